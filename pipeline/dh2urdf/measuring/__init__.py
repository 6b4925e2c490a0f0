"""What a simulator holds, beside the robot that was written: the same comparison and the same words for all of them.

A loader asks its simulator what became of the file, in the simulator's own way, and hands the answers over as plain
numbers; where they differ from the robot by more than the simulator's arithmetic, there is a problem.
"""

from __future__ import annotations

import math
from dataclasses import replace
from functools import partial, update_wrapper
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.chain import KinematicChain
from dh2urdf.kinematics.mass import tensor
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Inertial
from dh2urdf.rotations import RigidTransform, Rotation, Vec3, norm, subtract
from dh2urdf.source import Messages, Problem
from dh2urdf.stages.load_records import LoadReport, SimulatedArm

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from dh2urdf.robot import Joint, Robot
    from dh2urdf.stages import Loader
    from dh2urdf.stages.load_records import LoadRequest

say = Messages(__file__)

DOUBLE_PRECISION = 2.0**-52  # distance of 1 to the next number in double precision
_ROWS = 4
_WITHOUT_EXTENT = 1e-12  # what a pose of an arm without extent is allowed, and a centre of mass in the origin [m]


class Body(NamedTuple):
    """A link as a simulator holds it."""

    mass: float  # [kg]
    com: Vec3  # centre of mass in the link frame [m]
    inertia: Rotation  # about the centre of mass, in the axes of the link frame, row by row [kg·m²]


class Precision(NamedTuple):
    """A simulator's arithmetic: what its answers may differ from what was written.

    An inertia may differ by a share of the trace, and besides, where the simulator holds it about the link's origin, by
    a share of that of the mass at its centre about this origin.
    """

    number: float  # a limit, a mass or a centre of mass, as a share of it
    axis: float  # the axis of a joint, which many simulators make a unit vector again
    inertia: float
    position: float  # as a share of the arm's reach
    angle: float  # an orientation [rad]
    name: str  # in words
    com: float = 0.0  # besides, a centre of mass, where the simulator has it in the world frame [m]
    inertia_about_origin: float = 0.0


DOUBLE = Precision(number=1e-14, axis=1e-12, inertia=1e-13, position=1e-13, angle=1e-12, name="double precision")
"""The arithmetic of a simulator that computes in double precision, in a chain of some hundred links."""


