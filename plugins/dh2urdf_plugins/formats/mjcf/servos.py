"""The position servos of an arm: gains that follow a step of the target, from efforts and from what the joints move.

Every joint has a spring and a damper to its target, a PD controller. Of all joints together the equation of motion is
M(q)·a + C·v + K·(q − target) = 0, with diagonal K = D/T² and C = 2·D/T where all joints have one time constant T. The
mode of an eigenvalue μ of D⁻¹·M then has the damping ratio 1/√μ and decays at least with the rate 1/(2T), however
small μ is. So the law is to choose D such that no μ exceeds 1 at any joint vector: no mode overshoots, stretched out
or folded. D is the bound of the row sums of M (Gershgorin's theorem): the inertia that a joint feels when all joints
accelerate alike.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.manipulator import Follower, JointType
from dh2urdf.rotations import cross, norm, total
from dh2urdf_plugins.home_pose import SLIDING

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Joint, Robot
    from dh2urdf.rotations import Vec3

FASTEST, SLOWEST = 0.05, 0.25
"""Time constants of servos [s]: of one that has effort enough, and of one whose effort just carries the arm."""
YIELDING = 0.05
"""How far a joint is from its target when its servo asks for the effort that the weight leaves [rad]."""
STUCK = 0.002
"""How far at most static friction keeps a joint from its target [rad]."""
ROTOR = 0.05
"""Armature of a joint without one, as a share of the inertia that its servo is tuned for.

A light joint whose servo is at its limit would change its speed in one time step by more than the damper can follow;
with T = 50 ms and MuJoCo's step of 2 ms the share has to be above 0.04.
"""


class Servo(NamedTuple):
    """A position servo on one joint."""

    stiffness: float  # kp [N·m/rad or N/m]
    damping: float  # kv [N·m·s/rad or N·s/m]; with the joint's own damping it makes the whole
    armature: float  # inertia of the rotor behind the gear [kg·m² or kg]


def servos(robot: Robot) -> dict[str, Servo]:
    """The servo of every joint that has an effort, by the joint's name."""
    inertias, weights = _loads(robot)
    found = {}
    for joint in robot.actuated_joints:
        if not joint.limits.effort:
            continue
        unit = _unit(joint)
        inertia = inertias[joint.name] + (joint.armature or 0.0)
        spare = joint.limits.effort - weights[joint.name]
        wanted = max(spare / (YIELDING * unit), (joint.friction or 0.0) / (STUCK * unit))
        allowed = math.inf if joint.armature is None else joint.armature / (ROTOR * FASTEST**2)
        stiffness = max(min(wanted, allowed), inertia / SLOWEST**2)
        settling = max(FASTEST, math.sqrt(inertia / stiffness)) if stiffness else FASTEST
        damping = max(0.0, 2.0 * stiffness * settling - (joint.damping or 0.0))
        armature = _rounded(ROTOR * stiffness * settling**2) if joint.armature is None else joint.armature
        found[joint.name] = Servo(_rounded(stiffness), _rounded(damping), armature)
    return found


def _rounded(gain: float) -> float:
    """A number of a servo to the digits that matter."""
    return float(f"{gain:.4g}")


def _unit(joint: Joint) -> float:
    return SLIDING if joint.type is JointType.PRISMATIC else 1.0


def _loads(robot: Robot) -> tuple[dict[str, float], dict[str, float]]:
    """What each joint has to move at most, by its name, whatever the joint vector and however the arm is mounted.

    That is the inertia that it feels when all joints accelerate alike [kg·m² or kg], and the weight [N·m or N].
    A link of mass m and largest moment of inertia I adds to the element (j, k) of M at most m·r_j·r_k + I, where r_j is
    the length of the way from joint j to the link's centre of mass. Where j slides, r_j is 1, and there is no I.
    """
    inertia = {joint.name: 0.0 for joint in robot.actuated_joints}
    weight, followers = dict(inertia), robot.followers
    into = {joint.child: joint for joint in robot.joints}
    ways: dict[str, list[tuple[Joint, float]]] = {}  # of every link: the joints that move it, and how far they are
    for link in robot.links:  # Parents before children.
        joint = into.get(link.name)
        ways[link.name] = list(_ways(joint, ways[joint.parent])) if joint else []
        if not (link.inertial and link.inertial.mass):
            continue
        mass, com, tensor = link.inertial.mass, link.inertial.com, link.inertial.inertia
        moment = 0.5 * (tensor.ixx + tensor.iyy + tensor.izz)  # No principal moment exceeds the sum of the other two.
        away = norm(com)
        levers = [
            (each, 1.0, 0.0)
            if each.type is JointType.PRISMATIC
            else (each, reach + (_across(each, com) if each is joint else away), moment)
            for each, reach in ways[link.name]
        ]
        reaches = total(_unit(each) * lever for each, lever, _ in levers)
        turning = sum(each.type is not JointType.PRISMATIC for each, _, _ in levers)
        for each, lever, turns in levers:
            law = followers.get(each.name, Follower(each.name))  # The leader of a joint bears what the joint moves.
            name, rate = law.leader, abs(law.multiplier)
            if name:
                weight[name] += rate * GRAVITY * mass * lever
                inertia[name] += rate * (mass * lever * reaches / _unit(each) + turns * turning)
    return inertia, weight


def _ways(joint: Joint, before: list[tuple[Joint, float]]) -> Iterator[tuple[Joint, float]]:
    """How far the joints that move a link are from its frame at most [m]; the joint that holds it comes last."""
    limits, xyz = joint.limits, joint.origin.xyz
    travel = max(map(abs, (limits.lower or 0.0, limits.upper or 0.0))) if joint.type is JointType.PRISMATIC else 0.0
    away = norm(xyz)
    for each, reach in before:
        yield each, reach + (_across(each, xyz) if each.child == joint.parent else away) + travel
    if joint.type is not JointType.FIXED:
        yield joint, 0.0


def _across(joint: Joint, point: Vec3) -> float:
    """How far a point of the link that a joint moves is from the joint's axis [m]."""
    return norm(cross(point, joint.axis))
