"""The descriptions of the PyPI package example-robot-data, and what is found in them: each is inspected once."""

from __future__ import annotations

import importlib.metadata
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf_check.inspection import inspect_urdf

if TYPE_CHECKING:
    from dh2urdf.stages import Finding


def descriptions() -> list[Path]:
    """All of them; none where the package is not installed."""
    try:
        files = importlib.metadata.files("example-robot-data") or ()
    except importlib.metadata.PackageNotFoundError:
        return []
    return sorted(Path(str(file.locate())).resolve() for file in files if file.suffix == ".urdf")


@cache
def findings_of(path: Path) -> tuple[Finding, ...]:
    return inspect_urdf(path).findings
