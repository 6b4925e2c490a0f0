"""An interpreter of our own beside this one, which answers calls one after the other.

It is started as a plain subprocess: unlike a `multiprocessing` child it may be started by a worker of a process pool,
and needs no ``if __name__ == "__main__"`` in the user's script. What it answers, and what was printed meanwhile, is the
caller's to judge: see `dh2urdf.isolation.child_process` for calls that may crash, and the executor `local` for workers.
"""

from __future__ import annotations

import contextlib
import json
import os
import pickle
import signal
import struct
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, cast

from dh2urdf.plugin_system.child_place import ChildPlace

if sys.platform == "linux":
    from fcntl import F_SETPIPE_SZ, fcntl

if TYPE_CHECKING:
    from collections.abc import Sequence

KEPT_OUTPUT = 64 * 1024
"""Bytes of the output of a call that are kept, half from its beginning and half from its end."""
LARGEST_ANSWER = 2**30
"""Bytes of an answer, at most."""
_LARGEST_HEAD = 2**20
"""Bytes of the words of an answer, at most."""

_PIPE = 1 << 20
"""Bytes that a pipe holds, the most that Linux allows everyone: whenever it is full, one side waits for the other."""
_SIZES = struct.Struct(">II")
_SCRIPT = Path(__file__).with_name("_child.py")
_LEAVING = 5.0  # [s] to end after the last answer, and to empty a pipe after the end


class Interpreter:
    """An interpreter in a session of its own, with all that it starts: Ctrl-C in a terminal reaches none of them.

    It leaves, and all that it started is killed, when this process is gone, however it went.

    Args:
        flags: options of Python, such as ``-X faulthandler``.

    Attributes:
        output: what was printed since the last call began.
        who: who was at work when it ended, with distribution and version; empty before, and where nobody was.

    Raises:
        OSError: it cannot be started.
    """

    def __init__(self, flags: Sequence[str] = ()) -> None:
        self._place, self.who = ChildPlace(), ""
        mark = f"\x1f{os.urandom(8).hex()}"
        self.output = Output(begin=f"{mark}(", end=f"{mark})")
        try:
            self._process = subprocess.Popen(  # noqa: S603 - our own script
                # -P: the folder of this package is not a folder of modules
                [sys.executable, *flags, "-P", str(_SCRIPT), self.output.begin, self.output.end],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                start_new_session=True,  # A process group of its own, to end it with all that it started.
                **self._place.for_child(),
            )
        except BaseException:
            self._place.close()
            raise
        self._calls = cast("IO[bytes]", self._process.stdin)
        self._answers = cast("IO[bytes]", self._process.stdout)
        self._printed = cast("IO[bytes]", self._process.stderr)
        if sys.platform == "linux":
            for pipe in (self._calls, self._answers):
                with contextlib.suppress(OSError):  # This user has many pipes already.
                    fcntl(pipe, F_SETPIPE_SZ, _PIPE)
        self._messages: list[Any] = [sys.path]
        self._talk: threading.Thread | None = None
        self._has_ended = False
        self._watch = threading.Thread(target=self._clear_after, daemon=True)
        self._listen = threading.Thread(target=self._take_output, daemon=True)
        self._watch.start()
        self._listen.start()

    def call(
        self,
        encoding: bytes | None,
        function: bytes | None,
        args: bytes | None,
        timeout: float | None,
        *,
        last: bool = False,
    ) -> tuple[Any, ...]:
        """What came of a call: a word, texts, and bytes, as `dh2urdf.isolation._child` sends them.

        Args:
            encoding: the pickled encoding of the answer; without it, that of the call before.
            function: the pickled function; without it, that of the call before.
            args: its pickled arguments; without them it is imported and not called.
            timeout: how long it may take [s]; None where it takes as long as it takes.
            last: whether the interpreter ends afterwards.

        Returns:
            The answer; ``()`` where the interpreter ended without one, ``("late",)`` where it takes too long, and
            ``("garbled", reason)`` where what it sent is no answer: then it is to be ended.
        """
        self.output.expect()
        received: list[tuple[Any, ...]] = []
        self._messages += [(encoding, function, args), *([None] if last else [])]
        if timeout is None:
            self._exchange(received)  # Neither side ever waits for a full pipe: a thread takes the output.
        else:
            self._talk = threading.Thread(target=self._exchange, args=(received,), daemon=True)
            self._talk.start()
            self._talk.join(timeout)
            if self._talk.is_alive():
                return ("late",)
        if last:
            self.wait(_LEAVING)
        elif received:
            self.output.wait(_LEAVING)
        return received[0] if received else ()

    def is_alive(self) -> bool:
        """Whether it can be called."""
        return self._process.poll() is None

    def terminate(self) -> None:
        """Ask it to end: a call under way takes away what it was writing."""
        self._process.terminate()

    def wait(self, seconds: float) -> None:
        """Wait until it has ended, for so long at most."""
        self._watch.join(max(0.0, seconds))

    def kill(self) -> None:
        """End it and all that it started, whatever they do."""
        self._process.kill()
        self._watch.join()

    def end(self) -> int:
        """End it, with all that it started, and give everything back; its exit status, negative for a signal."""
        self.kill()
        if not self._has_ended:
            self._has_ended, self.who = True, self._place.who()
        for thread, streams in (
            (self._talk, (self._calls, self._answers)),
            (self._listen, (self._printed, self._place)),
        ):
            if thread is not None:
                thread.join(_LEAVING)
            if thread is None or not thread.is_alive():  # A process that left the group may still hold the other end.
                for stream in streams:
                    with contextlib.suppress(OSError):
                        stream.close()
        return self._process.returncode

    def _clear_after(self) -> None:
        """Ends what it started, as soon as it has ended: that may hold the pipe of its answers open."""
        self._process.wait()
        if hasattr(os, "killpg"):
            with contextlib.suppress(ProcessLookupError, PermissionError):  # nothing is left, or (macOS) a zombie
                os.killpg(self._process.pid, signal.SIGKILL)

    def _exchange(self, received: list[tuple[Any, ...]]) -> None:
        try:
            while self._messages:
                pickle.dump(self._messages.pop(0), self._calls)
            self._calls.flush()  # It stays open: its end tells the child that the parent is gone.
            answer = _answer_from(self._answers)
        except (OSError, ValueError):  # It ended, and the pipe with it.
            return
        if answer:
            received.append(answer)

    def _take_output(self) -> None:
        while chunk := os.read(self._printed.fileno(), KEPT_OUTPUT):
            self.output.add(chunk)
        self.output.finish()


