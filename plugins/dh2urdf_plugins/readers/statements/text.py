"""The lines of a CSV file, in whatever encoding and with whatever line ends it comes, without holding the file."""

from __future__ import annotations

import codecs
import io
from typing import TYPE_CHECKING, NoReturn

from dh2urdf.documents import check_file, refuse_other_kind
from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

MAX_LINE = 2**20
"""Length of a line: a file without line ends must not be held as one."""
_CHARACTERS = 250_000
"""Characters read at once, some thousand rows: with fewer, what a block costs besides its rows counts."""
_SAMPLE = 4096

_ACCEPTED = "text in UTF-8 or UTF-16, with commas, semicolons or tabs between the cells"


def line_blocks(path: Path) -> Iterator[list[str]]:
    """The lines of a text file, without their ends, some thousand at a time.

    Raises:
        TableError: there is no such file, it is no text, or a line of it is longer than `MAX_LINE`.
    """
    check_file(path, TableError)
    with path.open("rb") as binary:
        sample = binary.read(_SAMPLE)
        encoding = _encoding(sample, path)
        binary.seek(0)
        yield from _blocks(binary, encoding, path)


def _encoding(sample: bytes, path: Path) -> str:
    refuse_other_kind(sample, str(path), TableError, "a text file", _ACCEPTED)
    if sample.startswith(codecs.BOM_UTF8):
        return "utf-8-sig"
    if sample.startswith((codecs.BOM_UTF32_LE, codecs.BOM_UTF32_BE)):
        _refuse("this is text in UTF-32", path, suggestion="save the file as UTF-8")
    if sample.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return "utf-16"
    # Tables are mostly ASCII, whose UTF-16 has a zero in every second byte: the first or the second of each pair.
    even, odd = sample[0::2].count(0), sample[1::2].count(0)
    half = len(sample) // 2
    if half and odd > half * 0.6 and even < half * 0.1:
        return "utf-16-le"
    if half and even > half * 0.6 and odd < half * 0.1:
        return "utf-16-be"
    if b"\0" in sample:
        _refuse("this is no text file: it holds NUL bytes", path, suggestion="save the table as CSV (UTF-8)")
    return "utf-8"


def _refuse(message: str, path: Path, line: int | None = None, suggestion: str | None = None) -> NoReturn:
    mark = Mark(file=str(path), line=line)
    raise TableError(Problem(message=message, mark=mark, accepted=_ACCEPTED, suggestion=suggestion))


def _blocks(binary: io.BufferedReader, encoding: str, path: Path) -> Iterator[list[str]]:
    # Universal newlines: CR LF, CR and LF become "\n", also in a cell in quotes.
    text = io.TextIOWrapper(binary, encoding=encoding, errors="strict", newline=None)
    rest, line = "", 0
    try:
        while block := text.read(_CHARACTERS):
            lines = (rest + block).split("\n")
            rest = lines.pop()
            if len(rest) > MAX_LINE:
                _refuse(f"a line has more than {MAX_LINE} characters", path, line + len(lines) + 1)
            yield lines
            line += len(lines)
        if rest:
            yield [rest]
    except UnicodeDecodeError as error:
        _refuse_bytes(error, path, encoding)
    finally:
        text.detach()


def _refuse_bytes(error: UnicodeDecodeError, path: Path, encoding: str) -> NoReturn:
    """Finds the bytes again, since a decoder that streams does not know its line."""
    codec = codecs.getincrementaldecoder(encoding)()
    line = 1
    with path.open("rb") as binary:
        while raw := binary.readline():
            try:
                codec.decode(raw)
            except UnicodeDecodeError as again:
                error = again
                break
            line += 1
    byte = error.object[error.start]
    name = "UTF-16" if encoding.startswith("utf-16") else "UTF-8"
    _refuse(
        f"byte 0x{byte:02x} is no {name} text" + ("; this may be Latin-1 or Windows-1252" if name == "UTF-8" else ""),
        path,
        line,
        "save the file as UTF-8 (in Excel: CSV UTF-8)",
    )