class Comparison:
    """What a simulator holds, beside the robot that was written."""

    def __init__(self, simulator: str, request: LoadRequest, precision: Precision = DOUBLE) -> None:
        self.simulator, self.request, self.robot, self.precision = simulator, request, request.robot, precision

    def placed(self, problem: Problem) -> Problem:
        """The same problem as one of this robot, at the row of the joint that it is about."""
        row = next((each.mark for each in self.robot.joints if each.name == problem.joint), None)
        return replace(problem, robot=self.robot.name, mark=row or self.request.mark)

    def _found(self, code: str, **words: Any) -> Problem:  # noqa: ANN401 - of a message
        return self.placed(say(code, simulator=self.simulator, **words))

    def joints(self, held: Sequence[Mapping[str, Any]]) -> list[Problem]:
        """Where the moving joints that the simulator has differ from the robot's.

        A joint has its name and what a `LoadReport` has of it. A property that is left out is not compared.
        """
        found = {joint["name"]: joint for joint in held}
        written_names = {joint.name for joint in self.robot.moving_joints}
        problems = [self._found("joint-not-written", found=name) for name in found if name not in written_names]
        for joint in self.robot.moving_joints:
            if joint.name not in found:
                problems.append(self._found("joint-lost", joint=joint.name))
                continue
            for key, written in written_joint(joint).items():
                if written is None and key in {"velocity", "effort"}:
                    continue  # A joint of something attached has none, and each simulator its own number for that.
                if key in found[joint.name] and not self._same(value := found[joint.name][key], written):
                    values = {"found": _shown(value), "written": _shown(written)}
                    problems.append(self._found("joint-differs", joint=joint.name, field=key, **values))
        return problems

    def _same(self, found: Any, written: Any) -> bool:  # noqa: ANN401 - words, numbers and vectors
        if isinstance(written, tuple):
            return math.dist(found, written) <= self.precision.axis
        if isinstance(written, float) and found is not None:
            return bool(abs(found - written) <= self.precision.number * abs(written))
        return bool(found == written)

    def masses(
        self, held: Mapping[str, Body], written: Mapping[str, Inertial] | None = None
    ) -> tuple[dict[str, Any], list[Problem]]:
        """The mass of the arm and the largest errors of a link's, and where they are larger than they may be.

        The links that it should have are `written`: those of the robot by default.
        """
        if written is None:
            written = {link.name: link.inertial or Inertial(mass=0.0) for link in self.robot.links}
        problems: list[Problem] = []
        mass = mass_error = inertia_error = 0.0
        for name, body in written.items():
            if name not in held:
                problems.append(self._found("link-lost", link=name))
                continue
            if self.is_filled_in(name, body, held[name]):
                continue
            found, wanted = held[name], tensor(body.inertia)
            errors = {
                "mass": (abs(found.mass - body.mass), self.precision.number * body.mass, "kg"),
                "com": (
                    norm(subtract(found.com, body.com)),
                    self.precision.number * norm(body.com) + self.precision.com + _WITHOUT_EXTENT,
                    "m",
                ),
                "inertia": (
                    max(abs(is_ - was) for is_, was in zip(found.inertia, wanted, strict=True)),
                    self.precision.inertia * (wanted[0] + wanted[4] + wanted[8])
                    + self.precision.inertia_about_origin * body.mass * norm(body.com) ** 2,
                    "kg·m²",
                ),
            }
            problems += [
                self._found("link-differs", field=field, found=f"{error:.3g} {unit}", link=name, bound=bound, unit=unit)
                for field, (error, bound, unit) in errors.items()
                if not error <= bound  # NaN is not right either.
            ]
            mass += found.mass
            mass_error = max(mass_error, errors["mass"][0])
            inertia_error = max(inertia_error, errors["inertia"][0])
        return {"mass": mass, "mass_error": mass_error, "inertia_error": inertia_error}, problems

    def loaded(
        self,
        version: str,
        joints: Iterable[dict[str, Any]],
        bodies: Mapping[str, Body] | None,
        written: Mapping[str, Inertial] | None = None,
        others: Iterable[Problem] = (),
    ) -> LoadReport:
        """The report of an arm that has the joints and the masses that were written; others are a `LoaderError`.

        The bodies are None where the simulator does not tell; `others` is what else is wrong with the arm.
        """
        joints = tuple(joints)
        masses, problems = ({}, []) if bodies is None else self.masses(bodies, written)
        if problems := [*self.joints(joints), *others, *problems]:
            raise LoaderError(problems)
        return LoadReport(simulator=self.simulator, version=version, joints=joints, **masses)

    def is_filled_in(self, _name: str, _written: Inertial, _held: Body) -> bool:
        """Whether a link has a mass that the file gives it for the simulator's sake, and the robot does not."""
        return False

    def poses(self, frames: Callable[[Sequence[float], Sequence[str]], Mapping[str, RigidTransform]]) -> dict[str, Any]:
        """The largest errors of every tip, and at which joint vector; a `LoaderError` where they are too large.

        `frames` puts the arm at a joint vector, and returns where some links are in the root.
        """
        tolerances = {tip: self._tolerances(tip) for tip in self.request.expected}
        worst, worst_angle = 0.0, 0.0
        q_worst: tuple[float, ...] = ()
        for number, q in enumerate(self.request.poses):
            measured = frames(q, tuple(tolerances))
            for tip, allowed in tolerances.items():
                distance, angle = pose_error(measured[tip], self.request.expected[tip][number])
                if not (distance <= allowed[0] and angle <= allowed[1]):
                    off = f"{distance:.3g} m and {angle:.3g} rad"
                    about = {"q": _shown(tuple(q)), "precision": self.precision.name}
                    bounds = {"distance": allowed[0], "angle": allowed[1]}
                    raise LoaderError(self._found("tip-elsewhere", found=off, tip=tip, **about, **bounds))
                if distance >= worst:
                    worst, q_worst = distance, q
                worst_angle = max(worst_angle, angle)
        return {
            "position_error": worst,
            "angle_error": worst_angle,
            "tolerance": max((distance for distance, _ in tolerances.values()), default=0.0),
            "angle_tolerance": max((angle for _, angle in tolerances.values()), default=self.precision.angle),
            "q": tuple(q_worst),
            "poses": len(self.request.poses),
        }

    def _tolerances(self, tip: str) -> tuple[float, float]:
        """What a tip's position [m] and angle [rad] may be off: the simulator's arithmetic, and the chain's.

        Each frame of a chain is written with the rounding of the frame before and its own, so n joints give a tip
        n²/2 roundings: nothing for an arm (8e-15 for six axes), 2e-10 for a thousand axes.
        """
        chain = len(KinematicChain.between(self.robot, self.robot.root, tip).joints) ** 2 * DOUBLE_PRECISION
        position = (self.precision.position + chain) * reach(self.robot, tip) + _WITHOUT_EXTENT
        return position, self.precision.angle + chain


