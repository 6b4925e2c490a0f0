"""The limits of joints that a table does not give: range, travel and velocity; and what laws make of limits."""

from __future__ import annotations

import math
from functools import reduce
from typing import TYPE_CHECKING, Any

from dh2urdf.fields import replace_unchecked
from dh2urdf.kinematics.mass import two_digits
from dh2urdf.manipulator import DHRow, JointType, Limits, new_limits, whole_laws
from dh2urdf.rotations import greater_of, mapped
from dh2urdf_plugins.transforms.shapes import SMALLEST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import Follower, Manipulator
    from dh2urdf.rotations import Condition, Number

_ROUNDING = 1e-9  # what a value may be beyond a limit [rad or m]


def complete_limits(rows: Sequence[DHRow]) -> list[Limits]:
    """The limits of an arm's rows with lower, upper and velocity filled in; effort waits for the masses.

    ±2π rad, or to each side half the length of the arm's longest link, rounded down to two digits; π rad/s or 1 m/s.
    A continuous joint has no lower and upper, a fixed one nothing. Those of a follower are what its law makes of its
    leader's.
    """
    slides = any(row.type is JointType.PRISMATIC and row.limits.lower is None for row in rows)
    slide = half_travel(rows) if slides else 0.0
    limits = []
    for row in rows:
        given = row.limits
        bound, speed = (slide, 1.0) if row.type is JointType.PRISMATIC else (math.tau, math.pi)
        velocity = speed if given.velocity is None else given.velocity
        lower = -bound if given.lower is None else given.lower
        upper = bound if given.upper is None else given.upper
        if row.type is JointType.FIXED:
            limits.append(new_limits())
        elif row.type is JointType.CONTINUOUS:
            limits.append(replace_unchecked(given, lower=None, upper=None, velocity=velocity))
        else:
            limits.append(replace_unchecked(given, lower=lower, upper=upper, velocity=velocity))
    numbers = {row.joint: number for number, row in enumerate(rows)}
    for name, law in whole_laws({row.joint: row.follows for row in rows if row.follows}).items():
        number, leader = numbers[name], limits[numbers[law.leader]]
        row, led = rows[number], limits[number]
        lower, upper = led_range(law, leader) if row.type is not JointType.CONTINUOUS else (None, None)
        speed = abs(law.multiplier) * leader.velocity  # type: ignore[operator]  # it is complete
        limits[number] = replace_unchecked(
            led,
            lower=led.lower if lower is None or row.limits.lower is not None else lower,
            upper=led.upper if upper is None or row.limits.upper is not None else upper,
            velocity=led.velocity if row.limits.velocity is not None or not law.multiplier else speed,
        )
    return limits


def led_range(law: Follower, leader: Limits) -> tuple[Any, Any]:
    """The smallest and the largest value of a joint that follows another one [rad or m]; None where there is no end."""
    if leader.lower is None or leader.upper is None:
        return None, None
    ends = law.value(leader.lower), law.value(leader.upper)
    return ends if law.multiplier >= 0.0 else ends[::-1]


def half_travel(rows: Sequence[DHRow]) -> Number:
    """How far a prismatic joint without limits moves to each side [m]: its rail is no longer than the longest link.

    A link is as long as `a`, or as `d` at joint value 0. ±1 m where all of an arm's links have the length 0.
    """
    lengths = [abs(row.d + row.offset) if row.type is JointType.PRISMATIC else abs(row.d) for row in rows]

    def half(longest: float) -> float:
        return two_digits(0.5 * longest, math.floor, 1e-9) if SMALLEST < longest < math.inf else 1.0

    return mapped(half, reduce(greater_of, [*lengths, *(abs(row.a) for row in rows)]))


def travel(joint_type: JointType, limits: Limits) -> float:
    """How far a joint moves its link along its axis from where it is at joint value 0, at most [m]."""
    if joint_type is not JointType.PRISMATIC or limits.lower is None or limits.upper is None:
        return 0.0
    farthest: float = greater_of(abs(limits.lower), abs(limits.upper))
    return farthest


def leaves_limits(row: DHRow, law: Follower, manipulator: Manipulator) -> Condition:
    """Whether a law leads the joint of a row beyond the limits that the row gives; takes columns."""
    if row.limits.lower is None or row.limits.upper is None:
        return False
    leader = [each.joint for each in manipulator.rows].index(law.leader)
    lower, upper = led_range(law, complete_limits(manipulator.rows)[leader])
    if lower is None:
        return bool(law.multiplier)
    beyond: Condition = (lower < row.limits.lower - _ROUNDING) | (upper > row.limits.upper + _ROUNDING)
    return beyond
