"""One table, one robot description: what the command `dh2urdf convert` and the function `dh2urdf.convert` both do."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass, replace
from os.path import isdir
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.attribution import Call, depending_on
from dh2urdf.conversion import Recipe, Written, make_robot, read_items, write_robot
from dh2urdf.errors import ConfigError, RobotError, TableError, TransformError
from dh2urdf.manipulator import Manipulator
from dh2urdf.meshes import FILE, RELATIVE, prefix_of
from dh2urdf.options import make_options
from dh2urdf.output import safe_stem
from dh2urdf.robot import Robot
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected
from dh2urdf.textfiles import check_file
from dh2urdf.truth import Truth

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    from dh2urdf.proof import Proof
    from dh2urdf.registry import Catalog
    from dh2urdf.stages import Emitter, Reader

DEFAULT_EMITTER = "urdf"
DEFAULT_TRANSFORM = "alpha-swap"
POSES = 8
"""Random joint vectors of the proof of one conversion [1]; `run` takes more."""


class Asker(NamedTuple):
    """Who asks for a conversion: a command line or a program, as messages speak to it.

    Attributes:
        mark: the place of whatever is wrong with what was asked.
        reader: what stands before the name of a reader.
        format: what stands before the name of an emitter.
        robot: what stands before the name of a manipulator.
        out: what stands before the name of a file.
        meshes: what stands before the word for meshes.
        setting: what stands before any other option of a stage.
        nowhere: where a conversion goes that writes no file.
        every: how to get all manipulators of a table.
        run: how to do what a run file says.
    """

    mark: Mark
    reader: str
    format: str
    robot: str
    out: str
    meshes: str
    setting: str
    nowhere: str
    every: str
    run: str


class Setting(NamedTuple):
    """An option of some stage.

    Attributes:
        text: as it was said.
        key: ``frames``, or ``transform.frames`` where it has to be said whose option it is.
        value: its value as a word of the command line; None where there is none.
    """

    text: str
    key: str
    value: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Conversion:
    """What became of one table.

    Attributes:
        manipulator: the table.
        robot: the robot made of it.
        written: what was made by each emitter, in the order in which they were asked for.
    """

    manipulator: Manipulator
    robot: Robot
    written: tuple[Written, ...]

    @property
    def text(self) -> str:
        """The main file of the first format, as text."""
        return self.written[0].files[0].content.decode()

    @property
    def files(self) -> dict[str, bytes]:
        """What stands in every file, by its name."""
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


def convert_table(
    table: Path | Manipulator,
    target: Path | None,
    asker: Asker,
    catalog: Catalog,
    *,
    reader: str | None = None,
    transform: str = DEFAULT_TRANSFORM,
    formats: Sequence[str] = (),
    robot: str | None = None,
    given: Mapping[str, Mapping[str, str | None]] | None = None,
    settings: Iterable[Setting] = (),
    meshes: str | None = None,
    note: Callable[[Sequence[Problem]], None] = lambda _: None,
) -> Conversion:
    """Make a robot description of one table, and prove that it is the same arm.

    Args:
        table: a table's file, or what was read from one.
        target: the file to write; a folder where there are several formats. None writes nothing: each format is then
            one file.
        asker: who asks.
        catalog: the stages that there are.
        reader: name of the reader; without it the table's suffix says it.
        transform: name of the transform.
        formats: names of emitters; without any the suffix of the target says it, else it is URDF.
        robot: which manipulator of a table that holds several.
        given: options by kind of stage, as words.
        settings: further options.
        meshes: how the description names meshes, as `dh2urdf.meshes.prefix_of` takes it.
        note: is told of the notices before anything is written.

    Raises:
        TableError: the table cannot be read, or no robot can be made of it.
        ConfigError: something that was asked for is wrong.
        ManipulatorError: no file could be made, or it is not the arm of the table.
        OutputError: the files cannot be written.
        PluginError: a plugin that is needed is broken, or something it needs is not installed.
    """
    stages: dict[str, list[Any]] = {"reader": []}
    if isinstance(table, Path):
        check_file(table, TableError)
        stages["reader"] = [chosen_reader(catalog, table, reader, asker)]
    else:
        _refuse_choice(asker, {asker.reader: reader, asker.robot: robot})
    stages["transform"] = [catalog.get("transform", transform)]
    if target is not None and len(formats) <= 1 and isdir(target):  # noqa: PTH112 - Path.is_dir raises where a name is too long
        stem = safe_stem(table.name if isinstance(table, Manipulator) else table.stem)
        raise ConfigError(
            Problem(
                message=f"{asker.out}{shown(str(target))} is a folder, and one file is written",
                mark=asker.mark,
                found=str(target),
                accepted=f"a file name, such as {target / stem}.urdf",
            )
        )
    if formats or target is None:
        stages["emitter"] = [catalog.get("emitter", name) for name in formats or (DEFAULT_EMITTER,)]
    else:
        stages["emitter"] = [catalog.emitter_for(target, f"`{asker.format}NAME` chooses an emitter")]
    calls = stage_calls(catalog, stages, asker, given or {}, settings)
    if target is None:
        calls["emitter"] = [_in_one_file(call) for call in calls["emitter"]]
    manipulator = table if isinstance(table, Manipulator) else read_manipulator(calls["reader"][0], table, robot, asker)
    recipe = Recipe(
        transform=calls["transform"][0],
        emitters=tuple(calls["emitter"]),
        poses=POSES,
        mesh_prefix=_mesh_prefix(meshes, target, asker),
    )
    try:
        made = make_robot(manipulator, recipe.transform)
    except (TransformError, RobotError) as error:  # All there is to do is this table, and it is wrong.
        raise TableError(error.problems) from error
    note((*manipulator.notices, *made.notices))
    return Conversion(manipulator=manipulator, robot=made, written=_write(manipulator, made, recipe, target))


def _in_one_file(call: Call[Emitter[Any]]) -> Call[Emitter[Any]]:
    """An emitter with options that make it give a single file."""
    if call.stage.one_file is None:
        return call
    with depending_on(call, "one_file"):
        return replace(call, options=call.stage.one_file(call.options))


def _write(manipulator: Manipulator, robot: Robot, recipe: Recipe, target: Path | None) -> tuple[Written, ...]:
    """The files of a robot, proved and put where they belong: at a file's name, into a folder, or nowhere."""
    truth, stem = Truth.of(manipulator), safe_stem(manipulator.name)
    if target is None:
        with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
            return write_robot(truth, robot, recipe, directory=Path(folder), stem=stem)
    if len(recipe.emitters) > 1:
        return write_robot(truth, robot, recipe, directory=target, stem=stem)
    stem = _stem(target, recipe.emitters[0].stage)
    return write_robot(truth, robot, recipe, directory=target.parent, stem=stem, main_file=target.name)


