"""Child processes: functions that may crash, hang or leave, in an interpreter of their own.

Simulators are C++ that trusts its input: a description with a duplicate joint name ends PyBullet with a segmentation
fault, others leave the interpreter. In a child process, that costs one manipulator, and the message says how the child
ended and what it printed before.

A `Child` is a plain subprocess: unlike one of `multiprocessing` it may be started by a worker of a process pool, and
needs no ``if __name__ == "__main__"`` in the user's script. It serves a single call (`run_in_child`), several callers
one after the other (`dh2urdf.isolation.kept_children`), or the tasks of a worker (the executor `local`).
"""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import re
import select
import signal
import struct
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Generic, NamedTuple, TypeVar, TypeVarTuple, cast

from dh2urdf.errors import CrashError, TimeLimitError
from dh2urdf.isolation.attribution import MARK, NAME_SIZE
from dh2urdf.isolation.encodings import AnswerError, Data, Pickled
from dh2urdf.source import Messages, shown

say = Messages(__file__)

if sys.platform == "linux":
    from fcntl import F_SETPIPE_SZ, fcntl

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping
    from typing import Self

T = TypeVar("T")
Args = TypeVarTuple("Args")

KEPT_OUTPUT = 64 * 1024
"""Bytes of the output of a call that are kept, half from its beginning and half from its end."""
LARGEST_ANSWER = 2**30
"""Bytes of an answer, at most."""
PLAIN: Data[Any] = Data()
"""The encoding of plain values: numbers, texts, lists and mappings of them."""

_CHUNK = 2**20  # bytes that are read or written at a time: the most that a pipe of any user holds on Linux
_GLANCE = 0.1  # [s] between looks whether the child has ended
_LEAVING = 5.0  # [s] for a child that has closed the pipe of its answers to end
_HEAD = struct.Struct(">cII")  # the first letter of a word, and the bytes of its text and of its body
_WORDS = {word[:1].encode(): word for word in ("value", "raised", "not imported", "left")}
_SCRIPT = Path(__file__).with_name("_child.py")
_FAULT = re.compile(r"^(?:Fatal Python error: |Timeout \().*", re.MULTILINE)  # how the words of faulthandler begin


@dataclass(frozen=True, slots=True)
class ChildResult(Generic[T]):
    """What a function in a child returned, and what was printed meanwhile, from C too, in the order of printing."""

    value: T
    output: str


class ChildFailure(Exception):  # noqa: N818 - never raised: it is the cause of what is
    """The cause of an exception of `run_in_child`: what the child printed, and its traceback as text.

    The traceback is empty where the function raised nothing.
    """

    def __init__(self, output: str, traceback: str = "") -> None:
        self.output, self.traceback = output, traceback
        super().__init__(output, traceback)

    def __str__(self) -> str:
        return f"in the child process, which printed {self.output!r}\n{self.traceback}".rstrip("\n")


class Answer(NamedTuple):
    """What a child sent after a call, or why it sent nothing.

    Attributes:
        word: ``value``, ``raised``, ``not imported`` (the function), ``left`` (the interpreter); or ``gone`` (the child
            ended), ``late``, ``garbled`` (what it sent is no answer), after which it is to be ended.
        text: the traceback of what was raised, or a reason.
        body: the value or the exception in the encoding of the call.
    """

    word: str
    text: str = ""
    body: bytes = b""


def run_in_child(
    function: Callable[[*Args], T],
    *args: *Args,
    timeout: float | None,
    who: str = "the simulator",
    encoding: Data[Any] | Pickled[Any] = PLAIN,
) -> ChildResult[T]:
    """Call a function in a child process and wait for it.

    The child is gone, and all processes that it started are killed, when this returns or raises, also where it is
    interrupted.

    Args:
        function: a function of a module that can be imported by name.
        args: its arguments, which must be picklable.
        timeout: how long it may take [s]; None where a person ends it, for example by closing a window.
        who: what messages call the function, where nobody is known to be at work in the child.
        encoding: how the child sends what the function returns or raises: `Data` of its type.

    Raises:
        TimeLimitError: the child did not finish in time.
        CrashError: the child crashed, left without a result, cannot be started, cannot import the function, or sent
            what is no answer.
        Exception: whatever the function raised, in its own type where that is one of Python's or of `dh2urdf.errors`,
            else as a `RuntimeError` that describes it. What the child printed is in its cause, a `ChildFailure`.
    """
    with Child.started() as child:
        return child.call(function, args, timeout, who, encoding)


