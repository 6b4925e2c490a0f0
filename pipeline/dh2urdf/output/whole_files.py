"""Files that appear whole, under names that are safe, or not at all."""

from __future__ import annotations

import os
import re
import unicodedata
from contextlib import contextmanager, suppress
from errno import EACCES, EBADF, EDQUOT, EISDIR, ENAMETOOLONG, ENOSPC, EPERM, EROFS
from itertools import permutations, product
from pathlib import Path, PurePosixPath
from typing import TYPE_CHECKING

from dh2urdf.documents.text_files import ADDRESS, is_file, is_folder, is_there
from dh2urdf.errors import OutputError
from dh2urdf.source import Messages, Problem, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from dh2urdf.stages import EmittedFile

say = Messages(__file__)

LONGEST_STEM = 120
"""Bytes of a file name's stem: file systems take 255 for the whole name, and suffixes need their share."""
NO_NAMES = frozenset(("", ".", ".."))
"""What no part of a relative name may be."""
NOT_THERE = (FileNotFoundError, NotADirectoryError)
"""The errors of a missing file; the second, where another file stands for a folder above it."""
_STAGING = ".dh2urdf-"
_ADVICE = {
    **dict.fromkeys((ENOSPC, EDQUOT), "make room, or write to another disk; a run goes on with `--resume`"),
    **dict.fromkeys((EACCES, EPERM, EROFS), "write to another folder"),
    EISDIR: "a folder has this name: write to another name",
    ENAMETOOLONG: "write to a shorter name",
}
"""What to do where the operating system writes no file."""
TO_FOLDER = "write to the folder"
"""What is being done where a file cannot be made because of its folder."""
_SAFE = r"[A-Za-z0-9](?:[A-Za-z0-9.+_-]*[A-Za-z0-9+])?"
_DEVICES = {"con", "prn", "aux", "nul", *(f"{port}{n}" for port in ("com", "lpt") for n in range(1, 10))}


def safe_stem(name: str) -> str:
    """A manipulator's name as the stem of file names, safe on every file system.

    Letters, digits, ``.``, ``-``, ``+`` and ``_`` stay; anything else becomes ``_``. A stem never begins with a dot or
    a dash, is no device name of Windows, and where it was cut short it ends in a hash of the whole name.
    """
    plain = name.isascii() and name.isalnum()
    if (
        len(name) <= LONGEST_STEM
        and (plain or re.fullmatch(_SAFE, name))
        and name.partition(".")[0].lower() not in _DEVICES
    ):
        return name  # as nearly all are; what follows gives the same
    composed = unicodedata.normalize("NFC", name)
    stem = "".join(c if c.isalnum() or c in ".-+_" else "_" for c in composed).strip("._-") or "robot"
    device, dot, rest = stem.partition(".")
    if device.casefold() in _DEVICES:  # with any suffix
        stem = f"{device}_{dot}{rest}"
    if len(stem.encode()) > LONGEST_STEM:
        from hashlib import sha256

        digest = sha256(name.encode(errors="surrogatepass")).hexdigest()[:12]
        stem = f"{stem.encode()[: LONGEST_STEM - 13].decode(errors='ignore')}-{digest}"
    return stem


class NameSet:
    """A set of names that only grows.

    Of a million names, two have the same hash once in forty million runs: a name then counts as known that is new.
    """

    def __init__(self) -> None:
        self._hashes: set[int] = set()

    def known(self, names: Iterable[str]) -> set[str]:
        """Return those of some names that were added before."""
        return {name for name in names if hash(name) in self._hashes}

    def add(self, names: Iterable[str]) -> None:
        """Remember some names."""
        self._hashes.update(map(hash, names))


