"""The executor `dask`: workers of a Dask cluster, on this machine or on many.

Dask gives the tasks of a worker that is gone to others. What is added here is the order of the results, a bound on what
is handed over, and an answer where Dask waits for ever: nobody at the address, no workers, workers of another version.
"""

from __future__ import annotations

import importlib.util
import logging
import os
import threading
import time
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.errors import ExecutorError, MissingDependencyError
from dh2urdf.isolation import is_own
from dh2urdf.source import Messages, Problem
from dh2urdf.stages import Executor, Lost, Requires
from dh2urdf_plugins.executors.local import processors
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

say = Messages(__file__)

AHEAD_OF_THREADS = 3
"""Tasks per thread of the cluster that wait or are under way: the next one is there before the last result has left."""
CONNECTING = 5.0  # how long a scheduler may take to answer [s]
WORKERS_WITHIN = 300.0  # how long a run waits for workers where there are none [s]: a queue may have to start others
KILLS = 1  # workers of an own cluster that may die at a task and it is still given to another one

_HUSH = "import os\nfor number in (1, 2): os.dup2(os.open(os.devnull, os.O_WRONLY), number)\n"
"""Nobody sees what workers print, and it must not fill a pipe."""
_RUNNING: dict[str, Any] = {}  # the cluster of this process, by its address
_LOOK = 1.0  # [s] between looks at the cluster while a result is waited for
_UNTOLD = 5.0  # [s] without workers that nobody has to hear of: others are being started
_LOGGER = logging.getLogger("dh2urdf")
_VERSIONS = """{
    **{
        name: next((found.version for found in __import__("importlib.metadata").metadata.distributions(name=name)), "")
        for name in NAMES
    },
    "Python": "%d.%d" % __import__("sys").version_info[:2],
}"""
"""The versions of some distributions and of Python, as an expression: a worker has to answer without dh2urdf, too."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DaskOptions:
    """Which cluster works."""

    scheduler: str | None = option(
        "address of a Dask scheduler, such as tcp://host:8786; none: a cluster on this machine", None
    )
    workers: Literal["auto"] | int = option(
        "processes of the cluster on this machine; auto takes one per processor", "auto"
    )

    def __post_init__(self) -> None:
        if self.workers != "auto" and self.workers < 1:
            raise ValueError("workers is a number from 1 on, or auto")
        if self.workers != "auto" and self.scheduler is not None:
            raise ValueError("workers are those of the scheduler: you choose their number when you start them")


def require(_options: DaskOptions) -> None:
    """Ask whether Dask's scheduler is there, without importing it."""
    if importlib.util.find_spec("distributed") is None:
        raise MissingDependencyError("executor 'dask'", "distributed", "dh2urdf[dask]")


def map_on_dask(function: Callable[[Any], Any], tasks: Iterable[Any], options: DaskOptions) -> Iterator[Any]:
    """Results of a function over tasks, in their order, from the workers of a Dask cluster."""
    from dh2urdf.isolation import Child
    from dh2urdf.plugin_system import handed_over

    with ExitStack() as stack:
        if (address := options.scheduler) is None:
            # A cluster that lives as long, in a child process: no Ctrl-C of a terminal arrives there, and the child is
            # ended at once with all of it.
            child = stack.enter_context(Child.started())
            workers = processors() if options.workers == "auto" else options.workers
            try:
                address = child.call(_start, (workers,), None, "Dask").value
            except (OSError, RuntimeError) as error:
                raise ExecutorError(say("no-cluster", reason=f"{type(error).__name__}: {error}")) from error
        cluster = _Cluster(stack.enter_context(_client(address)), function)
        for task, future in handed_over(tasks, cluster.hand_over, cluster.ahead):
            yield cluster.result(task, future)


