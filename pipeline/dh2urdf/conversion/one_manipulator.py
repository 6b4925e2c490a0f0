"""One manipulator on its way: transform, check, emit, prove, put in place.

The command `convert` and every worker of a run go through here, so one table and a million are made alike.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypeVar, overload

from dh2urdf.cells.floating import prove_floating, with_world
from dh2urdf.columns import ManipulatorGroups
from dh2urdf.conversion.robots import keeps_kinematics
from dh2urdf.errors import EmitterError, InputError, ProofError, RecordError, TableError
from dh2urdf.kinematics.expected_poses import proof_vectors
from dh2urdf.kinematics.proof import TOLERANCE, Proof, prove
from dh2urdf.manipulator import Manipulator
from dh2urdf.meshes.files import RELATIVE, copy_path, located, mesh_files, prefix_of, read_mesh
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.output.whole_files import put_in_place, refuse_inputs, staging, write_files, write_whole
from dh2urdf.plugin_system.calls import Call, a_record, blaming, emitted_files, items_of, reading, several_records
from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf.stages import (
    Edit,
    EditsInColumns,
    EmitsInColumns,
    EmittedFile,
    Emitter,
    GivesNotices,
    Reader,
    ReadsBack,
    ReadsInColumns,
    Rejected,
    Traces,
    Transform,
    TransformsInColumns,
    WritesFolders,
    WritesTables,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.kinematics.expected_poses import ExpectedPoses, Poses
    from dh2urdf.stages import Loader  # noqa: TC004 - the type of a field, which nobody asks for
    from dh2urdf.table_text import TableText, Trace, WrittenTable

say = Messages(__file__)

Only: TypeAlias = Literal["arms", "cells"]
"""What an emitter writes that does not write both."""

I = TypeVar("I")  # noqa: E741 - what a reader yields


@dataclass(frozen=True, slots=True, kw_only=True)
class Sample:
    """Which manipulators of a run are looked at, by their numbers from 0.

    Attributes:
        first: so many at the beginning.
        every: n, for every n-th of the rest.
    """

    first: int = 0
    every: int = 1

    def __contains__(self, index: int) -> bool:
        return index < self.first or index % self.every == 0


@dataclass(frozen=True, slots=True, kw_only=True)
class Recipe:
    """What is done with every manipulator.

    Attributes:
        transform: makes the robot.
        edits: change the table before the transform, and the robot after it, in their order.
        emitters: make the files.
        only: by the names of emitters, what they write that do not write both arms and cells.
        loaders: load the files into simulators.
        optional: the names of the loaders whose failures are notices.
        missing: of these, what is not installed that they need, by their names.
        poses: random joint vectors of a proof, besides zero and both ends of the limits.
        proved: whose files are compared with the table.
        sample: whose files go through what is slow: expansion of xacro, and simulators.
        time_limit: how long one manipulator may take, simulators aside [s].
        mesh_prefix: what descriptions write before the name of a copied mesh; None where none is copied.
        mesh_conversion: what becomes of meshes.
    """

    transform: Call[Transform[Any]]
    emitters: tuple[Call[Emitter[Any]], ...]
    edits: tuple[Call[Edit[Any]], ...] = ()
    only: Mapping[str, Only] = field(default_factory=dict)
    loaders: tuple[Call[Loader[Any]], ...] = ()
    optional: frozenset[str] = frozenset()
    missing: Mapping[str, str] = field(default_factory=dict)
    poses: int = 32
    proved: Sample = Sample()
    sample: Sample = Sample()
    time_limit: float = 300.0
    mesh_prefix: str | None = prefix_of(RELATIVE)
    mesh_conversion: MeshConversion = MeshConversion.NEVER

    @property
    def copies_meshes(self) -> bool:
        """Whether meshes are copied beside the descriptions; files in folders of their own bring theirs."""
        return self.mesh_prefix is not None and not all(call.stage.can(WritesFolders) for call in self.emitters)

    @property
    def calls(self) -> tuple[Call[Any], ...]:
        """The stages that make and look at files."""
        return (self.transform, *self.edits, *self.emitters, *self.loaders)

    def of(self, what: Only) -> Recipe:
        """What is done with arms by themselves, or with cells."""
        emitters = tuple(call for call in self.emitters if self.only.get(call.stage.name, what) == what)
        return replace(self, emitters=emitters)

    @property
    def makes_many_at_once(self) -> bool:
        """Whether all stages that make files have a form for many manipulators at once."""
        has_form = self.transform.stage.can(TransformsInColumns) is not None
        edits = all(call.stage.can(EditsInColumns) for call in self.edits)
        return has_form and edits and all(call.stage.can(EmitsInColumns) for call in self.emitters)

    @property
    def keeps_kinematics(self) -> bool:
        """Whether a difference from the DH product is a failure."""
        return keeps_kinematics(self.transform) and all(map(keeps_kinematics, self.edits))


@dataclass(frozen=True, slots=True, kw_only=True)
class Written:
    """What an emitter made.

    Attributes:
        stage: name of the emitter.
        files: its files, the main one first.
        proof: how far the main file is from the DH product; None where the format cannot be read back or the proof
            was left to a sample of the run.
    """

    stage: str
    files: tuple[EmittedFile, ...]
    proof: Proof | None


def with_notices(robot: Robot, emitters: Iterable[Call[Emitter[Any]]]) -> Robot:
    """A robot with the notices of the emitters that write its files; the same notice of several emitters stands once.

    Raises:
        StageError: an emitter is at fault.
    """
    notices = dict.fromkeys(robot.notices)
    for call in emitters:
        if gives := call.stage.can(GivesNotices):
            with blaming(call, "notices"):
                found = several_records(gives.notices(robot, call.options), Problem)
            for each in found:
                notices[replace(each.about(robot=robot.name), severity="notice")] = None
    return replace(robot, notices=tuple(notices))


def with_copies(robot: Robot, recipe: Recipe) -> Robot:
    """A robot whose meshes are those that its descriptions shall name: converted, and named by their copies.

    Raises:
        ManipulatorError: a mesh cannot be converted.
        MissingDependencyError: a package that converts is not installed.
        OutputError: a mesh cannot be read any more.
    """
    if recipe.mesh_conversion is not MeshConversion.NEVER:
        from dh2urdf.meshes.conversion import converted

        robot = converted(robot, recipe.mesh_conversion)
    return located(robot, recipe.mesh_prefix)


def write_robot(
    expected: ExpectedPoses,
    robot: Robot,
    recipe: Recipe,
    *,
    directory: Path,
    stem: str,
    main_file: str | None = None,
    inputs: Iterable[Path] = (),
) -> tuple[Written, ...]:
    """Emit a robot with every emitter, prove each file, and put all of them in place, with its meshes, or none.

    Args:
        expected: what the tables declare about it.
        robot: the robot.
        recipe: what is done.
        directory: where the files go; made where it is missing.
        stem: the stem of their names.
        main_file: another name for the first emitter's main file.
        inputs: files that are read, and so must not be overwritten; the robot's meshes are too.

    Raises:
        ManipulatorError: an emitter failed, or what it wrote is not the arm of the table.
        OutputError: the files cannot be written, or one of them is an input.
    """
    originals = mesh_files(robot)
    if originals:
        robot = with_copies(robot, recipe)
    copies = mesh_files(robot) if originals and recipe.copies_meshes else ()
    with staging(directory) as folder:
        written = emit_robot(expected, robot, recipe, folder=folder, stem=stem, main_file=main_file)
        names = [file.name for emitted in written for file in emitted.files]
        targets = [directory / name for name in (*names, *map(copy_path, copies))]
        refuse_inputs(targets, [*inputs, *[Path(mesh.path) for mesh in originals]])
        for file in copies:
            write_whole(directory / copy_path(file), read_mesh(file))
        put_in_place(folder, names, directory)
    return written


def emit_robot(
    expected: ExpectedPoses,
    robot: Robot,
    recipe: Recipe,
    *,
    folder: Path,
    stem: str,
    place: str = "",
    main_file: str | None = None,
    proved: bool = True,
    sampled: bool = True,
    alone: bool = True,
    at_once: bool = False,
) -> tuple[Written, ...]:
    """Emit a robot with every emitter into a folder of its own, and prove each file there.

    Args:
        expected: what the tables declare about it.
        robot: the robot.
        recipe: what is done.
        folder: a folder that nobody else uses.
        stem: the stem of the files' names.
        place: where the files will be in the end, for messages; by default the folder above.
        main_file: another name for the first emitter's main file.
        proved: whether to prove the files.
        sampled: whether to prove also those whose proof is slow.
        alone: whether no other robot is written into the same place with the same options.
        at_once: whether to prove at all joint vectors together, with numpy.

    Raises:
        ManipulatorError: an emitter failed, or what it wrote is not the arm of the table.
        OutputError: the files cannot be written.
    """
    poses = proof_vectors(expected, robot, recipe.poses) if proved else ()
    written: list[Written] = []
    taken: dict[str, str] = {}
    for call in recipe.emitters:
        emitter = call.stage
        if not alone:
            _refuse_one_folder(call, stem)
        in_folders = emitter.can(WritesFolders) is not None
        with blaming(call):
            files = emitted_files(emitter.emit(robot, stem, call.options), stem, in_folders=in_folders)
            if not files:
                raise ValueError("it gave no file")
        if main_file is not None and not written:
            files[0] = replace(files[0], name=main_file)
        for file in files:
            if other := taken.get(file.name.casefold()):  # as on file systems that ignore case
                code = "emitter-twice" if other == emitter.name else "emitters-of-one-file"
                raise EmitterError(say(code, first=other, second=emitter.name, name=file.name))
            taken[file.name.casefold()] = emitter.name
        write_files(folder, files, place)
        reads = emitter.can(ReadsBack)
        proof = None
        described = next((file.name for file in files if file.is_robot), None)
        if described and proved and reads is not None and (sampled or not reads.is_costly):
            path, final = folder / described, f"{place or folder.parent}/{described}"
            with reading(path, final), blaming(call, "read_back"):
                read = a_record(reads.read_back(path), Robot)
            if robot.floating and not reads.of_tables:
                read = with_world(robot, read)
                prove_floating(robot, read)
            proof = _proof(expected, robot, read, call, poses, recipe, at_once=at_once)
            if robot.attachments and not reads.of_tables:
                from dh2urdf.kinematics.attached import prove_attachments

                prove_attachments(robot, read)
        written.append(Written(stage=emitter.name, files=tuple(files), proof=proof))
    return tuple(written)


def _proof(  # noqa: PLR0917 - what is known of a file
    expected: ExpectedPoses,
    robot: Robot,
    described: Robot,
    call: Call[Emitter[Any]],
    poses: Poses,
    recipe: Recipe,
    *,
    at_once: bool,
) -> Proof:
    """Return how far the robot that a file describes is from the tables.

    Raises:
        ProofError: it is another arm; the error names whose fault that is: the emitter, or what made the robot.
    """
    try:
        proof = prove(expected, described, poses, at_once=at_once)
    except ProofError as error:
        if what := _makers_at_fault(expected, robot, poses, recipe):
            raise _another_arm(error.problems, what) from error
        raise
    if recipe.keeps_kinematics and not proof.holds:
        off = say(
            "off-the-table",
            expected.mark,
            robot=expected.name,
            tip=proof.tip,
            position=proof.position_error,
            angle=proof.angle_error,
            q=[*proof.q],
            most=proof.tolerance,
            most_angle=TOLERANCE,
        )
        what = _makers_at_fault(expected, robot, poses, recipe) or f"the emitter {call.stage.name!r} wrote"
        raise _another_arm([off], what)
    return proof


def _another_arm(problems: Sequence[Problem], what: str) -> ProofError:
    told = [replace(each, message=f"what {what} is not the arm of the table: {each.message}") for each in problems]
    return ProofError(told)


def _makers_at_fault(expected: ExpectedPoses, robot: Robot, poses: Poses, recipe: Recipe) -> str:
    """Return the transform and the edits that made a robot which is another arm, in words; empty where it is none."""
    with suppress(ProofError):
        if prove(expected, robot, poses).holds:
            return ""
    makers: list[Call[Any]] = [recipe.transform, *(call for call in recipe.edits if call.stage.edit_robot is not None)]
    return f"the {' and the '.join(str(call.attribution) for call in makers)} made"


def _refuse_one_folder(call: Call[Emitter[Any]], stem: str) -> None:
    """Refuse options with which two robots would be written into one folder."""
    if (writes := call.stage.can(WritesFolders)) is None:
        return
    with blaming(call, "in_folders"):
        own, others = (set(items_of(writes.in_folders(each, call.options), "names")) for each in (stem, f"{stem}_"))
    if shared := sorted(own & others):
        raise EmitterError(say("one-folder-of-several", found=shared[0], emitter=call.stage.name))


def refuse_undeclared_files(
    call: Call[Emitter[Any]], stems: Iterable[str], files: Iterable[Sequence[EmittedFile]]
) -> None:
    """Refuse files of a run with an ending that the emitter's record does not have.

    Stems are given out so that no two of them make one name with the endings that are declared: where ``ur5`` has a
    file ``ur5_parts.csv``, no other robot has the stem ``ur5_parts`` beside the ending ``.csv``.

    Args:
        call: the emitter.
        stems: the stem of each robot.
        files: the files of each.

    Raises:
        ManipulatorError: there is such a file.
    """
    if call.stage.can(WritesFolders):
        return
    declared = {ending.casefold() for ending in call.stage.endings}
    with blaming(call):
        for stem, own in zip(stems, files, strict=True):
            for file in own:
                if (ending := file.name[len(stem) :]).casefold() not in declared:
                    raise ValueError(
                        f"{shown(file.name)} has {shown(ending)} behind the stem, which is none of the suffixes and "
                        "other_endings of its record: another robot of the run may have a file of this name"
                    )


# --- What is read -----------------------------------------------------------------------------------------------------


@overload
def read_items(
    call: Call[Reader[Any]], path: Path, trace: Trace | None = None, *, columns: Literal[False] = False
) -> Iterator[Manipulator | Rejected]: ...
@overload
def read_items(
    call: Call[Reader[Any]], path: Path, trace: Trace | None = None, *, columns: bool
) -> Iterator[Manipulator | ManipulatorGroups | Rejected]: ...
def read_items(
    call: Call[Reader[Any]], path: Path, trace: Trace | None = None, *, columns: bool = False
) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """What a reader yields of a file, one by one.

    Args:
        call: the reader.
        path: the file.
        trace: takes what the cells of each manipulator say, where it is wanted and the reader knows it.
        columns: whether manipulators may come in columns, where the reader has a way to yield these.

    Raises:
        TableError: the file as a whole cannot be read, or it has changed while it was read.
        StageError: the reader raised something else.
    """
    before, reader = _state_of(path), call.stage
    try:
        with reading(path):
            with blaming(call):
                if columns and (fast := reader.can(ReadsInColumns)):
                    given = fast.read_columns(path, call.options)
                elif trace is not None and (traces := reader.can(Traces)):
                    given = traces.trace(path, call.options, trace)
                else:
                    given = reader.read(path, call.options)
                items = items_of(given, Manipulator)
            for item in checked_items(items, call, columns=columns):
                if isinstance(item, Rejected) and _state_of(path) != before:
                    raise TableError(item.problems)  # A row that was cut off is no fault of the table.
                yield item
    except TableError as error:
        problems, mark = error.problems, Mark(file=str(path))
        if _state_of(path) != before:
            raise TableError([_changed(path), *problems], error.notices) from error
        if isinstance(error, RecordError):  # which names the record, and neither the file nor who made it
            made = f"the {call.attribution if call.plugin else call} made such a record of it"
            problems = tuple([replace(each, mark=mark, message=f"{each.message}: {made}") for each in problems])
        elif all(problem.mark is not None for problem in problems):
            raise
        raise TableError([each.about(mark=mark) for each in problems], error.notices) from error
    if _state_of(path) != before:
        raise TableError(_changed(path))


def checked_items(items: Iterator[I], call: Call[Reader[Any]], *, columns: bool = False) -> Iterator[I]:
    """What a reader yields, each looked at.

    Raises:
        TableError: the file as a whole cannot be read.
        StageError: the reader raised or gave something else.
    """
    end = object()
    while True:
        with blaming(call):  # What is done with an item is not the reader's work.
            item: Any = next(items, end)
            if item is end:
                return
            if isinstance(item, Rejected) and not item.problems:
                raise ValueError(f"it rejected {shown(item.name)} and did not say why")
            if isinstance(item, ManipulatorGroups) and columns:
                from dh2urdf.plugin_system.column_calls import checked_groups

                checked_groups(item)
            else:
                a_record(item, Manipulator, Rejected)
        yield item


def _state_of(path: Path) -> tuple[int, ...] | None:
    """What is another number once somebody has written to a file or put another one in its place; None without one."""
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return status.st_dev, status.st_ino, status.st_size, status.st_mtime_ns


def _changed(path: Path) -> Problem:
    return say("file-changed", Mark(file=str(path)))


def in_format(tables: Sequence[TableText], call: Call[Reader[Any]]) -> WrittenTable:
    """Tables as a file in the format of a reader.

    Raises:
        InputError: the reader only reads, or a file of its format cannot hold several such tables.
    """
    from dh2urdf.table_text import WrittenTable

    writes = call.stage.can(WritesTables)
    if writes is None:
        raise InputError(say("reader-only-reads", reader=call.stage.name))
    with blaming(call, "write"):
        return a_record(writes.write(tables), WrittenTable)