class Stems:
    """Gives every manipulator of a run a stem of its own, also where the file system ignores case.

    Args:
        stem_of: the stem that a name has by itself.
        endings: what each writer of files puts behind a stem. Where the ``.sim.png`` of one is the ``.png`` of another
            behind ``.sim``, a run has no stems ``ur5`` and ``ur5.sim``: both would name ``ur5.sim.png``.
        own_files: names of files that are the run's own.
    """

    def __init__(
        self,
        stem_of: Callable[[str], str] = safe_stem,
        endings: Sequence[Sequence[str]] = (),
        own_files: Sequence[str] = (),
    ) -> None:
        self._stem_of = stem_of
        self._taken = NameSet()
        self._numbers: dict[str, int] = {}  # how often a stem was wanted, of those that were wanted again
        pairs = [pair for one, other in permutations(endings, 2) for pair in product(one, other)]
        self._tails = {
            longer.removesuffix(shorter) for longer, shorter in pairs if longer != shorter and longer.endswith(shorter)
        }
        ends = [ending for some in endings for ending in some]
        self._taken.add(name.removesuffix(end) for name in own_files for end in ends if name.endswith(end))

    def claim(self, name: str) -> tuple[str, Problem | None]:
        """The stem of a manipulator, and a notice where another one already has the stem of its name."""
        wanted = stem = self._stem_of(name)
        first = key = self._key(wanted)
        number = self._numbers.get(first, 1)
        while self._taken.known([key, *self._kept(key)]):
            number += 1
            stem = f"{wanted}-{number}"
            key = self._key(stem)
        self._taken.add([key])
        if number == 1:
            return stem, None
        self._numbers[first] = number
        return stem, say("stem-changed", robot=name, stem=stem, wanted=wanted)

    def _kept(self, key: str) -> list[str]:
        """The stems besides it that a stem keeps from others."""
        before = [key.removesuffix(tail) for tail in self._tails if key.endswith(tail)]
        return before + [key + tail for tail in self._tails]

    @staticmethod
    def _key(stem: str) -> str:
        return stem.lower() if stem.isascii() else unicodedata.normalize("NFC", stem.casefold())


@contextmanager
def staging(directory: Path) -> Iterator[Path]:
    """A temporary folder inside an output folder, gone at the end whatever happens.

    Files are written and proved there, and then moved into place by `put_in_place`: a rename within one file system.
    Where that fails, no empty output folder is left that was not there before.

    Raises:
        OutputError: the folder cannot be made.
    """
    new: list[Path] = []
    for place in (directory, *directory.parents):
        if is_there(place):
            break
        new.append(place)
    make_folder(directory)
    # The name is known before there is a folder of it, and an interrupt, which may come between any two steps and while
    # the folder is being removed, has it removed again: so nothing is left at any moment.
    folder = directory / f"{_STAGING}{os.urandom(6).hex()}"
    try:
        try:
            with reporting_os_errors(directory, TO_FOLDER):
                folder.mkdir(mode=0o700)
            yield folder
        finally:
            _remove(folder)
    except BaseException:
        _remove(folder)
        with suppress(OSError):  # One with other files in it stays, and so do those above.
            for place in new:
                place.rmdir()
        raise


def make_folder(directory: Path) -> None:
    """Make a folder and those above it, where they are not there.

    Raises:
        OutputError: it cannot be made; or it is an address, for which a folder called ``s3:`` would be made here.
    """
    if re.match(ADDRESS, str(directory)) and not is_folder(Path(directory.parts[0])):
        raise OutputError(say("address-not-folder", path=str(directory)))
    with reporting_os_errors(directory, TO_FOLDER):
        directory.mkdir(parents=True, exist_ok=True)


def _remove(folder: Path) -> None:
    """Remove a staging folder; an interrupt meanwhile goes its way as what it is.

    (In `shutil.rmtree` it may become an OSError, and it costs twice the time.)
    """
    with suppress(OSError):
        for name in os.listdir(folder):  # noqa: PTH208 - a few microseconds for each manipulator of a million
            try:
                os.unlink(folder / name)  # noqa: PTH108
            except (IsADirectoryError, PermissionError):  # the second, of a folder, on macOS and Windows
                _remove(folder / name)
        folder.rmdir()


def write_files(folder: Path, files: Sequence[EmittedFile], place: str = "") -> None:
    """Write an emitter's files into a staging folder.

    Args:
        folder: the staging folder.
        files: the files.
        place: where they will be in the end, for messages; by default the folder above.

    Raises:
        OutputError: a file cannot be written, or its name leads out of the folder.
    """
    for file in files:
        path = PurePosixPath(checked(file.name))
        with reporting_os_errors(f"{place}/{file.name}" if place else folder.parent / file.name):
            if len(path.parts) > 1:
                (folder / path).parent.mkdir(parents=True, exist_ok=True)
            (folder / file.name).write_bytes(file.content)


def checked(name: str) -> str:
    """A name of a file in a store.

    Raises:
        OutputError: it leads out of the store, or means another file on another system.
    """
    if "\\" in name or not NO_NAMES.isdisjoint(name.split("/")):
        raise OutputError(say("not-a-plain-name", found=name))
    return name


