"""Joint values as sliders show them: in the units of the table, inside the limits."""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.kinematics import chain
from dh2urdf.kinematics.expected_poses import LARGEST_SAMPLE
from dh2urdf.manipulator import JointType
from dh2urdf.quantities import evaluate
from dh2urdf.quantities.units import UNITS, Unit

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Joint


@dataclass(frozen=True, slots=True, kw_only=True)
class Slider:
    """A moving joint on the screen."""

    name: str
    lower: float  # smallest value [rad or m]
    upper: float  # largest value [rad or m]
    unit: Unit  # of what is shown
    group: str = ""  # the robot that the joint belongs to, where there are several
    is_endless: bool = False  # whether it turns round and round; values beyond half a turn come in at the other end

    def shown(self, value: float) -> float:
        """A joint value [rad or m] in the unit of the slider."""
        return self.unit.number(value)

    def value(self, shown: float) -> float:
        """The joint value [rad or m] that a slider shows, inside the limits."""
        return self.inside(self.unit.si(shown))

    def read(self, text: str) -> float:
        """What a text says in the unit of the slider, inside the limits; it may be all that a cell may be."""
        return self.shown(self.inside(evaluate(text, self.unit.dimension, self.unit, decimal_comma=True).value))

    def inside(self, value: float) -> float:
        """The value inside the limits that is nearest to another."""
        if not math.isfinite(value):
            return self.inside(0.0)
        return min(max(math.remainder(value, math.tau) if self.is_endless else value, self.lower), self.upper)

    def holds(self, value: float) -> bool:
        """Whether a value [rad or m] is inside the limits."""
        return self.is_endless or self.lower <= value <= self.upper


def sliders(
    joints: Sequence[Joint], length_unit: str = "m", angle_unit: str = "rad", group: str = ""
) -> tuple[Slider, ...]:
    """The sliders of some joints; a continuous joint has a turn."""
    found = []
    for joint in joints:
        lower, upper = joint.limits.lower, joint.limits.upper
        unit = UNITS[length_unit if joint.type is JointType.PRISMATIC else angle_unit]
        is_endless = joint.type is JointType.CONTINUOUS
        if lower is None or upper is None or is_endless:
            lower, upper = -math.pi, math.pi
        lower, upper = max(lower, -LARGEST_SAMPLE), min(upper, LARGEST_SAMPLE)
        found.append(Slider(name=joint.name, lower=lower, upper=upper, unit=unit, group=group, is_endless=is_endless))
    return tuple(found)


def renamed(q: Mapping[str, float], before: Sequence[Slider], after: Sequence[Slider]) -> dict[str, float]:
    """Joint values by the names that the joints have now, where names are all that has changed."""
    old, new = ([slider.name for slider in each] for each in (before, after))
    names = {one: other for one, other in zip(old, new, strict=False) if one != other}
    if len(old) != len(new) or names.keys() & set(new) or set(names.values()) & set(old):  # others, or in another order
        return dict(q)
    return {names.get(name, name): value for name, value in q.items()}


def kept(q: Mapping[str, float], of: Sequence[Slider]) -> dict[str, float]:
    """The values of joints that are still there, inside their limits; 0 or what is nearest for those that are new."""
    return {slider.name: slider.inside(q.get(slider.name, 0.0)) for slider in of}


def reach(manipulator: Manipulator, of: Sequence[Slider]) -> float:
    """An upper bound of the distance from base_link to tool0, every joint anywhere inside its limits [m]."""
    ends = {slider.name: (slider.lower, slider.upper) for slider in of}
    travel = 0.0
    for row in manipulator.moving_rows:
        if row.type is JointType.PRISMATIC:
            farthest = max(abs(chain.joint_variables(row, q)[1]) for q in ends.get(row.joint, (0.0,)))
            travel += farthest - abs(chain.joint_variables(row)[1])
    return chain.reach(manipulator) + travel


def anywhere(of: Sequence[Slider]) -> dict[str, float]:
    """Every joint somewhere inside its limits."""
    return {slider.name: random.uniform(slider.lower, slider.upper) for slider in of}  # noqa: S311 - a pose, no secret
