"""Runs a function in a child process of its own, so that it may crash, hang or leave.

Simulators are C++ that trusts its input: a description with a duplicate joint name ends PyBullet with a segmentation
fault, others leave the interpreter. In a child process that is one manipulator's failure, told in a sentence, with
what the simulator printed before.

The child is a fresh interpreter, started as a plain subprocess: unlike a `multiprocessing` child it may be started by
a worker of a process pool, and needs no ``if __name__ == "__main__"`` in the user's script.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import subprocess
import sys
import threading
from dataclasses import dataclass, replace
from pathlib import Path
from types import NoneType
from typing import IO, TYPE_CHECKING, Any, Generic, TypeVar, TypeVarTuple, cast

from dh2urdf.errors import CrashError, LoaderError, TimeLimitError
from dh2urdf.plugin_system.at_work import MARK
from dh2urdf.plugin_system.child_place import ChildPlace
from dh2urdf.plugin_system.stage_answers import a_record, a_whole_record, whole_records
from dh2urdf.source import Problem, shown
from dh2urdf.stages import LoadReport

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from dh2urdf.stages import Loader, LoadRequest

T = TypeVar("T")
O = TypeVar("O")  # noqa: E741 - the options type of a stage
Args = TypeVarTuple("Args")

KEPT_OUTPUT = 64 * 1024
"""Bytes of the child's output that are kept, half from its beginning and half from its end."""

_SCRIPT = Path(__file__).with_name("_child.py")
_LEAVING = 5.0  # [s] to end after the outcome is known, and to empty a pipe after the end
_LAST_WORDS = 200  # characters of the output that a message repeats


@dataclass(frozen=True, slots=True)
class ChildResult(Generic[T]):
    """What came of a call in a child process.

    Attributes:
        value: what the function returned.
        output: what the child printed on standard output and standard error, from C too, in the order of printing.
    """

    value: T
    output: str


class ChildFailure(Exception):  # noqa: N818 - never raised: it is the cause of what is
    """The cause of an exception of `run_in_child`: what is known from the child.

    Attributes:
        output: what the child printed.
        traceback: the traceback in the child as text; empty where the function raised nothing.
    """

    def __init__(self, output: str, traceback: str = "") -> None:
        self.output, self.traceback = output, traceback
        super().__init__(output, traceback)

    def __str__(self) -> str:
        return "\n".join(
            part for part in (f"in the child process, which printed {self.output!r}", self.traceback) if part
        )


def run_in_child(
    function: Callable[[*Args], T], *args: *Args, timeout: float | None, who: str = "the simulator"
) -> ChildResult[T]:
    """Calls a function in a child process and waits for it.

    The child is gone, and all processes that it started are killed, when this returns or raises, also where it is
    interrupted.

    Args:
        function: a function of a module that can be imported by name.
        args: its arguments; they and the value must be picklable.
        timeout: how long it may take [s]; None where a person ends it, for example by closing a window.
        who: what messages call the function, where nobody is known to be at work in the child.

    Raises:
        TimeLimitError: the child did not finish in time.
        CrashError: the child crashed, left without a result, cannot be started, or cannot import the function.
        Exception: whatever the function raised, in its own type; as a `RuntimeError` that tells of it where that
            cannot be pickled. What the child printed is in its cause, a `ChildFailure`.
    """
    kind: type[CrashError] = CrashError
    child = _Child(_pickled_call(function, args, who))
    try:
        outcome = child.outcome(timeout)
    finally:
        status = child.end()
    output, who = child.output.text(), child.who or who
    match outcome:
        case ("value", value):
            return ChildResult(pickle.loads(value), output)  # noqa: S301 - our own child sent it
        case ("raised", bytes(error), _, traceback):
            raise pickle.loads(error) from ChildFailure(output, traceback)  # noqa: S301 - our own child sent it
        case ("raised", _, text, traceback):
            raise RuntimeError(text) from ChildFailure(output, traceback)
        case ("not imported", reason):
            message = f"a child process cannot import {function.__module__}.{function.__qualname__}: {reason}"
        case ("left", code):
            message = f"{who} left the interpreter (exit status {code}) and gave no result"
        case ("late",):
            kind = TimeLimitError
            message = f"{who} did not finish within {timeout:g} s"
        case _ if status < 0:
            message = f"{who} crashed ({(signal.strsignal(-status) or f'signal {-status}').lower()})"
        case _:
            message = f"{who} left the process (exit status {status}) and gave no result"
    raise kind(message + _last_words(output)) from ChildFailure(output)


