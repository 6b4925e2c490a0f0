"""The loader `gazebo`: has sdformat, the reader of Gazebo, convert and check the written file, and measures the model.

Gazebo reads SDF by sdformat, and a URDF too, which sdformat turns into SDF: what it drops, lumps or changes there is
missing in Gazebo. sdformat has a command, `gz sdf` (`ign sdf` up to Gazebo Fortress), which needs no Gazebo and no
display.
"""

from __future__ import annotations

import math
import re
import shutil
import subprocess
import sys
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import LoaderError, MissingProgramError, ProofError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.mass import tensor
from dh2urdf.measuring import DOUBLE, Body
from dh2urdf.rotations import IDENTITY, RigidTransform, quarter_turns
from dh2urdf.source import Messages, shown
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.base_bodies import with_base_bodies
from dh2urdf_plugins.formats.sdf.reader import parse_sdf
from dh2urdf_plugins.loaders import measures

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from dh2urdf.measuring import Precision
    from dh2urdf.robot import Robot
    from dh2urdf.stages import LoadReport, LoadRequest, Question
    from dh2urdf_plugins.loaders.simulators import SimulatorOptions

say = Messages(__file__)

COMMANDS = ("gz", "ign")
"""What the command of sdformat is a subcommand of: in Gazebo from Garden on (and Gazebo classic), and before."""
REMEDY = (
    "apt-get install ignition-tools libsdformat-dev (Debian 12), or install Gazebo (gazebosim.org), "
    "which brings it along"
)
MISSING = ("loader 'gazebo'", "the command `gz sdf` or `ign sdf` of sdformat", REMEDY)


class Held(measures.Model):
    """A robot as sdformat wrote it, and the robot of which it was asked, where that is known.

    sdformat lumps what a fixed joint holds into the link that carries it: of a URDF, flange and tool0 are no links in
    Gazebo. (Later versions keep a frame of the name.) `carriers` has for such links the one that carries it, and their
    frame there.
    """

    def __init__(self, model: Robot, written: Robot | None = None) -> None:
        self.model, self._written = model, written
        self.joints: list[dict[str, Any]] = [
            {
                "name": joint.name,
                "type": joint.type.value,
                "axis": joint.axis,
                **{name: getattr(joint.limits, name) for name in ("lower", "upper", "velocity", "effort")},
            }
            for joint in model.moving_joints
        ]
        self.bodies = {
            link.name: Body(link.inertial.mass, link.inertial.com, tensor(link.inertial.inertia))
            for link in model.links
            if link.inertial
        }
        self.carriers = measures.carriers(written or model, self.bodies)

    def put(self, values: Mapping[str, float]) -> None:
        """Put joints at values [rad or m]; the others are at 0."""
        moving = (joint.name for joint in self.model.moving_joints)
        self._frames = link_poses(self.model, {name: values.get(name, 0.0) for name in moving})
        if self._written:
            to_root = self._frames[self._written.root].inverse
            self._frames = {name: to_root @ frame for name, frame in self._frames.items()}

    def placed(self, links: Iterable[str]) -> dict[str, RigidTransform]:
        """The frames of some links in the world; of a written robot, in its root."""
        found = ((name, *((name, IDENTITY) if name in self._frames else self.carriers[name])) for name in links)
        return {name: self._frames[carrier] @ pose for name, carrier, pose in found}


# --- The command


def require() -> None:
    """Raise `MISSING` where there is no command that may be sdformat's, without starting any."""
    if not any(map(shutil.which, COMMANDS)):
        raise MissingProgramError(*MISSING)


def find_command() -> tuple[str, str]:
    """The command that has sdformat as a subcommand, and the version of sdformat, for which it is asked once."""
    for command in filter(None, map(shutil.which, COMMANDS)):
        if version := _version(command):
            return command, version
    raise MissingProgramError(*MISSING)


@cache
def _version(command: str) -> str:
    """The version of sdformat that a command has; empty where it has none."""
    asked = subprocess.run(  # noqa: S603 - no words of a stranger
        [command, "sdf", "--versions"], capture_output=True, check=False, text=True, encoding="utf-8"
    )
    version = re.search(r"^\d+(\.\d+)+$", asked.stdout, re.MULTILINE)
    return version[0] if version else ""