def _stem(target: Path, emitter: Emitter[Any]) -> str:
    """The stem of a file that a person named: its name without the format's suffix."""
    for suffix in sorted(emitter.suffixes, key=len, reverse=True):
        if target.name.lower().endswith(suffix):
            return target.name[: -len(suffix)] or target.name
    return target.stem


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


# --- Which manipulator ------------------------------------------------------------------------------------------------


def chosen_reader(catalog: Catalog, table: Path, name: str | None, asker: Asker) -> Reader[Any]:
    """The reader that is named, or the one by the table's suffix.

    Raises:
        InputError: there is none, or several are.
        PluginError: it is broken, or two plugins claim its name.
    """
    if name:
        return catalog.get("reader", name)
    return catalog.reader_for(table, f"`{asker.reader}NAME` chooses a reader")


def _refuse_choice(asker: Asker, choices: Mapping[str, str | None]) -> None:
    """Refuses what chooses from a file, or how to read it, where there is no file any more.

    Raises:
        ConfigError: something is chosen.
    """
    for before, word in choices.items():
        if word is not None:
            message = f"{before}{shown(word)} is about a file, and the table is a manipulator already"
            raise ConfigError(Problem(message=message, mark=asker.mark, found=word))


def read_manipulator(call: Call[Reader[Any]], table: Path, robot: str | None, asker: Asker) -> Manipulator:
    """The manipulator of a table that is meant.

    Raises:
        TableError: it cannot be read, there is none, or which of several is not said.
        ConfigError: the file is a run file.
    """
    try:
        return _choose(read_items(call, table), robot, table, asker)
    except TableError:
        from dh2urdf.config import is_run_file  # Reading run files takes modules that a conversion does not need.

        if not is_run_file(table):
            raise
        raise ConfigError(
            Problem(
                message="this is a run file, not a table",
                mark=Mark(file=str(table)),
                suggestion=f"`{asker.run.format(str(table))}` does what it says",
            )
        ) from None