@contextmanager
def _client(address: str) -> Iterator[Any]:
    """A connection to a scheduler."""
    import distributed

    for name in ("distributed", "distributed.client", "tornado", "tornado.application"):  # each prints for itself
        if is_own():
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
    try:
        distributed.comm.resolve_address(address)  # A client that met no address would never be closed.
        client = distributed.Client(address, timeout=CONNECTING, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ExecutorError(say("no-scheduler", field="scheduler", address=address, reason=error)) from error
    try:
        yield client
    finally:
        client.close(timeout=_LOOK)  # The scheduler drops what it still has to do for this client.


def _start(workers: int) -> str:
    """In the child: start a scheduler, and workers in further processes; the scheduler's address."""
    # By default a worker that takes longer than 15 s to come back is given up for good, and a run waits for nobody.
    os.environ["DASK_DISTRIBUTED__DEPLOY__LOST_WORKER_TIMEOUT"] = f"{WORKERS_WITHIN:g}s"
    from distributed import LocalCluster

    cluster = LocalCluster(
        n_workers=workers,
        threads_per_worker=1,
        dashboard_address=None,
        silence_logs=logging.CRITICAL,
        preload=[_HUSH],
        scheduler_kwargs={"allowed_failures": KILLS},
    )
    exec(_HUSH)  # noqa: S102 - the text is above
    _RUNNING[cluster.scheduler_address] = cluster
    return str(cluster.scheduler_address)


class _Cluster:
    """What a run asks of the workers."""

    def __init__(self, client: Any, function: Callable[[Any], Any]) -> None:  # noqa: ANN401 - Dask has no types
        self._client, self._function = client, function
        # What has to be the same everywhere. A run says whose stages it uses; what else is installed is its own affair.
        self._needed = _versions(("Python", "distributed", "dh2urdf", *getattr(function, "distributions", ())))
        self._under_way: set[Any] = set()
        self._threads, self._looked = 0, 0.0
        self._look_for_workers()
        found = client.run(eval, _VERSIONS, {"NAMES": tuple(self._needed)})
        if problems := [problem for where in sorted(found) for problem in _others(where, self._needed, found[where])]:
            raise ExecutorError(problems)

    def ahead(self) -> int:
        """Return how many tasks the workers should have, as many workers as there are by now."""
        if time.monotonic() - self._looked > _LOOK:
            self._look()
        return AHEAD_OF_THREADS * max(1, self._threads)

    def hand_over(self, task: Any) -> tuple[Any, Any]:  # noqa: ANN401 - a task is the caller's
        """Return a task and Dask's promise of its result."""
        future = self._client.submit(_do, self._function, self._needed, task, pure=False)
        self._under_way.add(future)
        return task, future

    def result(self, task: Any, future: Any) -> Any:  # noqa: ANN401 - a task and its result are the caller's
        """Return the result of a task; of one that no worker survives, that it is lost."""
        from distributed import KilledWorker

        try:
            return self._result(future)
        except KilledWorker:
            # Dask suspects all that a worker had to do when it died. Alone, it is known which of them it was.
            for other in self._under_way:
                self._wait(other)
        try:
            return self._result(self.hand_over(task)[1])
        except KilledWorker as error:
            count, last = error.allowed_failures + 1, error.last_worker.address
            return Lost(reason=f"{count} Dask workers died at it, the last at {last}")

    def _result(self, future: Any) -> Any:  # noqa: ANN401 - the result of the caller's function
        import asyncio
        import concurrent.futures

        self._wait(future)
        self._under_way.discard(future)
        # Its worker may be gone by now, and others have to make the result again: this waits, too.
        gathering = self._client.gather([future], asynchronous=True)
        gathered = asyncio.run_coroutine_threadsafe(gathering, self._client.loop.asyncio_loop)
        try:
            while concurrent.futures.wait([gathered], timeout=_LOOK).not_done:
                self._look_for_workers()
            (result,) = gathered.result()
        except (OSError, asyncio.CancelledError, concurrent.futures.CancelledError) as error:
            if future.status == "error":  # It is what the function raised.
                raise
            raise ExecutorError(say("scheduler-gone")) from error
        finally:
            gathered.cancel()
        return result

    def _wait(self, future: Any) -> None:  # noqa: ANN401 - Dask has no types
        """Wait until a task is done, as long as there is somebody to do it."""
        while True:
            try:
                future.exception(timeout=_LOOK)
            except TimeoutError:
                self._look_for_workers()
            else:
                return

    def _look(self) -> None:
        """Count the workers' threads."""
        try:
            self._threads = sum(self._client.nthreads().values())
        except OSError as error:
            raise ExecutorError(say("scheduler-gone")) from error
        self._looked = time.monotonic()

    def _look_for_workers(self) -> None:
        """Count the workers' threads; where there are none, wait until some are there."""
        self._look()
        began, told = time.monotonic(), False
        while not self._threads:
            waited = time.monotonic() - began
            if not told and waited > _UNTOLD:
                _LOGGER.warning("no Dask worker is there; waiting for one, up to %g s", WORKERS_WITHIN)
                told = True
            if waited > WORKERS_WITHIN:
                address = self._client.scheduler.address
                raise ExecutorError(say("no-worker-came", seconds=WORKERS_WITHIN, address=address))
            time.sleep(_LOOK / 10)
            self._look()


@cache
def _versions(names: tuple[str, ...]) -> dict[str, str]:
    """Return the versions of some distributions, and of Python, in this process; empty where one is not installed."""
    return dict(eval(_VERSIONS, {"NAMES": names}))  # noqa: S307 - the text is above


def _others(address: str, ours: dict[str, str], theirs: dict[str, str]) -> Iterator[Problem]:
    """Yield what a worker has not, or in another version."""
    for name, version in ours.items():
        if theirs.get(name) != version:
            code = "worker-of-other-version" if theirs.get(name) else "worker-without-package"
            yield say(code, address=address, name=name, version=version, theirs=theirs.get(name))


_ONE_AT_A_TIME = threading.Lock()  # a worker may have several threads; stages need not bear others beside them


def _do(function: Callable[[Any], Any], ours: dict[str, str], task: Any) -> Any:  # noqa: ANN401 - the caller's
    """Do a task, in a worker; one that came late has been asked for its versions by nobody yet."""
    theirs = _versions(tuple(ours))
    if ours != theirs:
        from distributed import get_worker

        raise ExecutorError(_others(get_worker().address, ours, theirs))
    with _ONE_AT_A_TIME:
        return function(task)


EXECUTOR = Executor(
    name="dask",
    summary="workers of a Dask cluster, on this machine or on many",
    options=DaskOptions,
    map=map_on_dask,
    capabilities=(Requires(require),),
)
