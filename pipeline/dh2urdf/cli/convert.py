"""`dh2urdf convert`: one table, one robot description."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.cli.answers import answer
from dh2urdf.cli.leaving_out import catalog, without_option
from dh2urdf.cli.tables import ASKER, READER_OPTIONS, settings_of, table_options
from dh2urdf.errors import SCREENFUL
from dh2urdf.single_table import DEFAULT_TRANSFORM, convert_table

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.source import Problem


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
    target = None if output in (None, "-") else Path(str(output))
    conversion = convert_table(
        table,
        target,
        ASKER,
        catalog(),
        reader=reader_name,
        transform=transform_name,
        formats=(format_name,) if format_name else (),
        robot=robot,
        given={
            "reader": {name: flags[name] for name in READER_OPTIONS},
            "transform": {name: flags[name] for name in ("variant", "frames")},
        },
        settings=settings_of(settings),
        meshes=flags["meshes"],
        note=_print_notices,
    )
    if target is None:
        answer(conversion.written[0].files[0].content, nl=False)
    return 0


def _print_notices(notices: Sequence[Problem]) -> None:
    for notice in notices[:SCREENFUL]:
        click.echo(notice, err=True)
    if (more := len(notices) - SCREENFUL) > 0:
        click.echo(f"and {more} more notice{'s' if more > 1 else ''}", err=True)
