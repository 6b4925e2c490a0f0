"""A table as an editor holds it, and as a file has it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.table_text import FIELDS, REQUIRED

if TYPE_CHECKING:
    from dh2urdf.source import Mark


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
