"""The robot of a description, as far as it can be read: to compare its kinematics, whatever else is wrong with it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.manipulator import JOINT_TYPES, JointType, Limits
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import X_AXIS, Z_AXIS, ZERO, norm, scale
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from dh2urdf.rotations import Vec3
    from dh2urdf_check.document.description import Description, JointNode
    from dh2urdf_check.document.tree import Element


def robot_of(description: Description) -> Robot | None:
    """Links and joints without bodies and shapes; None where there is no tree of them.

    An axis is made a unit vector, as readers do. A joint is left out where a chain cannot lead over it: it is of no
    type of a manipulator, lacks a link, has no direction, or a text in it is not the number that it should be.
    """
    if not description.roots:
        return None
    joints = [joint for node in description.joints if (joint := _joint(node, description))]
    first: dict[str, Joint] = {}
    for joint in joints:
        first.setdefault(joint.child, joint)
    root = description.roots[0].name
    names = [root, *(name for name in description.link if name != root)]
    return Robot(
        name=description.root.get("name") or "",
        links=tuple(Link(name=name) for name in names),
        joints=tuple(first.values()),
    )


def _joint(node: JointNode, description: Description) -> Joint | None:
    kind = JOINT_TYPES.get(node.kind)
    origin = _origin(node.element.first("origin"))
    axis = Z_AXIS if kind is JointType.FIXED else _direction(node.element.first("axis"))
    if kind is None or origin is None or axis is None or not {node.parent, node.child} <= description.link.keys():
        return None
    limit = node.element.first("limit")
    return Joint(
        name=node.name,
        type=kind,
        parent=node.parent,
        child=node.child,
        origin=origin,
        axis=axis,
        limits=Limits(lower=limit.number("lower"), upper=limit.number("upper")) if limit else Limits(),
        mark=Mark(file=str(description.path), line=node.element.line, column=node.element.column),
    )


def _origin(element: Element | None) -> Origin | None:
    if element is None:
        return Origin()
    xyz, rpy = _vector(element, "xyz", ZERO), _vector(element, "rpy", ZERO)
    return None if xyz is None or rpy is None else Origin(xyz=xyz, rpy=rpy)


def _direction(element: Element | None) -> Vec3 | None:
    axis = X_AXIS if element is None else _vector(element, "xyz", X_AXIS)
    length = norm(axis) if axis else 0.0
    return scale(1.0 / length, axis) if axis and length else None


def _vector(element: Element, attribute: str, default: Vec3) -> Vec3 | None:
    if element.get(attribute) is None:
        return default
    numbers = element.numbers(attribute, 3)
    return (numbers[0], numbers[1], numbers[2]) if numbers else None
