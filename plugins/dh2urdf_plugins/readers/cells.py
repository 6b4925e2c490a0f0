"""What a table consists of, whatever its format: texts with their places, and the units of bare numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from dh2urdf.quantities import Dimension, Unit
from dh2urdf.source import Mark  # noqa: TC001 - the field of a NamedTuple is looked up when it is made

SPACES = " \t\u00a0\u2007\u2009\u202f"
"""White space around a cell."""


class Cell(NamedTuple):
    """A text of a table and its place."""

    text: str
    mark: Mark


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
