"""The arm as CoppeliaSim holds it, measured and compared with the robot that was written.

What its importer makes of a URDF, seen in CoppeliaSim 4.10.0:

- A joint becomes an object whose z axis is the joint's axis; a fixed joint becomes a force sensor. Names keep ASCII
  letters, digits and ``_``.
- A link becomes the shapes ``<link>_visual`` and ``<link>_respondable``; the second carries mass and inertia. A link
  with mass properties and no collision shape gets a sphere for one, 5 cm across.
- The frame of a shape is that of its first visual or collision; of a link without shapes it is the link's.
- A mass of 0 is not read, so that the link weighs 1 kg. Sizes are 1 mm at least.

What the importer of CoppeliaSim is given, and frames and limits as it has them.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.documents import xml_root
from dh2urdf.elementwise import total
from dh2urdf.errors import LoaderError
from dh2urdf.kinematics import axis_rotation
from dh2urdf.manipulator import Inertia, JointType
from dh2urdf.mass_properties import placed
from dh2urdf.measuring import Body, Precision, tensor
from dh2urdf.meshes import has_meshes
from dh2urdf.robot import Inertial
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, ZERO, RigidTransform, rotate, scale, transpose
from dh2urdf.source import Problem, shown
from dh2urdf.stages import LoadReport
from dh2urdf_plugins.coppeliasim_import import alias, importable_axis, importable_limits
from dh2urdf_plugins.loaders.measures import Comparison, hold_start

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from dh2urdf.manipulator import Limits
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.stages import LoadRequest


def text_for(path: Path, comparison: Comparison) -> str:
    """The text of a file as the importer takes it.

    By the declaration it tells a text from a path. Meshes get absolute paths: beside a text it does not look for any.

    Raises:
        LoaderError: the file cannot be read.
    """
    try:
        tree = xml_root(path.read_bytes())
    except OSError as error:
        raise LoaderError(comparison.problem(message=f"the file cannot be read: {error}")) from error
    except etree.XMLSyntaxError as error:
        raise LoaderError(comparison.problem(message=f"the file is not XML: {error}")) from error
    for mesh in tree.iter("mesh"):
        name = mesh.get("filename", "")
        if "://" not in name:
            mesh.set("filename", str((path.parent / name).resolve()))
    return '<?xml version="1.0"?>\n' + etree.tostring(tree, encoding="unicode")


def link_frames(robot: Robot, q: Sequence[float]) -> dict[str, RigidTransform]:
    """The frames of all links in the root at a joint vector [rad or m]."""
    values = dict(zip((joint.name for joint in robot.moving_joints), q, strict=True))
    frames = {robot.root: IDENTITY}
    for joint in robot.joints:  # Parents before children.
        motion = IDENTITY
        if joint.type is JointType.PRISMATIC:
            motion = RigidTransform(IDENTITY_ROTATION, scale(values[joint.name], joint.axis))
        elif joint.type is not JointType.FIXED:
            motion = RigidTransform(axis_rotation(joint.axis, values[joint.name]), ZERO)
        frames[joint.child] = frames[joint.parent] @ joint.origin.transform @ motion
    return frames


def interval(limits: Limits) -> list[float] | None:
    """Limits as CoppeliaSim has them: the lower one, and the range [rad or m]."""
    if limits.lower is None or limits.upper is None:
        return None
    return [limits.lower, limits.upper - limits.lower]


def transform(matrix: Sequence[float]) -> RigidTransform:
    """A rigid transform of the upper three rows of its homogeneous matrix."""
    a, b, c, x, d, e, f, y, g, h, i, z = matrix
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))


# The importer's options, by the bits that its manual gives them. Bit 128 stays off: with it, every other link collides
# with the arm itself.
VISUALS_FOR_ALL = 8  # Or a link without shapes becomes nothing, and the import breaks off where something hangs on it.
NOT_CENTRED = 32  # Or the arm is moved until it stands on the floor in the middle: its root stays in the origin.
OPTIONS = VISUALS_FOR_ALL | NOT_CENTRED

_WORLD = -1  # The handle that stands for the world.
_CONSOLE = "its console says more"
_PRECISION = Precision(
    number=1e-6,
    axis=1e-6,
    inertia=1e-6,
    position=1e-6,
    angle=1e-6,
    com=1e-9,
    name="Euler angles, by which the importer places all objects: near their singular angle half the digits are lost",
)
_MASSLESS = 1e-3
"""What a link without mass may weigh [kg]: the importer's shapes for such links weigh 1e-5."""


