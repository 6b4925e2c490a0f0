"""Rules about what a joint says of itself: its type, axis, limits, and whom it follows."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.rotations import norm
from dh2urdf.source import did_you_mean, shown
from dh2urdf_plugins.lint.description import MOVING, TURNING_OR_SLIDING, Hit, few

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_plugins.lint.description import Description, JointNode
    from dh2urdf_plugins.lint.tree import Element

UNIT = 1e-5
"""How far the length of an axis may be from 1 [1]: what rounding to six digits makes of it."""
_SMALLEST_AXIS = 1e-10


def hits(description: Description) -> Iterator[Hit]:
    """What there is to say of every joint."""
    kinds = {joint.name: joint.kind for joint in description.joints}
    for joint in description.joints:
        yield from _type(joint)
        yield from _axis(joint)
        yield from _limits(joint)
        yield from _mimic(joint, kinds)
    yield from _of_many(description)


def _type(joint: JointNode) -> Iterator[Hit]:
    if joint.kind in {"floating", "planar"}:
        yield Hit(f"{joint.kind}-joint", joint.element, f"joint {shown(joint.name)} is {joint.kind}")


def _axis(joint: JointNode) -> Iterator[Hit]:
    if joint.kind not in MOVING or joint.kind == "floating":
        return
    axis = joint.element.first("axis")
    if axis is None or axis.get("xyz") is None:
        yield Hit("missing-axis", axis or joint.element, f"joint {shown(joint.name)} has no axis")
    elif numbers := axis.numbers("xyz", 3):
        x, y, z = numbers
        length = norm((x, y, z))
        if length < _SMALLEST_AXIS:
            yield Hit("axis-zero", axis, f"the axis of joint {shown(joint.name)} has the length 0")
        elif abs(length - 1.0) > UNIT:
            yield Hit("axis-not-unit", axis, f"the axis of joint {shown(joint.name)} has the length {length:.6g}")
        if z < 0.0 and not (x or y):
            yield Hit("axis-along-minus-z", axis, f"the axis of joint {shown(joint.name)} is exactly -z")


def _limits(joint: JointNode) -> Iterator[Hit]:
    limit, about = joint.element.first("limit"), f"joint {shown(joint.name)}"
    needs_range = joint.kind in {"revolute", "prismatic"}
    if limit is None:
        if needs_range:
            yield Hit("missing-limit", joint.element, f"{about} is {joint.kind} and has no limit")
        return
    if joint.kind not in MOVING:
        return
    missing = [name for name in ("lower", "upper") if limit.get(name) is None]
    if needs_range and missing:
        yield Hit("missing-range", limit, f"the limit of {about} has no {' and no '.join(missing)}")
    for name in ("effort", "velocity"):
        if limit.get(name) is None:
            yield Hit(f"missing-{name}", limit, f"the limit of {about} has no {name}")
    lower, upper = limit.number("lower"), limit.number("upper")
    if needs_range and lower is not None and upper is not None and lower > upper:
        yield Hit("swapped-limits", limit, f"{about} has lower {lower:g} and upper {upper:g}")


def _mimic(joint: JointNode, kinds: dict[str, str]) -> Iterator[Hit]:
    if (mimic := joint.element.first("mimic")) is None:
        return
    leader = mimic.get("joint") or ""
    message = f"joint {shown(joint.name)} follows joint {shown(leader)}"
    if leader not in kinds:
        near = did_you_mean(leader, kinds)
        message = f"{message}, and there is no such joint"
        yield Hit("mimic-undefined", mimic, f"{message}: {near}" if near else message)
        return
    is_fixed, leader_is_fixed = joint.kind == "fixed", kinds[leader] == "fixed"
    if is_fixed and not leader_is_fixed:
        yield Hit("mimic-while-fixed", mimic, f"{message}, and is fixed")
    elif leader_is_fixed and not is_fixed:
        yield Hit("mimic-of-fixed", mimic, f"{message}, which is fixed")
    elif not is_fixed:
        yield Hit("mimic-joint", mimic, message)


def _of_many(description: Description) -> Iterator[Hit]:
    """What is said once, of all joints that it is true of."""
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
