"""The rules that a finished robot must keep, whatever made it.

No reader of robot descriptions is a validator: what one refuses, another reads in silence and simulates as something
else, or crashes on. So every robot is checked before it is written. Each rule below stands for a fault that was seen
to go wrong in PyBullet, MuJoCo, Pinocchio, Drake, urdfdom or sdformat.
"""

from __future__ import annotations

import math
import re
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import BOUNDS, DYNAMICS, LIMITS
from dh2urdf.kinematics.mass import inertia_problem, is_sound, tensor
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf.rotations import norm
from dh2urdf.source import Messages, Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.robot import Geometry, Inertial, Joint, Link, Robot
    from dh2urdf.rotations import Condition

say = Messages(__file__)

LONGEST_NAME = 1000
"""Characters of a name: PyBullet crashes on longer ones, or cuts them."""

_FUNCTIONS = frozenset({"abs", "max", "min", "sin", "cos", "atan2"})
"""The functions that formulas may use."""
_IDENTIFIER = r"(?<![\w.])[^\W\d]\w*"
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
    foreign, followers = robot.foreign_names, robot.followers
    for joint in robot.joints:
        problems += _joint_problems(joint, is_foreign=joint.name in foreign)
        if joint.follows and joint.name not in followers:
            problems.append(_problem(joint, "joint-follows-nothing", "follows", found=joint.follows.leader))
    for link in robot.links:
        problems += _body_problems(link, joint_to.get(link.name), is_foreign=link.name in foreign)
        problems += _shape_problems(link, joint_to.get(link.name))
    bases = _weightless_bases(robot, joint_to) if robot.floating else ()
    problems += [*_weightless_chains(robot, joint_to), *bases, *_formula_problems(robot)]
    if robot.arms and all(problem.severity == "notice" for problem in problems):
        from dh2urdf.robot_check.contacts import arm_overlaps

        problems += arm_overlaps(robot)
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
    foreign = robot.foreign_names  # All have them alike.
    with np.errstate(all="ignore"):
        for joint in robot.joints:
            if joint.name not in foreign:
                sure &= _is_sure_joint(joint)
        for link in robot.links:
            if link.inertial and columns_of(link.inertial):
                sure &= (link.inertial.mass > 0.0) & is_sound(link.inertial.inertia)
            for shape in link.shapes:
                for size in _sizes(shape.geometry).values():
                    sure &= size > 0.0
            for part in (part for visual in link.visuals if visual.material for part in visual.material.rgba):
                sure &= (part >= 0.0) & (part <= 1.0)
    if sure.any():
        index = int(sure.argmax())
        sure &= not check_robot(replace(member(robot, index), name=names[index]))
    return sure


def _is_sure_joint(joint: Joint) -> Condition:
    (x, y, z), limits = joint.axis, joint.limits
    sure: Condition = abs(x * x + y * y + z * z - 1.0) <= UNIT  # An axis half as far from 1 passes the rule.
    for number in (getattr(limits, name) for name in LIMITS if name not in BOUNDS):
        if number is not None:
            sure &= number > 0.0
    if limits.lower is not None and limits.upper is not None:
        sure &= limits.lower <= limits.upper
    for number in (getattr(joint, name) for name in DYNAMICS):
        if number is not None:
            sure &= number >= 0.0
    return sure


def _problem(joint: Joint | None, code: str, field: str | None = None, **about: Any) -> Problem:  # noqa: ANN401 - of a message
    """A problem with the name and the place of a joint; that of a link is the joint that moves it."""
    of_joint: dict[str, Any] = {} if joint is None else {"joint": joint.name, "mark": joint.mark}
    return say(code, field=field, **of_joint, **about)


# Names.


def _name_problems(robot: Robot, joint_to: dict[str, Joint]) -> Iterator[Problem]:
    """Names are there, short enough, writable, and no two are the same: links and joints share one set."""
    owners: dict[str, str] = {}
    foreign = robot.foreign_names
    named = [("link", link.name, joint_to.get(link.name)) for link in robot.links]
    named += [("joint", joint.name, joint) for joint in robot.joints]
    troublesome = []
    for kind, name, joint in named:
        if not name.strip():
            yield _problem(joint, "name-missing", kind, found=name, what=f"a {kind}")
        elif len(name) > LONGEST_NAME:
            yield _problem(joint, "name-too-long", kind, found=name, kind=kind, count=len(name), most=LONGEST_NAME)
        elif not (name.isascii() and name.isprintable()) and (culprit := re.search(_NOT_IN_NAMES, name)):
            number = ord(culprit.group())
            yield _problem(joint, "name-unwritable", kind, found=name, kind=kind, number=number)
        elif name in foreign and owners.get(name) not in {None, kind}:
            yield _problem(joint, "name-of-both", kind, found=name)
        elif name in owners:
            yield _problem(joint, "name-taken", kind, found=name, kind=kind, owner=owners[name])
        elif not (name.isascii() and name.replace("-", "_").isidentifier()) and re.search(_TROUBLESOME, name):
            troublesome.append(name)
        owners.setdefault(name, kind)
    if not robot.name.strip():
        yield say("name-missing", field="name", what="the robot")
    if troublesome:
        few = ", ".join(map(shown, troublesome[:3]))
        yield say("names-troublesome", count=len(troublesome), names=few)


