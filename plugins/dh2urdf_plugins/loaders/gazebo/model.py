"""What sdformat makes of a file, whatever file that is: its command is started for each."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from dataclasses import asdict
from functools import cache
from typing import TYPE_CHECKING

from dh2urdf.errors import MissingProgramError, ProofError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.mass import tensor
from dh2urdf.measuring import Body
from dh2urdf.robot import Box, Cylinder, Sphere
from dh2urdf.stages import HeldRobot
from dh2urdf_plugins.loaders.inspecting import COLLISION, VISUAL, lengths, refused, told_bodies, told_frames

if TYPE_CHECKING:
    from collections.abc import Mapping

    from dh2urdf.robot import Geometry, Robot
    from dh2urdf.stages import Question

COMMANDS = ("gz", "ign")
"""What the command of sdformat is a subcommand of: in Gazebo from Garden on (and Gazebo classic), and before."""
REMEDY = (
    "apt-get install ignition-tools libsdformat-dev (Debian 12), or install Gazebo (gazebosim.org), "
    "which brings it along"
)


def prepare() -> str:
    """Find the command of sdformat, and import what reads its answer; the version of sdformat.

    Raises:
        MissingProgramError: there is none.
    """
    import dh2urdf_plugins.formats.sdf.reader  # noqa: F401 - nothing can be imported behind the fence

    return find_command()[1]


def inspect(question: Question) -> HeldRobot:
    """What sdformat makes of a URDF or an SDF.

    Raises:
        LoaderError: it refuses the file, or finds it invalid.
    """
    from dh2urdf_plugins.formats.sdf.reader import parse_sdf

    command, _ = find_command()
    path = str(question.path)
    checked = call(command, "--check", path)
    converted = call(command, "--print", path)
    if checked.returncode or converted.returncode or not converted.stdout.strip():
        told = checked.stdout if checked.returncode else converted.stdout
        raise refused(_COLOUR.sub("", told.decode("utf-8", "replace")), question)
    try:
        model = parse_sdf(converted.stdout, "what sdformat wrote")
    except ProofError:  # A model with more to it than one arm: the names of its links are all that is known.
        return HeldRobot(links=dict.fromkeys(_LINK.findall(converted.stdout.decode("utf-8", "replace"))))
    return _held(model, question)


def _held(model: Robot, question: Question) -> HeldRobot:
    """A robot as sdformat wrote it, as plain numbers."""
    bodies = {
        link.name: Body(link.inertial.mass, link.inertial.com, tensor(link.inertial.inertia))
        for link in model.links
        if link.inertial
    }
    links = told_bodies(bodies)
    return HeldRobot(
        links={link.name: links.get(link.name) for link in model.links},
        joints=[
            {"name": joint.name, "type": joint.type.value, "axis": joint.axis, **asdict(joint.limits)}
            for joint in model.moving_joints
        ],
        frames=told_frames(question.postures, lambda values: link_poses(model, _known(model, values))),
        shapes={
            link.name: {
                word: [size for shape in shapes if (size := _lengths(shape.geometry))]
                for word, shapes in ((VISUAL, link.visuals), (COLLISION, link.collisions))
            }
            for link in model.links
        },
    )


def _known(model: Robot, values: Mapping[str, float]) -> dict[str, float]:
    return {joint.name: values.get(joint.name, 0.0) for joint in model.moving_joints}


def _lengths(geometry: Geometry) -> tuple[float, float, float] | None:
    match geometry:
        case Box(size=size):
            return lengths(*size)
        case Cylinder(radius=radius, length=length):
            return lengths(2 * radius, 2 * radius, length)
        case Sphere(radius=radius):
            return lengths(2 * radius, 2 * radius, 2 * radius)
    return None


def find_command() -> tuple[str, str]:
    """The command that has sdformat as a subcommand, and the version of sdformat.

    Raises:
        MissingProgramError: there is none.
    """
    for name in COMMANDS:
        command = shutil.which(name)
        if command is None:
            continue
        if version := _version(command):
            return command, version
    raise missing()


@cache
def _version(command: str) -> str:
    """The version of sdformat that a command has; empty where it has none."""
    asked = subprocess.run(  # noqa: S603 - no words of a stranger
        [command, "sdf", "--versions"], capture_output=True, check=False, text=True, encoding="utf-8"
    )
    version = re.search(r"^\d+(\.\d+)+$", asked.stdout, re.MULTILINE)
    return version[0] if version else ""


def call(command: str, option: str, path: str) -> subprocess.CompletedProcess[bytes]:
    """Call sdformat; its messages go where a simulator's do, into the report."""
    done = subprocess.run([command, "sdf", option, path], stdout=subprocess.PIPE, stderr=sys.stderr, check=False)  # noqa: S603 - an absolute path, and no shell
    if done.returncode and done.stdout:  # Of a file that it refuses it also speaks on standard output.
        sys.stderr.write(done.stdout.decode("utf-8", "replace"))
    return done


def missing() -> MissingProgramError:
    """The error of a machine that has no command of sdformat."""
    return MissingProgramError("loader 'gazebo'", "the command `gz sdf` or `ign sdf` of sdformat", REMEDY)


_LINK = re.compile(r"<link name='([^\n']*)'")
_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_EXPECTED = re.compile(r"backtrace generation will be disabled")  # said by `ign` of itself, whatever it does


def complaints(output: str) -> list[str]:
    """What sdformat printed; of a good file it prints nothing.

    A message may go on in lines that are indented.
    """
    messages: list[str] = []
    for line in _COLOUR.sub("", output).splitlines():
        if line[:1].isspace() and messages:
            messages[-1] += f" {line.strip()}"
        elif line.strip():
            messages.append(line.strip())
    return [message for message in messages if not _EXPECTED.search(message)]
