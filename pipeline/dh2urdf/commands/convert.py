"""One table, one robot description: what the command `dh2urdf convert` and the function `dh2urdf.convert` both do."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.commands.choices import chosen_reader, edit_calls, option, read_manipulator, stage_calls
from dh2urdf.conversion.one_manipulator import Recipe, Written, with_notices, write_robot
from dh2urdf.conversion.robots import make_item
from dh2urdf.documents.text_files import is_folder
from dh2urdf.errors import ConfigError, EditError, RobotError, TableError, TransformError
from dh2urdf.manipulator import Manipulator
from dh2urdf.meshes.files import FILE, RELATIVE, prefix_of
from dh2urdf.meshes.kinds import MeshConversion
from dh2urdf.output.whole_files import refuse_no_file, safe_stem
from dh2urdf.plugin_system.calls import Call, a_record, depending_on
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf.stages import OtherFiles, Reader, WritesFolders
from dh2urdf.table_text import Trace

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Mapping, Sequence

    from dh2urdf.kinematics.expected_poses import ExpectedPoses
    from dh2urdf.kinematics.proof import Proof
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stages import Emitter

say = Messages(__file__)

TRACED_BYTES = 2**16
"""Size of a table of which a conversion also reads what its cells say [B]: a few hundred rows."""
POSES = 8  # random joint vectors of the proof of one conversion; `run` takes more


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


def plan_conversion(
    table: Path | Manipulator,
    target: Path | None,
    mark: Mark,
    catalog: Catalog,
    *,
    reader: str | None = None,
    transform: str | None = None,
    formats: Sequence[str] = (),
    robot: str | None = None,
    given: Mapping[str, Mapping[str, str | None]] | None = None,
    settings: Iterable[str] = (),
    meshes: str | None = None,
    convert_meshes: str | None = None,
    edits: Iterable[str] = (),
    inputs: Iterable[Path] = (),
) -> partial[Conversion]:
    """Resolve the stages and options of a conversion; what is returned carries it out.

    The arguments are those of `dh2urdf.convert`, but for these: `mark` is the place that problems name (the command
    line, or the function that was called); `given` and `settings` are options as words, the first by kind of stage;
    `inputs` are further files that must not be overwritten, the other tables of the same command.
    """
    readers: list[Any] = []
    if isinstance(table, Path):
        readers = [chosen_reader(catalog, table, reader, mark)]
    elif (reader, robot) != (None, None):
        wrong = option(mark, "reader", reader) if reader else option(mark, "robot", shown(str(robot)))
        raise ConfigError(say("option-of-files", mark, found=reader or robot, setting=wrong))
    transforms = [catalog.get("transform", transform) if transform else catalog.usual("transform")]
    emitters = _emitters(table, target, formats, mark, catalog)
    stages = {"reader": readers, "transform": transforms, "emitter": emitters}
    calls = stage_calls(catalog, stages, mark, given or {}, settings)
    notices: list[Problem] = []
    if target is None:
        calls["emitter"] = [in_one_file(call) for call in calls["emitter"]]
    elif len(emitters) == 1 and not emitters[0].can(WritesFolders):
        calls["emitter"] = [as_named(calls["emitter"][0], target)]
        if formats:
            from dh2urdf.conversion.file_endings import notices_of_ending

            notices = notices_of_ending(catalog, target, emitters[0], option(mark, "formats", emitters[0].name), mark)
    changes = edit_calls(edits, mark, catalog)
    prefix, conversion = _mesh_settings(meshes, convert_meshes, target, mark)
    recipe = Recipe(
        transform=calls["transform"][0],
        emitters=tuple(calls["emitter"]),
        edits=changes,
        poses=POSES,
        mesh_prefix=prefix,
        mesh_conversion=conversion,
    )
    reading = next(iter(calls["reader"]), None)
    return partial(carry_out, table, target, reading, recipe, mark, robot, tuple(inputs), notices)


def carry_out(  # noqa: PLR0917 - what `plan_conversion` has found out
    table: Path | Manipulator,
    target: Path | None,
    reader: Call[Reader[Any]] | None,
    recipe: Recipe,
    mark: Mark,
    robot: str | None = None,
    inputs: Sequence[Path] = (),
    asked: Sequence[Problem] = (),
    note: Callable[[Sequence[Problem]], None] = lambda _: None,
) -> Conversion:
    """Read the table, make the robot, write and prove the files; `note` takes the notices before that."""
    trace = Trace()
    if isinstance(table, Manipulator):
        manipulator, files = table, [Path(table.mark.file)] if table.mark else []
    elif reader is None:
        raise TypeError(table)
    else:  # What the cells of a large table say would take long.
        wanted = trace if table.stat().st_size <= TRACED_BYTES else None
        manipulator, files = read_manipulator(reader, table, robot, mark, wanted), [table, *reader.files]
    try:
        made, expected = make_item(manipulator, recipe.transform, recipe.edits)
        made = with_notices(made, recipe.emitters)
    except (EditError, TransformError, RobotError) as error:  # All there is to do is this table, and it is wrong.
        raise TableError(error.problems, manipulator.notices) from error
    notices = made.notices
    if recipe.mesh_conversion is not MeshConversion.NEVER:
        from dh2urdf.meshes.conversion import lost_pictures, unsettled

        notices = (*unsettled(notices), *lost_pictures(made))
    made = replace(made, notices=(*notices, *asked))
    note((*manipulator.notices, *made.notices))
    used = [path for call in recipe.calls for path in call.files]
    untyped = [row.joint for row, cells in zip(manipulator.rows, trace.rows, strict=False) if "type" not in cells]
    return Conversion(
        manipulator=manipulator,
        robot=made,
        written=_write(expected, made, recipe, target, (*files, *used, *inputs)),
        keeps_kinematics=recipe.keeps_kinematics,
        untyped=tuple(untyped),
    )


def _emitters(
    table: Path | Manipulator, target: Path | None, formats: Sequence[str], mark: Mark, catalog: Catalog
) -> list[Emitter[Any]]:
    """The emitters that are named, or the one by the suffix of the target, or the usual one."""
    emitters = [catalog.get("emitter", name) for name in formats]
    in_folders = [emitter.name for emitter in emitters if emitter.can(WritesFolders)]
    if target is None:
        if in_folders:
            setting, accepted = option(mark, "formats", in_folders[0]), option(mark, "out", "FOLDER")
            raise ConfigError(say("folder-nowhere", mark, setting=setting, where=_nowhere(mark), accepted=accepted))
        return emitters or [catalog.usual("emitter")]
    if len(formats) <= 1 and not in_folders:
        if is_folder(target):
            stem = safe_stem(table.name if isinstance(table, Manipulator) else table.stem)
            setting, name = option(mark, "out", shown(str(target))), f"{target / stem}.urdf"
            raise ConfigError(say("folder-for-file", mark, found=str(target), setting=setting, name=name))
        refuse_no_file(target)
    return emitters or [catalog.emitter_for(target, f"`{option(mark, 'formats', 'NAME')}` chooses an emitter")]


def in_one_file(call: Call[Emitter[Any]]) -> Call[Emitter[Any]]:
    """An emitter with options that make it give a single file."""
    others = call.stage.can(OtherFiles)
    if others is None or others.one_file is None:
        return call
    with depending_on(call, "one_file"):
        return replace(call, options=a_record(others.one_file(call.options), call.stage.options))


def as_named(call: Call[Emitter[Any]], target: Path) -> Call[Emitter[Any]]:
    """An emitter with options that make it give what the suffix of a file names, which must be one of its formats."""
    others = call.stage.can(OtherFiles)
    if others is None or others.for_suffix is None:
        return call
    if (suffix := _suffix(target, call.stage)) is None:
        name, suffixes = target.name, call.stage.suffixes
        about: dict[str, Any] = {"name": name, "emitter": call.stage.name, "suffixes": suffixes}
        raise ConfigError(say("name-of-no-format", found=str(target), **about))
    with depending_on(call, "for_suffix"):
        return replace(call, options=a_record(others.for_suffix(call.options, suffix), call.stage.options))


def _write(
    expected: ExpectedPoses, robot: Robot, recipe: Recipe, target: Path | None, inputs: Sequence[Path]
) -> tuple[Written, ...]:
    """The files of a robot, proved and put where they belong: at a file's name, into a folder, or nowhere."""
    stem = safe_stem(expected.name)
    if target is None:
        import tempfile

        with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
            return write_robot(expected, robot, recipe, directory=Path(folder), stem=stem)
    if len(recipe.emitters) > 1 or recipe.emitters[0].stage.can(WritesFolders) is not None:
        return write_robot(expected, robot, recipe, directory=target, stem=stem, inputs=inputs)
    name = target.name
    suffix = _suffix(target, recipe.emitters[0].stage)
    stem = target.stem if suffix is None else name[: -len(suffix)] or name
    return write_robot(expected, robot, recipe, directory=target.parent, stem=stem, main_file=name, inputs=inputs)


