"""A reader for dh2urdf: kinematic files of cisst and of the da Vinci Research Kit."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.hookspecs import hookimpl

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.stages import Reader


@hookimpl
def dh2urdf_readers() -> Iterable[Reader[Any]]:
    """Kinematic files of cisst."""
    from dh2urdf_cisst.reader import READER

    return (READER,)
