"""Numbers as people write them in tables: ``pi/2``, ``90°``, ``-425 mm``, ``q2 + pi/2``.

`dh2urdf.quantities.grammar` has the grammar and `dh2urdf.quantities.units` the units; this is what they come to, in SI
units. A unit that is a power of ten is applied to the decimal text, so that 109.15 mm is the double 0.10915 and not its
neighbour. Any other factor is an exact fraction. Degrees are whole quarter turns first, so that 90° is the double π/2.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.quantities.grammar import MAX_CHARACTERS, SPACE, Intermediate, Parser, Variable
from dh2urdf.quantities.units import Decimal, Dimension, QuantityError, Unit, accepted_forms
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Mapping

say = Messages(__file__)


@dataclass(frozen=True, slots=True)
class Quantity:
    """What an expression says.

    Attributes:
        value: the number, or what is added to the joint variable [SI].
        has_unit: whether it names its unit itself.
        variable: the joint variable in it.
        sign: 1 or -1, the factor of the joint variable.
        uses_pi: whether it is a multiple of π, which is radians where it names no unit.
        foreign: whether it names a unit other than the SI unit.
    """

    value: float
    has_unit: bool = False
    variable: Variable | None = None
    sign: int = 1
    uses_pi: bool = False
    foreign: bool = False

    def is_radians(self, dimension: Dimension) -> bool:
        """Whether an angle, or a turn rate, can only be in radians: it is a multiple of π."""
        return self.uses_pi and dimension in (Dimension.ANGLE, Dimension.TURN_RATE)


_AS_COMPUTED = 1e-9
_DECIMAL = rf"{SPACE}*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eE]([+-]?[0-9]{{1,18}}))?{SPACE}*"


def evaluate(
    text: str,
    dimension: Dimension,
    unit: Unit | None = None,
    *,
    decimal_comma: bool = False,
    angle: Unit | None = None,
    symbols: Mapping[str, Intermediate] | None = None,
) -> Quantity:
    """The quantity that a text says, in SI units.

    Args:
        text: a number or an expression.
        dimension: what it has to measure.
        unit: the unit of a number that names none; the SI unit where it is None.
        decimal_comma: whether a comma may stand for the decimal point.
        angle: the unit that is declared for angles, which a bare number in sin, cos or tan would follow; None where
            nothing declares one. By default, the unit of a number, where that is one of angles.
        symbols: what names of lengths and angles stand for, by `symbol_key`.

    Raises:
        QuantityError: it is no such quantity, not a finite one, or one that can be read in two ways.
    """
    number = text.replace(",", ".") if decimal_comma and "." not in text else text
    plain = re.fullmatch(_DECIMAL, number)
    if plain and len(text) <= MAX_CHARACTERS:
        decimal = Decimal(plain[1], int(plain[2] or 0))
        value = Intermediate(float(number), decimal)
    else:
        if angle is None and unit is not None and unit.dimension is Dimension.ANGLE:
            angle = unit
        value = Parser(text, dimension, decimal_comma=decimal_comma, angle=angle, symbols=symbols).parse()
    return _in_si(text, value, dimension, unit)


def is_zero(text: str) -> bool:
    """Whether a cell is empty or 0, with a decimal point or comma."""
    try:
        return not text or evaluate(text.replace(",", "."), Dimension.NUMBER) == Quantity(0.0)
    except QuantityError:
        return False


def _in_si(text: str, value: Intermediate, dimension: Dimension, unit: Unit | None) -> Quantity:
    number, fault = value.number, None
    is_part_of_pi = value.uses_pi and number != 0 and abs(math.remainder(number, math.pi / 12)) < _AS_COMPUTED
    if value.dimension is not None:
        if not dimension.holds(value.dimension):
            fault = say("other-dimension", found=text, measures=value.dimension, needed=dimension)
    elif dimension is Dimension.LENGTH and is_part_of_pi:
        fault = say("part-of-pi", found=text)
    elif unit is not None and unit.parts and value.uses_pi:
        si, declared = "rad" if dimension is Dimension.ANGLE else "rad/s", "degrees" if unit.degrees else unit.symbol
        fault = say("pi-in-a-column-of-degrees", found=text, text=text.strip(), declared=declared, unit=si)
    elif unit is not None:
        number = unit.si(number, value.decimal)
    if number == 0 and (value.number or (value.decimal and not value.decimal.is_zero)):
        fault = fault or say("too-small", found=text)
    elif not math.isfinite(number):
        fault = fault or say("too-large-a-number", found=text)
    elif value.variable and value.factor not in (1.0, -1.0):
        fault = fault or say("factor", found=text, variable=value.variable.text, factor=f"{value.factor:g}")
    if fault:
        raise QuantityError(fault.message, fault.accepted or accepted_forms(dimension), fault.suggestion)
    sign = -1 if value.factor < 0 else 1
    return Quantity(number + 0.0, value.dimension is not None, value.variable, sign, value.uses_pi, value.foreign)
