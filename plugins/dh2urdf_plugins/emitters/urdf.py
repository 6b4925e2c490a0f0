"""URDF: the robot as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal

from dh2urdf.errors import EmitterError
from dh2urdf.stages import EmittedFile, Emitter
from dh2urdf_plugins.emitters.urdf_tree import Notation, check_lines, serialise, urdf_tree
from dh2urdf_plugins.urdf_reader import read_urdf
from dh2urdf_plugins.urdf_scanner import scan_columns

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.columns import RobotColumns
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
        EmitterError: XML cannot hold one of its names, a name makes a line longer than readers take, or the robot lacks
            what URDF requires.
    """
    notation = Notation()
    content = serialise(urdf_tree(robot, notation.text(robot.name), notation), robot.comment)
    check_lines(content)
    return (EmittedFile(name=f"{stem}.urdf", content=content),)


def emit_columns(
    robots: RobotColumns, stems: Sequence[str], _options: UrdfOptions
) -> list[tuple[EmittedFile, ...]] | None:
    """The URDF of each of many robots, as ``<stem>.urdf``.

    A robot that is not sure, or whose name or comment has to be escaped, gets no file. None where one file is not
    another with other numbers, or where there can be none: `emit` makes them one by one, or says why it cannot.
    """
    from dh2urdf_plugins.emitters.urdf_columns import filled_in

    try:
        contents = filled_in(robots)
    except EmitterError:
        return None
    return [
        () if content is None else (EmittedFile(name=f"{stem}.urdf", content=content),)
        for stem, content in zip(stems, contents, strict=True)
    ]


EMITTER = Emitter(
    name="urdf",
    summary="URDF that every common simulator and ROS tool reads alike",
    suffixes=(".urdf",),
    options=UrdfOptions,
    emit=emit,
    read_back=read_urdf,
    emit_columns=emit_columns,
    read_columns=scan_columns,
)
