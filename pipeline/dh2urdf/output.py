"""Files that appear whole, under names that are safe, or not at all."""

from __future__ import annotations

import os
import unicodedata
from contextlib import contextmanager, suppress
from errno import EISDIR
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.errors import OutputError
from dh2urdf.source import Problem, shown

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.stages import EmittedFile

LONGEST_STEM = 120
"""Bytes of a file name's stem [1]: file systems take 255 for the whole name, and suffixes need their share."""
_STAGING = ".dh2urdf-"
_DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))}


def safe_stem(name: str) -> str:
    """A manipulator's name as the stem of file names, safe on every file system.

    Letters, digits, ``.``, ``-``, ``+`` and ``_`` stay; anything else becomes ``_``. A stem never begins with a dot or
    a dash, is no device name of Windows, and where it was cut short it ends in a hash of the whole name.
    """
    composed = unicodedata.normalize("NFC", name)
    stem = "".join(c if c.isalnum() or c in ".-+_" else "_" for c in composed).strip("._-") or "robot"
    device, dot, rest = stem.partition(".")
    if device.casefold() in _DEVICES:  # with any suffix
        stem = f"{device}_{dot}{rest}"
    if len(stem.encode()) > LONGEST_STEM:
        digest = sha256(name.encode(errors="surrogatepass")).hexdigest()[:12]
        stem = f"{stem.encode()[: LONGEST_STEM - 13].decode(errors='ignore')}-{digest}"
    return stem


class Stems:
    """Gives every manipulator of a run a stem of its own, also where the file system ignores case."""

    def __init__(self) -> None:
        self._owners: dict[str, str] = {}

    def claim(self, name: str, *, remember: bool = True) -> tuple[str, Problem | None]:
        """The stem of a manipulator, and a notice where another one already has the stem of its name.

        Args:
            name: the manipulator's name.
            remember: whether another one may yet ask for the same stem.
        """
        wanted = stem = safe_stem(name)
        number = 1
        while self._key(stem) in self._owners:
            number += 1
            stem = f"{wanted}-{number}"
        if remember:
            self._owners[self._key(stem)] = name
        if number == 1:
            return stem, None
        return stem, Problem(
            message=(
                f"its files are named {stem!r}: {wanted!r} belongs to the manipulator "
                f"{shown(self._owners[self._key(wanted)])} of this run"
            ),
            severity="notice",
            robot=name,
        )

    @staticmethod
    def _key(stem: str) -> str:
        return unicodedata.normalize("NFC", stem.casefold())


@contextmanager
def staging(directory: Path) -> Iterator[Path]:
    """A temporary folder inside an output folder, gone at the end whatever happens.

    Files are written and proved there, and then moved into place by `put_in_place`: a rename within one file system.

    Raises:
        OutputError: the folder cannot be made.
    """
    with reporting_os_errors(directory):
        directory.mkdir(parents=True, exist_ok=True)
    # The name is known before there is a folder of it, and an interrupt, which may come between any two steps and while
    # the folder is being removed, has it removed again: so nothing is left at any moment.
    folder = directory / f"{_STAGING}{os.urandom(6).hex()}"
    try:
        try:
            with reporting_os_errors(directory):
                folder.mkdir(mode=0o700)
            yield folder
        finally:
            _remove(folder)
    except BaseException:
        _remove(folder)
        raise


def _remove(folder: Path) -> None:
    """Remove a staging folder, which holds files alone; an interrupt meanwhile goes its way as what it is.

    (In `shutil.rmtree` it may become an OSError, and it costs twice the time.)
    """
    with suppress(OSError):
        for name in os.listdir(folder):  # noqa: PTH208 - a few microseconds for each manipulator of a million
            os.unlink(folder / name)  # noqa: PTH108
        folder.rmdir()


def write_files(folder: Path, files: Sequence[EmittedFile]) -> None:
    """Write an emitter's files into a staging folder.

    Raises:
        OutputError: a file cannot be written, or its name is not a plain file name.
    """
    for file in files:
        if Path(file.name).name != file.name or file.name in ("", ".", ".."):
            raise OutputError(Problem(message=f"{shown(file.name)} is not a plain file name", found=file.name))
        with reporting_os_errors(folder.parent / file.name):
            (folder / file.name).write_bytes(file.content)


def put_in_place(folder: Path, names: Sequence[str], directory: Path) -> None:
    """Move files from a staging folder to where they belong, each replacing an older one at once.

    Raises:
        OutputError: a file cannot be moved; where a folder stands in the way of one, none is.
    """
    for name in names:
        with reporting_os_errors(directory / name):
            if (directory / name).is_dir():
                raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
    for name in names:
        with reporting_os_errors(directory / name):
            (folder / name).replace(directory / name)


def write_whole(path: Path, content: bytes) -> None:
    """Write one file whole, or leave what stood there.

    Raises:
        OutputError: it cannot be written.
    """
    with staging(path.parent) as folder, reporting_os_errors(path):
        (folder / path.name).write_bytes(content)
        (folder / path.name).replace(path)


@contextmanager
def reporting_os_errors(path: Path) -> Iterator[None]:
    """Turn what the operating system says of a path into one line.

    Raises:
        OutputError: whatever OSError came, or the ValueError of a path that no system has.
    """
    try:
        yield
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise OutputError(Problem(message=f"cannot write {shown(str(path), 200)}: {reason}")) from error
