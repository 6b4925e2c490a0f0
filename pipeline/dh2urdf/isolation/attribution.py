"""Plugins, which stage of one runs at this moment, what it raises, and which lines it prints meanwhile.

An interrupt takes the name of the running stage along as a note. A child process also writes the name into a file that
its parent shares: the parent knows it even where the child hangs, crashes or leaves by `os._exit`.
"""

from __future__ import annotations

import io
import os
import re
import sys
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from contextvars import ContextVar
from functools import cached_property
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from importlib.metadata import Distribution, EntryPoint
    from types import TracebackType
    from typing import TextIO

UNKNOWN = "an unknown distribution"
_BUILT_IN = ("dh2urdf_plugins", "dh2urdf_check", "dh2urdf_studio")
MARK = "\x1e"
"""What a line on a child's standard error begins with if its parent has the line from the child's results, too."""
NAME_SIZE = 1024
"""Bytes of the shared file: what runs, up to a zero byte."""
MOST_LINES = 100
"""Lines of one batch that are passed on; the rest is counted."""
LONGEST = 10_000
"""Bytes after which a line ends: a progress bar never ends its line."""

_current: ContextVar[Attribution | None] = ContextVar("stage", default=None)
_shared: int | None = getattr(sys.modules["__main__"], "running_stage", None)  # set by `dh2urdf.isolation._child`


class Attribution:
    """A context in which a plugin runs; it is entered anew for each item of a generator.

    A plugin is met in the folder where the last one was, wherever that one went. A process that a plugin has forked off
    ends here: it would do the rest of the run a second time.

    Args:
        what: what is done, such as ``emitter 'usd'``.
        plugin: the plugin; None where the stage came from none.
    """

    __slots__ = ("_before", "_folder", "_process", "plugin", "what")

    def __init__(self, what: str, plugin: Plugin | None) -> None:
        self.what, self.plugin = what, plugin

    def __str__(self) -> str:
        return f"{self.what} of {self.plugin.distribution}" if self.plugin else self.what

    def __enter__(self) -> None:
        self._before = _current.get()
        _current.set(self)
        self._process = 0
        if self.plugin is not None and not self.plugin.is_builtin:
            self._process, self._folder = os.getpid(), _folder()
        if _shared is not None:
            _share(_shared, self)

    def __exit__(
        self, _kind: type[BaseException] | None, error: BaseException | None, _traceback: TracebackType | None
    ) -> None:
        if self._process:
            if self._process != os.getpid():
                os._exit(1)
            if self._folder and self._folder != _folder():
                with suppress(OSError):  # It was removed meanwhile.
                    os.chdir(self._folder)
        _current.set(self._before)
        if not isinstance(error, KeyboardInterrupt):
            if _shared is not None:
                _share(_shared, self._before)
        elif self._process and not getattr(error, "__notes__", ()):
            error.add_note(f"{self} was at work")  # A child keeps the name, too: the interrupt ends it.


def _share(descriptor: int, at_work: Attribution | None) -> None:
    """Write the name where the parent of this process reads it."""
    os.pwrite(descriptor, str(at_work or "").encode(errors="replace")[: NAME_SIZE - 1] + b"\0", 0)


def _folder() -> str:
    """The current folder; empty where it was removed."""
    try:
        return os.getcwd()  # noqa: PTH109 - asked at each call of a plugin
    except OSError:
        return ""


def current() -> Attribution | None:
    """The innermost context that this thread is in; None where no plugin runs."""
    return _current.get()


class Plugin:
    """An installed plugin.

    Attributes:
        name: its entry point, such as ``my_lab = my_lab.dh2urdf``.
        module: what the entry point gives; imported when it is asked for.
        distribution: name and version of the distribution that provides it; read when it is asked for, since the
            metadata of a distribution take as long to read as a table.
        entry: the name of the entry point: what stands before the ``=``.
        is_builtin: whether it is a plugin of dh2urdf itself.
        is_installed: whether it was found among what is installed, as every process of this environment finds it.
    """

    def __init__(
        self,
        *,
        name: str,
        distribution: Distribution | str | None,
        module: Any = None,  # noqa: ANN401 - anything
        point: EntryPoint | None = None,
    ) -> None:
        self.name = name
        self.entry, _, place = name.partition(" = ")
        self.is_builtin, self.is_installed = place in _BUILT_IN, point is not None
        self._distribution, self._module, self._point = distribution, module, point

    @cached_property
    def module(self) -> Any:  # noqa: ANN401, D102 - anything; documented with the class
        if self._point is None:
            return self._module
        with Attribution(f"the import of the plugin {self.name!r}", self):
            return self._point.load()

    @cached_property
    def distribution(self) -> str:  # noqa: D102 - documented with the class
        found = self._distribution
        if found is None or isinstance(found, str):
            return found or UNKNOWN
        return f"{found.name or UNKNOWN} {found.version}"

    @property
    def distribution_name(self) -> str:
        """The name of the distribution, without its version."""
        found = self._distribution
        return found.partition(" ")[0] if isinstance(found, str) else (found and found.name) or UNKNOWN

    def is_of(self, distribution: str) -> bool:
        """Whether a distribution provides it; spellings of a name that pip takes for one are one here, too."""
        return same_name(self.distribution_name, distribution)


