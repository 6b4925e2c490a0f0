"""Where the output of a run goes: a folder, or a prefix of an object store.

A store holds files under relative names with ``/`` between their parts. Each appears whole or not at all and replaces
an older one at once, so that a run that is killed at any moment leaves no half of a file under a final name. No file is
forced onto the disk, which would cost a hundred times the writing: what a power cut takes is found by the hashes of the
manifest when the run is resumed.
"""

from __future__ import annotations

import io
from abc import ABC, abstractmethod
from typing import TYPE_CHECKING, Any, BinaryIO, cast

from dh2urdf.errors import OutputError
from dh2urdf.output.whole_files import NO_NAMES, READ_AT_ONCE
from dh2urdf.source import Problem, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
    from contextlib import AbstractContextManager
    from pathlib import Path

WORKING = ".dh2urdf"
"""The folder of a store for what only the run itself needs: its journal, its lock, temporary files."""
NOT_THERE = (FileNotFoundError, NotADirectoryError)
"""What says that a file is missing; the second, where another file stands for a folder above it."""


class Store(ABC):
    """A place for files under relative names.

    A worker process, here or on another machine, gets a pickled one and reaches the same place. Its text is for
    messages, and shows no password. Every method raises `OutputError` where the place refuses, and where a name is none
    of a file in it: absolute, with ``..`` or with a backslash.
    """

    @abstractmethod
    def write(self, name: str, content: bytes) -> None:
        """Write a file whole, in the place of an older one."""

    @abstractmethod
    def put(self, name: str, path: Path) -> None:
        """Put a finished file of a folder of `scratch` where it belongs, in the place of an older one."""

    @abstractmethod
    def read(self, name: str, *, offset: int = 0, size: int | None = None) -> bytes:
        """What is in a file, or some of it: so many bytes from an offset on, fewer where the file ends."""

    @abstractmethod
    def open(self, name: str) -> BinaryIO:
        """A file as a stream for reading from its beginning, which the caller closes."""

    @abstractmethod
    def size(self, name: str) -> int | None:
        """How long a file is [byte]; None where there is none."""

    @abstractmethod
    def names(self, folder: str = "") -> Iterator[str]:
        """The names of all files in a folder and below it, in no particular order; no folder is an empty one."""

    @abstractmethod
    def remove(self, name: str) -> None:
        """Remove a file, if it is there, and the folder that was its own."""

    def is_protected(self, _name: str) -> bool:
        """Whether a file is an input of the run, and must stay as it is."""
        return False

    @abstractmethod
    def remove_tree(self, folder: str) -> None:
        """Remove a folder and all in it, if it is there."""

    @abstractmethod
    def scratch(self) -> AbstractContextManager[Path]:
        """A local folder for files in the making, gone at the end whatever happens; no folders are made in it."""

    @abstractmethod
    def lock(self) -> AbstractContextManager[None]:
        """Keep other runs out of this place, and remove what was left in it by one that was killed.

        Raises:
            OutputError: another run is at work here.
        """


def checked(name: str) -> str:
    """A name of a file in a store.

    Raises:
        OutputError: it is none: it leads out of the store, or means another file on another system.
    """
    if "\\" in name or not NO_NAMES.isdisjoint(name.split("/")):
        raise OutputError(Problem(message=f"{shown(name)} is not a plain relative name", found=name))
    return name


class ReportingStream(io.RawIOBase):
    """A stream for reading whose errors name its store."""

    def __init__(self, stream: Any, reporting: Callable[[], AbstractContextManager[None]]) -> None:  # noqa: ANN401
        self._stream, self._reporting = stream, reporting

    @classmethod
    def buffered(cls, stream: Any, reporting: Callable[[], AbstractContextManager[None]]) -> BinaryIO:  # noqa: ANN401
        """Such a stream that reads ahead."""
        return cast("BinaryIO", io.BufferedReader(cls(stream, reporting), READ_AT_ONCE))

    def readable(self) -> bool:
        """It is."""
        return True

    def readinto(self, buffer: Any) -> int:  # noqa: ANN401 - whatever has the interface of a buffer
        """Fill a buffer, as far as the stream goes."""
        with self._reporting():
            return cast("int", self._stream.readinto(buffer))

    def close(self) -> None:
        """Close the stream too."""
        with self._reporting():
            self._stream.close()
        super().close()
