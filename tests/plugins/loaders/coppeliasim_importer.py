"""What CoppeliaSim's URDF importer makes of a file, step by step and with its faults.

Written from the source of https://github.com/CoppeliaRobotics/simURDF, and compared with CoppeliaSim 4.10.0 by
`test_coppeliasim_arms`. Its C++ reads first, then creates joints, then links, and parents them last: a link is
placed by the frame of its joint, whatever position that joint has by then.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import numpy as np

SHAPE, JOINT, DUMMY, FORCE_SENSOR = 0, 1, 4, 12
REVOLUTE, PRISMATIC = 10, 11
CREATE_VISUALS, NOT_CENTRED, ALTERNATING_MASKS = 8, 32, 128
SMALLEST_RANGE = math.radians(0.001)
MESHES = (".obj", ".dxf", ".3ds", ".stl", ".dae", ".glb")
WHITE = (1.0, 1.0, 1.0)
"""Not the real one's default colour; it stands for any that the file did not say."""


class Crash(Exception):  # noqa: N818 - the program ends
    """The real program ends here, by an exception of C++ that nobody catches or by a null pointer."""


@dataclass
class Thing:
    """An object of the scene."""

    kind: int
    alias: str = ""
    parent: int = -1
    local: np.ndarray = field(default_factory=lambda: np.eye(4))
    subtype: int = 0
    position: float = 0.0
    cyclic: bool = True
    interval: tuple[float, float] = (-math.pi, 2 * math.pi)
    force: float = 0.0
    velocity: float = 0.0
    mass: float = 0.0
    inertia: tuple[float, ...] = (0.001, 0, 0, 0, 0.001, 0, 0, 0, 0.001)
    com: np.ndarray = field(default_factory=lambda: np.eye(4))
    static: bool = True
    respondable: bool = False
    mask: int = 0xFFFF
    colour: tuple[float, ...] = WHITE

    def limit(self, cyclic: bool, lower: float, extent: float) -> None:  # noqa: FBT001 - as the API has it
        smallest = 0.0 if self.subtype == PRISMATIC else SMALLEST_RANGE
        self.cyclic, self.interval = cyclic, (lower, max(extent, smallest))
        self.move(self.position)

    def move(self, position: float) -> None:
        low, extent = self.interval
        self.position = position if self.cyclic else min(max(position, low), low + extent)

    @property
    def motion(self) -> np.ndarray:
        """What a joint does to its children."""
        if self.kind == JOINT and self.subtype == PRISMATIC:
            return transform(xyz=(0.0, 0.0, self.position))
        return turn("z", self.position) if self.kind == JOINT else np.eye(4)


class Scene:
    """Objects by their handles, each in the frame of its parent."""

    def __init__(self, things: dict[int, Thing]) -> None:
        self.things = things

    def add(self, thing: Thing) -> int:
        handle = max(self.things, default=0) + 1
        self.things[handle] = thing
        return handle

    def world(self, handle: int) -> np.ndarray:
        thing = self.at(handle)
        return self._moved(thing.parent) @ thing.local

    def at(self, handle: int) -> Thing:
        if handle not in self.things:
            raise ValueError("354: in sim.genericFunctionHandler: object does not exist.")
        return self.things[handle]

    def _moved(self, handle: int) -> np.ndarray:
        return np.eye(4) if handle == -1 else self.world(handle) @ self.things[handle].motion

    def place(self, handle: int, pose: np.ndarray) -> None:
        thing = self.at(handle)
        thing.local = np.linalg.inv(self._moved(thing.parent)) @ pose

    def hang(self, handle: int, parent: int, *, in_place: bool = True) -> None:
        pose = self.world(handle)
        if parent != -1 and handle in self.above(parent):
            raise ValueError("354: in sim.genericFunctionHandler: object is ancestor of desired parent.")
        self.things[handle].parent = parent
        if in_place:
            self.place(handle, pose)

    def above(self, handle: int) -> list[int]:
        return [handle, *self.above(self.at(handle).parent)] if handle != -1 else []

    def tree(self, handle: int) -> list[int]:
        below = [self.tree(each) for each, thing in self.things.items() if thing.parent == handle]
        return [handle, *(each for tree in below for each in tree)]


