"""Rules about names that nothing has: of attributes, of leaders, and of joints and links in extensions."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.document.description import Hit, few

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description
    from dh2urdf_check.document.tree import Element

ATTRIBUTES = {
    "link": ("name", "type"),
    "joint": ("name", "type"),
    "origin": ("xyz", "rpy", "quat_xyzw"),
    "axis": ("xyz",),
    "parent": ("link",),
    "child": ("link",),
    "limit": ("lower", "upper", "effort", "velocity", "acceleration", "jerk", "deceleration"),
    "dynamics": ("damping", "friction"),
    "mimic": ("joint", "multiplier", "offset"),
    "mass": ("value",),
    "inertia": ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"),
    "box": ("size",),
    "cylinder": ("radius", "length"),
    "sphere": ("radius",),
    "mesh": ("filename", "scale"),
}
"""The attributes of each element, with those that a newer urdfdom or another reader has."""
_READ = ("link", "joint")
_CONTROLS = ("ros2_control", "transmission")


def hits(description: Description) -> Iterator[Hit]:
    """Findings about names."""
    for child in description.root.children:
        if child.tag in _READ:
            for element in child.walk():
                yield from _attributes(element)
    yield from _circles(description)
    joints = {joint.name for joint in description.joints if joint.name}
    for child in description.root.children:
        if child.tag in _CONTROLS:
            yield from _joints_of(child, joints)
        elif child.tag == "gazebo" and (name := child.get("reference")):
            yield from _missing(child, name, joints | set(description.link), "the reference of a gazebo element")


def _attributes(element: Element) -> Iterator[Hit]:
    known = ATTRIBUTES.get(element.tag, ())
    for name in element.attributes if known else ():
        if name in known:
            continue
        if near := did_you_mean(name, [other for other in known if element.get(other) is None]):
            yield Hit("unknown-attribute", element, f"{element.tag} has no attribute {shown(name)}: {near}")


def _circles(description: Description) -> Iterator[Hit]:
    leaders = {
        joint.name: mimic.get("joint") or ""
        for joint in description.joints
        if (mimic := joint.element.first("mimic")) is not None and mimic.get("joint") != joint.name
    }
    seen = set[str]()
    for joint in description.joints:
        path: dict[str, int] = {}
        name = joint.name
        while name in leaders and name not in path and name not in seen:
            path[name] = len(path)
            name = leaders[name]
        if name in path:
            circle = list(path)[path[name] :]
            yield Hit("mimic-circle", joint.element, f"the joints {few(circle)} follow each other in a circle")
        seen.update(path)


def _joints_of(control: Element, joints: set[str]) -> Iterator[Hit]:
    for element in control.children:
        if element.tag == "joint" and (name := element.get("name")):
            yield from _missing(element, name, joints, f"a joint of a {control.tag}")


def _missing(element: Element, name: str, known: set[str], what: str) -> Iterator[Hit]:
    if name not in known:
        near = did_you_mean(name, known)
        message = f"{what} is {shown(name)}, which is not there"
        yield Hit("reference-to-nothing", element, f"{message}: {near}" if near else message)
