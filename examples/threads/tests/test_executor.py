from __future__ import annotations

import threading
import time
from itertools import count, islice

import pytest

from dh2urdf.testing import ExecutorContract
from dh2urdf_threads.executor import AHEAD, EXECUTOR, ThreadsOptions, map_on_threads


class TestContract(ExecutorContract):
    stage = EXECUTOR


class TestOneThread(ExecutorContract):
    stage = EXECUTOR
    options = ThreadsOptions(workers=1)


def test_threads_work_side_by_side() -> None:
    """As many tasks are under way at once as there are threads: they wait for each other, and all arrive."""
    meeting = threading.Barrier(3, timeout=30)

    def wait(_task: int) -> str:
        meeting.wait()
        return threading.current_thread().name

    names = list(map_on_threads(wait, range(3), ThreadsOptions(workers=3)))
    assert len(set(names)) == 3


def test_no_more_tasks_are_taken_than_said() -> None:
    """Two for each thread, of tasks without end."""
    tasks = count()
    results = map_on_threads(str, tasks, ThreadsOptions(workers=3))
    assert list(islice(results, 5)) == ["0", "1", "2", "3", "4"]
    assert next(tasks) <= 5 + AHEAD * 3


def test_what_has_not_begun_never_does() -> None:
    """A run that stops in the middle waits for what is under way, and for nothing else."""
    begun: list[int] = []

    def work(task: int) -> int:
        begun.append(task)
        time.sleep(0.01)
        return task

    results = map_on_threads(work, range(100), ThreadsOptions(workers=1))
    next(results)
    results.close()  # type: ignore[attr-defined]  # it is a generator
    seen = len(begun)
    time.sleep(0.05)
    assert len(begun) == seen <= 1 + AHEAD


@pytest.mark.parametrize("workers", [0, -1])
def test_there_is_a_thread_at_least(workers: int) -> None:
    """None is no executor."""
    with pytest.raises(ValueError, match="from 1 on"):
        ThreadsOptions(workers=workers)
