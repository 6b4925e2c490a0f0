"""Executors that give a pool alone: dh2urdf keeps the contract for them, crashes of workers included."""

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context

import pytest

from dh2urdf.plugin_system.pools import results_of
from dh2urdf.stages import Executor, Lost, NoOptions
from dh2urdf.testing import ExecutorContract
from dh2urdf.testing.worker_contracts import doubled_or_killed


@dataclass(frozen=True, slots=True, kw_only=True)
class Workers:
    workers: int = field(default=2, metadata={"help": "how many work"})


def processes(options: Workers) -> ProcessPoolExecutor:
    return ProcessPoolExecutor(options.workers, mp_context=get_context("spawn"))


def threads(options: Workers) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(options.workers)


PROCESSES = Executor(name="processes", summary="a pool of processes", options=Workers, pool=processes)
THREADS = Executor(name="threads", summary="a pool of threads", options=Workers, pool=threads)


class InNoPlugin(ExecutorContract):
    """The contract without the clause about the plugin of a stage: these are in none."""

    test_registering_imports_nothing_heavy = None  # type: ignore[assignment]


class TestProcesses(InNoPlugin):
    stage = PROCESSES


class TestThreads(InNoPlugin):
    stage = THREADS


def test_every_task_that_ends_a_worker_is_lost_and_no_other() -> None:
    """A third of the tasks kill their process, again and again: pools are replaced, and the others have results."""
    found = list(results_of(PROCESSES, doubled_or_killed, [1, 2, -1, 4, 5, -1, 7, 8, -1], Workers()))
    assert [each if isinstance(each, int) else 0 for each in found] == [2, 4, 0, 8, 10, 0, 14, 16, 0]
    assert all(each.reason.startswith("the worker ended") for each in found if isinstance(each, Lost))


def test_neither_map_nor_pool() -> None:
    """A record without both is refused where it is used, and by the catalog before."""
    with pytest.raises(TypeError, match="neither map nor pool"):
        results_of(Executor(name="none", summary="s", options=NoOptions), str, [1], NoOptions())
