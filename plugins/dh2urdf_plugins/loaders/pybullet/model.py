"""What PyBullet makes of a file, whatever file that is: its bodies, joints and shapes as it tells them."""

from __future__ import annotations

import re
import sys
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.measuring import Body
from dh2urdf.rotations import IDENTITY, RigidTransform, multiply, rotate, rotation_from_quaternion, transpose
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.loaders.inspecting import (
    COLLISION,
    VISUAL,
    lengths,
    lengths_of,
    refused,
    told_bodies,
    told_frames,
)
from dh2urdf_plugins.loaders.simulators import PACKAGES, SimulatorOptions

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping, Sequence

    from dh2urdf.stages import Question

ROOT = -1  # PyBullet's index of the root link
_NO_FILE = b"unknown_file"


class Model:
    """A body as PyBullet holds it; its root is in the world's origin."""

    def __init__(self, bullet: Any, body: int, root: str) -> None:  # noqa: ANN401 - a module without type information
        self.bullet, self.body = bullet, body
        infos = [bullet.getJointInfo(body, index) for index in range(bullet.getNumJoints(body))]
        self.moving = [info for info in infos if info[2] != bullet.JOINT_FIXED]
        self.joints = {text(info[1]): info[0] for info in infos}
        self.links = {root: ROOT, **{text(info[12]): info[0] for info in infos}}

    def held_joint(self, info: Sequence[Any]) -> dict[str, Any]:
        """A joint as PyBullet has it; its axis is held in the inertial frame, and turned back to the link frame."""
        lower, upper = info[8], info[9]
        endless = info[2] == self.bullet.JOINT_REVOLUTE and lower > upper
        names = {self.bullet.JOINT_REVOLUTE: "revolute", self.bullet.JOINT_PRISMATIC: "prismatic"}
        inertial_frame = rotation_from_quaternion(self.bullet.getDynamicsInfo(self.body, info[0])[4])
        return {
            "name": text(info[1]),
            "type": "continuous" if endless else names.get(info[2], f"number {info[2]}"),
            "axis": tuple(round(element, 12) + 0.0 for element in rotate(inertial_frame, info[13])),
            "lower": None if endless else lower,
            "upper": None if endless else upper,
            "velocity": info[11],
            "effort": info[10],
        }

    def held_bodies(self) -> dict[str, Body]:
        """The links as PyBullet has them: the inertia is held in its principal axes, and turned back to the link."""
        bodies = {}
        for name, index in self.links.items():
            mass, _, moments, com, orientation = self.bullet.getDynamicsInfo(self.body, index)[:5]
            axes = rotation_from_quaternion(orientation)
            principal = (moments[0], 0, 0, 0, moments[1], 0, 0, 0, moments[2])
            bodies[name] = Body(mass, com, multiply(multiply(axes, principal), transpose(axes)))
        return bodies

    def frame(self, link: int) -> RigidTransform:
        """The frame of a link in the world, in whose origin the root stands."""
        if link == ROOT:
            return IDENTITY
        state = self.bullet.getLinkState(self.body, link, computeForwardKinematics=1)
        return RigidTransform(rotation_from_quaternion(state[5]), state[4])

    def base(self) -> RigidTransform:
        """The frame of the root in the world, where a file puts it elsewhere: Bullet moves its centre of mass."""
        position, orientation = self.bullet.getBasePositionAndOrientation(self.body)
        com, axes = self.bullet.getDynamicsInfo(self.body, ROOT)[3:5]
        centre = RigidTransform(rotation_from_quaternion(orientation), position)
        return centre @ RigidTransform(rotation_from_quaternion(axes), com).inverse

    def held_shapes(self) -> dict[str, dict[str, list[tuple[float, float, float]]]]:
        """The lengths of the shapes of each link; of meshes, of those that touch.

        A cylinder of a URDF becomes a hull with a margin around it, which has no file: its size is not told.
        """
        bullet = self.bullet
        found: dict[str, dict[str, list[tuple[float, float, float]]]] = {}
        visuals = bullet.getVisualShapeData(self.body)
        for name, index in self.links.items():
            solids = bullet.getCollisionShapeData(self.body, index)
            sizes = [
                self._size(solid[2], solid[3])
                if solid[2] != bullet.GEOM_MESH or solid[4] in {b"", _NO_FILE}
                else lengths_of(self._vertices(index, at, solid[6]))
                for at, solid in enumerate(solids)
            ]
            seen = [self._size(kind, size) for _, at, kind, size, *_ in visuals if at == index]
            found[name] = {COLLISION: [each for each in sizes if each], VISUAL: [each for each in seen if each]}
        return found

    def _vertices(self, index: int, at: int, orientation: Sequence[float]) -> Any:  # noqa: ANN401 - an array
        """The vertices of a mesh along the axes of its file: Bullet has them along the principal axes of the link."""
        import numpy as np

        vertices = np.array(self.bullet.getMeshData(self.body, index, collisionShapeIndex=at)[1]).reshape(-1, 3)
        return vertices @ np.array(self.bullet.getMatrixFromQuaternion(orientation)).reshape(3, 3)

    def _size(self, kind: int, size: Sequence[float]) -> tuple[float, float, float] | None:
        bullet = self.bullet
        if kind == bullet.GEOM_BOX:
            return lengths(*size)
        if kind == bullet.GEOM_SPHERE:
            return lengths(*(3 * (2 * size[0],)))
        if kind in {bullet.GEOM_CYLINDER, bullet.GEOM_CAPSULE}:
            length, radius = size[:2]
            return lengths(2 * radius, 2 * radius, length + (2 * radius if kind == bullet.GEOM_CAPSULE else 0.0))
        return None


