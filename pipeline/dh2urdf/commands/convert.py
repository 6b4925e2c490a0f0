"""One table, one robot description: what the command `dh2urdf convert` and the function `dh2urdf.convert` both do."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.commands.chosen_table import chosen_reader, read_manipulator
from dh2urdf.commands.options_of_stages import Asker, stage_calls
from dh2urdf.conversion.one_manipulator import Recipe, Written, with_notices, write_robot
from dh2urdf.conversion.robots import make_item
from dh2urdf.documents.text_files import check_file, is_folder
from dh2urdf.errors import ConfigError, EditError, RobotError, TableError, TransformError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.manipulator import Manipulator
from dh2urdf.meshes.files import FILE, RELATIVE, mesh_files, prefix_of
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.output.whole_files import refuse_no_file, safe_stem
from dh2urdf.provenance import Trace
from dh2urdf.robot import Robot
from dh2urdf.source import Problem, shown
from dh2urdf.stage_calls.answers import a_record
from dh2urdf.stage_calls.calls import Call, depending_on
from dh2urdf.stages import Edit, Reader

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from dh2urdf.commands.options_of_stages import Setting
    from dh2urdf.kinematics.expected_poses import ExpectedPoses
    from dh2urdf.kinematics.proof import Proof
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Emitter

TRACED_BYTES = 2**16
"""Size of a table of which a conversion also reads what its cells say [B]: a few hundred rows."""
POSES = 8
"""Random joint vectors of the proof of one conversion; `run` takes more."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Conversion:
    """What became of one table.

    Attributes:
        manipulator: the table.
        robot: the robot made of it.
        written: what was made by each emitter, in the order in which they were asked for.
        keeps_kinematics: whether the transform keeps T(q): where it does not, differences fail nothing.
        untyped: names of joints that are revolute because the table does not say their type, as far as that is known.
    """

    manipulator: Manipulator
    robot: Robot
    written: tuple[Written, ...]
    keeps_kinematics: bool = True
    untyped: tuple[str, ...] = ()

    @property
    def text(self) -> str:
        """The main file of the first format, as text."""
        return self.written[0].files[0].content.decode()

    @property
    def files(self) -> dict[str, bytes]:
        """What is in every file, by its name."""
        return {file.name: file.content for written in self.written for file in written.files}

    @property
    def proofs(self) -> dict[str, Proof | None]:
        """By format, how far the main file is from the DH product; None where the format cannot be read back."""
        return {written.stage: written.proof for written in self.written}

    @property
    def notices(self) -> tuple[Problem, ...]:
        """What a careful person would want to know of the table and of the robot."""
        return (*self.manipulator.notices, *self.robot.notices)

    def _repr_html_(self) -> str:
        """What a notebook shows: the robot."""
        return self.robot._repr_html_()


