"""The functions that an expression may call, and what they measure: ``sqrt``, ``cos``, ``atan2``, ``radians``."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.late_tuples import NamedTuple
from dh2urdf.quantities.units import Dimension
from dh2urdf.rotations import HALF_PI, cos_sin

if TYPE_CHECKING:
    from collections.abc import Callable


def _sine(angle: float) -> float:
    return float(cos_sin(angle)[1])


def _cosine(angle: float) -> float:
    return float(cos_sin(angle)[0])


def _tangent(angle: float) -> float:
    cosine, sine = cos_sin(angle)
    return float(sine / cosine)


def from_degrees(number: float) -> float:
    """An angle in rad, of a number of degrees."""
    return number / 90 * HALF_PI


class Function(NamedTuple):
    """A function of numbers.

    Attributes:
        call: what computes it.
        takes: what its argument may measure besides nothing.
        gives: what its value measures; None for a bare number.
        arguments: how many it has.
    """

    call: Callable[..., float]
    takes: Dimension | None = None
    gives: Dimension | None = None
    arguments: int = 1


FUNCTIONS = {
    "sqrt": Function(math.sqrt),
    "abs": Function(abs),
    "sin": Function(_sine, takes=Dimension.ANGLE),
    "cos": Function(_cosine, takes=Dimension.ANGLE),
    "tan": Function(_tangent, takes=Dimension.ANGLE),
    "asin": Function(math.asin, gives=Dimension.ANGLE),
    "acos": Function(math.acos, gives=Dimension.ANGLE),
    "atan": Function(math.atan, gives=Dimension.ANGLE),
    "atan2": Function(math.atan2, gives=Dimension.ANGLE, arguments=2),
    "radians": Function(from_degrees, gives=Dimension.ANGLE),
}
"""The functions by their names."""
OTHER_NAMES = {"arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "deg2rad": "radians"}
"""Names that people write for them."""
