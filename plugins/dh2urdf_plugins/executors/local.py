"""The executor `local`: processes of this machine.

Every worker process has a thread here that hands it one task at a time, so it is known which task a worker was at when
it died. A pool of `concurrent.futures` does not know that, and breaks as a whole.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import re
import signal
import sys
import threading
import time
from dataclasses import field
from itertools import chain, islice
from operator import length_hint
from typing import TYPE_CHECKING, Any, Literal

from dh2urdf.errors import ExecutorError, PluginError
from dh2urdf.isolation import claim
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.plugin_system import MARK, unmarked
from dh2urdf.source import Problem, printable, shown
from dh2urdf.stages import Executor, Lost

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from concurrent.futures import Future

MOST_PRINTED = 100
"""Lines of what C code and other programs print during a task that are passed on."""
AHEAD = 4
"""Tasks per process that wait or are under way, so that the tasks of a long run are never all held."""
TRIES = 2
"""Workers that a task may cost before it is lost: the first may have been killed for the sake of others."""

_CLEARING_UP = 0.6  # [s] for workers to take away what they were writing
_LAST_WORDS = 300  # characters of what a worker printed that a reason repeats
_FAULT = re.compile(r"^(?:Fatal Python error: |Timeout \().*", re.MULTILINE)  # how the words of faulthandler begin
_STACK = re.compile(r"^(?:(Current thread)|Thread) .*\n((?:  File .*\n)+)", re.MULTILINE)


@dataclass(frozen=True, slots=True, kw_only=True)
class LocalOptions:
    """How many processes work."""

    workers: Literal["auto"] | int = field(
        default="auto",
        metadata={"help": "processes; 1 works in the process itself, which a crash ends; auto takes one per processor"},
    )

    def __post_init__(self) -> None:
        if self.workers != "auto" and self.workers < 1:
            raise ValueError("workers is a number from 1 on, or auto")


def map_locally(function: Callable[[Any], Any], tasks: Iterable[Any], options: LocalOptions) -> Iterator[Any]:
    """Results of a function over tasks, in their order, from processes of this machine.

    One task needs no other process: it is done in this one, and so are all where one worker is asked for. A task that
    is a collection of several things is worth a process of its own, which may crash, on one processor too.

    Raises:
        ExecutorError: no worker process can be started, or none can import the function.
    """
    workers = processors() if options.workers == "auto" else options.workers
    waiting = iter(tasks)
    first = list(islice(waiting, 2))
    if options.workers == 1 or sum(length_hint(task, 1) for task in first) <= 1:
        yield from map(function, first)
        yield from map(function, waiting)
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
    """Worker processes, and a thread for each that waits for its results."""

    def __init__(self, function: Callable[[Any], Any], workers: int) -> None:
        from concurrent.futures import ThreadPoolExecutor

        self._function = pickle.dumps(function)
        self._whose = " or ".join(name for name in getattr(function, "distributions", ()) if name != "dh2urdf")
        self._threads = ThreadPoolExecutor(workers)
        self._workers: list[_Worker] = []
        self._idle: list[_Worker] = []
        self._changing = threading.Lock()
        self._is_ending = False

    def submit(self, task: Any) -> Future[Any]:  # noqa: ANN401 - a task is the caller's
        """The result to come of a task."""
        from concurrent.futures import Future

        try:
            data = pickle.dumps((task,))  # here, where no worker waits for it
        except Exception as error:  # noqa: BLE001 - what a task that cannot be pickled raises, in its turn
            failed: Future[Any] = Future()
            failed.set_exception(error)
            return failed
        return self._threads.submit(self._do, data)

    def _do(self, task: bytes) -> Any:  # noqa: ANN401 - its result is the caller's
        """The result of one task, from one worker, or from another one where that dies; in a thread."""
        for tried in range(TRIES):
            worker = self._take(fresh=tried > 0)
            answer = worker.ask(task)
            if answer:
                if not self._is_ending:  # else it may print that it was ended
                    worker.pass_on(self._whose)
                self._idle.append(worker)
                return _result(answer)
            reason = worker.reason()
            self._workers.remove(worker)
        if not worker.is_ready:
            raise ExecutorError(
                Problem(message=f"worker processes cannot begin: {reason}", suggestion="`--workers 1` needs none")
            )
        return Lost(reason=reason)

    def _take(self, *, fresh: bool) -> _Worker:
        """A worker that has nothing to do, or a new one; there are never more than threads."""
        from concurrent.futures import CancelledError

        with self._changing:
            if self._is_ending:
                raise CancelledError
            while self._idle and not fresh:
                worker = self._idle.pop()
                if worker.is_alive():
                    return worker
                worker.end()
                self._workers.remove(worker)
            worker = _Worker(self._function)
            self._workers.append(worker)
            return worker

    def end(self) -> None:
        """Ends all workers, at work or not, and waits until they are gone."""
        with self._changing:
            self._is_ending = True
            workers = list(self._workers)  # Threads still take off the list what dies.
        try:
            for worker in workers:
                worker.terminate()
            patience = time.monotonic() + _CLEARING_UP
            for worker in workers:
                worker.wait(patience - time.monotonic())
        finally:  # Also where a person presses Ctrl-C again.
            for worker in workers:
                worker.kill()
            self._threads.shutdown(cancel_futures=True)
            for worker in workers:
                worker.end()


def _result(answer: tuple[Any, ...]) -> Any:  # noqa: ANN401 - the result of the caller's function
    from dh2urdf.isolation import PICKLED, ChildFailure, result_of

    match answer:
        case ("not imported", why, error):
            with contextlib.suppress(ImportError, AttributeError, TypeError):  # what cannot be had here either
                raised = error and PICKLED.unpack_error(error)
                if isinstance(raised, PluginError):  # It says whose fault it is.
                    raise raised
            raise ExecutorError(
                Problem(
                    message=f"a worker process cannot take the work over: {why}",
                    suggestion="stages have to be in importable modules, not in a script; `--workers 1` takes any",
                )
            )
        case ("left", code, traceback):
            raise SystemExit(code) from ChildFailure("", traceback)
        case _:
            return result_of(answer, PICKLED)


class _Worker:
    """An interpreter that works for this one: it calls the function of the run with one task after the other."""

    def __init__(self, function: bytes) -> None:
        from dh2urdf.isolation import Interpreter

        try:
            self._interpreter = Interpreter(("-X", "faulthandler"))
        except OSError as error:
            raise ExecutorError(
                Problem(
                    message=f"worker processes cannot be started: {error.strerror}",
                    suggestion="`--workers 1` needs none",
                )
            ) from error
        self._function = function
        self.is_ready = False
        self.is_alive, self.terminate = self._interpreter.is_alive, self._interpreter.terminate
        self.wait, self.kill, self.end = self._interpreter.wait, self._interpreter.kill, self._interpreter.end

    def ask(self, task: bytes) -> tuple[Any, ...]:
        """The worker's answer to a task; empty where it died before."""
        if not self.is_ready:
            from dh2urdf.isolation import PICKLED

            tasks = pickle.dumps(PICKLED)
            for function, args in ((pickle.dumps(claim), pickle.dumps(())), (self._function, None)):
                answer = self._interpreter.call(tasks, function, args, None)
                if answer[:1] not in {("value",), ("imported",)}:
                    return answer
            self.is_ready = True
        answer = self._interpreter.call(None, None, task, None)
        return () if answer[:1] == ("garbled",) else answer

    def pass_on(self, whose: str) -> None:
        """Prints on standard error what C code and other programs printed during the task.

        Args:
            whose: the distributions that may have printed it.
        """
        output = self._interpreter.output
        if output.size > 0:
            lines = unmarked(output.last())
            if output.is_cut or len(lines) > MOST_PRINTED:
                lines = [f"[the last {MOST_PRINTED} lines of {output.size:,} bytes]", *lines[-MOST_PRINTED:]]
            name = f"a stage of {whose}" if whose else "a worker"
            sys.stderr.write("".join(f"{name} prints: {printable(line)}\n" for line in lines))

    def reason(self) -> str:
        """How a worker that died came to its end, and what it printed before."""
        self.wait(_CLEARING_UP)
        status = self.end()  # It is gone, unless what it sent was no answer.
        name = {number.value: number.name for number in signal.Signals}.get(-status, f"signal {-status}")
        if name in {"SIGKILL", "SIGTERM"}:
            end = f"the worker was killed ({name}), from outside or for want of memory"
        elif status < 0:
            end = f"the worker crashed ({name}, {(signal.strsignal(-status) or 'unknown').lower()})"
        else:
            end = f"the worker left with exit status {status}"
        if who := self._interpreter.who:
            end = f"{end} while {who} was at work"
        words = self._last_words()
        return f"{end}; it printed last: {shown(words, _LAST_WORDS)}" if words else end

    def _last_words(self) -> str:
        """The end of what it printed; of what faulthandler says, where the thread was that failed, or the main one."""
        printed = self._interpreter.output.last().replace(MARK, "").rstrip() + "\n"
        *_, fault = None, *_FAULT.finditer(printed)
        if fault:
            stacks = list(_STACK.finditer(printed, fault.end()))
            failed = [stack[2] for stack in stacks if stack[1]] or [stack[2] for stack in stacks[-1:]]
            printed = " ".join([fault[0], *failed])[: 2 * _LAST_WORDS]
        else:
            printed = printed[-_LAST_WORDS:]
        return " ".join(printed.split())


EXECUTOR = Executor(
    name="local",
    is_usual=True,
    summary="processes of this machine",
    options=LocalOptions,
    map=map_locally,
)
