"""The rules that a finished robot must keep, whatever made it.

No reader of robot descriptions is a validator: what one refuses, another reads in silence and simulates as something
else, or crashes on. So every robot is checked before it is written. Each rule below stands for a fault that was seen
to go wrong in PyBullet, MuJoCo, Pinocchio, Drake, urdfdom or sdformat.
"""

from __future__ import annotations

import math
import re
from dataclasses import fields, replace
from typing import TYPE_CHECKING

from dh2urdf.kinematics.mass import inertia_problem, is_sound
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf.robot_check.formulas import formula_problems
from dh2urdf.rotations import norm
from dh2urdf.row_fields import DYNAMICS
from dh2urdf.source import Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.elementwise import Condition
    from dh2urdf.robot import Collision, Geometry, Inertial, Joint, Link, Robot, Visual

LONGEST_NAME = 1000
"""Characters of a name: PyBullet crashes on longer ones, or cuts them."""

UNIT = 1e-9
"""How far the length of an axis may be from 1: PyBullet takes another length for another inertia."""


# XML holds none of these, or holds them so that readers make spaces of them (XML 1.0, sections 2.2 and 3.3.3).
# It is compiled at the first name that is not plain ASCII: that alone takes as long as checking a robot.
_NOT_IN_NAMES = "[\x00-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff]"
_TROUBLESOME = r"\s|::|[&<>\"'/]|[^\x00-\x7f]"


def check_robot(robot: Robot) -> tuple[Problem, ...]:
    """Everything that is wrong with a robot; an empty tuple for one that every reader takes.

    A problem of severity ``notice`` does not keep the robot from being written.
    """
    joint_to: dict[str, Joint] = {}
    for joint in robot.joints:
        joint_to.setdefault(joint.child, joint)
    problems = [*_name_problems(robot, joint_to), *_tree_problems(robot, joint_to)]
    for joint in robot.joints:
        problems += (_of_joint(problem, joint) for problem in _joint_problems(joint))
    children = {joint.child for joint in robot.joints}
    for link in robot.links:
        holder = joint_to.get(link.name)
        found = [*_body_problems(link, holder, is_root=link.name not in children), *_shape_problems(link)]
        problems += (_of_joint(problem, holder) for problem in found)
    problems += _weightless_chains(robot, joint_to)
    problems += formula_problems(robot)
    return tuple(problem.about(robot=robot.name) for problem in problems)


def sure_columns(robot: Robot, names: Sequence[str]) -> Condition:
    """Which of many robots, whose numbers are columns, are beyond doubt: `check_robot` reports nothing about them.

    Of the numbers each rule below has a test here that is cheap and sufficient; what all robots have alike is judged by
    `check_robot` itself on one of them.

    Args:
        robot: the robot with the columns, shapes that only some of them have included.
        names: the names of all of them.
    """
    import numpy as np

    from dh2urdf.columns import columns_of, member

    sure = np.array([bool(name.strip()) for name in names])
    if columns := columns_of(robot):
        sure &= np.isfinite(columns).all(axis=0)
    with np.errstate(all="ignore"):
        for joint in robot.joints:
            sure &= _is_sure_joint(joint)
        for link in robot.links:
            sure &= _is_sure_link(link)
    if sure.any():
        index = int(sure.argmax())
        one = member(robot, index)
        sure &= not check_robot(replace(one, name=names[index]))
    return sure


def _of_joint(problem: Problem, joint: Joint | None) -> Problem:
    """The problem with the name and the place of a joint; that of a link is the joint that moves it."""
    if joint is None:
        return problem
    return replace(problem, joint=problem.joint or joint.name, mark=problem.mark or joint.mark)


# Names.


