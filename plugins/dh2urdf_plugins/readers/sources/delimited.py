"""The rows of a CSV file: comment lines, the header, and what is below it, in blocks of lines and never as a whole."""

from __future__ import annotations

import codecs
import csv
import io
import re
from itertools import accumulate, chain, islice
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.documents import check_file, refuse_other_kind
from dh2urdf.errors import TableError
from dh2urdf.fields import many_unchecked
from dh2urdf.source import Mark, Messages, shown
from dh2urdf.table_text import REQUIRED, CellRow
from dh2urdf_plugins.readers.comments.top import MAX_TITLES
from dh2urdf_plugins.readers.header.header_rows import text_in
from dh2urdf_plugins.readers.sources.texts import DELIMITERS, MAX_HEADER, delimiter_of, fields_in, split
from dh2urdf_plugins.readers.tables.cell_rows import CellRows, choose, one_table, other_header, starts_table
from dh2urdf_plugins.readers.words.bounds import MAX_JOINTS
from dh2urdf_plugins.readers.words.cells import SPACES, text_of
from dh2urdf_plugins.readers.words.comment_lines import (
    SIGNS,
    as_typed,
    fills_row,
    is_comment,
    is_open,
    is_quoted,
    joined,
    without_marker,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.source import Problem
    from dh2urdf_plugins.readers.header.columns import Columns, Row

MAX_LINE = 2**20
"""Length of a line: a file without line ends must not be held as one."""
_BYTES = 250_000
"""Bytes read at once, some thousand rows: with fewer, what a block costs besides its rows counts."""
_SAMPLE = 4096
_ACCEPTED = "text in UTF-8, or in UTF-16 with a byte order mark, with commas, semicolons or tabs between the cells"
_MARKS = {
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
"""Encodings by their byte order marks, longer ones first where one begins another."""
COMPUTED = "=+@-"
"""How a cell begins that a spreadsheet computes: names of that kind are written as texts, behind an apostrophe."""
_GUARDED = re.compile(f"'+[{COMPUTED}]")
_CAREFUL = ('"', *(f"'{sign}" for sign in COMPUTED))
"""What a block has whose lines are more than cells and delimiters."""
_KEPT = 4 * MAX_JOINTS
"""Lines with quotes that are kept behind the last one: those of a manipulator of which some rows are still to come."""
_EMPTY = SPACES + "".join(DELIMITERS) + '"'
"""What a line consists of that holds nothing."""
_LINES_OF_A_CELL = 100
"""Lines that a comment, or a header, in quotes may run over."""
_EXCEL_SEPARATOR = r'(?i)\s*"?sep=(.)"?[\s,;]*'  # Excel's own way to name the delimiter

say = Messages(__file__)


# --- Lines ------------------------------------------------------------------------------------------------------------


def line_blocks(path: Path) -> Iterator[list[str]]:
    """The lines of a text file, without their ends, some thousand at a time."""
    check_file(path, TableError)
    with path.open("rb") as binary:
        sample = binary.read(_SAMPLE)
        refuse_other_kind(sample, str(path), TableError, "a text file", _ACCEPTED)
        encoding = next((_MARKS[mark] for mark in _MARKS if sample.startswith(mark)), "utf-8")
        if encoding == "utf-32" or (encoding == "utf-8" and b"\0" in sample):
            raise TableError(say("utf-32" if encoding == "utf-32" else "nul-bytes", Mark(file=str(path))))
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
                about: dict[str, Any] = {"byte": byte, "name": "UTF-16" if is_wide else "UTF-8", "perhaps": perhaps}
                raise TableError(say("no-text", Mark(file=str(path), line=at), **about)) from None
            rest = lines.pop()
            if len(rest) > MAX_LINE:
                raise TableError(say("long-line", Mark(file=str(path), line=line + len(lines) + 1), limit=MAX_LINE))
            if lines:
                yield lines
            line += len(lines)
    if rest:
        yield [rest]


# --- Rows -------------------------------------------------------------------------------------------------------------


class _Line(NamedTuple):
    """A line above the rows, or several where a cell in quotes runs over them: its number, and how many end with it."""

    number: int
    text: str
    end: int
    comment: bool


class CsvRows(CellRows):
    """The rows of a CSV file: comment lines of one cell each, the header, and what is below it.

    Of several tables one is read, by its number.
    """

    are_values = True

    def __init__(self, path: Path, number: int | None = None) -> None:
        super().__init__(self._rows())
        self.path, self.file = path, str(path)
        self.blocks = line_blocks(path) if number is None else iter([lines_of_table(path, number)])
        self.delimiter = ","
        self.one_robot = True
        self.quoted: dict[int, str] = {}  # lines with quotes: lengths do not tell where their cells start

    def _rows(self) -> Iterator[CellRow]:
        """The rows one by one, down to where the header may be where no line names two of a, alpha, d and theta."""
        lines = list(chain.from_iterable(islice(self.blocks, 2)))
        top, header = self._top(lines)
        for line in top:
            if line.comment and line is not header:
                yield from self._comments(line.text, line.number)
            else:
                yield self._cells(line.text, line.number)
        if header:
            yield from self._below(chain((lines[header.end :],), self.blocks), header.end)

    # --- The top ------------------------------------------------------------------------------------------------------

    def _top(self, lines: Sequence[str]) -> tuple[list[_Line], _Line | None]:
        """The lines down to the header, and the header, which shows the delimiter.

        One in a comment is the header, too, unless a header is below it.
        """
        titles, top = list[str](), list[_Line]()
        header = separator = found = None
        for line in _top_lines(lines):
            if line.number == 1 and (match := re.fullmatch(_EXCEL_SEPARATOR, line.text)):
                separator = match[1] if match[1] in DELIMITERS else None
                continue
            text = (commented_header(line.text) or "") if line.comment else line.text
            top.append(line)
            if len(text) > MAX_HEADER:
                mark = Mark(file=self.file, line=line.number)
                raise TableError(say("long-header", mark, length=len(text), most=MAX_HEADER))
            found = delimiter_of(text, separator)
            # A header in a comment above the header itself only explains this: it names no link before.
            below = lines[line.end : line.end + MAX_TITLES] if line.comment and "1" not in line.text else ()
            first = next((each for each in below if each.strip(_EMPTY) and not is_comment(each, top=True)), "")
            if found and not delimiter_of(first):
                header = top[-1] = line._replace(text=text)
                break
            titles += [] if line.comment else [text]
            if len(titles) > MAX_TITLES:
                break
        named = {sign: max((len(fields_in(text, sign)) for text in titles), default=0) for sign in DELIMITERS}
        likely = max(DELIMITERS, key=lambda sign: (named[sign], max((text.count(sign) for text in titles), default=0)))
        self.delimiter = (header and found) or separator or likely
        if header and not header.comment and _is_cut(header.text):
            mark, text = Mark(file=self.file, line=header.number), shown(header.text.strip())
            raise TableError(say("open-quote-in-header", mark, text=text))
        return top, header

    # --- The rows -----------------------------------------------------------------------------------------------------

    def _below(self, blocks: Iterable[list[str]], passed: int) -> Iterator[CellRow]:
        """The rows below so many lines."""
        for block in blocks:
            start, text = passed + 1, "".join(block)
            is_quoted = any(sign in text for sign in _CAREFUL)
            self.quoted = {at: line for at, line in self.quoted.items() if at > passed - _KEPT}
            marks = many_unchecked(Mark(file=self.file), len(block), line=range(start, start + len(block)))
            # Without quotes `csv.reader` does the same, in twice the time.
            cells = (line.split(self.delimiter) if line else [] for line in block)
            if (
                is_quoted
                or any(sign in text for sign in SIGNS)
                or max(map(len, block), default=0) >= csv.field_size_limit()
            ):
                yield from self._quoted(block, start)
            else:
                yield from map(CellRow, cells, marks)
            passed += len(block)

    def _quoted(self, block: list[str], start: int) -> Iterator[CellRow]:
        """The rows of a block with quotes or comments, which takes the lines that its last cell runs over."""

        def following() -> Iterator[str]:
            for more in self.blocks:
                block.extend(more)
                yield from more

        # A cell in quotes keeps the end of the line; what a comment holds is none of the reader's business.
        lines = (SIGNS[0] if is_comment(line) else f"{line}\n" for line in chain(tuple(block), following()))
        reader = csv.reader(lines, delimiter=self.delimiter, strict=True)
        while reader.line_num < len(block):
            at = reader.line_num
            try:
                cells = self._unguarded(next(reader))
            except csv.Error as error:
                raise TableError(self._wrong_cell(str(error), start + at, block[at:])) from None
            if is_comment(block[at]):
                yield from self._comments(block[at], start + at)
                continue
            if any(sign in block[at] for sign in _CAREFUL):
                self.quoted[start + at] = block[at]
            yield CellRow(cells, Mark(file=self.file, line=start + at))

    def _unguarded(self, cells: list[str]) -> list[str]:
        """Cells as they were before a spreadsheet kept them; those that it made of a comment become one."""
        if cells and is_comment(cells[0]) and not fills_row(cells, self.joints.geometry):
            return [joined(cells, decimal_comma=self.delimiter != ",")]
        return [cell[1:] if _GUARDED.match(cell) else cell for cell in cells]

    def _wrong_cell(self, error: str, line: int, lines: Sequence[str]) -> Problem:
        """What is wrong with a cell whose quotes are wrong, or that has no end, in some lines from a number on."""
        number, text = next(((n, text) for n, text in enumerate(lines, line) if '"' in text), (line, ""))
        is_open = number == line and text.count('"') % 2
        if "limit" in error and not is_open:
            return say("long-cell", Mark(file=self.file, line=line), most=csv.field_size_limit())
        mark = Mark(file=self.file, line=line, column=text.find('"') + 1 or None)
        about = {"found": text or None, "text": shown(text.strip())}
        return say("text-behind-a-quote" if "expected after" in error else "open-quote", mark, **about)

    def _comments(self, line: str, number: int) -> Iterator[CellRow]:
        """A comment as it was typed, in one cell; several where a cell of it has several lines."""
        for at, text in enumerate(as_typed(line, self.delimiter)):
            yield CellRow([f"# {text}" if at else text], Mark(file=self.file, line=number + at))

    # --- Rows that are joints -----------------------------------------------------------------------------------------

    def start(self, columns: Columns) -> Columns:
        """Takes the columns of the rows to come."""
        columns = super().start(columns)
        self.one_robot = "robot" not in columns.fields
        columns.decimal_comma, columns.quoted_commas = self.delimiter != ",", self.delimiter == ","
        columns.numbers = frozenset()  # all cells are texts
        return columns

    def _are_joints(self, rows: Sequence[CellRow]) -> bool:
        """Whether rows are whole and no comments; the last one may be a note with as many commas as a joint has."""
        if {len(row.cells) for row in rows} != {len(self.fields)} or self.joints.after_gap or self.joints.held:
            return False
        firsts: list[Any] = [row.cells[0] for row in rows]
        return all(map(str.strip, firsts)) and not (firsts[-1][:1].isalpha() and " " in firsts[-1])

    def _taken(self, row: CellRow) -> list[CellRow]:
        """The joints that a row adds; a comment has one cell, and above another header it may hold for that alone."""
        if len(row.cells) > 1:
            if self.joints.after_gap and starts_table(row):
                self._refuse_several()
            return self.joints.take(row)
        try:
            return super()._taken(row)
        except TableError:
            self._refuse_several()
            raise

    def _refuse_several(self) -> None:
        """Refuses a file of several tables; the rows of several manipulators are one table."""
        if self.one_robot:
            lines_of_table(self.path, None)

    def row(self, key: CellRow, cells: Row, number: int) -> tuple[CellRow, list[Problem]]:
        """A row with the places at which its cells start, and what is wrong with it."""
        texts, line = list(map(text_in, key.cells)), key.mark.line or 0
        row = self._cells(self.quoted.get(line) or self.delimiter.join(texts), line, list(map(text_of, cells)))
        if problem := other_header(key, number):
            if starts_table(key):
                self._refuse_several()
            return row, [problem]
        more = next((text for text in texts[len(self.fields) :] if text.strip()), None)
        if len(texts) >= self.joints.width and (more is None or is_comment(more)):
            return row, []
        has_more = self.delimiter == "," and len(texts) > len(self.fields)
        advice = "is there a decimal comma in it, or a comma in a text without quotes?" if has_more else None
        joint, count, sign = f"joint_{number}", len(texts), DELIMITERS[self.delimiter]
        about: dict[str, Any] = {"number": number, "cells": count, "columns": len(self.fields), "sign": sign}
        return row, [say("ragged-row", key.mark, joint=joint, suggestion=advice, **about)]

    def _cells(self, line: str, number: int, cells: Sequence[str] | None = None) -> CellRow:
        """The cells of a line, each where it starts; those that start in a later line are where a cell goes on."""
        cells = split(line, self.delimiter) if cells is None else cells
        hidden = re.sub(r'"[^"]*("|\Z)', lambda quoted: "_" * len(quoted[0]), line).split(self.delimiter)
        ends = accumulate(len(cell) + 1 for cell in hidden)
        starts = [end - len(cell.lstrip(SPACES)) for end, cell in zip(ends, hidden, strict=True)]
        places = starts + [starts[-1]] * (len(cells) - len(starts))
        marks = [Mark(file=self.file, line=number, column=at) for at in places]
        return CellRow(cells, Mark(file=self.file, line=number), marks)


def _top_lines(lines: Sequence[str]) -> Iterator[_Line]:
    """The lines that hold anything, each with those that a cell in quotes runs over."""
    number = 0
    while number < len(lines):
        text, start = lines[number], number + 1
        number += 1
        if not text.strip(_EMPTY):
            continue
        comment = is_comment(text, top=True)
        goes_on = is_open if comment else _is_cut
        while goes_on(text) and number < min(len(lines), start + _LINES_OF_A_CELL) and len(text) < MAX_HEADER:
            text += f"\n{lines[number]}"
            number += 1
        yield _Line(start, text, number, comment)


def lines_of_table(path: Path, number: int | None) -> list[str]:
    """The lines of one of several tables; all others are empty, so that each line keeps its number."""
    lines = list(chain.from_iterable(line_blocks(path)))
    sign = next(filter(None, map(delimiter_of, lines[:MAX_TITLES])), ",")
    rows = [
        CellRow([line] if is_comment(line, top=True) or len(line) > MAX_HEADER else split(line, sign), mark)
        for line, mark in zip(lines, (Mark(file="", line=at) for at in range(1, len(lines) + 1)), strict=True)
    ]
    headers = [str(row.mark.in_file) for row in rows if starts_table(row)]
    if len(headers) <= 1 and number in (None, 1):
        return lines
    chosen = choose(range(1, len(headers) + 1), headers, number, path)
    kept = {row.mark.line for row in one_table(rows, chosen)}
    return [line if at in kept else "" for at, line in enumerate(lines, start=1)]


def commented_header(line: str) -> str | None:
    """The header that a line starting with # is, or None where it is a comment.

    The first column may be called ``#``, or the header as a whole may be commented out, as numpy writes it.
    """
    if max(map(line.count, DELIMITERS)) + 1 < len(REQUIRED) or len(line) > MAX_HEADER or is_quoted(line):
        return None
    texts = (line, without_marker(line))
    named = {text: max((fields_in(text, sign) for sign in DELIMITERS), key=len) for text in texts}
    best = max(texts, key=lambda text: len(named[text]))
    return best if named[best].issuperset(REQUIRED) else None


def _is_cut(line: str) -> bool:
    """Whether a line ends in a cell that begins with a quote: one in the middle of a cell, as of 5", opens none."""
    quoted, begins = False, True
    for character in line if '"' in line else "":
        if character == '"' and (quoted or begins):
            quoted, begins = not quoted, quoted  # of two in quotes, the second one opens them again
        elif not quoted:
            begins = character in DELIMITERS or (begins and character in SPACES)
    return quoted
