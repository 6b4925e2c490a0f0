"""The loader `drake`: loads the written URDF or SDF into Drake, measures the arm, reads what Drake logs.

Drake is the strictest of the readers, in three ways: what its parser finds wrong is raised, what it doubts is logged,
and what its algebra finds impossible ends the interpreter with SystemExit. https://drake.mit.edu/doxygen_cxx says, in
the group "Parsing Models for Multibody Dynamics", what it takes of a URDF.
"""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.measuring import DOUBLE
from dh2urdf.source import Messages, listed, shown
from dh2urdf_plugins.loaders.drake.model import Model, log_to_output, messages
from dh2urdf_plugins.loaders.measures import (
    HOLD_SECONDS,
    HOLD_STAYS,
    OVERLAP,
    TIME_STEP,
    Comparison,
    farthest,
    hold_start,
    printed,
)
from dh2urdf_plugins.loaders.simulators import PACKAGES

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.rotations import RigidTransform
    from dh2urdf.source import Problem
    from dh2urdf.stages import LoadReport, LoadRequest
    from dh2urdf_plugins.loaders.simulators import SimulatorOptions

say = Messages(__file__)

YIELD = HOLD_STAYS / 10
"""Displacement at which a motor of the hold test gives its full effort [rad or m]: it acts as a stiff spring."""


