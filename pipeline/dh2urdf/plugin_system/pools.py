"""The results of an executor: those of its own `map`, or of tasks that are submitted to its pool."""

from __future__ import annotations

import os
from contextlib import ExitStack, suppress
from functools import partial
from typing import TYPE_CHECKING, Any

from dh2urdf.plugin_system.task_window import handed_over
from dh2urdf.stages import Executor, Lost

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

AHEAD = 3
"""Tasks per worker of a pool that wait or are under way: the next one is there when a result has left."""


def results_of(
    executor: Executor[Any],
    function: Callable[[Any], Any],
    tasks: Iterable[Any],
    options: Any,  # noqa: ANN401 - the options of any executor
) -> Iterator[Any]:
    """Return results of a function over tasks, in the order of the tasks, as `Executor.map` has them."""
    if executor.map is not None:
        return executor.map(function, tasks, options)
    if executor.pool is None:
        raise TypeError(f"the executor {executor.name!r} has neither map nor pool")
    workers = getattr(options, "workers", None)
    workers = workers if isinstance(workers, int) and workers > 0 else os.cpu_count() or 1
    return _from_pools(partial(executor.pool, options), function, tasks, AHEAD * workers)


def _from_pools(
    make: Callable[[], Any], function: Callable[[Any], Any], tasks: Iterable[Any], ahead: int
) -> Iterator[Any]:
    """Results of the pool that is there now; one that a worker has broken is replaced by a new one."""
    from concurrent.futures import BrokenExecutor

    under_way: set[Any] = set()

    def submit(task: Any) -> tuple[Any, Any, Any]:  # noqa: ANN401 - a task is the caller's
        with suppress(BrokenExecutor):
            future = pool.submit(function, task)
            under_way.add(future)
            return pool, task, future
        return pool, task, None

    def entered() -> Any:  # noqa: ANN401 - a pool of any kind
        made = make()
        if not (hasattr(made, "__enter__") and hasattr(made, "submit")):
            given = None if made is None else type(made).__name__
            raise TypeError(f"it gave {given}, not a pool: a context manager with `submit`")
        there = stack.enter_context(made)
        stack.callback(lambda: [future.cancel() for future in under_way])  # What has not begun is for nobody.
        return there

    with ExitStack() as stack:
        pool = entered()
        for own, task, future in handed_over(tasks, submit, lambda: ahead):
            under_way.discard(future)
            with suppress(BrokenExecutor):  # Some task ended a worker, and the pool gives up all that it had.
                if future is not None:
                    result = future.result()
                    yield result
                    continue
            if own is pool:
                stack.close()
                under_way.clear()
                pool = entered()
            # Alone in a pool, it is known whether it was this task.
            with make() as alone:
                try:
                    result = alone.submit(function, task).result()
                except BrokenExecutor as error:
                    result = Lost(reason=f"the worker ended: {error}" if str(error) else "the worker ended")
            yield result
