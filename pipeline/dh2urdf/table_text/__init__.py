"""A table as its author types it: texts in cells, before anything reads them.

An editor holds such texts, and a format writes and reads them without losing a letter: `pi/2` stays `pi/2`. What the
texts mean is the readers' business; `dh2urdf.table_text.texts` makes them of the numbers of a `Manipulator`.

A manipulator knows its values and the place of each row. What its author typed is needed by people alone, so a reader
collects it where it is asked to (`Trace`), and reading a million rows costs nothing more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf import late_names
from dh2urdf.columns import COM, INERTIA, LIMITS, NUMBERS
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.table_text.written import Place as Place, TableText as TableText, WrittenTable as WrittenTable

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


if not TYPE_CHECKING:  # A conversion makes no such table.
    __all__, __getattr__, __dir__ = late_names(__name__, {"written": "Place TableText WrittenTable"})
    __all__ += ["ANGLE_UNITS", "FIELDS", "GEOMETRY", "LENGTH_UNITS", "MESHES", "METADATA", "NAMES", "PARAMETERS"]
    __all__ += ["REQUIRED", "STATEMENTS", "CellRow", "Said", "Trace"]
