"""The top of a CSV table: comment lines, the delimiter, and the header."""

from __future__ import annotations

import re
from itertools import islice
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.table_text import REQUIRED, STATEMENTS, CellRow
from dh2urdf_plugins.readers.comments.top import MAX_TITLES, is_header
from dh2urdf_plugins.readers.header.columns import TURN_ROUND, are_joints
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.sources.texts import DELIMITERS, MAX_HEADER, split
from dh2urdf_plugins.readers.words.bounds import MAX_TEXT
from dh2urdf_plugins.readers.words.cells import SPACES
from dh2urdf_plugins.readers.words.comment_lines import as_typed, is_comment, is_open, is_quoted, without_marker

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

_COMMENT_LINES = 1000
"""Lines that a comment, or a header, in quotes may run over."""
_EMPTY = SPACES + "".join(DELIMITERS) + '"'
"""What a line consists of that holds nothing."""

_EXCEL_SEPARATOR = r'(?i)\s*"?sep=(.)"?[\s,;]*'  # Excel's own way to name the delimiter


def top_rows(
    lines: Iterable[str], file: str, ahead: Callable[[], Sequence[str]]
) -> Iterator[tuple[CellRow, str | None]]:
    """The lines above the header and the header with its delimiter: comments of one cell each, and titles in cells.

    The header is the first line that names two of a, alpha, d and theta; one in a comment, unless a header is below it.
    Where no line does, it is the line that is most like one, so that a message can say what it lacks.

    Args:
        lines: the lines of the file.
        file: the file.
        ahead: returns the lines that follow the one that was read last.

    Raises:
        TableError: there is no header.
    """
    held: list[_Line] = []
    titles: list[_Line] = []  # what is held and no comment
    delimiter: str | None = None
    for number, first in (numbered := enumerate(lines, start=1)):
        if not first.strip(_EMPTY):
            continue
        if number == 1 and "=" in first and (match := re.fullmatch(_EXCEL_SEPARATOR, first)):
            delimiter = match[1] if match[1] in DELIMITERS else None
            continue
        line = _whole(first, numbered)
        if len(line) > MAX_HEADER and not is_comment(line, top=True):
            raise TableError(_long_header(line, number, file))
        comment = is_comment(line, top=True)
        header = _header_in(line) if comment else line
        found = delimiter or delimiter_of(header)
        if (
            found
            and is_header(row := _cells(header, number, file, found))
            and not (comment and _explains_header(line, ahead(), number, file, found))
        ):
            if not comment and _is_cut(line):
                raise TableError(_open_header(first, number, file))
            yield from ((above, None) for above in _above(held, file, found))
            yield row, found
            return
        held.append(_Line(number, line, comment))
        titles += [] if comment else held[-1:]
        if len(titles) > MAX_TITLES:
            break
    if not titles:
        yield from ((above, None) for above in _above(held, file, None))
        raise TableError(_nothing(file, empty=not held))
    likely = max(titles, key=lambda title: _known(title.text))
    found = delimiter or delimiter_of(likely.text)
    if found is None:
        raise TableError(_no_header(likely.text, likely.number, file))
    yield from ((above, None) for above in _above(held[: held.index(likely)], file, found))
    yield _cells(likely.text, likely.number, file, found), found


def _explains_header(comment: str, below: Sequence[str], number: int, file: str, delimiter: str) -> bool:
    """Whether a header in a comment is above the header itself, and only explains it: it names no link before."""
    if "1" in comment:
        return False
    found = row_below([line for line in below[:MAX_TITLES] if not is_comment(line, top=True)], number, file, delimiter)
    return found is not None and is_header(found[0])


def _header_in(comment: str) -> str:
    """The header in a comment; empty where it holds none."""
    return (commented_header(comment) if len(comment) <= MAX_HEADER else None) or ""


class _Line(NamedTuple):
    """A line above the header.

    Attributes:
        number: counted from 1.
        text: the line, or several where a cell in quotes runs over them.
        comment: whether it begins as a comment does.
    """

    number: int
    text: str
    comment: bool


def _whole(line: str, lines: Iterator[tuple[int, str]]) -> str:
    """A line with those that follow, as far as a cell in quotes runs on into them."""
    is_cut = is_open if is_comment(line, top=True) else _is_cut
    for _, more in islice(lines, _COMMENT_LINES) if is_cut(line) else ():
        line += f"\n{more}"
        if not is_cut(line) or len(line) > MAX_HEADER:
            break
    return line


