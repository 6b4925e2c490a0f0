"""The arm as PyBullet holds it, measured and compared with the robot that was written.

PyBullet is no validator: it takes the faults of a description in silence, prints through C, or crashes. So the arm is
asked what it became: its joints, its masses and inertias, where tool0 is, and whether it can hold its own weight. The
source is https://github.com/bulletphysics/bullet3, in examples/SharedMemory and examples/Importers/ImportURDFDemo.
"""

from __future__ import annotations

import math
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Inertial
from dh2urdf.rotations import IDENTITY, RigidTransform, Rotation, multiply, norm, rotate, subtract, transpose
from dh2urdf.source import Problem, shown
from dh2urdf.stages import LoadReport
from dh2urdf_plugins.loaders.measures import (
    GRAVITY,
    HOLD_SECONDS,
    HOLD_STAYS,
    SINGLE_PRECISION,
    hold_start,
    pose_error,
    reach,
    tensor,
    touching_pairs,
)
from dh2urdf_plugins.loaders.pybullet_picture import write_picture

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.robot import Joint
    from dh2urdf.stages import LoadRequest

TIME_STEP = 1 / 240
"""PyBullet's usual time step [s]."""
MARGIN = 0.001
"""By how much Bullet thickens a cylinder or a mesh in its search for contacts [m]."""

_ROUNDINGS = 4
"""Largest error of a measured pose, in roundings of the arm's reach (or of a half turn) to single precision [1].

PyBullet 3.2 computes link poses in double precision, but `getLinkState` gives them out by way of single precision: the
pose of the centre of mass and the inertial frame are rounded, the one inverted, and the two multiplied.
"""
_DOUBLE_PRECISION = 1e-12
"""What an arm without extent is allowed [m]."""
_PRINCIPAL_AXES = 2e-6
"""Largest error of an inertia [1], as a share of the trace: PyBullet turns the tensor to its principal axes by Jacobi
rotations, which end when the products are below 1e-6 of the trace."""
_ROOT = -1  # PyBullet's index of the root link
_SHOWN_PAIRS = 5


