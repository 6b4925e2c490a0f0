"""The loader `gazebo`: has sdformat, the reader of Gazebo, convert and check the written file, and measures the model.

Gazebo reads SDF by sdformat, and a URDF too, which sdformat turns into SDF: what it drops, lumps or changes there is
missing in Gazebo. sdformat has a command, `gz sdf` (`ign sdf` up to Gazebo Fortress), which needs no Gazebo and no
display.
"""

from __future__ import annotations

import math
import re
import shutil
import sys
from dataclasses import asdict, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import LoaderError, ProofError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.mass import tensor
from dh2urdf.measuring import DOUBLE, Body
from dh2urdf.rotations import IDENTITY, RigidTransform, quarter_turns
from dh2urdf.source import Messages, shown
from dh2urdf_plugins.base_bodies import with_base_bodies
from dh2urdf_plugins.loaders.gazebo.model import COMMANDS, call, complaints, find_command, missing
from dh2urdf_plugins.loaders.measures import Comparison, carriers, lumped_bodies, printed

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.measuring import Precision
    from dh2urdf.robot import Inertial, Robot
    from dh2urdf.source import Problem
    from dh2urdf.stages import LoadReport, LoadRequest
    from dh2urdf_plugins.loaders.simulators import SimulatorOptions

say = Messages(__file__)


def require(_options: SimulatorOptions) -> None:
    """Ask whether there is a command that may be sdformat's, without starting it.

    Raises:
        MissingProgramError: there is none.
    """
    if not any(map(shutil.which, COMMANDS)):
        raise missing()


def prepare(_options: SimulatorOptions) -> None:
    """Find the command of sdformat: it is asked for its version once.

    Raises:
        MissingProgramError: there is none.
    """
    find_command()


class Arm:
    """The arm as sdformat has it, beside the robot that was written.

    sdformat lumps what a fixed joint holds into the link that carries it: of a URDF, flange and tool0 are no links in
    Gazebo. (Later versions keep a frame of the name.) So links are compared with the sum of what they carry, and tool0
    is measured at its carrier, times the transform between the two that was written.
    """

    def __init__(self, model: Robot, comparison: Comparison) -> None:
        self.model, self.comparison, self.robot = model, comparison, comparison.robot
        self.frames = {link.name for link in model.links}
        self.links = {
            link.name: Body(link.inertial.mass, link.inertial.com, tensor(link.inertial.inertia))
            for link in model.links
            if link.inertial
        }
        self.carriers = carriers(self.robot, self.links)

    def report(self, version: str) -> LoadReport:
        """Measure everything.

        Args:
            version: that of sdformat.

        Raises:
            LoaderError: sdformat holds another arm.
        """
        joints = (
            {"name": joint.name, "type": joint.type.value, "axis": joint.axis, **asdict(joint.limits)}
            for joint in self.model.moving_joints
        )
        report = self.comparison.loaded(version, joints, self.links, self._written_bodies())
        return replace(report, **self.comparison.poses(self._frames), findings=self._lumped())

    def _written_bodies(self) -> dict[str, Inertial]:
        """What the links of the model should be: the sums of what they carry."""
        bodies = lumped_bodies(with_base_bodies(self.robot), self.links)  # it has no arm whose base weighs nothing
        return {
            name: body
            for name, body in bodies.items()
            if body.mass or name in self.links or name not in self.frames  # No link need be in a mere frame.
        }

    def _frames(self, q: Sequence[float], links: Sequence[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the root at a joint vector."""
        values = {joint.name: value for joint, value in zip(self.robot.moving_joints, q, strict=True)}
        held = link_poses(self.model, values)
        to_root = held[self.robot.root].inverse
        frames = {}
        for name in links:
            carrier, pose = (name, IDENTITY) if name in held else self.carriers[name]
            frames[name] = to_root @ held[carrier] @ pose
        return frames

    def _lumped(self) -> tuple[Problem, ...]:
        """The frames that are missing in Gazebo: a person looks for tool0 there in vain."""
        lost = [
            link.name
            for link in self.robot.links[1:]
            if link.name not in self.frames and not (link.inertial and link.inertial.mass)
        ]
        if not lost:
            return ()
        names = ", ".join(f"{shown(name)} (in {shown(self.carriers[name][0])})" for name in lost)
        return (self.comparison.placed(say("gazebo-lumped-links", links=names)),)


def precision(robot: Robot) -> Precision:
    """What sdformat's arithmetic is: double precision, written in 16 digits, and less near the singular pitch.

    It reads a joint's roll, pitch and yaw, keeps a quaternion, and writes them anew. It takes the pitch from an asin:
    near ±π/2 that loses as many digits as the cosine of the pitch is small, half of all at the worst. (Exactly there
    it does not.) Lumping moves an inertia to another point, so that of a body far from there its digits count as little
    as beside m·r².
    """
    epsilon = sys.float_info.epsilon
    pitches = [joint.origin.rpy[1] for joint in robot.joints]
    lost = 4.0 * sum(
        min(epsilon / abs(math.cos(pitch)), math.sqrt(epsilon)) for pitch in pitches if quarter_turns(pitch) is None
    )
    return DOUBLE._replace(
        position=DOUBLE.position + lost, angle=DOUBLE.angle + lost, inertia_about_origin=4.0 * epsilon
    )


def load(request: LoadRequest, _options: SimulatorOptions) -> LoadReport:
    """Have sdformat convert and check a file, and measure the model that it makes of it.

    Raises:
        LoaderError: sdformat refuses the file, or makes another arm of it than the one that was written.
        MissingProgramError: sdformat is not installed.
    """
    from dh2urdf_plugins.formats.sdf.reader import parse_sdf

    command, version = find_command()
    comparison = Comparison("sdformat", request, precision(request.robot))
    path = str(request.path.resolve())
    converted = call(command, "--print", path)
    checked = call(command, "--check", path)
    for done, what in ((converted, "cannot convert the file"), (checked, "finds the file invalid")):
        if done.returncode or not done.stdout.strip():
            raise LoaderError(comparison.placed(say("sdformat-refuses", what=what)))
    try:
        model = parse_sdf(converted.stdout, "what sdformat wrote")
    except ProofError as error:
        raise LoaderError(error.problems) from error
    return Arm(model, comparison).report(version)


_LEVEL = re.compile(r"\b(Error|Warning)\b")


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """What sdformat printed."""
    messages = complaints(output)
    levels = [level[1] if (level := _LEVEL.search(message)) else "" for message in messages]
    return printed("sdformat", request, zip(levels, messages, strict=True))
