"""A robot as it will be written: links and joints, in no file format.

The names follow URDF, the common tongue of the readers. Lengths are in m, angles in rad, masses in kg.

A number that follows from the table may carry a *formula*: an arithmetic expression over the robot's `Parameter`
names (``a_2``, ``0.5*d_1``, ``abs(a_3) - 0.08``, functions abs, max, sin, cos; xacro and Python read it alike) whose
value is that number. Emitters of parametric formats write the formula; all others write the number.

A cell is one robot of several arms, with one root. Its links and joints are all there is of it, in numbers, as of any
other robot; `Robot.arms` says besides of which arms it is composed, for emitters that write every kind of arm once.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.fields import Record, function_of, unchecked
from dh2urdf.manipulator import Follower, Inertia, JointType, Limits, Manipulator, whole_laws
from dh2urdf.rotations import Z_AXIS, ZERO, Vec3, total
from dh2urdf.shapes import (
    Box,
    Collision,
    Cylinder,
    Formulas,
    Geometry,
    Material,
    Mesh,
    Origin,
    Parameter,
    Sphere,
    Visual,
)
from dh2urdf.source import Mark, Problem, free_name

if TYPE_CHECKING:
    import os
    from collections.abc import Iterable, Mapping

    import numpy as np
    from numpy.typing import NDArray

    from dh2urdf.manipulator import JointVectors

__all__ = [
    "WEIGHTLESS",
    "Arm",
    "Attachment",
    "Box",
    "Collision",
    "Cylinder",
    "Follower",
    "Formulas",
    "Geometry",
    "Inertial",
    "Joint",
    "Link",
    "Material",
    "Mesh",
    "Origin",
    "Parameter",
    "Robot",
    "Sphere",
    "Visual",
    "followers_of",
    "new_collision",
    "new_inertial",
    "new_joint",
    "new_link",
    "new_origin",
    "new_parameter",
    "new_visual",
    "with_followers",
]

V = TypeVar("V")


@dataclass(frozen=True, slots=True, kw_only=True)
class Inertial(Record):
    """Mass properties of a link.

    Attributes:
        mass: [kg].
        com: centre of mass in the link frame [m].
        inertia: about the centre of mass, axes parallel to the link frame [kg·m²].
    """

    mass: float
    com: Vec3 = ZERO
    inertia: Inertia = Inertia(ixx=0.0, iyy=0.0, izz=0.0)


WEIGHTLESS = Inertial(mass=0.0)
"""The mass properties of a mere frame, said explicitly: PyBullet takes silence for 1 kg."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Link(Record):
    """A rigid body or, without inertial and shapes, a frame."""

    name: str
    inertial: Inertial | None = None
    visuals: tuple[Visual, ...] = ()
    collisions: tuple[Collision, ...] = ()

    @property
    def shapes(self) -> tuple[Visual | Collision, ...]:
        """What is seen of it, and what it touches with."""
        return (*self.visuals, *self.collisions)


@dataclass(frozen=True, slots=True, kw_only=True)
class Joint(Record):
    """A joint between two links.

    Attributes:
        name: the joint's name; no link has it.
        type: how it moves.
        parent: name of the link that holds it.
        child: name of the link that it moves.
        origin: the child's frame in the parent's at q = 0.
        axis: unit vector in the child's frame; unused where fixed.
        limits: lower, upper, effort and velocity for revolute and prismatic, effort and velocity for continuous, none
            for fixed; acceleration and jerk where the table gives them.
        damping: viscous friction [N·m·s/rad or N·s/m].
        friction: static friction [N·m or N].
        armature: inertia of the rotor, behind the gear [kg·m² or kg].
        follows: the joint whose value decides that of this one, and how; None where it moves by itself.
        mark: the row of the table that says it.
    """

    name: str
    type: JointType
    parent: str
    child: str
    origin: Origin = Origin()
    axis: Vec3 = Z_AXIS
    limits: Limits = Limits()
    damping: float | None = None
    friction: float | None = None
    armature: float | None = None
    follows: Follower | None = None
    mark: Mark | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class Arm(Record):
    """One arm of a cell.

    Attributes:
        name: its name in the cell.
        kind: the robot that it is, as it stands alone: names without the prefix, parameters and formulas.
        prefix: what stands before the names of its links, joints and materials in the cell.
        parent: name of the cell's link that holds it.
        placement: the frame of its root link in the parent's.
    """

    name: str
    kind: Robot
    prefix: str
    parent: str
    placement: Origin


