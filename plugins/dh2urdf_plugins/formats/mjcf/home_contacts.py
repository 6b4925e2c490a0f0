"""The links of an arm that touch each other where it starts, found without a collision library.

Links are drawn thicker than they are, from joint to joint: those of a folded wrist overlap, and a simulator would push
them apart. Every shape but a mesh is taken for the capsule around it: all points within a radius of a segment.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING

from dh2urdf.kinematics import joint_motion
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Sphere
from dh2urdf.rotations import IDENTITY, add, dot, rotate, scale, subtract
from dh2urdf_plugins.home_pose import stepped

if TYPE_CHECKING:
    from typing import TypeAlias

    from dh2urdf.robot import Collision, Robot
    from dh2urdf.rotations import RigidTransform, Vec3

    Capsule: TypeAlias = tuple[Vec3, Vec3, float]  # both ends of its segment, and its radius

GRAZING = 0.01
"""Share of its radius by which the capsule of a link may reach into another: of a straight arm, ends meet ends."""


def touching_at_home(robot: Robot) -> list[tuple[str, str]]:
    """The pairs of links that touch at home, or where all joints have made a step from there, to either side."""
    capsules = {link.name: [each for each in map(_capsule, link.collisions) if each] for link in robot.links}
    origins = {joint.name: joint.origin.transform for joint in robot.joints}
    found: dict[tuple[str, str], None] = {}
    for steps in (0.0, -1.0, 1.0):
        frames = {robot.root: IDENTITY}
        for joint in robot.joints:  # Parents before children.
            frames[joint.child] = frames[joint.parent] @ origins[joint.name]
            if joint.type is not JointType.FIXED:
                frames[joint.child] @= joint_motion(joint, stepped(joint, steps))
        placed = [(name, _placed(each, frames[name])) for name, shapes in capsules.items() for each in shapes]
        for (first, one), (second, other) in combinations(placed, 2):
            # Of most links the spheres around the capsules are apart.
            reach = one[2] + other[2] + math.dist(*one[:2]) + math.dist(*other[:2])
            is_near = first != second and math.dist(one[0], other[0]) <= reach
            if is_near and _distance(one, other) < -GRAZING * (one[2] + other[2]):
                found[first, second] = None
    return list(found)


def _capsule(shape: Collision) -> Capsule | None:
    """The capsule around a shape, in the frame of its link; None of a mesh."""
    match shape.geometry:
        case Sphere(radius=radius):
            half: Vec3 = (0.0, 0.0, 0.0)
        case Cylinder(radius=radius, length=length):
            half = (0.0, 0.0, length / 2)
        case Box(size=size):
            longest = max(range(3), key=lambda axis: size[axis])
            radius = math.hypot(*(size[axis] / 2 for axis in range(3) if axis != longest))
            x, y, z = (size[axis] / 2 if axis == longest else 0.0 for axis in range(3))
            half = (x, y, z)
        case _:
            return None
    return _placed((half, scale(-1.0, half), radius), shape.origin.transform)


def _placed(capsule: Capsule, frame: RigidTransform) -> Capsule:
    start, end, radius = capsule
    ends = [add(frame.translation, rotate(frame.rotation, point)) for point in (start, end)]
    return ends[0], ends[1], radius


def _distance(one: Capsule, other: Capsule) -> float:
    """How far two capsules are apart [m]; negative where they overlap.

    The nearest points of two segments: C. Ericson, Real-Time Collision Detection, section 5.1.9.
    """
    (start, end, radius), (other_start, other_end, other_radius) = one, other
    along, beside, between = subtract(end, start), subtract(other_end, other_start), subtract(start, other_start)
    a, e, b = dot(along, along), dot(beside, beside), dot(along, beside)
    c, f = dot(along, between), dot(beside, between)
    s = _share(b * f - c * e, a * e - b * b)
    t = _share(b * s + f, e)
    s = _share(b * t - c, a)
    apart = subtract(add(start, scale(s, along)), add(other_start, scale(t, beside)))
    return math.sqrt(dot(apart, apart)) - radius - other_radius


def _share(numerator: float, denominator: float) -> float:
    """A quotient between 0 and 1; 0 where a segment is a point, or two are parallel."""
    return min(max(numerator / denominator, 0.0), 1.0) if denominator > 0.0 else 0.0
