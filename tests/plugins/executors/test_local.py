from __future__ import annotations

import math
import multiprocessing
import operator
import os
import signal
import subprocess
import sys
from functools import partial
from itertools import count, islice
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import ManipulatorError
from dh2urdf_plugins.executors.local import EXECUTOR, LocalOptions, map_locally

if TYPE_CHECKING:
    from collections.abc import Iterator

# The work is done by functions of the standard library: a worker has to import what it is to call.
call = operator.methodcaller("__call__")
one_by = partial(operator.floordiv, 1)


class Counted:
    """Numbers from 0, counting how many were taken."""

    def __init__(self, numbers: Any) -> None:
        self.taken = 0
        self._numbers = numbers

    def __iter__(self) -> Iterator[int]:
        for number in self._numbers:
            self.taken += 1
            yield number


@pytest.fixture(params=[1, 2], ids=["in this process", "in a pool"])
def options(request: pytest.FixtureRequest) -> LocalOptions:
    return LocalOptions(workers=request.param)


class TestResults:
    @pytest.mark.parametrize("number", [0, 1, 2, 3, 200])
    def test_come_in_the_order_of_the_tasks(self, options: LocalOptions, number: int) -> None:
        """Every task has its result, in order, whoever is done first."""
        sizes = [2000 if i % 50 == 0 else i for i in range(number)]
        assert list(map_locally(math.factorial, sizes, options)) == [math.factorial(size) for size in sizes]

    def test_come_while_tasks_are_still_taken(self, options: LocalOptions) -> None:
        """A run without end gives results: tasks are taken as they are needed, and a few ahead."""
        tasks = Counted(count())
        results = map_locally(operator.neg, tasks, options)
        assert list(islice(results, 50)) == [-number for number in range(50)]
        assert tasks.taken < 500
        results.close()  # type: ignore[attr-defined]

    def test_an_error_comes_in_its_place(self, options: LocalOptions) -> None:
        """What a task raises is raised after the results before it."""
        results = map_locally(one_by, [1, 1, 0, 1], options)
        assert [next(results), next(results)] == [1, 1]
        with pytest.raises(ZeroDivisionError):
            next(results)
        assert multiprocessing.active_children() == []

    def test_an_error_of_the_tasks_themselves_is_theirs(self, options: LocalOptions) -> None:
        """A reader that fails while tasks are taken ends the run with its own error."""

        def tasks() -> Iterator[int]:
            yield from range(5)
            raise LookupError("no more rows")

        with pytest.raises(LookupError, match="no more rows"):
            list(map_locally(operator.neg, tasks(), options))
        assert multiprocessing.active_children() == []


class TestProcesses:
    def test_several_workers_are_processes_of_their_own(self) -> None:
        """With several workers nothing is done in the process that asks."""
        workers = set(map_locally(call, [os.getpid] * 50, LocalOptions(workers=2)))
        assert os.getpid() not in workers
        assert 1 <= len(workers) <= 2

    def test_one_worker_is_this_process(self) -> None:
        """With one worker everything is done here: no pool to start, and a debugger sees it."""
        assert set(map_locally(call, [os.getpid] * 5, LocalOptions(workers=1))) == {os.getpid()}

    def test_one_task_needs_no_pool(self) -> None:
        """One manipulator is made here, whatever number of workers is asked for."""
        assert list(map_locally(call, [os.getpid], LocalOptions(workers=8))) == [os.getpid()]

    def test_none_is_left_when_the_results_are_not_wanted_any_more(self) -> None:
        """Where the run ends early, so do its processes."""
        results = map_locally(operator.neg, count(), LocalOptions(workers=2))
        next(results)
        results.close()  # type: ignore[attr-defined]
        assert multiprocessing.active_children() == []

    def test_one_that_is_killed_is_told_in_a_sentence(self) -> None:
        """Where the system ends a worker, for want of memory or at a person's wish, the run does not call it a fault."""
        with pytest.raises(ManipulatorError, match="a worker process was ended from outside: killed, or out of memory"):
            list(map_locally(call, [partial(signal.raise_signal, signal.SIGKILL)] * 3, LocalOptions(workers=2)))
        assert multiprocessing.active_children() == []

    @pytest.mark.skipif(not hasattr(os, "killpg"), reason="the system has no process groups")
    @pytest.mark.parametrize("results", [1, 30], ids=["while workers start", "while workers wait"])
    def test_an_interrupt_is_told_once(self, results: int) -> None:
        """Ctrl-C reaches every process of the terminal; the workers end without a word, the run tells it once."""
        script = (
            "import time\n"
            "from dh2urdf_plugins.executors.local import LocalOptions, map_locally\n"
            "def tasks():\n"
            "    while True:\n"
            "        yield 0.001\n"
            "        time.sleep(0.01)\n"
            "try:\n"
            "    for _ in map_locally(time.sleep, tasks(), LocalOptions(workers=3)):\n"
            "        print('done', flush=True)\n"
            "except KeyboardInterrupt:\n"
            "    print('interrupted')\n"
        )
        with subprocess.Popen(
            [sys.executable, "-c", script],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        ) as process:
            assert process.stdout
            for _ in range(results):
                assert process.stdout.readline() == "done\n"
            os.killpg(process.pid, signal.SIGINT)
            printed, errors = process.communicate(timeout=60)
        assert printed.splitlines()[-1] == "interrupted"
        assert errors == ""


class TestOptions:
    @pytest.mark.parametrize("workers", [0, -1])
    def test_there_is_at_least_one_worker(self, workers: int) -> None:
        """No worker, or fewer, is refused."""
        with pytest.raises(ValueError, match="a number from 1 on, or auto"):
            LocalOptions(workers=workers)

    def test_auto_is_the_default_and_works(self) -> None:
        """Without a number there is a worker per processor."""
        assert EXECUTOR.options() == LocalOptions(workers="auto")
        assert list(EXECUTOR.map(operator.neg, range(10), LocalOptions())) == [-number for number in range(10)]
