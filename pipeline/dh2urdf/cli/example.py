"""`dh2urdf example`: the tables of known arms."""

from __future__ import annotations

from pathlib import Path

import click

from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import option
from dh2urdf.documents.text_files import is_folder
from dh2urdf.errors import ConfigError
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.scaffold.tables import shipped_table, shipped_tables, write_new
from dh2urdf.source import Problem, shown


@click.command(name="example")
@click.argument("name", required=False)
@option("-o", "--output", "output", metavar="FILE", help="File to write, or folder; standard output without it.")
@option("--list", "listed", is_flag=True, help="List the arms.")
def command(name: str | None, output: str | None, listed: bool) -> int:  # noqa: FBT001 - click hands flags over so
    """Print the table of the arm NAME, one of those that dh2urdf ships; list them without a NAME.

    No file is overwritten.

    \b
    dh2urdf example --list
    dh2urdf example ur5 -o ur5.csv
    dh2urdf example panda | dh2urdf convert - > panda.urdf
    """
    if output and (listed or name is None):
        message = "a list of the arms is printed, and not written to a file"
        raise ConfigError(Problem(message=message, mark=COMMAND_LINE, found=output, accepted="NAME -o FILE"))
    if listed or name is None:
        tables = shipped_tables()
        width = max(map(len, tables), default=0)
        for each, path in tables.items():
            answer(f"{each.ljust(width)}  {path.read_text('utf-8').splitlines()[0].strip('# ').rstrip('.')}")
        return 0
    table = shipped_table(name)
    if output in (None, "-"):
        answer(table.read_bytes(), nl=False)
        return 0
    target = Path(str(output))
    if is_folder(target) or str(output).endswith("/"):
        target /= table.name
    if target.suffix.lower() != table.suffix:
        message = f"the table is a {table.suffix} file, and {shown(target.name)} says another format"
        raise ConfigError(
            Problem(message=message, mark=COMMAND_LINE, field="-o", found=str(output), accepted=f"-o {table.name}")
        )
    write_new({target: table.read_bytes()})
    answer(str(target))
    return 0
