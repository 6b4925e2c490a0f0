"""Where the joints of an arm start, and a step from there: for the named states of ROS and the keyframe of MuJoCo."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.robot_check.contacts import initial_position

if TYPE_CHECKING:
    from dh2urdf.robot import Joint

__all__ = ["SLIDING", "STEP", "initial_position", "stepped"]

STEP = 0.2
"""A step of a joint's target that servos follow [rad]."""
SLIDING = 0.25
"""Travel of a prismatic joint that counts like 1 rad of a revolute one [m]."""


def stepped(joint: Joint, steps: float) -> float:
    """The joint value some steps from where the joint starts, on the side where its limits leave room [rad or m]."""
    start = initial_position(joint)
    lower = -math.inf if joint.limits.lower is None else joint.limits.lower
    upper = math.inf if joint.limits.upper is None else joint.limits.upper
    step = steps * STEP * (SLIDING if joint.type is JointType.PRISMATIC else 1.0)
    if lower <= start + step <= upper:
        return start + step
    ways = [min(max(value, lower), upper) for value in (start + step, start - step)]
    return max(ways, key=lambda value: abs(value - start))
