"""What a loader is asked to load, and what the simulator reports about it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from dh2urdf.robot import Inertial, Robot
from dh2urdf.source import Mark, Problem


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadRequest:
    """What a loader is asked to load.

    Attributes:
        path: the written file.
        robot: the robot that was written.
        poses: joint vectors inside the limits, one value per moving joint, also those that follow others; the robot is
            measured at each.
        expected: by the name of the link, tool0, T(root → tool0) at each of `poses`, as row-major 4x4 matrices of 16
            numbers [m]; of a cell the tool0 of every arm; of what is attached, also the links that hold no other.
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
class Question:
    """A robot description of any origin that a simulator is given: what does it make of it?

    Attributes:
        path: the file, as an absolute path.
        format: the name of its format, such as ``sdf``; what a xacro expands to is a ``urdf``.
        packages: the folders of ROS packages, by their names.
        postures: values of joints by their names [rad or m]: where the links are is asked at each.
    """

    path: Path
    format: str
    packages: Mapping[str, Path] = field(default_factory=dict)
    postures: tuple[Mapping[str, float], ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class HeldRobot:
    """What a simulator made of a robot description: plain numbers. What a simulator does not tell is left out.

    Attributes:
        links: by the name of the link: mass [kg], centre of mass [m], and inertia about it [kg·m²], row by row, in the
            axes of the link; None where the simulator tells names only.
        joints: the moving joints, each with its name and what it knows of type, axis, lower, upper, velocity and
            effort; and ``mimic``, which is the leader, the multiplier and the offset, or None where it follows none.
        frames: by the name of the link, T(world → link) at each posture, as row-major 4x4 matrices [m].
        shapes: by the name of the link and ``visual`` or ``collision``, the lengths of each shape along the axes of
            the shape, the longest first [m].
        root_is_loose: whether the root can move in the world; None where the simulator was asked to hold it.
        refusals: the parts that it refused though it took the rest, each in the simulator's words.
    """

    links: dict[str, tuple[float, tuple[float, ...], tuple[float, ...]] | None] = field(default_factory=dict)
    joints: list[dict[str, Any]] = field(default_factory=list)
    frames: dict[str, list[list[float]]] = field(default_factory=dict)
    shapes: dict[str, dict[str, list[tuple[float, float, float]]]] = field(default_factory=dict)
    root_is_loose: bool | None = None
    refusals: list[str] = field(default_factory=list)


@dataclass(frozen=True, slots=True, kw_only=True)
class LoadReport:
    """What a simulator reports about a file, measured by asking it.

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


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatedArm:
    """The arm as a simulator has it: what `dh2urdf.stages.Loader.open` gives, and dh2urdf compares with the robot.

    Attributes:
        simulator: its name.
        version: its version.
        pose: T(root → link) of a link at a joint vector, which has a value for each moving joint in the order of
            `dh2urdf.robot.Robot.moving_joints` [rad or m]: four rows of four numbers [m], as an array or
            lists, or a `dh2urdf.rotations.RigidTransform`.
        joints: the moving joints it found, each with its name and what it knows of type, axis, lower, upper, velocity
            and effort. What is left out is not compared.
        bodies: the links by their names: mass [kg], centre of mass [m] and inertia about it [kg·m²], in the axes of the
            link. None where the simulator does not tell; then masses are not compared.
        tolerance: what its numbers may be off: of a position as a share of the reach, of an angle [rad], of any other
            number as a share of it.
        findings: what a person should know.
        close: called once, when all is measured.
    """

    simulator: str
    version: str
    pose: Callable[[str, Sequence[float]], Any]
    joints: Sequence[Mapping[str, Any]]
    bodies: Mapping[str, Inertial] | None = None
    tolerance: float = 1e-9
    findings: tuple[Problem, ...] = ()
    close: Callable[[], None] | None = None