def _name_problems(robot: Robot, joint_to: dict[str, Joint]) -> Iterator[Problem]:
    """Names are there, short enough, writable, and no two are the same: links and joints share one set."""
    owners: dict[str, str] = {}
    named = [("link", link.name, joint_to.get(link.name)) for link in robot.links]
    named += [("joint", joint.name, joint) for joint in robot.joints]
    troublesome = []
    for kind, name, joint in named:
        if problem := _name_problem(kind, name):
            yield _of_joint(problem, joint)
        elif name in owners:
            yield _of_joint(
                Problem(
                    message=f"{kind} {shown(name)} has the name of another {owners[name]}",
                    field=kind,
                    found=name,
                    accepted="names that differ: links and joints, base_link, base_link_inertia, flange and tool0 "
                    "included, share one set",
                ),
                joint,
            )
        elif not (name.isascii() and name.replace("-", "_").isidentifier()) and re.search(_TROUBLESOME, name):
            troublesome.append(name)
        owners.setdefault(name, kind)
    if not robot.name.strip():
        yield Problem(message="the robot has no name", field="name", accepted="a name that is not empty")
    if troublesome:
        few = ", ".join(map(shown, troublesome[:3]))
        yield Problem(
            severity="notice",
            message=f"{len(troublesome)} names hold characters that some ROS tools and SDF do not take: {few}",
            accepted="letters a to z, digits, _ and - are taken everywhere",
        )


def _name_problem(kind: str, name: str) -> Problem | None:
    if not name.strip():
        return Problem(message=f"a {kind} has no name", field=kind, found=name, accepted="a name that is not empty")
    if len(name) > LONGEST_NAME:
        return Problem(
            message=f"the name of a {kind} has {len(name)} characters",
            field=kind,
            found=name,
            accepted=f"at most {LONGEST_NAME} characters: PyBullet crashes on longer names",
        )
    if not (name.isascii() and name.isprintable()) and (culprit := re.search(_NOT_IN_NAMES, name)):
        return Problem(
            message=f"the name of {kind} {shown(name)} holds the character U+{ord(culprit.group()):04X}",
            field=kind,
            found=name,
            accepted="names without control characters and lone surrogates, which XML cannot hold",
        )
    return None


# The tree.


def _tree_problems(robot: Robot, joint_to: dict[str, Joint]) -> Iterator[Problem]:
    """One root, from which every link is reached by one way."""
    names = {link.name for link in robot.links}
    for joint in robot.joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in names:
                near = did_you_mean(link, names)
                message = f"the joint's {role} {shown(link)} is no link of the robot"
                yield _of_joint(Problem(message=message, field=role, found=link, suggestion=near), joint)
        if joint_to[joint.child] is not joint:
            message = f"link {shown(joint.child)} is already the child of joint {shown(joint_to[joint.child].name)}"
            yield _of_joint(Problem(message=message, field="child", accepted="one joint for each link"), joint)
    roots = [link.name for link in robot.links if link.name not in joint_to]
    if not robot.links:
        yield Problem(message="the robot has no links")
    elif not roots:
        yield Problem(message="no link is the root: the joints form a cycle", accepted="a tree with one root")
    elif len(roots) > 1:
        few = ", ".join(map(shown, roots[:5]))
        yield Problem(message=f"{len(roots)} links have no parent: {few}", accepted="a tree with one root")
    else:
        reached = _reached(robot, roots[0])
        if lost := [link.name for link in robot.links if link.name not in reached]:
            few = ", ".join(map(shown, lost[:5]))
            message = f"no way leads from the root {shown(roots[0])} to {few}: joints form a cycle"
            yield Problem(message=message, accepted="a tree with one root")


def _reached(robot: Robot, root: str) -> set[str]:
    """The links that are below the root; without recursion, for arms may have thousands of joints."""
    below: dict[str, list[str]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint.child)
    reached, ahead = {root}, [root]
    while ahead:
        fresh = [child for child in below.get(ahead.pop(), ()) if child not in reached]
        reached.update(fresh)
        ahead += fresh
    return reached


# Joints.