def _suffix(target: Path, emitter: Emitter[Any]) -> str | None:
    """The longest suffix of an emitter's files that a file has; None where it has none of them."""
    return max((each for each in emitter.suffixes if target.name.lower().endswith(each)), key=len, default=None)


def _mesh_settings(
    meshes: str | None, convert_meshes: str | None, target: Path | None, mark: Mark
) -> tuple[str | None, MeshConversion]:
    """What the description writes before the names of meshes, and what becomes of them."""
    try:
        prefix = prefix_of(meshes or (FILE if target is None else RELATIVE))
        if target is None and prefix is not None:
            accepted = f"{option(mark, 'out', 'FILE')}, or {option(mark, 'meshes', 'file')}"
            about = {"setting": option(mark, "meshes", str(meshes)), "where": _nowhere(mark), "accepted": accepted}
            raise ConfigError(say("meshes-nowhere", mark, found=meshes, **about))
        if not convert_meshes:
            return prefix, MeshConversion.NEVER
        from dh2urdf.meshes.conversion import conversion_of

        return prefix, conversion_of(convert_meshes, prefix)
    except ConfigError as error:
        raise ConfigError(replace(problem, mark=mark) for problem in error.problems) from None


def _nowhere(mark: Mark) -> str:
    """Where a conversion without a file goes."""
    return "this goes to standard output" if mark == COMMAND_LINE else "none is written"
