"""What runs in a worker process of the executor `local`: it takes tasks from its parent and gives their results back.

It is started by its path, so what it needs before it knows the parent's folders of modules is the standard library's.
Messages are pickles of tuples. The first to come is (``sys.path``, the pickled function); each further one is a pickled
task. Back go ``("ready",)`` or ``("unusable", why, pickled exception)`` once, then for every task
``("value", pickled result)`` or ``("raised", pickled exception, traceback)``. What anybody prints, from C too, goes to
standard error.
"""

from __future__ import annotations

import os
import pickle
import signal
import sys
import threading
import traceback
from pathlib import Path
from queue import SimpleQueue
from typing import IO, TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable


class _Terminated(KeyboardInterrupt):
    """SIGTERM came while a task was under way: an interrupt like Ctrl-C, and no fault of what it interrupts."""


def main() -> None:
    """Does the tasks of the parent, one after the other, until the parent ends it or is gone."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's affair.
    messages, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    with Path(os.devnull).open("rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(line_buffering=True)  # The parent passes on what is printed, after each task.
    received: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_receive, args=(messages, received), daemon=True).start()
    sys.path[:], pickled_function = received.get()
    try:
        from dh2urdf.isolation import claim

        claim()
        function = pickle.loads(pickled_function)  # noqa: S301 - our own parent sent it
    except Exception as error:  # noqa: BLE001 - unpickling imports modules, which may raise anything
        _send(answers, ("unusable", f"{type(error).__name__}: {error}", _pickled(error)))
        return
    _send(answers, ("ready",))
    while True:
        _send(answers, _do(function, received.get()))


def _receive(messages: IO[bytes], received: SimpleQueue[Any]) -> None:
    """Takes what the parent sends; its end is the parent's: this process and all that it started leave at once.

    A run that was killed may be resumed in the next moment, and must not meet its own past.
    """
    try:
        while True:
            received.put(pickle.load(messages))  # noqa: S301 - our own parent sent it
    except (EOFError, OSError, pickle.UnpicklingError):
        if hasattr(os, "killpg"):
            os.killpg(0, signal.SIGKILL)
        os._exit(1)


def _send(answers: IO[bytes], answer: tuple[Any, ...]) -> None:
    pickle.dump(answer, answers)
    answers.flush()


def _do(function: Callable[[Any], Any], task: bytes) -> tuple[Any, ...]:
    """The result of one task, or what it raised. SIGTERM ends the task, which takes away what it was writing."""
    signal.signal(signal.SIGTERM, _on_terminate)
    try:
        return ("value", pickle.dumps(function(pickle.loads(task))))  # noqa: S301 - our own parent sent it
    except _Terminated:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.raise_signal(signal.SIGTERM)
        raise
    except BaseException as error:  # noqa: BLE001 - the parent raises it again
        return ("raised", _pickled(error), traceback.format_exc())
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _on_terminate(_number: int, _frame: object) -> None:
    raise _Terminated


def _pickled(error: BaseException) -> bytes:
    """The exception as the parent can raise it; what cannot be pickled becomes a `RuntimeError`."""
    try:
        data = pickle.dumps(error)
        pickle.loads(data)  # noqa: S301 - made in the line before
    except Exception:  # noqa: BLE001 - the exception's own code runs here
        return pickle.dumps(RuntimeError(f"{type(error).__name__}: {error}"))
    return data


if __name__ == "__main__":
    main()
