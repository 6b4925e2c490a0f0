"""Notices as Python's warnings: in a program nobody reads `notices` that are not looked for."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING

from dh2urdf.errors import TableWarning
from dh2urdf.plugin_system.attribution import current

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.source import Problem


def warn_of(notices: Iterable[Problem], depth: int = 1) -> None:
    """Give notices as warnings, each once, at the line that called a public function, `depth` functions above.

    Not while a stage is at work, such as a reader that calls `from_dh`: the caller of the stage reports its notices.
    """
    if current() is None:
        for text in dict.fromkeys(map(str, notices)):
            warnings.warn(text, TableWarning, stacklevel=depth + 2)
