"""What a link that is dragged moves: the joint that is nearest to it, or the one which that joint follows."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import JointType
from dh2urdf.rotations import Vec3, norm

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.robot import Joint, Robot
    from dh2urdf.stages.foreign_robot import Follower

_MOVING = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
_STEPS, _CLOSE = 30, 1e-9


class Grip(NamedTuple):
    """How a link can be dragged.

    Attributes:
        joint: name of the joint whose value changes.
        carrier: name of the link whose frame has the axis: of the joint nearest to the link.
        axis: the axis about which the link turns, or along which it slides, in the carrier's frame.
        slides: whether it slides.
        is_endless: whether the joint whose value changes has no limits.
        followers: how the joint nearest to the link follows that one, the last first; none where it is that one.
    """

    joint: str
    carrier: str
    axis: Vec3
    slides: bool
    is_endless: bool
    followers: tuple[Follower, ...] = ()

    def value(self, before: float, by: float) -> float:
        """The joint value that turns or slides the link so far from a value before [rad or m], by Newton's method."""
        aim, value = self._followed(before)[0] + by, before
        for _ in range(_STEPS):
            now, rate = self._followed(value)
            if abs(aim - now) < _CLOSE or not rate:
                break
            value += (aim - now) / rate
        if not abs(self._followed(value)[0] - aim) < _CLOSE:  # the joint turns back before
            return before
        return math.remainder(value, math.tau) if self.is_endless else value

    def _followed(self, value: float) -> tuple[float, float]:
        """Where the link is at a value of the joint, and how far it moves for each rad or m of it."""
        rate = 1.0
        for follower in self.followers:
            rate, value = rate * follower.rate(value), follower.value(value)
        return value, rate


def grips(robot: Robot, followers: Mapping[str, Follower], before: str = "") -> dict[str, Grip]:
    """How the links of a robot can be dragged, by the name of the link; those that nothing moves are left out."""
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
    leader, way = joint.name, list["Follower"]()
    while (follower := followers.get(leader)) is not None:
        leader = follower.leader
        way.insert(0, follower)
    if not all(each.is_finite and (each.multiplier or each.higher) for each in way):
        return None
    slides, is_endless = joint.type is JointType.PRISMATIC, joints[leader].type is JointType.CONTINUOUS
    return Grip(before + leader, before + joint.child, joint.axis, slides, is_endless, tuple(way))


class Grasp:
    """A link that is being dragged."""

    def __init__(self) -> None:
        self._before = 0.0

    def value(self, grip: Grip, value: float, by: float, *, begins: bool) -> float:
        """The value of the grip's joint, where the link has moved so far since it was taken [rad or m]."""
        if begins:
            self._before = value
        return grip.value(self._before, by)
