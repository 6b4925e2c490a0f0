"""The loaders: their options, the packages that they need, and their records.

Each simulator has a module of its own, which is imported when it is asked. There are `load`, which measures a written
arm, `inspect`, which tells what became of a file of any origin, and `messages`, which finds the simulator's words in
what was printed.
"""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from importlib.metadata import version
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from dh2urdf.errors import MissingDependencyError
from dh2urdf.source import Messages, Problem, shown
from dh2urdf.stages import LOAD_TIME_LIMIT, Inspects, Loader, ReadsOutput, Requires, Reusable
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from dh2urdf.stages import HeldRobot, LoadReport, LoadRequest, Question

say = Messages(__file__)

Engine: TypeAlias = Literal["bullet", "ode", "vortex", "newton", "mujoco"]  # the physics engines of CoppeliaSim
PORT = 23000  # where CoppeliaSim listens by default


@dataclass(frozen=True, slots=True, kw_only=True)
class SimulatorOptions:
    """What is measured in a simulator."""

    poses: int = option("random joint vectors at which tool0 is compared with the table", 25)

    def __post_init__(self) -> None:
        if self.poses < 1:
            raise ValueError("poses is a number from 1 on")


@dataclass(frozen=True, slots=True, kw_only=True)
class PictureOptions(SimulatorOptions):
    """What is done in a simulator that takes pictures."""

    picture: bool = option("write a picture of the arm beside its files", True)


@dataclass(frozen=True, slots=True, kw_only=True)
class PyBulletOptions(PictureOptions):
    """What is done in PyBullet."""

    gui: bool = option("show the arm in a window, and wait until it is closed", False)

    @property
    def time_limit(self) -> float | None:
        """How long loading may take [s]; a window stays open as long as a person likes."""
        return None if self.gui else LOAD_TIME_LIMIT


@dataclass(frozen=True, slots=True, kw_only=True)
class CoppeliaSimOptions(SimulatorOptions):
    """Which CoppeliaSim is asked, and what is done there."""

    host: str = option("where CoppeliaSim runs", "localhost")
    port: int = option("port of its ZMQ remote API", PORT)
    engine: Engine | None = option(
        "engine of a hold test of two seconds, such as mujoco; none is done by default. "
        "bullet, which CoppeliaSim takes by itself, was seen to let joints come apart",
        None,
    )

    def __post_init__(self) -> None:
        SimulatorOptions.__post_init__(self)
        if not 0 < self.port < 1 << 16:
            raise ValueError("port is a number from 1 to 65535")


