"""Comment lines of a CSV file, as people type them and as spreadsheets write them back.

A spreadsheet knows no comments. It opens the line as cells and saves it as cells: it fills the line up with delimiters,
puts cells in quotes, and splits what stood between brackets at every comma. Here the line becomes what was typed.
"""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from dh2urdf.source import Mark
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.cells import SPACES

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

MARKERS = ("#", "%", "//")
"""What a comment begins with: as in Python, in MATLAB and in C."""
SIGNS = (*MARKERS, "\N{FULLWIDTH NUMBER SIGN}", "\N{FULLWIDTH PERCENT SIGN}")
"""What a line contains if it is a comment; East Asian keyboards have signs of full width."""
_TOP_ONLY = ("%", "\N{FULLWIDTH PERCENT SIGN}")
"""What only a line above the header begins with if it is a comment."""
_QUOTED = "#>"
"""What a comment begins with whose words are those of another file."""

_INVISIBLE = SPACES + "\ufeff\u3000"
_APOSTROPHES = "'\N{RIGHT SINGLE QUOTATION MARK}\N{LEFT SINGLE QUOTATION MARK}`\N{ACUTE ACCENT}"
_ANY_START = (
    rf'(?P<outer>(?:[{_INVISIBLE},;]|"")*+)(?P<quote>"?)[{_INVISIBLE}]*+[{_APOSTROPHES}]*+[{_INVISIBLE}]*+'
    rf"(?P<sign>{'|'.join(SIGNS)})"
)
SPREADSHEET_ERROR = r"\s*#(?:[¡¿]?[A-Z\u00c0-\u00dc][A-Z\u00c0-\u00dc/0-9_ ]*[!?]|N/?[AVD]\b|CALC!|GETTING_DATA|KALK!)"
"""What spreadsheets write for an error: ``#REF!``, ``#NAME?``, ``#N/A``, in German ``#WERT!`` and ``#NV``."""
_DECIMAL_COMMA = r"([^,]*?[+-]?[0-9]*),([0-9]+[^,]*)"
_OPEN_KEY = (":", "=", "\uff1a")
"""What a key ends with whose value is in the next cell."""
_BRACKETS = frozenset("[{")
_NUMBER = r"[-+−(]*([0-9]|[.,][0-9]|\\?pi\b|π)"


@dataclass(frozen=True, slots=True)
class Comment:
    """A comment of a table, in whatever format."""

    text: str  # what is behind the marker
    mark: Mark  # where that is
    line: str  # the whole comment, as messages repeat it
    whole: Mark  # the place of the whole comment

    @classmethod
    def of(cls, line: str, place: Mark, *, longest: int = MAX_TEXT) -> Comment:
        """The comment that a line or a row is, with its marker or without one; a quoted or long one has no text."""
        start = _start_of(line)
        text = line[start.end() :] if start else line
        if is_quoted(line) or len(text) > longest:
            text = ""
        rest = text.lstrip(f"{_INVISIBLE}{''.join(MARKERS)}")
        return cls(rest, within(place, len(line) - len(rest)), line.strip(), place)


def _start_of(line: str) -> re.Match[str] | None:
    """The beginning of a comment line: ``outer`` cells without content, a ``quote`` perhaps, and the ``sign``."""
    return re.match(_ANY_START, line) if any(sign in line for sign in SIGNS) else None


def is_quoted(line: str) -> bool:
    """Whether a comment has the words of another file, as ``#> …`` has: nothing is read from it."""
    start = _start_of(line) if _QUOTED in line else None
    return start is not None and line.startswith(_QUOTED, start.start("sign"))


def within(place: Mark, position: int) -> Mark:
    """The place of a character of a line, counted from 0; a cell has one place for all of its characters."""
    return place if place.place else replace(place, column=(place.column or 1) + position)


def is_comment(line: str, *, top: bool = False) -> bool:
    """Whether a line is a comment by its first characters; an error of a spreadsheet begins with # too, and is none.

    Above the header a comment may be in quotes, in a column further right, or begin with the % of MATLAB; below, a cell
    in quotes may be a name, and one that begins with % is no comment, so that no row of a joint is lost.
    """
    start = _start_of(line)
    if start is None or (line[start.end() :][:1] != " " and re.match(SPREADSHEET_ERROR, line[start.start("sign") :])):
        return False
    return top or not (start["quote"] or start["outer"].strip(_INVISIBLE) or start["sign"] in _TOP_ONLY)


def is_open(line: str) -> bool:
    """Whether a comment in quotes goes on in the next line."""
    start = _start_of(line)
    return start is not None and bool(start["quote"]) and line.count('"') % 2 == 1


def without_marker(line: str) -> str:
    """A comment line with spaces in place of its marker: the header that is commented out, perhaps."""
    start = _start_of(line)
    before, end = (start.end("quote"), start.end()) if start else (0, 0)
    return line[:before] + " " * (end - before) + line[end:]


def as_typed(line: str, delimiter: str) -> list[str]:
    """A comment line of a table with a delimiter as a person would type it; several where a cell has several lines."""
    start = _start_of(line)
    if start is None:
        return [line]
    padded = line.rstrip(f'{SPACES}{delimiter}"')
    at = start.start("sign")
    typed = without_marker(line)[:at] + line[at:].rstrip(SPACES + delimiter)
    if start["quote"] or delimiter in line[len(padded) :] or (delimiter != "," and _BRACKETS.intersection(typed)):
        cells = next(csv.reader([line.lstrip(SPACES + delimiter)], delimiter=delimiter), [])
        first = _start_of(cells[0]) if cells else None
        if first:
            parts = [cells[0][first.start("sign") :], *cells[1:]]
            typed = " " * at + joined(parts, decimal_comma=delimiter != ",")
    return typed.split("\n")


def joined(cells: Sequence[str], *, decimal_comma: bool = False) -> str:
    """What was one text before a spreadsheet made cells of it: ``# convention:``, ``standard``."""
    parts = [cell for cell in cells if cell.strip(SPACES)]
    if decimal_comma and len(parts) > 1:  # a part of a list has a point in place of its decimal comma
        parts = [f"{match[1]}.{match[2]}" if (match := re.fullmatch(_DECIMAL_COMMA, part)) else part for part in parts]
    signs = [" " if part.rstrip(SPACES).endswith(_OPEN_KEY) else "," for part in parts]
    return "".join(map(str.__add__, parts, signs))[:-1].rstrip(SPACES)


def fills_row(cells: Sequence[str], required: Iterable[int]) -> bool:
    """Whether cells, the first of which begins as a comment does, are a row: what it needs is there, and a number."""
    filled = [cells[index].strip(SPACES) if index < len(cells) else "" for index in required]
    return all(filled) and any(re.match(_NUMBER, each) for each in filled)
