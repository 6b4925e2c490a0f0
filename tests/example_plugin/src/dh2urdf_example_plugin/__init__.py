"""Stages for dh2urdf: a reader of TOML tables and an emitter of data sheets."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.hookspecs import hookimpl

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.stages import Emitter, Reader


@hookimpl
def dh2urdf_readers() -> Iterable[Reader[Any]]:
    """Tables in TOML."""
    from dh2urdf_example_plugin.reader import READER

    return (READER,)


@hookimpl
def dh2urdf_emitters() -> Iterable[Emitter[Any]]:
    """Data sheets in Markdown."""
    from dh2urdf_example_plugin.emitter import EMITTER

    return (EMITTER,)
