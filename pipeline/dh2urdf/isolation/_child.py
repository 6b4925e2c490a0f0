"""What runs in an interpreter that `dh2urdf.isolation.interpreter` starts: the calls of its parent, in their order.

It is started by its path and needs the standard library alone, so it works wherever the interpreter does. The parent
sends pickles. The first one is ``sys.path``. Each further one is a call, ``(encoding, function, arguments)``, each
pickled once more; without a function it is the function of the call before, in its encoding, and without arguments the
function is imported and not called. None ends the interpreter.

Calls arrive on standard input. Each answer leaves on what was standard output: the sizes of its two parts, a word with
texts as JSON, and what the encoding (of `dh2urdf.isolation.encodings`) makes of the value or the exception. Everything
that anybody prints, from C too, goes to standard error, between two marks for each call.
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
from pathlib import Path
from queue import SimpleQueue
from typing import IO, Any

_LONGEST_TEXT = 2**16  # characters of a text of an answer: of a traceback the end


class _Terminated(KeyboardInterrupt):
    """SIGTERM came during a call: an interrupt like Ctrl-C, and no fault of what it interrupts."""


def main(begin: bytes, end: bytes) -> None:
    """Answer the calls of the parent until it sends the last one, or is gone.

    Args:
        begin: what is written to standard error before a call.
        end: what is written there after it.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's affair.
    messages, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    with Path(os.devnull).open("rb") as nothing:
        os.dup2(nothing.fileno(), 0)
    _print_at_once()
    received: SimpleQueue[Any] = SimpleQueue()
    threading.Thread(target=_receive, args=(messages, received), daemon=True).start()
    sys.path[:] = received.get()
    kept: Any = None
    while (call := received.get()) is not None:
        os.write(2, begin)
        kept, (*words, body) = answer_call(kept, *call)
        for stream in (sys.stdout, sys.stderr):
            with contextlib.suppress(OSError, ValueError, AttributeError):  # closed or replaced by what was called
                stream.flush()
        os.write(2, end)
        head = json.dumps([word[-_LONGEST_TEXT:] if isinstance(word, str) else word for word in words]).encode()
        answers.write(struct.pack(">II", len(head), min(len(body), 2**32 - 1)) + head)
        answers.write(body)
        answers.flush()


def _print_at_once() -> None:
    """Turns the buffers of standard output off, so that a crash loses nothing that was printed before it."""
    if hasattr(sys.stdout, "reconfigure"):
        sys.stdout.reconfigure(line_buffering=True, errors="backslashreplace")
    with contextlib.suppress(ImportError, OSError, AttributeError, ValueError, TypeError):  # no C library, or another
        import ctypes

        libc = ctypes.CDLL(None)
        unbuffered = 2  # _IONBF of glibc, musl and the BSDs
        libc.setvbuf(ctypes.c_void_p.in_dll(libc, "stdout"), None, unbuffered, 0)


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


def answer_call(
    kept: tuple[Any, Any] | None, encoding: bytes | None, function: bytes | None, args: bytes | None
) -> tuple[tuple[Any, Any] | None, tuple[Any, ...]]:
    """What came of a call. SIGTERM ends the call, which takes away what it was writing.

    Args:
        kept: encoding and function of the call before.
        encoding: the encoding, pickled; without it, that of the call before.
        function: the function, pickled; without it, that of the call before.
        args: its arguments, pickled; without them it is not called.

    Returns:
        Encoding and function, and the answer: a word, texts, and bytes.
    """
    coder: Any = None
    try:
        if encoding is not None and function is not None:
            coder = pickle.loads(encoding)  # noqa: S301 - our own parent sent it
            coder.prepare()
            kept = coder, pickle.loads(function)  # noqa: S301 - our own parent sent it
    except Exception as error:  # noqa: BLE001 - unpickling imports modules, which may raise anything
        return None, ("not imported", f"{type(error).__name__}: {error}", coder.pack_error(error) if coder else b"")
    if args is None or kept is None:
        return kept, ("imported", b"")
    coder, called = kept
    signal.signal(signal.SIGTERM, _on_terminate)
    try:
        return kept, ("value", coder.pack(called(*pickle.loads(args))))  # noqa: S301 - our own parent sent it
    except SystemExit as error:
        code = error.code if isinstance(error.code, int) else 0 if error.code is None else str(error.code)
        return kept, ("left", code, traceback.format_exc(), b"")
    except _Terminated:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        signal.raise_signal(signal.SIGTERM)
        raise
    except BaseException as error:  # noqa: BLE001 - the parent raises it again
        return kept, ("raised", traceback.format_exc(), coder.pack_error(error))
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _on_terminate(_number: int, _frame: object) -> None:
    raise _Terminated


if __name__ == "__main__":
    main(*map(str.encode, sys.argv[1:]))
