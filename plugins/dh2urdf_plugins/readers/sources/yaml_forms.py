"""What is wrong with a YAML document that has not the form of a table."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.source import Problem
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.tables.cell_groups import PARTS

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.words.cells import Cell

NOT_IN_A_JOINT = ("robot", "convention")
"""Fields that a table of one manipulator has no column for."""
_JOINTS = "write `joints:`, a list with one mapping for each joint, such as {a: 0, alpha: pi/2, d: 0.1}"
_WORDS = {
    _JOINTS: "links, link, joint, dh, dh_params, dh_parameters, dh_table, parameters, params, rows, table, chain, "
    "axes, axis, a, r, d, alpha, theta",
    "write `units: {length: mm}`": "length_unit, lengths, unit_length, length",
    "write `units: {angle: deg}`": "angle_unit, angles, unit_angle, angle, degrees, radians",
    "write `units: {length: mm, angle: deg}`": "unit",
    "write `name:`": "robot, robot_name, model, manipulator, arm, id, title",
    "write `convention: standard`, or `modified`": "dh_convention, type, dh_type, notation, method, modified, mdh",
    "write `tool: {xyz: [0, 0, 0.1]}`": "tcp, ee, end_effector, endeffector, flange, tool0, tool_frame, gripper",
    "write `base: {xyz: [0, 0, 0.3]}`": "base_frame, origin, mount, world",
}
MEANT = {word: advice for advice, words in _WORDS.items() for word in words.split(", ")}
"""What to write in place of other words for the keys of a manipulator."""


def with_full_names(node: Node) -> Node:
    """A mapping of bounds or coordinates with the names of their fields: ``min`` is ``lower``, ``x`` is ``com_x``."""
    if not isinstance(node.value, dict) or PARTS.keys().isdisjoint(node.value):
        return node
    names = {key: name for key in node.value if (name := PARTS.get(key, key)) == key or name not in node.value}
    value = {names.get(key, key): item for key, item in node.value.items()}
    places = {names.get(key, key): place for key, place in node.key_places.items()}
    return replace(node, value=value, key_places=places)


def as_entries(joints: Node) -> str | None:
    """How to write joints that are a mapping by their names, which has no order."""
    entries = joints.value if isinstance(joints.value, dict) else {}
    name = next((key for key, item in entries.items() if isinstance(item.value, dict)), None)
    return f"write each name in its entry: `- {{name: {name}, a: 0, alpha: pi/2, d: 0.1}}`" if name else None


def in_the_joint(node: Node) -> str | None:
    """What to do about the value of an unknown key of a joint that is a mapping of the joint's own keys."""
    entries = node.value if isinstance(node.value, dict) else {}
    known = [key for key in entries if joint_field(key)]
    return f"write its keys in the joint itself: {', '.join(known)}" if known else None


def no_mapping(root: Node, keys: Iterable[str]) -> Problem:
    """A document, or one of the manipulators in it, that is no mapping.

    Args:
        root: what it is.
        keys: the keys of a manipulator.
    """
    commas = isinstance(root.value, str) and "," in root.value
    return Problem(
        message=f"a table is a mapping with the key joints, and this is {root.describe()}",
        mark=root.mark,
        accepted=f"the keys {', '.join(keys)}, or robots with a list of such mappings",
        suggestion="this looks like CSV: give the file the suffix .csv" if commas else None,
    )


def other_reader(root: Node) -> Problem | None:
    """A mapping that is no table, and that another reader of YAML files reads; None for any other.

    Args:
        root: the mapping.
    """
    entries = root.value if isinstance(root.value, dict) else {}
    for name, what, is_it in _OTHERS:
        if is_it(entries):
            return Problem(
                message=f"this is {what}, not a table",
                mark=root.mark,
                accepted="a mapping with the key joints",
                suggestion=f"`--from {name}` reads it; in a run file, `stage: {name}` beside the path",
            )
    return None


def _is_mapping_with(node: Node | None, key: str) -> bool:
    return node is not None and isinstance(node.value, dict) and key in node.value


_OTHERS: tuple[tuple[str, str, Callable[[dict[str, Node]], bool]], ...] = (
    (
        "ur-kinematics",
        "a calibration of Universal Robots' ROS packages",
        lambda entries: _is_mapping_with(entries.get("kinematics"), "shoulder"),
    ),
    (
        "franka-kinematics",
        "a kinematics.yaml of Franka's ROS package",
        lambda entries: _is_mapping_with(entries.get("joint1"), "kinematic"),
    ),
    (
        "screws",
        "a file of screw axes",
        lambda entries: any(key in entries for key in ("Slist", "Blist")) or ("H" in entries and "P" in entries),
    ),
)
"""Readers of other YAML files: name, what they read, and how it is recognized."""


def no_robots(robots: Node) -> Problem:
    """Robots that are no list, or an empty one."""
    return Problem(
        message=f"robots is {'an empty list' if isinstance(robots.value, list) else robots.describe()}",
        mark=robots.mark,
        field="robots",
        accepted="a list of manipulators, each with name, convention and joints",
    )


def unused_default(name: str, cell: Cell) -> Problem:
    """A default that no joint takes, as a notice."""
    message = f"defaults.{name} has no effect: every joint has a value of its own"
    return Problem(message=message, severity="notice", mark=cell.mark, field=f"defaults.{name}", found=cell.text)


def joint_field(key: str) -> str | None:
    """The field, or the group of fields, that a key of a joint means."""
    header = read_header(key)
    if header.field is None or header.unit or header.field.name in NOT_IN_A_JOINT:
        return None
    return header.field.name