@dataclass(frozen=True, slots=True, kw_only=True)
class Attachment(Record):
    """A robot from a description that is bolted to another one: a gripper, a tool, a camera, a base.

    Attributes:
        name: what it is called.
        prefix: what stands before the names of its links, joints and materials in the whole robot.
        parent: name of the link of the whole robot that holds it.
        placement: the frame of its first link in the parent's.
        robot: the robot as its own file describes it, the link that is held first; its name is that of the part, which
            is the same where a cell has one part several times.
        elements: the elements of its file beside links, joints and materials, as XML; their names have no prefix.
        semantics: the elements of an SRDF of it, as XML; their names have no prefix.
        tip: the link of it that is the tool of the whole robot, without the prefix; None where tool0 stays the tool.
    """

    name: str
    prefix: str
    parent: str
    placement: Origin
    robot: Robot
    elements: tuple[str, ...] = ()
    semantics: tuple[str, ...] = ()
    tip: str | None = None

    @property
    def names(self) -> frozenset[str]:
        """The names of its links and joints, without the prefix."""
        return frozenset((*(link.name for link in self.robot.links), *(joint.name for joint in self.robot.joints)))


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Robot(Record):
    """A tree of links and joints with one root.

    Attributes:
        name: the robot's name.
        links: parents before children.
        joints: in the order of their child links.
        parameters: the numbers that formulas use.
        comment: one line for a reader of the file: what made it, from what.
        notices: what a careful person would want to know about how it was made.
        arms: the arms of a cell, parents before children; empty for a robot that is one arm.
        attachments: what is bolted to it; their links and joints are among its own, the last ones.
        floating: names of the links that nothing holds in the world; where they are at first is the origin of their
            fixed joint on the root, or they are the root.
        loaded: names of the joints whose effort follows from what they carry; of others, the table says it.
        manipulator: the table that it was made of; None for a cell, and where nobody knows it.
    """

    name: str
    links: tuple[Link, ...]
    joints: tuple[Joint, ...]
    parameters: tuple[Parameter, ...] = field(default=(), compare=False)
    comment: str = field(default="", compare=False)
    notices: tuple[Problem, ...] = field(default=(), compare=False)
    arms: tuple[Arm, ...] = field(default=(), compare=False)
    attachments: tuple[Attachment, ...] = field(default=(), compare=False)
    floating: tuple[str, ...] = field(default=(), compare=False)
    loaded: tuple[str, ...] = field(default=(), compare=False)
    manipulator: Manipulator | None = field(default=None, compare=False)

    @property
    def root(self) -> str:
        """Name of the root link."""
        return self.links[0].name

    @property
    def mounting(self) -> str:
        """Name of the fixed joint that holds this robot on another: ``base_joint``, as in ROS-Industrial's macros.

        A ``_`` follows for as long as the robot has a joint or link of that name.
        """
        taken = {joint.name for joint in self.joints} | {link.name for link in self.links}
        return free_name("base_joint", taken)

    @property
    def moving_joints(self) -> tuple[Joint, ...]:
        """The joints that move, in order: by themselves, or because they follow another one."""
        return tuple(joint for joint in self.joints if joint.type is not JointType.FIXED)

    @property
    def followers(self) -> dict[str, Follower]:
        """The joints that can follow another one, by name, and how they follow the one that moves by itself."""
        return followers_of(self.moving_joints)

    @property
    def actuated_joints(self) -> tuple[Joint, ...]:
        """The joints that move by themselves, in order: a joint vector has a value for each."""
        followers = self.followers
        return tuple(joint for joint in self.moving_joints if joint.name not in followers)

    @property
    def held_rigidly(self) -> tuple[Joint, ...]:
        """The fixed joints, but for those of links that float."""
        return tuple(
            [joint for joint in self.joints if joint.type is JointType.FIXED and joint.child not in self.floating]
        )

    @property
    def foreign_names(self) -> frozenset[str]:
        """The names of the links and joints of its attachments."""
        return frozenset(each.prefix + name for each in self.attachments for name in each.names)

    @property
    def tips(self) -> tuple[str, ...]:
        """The links of attachments that are tools in place of tool0; of several on one arm the last counts."""
        return tuple(each.prefix + each.tip for each in self.attachments if each.tip is not None)

    @property
    def mass(self) -> float:
        """Mass of all links [kg]."""
        return total(link.inertial.mass for link in self.links if link.inertial)

    def fk(self, q: JointVectors, tip: str = "tool0") -> NDArray[np.float64]:
        """Forward kinematics of a link at one joint vector or at many.

        Args:
            q: joint vectors of shape (..., n), one value per actuated joint that moves the link, in the order of the
                way from the root [rad or m]; or a mapping from the names of these joints, and of any other actuated
                ones, to their values.
            tip: name of the link; in a cell the tool0 of an arm has the arm's prefix.

        Returns:
            T(root → tip) of shape (..., 4, 4), lengths in m.

        Raises:
            RecordError: the robot has no such link, the joint vectors have another number of values than there are
                moving joints on the way, a joint is unknown or missing, or a value is not a finite number. It is a
                TypeError or a ValueError, too.
        """
        return function_of("kinematics.pose_arrays.robot_pose")(self, q, tip)

    def fk_all(self, q: JointVectors) -> dict[str, NDArray[np.float64]]:
        """The frame of every link at one joint vector or at many.

        Args:
            q: joint vectors of shape (..., n), one value per actuated joint of the robot [rad or m]; or a mapping from
                the names of all of them to their values.

        Returns:
            By the name of the link T(root → link) of shape (..., 4, 4), lengths in m.

        Raises:
            RecordError: as of `fk`.
        """
        return function_of("kinematics.pose_arrays.robot_poses")(self, q)

    def jacobian(self, q: JointVectors, tip: str = "tool0") -> NDArray[np.float64]:
        """The geometric Jacobian J of a link, with the axes of the root link: the twist of the link is J·dq/dt.

        The first three rows are the velocity of the link's origin [m/s], the last three its angular velocity [rad/s].

        Args:
            q: joint vectors as `fk` accepts them.
            tip: name of the link.

        Returns:
            Matrices of shape (..., 6, n), a column for each actuated joint that moves the link.

        Raises:
            RecordError: as of `fk`.
        """
        return function_of("kinematics.pose_arrays.robot_jacobian")(self, q, tip)

    def to_urdf(self, out: str | os.PathLike[str] | None = None, **options: object) -> str:
        """The robot as URDF, which is checked and read back before anybody gets it.

        Args:
            out: the file to write; without it nothing is written. Meshes are named where they are.
            options: options of the emitter, such as ``profile="ros"``.

        Returns:
            The text of the file.

        Raises:
            RobotError: the robot breaks a rule that the readers of robot descriptions rely on.
            ProofError: what was written has other kinematics than the robot.
            ConfigError: an option is unknown or its value wrong, or the file's name is that of another format.
            OutputError: the file cannot be written.
        """
        return function_of("commands.written.write_description")(self, ".urdf", out, options, "Robot.to_urdf()")

    def to_sdf(self, out: str | os.PathLike[str] | None = None, **options: object) -> str:
        """The robot as SDF, as `to_urdf` has it as URDF."""
        return function_of("commands.written.write_description")(self, ".sdf", out, options, "Robot.to_sdf()")

    def to_mjcf(self, out: str | os.PathLike[str] | None = None, **options: object) -> str:
        """The robot as MJCF for MuJoCo, as `to_urdf` has it as URDF."""
        return function_of("commands.written.write_description")(self, ".xml", out, options, "Robot.to_mjcf()")

    def __repr__(self) -> str:
        """Name, number of links and number of moving joints."""
        links, moving = len(self.links), len(self.moving_joints)
        joints = f"{moving} moving joint{'' if moving == 1 else 's'}"
        return f"<Robot {self.name!r}: {links} link{'' if links == 1 else 's'}, {joints}>"

    def _repr_html_(self) -> str:
        """What a notebook shows: the joints with their limits and, with matplotlib, a drawing of the robot."""
        return function_of("report.notebook.robot_html")(self)


