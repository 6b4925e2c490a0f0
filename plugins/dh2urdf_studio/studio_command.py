"""`dh2urdf studio`: a page in the browser where a table is typed and the arm moves beside it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import PATH, catalog, option, without_option
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf_studio.editing.opening import Opened

say = Messages(__file__)


@click.command(name="studio", epilog=EXIT_STATUS)
@click.argument("table", type=PATH, required=False)
@option("--robot", metavar="NAME", help="Which manipulator of a table that holds several.")
@option("--port", type=click.IntRange(0, 65535), metavar="P", help="Port; 8420 or a free one without it.")
@option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS", help="Address to listen at.")
@option("--no-browser", is_flag=True, help="Do not open the page in the browser.")
@without_option
def command(table: Path | None, robot: str | None, port: int | None, host: str, no_browser: bool) -> int:  # noqa: FBT001 - click hands flags over so
    """Type a DH table, see the arm move, press Generate: a page in the browser, served from this machine to itself.

    TABLE is opened where it is given; the file itself is not changed. The address of the page is printed; Ctrl-C ends
    the studio.

    \b
    dh2urdf studio
    dh2urdf studio ur5.csv --port 9000 --no-browser
    """
    from dh2urdf.documents.text_files import check_file
    from dh2urdf.errors import TableError
    from dh2urdf_studio.editing.opening import open_tables
    from dh2urdf_studio.server import require_nicegui, serve
    from dh2urdf_studio.words import remarks

    require_nicegui("studio")
    installed = catalog()
    opened = None
    if table is not None:
        check_file(table, TableError)
        chosen = _chosen(open_tables(table, installed, wanted=robot), robot, table)
        opened = chosen.table
        for remark in remarks(chosen):
            click.echo(remark, err=True)
    from dh2urdf_studio.app import build_studio

    serve(
        lambda: build_studio(installed, opened),
        host=host,
        port=port,
        browser=not no_browser,
        report=answer,
        title="dh2urdf studio",
    )
    return 0


def _chosen(tables: tuple[Opened, ...], robot: str | None, path: Path) -> Opened:
    """The manipulator that is meant.

    Raises:
        TableError: there is none of the name, or which of several is not said.
    """
    from dh2urdf.errors import TableError
    from dh2urdf.source import Mark, did_you_mean

    names = [opened.table.name for opened in tables]
    if robot is None and len(tables) == 1:
        return tables[0]
    if robot in names:
        return tables[names.index(robot)]
    code = "several-manipulators" if robot is None else "manipulator-unknown"
    near = did_you_mean(robot, names) if robot else None
    raise TableError(say(code, Mark(file=str(path)), found=robot, names=names[:20], suggestion=near))