@dataclass(frozen=True, slots=True, kw_only=True)
class Planned:
    """A conversion whose stages and options are all resolved; nothing has been read yet.

    Attributes:
        table: a table's file, or what was read from one.
        target: the file to write; a folder where there are several formats. None writes nothing.
        reader: reads the table; None where it has been read.
        recipe: what is done with it.
        robot: which manipulator of a table that holds several.
        asker: who asks.
        inputs: further files that must not be overwritten.
        meshes: the words about meshes that were given, with what stands before each.
        notices: what a careful person would want to know of what was asked for.
    """

    table: Path | Manipulator
    target: Path | None
    reader: Call[Reader[Any]] | None
    recipe: Recipe
    robot: str | None
    asker: Asker
    inputs: tuple[Path, ...] = ()
    meshes: tuple[tuple[str, str], ...] = ()
    notices: tuple[Problem, ...] = ()

    def carry_out(self, note: Callable[[Sequence[Problem]], None] = lambda _: None) -> Conversion:
        """Read the table, make the robot, write and prove the files.

        Args:
            note: takes the notices before anything is written.

        Raises:
            TableError: the table cannot be read, or no robot can be made of it.
            ConfigError: the table is a run file.
            ManipulatorError: no file could be made, or it is not the arm of the table.
            OutputError: the files cannot be written, or one of them is an input.
            PluginError: a plugin that is needed is broken, or something it needs is not installed.
        """
        trace = Trace()
        manipulator, files = self._read(trace)
        named = zip(manipulator.rows, trace.rows, strict=False)
        try:
            robot, expected = make_item(manipulator, self.recipe.transform, self.recipe.edits)
            made = with_notices(robot, self.recipe.emitters)
        except (EditError, TransformError, RobotError) as error:  # All there is to do is this table, and it is wrong.
            raise TableError(error.problems, manipulator.notices) from error
        notices = made.notices
        if self.recipe.mesh_conversion is not MeshConversion.NEVER:
            from dh2urdf.meshes.conversion import unsettled

            notices = unsettled(notices)
        made = replace(made, notices=(*notices, *self.notices, *self._unused_meshes(made)))
        note((*manipulator.notices, *made.notices))
        used = (path for call in self.recipe.calls for path in call.files)
        written = _write(expected, made, self.recipe, self.target, (*files, *used, *self.inputs))
        return Conversion(
            manipulator=manipulator,
            robot=made,
            written=written,
            keeps_kinematics=self.recipe.keeps_kinematics,
            untyped=tuple(row.joint for row, cells in named if "type" not in cells),
        )

    def _unused_meshes(self, robot: Robot) -> Iterator[Problem]:
        """A notice where a setting of meshes is given, and there are none."""
        for before, word in self.meshes if not mesh_files(robot) else ():
            message = f"{before}{shown(word)} has no effect: the arm has no meshes"
            yield Problem(message=message, severity="notice", mark=self.asker.mark, field="meshes")

    def _read(self, trace: Trace) -> tuple[Manipulator, tuple[Path, ...]]:
        """The manipulator, and the file that it comes from, as far as that is known.

        Args:
            trace: takes what the cells say; not of a large file, where it would take long.
        """
        if isinstance(self.table, Manipulator):
            mark = self.table.mark
            return self.table, (Path(mark.file),) if mark else ()
        if self.reader is None:
            raise TypeError(self.table)
        wanted = trace if self.table.stat().st_size <= TRACED_BYTES else None
        arm = read_manipulator(self.reader, self.table, self.robot, self.asker, wanted)
        return arm, (self.table, *self.reader.files)