def _joint_problems(joint: Joint) -> Iterator[Problem]:
    """Origin finite, axis of length 1, limits complete and in order, friction and armature not negative."""
    yield from _finite("origin", (*joint.origin.xyz, *joint.origin.rpy))
    if joint.type is not JointType.FIXED:
        length = norm(joint.axis)
        if not abs(length - 1.0) <= UNIT:
            message = f"the joint's axis has the length {length:.12g}"
            yield Problem(message=message, field="axis", accepted="a vector of length 1")
    yield from _limit_problems(joint)
    for name in DYNAMICS:
        value = getattr(joint, name)
        if value is not None and not 0.0 <= value < math.inf:
            message = f"{name} is {value:.12g}"
            yield Problem(message=message, field=name, found=f"{value:.12g}", accepted="a number of 0 or more")


def _limit_problems(joint: Joint) -> Iterator[Problem]:
    limits = joint.limits
    bounded = joint.type in (JointType.REVOLUTE, JointType.PRISMATIC)
    moving = joint.type is not JointType.FIXED
    needed = {"lower": bounded, "upper": bounded, "velocity": moving, "effort": moving}
    for name, is_needed in needed.items():
        value = getattr(limits, name)
        field = f"limits.{name}"
        if is_needed is (value is None):
            words = "needs a limit" if is_needed else "has no limit"
            yield Problem(message=f"a {joint.type.value} joint {words} {name}", field=field)
        elif value is not None and not math.isfinite(value):
            message = f"the limit {name} is {value}"
            yield Problem(message=message, field=field, found=str(value), accepted="a finite number")
        elif value is not None and value <= 0.0 and name in ("velocity", "effort"):
            message = f"the limit {name} is {value:.12g}, so the joint could not move"
            accepted = "a number greater than 0, or nothing: then it is computed"
            yield Problem(message=message, field=field, found=f"{value:.12g}", accepted=accepted)
    if bounded and limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
        message = f"the limit lower, {limits.lower:.12g}, is greater than upper, {limits.upper:.12g}"
        yield Problem(message=message, field="limits.lower", found=f"{limits.lower:.12g}", accepted="lower ≤ upper")


def _is_sure_joint(joint: Joint) -> Condition:
    (x, y, z), limits = joint.axis, joint.limits
    sure: Condition = abs(x * x + y * y + z * z - 1.0) <= UNIT  # An axis half as far from 1 passes the rule.
    for number in (limits.velocity, limits.effort):
        if number is not None:
            sure &= number > 0.0
    if limits.lower is not None and limits.upper is not None:
        sure &= limits.lower <= limits.upper
    for name in DYNAMICS:
        number = getattr(joint, name)
        if number is not None:
            sure &= number >= 0.0
    return sure


# Links.


def _body_problems(link: Link, holder: Joint | None, *, is_root: bool) -> Iterator[Problem]:
    """A moving link is a body that can exist; only a frame, held by a fixed joint, may weigh nothing."""
    body = link.inertial
    moves = holder is not None and holder.type is not JointType.FIXED
    name = shown(link.name)
    if body is None or _weighs_nothing(body):
        if moves:
            message = f"link {name} moves and has no mass: simulators drop it, or take it for 1 kg"
            yield Problem(message=message, field="mass", accepted="a mass greater than 0")
        return
    if is_root:
        message = f"the root link {name} has an inertial, which KDL does not use"
        suggestion = "give it to a link that a fixed joint holds on an empty root"
        yield Problem(severity="notice", message=message, field="mass", suggestion=suggestion)
    if not 0.0 < body.mass < math.inf:
        message = f"the mass of link {name} is {body.mass:.12g} kg"
        yield Problem(message=message, field="mass", found=f"{body.mass:.12g}", accepted="a mass greater than 0")
    yield from _finite("com", body.com)
    if broken := inertia_problem(body.inertia):
        yield Problem(message=f"link {name}: {broken}", field="inertia")


