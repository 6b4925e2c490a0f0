"""The files that a stranger's xacro may read: those of its own package, and of the packages that the user names."""

from __future__ import annotations

import errno
import glob
import io
import os
import stat
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.meshes import own_folder, with_its_own

if TYPE_CHECKING:
    from collections.abc import Mapping

MAX_FILE = 2**26  # size of a file that is read [B]
MAX_BYTES = 2**28  # size of all files together, each time that one is read [B]
MAX_FILES = 10_000  # how often a file is read


class FileError(Exception):
    """A file that must not be read."""


class Files:
    """Opens files below some folders, and nothing else: of the file that is expanded, and of named packages."""

    def __init__(self, path: Path, packages: Mapping[str, Path]) -> None:
        own = own_folder(path)
        self.packages = {name: folder.resolve() for name, folder in with_its_own(path, packages).items()}
        self.roots = tuple(dict.fromkeys((own, path.absolute().parent.resolve(), *self.packages.values())))
        self._read = self._bytes = 0

    def package(self, name: str) -> str:
        """The folder of a package, as ``$(find NAME)`` asks for it."""
        folder = self.packages.get(name)
        if folder is None:
            known = ", ".join(sorted(self.packages)) or "none"
            raise FileError(f"the package {name!r} is not known (known: {known})")
        return str(folder)

    def open(self, name: str, mode: str = "r") -> io.StringIO | io.BytesIO:
        """The content of a file."""
        path = self._inside(name)
        handle = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_CLOEXEC", 0))
        with os.fdopen(handle, "rb") as file:
            status = os.fstat(file.fileno())
            if not stat.S_ISREG(status.st_mode):
                raise FileError(f"{name!r} is no ordinary file")
            content = file.read(MAX_FILE + 1)
        self._read += 1
        self._bytes += len(content)
        if len(content) > MAX_FILE or self._bytes > MAX_BYTES or self._read > MAX_FILES:
            raise FileError(f"{name!r} is too large, or too many files are read")
        return io.BytesIO(content) if "b" in mode or content.lstrip()[:1] == b"<" else io.StringIO(content.decode())

    def glob(self, pattern: str) -> list[str]:
        """The files below the folders that a pattern means."""
        fixed = pattern[: next(k for k, c in enumerate(pattern) if c in "*?[")]
        self._inside(os.path.dirname(fixed) or ".")  # noqa: PTH120 - the beginning of a pattern
        found: list[str] = []
        for name in glob.iglob(pattern):  # noqa: PTH207 - as xacro understands a pattern
            found.append(name)
            if len(found) > MAX_FILES:
                raise FileError(f"{pattern!r} means more than {MAX_FILES} files")
        return found

    def _inside(self, name: str) -> Path:
        path = Path(os.path.realpath(name))
        if not any(path.is_relative_to(root) for root in self.roots):
            raise FileError(f"{name!r} is outside the folders that this file may read")
        if not path.exists():
            raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), name)
        return path
