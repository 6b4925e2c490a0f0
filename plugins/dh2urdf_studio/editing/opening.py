"""Opening a file: its manipulators as tables to edit, with the texts of their author where that is possible.

What a person pastes is such a table too, which the reader of tables reads, or it is cells for the table on the page.
"""

from __future__ import annotations

import os
import re
import tempfile
from contextlib import suppress
from dataclasses import fields, replace
from importlib.resources import as_file, files
from itertools import islice, takewhile
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.errors import Dh2UrdfError, InputError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.plugin_system.calls import Call, blaming, default_call, several_records
from dh2urdf.plugin_system.catalog import load
from dh2urdf.run_file.config import RUN_SUFFIXES, is_run_file
from dh2urdf.source import Mark, Messages, listed, shown
from dh2urdf.stages import ReadsCells, ReadsDescriptions, Rejected, WritesTables
from dh2urdf.table_text import FIELDS, TableText
from dh2urdf.table_text.texts import table_text
from dh2urdf_studio.editing.edits import MOST_ROWS, resized, with_cells
from dh2urdf_studio.editing.reading import read_whole
from dh2urdf_studio.page_data import PAGE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Reader

say = Messages(__file__)

MOST_NAMES = 5  # names that a notice has of manipulators that cannot be read
_GALLERY = files("dh2urdf_studio") / "arms"
USUAL_UNITS = ("m", "rad")
_NO_TABLE = (
    "this is no table\naccepted: cells of a spreadsheet or CSV, a table of Markdown or LaTeX, YAML, JSON, or rows of "
    "numbers in brackets; a robot description is opened as a file"
)
_NAME = re.compile(r"(?!pi\b)[^\W\d_][\w -]*", re.IGNORECASE)
_VALUE = re.compile(r"[-+−–]?(?:[\d.,]+(?:e[-+]?\d+)?|pi|π|(?:θ|theta|th|q|d)_?\d+)(?!\w)", re.IGNORECASE)
"""How a number or an expression begins."""
_WORD = re.compile(r"[^\W\d_]{2,}")
_UNNAMED = "field 'columns'"  # what the reader's message has in it where nothing names the columns


class Opened(NamedTuple):
    """A manipulator of a file, as a table to edit."""

    table: TableText
    lost: tuple[str, ...] = ()  # what else the file contains, which such a table has no place for: meshes, for one
    notices: tuple[str, ...] = ()  # what the reader noticed of the file alone: an ignored column, for one


def open_tables(
    path: Path,
    catalog: Catalog,
    most: int | None = None,
    *,
    wanted: str | None = None,
    options: Mapping[str, str] | None = None,
) -> tuple[Opened, ...]:
    """The manipulators of a file that can be read; what is wrong with the others is among the notices.

    Their texts are those of the file where the reader tells them and they read as the same arm; else the texts of the
    numbers that were read. Tables that do not say their convention are opened as they stand, for a person to say it.
    Options are units of the reader's.

    Raises:
        InputError: the file cannot be read, or none of its manipulators can, or not the one that is wanted.
    """
    if path.suffix.lower() in RUN_SUFFIXES and is_run_file(path):
        raise InputError(say("run-file-for-table", Mark(file=str(path))))
    reader = catalog.reader_for(path)
    call = default_call(catalog, reader)
    call = replace(call, options=replace(call.options, **options)) if options else call
    items = list(islice(_items(path, call), most))
    # The numbers of a row are the same in both conventions: where the file names none, a person chooses it on the page.
    unsaid = hasattr(call.options, "convention") and any(
        problem.field == "convention" for item in items if isinstance(item, Rejected) for problem in item.problems
    )
    if unsaid and not any(isinstance(item, Manipulator) for item in items):
        chosen = replace(call.options, convention=Convention.STANDARD.value)
        items = list(islice(_items(path, replace(call, options=chosen)), most))
    else:
        unsaid = False
    arms = [item for item in items if isinstance(item, Manipulator)]
    rejected = [item for item in items if isinstance(item, Rejected)]
    bad = [item for item in rejected if not arms or item.name == wanted]
    if bad or not arms:
        raise InputError(
            [problem for item in bad for problem in item.problems], [notice for item in bad for notice in item.notices]
        )
    typed: dict[str, TableText] = {}
    if (writes := call.stage.can(WritesTables)) is not None and writes.texts is not None:
        # A file whose texts its reader cannot give is opened with its numbers.
        with suppress(InputError), blaming(call, "texts"):
            typed = {table.name: table for table in several_records(islice(writes.texts(path), most), TableText)}
    opened = [_opened(arm, typed.get(arm.name), catalog, options or {}) for arm in arms]
    if unsaid:
        opened = [each._replace(table=replace(each.table, convention="")) for each in opened]
    if rejected:
        names = listed([shown(item.name)[1:-1] for item in rejected], MOST_NAMES)
        told = f"The file also has {names}, which cannot be read: {rejected[0].problems[0]}"
        opened = [each._replace(notices=(*each.notices, told)) for each in opened]
    return tuple(opened)