class Arm:
    """The arm as PyBullet holds it, beside the robot that was written."""

    def __init__(self, bullet: Any, request: LoadRequest) -> None:  # noqa: ANN401 - a module without type information
        self.bullet, self.request, self.robot = bullet, request, request.robot
        bullet.setPhysicsEngineParameter(enableFileCaching=0)  # Or a rewritten file would give the old arm again.
        try:
            self.body = bullet.loadURDF(
                str(request.path.resolve()), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE
            )
        except bullet.error as error:
            raise LoaderError(self.problem(message="PyBullet cannot load the file")) from error
        infos = [bullet.getJointInfo(self.body, index) for index in range(bullet.getNumJoints(self.body))]
        self.moving = [info for info in infos if info[2] != bullet.JOINT_FIXED]
        self.joints = {_text(info[1]): info[0] for info in infos}
        self.links = {self.robot.root: _ROOT, **{_text(info[12]): info[0] for info in infos}}

    def problem(self, *, joint: str | None = None, **words: Any) -> Problem:  # noqa: ANN401 - those of a Problem
        """A problem of this robot, at the row of the joint that it is about."""
        row = next((each.mark for each in self.robot.joints if each.name == joint), None)
        return Problem(robot=self.robot.name, mark=row or self.request.mark, joint=joint, **words)

    def report(self) -> LoadReport:
        """Measure everything.

        Raises:
            LoaderError: PyBullet holds another arm.
        """
        joints, problems = self._compare_joints()
        masses, more_problems = self._compare_masses()
        if problems := [*problems, *more_problems]:
            raise LoaderError(problems)
        report = LoadReport(simulator="PyBullet", version=version("pybullet"), joints=joints, **masses)
        if not self._gives_poses():
            return replace(report, findings=(self._too_many_joints(),))
        report = replace(report, **self._compare_poses())
        if self.moving:
            hold, findings = self._hold()
            report = replace(report, hold=hold, findings=findings)
        if self.request.picture:
            write_picture(self.bullet, self.robot, self._frames, self.request.picture)
            report = replace(report, picture=self.request.picture.name)
        return report

    def set_joints(self, q: Sequence[float]) -> None:
        """Put the arm at a joint vector, at rest."""
        for joint, value in zip(self.robot.moving_joints, q, strict=True):
            self.bullet.resetJointState(self.body, self.joints[joint.name], value)

    # Joints

    def _compare_joints(self) -> tuple[tuple[dict[str, Any], ...], list[Problem]]:
        """The moving joints as PyBullet has them, and where they differ from the robot's."""
        held = {joint["name"]: joint for joint in map(self._held_joint, self.moving)}
        written_names = {joint.name for joint in self.robot.moving_joints}
        problems = [
            self.problem(message="PyBullet has a joint that was not written", found=name)
            for name in held
            if name not in written_names
        ]
        for joint in self.robot.moving_joints:
            if joint.name not in held:
                problems.append(self.problem(message="PyBullet has lost the joint", joint=joint.name))
                continue
            for key, written in _written_joint(joint).items():
                if not _same(found := held[joint.name][key], written):
                    problems.append(
                        self.problem(
                            message=f"PyBullet has {key} {_shown(found)} where {_shown(written)} was written",
                            joint=joint.name,
                            field=key,
                            found=_shown(found),
                            accepted=_shown(written),
                        )
                    )
        return tuple(held.values()), problems

    def _held_joint(self, info: Sequence[Any]) -> dict[str, Any]:
        """A joint as PyBullet has it; its axis is held in the inertial frame, and turned back to the link frame."""
        lower, upper = info[8], info[9]
        endless = info[2] == self.bullet.JOINT_REVOLUTE and lower > upper
        names = {self.bullet.JOINT_REVOLUTE: "revolute", self.bullet.JOINT_PRISMATIC: "prismatic"}
        inertial_frame = _rotation(self.bullet.getDynamicsInfo(self.body, info[0])[4])
        return {
            "name": _text(info[1]),
            "type": "continuous" if endless else names.get(info[2], f"number {info[2]}"),
            "axis": tuple(round(element, 12) + 0.0 for element in rotate(inertial_frame, info[13])),
            "lower": None if endless else lower,
            "upper": None if endless else upper,
            "velocity": info[11],
            "effort": info[10],
        }

    # Masses

    def _compare_masses(self) -> tuple[dict[str, Any], list[Problem]]:
        """The mass of the arm and the largest errors of a link's, and where they are larger than PyBullet's arithmetic.

        The root is left out: it is the world's, and PyBullet makes it weightless.
        """
        problems: list[Problem] = []
        mass = mass_error = inertia_error = 0.0
        for link in self.robot.links[1:]:
            if link.name not in self.links:
                problems.append(self.problem(message=f"PyBullet has lost the link {shown(link.name)}"))
                continue
            written = link.inertial or Inertial(mass=0.0)
            wanted = tensor(written.inertia)
            found, _, principal, com, orientation = self.bullet.getDynamicsInfo(self.body, self.links[link.name])[:5]
            axes = _rotation(orientation)
            held = multiply(
                multiply(axes, (principal[0], 0, 0, 0, principal[1], 0, 0, 0, principal[2])), transpose(axes)
            )
            errors = {
                "mass": (abs(found - written.mass), SINGLE_PRECISION * written.mass, "kg"),
                "com": (norm(subtract(com, written.com)), SINGLE_PRECISION * norm(written.com), "m"),
                "inertia": (
                    max(abs(is_ - was) for is_, was in zip(held, wanted, strict=True)),
                    _PRINCIPAL_AXES * (wanted[0] + wanted[4] + wanted[8]),
                    "kg·m²",
                ),
            }
            problems += [
                self.problem(
                    message=f"PyBullet has another {name} of the link {shown(link.name)}, by {error:.3g} {unit}",
                    field=name,
                    found=f"{error:.3g} {unit}",
                    accepted=f"at most {bound:.3g} {unit}",
                )
                for name, (error, bound, unit) in errors.items()
                if not error <= bound  # NaN is not right either.
            ]
            mass += found
            mass_error = max(mass_error, errors["mass"][0])
            inertia_error = max(inertia_error, errors["inertia"][0])
        return {"mass": mass, "mass_error": mass_error, "inertia_error": inertia_error}, problems

    # Poses

    def _gives_poses(self) -> bool:
        """Whether PyBullet moves every joint and tells where every link is.

        Its messages hold 128 numbers per robot: beyond, it refuses to tell, or in silence moves the last joints not at
        all and tells them wrong.
        """
        try:
            self._frame(max(self.links.values()))
            if not self.moving:
                return True
            last, somewhere = max(info[0] for info in self.moving), 0.125
            self.bullet.resetJointState(self.body, last, somewhere)
            return bool(self.bullet.getJointState(self.body, last)[0] == somewhere)
        except self.bullet.error:
            return False

    def _too_many_joints(self) -> Problem:
        found = f"{len(self.moving)} moving joints, {len(self.links) - 1} links"
        return self.problem(
            message=f"PyBullet cannot move so large an arm ({found}): only joints and masses were compared",
            severity="notice",
            found=found,
            accepted="at most 121 moving joints, and 127 links without the root",
        )

    def _frame(self, link: int) -> RigidTransform:
        """The frame of a link in the world, in whose origin the root stands."""
        if link == _ROOT:
            return IDENTITY
        state = self.bullet.getLinkState(self.body, link, computeForwardKinematics=1)
        return RigidTransform(_rotation(state[5]), state[4])

    def _frames(self, q: Sequence[float]) -> dict[str, RigidTransform]:
        """The frames of all links in the world at a joint vector."""
        self.set_joints(q)
        return {link.name: self._frame(self.links[link.name]) for link in self.robot.links}

    def _compare_poses(self) -> dict[str, Any]:
        """The largest errors of every tip, and at which joint vector.

        Raises:
            LoaderError: they are larger than PyBullet's arithmetic.
        """
        tolerances = {
            tip: _ROUNDINGS * SINGLE_PRECISION * reach(self.robot, tip) + _DOUBLE_PRECISION
            for tip in self.request.expected
        }
        angle_tolerance = _ROUNDINGS * SINGLE_PRECISION * math.pi
        worst, worst_angle = 0.0, 0.0
        q_worst: tuple[float, ...] = ()
        for number, q in enumerate(self.request.poses):
            self.set_joints(q)
            for tip, tolerance in tolerances.items():
                distance, angle = pose_error(self._frame(self.links[tip]), self.request.expected[tip][number])
                if not (distance <= tolerance and angle <= angle_tolerance):
                    raise LoaderError(
                        self.problem(
                            message=f"PyBullet has {tip} in another place, {distance:.3g} m and {angle:.3g} rad away, "
                            f"at q = {_shown(q)}",
                            found=f"{distance:.3g} m and {angle:.3g} rad",
                            accepted=f"the error of single precision, {tolerance:.3g} m and {angle_tolerance:.3g} rad",
                        )
                    )
                if distance >= worst:
                    worst, q_worst = distance, q
                worst_angle = max(worst_angle, angle)
        return {
            "position_error": worst,
            "angle_error": worst_angle,
            "tolerance": max(tolerances.values(), default=0.0),
            "angle_tolerance": angle_tolerance,
            "q": tuple(q_worst),
            "poses": len(self.request.poses),
        }

    # The hold test

    def _hold(self) -> tuple[dict[str, Any], tuple[Problem, ...]]:
        """Whether the motors, with the efforts that were written, keep the arm where it is under gravity."""
        bullet, joints = self.bullet, self.robot.moving_joints
        start = hold_start(self.robot)
        self.set_joints(start)
        contacts = [pair for pair in touching_pairs(self.robot) if self._touch(*pair)]
        bullet.setTimeStep(TIME_STEP)
        bullet.setGravity(0, 0, -GRAVITY)
        for joint, value in zip(joints, start, strict=True):
            bullet.setJointMotorControl2(
                self.body,
                self.joints[joint.name],
                bullet.POSITION_CONTROL,
                targetPosition=value,
                force=joint.limits.effort or 0.0,
            )
        indices = [self.joints[joint.name] for joint in joints]
        displacement = [0.0] * len(joints)
        for _ in range(round(HOLD_SECONDS / TIME_STEP)):
            bullet.stepSimulation()
            for number, state in enumerate(bullet.getJointStates(self.body, indices)):
                moved = abs(state[0] - start[number])
                displacement[number] = max(displacement[number], moved if math.isfinite(moved) else math.inf)
        largest = max(displacement, default=0.0)
        weakest = joints[displacement.index(largest)] if largest > 0.0 else None
        hold = {
            "seconds": HOLD_SECONDS,
            "start": start,
            "largest_displacement": largest if math.isfinite(largest) else None,
            "joint": weakest.name if weakest else None,
            "threshold": HOLD_STAYS,
            "stayed": largest <= HOLD_STAYS,
            "contacts": contacts,
        }
        return hold, tuple(self._hold_findings(weakest, largest, contacts))

    def _touch(self, first: str, second: str) -> bool:
        """Whether the shapes of two links overlap, by more than Bullet's margin around each."""
        points = self.bullet.getClosestPoints(self.body, self.body, 0.0, self.links[first], self.links[second])
        return any(point[8] < -2.0 * MARGIN for point in points)

    def _hold_findings(
        self, weakest: Joint | None, largest: float, contacts: Sequence[tuple[str, str]]
    ) -> Iterator[Problem]:
        if weakest and largest > HOLD_STAYS:
            unit = "m" if weakest.type is JointType.PRISMATIC else "rad"
            by = f"{largest:.3g} {unit}" if math.isfinite(largest) else "without end"
            yield self.problem(
                message=f"the arm did not stay in place: in {HOLD_SECONDS:g} s under gravity this joint moved by {by}",
                severity="notice",
                joint=weakest.name,
                field="limits.effort",
                found=str(weakest.limits.effort),
                suggestion="give the joint the effort that its motor has",
            )
        if contacts:
            pairs = [f"{shown(first)} and {shown(second)}" for first, second in contacts[:_SHOWN_PAIRS]]
            pairs += [f"{more} more pairs"] if (more := len(contacts) - _SHOWN_PAIRS) > 0 else []
            yield self.problem(
                message=f"collision shapes of the arm overlap at the start of the hold test: {', '.join(pairs)}",
                severity="notice",
                suggestion="switch the arm's contacts with itself off, or give these links a smaller radius",
            )


