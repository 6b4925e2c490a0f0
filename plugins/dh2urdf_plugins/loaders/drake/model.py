"""What Drake makes of a file, whatever file that is: its bodies, joints and shapes."""

from __future__ import annotations

import logging
import math
import re
import sys
from importlib import import_module
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.measuring import Body
from dh2urdf.rotations import RigidTransform
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
from dh2urdf_plugins.loaders.measures import TIME_STEP, rotation, vector
from dh2urdf_plugins.loaders.simulators import PACKAGES, SimulatorOptions

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from dh2urdf.stages import Question

_MARK = "Drake logged "
_MODULES = ("multibody.parsing", "multibody.plant", "multibody.tree", "systems.framework", "geometry")


class Model:
    """What Drake makes of a file; `build` is called before poses are asked.

    Raises:
        RuntimeError: Drake refuses the file.
        SystemExit: Drake's C++ aborts.
    """

    def __init__(self, path: Path, packages: Mapping[str, Path] | None = None) -> None:
        from pydrake.multibody.parsing import Parser
        from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
        from pydrake.systems.framework import DiagramBuilder

        self._builder = DiagramBuilder()
        self.plant, self.scene = AddMultibodyPlantSceneGraph(self._builder, TIME_STEP)
        parser = Parser(self.plant)
        for name, folder in (packages or {}).items():
            if not parser.package_map().Contains(name):
                parser.package_map().Add(name, str(folder))
        parser.AddModels(path)
        self.joints = {joint.name(): joint for joint in self.moving_joints()}
        self.bodies = {
            body.name(): body
            for model in map(self.model, range(self.plant.num_model_instances()))
            for body in map(self.plant.get_body, self.plant.GetBodyIndices(model))
        }

    def build(self) -> None:
        """Make the diagram and its context, once the plant is finalized."""
        self.diagram = self._builder.Build()
        self.context = self.diagram.CreateDefaultContext()
        self.state = self.plant.GetMyMutableContextFromRoot(self.context)

    def model(self, index: int) -> Any:  # noqa: ANN401 - a module without type information
        """The index of a model, in Drake's own type."""
        from pydrake.multibody.tree import ModelInstanceIndex

        return ModelInstanceIndex(index)

    def moving_joints(self) -> Iterable[Any]:
        """The joints that have a joint value, in Drake's order."""
        joints = map(self.plant.get_joint, self.plant.GetJointIndices())
        return [joint for joint in joints if joint.num_velocities()]

    def held_joint(self, joint: Any) -> dict[str, Any]:  # noqa: ANN401 - a module without type information
        """A joint as Drake has it; the effort is that of its actuator, which a URDF gives it by a transmission only."""
        kind = joint.type_name()
        if joint.num_velocities() != 1:
            return {"name": joint.name(), "type": kind}
        axis = joint.revolute_axis() if kind == "revolute" else joint.translation_axis()
        lower, upper = joint.position_lower_limits()[0], joint.position_upper_limits()[0]
        endless = kind == "revolute" and lower == -math.inf and upper == math.inf
        efforts = {actuator.joint().name(): actuator.effort_limit() for actuator in self.actuators()}
        return {
            "name": joint.name(),
            "type": "continuous" if endless else kind,
            "axis": tuple(float(element) + 0.0 for element in axis),
            "lower": None if endless else float(lower),
            "upper": None if endless else float(upper),
            "velocity": float(joint.velocity_upper_limits()[0]),
            **({"effort": efforts[joint.name()]} if joint.name() in efforts else {}),
        }

    def actuators(self) -> Iterable[Any]:
        """The actuators, in Drake's order."""
        return map(self.plant.get_joint_actuator, self.plant.GetJointActuatorIndices())

    def frame(self, name: str) -> Any:  # noqa: ANN401 - a module without type information
        """The frame of a link, which of an SDF may be a frame on another body."""
        return self.bodies[name].body_frame() if name in self.bodies else self.plant.GetFrameByName(name)

    def held_bodies(self, links: Iterable[str] = ()) -> dict[str, Body]:
        """The links as Drake has them, a mere frame without mass; `links` are those that may be frames."""
        nothing = Body(0.0, (0.0, 0.0, 0.0), (0.0,) * 9)
        names = [name for name in links if name not in self.bodies]
        bodies = {name: nothing for name in names if self.plant.HasFrameNamed(name)}
        for name, body in self.bodies.items():
            if body.index() == self.plant.world_body().index():  # It has no mass of its own.
                bodies[name] = nothing
                continue
            spatial = body.default_spatial_inertia()
            com = spatial.get_com()
            about_com = spatial.Shift(com).CalcRotationalInertia().CopyToFullMatrix3()
            bodies[name] = Body(float(spatial.get_mass()), vector(com), rotation(about_com))
        return bodies

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world, as the context has them."""
        poses = {name: self.frame(name).CalcPoseInWorld(self.state) for name in links}
        return {
            name: RigidTransform(rotation(pose.rotation().matrix()), vector(pose.translation()))
            for name, pose in poses.items()
        }

    def held_shapes(self) -> dict[str, dict[str, list[tuple[float, float, float]]]]:
        """The lengths of the shapes of each body; of a mesh, where Drake has its convex hull."""
        from pydrake.geometry import Role

        inspector = self.scene.model_inspector()
        found: dict[str, dict[str, list[tuple[float, float, float]]]] = {}
        for name, body in self.bodies.items():
            frame = self.plant.GetBodyFrameIdIfExists(body.index())
            for role, word in ((Role.kIllustration, VISUAL), (Role.kProximity, COLLISION)):
                for shape in inspector.GetGeometries(frame, role) if frame is not None else ():
                    if size := _lengths_of_shape(inspector, shape):
                        found.setdefault(name, {}).setdefault(word, []).append(size)
        return found


def _lengths_of_shape(inspector: Any, shape: Any) -> tuple[float, float, float] | None:  # noqa: ANN401 - of Drake
    from pydrake.geometry import Box, Capsule, Cylinder, Sphere

    match inspector.GetShape(shape):
        case Box() as box:
            return lengths(box.width(), box.depth(), box.height())
        case Sphere() as sphere:
            return lengths(*(3 * (2 * sphere.radius(),)))
        case Cylinder() as cylinder:
            return lengths(2 * cylinder.radius(), 2 * cylinder.radius(), cylinder.length())
        case Capsule() as capsule:
            wide = 2 * capsule.radius()
            return lengths(wide, wide, wide + capsule.length())
    hull = inspector.GetConvexHull(shape)
    return None if hull is None else lengths_of([hull.vertex(at) for at in range(hull.num_vertices())])


def prepare() -> str:
    """Import Drake; its version.

    Raises:
        MissingDependencyError: it is not installed.
    """
    PACKAGES["drake"].load(SimulatorOptions())
    for module in _MODULES:
        import_module(f"pydrake.{module}")
    return version("drake")


def inspect(question: Question) -> HeldRobot:
    """What Drake makes of a URDF, an SDF or an MJCF.

    Raises:
        LoaderError: it refuses the file, or what it makes of it.
    """
    log_to_output()
    try:
        held = Model(question.path, question.packages)
        held.plant.Finalize()
        held.build()
    except (RuntimeError, ValueError) as error:
        raise refused(error, question) from error
    except SystemExit as error:
        raise refused(f"ends the interpreter with SystemExit: {error}", question) from error
    plant = held.plant
    world = plant.world_body().index()
    names = [name for name, body in held.bodies.items() if body.index() != world]

    def frames(values: Mapping[str, float]) -> dict[str, RigidTransform]:
        positions = plant.GetDefaultPositions()
        for name, value in values.items():
            if name in held.joints and held.joints[name].num_positions() == 1:
                positions[held.joints[name].position_start()] = value
        plant.SetPositions(held.state, positions)
        return held.placed(names)

    bodies = held.held_bodies()
    # Python is not told whom a coupler joins.
    mimic = {} if plant.num_constraints() else {"mimic": None}
    return HeldRobot(
        links=told_bodies({name: bodies[name] for name in names}),
        joints=[{**held.held_joint(joint), **mimic} for joint in held.joints.values() if joint.num_velocities() == 1],
        frames=told_frames(question.postures, frames),
        shapes=held.held_shapes(),
        root_is_loose=bool(plant.GetFloatingBaseBodies()),
    )


def log_to_output() -> None:
    """Print what Drake logs: its C++ hands it to this logger, whose last resort would print it without its level."""
    to_output = logging.StreamHandler(sys.stderr)
    to_output.setFormatter(logging.Formatter(f"{_MARK}%(levelname)s: %(message)s"))
    logger = logging.getLogger("drake")
    logger.handlers, logger.propagate = [to_output], False


_LOGGED = re.compile(rf"{_MARK}([A-Z]+): ")


def messages(output: str) -> list[tuple[str, str]]:
    """What Drake logged: the level and the text of each; a line that nobody logged is a message of its own."""
    found: list[tuple[str, str]] = []
    for line in filter(None, map(str.strip, output.splitlines())):
        logged = _LOGGED.match(line)
        if found and found[-1][0] and not logged:
            found[-1] = (found[-1][0], f"{found[-1][1]} {line}")
        else:
            found.append((logged[1] if logged else "", _LOGGED.sub("", line)))
    return found


def complaints(output: str) -> list[str]:
    """What Drake logged, without what else was printed."""
    return [words for level, words in messages(output) if level]
