"""`dh2urdf convert`: tables into robot descriptions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import PATH, catalog, option, without_option
from dh2urdf.cli.stage_flags import StageCommand, given_options
from dh2urdf.cli.standard_input import DASH, files_behind, given_table
from dh2urdf.cli.tables import ASKER, settings_of, table_options
from dh2urdf.commands.convert import plan_conversion
from dh2urdf.documents.text_files import is_folder
from dh2urdf.errors import SCREENFUL
from dh2urdf.report.answers.conversions import closing_line

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.commands.convert import Conversion, Planned
    from dh2urdf.source import Problem

STANDARD_OUTPUT = "standard output"


@click.command(name="convert", cls=StageCommand, kinds=("reader", "transform", "emitter"), epilog=EXIT_STATUS)
@click.argument("tables", type=PATH, nargs=-1, required=True, metavar="TABLE…")
@option(
    "-o", "--output", "output", metavar="FILE", help="File to write, or folder; standard output without the option."
)
@option("--to", "format_name", metavar="NAME", help="Format; by FILE's suffix, else urdf.")
@table_options
@option("--transform", "transform_name", metavar="NAME", help="Transform; the usual one.")
@option(
    "--edit", "edits", multiple=True, metavar="YAML", help="'payload: {mass: 2.5}', a change of the arm; repeatable."
)
@option("--meshes", metavar="M", help="relative (copies beside FILE), file (file:// paths) or package://NAME.")
@option("--convert-meshes", metavar="C", help="auto (OBJ), hull or decomposition (OBJ, and what touches is convex).")
@option("--set", "settings", multiple=True, metavar="KEY=VALUE", help="Any other option of a stage.")
@option(
    "--json",
    "as_json",
    is_flag=True,
    help="Print what became of the tables as JSON; without -o with the description in it.",
)
@option("-q", "--quiet", is_flag=True, help="Say only what fails.")
@without_option
def command(  # noqa: PLR0917 - click hands everything over by name
    tables: tuple[Path, ...],
    output: str | None,
    format_name: str | None,
    reader_name: str | None,
    transform_name: str | None,
    robot: str | None,
    edits: tuple[str, ...],
    settings: tuple[str, ...],
    as_json: bool,  # noqa: FBT001 - click hands flags over so
    quiet: bool,  # noqa: FBT001
    **flags: str | None,
) -> int:
    """Turn TABLE into a robot description and prove that it is the same arm.

    The reader goes by TABLE's suffix, such as .csv or .yaml, the format by FILE's, such as .urdf or .xacro. A xacro
    has its macro in a file beside FILE; on standard output both are one. TABLE may be -, which is standard input;
    `--from` then says its format. Several tables go into a folder, each as a file of the table's name: one that fails
    does not stop the others. The last line on standard error says how far the description is from the table, and what
    was filled in. `dh2urdf plugins` lists all stages and their options.

    \b
    dh2urdf convert ur5.csv -o ur5.urdf
    dh2urdf convert panda.csv --convention modified --angle-unit deg > panda.urdf
    dh2urdf convert ur5.csv -o ur5.urdf.xacro --frames dh
    dh2urdf convert arms.csv --robot ur10 --set shape=box --set density=1500
    dh2urdf convert tables/*.csv -o build --to sdf
    my-program | dh2urdf convert - --from csv -o arm.urdf
    """
    installed = catalog()
    target = None if output is None or output == DASH else Path(output)
    into_folder = target is not None and (str(output).endswith("/") or is_folder(target))

    def plan(table: Path, file: Path | None) -> Planned:
        path, reader = given_table(table, reader_name, installed)
        return plan_conversion(
            path,
            file,
            ASKER,
            installed,
            reader=reader,
            transform=transform_name,
            formats=(format_name,) if format_name else (),
            robot=robot,
            given=given_options(flags),
            settings=settings_of(settings),
            meshes=flags["meshes"],
            convert_meshes=flags["convert_meshes"],
            edits=edits,
            inputs=files_behind(tables),
        )

    def note(notices: Sequence[Problem]) -> None:
        if not quiet:
            print_notices(notices)

    def said(conversion: Conversion, file: Path | None) -> None:
        if not quiet:
            place = STANDARD_OUTPUT if file is None else str(file)
            click.echo(closing_line(conversion, place), err=True)

    if len(tables) > 1 or into_folder:
        from dh2urdf.cli.several_tables import convert_several, files_of

        return convert_several(files_of(tables, target, format_name, installed), plan, note, said, as_json=as_json)
    conversion = plan(tables[0], target).carry_out(note)
    if as_json:
        from dh2urdf.cli.printing.conversion_rows import print_report, row_of

        print_report([row_of(conversion, tables[0], target)])
    elif target is None:
        answer(conversion.written[0].files[0].content, nl=False)
    said(conversion, target)
    return 0


def print_notices(notices: Sequence[Problem]) -> None:
    """Print a screenful of notices on standard error, and how many more there are."""
    for notice in notices[:SCREENFUL]:
        click.echo(notice, err=True)
    if (more := len(notices) - SCREENFUL) > 0:
        click.echo(f"and {more} more notice{'s' if more > 1 else ''}", err=True)
