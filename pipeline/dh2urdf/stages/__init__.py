"""The records that a plugin hands to the pipeline, one type per kind of stage, and one for commands.

A stage is a plain function with a record around it: a name for the run file, a summary for `dh2urdf plugins`, and an
options dataclass that the function takes. The options' fields have defaults, and a description each in
``field(metadata={"help": …})``; pydantic checks what the user gives against their types.

A record has at most five fields that every author needs. Whatever else a stage can do is a capability: a small record
that is listed in `capabilities`, such as ``capabilities=(ReadsBack(read), Checks(check))``.
"""

# ruff: noqa: TC004 - nobody asks for the types of these records' fields; most commands make few of what they name

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Generic, Literal, NamedTuple, TypeAlias, TypeVar

from dh2urdf import late_names
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.columns import ManipulatorColumns, ManipulatorGroups, RobotColumns
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf.stages.executors import Executor as Executor, ExecutorCapability as ExecutorCapability, Lost as Lost
    from dh2urdf.stages.foreign_robot import ForeignRobot as ForeignRobot
    from dh2urdf.stages.given import Stage as Stage, Subcommand as Subcommand
    from dh2urdf.stages.inspections import (
        SEVERITIES as SEVERITIES,
        Annotation as Annotation,
        Effect as Effect,
        Expansion as Expansion,
        Finding as Finding,
        Inspection as Inspection,
        Repair as Repair,
        Severity as Severity,
        arguments_of as arguments_of,
    )
    from dh2urdf.stages.load_records import (
        HeldRobot as HeldRobot,
        LoadReport as LoadReport,
        LoadRequest as LoadRequest,
        Question as Question,
        SimulatedArm as SimulatedArm,
    )
    from dh2urdf.stages.loaders import (
        LOAD_TIME_LIMIT as LOAD_TIME_LIMIT,
        Inspects as Inspects,
        Loader as Loader,
        LoaderCapability as LoaderCapability,
        ReadsOutput as ReadsOutput,
        Reusable as Reusable,
    )
    from dh2urdf.table_text import CellRow, TableText, Trace, WrittenTable

O = TypeVar("O")  # noqa: E741 - the options type of a stage
C = TypeVar("C")

PACKAGE_FILE = "package.xml"
"""What the folder of a ROS package holds."""


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


class _Capable:
    """What records of all kinds have in common."""

    __slots__ = ()
    capabilities: tuple[Any, ...]

    def can(self, capability: type[C]) -> C | None:
        """Return the capability of a type that the stage has, or None.

        Args:
            capability: its type, such as `ReadsBack`.
        """
        for each in self.capabilities:
            if isinstance(each, capability):
                return each
        return None

    def keeps_kinematics(self, options: Any) -> bool:  # noqa: ANN401 - the stage's own options
        """Whether T(base_link → tool0) is the DH product with these options."""
        keeps = self.can(KeepsKinematics)
        return keeps is None or keeps.keeps_kinematics(options)

    def require(self, options: Any) -> Any:  # noqa: ANN401 - the stage's own options; what the plugin gives
        """Raise a `dh2urdf.errors.PluginError` where something that the stage needs is not installed.

        Returns:
            What the plugin's function gives: None, or it is wrong.
        """
        needs: Any = self.can(Requires)
        return needs.require(options) if needs else None


# --- Capabilities of several kinds


class Usual:
    """A transform, emitter or executor that is taken where nobody names one; of the built-in ones, one is."""


class KeepsKinematics(NamedTuple):
    """A transform, or an edit of robots, that keeps T(base_link → tool0) with some options only: whether with these.

    Where it does not, the proof reports the difference and fails nothing; an edited robot has no table any more.
    """

    keeps_kinematics: Callable[[Any], bool]


class Requires(NamedTuple):
    """A loader or an executor that needs packages or programs.

    `require` is called before a run begins. It raises `dh2urdf.errors.MissingDependencyError` where a package that the
    stage needs with these options is not installed, without importing it (`importlib.util.find_spec`), and
    `MissingProgramError` where a program is missing.
    """

    require: Callable[[Any], None]


# --- Readers


class WritesTables(NamedTuple):
    """A reader that also writes files of tables.

    Attributes:
        write: the file of tables, which `read` reads, or InputError where it cannot hold them all.
        texts: the tables of a file as their authors typed them, as far as that is known; a text is used only where
            `write` and `read` make the same manipulator of it. None where the format has no such texts.
        not_written: suffixes of the record, but the first, whose files it reads and `write` does not make, as `.tsv`.
    """

    write: Callable[[Sequence[TableText]], WrittenTable]
    texts: Callable[[Path], Iterator[TableText]] | None = None
    not_written: tuple[str, ...] = ()


