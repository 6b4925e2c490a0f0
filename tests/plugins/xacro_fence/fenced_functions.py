"""What the tests of the fence try in a child process."""

from __future__ import annotations

import os
import socket
import subprocess
from typing import TYPE_CHECKING, Any

from dh2urdf.isolation import enter

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


def fenced(folder: Path, deed: str) -> str:
    """What becomes of a deed behind the fence, without any check of expressions."""
    import ctypes

    enter([folder], 1.0 if deed == "time" else 5.0)
    deeds: dict[str, Callable[[], Any]] = {
        "read inside": (folder / "inside.txt").read_text,
        "read outside": (folder.parent / "home" / "secret.yaml").read_text,
        "read by descriptor": lambda: os.read(os.open(folder.parent / "home" / "secret.yaml", os.O_RDONLY), 100),
        "write inside": lambda: (folder / "new.txt").write_text("x"),
        "append inside": lambda: (folder / "inside.txt").open("a"),
        "remove": (folder / "inside.txt").unlink,
        "run": lambda: subprocess.run(["true"], check=True),  # noqa: S607
        "shell": lambda: os.system("true"),  # noqa: S605, S607
        "fork": os.fork,
        "connect": lambda: socket.create_connection(("127.0.0.1", 9)),
        "library": lambda: ctypes.CDLL("libc.so.6"),
        "memory": lambda: len(bytearray(2**32)),
        "time": lambda: sum(1 for _ in iter(int, 1)),
    }
    try:
        return str(deeds[deed]())
    except (OSError, MemoryError) as error:
        return type(error).__name__


def landlocked(folder: Path) -> str:
    """What the kernel says without Python's own hook."""
    from dh2urdf.isolation.fence import _lock

    _lock([str(folder)])
    try:
        return (folder.parent / "home" / "secret.yaml").read_text()
    except PermissionError:
        return "refused by the kernel"
