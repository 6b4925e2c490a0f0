"""What a plugin gives: stages of all kinds, and commands."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, TypeAlias

from dh2urdf.stages import Edit, Emitter, Reader, Transform
from dh2urdf.stages.executors import Executor
from dh2urdf.stages.loaders import Loader

Stage: TypeAlias = Reader[Any] | Transform[Any] | Edit[Any] | Emitter[Any] | Loader[Any] | Executor[Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Subcommand:
    """A command that a plugin adds to ``dh2urdf``.

    Attributes:
        name: the word on the command line, such as ``check``. A command of dh2urdf itself keeps its name.
        summary: one line for ``dh2urdf --help``.
        function: where the `click.Command` is, as ``module:name``; the module is imported when the command is called.
            The command's options are those of the `click.Command`, and its exit status is what its function returns.
        behind: the command that it follows in ``dh2urdf --help``; it is at the end by default.
    """

    name: str
    summary: str
    function: str
    behind: str = ""