def same_name(one: str, other: str) -> bool:
    """Whether two names of a distribution are one name, as pip compares them."""
    return re.sub(r"[-_.]+", "-", one).lower() == re.sub(r"[-_.]+", "-", other).lower()


# --- What plugins raise: anything, and even the text of that may fail


def reason_of(error: BaseException) -> str:
    """Return the class of an exception and its message, in one line."""
    try:
        text = str(error)
    except Exception as failed:  # noqa: BLE001 - it is the exception's own code
        text = f"its text cannot be made: {type(failed).__name__}"
    text = "; ".join(filter(None, map(str.strip, text.removeprefix("error: ").splitlines())))
    return f"{type(error).__name__}: {text}" if text else f"{type(error).__name__}, without a message"


def traceback_of(error: BaseException) -> str:
    """Return where an exception was raised, for `--debug`."""
    import traceback

    return "".join(traceback.format_exception(error))


# --- What plugins print -----------------------------------------------------------------------------------------------


class NamedLines(io.RawIOBase):
    """Takes bytes, and hands over whole lines with the name of the stage that printed them, and without it.

    Programs that are given this stream print to standard error.
    """

    def __init__(self, put: Callable[[str, str], object], stderr: TextIO) -> None:
        self._put, self._stderr = put, stderr
        self._who, self._line = "", b""

    def as_text(self) -> io.TextIOWrapper:
        """Return a text stream over these lines, as libraries expect of standard output."""
        return io.TextIOWrapper(self, "utf-8", "backslashreplace", write_through=True)  # type: ignore[arg-type] # it needs no name

    def writable(self) -> bool:
        """Return True."""
        return True

    def fileno(self) -> int:
        """Return the number of the file that programs print to."""
        return self._stderr.fileno()

    def close(self) -> None:
        """Stay open for the next one that prints."""

    def write(self, data: Any) -> int:  # noqa: ANN401 - anything that has bytes
        """Take bytes; those of the last line wait for its end."""
        running = _current.get()
        who = str(running) if running and running.plugin else ""
        if who != self._who:
            self.finish()
            self._who = who
        *lines, self._line = (self._line + bytes(data)).split(b"\n")
        for line in lines:
            self._hand_over(line)
        if len(self._line) > LONGEST:
            self.finish()
        return len(data)

    def finish(self) -> None:
        """Hand over a line without an end."""
        if self._line:
            self._hand_over(self._line)
            self._line = b""

    def _hand_over(self, data: bytes) -> None:
        line = data.decode("utf-8", "backslashreplace")
        self._put(f"{self._who} prints: {line}" if self._who else line, line)


@contextmanager
def collected_lines(*, is_worker: bool) -> Iterator[list[str]]:
    """Collect what is printed in this process if it is a worker; elsewhere it is printed as usual.

    The run prints the lines of its workers. A child also writes them to its standard error, with a `MARK`: those are
    its last words if it dies, and its parent passes on only lines without a mark, which C code and programs print.
    """
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
        if _shared is not None:
            stderr.write(f"{MARK}{line}\n")
            stderr.flush()

    stream = NamedLines(put, stderr)
    text = stream.as_text()
    try:
        with redirect_stdout(text), redirect_stderr(text):
            yield lines
    finally:
        stream.finish()
        if left_out:
            lines.append(f"and {left_out:,} more lines that plugins printed")


def unmarked(printed: str) -> list[str]:
    """Return the lines of a child's standard error that its results do not have."""
    return [line for line in printed.removesuffix("\n").split("\n") if line and not line.startswith(MARK)]
