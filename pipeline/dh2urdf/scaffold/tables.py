"""Tables to begin with: those of known arms (`dh2urdf example`), and the first table of an arm (`dh2urdf init`)."""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

from dh2urdf.commands.written import in_format
from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.documents.text_files import encoded, is_file, is_folder
from dh2urdf.errors import ConfigError, OutputError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.output.spooled import spooled
from dh2urdf.output.whole_files import make_folder, reporting_os_errors
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.scaffold import TEMPLATES
from dh2urdf.source import Messages, did_you_mean, shown
from dh2urdf.table_text import TableText
from dh2urdf.table_text.texts import yaml_word

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.stage_calls.calls import Call
    from dh2urdf.stages import Reader

say = Messages(__file__)

MOST_AXES = 100
"""Joints of a template at most."""
_PRODUCTS = {
    Convention.STANDARD: "standard (classic, distal): a row is Rz(theta) Tz(d) Tx(a) Rx(alpha)",
    Convention.MODIFIED: "modified (Craig, proximal): a row is Rx(alpha) Tx(a) Rz(theta) Tz(d)",
}
_IN_A_WHEEL = Path(__file__).parents[1] / "tables"
_IN_A_CLONE = Path(__file__).parents[3] / "configs" / "tables"


def shipped_tables() -> dict[str, Path]:
    """The tables by name; of a clone of the repository those in `configs/tables`, of which a wheel holds a copy."""
    folder = _IN_A_WHEEL if is_folder(_IN_A_WHEEL) else _IN_A_CLONE
    return {path.stem: path for path in sorted(folder.iterdir()) if is_file(path)} if is_folder(folder) else {}


def shipped_table(name: str) -> Path:
    """The table of a name.

    Raises:
        ConfigError: there is none.
    """
    tables = shipped_tables()
    if name in tables:
        return tables[name]
    near = did_you_mean(name, tables)
    raise ConfigError(say("example-unknown", COMMAND_LINE, found=name, names=tuple(tables), suggestion=near))


def table_template(
    call: Call[Reader[Any]], convention: Convention, joints: Sequence[str], name: str, file: Path
) -> bytes:
    """A table of an arm that stands upright, with comments; in either convention it is the same arm.

    The reader `call` writes it and reads it back. Without a name, the manipulator is named by the file.

    Raises:
        ConfigError: a name cannot be one.
    """
    comments = Template((TEMPLATES / "table.txt").read_text("utf-8")).substitute(
        count=len(joints), file=file.name, stem=file.stem, convention=_PRODUCTS[convention]
    )
    # A waist, links side by side, and a wrist from the fourth joint on: a [mm], alpha [deg], d [mm], standard.
    links = [(0, 90, 300), (200, 0, 0), (150, 0, 0)][: len(joints)]
    step = min(100, 4000 // len(joints))  # an arm of 5 m would be worth a notice
    links += [(0, 90 if number % 2 else -90, step) for number in range(3, len(joints))]
    links[-1] = (0, 0, links[-1][2] or 80)
    if convention is Convention.MODIFIED:  # a and alpha are those of the link before
        before = [(0, 0, 0), *links]
        links = [(a, alpha, d) for (a, alpha, _), (_, _, d) in zip(before, links, strict=False)]
    ends = {"theta": "0", "lower": "-170", "upper": "170"}
    text = TableText(
        name=name,
        convention=str(convention),
        length_unit="mm",
        angle_unit="deg",
        rows=tuple(
            {"joint": joint, "type": "revolute", "a": str(a), "alpha": str(alpha), "d": str(d), **ends}
            for joint, (a, alpha, d) in zip(joints, links, strict=True)
        ),
    )
    content = encoded(comments) + in_format([text], call).content
    with spooled(content, str(file), file.suffix) as path:
        (item,) = read_items(call, path)
    if not isinstance(item, Manipulator):
        raise ConfigError([replace(problem, mark=COMMAND_LINE) for problem in item.problems])
    return content


def run_template(table: Path, run: Path) -> bytes:
    """A run file for a table, with comments; the table is named by its path from the place of the run file."""
    path = os.path.relpath(table, run.parent).replace(os.sep, "/")
    text = Template((TEMPLATES / "run.yaml").read_text("utf-8"))
    return encoded(text.substitute(run=run.name, table=yaml_word(path)))


def write_new(files: dict[Path, bytes]) -> None:
    """Write files that are not there yet: all of them, or none.

    Raises:
        OutputError: one of them is there, or they cannot be written.
    """
    problems = [
        say("file-there", COMMAND_LINE, found=str(path), path=shown(str(path), 200))
        for path in files
        if os.path.lexists(path)
    ]
    if problems:
        raise OutputError(problems)
    written: list[Path] = []
    try:
        for path, content in files.items():
            make_folder(path.parent)
            with reporting_os_errors(path), path.open("xb") as file:
                written.append(path)
                file.write(content)
    except BaseException:
        for path in written:
            path.unlink(missing_ok=True)
        raise
