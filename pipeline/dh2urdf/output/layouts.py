"""Under which names the files of a run go into its store: all together, in folders, or in tar shards."""

from __future__ import annotations

import io
import os
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, NotRequired, TypeAlias, TypedDict

from dh2urdf.errors import OutputError
from dh2urdf.output.whole_files import checked, refused, reporting_os_errors, safe_stem, write_all

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator

    from dh2urdf.output.store import Store

_BLOCK = 512
"""Headers and contents begin at multiples of this [byte] (POSIX.1-2017, pax, "ustar Interchange Format")."""
_RECORD = 20 * _BLOCK
"""A whole archive is a multiple of this [byte]."""
_IN_MEMORY = 1 << 22
"""Each time that a shard has grown by so much [byte], the system is asked to keep no copy of it in memory."""
_AT_ONCE = 1 << 18
"""So much is written to the disk at once [byte]: what a cache of the processor holds takes a quarter of the time."""

# The fields of a header between name, size and checksum, with the lengths that the standard gives them: mode, user and
# group; time of modification; kind, linked name, format, names of user and group, device, prefix of the name.
_OWNER = b"%07o\x00%07o\x00%07o\x00" % (0o644, 0, 0)
_TIME = b"%011o\x00" % 0
_REST = b"0" + bytes(100) + b"ustar\x0000" + bytes(32 + 32 + 8 + 8 + 155 + 12)
_FIXED_SUM = sum(_OWNER + _TIME + _REST) + 8 * ord(" ")
_LONGEST_NAME = 100
_ZEROS = bytes(_BLOCK)


def shard_stem(name: str) -> str:
    """A manipulator's name as the stem of files in a shard: as everywhere, with ``_`` for every dot."""
    return safe_stem(name).replace(".", "_")


@contextmanager
def writing_shard(store: Store, name: str) -> Iterator[Callable[[str, bytes], int]]:
    """A shard in the making: at the end it stands whole in its store, or, after an error, not at all.

    Yields:
        What adds a file, from its name and content, and returns where its content begins [byte].

    Raises:
        OutputError: it cannot be written.
    """
    place = f"{store}/{checked(name)}"
    waiting: list[bytes | memoryview] = []
    size = written = released = 0

    def add(inner: str, content: bytes) -> int:
        nonlocal size
        parts = _parts(checked(inner), content)
        offset = size + len(parts[0])
        waiting.extend(parts)
        size += sum(map(len, parts))
        if size - written >= _AT_ONCE:
            write()
        return offset

    def write() -> None:
        nonlocal written, released
        with reporting_os_errors(place):
            write_all(file.fileno(), b"".join(waiting))
        waiting.clear()
        written = size
        if written - released >= _IN_MEMORY:
            # The system writes what it holds to the disk, and frees the memory of what is there: otherwise a run of a
            # million manipulators fills the machine's memory with copies of its shards, an eighth of the run.
            with suppress(OSError):  # It is advice, which a file system need not take.
                os.posix_fadvise(file.fileno(), 0, written, os.POSIX_FADV_DONTNEED)
            released = written

    with store.scratch() as folder:
        path = folder / "shard"
        with reporting_os_errors(place):
            file = path.open("wb", buffering=0)
        with file:
            yield add
            waiting.append(_end(size))
            write()
            with reporting_os_errors(place):
                file.close()
        store.put(name, path)


def _parts(name: str, content: bytes | memoryview) -> tuple[bytes, bytes | memoryview, bytes]:
    """What a shard has of a file: its header, its content, and zeros up to the next block."""
    return _header(name, len(content)), content, _ZEROS[: -len(content) % _BLOCK]


def _end(size: int) -> bytes:
    """The zeros behind the last file of a shard, which ends there at some size."""
    return bytes(2 * _BLOCK + -(size + 2 * _BLOCK) % _RECORD)


