"""The rows of a CSV file: comment lines, the header, and what is below it, in blocks of lines and never as a whole."""

from __future__ import annotations

import codecs
import csv
import io
import re
from itertools import accumulate, chain, islice
from operator import itemgetter
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.documents import check_file, refuse_other_kind
from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Messages, shown
from dh2urdf.table_text import REQUIRED, CellRow
from dh2urdf_plugins.readers.comments.declared import comment_below
from dh2urdf_plugins.readers.comments.top import MAX_TITLES
from dh2urdf_plugins.readers.header.header_rows import completed, headers_in, text_in
from dh2urdf_plugins.readers.sources.texts import DELIMITERS, MAX_HEADER, delimiter_of, fields_in, split
from dh2urdf_plugins.readers.tables.cell_rows import Joints, choose, one_table, other_header, starts_table
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

    from dh2urdf.columns import PlaceInFile
    from dh2urdf.source import Problem
    from dh2urdf_plugins.readers.header.columns import Columns, Row
    from dh2urdf_plugins.readers.words.comment_lines import Comment

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
MAX_BELOW = 1000
"""Comments below the header that are kept, for the names that they may define."""
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


class CsvRows:
    """The rows of a CSV file: comment lines of one cell each, the header, and what is below it.

    The key of a row is the number of its line. Of several tables one is read, by its number.
    """

    def __init__(self, path: Path, number: int | None = None) -> None:
        self.path, self.file = path, str(path)
        self.below: list[Comment] = []
        self.blocks = line_blocks(path) if number is None else iter([lines_of_table(path, number)])
        self.lines: list[str] = []  # those that were read and not handed on
        self.passed = 0  # lines before these
        self.top: dict[int, _Line] = {}
        self.delimiter = ","
        self.header: list[str] = []
        self.width = self.needed = 0
        self.joints = Joints([], 0, self.below)
        self.one_robot = True
        self.quoted: dict[int, str] = {}  # lines with quotes: lengths do not tell where their cells start

    # --- The top ------------------------------------------------------------------------------------------------------

    def __iter__(self) -> Iterator[CellRow]:
        """The rows down to the header, or down to where it may be where no line names two of a, alpha, d and theta.

        One in a comment is the header, too, unless a header is below it.
        """
        self.lines = list(chain.from_iterable(islice(self.blocks, 2)))
        titles: list[str] = []
        header = separator = found = None
        for line in self._top_lines():
            if line.number == 1 and (match := re.fullmatch(_EXCEL_SEPARATOR, line.text)):
                separator = match[1] if match[1] in DELIMITERS else None
                continue
            text = (commented_header(line.text) or "") if line.comment else line.text
            self.top[line.number] = line
            if len(text) > MAX_HEADER:
                raise TableError(say("long-header", self.mark(line.number), length=len(text), most=MAX_HEADER))
            found = delimiter_of(text, separator)
            # A header in a comment above the header itself only explains this: it names no link before.
            below = self.lines[line.end : line.end + MAX_TITLES] if line.comment and "1" not in line.text else ()
            first = next((each for each in below if each.strip(_EMPTY) and not is_comment(each, top=True)), "")
            if found and not delimiter_of(first):
                header = self.top[line.number] = line._replace(text=text)
                break
            titles += [] if line.comment else [text]
            if len(titles) > MAX_TITLES:
                break
        named = {sign: max((len(fields_in(text, sign)) for text in titles), default=0) for sign in DELIMITERS}
        likely = max(DELIMITERS, key=lambda sign: (named[sign], max((text.count(sign) for text in titles), default=0)))
        self.delimiter = (header and found) or separator or likely
        for line in self.top.values():
            if line.comment and line is not header:
                texts = enumerate(as_typed(line.text, self.delimiter), line.number)
                yield from (CellRow([text], self.mark(number)) for number, text in texts)
            else:
                yield self._cells(line.text, line.number)

    def _top_lines(self) -> Iterator[_Line]:
        """The lines that hold anything, each with those that a cell in quotes runs over."""
        number = 0
        while number < len(self.lines):
            text, start = self.lines[number], number + 1
            number += 1
            if not text.strip(_EMPTY):
                continue
            comment = is_comment(text, top=True)
            goes_on = is_open if comment else _is_cut
            while goes_on(text) and number < min(len(self.lines), start + _LINES_OF_A_CELL) and len(text) < MAX_HEADER:
                text += f"\n{self.lines[number]}"
                number += 1
            yield _Line(start, text, number, comment)

    def complete(self, header: CellRow) -> CellRow:
        """The header with a row of units, or of names under shared titles, that follows it."""
        line = self.top[header.mark.line or 0]
        if not line.comment and _is_cut(line.text):
            raise TableError(say("open-quote-in-header", header.mark, text=shown(line.text.strip())))
        del self.lines[: line.end]
        self.passed = line.end
        for count, text in enumerate(self.lines, start=1):
            if text.strip(_EMPTY):
                is_row = len(text) <= MAX_HEADER and not is_comment(text, top=True)
                found = completed(header, self._cells(text, self.passed + count)) if is_row else None
                if found:
                    del self.lines[:count]
                    self.passed += count
                return found or header
        return header

    # --- The rows -----------------------------------------------------------------------------------------------------

    def start(self, columns: Columns) -> Columns:
        """Takes the columns of the rows to come."""
        self.header, self.width = columns.headers, len(columns.headers)
        self.needed = max(index for index, header in enumerate(columns.headers) if header) + 1
        self.joints = Joints([columns.fields.index(name) for name in REQUIRED], self.needed, self.below)
        self.one_robot = "robot" not in columns.fields
        columns.decimal_comma = self.delimiter != ","
        columns.quoted_commas = self.delimiter == ","
        return columns

    def batches(self) -> Iterator[tuple[Sequence[int], Sequence[Row]]]:
        """The rows that hold anything, and the line at which each starts."""
        for lines, batch in self._records():
            plain = set(map(len, batch)) == {self.width} and all(map(str.strip, map(itemgetter(0), batch)))
            # A line below the last joint may be a note with as many commas as a joint has.
            may_be_note = batch and batch[-1] and batch[-1][0][:1].isalpha() and " " in batch[-1][0]
            if plain and not self.joints.after_gap and not self.joints.held and not may_be_note:
                yield lines, batch
                continue
            kept: list[CellRow] = []
            for line, cells in zip(lines, batch, strict=True):
                row = CellRow(cells, self.mark(line))
                if cells == [SIGNS[0]]:
                    self.joints.after_gap = True
                    continue
                if self.joints.after_gap and self.one_robot and starts_table(row):
                    lines_of_table(self.path, None)
                kept += self.joints.take(row)
            yield [row.mark.line or 0 for row in kept], [list(map(text_in, row.cells)) for row in kept]
        self.joints.finish()

    def _records(self) -> Iterator[tuple[Sequence[int], list[list[str]]]]:
        """Batches of rows, and the line at which each row starts."""
        blocks, count = self._blocks(), 0

        def joined_lines(lines: list[str]) -> Iterator[str]:  # and those of the next blocks, as far as a cell runs on
            nonlocal count
            yield from lines
            for _, more, _ in blocks:
                count += len(more)
                yield from more

        for start, lines, has_quotes in blocks:
            if not has_quotes and max(map(len, lines), default=0) < csv.field_size_limit():
                # Without quotes `csv.reader` does the same, in twice the time.
                yield range(start, start + len(lines)), [line.split(self.delimiter) if line else [] for line in lines]
                continue
            count = len(lines)
            reader = csv.reader(joined_lines(lines), delimiter=self.delimiter, strict=True)
            starts: list[int] = []
            batch: list[list[str]] = []
            try:
                while reader.line_num < count:
                    starts.append(start + reader.line_num)
                    batch.append(self._unguarded(next(reader), starts[-1]))
            except csv.Error as error:
                raise TableError(self._wrong_cell(str(error), starts[-1])) from None
            yield starts, batch

    def _blocks(self) -> Iterator[tuple[int, list[str], bool]]:
        """Blocks of lines, of comments the sign alone: the number of the first line, and whether any has quotes."""
        for block in chain((self.lines,), self.blocks):
            start = self.passed + 1
            self.passed += len(block)
            text = "".join(block)
            has_quotes = any(sign in text for sign in _CAREFUL)
            if has_quotes:
                self.quoted = {at: line for at, line in self.quoted.items() if at > start - _KEPT}
                lines = enumerate(block, start)
                self.quoted |= {at: line for at, line in lines if any(sign in line for sign in _CAREFUL)}
                block = [f"{line}\n" for line in block]  # noqa: PLW2901 - a cell in quotes keeps the end of the line
            if any(sign[0] in text and sign in text for sign in SIGNS):
                block = [  # noqa: PLW2901 - the same lines
                    self._passed_over(line, start + k) if is_comment(line) else line for k, line in enumerate(block)
                ]
            yield start, block, has_quotes

    def _passed_over(self, line: str, number: int) -> str:
        """What stands for a comment below the header; one that declares something would not hold for the rows above."""
        for text in as_typed(line, self.delimiter):
            try:
                comment = comment_below(text, self.mark(number))
            except TableError:
                if self.one_robot:
                    lines_of_table(self.path, None)  # it may be above another header
                raise
            if "=" in comment.line and len(self.below) < MAX_BELOW:
                self.below.append(comment)
        return SIGNS[0]

    def _unguarded(self, cells: list[str], line: int) -> list[str]:
        """Cells as they were before a spreadsheet kept them; those that it made of a comment become one."""
        if cells and is_comment(cells[0]) and not fills_row(cells, self.joints.geometry):
            return [self._passed_over(joined(cells, decimal_comma=self.delimiter != ","), line)]
        return [cell[1:] if _GUARDED.match(cell) else cell for cell in cells]

    def _wrong_cell(self, error: str, line: int) -> Problem:
        """What is wrong with a cell whose quotes are wrong, or that has no end."""
        number, text = next(((n, text) for n, text in self.quoted.items() if n >= line and '"' in text), (line, ""))
        is_open = number == line and text.count('"') % 2
        if "limit" in error and not is_open:
            return say("long-cell", self.mark(line), most=csv.field_size_limit())
        mark = Mark(file=self.file, line=line, column=text.find('"') + 1 or None)
        about = {"found": text or None, "text": shown(text.strip())}
        return say("text-behind-a-quote" if "expected after" in error else "open-quote", mark, **about)

    # --- Places -------------------------------------------------------------------------------------------------------

    def _cells(self, line: str, number: int, cells: Sequence[str] | None = None) -> CellRow:
        """The cells of a line, each where it starts; those that start in a later line are where a cell goes on."""
        cells = split(line, self.delimiter) if cells is None else cells
        hidden = re.sub(r'"[^"]*("|\Z)', lambda quoted: "_" * len(quoted[0]), line).split(self.delimiter)
        ends = accumulate(len(cell) + 1 for cell in hidden)
        starts = [end - len(cell.lstrip(SPACES)) for end, cell in zip(ends, hidden, strict=True)]
        places = starts + [starts[-1]] * (len(cells) - len(starts))
        return CellRow(cells, self.mark(number), [Mark(file=self.file, line=number, column=at) for at in places])

    def places(self, keys: Iterable[int]) -> Iterable[PlaceInFile]:
        """The lines of rows."""
        return keys

    def mark(self, key: int) -> Mark:
        """The line of a row, with the file."""
        return Mark(file=self.file, line=key)

    def row(self, key: int, cells: Row, number: int) -> tuple[CellRow, Iterator[Problem]]:
        """A row with the places at which its cells start, and what is wrong with it."""
        texts = list(map(text_of, cells))
        row = self._cells(self.quoted.get(key) or self.delimiter.join(texts), key, texts)
        return row, self._problems(row, texts, number)

    def _problems(self, row: CellRow, texts: Sequence[str], number: int) -> Iterator[Problem]:
        """What is wrong with a row that is another header, or has other cells than the header has columns."""
        if headers_in(row) != self.header and (problem := other_header(row, number)):
            if self.one_robot and starts_table(row):
                lines_of_table(self.path, None)
            yield problem
            return
        more = next((text for text in texts[self.width :] if text.strip()), None)
        if len(texts) >= self.needed and (more is None or is_comment(more)):
            return
        has_more = self.delimiter == "," and len(texts) > self.width
        advice = "is there a decimal comma in it, or a comma in a text without quotes?" if has_more else None
        joint, count, sign = f"joint_{number}", len(texts), DELIMITERS[self.delimiter]
        about: dict[str, Any] = {"number": number, "cells": count, "columns": self.width, "sign": sign}
        yield say("ragged-row", row.mark, joint=joint, suggestion=advice, **about)


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
