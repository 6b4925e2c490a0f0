"""The loaders: their options, the packages that they need, and their records, which name what is imported when used."""

from __future__ import annotations

import importlib
import importlib.util
import sys
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

from dh2urdf.errors import MissingDependencyError
from dh2urdf.stages import LOAD_TIME_LIMIT, Inspects, Loader, ReadsOutput, Requires, Reusable
from dh2urdf_plugins.late import Late

Engine: TypeAlias = Literal["bullet", "ode", "vortex", "newton", "mujoco"]
"""The physics engines of CoppeliaSim."""
PORT = 23000
"""Where CoppeliaSim listens by default."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatorOptions:
    """What is measured in a simulator."""

    poses: int = field(default=25, metadata={"help": "random joint vectors at which tool0 is compared with the table"})

    def __post_init__(self) -> None:
        if self.poses < 1:
            raise ValueError("poses is a number from 1 on")


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureOptions(SimulatorOptions):
    """What is done in a simulator that takes pictures."""

    picture: bool = field(default=True, metadata={"help": "write a picture of the arm beside its files"})


@dataclass(frozen=True, slots=True, kw_only=True)
class PyBulletOptions(PictureOptions):
    """What is done in PyBullet."""

    gui: bool = field(default=False, metadata={"help": "show the arm in a window, and wait until it is closed"})

    @property
    def time_limit(self) -> float | None:
        """How long loading may take [s]; a window stays open as long as a person likes."""
        return None if self.gui else LOAD_TIME_LIMIT


@dataclass(frozen=True, slots=True, kw_only=True)
class CoppeliaSimOptions(SimulatorOptions):
    """Which CoppeliaSim is asked, and what is done there."""

    host: str = field(default="localhost", metadata={"help": "where CoppeliaSim runs"})
    port: int = field(default=PORT, metadata={"help": "port of its ZMQ remote API"})
    engine: Engine | None = field(
        default=None,
        metadata={
            "help": "engine of a hold test of two seconds, such as mujoco; none is done by default. "
            "bullet, which CoppeliaSim takes by itself, was seen to let joints come apart"
        },
    )

    def __post_init__(self) -> None:
        SimulatorOptions.__post_init__(self)
        if not 0 < self.port < 1 << 16:
            raise ValueError("port is a number from 1 to 65535")


@dataclass(frozen=True, slots=True)
class Packages:
    """The packages of one loader, which an extra of its own name installs; Pillow for those that take pictures.

    Attributes:
        loader: name of the loader.
        names: by the module that is imported, the package that has it.
    """

    loader: str
    names: dict[str, str]

    def require(self, options: SimulatorOptions) -> None:
        """Ask whether the packages that these options need are there, without importing them.

        Raises:
            MissingDependencyError: one of them is not installed.
        """
        for module in self._needed(options):
            if importlib.util.find_spec(module.partition(".")[0]) is None:
                raise self._missing(module)

    def prepare(self, options: SimulatorOptions) -> None:
        """Import what these options need, as `load` does."""
        self.load(options)

    def load(self, options: SimulatorOptions) -> Any:  # noqa: ANN401 - a module without type information
        """Import what these options need, and return the simulator's module.

        Raises:
            MissingDependencyError: a package is not installed, or lacks a library of the system.
        """
        for module in self._needed(options):
            try:
                importlib.import_module(module)
            except ImportError as error:
                raise self._missing(module, error) from error
        return sys.modules[next(iter(self.names))]

    def _needed(self, options: SimulatorOptions) -> list[str]:
        return [*self.names, *(["PIL.Image"] if getattr(options, "picture", False) else [])]

    def _missing(self, module: str, reason: str | ImportError = "") -> MissingDependencyError:
        package = self.names.get(module, "pillow")
        return MissingDependencyError(f"loader {self.loader!r}", package, f"dh2urdf[{self.loader}]", reason)


_ZMQ = {"coppeliasim_zmqremoteapi_client": "coppeliasim-zmqremoteapi-client", "zmq": "pyzmq"}
PACKAGES = {
    "pybullet": Packages("pybullet", {"pybullet": "pybullet"}),
    "mujoco": Packages("mujoco", {"mujoco": "mujoco"}),
    "pinocchio": Packages("pinocchio", {"pinocchio": "pin"}),
    "drake": Packages("drake", {"pydrake": "drake"}),
    "coppeliasim": Packages("coppeliasim", _ZMQ),
}


def _inspects(name: str, title: str, formats: str, unopened: str = "", *, starts_program: bool = False) -> Inspects:
    """How the simulator of a loader is given files of any origin."""
    inspect, prepare, complaints = (
        Late(f"{__package__}.{name}.model:{function}") for function in ("inspect", "prepare", "complaints")
    )
    return Inspects(
        inspect, prepare, complaints, tuple(formats.split()), title, tuple(unopened.split()), starts_program
    )


_INSPECTING = {
    "pybullet": _inspects("pybullet", "PyBullet", "urdf sdf mjcf"),
    "mujoco": _inspects("mujoco", "MuJoCo", "urdf mjcf"),
    "pinocchio": _inspects("pinocchio", "Pinocchio", "urdf"),
    "drake": _inspects("drake", "Drake", "urdf sdf mjcf"),
    "gazebo": _inspects("gazebo", "sdformat", "urdf sdf", "mesh", starts_program=True),
}


def _loader(name: str, formats: str, options: type[SimulatorOptions], summary: str, *own: str) -> Loader[Any]:
    """The record of a loader.

    Args:
        name: of the loader, and of the package with its module.
        formats: what it loads, the best first.
        options: its options.
        summary: what it does.
        own: functions of its module that take the place of those of its packages.
    """

    def of(function: str) -> Late:
        return Late(f"{__package__}.{name}.loader:{function}")

    require = of("require") if "require" in own else PACKAGES[name].require
    capabilities: tuple[Any, ...] = (Requires(require),)
    if name != "coppeliasim":  # a program of its own, whose console is not ours
        prepare = of("prepare") if "prepare" in own else PACKAGES[name].prepare
        capabilities += (ReadsOutput(of("read_output")), Reusable(prepare))
    if name in _INSPECTING:
        capabilities += (_INSPECTING[name],)
    load = of("load")
    return Loader(
        name=name,
        summary=summary,
        open=load,
        options=options,
        formats=tuple(formats.split()),
        capabilities=capabilities,
    )


LOADERS = (
    _loader(
        *("pybullet", "urdf", PyBulletOptions),
        "loads a URDF into PyBullet, compares the arm with the table, lets it hold its weight, takes a picture",
    ),
    _loader(
        *("mujoco", "mjcf urdf", PictureOptions),
        "loads MJCF or URDF into MuJoCo, compares the arm with the table, lets it hold its weight, takes a picture",
        "prepare",
    ),
    _loader(
        *("pinocchio", "urdf", SimulatorOptions),
        "loads a URDF into Pinocchio, compares the arm with the table, weighs it against its efforts",
    ),
    _loader(
        *("drake", "urdf sdf", SimulatorOptions),
        "loads URDF or SDF into Drake, compares the arm with the table, lets it hold its weight",
    ),
    _loader(
        *("gazebo", "sdf urdf", SimulatorOptions),
        "has Gazebo's sdformat check SDF, or convert URDF, and compares the model with the table",
        *("require", "prepare"),
    ),
    _loader(
        *("coppeliasim", "urdf", CoppeliaSimOptions),
        "has a running CoppeliaSim import a URDF, compares it with the table, lets it hold its weight if asked",
    ),
)
