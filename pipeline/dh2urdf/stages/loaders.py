"""The record of a loader, and what else loaders can do; `load_records` has what one is asked and what it answers."""

# ruff: noqa: TC004 - nobody asks for the types of these records' fields

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Generic, NamedTuple, TypeAlias

from dh2urdf.stages import O, Requires, _Capable

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Any

    from dh2urdf.source import Problem
    from dh2urdf.stages import HeldRobot, LoadReport, LoadRequest, Question, SimulatedArm

LOAD_TIME_LIMIT = 300.0
"""How long a loader may take where it names no other time [s]."""


class ReadsOutput(NamedTuple):
    """A loader whose simulator prints warnings.

    `read_output` returns the findings in all that the simulator printed while it loaded a file, well or badly, without
    those that it prints for good files too.
    """

    read_output: Callable[[LoadRequest, str], Sequence[Problem]]


class Reusable(NamedTuple):
    """A loader whose simulator a child process imports once for many manipulators of a run.

    `prepare` imports the simulator, as a load with these options would, and starts no thread. Each load is called in a
    fork of the child: no load meets what another one left in it. What `prepare` prints is in the output of each load.
    """

    prepare: Callable[[Any], None]


class Inspects(NamedTuple):
    """A loader whose simulator is given descriptions of any origin: ``dh2urdf check``.

    Attributes:
        inspect: what the simulator makes of a file. It is called behind a fence, where nothing can be imported and no
            file can be written. It raises `dh2urdf.errors.LoaderError` where the simulator
            refuses the file.
        prepare: imports all that this needs, and returns the version of the simulator.
        complaints: of all that was printed meanwhile, what the simulator says about the file, a message each.
        formats: names of the emitters whose files it takes.
        title: what findings call the simulator.
        unopened: elements of a file that the simulator takes over without looking at what they name, such as ``mesh``.
        starts_program: whether `inspect` starts a program; then the fence allows the programs of the system.
    """

    inspect: Callable[[Question], HeldRobot]
    prepare: Callable[[], str]
    complaints: Callable[[str], Sequence[str]]
    formats: tuple[str, ...]
    title: str
    unopened: tuple[str, ...] = ()
    starts_program: bool = False


LoaderCapability: TypeAlias = Requires | ReadsOutput | Reusable | Inspects
"""What else a loader can do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Loader(_Capable, Generic[O]):
    """Loads a written file into a simulator and reports what the simulator says.

    Attributes:
        name: the stage's name in a run file.
        summary: what it loads into, in one line.
        open: opens the file in the simulator. It returns a `SimulatedArm`, which dh2urdf measures, compares and
            closes; or a `LoadReport`, where it measures the arm itself. It is called in a child process, so it may
            crash or leave; what it prints, from C too, goes into the report. It raises `dh2urdf.errors.LoaderError`
            where the simulator refuses the file, and `dh2urdf.errors.MissingDependencyError` or `MissingProgramError`
            where it is not installed or does not run.
        options: its options dataclass. Three attributes or properties of it have a meaning: ``poses``, how many joint
            vectors are measured (else 25); ``picture``, whether a picture is taken (else no); and ``time_limit``, how
            long a load may take before it is taken for hung [s] (else five minutes), or None where a person ends it.
        formats: names of the emitters whose files it takes, the preferred one first.
        capabilities: what else it can do, of `LoaderCapability`.
    """

    name: str
    summary: str
    open: Callable[[LoadRequest, O], SimulatedArm | LoadReport]
    options: type[O]
    formats: tuple[str, ...] = ("urdf",)
    capabilities: tuple[LoaderCapability, ...] = ()

    def poses(self, options: O) -> int:
        """How many joint vectors are measured with these options."""
        poses: int = getattr(options, "poses", 25)
        return poses

    def picture(self, options: O) -> bool:
        """Whether these options ask for a picture."""
        picture: bool = getattr(options, "picture", False)
        return picture

    def time_limit(self, options: O) -> float | None:
        """How long a load may take with these options [s]; None where a person ends it."""
        limit: float | None = getattr(options, "time_limit", LOAD_TIME_LIMIT)
        return limit

    def read_output(self, request: LoadRequest, output: str) -> Sequence[Problem]:
        """The findings in what the simulator printed."""
        reads = self.can(ReadsOutput)
        return () if reads is None else reads.read_output(request, output)
