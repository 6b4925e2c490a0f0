"""A small CoppeliaSim for the tests: it speaks the remote API's wire protocol and imports URDF as the real one does.

The protocol is that of `coppeliasim_zmqremoteapi_client`: CBOR maps over a ZMQ REP socket, ``func`` and ``args`` in,
``ret`` or ``err`` out; the first request carries the version and the language. The scene keeps poses as 4x4 matrices
in the parent, as CoppeliaSim does, and knows nothing of dh2urdf. Its importer, with all faults of the real one, is in
`coppeliasim_importer`; `test_coppeliasim_arms` holds both against what CoppeliaSim 4.10.0 was seen to do.
"""

from __future__ import annotations

import re
import threading
from typing import Any, Self

import zmq
from coppeliasim_importer import (
    JOINT,
    PRISMATIC,
    REVOLUTE,
    SHAPE,
    Crash,
    Scene,
    Thing,
    import_urdf,
    rows,
)
from coppeliasim_zmqremoteapi_client import cbor


class Peer:
    """A CoppeliaSim that listens on a port of this machine, while it is entered.

    Attributes:
        calls: the functions that were called, in order.
        options: the importer's options, as they came.
        scene: the scene; it holds a floor, and a shape of a name that the importer gives too.
        running: whether a simulation runs.
        dies_at: a function at which it falls silent.
        blind: whether it sees no files, as in a container.
        old: whether it is a version whose importer has no `importFile`.
        engine: the engine that is chosen; only Bullet and MuJoCo are there, as in the build of 4.10.0 that was tried.
        stepping: whether the simulation waits to be told of each step.
        time: for how long it has run [s].
    """

    BULLET, MUJOCO, NEWTON = 0, 4, 3
    STEP = 0.05

    def __init__(self, *, running: bool = False, dies_at: str = "", blind: bool = False, old: bool = False) -> None:
        self.running, self.dies_at, self.blind, self.old = running, dies_at, blind, old
        self.engine, self.stepping, self.time = self.BULLET, False, 0.0
        self.calls: list[str] = []
        self.options = 0
        self.scene = Scene({14: Thing(SHAPE, "Floor"), 15: Thing(SHAPE, "tool0_respondable", mass=9.0)})
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
            try:
                self._socket.send(cbor.dumps(self._answer(request)))
            except Crash:
                return

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
        importers = {"import": self.import_file} if self.old else {"importFile": self.import_file}
        names = [name for name in dir(self) if name.startswith("sim_")]
        functions = {camel_case(name.removeprefix("sim_")): getattr(self, name) for name in names}
        return {"simURDF": importers, "sim": functions}

    def _info(self, space: str) -> dict[str, Any]:
        constants = {}
        if space == "sim":
            constants = {
                "sceneobject_joint": JOINT,
                "sceneobject_shape": SHAPE,
                "joint_revolute": REVOLUTE,
                "joint_prismatic": PRISMATIC,
                "handle_scene": -12,
                "simulation_stopped": 0,
                "intparam_dynamic_engine": 8,
                "physics_bullet": self.BULLET,
                "physics_newton": self.NEWTON,
                "physics_mujoco": self.MUJOCO,
                "intparam_program_full_version": 16,
                "jointfloatparam_maxvel": 2017,
                "shapeintparam_static": 3003,
                "shapeintparam_respondable": 3004,
                "shapeintparam_respondable_mask": 3019,
                "colorcomponent_ambient_diffuse": 0,
            }
        functions: dict[str, Any] = {name: {"func": {}} for name in self._functions()[space]}
        return functions | {name: {"const": value} for name, value in constants.items()}

    # The functions of `sim`; each gives the list of its return values.

    def sim_get_simulation_state(self) -> list[Any]:
        return [17 if self.running else 0]

    def sim_get_int32_param(self, parameter: int) -> list[Any]:
        return [{16: 4100000, 8: self.engine}[parameter]]

    # A simulation, as it was seen of a UR5: MuJoCo holds it where it is, Bullet has the last link drift off by 1.58 m in
    # two seconds while the joints tell of 0.09 rad, and an engine that is not there moves nothing and says nothing.

    def sim_set_int32_param(self, parameter: int, value: int) -> list[Any]:
        if parameter != 8:
            raise ValueError("no such parameter")
        self.engine = value
        return []

    def sim_set_stepping(self, enable: bool) -> list[Any]:  # noqa: FBT001
        self.stepping = enable
        return []

    def sim_start_simulation(self) -> list[Any]:
        self.running, self.time = True, 0.0
        self._at_rest = {handle: (thing.local.copy(), thing.position) for handle, thing in self.scene.things.items()}
        return []

    def sim_get_simulation_time(self) -> list[Any]:
        return [self.time]

    def sim_is_dynamically_enabled(self, handle: int) -> list[Any]:
        return [self.running and self.engine in (self.BULLET, self.MUJOCO) and self.scene.things[handle].kind == JOINT]

    def sim_step(self) -> list[Any]:
        if not (self.running and self.stepping):
            raise ValueError("no simulation that is stepped")
        self.time += self.STEP
        if self.engine == self.BULLET:
            joints = [thing for thing in self.scene.things.values() if thing.kind == JOINT]
            *_, last = (thing for thing in self.scene.things.values() if thing.alias.startswith("tool0_"))
            joints[0].move(joints[0].position + 0.0858 * self.STEP / 2.0)
            last.local[0, 3] += 1.58 * self.STEP / 2.0
        return []

    def sim_stop_simulation(self) -> list[Any]:
        self.running = False
        for handle, (local, position) in self._at_rest.items():
            thing = self.scene.things[handle]
            if thing.kind == JOINT:
                thing.move(position)
            thing.local = local
        return []

    def sim_set_joint_target_position(self, handle: int, _position: float) -> list[Any]:
        self._joint(handle)
        return []

    def sim_get_objects_in_tree(self, tree: int) -> list[Any]:
        return [list(self.scene.things) if tree == -12 else self.scene.tree(tree)]

    def sim_get_object_parent(self, handle: int) -> list[Any]:
        return [self.scene.things[handle].parent]

    def sim_get_object_type(self, handle: int) -> list[Any]:
        return [self.scene.things[handle].kind]

    def sim_get_object_alias(self, handle: int) -> list[Any]:
        return [self.scene.things[handle].alias]

    def sim_get_joint_type(self, handle: int) -> list[Any]:
        return [self._joint(handle).subtype]

    def sim_get_joint_interval(self, handle: int) -> list[Any]:
        joint = self._joint(handle)
        return [joint.cyclic, list(joint.interval)]

    def sim_get_joint_target_force(self, handle: int) -> list[Any]:
        return [self._joint(handle).force]

    def sim_get_object_float_param(self, handle: int, parameter: int) -> list[Any]:
        return [{2017: self._joint(handle).velocity}[parameter]]

    def sim_get_joint_position(self, handle: int) -> list[Any]:
        return [self._joint(handle).position]

    def sim_set_joint_position(self, handle: int, position: float) -> list[Any]:
        self._joint(handle).move(position)
        return []

    def sim_set_joint_interval(self, handle: int, cyclic: bool, interval: list[float]) -> list[Any]:  # noqa: FBT001
        self._joint(handle).limit(cyclic, *interval)
        return []

    def sim_get_shape_color(self, handle: int, _name: None, _component: int) -> list[Any]:
        return [1, list(self.scene.things[handle].colour)]

    def sim_get_shape_mass(self, handle: int) -> list[Any]:
        return [self.scene.things[handle].mass]

    def sim_get_shape_inertia(self, handle: int) -> list[Any]:
        shape = self.scene.things[handle]
        return [list(shape.inertia), rows(shape.com)]

    def sim_get_object_int32_param(self, handle: int, parameter: int) -> list[Any]:
        shape = self.scene.things[handle]
        return [{3003: int(shape.static), 3004: int(shape.respondable), 3019: shape.mask}[parameter]]

    def sim_get_object_matrix(self, handle: int, relative_to: int) -> list[Any]:
        if relative_to != -1:
            raise ValueError("asked in another frame")
        return [rows(self.scene.world(handle))]

    def sim_remove_objects(self, handles: list[int]) -> list[Any]:
        for handle in handles:
            del self.scene.things[handle]
        return []

    def _joint(self, handle: int) -> Thing:
        if self.scene.things[handle].kind != JOINT:
            raise ValueError("no joint")
        return self.scene.things[handle]

    # The importer

    def import_file(self, text: str, options: int = 0, _package: str = "") -> list[Any]:
        self.options = options
        return import_urdf(self.scene, text, options, blind=self.blind)


def camel_case(name: str) -> str:
    return re.sub("_([a-z])", lambda found: found[1].upper(), name)
