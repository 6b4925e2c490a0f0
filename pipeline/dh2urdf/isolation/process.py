"""What a run does to the process that it is in: garbage collection, and an end to work that takes too long.

What a switch changes for a whole process - the garbage collector, warnings, levels of loggers - is touched in a process
of our own alone: in the command line, and in the workers that a run starts.
"""

from __future__ import annotations

import gc
import os
import platform
from contextlib import contextmanager
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Iterator

_OWN: list[bool] = []
_STDERR = 2


def claim() -> None:
    """Say that this process does nothing but what dh2urdf was asked for."""
    _OWN.append(True)


def is_own() -> bool:
    """Whether the process does nothing but what dh2urdf was asked for."""
    return bool(_OWN)


def this_process() -> str:
    """Return the name of this process among those of all machines."""
    return f"{platform.node()}:{os.getpid()}"


@contextmanager
def collected_at_the_end() -> Iterator[None]:
    """Keep the garbage collector of a process of our own away, and call it at the end for what is new.

    It looks through all records to find the few that refer to themselves, such as an error and its traceback: a tenth
    of the time of a run. Once for each batch is enough.
    """
    if not (is_own() and gc.isenabled()):  # The caller that keeps it away will call it.
        yield
        return
    gc.disable()
    try:
        yield
    finally:
        gc.enable()
        gc.collect(0)


@contextmanager
def watched(home: str, seconds: float | None) -> Iterator[None]:
    """End this process where its work takes too long [s]: nothing else ends a plugin that hangs outside of Python.

    The executor tells the run that the batch is lost, and the run then finds out which manipulator it was. The process
    of the run itself (`home`) is not ended.
    """
    if home == this_process() or seconds is None:
        yield
        return
    import faulthandler

    faulthandler.dump_traceback_later(seconds, exit=True, file=_STDERR)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()
