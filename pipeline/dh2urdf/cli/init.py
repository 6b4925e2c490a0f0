"""`dh2urdf init`: the beginning of a table."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING

import click

from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import PATH, catalog, option, without_option
from dh2urdf.conversion.file_endings import table_writer
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import Convention
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.scaffold.tables import MOST_AXES, run_template, table_template, write_new
from dh2urdf.source import Problem
from dh2urdf.stage_calls.calls import default_call

if TYPE_CHECKING:
    from pathlib import Path

DEFAULT_FILE = "arm.csv"
DEFAULT_AXES = 6


@click.command(name="init")
@click.argument("file", type=PATH, default=DEFAULT_FILE)
@option(
    "--convention",
    type=click.Choice([str(convention) for convention in Convention]),
    default=str(Convention.STANDARD),
    metavar="C",
    help="standard or modified; standard.",
)
@option("--axes", type=click.IntRange(1, MOST_AXES), metavar="N", help=f"How many joints; {DEFAULT_AXES}.")
@option("--joints", metavar="A,B,C", help="Their names; joint_1, joint_2 and so on.")
@option("--name", default="", metavar="NAME", help="The manipulator's name; that of FILE.")
@option("--run", "run_file", type=PATH, metavar="RUN", help="Also write a run file for it.")
@without_option
def command(  # noqa: PLR0917 - click hands everything over by name
    file: Path, convention: str, axes: int | None, joints: str | None, name: str, run_file: Path | None
) -> int:
    """Write the beginning of a table to FILE, arm.csv by default: comments, and rows that can be converted at once.

    FILE's suffix chooses the format, such as .csv or .yaml. No file is overwritten.

    \b
    dh2urdf init
    dh2urdf init panda.yaml --convention modified --axes 7
    dh2urdf init arm.csv --joints waist,shoulder,elbow --run run.yaml
    """
    names = [word.strip() for word in joints.split(",")] if joints is not None else []
    if joints is not None and axes not in (None, len(names)):
        message = f"--axes {axes} and --joints, which names {len(names)}, contradict each other"
        raise ConfigError(Problem(message=message, mark=COMMAND_LINE, accepted="one of the two"))
    if len(names) > MOST_AXES:
        message = f"--joints names {len(names)} joints"
        raise ConfigError(Problem(message=message, mark=COMMAND_LINE, accepted=f"at most {MOST_AXES}"))
    names = names or [f"joint_{number}" for number in range(1, (axes or DEFAULT_AXES) + 1)]
    installed = catalog()
    call = default_call(installed, table_writer(installed, file, COMMAND_LINE))
    content = table_template(call, Convention(convention), names, name, file)
    files = {file: content}
    if run_file is not None:
        if str(run_file).casefold() == str(file).casefold():
            message = "the table and the run file have the same name"
            raise ConfigError(Problem(message=message, mark=COMMAND_LINE, field="--run", found=str(run_file)))
        files[run_file] = run_template(file, run_file)
    write_new(files)
    answer("\n".join(map(str, files)))
    table = shlex.quote(str(file))
    answer(f"\nnext:\n    dh2urdf info {table}\n    dh2urdf convert {table} -o {shlex.quote(f'{file.stem}.urdf')}")
    if run_file is not None:
        answer(f"    dh2urdf run {shlex.quote(str(run_file))}")
    return 0
