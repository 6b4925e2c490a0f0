"""Bars of parallelograms, which hold the links of followers in place of an equality of joint values.

Where a joint turns back what its leader turns, about a parallel axis, its link keeps its orientation to the link that
holds the leader. So a bar between the two links, as long as the axes are apart and parallel to the line between them,
keeps its length at any joint vector, and it alone makes the joint follow.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics import axis_rotation
from dh2urdf.manipulator import JointType
from dh2urdf.rotations import Vec3, add, cross, dot, multiply, norm, rotate, scale, subtract, transpose
from dh2urdf.source import Messages, Problem, free_name
from dh2urdf_plugins.formats import notices_of_elements

if TYPE_CHECKING:
    from dh2urdf.robot import Follower, Joint, Robot
    from dh2urdf_plugins.formats.mjcf import MjcfOptions

say = Messages(__file__)

ASIDE = 0.25
"""How far a bar is from the line between the axes, where the leader is in the middle of its limits: a share of it."""
FLATTEST = math.radians(10.0)
"""Angle of the parallelogram that the leader's limits have to leave [rad]: flat, it may turn over."""
MASS = 1e-6
"""Mass of a bar [kg]: it weighs nothing, and MuJoCo wants some."""
ARMATURE = 0.1
"""What a bar resists at its hinge: a share of what the follower's link does at the other end of it."""
THICKNESS = 0.015
"""Radius of a bar as it is drawn: a share of its length."""
STIFF = {"solref": "0.004 1", "solimp": "0.99 0.999 0.001"}
"""How MuJoCo holds the end of a bar: within two of its time steps."""
_PARALLEL = 1e-9
"""What two axes may differ that are parallel [rad]."""


class Bar(NamedTuple):
    """A bar, in the frame of the link that holds it, where the leader is at 0.

    Attributes:
        name: of its body, its hinge and the point at its end.
        leader: the joint whose value its hinge has.
        link: the link of the follower.
        start: where its hinge is [m].
        axis: unit vector that it turns about.
        span: from its hinge to its end [m].
        end: where its end is in that link [m].
        armature: of its hinge [kg·m²].
    """

    name: str
    leader: Joint
    link: str
    start: Vec3
    axis: Vec3
    span: Vec3
    end: Vec3
    armature: float


def bars(robot: Robot) -> dict[str, Bar]:
    """The bars of a robot, by the joints that they make follow: of those that turn back what their leader turns."""
    joint_to, taken = {joint.child: joint for joint in robot.joints}, {joint.name for joint in robot.joints}
    taken |= {link.name for link in robot.links}
    masses = {link.name: link.inertial.mass for link in robot.links if link.inertial}
    found: dict[str, Bar] = {}
    by_name = {joint.name: joint for joint in robot.joints}
    for name, law in robot.followers.items():
        joint, own = by_name[name], free_name(f"{name}_bar", taken)
        if bar := _bar(joint, law, joint_to, own, masses.get(joint.child, 0.0)):
            found[name] = bar
    return found


def _bar(joint: Joint, law: Follower, joint_to: dict[str, Joint], name: str, mass: float) -> Bar | None:
    """The bar of a joint; None where no bar makes it follow."""
    pose, above = joint.origin.transform, joint_to.get(joint.parent)
    while above and above.type is JointType.FIXED:
        pose, above = above.origin.transform @ pose, joint_to.get(above.parent)
    if above is None or above.name != law.leader or above.limits.lower is None or above.limits.upper is None:
        return None
    origin = above.origin.transform
    pose = origin @ pose  # that of the joint in the link that holds the leader, where both are at 0
    axis, own = rotate(origin.rotation, above.axis), rotate(pose.rotation, joint.axis)
    sign = -1.0 if dot(axis, own) < 0.0 else 1.0
    apart = subtract(pose.translation, origin.translation)
    span = subtract(apart, along := scale(dot(apart, axis), axis))
    middle, turns = 0.5 * (above.limits.lower + above.limits.upper), above.limits.upper - above.limits.lower
    is_turned_back = law.multiplier == -sign and not law.higher and JointType.PRISMATIC not in {above.type, joint.type}
    is_parallel = norm(cross(axis, own)) <= _PARALLEL
    if not (is_turned_back and is_parallel and norm(span) > 0.0 and turns <= math.pi - 2.0 * FLATTEST):
        return None
    aside = scale(ASIDE, cross(axis, rotate(axis_rotation(axis, middle), span)))
    at_law = multiply(axis_rotation(own, law.offset), pose.rotation)  # of the follower's link
    end = rotate(transpose(at_law), subtract(aside, along))
    armature = ARMATURE * mass * norm(span) ** 2
    start = add(origin.translation, aside)
    return Bar(name, above, joint.child, start, axis, span, end, armature)


def mjcf_notices(robot: Robot, options: MjcfOptions) -> list[Problem]:
    """What the file lacks: elements for other programs, and bars of followers, where they are asked for."""
    able = bars(robot) if options.followers == "connect" else robot.followers
    without = [say("follower-without-bar", joint=name) for name in robot.followers if name not in able]
    return [*notices_of_elements(robot, options), *without]
