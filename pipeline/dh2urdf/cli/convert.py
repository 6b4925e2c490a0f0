"""`dh2urdf convert`: one table, one robot description."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from os.path import isdir
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.conversion import Call, Recipe, make_robot, read_items, write_robot
from dh2urdf.errors import SCREENFUL, ConfigError, RobotError, TableError, TransformError
from dh2urdf.meshes import FILE, RELATIVE, prefix_of
from dh2urdf.options import make_options
from dh2urdf.output import safe_stem
from dh2urdf.registry import load
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.stages import Emitter, Rejected
from dh2urdf.textfiles import check_file
from dh2urdf.truth import Truth

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.manipulator import Manipulator

COMMAND_LINE = Mark(file="command line")
DEFAULT_EMITTER = "urdf"
DEFAULT_TRANSFORM = "alpha-swap"
POSES = 8
"""Random joint vectors of the proof of one conversion [1]; `run` takes more."""


@click.command(name="convert", epilog=EXIT_STATUS)
@click.argument("table", type=click.Path(path_type=Path))
@click.option("-o", "--output", "output", metavar="FILE", help="Where to write; standard output without it.")
@click.option("--to", "format_name", metavar="NAME", help="Format; by FILE's suffix, else urdf.")
@click.option("--robot", metavar="NAME", help="Which manipulator of a table that holds several.")
@click.option("--convention", metavar="C", help="standard or modified, where the table does not say it.")
@click.option("--length-unit", metavar="UNIT", help="Unit of lengths without one: m, cm or mm.")
@click.option("--angle-unit", metavar="UNIT", help="Unit of angles without one: rad or deg.")
@click.option("--base", metavar="YAML", help='base_link to the first DH frame: "{xyz: [0, 0, 0.3], rpy: [0, 0, pi]}".')
@click.option("--tool", metavar="YAML", help="Last DH frame to tool0, like --base.")
@click.option("--variant", metavar="V", help="exact (the arm itself) or paper (the published algorithm).")
@click.option("--frames", metavar="F", help="aligned (link frames parallel to the base) or dh (DH frames).")
@click.option("--meshes", metavar="M", help="relative (copies beside FILE), file (file:// paths) or package://NAME.")
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", help="Any other option of a stage.")
def command(
    table: Path,
    output: str | None,
    format_name: str | None,
    robot: str | None,
    settings: tuple[str, ...],
    **flags: str | None,
) -> int:
    """Turn TABLE into a robot description and prove that it is the same arm.

    The reader goes by TABLE's suffix, such as .csv or .yaml, the format by FILE's, such as .urdf or .xacro. A xacro
    has its macro in a file beside FILE; on standard output both are one. `dh2urdf plugins` lists all stages and their
    options.

    \b
    dh2urdf convert ur5.csv -o ur5.urdf
    dh2urdf convert panda.csv --convention modified --angle-unit deg > panda.urdf
    dh2urdf convert ur5.csv -o ur5.urdf.xacro --frames dh
    dh2urdf convert arms.csv --robot ur10 --set shape=box --set density=1500
    """
    catalog = load()
    target = None if output in (None, "-") else Path(str(output))
    check_file(table, TableError)
    reader = catalog.reader_for(table)
    transform = catalog.get("transform", DEFAULT_TRANSFORM)
    if target is not None and isdir(target):  # noqa: PTH112 - Path.is_dir raises where a name is too long
        raise ConfigError(
            Problem(
                message=f"-o {shown(str(target))} is a folder, and one file is written",
                mark=COMMAND_LINE,
                found=output,
                accepted=f"a file name, such as {target / safe_stem(table.stem)}.urdf",
            )
        )
    if format_name or target is None:
        emitter = catalog.get("emitter", format_name or DEFAULT_EMITTER)
    else:
        emitter = catalog.emitter_for(target)
    given = {
        "reader": {name: flags[name] for name in ("convention", "length_unit", "angle_unit", "base", "tool")},
        "transform": {name: flags[name] for name in ("variant", "frames")},
        "emitter": {},
    }
    stages = {"reader": reader, "transform": transform, "emitter": emitter}
    options = _options(stages, given, settings)
    if target is None and emitter.one_file:
        options["emitter"] = emitter.one_file(options["emitter"])
    try:
        manipulator = _choose(read_items(reader, table, options["reader"]), robot, table)
    except TableError:
        from dh2urdf.config import is_run_file  # Reading run files takes modules that a conversion does not need.

        if not is_run_file(table):
            raise
        raise ConfigError(
            Problem(
                message="this is a run file, not a table",
                mark=Mark(file=str(table)),
                suggestion=f"`dh2urdf run {table}` does what it says",
            )
        ) from None
    recipe = Recipe(
        transform=Call(stage=transform, options=options["transform"]),
        emitters=(Call(stage=emitter, options=options["emitter"]),),
        poses=POSES,
        mesh_prefix=_mesh_prefix(flags["meshes"], target),
    )
    try:
        made = make_robot(manipulator, recipe.transform)
    except (TransformError, RobotError) as error:  # All there is to do is this table, and it is wrong.
        raise TableError(error.problems) from error
    notices = (*manipulator.notices, *made.notices)
    for notice in notices[:SCREENFUL]:
        click.echo(notice, err=True)
    if (more := len(notices) - SCREENFUL) > 0:
        click.echo(f"and {more} more notice{'s' if more > 1 else ''}", err=True)
    truth = Truth.of(manipulator)
    if target is not None:
        stem = _stem(target, emitter)
        write_robot(truth, made, recipe, directory=target.parent, stem=stem, main_file=target.name)
        return 0
    with tempfile.TemporaryDirectory(prefix="dh2urdf-") as folder:
        written = write_robot(truth, made, recipe, directory=Path(folder), stem=safe_stem(manipulator.name))
        click.echo((Path(folder) / written[0].files[0].name).read_bytes(), nl=False)
    return 0


def _mesh_prefix(word: str | None, target: Path | None) -> str | None:
    """What the description writes before the names of meshes; on standard output it has nothing beside it.

    Raises:
        ConfigError: the word means nothing, or copies would lie nowhere.
    """
    try:
        prefix = prefix_of(word or (FILE if target is None else RELATIVE))
    except ConfigError as error:
        raise ConfigError(replace(problem, mark=COMMAND_LINE) for problem in error.problems) from None
    if target is None and prefix is not None:
        message = f"--meshes {word} copies meshes beside a file, and this goes to standard output"
        raise ConfigError(Problem(message=message, mark=COMMAND_LINE, found=word, accepted="-o FILE, or --meshes file"))
    return prefix


def _choose(items: Iterator[Manipulator | Rejected], robot: str | None, table: Path) -> Manipulator:
    """The manipulator that is meant.

    Raises:
        TableError: it cannot be read, there is none, or which of several is not said.
    """
    others: list[str] = []
    chosen: Manipulator | Rejected | None = None
    for item in items:
        if robot is None and chosen is not None:
            raise TableError(
                Problem(
                    message="the table holds several manipulators, and one conversion makes one",
                    mark=Mark(file=str(table)),
                    accepted=f"--robot NAME, such as --robot {shown(chosen.name)} or --robot {shown(item.name)}",
                    suggestion="`dh2urdf run` with a run file makes all of them",
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


def _options(
    stages: dict[str, Any], given: dict[str, dict[str, str | None]], settings: tuple[str, ...]
) -> dict[str, Any]:
    """The options of every stage, from the flags and from --set.

    `--set key=value` goes to the stage that has the option; `--set transform.key=value` says which.

    Raises:
        ConfigError: an option is unknown or its value wrong; all of it is said at once.
    """
    words: dict[str, dict[str, Any]] = {
        kind: {name: value for name, value in flags.items() if value is not None} for kind, flags in given.items()
    }
    known = {kind: stage.options.__dataclass_fields__ for kind, stage in stages.items()}
    problems: list[Problem] = []
    for setting in settings:
        path, equals, value = setting.partition("=")
        kind, _, key = path.strip().rpartition(".")
        kinds = [kind] if kind in known else [] if kind else [k for k in known if key in known[k]]
        if not equals or len(kinds) != 1 or key not in known[kinds[0]]:
            keys = [f"{k}.{name}" for k in known for name in known[k]]
            wrong = "names no option" if equals else "has no value"
            near = did_you_mean(path, [*keys, *(key.partition(".")[2] for key in keys)]) if equals else None
            problems.append(
                Problem(
                    message=f"--set {shown(setting)} {wrong}",
                    mark=COMMAND_LINE,
                    found=setting,
                    accepted=f"KEY=VALUE, where KEY is one of {', '.join(keys)}",
                    suggestion=near,
                )
            )
            continue
        words[kinds[0]][key] = value.strip()
    options: dict[str, Any] = {}
    for kind, stage in stages.items():
        try:
            options[kind] = make_options(stage.options, words[kind], mark=COMMAND_LINE, where=f"{kind} {stage.name!r}")
        except ConfigError as error:
            problems.extend(error.problems)
    if problems:
        raise ConfigError(problems)
    return options


def _stem(target: Path, emitter: Emitter[Any]) -> str:
    """The stem of a file that a person named: its name without the format's suffix."""
    for suffix in sorted(emitter.suffixes, key=len, reverse=True):
        if target.name.lower().endswith(suffix):
            return target.name[: -len(suffix)] or target.name
    return target.stem
