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
import sys
import time
from contextlib import suppress
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.measuring import Body, Precision
from dh2urdf.robot import Box, Inertial, Sphere
from dh2urdf.rotations import IDENTITY, RigidTransform, multiply, rotate, rotation_from_quaternion, transpose
from dh2urdf.source import Messages, listed
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.loaders import measures, viewpoint

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.robot import Robot
    from dh2urdf.stages import LoadReport, LoadRequest, Question
    from dh2urdf_plugins.loaders.simulators import PyBulletOptions

say = Messages(__file__)

SOFTNESS = 1e-9  # added to the diagonal of the direct solver's matrix, which is singular for joints that move no mass
MARGIN = 0.001  # by how much Bullet thickens a cylinder or a mesh in its search for contacts [m]
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
    number=measures.SINGLE_PRECISION,
    axis=_ROUNDINGS * measures.SINGLE_PRECISION,
    inertia=_PRINCIPAL_AXES,
    position=_ROUNDINGS * measures.SINGLE_PRECISION,
    angle=_ROUNDINGS * measures.SINGLE_PRECISION * math.pi,
    name="single precision",
)
_SHADOWS_UP_TO = 5.0  # [m] from the camera: beyond, the renderer's fixed bias lets every surface shade itself
_ROOT = -1  # PyBullet's index of the root link
_NO_FILE = b"unknown_file"


