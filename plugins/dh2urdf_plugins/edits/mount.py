"""The edit ``mount``: a frame that is fixed to a link, such as that of a camera, with a body or without."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.rotations import ZERO, Vec3
from dh2urdf.source import Messages
from dh2urdf.stages import Edit, EditsInColumns
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Link, Origin, Robot
    from dh2urdf.source import Problem

say = Messages(__file__)

_OPTICAL: Vec3 = (-math.pi / 2, 0.0, -math.pi / 2)
"""REP 103: z forward, x right, y down, in a body frame of x forward, y left, z up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MountOptions:
    """What is mounted, and where."""

    name: str = option("name of the link; its joint is NAME_joint. Required", "")
    parent: str = option("link that holds it", "tool0")
    xyz: Vec3 = option("its origin in that link [m]", ZERO, measures="length")
    rpy: Vec3 = option("roll, pitch, yaw in that link [rad]", ZERO, measures="angle")
    size: Vec3 | None = option(
        "edges of a solid box about its origin [m]; a mere frame without", None, measures="length"
    )
    mass: float = option("mass of the box [kg]", 0.0, measures="mass")
    optical: bool = option("whether NAME_optical_frame is there too, of REP 103: z forward, x right, y down", False)

    def __post_init__(self) -> None:
        if self.size is not None and not all(0.0 < edge < math.inf for edge in self.size):
            raise ValueError("size: the edges of a box are numbers greater than 0")
        if not 0.0 <= self.mass < math.inf or bool(self.mass) is not (self.size is not None):
            raise ValueError("mass and size belong together: a box has both, a mere frame has neither")


def edit_robot(robot: Robot, options: MountOptions) -> Robot:
    """The robot with one more link on a fixed joint, and an optical frame in it where that is asked for."""
    from dh2urdf.errors import EditError
    from dh2urdf.kinematics.mass import placed, solid
    from dh2urdf.robot import Box, Collision, Inertial, Link, Origin, Visual

    if problems := list(_problems(robot, options)):
        raise EditError(problem.about(robot=robot.name) for problem in problems)
    link = Link(name=options.name, inertial=Inertial(mass=0.0))
    if options.size is not None:
        shape = Box(size=options.size)
        body = placed(solid(shape, options.mass / math.prod(options.size)), Origin().transform)
        seen, touch = (Visual(geometry=shape),), (Collision(geometry=shape),)
        link = Link(name=options.name, inertial=body, visuals=seen, collisions=touch)
    robot = _with(robot, link, options.parent, Origin(xyz=options.xyz, rpy=options.rpy))
    if options.optical:
        frame = Link(name=f"{options.name}_optical_frame", inertial=Inertial(mass=0.0))
        robot = _with(robot, frame, options.name, Origin(rpy=_OPTICAL))
    return robot


def _with(robot: Robot, link: Link, parent: str, origin: Origin) -> Robot:
    """A robot with one more link on a fixed joint.

    A frame without mass is fixed to the nearest link with a mass, at the same place: simulators refuse or drop chains
    of links that weigh nothing, such as tool0 and a frame on it.
    """
    from dataclasses import replace

    from dh2urdf.manipulator import JointType
    from dh2urdf.robot import Joint, Origin
    from dh2urdf.rotations import agreed

    def weighs(one: Link) -> bool:
        return one.inertial is not None and agreed(one.inertial.mass != 0.0)

    links = {each.name: each for each in robot.links}
    above = {joint.child: joint for joint in robot.joints}
    pose = given = origin.transform
    while not weighs(link) and not weighs(links[parent]):
        joint = above.get(parent)
        if joint is None or joint.type is not JointType.FIXED:
            break
        parent, pose = joint.parent, joint.origin.transform @ pose
    numbers = zip((*pose.translation, *pose.rotation), (*given.translation, *given.rotation), strict=True)
    at = origin if all(agreed(one == other) for one, other in numbers) else Origin.of(pose)
    fixed = Joint(name=f"{link.name}_joint", type=JointType.FIXED, parent=parent, child=link.name, origin=at)
    return replace(robot, links=(*robot.links, link), joints=(*robot.joints, fixed))


def _problems(robot: Robot, options: MountOptions) -> Iterator[Problem]:
    from dh2urdf.source import did_you_mean

    known, name, parent = [link.name for link in robot.links], options.name, options.parent
    if not name:
        yield say("mount-without-name", field="edits")
    if parent not in known:
        near = did_you_mean(parent, known)
        yield say("mount-on-no-link", field="edits", found=parent, links=known, suggestion=near)
    taken = {*known, *(joint.name for joint in robot.joints)}
    frames = [name, f"{name}_optical_frame"] if options.optical else [name]
    for each in (word for frame in frames for word in (frame, f"{frame}_joint")):
        if name and each in taken:
            yield say("mount-name-taken", field="edits", found=each)


EDIT = Edit(
    name="mount",
    summary="a link on a fixed joint: the frame of a camera or of another sensor, with a box or without",
    options=MountOptions,
    edit_robot=edit_robot,
    capabilities=(EditsInColumns(),),
)