# The tree.


def _tree_problems(robot: Robot, joint_to: dict[str, Joint]) -> Iterator[Problem]:
    """One root, from which every link is reached by one way."""
    names = {link.name for link in robot.links}
    for joint in robot.joints:
        for role, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in names:
                near = did_you_mean(link, names)
                yield _problem(joint, "end-is-no-link", role, found=link, role=role, suggestion=near)
        if joint_to[joint.child] is not joint:
            yield _problem(joint, "two-parents", "child", link=joint.child, other=joint_to[joint.child].name)
    roots = [link.name for link in robot.links if link.name not in joint_to]
    lost = []
    if len(roots) == 1:
        reached = _reached(robot, roots[0])
        lost = [link.name for link in robot.links if link.name not in reached]
    few = ", ".join(map(shown, (lost or roots)[:5]))
    if not robot.links:
        yield say("no-links")
    elif not roots:
        yield say("no-root")
    elif len(roots) > 1:
        yield say("several-roots", count=len(roots), links=few)
    elif lost:
        yield say("links-in-circle", root=roots[0], links=few)


def _reached(robot: Robot, root: str) -> set[str]:
    """The links that are below the root; without recursion, for arms may have thousands of joints."""
    below: dict[str, list[str]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint.child)
    reached, ahead = {root}, [root]
    while ahead:
        for child in below.get(ahead.pop(), ()):
            if child not in reached:
                reached.add(child)
                ahead.append(child)
    return reached


# Joints.


def _joint_problems(joint: Joint, *, is_foreign: bool) -> Iterator[Problem]:
    """Origin finite, axis of length 1, limits complete and in order, friction and armature not negative.

    The limits of a foreign joint are its maker's business.
    """
    yield from _finite(joint, "origin", (*joint.origin.xyz, *joint.origin.rpy))
    length = norm(joint.axis)
    if joint.type is not JointType.FIXED and not abs(length - 1.0) <= UNIT:
        yield _problem(joint, "axis-not-unit", "axis", length=length)
    limits = joint.limits
    bounded = joint.type in (JointType.REVOLUTE, JointType.PRISMATIC) and not is_foreign
    moving = joint.type is not JointType.FIXED
    needed = {"lower": bounded, "upper": bounded, "velocity": moving, "effort": moving}
    for name in () if is_foreign else LIMITS:
        value, field = getattr(limits, name), f"limits.{name}"
        is_needed = needed.get(name, moving and value is not None)
        if is_needed is (value is None):
            code = "limit-missing" if is_needed else "limit-needless"
            yield _problem(joint, code, field, type=joint.type.value, name=name)
        elif value is not None and not math.isfinite(value):
            yield _problem(joint, "limit-infinite", field, found=str(value), name=name)
        elif value is not None and value <= 0.0 and name not in BOUNDS:
            yield _problem(joint, "limit-not-above-0", field, found=f"{value:.12g}", name=name)
    if bounded and limits.lower is not None and limits.upper is not None and limits.lower > limits.upper:
        about = {"found": f"{limits.lower:.12g}", "upper": limits.upper}
        yield _problem(joint, "limits-exchanged", "limits.lower", **about)
    for name in DYNAMICS:
        value = getattr(joint, name)
        if value is not None and not 0.0 <= value < math.inf:
            yield _problem(joint, "number-negative", name, found=f"{value:.12g}", name=name)


# Links.


def _body_problems(link: Link, holder: Joint | None, *, is_foreign: bool) -> Iterator[Problem]:
    """A moving link is a body that can exist; only a frame, held by a fixed joint, may weigh nothing.

    Attachments have notices about inertias that no body has.
    """
    body = link.inertial
    if body is None or _weighs_nothing(body):
        if holder is not None and holder.type is not JointType.FIXED:
            yield _problem(holder, "moves-without-mass", "mass", link=link.name)
        return
    if holder is None:
        yield _problem(None, "root-with-mass", "mass", link=link.name)
    if not 0.0 < body.mass < math.inf:
        yield _problem(holder, "mass-not-above-0", "mass", found=f"{body.mass:.12g}", link=link.name)
    yield from _finite(holder, "com", body.com)
    if not is_foreign and (broken := inertia_problem(body.inertia)):
        yield _problem(holder, "inertia-impossible", "inertia", link=link.name, reason=broken)


