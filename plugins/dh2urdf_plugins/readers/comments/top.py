"""The top of a table, whatever its format: comments that say what columns cannot, titles, and the header."""

from __future__ import annotations

import re
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from dh2urdf.documents import Node
from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem, listed, shown
from dh2urdf.table_text import STATEMENTS
from dh2urdf_plugins.readers.comments.declared import is_statement_key, name_said, statements_in
from dh2urdf_plugins.readers.header.columns import TURN_ROUND, Columns, are_joints, marked_as_left_out, name_columns
from dh2urdf_plugins.readers.header.header_rows import headers_in, join_headers, text_in
from dh2urdf_plugins.readers.header.unknown_columns import DIFFERENCES, other_geometry
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.words.bounds import MAX_COLUMNS, MAX_TEXT
from dh2urdf_plugins.readers.words.cells import SPACES
from dh2urdf_plugins.readers.words.comment_lines import Comment, is_comment, joined
from dh2urdf_plugins.readers.words.fields import convention_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterable, Mapping, Sequence

    from dh2urdf.table_text import CellRow


GEOMETRY = frozenset(("a", "alpha", "d", "theta"))
SURE = 2
"""Fields of geometry that make a row a header beyond doubt."""
MAX_TITLES = 1000
"""Rows that may be above the header."""
_OTHER_COMMENT = r"(?i)\s*(?:--|[!;*]|/\*|<!--|rem\b)"
"""What a comment of another language begins with."""


@dataclass(slots=True)
class Top:
    """Everything above the first row.

    Attributes:
        columns: the header.
        statements: what comments say, by key.
        comments: those that say nothing under a key.
        notices: of rows above the header that nothing is read from.
    """

    columns: Columns
    statements: dict[str, Node]
    comments: list[Comment] = field(default_factory=list)
    notices: list[Problem] = field(default_factory=list)


def read_top(
    rows: Iterable[CellRow],
    whole: Mark,
    statements: Mapping[str, Node] | None = None,
    *,
    ignore: Collection[str] = (),
) -> Top:
    """Everything above the first row; the rows behind the header are not touched.

    The header is the first row that names two of a, alpha, d and theta. A row above it is a comment, with or without a
    # before it.

    Args:
        rows: the rows of the table from the top.
        whole: the place of the table as a whole.
        statements: what the file says outside its rows, by key.
        ignore: the headers of columns that are left out.

    Raises:
        TableError: there is no header, or it is wrong, or a comment is.
    """
    top = _TopReader(statements or {})
    above: CellRow | None = None
    for row in rows:
        if is_header(row):
            header = row
            break
        above = row if any(map(text_in, row.cells)) else None
        if above:
            top.add(above)
            if len(top.titles) > MAX_TITLES:
                raise TableError(_no_header(top.titles, whole))
    else:  # the row that is most like a header, so that the message names what it lacks
        likely = max(top.titles, key=lambda row: len(_fields(row)), default=None)
        if likely is None or not _fields(likely):
            raise TableError(_no_header(top.titles, whole))
        header = likely
    if problem := _too_large(header):
        raise TableError(problem)
    if above and above in top.titles and above is not header and not _too_large(above):
        header, unused = join_headers(above, header)
        top.titles[-1:] = [unused] if any(unused.cells) else []
    if isinstance(rows, HeaderRows):
        header = rows.complete(header)
    texts = marked_as_left_out(header, ignore)
    columns = name_columns(texts, header.marks or [header.mark] * len(texts), header.mark)
    return Top(columns, top.said, top.comments, [*top.notices, *_title_notices(top.titles)])


def _too_large(header: CellRow) -> Problem | None:
    """What is wrong with a header of too many columns, or one of whose cells is too long."""
    count, longest = len(header.cells), max((len(text_in(cell)) for cell in header.cells), default=0)
    if count > MAX_COLUMNS:
        message, accepted = f"the header has {count:,} columns", f"at most {MAX_COLUMNS:,} columns"
    elif longest > MAX_TEXT:
        message, accepted = f"a column has a header of {longest:,} characters", f"at most {MAX_TEXT:,} characters"
    else:
        return None
    return Problem(message=message, mark=header.mark, accepted=accepted)


@runtime_checkable
class HeaderRows(Protocol):
    """Rows whose header may go on in the row below it."""

    def complete(self, header: CellRow) -> CellRow:
        """The header with what the row below it adds: units, or names of columns that share a title."""


def is_header(row: CellRow) -> bool:
    """Whether a row is a header beyond doubt."""
    has_marker = bool(row.cells) and text_in(row.cells[0]).startswith("# ")  # `# a` names no column
    return len(row.cells) - has_marker >= SURE and len(_fields(row) & GEOMETRY) >= SURE


def find_header(rows: Iterable[CellRow]) -> CellRow | None:
    """The header of a table, as `read_top` finds it; None where no row is one."""
    filled = (row for row in rows if any(map(text_in, row.cells)))
    return next(filter(is_header, islice(filled, MAX_TITLES)), None)