def _is_cut(line: str) -> bool:
    """Whether a line ends in a cell that begins with a quote: one in the middle of a cell, as of 5", opens none."""
    quoted, begins = False, True
    for character in line:
        if character == '"' and (quoted or begins):
            quoted, begins = not quoted, quoted  # of two in quotes, the second one opens them again
        elif not quoted:
            begins = character in DELIMITERS or (begins and character in SPACES)
    return quoted


def _known(line: str) -> int:
    """How many columns of a line name a field."""
    return max(len({h.field.name for h in map(read_header, split(line, each)) if h.field}) for each in DELIMITERS)


def _nothing(file: str, *, empty: bool) -> Problem:
    return Problem(
        message="the file is empty: there is no header" if empty else "there is no header and there are no rows",
        mark=Mark(file=file),
        accepted="a header with at least the columns a, alpha and d, and one row for each joint",
    )


def _above(lines: Iterable[_Line], file: str, delimiter: str | None) -> Iterator[CellRow]:
    """The lines above a header: comments of one cell each, and titles in cells."""
    for number, line, comment in lines:
        if not comment and delimiter:
            yield _cells(line, number, file, delimiter)
            continue
        for index, text in enumerate(as_typed(line, delimiter)):
            yield CellRow([text], Mark(file=file, line=number + index))


def _long_header(line: str, number: int, file: str) -> Problem:
    return Problem(
        message=f"this line should be the header, and has {len(line)} characters",
        mark=Mark(file=file, line=number),
        accepted=f"at most {MAX_HEADER} characters",
    )


def _open_header(line: str, number: int, file: str) -> Problem:
    return Problem(
        message=f"a column of the header opens with a quote that is not closed: {shown(line.strip())}",
        mark=Mark(file=file, line=number),
        found=line,
        accepted='a quote at both ends, "like this", or none',
    )


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

    best = max((delimiter for delimiter in DELIMITERS if delimiter in line), key=score, default=None)
    fields, cells = score(best) if best else (0, 0)
    return best if fields and cells > 1 else None


def commented_header(line: str) -> str | None:
    """The header that a line starting with # is, or None where it is a comment.

    The first column may be called ``#``, or the header as a whole may be commented out, as numpy writes it.
    """
    if max(map(line.count, DELIMITERS)) + 1 < len(REQUIRED) or is_quoted(line):
        return None
    found: dict[str, set[str]] = {}
    for text in (line, without_marker(line)):
        headers = map(read_header, split(text, delimiter_of(text) or ","))
        found[text] = {header.field.name for header in headers if header.field}
    best = max(found, key=lambda text: len(found[text]))
    return best if found[best].issuperset(REQUIRED) else None


def _cells(line: str, number: int, file: str, delimiter: str) -> CellRow:
    """The cells of a line."""
    starts = starts_of(line, delimiter)
    cells = split(line, delimiter)
    places = [starts[min(index, len(starts) - 1)] for index in range(len(cells))]
    marks = [Mark(file=file, line=number, column=place) for place in places]
    return CellRow(cells, Mark(file=file, line=number), marks)


def row_below(lines: Sequence[str], number: int, file: str, delimiter: str) -> tuple[CellRow, int] | None:
    """The first of some lines that holds anything, as cells, and how many lines end with it; None for a comment."""
    for count, line in enumerate(lines, start=1):
        if line.strip(_EMPTY):
            short = len(line) <= MAX_HEADER and not is_comment(line, top=True)
            return (_cells(line, number + count, file, delimiter), count) if short else None
    return None


def _no_header(line: str, number: int, file: str) -> Problem:
    return Problem(
        message=f"this line is no header whose columns are known: {shown(line)}",
        mark=Mark(file=file, line=number),
        field="columns",
        found=line,
        accepted="a header with at least the columns a, alpha and d, such as `joint,type,a,alpha,d,theta`, with one "
        "delimiter: comma, semicolon or tab",
        suggestion=_advice(line[:MAX_TEXT]),
    )


def _advice(line: str) -> str | None:
    """What to do about a line that is no header."""
    text = line.strip(SPACES + ',\t"')
    if (found := re.match(r"[^\W\d]+", text)) and found[0].casefold() in STATEMENTS and ":" in text:
        return f"write `# {text}`: what holds for all rows is in comment lines"
    if any(are_joints(split(line, delimiter)) for delimiter in DELIMITERS):
        return TURN_ROUND
    return "`--columns theta,d,a,alpha` names the columns of numbers without a header, in their order"
