"""Rules about what a joint declares itself: its type, axis, limits, and whom it follows."""

from __future__ import annotations

import math
from itertools import chain
from typing import TYPE_CHECKING

from dh2urdf.rotations import norm
from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.document.description import ALL, MOVING, TURNING_OR_SLIDING, Hit, few
from dh2urdf_check.numbers import drake_number, drake_numbers, mujoco_numbers
from dh2urdf_check.single_readers.drake import actuated_joints

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description, JointNode
    from dh2urdf_check.document.tree import Element

UNIT = 1e-5
"""How far the length of an axis may be from 1: what rounding to six digits makes of it."""
_SMALLEST_AXIS = {
    "pybullet": 1e-100,
    "mujoco": 1e-6,
    "pinocchio": 1e-100,
    "drake": 1e-8,
    "ros": 1e-100,
    "gazebo": 1e-6,
    "coppeliasim": 1e-100,
}
"""Length of an axis that a reader takes for a direction."""


def hits(description: Description) -> Iterator[Hit]:
    """Findings about every joint."""
    kinds = {joint.name: joint.kind for joint in description.joints}
    static = _static_in_mujoco(description)
    actuated = actuated_joints(description)
    for joint in description.joints:
        of_itself = (
            _type(joint, static),
            _axis(joint),
            _limits(joint, is_actuated=joint.name in actuated),
            _dynamics(joint),
        )
        for hit in chain(*of_itself):
            yield _not_of(hit, "drake") if joint.is_left_out_by_drake else hit
        yield from _mimic(joint, kinds)
    yield from _of_many(description)


def _not_of(hit: Hit, reader: str) -> Hit:
    return hit._replace(of=frozenset(ALL if hit.of is None else hit.of) - {reader})


def _static_in_mujoco(description: Description) -> set[str]:
    """Names of the links that are the world of MuJoCo: what is fixed to it is merged into it, if it may be."""
    compiler = description.root.first("mujoco", "compiler")
    keeps = compiler is not None and compiler.get("fusestatic") == "false"
    if keeps:
        return {root.name for root in description.roots if root.name == "world"}
    return {node.name for root in description.roots for node in description.body(root)}


def _type(joint: JointNode, static: set[str]) -> Iterator[Hit]:
    if joint.kind in {"floating", "planar"}:
        of = ALL - {"mujoco"} if joint.kind == "floating" and joint.parent in static else None
        yield Hit(f"{joint.kind}-joint", joint.element, f"joint {shown(joint.name)} is {joint.kind}", of)


def _axis(joint: JointNode) -> Iterator[Hit]:
    axis = joint.element.first("axis")
    if joint.kind not in MOVING or joint.kind == "floating":
        if axis is not None and axis.get("xyz") is None:
            yield Hit("axis-without-direction", axis, f"the axis of joint {shown(joint.name)} has no xyz", {"mujoco"})
    elif axis is None:
        yield Hit("missing-axis", joint.element, f"joint {shown(joint.name)} has no axis")
    elif axis.get("xyz") is None:
        yield Hit("axis-without-direction", axis, f"the axis of joint {shown(joint.name)} has no xyz")
    elif (numbers := axis.numbers("xyz", 3)) is None:
        text = axis.get("xyz") or ""
        drake = drake_numbers(text)
        read = {"mujoco": mujoco_numbers(text, 3), "drake": drake if len(drake) == len("xyz") else None}
        if of := {reader for reader, xyz in read.items() if xyz and math.hypot(*xyz) < _SMALLEST_AXIS[reader]}:
            yield Hit("axis-zero", axis, f"the axis of joint {shown(joint.name)} is read as 0 from {shown(text)}", of)
    else:
        x, y, z = numbers
        length = norm((x, y, z))
        if of := {reader for reader, smallest in _SMALLEST_AXIS.items() if length < smallest}:
            yield Hit("axis-zero", axis, f"the axis of joint {shown(joint.name)} has the length {length:g}", of)
        elif abs(length - 1.0) > UNIT:
            yield Hit("axis-not-unit", axis, f"the axis of joint {shown(joint.name)} has the length {length:.6g}")
        if z < 0.0 and not (x or y):
            yield Hit("axis-along-minus-z", axis, f"the axis of joint {shown(joint.name)} is exactly -z")


def _limits(joint: JointNode, *, is_actuated: bool) -> Iterator[Hit]:
    limit, about = joint.element.first("limit"), f"joint {shown(joint.name)}"
    needs_range = joint.kind in {"revolute", "prismatic"}
    if limit is None:
        if needs_range:
            yield Hit("missing-limit", joint.element, f"{about} is {joint.kind} and has no limit")
        return
    if joint.kind in MOVING:
        missing = [name for name in ("lower", "upper") if limit.get(name) is None]
        if needs_range and missing:
            yield Hit("missing-range", limit, f"the limit of {about} has no {' and no '.join(missing)}")
    for name in ("effort", "velocity"):
        if limit.get(name) is None:
            yield Hit(f"missing-{name}", limit, f"the limit of {about} has no {name}")
        elif joint.kind in MOVING:
            not_read = {"drake"} if name == "effort" and not is_actuated else set[str]()
            yield from _negative(limit, name, about, ALL - not_read)
    if joint.kind in TURNING_OR_SLIDING:
        yield from _range(joint, limit)


