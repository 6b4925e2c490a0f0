"""What is wrong with a YAML document that has not the form of a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable

    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.words.cells import Cell


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