class Arm(Model):
    """The arm as Drake holds it, beside the robot that was written; its root is in the world's origin.

    Raises:
        LoaderError: Drake cannot load the file.
    """

    def __init__(self, request: LoadRequest) -> None:
        self.request, self.robot = request, request.robot
        # Drake holds the inertia about the link's origin: a centre of mass far from it costs digits.
        self.comparison = Comparison("Drake", request, DOUBLE._replace(inertia_about_origin=1e-15))
        self._guarded(lambda: super(Arm, self).__init__(request.path.resolve()), "cannot load the file")
        joints = [*map(self.held_joint, self.joints.values())]
        held = self.held_bodies(link.name for link in self.robot.links)
        self.loaded = self.comparison.loaded(version("drake"), joints, held)
        self._fix_root()
        self._add_motors()
        self.plant.mutable_gravity_field().set_gravity_vector([0.0, 0.0, -GRAVITY])
        self._guarded(self.plant.Finalize, "cannot compute with the arm")
        self.build()

    def report(self) -> LoadReport:
        """Measure everything.

        Raises:
            LoaderError: Drake holds another arm.
        """
        report = replace(self.loaded, **self.comparison.poses(self._frames))
        if not self.joints:
            return report
        hold, findings = self._hold()
        return replace(report, hold=hold, findings=(*self._without_actuator(), *findings))

    def _guarded(self, call: Callable[[], Any], doing: str) -> None:
        """Call into Drake, and tell its errors as ours."""
        try:
            call()
        except (RuntimeError, SystemExit) as error:  # Drake's C++ aborts arrive in Python as SystemExit.
            said = str(error).replace(f"{self.request.path.resolve()}:", "line ")
            raise LoaderError(self.comparison.placed(say("drake-refuses", doing=doing, reason=said))) from error

    def _without_actuator(self) -> tuple[Problem, ...]:
        """The joints that a controller in Drake cannot move, and whose efforts it has therefore not kept."""
        idle = [shown(joint["name"]) for joint in self.loaded.joints if "effort" not in joint]
        if not idle:
            return ()
        joints = "1 joint" if len(idle) == 1 else f"{len(idle)} joints"
        return (self.comparison.placed(say("drake-without-actuators", count=joints, joints=listed(idle, 8))),)

    def _fix_root(self) -> None:
        """Weld the root to the world, unless the file has it there; a root of the name ``world`` is the world."""
        root, world = self.frame(self.robot.root), self.plant.world_body()
        if root.body().index() not in {body.index() for body in self.plant.GetBodiesWeldedTo(world)}:
            self.plant.WeldFrames(self.plant.world_frame(), root)

    # Masses and poses

    def _put(self, q: Sequence[float]) -> None:
        """Put the arm at a joint vector, at rest."""
        values = self.plant.GetPositions(self.state)
        for joint, value in zip(self.robot.moving_joints, q, strict=True):
            values[self.joints[joint.name].position_start()] = value
        self.plant.SetPositions(self.state, values)
        self.plant.SetVelocities(self.state, [0.0] * self.plant.num_velocities())

    def _frames(self, q: Sequence[float], links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world at a joint vector."""
        self._put(q)
        return self.placed(links)

    # The hold test

    def _add_motors(self) -> None:
        """Put a motor on every joint whose effort is above 0, with a stiff spring as its control.

        The spring cannot make the simulation unstable: Drake solves for it implicitly (the SAP solver, and
        `PdControllerGains`), and keeps it within the effort.
        """
        from pydrake.multibody.tree import PdControllerGains

        motors = {actuator.joint().name(): actuator for actuator in self.actuators()}
        for joint in self.robot.moving_joints:
            if not joint.limits.effort:
                continue
            if joint.name not in motors:
                motors[joint.name] = self.plant.AddJointActuator(
                    f"hold {joint.name}", self.joints[joint.name], joint.limits.effort
                )
            stiffness = joint.limits.effort / YIELD
            motors[joint.name].set_controller_gains(PdControllerGains(p=stiffness, d=stiffness * 0.1))

    def _hold(self) -> tuple[dict[str, Any], tuple[Problem, ...]]:
        """Whether the motors, with the efforts that were written, keep the arm where it is under gravity."""
        from pydrake.systems.analysis import Simulator

        start = hold_start(self.robot)
        self._put(start)
        contacts = self._overlaps()
        self._switch_contacts_off()
        self._set_targets(dict(zip((joint.name for joint in self.robot.moving_joints), start, strict=True)))
        simulator = Simulator(self.diagram, self.context)
        columns = [self.joints[joint.name].position_start() for joint in self.robot.moving_joints]

        def vectors() -> Iterator[Any]:
            for step in range(1, round(HOLD_SECONDS / TIME_STEP) + 1):
                self._guarded(partial(simulator.AdvanceTo, step * TIME_STEP), "cannot simulate the arm")
                yield self.plant.GetPositions(self.state)[columns]

        return self.comparison.hold(start, farthest(start, vectors()), contacts)

    def _set_targets(self, start: dict[str, float]) -> None:
        """Tell the motors where to stay: positions, then velocities, in the order of each model's actuators."""
        for model in map(self.model, range(self.plant.num_model_instances())):
            actuators = map(self.plant.get_joint_actuator, self.plant.GetJointActuatorIndices(model))
            targets = [start[actuator.joint().name()] for actuator in actuators]
            if targets:
                port = self.plant.get_desired_state_input_port(model)
                port.FixValue(self.state, [*targets, *(0.0 for _ in targets)])

    def _overlaps(self) -> list[tuple[str, str]]:
        """The pairs of links, none joined to the other, whose collision shapes overlap."""
        query = self.scene.get_query_output_port().Eval(self.scene.GetMyContextFromRoot(self.context))
        inspector = self.scene.model_inspector()

        def link(shape: Any) -> str:  # noqa: ANN401 - a module without type information
            return str(self.plant.GetBodyFromFrameId(inspector.GetFrameId(shape)).name())

        touching = [pair for pair in query.ComputePointPairPenetration() if pair.depth > OVERLAP]
        return self.comparison.overlapping((link(pair.id_A), link(pair.id_B)) for pair in touching)

    def _switch_contacts_off(self) -> None:
        from pydrake.geometry import CollisionFilterDeclaration, GeometrySet

        shapes = GeometrySet(self.scene.model_inspector().GetAllGeometryIds())
        context = self.scene.GetMyMutableContextFromRoot(self.context)
        self.scene.collision_filter_manager(context).Apply(CollisionFilterDeclaration().ExcludeWithin(shapes))


def load(request: LoadRequest, options: SimulatorOptions) -> LoadReport:
    """Load a URDF or SDF into Drake and measure it.

    Raises:
        LoaderError: Drake cannot load the file, or holds another arm than the one that was written.
        MissingDependencyError: Drake is not installed.
    """
    PACKAGES["drake"].load(options)
    log_to_output()
    return Arm(request).report()


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """What Drake logged: of a good file nothing.

    A message may have many lines; a line that nobody logged is a message of its own.
    """
    place = f"{request.path.resolve()}:"
    return printed("Drake", request, [(level, text.replace(place, "line ", 1)) for level, text in messages(output)])