class Child:
    """An interpreter in a session of its own, which answers calls one after the other.

    Ctrl-C in a terminal reaches neither it nor what it starts. All of these end when this process is gone, however it
    went.

    Args:
        flags: options of Python, such as ``-X faulthandler``.
        environment: variables that it has besides those of this process.

    Attributes:
        output: what was printed since the last call began.
        prepared: what was returned when it was prepared, in a tuple; see `dh2urdf.isolation.kept_children`.
        printed_before: what belongs before the output of each call, such as that of an import.
        who: who was at work when it ended, with distribution and version; empty before, and where nobody was.

    Raises:
        OSError: it cannot be started.
    """

    def __init__(self, *flags: str, environment: Mapping[str, str] | None = None) -> None:
        import tempfile

        self._name, self.who = tempfile.TemporaryFile(buffering=0), ""  # noqa: SIM115 - open until `end`
        self.output, self.printed_before = Output(), ""
        self.prepared: Any = None
        self._name.write(bytes(NAME_SIZE))  # where the child writes which stage runs: it outlives the child
        number = self._name.fileno()
        try:
            self._process = subprocess.Popen(  # noqa: S603 - our own script
                # -P: the folder of this package has no modules.
                [sys.executable, *flags, "-P", str(_SCRIPT), str(number)],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                start_new_session=True,  # A process group of its own, to end it with all that it started.
                bufsize=0,
                pass_fds=(number,),
                env={**os.environ, **(environment or {})},
            )
        except BaseException:
            self._name.close()
            raise
        self._calls, self._answers, self._printed = (
            cast("IO[bytes]", pipe) for pipe in (self._process.stdin, self._process.stdout, self._process.stderr)
        )
        for pipe in (self._calls, self._answers, self._printed):
            os.set_blocking(pipe.fileno(), False)
            if sys.platform == "linux" and pipe is not self._printed:
                with contextlib.suppress(OSError):  # This user has many pipes already.
                    fcntl(pipe, F_SETPIPE_SZ, _CHUNK)  # Whenever a pipe is full, one side waits for the other.
        self._unsent = pickle.dumps(sys.path)
        self._is_reusable = True

    @classmethod
    def started(cls) -> Self:
        """Start a child.

        Raises:
            CrashError: it cannot be started.
        """
        try:
            return cls()
        except OSError as error:
            raise CrashError(say("child-not-started", reason=error)) from error

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.end()

    def call(
        self,
        function: Callable[..., T],
        args: tuple[Any, ...],
        timeout: float | None,
        who: str,
        encoding: Data[Any] | Pickled[Any] = PLAIN,
        *,
        in_fork: bool = False,
        spent: float = 0.0,
    ) -> ChildResult[T]:
        """Call a function in the child, which is ended if it gives no answer; errors are those of `run_in_child`.

        Args:
            function: the function.
            args: its arguments.
            timeout: how long it may take [s], of which some is `spent` already.
            who: what messages call the function.
            encoding: how the child answers.
            in_fork: whether the child makes the call in a fork of itself, so that no other call meets what it leaves.
            spent: a part of the timeout [s].
        """
        left = None if timeout is None else max(0.0, timeout - spent)
        answer = self.ask(pickled_call(function, args, who), left, encoding, in_fork=in_fork)
        output = self.printed_before + self.output.text()
        try:
            if answer.word in {"value", "raised"}:
                return ChildResult(result_of(answer, encoding, output), output)
        except AnswerError as error:
            answer = Answer("garbled", str(error))
        status = self.end()
        output = self.printed_before + self.output.text()
        who = self.who or who
        kind: type[CrashError] = CrashError
        about: dict[str, Any] = {"who": who, "reason": answer.text}
        match answer.word:
            case "not imported":
                code, about["who"] = "child-without-function", f"{function.__module__}.{function.__qualname__}"
            case "left":
                code, about["status"] = "child-left", json.loads(answer.body)
            case "garbled":
                code = "child-answer-unusable"
            case "late":
                kind, code, about["seconds"] = TimeLimitError, "child-late", timeout
            case _ if status < 0:
                code = "child-crashed"
                about["signal"] = (signal.strsignal(-status) or f"signal {-status}").lower()
            case _:
                code, about["status"] = "child-left", status
        words = last_words(output)
        printed = f"; it printed last: {words}" if words else ""
        raise kind(say(code, printed=printed, **about)) from ChildFailure(output)

    def ask(
        self, call: bytes, timeout: float | None, encoding: Data[Any] | Pickled[Any], *, in_fork: bool = False
    ) -> Answer:
        """Return the child's answer to a call, a pickled pair of a function and its arguments; see `call`."""
        try:
            self._take_output()  # What came between two calls belongs to neither.
            self.output = Output()
            message, self._unsent = self._unsent + pickle.dumps((in_fork, pickle.dumps(encoding), call)), b""
            return self._exchange(memoryview(message), timeout)
        except BaseException:
            self.end()
            raise

    def _exchange(self, unsent: memoryview, timeout: float | None) -> Answer:  # noqa: C901 - three pipes at a time
        """Send a message, take what is printed, and wait for an answer."""
        received, is_closed = bytearray(), False
        end = None if timeout is None else time.monotonic() + timeout
        poll = select.poll()
        poll.register(self._calls, select.POLLOUT)
        poll.register(self._answers, select.POLLIN)
        poll.register(self._printed, select.POLLIN)
        while True:
            has_ended = self._process.poll() is not None
            if has_ended:
                self._kill_group()  # A fork may hold the pipes open.
            left = _GLANCE if end is None else max(0.0, min(_GLANCE, end - time.monotonic()))
            ready = [number for number, _ in poll.poll(1000 * left)]
            if self._calls.fileno() in ready:
                try:
                    unsent = unsent[os.write(self._calls.fileno(), unsent[:_CHUNK]) :]
                except BrokenPipeError:
                    unsent = unsent[:0]
                if not unsent:
                    poll.unregister(self._calls)
            if self._printed.fileno() in ready and not self._take_output():
                poll.unregister(self._printed)
            if self._answers.fileno() in ready:
                chunk = os.read(self._answers.fileno(), _CHUNK)
                received += chunk
                is_closed = not chunk
                if answer := self._answer_in(received, is_closed=is_closed):
                    self._take_output()  # All that was printed before the answer is in the pipe by now.
                    return answer
            if is_closed or (has_ended and not ready):
                self.wait(_LEAVING)
                self._take_output()
                return Answer("gone")
            if end is not None and time.monotonic() >= end:
                return Answer("late")

    def _answer_in(self, received: bytearray, *, is_closed: bool) -> Answer | None:
        """Return the answer that was received, as `dh2urdf.isolation._child` sends it; None where some is missing."""
        if len(received) < _HEAD.size:
            return None
        letter, text, body = _HEAD.unpack_from(received)
        if letter not in _WORDS or text + body > LARGEST_ANSWER:
            return Answer("garbled", f"it has {text + body} bytes, more than {LARGEST_ANSWER}, or is of no known kind")
        begin, size = _HEAD.size + text, _HEAD.size + text + body
        if len(received) < size or (len(received) == size and not is_closed):
            return None
        self._is_reusable = received[size:] == b"+"
        told = received[_HEAD.size : begin].decode(errors="replace")
        return Answer(_WORDS[letter], told, bytes(received[begin:size]))

    def _take_output(self) -> bool:
        """Take what was printed, of which a pipe holds little; whether more can come."""
        try:
            chunk = os.read(self._printed.fileno(), _CHUNK)
        except BlockingIOError:
            return True
        self.output.add(chunk)
        return bool(chunk)

    def is_alive(self) -> bool:
        """Whether it can be called."""
        return self._is_reusable and self._process.poll() is None

    def terminate(self) -> None:
        """Ask it to end: a call under way takes away what it was writing."""
        self._process.terminate()

    def wait(self, seconds: float) -> None:
        """Wait until it has ended, for so long at most."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(max(0.0, seconds))

    def kill(self) -> None:
        """Kill it and all that it started, whatever they do."""
        self._process.kill()
        self._process.wait()
        self._kill_group()

    def end(self) -> int:
        """Kill it, with all that it started, and give everything back; its exit status, negative for a signal."""
        self.kill()
        if not self._printed.closed:
            self._take_output()
            self.who = os.pread(self._name.fileno(), NAME_SIZE, 0).partition(b"\0")[0].decode(errors="replace")
            for each in (self._calls, self._answers, self._printed, self._name):
                each.close()
        return self._process.returncode

    def _kill_group(self) -> None:
        with contextlib.suppress(ProcessLookupError, PermissionError):  # nothing is left, or (macOS) a zombie
            os.killpg(self._process.pid, signal.SIGKILL)


def pickled_call(function: Callable[..., Any], args: tuple[Any, ...], who: str) -> bytes:
    """Return a function, by its name, and its arguments.

    Raises:
        CrashError: no child can have them.
    """
    name = getattr(function, "__qualname__", repr(function))
    if getattr(function, "__module__", None) == "__main__":
        raise CrashError(say("function-of-script", name=name))
    try:
        return pickle.dumps((function, args))
    except (pickle.PicklingError, AttributeError, TypeError) as error:
        raise CrashError(say("call-unsendable", who=who, name=name, reason=error)) from error


def result_of(answer: Answer, encoding: Data[Any] | Pickled[Any], output: str = "") -> Any:  # noqa: ANN401 - what the function returned
    """Return what a call in a child returned, or raise what it raised, as `run_in_child` does.

    Raises:
        AnswerError: it sent something else.
    """
    if answer.word == "value":
        return encoding.unpack(answer.body)
    raise encoding.unpack_error(answer.body) from ChildFailure(output, answer.text)


class Output:
    """The beginning and the end of what was printed, of any length, and the size of all of it [B]."""

    def __init__(self) -> None:
        self.size, self._kept = 0, bytearray()

    def add(self, data: bytes) -> None:
        """Take what was printed."""
        self.size += len(data)
        self._kept += data
        del self._kept[KEPT_OUTPUT // 2 : -KEPT_OUTPUT // 2]

    def text(self) -> str:
        """Return all of it, or its beginning, how much is left out, and its end."""
        gap, half = self.size - len(self._kept), KEPT_OUTPUT // 2
        kept = self._kept[:half] + b"\n[%d bytes left out]\n" % gap + self._kept[half:] if gap else self._kept
        return kept.decode("utf-8", "replace")


def last_words(printed: str, most: int = 200) -> str:
    """Return the end of what a child printed, in one line, as a message quotes it; empty where it printed nothing.

    Of what faulthandler prints about a crash, that is the reason and the stack of the thread that failed.
    """
    printed = printed.replace(MARK, "")
    *_, fault = None, *_FAULT.finditer(printed)
    if fault:
        stack = printed[fault.end() :].rpartition("(most recent call first):")[2].partition("Extension modules:")[0]
        return shown(" ".join(f"{fault[0]} {stack}".split()), most)
    words = " ".join(printed.split())
    return shown(words if len(words) <= most else f"…{words[1 - most :]}", most) if words else ""
