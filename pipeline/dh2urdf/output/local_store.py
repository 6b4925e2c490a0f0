"""A run's output in a folder of the file system."""

from __future__ import annotations

import os
import shutil
from contextlib import contextmanager, suppress
from errno import EACCES, EAGAIN
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from dh2urdf.documents.text_files import is_file
from dh2urdf.errors import OutputError
from dh2urdf.output.store import NOT_THERE, WORKING, ReportingStream, Store, checked
from dh2urdf.output.whole_files import TO_FOLDER, refused, reporting_os_errors, staging, write_all
from dh2urdf.source import Problem, shown

try:
    import fcntl
except ImportError:  # on Windows
    fcntl = None  # type: ignore[assignment]

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator
    from contextlib import AbstractContextManager

_TEMPORARY = f"{WORKING}/temporary"
_LOCK = f"{WORKING}/lock"
_NEW_FILE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
_LAST_LINE = os.O_WRONLY | os.O_CREAT | os.O_APPEND | getattr(os, "O_BINARY", 0)
_TRIES = 100
"""How often a lock is tried that another run seems to give back at this moment."""

_locked: set[str] = set()
"""Folders that this process has locked: the system keeps out other processes only."""


class LocalStore(Store):
    """A folder of the file system, made when its first file comes.

    A file is written among temporary ones, all in one folder, and renamed: there, what a killed process left is found
    without a search. Their names tell apart the processes of all machines that share the folder.

    Attributes:
        directory: the folder as the user wrote it, for messages.
    """

    def __init__(self, directory: Path) -> None:
        self.directory = directory
        self._root = os.path.abspath(directory)  # noqa: PTH100 - that a link be followed is the system's affair
        self._made: set[str] = set()
        self._protected: frozenset[str] = frozenset()
        self._temporary = -1, "", count()

    def __str__(self) -> str:
        return str(self.directory)

    def __reduce__(self) -> tuple[Callable[..., LocalStore], tuple[str, Path, frozenset[str]]]:
        return _in_another_process, (self._root, self.directory, self._protected)

    def protect(self, names: Iterable[str]) -> None:
        """Never write over some files, which are known by their names here, in lower case."""
        self._protected = frozenset(names)

    def is_protected(self, name: str) -> bool:
        """Whether a file is an input of the run, and must stay as it is."""
        return bool(self._protected) and name.casefold() in self._protected

    def _check_protected(self, name: str) -> None:
        if self.is_protected(name):
            place = shown(str(self.directory / name), 200)
            raise OutputError(
                Problem(message=f"{place} is an input, and would be overwritten", suggestion="write to another folder")
            )

    def write(self, name: str, content: bytes) -> None:
        """Write a file whole, in the place of an older one."""
        path = self._path(checked(name))
        self._check_protected(name)
        self._make_folders(name)
        try:
            try:
                self._write(path, content)
            except FileNotFoundError:  # Someone has removed a folder.
                self._made.clear()
                self._make_folders(name)
                self._write(path, content)
        except (OSError, ValueError) as error:
            raise refused(self.directory / name, error) from error

    def _write(self, path: str, content: bytes) -> None:
        # Plain system calls, as a run does this a million times. The temporary name is known before there is a file of
        # it, so that an interrupt, which may come between any two steps, leaves none.
        temporary = self._temporary_path()
        try:
            _write_file(temporary, _NEW_FILE, content)
            os.replace(temporary, path)  # noqa: PTH105
        except BaseException:
            with suppress(OSError):
                os.unlink(temporary)  # noqa: PTH108
            raise

    def _temporary_path(self) -> str:
        """A path that no other process on any machine uses, no other thread, and this one never again."""
        process, prefix, numbers = self._temporary
        if process != os.getpid():  # a new store, or a copy of one by a fork
            prefix, numbers = f"{self._path(_TEMPORARY)}/{os.urandom(6).hex()}-", count()
            self._temporary = os.getpid(), prefix, numbers
        return f"{prefix}{next(numbers)}"

    def put(self, name: str, path: Path) -> None:
        """Put a finished file of a folder of `scratch` where it belongs, in the place of an older one."""
        target = self._path(checked(name))
        self._check_protected(name)
        self._make_folders(name)
        with reporting_os_errors(self.directory / name):
            path.replace(target)

    def append(self, name: str, line: bytes) -> None:
        """Write a line at the end of a file, all at once: if the process is killed, no line but the last is torn."""
        path = self._path(checked(name))
        self._make_folders(name)
        with reporting_os_errors(self.directory / name):
            _write_file(path, _LAST_LINE, line)

    def read(self, name: str, *, offset: int = 0, size: int | None = None) -> bytes:
        """What is in a file, or some of it."""
        path = Path(self._path(checked(name)))
        with reporting_os_errors(self.directory / name, "read"), path.open("rb") as file:
            file.seek(offset)
            return file.read(-1 if size is None else size)

    def open(self, name: str) -> BinaryIO:
        """A file as a stream for reading from its beginning, which the caller closes."""
        path = Path(self._path(checked(name)))

        def reporting() -> AbstractContextManager[None]:
            return reporting_os_errors(self.directory / name, "read")

        with reporting():
            return ReportingStream.buffered(path.open("rb", buffering=0), reporting)

    def size(self, name: str) -> int | None:
        """How long a file is [byte]; None where there is none."""
        path = Path(self._path(checked(name)))
        with reporting_os_errors(self.directory / name, "read"):
            return path.stat().st_size if is_file(path) else None

    def names(self, folder: str = "") -> Iterator[str]:
        """The names of all files in a folder and below it."""
        top = self._path(checked(folder)) if folder else self._root

        def report(error: OSError) -> None:
            if not isinstance(error, NOT_THERE):
                raise refused(error.filename or top, error, "read") from error

        for parent, _, files in os.walk(top, onerror=report):
            for file in files:
                yield os.path.relpath(f"{parent}/{file}", self._root).replace(os.sep, "/")

    def remove(self, name: str) -> None:
        """Remove a file, if it is there, and the folder that was its own."""
        path = Path(self._path(checked(name)))
        with reporting_os_errors(self.directory / name, "remove"), suppress(*NOT_THERE):
            path.unlink()
        if folder := name.rpartition("/")[0]:
            with suppress(OSError):  # Others are in it.
                path.parent.rmdir()
                self._made.discard(folder)

    def remove_tree(self, folder: str) -> None:
        """Remove a folder and all in it, if it is there."""
        path = self._path(checked(folder))
        self._made.clear()
        with reporting_os_errors(self.directory / folder, "remove"), suppress(*NOT_THERE):
            shutil.rmtree(path)

    @contextmanager
    def scratch(self) -> Iterator[Path]:
        """A folder for files in the making, on the same file system, so that `put` is a rename."""
        self._make_folders("")
        with staging(Path(self._path(_TEMPORARY))) as folder:
            yield folder

    @contextmanager
    def lock(self) -> Iterator[None]:
        """Keep other runs out of this folder, and remove what was left in it by one that was killed.

        The system gives the lock back when this process ends, however it ends; its children do not have it. Where the
        system or the file system has no locks, there is none.
        """
        place = os.path.realpath(self._root)
        if place in _locked:
            raise self._is_at_work()
        _locked.add(place)
        try:
            lock = self._lock_file()
            try:
                self.remove_tree(_TEMPORARY)
                yield
            finally:
                if fcntl is None:  # Windows removes no file that is open, and the file is no lock there.
                    os.close(lock)
                with suppress(OSError, OutputError):
                    self.remove_tree(_TEMPORARY)
                    os.unlink(self._path(_LOCK))  # noqa: PTH108
                    os.rmdir(self._path(WORKING))  # noqa: PTH106 - unless the run keeps something there
                if fcntl is not None:
                    with suppress(OSError):  # The file is empty, and the lock is given back all the same.
                        os.close(lock)
        finally:
            _locked.discard(place)

    def _lock_file(self) -> int:
        """The descriptor of the lock file, locked until it is closed."""
        # A run that ends removes the file and, if it can, the folder: at any moment, so it may take some tries.
        with reporting_os_errors(self.directory, TO_FOLDER):
            for left in reversed(range(_TRIES)):
                try:
                    os.makedirs(self._path(WORKING), exist_ok=True)  # noqa: PTH103
                    lock = os.open(self._path(_LOCK), os.O_RDWR | os.O_CREAT, 0o666)
                except (FileNotFoundError, FileExistsError):  # makedirs meets a folder that is gone when it looks again
                    if not left:
                        raise
                    continue
                if self._has_locked(lock):
                    return lock
                os.close(lock)
        raise self._is_at_work()

    def _has_locked(self, lock: int) -> bool:
        """Lock a lock file; whether it still has its name then."""
        try:
            if fcntl is not None:
                # A lock of POSIX: unlike one of flock(2), no child has it after a fork.
                fcntl.lockf(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            if error.errno not in (EACCES, EAGAIN):
                return True
            os.close(lock)
            raise self._is_at_work() from error
        try:
            return os.path.samestat(os.fstat(lock), os.stat(self._path(_LOCK)))  # noqa: PTH116
        except FileNotFoundError:
            return False

    def _is_at_work(self) -> OutputError:
        return OutputError(
            Problem(
                message=f"another run is at work in {shown(str(self), 200)}",
                suggestion="wait until it ends, or write to another folder",
            )
        )

    def _path(self, name: str) -> str:
        return f"{self._root}/{name}"

    def _make_folders(self, name: str) -> None:
        """Make the folder of a file, and the one of temporary files; each is made once."""
        folder = name.rpartition("/")[0]
        if folder in self._made:
            return
        with reporting_os_errors(self.directory, TO_FOLDER):
            os.makedirs(self._path(_TEMPORARY), exist_ok=True)  # noqa: PTH103
        with reporting_os_errors(self.directory / folder, TO_FOLDER):
            os.makedirs(self._path(folder), exist_ok=True)  # noqa: PTH103
        self._made.add(folder)


def _in_another_process(root: str, directory: Path, protected: frozenset[str]) -> LocalStore:
    """A local store where relative paths may mean something else."""
    store = LocalStore(Path(root))
    store.directory = directory
    store.protect(protected)
    return store


def _write_file(path: str, flags: int, content: bytes) -> None:
    """Open a file, write to it and close it."""
    descriptor = os.open(path, flags, 0o666)
    try:
        write_all(descriptor, content)
    finally:
        os.close(descriptor)
