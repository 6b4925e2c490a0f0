"""The contract of executors."""

from __future__ import annotations

import os
import threading
import time
from itertools import count, islice
from typing import TYPE_CHECKING, Any, ClassVar

import pytest

from dh2urdf.errors import ExecutorError, PluginError
from dh2urdf.stage_calls.pools import results_of
from dh2urdf.stages import Executor, Lost
from dh2urdf.testing.children.witness import marked, processes
from dh2urdf.testing.stage_contract import StageContract
from dh2urdf.testing.tasks import doubled, doubled_at_leisure, doubled_or_killed, process_of, reciprocal

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Iterable, Iterator

TASKS = 40
AHEAD = 1000
"""Tasks that an executor may take before their results are asked for; a run may have a million."""
LEAVING = 10.0
"""How long workers may take to be gone [s]."""


class ExecutorContract(StageContract):
    """What holds for an executor."""

    kind = "executor"
    stage: ClassVar[Executor[Any]]

    # --- The clauses

    def test_results_come_in_order(self) -> None:
        """Every task has its result, in the order of the tasks."""
        clause = self.test_results_come_in_order
        for tasks in (range(TASKS), range(1), range(0)):
            found = self._all(clause, doubled_at_leisure, tasks)
            if found != [2 * task for task in tasks]:
                self.breach(
                    clause,
                    found=f"{found} for the doubles of {list(tasks)}",
                    accepted=f"{[2 * task for task in tasks]}",
                    remedy="yield results in the order of the tasks, whichever task is done first",
                )

    def test_takes_tasks_as_they_are_needed(self) -> None:
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
            self.breach(
                self.test_takes_tasks_as_they_are_needed,
                found=f"{taken} tasks were taken before {len(first)} results were asked for",
                accepted=f"at most {AHEAD} tasks ahead",
                remedy="hand over a few tasks per worker, and the next one when a result has left: "
                "Executor.map of concurrent.futures takes all of them at once",
            )

    def test_errors_come_in_their_place(self) -> None:
        """What a task raises is raised as it is, after the results before it."""
        clause = self.test_errors_come_in_their_place
        results, found = self._map(reciprocal, [1, 2, 0, 4]), []
        what = "nothing was raised"
        try:
            for result in results:
                found.append(result)  # noqa: PERF402 - what came before the error is the fact
        except ZeroDivisionError:
            what = ""
        except Exception as error:  # noqa: BLE001 - whatever an author's code raises
            what = f"{type(error).__name__} was raised: {error}"
        finally:
            results.close()
        if what or found != [1.0, 0.5]:
            self.breach(
                clause,
                found=f"{found}, and {what or 'then the error'}, of the reciprocals of 1, 2, 0, 4",
                accepted="[1.0, 0.5], and then ZeroDivisionError, as the task raised it",
                remedy="raise what a task raised where its result would stand: `future.result()` does",
            )

    def test_errors_of_the_tasks_come_in_their_place(self) -> None:
        """What the tasks' own iterator raises, such as a reader's error, is raised after the results before it."""
        clause = self.test_errors_of_the_tasks_come_in_their_place

        def tasks() -> Iterator[int]:
            yield from range(5)
            raise LookupError("the table ends here")

        results, found, raised = self._map(doubled, tasks()), [], False
        try:
            for result in results:
                found.append(result)  # noqa: PERF402 - what came before the error is the fact
        except LookupError:
            raised = True
        finally:
            results.close()
        if not raised or found != [0, 2, 4, 6, 8]:
            self.breach(
                clause,
                found=f"{found}, and {'then the error' if raised else 'no error'}",
                accepted="the results of the five tasks, and then the error of the iterator",
                remedy="yield the results of all tasks that were taken before raising what the iterator raised",
            )

    def test_what_it_hands_over_is_pickled(self) -> None:
        """A function that pickles is enough: workers in other processes take it, its tasks and its results."""
        clause = self.test_what_it_hands_over_is_pickled
        found = self._all(clause, _Scaled(3), range(TASKS))
        if found != [3 * task for task in range(TASKS)]:
            self.breach(
                clause,
                found=f"{found}",
                accepted="the results of an object that can be called and pickled",
                remedy="call the function that `map` is given, with one task each time",
            )

    def test_a_worker_that_ends_costs_one_task(self) -> None:
        """A task that ends its worker's process gives Lost in its place, and all others have their results."""
        clause = self.test_a_worker_that_ends_costs_one_task
        if os.getpid() in self._all(clause, process_of, range(8)):
            return  # It works in this process, which no task may end.
        tasks = [*range(1, 9), -1, *range(9, 17)]
        found = self._all(clause, doubled_or_killed, tasks)
        expected = [2 * task for task in tasks]
        if not (len(found) == len(tasks) and isinstance(found[8], Lost) and found[:8] == expected[:8]) or (
            found[9:] != expected[9:]
        ):
            self.breach(
                clause,
                found=f"{found}",
                accepted="the results in order, with a dh2urdf.stages.Lost in place of the ninth",
                remedy="give the tasks of a worker that is gone to another one, and after a few tries yield "
                "Lost(reason='the worker crashed …') for the one that each of them died at",
            )

    def test_leaves_nothing_behind(self) -> None:
        """When all results are there, or are not wanted any more, its processes and threads are gone."""
        clause = self.test_leaves_nothing_behind
        threads = set(threading.enumerate())
        for wanted in (TASKS, 3):
            with marked() as mark:
                results = self._map(doubled, range(TASKS))
                list(islice(results, wanted))
                results.close()
                left = _left(mark, threads)
            if left:
                self.breach(
                    clause,
                    found=f"after {wanted} of {TASKS} results there were still {', '.join(left)}",
                    accepted="nothing that goes on",
                    remedy="let `map` be a generator, and end the workers in its `finally`: it is closed "
                    "where a run ends early",
                )

    def _map(self, function: Callable[[Any], Any], tasks: Iterable[Any]) -> Generator[Any, None, None]:
        """The results; whatever goes wrong is raised where the first of them is asked for."""
        try:
            self.stage.require(self.given())
            yield from results_of(self.stage, function, tasks, self.given())
        except PluginError as error:
            pytest.skip(str(error))

    def _all(self, clause: Callable[..., Any], function: Callable[[Any], Any], tasks: Iterable[Any]) -> list[Any]:
        results = self._map(function, tasks)
        try:
            return list(results)
        except ExecutorError:
            raise
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
            self.breach(
                clause,
                found=f"{type(error).__name__}: {error}",
                accepted="the results; dh2urdf.errors.ExecutorError where nobody can do the work",
                remedy="raise ExecutorError with a Problem that says who cannot be reached and what to do",
            )
        finally:
            results.close()


class _Scaled:
    """A function with data, as the pipeline's own is."""

    def __init__(self, factor: int) -> None:
        self.factor = factor

    def __call__(self, number: int) -> int:
        return self.factor * number


def _left(mark: str, threads: set[threading.Thread]) -> list[str]:
    """What is still there after a while: processes, and threads that would keep the program from ending."""
    patience = time.monotonic() + LEAVING
    while True:
        running = [thread for thread in threading.enumerate() if thread not in threads and not thread.daemon]
        left = [*processes(mark).values(), *(f"the thread {thread.name}" for thread in running)]
        if not left or time.monotonic() > patience:
            return left
        time.sleep(0.05)
