"""The lines of a CSV file, in whatever encoding and with whatever line ends it comes, without holding the file."""

from __future__ import annotations

import codecs
import io
from typing import TYPE_CHECKING

from dh2urdf.documents import check_file, refuse_other_kind
from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Messages

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

say = Messages(__file__)

MAX_LINE = 2**20
"""Length of a line: a file without line ends must not be held as one."""
_BYTES = 250_000
"""Bytes read at once, some thousand rows: with fewer, what a block costs besides its rows counts."""
_SAMPLE = 4096
_ACCEPTED = "text in UTF-8 or UTF-16, with commas, semicolons or tabs between the cells"
_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
"""Encodings by their byte order marks, longer ones first where one begins another."""


def line_blocks(path: Path) -> Iterator[list[str]]:
    """The lines of a text file, without their ends, some thousand at a time."""
    check_file(path, TableError)
    with path.open("rb") as binary:
        encoding = _encoding(binary.read(_SAMPLE), path)
        binary.seek(0)
        # Universal newlines: CR LF, CR and LF become "\n", also in a cell in quotes.
        decoder = io.IncrementalNewlineDecoder(codecs.getincrementaldecoder(encoding)(), translate=True)
        rest, line, raw = "", 0, b"?"
        while raw:
            raw = binary.read(_BYTES)
            try:
                lines = (rest + decoder.decode(raw, final=not raw)).split("\n")
            except UnicodeDecodeError as error:
                at = line + 1 + error.object[: error.start].count(b"\n")
                is_wide, byte = "16" in encoding, error.object[error.start]
                perhaps = "" if is_wide else "; this may be Latin-1 or Windows-1252"
                name, mark = "UTF-16" if is_wide else "UTF-8", Mark(file=str(path), line=at)
                raise TableError(say("no-text", mark, byte=byte, name=name, perhaps=perhaps)) from None
            rest = lines.pop()
            if len(rest) > MAX_LINE:
                raise TableError(say("long-line", Mark(file=str(path), line=line + len(lines) + 1), limit=MAX_LINE))
            if lines:
                yield lines
            line += len(lines)
    if rest:
        yield [rest]


def _encoding(sample: bytes, path: Path) -> str:
    refuse_other_kind(sample, str(path), TableError, "a text file", _ACCEPTED)
    # Tables are mostly ASCII, whose UTF-16 has a zero in every second byte: the first or the second of each pair.
    half = len(sample) // 2 or 1
    even, odd = sample[0::2].count(0) / half, sample[1::2].count(0) / half
    guessed = "utf-16-le" if odd > 0.6 and even < 0.1 else "utf-16-be" if even > 0.6 and odd < 0.1 else "utf-8"  # noqa: PLR2004
    encoding = next((_MARKS[mark] for mark in _MARKS if sample.startswith(mark)), guessed)
    if encoding == "utf-32" or (encoding == "utf-8" and (even or odd)):
        raise TableError(say("utf-32" if encoding == "utf-32" else "nul-bytes", Mark(file=str(path))))
    return encoding
