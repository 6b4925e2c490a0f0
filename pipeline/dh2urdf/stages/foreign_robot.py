"""A robot description of any origin: the robot, and what a `Robot` does not hold."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from dh2urdf.robot import Robot
from dh2urdf.source import Problem

__all__ = ["ForeignRobot"]


@dataclass(frozen=True, slots=True, kw_only=True)
class ForeignRobot:
    """What a description of unknown origin holds.

    Attributes:
        robot: the links and joints; joints that no table has, such as floating ones, are fixed in it.
        loose: the types of the joints that no table has, by the name of the joint.
        folder: where the paths of its meshes begin; None for the folder of the file.
        notices: what could not be read, and is left out.
        elements: what the file has beside links, joints and materials, as XML: of a URDF, what is for other programs.
        lost: notices of what neither the robot nor the elements have, such as safety controllers.
        faults: what keeps joints from being read; they are fixed in the robot.
    """

    robot: Robot
    loose: Mapping[str, str] = field(default_factory=dict)
    folder: Path | None = None
    notices: tuple[Problem, ...] = ()
    elements: tuple[str, ...] = ()
    lost: tuple[Problem, ...] = ()
    faults: tuple[Problem, ...] = ()
