"""The arm as PyBullet holds it, measured and compared with the robot that was written.

The hold test uses Bullet's direct solver (Dantzig). The usual one, 50 rounds of Gauss-Seidel, gives way in chains of
parallel axes whatever their efforts are: held to 0.01 rad, 6 joints take 500 rounds, 10 joints 1,000, 20 joints 20,000
(half a minute), and 30 joints are 0.4 rad off after 10,000. The direct solver holds 6 to 100 joints within 1e-6 rad in
two seconds, and still lets an arm sink whose efforts are a tenth too small.

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
from dh2urdf.mass_properties import GRAVITY
from dh2urdf.measuring import Body, Precision
from dh2urdf.robot import Box, Inertial, Sphere
from dh2urdf.rotations import IDENTITY, RigidTransform, multiply, rotate, rotation_from_quaternion, transpose
from dh2urdf.stages import LoadReport
from dh2urdf_plugins.loaders.measures import (
    HOLD_SECONDS,
    OVERLAP,
    SINGLE_PRECISION,
    TIME_STEP,
    Comparison,
    hold_start,
    touching_pairs,
)
from dh2urdf_plugins.loaders.pybullet.picture import write_picture

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Link
    from dh2urdf.source import Problem
    from dh2urdf.stages import LoadRequest

SOFTNESS = 1e-9
"""Added to the diagonal of the direct solver's matrix, which is singular for joints that move no mass."""
MARGIN = 0.001
"""By how much Bullet thickens a cylinder or a mesh in its search for contacts [m]."""
SEARCHED = 0.01
"""Distance up to which Bullet searches for contacts [m]: with 0 it finds none between boxes that overlap."""

_ROUNDINGS = 4
"""Largest error of a measured pose, in roundings of the arm's reach (or of a half turn) to single precision.

PyBullet 3.2 computes link poses in double precision, but `getLinkState` gives them out by way of single precision: the
pose of the centre of mass and the inertial frame are rounded, the one inverted, and the two multiplied.
"""
_PRINCIPAL_AXES = 2e-6
"""Largest error of an inertia, as a share of the trace: PyBullet turns the tensor to its principal axes by Jacobi
rotations, which end when the products are below 1e-6 of the trace."""
_PRECISION = Precision(
    number=SINGLE_PRECISION,
    axis=_ROUNDINGS * SINGLE_PRECISION,
    inertia=_PRINCIPAL_AXES,
    position=_ROUNDINGS * SINGLE_PRECISION,
    angle=_ROUNDINGS * SINGLE_PRECISION * math.pi,
    name="single precision",
)
_ROOT = -1  # PyBullet's index of the root link


