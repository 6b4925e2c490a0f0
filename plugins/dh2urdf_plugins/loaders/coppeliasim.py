"""The loader `coppeliasim`: has a running CoppeliaSim import the written URDF, and measures the arm there.

CoppeliaSim is a program of its own. It is asked over its ZMQ remote API, by Coppelia Robotics' own Python client, and
what it prints stays on its console. It has one scene, which all workers of a run would use at once: each waits for its
turn.

What its importer makes of a URDF, seen in CoppeliaSim 4.10.0:

- A joint becomes an object whose z axis is the joint's axis; a fixed joint becomes a force sensor. Names keep ASCII
  letters, digits and ``_``.
- A link becomes the shapes ``<link>_visual`` and ``<link>_respondable``; the second carries mass and inertia. A link
  with mass properties and no collision shape gets a sphere for one, 5 cm across.
- The frame of a shape is that of its first visual or collision; of a link without shapes it is the link's.
- A mass of 0 is not read, so that the link weighs 1 kg. Sizes are 1 mm at least.

CoppeliaSim moves an imported joint by its own position control, with the effort of the file as the largest torque. It
makes no engine's absence known: without one the arm just stands still, so that it is asked whether it moves at all. And
an engine may let joints come apart, while they report small displacements: what counts besides is where the tips are.
"""

from __future__ import annotations

import fcntl
import math
import os
import socket
import sys
import tempfile
import time
from contextlib import ExitStack, closing, contextmanager, suppress
from dataclasses import replace
from ipaddress import ip_address
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.documents import xml_root
from dh2urdf.errors import LoaderError, MissingProgramError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.mass import placed, tensor
from dh2urdf.manipulator import Inertia
from dh2urdf.measuring import Body, Precision
from dh2urdf.meshes import has_meshes
from dh2urdf.robot import Inertial
from dh2urdf.rotations import IDENTITY, RigidTransform, rotate, total, transpose
from dh2urdf.source import Messages, Problem, listed, shown
from dh2urdf.stages import LOAD_TIME_LIMIT
from dh2urdf_plugins.coppeliasim_import import alias, importable_axis, importable_limits
from dh2urdf_plugins.loaders import measures

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from io import BufferedReader

    from dh2urdf.manipulator import Limits
    from dh2urdf.robot import Joint
    from dh2urdf.stages import LoadReport, LoadRequest
    from dh2urdf_plugins.loaders.simulators import CoppeliaSimOptions

say = Messages(__file__)

# The importer's options, by the bits that its manual gives them. Bit 128 stays off: with it, every other link collides
# with the arm itself.
VISUALS_FOR_ALL = 8  # Or a link without shapes becomes nothing, and the import breaks off where something hangs on it.
NOT_CENTRED = 32  # Or the arm is moved until it stands on the floor in the middle: its root stays in the origin.
OPTIONS = VISUALS_FOR_ALL | NOT_CENTRED

_WORLD = -1  # The handle that stands for the world.
_PRECISION = Precision(
    number=1e-6,
    axis=1e-6,
    inertia=1e-6,
    position=1e-6,
    angle=1e-6,
    com=1e-9,
    name="Euler angles, by which the importer places all objects: near their singular angle half the digits are lost",
)
_MASSLESS = 1e-3  # what a link without mass may weigh [kg]: the importer's shapes for such links weigh 1e-5
_STOPS_WITHIN = 30.0  # how long CoppeliaSim may take to stop a simulation [s]
ANSWERS_WITHIN = 5.0  # how long a CoppeliaSim may take to answer at all [s]; its client would wait for ever
_AGAIN = 0.02  # how long to wait between two looks at whether CoppeliaSim is free [s]
REMEDY = (
    "start one without a window, in its folder, by ./coppeliaSim.sh -H (with -GzmqRemoteApi.rpcPort=N for another "
    "port), or say in the loader's options `host` and `port` where it runs"
)


