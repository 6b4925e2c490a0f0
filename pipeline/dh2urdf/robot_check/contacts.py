"""Arms of a cell that overlap where their joints start, found without a collision library.

Every shape but a mesh is taken for the capsule around it: all points within a radius of a segment. Links are drawn
thicker than they are, so that an overlap is a notice.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.chain import link_poses
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Sphere
from dh2urdf.rotations import add, dot, rotate, scale, subtract
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Iterator
    from typing import TypeAlias

    from dh2urdf.robot import Arm, Collision, Joint, Origin, Robot
    from dh2urdf.rotations import RigidTransform, Vec3
    from dh2urdf.source import Problem

    Capsule: TypeAlias = tuple[Vec3, Vec3, float]  # both ends of its segment, and its radius [m]

say = Messages(__file__)

GRAZING = 0.01
"""Share of its radius by which the capsule of a link may reach into another: of a straight arm, ends meet ends."""
NEIGHBOURS = 2
"""Moving joints between a link and one of the arm that holds it, up to which their overlap is none: a flange is drawn
into what is bolted to it, and a wrist is folded."""


def initial_position(joint: Joint) -> float:
    """Where a joint starts: at 0, or in the middle of its limits where 0 is outside [rad or m]."""
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.type is JointType.CONTINUOUS or lower is None or upper is None or lower <= 0.0 <= upper:
        return 0.0
    return 0.5 * lower + 0.5 * upper


# --- Capsules ---------------------------------------------------------------------------------------------------------


def capsule_around(shape: Collision) -> Capsule | None:
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
    return placed_capsule((half, scale(-1.0, half), radius), shape.origin.transform)


def placed_capsule(capsule: Capsule, frame: RigidTransform) -> Capsule:
    """A capsule of a frame, where the frame is."""
    start, end, radius = capsule
    ends = [add(frame.translation, rotate(frame.rotation, point)) for point in (start, end)]
    return ends[0], ends[1], radius


def overlap(one: Capsule, other: Capsule) -> float:
    """How deep a capsule reaches into another [m]; 0 where they are apart, or only graze each other."""
    # Of most pairs the spheres around the capsules are apart.
    reach = one[2] + other[2] + math.dist(*one[:2]) + math.dist(*other[:2])
    if math.dist(one[0], other[0]) > reach:
        return 0.0
    depth = -capsule_distance(one, other)
    return depth if depth > GRAZING * (one[2] + other[2]) else 0.0


def capsule_distance(one: Capsule, other: Capsule) -> float:
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


# --- Arms -------------------------------------------------------------------------------------------------------------


class _ArmBody(NamedTuple):
    """The capsules of an arm in the root link of its cell, each with its link, and the capsule around all."""

    name: str
    capsules: list[tuple[str, Capsule]]
    around: Capsule


def arm_overlaps(robot: Robot) -> Iterator[Problem]:
    """A notice of two arms of a cell that have one place, or of the two that overlap most where their joints start."""
    places: dict[tuple[str, Origin], Arm] = {}
    for arm in robot.arms:
        if (same := places.setdefault((arm.parent, arm.placement), arm)) is not arm:
            yield say("arms-at-one-place", first=same.name, second=arm.name, place=arm.parent)
            return
    bodies = list(_bodies(robot))
    joint_to = {joint.child: joint for joint in robot.joints}
    holders = _holders(robot)
    found: list[tuple[float, str, str, str, str]] = []
    for one, other in combinations(bodies, 2):
        if not overlap(one.around, other.around):
            continue
        is_held = one.name in holders[other.name] or other.name in holders[one.name]
        deepest = (0.0, "", "")
        for first, capsule in one.capsules:
            for second, another in other.capsules:
                depth = overlap(capsule, another)
                if depth > deepest[0] and not (is_held and _between(first, second, joint_to) <= NEIGHBOURS):
                    deepest = depth, first, second
        if deepest[0]:
            found.append((deepest[0], one.name, other.name, *deepest[1:]))
    if found:
        depth, first, second, link, other_link = max(found)
        others = f"; of {len(found)} pairs of arms, this is the deepest" if len(found) > 1 else ""
        yield say("arms-overlap", first=first, second=second, link=link, other=other_link, depth=depth, others=others)


def _bodies(robot: Robot) -> Iterator[_ArmBody]:
    """The arms of a cell where their joints start; those without shapes that are known are left out."""
    frames = link_poses(robot, {joint.name: initial_position(joint) for joint in robot.moving_joints})
    shapes = {link.name: link.collisions for link in robot.links}
    for arm in robot.arms:
        links = [arm.prefix + link.name for link in arm.kind.links]
        around = ((link, capsule_around(shape)) for link in links for shape in shapes[link])
        capsules = [(link, placed_capsule(capsule, frames[link])) for link, capsule in around if capsule]
        if capsules:
            centre = capsules[0][1][0]
            size = max(math.dist(centre, end) + radius for _, (*ends, radius) in capsules for end in ends)
            yield _ArmBody(arm.name, capsules, (centre, centre, size))


def _holders(robot: Robot) -> dict[str, set[str]]:
    """The arms that hold each arm, and those that hold these; arms are after what holds them."""
    owners = {arm.prefix + link.name: arm.name for arm in robot.arms for link in arm.kind.links}
    holders: dict[str, set[str]] = {}
    for arm in robot.arms:
        holder = owners.get(arm.parent)
        holders[arm.name] = {holder, *holders[holder]} if holder else set()
    return holders


def _between(first: str, second: str, joint_to: dict[str, Joint]) -> int:
    """How many moving joints are between two links."""

    def above(link: str) -> Iterator[str]:
        while joint := joint_to.get(link):
            if joint.type is not JointType.FIXED:
                yield joint.name
            link = joint.parent

    return len({*above(first)} ^ {*above(second)})