def _items(path: Path, call: Call[Reader[Any]]) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a file; of a description with several chains, of which none is the usual one, all of them."""
    try:
        yield from read_items(call, path)
    except InputError as error:
        has_chains = any(problem.field == "tip_link" for problem in error.problems)
        if call.stage.can(ReadsDescriptions) is None or not has_chains:
            raise
        yield from read_items(replace(call, options=replace(call.options, tip_link="*")), path)


def tables_of(
    name: str, content: bytes, catalog: Catalog, most: int | None = None, *, options: Mapping[str, str] | None = None
) -> tuple[Opened, ...] | str:
    """The tables of a file by its name and bytes, or what is wrong with it, without the folder that it was read in."""
    with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
        path = Path(folder) / Path(name).name
        path.write_bytes(content)
        try:
            opened = open_tables(path, catalog, most, options=options)
        except Dh2UrdfError as error:
            return str(error).replace(f"{folder}{os.sep}", "")
    said = ([notice.replace(f"{folder}{os.sep}", "") for notice in each.notices] for each in opened)
    return tuple(each._replace(notices=tuple(notices)) for each, notices in zip(opened, said, strict=True))


def gallery() -> dict[str, str]:
    """The arms that the studio comes with, those of the project's configs/: what each is, by its file."""
    entries = sorted(_GALLERY.iterdir(), key=lambda entry: entry.name)
    return {entry.name: entry.read_text("utf-8").partition("\n")[0].lstrip("# ") for entry in entries}


def gallery_table(file: str, catalog: Catalog) -> TableText:
    """A table of the gallery."""
    with as_file(_GALLERY / file) as path:
        return open_tables(path, catalog)[0].table


def _opened(arm: Manipulator, typed: TableText | None, catalog: Catalog, units: Mapping[str, str]) -> Opened:
    """A table as it was typed, names and types filled in, if that reads as the arm; else the texts of its numbers."""
    if typed is not None:
        pairs = zip(arm.rows, typed.rows, strict=False)
        filled = [{"joint": row.joint, "type": row.type.value, **texts} for row, texts in pairs]
        rows = tuple({field: row[field] for field in FIELDS if field in row} for row in filled)
        completed = replace(typed, convention=typed.convention or arm.convention.value, rows=rows, **units)
        again = read_whole(completed, catalog).manipulator
        if again == arm:
            return Opened(completed, notices=_unseen(arm, again))
    # The page does not show meshes: it could not move them along with the frames of a table.
    meshes: dict[str, Any] = dict.fromkeys(("base_visual", "base_collision", "visuals", "collisions"))
    bare = [replace(row, visual=None, collision=None) for row in arm.rows]
    table = table_text(
        replace(arm, rows=tuple(bare), **meshes), units.get("length_unit", "m"), units.get("angle_unit", "rad")
    )
    again = read_whole(table, catalog).manipulator
    lost = []
    if again is not None:  # what the arm says that is otherwise, or not there, when its table is read again
        both = ((row, other, f" of {row.joint}") for row, other in zip(arm.rows, again.rows, strict=True))
        every: tuple[tuple[Any, Any, str], ...] = ((replace(arm, rows=again.rows), again, ""), *both)
        for one, other, whose in every:
            names = [field.name for field in fields(one) if field.compare]
            lost += [name + whose for name in names if getattr(one, name) != getattr(other, name)]
    return Opened(table, tuple(lost), _unseen(arm, again))


