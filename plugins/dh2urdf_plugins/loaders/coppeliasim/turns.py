"""Turns at what several processes share: a program that can serve one of them at a time."""

from __future__ import annotations

import contextlib
import os
import tempfile
import time
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.errors import LoaderError

try:
    import fcntl
except ImportError:  # Windows: there, one worker at a time has to be asked for.
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Iterator

_AGAIN = 0.02
"""How long to wait between two looks at whether the program is free [s]."""


@contextlib.contextmanager
def turn(key: str, what: str, patience: float) -> Iterator[None]:
    """Wait until no other process of this machine uses a program, and use it alone.

    The system ends the turn of a process that crashes or is killed.

    Args:
        key: names the program; part of a file name.
        what: names it in messages.
        patience: how long to wait [s].

    Raises:
        LoaderError: others have used it all the time.
    """
    if fcntl is None:
        yield
        return
    path = Path(tempfile.gettempdir(), f"dh2urdf-{key}.lock".replace(":", "_"))
    deadline = time.monotonic() + patience
    while (lock := _taken(path)) is None:
        if time.monotonic() > deadline:
            raise LoaderError(
                f"{what} was busy with other files for {patience:g} s: use fewer workers, or start another one"
            )
        time.sleep(_AGAIN)
    try:
        yield
    finally:
        with contextlib.suppress(OSError):  # Another user's file stays.
            path.unlink()
        os.close(lock)


def _taken(path: Path) -> int | None:
    """The lock file, locked; None where somebody else has it, or has just taken it away."""
    try:
        lock = os.open(path, os.O_RDONLY)  # Another user's can be locked, too, and is not to be created again.
    except FileNotFoundError:
        lock = os.open(path, os.O_RDONLY | os.O_CREAT, 0o644)
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.path.samestat(os.fstat(lock), path.stat()):
            return lock
    except (BlockingIOError, FileNotFoundError):
        pass
    os.close(lock)
    return None
