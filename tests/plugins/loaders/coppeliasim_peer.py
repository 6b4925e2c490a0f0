"""A small CoppeliaSim for the tests: it speaks the remote API's wire protocol and imports URDF as its source says.

The protocol is that of `coppeliasim_zmqremoteapi_client`: CBOR maps over a ZMQ REP socket, ``func`` and ``args`` in,
``ret`` or ``err`` out; the first request carries the version and the language. The scene keeps poses as 4x4 matrices
in the parent, as CoppeliaSim does, and knows nothing of dh2urdf. What the importer does was read in the source of
https://github.com/CoppeliaRobotics/simURDF.
"""

from __future__ import annotations

import math
import re
import threading
from dataclasses import dataclass, field
from typing import Any, Self
from xml.etree import ElementTree as ET

import numpy as np
import zmq
from coppeliasim_zmqremoteapi_client import cbor

SHAPE, JOINT, FORCE_SENSOR = 0, 1, 12
REVOLUTE, PRISMATIC = 10, 11
CREATE_VISUALS, NOT_CENTRED, MASKS_LEFT_ALONE = 8, 32, 128


@dataclass
class Thing:
    """An object of the scene."""

    kind: int
    alias: str
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


class Peer:
    """A CoppeliaSim that listens on a port of this machine, while it is entered.

    Attributes:
        calls: the functions that were called, in order.
        options: the importer's options, as they came.
        things: the scene, by handle; it holds a floor, and a shape of a name that the importer gives too.
        running: whether a simulation runs.
        dies_at: a function at which it falls silent.
        old: whether it is a version whose importer has no `importFile`, and whose constants have other names.
    """

    def __init__(self, *, running: bool = False, dies_at: str = "", old: bool = False) -> None:
        self.running, self.dies_at, self.old = running, dies_at, old
        self.calls: list[str] = []
        self.options = 0
        self.things = {14: Thing(SHAPE, "Floor"), 15: Thing(SHAPE, "tool0_respondable", mass=9.0)}
        self.required: set[str] = set()
        self._greeted: set[str] = set()
        self._stop = threading.Event()

    def __enter__(self) -> Self:
        self._context = zmq.Context()
        self._socket = self._context.socket(zmq.REP)
        self._socket.setsockopt(zmq.LINGER, 0)
        self.port = self._socket.bind_to_random_port("tcp://127.0.0.1")
        self._thread = threading.Thread(target=self._serve, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
        self._socket.close()
        self._context.term()

    def _serve(self) -> None:
        while not self._stop.is_set():
            if not self._socket.poll(20):
                continue
            request = cbor.loads(self._socket.recv())
            if request["func"] == self.dies_at:
                return
            self._socket.send(cbor.dumps(self._answer(request)))

    def _answer(self, request: dict[str, Any]) -> dict[str, Any]:
        if request["uuid"] not in self._greeted:
            if (request.get("ver"), request.get("lang")) != (2, "python"):
                return {"err": "the first request says version and language"}
            self._greeted.add(request["uuid"])
        try:
            return {"ret": list(self._call(request["func"], request["args"], request["argsL"]))}
        except (KeyError, ValueError, TypeError) as error:
            return {"err": f"{error}\t(in function '{request['func']}')".replace("\t", "_=TB=_")}

    def _call(self, name: str, arguments: list[Any], count: int) -> list[Any]:
        if count != len(arguments):
            raise ValueError("the number of arguments is wrong")
        self.calls.append(name)
        space, _, function = name.partition(".")
        if name == "zmqRemoteApi.require":
            self.required.add(arguments[0])
            return []
        if name == "zmqRemoteApi.info":
            return [self._info(arguments[0])]
        if space not in self.required or function not in self._functions()[space]:
            raise ValueError(f"No such function: {name}")
        return list(self._functions()[space][function](*arguments))

    def _functions(self) -> dict[str, dict[str, Any]]:
        importers = {"import": self.import_urdf} if self.old else {"importFile": self.import_urdf}
        names = [name for name in dir(self) if name.startswith("sim_")]
        functions = {camel_case(name.removeprefix("sim_")): getattr(self, name) for name in names}
        return {"simURDF": importers, "sim": functions}

    def _info(self, space: str) -> dict[str, Any]:
        constants = {}
        if space == "sim":
            kinds = {"object_joint_type": JOINT, "object_shape_type": SHAPE}
            kinds |= {"joint_revolute_subtype": REVOLUTE, "joint_prismatic_subtype": PRISMATIC}
            if not self.old:
                kinds = {"sceneobject_joint": JOINT, "sceneobject_shape": SHAPE}
                kinds |= {"joint_revolute": REVOLUTE, "joint_prismatic": PRISMATIC}
            constants = kinds | {
                "handle_scene": -12,
                "handle_all": -2,
                "simulation_stopped": 0,
                "intparam_program_version": 4,
                "jointfloatparam_maxvel": 2017,
                "shapeintparam_static": 3003,
            }
        functions: dict[str, Any] = {name: {"func": {}} for name in self._functions()[space]}
        return functions | {name: {"const": value} for name, value in constants.items()}

    # The functions of `sim`; each gives the list of its return values.

    def sim_get_simulation_state(self) -> list[Any]:
        return [17 if self.running else 0]

    def sim_get_int32_param(self, parameter: int) -> list[Any]:
        return [{4: 40900}[parameter]]

    def sim_get_objects_in_tree(self, tree: int, kind: int, options: int) -> list[Any]:
        if (tree, kind, options) != (-12, -2, 0):
            raise ValueError("asked for another tree")
        return [list(self.things)]

    def sim_get_object_type(self, handle: int) -> list[Any]:
        return [self.things[handle].kind]

    def sim_get_object_alias(self, handle: int) -> list[Any]:
        return [self.things[handle].alias]

    def sim_get_joint_type(self, handle: int) -> list[Any]:
        return [self._joint(handle).subtype]

    def sim_get_joint_interval(self, handle: int) -> list[Any]:
        joint = self._joint(handle)
        return [joint.cyclic, list(joint.interval)]

    def sim_get_joint_target_force(self, handle: int) -> list[Any]:
        return [self._joint(handle).force]

    def sim_get_object_float_param(self, handle: int, parameter: int) -> list[Any]:
        return [{2017: self._joint(handle).velocity}[parameter]]

    def sim_set_joint_position(self, handle: int, position: float) -> list[Any]:
        joint = self._joint(handle)
        low, span = joint.interval
        joint.position = position if joint.cyclic else min(max(position, low), low + span)
        return []

    def sim_get_shape_mass(self, handle: int) -> list[Any]:
        return [self.things[handle].mass]

    def sim_get_shape_inertia(self, handle: int) -> list[Any]:
        shape = self.things[handle]
        return [list(shape.inertia), rows(shape.com)]

    def sim_get_object_int32_param(self, handle: int, parameter: int) -> list[Any]:
        return [{3003: int(self.things[handle].static)}[parameter]]

    def sim_get_object_matrix(self, handle: int, relative_to: int) -> list[Any]:
        if relative_to != -1:
            raise ValueError("asked in another frame")
        pose = self.things[handle].local
        above = self.things[handle].parent
        while above != -1:
            thing = self.things[above]
            pose = thing.local @ motion(thing) @ pose
            above = thing.parent
        return [rows(pose)]

    def sim_remove_objects(self, handles: list[int]) -> list[Any]:
        for handle in handles:
            del self.things[handle]
        return []

    def _joint(self, handle: int) -> Thing:
        if self.things[handle].kind != JOINT:
            raise ValueError("no joint")
        return self.things[handle]

    # The importer

    def import_urdf(self, text: str, options: int = 0, _package: str = "") -> list[Any]:
        self.options = options
        if not text.startswith("<?xml"):
            return [""]  # It takes the text for a path, finds no such file, says so on its console, and goes on.
        try:
            robot = ET.fromstring(text)  # noqa: S314 - a text of these tests
        except ET.ParseError:
            return [""]
        origin = {link.get("name"): np.eye(4) for link in robot.findall("link")}
        joints = robot.findall("joint")
        for joint in joints:  # Parents before children, as in the tests' files.
            origin[child_of(joint)] = origin[joint.find("parent").get("link")] @ pose_of(joint)
        world: dict[int, np.ndarray] = {}
        handles: dict[str, int] = {}
        for joint in joints:
            handles[joint.get("name")] = self._add(
                joint_thing(joint), world, origin[child_of(joint)] @ turn_z_to(joint)
            )
        carrier = {link.get("name"): self._import_link(link, options, world, origin) for link in robot.findall("link")}
        for joint in joints:
            handle = handles[joint.get("name")]
            self._hang(handle, carrier[joint.find("parent").get("link")], world)
            self._hang(carrier[child_of(joint)], handle, world)
        if not options & NOT_CENTRED:
            for handle in world:
                if self.things[handle].parent == -1:
                    self.things[handle].local = (
                        np.array([[1, 0, 0, 0.1], [0, 1, 0, -0.2], [0, 0, 1, 0.3], [0, 0, 0, 1.0]])
                        @ self.things[handle].local
                    )
        return [robot.get("name")]

    def _import_link(self, link: Any, options: int, world: dict[int, np.ndarray], origin: dict[Any, Any]) -> int:
        """Make the shapes of a link; the handle of the one that carries it, or -1."""
        name, inertial = link.get("name"), link.find("inertial")
        seen, touching = (link.findall(kind) for kind in ("visual", "collision"))
        carrier = visual = -1
        if seen or options & CREATE_VISUALS:
            frame = pose_of(seen[0]) if seen else np.eye(4)
            visual = self._add(Thing(SHAPE, f"{name}_visual", mass=1e-5), world, origin[name] @ frame)
        if touching or inertial is not None:
            frame = pose_of(touching[0]) if touching else np.eye(4)
            shape = Thing(SHAPE, f"{name}_respondable", static=inertial is None or not touching)
            if inertial is not None:
                shape.mass = float(inertial.find("mass").get("value")) or 1.0
                moments = inertial.find("inertia").attrib
                upper = [float(moments[key]) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")]
                if any(upper):
                    xx, xy, xz, yy, yz, zz = upper
                    shape.inertia = (xx, xy, xz, xy, yy, yz, xz, yz, zz)
                shape.com = np.linalg.inv(frame) @ pose_of(inertial)
            carrier = self._add(shape, world, origin[name] @ frame)
        if carrier != -1 and visual != -1:
            self._hang(visual, carrier, world)
        return visual if carrier == -1 else carrier

    def _add(self, thing: Thing, world: dict[int, np.ndarray], pose: np.ndarray) -> int:
        handle = max(self.things) + 1
        self.things[handle], world[handle] = thing, pose
        thing.local = pose
        return handle

    def _hang(self, handle: int, parent: int, world: dict[int, np.ndarray]) -> None:
        """Give an object a parent where it is."""
        if -1 not in (handle, parent):
            self.things[handle].parent = parent
            self.things[handle].local = np.linalg.inv(world[parent]) @ world[handle]


def camel_case(name: str) -> str:
    return re.sub("_([a-z])", lambda found: found[1].upper(), name)


def joint_thing(element: Any) -> Thing:
    kind = element.get("type")
    if kind == "fixed":
        return Thing(FORCE_SENSOR, element.get("name"))
    limit = element.find("limit")
    joint = Thing(JOINT, element.get("name"), subtype=PRISMATIC if kind == "prismatic" else REVOLUTE)
    joint.force, joint.velocity = float(limit.get("effort")), float(limit.get("velocity"))
    if kind != "continuous":
        lower, upper = float(limit.get("lower")), float(limit.get("upper"))
        joint.cyclic, joint.interval = False, (lower, upper - lower)
    return joint


def motion(thing: Thing) -> np.ndarray:
    """What a joint does to its children."""
    pose = np.eye(4)
    if thing.kind != JOINT:
        return pose
    if thing.subtype == PRISMATIC:
        pose[2, 3] = thing.position
    else:
        c, s = math.cos(thing.position), math.sin(thing.position)
        pose[:2, :2] = [[c, -s], [s, c]]
    return pose


def child_of(joint: Any) -> str:
    return str(joint.find("child").get("link"))


def pose_of(element: Any) -> np.ndarray:
    """The origin of an element: Rz(yaw)·Ry(pitch)·Rx(roll) at xyz."""
    pose = np.eye(4)
    origin = element.find("origin")
    if origin is None:
        return pose
    roll, pitch, yaw = (float(word) for word in origin.get("rpy", "0 0 0").split())
    cr, sr, cp, sp, cy, sy = (f(a) for a in (roll, pitch, yaw) for f in (math.cos, math.sin))
    rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
    ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
    rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
    pose[:3, :3] = rz @ ry @ rx
    pose[:3, 3] = [float(word) for word in origin.get("xyz", "0 0 0").split()]
    return pose


def turn_z_to(joint: Any) -> np.ndarray:
    """The rotation that turns z to the joint's axis, about the axis across both; URDF's axis by default is x."""
    element = joint.find("axis")
    words = "1 0 0" if element is None else element.get("xyz")
    axis = np.array([float(word) for word in words.split()])
    across = np.cross([0, 0, 1], axis)
    pose = np.eye(4)
    if np.linalg.norm(across) < 1e-15:
        pose[:3, :3] = np.diag([1.0, 1.0, 1.0] if axis[2] > 0 else [1.0, -1.0, -1.0])
        return pose
    x, y, z = across / np.linalg.norm(across)
    K = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    angle = math.acos(axis[2])
    pose[:3, :3] = np.eye(3) + math.sin(angle) * K + (1 - math.cos(angle)) * K @ K
    return pose


def rows(pose: np.ndarray) -> list[float]:
    """The upper three rows of a matrix, as CoppeliaSim tells them."""
    return [float(number) for number in pose[:3].reshape(12)]
