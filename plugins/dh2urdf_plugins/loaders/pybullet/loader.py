"""The loader `pybullet`: loads the written URDF into PyBullet, measures the arm, and reads what PyBullet prints."""

from __future__ import annotations

import re
import time
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from dh2urdf.source import Problem, shown
from dh2urdf.stages import LOAD_TIME_LIMIT, Loader, ReadsOutput, Requires, Reusable
from dh2urdf_plugins.loaders.options import SimulatorOptions
from dh2urdf_plugins.loaders.packages import Packages

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

_PACKAGES = Packages("pybullet", {"pybullet": "pybullet", "PIL.Image": "pillow"})


@dataclass(frozen=True, slots=True, kw_only=True)
class PyBulletOptions(SimulatorOptions):
    """What is done in PyBullet."""

    picture: bool = field(default=True, metadata={"help": "write a picture of the arm beside its files"})
    gui: bool = field(default=False, metadata={"help": "show the arm in a window, and wait until it is closed"})

    @property
    def time_limit(self) -> float | None:
        """How long loading may take [s]; a window stays open as long as a person likes."""
        return None if self.gui else LOAD_TIME_LIMIT


def require(options: PyBulletOptions) -> None:
    """Ask whether PyBullet, and Pillow for a picture, are there, without importing them.

    Raises:
        MissingDependencyError: one of them is not installed.
    """
    _PACKAGES.require("pybullet", *(["PIL.Image"] if options.picture else []))


def prepare(options: PyBulletOptions) -> None:
    """Import PyBullet, and Pillow for a picture.

    Raises:
        MissingDependencyError: one of them is not installed.
    """
    _import(picture=options.picture)


def _import(*, picture: bool) -> Any:  # noqa: ANN401 - a module without type information
    bullet = _PACKAGES.load("pybullet")
    if picture:
        _PACKAGES.load("PIL.Image")
    return bullet


def load(request: LoadRequest, options: PyBulletOptions) -> LoadReport:
    """Load a URDF into PyBullet and measure it.

    Raises:
        LoaderError: PyBullet cannot load the file, or holds another arm than the one that was written.
        MissingDependencyError: PyBullet, or Pillow for a picture, is not installed.
    """
    from dh2urdf_plugins.loaders.pybullet.arm import Arm

    bullet = _import(picture=request.picture is not None)
    bullet.connect(bullet.GUI if options.gui else bullet.DIRECT)
    try:
        report = Arm(bullet, request).report()
        while options.gui and bullet.isConnected():  # Closing the window ends the connection.
            time.sleep(0.1)
    finally:
        if bullet.isConnected():
            bullet.disconnect()
    return report


# What PyBullet prints: "b3Warning[file,line]:", a line end and the text; often the next message follows without one.
_MESSAGE = re.compile(r"b3(Warning|Error)\[[^\]]*\]:\n?(.*?)(?=\n|b3(?:Warning|Error)\[|\Z)")
_COMPLAINT = re.compile(r"\b(warning|error|fail(ed|ure)?|cannot|invalid)\b", re.IGNORECASE)
_NO_INERTIA = "No inertial data for link"


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """The warnings and errors that PyBullet printed, each once, in the order of printing.

    PyBullet gives the name of the link or joint that it speaks of in a message of its own. Of the empty root it says
    that it has no inertial and will weigh 1 kg, which is expected: the world holds the root, and it weighs nothing.
    """
    robot = request.robot
    names = {*(link.name for link in robot.links), *(joint.name for joint in robot.joints)}
    said: list[tuple[str, str]] = []
    for kind, text in _MESSAGE.findall(output):
        if text in names and said:
            said[-1] = (said[-1][0], f"{said[-1][1]}: {text}")
        elif text:
            said.append((kind, text))
    said += [("Warning", line.strip()) for line in _MESSAGE.sub("", output).splitlines() if _COMPLAINT.search(line)]
    return tuple(
        Problem(
            message=f"PyBullet printed {shown(text, 200)}",
            severity="error" if kind == "Error" else "notice",
            robot=robot.name,
        )
        for kind, text in dict.fromkeys(said)
        if not (text.startswith(_NO_INERTIA) and text.endswith(f": {robot.root}"))
    )


LOADER = Loader(
    name="pybullet",
    summary="loads a URDF into PyBullet, compares the arm with the table, lets it hold its weight, takes a picture",
    open=load,
    options=PyBulletOptions,
    formats=("urdf",),
    capabilities=(
        Requires(require),
        ReadsOutput(read_output),
        Reusable(prepare),
    ),
)