def load(request: LoadRequest, options: CoppeliaSimOptions) -> LoadReport:
    """Have CoppeliaSim import a URDF, and measure the arm; it is taken out of the scene again."""
    import zmq

    client_class = sys.modules["coppeliasim_zmqremoteapi_client"].RemoteAPIClient

    where = f"{options.host}:{options.port}"
    silent = MissingProgramError("loader 'coppeliasim'", f"a CoppeliaSim that answers at {where}", REMEDY)
    try:
        with socket.create_connection((options.host, options.port), ANSWERS_WITHIN) as greeting:
            address, own = str(greeting.getpeername()[0]), str(greeting.getsockname()[0])
    except OSError as error:
        raise silent from error
    same_machine = address == own or ip_address(address.partition("%")[0]).is_loopback
    key = f"coppeliasim-{'localhost' if same_machine else address}-{options.port}"
    with turn(key, f"CoppeliaSim at {where}", LOAD_TIME_LIMIT / 2):
        client = client_class(options.host, options.port)
        client.socket.setsockopt(zmq.LINGER, 0)  # What was not delivered must not keep this process from ending.
        client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * ANSWERS_WITHIN))
        try:
            client.require("sim")  # Somebody listens: CoppeliaSim, or another program?
        except zmq.ZMQError as error:
            raise silent from error
        client.socket.setsockopt(zmq.RCVTIMEO, round(1000 * LOAD_TIME_LIMIT / 4))
        with closing(Arm(request, client, same_machine=same_machine)) as arm:
            report = arm.report()
            if options.engine is None:
                return report
            held = arm.hold(options.engine)
            return replace(report, hold=held["hold"], findings=(*report.findings, *held["findings"]))


@contextmanager
def turn(key: str, what: str, patience: float) -> Iterator[None]:
    """Wait up to some patience [s] until no other process of this machine uses a program, and use it alone.

    The system ends the turn of a process that crashes or is killed.
    """
    path = Path(tempfile.gettempdir(), f"dh2urdf-{key}.lock".replace(":", "_"))
    deadline = time.monotonic() + patience
    while (lock := _locked(path)) is None:
        if time.monotonic() > deadline:
            how = "use fewer workers, or start another one"
            raise LoaderError(f"{what} was busy with other files for {patience:g} s: {how}")
        time.sleep(_AGAIN)
    with lock:
        try:
            yield
        finally:
            with suppress(PermissionError):  # Another user's file stays.
                path.unlink()


def _locked(path: Path) -> BufferedReader | None:
    """Open and lock a file; None where another process has the lock, or has just removed the file."""
    with suppress(PermissionError):  # Another user's file can be locked, too.
        path.touch(mode=0o644)
    with suppress(BlockingIOError, FileNotFoundError), ExitStack() as opened:
        file = opened.enter_context(path.open("rb"))
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        if os.path.samestat(os.fstat(file.fileno()), path.stat()):
            opened.pop_all()
            return file
    return None


