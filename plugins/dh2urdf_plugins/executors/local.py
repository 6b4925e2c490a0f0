"""The executor `local`: processes of this machine."""

from __future__ import annotations

import os
import signal
from collections import deque
from dataclasses import dataclass, field
from itertools import islice
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.errors import ManipulatorError, OutputError
from dh2urdf.source import Problem
from dh2urdf.stages import Executor

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from concurrent.futures import Future, ProcessPoolExecutor

CHUNK = 16
"""Manipulators that a process takes at once: handing one over costs about as much as making it."""
AHEAD = 4
"""Chunks per process that wait or are under way, so that the tasks of a long run are never all held."""


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalOptions:
    """How many processes work."""

    workers: Literal["auto"] | int = field(
        default="auto",
        metadata={"help": "processes; 1 works in the process itself, auto takes one per processor"},
    )

    def __post_init__(self) -> None:
        if self.workers != "auto" and self.workers < 1:
            raise ValueError("workers is a number from 1 on, or auto")


def map_locally(function: Callable[[Any], Any], tasks: Iterable[Any], options: LocalOptions) -> Iterator[Any]:
    """Results of a function over tasks, in their order, from a pool of processes.

    One task, or one worker, needs no pool: it is done in this process.
    """
    workers = _processors() if options.workers == "auto" else options.workers
    waiting = iter(tasks)
    first = list(islice(waiting, 2))
    if workers == 1 or len(first) < 2:  # noqa: PLR2004 - one task alone
        yield from map(function, first)
        yield from map(function, waiting)
        return
    yield from _map_in_pool(function, _chunks(first, waiting), workers)


def _processors() -> int:
    """The processors that this process may use, where the system says; else all there are."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _map_in_pool(function: Callable[[Any], Any], chunks: Iterator[list[Any]], workers: int) -> Iterator[Any]:
    from concurrent.futures import ProcessPoolExecutor
    from concurrent.futures.process import BrokenProcessPool
    from multiprocessing import get_context

    context = get_context("spawn")
    try:
        stop = context.RawValue("b", 0)
        pool = ProcessPoolExecutor(workers, mp_context=context, initializer=_start_worker, initargs=(stop,))
    except OSError as error:  # Shared memory and semaphores are files, too: a full disk is met here first.
        raise OutputError(
            Problem(
                message=f"worker processes cannot be started: {error.strerror}", suggestion="`--workers 1` needs none"
            )
        ) from error
    under_way: deque[Future[list[Any]]] = deque()
    try:
        under_way.extend(_submit(pool, function, chunk) for chunk in islice(chunks, AHEAD * workers))
        while under_way:
            results = under_way.popleft().result()
            under_way.extend(_submit(pool, function, chunk) for chunk in islice(chunks, 1))
            yield from results
    except BrokenProcessPool as error:
        raise ManipulatorError(
            Problem(
                message="a worker process was ended from outside: killed, or out of memory",
                suggestion="fewer workers need less memory: `--workers 1`",
            )
        ) from error
    finally:
        stop.value = 1
        pool.shutdown(cancel_futures=True)


_stop: Any = None
"""In a worker: whether the run has ended, and nobody waits for the rest of a chunk."""

# Ctrl-C reaches all processes of a terminal, and SIGTERM may: it ends a worker's work, and what the work was writing is
# taken away. A worker that has none, or that is just being started, stays silent: the run tells it, once.


class _Terminated(BaseException):
    """SIGTERM came while a worker was at work."""


def _on_terminate(_number: int, _frame: object) -> None:
    raise _Terminated


def _submit(pool: ProcessPoolExecutor, function: Callable[[Any], Any], chunk: list[Any]) -> Future[list[Any]]:
    if not hasattr(signal, "pthread_sigmask"):
        return pool.submit(_map_chunk, function, chunk)
    mask = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})  # A process that starts here inherits it.
    try:
        return pool.submit(_map_chunk, function, chunk)
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, mask)


def _start_worker(stop: Any) -> None:  # noqa: ANN401 - a number in shared memory has no public type
    global _stop  # noqa: PLW0603 - a worker has one pool
    _stop = stop
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})


def _map_chunk(function: Callable[[Any], Any], chunk: list[Any]) -> list[Any]:
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, _on_terminate)
    try:
        return [function(task) for task in chunk if not _stop.value]
    except _Terminated:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        os.kill(os.getpid(), signal.SIGTERM)  # Everything is cleaned up: now it ends as SIGTERM ends a process.
        raise
    finally:
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _chunks(first: list[Any], rest: Iterator[Any]) -> Iterator[list[Any]]:
    """The tasks one by one at first, so that a short run keeps every process busy, then in full chunks."""
    yield from ([task] for task in first)
    size = 1
    while chunk := list(islice(rest, size)):
        yield chunk
        size = min(size + 1, CHUNK)


EXECUTOR = Executor(
    name="local",
    summary="processes of this machine",
    options=LocalOptions,
    map=map_locally,
)
