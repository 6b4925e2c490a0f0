"""Mounts a frame on a robot, with a body or without."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.elementwise import agreed
from dh2urdf.errors import EditError
from dh2urdf.manipulator import JointType
from dh2urdf.mass_properties import placed, solid
from dh2urdf.robot import Box, Collision, Inertial, Joint, Link, Origin, Visual
from dh2urdf.source import Problem, did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform, Vec3
    from dh2urdf_plugins.edits.mount_options import MountOptions

_OPTICAL: Vec3 = (-math.pi / 2, 0.0, -math.pi / 2)
"""REP 103: z forward, x right, y down, in a body frame of x forward, y left, z up."""


def mounted(robot: Robot, options: MountOptions) -> Robot:
    """The robot with one more link on a fixed joint, and an optical frame in it where that is asked for.

    Raises:
        EditError: there is no such parent, or a name is taken or missing.
    """
    problems = list(_problems(robot, options))
    if problems:
        raise EditError(problem.about(robot=robot.name) for problem in problems)
    robot = _with(robot, _link(options), options.parent, Origin(xyz=options.xyz, rpy=options.rpy))
    if options.optical:
        frame = Link(name=_optical(options), inertial=Inertial(mass=0.0))
        robot = _with(robot, frame, options.name, Origin(rpy=_OPTICAL))
    return robot


def _with(robot: Robot, link: Link, parent: str, origin: Origin) -> Robot:
    """A robot with one more link on a fixed joint.

    A frame without mass is fixed to the nearest link with a mass, at the same place: simulators refuse or drop chains
    of links that weigh nothing, such as tool0 and a frame on it.
    """
    links = {each.name: each for each in robot.links}
    above = {joint.child: joint for joint in robot.joints}
    pose = given = origin.transform
    is_frame = not _weighs(link)
    while is_frame and not _weighs(links[parent]):
        joint = above.get(parent)
        if joint is None or joint.type is not JointType.FIXED:
            break
        parent, pose = joint.parent, joint.origin.transform @ pose
    at = origin if _same(pose, given) else Origin.of(pose)
    fixed = Joint(name=f"{link.name}_joint", type=JointType.FIXED, parent=parent, child=link.name, origin=at)
    return replace(robot, links=(*robot.links, link), joints=(*robot.joints, fixed))


def _same(pose: RigidTransform, other: RigidTransform) -> bool:
    numbers = zip((*pose.translation, *pose.rotation), (*other.translation, *other.rotation), strict=True)
    return all(agreed(mine == its) for mine, its in numbers)


def _weighs(link: Link) -> bool:
    return link.inertial is not None and agreed(link.inertial.mass != 0.0)


def _problems(robot: Robot, options: MountOptions) -> Iterator[Problem]:
    known = [link.name for link in robot.links]
    if not options.name:
        accepted = "a name, such as `{stage: mount, options: {name: camera_link}}`"
        yield Problem(message="what is mounted has no name", field="edits", accepted=accepted)
    if options.parent not in known:
        yield Problem(
            message=f"the robot has no link {shown(options.parent)} on which something could be mounted",
            field="edits",
            found=options.parent,
            accepted=", ".join(known),
            suggestion=did_you_mean(options.parent, known),
        )
    taken = {*known, *(joint.name for joint in robot.joints)}
    wanted = [options.name, *([_optical(options)] if options.optical else [])]
    for name in (each for link in wanted for each in (link, f"{link}_joint")):
        if options.name and name in taken:
            message = f"the robot has a link or a joint {shown(name)} already"
            yield Problem(message=message, field="edits", found=name, accepted="another name")


def _link(options: MountOptions) -> Link:
    if options.size is None:
        return Link(name=options.name, inertial=Inertial(mass=0.0))
    shape = Box(size=options.size)
    volume = math.prod(options.size)
    return Link(
        name=options.name,
        inertial=placed(solid(shape, options.mass / volume), Origin().transform),
        visuals=(Visual(geometry=shape),),
        collisions=(Collision(geometry=shape),),
    )


def _optical(options: MountOptions) -> str:
    return f"{options.name}_optical_frame"