class Arm(measures.Model):
    """The arm as CoppeliaSim holds it, beside the robot that was written; it may run on another machine.

    `client` is one of Coppelia Robotics, and has no type information.
    """

    def __init__(self, request: LoadRequest, client: Any, *, same_machine: bool) -> None:  # noqa: ANN401
        self.request, self.robot, self.client, self.lost = request, request.robot, client, False
        self.comparison = measures.Comparison("CoppeliaSim", request, _PRECISION)
        self.sim = self.ask(client.require, "sim")
        if self.ask(self.sim.getSimulationState) != self.sim.simulation_stopped:
            raise LoaderError(
                "CoppeliaSim is running a simulation: stop it, so that joints can be put where they belong"
            )
        self.before = {*self._scene()}
        self.joints: dict[str, int] = {}
        self.shapes: dict[str, int] = {}
        try:
            self._import(same_machine=same_machine)
            # A joint gets its name in the file, a shape keeps CoppeliaSim's; a fixed joint, a force sensor, is neither.
            written = {alias(joint.name): joint.name for joint in self.robot.moving_joints}
            for handle in self._imported():
                kind, name = self.ask(self.sim.getObjectType, handle), self.ask(self.sim.getObjectAlias, handle)
                if kind == self.sim.sceneobject_joint:
                    self.joints[written.get(name, name)] = handle
                elif kind == self.sim.sceneobject_shape:
                    self.shapes[name] = handle
            self.misread = next(filter(self._is_misread, self.robot.moving_joints), None)
            self._restore_limits()
        except LoaderError:
            self.close()
            raise

    def ask(self, function: Callable[..., Any], *arguments: Any) -> Any:  # noqa: ANN401 - any function of CoppeliaSim
        """Call a function of CoppeliaSim, with its errors as ours."""
        import zmq

        try:
            return function(*arguments)
        except zmq.ZMQError as error:
            self.lost = True
            raise LoaderError("CoppeliaSim does not answer any more: it may have crashed, see its console") from error
        except Exception as error:  # What CoppeliaSim refuses, the client raises as a bare Exception.
            said = " ".join(str(error).replace("_=NL=_", " ").replace("_=TB=_", " ").split())
            raise LoaderError(f"CoppeliaSim refused: {said} (its console says more)") from error

    def _scene(self) -> list[int]:
        """The handles of all objects of the scene."""
        return list(self.ask(self.sim.getObjectsInTree, self.sim.handle_scene))

    def _imported(self) -> list[int]:
        """The handles of what was imported."""
        return [handle for handle in self._scene() if handle not in self.before]

    def close(self) -> None:
        """Take what was imported out of the scene again."""
        if not self.lost and (imported := self._imported()):
            self.ask(self.sim.removeObjects, imported)

    def report(self) -> LoadReport:
        """Measure everything."""
        try:
            return self._report()
        except LoaderError as error:
            if not self.misread:
                raise
            advice = (
                f"CoppeliaSim's importer misreads the joint {shown(self.misread.name)}: write the URDF with the "
                "profile coppeliasim, `--profile coppeliasim`, or `options: {profile: coppeliasim}` of the emitter"
            )
            raise LoaderError([replace(problem, suggestion=advice) for problem in error.problems]) from error

    def _report(self) -> LoadReport:
        start = self.comparison.values(measures.hold_start(self.robot))
        frames = link_poses(self.robot, start)
        self.put(start)
        child = {joint.name: frames[joint.child] for joint in self.robot.moving_joints}
        joints = [self._held_joint(name, child.get(name, IDENTITY)) for name in self.joints]
        lost = self.comparison.lost(tip for tip in self.request.expected if self._shape(tip) is None)
        if problems := [*self.comparison.joints(joints), *lost]:
            raise LoaderError(problems)
        bodies = self._held_bodies(frames)
        poses = self.comparison.poses_of(self)  # Before the masses: in a wrong frame all of them are wrong.
        written = {link.name: link.inertial for link in self.robot.links if link.inertial and link.inertial.mass}
        number = self.ask(self.sim.getInt32Param, self.sim.intparam_program_full_version)
        version = f"{number // 1000000}.{number // 10000 % 100}.{number // 100 % 100}.{number % 100}"
        report = self.comparison.loaded(version, joints, bodies, written)
        mass = total(body.mass for body in bodies.values())
        return replace(report, mass=mass, findings=tuple(self._findings(bodies)), **poses)

    # The import

    def _import(self, *, same_machine: bool) -> None:
        """Import the file by its path where CoppeliaSim can see it, else as a text."""
        text = self._text()
        importer = self.ask(self.client.require, "simURDF")
        if not hasattr(importer, "importFile"):
            raise LoaderError("this CoppeliaSim is too old: its URDF importer has no `importFile`")
        roots: Sequence[int] = ()
        try:
            if same_machine:
                _, roots = self.ask(importer.importFile, str(self.request.path.resolve()), OPTIONS)
            if not roots:  # It runs in a container, say, and does not see the file.
                _, roots = self.ask(importer.importFile, text, OPTIONS)
        except LoaderError as error:
            if self.lost or not has_meshes(self.robot):
                raise
            # What the importer says where a link became nothing is that an object does not exist.
            reason = error.problems[0].message
            raise LoaderError(self.comparison.placed(say("coppeliasim-lost-mesh", reason=reason))) from error
        if not roots:
            raise LoaderError(self.comparison.placed(say("coppeliasim-imported-nothing")))

    def _text(self) -> str:
        """The text of the file as the importer takes it: with a declaration, by which it tells a text from a path.

        Meshes get absolute paths: beside a text it looks for none.
        """
        path = self.request.path
        try:
            tree = xml_root(path.read_bytes())
        except (OSError, etree.XMLSyntaxError) as error:
            code = "loaded-file-unreadable" if isinstance(error, OSError) else "loaded-file-not-xml"
            raise LoaderError(self.comparison.placed(say(code, reason=error))) from error
        for mesh in tree.iter("mesh"):
            name = mesh.get("filename", "")
            if "://" not in name:
                mesh.set("filename", str((path.parent / name).resolve()))
        return '<?xml version="1.0"?>\n' + etree.tostring(tree, encoding="unicode")

    def _is_misread(self, joint: Joint) -> bool:
        """Whether the importer cannot have read a joint right: one about -z turns about +z, or it could not be at 0."""
        if joint.name not in self.joints:
            return False
        handle = self.joints[joint.name]
        cyclic, (lower, extent) = self.ask(self.sim.getJointInterval, handle)
        if not cyclic and not lower <= 0.0 <= lower + extent:
            return True
        if importable_axis(joint.axis) == joint.axis:
            return False
        return math.dist(self._axis(handle, link_poses(self.robot, {})[joint.child]), joint.axis) > 1.0

    def _restore_limits(self) -> None:
        """Give joints the limits of the table, where a file for this importer has had to widen them."""
        for joint in self.robot.moving_joints:
            wanted, in_file = _interval(joint.limits), _interval(importable_limits(joint.limits))
            if wanted == in_file or joint.name not in self.joints:
                continue
            handle = self.joints[joint.name]
            cyclic, held = self.ask(self.sim.getJointInterval, handle)
            if not cyclic and held == in_file:
                self.ask(self.sim.setJointInterval, handle, False, wanted)

    # Joints and links

    def put(self, values: Mapping[str, float]) -> None:
        """Put joints at values [rad or m]."""
        for name, value in values.items():
            if name in self.joints:
                self.ask(self.sim.setJointPosition, self.joints[name], float(value))

    def _axis(self, handle: int, child: RigidTransform) -> tuple[float, ...]:
        """The axis of a joint in the frame of the link that it moves, given where that is."""
        r = self._frame(handle).rotation
        return tuple(round(element, 12) + 0.0 for element in rotate(transpose(child.rotation), (r[2], r[5], r[8])))

    def _held_joint(self, name: str, child: RigidTransform) -> dict[str, Any]:
        """A joint as CoppeliaSim has it, given where its child link is, in whose frame the axis is."""
        sim, handle = self.sim, self.joints[name]
        names = {sim.joint_revolute: "revolute", sim.joint_prismatic: "prismatic"}
        kind = self.ask(sim.getJointType, handle)
        cyclic, (lower, extent) = self.ask(sim.getJointInterval, handle)
        upper = lower + extent
        upper = 0.0 if abs(upper) <= 1e-12 * extent else upper  # It holds the range: 0 comes back with a rounding.
        word = "continuous" if cyclic else names.get(kind, f"number {kind}")
        velocity = self.ask(sim.getObjectFloatParam, handle, sim.jointfloatparam_maxvel)
        effort = self.ask(sim.getJointTargetForce, handle)
        axis = self._axis(handle, child)
        return measures.joint_record(name, word, axis, lower, upper, velocity=velocity, effort=effort)

    def _shape(self, link: str) -> int | None:
        """The shape that carries a link: what touches, and what is seen where nothing touches."""
        return self.shapes.get(alias(f"{link}_respondable"), self.shapes.get(alias(f"{link}_visual")))

    def _held_bodies(self, frames: dict[str, RigidTransform]) -> dict[str, Body]:
        """The links that have an inertial, as CoppeliaSim has them, given the frames in which to tell them."""
        bodies = {}
        for link in self.robot.links:
            shape = self._shape(link.name)
            if shape is None or link.inertial is None:
                continue
            mass = self.ask(self.sim.getShapeMass, shape)
            (ixx, ixy, ixz, _, iyy, iyz, _, _, izz), matrix = self.ask(self.sim.getShapeInertia, shape)
            held = Inertial(mass=mass, inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz))
            body = placed(held, frames[link.name].inverse @ self._frame(shape) @ _transform(matrix))
            bodies[link.name] = Body(mass, body.com, tensor(body.inertia))
        return bodies

    def _frame(self, handle: int) -> RigidTransform:
        """The frame of an object in the world, in whose origin the root stands."""
        return _transform(self.ask(self.sim.getObjectMatrix, handle, _WORLD))

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links without shapes of their own, as CoppeliaSim has them now."""
        shapes = {name: self._shape(name) for name in links}
        return {name: self._frame(shape) for name, shape in shapes.items() if shape is not None}

    def _findings(self, bodies: dict[str, Body]) -> Iterator[Problem]:
        """Links that weigh something in CoppeliaSim alone, or do not move in its simulations."""
        moved, heavy, static = {joint.child for joint in self.robot.moving_joints}, [], []
        for link in self.robot.links:
            if link.inertial and not link.inertial.mass and (mass := bodies[link.name].mass) > _MASSLESS:
                heavy.append(f"{shown(link.name)} ({mass:g} kg)")
            shape = self._shape(link.name) if link.name in moved else None
            if shape is not None and self.ask(self.sim.getObjectInt32Param, shape, self.sim.shapeintparam_static):
                static.append(shown(link.name))
        told = {
            "links without mass weigh something in CoppeliaSim": heavy,
            "links are static in CoppeliaSim, and stand still in a simulation": static,
        }
        advice = (
            "it takes a mass of 0 for none said: leave the `inertial` of these links out",
            "a link needs a collision shape and an `inertial` to move there",
        )
        for (what, links), how in zip(told.items(), advice, strict=True):
            if links:
                about: dict[str, Any] = {"what": what, "links": listed(links), "suggestion": how}
                yield self.comparison.placed(say("coppeliasim-has-otherwise", **about))

    # The hold test, by an engine of CoppeliaSim's

    def hold(self, engine: str) -> dict[str, Any]:
        """Have the arm hold itself for two seconds, and put the scene back as it was."""
        ask, sim, start = self.ask, self.sim, measures.hold_start(self.robot)
        before = ask(sim.getInt32Param, sim.intparam_dynamic_engine)
        ask(sim.setInt32Param, sim.intparam_dynamic_engine, getattr(sim, f"physics_{engine}"))
        ask(sim.setStepping, True)
        apart = dict.fromkeys(self.request.expected, 0.0)
        try:
            self.put(self.comparison.values(start))
            for name, value in self.comparison.values(start).items():
                ask(sim.setJointTargetPosition, self.joints[name], float(value))
            ask(sim.startSimulation)
            displacement = measures.farthest(start, self._vectors(engine, apart))
        finally:
            if not self.lost:
                self._stop()
                ask(sim.setStepping, False)
                ask(sim.setInt32Param, sim.intparam_dynamic_engine, before)
        held = self.comparison.hold(start, displacement, ())
        tip, distance = max(apart.items(), key=lambda item: item[1])
        if distance > measures.HOLD_STAYS:
            code, seconds = "coppeliasim-joints-apart", measures.HOLD_SECONDS
            finding = self.comparison.placed(say(code, engine=engine, seconds=seconds, tip=tip, distance=distance))
            return {"hold": {**held["hold"], "stayed": False}, "findings": (*held["findings"], finding)}
        return held

    def _vectors(self, engine: str, apart: dict[str, float]) -> Iterator[list[float]]:
        """Give the joint vector of each step of a simulation; note how far each tip is from where joints put it [m]."""
        ask, sim = self.ask, self.sim
        moves = False
        while ask(sim.getSimulationTime) < measures.HOLD_SECONDS:
            ask(sim.step)
            if not (moves := moves or any(ask(sim.isDynamicallyEnabled, each) for each in self.joints.values())):
                raise LoaderError(
                    f"this CoppeliaSim has no engine {engine}, or does not move the arm with it: "
                    "nothing of it is simulated"
                )
            q = [ask(sim.getJointPosition, self.joints[joint.name]) for joint in self.robot.moving_joints]
            told, held = link_poses(self.robot, self.comparison.values(q)), self.placed(apart)
            for tip, most in apart.items():
                distance = math.dist(told[tip].translation, held[tip].translation)
                apart[tip] = max(most, distance if math.isfinite(distance) else math.inf)
            yield q

    def _stop(self) -> None:
        """Stop the simulation, which puts everything back where it was."""
        self.ask(self.sim.stopSimulation)
        deadline = time.monotonic() + _STOPS_WITHIN
        while self.ask(self.sim.getSimulationState) != self.sim.simulation_stopped:
            if time.monotonic() > deadline:
                raise LoaderError(f"CoppeliaSim does not stop its simulation within {_STOPS_WITHIN:g} s")
            time.sleep(0.01)


def _interval(limits: Limits) -> list[float] | None:
    """Limits as CoppeliaSim has them: the lower one, and the range [rad or m]."""
    if limits.lower is None or limits.upper is None:
        return None
    return [limits.lower, limits.upper - limits.lower]


def _transform(matrix: Sequence[float]) -> RigidTransform:
    """A rigid transform of the upper three rows of its homogeneous matrix."""
    a, b, c, x, d, e, f, y, g, h, i, z = matrix
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))
