"""`dh2urdf new-plugin`: the beginning of a plugin."""

from __future__ import annotations

import shlex
from typing import TYPE_CHECKING, cast

import click

from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import PATH, catalog, option, without_option
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.scaffold import write_plugin

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.stages import Kind


@click.command(name="new-plugin")
@click.argument("name")
@option("--kind", required=True, type=click.Choice(KINDS), metavar="KIND", help=f"One of {', '.join(KINDS)}.")
@option("--dir", "folder", type=PATH, default=".", metavar="D", help="Where its folder is made.")
@option("--minimal", is_flag=True, help="A module with the stage, its contract test, and what installs it.")
@without_option
def command(name: str, kind: str, folder: Path, *, minimal: bool) -> int:
    """Write a small distribution NAME with one working stage, its tests, and all that goes with it.

    It installs, passes its own tests, ruff and mypy --strict, and is listed by `dh2urdf plugins`, at once. NAME is that
    of the folder and of the distribution; the stage has the same, without a dh2urdf- at its beginning.

    \b
    dh2urdf new-plugin dh2urdf-lab-table --kind reader
    cd dh2urdf-lab-table
    pip install -e '.[test]' && pytest
    """
    place, files = write_plugin(name, cast("Kind", kind), folder, catalog(), minimal=minimal)
    answer("\n".join(f"{place / file}" for file in files))
    there = shlex.quote(str(place))
    answer(f"\nnext:\n    cd {there}\n    pip install -e '.[test]' && pytest\n    dh2urdf plugins")
    return 0
