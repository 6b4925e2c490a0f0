"""The loader `drake`: loads a URDF or SDF into Drake, measures the arm, reads what Drake logs.

Drake is the strictest of the readers, in three ways: what its parser finds wrong is raised, what it doubts is logged,
and what its algebra finds impossible ends the interpreter with SystemExit. https://drake.mit.edu/doxygen_cxx says, in
the group "Parsing Models for Multibody Dynamics", what it takes of a URDF.
"""

from __future__ import annotations

import logging
import math
import re
import sys
from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.measuring import DOUBLE, Body
from dh2urdf.rotations import ZERO, RigidTransform
from dh2urdf.source import Messages, listed, shown
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.loaders import measures

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping
    from pathlib import Path

    from dh2urdf.stages import LoadReport, LoadRequest, Question
    from dh2urdf_plugins.loaders.simulators import SimulatorOptions

say = Messages(__file__)

YIELD = measures.HOLD_STAYS / 10
"""Displacement at which a motor of the hold test gives its full effort [rad or m]: it acts as a stiff spring."""
_MARK = "Drake logged "


class Held(measures.Model):
    """What Drake makes of a file; `build` is called before joints are put."""

    def __init__(self, path: Path, packages: Mapping[str, Path]) -> None:
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
        from pydrake.multibody.tree import ModelInstanceIndex
        from pydrake.systems.framework import DiagramBuilder

        self._builder = DiagramBuilder()
        self.plant, self.scene = AddMultibodyPlantSceneGraph(self._builder, measures.TIME_STEP)
        parser = Parser(self.plant)
        for name, folder in packages.items():
            if not parser.package_map().Contains(name):
                parser.package_map().Add(name, str(folder))
        parser.AddModels(path)
        plant = self.plant
        joints = map(plant.get_joint, plant.GetJointIndices())
        self.joints = {joint.name(): joint for joint in joints if joint.num_velocities()}
        self.models = [*map(ModelInstanceIndex, range(plant.num_model_instances()))]
        bodies = [plant.get_body(index) for model in self.models for index in plant.GetBodyIndices(model)]
        self.bodies = {body.name(): body for body in bodies}

    def build(self) -> None:
        """Make the diagram and its context, once the plant is finalized."""
        self.diagram = self._builder.Build()
        self.context = self.diagram.CreateDefaultContext()
        self.state = self.plant.GetMyMutableContextFromRoot(self.context)

    def actuators(self) -> dict[str, Any]:
        """The actuators, by the names of their joints."""
        found = map(self.plant.get_joint_actuator, self.plant.GetJointActuatorIndices())
        return {actuator.joint().name(): actuator for actuator in found}

    def held_joint(self, joint: Any) -> dict[str, Any]:  # noqa: ANN401 - a module without type information
        """A joint as Drake has it; the effort is that of its actuator, which a URDF gives it by a transmission only."""
        name, kind = joint.name(), joint.type_name()
        if joint.num_velocities() != 1:
            return {"name": name, "type": kind}
        axis = joint.revolute_axis() if kind == "revolute" else joint.translation_axis()
        lower, upper = joint.position_lower_limits()[0], joint.position_upper_limits()[0]
        endless = kind == "revolute" and lower == -math.inf and upper == math.inf
        actuator = self.actuators().get(name)
        kind, others = "continuous" if endless else kind, {"effort": actuator.effort_limit()} if actuator else {}
        velocity = float(joint.velocity_upper_limits()[0])
        bounds = (float(lower), float(upper))
        return measures.joint_record(name, kind, measures.vector(axis), *bounds, velocity=velocity, **others)

    def frame(self, name: str) -> Any:  # noqa: ANN401 - a module without type information
        """The frame of a link, which of an SDF may be a frame on another body."""
        return self.bodies[name].body_frame() if name in self.bodies else self.plant.GetFrameByName(name)

    def held_bodies(self, links: Iterable[str] = ()) -> dict[str, Body]:
        """The links as Drake has them, a mere frame without mass; `links` are those that may be frames."""
        nothing = Body(0.0, ZERO, (0.0,) * 9)
        names = [name for name in links if name not in self.bodies]
        bodies = {name: nothing for name in names if self.plant.HasFrameNamed(name)}
        for name, body in self.bodies.items():
            if body.index() == self.plant.world_body().index():  # It has no mass of its own.
                bodies[name] = nothing
                continue
            spatial = body.default_spatial_inertia()
            com = spatial.get_com()
            about_com = spatial.Shift(com).CalcRotationalInertia().CopyToFullMatrix3()
            bodies[name] = Body(float(spatial.get_mass()), measures.vector(com), measures.rotation(about_com))
        return bodies

    def put(self, values: Mapping[str, float]) -> None:
        """Put joints at values [rad or m], at rest, and the others where the file has them."""
        positions = self.plant.GetDefaultPositions()
        for name, value in values.items():
            if name in self.joints and self.joints[name].num_positions() == 1:
                positions[self.joints[name].position_start()] = value
        self.plant.SetPositions(self.state, positions)
        self.plant.SetVelocities(self.state, [0.0] * self.plant.num_velocities())

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world."""
        poses = {name: self.frame(name).CalcPoseInWorld(self.state) for name in links}
        return {name: measures.frame(pose.rotation().matrix(), pose.translation()) for name, pose in poses.items()}

    def held_shapes(self) -> Iterator[tuple[str, str, measures.Lengths | None]]:
        """The lengths of the shapes of each body; of a mesh, where Drake has its convex hull."""
        from pydrake.geometry import Role

        inspector = self.scene.model_inspector()
        for name, body in self.bodies.items():
            frame = self.plant.GetBodyFrameIdIfExists(body.index())
            for role, word in ((Role.kIllustration, measures.VISUAL), (Role.kProximity, measures.COLLISION)):
                for shape in inspector.GetGeometries(frame, role) if frame is not None else ():
                    yield name, word, _lengths_of_shape(inspector, shape)


def _lengths_of_shape(inspector: Any, shape: Any) -> measures.Lengths | None:  # noqa: ANN401 - of Drake
    from pydrake.geometry import Box, Capsule, Cylinder, Sphere

    match inspector.GetShape(shape):
        case Box() as box:
            return measures.lengths(box.width(), box.depth(), box.height())
        case Sphere() as sphere:
            return measures.round_lengths(sphere.radius())
        case Cylinder() as cylinder:
            return measures.round_lengths(cylinder.radius(), cylinder.length())
        case Capsule() as capsule:
            return measures.round_lengths(capsule.radius(), 2 * capsule.radius() + capsule.length())
    hull = inspector.GetConvexHull(shape)
    return None if hull is None else measures.lengths_of([hull.vertex(at) for at in range(hull.num_vertices())])


# --- The arm of a run


def load(request: LoadRequest, _options: SimulatorOptions) -> LoadReport:
    """Load a URDF or SDF into Drake and measure it."""
    from pydrake.multibody.tree import PdControllerGains

    log_to_output()
    # Drake holds the inertia about the link's origin: a centre of mass far from it costs digits.
    comparison = measures.Comparison("Drake", request, DOUBLE._replace(inertia_about_origin=1e-15))
    held = _guarded(comparison, lambda: Held(request.path.resolve(), {}), "cannot load the file")
    joints = [*map(held.held_joint, held.joints.values())]
    bodies = held.held_bodies(link.name for link in request.robot.links)
    report = comparison.loaded(version("drake"), joints, bodies)
    # The root is welded to the world, unless the file has it there; a root of the name ``world`` is the world.
    robot = request.robot
    root, world = held.frame(robot.root), held.plant.world_body()
    if robot.root not in robot.floating and root.body().index() not in {
        body.index() for body in held.plant.GetBodiesWeldedTo(world)
    }:
        held.plant.WeldFrames(held.plant.world_frame(), root)
    # A motor on every joint that follows none and has an effort above 0, with a stiff spring as its control. The spring
    # cannot make the simulation unstable: Drake solves for it implicitly (the SAP solver), within the effort.
    motors = held.actuators()
    for joint in request.robot.actuated_joints:
        if effort := joint.limits.effort:
            motor = motors.get(joint.name)
            motor = motor or held.plant.AddJointActuator(f"hold {joint.name}", held.joints[joint.name], effort)
            motor.set_controller_gains(PdControllerGains(p=effort / YIELD, d=effort / YIELD * 0.1))
    held.plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
    _guarded(comparison, held.plant.Finalize, "cannot compute with the arm")
    free = map(held.plant.get_body, held.plant.GetFloatingBaseBodies())
    if problems := comparison.floats(str(body.name()) for body in free):
        raise LoaderError(problems)
    held.build()
    report = replace(report, **comparison.poses_of(held))
    if not joints:
        return report
    report = replace(report, **_hold(held, comparison))
    # A controller in Drake cannot move these, and it has not kept their efforts.
    actuated = {joint.name for joint in request.robot.actuated_joints}
    if idle := [shown(joint["name"]) for joint in joints if "effort" not in joint and joint["name"] in actuated]:
        count = "1 joint" if len(idle) == 1 else f"{len(idle)} joints"
        idle_joints = comparison.placed(say("drake-without-actuators", count=count, joints=listed(idle, 8)))
        report = replace(report, findings=(idle_joints, *report.findings))
    return report


def _guarded(comparison: measures.Comparison, call: Callable[[], Any], doing: str) -> Any:  # noqa: ANN401 - of Drake
    """Call into Drake, and tell its errors as ours."""
    try:
        return call()
    except (RuntimeError, SystemExit) as error:  # Drake's C++ aborts arrive in Python as SystemExit.
        said = str(error).replace(f"{comparison.request.path.resolve()}:", "line ")
        raise LoaderError(comparison.placed(say("drake-refuses", doing=doing, reason=said))) from error


def _hold(held: Held, comparison: measures.Comparison) -> dict[str, Any]:
    """Whether the motors, with the efforts that were written, keep the arm where it is under gravity."""
    from pydrake.geometry import CollisionFilterDeclaration, GeometrySet
    from pydrake.systems.analysis import Simulator

    start = measures.hold_start(comparison.robot)
    targets = comparison.values(start)
    held.put(targets)
    query = held.scene.get_query_output_port().Eval(held.scene.GetMyContextFromRoot(held.context))
    inspector, overlaps = held.scene.model_inspector(), []
    for pair in query.ComputePointPairPenetration():
        if pair.depth > measures.OVERLAP:
            frames = map(inspector.GetFrameId, (pair.id_A, pair.id_B))
            first, second = (str(held.plant.GetBodyFromFrameId(frame).name()) for frame in frames)
            overlaps.append((first, second))
    shapes = GeometrySet(inspector.GetAllGeometryIds())
    filters = held.scene.collision_filter_manager(held.scene.GetMyMutableContextFromRoot(held.context))
    filters.Apply(CollisionFilterDeclaration().ExcludeWithin(shapes))  # From now on nothing touches.
    for model in held.models:  # Positions, then velocities, in the order of each model's actuators.
        actuators = map(held.plant.get_joint_actuator, held.plant.GetJointActuatorIndices(model))
        if at := [targets[actuator.joint().name()] for actuator in actuators]:
            held.plant.get_desired_state_input_port(model).FixValue(held.state, [*at, *(0.0 for _ in at)])
    simulator = Simulator(held.diagram, held.context)
    columns = [held.joints[name].position_start() for name in targets]

    def vectors() -> Iterator[Any]:
        for step in range(1, round(measures.HOLD_SECONDS / measures.TIME_STEP) + 1):
            _guarded(comparison, partial(simulator.AdvanceTo, step * measures.TIME_STEP), "cannot simulate the arm")
            yield held.plant.GetPositions(held.state)[columns]

    return comparison.hold(start, measures.farthest(start, vectors()), comparison.overlapping(overlaps))


# --- A file of any origin


def inspect(question: Question) -> HeldRobot:
    """What Drake makes of a URDF, an SDF or an MJCF."""
    log_to_output()
    try:
        held = Held(question.path, question.packages)
        held.plant.Finalize()
        held.build()
    except (RuntimeError, ValueError) as error:
        raise measures.refused(error, question) from error
    except SystemExit as error:
        raise measures.refused(f"ends the interpreter with SystemExit: {error}", question) from error
    world = held.plant.world_body().index()
    names = [name for name, body in held.bodies.items() if body.index() != world]
    bodies = held.held_bodies()
    # Python is not told whom a coupler joins.
    mimic = {} if held.plant.num_constraints() else {"mimic": None}
    return HeldRobot(
        links=measures.told_bodies({name: bodies[name] for name in names}),
        joints=[{**held.held_joint(joint), **mimic} for joint in held.joints.values() if joint.num_velocities() == 1],
        frames=held.told_frames(names, question.postures),
        shapes=measures.told_shapes(held.held_shapes()),
        root_is_loose=bool(held.plant.GetFloatingBaseBodies()),
    )


# --- What it logs


def log_to_output() -> None:
    """Print what Drake logs: its C++ hands it to this logger, whose last resort would print it without its level."""
    to_output = logging.StreamHandler(sys.stderr)
    to_output.setFormatter(logging.Formatter(f"{_MARK}%(levelname)s: %(message)s"))
    logger = logging.getLogger("drake")
    logger.handlers, logger.propagate = [to_output], False


_LOGGED = re.compile(rf"{_MARK}([A-Z]+): ")


def messages(output: str, request: LoadRequest | None = None) -> list[tuple[str, str]]:
    """What Drake logged, which may have many lines; of a run, a line that nobody logged is a message of its own."""
    found: list[tuple[str, str]] = []
    for line in filter(None, map(str.strip, output.splitlines())):
        logged = _LOGGED.match(line)
        if found and found[-1][0] and not logged:
            found[-1] = (found[-1][0], f"{found[-1][1]} {line}")
        else:
            found.append((logged[1] if logged else "", _LOGGED.sub("", line)))
    if request is None:
        return [each for each in found if each[0]]
    return [(level, text.replace(f"{request.path.resolve()}:", "line ", 1)) for level, text in found]
