"""The loader `gazebo`: has sdformat, the reader of Gazebo, convert and check the written file, and measures the model.

Gazebo reads SDF by sdformat, and a URDF too, which sdformat turns into SDF: what it drops, lumps or changes there is
missing in Gazebo. sdformat has a command, `gz sdf` (`ign sdf` up to Gazebo Fortress), which needs no Gazebo and no
display.
"""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

from dh2urdf.errors import LoaderError, MissingProgramError
from dh2urdf.source import Problem, shown
from dh2urdf.stages import Loader, ReadsOutput, Requires, Reusable
from dh2urdf_plugins.loaders.options import SimulatorOptions

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

COMMANDS = ("gz", "ign")
"""What the command of sdformat is a subcommand of: in Gazebo from Garden on (and Gazebo classic), and before."""
REMEDY = (
    "apt-get install ignition-tools libsdformat-dev (Debian 12), or install Gazebo (gazebosim.org), "
    "which brings it along"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class GazeboOptions(SimulatorOptions):
    """What is done with sdformat."""


def require(_options: GazeboOptions) -> None:
    """Ask whether there is a command that may be sdformat's, without starting it.

    Raises:
        MissingProgramError: there is none.
    """
    if not any(map(shutil.which, COMMANDS)):
        raise _missing()


def prepare(_options: GazeboOptions) -> None:
    """Find the command of sdformat: it is asked for its version once.

    Raises:
        MissingProgramError: there is none.
    """
    find_command()


def load(request: LoadRequest, _options: GazeboOptions) -> LoadReport:
    """Have sdformat convert and check a file, and measure the model that it makes of it.

    Raises:
        LoaderError: sdformat refuses the file, or makes another arm of it than the one that was written.
        MissingProgramError: sdformat is not installed.
    """
    from dh2urdf_plugins.loaders.gazebo.arm import Arm, precision
    from dh2urdf_plugins.loaders.gazebo.sdf_model import parse_sdf
    from dh2urdf_plugins.loaders.measures import Comparison

    command, version = find_command()
    comparison = Comparison("sdformat", request, precision(request.robot))
    path = str(request.path.resolve())
    converted = _call(command, "--print", path)
    checked = _call(command, "--check", path)
    for done, what in ((converted, "cannot convert the file"), (checked, "finds the file invalid")):
        if done.returncode or not done.stdout.strip():
            raise LoaderError(comparison.problem(message=f"sdformat {what}"))
    try:
        model = parse_sdf(converted.stdout)
    except ValueError as error:
        raise LoaderError(comparison.problem(message=f"sdformat cannot convert the file: it wrote {error}")) from error
    return Arm(model, comparison).report(version)


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
    raise _missing()


@cache
def _version(command: str) -> str:
    """The version of sdformat that a command has; empty where it has none."""
    asked = subprocess.run(  # noqa: S603 - no words of a stranger
        [command, "sdf", "--versions"], capture_output=True, check=False, text=True, encoding="utf-8"
    )
    version = re.search(r"^\d+(\.\d+)+$", asked.stdout, re.MULTILINE)
    return version[0] if version else ""


def _call(command: str, option: str, path: str) -> subprocess.CompletedProcess[bytes]:
    """Call sdformat; its messages go where a simulator's do, into the report."""
    done = subprocess.run([command, "sdf", option, path], stdout=subprocess.PIPE, stderr=sys.stderr, check=False)  # noqa: S603 - an absolute path, and no shell
    if done.returncode and done.stdout:  # Of a file that it refuses it also speaks on standard output.
        sys.stderr.write(done.stdout.decode("utf-8", "replace"))
    return done


def _missing() -> MissingProgramError:
    return MissingProgramError("loader 'gazebo'", "the command `gz sdf` or `ign sdf` of sdformat", REMEDY)


_COLOUR = re.compile(r"\x1b\[[0-9;]*m")
_LEVEL = re.compile(r"\b(Error|Warning)\b")
_EXPECTED = re.compile(r"backtrace generation will be disabled")  # said by `ign` of itself, whatever it does


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """What sdformat printed, each message once, in the order of printing; of a good file it prints nothing.

    A message may go on in lines that are indented.
    """
    messages: list[str] = []
    for line in _COLOUR.sub("", output).splitlines():
        if line[:1].isspace() and messages:
            messages[-1] += f" {line.strip()}"
        elif line.strip():
            messages.append(line.strip())
    return tuple(
        Problem(
            message=f"sdformat printed {shown(message, 300)}",
            severity="error" if (level := _LEVEL.search(message)) and level[1] == "Error" else "notice",
            robot=request.robot.name,
        )
        for message in dict.fromkeys(messages)
        if not _EXPECTED.search(message)
    )


LOADER = Loader(
    name="gazebo",
    summary="has Gazebo's sdformat check SDF, or convert URDF, and compares the model with the table",
    open=load,
    options=GazeboOptions,
    formats=("sdf", "urdf"),
    capabilities=(
        Requires(require),
        ReadsOutput(read_output),
        Reusable(prepare),
    ),
)
