"""`dh2urdf view`: robots of any kind of file in one scene in the browser."""

from __future__ import annotations

from contextlib import closing
from typing import TYPE_CHECKING

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.cli.answers import answer
from dh2urdf.cli.convert import print_notices
from dh2urdf.cli.shared_options import catalog, files_and_arguments, option, package_paths_option, without_option

if TYPE_CHECKING:
    from pathlib import Path


@click.command(name="view", epilog=EXIT_STATUS)
@click.argument("files", nargs=-1, required=True, metavar="FILE… [NAME:=VALUE]…")
@package_paths_option
@option("--port", type=click.IntRange(0, 65535), metavar="P", help="Port; 8420 or a free one without it.")
@option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS", help="Address to listen at.")
@option("--no-browser", is_flag=True, help="Do not open the page in the browser.")
@without_option
def command(
    files: tuple[str, ...],
    package_paths: tuple[Path, ...],
    port: int | None,
    host: str,
    no_browser: bool,  # noqa: FBT001 - click hands flags over so
) -> int:
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
    from dh2urdf_studio.drawing.mesh_store import MeshStore
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

        serve(
            lambda: build_view(first, meshes),
            host=host,
            port=port,
            browser=not no_browser,
            report=answer,
            title="dh2urdf view",
        )
    return 0
