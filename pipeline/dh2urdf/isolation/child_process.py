"""Runs a function in a child process of its own, so that it may crash, hang or leave.

Simulators are C++ that trusts its input: a description with a duplicate joint name ends PyBullet with a segmentation
fault, others leave the interpreter. In a child process that is one manipulator's failure, told in a sentence, with
what the simulator printed before.

The child is a fresh `dh2urdf.isolation.interpreter.Interpreter`. Where a loader can be called many times in one
process, `dh2urdf.isolation.loads` keeps its child for the next manipulator.
"""

from __future__ import annotations

import pickle
import signal
from typing import TYPE_CHECKING, Any, Generic, TypeVar, TypeVarTuple

from dh2urdf.errors import CrashError, TimeLimitError
from dh2urdf.isolation.encodings import AnswerError, Data, Pickled
from dh2urdf.isolation.interpreter import Interpreter
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.plugin_system.at_work import MARK
from dh2urdf.source import shown

if TYPE_CHECKING:
    from collections.abc import Callable


T = TypeVar("T")
Args = TypeVarTuple("Args")

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


PLAIN: Data[Any] = Data()
"""The encoding of plain values: numbers, texts, lists and mappings of them."""


def run_in_child(
    function: Callable[[*Args], T],
    *args: *Args,
    timeout: float | None,
    who: str = "the simulator",
    encoding: Data[Any] | Pickled[Any] = PLAIN,
) -> ChildResult[T]:
    """Calls a function in a child process and waits for it.

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
    call = pickled_call(function, args, who, encoding)
    child = started()
    try:
        answer = child.call(*call, timeout, last=True)
    finally:
        status = child.end()
    return outcome(answer, child.output.text(), status, function, timeout, child.who or who, encoding)


def started() -> Interpreter:
    """A new child.

    Raises:
        CrashError: it cannot be started.
    """
    try:
        return Interpreter()
    except OSError as error:
        raise CrashError(f"a child process cannot be started: {error}") from error


def outcome(  # noqa: PLR0917 - what is known of a call
    answer: tuple[Any, ...],
    output: str,
    status: int,
    function: Callable[..., T],
    timeout: float | None,
    who: str,
    encoding: Data[Any] | Pickled[Any] = PLAIN,
) -> ChildResult[T]:
    """What came of a call in a child.

    Args:
        answer: its answer.
        output: what it printed.
        status: its exit status, where the answer is none.
        function: what was called.
        timeout: how long it could take [s].
        who: what messages call the function.
        encoding: how it sent what it returned or raised.

    Raises:
        Exception: as `run_in_child`.
    """
    if answer[:1] in {("value",), ("raised",)}:
        try:
            return ChildResult(result_of(answer, encoding, output), output)
        except AnswerError as error:
            answer = ("garbled", str(error))
    kind: type[CrashError] = CrashError
    match answer:
        case ("not imported", reason, _):
            message = f"a child process cannot import {function.__module__}.{function.__qualname__}: {reason}"
        case ("left", code, _):
            message = f"{who} left the interpreter (exit status {code}) and gave no result"
        case ("garbled", reason):
            message = f"{who} sent an answer that cannot be used: {reason}"
        case ("late",):
            kind = TimeLimitError
            message = f"{who} did not finish within {timeout:g} s"
        case _ if status < 0:
            message = f"{who} crashed ({(signal.strsignal(-status) or f'signal {-status}').lower()})"
        case _:
            message = f"{who} left the process (exit status {status}) and gave no result"
    raise kind(message + _last_words(output)) from ChildFailure(output)


def result_of(answer: tuple[Any, ...], encoding: Data[Any] | Pickled[Any], output: str = "") -> Any:  # noqa: ANN401 - what the function returned
    """What a call in a child returned.

    Args:
        answer: the answer of a call that returned or raised something.
        encoding: how it sent that.
        output: what the child printed.

    Raises:
        AnswerError: it sent something else.
        Exception: whatever the function raised, as `run_in_child` raises it.
    """
    match answer:
        case ("value", value):
            return encoding.unpack(value)
        case ("raised", traceback, error):
            raise encoding.unpack_error(error) from ChildFailure(output, traceback)
        case _:
            raise ValueError(answer)


def pickled_call(
    function: Callable[..., Any], args: tuple[Any, ...], who: str, encoding: Data[Any] | Pickled[Any] = PLAIN
) -> tuple[bytes, bytes, bytes]:
    """The encoding of the answer, the function, by its name, and its arguments.

    Raises:
        CrashError: no child can have them.
    """
    if getattr(function, "__module__", None) == "__main__":
        raise CrashError(
            f"{function.__qualname__} is in the script that is run, where a child process cannot import it",
        )
    try:
        return pickle.dumps(encoding), pickle.dumps(function), pickle.dumps(args)
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
