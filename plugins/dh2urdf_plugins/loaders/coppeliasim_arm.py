"""The arm as CoppeliaSim holds it, measured and compared with the robot that was written.

What its importer makes of a URDF follows from its source, https://github.com/CoppeliaRobotics/simURDF:

- A joint becomes an object of the same name, whose z axis is the joint's axis; a fixed joint becomes a force sensor.
- A link becomes the shapes ``<link>_visual`` and ``<link>_respondable``; the second carries mass and inertia. A link
  with mass properties and no collision shape gets a sphere for one, 5 cm across.
- The frame of a shape is that of its first visual or collision; of a link without shapes it is the link's.
- A mass of 0 is not read, so that the link weighs 1 kg. Sizes are 1 mm at least.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics import axis_rotation
from dh2urdf.manipulator import Inertia, JointType
from dh2urdf.mass_properties import placed
from dh2urdf.robot import Inertial
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, ZERO, RigidTransform, rotate, scale, transpose
from dh2urdf.source import Problem, shown
from dh2urdf.stages import LoadReport
from dh2urdf_plugins.loaders.comparison import Body, Comparison, Precision
from dh2urdf_plugins.loaders.measures import hold_start, tensor

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.robot import Robot
    from dh2urdf.stages import LoadRequest

# The importer's options, by the bits that its manual gives them.
VISUALS_FOR_ALL = 8  # Or a link without shapes becomes nothing, and what hangs on it has no parent.
NOT_CENTRED = 32  # Or the arm is moved until it stands on the floor in the middle: its root stays in the origin.
MASKS_LEFT_ALONE = 128  # Or every other link collides with the arm itself, neighbours too.
OPTIONS = VISUALS_FOR_ALL | NOT_CENTRED | MASKS_LEFT_ALONE

_WORLD = -1  # The handle that stands for the world.
_XML = '<?xml version="1.0"?>\n'  # By this beginning the importer tells a text from a path.
_PRECISION = Precision(
    number=1e-6,
    axis=1e-6,
    inertia=1e-6,
    position=1e-6,
    angle=1e-6,
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
            raise LoaderError(f"CoppeliaSim refused: {said}") from error


class Arm:
    """The arm as CoppeliaSim holds it, beside the robot that was written.

    Raises:
        LoaderError: CoppeliaSim cannot import the file.
    """

    def __init__(self, request: LoadRequest, connection: Connection) -> None:
        self.request, self.robot, self.connection = request, request.robot, connection
        self.comparison = Comparison("CoppeliaSim", request, _PRECISION)
        self.ask = connection.ask
        self.sim = self.ask(connection.client.require, "sim")
        if self.ask(self.sim.getSimulationState) != self.sim.simulation_stopped:
            raise LoaderError(
                "CoppeliaSim is running a simulation: stop it, so that joints can be put where they belong"
            )
        self.before = set(self._scene())
        try:
            self._import()
            self.joints, self.shapes = self._imported_objects()
        except LoaderError:
            self.close()
            raise

    def close(self) -> None:
        """Take out of the scene what was not there before."""
        if not self.connection.lost and (handles := self._imported()):
            self.ask(self.sim.removeObjects, handles)

    def _imported(self) -> list[int]:
        return [handle for handle in self._scene() if handle not in self.before]

    def _imported_objects(self) -> tuple[dict[str, int], dict[str, int]]:
        """The handles of the joints and of the shapes, by name; a fixed joint is neither, but a force sensor."""
        kinds: dict[int, dict[str, int]] = {
            self._constant("object_joint_type", "sceneobject_joint"): {},
            self._constant("object_shape_type", "sceneobject_shape"): {},
        }
        for handle in (handles := self._imported()):
            named = kinds.get(self.ask(self.sim.getObjectType, handle), {})
            named[self.ask(self.sim.getObjectAlias, handle)] = handle
        if not handles:
            raise LoaderError(self.comparison.problem(message="CoppeliaSim imported nothing; its console says why"))
        joints, shapes = kinds.values()
        return joints, shapes

    def report(self) -> LoadReport:
        """Measure everything.

        Raises:
            LoaderError: CoppeliaSim holds another arm.
        """
        start = hold_start(self.robot)
        frames = link_frames(self.robot, start)
        self._put(start)
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
        masses["mass"] = sum(body.mass for body in bodies.values())
        number = self.ask(self.sim.getInt32Param, self.sim.intparam_program_version)
        return LoadReport(
            simulator="CoppeliaSim",
            version=f"{number // 10000}.{number // 100 % 100}.{number % 100}",
            joints=joints,
            findings=self._findings(bodies),
            **masses,
            **poses,
        )

    def _scene(self) -> list[int]:
        """The handles of all objects of the scene."""
        return list(self.ask(self.sim.getObjectsInTree, self.sim.handle_scene, self.sim.handle_all, 0))

    def _import(self) -> None:
        """Hand the text over, not the path: CoppeliaSim may run on another machine, or in a container."""
        try:
            text = self.request.path.read_text("utf-8-sig")
        except (OSError, UnicodeDecodeError) as error:
            raise LoaderError(self.comparison.problem(message=f"the file cannot be read: {error}")) from error
        importer = self.ask(self.connection.client.require, "simURDF")
        # Of old it was `import`, which is a keyword of Python.
        import_text = getattr(importer, "importFile", None) or getattr(importer, "import")
        self.ask(import_text, text if text.startswith("<?xml") else _XML + text, OPTIONS)

    # Joints

    def _put(self, q: Sequence[float]) -> None:
        """Put the arm at a joint vector."""
        for joint, value in zip(self.robot.moving_joints, q, strict=True):
            if joint.name in self.joints:
                self.ask(self.sim.setJointPosition, self.joints[joint.name], float(value))

    def _held_joint(self, name: str, child: RigidTransform) -> dict[str, Any]:
        """A joint as CoppeliaSim has it, given where its child link is, in whose frame an axis is told."""
        sim, handle = self.sim, self.joints[name]
        names = {
            self._constant("joint_revolute_subtype", "joint_revolute"): "revolute",
            self._constant("joint_prismatic_subtype", "joint_prismatic"): "prismatic",
        }
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

    def _constant(self, *names: str) -> Any:  # noqa: ANN401 - a number
        """A constant that has changed its name between versions."""
        return next((getattr(self.sim, name) for name in names if hasattr(self.sim, name)), None)

    # Masses

    def _shape(self, link: str) -> int | None:
        """The shape that carries a link: what touches, and what is seen where nothing touches."""
        return self.shapes.get(f"{link}_respondable", self.shapes.get(f"{link}_visual"))

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
            in_link = frames[link.name].inverse @ self._frame(shape) @ _transform(matrix)
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
        return _transform(self.ask(self.sim.getObjectMatrix, handle, _WORLD))

    def _frames(self, q: Sequence[float], links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links without shapes of their own at a joint vector."""
        self._put(q)
        shapes = {name: self._shape(name) for name in links}
        return {name: self._frame(shape) for name, shape in shapes.items() if shape is not None}

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


def _transform(matrix: Sequence[float]) -> RigidTransform:
    """A rigid transform of the upper three rows of its homogeneous matrix."""
    a, b, c, x, d, e, f, y, g, h, i, z = matrix
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))
