"""What runs in a child process of `dh2urdf.isolation.child_process`: one call, whose outcome goes back to the parent.

It is started by its path and needs the standard library alone, so it works wherever the interpreter does. The call
arrives on standard input, the outcome leaves on what was standard output, and everything that anybody prints, from
C too, goes to standard error.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import signal
import sys
import threading
import traceback
from pathlib import Path
from typing import Any


def main() -> None:
    """Takes the call from the parent, makes it, and sends the outcome."""
    parent, outcome = os.dup(0), os.dup(1)
    os.dup2(2, 1)
    with Path(os.devnull).open("rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    _print_at_once()
    with os.fdopen(parent, "rb", closefd=False) as job:
        sys.path[:], call = pickle.load(job)  # noqa: S301 - our own parent sent it
    threading.Thread(target=_leave_with_parent, args=(parent,), daemon=True).start()
    with os.fdopen(outcome, "wb") as result:
        pickle.dump(_outcome(call), result)


def _print_at_once() -> None:
    """Turns the buffers of standard output off, so that a crash loses nothing that was printed before it."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(line_buffering=True, errors="backslashreplace")
    with contextlib.suppress(ImportError, OSError, AttributeError, ValueError, TypeError):  # no C library, or another
        import ctypes

        libc = ctypes.CDLL(None)
        unbuffered = 2  # _IONBF of glibc, musl and the BSDs
        libc.setvbuf(ctypes.c_void_p.in_dll(libc, "stdout"), None, unbuffered, 0)


def _leave_with_parent(parent: int) -> None:
    """Ends this process, and all that it started, as soon as the parent is gone, however it went."""
    os.read(parent, 1)  # The parent sends nothing more: this returns when its end of the pipe closes.
    if hasattr(os, "killpg"):
        os.killpg(0, signal.SIGKILL)
    os._exit(1)


def _outcome(call: bytes) -> tuple[Any, ...]:
    """Makes the call; says what came of it, as a word and its data."""
    try:
        function, args = pickle.loads(call)  # noqa: S301 - our own parent sent it
    except Exception as error:  # noqa: BLE001 - unpickling imports modules, which may raise anything
        return ("not imported", f"{type(error).__name__}: {error}")
    try:
        return ("value", pickle.dumps(function(*args)))
    except SystemExit as error:
        return ("left", 0 if error.code is None else error.code)
    except BaseException as error:  # noqa: BLE001 - the parent raises it again
        return ("raised", _pickled(error), f"{type(error).__name__}: {error}", traceback.format_exc())


def _pickled(error: BaseException) -> bytes | None:
    """The exception as the parent can raise it again, or None where it does not survive the way."""
    try:
        data = pickle.dumps(error)
        pickle.loads(data)  # noqa: S301 - made in the line before
    except Exception:  # noqa: BLE001 - the exception's own code runs here
        return None
    return data


if __name__ == "__main__":
    main()