class Held(measures.Model):
    """A body as PyBullet holds it; `base` is where the root is in the world."""

    def __init__(self, body: int, root: str) -> None:
        self.bullet: Any = sys.modules["pybullet"]
        self.body, self.base = body, IDENTITY
        infos = [self.bullet.getJointInfo(body, index) for index in range(self.bullet.getNumJoints(body))]
        self.moving = [info for info in infos if info[2] != self.bullet.JOINT_FIXED]
        self.joints = {_text(info[1]): info[0] for info in infos}
        self.links = {root: _ROOT, **{_text(info[12]): info[0] for info in infos}}

    def held_joint(self, info: Sequence[Any]) -> dict[str, Any]:
        """A joint as PyBullet has it; its axis is held in the inertial frame, and turned back to the link frame."""
        lower, upper = info[8], info[9]
        endless = info[2] == self.bullet.JOINT_REVOLUTE and lower > upper
        names = {self.bullet.JOINT_REVOLUTE: "revolute", self.bullet.JOINT_PRISMATIC: "prismatic"}
        inertial_frame = rotation_from_quaternion(self.bullet.getDynamicsInfo(self.body, info[0])[4])
        kind = "continuous" if endless else names.get(info[2], f"number {info[2]}")
        axis = tuple(round(element, 12) + 0.0 for element in rotate(inertial_frame, info[13]))
        return measures.joint_record(_text(info[1]), kind, axis, lower, upper, velocity=info[11], effort=info[10])

    def held_bodies(self) -> dict[str, Body]:
        """The links as PyBullet has them: the inertia is held in its principal axes, and turned back to the link."""
        bodies = {}
        for name, index in self.links.items():
            mass, _, moments, com, orientation = self.bullet.getDynamicsInfo(self.body, index)[:5]
            axes = rotation_from_quaternion(orientation)
            principal = (moments[0], 0, 0, 0, moments[1], 0, 0, 0, moments[2])
            bodies[name] = Body(mass, com, multiply(multiply(axes, principal), transpose(axes)))
        return bodies

    def put(self, values: Mapping[str, float]) -> None:
        """Put joints at values [rad or m], at rest."""
        for name, value in values.items():
            if name in self.joints:
                self.bullet.resetJointState(self.body, self.joints[name], value)

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world."""
        return {name: self.frame(self.links[name]) for name in links}

    def frame(self, link: int) -> RigidTransform:
        """The frame of a link in the world."""
        if link == _ROOT:
            return self.base
        state = self.bullet.getLinkState(self.body, link, computeForwardKinematics=1)
        return RigidTransform(rotation_from_quaternion(state[5]), state[4])

    def held_base(self) -> RigidTransform:
        """The frame of the root in the world, where a file puts it elsewhere: Bullet moves its centre of mass."""
        position, orientation = self.bullet.getBasePositionAndOrientation(self.body)
        com, axes = self.bullet.getDynamicsInfo(self.body, _ROOT)[3:5]
        centre = RigidTransform(rotation_from_quaternion(orientation), position)
        return centre @ RigidTransform(rotation_from_quaternion(axes), com).inverse

    def held_shapes(self) -> Iterator[tuple[str, str, measures.Lengths | None]]:
        """The lengths of the shapes of each link; of meshes, of those that touch.

        A cylinder of a URDF becomes a hull with a margin around it, which has no file: its size is not told.
        """
        import numpy as np

        bullet = self.bullet
        visuals = bullet.getVisualShapeData(self.body)
        for name, index in self.links.items():
            solids = bullet.getCollisionShapeData(self.body, index)
            for at, (_, _, kind, size, file, _, turned, *_) in enumerate(solids):
                lengths = self._size(kind, size)
                if kind == bullet.GEOM_MESH and file not in {b"", _NO_FILE}:
                    # Bullet has it along the principal axes of the link; the lengths are along the axes of its file.
                    vertices = np.array(bullet.getMeshData(self.body, index, collisionShapeIndex=at)[1]).reshape(-1, 3)
                    axes = np.array(bullet.getMatrixFromQuaternion(turned)).reshape(3, 3)
                    lengths = measures.lengths_of(vertices @ axes)
                yield name, measures.COLLISION, lengths
            for _, of, kind, size, *_ in visuals:
                if of == index:
                    yield name, measures.VISUAL, self._size(kind, size)

    def _size(self, kind: int, size: Sequence[float]) -> measures.Lengths | None:
        bullet = self.bullet
        if kind == bullet.GEOM_BOX:
            return measures.lengths(*size)
        if kind == bullet.GEOM_SPHERE:
            return measures.round_lengths(size[0])
        if kind in {bullet.GEOM_CYLINDER, bullet.GEOM_CAPSULE}:
            length, radius = size[:2]
            return measures.round_lengths(radius, length + (2 * radius if kind == bullet.GEOM_CAPSULE else 0.0))
        return None


def _text(name: bytes) -> str:
    """A name, which PyBullet has as bytes."""
    return name.decode("utf-8", "replace")


# --- The arm of a run


def load(request: LoadRequest, options: PyBulletOptions) -> LoadReport:
    """Load a URDF into PyBullet and measure it."""
    bullet: Any = sys.modules["pybullet"]
    bullet.connect(bullet.GUI if options.gui else bullet.DIRECT)
    try:
        report = _report(bullet, request)
        while options.gui and bullet.isConnected():  # Closing the window ends the connection.
            time.sleep(0.1)
    finally:
        if bullet.isConnected():
            bullet.disconnect()
    return report


def _report(bullet: Any, request: LoadRequest) -> LoadReport:  # noqa: ANN401 - a module without type information
    """Measure everything."""
    robot, comparison = request.robot, measures.Comparison("PyBullet", request, _PRECISION)
    floats = robot.root in robot.floating
    bullet.setPhysicsEngineParameter(
        enableFileCaching=0,  # Or a rewritten file would give the old arm again.
        constraintSolverType=bullet.CONSTRAINT_SOLVER_LCP_DANTZIG,
        globalCFM=SOFTNESS,
    )
    try:
        inertia = bullet.URDF_USE_INERTIA_FROM_FILE
        body = bullet.loadURDF(str(request.path.resolve()), useFixedBase=not floats, flags=inertia)
    except bullet.error as error:
        raise LoaderError(comparison.placed(say("cannot-load", simulator="PyBullet"))) from error
    held = Held(body, robot.root)
    # A root that does not float is the world's, and PyBullet makes it weightless.
    links, bodies = robot.links if floats else robot.links[1:], held.held_bodies()
    written = {link.name: link.inertial or Inertial(mass=0.0) for link in links}
    # What is attached keeps frames without an inertial: PyBullet takes each for 1 kg.
    bare = {link.name for link in links if link.inertial is None and bodies[link.name].mass == 1.0}
    joints = map(held.held_joint, held.moving)
    written = {name: inertial for name, inertial in written.items() if name not in bare}
    report = comparison.loaded(version("pybullet"), joints, bodies, written)
    if bare:
        heavy = say("pybullet-heavy-frames", count=len(bare), links=listed(sorted(bare)))
        report = replace(report, findings=(comparison.placed(heavy),))
    if floats and not bodies[robot.root].mass:
        still = comparison.placed(say("pybullet-holds-root", root=robot.root))
        report = replace(report, findings=(*report.findings, still))
    if not _gives_poses(held):
        found = f"{len(held.moving)} moving joints, {len(held.links) - 1} links"
        accepted = "at most 121 moving joints, and 127 links without the root"
        too_large = say("pybullet-arm-too-large", found=found, accepted=accepted)
        return replace(report, findings=(comparison.placed(too_large),))
    report = replace(report, **comparison.poses_of(held))
    if held.moving:
        hold = _hold(held, comparison)
        report = replace(report, **{**hold, "findings": (*report.findings, *hold["findings"])})
    if request.picture:
        _write_picture(held, comparison, request.picture)
        report = replace(report, picture=request.picture.name)
    return report


def _gives_poses(held: Held) -> bool:
    """Whether PyBullet moves every joint and tells where every link is.

    Its messages hold 128 numbers per robot: beyond, it refuses to tell, or in silence moves the last joints not at
    all and tells them wrong.
    """
    try:
        held.frame(max(held.links.values()))
        if not held.moving:
            return True
        last, somewhere = max(info[0] for info in held.moving), 0.125
        held.bullet.resetJointState(held.body, last, somewhere)
        return bool(held.bullet.getJointState(held.body, last)[0] == somewhere)
    except held.bullet.error:
        return False


def _hold(held: Held, comparison: measures.Comparison) -> dict[str, Any]:
    """Whether the motors, with the efforts that were written, keep the arm where it is under gravity."""
    bullet, robot = held.bullet, comparison.robot
    start = measures.hold_start(robot)
    held.put(comparison.values(start))
    contacts = [pair for pair in measures.touching_pairs(robot) if _touch(held, robot, *pair)]
    bullet.setTimeStep(measures.TIME_STEP)
    bullet.setGravity(0, 0, -GRAVITY)
    indices = [held.joints[joint.name] for joint in robot.moving_joints]
    for index, joint, value in zip(indices, robot.moving_joints, start, strict=True):
        effort = joint.limits.effort or 0.0
        bullet.setJointMotorControl2(held.body, index, bullet.POSITION_CONTROL, targetPosition=value, force=effort)

    def vectors() -> Iterator[list[float]]:
        for _ in range(round(measures.HOLD_SECONDS / measures.TIME_STEP)):
            bullet.stepSimulation()
            yield [state[0] for state in bullet.getJointStates(held.body, indices)]

    return comparison.hold(start, measures.farthest(start, vectors()), contacts)


def _touch(held: Held, robot: Robot, first: str, second: str) -> bool:
    """Whether the shapes of two links overlap, by more than Bullet's margins around them."""
    links = held.links[first], held.links[second]
    points = held.bullet.getClosestPoints(held.body, held.body, SEARCHED, *links)
    pair = [link for link in robot.links if link.name in {first, second}]
    margins = sum(
        MARGIN for link in pair if not all(isinstance(shape.geometry, Box | Sphere) for shape in link.collisions)
    )
    return any(-point[8] - margins > measures.OVERLAP for point in points)


