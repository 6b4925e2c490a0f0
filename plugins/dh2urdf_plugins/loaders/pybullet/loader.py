"""The loader `pybullet`: loads the written URDF into PyBullet, measures the arm, and reads what PyBullet prints.

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
import re
import time
from dataclasses import replace
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.measuring import Precision
from dh2urdf.robot import Box, Inertial, Sphere
from dh2urdf.source import Messages
from dh2urdf_plugins.loaders.measures import (
    HOLD_SECONDS,
    OVERLAP,
    SINGLE_PRECISION,
    TIME_STEP,
    Comparison,
    farthest,
    hold_start,
    printed,
    touching_pairs,
)
from dh2urdf_plugins.loaders.pybullet.model import NO_INERTIA, Model, messages
from dh2urdf_plugins.loaders.simulators import PACKAGES
from dh2urdf_plugins.loaders.viewpoint import (
    FIELD_OF_VIEW,
    FLOOR,
    HEIGHT,
    SUPERSAMPLING,
    WIDTH,
    best_view,
    write_png,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.robot import Link
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Problem
    from dh2urdf.stages import LoadReport, LoadRequest
    from dh2urdf_plugins.loaders.simulators import PyBulletOptions

say = Messages(__file__)

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
_SHADOWS_UP_TO = 5.0  # [m] from the camera: beyond, the renderer's fixed bias lets every surface shade itself


class Arm(Model):
    """The arm as PyBullet holds it, beside the robot that was written."""

    def __init__(self, bullet: Any, request: LoadRequest) -> None:  # noqa: ANN401 - a module without type information
        self.request, self.robot = request, request.robot
        self.comparison = Comparison("PyBullet", request, _PRECISION)
        bullet.setPhysicsEngineParameter(
            enableFileCaching=0,  # Or a rewritten file would give the old arm again.
            constraintSolverType=bullet.CONSTRAINT_SOLVER_LCP_DANTZIG,
            globalCFM=SOFTNESS,
        )
        try:
            body = bullet.loadURDF(
                str(request.path.resolve()), useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE
            )
        except bullet.error as error:
            raise LoaderError(self.comparison.placed(say("cannot-load", simulator="PyBullet"))) from error
        super().__init__(bullet, body, self.robot.root)

    def report(self) -> LoadReport:
        """Measure everything.

        Raises:
            LoaderError: PyBullet holds another arm.
        """
        # The root is the world's, and PyBullet makes it weightless.
        written = {link.name: link.inertial or Inertial(mass=0.0) for link in self.robot.links[1:]}
        joints = map(self.held_joint, self.moving)
        report = self.comparison.loaded(version("pybullet"), joints, self.held_bodies(), written)
        if not self._gives_poses():
            found = f"{len(self.moving)} moving joints, {len(self.links) - 1} links"
            accepted = "at most 121 moving joints, and 127 links without the root"
            return replace(report, findings=self.comparison.too_large("pybullet-arm-too-large", found, accepted))
        report = replace(report, **self.comparison.poses(self._frames))
        if self.moving:
            hold, findings = self._hold()
            report = replace(report, hold=hold, findings=findings)
        if self.request.picture:
            self._write_picture(self.request.picture)
            report = replace(report, picture=self.request.picture.name)
        return report

    def set_joints(self, q: Sequence[float]) -> None:
        """Put the arm at a joint vector, at rest."""
        for joint, value in zip(self.robot.moving_joints, q, strict=True):
            self.bullet.resetJointState(self.body, self.joints[joint.name], value)

    # Poses

    def _gives_poses(self) -> bool:
        """Whether PyBullet moves every joint and tells where every link is.

        Its messages hold 128 numbers per robot: beyond, it refuses to tell, or in silence moves the last joints not at
        all and tells them wrong.
        """
        try:
            self.frame(max(self.links.values()))
            if not self.moving:
                return True
            last, somewhere = max(info[0] for info in self.moving), 0.125
            self.bullet.resetJointState(self.body, last, somewhere)
            return bool(self.bullet.getJointState(self.body, last)[0] == somewhere)
        except self.bullet.error:
            return False

    def _frames(self, q: Sequence[float], links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world at a joint vector."""
        self.set_joints(q)
        return {name: self.frame(self.links[name]) for name in links}

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

        def vectors() -> Iterator[list[float]]:
            for _ in range(round(HOLD_SECONDS / TIME_STEP)):
                bullet.stepSimulation()
                yield [state[0] for state in bullet.getJointStates(self.body, indices)]

        return self.comparison.hold(start, farthest(start, vectors()), contacts)

    def _touch(self, first: str, second: str) -> bool:
        """Whether the shapes of two links overlap, by more than Bullet's margins around them."""
        links = self.links[first], self.links[second]
        points = self.bullet.getClosestPoints(self.body, self.body, SEARCHED, *links)
        margins = sum(_margin(link) for link in self.robot.links if link.name in {first, second})
        return any(-point[8] - margins > OVERLAP for point in points)

    def _write_picture(self, path: Path) -> None:
        """Render the arm by PyBullet's software renderer, which needs no display and no graphics card."""
        from PIL import Image

        bullet, links = self.bullet, [link.name for link in self.robot.links]
        view = best_view(self.robot, lambda q: self._frames(q, links))
        self.set_joints(view.q)
        # A light floor under the arm, for its shadow to fall on.
        (x, y, z), half = view.floor
        thickness = half / 100
        shape = bullet.createVisualShape(
            bullet.GEOM_BOX, halfExtents=(half, half, thickness), rgbaColor=FLOOR, specularColor=(0, 0, 0)
        )
        bullet.createMultiBody(baseVisualShapeIndex=shape, basePosition=(x, y, z - thickness))
        width, height = WIDTH * SUPERSAMPLING, HEIGHT * SUPERSAMPLING
        pixels = bullet.getCameraImage(
            width,
            height,
            viewMatrix=bullet.computeViewMatrix(view.eye, view.target, (0.0, 0.0, 1.0)),
            projectionMatrix=bullet.computeProjectionMatrixFOV(
                math.degrees(FIELD_OF_VIEW), WIDTH / HEIGHT, view.distance / 100, view.distance * 100
            ),
            shadow=int(view.distance < _SHADOWS_UP_TO),
            lightDirection=(0.6, -0.5, 1.2),
            lightDistance=4
            * view.distance,  # The shadows have the camera's lens: from afar they cover all that is seen.
            lightAmbientCoeff=0.6,
            lightDiffuseCoeff=0.5,
            lightSpecularCoeff=0.05,
            renderer=bullet.ER_TINY_RENDERER,
        )[2]
        write_png(Image.frombytes("RGBA", (width, height), bytes(pixels)).convert("RGB"), path)