def text(name: bytes) -> str:
    """A name, which PyBullet has as bytes."""
    return name.decode("utf-8", "replace")


def prepare() -> str:
    """Import PyBullet; its version.

    Raises:
        MissingDependencyError: it is not installed.
    """
    PACKAGES["pybullet"].load(SimulatorOptions())
    return version("pybullet")


def inspect(question: Question) -> HeldRobot:
    """What PyBullet makes of a URDF, an SDF or an MJCF.

    Raises:
        LoaderError: it refuses the file.
    """
    bullet = sys.modules["pybullet"]
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
        raise refused("", question) from error
    held = HeldRobot()
    for body in bodies:
        model = Model(bullet, body, text(bullet.getBodyInfo(body)[0]))
        root = next(iter(model.links))
        held.links.update(told_bodies(model.held_bodies()))
        if question.format == "urdf":  # The world holds the root, which PyBullet makes weightless.
            held.links[root] = None
        held.joints.extend({**model.held_joint(info), "mimic": None} for info in model.moving)
        if question.format != "mjcf":  # PyBullet 3.2.7 crashes when it is asked for the shapes of some of them.
            held.shapes.update(model.held_shapes())
        held.frames.update(told_frames(question.postures, _frames(model)))
    return held


def _frames(model: Model) -> Callable[[Mapping[str, float]], dict[str, RigidTransform]]:
    base, by_index = model.base(), model.bullet

    def frames(values: Mapping[str, float]) -> dict[str, RigidTransform]:
        try:
            for name, value in values.items():
                if name in model.joints:
                    by_index.resetJointState(model.body, model.joints[name], value)
            return {name: base if link == ROOT else model.frame(link) for name, link in model.links.items()}
        except by_index.error:  # Its messages hold 128 numbers per robot.
            return {}

    return frames


# What PyBullet prints: "b3Warning[file,line]:", a line end and the text; often the next message follows without one.
_MESSAGE = re.compile(r"b3(Warning|Error)\[[^\]]*\]:\n?(.*?)(?=\n|b3(?:Warning|Error)\[|\Z)")
_COMPLAINT = re.compile(r"\b(warning|error|fail(ed|ure)?|cannot|invalid)\b", re.IGNORECASE)
_NAME = re.compile(r"\S+")
_WITHOUT_WORLD = "expected a world element, continuing without it"
NO_INERTIA = "No inertial data for link"


def messages(output: str, is_name: Callable[[str], object] = _NAME.fullmatch) -> list[tuple[str, str]]:
    """The warnings and errors that PyBullet printed: the level and the text of each.

    Args:
        output: what was printed.
        is_name: whether a text is a name: PyBullet gives the name of the link or joint that it speaks of in a message
            of its own.
    """
    said: list[tuple[str, str]] = []
    for kind, words in _MESSAGE.findall(output):
        if words and is_name(words) and said:
            said[-1] = (said[-1][0], f"{said[-1][1]}: {words}")
        elif words:
            said.append((kind, words))
    said += [("Warning", line.strip()) for line in _MESSAGE.sub("", output).splitlines() if _COMPLAINT.search(line)]
    return said


def complaints(output: str) -> list[str]:
    """The warnings and errors that PyBullet printed, without what it prints of every SDF."""
    return [words for _, words in messages(output) if not words.startswith(_WITHOUT_WORLD)]