@dataclass
class UrdfJoint:
    """A joint as it was read."""

    element: Any
    parent_link: str
    child_link: str
    frame: np.ndarray
    parent_joint: str = ""
    handle: int = -1

    @property
    def name(self) -> str:
        return str(self.element.get("name", ""))


@dataclass
class UrdfLink:
    """A link as it was read: the name of its joint, and the handles of its shapes."""

    element: Any
    parent: str = ""
    visual: int = -1
    respondable: int = -1

    @property
    def name(self) -> str:
        return str(self.element.get("name"))

    @property
    def handle(self) -> int:
        return self.visual if self.respondable == -1 else self.respondable


def import_urdf(scene: Scene, text: str, options: int, *, blind: bool = False) -> list[Any]:
    """The robot's name and the handles of its models.

    Raises:
        ValueError: the importer gives up; what it made before stays in the scene.
        Crash: it ends the program.
    """
    folder = None
    try:
        if text.startswith("<?xml"):
            document = ET.fromstring(text)  # noqa: S314 - a text of these tests
        else:
            if blind:
                return ["", {}]
            folder = Path(text).parent
            document = ET.fromstring(Path(text).read_bytes())  # noqa: S314
    except (OSError, ET.ParseError):
        return ["", {}]
    if document.tag != "robot":
        return ["", {}]
    return _Import(scene, document, options, folder).done()