def plan_conversion(
    table: Path | Manipulator,
    target: Path | None,
    asker: Asker,
    catalog: Catalog,
    *,
    reader: str | None = None,
    transform: str | None = None,
    formats: Sequence[str] = (),
    robot: str | None = None,
    given: Mapping[str, Mapping[str, str | None]] | None = None,
    settings: Iterable[Setting] = (),
    meshes: str | None = None,
    convert_meshes: str | None = None,
    edits: Iterable[str] = (),
    inputs: Iterable[Path] = (),
) -> Planned:
    """Resolve the stages and options of a conversion.

    Args:
        table: a table's file, or what was read from one.
        target: the file to write; a folder where there are several formats. None writes nothing: each format is then
            one file.
        asker: who asks.
        catalog: the stages that there are.
        reader: name of the reader; without it the table's suffix says it.
        transform: name of the transform; None for the usual one.
        formats: names of emitters; without any the suffix of the target says it, else it is the usual one.
        robot: which manipulator of a table that holds several.
        given: options by kind of stage, as words.
        settings: further options.
        meshes: how the description names meshes, as `dh2urdf.meshes.files.prefix_of` takes it.
        convert_meshes: what becomes of meshes, as `dh2urdf.meshes.conversion.conversion_of` takes it.
        edits: changes of the table and of the robot, as `dh2urdf.commands.given_edits.edit_calls` takes them.
        inputs: further files that must not be overwritten: the other tables of the same command.

    Raises:
        TableError: there is no such table.
        ConfigError: something that was asked for is wrong.
        InputError: no installed reader or emitter takes a file's suffix, or none has the name.
        PluginError: a plugin that is needed is broken.
    """
    stages: dict[str, list[Any]] = {"reader": []}
    if isinstance(table, Path):
        check_file(table, TableError)
        stages["reader"] = [chosen_reader(catalog, table, reader, asker)]
    else:
        _refuse_choice(asker, {asker.reader: reader, asker.robot: robot})
    stages["transform"] = [catalog.get("transform", transform) if transform else catalog.usual("transform")]
    if formats or target is None:
        named = [catalog.get("emitter", name) for name in formats]
        stages["emitter"] = named or [catalog.usual("emitter")]
    in_folders = [emitter.name for emitter in stages.get("emitter", ()) if emitter.in_folders]
    if in_folders and target is None:
        raise ConfigError(
            Problem(
                message=f"{asker.format}{in_folders[0]} writes a folder of files, and {asker.nowhere}",
                mark=asker.mark,
                found=in_folders[0],
                accepted=f"{asker.out}FOLDER",
            )
        )
    one_file = len(formats) <= 1 and not in_folders
    if target is not None and one_file and is_folder(target):
        stem = safe_stem(table.name if isinstance(table, Manipulator) else table.stem)
        raise ConfigError(
            Problem(
                message=f"{asker.out}{shown(str(target))} is a folder, and one file is written",
                mark=asker.mark,
                found=str(target),
                accepted=f"a file name, such as {target / stem}.urdf",
            )
        )
    if target is not None and one_file:
        refuse_no_file(target)
    if target is not None and not formats:
        stages["emitter"] = [catalog.emitter_for(target, f"`{asker.format}NAME` chooses an emitter")]
    calls = stage_calls(catalog, stages, asker, given or {}, settings)
    if target is None:
        calls["emitter"] = [in_one_file(call) for call in calls["emitter"]]
    elif one_file:
        calls["emitter"] = [as_named(call, target) for call in calls["emitter"]]
    prefix = _mesh_prefix(meshes, target, asker)
    recipe = Recipe(
        transform=calls["transform"][0],
        emitters=tuple(calls["emitter"]),
        edits=_edits(edits, asker, catalog),
        poses=POSES,
        mesh_prefix=prefix,
        mesh_conversion=_mesh_conversion(convert_meshes, prefix, target, asker),
    )
    notices: list[Problem] = []
    if formats and target is not None and one_file:
        from dh2urdf.conversion.file_endings import notices_of_ending

        (chosen,) = stages["emitter"]
        notices = notices_of_ending(catalog, target, chosen, f"{asker.format}{chosen.name}", asker.mark)
    said = ((asker.meshes, meshes), (asker.convert_meshes, convert_meshes))
    return Planned(
        table=table,
        target=target,
        reader=calls["reader"][0] if calls["reader"] else None,
        recipe=recipe,
        robot=robot,
        asker=asker,
        inputs=tuple(inputs),
        meshes=tuple((before, word) for before, word in said if word is not None),
        notices=tuple(notices),
    )


def _edits(words: Iterable[str], asker: Asker, catalog: Catalog) -> tuple[Call[Edit[Any]], ...]:
    if not (given := tuple(words)):
        return ()
    from dh2urdf.commands.given_edits import edit_calls

    return edit_calls(given, asker, catalog)


def in_one_file(call: Call[Emitter[Any]]) -> Call[Emitter[Any]]:
    """An emitter with options that make it give a single file."""
    if call.stage.one_file is None:
        return call
    with depending_on(call, "one_file"):
        return replace(call, options=a_record(call.stage.one_file(call.options), call.stage.options))


