"""What a loader is asked to load, and what the simulator says of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadRequest:
    """What a loader is asked to load.

    Attributes:
        path: the written file.
        robot: the robot that was written.
        poses: joint vectors inside the limits, one value per moving joint; the robot is measured at each.
        expected: by the name of the link, tool0, T(root → tool0) at each of `poses`, as row-major 4x4 matrices of 16
            numbers [m]; of a cell the tool0 of every arm.
        mark: the robot's place in its file: a table, or a run file where it is a cell.
        picture: where to write a picture of the robot, or None.
    """

    path: Path
    robot: Robot
    poses: tuple[tuple[float, ...], ...]
    expected: dict[str, tuple[tuple[float, ...], ...]]
    mark: Mark | None = None
    picture: Path | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadReport:
    """What a simulator says of a file, measured by asking it.

    Attributes:
        simulator: its name.
        version: its version.
        joints: the moving joints it found, in its order: name, type, axis, lower, upper, velocity, effort.
        mass: mass of the arm as the simulator holds it [kg].
        mass_error: largest difference of one link's mass from the robot's [kg].
        inertia_error: largest difference of an element of one link's inertia from the robot's [kg·m²].
        position_error: largest distance of tool0 from where the DH product has it [m].
        angle_error: largest angle between them [rad].
        tolerance: what `position_error` may be: the simulator's arithmetic [m].
        angle_tolerance: what `angle_error` may be [rad].
        q: the joint vector of the largest position error.
        poses: how many joint vectors were measured.
        hold: the hold test: seconds, largest joint displacement, whether the arm stayed, contacts within the arm; of a
            library that simulates nothing, the largest share of an effort that gravity asks, and whether that is there.
        findings: what a person should know.
        output: what the simulator printed.
        picture: name of the picture that was written.
    """

    simulator: str
    version: str
    joints: tuple[dict[str, Any], ...] = ()
    mass: float | None = None
    mass_error: float | None = None
    inertia_error: float | None = None
    position_error: float | None = None
    angle_error: float | None = None
    tolerance: float | None = None
    angle_tolerance: float | None = None
    q: tuple[float, ...] = ()
    poses: int = 0
    hold: dict[str, Any] = field(default_factory=dict)
    findings: tuple[Problem, ...] = ()
    output: str = ""
    picture: str | None = None