class _TopReader:
    """Takes the rows above the header.

    Attributes:
        said: what they declare about all rows, by key.
        comments: those that say nothing under a key.
        titles: those that are neither comments nor statements.
        notices: of other names than the one that the manipulator gets.
    """

    def __init__(self, said: Mapping[str, Node]) -> None:
        self.said = dict(said)
        self.comments: list[Comment] = []
        self.titles: list[CellRow] = []
        self.notices: list[Problem] = []
        self.named: Comment | None = None  # what says the name under another key than `name`

    def add(self, row: CellRow) -> None:
        """Takes a row, which may say something with or without a # before it."""
        text = comment_text(row)
        comment = Comment.of(text, row.mark, longest=len(text))
        if not is_comment(text, top=True):
            _refuse_other_comment(text, row.mark)
        found = statements_in(comment)
        if not found:
            self.comments.append(Comment.of(text, row.mark))
            if not is_comment(text, top=True):
                self.titles.append(row)
        for key, node in found.items():
            if key != "name" or self._is_name(comment):
                self.said[key] = _both(key, self.said[key], node) if key in self.said else node

    def _is_name(self, comment: Comment) -> bool:
        """Whether a comment that says a name is the one that holds: `name`, or else the first of the others."""
        by_key, earlier = name_said(comment) is None, self.named
        if not by_key:
            self.named = comment
        if "name" not in self.said or (by_key and earlier is None):
            return True
        left_out = earlier if by_key and earlier else comment
        message = f"nothing is read from {shown(left_out.line)}: another line says the name"
        self.notices.append(Problem(message=message, severity="notice", mark=left_out.whole, found=left_out.line))
        if by_key:
            del self.said["name"]
            self.named = None
        return by_key


def _refuse_other_comment(text: str, mark: Mark) -> None:
    """Refuses what says something in a comment of another language, which is none here.

    Raises:
        TableError: it is such a comment.
    """
    match = re.match(_OTHER_COMMENT, text)
    if match and statements_in(Comment.of(text[match.end() :], mark)):
        message = f"{shown(text)} is no comment here, and says nothing"
        raise TableError(Problem(message=message, mark=mark, found=text, suggestion="a comment begins with #"))


def _both(key: str, earlier: Node, node: Node) -> Node:
    """Two comments as one statement: units of lengths here and of angles there.

    Raises:
        TableError: both say the same.
    """
    one, other = earlier.value, node.value
    if key == "units" and isinstance(one, dict) and isinstance(other, dict) and _agree(one, other):
        return replace(earlier, value={**one, **other}, key_places={**earlier.key_places, **node.key_places})
    if key == "convention" and convention_of(earlier.text or "") == convention_of(node.text or ""):
        return earlier
    message = f"a comment line says {key} already, in {earlier.mark.in_file or earlier.file}"
    raise TableError(Problem(message=message, mark=replace(node.mark, column=None), field=key))


def _agree(one: Mapping[str, Node], other: Mapping[str, Node]) -> bool:
    """Whether two mappings of words contradict each other nowhere."""
    return all(one[key].text == other[key].text is not None for key in one.keys() & other)


def comment_text(row: CellRow) -> str:
    """The text of a comment that a format may have split into cells: ``# convention``, ``standard``."""
    first, *others = [text for cell in row.cells if (text := text_in(cell).strip(SPACES))]
    key = first.strip(f"{SPACES}#:=").casefold()
    if others and (key in STATEMENTS or (len(others) == 1 and is_statement_key(key))):
        return f"{'# ' if is_comment(first) else ''}{key}: {', '.join(others)}"
    return joined([first, *map(" {}".format, others)])


def _fields(row: CellRow) -> set[str]:
    headers = [read_header(cell.strip(SPACES)) for cell in row.cells if isinstance(cell, str)]
    return {header.field.name for header in headers if header.field}


def _no_header(titles: Sequence[CellRow], whole: Mark) -> Problem:
    first = shown(comment_text(titles[0])) if titles else None
    return Problem(
        message=f"no row is a header whose columns are known; the first row is {first}"
        if first
        else "there is no header and there are no rows",
        mark=titles[0].mark if titles else whole,
        accepted="a header with at least the columns a, alpha and d, and one row for each joint",
        suggestion=_advice(headers_in(titles[0])) if titles else None,
    )


def _advice(headers: Sequence[str]) -> str | None:
    """What to do about a row that is no header."""
    if are_joints(headers):
        return TURN_ROUND
    return DIFFERENCES if any(other_geometry(header, "column") for header in headers) else None


def _title_notices(titles: Sequence[CellRow]) -> list[Problem]:
    """A notice of the rows above the header that are neither comments nor statements."""
    if not titles:
        return []
    texts = listed([shown(comment_text(row)) for row in titles])
    return [
        Problem(
            message=f"nothing is read from what is above the header: {texts}",
            severity="notice",
            mark=titles[0].mark,
            accepted=f"above the header: {', '.join(STATEMENTS)}, as in `units: {{length: mm, angle: deg}}`; and "
            "comments, which begin with #",
        )
    ]