class _Import:
    def __init__(self, scene: Scene, robot: Any, options: int, folder: Path | None) -> None:
        self.scene, self.options, self.folder = scene, options, folder
        elements = [*robot.findall("link"), *robot.findall("gazebo/sensor"), *robot.findall("sensor")]
        if any(element.get("name") is None for element in (robot, *elements)):
            raise Crash
        self.name = robot.get("name")
        self.joints = [
            UrdfJoint(element, _link_of(element, "parent"), _link_of(element, "child"), origin_of(element))
            for element in robot.findall("joint")
        ]
        self.links = [UrdfLink(element) for element in robot.findall("link")]

    def done(self) -> list[Any]:
        self._create_joints()
        for link in self.links:
            self._create_link(link)
        for joint in self.joints:
            for name, is_parent in ((joint.parent_link, True), (joint.child_link, False)):
                if link := self._link(name):
                    self.scene.hang(*((joint.handle, link.handle) if is_parent else (link.handle, joint.handle)))
        made = [handle for link in self.links for handle in (link.visual, link.respondable) if handle != -1]
        made += [joint.handle for joint in self.joints]
        roots = [handle for handle in made if self.scene.things[handle].parent == -1]
        if self.options & ALTERNATING_MASKS:
            for root in roots:
                self._alternate(root, bit=True)
        if not self.options & NOT_CENTRED:  # The amounts are not the real one's.
            for root in roots:
                self.scene.place(root, transform(xyz=(0.1, -0.2, 0.3)) @ self.scene.world(root))
        return [self.name, roots or {}]

    def _link(self, name: str) -> UrdfLink | None:
        return next((link for link in self.links if link.name == name), None)

    def _joint(self, name: str) -> UrdfJoint | None:
        return next((joint for joint in self.joints if joint.name == name), None)

    # Joints

    def _create_joints(self) -> None:
        for joint in self.joints:
            if not (child := self._link(joint.child_link)):
                raise Crash
            child.parent = joint.name
        for joint in self.joints:
            if not (parent := self._link(joint.parent_link)):
                raise Crash
            joint.parent_joint = parent.parent
            joint.handle = self.scene.add(_joint_thing(joint.element))
        for joint in self.joints:
            self.scene.place(joint.handle, joint.frame)
        for joint in self.joints:
            if joint.parent_joint and (above := self._joint(joint.parent_joint)):
                self.scene.hang(joint.handle, above.handle, in_place=False)
        for joint in self.joints:
            joint.frame = self.scene.world(joint.handle)
            self.scene.hang(joint.handle, -1)
        for joint in self.joints:
            self.scene.place(joint.handle, joint.frame @ _turn_z_to(joint.element))

    # Links

    def _create_link(self, link: UrdfLink) -> None:
        seen, touching = (link.element.findall(kind) for kind in ("visual", "collision"))
        inertial = link.element.find("inertial")
        mass, inertia, body = _mass_properties(inertial)
        visuals = [self._shape(each, mass) for each in seen]
        collisions = []
        for each in touching:
            handle = self._shape(each, mass)
            shape = self.scene.at(handle)  # Or it raises, and leaves what there is by now.
            shape.static, shape.respondable, shape.mask = inertial is None, True, 0xFF00
            collisions.append(handle)
        frames = [origin_of(each) for each in seen]
        if not seen and self.options & CREATE_VISUALS:
            # Of a link that touches and is not seen, what touches is copied: a body besides, that falls.
            masses = [self.scene.at(handle).mass for handle in collisions] or [1e-5]
            visuals = [self.scene.add(Thing(SHAPE, mass=each, static=not touching)) for each in masses]
            frames = [np.eye(4)] * len(visuals)
        if inertial is not None and not touching:
            collisions, touching = [self.scene.add(Thing(SHAPE, mass=mass))], [ET.Element("collision")]
        for handle, each in zip(visuals, seen, strict=False):
            if handle != -1 and (colour := each.find("material/color")) is not None and colour.get("rgba") is not None:
                self.scene.things[handle].colour = tuple(_numbers(colour.get("rgba"), [0.4, 0.4, 0.4, 0.0])[:3])
        link.visual = self._grouped(visuals, frames)
        link.respondable = self._grouped(collisions, [origin_of(each) for each in touching])
        if inertial is not None:
            self._give_mass(link.respondable, mass, inertia, body)
        if link.visual != -1:
            self.scene.things[link.visual].alias = _alias(f"{link.name}_visual")
            if link.respondable != -1:
                self.scene.hang(link.visual, link.respondable)
        if link.respondable != -1:
            self.scene.things[link.respondable].alias = _alias(f"{link.name}_respondable")
        joint = self._joint(link.parent) if link.parent else None
        pose = self.scene.world(link.handle)  # Raises where the link has become nothing.
        self.scene.place(link.handle, joint.frame @ pose if joint else pose)

    def _shape(self, element: Any, mass: float) -> int:
        """A shape, or -1 where the importer leaves it out."""
        for tag, attributes in (
            ("mesh", ("filename",)),
            ("sphere", ("radius",)),
            ("cylinder", ("radius", "length")),
            ("box", ("size",)),
        ):
            shape = element.find(f"geometry/{tag}")
            if shape is None or any(shape.get(name) is None for name in attributes):
                continue
            if tag != "mesh":
                return self.scene.add(Thing(SHAPE, mass=mass))
            return self.scene.add(Thing(SHAPE, mass=1.0)) if self._is_found(shape.get("filename")) else -1
        return -1

    def _is_found(self, name: str) -> bool:
        path = Path(re.sub("(?i)^file://", "", name))
        if not path.is_absolute():
            if self.folder is None or "://" in name:
                return False
            path = self.folder / path
        return path.is_file() and path.suffix.lower() in MESHES

    def _grouped(self, shapes: list[int], frames: list[np.ndarray]) -> int:
        """One shape of those that there are, in the frame of the first of them."""
        there = [(handle, frame) for handle, frame in zip(shapes, frames, strict=False) if handle != -1]
        if not there:
            return -1
        handle, frame = there[0]
        for other, _ in there[1:]:
            self.scene.things[handle].mass += self.scene.things.pop(other).mass
        self.scene.place(handle, frame)
        return handle

    def _give_mass(self, handle: int, mass: float, inertia: np.ndarray, body: np.ndarray) -> None:
        shape, in_shape = self.scene.at(handle), np.linalg.inv(self.scene.world(handle)) @ body
        R = in_shape[:3, :3]
        turned = R @ inertia @ R.T / mass
        for axis in range(3):  # The real one keeps moments per mass, none below this.
            turned[axis, axis] = max(turned[axis, axis], 1e-8)
        shape.mass, shape.inertia = mass, tuple(float(number) for number in (turned * mass).reshape(9))
        shape.com = transform(xyz=in_shape[:3, 3])

    def _alternate(self, handle: int, *, bit: bool) -> None:
        thing = self.scene.things[handle]
        if thing.kind == SHAPE and thing.respondable:
            thing.mask = 0xFF01 if bit else 0xFF02
            bit = not bit
        for each, other in self.scene.things.items():
            if other.parent == handle:
                self._alternate(each, bit=bit)


