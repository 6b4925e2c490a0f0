"""What the commands that take one table share: its options, and how messages speak of them."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.commands.options_of_stages import Asker, Setting
from dh2urdf.plugin_system.options import COMMAND_LINE

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable
    from typing import TypeVar

    F = TypeVar("F", bound=Callable[..., Any])

READER_OPTIONS = ("convention", "length_unit", "angle_unit", "units", "base", "tool", "payload", "calibration")
"""The options of readers that have a flag of their own."""
CHAIN_OPTIONS = ("base_link", "tip_link")
"""The same of readers of robot descriptions."""


def _run_command(path: str) -> str:
    import shlex

    return f"dh2urdf run {shlex.quote(path)}"


ASKER = Asker(
    mark=COMMAND_LINE,
    reader="--from ",
    format="--to ",
    robot="--robot ",
    out="-o ",
    meshes="--meshes ",
    convert_meshes="--convert-meshes ",
    setting="--set ",
    nowhere="this goes to standard output",
    every="`dh2urdf run` with a run file makes all of them",
    run=_run_command,
)


def table_options(function: F) -> F:
    """Gives a command the flags that say what a table leaves out."""
    for option in reversed(
        (
            click.option("--from", "reader_name", metavar="NAME", help="Reader of TABLE; by its suffix."),
            click.option("--robot", metavar="NAME", help="Which manipulator of a table that holds several."),
            click.option("--convention", metavar="C", help="standard or modified, where the table does not say it."),
            click.option("--length-unit", metavar="UNIT", help="Unit of lengths without one: m, cm or mm."),
            click.option("--angle-unit", metavar="UNIT", help="Unit of angles without one: rad or deg."),
            click.option(
                "--units", metavar="YAML", help='By what they measure: "{length: mm, inertia: kg·mm²}", "mm, deg".'
            ),
            click.option(
                "--base",
                metavar="YAML",
                help='base_link to the first DH frame: "{xyz: [0, 0, 0.3], rpy: [0, 0, pi]}".',
            ),
            click.option("--tool", metavar="YAML", help="Last DH frame to tool0, like --base."),
            click.option("--payload", metavar="YAML", help='What the arm carries: "{mass: 2.5, com: [0, 0, 0.05]}".'),
            click.option(
                "--calibration", metavar="FILE", help="Differences to the rows: a calibration.conf, or a table of them."
            ),
        )
    ):
        function = option(function)
    return function


def chain_options(function: F) -> F:
    """Gives a command the flags that say which chain of a robot description is meant."""
    for option in (
        click.option("--tip-link", metavar="LINK", help="Where the chain of a robot description ends; by usual names."),
        click.option("--base-link", metavar="LINK", help="Where the chain of a robot description begins; the root."),
    ):
        function = option(function)
    return function


package_paths_option = click.option(
    "--package-path",
    "package_paths",
    type=click.Path(path_type=Path),
    multiple=True,
    metavar="DIR",
    help="A ROS package, or a folder of packages, whose files a xacro may include or meshes are in; repeatable.",
)


def settings_of(words: Iterable[str]) -> list[Setting]:
    """What `--set key=value` says."""
    settings = []
    for word in words:
        key, equals, value = word.partition("=")
        settings.append(Setting(word, key.strip(), value.strip() if equals else None))
    return settings
