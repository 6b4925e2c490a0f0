"""URDF: the robot as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, TypeAlias

from dh2urdf.stages import EmitsInColumns, EmittedFile, Emitter, GivesNotices, ReadsBack, ReadsForeign, Usual
from dh2urdf_plugins.formats import checks, foreign_urdf, read_urdf, read_urdfs
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from dh2urdf.robot import Robot

ProfileName: TypeAlias = Literal["portable", "ros", "pybullet", "mujoco", "gazebo", "coppeliasim", "drake"]
UrdfVersion: TypeAlias = Literal["1.0", "1.2"]
VERSION_HELP = "of URDF; 1.2 has limits of acceleration and jerk, and capsules, and older readers refuse it"
PROFILE_HELP = "readers that the file is for; portable: all of them"

notices = Late(f"{__name__}.profiles:notices_of")
"""What a person should know of a URDF or a xacro, such as that Gazebo drops it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UrdfOptions:
    """What a URDF is written for."""

    profile: ProfileName = option(PROFILE_HELP, "portable", flag="P")
    version: UrdfVersion = option(VERSION_HELP, "1.0")


def emit(robot: Robot, stem: str, options: UrdfOptions) -> tuple[EmittedFile]:
    """The URDF of a robot, as ``<stem>.urdf``."""
    from dh2urdf_plugins.formats.urdf.profiles import PROFILES, adapted, append_transmissions
    from dh2urdf_plugins.formats.urdf.writer import Notation, check_lines, serialise, urdf_tree

    notation, profile = Notation(options.version), PROFILES[options.profile]
    robot = adapted(robot, profile)
    if robot.floating:
        from dh2urdf.cells.floating import without_world

        robot = without_world(robot)
    name, is_shared = notation.text(robot.name), profile.shared_materials
    root = urdf_tree(robot, name, notation, mujoco=profile.mujoco_element, shared_materials=is_shared)
    if profile.transmissions:
        append_transmissions(root, robot, notation)
    content = serialise(root, robot.comment)
    check_lines(content)
    return (EmittedFile(name=f"{stem}.urdf", content=content),)


EMITTER = Emitter(
    name="urdf",
    summary="URDF that every common simulator and ROS tool reads alike",
    suffixes=(".urdf",),
    options=UrdfOptions,
    emit=emit,
    capabilities=(
        Usual(),
        ReadsBack(read_urdf, floats_by_root=True),
        ReadsForeign(foreign_urdf, can_attach=True),
        EmitsInColumns(Late(f"{__name__}.columns:emit_columns"), read_urdfs),
        *checks("inspection:inspect_urdf", "files:urdfs", "fixing:fixed", finds_packages=True),
        GivesNotices(notices),
    ),
)
