"""The numbers of a row, in one place: what each measures, which joints have it, and which values it takes.

Columns, the keys of `--resume`, texts of tables, variations, checks and reports take their lists from here, and the
lists here come from the fields of the records: a number that is added to `DHRow` and to `ROW_FIELDS` is in all of them.
"""

from __future__ import annotations

from dataclasses import fields
from typing import Any, NamedTuple

from dh2urdf.manipulator import DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.quantities.units import Dimension
from dh2urdf.robot import Joint

NUMBERS = tuple(field.name for field in fields(DHRow) if field.type in {"float", "float | None"})
"""The fields of a row that are one number each."""
LIMITS = tuple(field.name for field in fields(Limits))
"""The limits of its joint."""
COM = ("com_x", "com_y", "com_z")
"""The coordinates of its centre of mass."""
INERTIA = tuple(field.name for field in fields(Inertia))
"""The elements of its inertia tensor."""
WORDS = tuple(field.name for field in fields(DHRow) if field.name not in {*NUMBERS, "limits", "com", "inertia", "mark"})
"""The fields of a row that are no numbers, or as the sign none that a column holds."""
COMMON = tuple(field.name for field in fields(Manipulator) if field.name not in {"name", "rows", "mark"})
"""The fields of a manipulator that its rows have nothing to do with."""
DYNAMICS = tuple(name for name in NUMBERS if name in {field.name for field in fields(Joint)})
"""What a joint resists its motion with: the numbers that go from the row to the joint as they are."""

_MOVING = frozenset(JointType) - {JointType.FIXED}
_BOUNDED = frozenset({JointType.REVOLUTE, JointType.PRISMATIC})

SI_UNITS = {
    Dimension.LENGTH: "m",
    Dimension.ANGLE: "rad",
    Dimension.SPEED: "m/s",
    Dimension.TURN_RATE: "rad/s",
    Dimension.FORCE: "N",
    Dimension.TORQUE: "N·m",
    Dimension.DAMPING: "N·m·s/rad",
    Dimension.LINEAR_DAMPING: "N·s/m",
    Dimension.MASS: "kg",
    Dimension.INERTIA: "kg·m²",
}
"""The unit of each dimension in records and reports."""


class RowField(NamedTuple):
    """A number of a row.

    Attributes:
        dimension: what it measures; None for words and counts.
        linear: what it measures in the row of a prismatic joint, where that is something else.
        types: the types of joints that have it.
        positive: whether it must be greater than 0.
        negative: whether it may be less than 0.
    """

    dimension: Dimension | None
    linear: Dimension | None = None
    types: frozenset[JointType] = frozenset(JointType)
    positive: bool = False
    negative: bool = True

    def of(self, kind: JointType) -> Dimension | None:
        """What it measures in the row of a type of joint."""
        return self.linear if self.linear and kind is JointType.PRISMATIC else self.dimension

    def takes(self, numbers: Any) -> Any:  # noqa: ANN401 - a number, or a column of them
        """Whether it may have a value, for each of a column; that numbers are finite is another matter."""
        if self.positive:
            return numbers > 0.0
        return (numbers >= 0.0) | self.negative

    @property
    def bound(self) -> str:
        """What `takes` asks of a number, as the end of a sentence; empty where it takes any."""
        return "greater than 0" if self.positive else "" if self.negative else "0 or greater"


ROW_FIELDS = {
    "a": RowField(Dimension.LENGTH),
    "d": RowField(Dimension.LENGTH),
    "alpha": RowField(Dimension.ANGLE),
    "theta": RowField(Dimension.ANGLE),
    "offset": RowField(Dimension.ANGLE, Dimension.LENGTH, types=_MOVING),
    "lower": RowField(Dimension.ANGLE, Dimension.LENGTH, types=_BOUNDED),
    "upper": RowField(Dimension.ANGLE, Dimension.LENGTH, types=_BOUNDED),
    "velocity": RowField(Dimension.TURN_RATE, Dimension.SPEED, types=_MOVING, positive=True),
    "effort": RowField(Dimension.TORQUE, Dimension.FORCE, types=_MOVING, positive=True),
    "mass": RowField(Dimension.MASS, positive=True),
    "radius": RowField(Dimension.LENGTH, positive=True),
    "damping": RowField(Dimension.DAMPING, Dimension.LINEAR_DAMPING, types=_MOVING, negative=False),
    "friction": RowField(Dimension.TORQUE, Dimension.FORCE, types=_MOVING, negative=False),
    "armature": RowField(Dimension.INERTIA, Dimension.MASS, types=_MOVING, negative=False),
    **dict.fromkeys(COM, RowField(Dimension.LENGTH)),
    **dict.fromkeys(INERTIA, RowField(Dimension.INERTIA)),
}
"""All numbers of a row, by the names that tables and run files have for them."""
