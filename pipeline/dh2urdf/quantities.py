"""Numbers as people write them in tables: ``pi/2``, ``90°``, ``-425 mm``, ``q2 + pi/2``.

`dh2urdf.expressions` has the grammar and `dh2urdf.units` the units; this is what they come to, in SI units. A unit
that is a power of ten is applied to the decimal text, so that 109.15 mm is the double 0.10915 and not its neighbour;
degrees are whole quarter turns first, so that 90° is the double π/2.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass

from dh2urdf.expressions import MAX_CHARACTERS, MAX_NESTING, SPACE, Value, Variable, parse
from dh2urdf.source import shown
from dh2urdf.units import Decimal, Dimension, QuantityError, Unit, accepted_forms, find_unit, is_unit

__all__ = [
    "MAX_CHARACTERS",
    "MAX_NESTING",
    "Dimension",
    "Quantity",
    "QuantityError",
    "Unit",
    "Variable",
    "accepted_forms",
    "evaluate",
    "find_unit",
    "is_unit",
]


@dataclass(frozen=True, slots=True)
class Quantity:
    """What an expression says.

    Attributes:
        value: the number, or what is added to the joint variable [SI].
        has_unit: whether it names its unit itself.
        variable: the joint variable in it.
        sign: 1 or -1, the factor of the joint variable.
    """

    value: float
    has_unit: bool = False
    variable: Variable | None = None
    sign: int = 1


_DECIMAL = re.compile(rf"{SPACE}*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eE]([+-]?[0-9]{{1,18}}))?{SPACE}*")


def evaluate(text: str, dimension: Dimension, unit: Unit | None = None, *, decimal_comma: bool = False) -> Quantity:
    """The quantity that a text says, in SI units.

    Args:
        text: a number or an expression.
        dimension: what it has to measure.
        unit: the unit of a number that names none; the SI unit where it is None.
        decimal_comma: whether a comma may stand for the decimal point.

    Raises:
        QuantityError: it is no such quantity, or not a finite one.
    """
    plain = _DECIMAL.fullmatch(text)
    if plain and len(text) <= MAX_CHARACTERS:
        decimal = Decimal(plain[1], int(plain[2] or 0))
        value = Value(float(text), decimal)
    else:
        value = parse(text, dimension, decimal_comma=decimal_comma)
    return _in_si(text, value, dimension, unit)


def _in_si(text: str, value: Value, dimension: Dimension, unit: Unit | None) -> Quantity:
    accepted = accepted_forms(dimension)
    number = value.number
    if value.dimension is None and unit is not None:
        if value.uses_pi and unit.degrees:
            message = f"{shown(text)} is a multiple of π, and the unit declared for numbers here is degrees"
            clean = text.strip()
            raise QuantityError(message, accepted, f"write the angle in degrees, or name its unit: '{clean} rad'")
        number = unit.si(number, value.decimal)
    elif value.dimension is not None and value.dimension is not dimension:
        raise QuantityError(f"{shown(text)} is {value.dimension}, and {dimension} is needed", accepted)
    if not math.isfinite(number):
        raise QuantityError(f"{shown(text)} is beyond the largest number that can be held", accepted)
    if value.variable and value.factor not in (1.0, -1.0):
        message = f"{shown(text)} takes {value.variable.text} times {value.factor:g}"
        raise QuantityError(message, f"{value.variable.text}, or its negative, and a number added to it")
    return Quantity(number + 0.0, value.dimension is not None, value.variable, -1 if value.factor < 0 else 1)
