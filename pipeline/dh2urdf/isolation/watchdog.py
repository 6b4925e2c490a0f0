"""Ends a worker that takes longer with a manipulator than it may.

Nothing else ends code of a plugin that hangs outside of Python. The executor tells the run that the batch is lost, and
the run then finds out which manipulator it was.
"""

from __future__ import annotations

import faulthandler
import os
import platform
from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import ManipulatorError
from dh2urdf.stage_calls.answers import a_record
from dh2urdf.stage_calls.calls import Call, blaming

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.stages import Loader


_STDERR = 2


def this_process() -> str:
    """The name of this process among those of all machines."""
    return f"{platform.node()}:{os.getpid()}"


@contextmanager
def watched(home: str, seconds: float, loaders: Sequence[Call[Loader[Any]]] = ()) -> Iterator[None]:
    """Ends this process where what is done takes longer than a manipulator may.

    Args:
        home: the process of the run itself, which is not ended.
        seconds: what a manipulator may take, simulators aside [s].
        loaders: the simulators that it goes through.

    """
    limits = [_limit_of(call) for call in loaders]
    if home == this_process() or None in limits:
        yield
        return
    faulthandler.dump_traceback_later(seconds + sum(filter(None, limits)), exit=True, file=_STDERR)
    try:
        yield
    finally:
        faulthandler.cancel_dump_traceback_later()


def _limit_of(call: Call[Loader[Any]]) -> float | None:
    """How long a loader may take [s]; 0 where it cannot say, and then fails when it is called."""
    with suppress(ManipulatorError), blaming(call, "time_limit"):
        limit = call.stage.time_limit(call.options)
        return None if limit is None else a_record(limit, int, float)
    return 0.0
