"""The executor `local`: processes of this machine.

Every worker process has a thread here that hands it one task at a time, so it is known which task a worker was at when
it died. A pool of `concurrent.futures` does not know that, and breaks as a whole.
"""

from __future__ import annotations

import json
import os
import pickle
import signal
import sys
import threading
import time
from dataclasses import dataclass
from itertools import chain, islice
from operator import length_hint
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.errors import ExecutorError, PluginError
from dh2urdf.isolation import claim
from dh2urdf.source import Messages, printable
from dh2urdf.stages import Executor, Lost, Usual
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from dh2urdf.isolation import Child

say = Messages(__file__)

MOST_PRINTED = 100  # lines of what C code and other programs print during a task that are passed on
AHEAD = 4  # tasks per process that wait or are under way, so that the tasks of a long run are never all held
TRIES = 2  # workers that a task may cost before it is lost: the first may have been killed for the sake of others
_CLEARING_UP = 0.6  # [s] for workers to take away what they were writing
_LAST_WORDS = 300  # characters of what a worker printed that a reason repeats


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalOptions:
    """How many processes work."""

    workers: Literal["auto"] | int = option(
        "processes; 1 works in the process itself, which a crash ends; auto takes one per processor", "auto"
    )

    def __post_init__(self) -> None:
        if self.workers != "auto" and self.workers < 1:
            raise ValueError("workers is a number from 1 on, or auto")


def map_locally(function: Callable[[Any], Any], tasks: Iterable[Any], options: LocalOptions) -> Iterator[Any]:
    """Results of a function over tasks, in their order, from processes of this machine.

    One task needs no other process: it is done in this one, and so are all where one worker is asked for. A task that
    is a collection of several things is worth a process of its own, which may crash, on one processor too.
    """
    workers = processors() if options.workers == "auto" else options.workers
    waiting = iter(tasks)
    first = list(islice(waiting, 2))
    if options.workers == 1 or sum(length_hint(task, 1) for task in first) <= 1:
        yield from map(function, chain(first, waiting))
        return
    from dh2urdf.plugin_system import handed_over

    pool = _Pool(function, workers)
    try:
        for future in handed_over(chain(first, waiting), pool.submit, lambda: AHEAD * workers):
            yield future.result()
    finally:
        pool.end()


def processors() -> int:
    """The processors that this process may use, where the system says; else all there are."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _Pool:
    """Threads with a worker process each."""

    def __init__(self, function: Callable[[Any], Any], workers: int) -> None:
        from concurrent.futures import ThreadPoolExecutor

        self._begin = pickle.dumps((_begin, (function,)))
        others = " or ".join(name for name in getattr(function, "distributions", ()) if name != "dh2urdf")
        self._whose = f"a stage of {others}" if others else "a worker"
        self._threads = ThreadPoolExecutor(workers)
        self._of_thread = threading.local()
        self._workers: list[Child] = []
        self._changing = threading.Lock()
        self._is_ending = False

    def submit(self, task: Any) -> Any:  # noqa: ANN401 - a task is the caller's
        """Return the future of a task's result."""
        return self._threads.submit(self._do, task)

    def _do(self, task: Any) -> Any:  # noqa: ANN401 - task and result are the caller's
        """Return the result of one task, from the worker of this thread, or from another one if that dies."""
        from dh2urdf.isolation import PICKLED, ChildFailure, result_of, unmarked

        call = pickle.dumps((_work, (task,)))
        for _ in range(TRIES):
            worker = getattr(self._of_thread, "worker", None)
            if worker is None or not worker.is_alive():
                worker = self._of_thread.worker = self._started()
            answer = worker.ask(call, None, PICKLED)
            if answer.word in {"gone", "garbled"}:
                reason = _reason(worker)
                continue
            if not self._is_ending and (lines := unmarked(worker.output.text())):  # else it may print that it was ended
                # What C code and other programs printed during the task.
                if len(lines) > MOST_PRINTED:
                    lines = [f"[the last {MOST_PRINTED} lines of {worker.output.size:,} bytes]", *lines[-MOST_PRINTED:]]
                sys.stderr.write("".join(f"{self._whose} prints: {printable(line)}\n" for line in lines))
            if answer.word == "left":
                raise SystemExit(json.loads(answer.body)) from ChildFailure("", answer.text)
            return result_of(answer, PICKLED)
        return Lost(reason=reason)

    def _started(self) -> Child:
        """Start a worker that has the function of the run."""
        from concurrent.futures import CancelledError

        from dh2urdf.isolation import PICKLED, Child

        for _ in range(TRIES):
            with self._changing:
                if self._is_ending:
                    raise CancelledError
                try:
                    worker = Child("-X", "faulthandler")
                except OSError as error:
                    raise ExecutorError(say("workers-not-started", reason=error.strerror)) from error
                self._workers.append(worker)
            answer = worker.ask(self._begin, None, PICKLED)
            if answer.word == "value":
                return worker
            if answer.word == "not imported":
                reported = answer.body and PICKLED.unpack(answer.body)
                if isinstance(reported, PluginError):  # It says whose fault it is.
                    raise reported
                raise ExecutorError(say("worker-without-function", reason=answer.text))
            reason = _reason(worker)
        raise ExecutorError(say("workers-not-started", reason=reason))

    def end(self) -> None:
        """End all workers, at work or not, and wait until they are gone."""
        with self._changing:
            self._is_ending = True
        try:
            for worker in self._workers:
                worker.terminate()
            patience = time.monotonic() + _CLEARING_UP
            for worker in self._workers:
                worker.wait(patience - time.monotonic())
        finally:  # Also where a person presses Ctrl-C again.
            for worker in self._workers:
                worker.kill()
            self._threads.shutdown(cancel_futures=True)
            for worker in self._workers:
                worker.end()


def _reason(worker: Child) -> str:
    """How a worker that died came to its end, and what it printed before."""
    from dh2urdf.isolation import last_words

    worker.wait(_CLEARING_UP)
    status = worker.end()  # It is gone, unless what it sent was no answer.
    name = {number.value: number.name for number in signal.Signals}.get(-status, f"signal {-status}")
    if name in {"SIGKILL", "SIGTERM"}:
        end = f"the worker was killed ({name}), from outside or for want of memory"
    elif status < 0:
        end = f"the worker crashed ({name}, {(signal.strsignal(-status) or 'unknown').lower()})"
    else:
        end = f"the worker left with exit status {status}"
    if worker.who:
        end = f"{end} while {worker.who} was at work"
    words = last_words(worker.output.text(), _LAST_WORDS)
    return f"{end}; it printed last: {words}" if words else end


# --- In a worker

_FUNCTION: dict[str, Callable[[Any], Any]] = {}


def _begin(function: Callable[[Any], Any]) -> None:
    """Take the function of a run over."""
    claim()
    _FUNCTION["of the run"] = function


def _work(task: Any) -> Any:  # noqa: ANN401 - task and result are the caller's
    return _FUNCTION["of the run"](task)


EXECUTOR = Executor(
    name="local", summary="processes of this machine", options=LocalOptions, map=map_locally, capabilities=(Usual(),)
)
