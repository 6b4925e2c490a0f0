"""The commands ``studio`` and ``view``: a page where a table is typed and the arm moves beside it, and one of robots.

What they show is thought out in modules that know no browser: tables and their edits (`edits`, `conversions`), the
readers' answers (`reading`), what is to be drawn (`scene`), what is handed over (`save`), a tab's state (`tab`,
`session`, `viewing`). `scene_page`, with `page` and `view_page`, `widgets` and `server` put it on the screen, with
NiceGUI, which the extra ``dh2urdf[studio]`` installs; nothing outside them imports it.
"""

from __future__ import annotations

from dh2urdf.hookspecs import hookimpl
from dh2urdf.stages import Subcommand


@hookimpl
def dh2urdf_commands() -> tuple[Subcommand, ...]:
    """``studio`` and ``view``."""
    return (
        Subcommand(
            name="studio",
            summary="Type a table in the browser, see the arm move, press Generate.",
            function="dh2urdf_studio.commands:studio",
            behind="collisions",
        ),
        Subcommand(
            name="view",
            summary="Show robots of URDF, xacro, tables and cells in the browser.",
            function="dh2urdf_studio.commands:view",
            behind="studio",
        ),
    )
