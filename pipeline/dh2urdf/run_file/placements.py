"""Reads where something stands from a run file: xyz and rpy, with or without units."""

from __future__ import annotations

from math import tau
from typing import TYPE_CHECKING

from dh2urdf.quantities.quantity import Dimension, QuantityError, evaluate
from dh2urdf.rotations import ZERO, Vec3
from dh2urdf.run_file.sections import SectionReader
from dh2urdf.source import shown

if TYPE_CHECKING:
    from dh2urdf.documents.document import Node

LARGEST_ANGLE = 1000 * tau
"""Angles beyond a thousand turns have lost too many digits [rad]."""


class PlacementReader(SectionReader):
    """Reads vectors of lengths and of angles, and gathers what is wrong with them."""

    def vector(self, node: Node | None, field: str, dimension: Dimension) -> Vec3:
        """A list of three lengths [m] or angles [rad]; zeros where it is none, or is not given."""
        if node is None:
            return ZERO
        if not isinstance(node.value, list) or len(node.value) != 3:  # noqa: PLR2004 - the space has three dimensions
            self.say(f"this cannot be {node.describe()}", node, field, accepted="a list of three numbers")
            return ZERO
        x, y, z = (self.number(item, field, dimension) for item in node.value)
        return (x, y, z)

    def number(self, node: Node, field: str, dimension: Dimension) -> float:
        """A length [m] or an angle [rad]; 0 where it is none."""
        if node.text is None or node.value is None or isinstance(node.value, bool):
            self.say(f"{node.describe()} stands where a number is needed", node, field, accepted="a number")
            return 0.0
        try:
            quantity = evaluate(node.text, dimension)
        except QuantityError as error:
            self.say(error.message, node, field, accepted=error.accepted, suggestion=error.suggestion)
            return 0.0
        size = abs(quantity.value)
        if quantity.variable:
            self.say(f"{shown(node.text)} names a joint variable, and nothing moves here", node, field)
        elif dimension is Dimension.ANGLE and size > tau and not quantity.has_unit:
            self.say(
                f"{shown(node.text)} is more than a full turn in rad",
                node,
                field,
                accepted="at most 2π rad where no unit is named",
                suggestion=f"if these are degrees, say so: '{node.text.strip()} deg'",
            )
        elif dimension is Dimension.ANGLE and size > LARGEST_ANGLE:
            self.say(f"{shown(node.text)} is more than a thousand turns", node, field)
        return quantity.value