class Traces(NamedTuple):
    """A reader that knows which cell a number is from.

    `trace` reads as `read` does, and before each manipulator fills a trace with what its cells say: `dh2urdf info`.
    """

    trace: Callable[[Path, Any, Trace], Iterator[Manipulator | Rejected]]


class ReadsCells(NamedTuple):
    """The reader of rows of cells that come from no file, such as those of a DataFrame: `Catalog.cell_reader`.

    `read_cells` takes the rows from the top, comments and header included, and what messages name as the file. Of files
    with the suffix `any_text`, `read` finds out the form itself. `cells_of` gives the cells of a text of any form.
    """

    read_cells: Callable[[Iterable[CellRow], str, Any], Iterator[Manipulator | Rejected]]
    any_text: str = ""
    cells_of: Callable[[str], list[list[str]]] | None = None


class ReadsInColumns(NamedTuple):
    """A reader that reads many manipulators faster than one by one.

    `read_columns` yields what `read` yields, in the same order, but manipulators that follow each other in the file may
    come as `dh2urdf.columns.ManipulatorGroups`. Notices of the table of a group hold for each of its members.
    """

    read_columns: Callable[[Path, Any], Iterator[Manipulator | ManipulatorGroups | Rejected]]


class ReadsDescriptions(NamedTuple):
    """A reader of robot descriptions, whose chains are its tables.

    `leaves` are the links at the ends of a description's chains, each with the number of moving joints before it.
    """

    leaves: Callable[[Path, Any], Mapping[str, int]]


class HasSchema(NamedTuple):
    """A reader of YAML or JSON with a JSON Schema (2020-12) of its files: `dh2urdf schema table` prints it."""

    schema: Callable[[], dict[str, Any]]


ReaderCapability: TypeAlias = WritesTables | Traces | ReadsCells | ReadsInColumns | ReadsDescriptions | HasSchema
"""What else a reader can do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Reader(_Capable, Generic[O]):
    """Reads manipulators from a file.

    Attributes:
        name: the stage's name in a run file.
        summary: what it reads, in one line.
        read: yields the manipulators of a file one by one, without holding them. It raises
            `dh2urdf.errors.TableError` where the file as a whole cannot be read, and yields `Rejected` where one
            manipulator of several cannot.
        options: its options dataclass.
        suffixes: file suffixes that choose it, in lower case with the dot; the first is the usual one.
        capabilities: what else it can do, of `ReaderCapability`.
    """

    name: str
    summary: str
    read: Callable[[Path, O], Iterator[Manipulator | Rejected]]
    options: type[O]
    suffixes: tuple[str, ...] = ()
    capabilities: tuple[ReaderCapability, ...] = ()


# --- Transforms and edits


class TransformsInColumns(NamedTuple):
    """A transform that makes many robots at once.

    `transform_columns` makes the robots of many manipulators, to the last bit as `transform` does, in groups whose
    members differ in numbers only, each with the places of its members; it leaves out what has to be made one by one.
    It returns None where it cannot with these options.
    """

    transform_columns: Callable[[ManipulatorColumns, Any], Sequence[tuple[Sequence[int], RobotColumns]] | None]


class Compares(NamedTuple):
    """A transform with an option, a choice of words, whose first two choices the studio shows side by side."""

    option: str


TransformCapability: TypeAlias = KeepsKinematics | TransformsInColumns | Compares | Usual
"""What else a transform can do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Transform(_Capable, Generic[O]):
    """Makes the robot of a manipulator.

    Attributes:
        name: the stage's name in a run file.
        summary: what it makes, in one line.
        transform: makes the robot; raises `dh2urdf.errors.TransformError` where it refuses the manipulator. Without
            the capability `KeepsKinematics`, T(base_link → tool0) of the robot is the DH product.
        options: its options dataclass.
        capabilities: what else it can do, of `TransformCapability`.
    """

    name: str
    summary: str
    transform: Callable[[Manipulator, O], Robot]
    options: type[O]
    capabilities: tuple[TransformCapability, ...] = ()


class EditsInColumns:
    """An edit whose functions also accept records whose numbers are columns (`dh2urdf.columns`).

    They make of them, to the last bit, what they make of each alone. A run then edits many arms at once. The copies are
    made by `dh2urdf.fields.replace_unchecked`, and conditions are asked by `dh2urdf.rotations.agreed`.
    """