def _answer_from(pipe: IO[bytes]) -> tuple[Any, ...]:
    """The next answer of a child, which is data: a word, texts, and bytes; ``()`` where the child ends before.

    Returns:
        The answer, or ``("garbled", reason)``.
    """
    head, body = _SIZES.unpack(pipe.read(_SIZES.size).ljust(_SIZES.size, b"\0"))
    if head > _LARGEST_HEAD or body > LARGEST_ANSWER:
        return "garbled", f"it would have {head + body} bytes, more than {LARGEST_ANSWER}"
    words, content = pipe.read(head), pipe.read(body)
    if not head or len(words) + len(content) < head + body:
        return ()
    try:
        match json.loads(words):
            case ["value" | "imported" as word]:
                return word, content
            case ["raised" | "not imported" as word, str(text)]:
                return word, text, content
            case ["left", int() | str() as code, str(text)]:
                return "left", code, text
    except (ValueError, RecursionError):
        pass  # The last line reports it.
    return "garbled", "it does not begin with one of the words of an answer"


class Output:
    """The beginning and the end of what was printed since a call began, of any length.

    Args:
        begin: what is printed where a call begins.
        end: what is printed where it ends; of the same length.

    Attributes:
        size: how much was printed [B].
    """

    def __init__(self, begin: str, end: str) -> None:
        self.begin, self.end = begin, end
        self._marks = {begin.encode(): self._clear, end.encode(): self._end}
        self._held = b""  # the end of what came, which may be the first part of a mark
        self._has_ended = threading.Event()
        self._clear()

    def _clear(self) -> None:
        self.size, self._head, self._tail = 0, b"", b""

    def _end(self) -> None:
        self._has_ended.set()

    def expect(self) -> None:
        """Wait for the end of a call anew."""
        self._has_ended.clear()

    def wait(self, seconds: float) -> None:
        """Wait until all is here that was printed before the end of a call, for so long at most."""
        self._has_ended.wait(seconds)

    def add(self, chunk: bytes) -> None:
        """Take what was printed."""
        data = self._held + chunk
        longest = len(self.begin)
        while found := [(at, mark) for mark in self._marks if (at := data.find(mark)) >= 0]:
            at, mark = min(found)
            self._take(data[:at])
            self._marks[mark]()
            data = data[at + longest :]
        sure = data.rfind(b"\x1f", max(0, len(data) - longest + 1))
        at = len(data) if sure < 0 else sure
        self._take(data[:at])
        self._held = data[at:]

    def finish(self) -> None:
        """Take what was held back: nothing more comes."""
        self._take(self._held)
        self._held = b""
        self._has_ended.set()

    def _take(self, data: bytes) -> None:
        half = KEPT_OUTPUT // 2
        room = max(0, half - len(self._head))
        self._head += data[:room]
        self._tail = (self._tail + data[room:])[-half:]
        self.size += len(data)

    @property
    def is_cut(self) -> bool:
        """Whether there was too much to keep all of it."""
        return self.size > len(self._head) + len(self._tail)

    def text(self) -> str:
        """All of it, or its beginning, how much is left out, and its end."""
        left_out = self.size - len(self._head) - len(self._tail)
        gap = b"\n[%d bytes left out]\n" % left_out if left_out else b""
        return (self._head + gap + self._tail).decode("utf-8", "replace")

    def last(self) -> str:
        """The end of it."""
        return ((b"" if self.is_cut else self._head) + self._tail).decode("utf-8", "replace")
