"""`dh2urdf convert`: one table, one robot description."""

from __future__ import annotations

import tempfile
from dataclasses import replace
from os.path import isdir
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.attribution import depending_on
from dh2urdf.cli import EXIT_STATUS
from dh2urdf.cli.leaving_out import catalog, without_option
from dh2urdf.cli.tables import (
    COMMAND_LINE,
    READER_OPTIONS,
    chosen_reader,
    read_manipulator,
    stage_calls,
    table_options,
)
from dh2urdf.conversion import Recipe, make_robot, write_robot
from dh2urdf.errors import SCREENFUL, ConfigError, RobotError, TableError, TransformError
from dh2urdf.meshes import FILE, RELATIVE, prefix_of
from dh2urdf.output import safe_stem
from dh2urdf.source import Problem, shown
from dh2urdf.textfiles import check_file
from dh2urdf.truth import Truth

if TYPE_CHECKING:
    from dh2urdf.stages import Emitter

DEFAULT_EMITTER = "urdf"
DEFAULT_TRANSFORM = "alpha-swap"
POSES = 8
"""Random joint vectors of the proof of one conversion [1]; `run` takes more."""


@click.command(name="convert", epilog=EXIT_STATUS)
@click.argument("table", type=click.Path(path_type=Path))
@click.option("-o", "--output", "output", metavar="FILE", help="Where to write; standard output without it.")
@click.option("--to", "format_name", metavar="NAME", help="Format; by FILE's suffix, else urdf.")
@table_options
@click.option("--transform", "transform_name", default=DEFAULT_TRANSFORM, metavar="NAME", help="Transform; alpha-swap.")
@click.option("--variant", metavar="V", help="exact (the arm itself) or paper (the published algorithm).")
@click.option("--frames", metavar="F", help="aligned (link frames parallel to the base) or dh (DH frames).")
@click.option("--meshes", metavar="M", help="relative (copies beside FILE), file (file:// paths) or package://NAME.")
@click.option("--set", "settings", multiple=True, metavar="KEY=VALUE", help="Any other option of a stage.")
@without_option
def command(  # noqa: PLR0917 - click hands everything over by name
    table: Path,
    output: str | None,
    format_name: str | None,
    reader_name: str | None,
    transform_name: str,
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
    installed = catalog()
    target = None if output in (None, "-") else Path(str(output))
    check_file(table, TableError)
    reader = chosen_reader(installed, table, reader_name)
    transform = installed.get("transform", transform_name)
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
        emitter = installed.get("emitter", format_name or DEFAULT_EMITTER)
    else:
        emitter = installed.emitter_for(target)
    given = {
        "reader": {name: flags[name] for name in READER_OPTIONS},
        "transform": {name: flags[name] for name in ("variant", "frames")},
        "emitter": {},
    }
    stages = {"reader": reader, "transform": transform, "emitter": emitter}
    calls = stage_calls(installed, stages, given, settings)
    if target is None and emitter.one_file:
        with depending_on(calls["emitter"], "one_file"):
            calls["emitter"] = replace(calls["emitter"], options=emitter.one_file(calls["emitter"].options))
    manipulator = read_manipulator(calls["reader"], table, robot)
    recipe = Recipe(
        transform=calls["transform"],
        emitters=(calls["emitter"],),
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


def _stem(target: Path, emitter: Emitter[Any]) -> str:
    """The stem of a file that a person named: its name without the format's suffix."""
    for suffix in sorted(emitter.suffixes, key=len, reverse=True):
        if target.name.lower().endswith(suffix):
            return target.name[: -len(suffix)] or target.name
    return target.stem
