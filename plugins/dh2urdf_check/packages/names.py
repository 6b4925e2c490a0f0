"""Rules about joints, links and limits that several files of a package name: YAML files of parameters, and SRDFs."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.documents import load_yaml
from dh2urdf.errors import InputError
from dh2urdf.source import Mark, did_you_mean, shown
from dh2urdf_check.packages.package import broken, of_document, parsed
from dh2urdf_plugins.formats.xml_files import mark_of
from dh2urdf_plugins.ros_conventions import CONTROLLER_MANAGER

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.documents import Node
    from dh2urdf.robot import Joint
    from dh2urdf.stages import Finding
    from dh2urdf_check.packages.package import Package

_TAG = re.compile(rb"(?:^|[\s\[{,:])![A-Za-z!<]")
"""A tag, such as xacro's `!degrees`, whose file is for xacro alone."""
_ROS = "ros__parameters"
_PLANNING = ("has_velocity_limits", "has_acceleration_limits", "max_acceleration")
_REALS = ("max_velocity", "max_acceleration", "max_jerk", "min_position", "max_position")
_NEAR = 1e-6
"""How far a number may be outside a limit that was rounded."""


def hits(package: Package) -> Iterator[Finding]:
    """What there is to report of them; of joints only where a description can be read."""
    files: list[Node] = []
    for path in package.files:
        if path.suffix not in {".yaml", ".yml"}:
            continue
        content = package.content(path)
        if content is None or _TAG.search(content):
            continue
        try:
            files.append(load_yaml(content, str(path), InputError))
        except InputError as error:
            problem = error.problems[0]
            yield broken("package-not-yaml", problem.mark or Mark(file=str(path)), problem.message)
    controllers = {name for file in files for name in _ros2_controllers(file)}
    for file in files:
        yield from _controllers(file, package, controllers)
        yield from _limits(file, package)
        yield from _positions(file, package)
    for path in package.files:
        if path.suffix == ".srdf":
            yield from _srdf(path, package)


def _entries(node: Node | None, *keys: str) -> dict[str, Node]:
    """The entries of a mapping inside mappings; none where something else is there."""
    for key in keys:
        node = _entries(node).get(key)
    return node.value if node is not None and isinstance(node.value, dict) else {}


def _words(node: Node | None) -> list[Node]:
    """The names of a list that no launch file fills in."""
    items = node.value if node is not None and isinstance(node.value, list) else []
    return [item for item in items if isinstance(item.value, str) and "$(" not in item.value]


# --- Controllers ------------------------------------------------------------------------------------------------------


def _ros2_controllers(node: Node) -> set[str]:
    manager = _entries(node, "controller_manager", _ROS)
    return {name for name, entry in manager.items() if "type" in _entries(entry)}


def _controllers(node: Node, package: Package, known: set[str]) -> Iterator[Finding]:
    if "controller_manager" in _entries(node):
        for name in _ros2_controllers(node):
            yield from _controller_joints(_entries(node, name, _ROS).get("joints"), name, package)
    manager = _entries(node, CONTROLLER_MANAGER)
    for each in _words(manager.get("controller_names")):
        name = str(each.value)
        if known and name not in known:
            near = did_you_mean(name, known)
            message = f"no controller of ros2_control is called {shown(name)}"
            yield broken("package-unknown-controller", each.mark, f"{message}: {near}" if near else message)
        yield from _controller_joints(_entries(manager.get(name)).get("joints"), name, package)


def _controller_joints(joints: Node | None, controller: str, package: Package) -> Iterator[Finding]:
    for each in _words(joints):
        if missing := _missing(str(each.value), package.joints):
            yield broken("package-controller-joint", each.mark, f"the controller {shown(controller)} moves {missing}")


def _missing(name: str, joints: dict[str, Joint], *, prefixed: bool = False) -> str | None:
    """What is wrong with the name of a joint; None where it is right, or where no description can be read.

    Args:
        name: the name.
        joints: the joints of the descriptions.
        prefixed: whether a macro reads the name and puts its prefix before it.
    """
    if not joints or "$(" in name or name in joints or (prefixed and any(each.endswith(name) for each in joints)):
        return None
    near = did_you_mean(name, joints)
    message = f"the joint {shown(name)}, which the description does not have"
    return f"{message}: {near}" if near else message