def refuse_inputs(targets: Iterable[Path], inputs: Iterable[Path]) -> None:
    """Refuses to write over a file that is read, under whatever name: by a link, or in other letters' case.

    Args:
        targets: the files that are to be written.
        inputs: the files that are read.

    Raises:
        OutputError: a target is an input; it names both.
    """
    read = [(path, *_places(path)) for path in dict.fromkeys(inputs)]
    for target in targets:
        identity, folded = _places(target)
        for path, its_identity, its_folded in read:
            if folded == its_folded or (identity is not None and identity == its_identity):
                other = "" if str(path) == str(target) else f", which is {shown(str(target), 200)}"
                raise OutputError(say("input-overwritten", found=str(target), path=path, other=other))


def _places(path: Path) -> tuple[tuple[int, int] | None, str]:
    """Return the file behind a path, if there is one, and the path as a file system that ignores case has it."""
    whole = os.path.join(os.path.realpath(path.parent), path.name)  # noqa: PTH118
    folded = unicodedata.normalize("NFC", unicodedata.normalize("NFC", whole).casefold())
    with suppress(OSError, ValueError):
        status = os.stat(path)  # noqa: PTH116 - Path.stat is the same, and twice as slow
        return (status.st_dev, status.st_ino), folded
    return None, folded


def put_in_place(folder: Path, names: Sequence[str], directory: Path) -> None:
    """Move files from a staging folder to where they belong, each replacing an older one at once.

    Raises:
        OutputError: a file cannot be moved; where a folder is in the way of one, none is.
    """
    for name in names:
        refuse_no_file(directory / name)
    for name in names:
        with reporting_os_errors(directory / name):
            if "/" in name:
                (directory / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).replace(directory / name)


def refuse_no_file(path: Path) -> None:
    """Refuse a path at which something else than a file is, which a rename would remove: `/dev/null` is there for all.

    Raises:
        OutputError: there is a folder, a device, a pipe or a socket, a link to one, or one to an open file.
    """
    with reporting_os_errors(path):
        if is_folder(path):
            raise IsADirectoryError(EISDIR, os.strerror(EISDIR))
        is_open_file = path.is_symlink() and str(path.readlink()).startswith("/proc/")
        is_other = is_there(path) and not is_file(path)
    if is_open_file or is_other:
        raise OutputError(say("device-not-writable", found=str(path)))


def write_whole(path: Path, content: bytes) -> None:
    """Write one file whole, or leave what was there.

    Raises:
        OutputError: it cannot be written.
    """
    refuse_no_file(path)
    with staging(path.parent) as folder, reporting_os_errors(path):
        (folder / path.name).write_bytes(content)
        (folder / path.name).replace(path)


def write_all(descriptor: int, content: bytes) -> None:
    """Write all of a content to an open file, in one call of the system if it can be."""
    written = os.write(descriptor, content)
    while written < len(content):  # The disk is full, and the next call reports it; or this one took its most, 2 GB.
        written += os.write(descriptor, memoryview(content)[written:])


@contextmanager
def reporting_os_errors(path: Path | str, doing: str = "write") -> Iterator[None]:
    """Turn what the operating system declares about a path into one line.

    Raises:
        OutputError: whatever OSError came, or the ValueError of a path that no system has.
    """
    try:
        yield
    except (OSError, ValueError) as error:
        raise refused(path, error, doing) from error


@contextmanager
def reporting_the_disk(place: Path | str) -> Iterator[None]:
    """Turn what no step has reported of what the operating system declares into one line about its file.

    Args:
        place: what is named where the error names no file, as after a failed `read` or `close`.

    Raises:
        OutputError: whatever OSError came, unless it is a fault of the program.
    """
    try:
        yield
    except OSError as error:
        if not is_of_the_disk(error):
            raise
        raise refused(error.filename or place, error, "write or read") from error


def is_of_the_disk(error: OSError) -> bool:
    """Whether the operating system declares something that is no fault of the program, and no broken connection."""
    return error.errno not in (None, EBADF) and not isinstance(error, ConnectionError)


def refused(path: Path | str, error: Exception, doing: str = "write") -> OutputError:
    """What the operating system declares about a path, and what to do about it."""
    reason = getattr(error, "strerror", None) or str(error)
    if not doing.startswith("write"):
        return OutputError(say("path-refused", doing=doing, path=path, reason=reason))
    advice = _ADVICE.get(getattr(error, "errno", None) or 0)
    if isinstance(error, (FileExistsError, NotADirectoryError)):
        files = [place for place in (Path(path), *Path(path).parents) if is_file(place)]
        if files:
            what = "it" if files[0] == Path(path) else shown(str(files[0]), 200)
            reason, advice = f"{what} is a file, not a folder", _ADVICE[EACCES]
    return OutputError(say("path-refused", doing=doing, path=path, reason=reason, suggestion=advice))