def _written_joint(joint: Joint) -> dict[str, Any]:
    """What PyBullet should have of a joint."""
    bounded = joint.type is not JointType.CONTINUOUS
    return {
        "type": joint.type.value,
        "axis": joint.axis,
        "lower": joint.limits.lower if bounded else None,
        "upper": joint.limits.upper if bounded else None,
        "velocity": joint.limits.velocity,
        "effort": joint.limits.effort,
    }


def _same(found: Any, written: Any) -> bool:  # noqa: ANN401 - words, numbers and vectors
    """Whether two values of a joint are the same within single precision."""
    if isinstance(written, tuple):
        return math.dist(found, written) <= _ROUNDINGS * SINGLE_PRECISION
    if isinstance(written, float):
        return found is not None and abs(found - written) <= SINGLE_PRECISION * abs(written)
    return bool(found == written)


def _shown(value: Any) -> str:  # noqa: ANN401 - words, numbers and vectors
    return f"({', '.join(map(str, value))})" if isinstance(value, tuple) else str(value)


def _text(name: bytes) -> str:
    return name.decode("utf-8", "replace")


def _rotation(quaternion: Sequence[float]) -> Rotation:
    """The rotation of a quaternion (x, y, z, w); it need not be normalised to the last digit."""
    x, y, z, w = quaternion
    s = 2.0 / (x * x + y * y + z * z + w * w)
    return (
        *(1 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)),
        *(s * (x * y + z * w), 1 - s * (x * x + z * z), s * (y * z - x * w)),
        *(s * (x * z - y * w), s * (y * z + x * w), 1 - s * (x * x + y * y)),
    )
