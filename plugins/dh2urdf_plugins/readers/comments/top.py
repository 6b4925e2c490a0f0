"""The top of a table, whatever its format: comments that declare what columns cannot, titles, and the header."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Protocol

from dh2urdf.documents import Node
from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Messages, Problem
from dh2urdf.table_text import PARAMETERS, STATEMENTS
from dh2urdf_plugins.readers.comments.declared import Sentence, declared_key, said_in, statement_in
from dh2urdf_plugins.readers.header.columns import TURN_ROUND, Columns, are_joints, name_columns
from dh2urdf_plugins.readers.header.header_rows import headers_in, join_headers, text_in
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.words.bounds import MAX_COLUMNS, MAX_TEXT
from dh2urdf_plugins.readers.words.cells import SPACES
from dh2urdf_plugins.readers.words.comment_lines import Comment, is_comment, joined
from dh2urdf_plugins.readers.words.fields import convention_of

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator, Mapping, Sequence

    from dh2urdf.table_text import CellRow

say = Messages(__file__)

SURE = 2
"""Fields of geometry that make a row a header beyond doubt."""
MAX_TITLES = 1000
"""Rows that may be above the header."""


class Above(Protocol):
    """The rows of a table, read down to the header."""

    def __iter__(self) -> Iterator[CellRow]:
        """The rows one by one."""

    def complete(self, header: CellRow) -> CellRow:
        """The header with what the row below it adds: units, or names of columns that share a title."""


@dataclass(slots=True)
class Top:
    """Everything above the first row: the header, what comments declare by key, the others, and sentences of these."""

    columns: Columns
    statements: dict[str, Node]
    comments: list[Comment] = field(default_factory=list)
    sentences: list[Sentence] = field(default_factory=list)


def read_top(
    rows: Above,
    whole: Mark,
    statements: Mapping[str, Node] | None = None,
    *,
    convention: str | None = None,
    ignore: Collection[str] = (),
) -> Top:
    """Everything above the first row; the rows behind the header are not touched.

    The header is the first row that names two of a, alpha, d and theta. A row above it is a comment, with or without a
    # before it. Statements are those of the file outside its rows; the convention and the ignored columns are options.
    """
    said, comments, sure = dict(statements or {}), list[Comment](), set(statements or ())
    above: list[CellRow] = []  # those that are neither comments nor declarations
    last: CellRow | None = None
    for row in rows:
        if is_header(row):
            header = row
            break
        last = row if any(map(text_in, row.cells)) else None
        if last and _take(last, said, comments, sure):
            above.append(last)
            if len(above) > MAX_TITLES:
                raise TableError(_no_header(above, whole))
    else:  # the row that is most like a header, so that the message names what it lacks
        if not any(map(_fields, above)):
            raise TableError(_no_header(above, whole))
        header = max(above, key=lambda row: len(_fields(row)))
        place = above.index(header)
        last = above[place - 1] if place else None
        del above[place:]
    longest = max((len(text_in(cell)) for cell in header.cells), default=0)
    if len(header.cells) > MAX_COLUMNS:
        raise TableError(say("many-columns", header.mark, count=len(header.cells), limit=MAX_COLUMNS))
    if longest > MAX_TEXT:
        raise TableError(say("long-header", header.mark, count=longest, limit=MAX_TEXT))
    is_title = last and above and last is above[-1] and len(last.cells) <= MAX_COLUMNS
    if last and is_title and all(len(text_in(cell)) <= MAX_TEXT for cell in last.cells):
        header = join_headers(last, header)
    header = rows.complete(header)
    sentences = list(filter(None, map(said_in, comments)))
    declared = said["convention"].text if "convention" in said else convention
    named = [convention_of(declared)] if declared else [each.convention for each in sentences if each.convention]
    columns = name_columns(header, ignore, next(iter(named), None))
    return Top(columns, said, comments, sentences)


def _take(row: CellRow, said: dict[str, Node], comments: list[Comment], sure: set[str]) -> bool:
    """Takes a row above the header, which may declare something with or without a #; returns whether it is a title."""
    text = comment_text(row)
    declared = statement_in(Comment.of(text, row.mark, longest=len(text)))
    if declared is None:
        comments.append(Comment.of(text, row.mark))
        return not is_comment(text, top=True)
    key, node = declared
    if key != "name" or text.lstrip(f"{SPACES}#%/").casefold().startswith(key):
        said[key] = _both(key, said[key], node) if key in sure else node
        sure.add(key)
    else:  # `name` before `robot`, and the first of the others
        said.setdefault(key, node)
    return False


def is_header(row: CellRow) -> bool:
    """Whether a row is a header beyond doubt."""
    has_marker = bool(row.cells) and text_in(row.cells[0]).startswith("# ")  # `# a` names no column
    return len(row.cells) - has_marker >= SURE and len(_fields(row).intersection(PARAMETERS)) >= SURE


def _both(key: str, earlier: Node, node: Node) -> Node:
    """Two comments as one statement: units of lengths here and of angles there; both may not say the same."""
    one, other = earlier.value, node.value
    if key == "units" and isinstance(one, dict) and isinstance(other, dict):
        if all(one[name].text == other[name].text is not None for name in one.keys() & other):
            return replace(earlier, value={**one, **other}, key_places={**earlier.key_places, **node.key_places})
    elif key == "convention" and convention_of(earlier.text or "") == convention_of(node.text or ""):
        return earlier
    where = earlier.mark.in_file or earlier.file
    raise TableError(say("declared-twice", replace(node.mark, column=None), field=key, where=where))


def comment_text(row: CellRow) -> str:
    """The text of a comment that a format may have split into cells: ``# convention``, ``standard``."""
    first, *others = [text for cell in row.cells if (text := text_in(cell).strip(SPACES))]
    key = first.strip(f"{SPACES}#:=")
    is_mapping = others and others[0].startswith(("{", "[")) and key.replace(" ", "").isalpha()
    is_word = len(others) == 1 and declared_key(key) in ("name", "convention")
    if others and (is_mapping or is_word or key.casefold() in STATEMENTS):
        return f"{'# ' if is_comment(first) else ''}{key}: {', '.join(others)}"
    return joined([first, *map(" {}".format, others)])


def _fields(row: CellRow) -> set[str]:
    headers = [read_header(cell.strip(SPACES)) for cell in row.cells if isinstance(cell, str)]
    return {header.field.name for header in headers if header.field}


def _no_header(above: Sequence[CellRow], whole: Mark) -> Problem:
    """What is wrong with rows none of which is like a header."""
    if not above:
        return say("no-rows", whole)
    first, advice = above[0], TURN_ROUND if are_joints(headers_in(above[0])) else None
    return say("no-header", first.mark, field="columns", found=comment_text(first), suggestion=advice)
