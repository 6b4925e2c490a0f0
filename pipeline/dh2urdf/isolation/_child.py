"""What runs in an interpreter that `dh2urdf.isolation.child_process` starts: the calls of its parent, in their order.

It is started by its path and needs only the standard library. The parent sends pickles on standard input: first
`sys.path`, then for each call whether to make it in a fork, the pickled encoding, and the pickled function with its
arguments. An answer leaves on what was standard output: the first letter of a word, the sizes of a text and a body, the
text, as body what the encoding (see `dh2urdf.isolation.encodings`) makes of the value or the exception, and a byte that
says whether more calls are taken. Everything that is printed, from C too, goes to standard error.
"""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import signal
import struct
import sys
import threading
import traceback
import warnings
from mmap import mmap
from queue import SimpleQueue
from typing import IO, Any

_LONGEST_TEXT = 2**16  # characters of a traceback, of which the end is sent


running_stage: int | None = None
"""The file in which `dh2urdf.isolation.attribution` writes which stage runs."""


class _Terminated(KeyboardInterrupt):
    """SIGTERM came during a call: an interrupt like Ctrl-C, and no fault of what it interrupts."""


def main() -> None:
    """Answer the calls of the parent until it is gone."""
    global running_stage  # noqa: PLW0603 - found there by the name of this script's module, __main__
    running_stage = int(sys.argv.pop())
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # The parent deals with Ctrl-C.
    messages, answers = os.fdopen(os.dup(0), "rb"), os.dup(1)
    os.dup2(2, 1)
    nothing = os.open(os.devnull, os.O_RDONLY)
    os.dup2(nothing, 0)
    os.close(nothing)
    _print_at_once()
    received: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_receive, args=(messages, received), daemon=True).start()
    sys.path[:] = received.get()
    while True:
        in_fork, *call = received.get()
        if in_fork:
            _answer_in_fork(answers, *call)
        else:
            _answer(answers, *call)
        os.write(answers, b"-" if in_fork and _has_children() else b"+")


def _print_at_once() -> None:
    """Turn off the buffers of standard output, so that a crash loses nothing that was printed before it."""
    sys.stdout.reconfigure(line_buffering=True, errors="backslashreplace")  # type: ignore[union-attr]
    import ctypes

    libc = ctypes.CDLL(None)
    unbuffered = 2  # _IONBF of glibc and musl
    libc.setvbuf(ctypes.c_void_p.in_dll(libc, "stdout"), None, unbuffered, 0)


def _receive(messages: IO[bytes], received: SimpleQueue[Any]) -> None:
    """Take what the parent sends; when the parent is gone, this process and all that it started leave at once.

    A run that was killed may be resumed in the next moment, and must not meet its own past.
    """
    try:
        while True:
            received.put(pickle.load(messages))  # noqa: S301 - our own parent sent it
    except (EOFError, OSError, pickle.UnpicklingError):
        os.killpg(0, signal.SIGKILL)


def _answer(answers: int, encoding: bytes, call: bytes) -> None:
    """Make a call, and send what came of it."""
    word, text, body = _outcome(encoding, call)
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError, AttributeError):  # closed or replaced by what was called
            stream.flush()
    told = text[-_LONGEST_TEXT:].encode(errors="replace")
    with open(answers, "wb", closefd=False) as pipe:
        pipe.write(struct.pack(">cII", word[:1].encode(), len(told), min(len(body), 2**32 - 1)) + told)
        pipe.write(body)


def _answer_in_fork(answers: int, encoding: bytes, call: bytes) -> None:
    """Make a call in a fork: nothing that it does is met by the next one. A fork that gives no answer ends us, too."""
    import ctypes

    set_child_subreaper = 36  # PR_SET_CHILD_SUBREAPER of <linux/prctl.h>: orphans of the fork become our children
    ctypes.CDLL(None).prctl(set_child_subreaper, 1, 0, 0, 0)
    has_answered = mmap(-1, 1)
    with warnings.catch_warnings():
        # Python 3.12 warns of other threads. There is one: it waits for the next message, and holds no lock.
        warnings.simplefilter("ignore", DeprecationWarning)
        number = os.fork()
    if number == 0:
        _answer(answers, encoding, call)
        has_answered[0] = 1
        os._exit(0)
    status = os.waitstatus_to_exitcode(os.waitpid(number, 0)[1])
    if not has_answered[0] and status < 0:
        with contextlib.suppress(OSError):  # SIGKILL has no other handler.
            signal.signal(-status, signal.SIG_DFL)
        os.kill(os.getpid(), -status)
    if not has_answered[0]:
        os._exit(status)


def _has_children() -> bool:
    """Whether a fork has left a process behind that still runs; on Linux, also where those in between have ended."""
    try:
        while os.waitpid(-1, os.WNOHANG)[0]:
            pass
    except ChildProcessError:
        return False
    return True


def _outcome(encoding: bytes, call: bytes) -> tuple[str, str, bytes]:
    """What came of a call: a word, a text, and bytes. SIGTERM ends the call, which takes away what it was writing."""
    coder = None
    try:
        coder = pickle.loads(encoding)  # noqa: S301 - our own parent sent it
        coder.prepare()
        function, args = pickle.loads(call)  # noqa: S301 - our own parent sent it
    except Exception as error:  # noqa: BLE001 - unpickling imports modules, which may raise anything
        return "not imported", f"{type(error).__name__}: {error}", coder.pack_error(error) if coder else b""
    signal.signal(signal.SIGTERM, _on_terminate)
    try:
        return "value", "", coder.pack(function(*args))
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else 0 if error.code is None else str(error.code)
        return "left", traceback.format_exc(), json.dumps(code).encode()
    except _Terminated:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.raise_signal(signal.SIGTERM)
        raise
    except BaseException as error:  # noqa: BLE001 - the parent raises it again
        return "raised", traceback.format_exc(), coder.pack_error(error)
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _on_terminate(_number: int, _frame: object) -> None:
    raise _Terminated


if __name__ == "__main__":
    main()