def _is_sure_link(link: Link) -> Condition:
    from dh2urdf.columns import columns_of

    sure: Condition = True
    body = link.inertial
    if body and columns_of(body):
        sure &= (body.mass > 0.0) & is_sound(body.inertia)
    shapes: Iterable[Visual | Collision] = (*link.visuals, *link.collisions)
    for shape in shapes:
        for _, size in _sizes(shape.geometry):
            sure &= size > 0.0
    for material in (visual.material for visual in link.visuals if visual.material):
        for part in material.rgba:
            sure &= (part >= 0.0) & (part <= 1.0)
    return sure


def _weighs_nothing(body: Inertial) -> bool:
    """Whether a body is the explicit zero of a frame."""
    return not body.mass and not any(getattr(body.inertia, field.name) for field in fields(body.inertia))


def _weightless_chains(robot: Robot, joint_to: dict[str, Joint]) -> Iterator[Problem]:
    """A frame of zero mass below another one costs sdformat the whole model: its poses become infinite.

    sdformat lumps what fixed joints hold into one body, the outermost first (ReduceFixedJoints of parser_urdf.cc), and
    divides by the mass: a frame that holds a body by fixed joints, as the base_link of an arm on a tool0, has a mass by
    then.
    """
    weightless = {link.name for link in robot.links if link.inertial and _weighs_nothing(link.inertial)}
    bodies = [link.name for link in robot.links if link.inertial and link.name not in weightless]
    laden = set()
    for name in bodies:
        holder = joint_to.get(name)
        while holder and holder.type is JointType.FIXED and holder.parent not in laden:
            laden.add(holder.parent)
            holder = joint_to.get(holder.parent)
    # A base without a mass in a cell is what the tables say; the emitters for Gazebo see to it, and others say so.
    bases = {arm.prefix + arm.kind.root for arm in robot.arms}
    for link in robot.links:
        holder = joint_to.get(link.name)
        if not holder or not bases.isdisjoint({link.name, holder.parent}):
            continue
        if link.name in weightless and link.name not in laden and holder.parent in weightless:
            message = f"link {shown(link.name)} and its parent {shown(holder.parent)} both weigh nothing"
            suggestion = "make both children of a link with a mass, or leave the inertial of one out"
            yield _of_joint(Problem(message=message, field="mass", suggestion=suggestion), holder)


def _shape_problems(link: Link) -> Iterator[Problem]:
    """Sizes are positive and finite, shapes stand somewhere, colours are colours."""
    shapes: Iterable[Visual | Collision] = (*link.visuals, *link.collisions)
    for shape in shapes:
        for what, size in _sizes(shape.geometry):
            if not 0.0 < size < math.inf:
                message = f"the {what} of a shape of link {shown(link.name)} is {size:.12g}"
                yield Problem(message=message, field="geometry", accepted="a size greater than 0")
        yield from _finite("origin", (*shape.origin.xyz, *shape.origin.rpy))
    for material in (visual.material for visual in link.visuals if visual.material):
        if not all(0.0 <= part <= 1.0 for part in material.rgba):
            message = f"the colour of material {shown(material.name)} is out of range"
            yield Problem(message=message, field="material", accepted="red, green, blue, alpha from 0 to 1")


def _sizes(geometry: Geometry) -> tuple[tuple[str, float], ...]:
    match geometry:
        case Box(size=(x, y, z)):
            return (("size along x", x), ("size along y", y), ("size along z", z))
        case Cylinder(radius=radius, length=length):
            return (("radius", radius), ("length", length))
        case Sphere(radius=radius):
            return (("radius", radius),)
        case Mesh(scale=scale):
            # A negative factor is a mirror, which readers take.
            return tuple(("scale", abs(factor)) for factor in scale)


def _finite(field: str, numbers: Iterable[float]) -> Iterator[Problem]:
    culprit = next((number for number in numbers if not math.isfinite(number)), None)
    if culprit is not None:
        yield Problem(message=f"{field} holds {culprit}", field=field, found=str(culprit), accepted="finite numbers")


# Formulas.
