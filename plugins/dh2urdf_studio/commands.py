"""`dh2urdf studio` and `dh2urdf view`: pages in the browser, served from this machine to itself."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.cli.answers import answer
from dh2urdf.cli.convert import print_notices
from dh2urdf.cli.shared_options import PATH, catalog, files_and_arguments, option, package_paths_option, without_option
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Mark, Messages, did_you_mean

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path


say = Messages(__file__)


def serving_options(command: Callable[..., int]) -> Callable[..., int]:
    """The options of every command that serves a page."""
    for each in (
        without_option,
        option("--no-browser", is_flag=True, help="Do not open the page in the browser."),
        option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS", help="Address to listen at."),
        option("--port", type=click.IntRange(0, 65535), metavar="P", help="Port; 8420 or a free one without it."),
    ):
        command = each(command)
    return command


@click.command(name="studio", epilog=EXIT_STATUS)
@click.argument("table", type=PATH, required=False)
@option("--robot", metavar="NAME", help="Which manipulator of a table that holds several.")
@option("--edit", "edits", multiple=True, metavar="YAML", help="A change of the arm, as for convert; repeatable.")
@serving_options
def studio(  # noqa: PLR0917 - click hands options over so
    table: Path | None,
    robot: str | None,
    edits: tuple[str, ...],
    port: int | None,
    host: str,
    no_browser: bool,  # noqa: FBT001 - as above
) -> int:
    """Type a DH table, see the arm move, press Generate: a page in the browser, served from this machine to itself.

    TABLE is opened where it is given; the file itself is not changed. The address of the page is printed; Ctrl-C ends
    the studio.

    \b
    dh2urdf studio
    dh2urdf studio ur5.csv --port 9000 --no-browser
    dh2urdf studio ur5.csv --edit 'attach: {file: hand.urdf, name: hand}'
    """
    from dh2urdf.commands.choices import edit_calls
    from dh2urdf.documents.text_files import check_file
    from dh2urdf.errors import TableError
    from dh2urdf_studio.editing.opening import open_tables
    from dh2urdf_studio.server import require_nicegui, serve
    from dh2urdf_studio.words import remarks

    require_nicegui("studio")
    installed = catalog()
    edit_calls(edits, COMMAND_LINE, installed)
    opened = None
    if table is not None:
        check_file(table, TableError)
        tables = open_tables(table, installed, wanted=robot)
        names = [each.table.name for each in tables]
        if robot not in names and (robot is not None or len(tables) > 1):
            code = "several-manipulators" if robot is None else "manipulator-unknown"
            near = did_you_mean(robot, names) if robot else None
            raise TableError(say(code, Mark(file=str(table)), found=robot, names=names[:20], suggestion=near))
        chosen = tables[names.index(robot) if robot is not None else 0]
        opened = chosen.table
        for remark in remarks(chosen):
            click.echo(remark, err=True)
    from dh2urdf_studio.app import build_studio

    def build(is_open: bool) -> None:  # noqa: FBT001 - the server calls it so
        build_studio(installed, opened, edits, may_edit=not is_open)

    serve(build, host, port, answer, "dh2urdf studio", browser=not no_browser)
    return 0


@click.command(name="view", epilog=EXIT_STATUS)
@click.argument("files", nargs=-1, required=True, metavar="FILE… [NAME:=VALUE]…")
@package_paths_option
@serving_options
def view(files: tuple[str, ...], package_paths: tuple[Path, ...], port: int | None, host: str, no_browser: bool) -> int:  # noqa: FBT001 - click hands flags over so
    """Show robots in the browser: sliders, joint axes, frames, collision shapes.

    A FILE is a robot description that an emitter reads back (URDF, xacro), a table, or a run file, of which the cells
    are shown, or the arms where it has none. Several are shown in one scene. The address of the page is printed;
    Ctrl-C ends it. A xacro is expanded as by `dh2urdf check`, with the values that NAME:=VALUE gives to its arguments.
    Programs of this machine can move the joints: POST joint values to /set_joint_positions.

    \b
    dh2urdf view ur5.urdf
    dh2urdf view ur5.csv panda.yaml robot.urdf.xacro
    dh2urdf view pair.yaml
    dh2urdf view ur.urdf.xacro ur_type:=ur10 --package-path ~/ws/src
    """
    from dh2urdf.stages import Expansion
    from dh2urdf_studio.drawing.mesh_files import MeshStore
    from dh2urdf_studio.server import require_nicegui, serve
    from dh2urdf_studio.viewing import View, load_figures

    require_nicegui("view")
    paths, arguments = files_and_arguments(files)
    figures = load_figures(paths, catalog(), Expansion(arguments=arguments, package_paths=package_paths))
    print_notices([notice for figure in figures for notice in figure.notices])
    first = View(figures)
    with closing(MeshStore(first.meshes())) as meshes:
        meshes.begin(first.drawing.first_meshes)  # while the server starts
        from dh2urdf_studio.app import build_view

        serve(lambda _: build_view(first, meshes), host, port, answer, "dh2urdf view", browser=not no_browser)
    return 0