@dataclass(frozen=True, slots=True, kw_only=True)
class Simulator:
    """A simulator, and what is asked of it.

    `packages` has, by the module that is imported, the package that has it; the first is the simulator's own. A
    simulator without any is a program.
    """

    name: str  # of the loader, of its module, and of the extra that installs its packages
    title: str  # what messages call it
    summary: str
    formats: str  # what it loads, the best first
    options: type[SimulatorOptions] = SimulatorOptions
    packages: dict[str, str]
    inspected: str = ""  # formats of the files of any origin that it is given, if any
    unopened: tuple[str, ...] = ()  # elements of these files that it takes over without looking at what they name

    @property
    def loader(self) -> Loader[Any]:
        """The record of the loader."""
        capabilities: tuple[Any, ...] = (Requires(self.require),)
        if self.inspected:
            about = (tuple(self.inspected.split()), self.title, self.unopened, not self.packages)
            inspects = Inspects(self.inspect, self.ready, self.complaints, *about)
            capabilities += (ReadsOutput(self.read_output), Reusable(self.prepare), inspects)
        return Loader(
            name=self.name,
            summary=self.summary,
            open=self.load,
            options=self.options,
            formats=tuple(self.formats.split()),
            capabilities=capabilities,
        )

    def _module(self) -> Any:  # noqa: ANN401 - a module
        return import_module(f"{__package__}.{self.name}")

    def require(self, options: SimulatorOptions) -> None:
        """Ask whether what these options need is there, without importing it; raises as `prepare`."""
        if not self.packages:
            self._module().require()
        for module in self._needed(options):
            if find_spec(module.partition(".")[0]) is None:
                raise self._missing(module)

    def prepare(self, options: SimulatorOptions) -> None:
        """Import what these options need."""
        if not self.packages:
            self._module().find_command()
        elif own := getattr(self._module(), "prepare", None):
            own(options)
        for module in self._needed(options):
            try:
                import_module(module)
            except ImportError as error:
                raise self._missing(module, error) from error

    def _needed(self, options: SimulatorOptions) -> list[str]:
        return [*self.packages, *(["PIL.Image"] if getattr(options, "picture", False) else [])]

    def _missing(self, module: str, reason: str | ImportError = "") -> MissingDependencyError:
        package = self.packages.get(module, "pillow")
        return MissingDependencyError(f"loader {self.name!r}", package, f"dh2urdf[{self.name}]", reason)

    def load(self, request: LoadRequest, options: SimulatorOptions) -> LoadReport:
        """Load a file and measure the arm; a `LoaderError` where the simulator refuses it, or holds another arm."""
        self.prepare(options)
        return self._module().load(request, options)  # type: ignore[no-any-return]

    def read_output(self, request: LoadRequest, output: str) -> tuple[Problem, ...]:
        """The findings in what the simulator printed, each message once, in the order of printing."""
        found = []
        for level, text in dict.fromkeys(self._module().messages(output, request)):
            code = "printed-error" if level.lower() in ("error", "critical") else "printed"
            found.append(say(code, robot=request.robot.name, simulator=self.title, text=shown(text, 300)))
        return tuple(found)

    def ready(self) -> str:
        """Import all that files of any origin need; the version of the simulator."""
        self.prepare(SimulatorOptions())
        return version(next(iter(self.packages.values()))) if self.packages else self._module().find_command()[1]

    def inspect(self, question: Question) -> HeldRobot:
        """What the simulator makes of a file; raises a `LoaderError` where it refuses the file."""
        return self._module().inspect(question)  # type: ignore[no-any-return]

    def complaints(self, output: str) -> list[str]:
        """What the simulator printed about a file."""
        return [text for _, text in self._module().messages(output)]


_DRAKE = ("multibody.parsing", "multibody.plant", "multibody.tree", "systems.framework", "geometry")
SIMULATORS = (
    Simulator(
        name="pybullet",
        title="PyBullet",
        summary="loads a URDF into PyBullet, compares the arm with the table, lets it hold its weight, takes a picture",
        formats="urdf",
        options=PyBulletOptions,
        packages={"pybullet": "pybullet"},
        inspected="urdf sdf mjcf",
    ),
    Simulator(
        name="mujoco",
        title="MuJoCo",
        summary="loads MJCF or URDF into MuJoCo, compares the arm with the table, lets it hold its weight, takes a "
        "picture",
        formats="mjcf urdf",
        options=PictureOptions,
        packages={"mujoco": "mujoco"},
        inspected="urdf mjcf",
    ),
    Simulator(
        name="pinocchio",
        title="Pinocchio",
        summary="loads a URDF into Pinocchio, compares the arm with the table, weighs it against its efforts",
        formats="urdf",
        packages={"pinocchio": "pin"},
        inspected="urdf",
    ),
    Simulator(
        name="drake",
        title="Drake",
        summary="loads URDF or SDF into Drake, compares the arm with the table, lets it hold its weight",
        formats="urdf sdf",
        packages={"pydrake": "drake", **{f"pydrake.{module}": "drake" for module in _DRAKE}},
        inspected="urdf sdf mjcf",
    ),
    Simulator(
        name="gazebo",
        title="sdformat",
        summary="has Gazebo's sdformat check SDF, or convert URDF, and compares the model with the table",
        formats="sdf urdf",
        packages={},
        inspected="urdf sdf",
        unopened=("mesh",),
    ),
    Simulator(
        name="coppeliasim",
        title="CoppeliaSim",
        summary="has a running CoppeliaSim import a URDF, compares it with the table, lets it hold its weight if asked",
        formats="urdf",
        options=CoppeliaSimOptions,
        packages={"coppeliasim_zmqremoteapi_client": "coppeliasim-zmqremoteapi-client", "zmq": "pyzmq"},
    ),
)
LOADERS = tuple(simulator.loader for simulator in SIMULATORS)
