"""What a link that is dragged moves: the joint that is nearest to it, or the one which that joint follows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import JointType
from dh2urdf.rotations import Vec3, norm

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.foreign_robot import Follower
    from dh2urdf.robot import Joint, Robot

_MOVING = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)


class Grip(NamedTuple):
    """How a link can be dragged.

    Attributes:
        joint: name of the joint whose value changes.
        carrier: name of the link whose frame has the axis: of the joint nearest to the link.
        axis: the axis about which the link turns, or along which it slides, in the carrier's frame.
        slides: whether it slides.
        is_endless: whether the joint whose value changes has no limits.
        rate: how far the link moves, over the value of the joint.
    """

    joint: str
    carrier: str
    axis: Vec3
    slides: bool
    is_endless: bool
    rate: float = 1.0

    def value(self, before: float, by: float) -> float:
        """The joint value that moves the link so far.

        Args:
            before: the value before [rad or m].
            by: how far the link turns or slides [rad or m].
        """
        value = before + by / self.rate
        return math.remainder(value, 2.0 * math.pi) if self.is_endless else value


def grips(robot: Robot, followers: Mapping[str, Follower], before: str = "") -> dict[str, Grip]:
    """How the links of a robot can be dragged, by the name of the link; those that nothing moves are left out.

    Args:
        robot: the robot.
        followers: the joints that follow another one, by name.
        before: what stands before the names of its joints and links in the scene.
    """
    above = {joint.child: joint for joint in robot.joints}
    joints = {joint.name: joint for joint in robot.joints}
    found = {}
    for link in robot.links:
        name, seen = link.name, set[str]()
        while (joint := above.get(name)) is not None and name not in seen:
            seen.add(name)
            if (grip := _grip(joint, joints, followers, before)) is not None:
                found[link.name] = grip
                break
            name = joint.parent
    return found


def _grip(joint: Joint, joints: Mapping[str, Joint], followers: Mapping[str, Follower], before: str) -> Grip | None:
    if joint.type not in _MOVING or norm(joint.axis) == 0.0:
        return None
    leader, rate = joint.name, 1.0
    while (follower := followers.get(leader)) is not None:
        leader, rate = follower.leader, rate * follower.multiplier
    if rate == 0.0 or not math.isfinite(rate):
        return None
    return Grip(
        joint=before + leader,
        carrier=before + joint.child,
        axis=joint.axis,
        slides=joint.type is JointType.PRISMATIC,
        is_endless=joints[leader].type is JointType.CONTINUOUS,
        rate=rate,
    )


class Grasp:
    """A link that is being dragged."""

    def __init__(self) -> None:
        self._before = 0.0

    def value(self, grip: Grip, value: float, by: float, *, begins: bool) -> float:
        """The value of the grip's joint.

        Args:
            grip: of the link.
            value: the value of its joint now [rad or m].
            by: how far the link has moved since it was taken [rad or m].
            begins: whether it was taken just now.
        """
        if begins:
            self._before = value
        return grip.value(self._before, by)
