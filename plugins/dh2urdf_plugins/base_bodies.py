"""A base to which a table gives the mass 0, for the formats that need one that weighs something."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.manipulator import BASE, ROOT, Inertia
from dh2urdf.robot import Inertial
from dh2urdf.source import Messages, Problem

if TYPE_CHECKING:
    from dh2urdf.robot import Robot

say = Messages(__file__)

STILL = Inertial(mass=1.0, inertia=Inertia(ixx=0.01, iyy=0.01, izz=0.01))
"""What a base without a mass weighs where a format needs one: it stands still, and so its mass moves nothing."""


def is_weightless_base(name: str, body: Inertial | None) -> bool:
    """Whether a link is the base of an arm, or of an arm of a cell, and weighs nothing."""
    return name.endswith((ROOT, BASE)) and body is not None and not body.mass


def weightless_bases(robot: Robot) -> frozenset[str]:
    """Names of the bases at rest that weigh nothing, of an arm or of the arms of a cell.

    A base on a link that moves, as in a cell, needs no mass: the link has one. Nor does a root that holds a base.
    """
    still = links_at_rest(robot)
    holders = {joint.parent for joint in robot.joints if joint.child.endswith(BASE)}
    bases = {link.name for link in robot.links if is_weightless_base(link.name, link.inertial)}
    return frozenset(bases & still - holders - robot.foreign_names)


def with_base_bodies(robot: Robot) -> Robot:
    """A robot whose bases at rest all weigh something."""
    bases = weightless_bases(robot)
    links = tuple(replace(link, inertial=STILL) if link.name in bases else link for link in robot.links)
    return replace(robot, links=links)


def links_at_rest(robot: Robot) -> frozenset[str]:
    """Names of the root and of all links that no joint moves."""
    still = {robot.root}
    for joint in robot.held_rigidly:  # Parents before children.
        if joint.parent in still:
            still.add(joint.child)
    return frozenset(still)


def notices_for_gazebo(robot: Robot, *, filled: bool) -> list[Problem]:
    """A notice where Gazebo needs a mass of the base, and the base has none.

    sdformat merges the links that are fixed to each other, and drops a root that weighs nothing then, with the arm.

    Args:
        robot: an arm, or a cell of arms.
        filled: whether the file gives such a base the mass of `STILL`.
    """
    if filled:
        if not weightless_bases(robot):
            return []
        return [say("gazebo-base-filled", field="base.mass", mass=STILL.mass)]
    for arm in [arm.kind for arm in robot.arms] or [robot]:
        still = links_at_rest(arm)
        if not any(link.inertial and link.inertial.mass for link in arm.links if link.name in still):
            return [say("gazebo-drops-arm", field="base.mass")]
    return []


def notices_of_riders(robot: Robot) -> list[Problem]:
    """A notice where an arm of a cell has a base without a mass on a link that moves: sdformat loses such an arm."""
    still = links_at_rest(robot)
    moving = [link for link in robot.links if link.name not in still and link.name.endswith(BASE)]
    if not any(is_weightless_base(link.name, link.inertial) for link in moving):
        return []
    return [say("gazebo-drops-rider", field="base.mass")]
