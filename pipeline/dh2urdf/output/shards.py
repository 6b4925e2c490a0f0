"""Tar shards: the files of many manipulators in one, as WebDataset and the tar readers of PyTorch take them.

The files of one manipulator stand together. Such readers tell one sample from the next by the names up to the first
dot: files that differ there, as the macro of xacro does, are samples of their own. The bytes depend on names and
contents alone: no time, no owner. A member can be read by itself, at the offset that the manifest has of it.
"""

from __future__ import annotations

import os
import re
from contextlib import ExitStack, suppress
from typing import TYPE_CHECKING, BinaryIO, NamedTuple, Self

from dh2urdf.errors import OutputError
from dh2urdf.output.whole_files import checked, refused, reporting_os_errors, safe_stem, write_all
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Iterator
    from types import TracebackType

    from dh2urdf.output.store import Store

say = Messages(__file__)

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
_EXTENDED = b"x"


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
        self._parts: list[bytes] = []
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
                end = self._size + 2 * _BLOCK
                self._parts.append(bytes(2 * _BLOCK + -end % _RECORD))
                self._write()
                with reporting_os_errors(self._place):
                    self._file.close()
                self._store.put(self._name, self._path)

    def add(self, name: str, content: bytes) -> int:
        """Add a file.

        Returns:
            Where its content begins [byte].
        """
        header = _header(checked(name), len(content))
        offset = self._size + len(header)
        padding = -len(content) % _BLOCK
        self._parts += (header, content, _ZEROS[:padding])
        self._size = offset + len(content) + padding
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


class Member(NamedTuple):
    """A file in a shard.

    Attributes:
        name: its name.
        offset: where its content begins [byte].
        content: what is in it.
    """

    name: str
    offset: int
    content: bytes


def members(shard: BinaryIO) -> Iterator[Member]:
    """The files of a shard, in their order, read in one pass.

    Every byte is compared with what `ShardWriter` writes of the same names and contents, from the first header to the
    zeros at the end. (`tarfile` takes a damaged header for the end of the shard, and reads nothing behind the end.)

    Raises:
        OutputError: the shard has other bytes, or ends too soon; it comes after the files before that place.
    """
    position = 0
    while (header := shard.read(_BLOCK)) != _ZEROS:
        name, size = _read_header(header, position)
        offset = position + _BLOCK
        if header[156:157] == _EXTENDED:  # It holds the name of the next one.
            extension = shard.read(size + -size % _BLOCK)
            record = re.fullmatch(rb"[0-9]+ path=(.*)\n", extension[:size], re.DOTALL)
            name = record[1].decode(errors="replace") if record else name
            header += extension + (last := shard.read(_BLOCK))
            size = _read_header(last, position)[1]
            offset = position + len(header)
        content = shard.read(size + -size % _BLOCK)
        if header != _header(name, size) or content[size:] != _ZEROS[: -size % _BLOCK]:
            raise _damaged(position)
        yield Member(name, offset, content[:size])
        position = offset + len(content)
    rest = bytes(_BLOCK + -(position + 2 * _BLOCK) % _RECORD)
    if shard.read(len(rest) + 1) != rest:
        raise _damaged(position)


def _read_header(header: bytes, position: int) -> tuple[str, int]:
    """The name and the size that a header has, right or wrong."""
    try:
        name, size = header[:_LONGEST_NAME].rstrip(b"\x00").decode(errors="replace"), header[124:135].decode("ascii")
        return name, int(size if size.isdigit() else "", 8)
    except ValueError as error:
        raise _damaged(position) from error


def _damaged(position: int) -> OutputError:
    return OutputError(say("shard-damaged", position=position))