def _header(name: str, size: int) -> bytes:
    """What stands before a file's content.

    (`tarfile` takes 21 µs for each. Here it makes those of names that the standard's own header cannot hold.)

    Raises:
        OutputError: the name has no bytes.
    """
    try:
        encoded = name.encode()
    except UnicodeEncodeError as error:
        raise refused(name, error) from error
    if len(encoded) > _LONGEST_NAME or not name.isascii():
        from tarfile import PAX_FORMAT, TarInfo

        info = TarInfo(name)
        info.size = size
        return info.tobuf(PAX_FORMAT)
    length = b"%011o\x00" % size
    checksum = b"%06o\x00 " % (_FIXED_SUM + sum(encoded) + sum(length))
    return b"".join((encoded.ljust(_LONGEST_NAME, b"\x00"), _OWNER, length, _TIME, checksum, _REST))


def members(content: bytes) -> dict[str, memoryview]:
    """The files of a shard by their names, as far as `tarfile` finds them."""
    import tarfile

    found: dict[str, memoryview] = {}
    with suppress(tarfile.TarError, ValueError), tarfile.open(fileobj=io.BytesIO(content), mode="r:") as shard:
        for member in shard:
            found[member.name] = memoryview(content)[member.offset_data :][: member.size]
    return found


def is_shard_of(content: bytes, files: Iterable[tuple[str, bytes | memoryview]]) -> bool:
    """Whether a shard has, to the last byte, what `writing_shard` writes of files with these names and contents."""
    whole, position = memoryview(content), 0
    with suppress(OutputError):  # of a name that has no bytes
        for part in (part for name, inner in files for part in _parts(name, inner)):
            if whole[position:][: len(part)] != part:
                return False
            position += len(part)
        return whole[position:] == _end(position)
    return False


DEFAULT_SIZE = 1000
"""Manipulators in one folder or shard: file systems and people are slow with folders of many thousand files."""
LARGEST = 10_000
"""Manipulators in one folder or shard at most: a worker holds a shard's descriptions until it is written."""


class Form(StrEnum):
    """How the files of a run lie."""

    FILES = "files"
    """All in one folder."""
    FOLDERS = "folders"
    """In folders of so many manipulators."""
    SHARDS = "shards"
    """In tar files of so many manipulators."""


class Stored(TypedDict):
    """Where a file is in the output of a run, as its manifest has it."""

    path: str
    shard: NotRequired[str]
    offset: NotRequired[int]


Put: TypeAlias = "Callable[[int, str, bytes], Stored]"
"""Puts a file of the manipulator of a number in its place, whole, and returns where that is, for the manifest."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Layout:
    """How the files of a run lie in its store.

    Attributes:
        form: in which form.
        size: manipulators in one folder or shard.
    """

    form: Form = Form.FILES
    size: int = DEFAULT_SIZE

    @property
    def is_whole(self) -> bool:
        """Whether many are one file, and so there as a whole or not at all."""
        return self.form is Form.SHARDS

    @property
    def stem_of(self) -> Callable[[str], str]:
        """What gives the stem of a manipulator's files."""
        return shard_stem if self.is_whole else safe_stem

    @property
    def whole(self) -> int:
        """How many manipulators are written as a whole: those of a shard, otherwise each by itself."""
        return self.size if self.is_whole else 1

    def parts(self, count: int) -> list[range]:
        """Return the places in a batch of so many, cut where a shard ends; all together where there are none."""
        step = self.size if self.is_whole else max(1, count)
        return [range(start, min(start + step, count)) for start in range(0, count, step)]

    def folder(self, index: int) -> str:
        """Return the folder or shard of the manipulator of a number; empty where there is none."""
        match self.form:
            case Form.FILES:
                return ""
            case Form.FOLDERS:
                return f"{index // self.size:05d}"
            case Form.SHARDS:
                return f"{index // self.size:06d}.tar"

    def path(self, index: int, name: str) -> str:
        """Return the name of a file in the store, shards aside."""
        folder = self.folder(index)
        return f"{folder}/{name}" if folder else name

    @contextmanager
    def place(self, store: Store, first: int) -> Iterator[Put]:
        """Yield what puts files into the shard that begins with the manipulator of a number, or each in its place.

        Raises:
            OutputError: a file cannot be written.
        """

        def put(index: int, name: str, content: bytes) -> Stored:
            path = self.path(index, name)
            store.write(path, content)
            return {"path": path}

        if not self.is_whole:
            yield put
            return
        folder = self.folder(first)
        with writing_shard(store, folder) as add:
            yield lambda _index, name, content: {"path": name, "shard": folder, "offset": add(name, content)}
