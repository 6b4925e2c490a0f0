"""The records that a plugin hands to the pipeline, one type per kind of stage.

A stage is a plain function with a record around it: a name for the run file, a summary for `dh2urdf plugins`, and an
options dataclass that the function takes. The options' fields have defaults, and a description each in
``field(metadata={"help": …})``; pydantic checks what the user gives against their types.
"""

# ruff: noqa: TC004 - nobody asks for the types of these records' fields; most commands make few of what they name

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any, Generic, Literal, TypeAlias, TypeVar

from dh2urdf._stage_defaults import (
    LOAD_TIME_LIMIT,
    PACKAGE_FILE,
    all_there,
    always,
    load_time_limit,
    nothing,
    option_picture,
    option_poses,
)
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from contextlib import AbstractContextManager
    from pathlib import Path

    from dh2urdf.columns import ManipulatorColumns, ManipulatorGroups, RobotColumns
    from dh2urdf.foreign_robot import Follower, ForeignRobot
    from dh2urdf.inspections import (
        SEVERITIES,
        Annotation,
        Effect,
        Expansion,
        Finding,
        Inspection,
        Repair,
        Severity,
    )
    from dh2urdf.load_records import LoadReport, LoadRequest, SimulatedArm
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.provenance import Trace
    from dh2urdf.robot import Robot
    from dh2urdf.table_text import CellRow, TableText, WrittenTable

__all__ = [
    "LOAD_TIME_LIMIT",
    "PACKAGE_FILE",
    "SEVERITIES",
    "Annotation",
    "Edit",
    "Effect",
    "EmittedFile",
    "Emitter",
    "Executor",
    "Expansion",
    "Finding",
    "Follower",
    "ForeignRobot",
    "Inspection",
    "Kind",
    "LoadReport",
    "LoadRequest",
    "Loader",
    "Lost",
    "NoOptions",
    "Reader",
    "Rejected",
    "Repair",
    "Severity",
    "SimulatedArm",
    "Stage",
    "Transform",
]

_ELSEWHERE = {
    "foreign_robot": "Follower ForeignRobot",
    "inspections": "SEVERITIES Annotation Effect Expansion Finding Inspection Repair Severity",
    "load_records": "LoadReport LoadRequest SimulatedArm",
}
"""The names that are imported when they are asked for, by their modules: most commands make no such record."""


