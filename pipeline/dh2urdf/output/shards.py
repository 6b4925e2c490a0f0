"""Tar shards: the files of many manipulators in one, as WebDataset and the tar readers of PyTorch take them.

The files of one manipulator stand together. Such readers tell one sample from the next by the names up to the first
dot: files that differ there, as the macro of xacro does, are samples of their own. The bytes depend on names and
contents alone: no time, no owner. A member can be read by itself, at the offset that the manifest has of it.
"""

from __future__ import annotations

import io
import os
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, Self

from dh2urdf.errors import OutputError
from dh2urdf.output.whole_files import checked, refused, reporting_os_errors, safe_stem, write_all

if TYPE_CHECKING:
    from collections.abc import Iterable
    from types import TracebackType

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


class ShardWriter:
    """A shard in the making: a context at whose end it stands whole in its store, or, after an error, not at all.

    Raises:
        OutputError: it cannot be written.
    """

    def __init__(self, store: Store, name: str) -> None:
        self._store, self._name = store, checked(name)
        self._parts: list[bytes | memoryview] = []
        self._size = self._written = self._released = 0

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            self._path = stack.enter_context(self._store.scratch()) / "shard"
            with reporting_os_errors(self._place):
                self._file = stack.enter_context(self._path.open("wb", buffering=0))
            self._stack = stack.pop_all()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None) -> None:
        with self._stack:
            if error is None:
                self._parts.append(_end(self._size))
                self._write()
                with reporting_os_errors(self._place):
                    self._file.close()
                self._store.put(self._name, self._path)

    def add(self, name: str, content: bytes) -> int:
        """Add a file.

        Returns:
            Where its content begins [byte].
        """
        parts = _parts(checked(name), content)
        offset = self._size + len(parts[0])
        self._parts += parts
        self._size += sum(map(len, parts))
        if self._size - self._written >= _AT_ONCE:
            self._write()
        return offset

    def _write(self) -> None:
        with reporting_os_errors(self._place):
            write_all(self._file.fileno(), b"".join(self._parts))
        self._parts.clear()
        self._written = self._size
        if self._written - self._released >= _IN_MEMORY:
            # The system writes what it holds to the disk, and frees the memory of what is there: otherwise a run of a
            # million manipulators fills the machine's memory with copies of its shards, an eighth of the run.
            with suppress(OSError):  # It is advice, which a file system need not take.
                os.posix_fadvise(self._file.fileno(), 0, self._written, os.POSIX_FADV_DONTNEED)
            self._released = self._written

    @property
    def _place(self) -> str:
        return f"{self._store}/{self._name}"


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
    """Whether a shard has, to the last byte, what `ShardWriter` writes of files with these names and contents."""
    whole, position = memoryview(content), 0
    with suppress(OutputError):  # of a name that has no bytes
        for part in (part for name, inner in files for part in _parts(name, inner)):
            if whole[position:][: len(part)] != part:
                return False
            position += len(part)
        return whole[position:] == _end(position)
    return False
