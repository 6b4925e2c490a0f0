"""What plugins print while they are at work, line by line, with the names of those who print it.

A worker may have no standard error that anybody reads. So what Python code prints there goes back with the results, and
the run prints it. A worker whose parent keeps its standard error writes it there, too, with a mark: those are its last
words if it dies, and the parent passes on only what has no mark, which C code and other programs print.
"""

from __future__ import annotations

import codecs
import io
import sys
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from typing import TYPE_CHECKING, Any

from dh2urdf.plugin_system.at_work import MARK, at_work_here, has_parent

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from typing import TextIO

MOST_LINES = 100
"""Lines of one batch that are passed on; the rest is counted."""
LONGEST = 10_000
"""Characters after which a line ends, as a bar that shows how far something is has no end."""


class NamedLines(io.TextIOBase):
    """A text stream that hands over whole lines with the name of the stage at work.

    It is what a library expects of standard output: bytes may be written to its `buffer`, and a program may be given
    it, which then prints to standard error, without a name.

    Args:
        put: takes what is to be printed, a line with the name of its plugin, and the line alone; both without an end.
        stderr: where what programs print goes.
    """

    encoding = "utf-8"
    errors = "backslashreplace"

    def __init__(self, put: Callable[[str, str], object], stderr: TextIO) -> None:
        self._put = put
        self._who = self._line = ""
        self._stderr = stderr
        self.buffer = _Bytes(self)

    def fileno(self) -> int:
        """The number of the file that programs print to."""
        return self._stderr.fileno()

    def close(self) -> None:
        """Stay open for the next one that prints."""

    def reconfigure(self, **_changes: object) -> None:
        """Stay as it is: it takes any text."""

    def write(self, text: str) -> int:
        """Take a text; its last line waits for its end."""
        at_work = at_work_here()
        who = str(at_work) if at_work and at_work.plugin else ""
        if who != self._who:
            self.finish()
            self._who = who
        *lines, self._line = (self._line + text).split("\n")
        for line in lines:
            self._hand_over(line)
        if len(self._line) > LONGEST:
            self.finish()
        return len(text)

    def finish(self) -> None:
        """Hand over a line without an end."""
        if self._line:
            self._hand_over(self._line)
            self._line = ""

    def _hand_over(self, line: str) -> None:
        self._put(f"{self._who} prints: {line}" if self._who else line, line)


class _Bytes(io.RawIOBase):
    """What is printed as bytes goes to the same lines."""

    def __init__(self, lines: NamedLines) -> None:
        self._lines = lines
        self._text = codecs.getincrementaldecoder(lines.encoding)(lines.errors)

    def write(self, data: Any) -> int:  # noqa: ANN401 - anything that has bytes
        """Take bytes; those of a character that is not whole wait for the others."""
        self._lines.write(self._text.decode(bytes(data)))
        return len(data)


@contextmanager
def collected_lines(*, is_worker: bool) -> Iterator[list[str]]:
    """What is printed in this process meanwhile, if it is a worker's; elsewhere it is printed as usual."""
    lines: list[str] = []
    if not is_worker:
        yield lines
        return
    stderr, left_out = sys.stderr, 0

    def put(named: str, line: str) -> None:
        nonlocal left_out
        if len(lines) < MOST_LINES:
            lines.append(named)
        else:
            left_out += 1
        if has_parent():
            stderr.write(f"{MARK}{line}\n")
            stderr.flush()

    stream = NamedLines(put, stderr)
    try:
        with redirect_stdout(stream), redirect_stderr(stream):
            yield lines
    finally:
        stream.finish()
        if left_out:
            lines.append(f"and {left_out:,} more lines that plugins printed")
