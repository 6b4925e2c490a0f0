"""The contract of executors."""

from __future__ import annotations

import os
import signal
import threading
import time
from itertools import count, islice
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.stage_calls.pools import results_of
from dh2urdf.stages import Executor, Lost
from dh2urdf.testing.child import descendants
from dh2urdf.testing.stage_contract import StageContract, clause

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

    from dh2urdf.testing.stage_contract import Found

TASKS = 40
AHEAD = 1000
"""Tasks that an executor may take before their results are asked for; a run may have a million."""
LEAVING = 10.0
"""How long workers may take to be gone [s]."""


class ExecutorContract(StageContract):
    """What holds for an executor."""

    kind = "executor"
    stage: ClassVar[Executor[Any]]

    @clause
    def test_results_come_in_order(self) -> Found:
        """Every task has its result, in the order of the tasks."""
        for tasks in (range(TASKS), range(1), range(0)):
            if (found := list(self._map(doubled_at_leisure, tasks))) != [2 * task for task in tasks]:
                yield f"{found} for the doubles of {list(tasks)}"

    @clause
    def test_takes_tasks_as_they_are_needed(self) -> Found:
        """Tasks without end give results: only a few are taken ahead."""
        taken = 0

        def endless() -> Iterator[int]:
            nonlocal taken
            for taken in count(1):
                if taken > 10 * AHEAD:
                    return
                yield taken

        results = self._map(doubled, endless())
        first = list(islice(results, TASKS))
        results.close()
        if first != [2 * task for task in range(1, TASKS + 1)] or taken > AHEAD + TASKS:
            yield f"{taken} tasks were taken before {len(first)} results were asked for"

    @clause
    def test_errors_come_in_their_place(self) -> Found:
        """What a task raises is raised as it is, after the results before it."""
        found, error = _until(self._map(reciprocal, [1, 2, 0, 4]))
        if found != [1.0, 0.5] or type(error) is not ZeroDivisionError:
            how = (
                "then the error" if type(error) is ZeroDivisionError else f"{type(error).__name__} was raised: {error}"
            )
            yield f"{found}, and {how}, of the reciprocals of 1, 2, 0, 4"

    @clause
    def test_errors_of_the_tasks_come_in_their_place(self) -> Found:
        """What the tasks' own iterator raises, such as a reader's error, is raised after the results before it."""

        def tasks() -> Iterator[int]:
            yield from range(5)
            raise LookupError("the table ends here")

        found, error = _until(self._map(doubled, tasks()))
        if found != [0, 2, 4, 6, 8] or not isinstance(error, LookupError):
            yield f"{found}, and {'then the error' if isinstance(error, LookupError) else repr(error)}"

    @clause
    def test_what_it_hands_over_is_pickled(self) -> Found:
        """A function that pickles is enough: workers in other processes take it, its tasks and its results."""
        if (found := list(self._map(_Scaled(3), range(TASKS)))) != [3 * task for task in range(TASKS)]:
            yield f"{found}"

    @clause
    def test_a_worker_that_ends_costs_one_task(self) -> Found:
        """A task that ends its worker's process gives Lost in its place, and all others have their results."""
        if os.getpid() in list(self._map(process_of, range(8))):
            return  # It works in this process, which no task may end.
        tasks = [*range(1, 9), -1, *range(9, 17)]
        found = list(self._map(doubled_or_killed, tasks))
        others = [result for result in found if not isinstance(result, Lost)]
        if (
            len(found) != len(tasks)
            or not isinstance(found[8], Lost)
            or others != [2 * task for task in tasks if task > 0]
        ):
            yield f"{found}"

    @clause
    def test_leaves_nothing_behind(self) -> Found:
        """When all results are there, or are not wanted any more, its processes and threads are gone."""
        threads, processes = set(threading.enumerate()), set(descendants())
        for wanted in (TASKS, 3):
            results = self._map(doubled, range(TASKS))
            list(islice(results, wanted))
            results.close()
            patience = time.monotonic() + LEAVING
            while left := _left(threads, processes):
                if time.monotonic() > patience:
                    yield f"after {wanted} of {TASKS} results there were still {', '.join(left)}"
                time.sleep(0.05)

    def _map(self, function: Callable[[Any], Any], tasks: Iterable[Any]) -> Generator[Any, None, None]:
        """The results; whatever goes wrong is raised where the first of them is asked for."""
        self.stage.require(self.given())
        yield from results_of(self.stage, function, tasks, self.given())


def _until(results: Generator[Any, None, None]) -> tuple[list[Any], Exception | None]:
    """Results up to an error, and the error."""
    found: list[Any] = []
    try:
        for result in results:
            found.append(result)  # noqa: PERF402 - what came before the error is the fact
    except Exception as error:  # noqa: BLE001 - whatever an author's code raises
        return found, error
    finally:
        results.close()
    return found, None


def _left(threads: set[threading.Thread], processes: set[int]) -> list[str]:
    """What was started since and would keep the program from ending: processes, and threads that are no daemons."""
    running = [thread for thread in threading.enumerate() if thread not in threads and not thread.daemon]
    others = [command for number, command in descendants().items() if number not in processes]
    return [*others, *(f"the thread {thread.name}" for thread in running)]


# --- What workers do: every one of them can import this module


class _Scaled:
    """A function with data, as the pipeline's own is."""

    def __init__(self, factor: int) -> None:
        self.factor = factor

    def __call__(self, number: int) -> int:
        return self.factor * number


def doubled(number: int) -> int:
    """Twice a number."""
    return 2 * number


def doubled_at_leisure(number: int) -> int:
    """Twice a number; every fourth takes longer than those after it."""
    time.sleep(0.0 if number % 4 else 0.03)
    return 2 * number


def reciprocal(number: int) -> float:
    """One by a number."""
    return 1 / number


def process_of(_task: object) -> int:
    """The process that does the task."""
    return os.getpid()


def doubled_or_killed(number: int) -> int:
    """Twice a number; a negative one ends the process that works at it."""
    if number < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return 2 * number