class Arm:
    """The arm as PyBullet holds it, beside the robot that was written."""

    def __init__(self, bullet: Any, request: LoadRequest) -> None:  # noqa: ANN401 - a module without type information
        self.bullet, self.request, self.robot = bullet, request, request.robot
        self.comparison = Comparison("PyBullet", request, _PRECISION)
        bullet.setPhysicsEngineParameter(
            enableFileCaching=0,  # Or a rewritten file would give the old arm again.
            constraintSolverType=bullet.CONSTRAINT_SOLVER_LCP_DANTZIG,
            globalCFM=SOFTNESS,
        )
        try:
            self.body = bullet.loadURDF(
                str(request.path.resolve()), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE
            )
        except bullet.error as error:
            raise LoaderError(self.comparison.problem(message="PyBullet cannot load the file")) from error
        infos = [bullet.getJointInfo(self.body, index) for index in range(bullet.getNumJoints(self.body))]
        self.moving = [info for info in infos if info[2] != bullet.JOINT_FIXED]
        self.joints = {_text(info[1]): info[0] for info in infos}
        self.links = {self.robot.root: _ROOT, **{_text(info[12]): info[0] for info in infos}}

    def report(self) -> LoadReport:
        """Measure everything.

        Raises:
            LoaderError: PyBullet holds another arm.
        """
        joints = tuple(map(self._held_joint, self.moving))
        masses, problems = self.comparison.masses(self._held_bodies(), self._written_bodies())
        if problems := [*self.comparison.joints(joints), *problems]:
            raise LoaderError(problems)
        report = LoadReport(simulator="PyBullet", version=version("pybullet"), joints=joints, **masses)
        if not self._gives_poses():
            return replace(report, findings=(self._too_many_joints(),))
        report = replace(report, **self.comparison.poses(self._frames))
        if self.moving:
            hold, findings = self._hold()
            report = replace(report, hold=hold, findings=findings)
        if self.request.picture:
            write_picture(self.bullet, self.robot, self._all_frames, self.request.picture)
            report = replace(report, picture=self.request.picture.name)
        return report

    def set_joints(self, q: Sequence[float]) -> None:
        """Put the arm at a joint vector, at rest."""
        for joint, value in zip(self.robot.moving_joints, q, strict=True):
            self.bullet.resetJointState(self.body, self.joints[joint.name], value)

    def _held_joint(self, info: Sequence[Any]) -> dict[str, Any]:
        """A joint as PyBullet has it; its axis is held in the inertial frame, and turned back to the link frame."""
        lower, upper = info[8], info[9]
        endless = info[2] == self.bullet.JOINT_REVOLUTE and lower > upper
        names = {self.bullet.JOINT_REVOLUTE: "revolute", self.bullet.JOINT_PRISMATIC: "prismatic"}
        inertial_frame = rotation_from_quaternion(self.bullet.getDynamicsInfo(self.body, info[0])[4])
        return {
            "name": _text(info[1]),
            "type": "continuous" if endless else names.get(info[2], f"number {info[2]}"),
            "axis": tuple(round(element, 12) + 0.0 for element in rotate(inertial_frame, info[13])),
            "lower": None if endless else lower,
            "upper": None if endless else upper,
            "velocity": info[11],
            "effort": info[10],
        }

    def _written_bodies(self) -> dict[str, Inertial]:
        """The links that PyBullet should have; not the root: it is the world's, and PyBullet makes it weightless."""
        return {link.name: link.inertial or Inertial(mass=0.0) for link in self.robot.links[1:]}

    def _held_bodies(self) -> dict[str, Body]:
        """The links as PyBullet has them: the inertia is held in its principal axes, and turned back to the link."""
        bodies = {}
        for name, index in self.links.items():
            mass, _, moments, com, orientation = self.bullet.getDynamicsInfo(self.body, index)[:5]
            axes = rotation_from_quaternion(orientation)
            principal = (moments[0], 0, 0, 0, moments[1], 0, 0, 0, moments[2])
            bodies[name] = Body(mass, com, multiply(multiply(axes, principal), transpose(axes)))
        return bodies

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
        return self.comparison.problem(
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
        return RigidTransform(rotation_from_quaternion(state[5]), state[4])

    def _frames(self, q: Sequence[float], links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world at a joint vector."""
        self.set_joints(q)
        return {name: self._frame(self.links[name]) for name in links}

    def _all_frames(self, q: Sequence[float]) -> dict[str, RigidTransform]:
        """The frames of all links in the world at a joint vector."""
        return self._frames(q, [link.name for link in self.robot.links])

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
        return self.comparison.hold(start, displacement, contacts)

    def _touch(self, first: str, second: str) -> bool:
        """Whether the shapes of two links overlap, by more than Bullet's margins around them."""
        links = self.links[first], self.links[second]
        points = self.bullet.getClosestPoints(self.body, self.body, SEARCHED, *links)
        margins = sum(_margin(link) for link in self.robot.links if link.name in {first, second})
        return any(-point[8] - margins > OVERLAP for point in points)


def _margin(link: Link) -> float:
    """By how much Bullet thickens the shapes of a link at most [m]."""
    return max(0.0 if isinstance(shape.geometry, Box | Sphere) else MARGIN for shape in link.collisions)


def _text(name: bytes) -> str:
    return name.decode("utf-8", "replace")