def _write_picture(held: Held, comparison: measures.Comparison, path: Path) -> None:
    """Render the arm by PyBullet's software renderer, which needs no display and no graphics card."""
    from PIL import Image

    bullet = held.bullet
    view = viewpoint.best_view(comparison.robot, partial(comparison.frames_of, held))
    held.put(comparison.values(view.q))
    # A light floor under the arm, for its shadow to fall on.
    (x, y, z), half = view.floor
    size, colour = (half, half, half / 100), viewpoint.FLOOR
    shape = bullet.createVisualShape(bullet.GEOM_BOX, halfExtents=size, rgbaColor=colour, specularColor=(0, 0, 0))
    bullet.createMultiBody(baseVisualShapeIndex=shape, basePosition=(x, y, z - half / 100))
    width, height = viewpoint.RENDERED
    pixels = bullet.getCameraImage(
        width,
        height,
        viewMatrix=bullet.computeViewMatrix(view.eye, view.target, (0.0, 0.0, 1.0)),
        projectionMatrix=bullet.computeProjectionMatrixFOV(
            math.degrees(viewpoint.FIELD_OF_VIEW), width / height, view.distance / 100, view.distance * 100
        ),
        shadow=int(view.distance < _SHADOWS_UP_TO),
        lightDirection=(0.6, -0.5, 1.2),
        # The shadows have the camera's lens: from afar they cover all that is seen.
        lightDistance=4 * view.distance,
        lightAmbientCoeff=0.6,
        lightDiffuseCoeff=0.5,
        lightSpecularCoeff=0.05,
        renderer=bullet.ER_TINY_RENDERER,
    )[2]
    viewpoint.write_png(Image.frombytes("RGBA", (width, height), bytes(pixels)).convert("RGB"), path)