def __getattr__(name: str) -> Any:  # noqa: ANN401 - whatever a module names
    for module, names in _ELSEWHERE.items():
        if name in names.split():
            return getattr(import_module(f"dh2urdf.{module}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


O = TypeVar("O")  # noqa: E741 - the options type of a stage
T = TypeVar("T")
R = TypeVar("R")


@dataclass(frozen=True, slots=True, kw_only=True)
class NoOptions:
    """The options of a stage that has none."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Rejected:
    """A manipulator of an input that cannot be read; the others of the same input go on.

    Attributes:
        name: its name, as far as it could be read.
        problems: everything that is wrong with it, in the order of the file.
        mark: its place in the file.
        notices: what a careful person would look at besides, in the order of the file.
    """

    name: str
    problems: tuple[Problem, ...]
    mark: Mark | None = None
    notices: tuple[Problem, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class Reader(Generic[O]):
    """Reads manipulators from a file.

    Attributes:
        name: the stage's name in a run file.
        summary: what it reads, in one line.
        suffixes: file suffixes that choose it, in lower case with the dot; the first is the usual one.
        not_written: those of the suffixes, but the first, whose files it reads and `write` does not make, as `.tsv`.
        options: its options dataclass.
        read: yields the manipulators of a file one by one, without holding them.
        schema: the JSON Schema (2020-12) of its files, where they are YAML or JSON: `dh2urdf schema table` prints it.
        write: the file of tables, which `read` reads, or InputError where it cannot hold them all. None: only read.
        trace: reads a file as `read` does, and before each manipulator fills a trace with what its cells say, which
            `dh2urdf info` shows. None where the reader does not know it.
        texts: the tables of a file as their authors typed them, as far as that is known; what it gives is taken only
            where `write` and `read` make the same manipulator of it. None where the format has no such texts.
        read_cells: yields the manipulators of rows of cells that come from no file, such as those of a DataFrame, as
            `read` does those of a file. It takes the rows from the top, comments and header included, and what messages
            name as the file. `Catalog.cell_reader` finds the reader that has it; None for all others.
        read_columns: yields what `read` yields, in the same order, but for manipulators that follow each other in the
            file: they may come as `dh2urdf.columns.ManipulatorGroups`, which spares a run the records of each. Notices
            of the table of a group hold for each of its members. None where the reader has no faster way than `read`.
        leaves: the links at the ends of a robot description's chains, each with the number of moving joints before it:
            a reader that has it reads descriptions, and their chains are its tables. None for files of tables.

    `read` raises `dh2urdf.errors.TableError` where the file as a whole cannot be read, and yields `Rejected` where
    one manipulator of several cannot.
    """

    name: str
    summary: str
    read: Callable[[Path, O], Iterator[Manipulator | Rejected]]
    options: type[O]
    suffixes: tuple[str, ...] = ()
    not_written: tuple[str, ...] = ()
    schema: Callable[[], dict[str, Any]] | None = None
    write: Callable[[Sequence[TableText]], WrittenTable] | None = None
    texts: Callable[[Path], Iterator[TableText]] | None = None
    trace: Callable[[Path, O, Trace], Iterator[Manipulator | Rejected]] | None = None
    read_cells: Callable[[Iterable[CellRow], str, O], Iterator[Manipulator | Rejected]] | None = None
    read_columns: Callable[[Path, O], Iterator[Manipulator | ManipulatorGroups | Rejected]] | None = None
    leaves: Callable[[Path, O], Mapping[str, int]] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Transform(Generic[O]):
    """Makes the robot of a manipulator.

    Attributes:
        name: the stage's name in a run file.
        summary: what it makes, in one line.
        options: its options dataclass.
        transform: makes the robot; raises `dh2urdf.errors.TransformError` where it refuses the manipulator.
        keeps_kinematics: whether T(base_link → tool0) of the robot is the DH product with these options. Where it is
            not, the proof reports the difference and fails nothing.
        transform_columns: makes the robots of many manipulators at once, to the last bit as `transform` does, in groups
            whose members differ in numbers only, each with the places of its members; it leaves out what has to be made
            one by one. None where it cannot with these options. A stage without it makes all of them one by one.
        is_usual: whether it is taken where nobody names a transform; of the built-in ones, one is.
        compared: name of an option, a choice of words, whose first two choices the studio shows side by side, such as
            two variants of an algorithm. The first is what is meant where nothing else is chosen.
    """

    name: str
    summary: str
    transform: Callable[[Manipulator, O], Robot]
    options: type[O]
    keeps_kinematics: Callable[[O], bool] = always
    transform_columns: Callable[[ManipulatorColumns, O], Sequence[tuple[Sequence[int], RobotColumns]] | None] | None = (
        None
    )
    is_usual: bool = False
    compared: str | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Edit(Generic[O]):
    """Changes the table before the transform, or the robot after it; a run file lists any number of edits, in order.

    At least one of the two functions is given. Both return a new record with the name that they were given.

    Attributes:
        name: the stage's name in a run file.
        summary: what it changes, in one line.
        options: its options dataclass.
        edit_table: the changed manipulator. It is the truth from there on: every file is proved against it. What a
            person should know of the change is added to its `notices`.
        edit_robot: the changed robot. What a person should know of the change is added to its `notices`.
        keeps_kinematics: whether `edit_robot` keeps T(base_link → tool0) with these options. Where it does not, the
            proof reports the difference and fails nothing, and the robot has no table any more.
        accepts_columns: whether both functions also accept records whose numbers are columns (`dh2urdf.columns`), and
            make of them, to the last bit, what they make of each alone. A run then edits many arms at once. The copies
            are made by `dh2urdf.unchecked_records.changed`, and conditions are asked by `dh2urdf.elementwise.agreed`.

    Both functions raise `dh2urdf.errors.EditError` where they refuse what they are given. A robot that breaks a rule
    after `edit_robot` is refused with the name of the edit.
    """

    name: str
    summary: str
    options: type[O]
    edit_table: Callable[[Manipulator, O], Manipulator] | None = None
    edit_robot: Callable[[Robot, O], Robot] | None = None
    keeps_kinematics: Callable[[O], bool] = always
    accepts_columns: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class EmittedFile:
    """A file that an emitter wants written.

    Attributes:
        name: its name in the output folder. Of an emitter with `Emitter.in_folders` it is a path of several parts with
            ``/`` between them; of all others it has no folder.
        content: what it holds.
        is_robot: whether `Emitter.read_back` reads it; of the files of a robot, the first such one is proved.
    """

    name: str
    content: bytes
    is_robot: bool = True


@dataclass(frozen=True, slots=True, kw_only=True)
class Emitter(Generic[O]):
    """Makes the files of a robot.

    Attributes:
        name: the stage's name in a run file, and the format that loaders ask for.
        summary: what it writes, in one line.
        suffixes: suffixes of the main file, in lower case with the dot; the first is the usual one.
        other_endings: what its other files have behind the stem, as `_macro.xacro`; a run refuses any other file.
        options: its options dataclass.
        emit: the files of a robot, whose names begin with the stem it is given; the first is the main file. It writes
            nothing itself: the pipeline writes all of them whole, or none.
        read_back: the robot that a written main file describes, by code that shares nothing with `emit`: the proof of
            every run compares its kinematics with the DH product. None where the format cannot be read.
        read_foreign: what a file of unknown origin holds: `dh2urdf view`. A `Robot`, or a `ForeignRobot` where there is
            more to it, such as joints that follow others. None where `read_back` only reads.
        expandable: whether files of the format hold macros: `read_foreign` and `check` then also take an `Expansion`.
        finds_packages: whether `check` takes an `Expansion` though files hold no macros: for its `package_paths`.
        in_folders: the names of the folders in which its files of a stem lie, as those of a ROS package do. Then
            `suffixes` is empty, `dh2urdf convert` writes into a folder, and the files bring the meshes that they name.
        one_file: the options that make `emit` give a single file, for standard output; None where it always does.
        for_suffix: the options that make `emit` give what a suffix names; None where all suffixes hold the same.
        costly_proof: whether `read_back` is so slow that long runs prove a sample only.
        emit_columns: the files of many robots at once, a list for each of them, byte by byte as `emit` gives them, with
            a stem for each; a robot that is not `sure`, or that it cannot write so, gets an empty list. None where it
            cannot with these options or for such robots. A stage without it makes them one by one.
        read_columns: the robots that many main files describe, in groups whose members differ in numbers only, each
            with the places of its members among the files. Joints and their origins, axes and limits suffice. It shares
            nothing with `emit_columns`, and leaves out what it does not surely read as `read_back` would.
        notices: what a person should know of the files of a robot, as notices; called before they are made. Of robots
            that differ in numbers only, and whose files `emit_columns` makes, it is called for one, and its notices
            hold for all: it may not depend on their numbers.
        check: inspects a file of the format, of any origin: `dh2urdf check`. It says whatever is wrong with the file as
            findings, and raises `dh2urdf.errors.InputError` only where the file cannot be read at all.
        fix: the file with what is mechanical fixed, and every other byte as it was: `dh2urdf check --fix`. It raises
            `dh2urdf.errors.InputError` where it cannot read the file. None where files of the format are not fixed.
        descriptions: of the files of a folder, each with the name of its outermost element of XML (or an empty name),
            those that are whole descriptions of the format, and not a part of others: `dh2urdf check FOLDER`.
        annotate: the file of the format that goes with a robot description of any origin, of which it takes how it is
            expanded, and an earlier file, whose other content stays: `dh2urdf collisions`.
        is_usual: whether it is taken where nobody names an emitter; of the built-in ones, one is.
    """

    name: str
    summary: str
    emit: Callable[[Robot, str, O], Sequence[EmittedFile]]
    options: type[O]
    suffixes: tuple[str, ...]
    other_endings: tuple[str, ...] = ()
    read_back: Callable[[Path], Robot] | None = None
    read_foreign: Callable[..., Robot | ForeignRobot] | None = None
    expandable: bool = False
    finds_packages: bool = False
    in_folders: Callable[[str, O], Iterable[str]] | None = None
    one_file: Callable[[O], O] | None = None
    for_suffix: Callable[[O, str], O] | None = None
    costly_proof: bool = False
    emit_columns: Callable[[RobotColumns, Sequence[str], O], Sequence[Sequence[EmittedFile]] | None] | None = None
    read_columns: Callable[[Sequence[bytes]], Sequence[tuple[Sequence[int], Robot]]] | None = None
    check: Callable[..., Inspection] | None = None
    fix: Callable[[Path], Repair] | None = None
    descriptions: Callable[[Mapping[Path, str]], Iterable[Path]] | None = None
    notices: Callable[[Robot, O], Sequence[Problem]] | None = None
    annotate: Callable[[Path, Expansion, Path | None, O], Annotation] | None = None
    is_usual: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class Loader(Generic[O]):
    """Loads a written file into a simulator and reports what the simulator says.

    Attributes:
        name: the stage's name in a run file.
        summary: what it loads into, in one line.
        formats: names of the emitters whose files it takes, the preferred one first.
        options: its options dataclass.
        open: opens the file in the simulator and gives what became of the arm, as a `SimulatedArm`, which dh2urdf
            measures, compares and closes. It is called as `load` is, and raises the same errors.
        load: in place of `open`: loads the file and measures it itself. It is called in a child process, so it may
            crash or leave; what it prints, from C too, is taken into the report. It raises
            `dh2urdf.errors.LoaderError` where the simulator refuses the file, and
            `dh2urdf.errors.MissingDependencyError` or `MissingProgramError` where it is not installed or does not run.
        poses: how many joint vectors to measure with these options; by default their field ``poses``, or 25.
        picture: whether these options ask for a picture; by default their field ``picture``, or no.
        read_output: the findings in what the simulator printed while `load` ran: its warnings, without those that it
            gives for good files too. Called with the whole output after the child process has ended, well or badly.
        require: called before a run begins; raises `dh2urdf.errors.MissingDependencyError` where a package that `load`
            needs with these options is not installed, without importing it (`importlib.util.find_spec`), and
            `MissingProgramError` where it is a program that is not.
        time_limit: how long `load` may take with these options before it is taken for hung [s]; None where a person
            ends it, by closing a window. By default five minutes.
        prepare: imports the simulator, as `load` with these options would. None, the default, gives every load a child
            process of its own. A loader that has it promises that `load` may be called many times in one process: it
            closes what it opens, and reports of a file the same whatever was loaded before. Then `prepare` is called
            once in a child, which serves many manipulators of a run. What it prints is part of the output of each load.
    """

    name: str
    summary: str
    options: type[O]
    open: Callable[[LoadRequest, O], SimulatedArm] | None = None
    load: Callable[[LoadRequest, O], LoadReport] | None = None
    formats: tuple[str, ...] = ("urdf",)
    poses: Callable[[O], int] = option_poses
    picture: Callable[[O], bool] = option_picture
    read_output: Callable[[LoadRequest, str], Sequence[Problem]] = nothing
    require: Callable[[O], None] = all_there
    time_limit: Callable[[O], float | None] = load_time_limit
    prepare: Callable[[O], None] | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class Lost:
    """A task that ended the process which worked at it, and so has no result.

    Attributes:
        reason: what is known of its end, as the end of a sentence: ``the worker crashed (segmentation fault)``.
    """

    reason: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Executor(Generic[O]):
    """Runs the pipeline over many manipulators.

    Attributes:
        name: the stage's name in a run file.
        summary: where the work is done, in one line.
        options: its options dataclass.
        map: results of a picklable function over tasks, in the order of the tasks, taking tasks as they are needed. A
            worker that ends costs no result but that of a task which ends every worker it is given to: it gives `Lost`
            in its place, and the others go on. What the function raises is raised after the results before it.
            The function of a run has an attribute ``distributions``: the names of those whose stages it uses, which a
            worker on another machine has to have in the same versions. None where `pool` is given.
        pool: a context manager whose `submit(function, task)` gives a future, as every Executor of concurrent.futures
            has it: then order, errors, and tasks that end a worker (`concurrent.futures.BrokenExecutor`) are dh2urdf's
            work. The field ``workers`` of the options, where it is a number, says how many tasks are submitted ahead.
        require: called before a run begins; raises `dh2urdf.errors.MissingDependencyError` where a package that `map`
            needs with these options is not installed, without importing it (`importlib.util.find_spec`).
        is_usual: whether it is taken where nobody names an executor; of the built-in ones, one is.
    """

    name: str
    summary: str
    options: type[O]
    map: Callable[[Callable[[Any], Any], Iterable[Any], O], Iterator[Any]] | None = None
    pool: Callable[[O], AbstractContextManager[Any]] | None = None
    require: Callable[[O], None] = all_there
    is_usual: bool = False


Kind: TypeAlias = Literal["reader", "transform", "edit", "emitter", "loader", "executor"]
Stage: TypeAlias = Reader[Any] | Transform[Any] | Edit[Any] | Emitter[Any] | Loader[Any] | Executor[Any]