def _margin(link: Link) -> float:
    """By how much Bullet thickens the shapes of a link at most [m]."""
    return max(0.0 if isinstance(shape.geometry, Box | Sphere) else MARGIN for shape in link.collisions)


def load(request: LoadRequest, options: PyBulletOptions) -> LoadReport:
    """Load a URDF into PyBullet and measure it.

    Raises:
        LoaderError: PyBullet cannot load the file, or holds another arm than the one that was written.
        MissingDependencyError: PyBullet, or Pillow for a picture, is not installed.
    """
    bullet = PACKAGES["pybullet"].load(options)
    bullet.connect(bullet.GUI if options.gui else bullet.DIRECT)
    try:
        report = Arm(bullet, request).report()
        while options.gui and bullet.isConnected():  # Closing the window ends the connection.
            time.sleep(0.1)
    finally:
        if bullet.isConnected():
            bullet.disconnect()
    return report


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """The warnings and errors that PyBullet printed.

    PyBullet gives the name of the link or joint that it speaks of in a message of its own. Of the empty root it says
    that it has no inertial and will weigh 1 kg, which is expected: the world holds the root, and it weighs nothing.
    """
    robot = request.robot
    names = {*(link.name for link in robot.links), *(joint.name for joint in robot.joints)}
    of_root = re.compile(rf"{NO_INERTIA}.*: {re.escape(robot.root)}", re.DOTALL)
    said = messages(output, lambda text: text in names)
    return printed("PyBullet", request, [each for each in said if not of_root.fullmatch(each[1])])
