"""What Pinocchio makes of a file, whatever file that is: its joints, frames and shapes."""

from __future__ import annotations

import math
import re
import sys
from importlib.metadata import version
from typing import TYPE_CHECKING, Any

from dh2urdf.measuring import Body
from dh2urdf.rotations import RigidTransform
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.loaders.inspecting import (
    COLLISION,
    VISUAL,
    lengths,
    refused,
    told_bodies,
    told_frames,
)
from dh2urdf_plugins.loaders.measures import rotation, vector
from dh2urdf_plugins.loaders.simulators import PACKAGES, SimulatorOptions

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping
    from pathlib import Path

    from dh2urdf.stages import Question

UNIVERSE = 0
"""The joint that holds the root."""


class Model:
    """What Pinocchio makes of a URDF.

    Raises:
        ValueError: Pinocchio refuses the file; the reason stands only in what its parser prints.
    """

    def __init__(self, pinocchio: Any, path: Path) -> None:  # noqa: ANN401 - a module without type information
        self.pinocchio = pinocchio
        self.model = pinocchio.buildModelFromUrdf(str(path))
        self.joints = {name: number for number, name in enumerate(self.model.names) if number != UNIVERSE}
        frames = enumerate(self.model.frames)
        self.numbers = {frame.name: number for number, frame in frames if frame.type == pinocchio.FrameType.BODY}

    def held_joint(self, number: int) -> dict[str, Any]:
        """A joint as Pinocchio has it; its axis is read off the columns of its motion subspace."""
        model, joint = self.model, self.model.joints[number]
        if joint.nv != 1:
            return {"name": model.names[number], "type": joint.shortname()}
        turning = joint.createData()
        joint.calc(turning, self.pinocchio.neutral(model)[joint.idx_q : joint.idx_q + joint.nq])
        *along, rx, ry, rz = (float(element) + 0.0 for element in turning.S.reshape(6))
        slides = any(along)
        endless = joint.nq == 2  # noqa: PLR2004 - cosine and sine
        return {
            "name": model.names[number],
            "type": "prismatic" if slides else "continuous" if endless else "revolute",
            "axis": tuple(along) if slides else (rx, ry, rz),
            "lower": None if endless else float(model.lowerPositionLimit[joint.idx_q]),
            "upper": None if endless else float(model.upperPositionLimit[joint.idx_q]),
            "velocity": float(model.velocityLimit[joint.idx_v]),
            "effort": float(model.effortLimit[joint.idx_v]),
        }

    def held_bodies(self) -> dict[str, Body]:
        """The bodies by the names of the links that carry them: the child of each joint, and the root."""
        carriers: dict[int, str] = {}
        for name, number in self.numbers.items():
            carriers.setdefault(int(self.model.frames[number].parentJoint), name)
        inertias = {name: self.model.inertias[joint] for joint, name in carriers.items()}
        return {
            name: Body(float(inertia.mass), vector(inertia.lever), rotation(inertia.inertia))
            for name, inertia in inertias.items()
        }

    def coordinates(self, values: Mapping[str, float]) -> Any:  # noqa: ANN401 - an array of Pinocchio's coordinates
        """Values of joints in Pinocchio's coordinates: cosine and sine of a joint that turns without end."""
        coordinates = self.pinocchio.neutral(self.model)
        for name, value in values.items():
            joint = self.model.joints[self.joints[name]] if name in self.joints else None
            if joint is None or joint.nv != 1:
                continue
            if joint.nq == 2:  # noqa: PLR2004 - cosine and sine
                coordinates[joint.idx_q : joint.idx_q + 2] = math.cos(value), math.sin(value)
            else:
                coordinates[joint.idx_q] = value
        return coordinates

    def placed(self, data: Any, links: Iterable[str]) -> dict[str, RigidTransform]:  # noqa: ANN401 - Pinocchio's working memory
        """The frames of some links in the root, as its working memory has them."""
        frames = ((name, data.oMf[self.numbers[name]]) for name in links)
        return {name: RigidTransform(rotation(frame.rotation), vector(frame.translation)) for name, frame in frames}


def prepare() -> str:
    """Import Pinocchio; its version.

    Raises:
        MissingDependencyError: it is not installed.
    """
    PACKAGES["pinocchio"].load(SimulatorOptions())
    return version("pin")


def inspect(question: Question) -> HeldRobot:
    """What Pinocchio makes of a URDF.

    Raises:
        LoaderError: it refuses the file.
    """
    pinocchio = sys.modules["pinocchio"]
    try:
        held = Model(pinocchio, question.path)
    except UnicodeError:  # It takes no path with bytes that are no text; what it makes of the file is not known.
        raise
    except (ValueError, RuntimeError) as error:
        raise refused("", question) from error
    data = held.model.createData()

    def frames(values: Mapping[str, float]) -> dict[str, RigidTransform]:
        pinocchio.framesForwardKinematics(held.model, data, held.coordinates(values))
        return held.placed(data, held.numbers)

    bodies = told_bodies(held.held_bodies())
    found = HeldRobot(
        links={name: bodies.get(name) for name in held.numbers},
        joints=[{**held.held_joint(number), "mimic": None} for number in held.joints.values()],
        frames=told_frames(question.postures, frames),
    )
    _add_shapes(pinocchio, held.model, question, found)
    return found


def _add_shapes(pinocchio: Any, model: Any, question: Question, found: HeldRobot) -> None:  # noqa: ANN401 - of Pinocchio
    """Add the lengths of the shapes, which Pinocchio reads by a function of their own, and may refuse."""
    folders = sorted({str(folder.parent) for folder in question.packages.values()} | {str(question.path.parent)})
    for kind, word in ((pinocchio.GeometryType.VISUAL, VISUAL), (pinocchio.GeometryType.COLLISION, COLLISION)):
        try:
            shapes = pinocchio.buildGeomFromUrdf(model, str(question.path), kind, package_dirs=folders)
        except (ValueError, RuntimeError) as error:
            found.refusals.append(f"{word} shapes: {refused(error, question)}")
            continue
        for shape in shapes.geometryObjects:
            shape.geometry.computeLocalAABB()
            box = shape.geometry.aabb_local
            size = lengths(box.width(), box.height(), box.depth())
            name = model.frames[shape.parentFrame].name
            found.shapes.setdefault(name, {}).setdefault(word, []).append(size)


# What Pinocchio's parser, urdfdom, prints: a level, a text, and in the next line where in urdfdom's source it stands.
MESSAGE = re.compile(r"^(Warning|Error): *(.*?) *$", re.MULTILINE)


def complaints(output: str) -> list[str]:
    """The warnings and errors that Pinocchio's parser printed."""
    return [words for _, words in MESSAGE.findall(output)]
