"""The loader `mujoco`: loads the written MJCF or URDF, measures the arm, and takes what MuJoCo reports about it."""

from __future__ import annotations

import contextlib
import importlib
import os
import re
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from dh2urdf.source import Problem, shown
from dh2urdf.stages import Loader, ReadsOutput, Requires, Reusable
from dh2urdf_plugins.loaders.options import SimulatorOptions
from dh2urdf_plugins.loaders.packages import Packages

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

_PACKAGES = Packages("mujoco", {"mujoco": "mujoco", "PIL.Image": "pillow"})


@dataclass(frozen=True, slots=True, kw_only=True)
class MuJoCoOptions(SimulatorOptions):
    """What is done in MuJoCo."""

    picture: bool = field(default=True, metadata={"help": "write a picture of the arm beside its files"})


def require(options: MuJoCoOptions) -> None:
    """Ask whether MuJoCo, and Pillow for a picture, are there, without importing them.

    Raises:
        MissingDependencyError: one of them is not installed.
    """
    _PACKAGES.require("mujoco", *(["PIL.Image"] if options.picture else []))


def prepare(options: MuJoCoOptions) -> None:
    """Import MuJoCo, and what a picture needs.

    Raises:
        MissingDependencyError: MuJoCo, or Pillow for a picture, is not installed.
    """
    _import(picture=options.picture)


def load(request: LoadRequest, _options: MuJoCoOptions) -> LoadReport:
    """Load an MJCF or a URDF into MuJoCo and measure it.

    A picture that cannot be taken, where there is no graphics library, is a finding.

    Raises:
        LoaderError: MuJoCo cannot load the file, or holds another arm than the one that was written.
        MissingDependencyError: MuJoCo, or Pillow for a picture, is not installed.
    """
    from dh2urdf_plugins.loaders.mujoco.arm import Arm
    from dh2urdf_plugins.loaders.mujoco.picture import NoGraphicsError, write_picture

    mujoco = _import(picture=request.picture is not None)
    mujoco.set_mju_user_warning(_print_warning)
    arm = Arm(mujoco, request)
    report = arm.report()
    if request.picture:
        try:
            write_picture(mujoco, request.path, arm, request.picture)
        except NoGraphicsError as error:
            finding = arm.comparison.problem(
                message=f"MuJoCo took no picture: {error}",
                severity="notice",
                suggestion="install EGL (Debian and Ubuntu: apt-get install libegl1 libopengl0 libgl1-mesa-dri), "
                "or say `picture: false`",
            )
            return replace(report, findings=(*report.findings, finding))
        report = replace(report, picture=request.picture.name)
    return report


def _import(*, picture: bool) -> Any:  # noqa: ANN401 - a module without type information
    """Import MuJoCo, which asks the environment once, while it is imported, by what to render."""
    from dh2urdf_plugins.loaders.mujoco.picture import graphics

    if picture:
        _PACKAGES.load("PIL.Image")
    if graphics_library := graphics() if picture else "disable":
        os.environ["MUJOCO_GL"] = graphics_library
    with contextlib.suppress(Exception):  # Whatever a broken graphics library raises: MuJoCo works without one.
        return importlib.import_module("mujoco")
    os.environ["MUJOCO_GL"] = "disable"
    return _PACKAGES.load("mujoco")


def _print_warning(text: str | bytes) -> None:
    """Print a warning; without this, MuJoCo writes it into a file in the working directory too."""
    words = text.decode("utf-8", "replace") if isinstance(text, bytes) else text
    os.write(2, f"WARNING: {' '.join(words.split())}\n".encode())


_MESSAGE = re.compile(r"^(?:WARNING|ERROR): *(.+?) *$", re.MULTILINE)
_UNNAMED = "Geom with duplicate name ''"  # MuJoCo 3.3 prints this for every file with two shapes: shapes have no names


def read_output(request: LoadRequest, output: str) -> tuple[Problem, ...]:
    """MuJoCo's warnings, each once, in the order of printing; what graphics libraries print is not about the arm."""
    return tuple(
        Problem(message=f"MuJoCo printed {shown(text, 300)}", severity="notice", robot=request.robot.name)
        for text in dict.fromkeys(_MESSAGE.findall(output))
        if not text.startswith(_UNNAMED)
    )


LOADER = Loader(
    name="mujoco",
    summary="loads MJCF or URDF into MuJoCo, compares the arm with the table, lets it hold its weight, takes a picture",
    open=load,
    options=MuJoCoOptions,
    formats=("mjcf", "urdf"),
    capabilities=(
        Requires(require),
        ReadsOutput(read_output),
        Reusable(prepare),
    ),
)