def _choose(items: Iterator[Manipulator | Rejected], robot: str | None, table: Path, asker: Asker) -> Manipulator:
    """The manipulator that is meant.

    Raises:
        TableError: it cannot be read, there is none, or which of several is not said.
    """
    others: list[str] = []
    chosen: Manipulator | Rejected | None = None
    for item in items:
        if robot is None and chosen is not None:
            names = [f"{asker.robot}{shown(name)}" for name in (chosen.name, item.name)]
            raise TableError(
                Problem(
                    message="the table holds several manipulators, and one conversion makes one",
                    mark=Mark(file=str(table)),
                    accepted=f"{asker.robot}NAME, such as {' or '.join(names)}",
                    suggestion=asker.every,
                )
            )
        if robot in (None, item.name):
            chosen = item
            if robot is not None:
                break
        others.append(item.name)
    if isinstance(chosen, Rejected):
        raise TableError(chosen.problems)
    if chosen is None:
        raise TableError(
            Problem(
                message=f"the table holds no manipulator {shown(robot)}" if robot else "the table holds no manipulator",
                mark=Mark(file=str(table)),
                found=robot,
                accepted=", ".join(others[:20]) or None,
                suggestion=did_you_mean(robot or "", others),
            )
        )
    return chosen


# --- Which options ----------------------------------------------------------------------------------------------------


def stage_calls(
    catalog: Catalog,
    stages: Mapping[str, Sequence[Any]],
    asker: Asker,
    given: Mapping[str, Mapping[str, str | None]],
    settings: Iterable[Setting] = (),
) -> dict[str, list[Call[Any]]]:
    """The calls of stages with their options, in the order of the stages of each kind.

    Args:
        catalog: where the stages are from.
        stages: the stages by kind. Those of one kind share what is said: each takes the options that it has.
        asker: who asks.
        given: options by kind; a stage that has no such option is an error.
        settings: options that go to the kind of stage which has them.

    Raises:
        ConfigError: an option is unknown or its value wrong; all of it is said at once.
    """
    words: dict[str, dict[str, str]] = {
        kind: {name: value for name, value in given.get(kind, {}).items() if value is not None} for kind in stages
    }
    known = {kind: {name: None for stage in some for name in _fields(stage)} for kind, some in stages.items()}
    problems: list[Problem] = []
    for text, path, value in settings:
        kind, _, key = path.rpartition(".")
        kinds = [kind] if kind in known else [] if kind else [k for k in known if key in known[k]]
        if value is None or len(kinds) != 1 or key not in known[kinds[0]]:
            keys = [f"{k}.{name}" for k in known for name in known[k]]
            wrong = "has no value" if value is None else "names no option"
            near = None if value is None else did_you_mean(path, [*keys, *(key.partition(".")[2] for key in keys)])
            problems.append(
                Problem(
                    message=f"{asker.setting}{shown(text)} {wrong}",
                    mark=asker.mark,
                    found=text,
                    accepted=f"KEY=VALUE, where KEY is one of {', '.join(keys)}",
                    suggestion=near,
                )
            )
            continue
        words[kinds[0]][key] = value
    calls: dict[str, list[Call[Any]]] = {kind: [] for kind in stages}
    for kind, some in stages.items():
        for stage in some:
            # What no stage of the kind has is left in, for the message that says so.
            foreign = known[kind].keys() - _fields(stage).keys()
            own = {name: word for name, word in words[kind].items() if name not in foreign}
            plugin, where = catalog.plugin_of(stage), f"{kind} {stage.name!r}"
            try:
                options = make_options(stage.options, own, mark=asker.mark, where=where, plugin=plugin)
                calls[kind].append(Call(stage=stage, options=options, plugin=plugin))
            except ConfigError as error:
                problems.extend(error.problems)
    if problems:
        raise ConfigError(problems)
    return calls


def _fields(stage: Any) -> Mapping[str, Any]:  # noqa: ANN401 - a stage of any kind
    fields: Mapping[str, Any] = stage.options.__dataclass_fields__
    return fields
