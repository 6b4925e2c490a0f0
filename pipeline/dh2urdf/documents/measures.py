"""Values of run files and options that measure something: a number in SI units, or an expression with units."""

from __future__ import annotations

from math import tau
from typing import TYPE_CHECKING

from dh2urdf.quantities.quantity import Dimension, QuantityError, accepted_forms, evaluate
from dh2urdf.source import shown

if TYPE_CHECKING:
    from dh2urdf.documents.nodes import Node

LARGEST_ANGLE = 1000 * tau
"""Angles beyond a thousand turns have lost too many digits [rad]."""


def measured(node: Node, dimension: Dimension) -> float:
    """What a value measures [SI].

    Raises:
        QuantityError: it measures nothing of the kind, or it is an angle that is probably meant in degrees.
    """
    if node.text is None or node.value is None or isinstance(node.value, bool):
        raise QuantityError(f"{node.describe()} stands where a number is needed", "a number")
    quantity = evaluate(node.text, dimension)
    if quantity.variable:
        raise QuantityError(
            f"{shown(node.text)} names a joint variable, and nothing moves here", accepted_forms(dimension)
        )
    size = abs(quantity.value)
    if dimension is Dimension.ANGLE and size > tau and not quantity.has_unit:
        raise QuantityError(
            f"{shown(node.text)} is more than a full turn in rad",
            "at most 2π rad where no unit is named",
            f"if these are degrees, say so: '{node.text.strip()} deg'",
        )
    if dimension is Dimension.ANGLE and size > LARGEST_ANGLE:
        raise QuantityError(f"{shown(node.text)} is more than a thousand turns", "at most a thousand turns")
    return quantity.value
