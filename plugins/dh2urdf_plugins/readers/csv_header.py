"""The top of a CSV table: comment lines that say what columns cannot, the delimiter, and the header."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.documents import Node
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.cells import SPACES, Cell
from dh2urdf_plugins.readers.csv_comments import convention_in_prose, is_comment, statement
from dh2urdf_plugins.readers.fields import REQUIRED, read_header
from dh2urdf_plugins.readers.headers import Columns, name_columns

if TYPE_CHECKING:
    from collections.abc import Iterable

DELIMITERS = {",": "comma", ";": "semicolon", "\t": "tab"}
MAX_HEADER = 100_000
"""Length of the header [1]."""

_EXCEL_SEPARATOR = re.compile(r'\s*"?sep=(.)"?\s*', re.IGNORECASE)  # Excel's own way to name the delimiter


@dataclass(slots=True)
class Top:
    """Everything above the first row.

    Attributes:
        columns: the header.
        statements: what comment lines say, by key.
        comments: comment lines that speak of the one convention or the other in prose.
    """

    columns: Columns
    statements: dict[str, Node]
    comments: list[tuple[Convention, Cell]]


def read_top(lines: Iterable[str], file: str) -> Top:
    """Everything above the first row; the lines behind the header are not touched.

    Raises:
        TableError: there is no header, or it is wrong, or a comment line is.
    """
    statements: dict[str, Node] = {}
    comments: list[tuple[Convention, Cell]] = []
    delimiter: str | None = None
    number = 0
    for number, line in enumerate(lines, start=1):
        if not line.strip(SPACES + "".join(DELIMITERS)):
            continue
        if number == 1 and (match := _EXCEL_SEPARATOR.fullmatch(line)):
            delimiter = match[1]
            continue
        long = len(line) > MAX_HEADER
        if long and not is_comment(line):
            message = f"this line should be the header, and has {len(line)} characters"
            raise TableError(
                Problem(message=message, mark=Mark(file=file, line=number), accepted=f"at most {MAX_HEADER} characters")
            )
        header = line if not is_comment(line) else None if long else commented_header(line)
        if header is not None:
            return Top(read_columns(header, number, file, delimiter), statements, comments)
        if convention := convention_in_prose(line):
            comments.append((convention, Cell(line.strip(), Mark(file=file, line=number))))
        if found := statement(line, number, file):
            key, node = found
            if key in statements:
                message = f"a comment line says {key} already, in line {statements[key].line}"
                raise TableError(Problem(message=message, mark=Mark(file=file, line=number), field=key))
            statements[key] = node
    raise TableError(
        Problem(
            message="there is no header and there are no rows" if number else "the file is empty: there is no header",
            mark=Mark(file=file),
            accepted="a header with at least the columns a, alpha and d, and one row for each joint",
        )
    )


def split(line: str, delimiter: str) -> list[str]:
    """The cells of one line."""
    return [cell.strip(SPACES) for cell in next(csv.reader([line], delimiter=delimiter), [])]


def starts_of(line: str, delimiter: str) -> list[int]:
    """The columns, in characters from 1, at which the cells of a line start."""
    starts, quoted = [0], False
    for position, character in enumerate(line):
        if character == '"':
            quoted = not quoted
        elif character == delimiter and not quoted:
            starts.append(position + 1)
    ends = [*starts[1:], len(line) + 1]
    return [
        start + len(cell) - len(cell.lstrip(SPACES)) + 1
        for start, cell in ((start, line[start : end - 1]) for start, end in zip(starts, ends, strict=True))
    ]


def delimiter_of(line: str) -> str | None:
    """The delimiter of a header: the one that makes the most fields of it."""

    def score(delimiter: str) -> tuple[int, int]:
        cells = split(line, delimiter)
        return sum(read_header(cell).field is not None for cell in cells), len(cells)

    best = max(DELIMITERS, key=score)
    fields, cells = score(best)
    return best if fields and cells > 1 else None


def commented_header(line: str) -> str | None:
    """The header that a line starting with # is, or None where it is a comment.

    The first column may be called ``#``, or the header as a whole may be commented out, as numpy writes it.
    """
    found: dict[str, set[str]] = {}
    for text in (line, line.replace("#", " ", 1)):
        headers = map(read_header, split(text, delimiter_of(text) or ","))
        found[text] = {header.field.name for header in headers if header.field}
    best = max(found, key=lambda text: len(found[text]))
    return best if found[best].issuperset(REQUIRED) else None


def read_columns(line: str, number: int, file: str, delimiter: str | None = None) -> Columns:
    """What a header says.

    Args:
        line: the header.
        number: its line.
        file: the file.
        delimiter: what stands between cells, where a line above says it.

    Raises:
        TableError: everything that is wrong with it.
    """
    delimiter = delimiter if delimiter in DELIMITERS else delimiter_of(line)
    if delimiter is None:
        raise TableError(_no_header(line, number, file))
    starts = starts_of(line, delimiter)
    headers = split(line, delimiter)
    places = [starts[min(index, len(starts) - 1)] for index in range(len(headers))]
    marks = [Mark(file=file, line=number, column=place) for place in places]
    return name_columns(headers, marks, Mark(file=file, line=number), delimiter)


def _no_header(line: str, number: int, file: str) -> Problem:
    return Problem(
        message=f"this line is no header whose columns are known: {shown(line)}",
        mark=Mark(file=file, line=number),
        found=line,
        accepted="a header with at least the columns a, alpha and d, such as `joint,type,a,alpha,d,theta`, with one "
        "delimiter: comma, semicolon or tab",
        suggestion="columns aligned with spaces or bars cannot be told apart; put commas between them"
        if "  " in line or "|" in line
        else None,
    )
