"""The loader `drake`: loads the written URDF or SDF into Drake, measures the arm, reads what Drake logs."""

from __future__ import annotations

import re
import sys
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.source import Problem, shown
from dh2urdf.stages import Loader, ReadsOutput, Requires, Reusable
from dh2urdf_plugins.loaders.options import SimulatorOptions
from dh2urdf_plugins.loaders.packages import Packages

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

_PACKAGES = Packages("drake", {"pydrake": "drake"})
_MARK = "Drake logged "


@dataclass(frozen=True, slots=True, kw_only=True)
class DrakeOptions(SimulatorOptions):
    """What is done in Drake."""


def require(_options: DrakeOptions) -> None:
    """Ask whether Drake is there, without importing it.

    Raises:
        MissingDependencyError: it is not installed.
    """
    _PACKAGES.require("pydrake")


def prepare(_options: DrakeOptions) -> None:
    """Import Drake, as far as all of its parts need; a load imports the others.

    Raises:
        MissingDependencyError: it is not installed.
    """
    _PACKAGES.load("pydrake")


def load(request: LoadRequest, _options: DrakeOptions) -> LoadReport:
    """Load a URDF or SDF into Drake and measure it.

    Raises:
        LoaderError: Drake cannot load the file, or holds another arm than the one that was written.
        MissingDependencyError: Drake is not installed.
    """
    import logging

    from dh2urdf_plugins.loaders.drake.arm import Arm

    _PACKAGES.load("pydrake")
    # Drake's C++ hands its messages to this logger, whose last resort would print them without their level.
    to_output = logging.StreamHandler(sys.stderr)
    to_output.setFormatter(logging.Formatter(f"{_MARK}%(levelname)s: %(message)s"))
    logger = logging.getLogger("drake")
    logger.handlers, logger.propagate = [to_output], False
    return Arm(request).report()


_LOGGED = re.compile(rf"{_MARK}([A-Z]+): ")


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """What Drake logged, each message once, in the order of logging; of a good file it says nothing.

    A message may have many lines; a line that nobody logged is a message of its own.
    """
    messages: list[tuple[str, str]] = []
    for line in filter(None, map(str.strip, output.splitlines())):
        logged = _LOGGED.match(line)
        if messages and messages[-1][0] and not logged:
            messages[-1] = (messages[-1][0], f"{messages[-1][1]} {line}")
        else:
            messages.append((logged[1] if logged else "", _LOGGED.sub("", line)))
    place = f"{request.path.resolve()}:"
    return tuple(
        Problem(
            message=f"Drake printed {shown(text.replace(place, 'line ', 1), 300)}",
            severity="error" if level in {"ERROR", "CRITICAL"} else "notice",
            robot=request.robot.name,
        )
        for level, text in dict.fromkeys(messages)
    )


LOADER = Loader(
    name="drake",
    summary="loads URDF or SDF into Drake, compares the arm with the table, lets it hold its weight",
    open=load,
    options=DrakeOptions,
    formats=("urdf", "sdf"),
    capabilities=(
        Requires(require),
        ReadsOutput(read_output),
        Reusable(prepare),
    ),
)