def written_joint(joint: Joint) -> dict[str, Any]:
    """What a simulator should have of a joint."""
    bounded = joint.type is not JointType.CONTINUOUS
    return {
        "type": joint.type.value,
        "axis": joint.axis,
        "lower": joint.limits.lower if bounded else None,
        "upper": joint.limits.upper if bounded else None,
        "velocity": joint.limits.velocity,
        "effort": joint.limits.effort,
    }


def _shown(value: Any) -> str:  # noqa: ANN401 - words, numbers and vectors
    return f"({', '.join(map(str, value))})" if isinstance(value, tuple) else str(value)


def reach(robot: Robot, tip: str) -> float:
    """The farthest that a link can be from its root [m]: the length of the chain, with its rails drawn out."""
    above = {joint.child: joint for joint in robot.joints}
    length, link = 0.0, tip
    while (joint := above.pop(link, None)) is not None:
        length += norm(joint.origin.xyz)
        if joint.type is JointType.PRISMATIC:
            length += max(abs(joint.limits.lower or 0.0), abs(joint.limits.upper or 0.0))
        link = joint.parent
    return length


def pose_error(measured: RigidTransform, expected: Sequence[float]) -> tuple[float, float]:
    """The distance [m] and the angle [rad] between a pose and the row-major 4x4 matrix that it should have.

    The angle follows from the Frobenius norm of the difference of the rotations, 2√2·sin(angle/2), which unlike the
    usual trace form is exact for small angles too.
    """
    expected_rotation = tuple(expected[4 * row + column] for row in range(3) for column in range(3))
    chord = math.dist(measured.rotation, expected_rotation) / math.sqrt(8.0)
    return math.dist(measured.translation, expected[3:12:4]), 2.0 * math.asin(min(1.0, chord))


# --- An arm that a loader has opened


def load_function(loader: Loader[Any]) -> Callable[[LoadRequest, Any], LoadReport]:
    """The function that opens a file with a loader, and measures the arm where the loader does not."""
    return update_wrapper(partial(load_opened, loader.open), loader.open)


def load_opened(
    open_arm: Callable[[LoadRequest, Any], SimulatedArm | LoadReport],
    request: LoadRequest,
    options: Any,  # noqa: ANN401 - the options of any loader
) -> LoadReport:
    """Open a file in a simulator, and compare joints, masses and poses with the robot that was written.

    A simulator that refuses the file, or has another arm, is a `LoaderError`; what a plugin must not give is a
    `TypeError` or a `ValueError`.
    """
    arm = open_arm(request, options)
    if isinstance(arm, LoadReport):
        return arm
    if not isinstance(arm, SimulatedArm):
        raise TypeError(f"open returned {type(arm).__name__}, neither a SimulatedArm nor a LoadReport")
    allowed = arm.tolerance
    precision = Precision(allowed, allowed, allowed, allowed, allowed, arm.simulator)
    comparison, bodies = Comparison(arm.simulator, request, precision), None

    def frames(q: Sequence[float], links: Sequence[str]) -> Mapping[str, RigidTransform]:
        return {link: _transform(arm.pose(link, q), link) for link in links}

    try:
        if arm.bodies is not None:
            bodies = {name: Body(each.mass, each.com, tensor(each.inertia)) for name, each in arm.bodies.items()}
        report = comparison.loaded(arm.version, map(_plain, arm.joints), bodies)
        return replace(report, findings=arm.findings, **comparison.poses(frames))
    finally:
        if arm.close is not None:
            arm.close()


def _plain(joint: Mapping[str, Any]) -> dict[str, Any]:
    """A joint with plain numbers, which a report can keep; what nobody compares is left as it is."""
    found, numbers = dict(joint), ("lower", "upper", "velocity", "effort")
    if "axis" in joint:
        found["axis"] = tuple(float(number) + 0.0 for number in joint["axis"])
    return found | {name: float(joint[name]) for name in numbers if joint.get(name) is not None}


def _transform(matrix: Any, link: str) -> RigidTransform:  # noqa: ANN401 - an array, or lists
    """A pose as a rigid transform."""
    if isinstance(matrix, RigidTransform):
        return matrix
    rows = [[float(number) for number in row] for row in matrix]
    if (found := [len(row) for row in rows]) != [_ROWS] * _ROWS:
        raise ValueError(f"the pose of {link!r} has rows of {found} numbers; accepted: four rows of four")
    (a, b, c, x), (d, e, f, y), (g, h, i, z), _ = rows
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))
