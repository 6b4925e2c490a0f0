"""The results of an executor: those of its own `map`, or of tasks that are submitted to its pool."""

from __future__ import annotations

import os
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Any, Self

from dh2urdf.plugin_system.task_window import handed_over
from dh2urdf.stages import Executor, Lost

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from contextlib import AbstractContextManager

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
    make = executor.pool
    if make is None:
        raise TypeError(f"the executor {executor.name!r} has neither map nor pool")

    def from_a_pool() -> Iterator[Any]:
        workers = getattr(options, "workers", None)
        workers = workers if isinstance(workers, int) and workers > 0 else os.cpu_count() or 1
        with _Pool(lambda: make(options), function) as pool:
            for promise in handed_over(tasks, pool.submit, lambda: AHEAD * workers):
                yield pool.result(*promise)

    return from_a_pool()


class _Pool:
    """The pool that is there now; one that a worker has broken is replaced by a new one."""

    def __init__(self, make: Callable[[], AbstractContextManager[Any]], function: Callable[[Any], Any]) -> None:
        self._make, self._function = make, function
        self._stack = ExitStack()
        self._under_way: set[Any] = set()
        self._enter()

    def _enter(self) -> None:
        made: Any = self._make()
        if not (hasattr(made, "__enter__") and hasattr(made, "submit")):
            given = None if made is None else type(made).__name__
            raise TypeError(f"it gave {given}, not a pool: a context manager with `submit`")
        self._pool = self._stack.enter_context(made)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        for future in self._under_way:  # What has not begun need not be done for nobody.
            future.cancel()
        self._stack.close()

    def submit(self, task: Any) -> tuple[Any, Any, Any]:  # noqa: ANN401 - a task is the caller's
        """Return the pool that a task is submitted to, the task, and its future; None where the pool is broken."""
        from concurrent.futures import BrokenExecutor

        with suppress(BrokenExecutor):
            future = self._pool.submit(self._function, task)
            self._under_way.add(future)
            return self._pool, task, future
        return self._pool, task, None

    def result(self, pool: Any, task: Any, future: Any) -> Any:  # noqa: ANN401 - the result of the caller's function
        """Return the result of a task; Lost for one that ends the worker which it has for itself."""
        from concurrent.futures import BrokenExecutor

        self._under_way.discard(future)
        with suppress(BrokenExecutor):  # Some task ended a worker, and the pool gives up all that it had.
            if future is not None:
                return future.result()
        if pool is self._pool:
            self._stack.close()
            self._under_way.clear()
            self._enter()
        # Alone in a pool, it is known whether it was this task.
        with self._make() as alone:
            try:
                return alone.submit(self._function, task).result()
            except BrokenExecutor as error:
                return Lost(reason=f"the worker ended: {error}" if str(error) else "the worker ended")
