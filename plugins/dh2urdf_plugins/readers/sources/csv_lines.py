"""The lines of a CSV file, and its records with the line at which each starts."""

from __future__ import annotations

import csv
import re
from collections import deque
from itertools import accumulate, chain, islice
from typing import TYPE_CHECKING, NoReturn

from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.comments.declared import comment_below
from dh2urdf_plugins.readers.sources.csv_header import starts_of
from dh2urdf_plugins.readers.statements.text import line_blocks
from dh2urdf_plugins.readers.words.cells import SPACES
from dh2urdf_plugins.readers.words.comment_lines import (
    SIGNS,
    as_typed,
    fills_row,
    is_comment,
    joined,
    marks_a_comment,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf_plugins.readers.words.comment_lines import Comment

MAX_BELOW = 1000
"""Comments below the header that are kept, for the names that they may define."""

COMPUTED = "=+@-"
"""How a cell begins that a spreadsheet computes. `texts` writes names of that kind as texts, behind an apostrophe."""
_GUARDED = re.compile(f"'+[{COMPUTED}]")
_CAREFUL = ('"', *(f"'{sign}" for sign in COMPUTED))
"""What a block has whose lines are more than cells and delimiters."""


class CsvLines:
    """The lines of a file, comment lines made empty once the header has been read.

    Attributes:
        quoted: number and text of the latest lines with quotes, or apostrophes before a sign: where a cell of these
            starts, the lengths of the cells before it do not tell.
        quotes_in_block: whether the latest block has any of them.
        signs_in_block: whether the latest block has a sign that a comment begins with.
        required: the columns that every row fills, unlike a comment that a spreadsheet has put into cells.
        passed: the lines of the comments among the latest rows, which are no empty rows.
    """

    def __init__(self, path: Path) -> None:
        self.file = str(path)
        self.number = 0
        self.quoted: deque[tuple[int, str]] = deque()
        self.quotes_in_block = False
        self.blocks = line_blocks(path)
        self.rest: Iterator[str] = iter(())
        self.signs_in_block = False
        self.required: Sequence[int] = ()
        self.passed: set[int] = set()
        self.below: list[Comment] = []  # comments below the header that may define names

    def __iter__(self) -> Iterator[str]:
        """The lines as they are, one by one: the top of the file."""
        for block in self.blocks:
            self.rest = iter(block)
            while (line := next(self.rest, None)) is not None:
                self.number += 1
                yield line

    def ahead(self) -> list[str]:
        """The lines that follow the one that was read last, as many as were read from the file at once."""
        lines = list(self.rest) or next(self.blocks, [])
        self.rest = iter(lines)
        return lines

    def skip(self, count: int) -> None:
        """Passes over lines that `ahead` has shown."""
        self.number += len(list(islice(self.rest, count)))

    def _below_header(self, delimiter: str) -> Iterator[tuple[int, list[str]]]:
        """Blocks of the lines below the one that was read last, each with the number of its first line."""
        for block in chain((list(self.rest),), self.blocks):
            start = self.number + 1
            self.number += len(block)
            yield start, self._prepared(block, start, delimiter)

    def _prepared(self, block: list[str], start: int, delimiter: str) -> list[str]:
        text = "".join(block)
        self.quotes_in_block = any(sign in text for sign in _CAREFUL)
        if self.quotes_in_block:
            lines = enumerate(block, start)
            self.quoted.extend((at, line) for at, line in lines if any(sign in line for sign in _CAREFUL))
            block = [line + "\n" for line in block]  # a cell in quotes keeps the end of the line
        self.signs_in_block = any(sign[0] in text and sign in text for sign in SIGNS)
        if not self.signs_in_block:
            return block
        return [
            "" if is_comment(line) and self._passes_over(line, start + k, delimiter) else line
            for k, line in enumerate(block)
        ]

    def _passes_over(self, line: str, number: int, delimiter: str) -> bool:
        """Passes over a comment below the header.

        Raises:
            TableError: it says something, which would not hold for the rows above.
        """
        self.passed.add(number)
        for text in as_typed(line, delimiter):
            comment = comment_below(text, Mark(file=self.file, line=number))
            if "=" in comment.line and len(self.below) < MAX_BELOW:
                self.below.append(comment)
        return True

    def _is_quoted_comment(self, cells: Sequence[str]) -> bool:
        """Whether a row whose first cell was in quotes is a comment that a spreadsheet has put into cells."""
        return bool(cells) and marks_a_comment(cells[0]) and not fills_row(cells, self.required)

    def records(self, delimiter: str) -> Iterator[tuple[Sequence[int], list[list[str]]]]:
        """Batches of rows, and the line at which each row starts."""
        blocks = self._below_header(delimiter)
        for start, lines in blocks:
            if not self.quotes_in_block and max(map(len, lines), default=0) < csv.field_size_limit():
                # Without quotes `csv.reader` does the same, in twice the time.
                yield range(start, start + len(lines)), [line.split(delimiter) if line else [] for line in lines]
                self.passed.clear()
                continue
            source = _Joined(lines, blocks)
            reader = csv.reader(source, delimiter=delimiter, strict=True)
            starts, batch = [], []
            try:
                while reader.line_num < source.count:
                    starts.append(start + reader.line_num)
                    cells = next(reader)
                    if self.signs_in_block and self._is_quoted_comment(cells):
                        self._passes_over(joined(cells, decimal_comma=delimiter != ","), starts[-1], delimiter)
                        cells = []
                    batch.append([cell[1:] if _GUARDED.match(cell) else cell for cell in cells])
            except csv.Error as error:
                self._refuse_cell(error, starts[-1])
            yield starts, batch
            self.passed.clear()

    def _refuse_cell(self, error: csv.Error, line: int) -> NoReturn:
        """Refuses the file for a cell whose quotes are wrong, or that has no end."""
        number, text = next(((n, text) for n, text in self.quoted if n >= line and '"' in text), (line, ""))
        is_open = number == line and text.count('"') % 2
        suggestion = "a quote that is part of the text is written twice" if text else None
        if "limit" in str(error) and not is_open:
            message, accepted = "a cell is too long", f"at most {csv.field_size_limit()} characters in a cell"
            text, suggestion = "", None
        elif "expected after" in str(error):
            message, accepted = "text is behind a closing quote", "a delimiter, or the end of the line"
        else:
            message, accepted = "a cell opens with a quote that is not closed", 'a quote at both ends, "like this"'
        raise TableError(
            Problem(
                message=f"{message}: {shown(text.strip())}" if text else message,
                mark=Mark(file=self.file, line=line, column=text.find('"') + 1 or None),
                found=text or None,
                accepted=accepted,
                suggestion=suggestion,
            )
        )

    def starts(self, number: int, cells: Sequence[str], delimiter: str) -> list[int]:
        """The columns at which the cells of a row start, counted from 1 in characters."""
        while self.quoted and self.quoted[0][0] < number:
            self.quoted.popleft()
        if self.quoted and self.quoted[0][0] == number:
            starts = starts_of(self.quoted[0][1], delimiter)
            return starts + starts[-1:] * (len(cells) - len(starts))  # where a cell goes on in the next line
        ends = accumulate(len(cell) + 1 for cell in cells)
        return [end - len(cell.lstrip(SPACES)) for end, cell in zip(ends, cells, strict=True)]


class _Joined:
    """The lines of a block with quotes, and those of the next ones as far as a cell in quotes runs on into them.

    Attributes:
        count: lines of the blocks that were begun.
    """

    def __init__(self, lines: list[str], blocks: Iterator[tuple[int, list[str]]]) -> None:
        self.count = len(lines)
        self.lines = iter(lines)
        self.blocks = blocks

    def __iter__(self) -> Iterator[str]:
        yield from self.lines
        for _, lines in self.blocks:
            self.count += len(lines)
            yield from lines