def _unseen(arm: Manipulator, again: Manipulator | None) -> tuple[str, ...]:
    """What the reader noticed of an arm, and nobody would see on the page."""
    seen = {notice.message for notice in again.notices} if again else ()
    return tuple(str(notice) for notice in arm.notices if notice.message not in seen)


# --- Pasting ----------------------------------------------------------------------------------------------------------


class Put(NamedTuple):
    """A table with pasted cells in it, and how many cells found no place."""

    table: TableText
    left_out: int = 0


def cells_of(text: str) -> list[list[str]]:
    """The cells of a pasted text, line by line; decimal commas become points where they can be nothing else."""
    reads = load().cell_reader().can(ReadsCells)
    return reads.cells_of(text) if reads and reads.cells_of else [line.split("\t") for line in text.splitlines()]


def first_field(text: str) -> str:
    """The field of the first cell of a text that is pasted into an empty table: names of joints may come first."""
    return "joint" if _NAME.fullmatch(cells_of(text)[0][0]) else "a"


def orders(text: str) -> list[tuple[str, ...]]:
    """What the columns of cells may be that have no names: of DH parameters alone, or behind names and types."""
    rows = cells_of(text)
    if len({len(row) for row in rows}) > 1:
        return []
    columns = [*zip(*rows, strict=True)]
    names = [*takewhile(lambda cells: all(_NAME.fullmatch(each) and not _VALUE.match(each) for each in cells), columns)]
    usual = PAGE["orders"].get(str(len(columns) - len(names)), ()) if len(names) <= len(("joint", "type")) else ()
    return [(*("joint", "type")[: len(names)], *order.split()) for order in usual]


def whole_tables(
    text: str, catalog: Catalog, convention: str = "", units: tuple[str, str] = USUAL_UNITS
) -> tuple[Opened, ...] | str:
    """The tables of a pasted text with a header; convention and units hold where it names none.

    There are none where the text has no header, and so is cells; a message, where it has one and cannot be read.
    """
    text = text.strip("\r\n")
    if text.lstrip().startswith("<"):
        return _NO_TABLE
    if not re.search(r"[\r\n]|^\s*(?:- )?[\[{]|\\begin", text):
        return ()
    # A reader refuses units as options where the text names its own.
    pairs = zip(("length_unit", "angle_unit"), units, strict=True)
    said = {name: unit for name, unit in pairs if unit not in USUAL_UNITS}
    unread: tuple[Opened, ...] | str = ()
    for options in (said, *({name: unit} for name, unit in said.items()), {}) if said else ({},):
        found = tables_of("clipboard.txt", text.encode(), catalog, options=options)
        if not isinstance(found, str):
            found = tuple(opened._replace(table=_of(convention, opened.table)) for opened in found)
            if not any(read_whole(_of(Convention.STANDARD, opened.table), catalog).errors for opened in found):
                return found
        unread = found
    return () if isinstance(unread, str) and _UNNAMED in unread and not _words_around(text) else unread


def _words_around(text: str) -> bool:
    """Whether a text has sentences around its cells, which nobody would see again."""
    cells = {cell for row in cells_of(text) for cell in row if cell}
    others = (line for line in text.splitlines() if not any(cell in line for cell in cells) and "=" not in line)
    return "\\caption" in text or any(_WORD.search(line) and not line.startswith("import ") for line in others)


def _of(convention: str, table: TableText) -> TableText:
    """A table in a convention, unless it names one."""
    return replace(table, convention=table.convention or str(convention))


def pasted(table: TableText, row: int, field: str, text: str, columns: Sequence[str]) -> Put:
    """The table with the cells of a text put in, from one cell to the right and downwards; rows are added for them."""
    lines = cells_of(text)
    first = columns.index(field)
    table = resized(table, max(len(table.rows), min(row + len(lines), MOST_ROWS)))
    every = {(row + down, first + right): cell for down, line in enumerate(lines) for right, cell in enumerate(line)}
    fitting = {
        (down, columns[right]): cell
        for (down, right), cell in every.items()
        if down < len(table.rows) and right < len(columns)
    }
    return Put(with_cells(table, fitting), sum(map(bool, every.values())) - sum(map(bool, fitting.values())))
