"""Where the values of a manipulator come from: what a reader saw, in which cell, in which unit.

A manipulator knows its values and the place of each row. What its author typed is needed by people alone, so a reader
collects it where it is asked to (`dh2urdf.stages.Reader.trace`), and reading a million rows costs nothing more.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Mapping


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