def _call(option: str, path: str) -> subprocess.CompletedProcess[bytes]:
    """Call sdformat; its messages go where a simulator's do, into the report."""
    command = [find_command()[0], "sdf", option, path]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=sys.stderr, check=False)  # noqa: S603 - no shell
    if done.returncode and done.stdout:  # Of a file that it refuses it also speaks on standard output.
        sys.stderr.write(done.stdout.decode("utf-8", "replace"))
    return done


# --- The arm of a run


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
    """Have sdformat convert and check a file, and measure the model that it makes of it."""
    robot, path = request.robot, str(request.path.resolve())
    comparison, version = measures.Comparison("sdformat", request, precision(robot)), find_command()[1]
    converted, checked = _call("--print", path), _call("--check", path)
    for done, what in ((converted, "cannot convert the file"), (checked, "finds the file invalid")):
        if done.returncode or not done.stdout.strip():
            raise LoaderError(comparison.placed(say("sdformat-refuses", what=what)))
    try:
        held = Held(parse_sdf(converted.stdout, "what sdformat wrote"), robot)
    except ProofError as error:
        raise LoaderError(error.problems) from error
    frames = {link.name for link in held.model.links}
    # A link is compared with the sum of what it carries; no link need be in a mere frame.
    lumped = measures.lumped_bodies(with_base_bodies(robot), held.bodies)  # it has no arm whose base weighs nothing
    written = {name: body for name, body in lumped.items() if body.mass or name in held.bodies or name not in frames}
    report = comparison.loaded(version, held.joints, held.bodies, written)
    report = replace(report, **comparison.poses_of(held))
    # A person looks for tool0 in Gazebo in vain.
    lost = [
        f"{shown(link.name)} (in {shown(held.carriers[link.name][0])})"
        for link in robot.links[1:]
        if link.name not in frames and not (link.inertial and link.inertial.mass)
    ]
    findings = (comparison.placed(say("gazebo-lumped-links", links=", ".join(lost))),) if lost else ()
    return replace(report, findings=findings)


# --- A file of any origin


def inspect(question: Question) -> HeldRobot:
    """What sdformat makes of a URDF or an SDF."""
    path = str(question.path)
    checked, converted = _call("--check", path), _call("--print", path)
    if checked.returncode or converted.returncode or not converted.stdout.strip():
        told = checked.stdout if checked.returncode else converted.stdout
        raise measures.refused(_COLOUR.sub("", told.decode("utf-8", "replace")), question)
    try:
        held = Held(parse_sdf(converted.stdout, "what sdformat wrote"))
    except ProofError:  # A model with more to it than one arm: the names of its links are all that is known.
        return HeldRobot(links=dict.fromkeys(_LINK.findall(converted.stdout.decode("utf-8", "replace"))))
    names, links = [link.name for link in held.model.links], measures.told_bodies(held.bodies)
    shapes = (
        (link.name, word, measures.lengths(*size) if (size := measures.edges(shape.geometry)) else None)
        for link in held.model.links
        for word, shapes in ((measures.VISUAL, link.visuals), (measures.COLLISION, link.collisions))
        for shape in shapes
    )
    return HeldRobot(
        links={name: links.get(name) for name in names},
        joints=held.joints,
        frames=held.told_frames(names, question.postures),
        shapes=measures.told_shapes(shapes),
    )


_LINK = re.compile(r"<link name='([^\n']*)'")
_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_LEVEL = re.compile(r"\b(Error|Warning)\b")
_EXPECTED = re.compile(r"backtrace generation will be disabled")  # said by `ign` of itself, whatever it does


def messages(output: str, _request: LoadRequest | None = None) -> list[tuple[str, str]]:
    """What sdformat printed, with its levels; of a good file it prints nothing.

    A message may go on in lines that are indented.
    """
    found: list[str] = []
    for line in _COLOUR.sub("", output).splitlines():
        if line[:1].isspace() and found:
            found[-1] += f" {line.strip()}"
        elif line.strip():
            found.append(line.strip())
    told = [message for message in found if not _EXPECTED.search(message)]
    return [(level[1] if (level := _LEVEL.search(message)) else "", message) for message in told]
