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
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass, field
from itertools import chain, islice
from operator import length_hint
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Literal, cast

from dh2urdf.errors import ExecutorError, PluginError
from dh2urdf.isolation import ChildFailure
from dh2urdf.plugin_system import MARK, ChildPlace, handed_over, unmarked
from dh2urdf.source import Problem, printable, shown
from dh2urdf.stages import Executor, Lost

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from concurrent.futures import Future

AHEAD = 4
"""Tasks per process that wait or are under way, so that the tasks of a long run are never all held."""
TRIES = 2
"""Workers that a task may cost before it is lost: the first may have been killed for the sake of others."""
MOST_LINES = 100
"""Lines of what C code and other programs print during a task that are passed on."""

_SCRIPT = Path(__file__).with_name("local_worker.py")
_CLEARING_UP = 0.6  # [s] for workers to take away what they were writing
_KEPT = 64 * 1024  # bytes of what a worker printed that are looked at
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
        return self._threads.submit(self._do, task)

    def _do(self, task: Any) -> Any:  # noqa: ANN401 - a task and its result are the caller's
        """The result of one task, from one worker, or from another one where that dies; in a thread."""
        data = pickle.dumps(task)
        for tried in range(TRIES):
            worker = self._take(fresh=tried > 0)
            answer = worker.ask(data)
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
                worker.close()


def _result(answer: tuple[Any, ...]) -> Any:  # noqa: ANN401 - the result of the caller's function
    match answer:
        case ("value", value):
            return pickle.loads(value)  # noqa: S301 - our own worker sent it
        case ("raised", error, traceback):
            raise pickle.loads(error) from ChildFailure("", traceback)  # noqa: S301 - our own worker sent it
        case _:
            with contextlib.suppress(ImportError, AttributeError):  # of what the worker could not import either
                error = pickle.loads(answer[2])  # noqa: S301 - our own worker sent it
                if isinstance(error, PluginError):  # It says whose fault it is.
                    raise error
            raise ExecutorError(
                Problem(
                    message=f"a worker process cannot take the work over: {answer[1]}",
                    suggestion="stages have to be in importable modules, not in a script; `--workers 1` takes any",
                )
            )


class _Worker:
    """A worker process, in a session of its own, with all that it starts: Ctrl-C in a terminal reaches none of them."""

    def __init__(self, function: bytes) -> None:
        self._place = ChildPlace()
        try:
            self._printed = tempfile.TemporaryFile("a+b", buffering=0)  # noqa: SIM115 - closed where it is read
            self._process = subprocess.Popen(  # noqa: S603 - our own script
                [sys.executable, "-X", "faulthandler", "-P", str(_SCRIPT)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=self._printed,
                start_new_session=True,
                **self._place.for_child(),
            )
        except OSError as error:
            raise ExecutorError(
                Problem(
                    message=f"worker processes cannot be started: {error.strerror}",
                    suggestion="`--workers 1` needs none",
                )
            ) from error
        self._messages = cast("IO[bytes]", self._process.stdin)
        self._answers = cast("IO[bytes]", self._process.stdout)
        self._first: Any = (sys.path, function)
        self.is_ready = False
        self._watch = threading.Thread(target=self._clear_after, daemon=True)
        self._watch.start()

    def _clear_after(self) -> None:
        """Ends what the worker started, as soon as it has ended: that may hold the pipe of its answers open."""
        self._process.wait()
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError, PermissionError):  # nothing is left, or (macOS) a zombie
                os.killpg(self._process.pid, signal.SIGKILL)

    def ask(self, task: bytes) -> tuple[Any, ...]:
        """The worker's answer to a task; empty where it died before."""
        try:
            self._printed.seek(0)  # The worker writes at the same place.
            self._printed.truncate()
            if not self.is_ready:
                answer = self._exchange(self._first)
                if answer != ("ready",):
                    return answer
                self.is_ready = True
            return self._exchange(task)
        except (EOFError, OSError, pickle.UnpicklingError):
            return ()

    def _exchange(self, message: Any) -> tuple[Any, ...]:  # noqa: ANN401 - what is sent
        pickle.dump(message, self._messages)
        self._messages.flush()
        return cast("tuple[Any, ...]", pickle.load(self._answers))  # noqa: S301 - our own worker sent it

    def pass_on(self, whose: str) -> None:
        """Prints on standard error what C code and other programs printed during the task.

        Args:
            whose: the distributions that may have printed it.
        """
        if (size := os.fstat(self._printed.fileno()).st_size) > 0:
            lines = unmarked(self._text())
            if size > _KEPT or len(lines) > MOST_LINES:
                lines = [f"[the last {MOST_LINES} lines of {size:,} bytes]", *lines[-MOST_LINES:]]
            name = f"a stage of {whose}" if whose else "a worker"
            sys.stderr.write("".join(f"{name} prints: {printable(line)}\n" for line in lines))

    def _text(self) -> str:
        """The end of what it printed."""
        self._printed.seek(max(0, self._printed.seek(0, os.SEEK_END) - _KEPT))
        return self._printed.read().decode("utf-8", "replace")

    def is_alive(self) -> bool:
        """Whether it can be given a task."""
        return self._process.poll() is None

    def reason(self) -> str:
        """How a worker that died came to its end, and what it printed before."""
        self._watch.join(_CLEARING_UP)
        self.kill()  # It is gone, unless what it sent was no answer.
        self._watch.join()
        status = self._process.returncode
        name = {number.value: number.name for number in signal.Signals}.get(-status, f"signal {-status}")
        if name in {"SIGKILL", "SIGTERM"}:
            end = f"the worker was killed ({name}), from outside or for want of memory"
        elif status < 0:
            end = f"the worker crashed ({name}, {(signal.strsignal(-status) or 'unknown').lower()})"
        else:
            end = f"the worker left with exit status {status}"
        if who := self._place.who():
            end = f"{end} while {who} was at work"
        words = self._last_words()
        self.close()
        return f"{end}; it printed last: {shown(words, _LAST_WORDS)}" if words else end

    def _last_words(self) -> str:
        """The end of what it printed; of what faulthandler says, where the thread was that failed, or the main one."""
        printed = self._text().replace(MARK, "").rstrip() + "\n"
        *_, fault = None, *_FAULT.finditer(printed)
        if fault:
            stacks = list(_STACK.finditer(printed, fault.end()))
            failed = [stack[2] for stack in stacks if stack[1]] or [stack[2] for stack in stacks[-1:]]
            printed = " ".join([fault[0], *failed])[: 2 * _LAST_WORDS]
        else:
            printed = printed[-_LAST_WORDS:]
        return " ".join(printed.split())

    def terminate(self) -> None:
        """Asks it to end: what it was writing is taken away."""
        self._process.terminate()

    def wait(self, seconds: float) -> None:
        """Waits until it has ended, for so long at most."""
        self._watch.join(max(0.0, seconds))

    def kill(self) -> None:
        """Ends it, whatever it does."""
        self._process.kill()

    def close(self) -> None:
        """Closes the pipes and the file of a worker that is gone."""
        for stream in (self._messages, self._answers, self._printed, self._place):
            with contextlib.suppress(OSError):
                stream.close()


EXECUTOR = Executor(
    name="local",
    is_usual=True,
    summary="processes of this machine",
    options=LocalOptions,
    map=map_locally,
)
