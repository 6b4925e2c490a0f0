"""An emitter for dh2urdf: the kinematic tree as a graph."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.hookspecs import hookimpl

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.stages import Emitter


@hookimpl
def dh2urdf_emitters() -> Iterable[Emitter[Any]]:
    """Graphs in DOT."""
    from dh2urdf_graphviz.emitter import EMITTER

    return (EMITTER,)