# --- A file of any origin


def inspect(question: Question) -> HeldRobot:
    """What PyBullet makes of a URDF, an SDF or an MJCF."""
    bullet: Any = sys.modules["pybullet"]
    bullet.connect(bullet.DIRECT)
    path = str(question.path)
    try:
        if question.format == "sdf":
            bodies = bullet.loadSDF(path)
        elif question.format == "mjcf":
            bodies = bullet.loadMJCF(path)
        else:
            bodies = (bullet.loadURDF(path, useFixedBase=True, flags=bullet.URDF_USE_INERTIA_FROM_FILE),)
    except bullet.error as error:
        raise measures.refused("", question) from error
    found = HeldRobot()
    for body in bodies:
        root = _text(bullet.getBodyInfo(body)[0])
        held = Held(body, root)
        held.base = held.held_base()
        found.links.update(measures.told_bodies(held.held_bodies()))
        if question.format == "urdf":  # The world holds the root, which PyBullet makes weightless.
            found.links[root] = None
        found.joints.extend({**held.held_joint(info), "mimic": None} for info in held.moving)
        if question.format != "mjcf":  # PyBullet 3.2.7 crashes when it is asked for the shapes of some of them.
            found.shapes.update(measures.told_shapes(held.held_shapes()))
        with suppress(bullet.error):  # Its messages hold 128 numbers per robot.
            found.frames.update(held.told_frames(held.links, question.postures))
    return found


# What PyBullet prints: "b3Warning[file,line]:", a line end and the text; often the next message follows without one.
_MESSAGE = re.compile(r"b3(Warning|Error)\[[^\]]*\]:\n?(.*?)(?=\n|b3(?:Warning|Error)\[|\Z)")
_COMPLAINT = re.compile(r"\b(warning|error|fail(ed|ure)?|cannot|invalid)\b", re.IGNORECASE)
_NO_INERTIA = "No inertial data for link"
_WITHOUT_WORLD = "expected a world element, continuing without it"


def messages(output: str, request: LoadRequest | None = None) -> list[tuple[str, str]]:
    """The warnings and errors that PyBullet printed.

    PyBullet gives the name of the link or joint that it speaks of in a message of its own. What it prints of any file
    is left out: of an SDF that it has no world, and of the empty root of a written arm that it has no inertial and will
    weigh 1 kg. The world holds this root, and it weighs nothing.
    """
    expected, names = f"{_WITHOUT_WORLD}.*", None
    if request is not None:
        robot = request.robot
        names = {link.name for link in robot.links} | {joint.name for joint in robot.joints}
        expected = rf"{_NO_INERTIA}.*: {re.escape(robot.root)}"
    said: list[tuple[str, str]] = []
    for kind, words in _MESSAGE.findall(output):
        if said and (words in names if names is not None else re.fullmatch(r"\S+", words)):
            said[-1] = (said[-1][0], f"{said[-1][1]}: {words}")
        elif words:
            said.append((kind, words))
    said += [("Warning", line.strip()) for line in _MESSAGE.sub("", output).splitlines() if _COMPLAINT.search(line)]
    return [each for each in said if not re.fullmatch(expected, each[1], re.DOTALL)]