class NeedsMasses(NamedTuple):
    """An edit of tables that has to know what the base and every link weigh, if `applies` is true of its options.

    Where a table leaves that out, `edit_table` is given a table with the masses of the robot that the transform makes
    of it, such as those of the drawn shapes.
    """

    applies: Callable[[Any], bool]


class DependsOn(NamedTuple):
    """An edit that reads files which its options do not name, such as the meshes of a description.

    `read` returns a record of what was read. Where that is another one, `--resume` makes the manipulators anew.
    """

    read: Callable[[Any], object]


EditCapability: TypeAlias = KeepsKinematics | EditsInColumns | NeedsMasses | DependsOn
"""What else an edit can do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Edit(_Capable, Generic[O]):
    """Changes the table before the transform, or the robot after it; a run file lists any number of edits, in order.

    At least one of the two functions is given. Both return a new record with the name that they were given.

    Attributes:
        name: the stage's name in a run file.
        summary: what it changes, in one line.
        options: its options dataclass.
        edit_table: the changed manipulator. It is the truth from there on: every file is proved against it. What a
            person should know of the change is added to its `notices`.
        edit_robot: the changed robot. What a person should know of the change is added to its `notices`.
        capabilities: what else it can do, of `EditCapability`.

    Both functions raise `dh2urdf.errors.EditError` where they refuse what they are given. A robot that breaks a rule
    after `edit_robot` is refused with the name of the edit.
    """

    name: str
    summary: str
    options: type[O]
    edit_table: Callable[[Manipulator, O], Manipulator] | None = None
    edit_robot: Callable[[Robot, O], Robot] | None = None
    capabilities: tuple[EditCapability, ...] = ()


# --- Emitters


@dataclass(frozen=True, slots=True, kw_only=True)
class EmittedFile:
    """A file that an emitter wants written.

    Attributes:
        name: its name in the output folder. With the capability `WritesFolders` it is a path of several parts with
            ``/`` between them; without it, the name has no folder.
        content: what it holds.
        is_robot: whether `ReadsBack` reads it; of the files of a robot, the first such one is proved.
    """

    name: str
    content: bytes
    is_robot: bool = True


class ReadsBack(NamedTuple):
    """An emitter whose files are proved.

    Attributes:
        read_back: the robot that a written main file describes, by code that shares nothing with `emit`: the proof of
            every run compares its kinematics with the DH product.
        is_costly: whether `read_back` is so slow that long runs prove a sample only.
        of_tables: whether the files are tables, which have the arm without what is attached to it.
        floats_by_root: whether nothing can float but the root: of a robot that floats, the file has no world.
    """

    read_back: Callable[[Path], Robot]
    is_costly: bool = False
    of_tables: bool = False
    floats_by_root: bool = False


class ReadsForeign(NamedTuple):
    """An emitter that reads files of unknown origin: `dh2urdf view`.

    Attributes:
        read_foreign: what a file holds, expanded as an `Expansion` says: a `Robot`, or a `ForeignRobot` where there is
            more to it, such as joints that follow others.
        has_macros: whether files of the format hold macros: then users may say how this and `check` expand them.
        can_attach: whether what a file holds can be attached to other robots; `read_foreign` gives a `ForeignRobot`.
    """

    read_foreign: Callable[[Path, Expansion], Robot | ForeignRobot]
    has_macros: bool = False
    can_attach: bool = False


class EmitsInColumns(NamedTuple):
    """An emitter that writes many robots at once.

    Attributes:
        emit_columns: the files of many robots, a list for each of them, byte by byte as `emit` gives them, with a stem
            for each; a robot that is not `sure`, or that it cannot write so, gets an empty list. None where it cannot
            with these options or for such robots.
        read_columns: the robots that many main files describe, in groups whose members differ in numbers only, each
            with the places of its members among the files. Joints and their origins, axes and limits suffice. It shares
            nothing with `emit_columns`, and leaves out what it does not surely read as `read_back` would.
    """

    emit_columns: Callable[[RobotColumns, Sequence[str], Any], Sequence[Sequence[EmittedFile]] | None]
    read_columns: Callable[[Sequence[bytes]], Sequence[tuple[Sequence[int], Robot]]] | None = None


class Checks(NamedTuple):
    """An emitter whose format `dh2urdf check` inspects.

    Attributes:
        check: inspects a file of any origin, whose packages and macros an `Expansion` says. It reports whatever is
            wrong with the file as findings, and raises `dh2urdf.errors.InputError` only where the file cannot be read
            at all.
        descriptions: of the files of a folder, each with the name of its outermost element of XML (or an empty name),
            those that are whole descriptions of the format, and not a part of others: `dh2urdf check FOLDER`.
        fix: the file with what is mechanical fixed, and every other byte as it was: `dh2urdf check --fix`. It raises
            `dh2urdf.errors.InputError` where it cannot read the file. None where files of the format are not fixed.
        finds_packages: whether `check` uses the `package_paths` of an `Expansion` though files hold no macros.
        ask: gives a file that was inspected to the programs that are installed, and returns what was seen beside what
            is foretold, from the catalog, the emitter, the file, its `Expansion` and its `Inspection`. None where no
            program reads the format.
    """

    check: Callable[[Path, Expansion], Inspection]
    descriptions: Callable[[Mapping[Path, str]], Iterable[Path]] | None = None
    fix: Callable[[Path], Repair] | None = None
    finds_packages: bool = False
    ask: Callable[[Any, Emitter[Any], Path, Expansion, Inspection], Inspection] | None = None


class WritesFolders(NamedTuple):
    """An emitter that writes folders, as a ROS package is one: `dh2urdf convert` writes into a folder.

    `in_folders` are the names of the folders in which its files of a stem lie. Its record has no suffixes, and the
    files bring the meshes that they name.
    """

    in_folders: Callable[[str, Any], Iterable[str]]


class OtherFiles(NamedTuple):
    """An emitter of several files, or of files in several formats.

    Attributes:
        other_endings: what files beside the main one have behind the stem, as `_macro.xacro`; a run refuses any other.
        one_file: the options that make `emit` give a single file, for standard output; None where it always does.
        for_suffix: the options that make `emit` give what a suffix names; None where all suffixes hold the same.
    """

    other_endings: tuple[str, ...] = ()
    one_file: Callable[[Any], Any] | None = None
    for_suffix: Callable[[Any, str], Any] | None = None


class GivesNotices(NamedTuple):
    """An emitter whose format cannot hold all that a robot has.

    `notices` are what a person should know of the files of a robot; called before they are made. Of robots that differ
    in numbers only, and whose files `emit_columns` makes, it is called for one: it may not depend on their numbers.
    """

    notices: Callable[[Robot, Any], Sequence[Problem]]


class Annotates(NamedTuple):
    """An emitter of files that go with a robot description: `dh2urdf collisions`.

    `annotate` makes the file of a description of any origin, of which it takes how it is expanded, and of an earlier
    file, whose other content stays.
    """

    annotate: Callable[[Path, Expansion, Path | None, Any], Annotation]


EmitterCapability: TypeAlias = (
    ReadsBack | ReadsForeign | EmitsInColumns | Checks | WritesFolders | OtherFiles | GivesNotices | Annotates | Usual
)
"""What else an emitter can do."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Emitter(_Capable, Generic[O]):
    """Makes the files of a robot.

    Attributes:
        name: the stage's name in a run file, and the format that loaders ask for.
        summary: what it writes, in one line.
        emit: the files of a robot, whose names begin with the stem it is given; the first is the main file. It writes
            nothing itself: the pipeline writes all of them whole, or none.
        options: its options dataclass.
        suffixes: suffixes of the main file, in lower case with the dot; the first is the usual one.
        capabilities: what else it can do, of `EmitterCapability`.
    """

    name: str
    summary: str
    emit: Callable[[Robot, str, O], Sequence[EmittedFile]]
    options: type[O]
    suffixes: tuple[str, ...]
    capabilities: tuple[EmitterCapability, ...] = ()

    @property
    def endings(self) -> tuple[str, ...]:
        """What its files have behind the stem: its suffixes, and the endings of its other files."""
        others = self.can(OtherFiles)
        return (*self.suffixes, *(others.other_endings if others else ()))


Kind: TypeAlias = Literal["reader", "transform", "edit", "emitter", "loader", "executor"]

if not TYPE_CHECKING:  # Most commands make no such record.
    __all__, __getattr__, __dir__ = late_names(
        __name__,
        {
            "executors": "Executor ExecutorCapability Lost",
            "foreign_robot": "ForeignRobot",
            "given": "Stage Subcommand",
            "inspections": "SEVERITIES Annotation Effect Expansion Finding Inspection Repair Severity arguments_of",
            "load_records": "HeldRobot LoadReport LoadRequest Question SimulatedArm",
            "loaders": "LOAD_TIME_LIMIT Inspects Loader LoaderCapability ReadsOutput Reusable",
        },
    )
    __all__ += [
        name
        for name, value in globals().items()
        if (getattr(value, "__module__", "") == __name__ and len(name) > 1 and name[0] != "_")
        or name.endswith("Capability")
        or name in {"PACKAGE_FILE", "Kind"}
    ]
