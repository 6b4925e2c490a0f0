"""Who is at work: the stage that is called, or the plugin that is imported, at this moment.

The name is kept where it survives whatever ends the work. In this process an interrupt takes it along as a note. A
child process writes it into memory that its parent shares, where the name is still known when the child hangs, crashes
or leaves by `os._exit`.
"""

from __future__ import annotations

import os
from _thread import _local  # `threading.local`, without an import that takes as long as all of this
from contextlib import suppress
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from mmap import mmap
    from types import TracebackType
    from typing import Protocol

    class _NamedPlugin(Protocol):
        """What is needed of a `dh2urdf.plugin_system.discovery.Plugin`."""

        name: str

        @property
        def is_builtin(self) -> bool: ...

        @property
        def distribution(self) -> str: ...

        @property
        def distribution_name(self) -> str: ...


MARK = "\x1e"
"""What a line on a child's standard error begins with if its parent has the line from the child's results, too."""

VARIABLE = "DH2URDF_AT_WORK"
MAGIC = b"dh2urdf\n"
SIZE = 1024  # bytes of the shared memory: a mark, and the name as a text that ends in a zero byte


class AtWork:
    """A context in which a plugin is at work.

    What a consumer does between two items of a generator is not the plugin's work: a context is entered for each item.

    A plugin is met in the folder where the last one was, wherever that one went. A process that a plugin has forked off
    ends here: it would do the rest of the run a second time.

    Args:
        what: what is done, such as ``emitter 'usd'``.
        plugin: the plugin; None where the stage came from none.
    """

    __slots__ = ("_before", "_folder", "_process", "plugin", "what")

    def __init__(self, what: str, plugin: _NamedPlugin | None) -> None:
        self.what, self.plugin = what, plugin

    def __str__(self) -> str:
        return f"{self.what} of {self.plugin.distribution}" if self.plugin else self.what

    def __enter__(self) -> None:
        self._before = _here.at_work
        _here.at_work = self
        if self._is_foreign:
            self._process, self._folder = os.getpid(), current_folder()
        if _shared is not None:
            self.tell(_shared)

    def __exit__(
        self, _kind: type[BaseException] | None, error: BaseException | None, _traceback: TracebackType | None
    ) -> None:
        if self._is_foreign:
            if self._process != os.getpid():
                os._exit(1)
            if self._folder and self._folder != current_folder():
                with suppress(OSError):  # It was removed meanwhile.
                    os.chdir(self._folder)
        _here.at_work = before = self._before
        if isinstance(error, KeyboardInterrupt):
            if self._is_foreign and not getattr(error, "__notes__", ()):
                error.add_note(f"{self} was at work")
        elif _shared is not None:  # An interrupt ends a child, which was at this work to its end.
            if before is None:
                _shared[len(MAGIC)] = 0
            else:
                before.tell(_shared)

    @property
    def _is_foreign(self) -> bool:
        return self.plugin is not None and not self.plugin.is_builtin

    def tell(self, shared: mmap) -> None:
        """Write it where the parent of this process reads it."""
        text = f"{self.what}\n{self.plugin.name if self.plugin else ''}".encode(errors="replace")
        text = text[: SIZE - len(MAGIC) - 1]
        shared[len(MAGIC) : len(MAGIC) + len(text) + 1] = text + b"\0"


def current_folder() -> str:
    """The current folder; empty where it was removed."""
    try:
        return os.getcwd()  # noqa: PTH109 - asked at each call of a plugin
    except OSError:
        return ""


class _Here(_local):
    at_work: AtWork | None = None


_here = _Here()


def at_work_here() -> AtWork | None:
    """The innermost context that this thread is in; None where no plugin is at work."""
    return _here.at_work


# --- A parent and its child ------------------------------------------------------------------------------------------


def _memory_of_parent() -> mmap | None:
    """The memory in which this process has to write who is at work in it; None where nobody wants to know."""
    word = os.environ.pop(VARIABLE, "")  # What this process starts is no affair of the same parent.
    if not word:
        return None
    from mmap import mmap

    try:
        shared = mmap(int(word), SIZE)
        os.close(int(word))
    except (OSError, ValueError):  # It came here through a process that does not hand files on.
        return None
    return shared if shared[: len(MAGIC)] == MAGIC else None


def has_parent() -> bool:
    """Whether a parent holds this process, who is at work in it, and what it prints on standard error."""
    return _shared is not None


def unmarked(printed: str) -> list[str]:
    """The lines of a child's standard error that its results do not have."""
    return [line for line in printed.removesuffix("\n").split("\n") if line and not line.startswith(MARK)]


_shared = _memory_of_parent()