def _range(joint: JointNode, limit: Element) -> Iterator[Hit]:
    about, needs_range = f"joint {shown(joint.name)}", joint.kind in {"revolute", "prismatic"}
    lower, upper = drake_number(limit.get("lower")), drake_number(limit.get("upper"))
    if lower is None or upper is None:
        return
    is_plain = None not in {limit.number("lower"), limit.number("upper")}
    if lower > upper:
        of = None if needs_range and is_plain else {"drake"}
        yield Hit("swapped-limits", limit, f"{about} has lower {lower:g} and upper {upper:g}", of)
    elif lower == upper and needs_range and is_plain:
        yield Hit("equal-limits", limit, f"{about} has lower and upper {lower:g}")


def _negative(element: Element, name: str, about: str, readers: frozenset[str]) -> Iterator[Hit]:
    """Findings about a number that may not be below 0; Drake alone reads the number that another text begins with."""
    value = drake_number(element.get(name))
    of = readers if element.number(name) is not None else readers & {"drake"}
    if value is not None and value < 0.0 and of:
        yield Hit(f"negative-{name}", element, f"the {name} of {about} is {value:g}", of)


def _dynamics(joint: JointNode) -> Iterator[Hit]:
    about = f"joint {shown(joint.name)}"
    if dynamics := joint.element.first("dynamics"):
        if dynamics.get("damping") is None and dynamics.get("friction") is None:
            yield Hit("empty-dynamics", dynamics, f"the dynamics of {about} have neither damping nor friction")
        for name in ("damping", "friction") if joint.kind in MOVING else ():
            yield from _negative(dynamics, name, about, ALL)
    safety = joint.element.first("safety_controller")
    if safety and safety.get("k_velocity") is None:
        yield Hit("safety-without-velocity", safety, f"the safety controller of {about} has no k_velocity")


def _mimic(joint: JointNode, kinds: dict[str, str]) -> Iterator[Hit]:
    if (mimic := joint.element.first("mimic")) is None:
        return
    leader = mimic.get("joint")
    if leader is None:
        of = ALL - {"pybullet", "mujoco"} if joint.kind == "fixed" else None
        yield Hit("mimic-without-joint", mimic, f"joint {shown(joint.name)} follows no joint", of)
        return
    message = f"joint {shown(joint.name)} follows joint {shown(leader)}"
    if leader == joint.name:
        yield Hit("mimic-itself", mimic, message, {"drake"} if joint.kind == "fixed" else None)
        return
    if leader not in kinds:
        near = did_you_mean(leader, kinds)
        message = f"{message}, and there is no such joint"
        yield Hit("mimic-undefined", mimic, f"{message}: {near}" if near else message)
        return
    is_fixed, leader_is_fixed = joint.kind == "fixed", kinds[leader] == "fixed"
    if is_fixed and not leader_is_fixed:
        yield Hit("mimic-while-fixed", mimic, f"{message}, and is fixed")
    elif leader_is_fixed and not is_fixed:
        of = ALL - {"drake"} if joint.kind == "floating" else None  # Drake leaves it out, with its mimic.
        yield Hit("mimic-of-fixed", mimic, f"{message}, which is fixed", of)
    elif not is_fixed and {joint.kind, kinds[leader]} & {"floating", "planar"}:
        yield Hit(
            "mimic-of-fixed",
            mimic,
            f"{message}, and they are {joint.kind} and {kinds[leader]}",
            _minding(joint, kinds[leader]),
        )
    elif not is_fixed:
        yield Hit("mimic-joint", mimic, message)


def _minding(joint: JointNode, leader: str) -> set[str]:
    """The readers that mind a joint that follows another, where one of them is floating or planar."""
    is_left_out = joint.kind == "floating" and leader != "floating"  # by Drake, with its mimic
    takes = is_left_out or (joint.kind == leader and leader != "floating")
    return {"mujoco"} if takes else {"mujoco", "drake"}


def _of_many(description: Description) -> Iterator[Hit]:
    """Findings that are reported once, for all joints that they are true of."""
    outside = [limit for joint in description.joints if (limit := _limit_beside_zero(joint))]
    rubbing = [
        (joint, dynamics)
        for joint in description.joints
        if (dynamics := joint.element.first("dynamics")) and dynamics.number("friction")
    ]
    endless = [(joint, joint.element) for joint in description.joints if joint.kind == "continuous"]
    for rule, found, what in (
        ("zero-outside-limits", outside, "0 is outside the limits of"),
        ("joint-friction", rubbing, "there is friction in"),
        ("continuous-joint", endless, "without limits turn"),
    ):
        if found:
            yield Hit(rule, found[0][1], f"{what} {few(joint.name for joint, _ in found)}")


def _limit_beside_zero(joint: JointNode) -> tuple[JointNode, Element] | None:
    limit = joint.element.first("limit")
    if limit is None or joint.kind not in TURNING_OR_SLIDING or joint.kind == "continuous":
        return None
    lower, upper = limit.number("lower"), limit.number("upper")
    if lower is None or upper is None or lower <= 0.0 <= upper or lower > upper:
        return None
    return joint, limit