# --- Elements ---------------------------------------------------------------------------------------------------------


def _alias(name: str) -> str:
    return "".join(chr(byte) if chr(byte).isalnum() and byte < 128 else "_" for byte in name.encode()) or "_"


def _link_of(joint: Any, tag: str) -> str:
    element = joint.find(tag)
    return "" if element is None else str(element.get("link", ""))


def _number(text: str) -> float:
    if text != text.strip():
        return 0.0
    try:
        return float(text)
    except ValueError:
        return 0.0


def _numbers(text: str | None, default: list[float]) -> list[float]:
    """As many numbers as there are words, and the defaults behind them."""
    numbers = [_number(word) for word in (text or "").split()]
    return [*numbers, *default[len(numbers) :]]


def origin_of(element: Any) -> np.ndarray:
    """The origin of an element: Rz(yaw)·Ry(pitch)·Rx(roll) at xyz."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    x, y, z, *_ = _numbers(origin.get("xyz"), [0.0] * 3)
    roll, pitch, yaw, *_ = _numbers(origin.get("rpy"), [0.0] * 3)
    return transform(xyz=(x, y, z)) @ turn("z", yaw) @ turn("y", pitch) @ turn("x", roll)


def _joint_thing(element: Any) -> Thing:
    kind, name = element.get("type"), element.get("name", "")
    if kind == "fixed":
        return Thing(FORCE_SENSOR, _alias(name))
    if kind not in {"revolute", "continuous", "prismatic"}:
        return Thing(DUMMY, _alias(name))
    prismatic = kind == "prismatic"
    joint = Thing(JOINT, _alias(name), subtype=PRISMATIC if prismatic else REVOLUTE)
    limit = element.find("limit")
    words = {} if limit is None else dict(limit.attrib)
    joint.force = _number(words.get("effort", "2" if kind == "revolute" else "200"))
    joint.velocity = _number(words.get("velocity", "20"))
    if prismatic:
        joint.cyclic, joint.interval = False, (-0.5, 1.0)
    if kind != "continuous" and words.keys() & {"lower", "upper"}:
        lower, upper = (_number(words.get(end, "0")) for end in ("lower", "upper"))
        joint.limit(False, lower, upper - lower)
    return joint


def _turn_z_to(element: Any) -> np.ndarray:
    """The rotation that turns z to the joint's axis; that of -z it turns about nothing."""
    axis = element.find("axis")
    x, y, z, *_ = _numbers(None if axis is None else axis.get("xyz"), [1.0, 0.0, 0.0])
    if not z < 1.0:
        return np.eye(4)
    angle = 3.14159265359 if z <= -1.0 else math.acos(z)
    about = np.array([-y, x, 0.0])
    if length := math.sqrt(x * x + y * y):
        about /= length
    alpha, beta = -math.atan2(about[1], about[0]), math.atan2(-math.sqrt(about[0] ** 2 + about[1] ** 2), 0.0)
    return turn("z", -alpha) @ turn("y", -beta) @ turn("z", angle) @ turn("y", beta) @ turn("z", alpha)


def _mass_properties(inertial: Any) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass, inertia and frame; 1 kg and 0.001 kg·m² where the importer reads none."""
    tensor = np.zeros((3, 3))
    if inertial is None:
        return 1.0, tensor, np.eye(4)
    element = inertial.find("mass")
    mass = 0.0 if element is None else _number(element.get("value", "0"))
    if (inertia := inertial.find("inertia")) is not None:
        for row, column in ((0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)):
            number = _number(inertia.get("i" + "xyz"[row] + "xyz"[column], "0"))
            tensor[row, column] = tensor[column, row] = number
    return mass if mass > 0.0 else 1.0, tensor if tensor.any() else np.eye(3) * 0.001, origin_of(inertial)


def transform(*, xyz: Any) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = xyz
    return pose


def turn(axis: str, angle: float) -> np.ndarray:
    pose, c, s = np.eye(4), math.cos(angle), math.sin(angle)
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    pose[i, i] = pose[j, j] = c
    pose[i, j], pose[j, i] = -s, s
    return pose


def rows(pose: np.ndarray) -> list[float]:
    """The upper three rows of a matrix, as CoppeliaSim tells them."""
    return [float(number) for number in pose[:3].reshape(12)]
