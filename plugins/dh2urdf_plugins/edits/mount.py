"""The edit ``mount``: a frame that is fixed to a link, such as that of a camera, with a body or without."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dh2urdf.elementwise import agreed
from dh2urdf.errors import EditError
from dh2urdf.manipulator import JointType
from dh2urdf.mass_properties import placed, solid
from dh2urdf.quantities import Dimension, evaluate
from dh2urdf.robot import Box, Collision, Inertial, Joint, Link, Origin, Visual
from dh2urdf.rotations import ZERO, Vec3
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf.stages import Edit

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Robot
    from dh2urdf.rotations import RigidTransform

_OPTICAL: Vec3 = (-math.pi / 2, 0.0, -math.pi / 2)
"""REP 103: z forward, x right, y down, in a body frame of x forward, y left, z up."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MountOptions:
    """What is mounted, and where."""

    name: str = field(default="", metadata={"help": "name of the link; its joint is NAME_joint. Required"})
    parent: str = field(default="tool0", metadata={"help": "link that holds it"})
    xyz: Vec3 = field(default=ZERO, metadata={"help": "its origin in that link [m]"})
    rpy: tuple[float | str, float | str, float | str] = field(
        default=ZERO,
        metadata={"help": "roll, pitch, yaw in that link [rad]: numbers or texts such as -pi/2"},
    )
    size: Vec3 | None = field(
        default=None, metadata={"help": "edges of a solid box about its origin [m]; a mere frame without"}
    )
    mass: float = field(default=0.0, metadata={"help": "mass of the box [kg]"})
    optical: bool = field(
        default=False,
        metadata={"help": "whether NAME_optical_frame is there too, of REP 103: z forward, x right, y down"},
    )

    def __post_init__(self) -> None:
        """Refuse what cannot be mounted.

        Raises:
            ValueError: a length is not greater than 0, or a mass has no box.
        """
        if self.size is not None and not all(0.0 < edge < math.inf for edge in self.size):
            raise ValueError("size: the edges of a box are numbers greater than 0")
        if not 0.0 <= self.mass < math.inf or bool(self.mass) is not (self.size is not None):
            raise ValueError("mass and size belong together: a box has both, a mere frame has neither")
        _ = self.angles

    @property
    def angles(self) -> Vec3:
        """Roll, pitch, yaw [rad].

        Raises:
            QuantityError: one of them is no angle; also a ValueError.
        """
        roll, pitch, yaw = (
            evaluate(angle, Dimension.ANGLE).value if isinstance(angle, str) else angle for angle in self.rpy
        )
        return (roll, pitch, yaw)


def edit_robot(robot: Robot, options: MountOptions) -> Robot:
    """The robot with one more link on a fixed joint, and an optical frame in it where that is asked for.

    Raises:
        EditError: there is no such parent, or a name is taken or missing.
    """
    problems = list(_problems(robot, options))
    if problems:
        raise EditError(problem.about(robot=robot.name) for problem in problems)
    robot = _with(robot, _link(options), options.parent, Origin(xyz=options.xyz, rpy=options.angles))
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
    at = origin if _same(pose, given) else Origin(xyz=pose.translation, rpy=pose.rpy)
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


EDIT = Edit(
    name="mount",
    summary="a link on a fixed joint: the frame of a camera or of another sensor, with a box or without",
    options=MountOptions,
    edit_robot=edit_robot,
    accepts_columns=True,
)
