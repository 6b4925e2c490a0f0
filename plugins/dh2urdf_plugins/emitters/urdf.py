"""URDF: the robot as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.errors import EmitterError
from dh2urdf.source import Problem, shown
from dh2urdf.stages import EmittedFile, Emitter
from dh2urdf_plugins.emitters.profiles import PROFILE_HELP, PROFILES, ProfileName, adapted, append_transmissions
from dh2urdf_plugins.emitters.urdf_tree import Notation, append_mujoco_options, append_robot, serialise
from dh2urdf_plugins.urdf_reader import read_urdf

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.robot import Robot
    from dh2urdf.stages import Inspection

LONGEST_LINE = 8000
"""Bytes of one line [1]: PyBullet cuts a longer one in silence."""


@dataclass(frozen=True, slots=True, kw_only=True)
class UrdfOptions:
    """What a URDF is written for."""

    profile: ProfileName = field(default="portable", metadata={"help": PROFILE_HELP})


def emit(robot: Robot, stem: str, options: UrdfOptions) -> tuple[EmittedFile]:
    """The URDF of a robot, as ``<stem>.urdf``.

    Raises:
        EmitterError: XML cannot hold one of its names, a name makes a line longer than readers take, or the robot lacks
            what URDF requires.
    """
    notation, profile = Notation(), PROFILES[options.profile]
    robot = adapted(robot, profile)
    root = etree.Element("robot", name=notation.text(robot.name))
    if profile.mujoco_element:
        append_mujoco_options(root)
    append_robot(root, robot, notation)
    if profile.transmissions:
        append_transmissions(root, robot, notation)
    content = serialise(root, robot.comment)
    _check_lines(content)
    return (EmittedFile(name=f"{stem}.urdf", content=content),)


def _check_lines(content: bytes) -> None:
    for number, line in enumerate(content.splitlines(), start=1):
        if len(line) > LONGEST_LINE:
            raise EmitterError(
                Problem(
                    message=f"line {number} of the robot description would have {len(line)} bytes",
                    found=shown(line.decode("utf-8").strip()),
                    accepted=f"at most {LONGEST_LINE} bytes: PyBullet cuts a longer line without a word",
                    suggestion="shorten the names",
                )
            )


def check(path: Path) -> Inspection:
    """What there is to say of a URDF of any origin.

    Raises:
        InputError: the file cannot be read.
    """
    from dh2urdf_plugins.lint.inspection import inspect_urdf

    return inspect_urdf(path)


EMITTER = Emitter(
    name="urdf",
    summary="URDF that every common simulator and ROS tool reads alike",
    suffixes=(".urdf",),
    options=UrdfOptions,
    emit=emit,
    read_back=read_urdf,
    check=check,
)
