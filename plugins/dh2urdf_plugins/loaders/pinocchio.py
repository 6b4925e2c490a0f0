"""The loader `pinocchio`: loads a URDF into Pinocchio, measures the arm, and reads what its parser prints.

Pinocchio is a library of rigid-body algorithms and simulates nothing: whether the arm can hold its weight is asked of
its recursive Newton-Euler algorithm. It keeps moving bodies only, and adds to each what fixed joints hold to it; links
are frames. https://gepettoweb.laas.fr/doc/stack-of-tasks/pinocchio has its documentation.
"""

from __future__ import annotations

import math
import re
import sys
from dataclasses import replace
from functools import cached_property
from importlib.metadata import version
from operator import itemgetter
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import GRAVITY
from dh2urdf.manipulator import JointType
from dh2urdf.measuring import Body
from dh2urdf.source import Messages
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.loaders import measures

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from dh2urdf.rotations import RigidTransform
    from dh2urdf.stages import LoadReport, LoadRequest, Question
    from dh2urdf_plugins.loaders.simulators import SimulatorOptions

say = Messages(__file__)

MEASURED_JOINTS = 250
"""Largest number of joints of an arm that is put into a pose: Pinocchio's working memory holds four arrays of the cube
of their number, here half a gigabyte."""
_WHOLE_TURNS = 2  # coordinates of a joint that turns without end: cosine and sine


