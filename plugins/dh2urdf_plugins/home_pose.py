"""Where the joints of an arm start, and a step from there: for the named states of ROS and the keyframe of MuJoCo."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType

if TYPE_CHECKING:
    from dh2urdf.robot import Joint

STEP = 0.2
"""A step of a joint's target that servos follow [rad]."""
SLIDING = 0.25
"""Travel of a prismatic joint that counts like 1 rad of a revolute one [m]."""


def initial_position(joint: Joint) -> float:
    """Where a joint starts: at 0, or in the middle of its limits where 0 is outside [rad or m]."""
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.type is JointType.CONTINUOUS or lower is None or upper is None or lower <= 0.0 <= upper:
        return 0.0
    return 0.5 * lower + 0.5 * upper


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