# --- Limits and positions ---------------------------------------------------------------------------------------------


def _limits(node: Node, package: Package) -> Iterator[Finding]:
    found = _entries(node).get("joint_limits")
    limits = _entries(found)
    is_for_planning = any(key in _entries(entry) for entry in limits.values() for key in _PLANNING)
    yield from _unknown(found, package, "limits", prefixed=not is_for_planning)
    if found is None or not is_for_planning:
        return
    for name, entry in limits.items():
        yield from _planning(name, _entries(entry), package.joints.get(name))
    for name in package.joints:
        values = _entries(found, name)
        has = values.get("has_acceleration_limits")
        if has is None or has.value is not True or "max_acceleration" not in values:
            mark = found.key_mark(name) if name in limits else found.mark
            yield broken("package-missing-limits", mark, f"the joint {shown(name)} has no acceleration")


def _planning(name: str, values: dict[str, Node], joint: Joint | None) -> Iterator[Finding]:
    for key in _REALS:
        if key in values and type(values[key].value) is int:
            message = f"{key} of the joint {shown(name)} is the whole number {values[key].value}"
            yield broken("package-whole-number", values[key].mark, message)
    velocity = values.get("max_velocity")
    highest = joint.limits.velocity if joint else None
    if velocity is None or highest is None or not isinstance(velocity.value, (int, float)):
        return
    if velocity.value > highest * (1.0 + _NEAR):
        message = f"max_velocity of the joint {shown(name)} is {velocity.value:.9g}, in the description {highest:.9g}"
        yield broken("package-higher-limit", velocity.mark, message)


def _positions(node: Node, package: Package) -> Iterator[Finding]:
    found = _entries(node).get("initial_positions")
    yield from _unknown(found, package, "an initial position", prefixed=True)
    for name, entry in _entries(found).items():
        if isinstance(entry.value, (int, float)) and name in package.joints:
            yield from _outside(entry.value, package.joints[name], entry.mark, "the initial position")


def _unknown(found: Node | None, package: Package, what: str, *, prefixed: bool) -> Iterator[Finding]:
    """The joints of a mapping that the descriptions do not have."""
    for name in _entries(found):
        missing = _missing(name, package.joints, prefixed=prefixed)
        if found is not None and missing:
            yield broken("package-unknown-joint", found.key_mark(name), f"{what} of {missing}")


def _outside(value: float, joint: Joint, mark: Mark, what: str) -> Iterator[Finding]:
    lower, upper = joint.limits.lower, joint.limits.upper
    if lower is not None and upper is not None and not lower - _NEAR <= value <= upper + _NEAR:
        message = f"{what} of the joint {shown(joint.name)} is {value:.9g}, its limits are {lower:.9g} and {upper:.9g}"
        yield broken("package-outside-limits", mark, message)


# --- SRDF -------------------------------------------------------------------------------------------------------------


def _srdf(path: Path, package: Package) -> Iterator[Finding]:
    try:
        root = parsed(package.content(path) or b"", path)
    except etree.XMLSyntaxError as error:
        mark = Mark(file=str(path), line=max(error.position[0], 1))
        yield broken("package-srdf-name", mark, f"this is not XML: {error.msg}")
        return
    name = root.get("name") or ""
    robot = next((each for each in package.robots if each.name == name), None)
    if robot is None:
        if len(package.robots) != 1:
            return
        (robot,) = package.robots
        message = f"the SRDF is of the robot {shown(name)}, the description of {shown(robot.name)}"
        yield broken("package-srdf-robot", mark_of(root), message)
    virtual = [each.get("name") or "" for each in root.iterfind("virtual_joint")]
    links, joints = [link.name for link in robot.links], [*(joint.name for joint in robot.joints), *virtual]
    yield from of_document(root, path, {"$links": links, "$joints": joints})
    moving = {joint.name: joint for joint in robot.moving_joints}
    for each in root.iterfind("group_state/joint"):
        joint, state = moving.get(each.get("name") or ""), each.getparent()
        try:
            value = float(each.get("value") or "")
        except ValueError:  # A joint of several values, or none that can be compared.
            continue
        if joint is not None and state is not None:
            yield from _outside(value, joint, mark_of(each), f"the state {shown(state.get('name') or '')}")