def _weighs_nothing(body: Inertial) -> bool:
    """Whether a body is the explicit zero of a frame."""
    return not body.mass and not any(tensor(body.inertia))


def _weightless_chains(robot: Robot, joint_to: dict[str, Joint]) -> Iterator[Problem]:
    """A frame of zero mass below another one costs sdformat the whole model: its poses become infinite.

    sdformat lumps what fixed joints hold into one body, the outermost first (ReduceFixedJoints of parser_urdf.cc), and
    divides by the mass: a frame that holds a body by fixed joints, as the base_link of an arm on a tool0, has a mass by
    then.
    """
    weightless = {link.name for link in robot.links if link.inertial and _weighs_nothing(link.inertial)}
    laden = set()
    for link in robot.links:
        holder = joint_to.get(link.name) if link.inertial and link.name not in weightless else None
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
            yield _problem(holder, "two-weigh-nothing", "mass", link=link.name, parent=holder.parent)


def _weightless_bases(robot: Robot, joint_to: dict[str, Joint]) -> Iterator[Problem]:
    """What floats moves: with its own links that fixed joints hold to it, it has a mass."""
    wholes = [(each.prefix, each.robot) for each in robot.attachments]
    wholes += [(arm.prefix, arm.kind) for arm in robot.arms]
    for prefix, whole in wholes:
        weighing = {link.name for link in whole.links if link.inertial and link.inertial.mass}
        for joint in reversed(whole.held_rigidly):  # Children before parents.
            if joint.child in weighing:
                weighing.add(joint.parent)
        root = prefix + whole.root
        if root in robot.floating and whole.root not in weighing:
            yield _problem(joint_to.get(root), "moves-without-mass", "mass", link=root)


def _shape_problems(link: Link, holder: Joint | None) -> Iterator[Problem]:
    """Sizes are positive and finite, shapes stand somewhere, colours are colours."""
    for shape in link.shapes:
        for what, size in _sizes(shape.geometry).items():
            if not 0.0 < size < math.inf:
                yield _problem(holder, "size-not-above-0", "geometry", what=what, link=link.name, size=size)
        yield from _finite(holder, "origin", (*shape.origin.xyz, *shape.origin.rpy))
    for material in (visual.material for visual in link.visuals if visual.material):
        if not all(0.0 <= part <= 1.0 for part in material.rgba):
            yield _problem(holder, "colour-out-of-range", "material", material=material.name)


def _sizes(geometry: Geometry) -> dict[str, float]:
    match geometry:
        case Box(size=sizes):
            return {f"size along {axis}": size for axis, size in zip("xyz", sizes, strict=True)}
        case Cylinder(radius=radius, length=length):
            return {"radius": radius, "length": length}
        case Sphere(radius=radius):
            return {"radius": radius}
        case Mesh(scale=scale):
            # A negative factor is a mirror, which readers take.
            return {f"scale along {axis}": abs(factor) for axis, factor in zip("xyz", scale, strict=True)}


def _finite(joint: Joint | None, field: str, numbers: Iterable[float]) -> Iterator[Problem]:
    for number in numbers:
        if not math.isfinite(number):
            yield _problem(joint, "numbers-infinite", field, found=str(number))
            return


# Formulas.


def _formula_problems(robot: Robot) -> Iterator[Problem]:
    """Formulas use the robot's parameters, each declared once with a finite number, and the known functions."""
    declared: set[str] = set()
    for parameter in robot.parameters:
        if parameter.name in declared or not math.isfinite(parameter.value):
            code = "parameter-twice" if parameter.name in declared else "parameter-infinite"
            yield say(code, joint=parameter.joint, field=parameter.name, value=parameter.value)
        declared.add(parameter.name)
    shapes = [shape for link in robot.links for shape in link.shapes]
    origins = [joint.origin for joint in robot.joints] + [shape.origin for shape in shapes]
    formulas: list[str] = []
    for origin in origins:
        formulas += (*(origin.xyz_formula or ()), *(origin.rpy_formula or ()))
    for shape in shapes:
        match shape.geometry:
            case Box(size_formula=(x, y, z)):
                formulas += (x, y, z)
            case Cylinder(length_formula=str(length)):
                formulas.append(length)
    unknown = {*re.findall(_IDENTIFIER, " ".join(formulas))} - declared - _FUNCTIONS
    for formula in formulas if unknown else ():
        for name in dict.fromkeys(re.findall(_IDENTIFIER, formula)):
            if name in unknown:
                yield say("formula-name-unknown", found=name, formula=formula, functions=sorted(_FUNCTIONS))
