"""Names that ROS accepts: of packages (REP 144), links and joints."""

from __future__ import annotations

import re
import unicodedata
from typing import TYPE_CHECKING

from dh2urdf.errors import EmitterError
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.ros_conventions import PACKAGE_NAME

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.robot import Robot

_NAME = re.compile(r"[A-Za-z0-9_-]+")
_NODE = re.compile(r"(?:[A-Za-z_][A-Za-z0-9_]*)?")
_SHORTEST = 2
_SUFFIX = "_description"


def package_stem(stem: str, package: str) -> str:
    """What the names of a robot's packages begin with: as `robot_name` has it, allowed or not."""
    return package.removesuffix(_SUFFIX) or stem


def robot_name(stem: str, package: str) -> str:
    """The name of a robot in the names of its packages.

    Args:
        stem: the robot's own name, as file names have it.
        package: the option, which may be the name of the whole package; empty where it is not given.

    Raises:
        EmitterError: REP 144 does not allow the name; the error proposes another.
    """
    name = package_stem(stem, package)
    if PACKAGE_NAME.fullmatch(name) and len(name) >= _SHORTEST:
        return name
    message = f"a ROS package cannot be named {shown(f'{name}{_SUFFIX}')}"
    raise EmitterError(
        Problem(
            message=message,
            found=name,
            field="package",
            accepted="two or more lower-case letters, digits and single `_`; the first is a letter (REP 144)",
            suggestion=f"set the option `package: {proposed_name(name)}`",
        )
    )


def proposed_name(name: str) -> str:
    """The name that REP 144 allows and that is nearest to another."""
    near = re.sub(r"[^a-z0-9]+", "_", _without_accents(name).lower()).strip("_")
    if not near:
        return "my_arm"
    return near if near[0].isalpha() and len(near) >= _SHORTEST else f"arm_{near}"


def _without_accents(name: str) -> str:
    return "".join(letter for letter in unicodedata.normalize("NFKD", name) if not unicodedata.combining(letter))


def check_names(robot: Robot) -> None:
    """Checks that the names of links, joints and materials are safe in YAML keys, parameters and frames.

    Raises:
        EmitterError: some are not; the error proposes a name for each.
    """
    named = [("link", link.name) for link in robot.links] + [("joint", joint.name) for joint in robot.joints]
    materials = [visual.material.name for link in robot.links for visual in link.visuals if visual.material]
    named += [("material", name) for name in dict.fromkeys(materials)]
    if problems := list(_problems(named)):
        raise EmitterError(problems)


def check_prefixes(robot: Robot) -> None:
    """Checks that the prefixes of arms can begin the names of controllers, which are nodes.

    A node has letters, digits and ``_`` in its name, and no digit at its beginning (rmw_validate_node_name).

    Raises:
        EmitterError: some cannot; the error proposes others.
    """
    problems = []
    for arm in robot.arms:
        if not _NODE.fullmatch(arm.prefix):
            near = re.sub(r"[^A-Za-z0-9_]+", "_", _without_accents(arm.prefix))
            near = near if _NODE.fullmatch(near) else f"arm_{near}"
            problems.append(
                Problem(
                    message=f"the arm {shown(arm.name)} has a prefix that no controller of ROS can be named with",
                    found=arm.prefix,
                    accepted="letters, digits and `_`; the first is no digit",
                    suggestion=f"set `prefix: {near}` for the arm of the cell",
                )
            )
    if problems:
        raise EmitterError(problems)


def _problems(named: Iterable[tuple[str, str]]) -> Iterable[Problem]:
    for what, name in named:
        if not _NAME.fullmatch(name):
            near = re.sub(r"[^A-Za-z0-9_-]+", "_", _without_accents(name)).strip("_") or what
            yield Problem(
                message=f"the {what} {shown(name)} has a name that ROS cannot use everywhere",
                found=name,
                accepted="letters, digits, `_` and `-`",
                suggestion=f"rename it to {shown(near)} in the table",
            )
