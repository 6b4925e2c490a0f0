"""What is wrong with a YAML document that has not the form of a table."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.documents import Node


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


def no_robots(robots: Node) -> Problem:
    """Robots that are no list, or an empty one."""
    return Problem(
        message=f"robots is {'an empty list' if isinstance(robots.value, list) else robots.describe()}",
        mark=robots.mark,
        field="robots",
        accepted="a list of manipulators, each with name, convention and joints",
    )