def load_in_child(loader: Loader[O], request: LoadRequest, options: O, who: str | None = None) -> LoadReport:
    """Calls a loader in a child process and completes its report with what the simulator printed.

    Args:
        loader: the loader.
        request: what it is asked to load.
        options: its options.
        who: what messages call it, such as ``the loader 'toy' of lab 1.0``.

    Raises:
        CrashError: as `run_in_child`.
        LoaderError: whatever the loader refuses; the findings in the output follow it.
        MissingDependencyError: the simulator is not installed.
    """
    # The folder of a file in the making has another name in every run.
    folder = f"{request.path.parent}{os.sep}"

    def plain(problems: Iterable[Problem], simulator: str = "") -> tuple[Problem, ...]:
        """The problems without the folder, each with the name of the simulator in its message."""
        told = (replace(problem, message=problem.message.replace(folder, "")) for problem in problems)
        return tuple(_named(problem, simulator or loader.name, loader.name) for problem in told)

    try:
        limit = a_record(loader.time_limit(options), int, float, NoneType)
        child = run_in_child(loader.load, request, options, timeout=limit, who=who or f"the loader {loader.name!r}")
    except (LoaderError, CrashError) as error:
        output = error.__cause__.output if isinstance(error.__cause__, ChildFailure) else ""
        said = whole_records(loader.read_output(request, output), Problem)
        raise type(error)(plain((*error.problems, *said))) from error
    report = a_whole_record(child.value, LoadReport)
    said = whole_records(loader.read_output(request, child.output), Problem)
    findings = plain((*report.findings, *said), report.simulator)
    return replace(report, findings=findings, output=child.output.replace(folder, ""))


def _named(problem: Problem, *names: str) -> Problem:
    """A problem whose message has one of these names; where it has none, the first is put before it."""
    if any(name.casefold() in problem.message.casefold() for name in names if name):
        return problem
    return replace(problem, message=f"{names[0]}: {problem.message}")


def _pickled_call(function: Callable[..., Any], args: tuple[Any, ...], who: str) -> bytes:
    """The function, by its name, and its arguments."""
    if getattr(function, "__module__", None) == "__main__":
        raise CrashError(
            f"{function.__qualname__} stands in the script that is run, where a child process cannot import it",
        )
    try:
        return pickle.dumps((function, args))
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        name = getattr(function, "__qualname__", repr(function))
        message = f"{who}: {name} and its arguments cannot be sent to a child process: {error}"
        raise CrashError(message) from error


def _last_words(output: str) -> str:
    """The end of the output, as the end of a message."""
    words = " ".join(output.replace(MARK, "").split())
    if len(words) > _LAST_WORDS:
        words = f"…{words[1 - _LAST_WORDS :]}"
    return f"; it printed last: {shown(words, _LAST_WORDS)}" if words else ""


class _Child:
    """A running child process.

    One thread sends the call and waits for the outcome, one takes the output: neither side ever waits for a full pipe.
    """

    def __init__(self, call: bytes) -> None:
        self._place = ChildPlace()
        self.who = ""
        try:
            self._process = subprocess.Popen(  # noqa: S603 - our own script
                [sys.executable, "-P", str(_SCRIPT)],  # -P: the folder of this package is not a folder of modules
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                start_new_session=True,  # A process group of its own, to end it with all that it started.
                **self._place.for_child(),
            )
        except OSError as error:
            self._place.close()
            raise CrashError(f"a child process cannot be started: {error}") from error
        self._call = cast("IO[bytes]", self._process.stdin)
        self._outcome = cast("IO[bytes]", self._process.stdout)
        self._printed = cast("IO[bytes]", self._process.stderr)
        self.output = _BoundedOutput()
        self._received: list[tuple[Any, ...]] = []
        self._talk = threading.Thread(target=self._exchange, args=(call,), daemon=True)
        self._listen = threading.Thread(target=self._take_output, daemon=True)
        self._talk.start()
        self._listen.start()

    def outcome(self, timeout: float | None) -> tuple[Any, ...]:
        """What the child sent: a word and its data; empty where it ended without, ``late`` where time is over."""
        self._talk.join(timeout)
        if self._talk.is_alive():
            return ("late",)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(_LEAVING)
        return self._received[0] if self._received else ()

    def end(self) -> int:
        """Ends the child and all that it started; its exit status, negative for a signal."""
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError, PermissionError):  # gone, or (macOS) a zombie
                os.killpg(self._process.pid, signal.SIGKILL)
        else:
            self._process.kill()
        status = self._process.wait()
        self.who = self._place.who()
        self._place.close()
        for thread, streams in (
            (self._talk, (self._call, self._outcome)),
            (self._listen, (self._printed,)),
        ):
            thread.join(_LEAVING)
            if not thread.is_alive():  # A process that left the group may still hold the other end.
                for stream in streams:
                    with contextlib.suppress(OSError):
                        stream.close()
        return status

    def _exchange(self, call: bytes) -> None:
        with contextlib.suppress(OSError, EOFError, pickle.UnpicklingError):  # The child ended before, or in between.
            pickle.dump((sys.path, call), self._call)
            self._call.flush()  # It stays open: its end tells the child that the parent is gone.
            self._received.append(pickle.load(self._outcome))  # noqa: S301 - our own child sent it

    def _take_output(self) -> None:
        while chunk := os.read(self._printed.fileno(), KEPT_OUTPUT):
            self.output.add(chunk)


class _BoundedOutput:
    """The beginning and the end of an output of any length."""

    def __init__(self) -> None:
        self._head, self._tail, self._left_out = b"", b"", 0

    def add(self, chunk: bytes) -> None:
        half = KEPT_OUTPUT // 2
        room = half - len(self._head)
        self._head += chunk[:room]
        tail = self._tail + chunk[room:]
        self._left_out += max(0, len(tail) - half)
        self._tail = tail[-half:]

    def text(self) -> str:
        gap = b"\n[%d bytes left out]\n" % self._left_out if self._left_out else b""
        return (self._head + gap + self._tail).decode("utf-8", "replace")
