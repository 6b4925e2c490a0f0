"""What a table consists of, whatever its format: texts with their places, and the units of bare numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from dh2urdf.quantities import Dimension, Symbols, Unit

if TYPE_CHECKING:
    from dh2urdf.source import Mark

LINE_END = "\n"
"""What a cell in quotes may hold, and no plain one does."""
SPACES = " \t\u00a0\u2007\u2009\u202f"
"""White space around a cell."""


Value: TypeAlias = str | float
"""What a cell holds as it comes from its file: a text, or a number that was one already."""


def text_of(value: Value) -> str:
    """What a cell holds as a text, which reads back to the same double if it was a number."""
    return value if isinstance(value, str) else repr(value).removesuffix(".0")


class Cell(NamedTuple):
    """A text of a table and its place.

    Attributes:
        text: the text.
        mark: its place.
        of_theta: whether its header says that it bounds theta, which is not q where the row has an offset.
        as_written: whether it is a name with no typesetting around it, and keeps its white space.
    """

    text: str
    mark: Mark
    of_theta: bool = False
    as_written: bool = False


class Doubt(NamedTuple):
    """Why the unit of bare numbers is not sure.

    Attributes:
        reason: more about the fault, as half a sentence.
        unit: a unit that they may have.
        dimension: what that unit measures, where a field has numbers of two kinds.
    """

    reason: str
    unit: str
    dimension: Dimension | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Units:
    """What a table declares about its units and its numbers.

    Attributes:
        known: the units of bare numbers, by what they measure; the SI unit where there is none.
        columns: the units that headers declare, by field.
        doubts: why bare numbers other than 0 have no sure unit, by what they measure or by field.
        decimal_comma: whether a comma may stand for the decimal point.
        symbols: what names of lengths and angles stand for.
        repair_pi: whether an angle that is nearly a multiple of π/2 is one.
        bare: outside of rows, the first number of each kind that is read in the SI unit since nothing says its unit,
            and its field.
    """

    known: Mapping[Dimension, Unit] = field(default_factory=dict)
    columns: Mapping[str, Unit] = field(default_factory=dict)
    doubts: Mapping[str, Doubt] = field(default_factory=dict)
    decimal_comma: bool = False
    symbols: Symbols = field(default_factory=Symbols, compare=False)
    repair_pi: bool = False
    bare: dict[Dimension, tuple[str, Cell]] = field(default_factory=dict, compare=False)

    @property
    def angle(self) -> Unit | None:
        """The unit of angles; None where nothing declares one, which means rad."""
        return self.known.get(Dimension.ANGLE)

    def of(self, dimension: Dimension) -> Unit | None:
        """The unit of numbers of a dimension that name none."""
        unit = self.known.get(dimension)
        base = {Dimension.SPEED: Dimension.LENGTH, Dimension.TURN_RATE: Dimension.ANGLE}.get(dimension)
        if unit is None and base and (measured := self.known.get(base)):
            return rate_of(measured)
        return unit

    def sure(self, dimension: Dimension, name: str | None = None) -> Unit | None:
        """The unit of numbers of a dimension that name none; None where that is the SI unit, or in doubt."""
        return None if self.doubt(dimension, name) else self.of(dimension)

    def unit_of(self, name: str, dimension: Dimension) -> Unit | None:
        """The unit of the bare numbers of a field: that of its header, or the sure one of what it measures."""
        return self.columns.get(name) or self.sure(dimension, name)

    def doubt(self, dimension: Dimension, name: str | None = None) -> Doubt | None:
        """Why the unit of a bare number is not sure; None where it is.

        Args:
            dimension: what it measures.
            name: its field, where it has one.
        """
        if not self.doubts or name in self.columns:
            return None
        doubt = self.doubts.get(name or "")
        if doubt and doubt.dimension not in (None, dimension) and dimension in self.known:
            doubt = None  # it is about the field's other kind of numbers, and the unit of this kind is declared
        return doubt or self.doubts.get(dimension)

    @property
    def in_functions(self) -> Unit | None:
        """The unit of a bare number in ``sin``, ``cos`` or ``tan``: degrees, where any angle of the table has them."""
        angles = [unit for unit in (self.angle, *self.columns.values()) if unit and unit.dimension is Dimension.ANGLE]
        return next((unit for unit in angles if unit.parts), angles[0] if angles else None)


def rate_of(unit: Unit) -> Unit:
    """A unit of length or angle per second."""
    rate = Dimension.SPEED if unit.dimension is Dimension.LENGTH else Dimension.TURN_RATE
    return replace(unit, symbol=f"{unit.symbol}/s", dimension=rate)