def as_named(call: Call[Emitter[Any]], target: Path) -> Call[Emitter[Any]]:
    """An emitter with options that make it give what the suffix of a file names.

    Raises:
        ConfigError: the suffix names none of the formats of an emitter that has several.
    """
    if call.stage.for_suffix is None:
        return call
    if (suffix := _suffix(target, call.stage)) is None:
        from dh2urdf.conversion.file_endings import names_no_format

        raise names_no_format(target, call.stage)
    with depending_on(call, "for_suffix"):
        return replace(call, options=a_record(call.stage.for_suffix(call.options, suffix), call.stage.options))


def _write(
    expected: ExpectedPoses, robot: Robot, recipe: Recipe, target: Path | None, inputs: Sequence[Path]
) -> tuple[Written, ...]:
    """The files of a robot, proved and put where they belong: at a file's name, into a folder, or nowhere."""
    stem = safe_stem(expected.name)
    if target is None:
        import tempfile

        with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
            return write_robot(expected, robot, recipe, directory=Path(folder), stem=stem)
    if len(recipe.emitters) > 1 or recipe.emitters[0].stage.in_folders:
        return write_robot(expected, robot, recipe, directory=target, stem=stem, inputs=inputs)
    stem = _stem(target, recipe.emitters[0].stage)
    directory, name = target.parent, target.name
    return write_robot(expected, robot, recipe, directory=directory, stem=stem, main_file=name, inputs=inputs)


def _stem(target: Path, emitter: Emitter[Any]) -> str:
    """The stem of a file that a person named: its name without the format's suffix."""
    suffix = _suffix(target, emitter)
    return target.stem if suffix is None else target.name[: -len(suffix)] or target.name


def _suffix(target: Path, emitter: Emitter[Any]) -> str | None:
    """The longest suffix of an emitter's files that a file has; None where it has none of them."""
    suffixes = sorted(emitter.suffixes, key=len, reverse=True)
    return next((suffix for suffix in suffixes if target.name.lower().endswith(suffix)), None)


def _mesh_prefix(word: str | None, target: Path | None, asker: Asker) -> str | None:
    """What the description writes before the names of meshes; where no file is written, nothing lies beside it.

    Raises:
        ConfigError: the word means nothing, or copies would lie nowhere.
    """
    try:
        prefix = prefix_of(word or (FILE if target is None else RELATIVE))
    except ConfigError as error:
        raise ConfigError(replace(problem, mark=asker.mark) for problem in error.problems) from None
    if target is None and prefix is not None:
        message = f"{asker.meshes}{word} copies meshes beside a file, and {asker.nowhere}"
        accepted = f"{asker.out}FILE, or {asker.meshes}file"
        raise ConfigError(Problem(message=message, mark=asker.mark, found=word, accepted=accepted))
    return prefix


def _mesh_conversion(word: str | None, prefix: str | None, target: Path | None, asker: Asker) -> MeshConversion:
    """What becomes of the meshes.

    Raises:
        ConfigError: the word means nothing, or what is converted would lie nowhere.
    """
    if not word:
        return MeshConversion.NEVER
    from dh2urdf.meshes.conversion import conversion_of

    try:
        return conversion_of(word, prefix)
    except ConfigError as error:
        where = f"{asker.out}FILE" if target is None else f"{asker.meshes}{RELATIVE}"
        raise ConfigError(
            replace(
                problem,
                message=f"{asker.convert_meshes}{word}: {problem.message}",
                mark=asker.mark,
                accepted=where if prefix is None and word in list(MeshConversion) else problem.accepted,
            )
            for problem in error.problems
        ) from None


def _refuse_choice(asker: Asker, choices: Mapping[str, str | None]) -> None:
    """Refuses what chooses from a file, or how to read it, where there is no file any more.

    Raises:
        ConfigError: something is chosen.
    """
    for before, word in choices.items():
        if word is not None:
            message = f"{before}{shown(word)} is about a file, and the table is a manipulator already"
            raise ConfigError(Problem(message=message, mark=asker.mark, found=word))