class Connection:
    """A CoppeliaSim that answers, and its errors as ours.

    Args:
        client: the `RemoteAPIClient` of Coppelia Robotics.
    """

    def __init__(self, client: Any) -> None:  # noqa: ANN401 - a library without type information
        self.client = client
        self.lost = False

    def ask(self, function: Callable[..., Any], *arguments: Any) -> Any:  # noqa: ANN401 - any function of CoppeliaSim
        """Call a function of CoppeliaSim.

        Raises:
            LoaderError: CoppeliaSim refuses, or does not answer any more.
        """
        import zmq

        try:
            return function(*arguments)
        except zmq.ZMQError as error:
            self.lost = True
            raise LoaderError("CoppeliaSim does not answer any more: it may have crashed, see its console") from error
        except Exception as error:  # What CoppeliaSim refuses, the client raises as a bare Exception.
            said = " ".join(str(error).replace("_=NL=_", " ").replace("_=TB=_", " ").split())
            raise LoaderError(f"CoppeliaSim refused: {said} ({_CONSOLE})") from error


class Arm:
    """The arm as CoppeliaSim holds it, beside the robot that was written.

    Args:
        request: the file and the robot.
        connection: the CoppeliaSim.
        same_machine: whether CoppeliaSim runs where the file is.

    Raises:
        LoaderError: CoppeliaSim cannot import the file.
    """

    def __init__(self, request: LoadRequest, connection: Connection, *, same_machine: bool) -> None:
        self.request, self.robot, self.connection = request, request.robot, connection
        self.comparison = Comparison("CoppeliaSim", request, _PRECISION)
        self.ask = connection.ask
        self.sim = self.ask(connection.client.require, "sim")
        if self.ask(self.sim.getSimulationState) != self.sim.simulation_stopped:
            raise LoaderError(
                "CoppeliaSim is running a simulation: stop it, so that joints can be put where they belong"
            )
        self.imported: list[int] = []
        self._import(same_machine=same_machine)
        try:
            self.joints, self.shapes = self._objects()
            self.misread = self._misread_joints()
            self._restore_limits()
        except LoaderError:
            self.close()
            raise

    def close(self) -> None:
        """Take what was imported out of the scene again."""
        if not self.connection.lost and self.imported:
            self.ask(self.sim.removeObjects, self.imported)

    def _objects(self) -> tuple[dict[str, int], dict[str, int]]:
        """The handles of the joints and of the shapes, by name; a fixed joint is neither, but a force sensor.

        A joint has its name in the file, a shape that which CoppeliaSim gives it.
        """
        joints: dict[str, int] = {}
        shapes: dict[str, int] = {}
        written = {alias(joint.name): joint.name for joint in self.robot.moving_joints}
        for handle in self.imported:
            kind, name = self.ask(self.sim.getObjectType, handle), self.ask(self.sim.getObjectAlias, handle)
            if kind == self.sim.sceneobject_joint:
                joints[written.get(name, name)] = handle
            elif kind == self.sim.sceneobject_shape:
                shapes[name] = handle
        return joints, shapes

    def report(self) -> LoadReport:
        """Measure everything.

        Raises:
            LoaderError: CoppeliaSim holds another arm.
        """
        try:
            return self._report()
        except LoaderError as error:
            if not self.misread:
                raise
            advice = (
                f"CoppeliaSim's importer misreads the joint {shown(self.misread)}: write the URDF with the profile "
                "coppeliasim, `--profile coppeliasim`, or `options: {profile: coppeliasim}` of the emitter"
            )
            raise LoaderError([replace(problem, suggestion=advice) for problem in error.problems]) from error

    def _report(self) -> LoadReport:
        start = hold_start(self.robot)
        frames = link_frames(self.robot, start)
        self.put(start)
        child = {joint.name: frames[joint.child] for joint in self.robot.moving_joints}
        joints = tuple(self._held_joint(name, child.get(name, IDENTITY)) for name in self.joints)
        if problems := [*self.comparison.joints(joints), *self._lost_tips()]:
            raise LoaderError(problems)
        bodies = self._held_bodies(frames)
        poses = self.comparison.poses(self._frames)  # Before the masses: in a wrong frame all of them are wrong.
        written = {link.name: link.inertial for link in self.robot.links if link.inertial and link.inertial.mass}
        masses, problems = self.comparison.masses(bodies, written)
        if problems:
            raise LoaderError(problems)
        masses["mass"] = total(body.mass for body in bodies.values())
        number = self.ask(self.sim.getInt32Param, self.sim.intparam_program_full_version)
        return LoadReport(
            simulator="CoppeliaSim",
            version=f"{number // 1000000}.{number // 10000 % 100}.{number // 100 % 100}.{number % 100}",
            joints=joints,
            findings=self._findings(bodies),
            **masses,
            **poses,
        )

    # The import

    def _scene(self) -> list[int]:
        """The handles of all objects of the scene."""
        return list(self.ask(self.sim.getObjectsInTree, self.sim.handle_scene))

    def _import(self, *, same_machine: bool) -> None:
        """Import the file by its path where CoppeliaSim can see it, else as a text.

        Raises:
            LoaderError: CoppeliaSim cannot import the file; what it made of it before is taken out of the scene.
        """
        text = text_for(self.request.path, self.comparison)
        importer = self.ask(self.connection.client.require, "simURDF")
        if not hasattr(importer, "importFile"):
            raise LoaderError("this CoppeliaSim is too old: its URDF importer has no `importFile`")
        before = set(self._scene())
        roots: Sequence[int] = ()
        try:
            if same_machine:
                _, roots = self.ask(importer.importFile, str(self.request.path.resolve()), OPTIONS)
            if not roots:  # It runs in a container, say, and does not see the file.
                _, roots = self.ask(importer.importFile, text, OPTIONS)
        except LoaderError as error:
            if not self.connection.lost:
                self.imported = [handle for handle in self._scene() if handle not in before]
                self.close()
            raise self._refusal(error) from error
        if not roots:
            raise LoaderError(self.comparison.problem(message=f"CoppeliaSim imported nothing; {_CONSOLE}"))
        self.imported = [handle for root in roots for handle in self.ask(self.sim.getObjectsInTree, root)]

    def _refusal(self, error: LoaderError) -> LoaderError:
        """What the importer says where a link became nothing is that an object does not exist."""
        if "object does not exist" not in str(error) or not has_meshes(self.robot):
            return error
        return LoaderError(
            self.comparison.problem(
                message=error.problems[0].message,
                suggestion="CoppeliaSim reports a missing mesh in this way: meshes have to be where CoppeliaSim can "
                "read them by the same path, as .stl, .obj or .dae, and not as `package://`",
            )
        )

    def _misread_joints(self) -> str | None:
        """The first joint that the importer cannot have read right from this file, or None."""
        for joint in self.robot.moving_joints:
            if joint.name in self.joints and (self._is_flipped(joint) or self._is_displaced(joint)):
                return joint.name
        return None

    def _is_flipped(self, joint: Joint) -> bool:
        """Whether it is a joint about -z that turns about +z."""
        if importable_axis(joint.axis) == joint.axis:
            return False
        r = self._frame(self.joints[joint.name]).rotation
        child = link_frames(self.robot, [0.0] * len(self.robot.moving_joints))[joint.child].rotation
        return math.dist(rotate(transpose(child), (r[2], r[5], r[8])), joint.axis) > 1.0

    def _is_displaced(self, joint: Joint) -> bool:
        """Whether it could not be at 0 when its link was placed."""
        cyclic, (lower, extent) = self.ask(self.sim.getJointInterval, self.joints[joint.name])
        return not cyclic and not lower <= 0.0 <= lower + extent

    def _restore_limits(self) -> None:
        """Give joints the limits of the table, where a file for this importer has had to widen them."""
        for joint in self.robot.moving_joints:
            wanted, in_file = interval(joint.limits), interval(importable_limits(joint.limits))
            if wanted == in_file or joint.name not in self.joints:
                continue
            handle = self.joints[joint.name]
            cyclic, held = self.ask(self.sim.getJointInterval, handle)
            if not cyclic and held == in_file:
                self.ask(self.sim.setJointInterval, handle, False, wanted)

    # Joints

    def put(self, q: Sequence[float]) -> None:
        """Put the arm at a joint vector."""
        for joint, value in zip(self.robot.moving_joints, q, strict=True):
            if joint.name in self.joints:
                self.ask(self.sim.setJointPosition, self.joints[joint.name], float(value))

    def _held_joint(self, name: str, child: RigidTransform) -> dict[str, Any]:
        """A joint as CoppeliaSim has it, given where its child link is, in whose frame the axis is."""
        sim, handle = self.sim, self.joints[name]
        names = {sim.joint_revolute: "revolute", sim.joint_prismatic: "prismatic"}
        kind = self.ask(sim.getJointType, handle)
        cyclic, interval = self.ask(sim.getJointInterval, handle)
        lower, upper = interval[0], interval[0] + interval[1]
        r = self._frame(handle).rotation
        axis = rotate(transpose(child.rotation), (r[2], r[5], r[8]))
        return {
            "name": name,
            "type": "continuous" if cyclic else names.get(kind, f"number {kind}"),
            "axis": tuple(round(element, 12) + 0.0 for element in axis),
            "lower": None if cyclic else lower,
            # It holds the range: an upper limit of 0 comes back with a rounding.
            "upper": None if cyclic else 0.0 if abs(upper) <= 1e-12 * interval[1] else upper,
            "velocity": self.ask(sim.getObjectFloatParam, handle, sim.jointfloatparam_maxvel),
            "effort": self.ask(sim.getJointTargetForce, handle),
        }

    # Masses

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
            moments, matrix = self.ask(self.sim.getShapeInertia, shape)
            ixx, ixy, ixz, _, iyy, iyz, _, _, izz = moments
            held = Inertial(mass=mass, inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz))
            in_link = frames[link.name].inverse @ self._frame(shape) @ transform(matrix)
            body = placed(held, in_link)
            bodies[link.name] = Body(mass, body.com, tensor(body.inertia))
        return bodies

    # Poses

    def _lost_tips(self) -> list[Problem]:
        return [
            self.comparison.problem(message=f"CoppeliaSim has lost the link {shown(tip)}")
            for tip in self.request.expected
            if self._shape(tip) is None
        ]

    def _frame(self, handle: int) -> RigidTransform:
        """The frame of an object in the world, in whose origin the root stands."""
        return transform(self.ask(self.sim.getObjectMatrix, handle, _WORLD))

    def _frames(self, q: Sequence[float], links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links without shapes of their own at a joint vector."""
        self.put(q)
        return self.held_frames(links)

    def held_frames(self, links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links without shapes of their own, as CoppeliaSim has them now."""
        shapes = {name: self._shape(name) for name in links}
        return {name: self._frame(shape) for name, shape in shapes.items() if shape is not None}

    def told_frames(self, q: Sequence[float]) -> dict[str, RigidTransform]:
        """The frames of all links where joints have the values that they tell [rad or m]."""
        return link_frames(self.robot, q)

    # Findings

    def _findings(self, bodies: dict[str, Body]) -> tuple[Problem, ...]:
        findings = []
        heavy = [
            f"{shown(link.name)} ({bodies[link.name].mass:g} kg)"
            for link in self.robot.links
            if link.inertial and not link.inertial.mass and bodies[link.name].mass > _MASSLESS
        ]
        if heavy:
            findings.append(
                self.comparison.problem(
                    message=f"links without mass weigh something in CoppeliaSim: {', '.join(heavy)}",
                    severity="notice",
                    suggestion="it takes a mass of 0 for none said: leave the `inertial` of these links out",
                )
            )
        moved = {joint.child for joint in self.robot.moving_joints}
        static = [shown(link.name) for link in self.robot.links if link.name in moved and self._is_static(link.name)]
        if static:
            findings.append(
                self.comparison.problem(
                    message=f"links are static in CoppeliaSim, and stand still in a simulation: {', '.join(static)}",
                    severity="notice",
                    suggestion="a link needs a collision shape and an `inertial` to move there",
                )
            )
        return tuple(findings)

    def _is_static(self, link: str) -> bool:
        shape = self._shape(link)
        return shape is not None and bool(self.ask(self.sim.getObjectInt32Param, shape, self.sim.shapeintparam_static))
