"""What a table consists of, whatever its format: texts with their places, and the units of bare numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple, TypeAlias

from dh2urdf.quantities import Dimension, Unit
from dh2urdf.source import Mark

SPACES = " \t\u00a0\u2007\u2009\u202f"
"""White space around a cell."""


Value: TypeAlias = str | float
"""What a cell holds as it comes from its file: a text, or a number that was one already."""


def text_of(value: Value) -> str:
    """What a cell holds as a text, which reads back to the same double if it was a number."""
    return value if isinstance(value, str) else repr(value).removesuffix(".0")


class Cell(NamedTuple):
    """A text of a table and its place."""

    text: str
    mark: Mark


class RowMark(Mark):
    """A place in a file that has rows and no lines: its line is the number of a row, counted from 1."""

    __slots__ = ()

    def __str__(self) -> str:
        return self.file if self.line is None else f"{self.file}, row {self.line}"


@dataclass(frozen=True, slots=True, kw_only=True)
class Units:
    """What a table says of its units and its numbers.

    Attributes:
        length: the unit of lengths; None where nothing declares one, which means m.
        angle: the unit of angles; None where nothing declares one, which means rad.
        columns: the units that headers declare, by field.
        decimal_comma: whether a comma may stand for the decimal point.
    """

    length: Unit | None = None
    angle: Unit | None = None
    columns: Mapping[str, Unit] = field(default_factory=dict)
    decimal_comma: bool = False

    def of(self, dimension: Dimension) -> Unit | None:
        """The unit of numbers of a dimension that name none."""
        if dimension is Dimension.LENGTH:
            return self.length
        if dimension is Dimension.ANGLE:
            return self.angle
        if dimension is Dimension.SPEED and self.length:
            return Unit(f"{self.length.symbol}/s", dimension, self.length.power)
        if dimension is Dimension.TURN_RATE and self.angle:
            return Unit(f"{self.angle.symbol}/s", dimension, degrees=self.angle.degrees)
        return None
