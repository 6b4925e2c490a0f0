"""The rigid transforms of a table: its base, its tool and its meshes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.quantities import Dimension, QuantityError, Unit, evaluate
from dh2urdf.rotations import RigidTransform, Rotation, Vec3, nearest_rotation
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.header.units import refuse_doubt
from dh2urdf_plugins.readers.rows.cells import ACCEPTED_ANGLE, FULL_TURN, LARGEST_ANGLE
from dh2urdf_plugins.readers.statements.shapes import refuse_unknown_keys
from dh2urdf_plugins.readers.words.bounds import MEASURABLE_ARM
from dh2urdf_plugins.readers.words.cells import Cell

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.words.cells import Units

ORTHONORMAL = 1e-9
"""Largest |RᵀR − 1| of a rotation that is taken without a word."""
NEARLY_ORTHONORMAL = 1e-4
"""Largest |RᵀR − 1| of one that is corrected, with a notice: four digits, as in 0.7071."""

_SIZE = 4
_ROUNDED = 0.1

MORE_DIGITS = "write its elements with more digits, or as expressions such as sqrt(2)/2"
ACCEPTED = "{xyz: [0, 0, 0.3], rpy: [0, 0, pi]}, or a rigid 4x4 matrix as a list of four rows"
PLACED = ("xyz", "rpy", "matrix")
"""Keys of a mapping that say where something stands: the matrix in place of the other two."""

_XYZ, _RPY = "write `xyz: [x, y, z]`", "write `rpy: [roll, pitch, yaw]`, or the whole as `matrix`"
_MEANT = dict.fromkeys(("x", "y", "z", "translation", "position", "offset", "origin", "trans", "pos"), _XYZ)
_MEANT |= dict.fromkeys(("rotation", "orientation", "quaternion", "quat", "euler", "roll", "pitch", "yaw", "rot"), _RPY)


class TransformReader:
    """Reads rigid transforms and hands over what is wrong with them."""

    def __init__(self, units: Units, add: Callable[[Problem], None]) -> None:
        """Takes the units of numbers, and what is called with every problem."""
        self.units = units
        self.add = add

    def read(self, node: Node, what: str, *, other_keys: Sequence[str] = ()) -> RigidTransform | None:
        """The transform that a mapping of xyz and rpy or a matrix says, or None where it says none.

        Args:
            node: the value.
            what: what it is the transform of: ``base``, ``tool`` or a mesh.
            other_keys: further keys of the mapping, which somebody else reads.
        """
        if isinstance(node.value, dict):
            transform = self._origin(node, what, other_keys)
        elif isinstance(node.value, list):
            transform = self._matrix(node, what)
        else:
            self._error(node.mark, what, f"{what} is {node.describe()}", found=node.text, accepted=ACCEPTED)
            return None
        return None if transform is None or self._is_beyond(transform, node, what) else transform

    def _is_beyond(self, transform: RigidTransform, node: Node, what: str) -> bool:
        """Whether a transform leads too far to be computed with."""
        distance = math.hypot(*transform.translation)
        if distance > MEASURABLE_ARM:
            self._error(
                node.mark,
                what,
                f"{what} is {distance:.4g} m away: positions cannot be computed to a micrometre there",
                accepted=f"a translation of at most {MEASURABLE_ARM:g} m",
            )
            return True
        return False

    def _error(
        self,
        mark: Mark,
        field: str,
        message: str,
        *,
        accepted: str,
        found: str | None = None,
        suggestion: str | None = None,
    ) -> None:
        self.add(
            Problem(message=message, mark=mark, field=field, found=found, accepted=accepted, suggestion=suggestion)
        )

    def _origin(self, node: Node, what: str, other_keys: Sequence[str]) -> RigidTransform | None:
        entries = node.value if isinstance(node.value, dict) else {}
        refuse_unknown_keys(node, (*PLACED, *other_keys), what, self.add, _MEANT)
        if (matrix := entries.get("matrix")) is not None:
            if both := [key for key in ("xyz", "rpy") if key in entries]:
                message = f"{what} has a matrix and {both[0]}"
                self._error(node.key_mark(both[0]), what, message, accepted="xyz and rpy, or the matrix of both")
                return None
            return self._matrix(matrix, what)
        xyz = self.vector(entries.get("xyz"), f"{what}.xyz", Dimension.LENGTH)
        rpy = self.vector(entries.get("rpy"), f"{what}.rpy", Dimension.ANGLE)
        return None if xyz is None or rpy is None else RigidTransform.from_xyz_rpy(xyz, rpy)

    def vector(self, node: Node | None, field: str, dimension: Dimension) -> Vec3 | None:
        """A list of three numbers; zeros where there is none, None where it is something else."""
        if node is None:
            return (0.0, 0.0, 0.0)
        if not isinstance(node.value, list) or len(node.value) != 3:  # noqa: PLR2004 - the space has three dimensions
            count = f"a list of {len(node.value)}" if isinstance(node.value, list) else node.describe()
            self._error(node.mark, field, f"{field} is {count}", found=node.text, accepted="a list of three numbers")
            return None
        numbers = [self.number(item, field, dimension) for item in node.value]
        x, y, z = numbers
        return None if x is None or y is None or z is None else (x, y, z)

    def number(self, node: Node, field: str, dimension: Dimension) -> float | None:
        """A number in the table's unit; None where it is none."""
        return self._number(node, field, dimension, self.units.sure(dimension))

    def _number(self, node: Node, field: str, dimension: Dimension, unit: Unit | None) -> float | None:
        if node.text is None or node.value is None or isinstance(node.value, bool):
            message = f"{node.describe()} stands where a number is needed"
            self._error(node.mark, field, message, found=node.text, accepted="a number")
            return None
        try:
            quantity = evaluate(node.text, dimension, unit, angle=self.units.in_functions)
            refuse_doubt(quantity, field, Cell(node.text, node.mark), dimension, self.units)
        except QuantityError as error:
            self._error(
                node.mark, field, error.message, found=node.text, accepted=error.accepted, suggestion=error.suggestion
            )
            return None
        if quantity.variable:
            message = f"{shown(node.text)} names a joint variable, and nothing moves here"
            self._error(node.mark, field, message, found=node.text, accepted="a number")
            return None
        if (
            dimension is Dimension.ANGLE
            and abs(quantity.value) > FULL_TURN
            and not (quantity.has_unit or self.units.angle)
        ):
            self._error(
                node.mark,
                field,
                f"{shown(node.text)} is more than a full turn in rad, and no unit is declared for it",
                found=node.text,
                accepted="at most 2π rad where no unit is declared",
                suggestion=f"if these are degrees, say so: '{node.text.strip()} deg'",
            )
            return None
        if dimension is Dimension.ANGLE and abs(quantity.value) > LARGEST_ANGLE:
            message = f"{shown(node.text)} is more than a thousand turns"
            self._error(node.mark, field, message, found=node.text, accepted=ACCEPTED_ANGLE)
            return None
        return quantity.value

    def _matrix(self, node: Node, what: str) -> RigidTransform | None:
        rows = [row.value for row in node.value] if isinstance(node.value, list) else []
        elements = [item for row in rows if isinstance(row, list) for item in row]
        if len(rows) != _SIZE or any(not isinstance(row, list) or len(row) != _SIZE for row in rows):
            self._error(node.mark, what, f"{what} is a list, and not one of four rows of four", accepted=ACCEPTED)
            return None
        length = self.units.sure(Dimension.LENGTH)
        numbers: list[float] = []
        for index, item in enumerate(elements):
            translation = index in (3, 7, 11)
            dimension = Dimension.LENGTH if translation else Dimension.NUMBER
            number = self._number(item, what, dimension, length if translation else None)
            if number is None:
                return None
            numbers.append(number)
        if any(abs(number - wanted) > ORTHONORMAL for number, wanted in zip(numbers[12:], (0, 0, 0, 1), strict=True)):
            last = ", ".join(item.text or "" for item in elements[12:])
            self._error(
                elements[12].mark,
                what,
                f"the last row of {what} is {last}, so that it is not rigid",
                found=last,
                accepted="0, 0, 0, 1 as the last row; the translation is in the last column",
            )
            return None
        return self._rigid(node.mark, what, numbers)

    def _rigid(self, mark: Mark, what: str, numbers: Sequence[float]) -> RigidTransform | None:
        a, b, c, x, d, e, f, y, g, h, i, z = numbers[:12]
        given: Rotation = (a, b, c, d, e, f, g, h, i)
        rotation, deviation = nearest_rotation(given)
        if not deviation <= NEARLY_ORTHONORMAL:  # `not <=`: an overflow makes it NaN
            self._error(
                mark,
                what,
                f"the matrix of {what} is no rotation: |RᵀR − 1| is {deviation:.3g}, so that it stretches, skews or "
                "mirrors",
                accepted=f"axes of length 1, square to each other and right-handed, to {NEARLY_ORTHONORMAL:g}",
                suggestion=MORE_DIGITS if deviation < _ROUNDED else None,
            )
            return None
        if deviation > ORTHONORMAL:
            message = f"the matrix of {what} is a rotation only to {deviation:.1g}; the nearest rotation is used"
            self.add(
                Problem(
                    message=message,
                    severity="notice",
                    mark=mark,
                    field=what,
                    suggestion=MORE_DIGITS,
                )
            )
        return RigidTransform(rotation, (x, y, z))
