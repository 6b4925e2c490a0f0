"""A table as its author types it: texts in cells, before anything reads them.

An editor holds such texts, and a format writes and reads them without losing a letter: `pi/2` stays `pi/2`. What the
texts mean is the readers' business; `dh2urdf.table_text.texts` makes them of the numbers of a `Manipulator`.

A manipulator knows its values and the place of each row. What its author typed is needed by people alone, so a reader
collects it where it is asked to (`Trace`), and reading a million rows costs nothing more.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from dh2urdf.columns import COM, INERTIA, LIMITS, NUMBERS
from dh2urdf.source import Mark, Problem

NAMES = ("joint", "link", "type")
PARAMETERS = ("a", "alpha", "d", "theta")
GEOMETRY = (*PARAMETERS, "offset")
REQUIRED = ("a", "alpha", "d")
FIELDS = (
    *(*NAMES, *GEOMETRY, "sign", *LIMITS, "mass", *COM, *INERTIA),
    *(name for name in NUMBERS if name not in {*GEOMETRY, "mass"}),
    "follows",
)
"""The fields of a row, in the order of their columns."""
STATEMENTS = ("name", "convention", "units", "base", "tool", "payload", "defaults", "symbols")
"""What a table may declare of itself."""
METADATA = "dh2urdf."
"""What the keys of these begin with among the metadata of a data frame or a Parquet file."""
LENGTH_UNITS = ("m", "cm", "mm")
"""The units that lengths of a table on the screen may be in."""
ANGLE_UNITS = ("rad", "deg")
"""Those of angles."""
MESHES = ("visual", "collision")
"""What a row may say besides, as YAML."""


@dataclass(frozen=True, slots=True, kw_only=True)
class TableText:
    """A table of one manipulator, as texts; an empty text says nothing.

    Attributes:
        name: the manipulator's name.
        convention: the word for the convention.
        length_unit: the unit of lengths without one.
        angle_unit: the unit of angles without one.
        base: the base transform, as YAML.
        tool: the tool transform, as YAML.
        payload: what the arm carries, as YAML.
        defaults: geometry and density of all links, as YAML.
        visuals: ``all`` or ``none``: whether links are seen.
        collisions: ``all`` or ``none``: whether links touch.
        rows: a mapping for each joint, from the base outwards: names of `FIELDS`, and texts that are not empty; besides
            them ``visual`` and ``collision``, the meshes of the link as YAML, which formats of cells have no place for.
    """

    name: str = ""
    convention: str = ""
    length_unit: str = "m"
    angle_unit: str = "rad"
    base: str = ""
    tool: str = ""
    payload: str = ""
    defaults: str = ""
    visuals: str = ""
    collisions: str = ""
    rows: tuple[Mapping[str, str], ...] = ()

    def columns(self) -> tuple[str, ...]:
        """The fields that a row says anything in, and those that every table has."""
        used = {field for row in self.rows for field in row}
        return tuple(field for field in FIELDS if field in used or field in REQUIRED)


class CellRow(NamedTuple):
    """A row of a table as its container has it, before anything of it is understood.

    Attributes:
        cells: what each cell holds: a text, a number, a truth value, or None where it is empty; a `Problem` where the
            container has something that is none of them, such as a date. It is an error if a field is read from there.
        mark: the row's place.
        marks: the place of each cell; the row's place holds for all of them where there are none.
    """

    cells: Sequence[str | float | Problem | None]
    mark: Mark
    marks: Sequence[Mark] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Place:
    """Where a written table has one of its texts.

    Attributes:
        line: counted from 1.
        column: where the text begins, counted from 1, in characters.
        row: number of the row, counted from 0; None where it is a text of the whole table.
        field: the field, or the attribute of `TableText`.
    """

    line: int
    column: int
    row: int | None
    field: str


@dataclass(frozen=True, slots=True, kw_only=True)
class WrittenTable:
    """A table in a file format.

    Attributes:
        content: the file.
        places: where its texts are, in the order of the file; empty where the format does not tell.
    """

    content: bytes
    places: tuple[Place, ...] = ()

    def at(self, mark: Mark | None) -> tuple[int | None, str | None]:
        """The row and the field that a mark in the file means; a mark of a whole line means no field."""
        if mark is None or mark.line is None:
            return None, None
        starts = [(place.line, place.column) for place in self.places]
        index = bisect_right(starts, (mark.line, mark.column or 1)) - 1
        if index < 0 or self.places[index].line != mark.line:
            return None, None
        place = self.places[index]
        return place.row, place.field if mark.column is not None or place.row is None else None


@dataclass(frozen=True, slots=True, kw_only=True)
class Said:
    """A value as it was typed.

    Attributes:
        text: what the cell holds; None where the value is no text of its own, such as a matrix.
        mark: its place.
        unit: the unit of a number that names none: of its header, or of the whole table; empty where that is the SI
            unit because nothing says another; None where the text names its unit itself, or is no number.
    """

    text: str | None
    mark: Mark | None
    unit: str | None = None


class Trace:
    """What a reader saw of one manipulator; the reader fills it before it yields the manipulator.

    Attributes:
        rows: of each row, what was typed, by field: ``joint``, ``alpha``, ``lower``, ``com_x``, ``ixx``.
        table: what holds for all rows, by key: ``convention``, ``base``, ``tool``, ``payload``, ``units.length``.
    """

    def __init__(self) -> None:
        """Begins empty."""
        self.rows: tuple[Mapping[str, Said], ...] = ()
        self.table: Mapping[str, Said] = {}

    def copy(self) -> Trace:
        """The same for the manipulator of now, which the next one does not change."""
        copy = Trace()
        copy.rows, copy.table = self.rows, self.table
        return copy