class Held(measures.Model):
    """What Pinocchio makes of a URDF."""

    def __init__(self, path: Path, *, floats: bool = False) -> None:
        self.pinocchio: Any = sys.modules["pinocchio"]
        root = [self.pinocchio.JointModelFreeFlyer()] if floats else []
        self.model = self.pinocchio.buildModelFromUrdf(str(path), *root)
        self.root = len(root)  # the number of the joint that holds the root
        self.joints = {name: number for number, name in enumerate(self.model.names) if number > self.root}
        frames, body = enumerate(self.model.frames), self.pinocchio.FrameType.BODY
        self.numbers = {frame.name: number for number, frame in frames if frame.type == body}

    @cached_property
    def data(self) -> Any:  # noqa: ANN401 - Pinocchio's working memory
        """The working memory, which may be large."""
        return self.model.createData()

    def held_joints(self) -> list[dict[str, Any]]:
        """The joints as Pinocchio has them; an axis is read off the columns of the joint's motion subspace."""
        model, held = self.model, []
        for number in self.joints.values():
            name, joint = model.names[number], model.joints[number]
            if joint.nv != 1:
                held.append({"name": name, "type": joint.shortname()})
                continue
            turning = joint.createData()
            joint.calc(turning, self.pinocchio.neutral(model)[joint.idx_q : joint.idx_q + joint.nq])
            *along, rx, ry, rz = (float(element) + 0.0 for element in turning.S.reshape(6))
            slides, endless = any(along), joint.nq == _WHOLE_TURNS
            kind = "prismatic" if slides else "continuous" if endless else "revolute"
            axis = tuple(along) if slides else (rx, ry, rz)
            bounds = (float(ends[joint.idx_q]) for ends in (model.lowerPositionLimit, model.upperPositionLimit))
            velocity, effort = (float(most[joint.idx_v]) for most in (model.velocityLimit, model.effortLimit))
            held.append(measures.joint_record(name, kind, axis, *bounds, velocity=velocity, effort=effort))
        return held

    def held_bodies(self, carriers: Mapping[str, int | None]) -> dict[str, Body]:
        """The bodies by the names of the links that carry them, given the joints that hold these."""
        inertias = {name: self.model.inertias[number] for name, number in carriers.items() if number is not None}
        return {
            name: Body(float(inertia.mass), measures.vector(inertia.lever), measures.rotation(inertia.inertia))
            for name, inertia in inertias.items()
        }

    def coordinates(self, values: Mapping[str, float]) -> Any:  # noqa: ANN401 - an array of Pinocchio's coordinates
        """Values of joints in Pinocchio's coordinates: cosine and sine of a joint that turns without end."""
        coordinates = self.pinocchio.neutral(self.model)
        for name, value in values.items():
            joint = self.model.joints[self.joints[name]] if name in self.joints else None
            if joint is None or joint.nv != 1:
                continue
            if joint.nq == _WHOLE_TURNS:
                coordinates[joint.idx_q : joint.idx_q + 2] = math.cos(value), math.sin(value)
            else:
                coordinates[joint.idx_q] = value
        return coordinates

    def put(self, values: Mapping[str, float]) -> None:
        """Put joints at values [rad or m]."""
        self.pinocchio.framesForwardKinematics(self.model, self.data, self.coordinates(values))

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the root."""
        frames = ((name, self.data.oMf[self.numbers[name]]) for name in links)
        return {name: measures.frame(frame.rotation, frame.translation) for name, frame in frames}


def load(request: LoadRequest, _options: SimulatorOptions) -> LoadReport:
    """Load a URDF into Pinocchio and measure it."""
    robot, comparison = request.robot, measures.Comparison("Pinocchio", request)
    try:
        held = Held(request.path.resolve(), floats=robot.root in robot.floating)
    except ValueError as error:  # The reason stands only in what the parser prints.
        raise LoaderError(comparison.placed(say("cannot-load", simulator="Pinocchio"))) from error
    joints = held.held_joints()
    carriers = {joint.child: held.joints.get(joint.name) for joint in robot.moving_joints}
    bodies, written = held.held_bodies({**carriers, robot.root: held.root}), measures.lumped_bodies(robot)
    lost = [link.name for link in robot.links if link.name not in held.numbers]
    report = comparison.loaded(version("pin"), joints, bodies, written, comparison.lost(lost))
    if len(joints) > MEASURED_JOINTS:
        found, accepted = f"{len(joints)} moving joints", f"at most {MEASURED_JOINTS} moving joints"
        too_large = say("pinocchio-arm-too-large", found=found, accepted=accepted)
        return replace(report, findings=(comparison.placed(too_large),))
    report = replace(report, **comparison.poses_of(held))
    return replace(report, **_hold(held, comparison)) if joints else report


def _hold(held: Held, comparison: measures.Comparison) -> dict[str, Any]:
    """Whether the efforts that Pinocchio read hold the arm at rest, at its start and at every measured pose."""
    import numpy as np

    model, start = held.model, measures.hold_start(comparison.robot)
    model.gravity.linear = np.array((0.0, 0.0, -GRAVITY))
    rest = np.zeros(model.nv)
    joints = [(joint, model.joints[held.joints[joint.name]].idx_v) for joint in comparison.robot.moving_joints]
    vectors = (start, *comparison.request.poses)
    loads = []
    for q in vectors:
        forces = held.pinocchio.rnea(model, held.data, held.coordinates(comparison.values(q)), rest, rest)
        for joint, at in joints:
            force = abs(float(forces[at]))
            loads.append((measures.share_of(float(model.effortLimit[at]), force), force, joint, tuple(q)))
    share, force, joint, q = max(loads, key=itemgetter(0))
    hold = {
        "start": start,
        "poses": len(vectors),
        "largest_load": share if math.isfinite(share) else None,
        "joint": joint.name,
        "q": q,
        "threshold": 1.0,
        "stayed": share <= 1.0,
    }
    if share <= 1.0:
        return {"hold": hold}
    unit = "N" if joint.type is JointType.PRISMATIC else "N·m"
    return {"hold": hold, "findings": (comparison.weak(joint, "arm-too-heavy", q=q, force=force, unit=unit),)}


def inspect(question: Question) -> HeldRobot:
    """What Pinocchio makes of a URDF."""
    try:
        held = Held(question.path)
    except UnicodeError:  # It takes no path with bytes that are no text; what it makes of the file is not known.
        raise
    except (ValueError, RuntimeError) as error:
        raise measures.refused("", question) from error
    carriers: dict[int, str] = {}
    for name, number in held.numbers.items():
        carriers.setdefault(int(held.model.frames[number].parentJoint), name)
    bodies = measures.told_bodies(held.held_bodies({name: number for number, name in carriers.items()}))
    refusals: list[str] = []
    return HeldRobot(
        links={name: bodies.get(name) for name in held.numbers},
        joints=[{**joint, "mimic": None} for joint in held.held_joints()],
        frames=held.told_frames(held.numbers, question.postures),
        shapes=measures.told_shapes(_shapes(held, question, refusals)),
        refusals=refusals,
    )


def _shapes(held: Held, question: Question, refusals: list[str]) -> Iterator[tuple[str, str, measures.Lengths]]:
    """The lengths of the shapes, which Pinocchio reads by a function of their own, and may refuse."""
    folders = sorted({str(folder.parent) for folder in question.packages.values()} | {str(question.path.parent)})
    kinds = held.pinocchio.GeometryType
    for kind, word in ((kinds.VISUAL, measures.VISUAL), (kinds.COLLISION, measures.COLLISION)):
        try:
            shapes = held.pinocchio.buildGeomFromUrdf(held.model, str(question.path), kind, package_dirs=folders)
        except (ValueError, RuntimeError) as error:
            refusals.append(f"{word} shapes: {measures.refused(error, question)}")
            continue
        for shape in shapes.geometryObjects:
            shape.geometry.computeLocalAABB()
            box = shape.geometry.aabb_local
            size = measures.lengths(box.width(), box.height(), box.depth())
            yield held.model.frames[shape.parentFrame].name, word, size


# What Pinocchio's parser, urdfdom, prints: a level, a text, and in the next line where in urdfdom's source it stands.
_MESSAGE = re.compile(r"^(Warning|Error): *(.*?) *$", re.MULTILINE)


def messages(output: str, _request: LoadRequest | None = None) -> list[tuple[str, str]]:
    """The warnings and errors that Pinocchio's parser printed."""
    return _MESSAGE.findall(output)
