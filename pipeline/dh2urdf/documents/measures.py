"""Values of run files and options that measure something: a number in SI units, or an expression with units."""

from __future__ import annotations

from math import inf, tau
from typing import TYPE_CHECKING

from dh2urdf.documents.nodes import LARGEST_BARE
from dh2urdf.quantities import Dimension, QuantityError, accepted_forms, evaluate
from dh2urdf.source import shown

if TYPE_CHECKING:
    from dh2urdf.documents.nodes import Node

MOST_TURNS = 10
"""What a limit of a joint may be at most without a unit where it may be an angle: beyond, degrees may be meant."""
LARGEST_ANGLE = 1000 * tau
"""Angles beyond a thousand turns have lost too many digits [rad]."""

_MILLIMETRES = "mm, say so: '{0} mm'; '{0} m' is read as such"


def measured(node: Node, dimension: Dimension, turns: int = 1) -> float:
    """What a value measures [SI]; an angle that names no unit may have so many turns.

    Raises:
        QuantityError: it measures nothing of the kind, or it is probably meant in degrees or mm.
    """
    if node.text is None or node.value is None or isinstance(node.value, bool):
        raise QuantityError(f"{node.describe()} stands where a number is needed", "a number")
    quantity = evaluate(node.text, dimension)
    if quantity.variable:
        message = f"{shown(node.text)} names a joint variable, and nothing moves here"
        raise QuantityError(message, accepted_forms(dimension))
    size = abs(quantity.value)
    largest = LARGEST_BARE.get(dimension.plain, inf) * (turns if dimension is Dimension.ANGLE else 1)
    if size > largest and not quantity.has_unit:
        if dimension is Dimension.ANGLE:
            found, most, unit = f"{turns} turns in rad", f"{largest:.4g} rad", "degrees, say so: '{} deg'"
            if turns == 1:
                found, most = "a full turn in rad", "2π rad"
        else:
            found = most = f"{LARGEST_BARE['length']:g} m"
            unit = _MILLIMETRES
        message, accepted = f"{shown(node.text)} is more than {found}", f"at most {most} where no unit is named"
        raise QuantityError(message, accepted, f"if these are {unit.format(node.text.strip())}")
    if dimension is Dimension.ANGLE and size > LARGEST_ANGLE:
        raise QuantityError(f"{shown(node.text)} is more than a thousand turns", "at most a thousand turns")
    return quantity.value
