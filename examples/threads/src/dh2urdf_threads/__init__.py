"""An executor for dh2urdf: the threads of one process."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.hookspecs import hookimpl

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.stages import Executor


@hookimpl
def dh2urdf_executors() -> Iterable[Executor[Any]]:
    """Threads."""
    from dh2urdf_threads.executor import EXECUTOR

    return (EXECUTOR,)
