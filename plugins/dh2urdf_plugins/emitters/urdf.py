"""URDF: the robot as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from lxml import etree

from dh2urdf.stages import EmittedFile, Emitter
from dh2urdf_plugins.emitters.urdf_tree import Notation, append_mujoco_options, append_robot, serialise
from dh2urdf_plugins.urdf_reader import read_urdf

if TYPE_CHECKING:
    from dh2urdf.robot import Robot


@dataclass(frozen=True, slots=True, kw_only=True)
class UrdfOptions:
    """What a URDF is written for."""

    profile: Literal["portable"] = field(
        default="portable", metadata={"help": "readers that the file is for; portable: all of them"}
    )


def emit(robot: Robot, stem: str, _options: UrdfOptions) -> tuple[EmittedFile]:
    """The URDF of a robot, as ``<stem>.urdf``.

    Raises:
        EmitterError: XML cannot hold one of its names, or the robot lacks what URDF requires.
    """
    notation = Notation()
    root = etree.Element("robot", name=notation.text(robot.name))
    append_mujoco_options(root)
    append_robot(root, robot, notation)
    return (EmittedFile(name=f"{stem}.urdf", content=serialise(root, robot.comment)),)


EMITTER = Emitter(
    name="urdf",
    summary="URDF that every common simulator and ROS tool reads alike",
    suffixes=(".urdf",),
    options=UrdfOptions,
    emit=emit,
    read_back=read_urdf,
)
