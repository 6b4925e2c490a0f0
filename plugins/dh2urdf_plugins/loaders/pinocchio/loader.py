"""The loader `pinocchio`: loads the written URDF into Pinocchio, measures the arm, and reads what its parser prints."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.source import Problem, shown
from dh2urdf.stages import Loader, ReadsOutput, Requires, Reusable
from dh2urdf_plugins.loaders.options import SimulatorOptions
from dh2urdf_plugins.loaders.packages import Packages

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

_PACKAGES = Packages("pinocchio", {"pinocchio": "pin"})


@dataclass(frozen=True, slots=True, kw_only=True)
class PinocchioOptions(SimulatorOptions):
    """What is done in Pinocchio."""


def require(_options: PinocchioOptions) -> None:
    """Ask whether Pinocchio is there, without importing it.

    Raises:
        MissingDependencyError: it is not installed.
    """
    _PACKAGES.require("pinocchio")


def prepare(_options: PinocchioOptions) -> None:
    """Import Pinocchio.

    Raises:
        MissingDependencyError: it is not installed.
    """
    _PACKAGES.load("pinocchio")


def load(request: LoadRequest, _options: PinocchioOptions) -> LoadReport:
    """Load a URDF into Pinocchio and measure it.

    Raises:
        LoaderError: Pinocchio cannot load the file, or holds another arm than the one that was written.
        MissingDependencyError: Pinocchio is not installed.
    """
    from dh2urdf_plugins.loaders.pinocchio.arm import Arm

    return Arm(_PACKAGES.load("pinocchio"), request).report()


# What Pinocchio's parser, urdfdom, prints: a level, a text, and in the next line where in urdfdom's source it stands.
_MESSAGE = re.compile(r"^(Warning|Error): *(.*?) *$", re.MULTILINE)


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """The warnings and errors that Pinocchio's parser printed, each once, in the order of printing."""
    return tuple(
        Problem(
            message=f"Pinocchio printed {shown(text, 300)}",
            severity="error" if level == "Error" else "notice",
            robot=request.robot.name,
        )
        for level, text in dict.fromkeys(_MESSAGE.findall(output))
    )


LOADER = Loader(
    name="pinocchio",
    summary="loads a URDF into Pinocchio, compares the arm with the table, weighs it against its efforts",
    open=load,
    options=PinocchioOptions,
    formats=("urdf",),
    capabilities=(
        Requires(require),
        ReadsOutput(read_output),
        Reusable(prepare),
    ),
)
