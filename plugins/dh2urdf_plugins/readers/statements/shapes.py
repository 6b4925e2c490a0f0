"""What a table declares about shapes, density and the base's body, beside its Denavit-Hartenberg parameters."""

from __future__ import annotations

from types import MappingProxyType
from typing import TYPE_CHECKING

from dh2urdf.manipulator import LinkGeometry
from dh2urdf.quantities import Dimension, QuantityError, evaluate
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf_plugins.readers.header.units import refuse_doubt
from dh2urdf_plugins.readers.words.cells import Cell

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping

    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.words.cells import Units

SHAPES = ("cylinder", "box", "capsule", "arm")


class ShapeReader:
    """Reads shapes and positive numbers and hands over what is wrong with them."""

    def __init__(self, units: Units, add: Callable[[Problem], None]) -> None:
        """Takes the units of numbers, and what is called with every problem."""
        self.units = units
        self.add = add

    def geometry(self, node: Node, what: str) -> LinkGeometry:
        """The shape that a mapping says, such as ``{shape: cylinder, radius: 0.04}``."""
        if not isinstance(node.value, dict):
            self._error(node, what, f"{what} is {node.describe()}", "{shape: cylinder, radius: 0.04}")
            return LinkGeometry()
        refuse_unknown_keys(node, ("shape", "radius"), what, self.add)
        shape, radius = node.value.get("shape"), node.value.get("radius")
        if shape is not None and shape.text not in SHAPES:
            near = did_you_mean(shape.text or "", SHAPES)
            self._error(shape, f"{what}.shape", f"{what}.shape is {shape.describe()}", ", ".join(SHAPES), near)
        return LinkGeometry(
            shape=shape.text if shape else None,
            radius=self.positive(radius, f"{what}.radius", Dimension.LENGTH) if radius else None,
        )

    def positive(self, node: Node, what: str, dimension: Dimension, *, or_zero: bool = False) -> float | None:
        """A number above 0, or 0 where that means something."""
        accepted = "a number of 0 or more" if or_zero else "a number above 0"
        if node.text is None or node.value is None or isinstance(node.value, bool):
            self._error(node, what, f"{what} is {node.describe()}", accepted)
            return None
        try:
            quantity = evaluate(node.text, dimension, self.units.sure(dimension), angle=self.units.in_functions)
            refuse_doubt(quantity, what, Cell(node.text, node.mark), dimension, self.units)
        except QuantityError as error:
            self._error(node, what, error.message, error.accepted, error.suggestion)
            return None
        if quantity.variable or quantity.value < 0 or (quantity.value == 0 and not or_zero):
            self._error(
                node, what, f"{what}, {shown(node.text)}, is {'negative' if or_zero else 'not positive'}", accepted
            )
        return quantity.value

    def _error(self, node: Node, field: str, message: str, accepted: str, suggestion: str | None = None) -> None:
        self.add(
            Problem(
                message=message,
                mark=node.mark,
                field=field,
                found=node.text,
                accepted=accepted,
                suggestion=suggestion,
            )
        )


def refuse_unknown_keys(
    node: Node,
    keys: Iterable[str],
    what: str,
    add: Callable[[Problem], None],
    meant: Mapping[str, str] = MappingProxyType({}),
) -> None:
    """Notes the keys of a mapping that nothing reads.

    Args:
        node: the mapping.
        keys: those that are read.
        what: what the mapping is.
        add: takes the problems.
        meant: what to write in place of other words for them.
    """
    keys = tuple(keys)
    for key in node.value if isinstance(node.value, dict) else ():
        if key not in keys:
            add(
                Problem(
                    message=f"{shown(key)} is no key of {what}",
                    mark=node.key_mark(key),
                    field=key,
                    found=key,
                    accepted=", ".join(keys),
                    suggestion=meant.get(key.casefold()) or did_you_mean(key, keys),
                )
            )
