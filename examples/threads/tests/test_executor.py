from __future__ import annotations

import threading

import pytest

from dh2urdf.testing import ExecutorContract
from dh2urdf_threads.executor import EXECUTOR, ThreadsOptions, pool


class TestContract(ExecutorContract):
    stage = EXECUTOR


class TestOneThread(ExecutorContract):
    stage = EXECUTOR
    options = ThreadsOptions(workers=1)


def test_it_has_as_many_threads_as_were_asked_for() -> None:
    """Each has a name that tells whose it is."""
    with pool(ThreadsOptions(workers=3)) as executor:
        meeting = threading.Barrier(3, timeout=30)
        futures = [executor.submit(lambda: (meeting.wait(), threading.current_thread().name)) for _ in range(3)]
        names = {future.result()[1] for future in futures}
    assert len(names) == 3
    assert all(name.startswith("dh2urdf") for name in names)


@pytest.mark.parametrize("workers", [0, -1])
def test_there_is_a_thread_at_least(workers: int) -> None:
    """None is no executor."""
    with pytest.raises(ValueError, match="from 1 on"):
        ThreadsOptions(workers=workers)
