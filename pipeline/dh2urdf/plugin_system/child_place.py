"""Who is at work in a child process, as its parent sees it."""

from __future__ import annotations

import os
from typing import IO, Any

from dh2urdf.plugin_system.at_work import MAGIC, SIZE, VARIABLE
from dh2urdf.plugin_system.discovery import UNKNOWN, installed


class ChildPlace:
    """Memory in which a child process writes who is at work in it.

    It is the child's as long as the child lives, and the parent's until `close`.
    """

    def __init__(self) -> None:
        self._file: IO[bytes] | None = None
        if os.name == "posix":  # Elsewhere a child takes over no open files, and nobody is named.
            import tempfile

            self._file = tempfile.TemporaryFile(buffering=0)  # noqa: SIM115 - open until `close`
            self._file.write(MAGIC.ljust(SIZE, b"\0"))

    def for_child(self) -> dict[str, Any]:
        """The arguments for `subprocess.Popen`."""
        if self._file is None:
            return {}
        number = self._file.fileno()
        return {"pass_fds": (number,), "env": {**os.environ, VARIABLE: str(number)}}

    def who(self) -> str:
        """Who is at work in the child, or was when it ended, with distribution and version; empty where nobody is."""
        if self._file is None:
            return ""
        self._file.seek(len(MAGIC))
        what, _, name = self._file.read(SIZE).partition(b"\0")[0].decode(errors="replace").partition("\n")
        return f"{what} of {_distribution(name)}" if name else what

    def close(self) -> None:
        """Gives the memory back."""
        if self._file is not None:
            self._file.close()


def _distribution(name: str) -> str:
    """Name and version of the distribution that has an installed plugin."""
    return next((plugin.distribution for plugin in installed().plugins if plugin.name == name), UNKNOWN)
