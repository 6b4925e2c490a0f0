"""`dh2urdf init`, `example` and `new-plugin`: files to begin with."""

from __future__ import annotations

from pathlib import Path
from shlex import quote
from typing import TYPE_CHECKING, Any, cast

import click

from dh2urdf import scaffold
from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import PATH, catalog, without_option
from dh2urdf.conversion.file_endings import table_writer
from dh2urdf.documents.text_files import is_folder
from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import Convention
from dh2urdf.plugin_system.calls import default_call
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from dh2urdf.stages import Kind

say = Messages(__file__)

DEFAULT_AXES, _AXES = 6, click.IntRange(1, scaffold.MOST_AXES)
_EITHER = click.Choice([str(convention) for convention in Convention])


@click.command(name="init")
@click.argument("file", type=PATH, default="arm.csv")
@click.option("--convention", type=_EITHER, default="standard", metavar="C", help="standard or modified; standard.")
@click.option("--axes", type=_AXES, metavar="N", help=f"How many joints; {DEFAULT_AXES}.")
@click.option("--joints", metavar="A,B,C", help="Their names; joint_1, joint_2 and so on.")
@click.option("--name", default="", metavar="NAME", help="The manipulator's name; that of FILE.")
@click.option("--run", "run_file", type=PATH, metavar="RUN", help="Also write a run file for it.")
@without_option
def init(  # noqa: PLR0917 - click hands everything over by name
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
        raise _wrong("axes-contradict", axes=axes, count=len(names))
    if len(names) > scaffold.MOST_AXES:
        raise _wrong("too-many-joints", count=len(names), most=scaffold.MOST_AXES)
    if run_file is not None and str(run_file).casefold() == str(file).casefold():
        raise _wrong("same-name-twice", found=str(run_file))
    names = names or [f"joint_{number}" for number in range(1, (axes or DEFAULT_AXES) + 1)]
    installed = catalog()
    call = default_call(installed, table_writer(installed, file, COMMAND_LINE))
    files = {file: scaffold.table_template(call, Convention(convention), names, name, file)}
    if run_file is not None:
        files[run_file] = scaffold.run_template(file, run_file)
    scaffold.write_new(files)
    table = quote(str(file))
    following = [f"dh2urdf info {table}", f"dh2urdf convert {table} -o {quote(f'{file.stem}.urdf')}"]
    following += [] if run_file is None else [f"dh2urdf run {quote(str(run_file))}"]
    answer("\n".join([*map(str, files), "", "next:", *(f"    {line}" for line in following)]))
    return 0


@click.command(name="example")
@click.argument("name", required=False)
@click.option("-o", "--output", "output", metavar="FILE", help="File to write, or folder; standard output without it.")
@click.option("--list", "listed", is_flag=True, help="List the arms.")
def example(name: str | None, output: str | None, *, listed: bool) -> int:
    """Print the table of the arm NAME, one of those that dh2urdf ships; list them without a NAME.

    No file is overwritten.

    \b
    dh2urdf example --list
    dh2urdf example ur5 -o ur5.csv
    dh2urdf example panda | dh2urdf convert - > panda.urdf
    """
    if listed or name is None:
        if output:
            raise _wrong("list-is-printed", found=output)
        tables = scaffold.shipped_tables()
        width = max(map(len, tables), default=0)
        for each, path in tables.items():
            answer(f"{each.ljust(width)}  {path.read_text('utf-8').splitlines()[0].strip('# ').rstrip('.')}")
        return 0
    table = scaffold.shipped_table(name)
    if output is None or output == "-":
        answer(table.read_bytes(), nl=False)
        return 0
    target = Path(output)
    if is_folder(target) or output.endswith("/"):
        target /= table.name
    if target.suffix.lower() != table.suffix:
        raise _wrong("example-of-other-format", found=output, suffix=table.suffix, target=target.name, name=table.name)
    scaffold.write_new({target: table.read_bytes()})
    answer(str(target))
    return 0


@click.command(name="new-plugin")
@click.argument("name")
@click.option("--kind", required=True, type=click.Choice(KINDS), metavar="KIND", help=f"One of {', '.join(KINDS)}.")
@click.option("--dir", "folder", type=PATH, default=".", metavar="D", help="Where its folder is made.")
@click.option("--minimal", is_flag=True, help="A module with the stage, its contract test, and what installs it.")
@without_option
def new_plugin(name: str, kind: str, folder: Path, *, minimal: bool) -> int:
    """Write a small distribution NAME with one working stage, its tests, and all that goes with it.

    It installs, passes its own tests, ruff and mypy --strict, and is listed by `dh2urdf plugins`, at once. NAME is that
    of the folder and of the distribution; the stage has the same, without a dh2urdf- at its beginning.

    \b
    dh2urdf new-plugin dh2urdf-lab-table --kind reader
    cd dh2urdf-lab-table
    pip install -e '.[test]' && pytest
    """
    place, files = scaffold.write_plugin(name, cast("Kind", kind), folder, catalog(), minimal=minimal)
    answer("\n".join(f"{place / file}" for file in files))
    answer(f"\nnext:\n    cd {quote(str(place))}\n    pip install -e '.[test]' && pytest\n    dh2urdf plugins")
    return 0


def _wrong(code: str, found: str | None = None, **values: Any) -> ConfigError:  # noqa: ANN401 - of a message
    return ConfigError(say(code, COMMAND_LINE, found=found, **values))
