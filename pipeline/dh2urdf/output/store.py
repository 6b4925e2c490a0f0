"""Where the output of a run goes: a folder, or a prefix of an object store.

A store holds files under relative names with ``/`` between their parts. Each file appears whole or not at all and
replaces an older one at once, so a run that is killed at any moment leaves no half of a file under a final name. No
file is forced onto the disk, which would cost a hundred times the writing: what a power cut takes is found by the
hashes of the manifest when the run is resumed.
"""

from __future__ import annotations

import fcntl
import os
import shutil
from contextlib import contextmanager, suppress
from errno import EACCES, EAGAIN
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO, TypeAlias

from dh2urdf.documents.text_files import is_file
from dh2urdf.errors import OutputError
from dh2urdf.output.whole_files import NOT_THERE, TO_FOLDER, checked, refused, reporting_os_errors, staging, write_all
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from dh2urdf.output.remote_store import RemoteStore

say = Messages(__file__)

Store: TypeAlias = "LocalStore | RemoteStore"
"""A place for files under relative names; both kinds have the methods of `LocalStore`, except `append` and `protect`.

A worker process, here or on another machine, gets a pickled store and reaches the same place. The text of a store is
for messages, and shows no password. Every method raises `OutputError` where the place refuses, and for a name that
would lead out of the store.
"""
WORKING = ".dh2urdf"
"""The folder of a store for what only the run itself needs: its journal, its lock, temporary files."""
_TEMPORARY = f"{WORKING}/temporary"
_LOCK = f"{WORKING}/lock"
_TRIES = 100
"""How often a lock is tried that another run seems to give back at this moment."""

_locked: set[str] = set()
"""Folders that this process has locked: the system keeps out other processes only."""


def open_store(address: str | Path) -> Store:
    """The store at an address: a path, or anything that fsspec knows, such as ``s3://bucket/prefix``.

    Nothing is read or written yet.

    Raises:
        OutputError: there is no such kind of address.
        MissingDependencyError: a package that reaches such addresses is not installed.
    """
    scheme, separator, path = str(address).partition("://")
    if not separator or isinstance(address, Path):
        return LocalStore(Path(address))
    if scheme.casefold() in ("file", "local"):
        return LocalStore(Path(path))
    from dh2urdf.output.remote_store import RemoteStore

    return RemoteStore(str(address))