def followers_of(moving: Iterable[Joint]) -> dict[str, Follower]:
    """How those of some moving joints that can follow another one follow the one at the end of their leaders.

    A joint that keeps one value follows without a leader.
    """
    laws = {joint.name: joint.follows for joint in moving}
    whole = whole_laws({name: law for name, law in laws.items() if law})
    return {name: law for name, law in whole.items() if law.is_held or law.leader in laws}


def with_followers(values: Mapping[str, V], followers: Mapping[str, Follower]) -> dict[str, V | float]:
    """The values of joints, and of the joints that follow them.

    Args:
        values: by the name of the joint [rad or m], each a float or an array; a tuple, such as an orientation, is
            passed on as it is.
        followers: the joints that follow, as `Robot.followers` has them. What is in `values` of them does not count.
    """
    every: dict[str, Any] = {name: value for name, value in values.items() if name not in followers}
    for name, law in followers.items():
        leading = every[law.leader] if law.leader else 0.0
        every[name] = leading if isinstance(leading, tuple) else law.value(leading)
    return every


# Constructors without checks, for stages that have computed the values: see `dh2urdf.fields.unchecked`.
new_collision = unchecked(Collision)
new_inertial = unchecked(Inertial)
new_joint = unchecked(Joint)
new_link = unchecked(Link)
new_origin = unchecked(Origin)
new_parameter = unchecked(Parameter)
new_visual = unchecked(Visual)
