"""The executor `threads`: the work of a run on threads of its own process, by `concurrent.futures`."""

from __future__ import annotations

import os
from collections import deque
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.stages import Executor

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from concurrent.futures import Future

AHEAD = 2
"""Tasks per thread that are under way or wait: a run may have a million, and they are never all held."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ThreadsOptions:
    """How many threads work."""

    workers: Literal["auto"] | int = field(
        default="auto", metadata={"help": "threads; auto takes one per processor, and four more, as Python does"}
    )

    def __post_init__(self) -> None:
        if self.workers != "auto" and self.workers < 1:
            raise ValueError("workers is a number from 1 on, or auto")


def map_on_threads(function: Callable[[Any], Any], tasks: Iterable[Any], options: ThreadsOptions) -> Iterator[Any]:
    """Results of a function over tasks, in their order, from threads of this process.

    What a task raises is raised in its place, and what the tasks' own iterator raises after the results before it.
    """
    workers = (os.cpu_count() or 1) + 4 if options.workers == "auto" else options.workers
    waiting: deque[Future[Any]] = deque()
    pool = ThreadPoolExecutor(workers, thread_name_prefix="dh2urdf")
    try:
        upcoming = iter(tasks)
        failure: Exception | None = None
        while True:
            while failure is None and len(waiting) < AHEAD * workers:
                try:
                    waiting.append(pool.submit(function, next(upcoming)))
                except Exception as error:  # noqa: BLE001 - raised when its turn comes; the end is one of them
                    failure = error
            if not waiting:
                break
            yield waiting.popleft().result()
        if not isinstance(failure, StopIteration) and failure is not None:
            raise failure
    finally:  # The run may stop in the middle: what has not begun never does, and what has begun is waited for.
        pool.shutdown(cancel_futures=True)


EXECUTOR = Executor(
    name="threads",
    summary="threads of this process",
    options=ThreadsOptions,
    map=map_on_threads,
)