class LocalStore:
    """A folder of the file system, made when its first file comes.

    A file is written among temporary ones, all in one folder, and renamed: what a killed process left is found there
    without a search.

    Attributes:
        directory: the folder as the user wrote it, for messages.
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._root = os.path.abspath(directory)  # noqa: PTH100 - links are for the system to follow
        self._protected: frozenset[str] = frozenset()

    def __str__(self) -> str:
        return str(self.directory)

    def protect(self, names: Iterable[str]) -> None:
        """Never write over some files, which are known by their names here, in lower case."""
        self._protected = frozenset(names)

    def is_protected(self, name: str) -> bool:
        """Whether a file is an input of the run, and must stay as it is."""
        return bool(self._protected) and name.casefold() in self._protected

    def write(self, name: str, content: bytes) -> None:
        """Write a file whole, in the place of an older one."""
        # Plain system calls, since a run does this a million times. The temporary name is known before there is a file,
        # so that an interrupt, which may come between any two steps, leaves none.
        temporary = f"{self._root}/{_TEMPORARY}/{os.urandom(8).hex()}"

        def create(path: str) -> None:
            _write_file(temporary, os.O_TRUNC, content)
            os.replace(temporary, path)  # noqa: PTH105

        try:
            self._create(name, create)
        except BaseException:
            with suppress(OSError, ValueError):
                os.unlink(temporary)  # noqa: PTH108
            raise

    def put(self, name: str, path: Path) -> None:
        """Put a finished file of a folder of `scratch` where it belongs, in the place of an older one."""
        self._create(name, path.replace)

    def append(self, name: str, lines: bytes) -> None:
        """Write lines at the end of a file in one call, so that a kill tears no line but the last."""
        self._create(name, lambda path: _write_file(path, os.O_APPEND, lines))

    def _create(self, name: str, create: Callable[[str], object]) -> None:
        path = self._path(name)
        if self.is_protected(name):
            raise OutputError(say("input-overwritten", found=name, path=self.directory / name, other=""))
        try:
            try:
                create(path)
            except NOT_THERE:  # It is the first file of its folder, or somebody has removed the folder.
                folder = name.rpartition("/")[0]
                with reporting_os_errors(self.directory / folder, TO_FOLDER):
                    for each in (_TEMPORARY, folder):
                        os.makedirs(f"{self._root}/{each}", exist_ok=True)  # noqa: PTH103
                create(path)
        except (OSError, ValueError) as error:
            raise refused(self.directory / name, error) from error

    def read(self, name: str) -> bytes:
        """Return the content of a file."""
        with self.open(name) as file:
            return file.read()

    @contextmanager
    def open(self, name: str) -> Iterator[BinaryIO]:
        """Open a file for reading from its beginning."""
        path = Path(self._path(name))
        with reporting_os_errors(self.directory / name, "read"), path.open("rb") as file:
            yield file

    def size(self, name: str) -> int | None:
        """Return the length of a file [byte]; None if there is no such file."""
        path = Path(self._path(name))
        with reporting_os_errors(self.directory / name, "read"):
            return path.stat().st_size if is_file(path) else None

    def names(self, folder: str = "") -> Iterator[str]:
        """Yield the names of all files in a folder and below it, in no particular order; no folder is an empty one."""
        top = self._path(folder) if folder else self._root

        def report(error: OSError) -> None:
            if not isinstance(error, NOT_THERE):
                raise refused(error.filename or top, error, "read") from error

        for parent, _, files in os.walk(top, onerror=report):
            for file in files:
                yield os.path.relpath(f"{parent}/{file}", self._root)

    def remove(self, name: str) -> None:
        """Remove a file, if it is there, and the folder that was its own."""
        path = Path(self._path(name))
        with reporting_os_errors(self.directory / name, "remove"), suppress(*NOT_THERE):
            path.unlink()
        if "/" in name:
            with suppress(OSError):  # Others are in it.
                path.parent.rmdir()

    def remove_tree(self, folder: str) -> None:
        """Remove a folder and all in it, if it is there."""
        path = self._path(folder)
        with reporting_os_errors(self.directory / folder, "remove"), suppress(*NOT_THERE):
            shutil.rmtree(path)

    @contextmanager
    def scratch(self) -> Iterator[Path]:
        """Yield a folder for files in the making, on the same file system, so that `put` is a rename."""
        with staging(Path(self._path(_TEMPORARY))) as folder:
            yield folder

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Keep other runs out of this folder, and remove what a killed run left in it.

        The system gives the lock back when this process ends, however it ends; its children do not have it. On a file
        system without locks there is none.

        Raises:
            OutputError: another run is at work here.
        """
        place = os.path.realpath(self._root)
        another = OutputError(say("store-busy", store=str(self)))
        if place in _locked:
            raise another
        _locked.add(place)
        try:
            lock = self._lock_file()
            if lock is None:
                raise another
            try:
                self.remove_tree(_TEMPORARY)
                yield
            finally:
                with suppress(OSError, OutputError):
                    self.remove_tree(_TEMPORARY)
                    os.unlink(self._path(_LOCK))  # noqa: PTH108
                    os.rmdir(self._path(WORKING))  # noqa: PTH106 - unless the run keeps something there
                with suppress(OSError):  # The file is empty, and the lock is given back all the same.
                    os.close(lock)
        finally:
            _locked.discard(place)

    def _lock_file(self) -> int | None:
        """Return the descriptor of the lock file, locked until it is closed; None where another process has it."""
        # A run that ends removes the file and, if it can, the folder, at any moment: so it may take some tries.
        with reporting_os_errors(self.directory, TO_FOLDER):
            for left in reversed(range(_TRIES)):
                try:
                    os.makedirs(self._path(WORKING), exist_ok=True)  # noqa: PTH103
                    lock = os.open(self._path(_LOCK), os.O_RDWR | os.O_CREAT, 0o666)
                except (FileNotFoundError, FileExistsError):  # makedirs meets a folder that is gone when it looks again
                    if not left:
                        raise
                    continue
                try:
                    # A lock of POSIX: unlike one of flock(2), no child has it after a fork.
                    fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                    if os.path.samestat(os.fstat(lock), os.stat(self._path(_LOCK))):  # noqa: PTH116
                        return lock
                except FileNotFoundError:
                    pass  # It was removed before it was locked.
                except OSError as error:
                    if error.errno not in (EACCES, EAGAIN):
                        return lock
                    left = 0  # noqa: PLW2901 - another run has it
                os.close(lock)
                if not left:
                    return None
        return None

    def _path(self, name: str) -> str:
        return f"{self._root}/{checked(name)}"


def _write_file(path: str, flags: int, content: bytes) -> None:
    """Open a file, write to it and close it."""
    descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | flags, 0o666)
    try:
        write_all(descriptor, content)
    finally:
        os.close(descriptor)
