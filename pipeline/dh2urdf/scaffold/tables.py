"""The beginning of a table and of a run file: `dh2urdf init`."""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.commands.written_tables import in_format
from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.documents.text_files import encoded
from dh2urdf.errors import ConfigError, OutputError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.output.spooled import spooled
from dh2urdf.output.whole_files import make_folder, reporting_os_errors
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Problem, shown
from dh2urdf.table_text import TableText, yaml_word

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.stage_calls.calls import Call
    from dh2urdf.stages import Reader

MOST_AXES = 100
"""Joints of a template at most."""
_PRODUCTS = {
    Convention.STANDARD: "standard (classic, distal): a row is Rz(theta) Tz(d) Tx(a) Rx(alpha)",
    Convention.MODIFIED: "modified (Craig, proximal): a row is Rx(alpha) Tx(a) Rz(theta) Tz(d)",
}
_REACHES = (250, 200, 150)
_RUN = """\
# A run makes all files of all its tables, and proves them. Do it: dh2urdf run {run}
# Every key is in the reference of run files; an editor completes them by `dh2urdf schema`.
inputs:
  - {table}
# The exact arm, its links parallel to the base. frames: dh has the frames of the table in their place.
transform: {{stage: alpha-swap, options: {{frames: aligned}}}}
# Formats: urdf, xacro, sdf, mjcf.
emitters: [urdf, xacro]
# Simulators that load the files, where they are installed:
# loaders: [pybullet, mujoco]
output: {{directory: build}}
"""


def table_template(
    call: Call[Reader[Any]], convention: Convention, joints: Sequence[str], name: str, file: Path
) -> bytes:
    """A table of an arm that stands upright, with comments; in either convention it is the same arm.

    Args:
        call: the reader that writes it and reads it back.
        convention: the convention of its rows.
        joints: the names of its joints.
        name: the manipulator's name; empty leaves it to the file's.
        file: where it will be.

    Raises:
        ConfigError: a name cannot be one.
        InputError: the reader only reads.
        StageError: the reader is at fault.
    """
    lines = [
        f"A table of Denavit-Hartenberg parameters: {len(joints)} axes, a row for each, from the base outwards.",
        "Put the numbers of your arm in place of these, and convert it:",
        f"    dh2urdf convert {file.name} -o {file.stem}.urdf",
        f"The convention is {_PRODUCTS[convention]}.",
        "The type of a joint may be revolute, continuous, prismatic or fixed.",
        "A number may be an expression (pi/2) and may have its own unit (90 deg).",
        "Further columns may say the speed, the effort and the mass: docs/tables.md has all of them.",
    ]
    text = TableText(
        name=name,
        convention=str(convention),
        length_unit="mm",
        angle_unit="deg",
        rows=tuple(_rows(convention, joints)),
    )
    content = encoded("".join(f"# {line}\n" for line in lines)) + in_format([text], call).content
    _check(call, content, file)
    return content


def _rows(convention: Convention, joints: Sequence[str]) -> list[dict[str, str]]:
    """The rows of an arm: a waist, links side by side, and a wrist from the fourth joint on."""
    last = len(joints) - 1
    links: list[tuple[int, int, int]] = []  # a [mm], alpha [deg], d [mm] of the standard convention
    for number in range(len(joints)):
        if number == 0:
            links.append((0, 90, 300))
        elif number < len(_REACHES):
            links.append((_REACHES[number], 0, 0))
        else:
            links.append((0, 90 if number % 2 else -90, 100))
    links[last] = (0, 0, links[last][2] or 80)
    if convention is Convention.MODIFIED:  # a and alpha are those of the link before
        before = [(0, 0), *((a, alpha) for a, alpha, _ in links)]
        links = [(a, alpha, d) for (a, alpha), (_, _, d) in zip(before, links, strict=False)]
    return [
        {
            "joint": joint,
            "type": "revolute",
            "a": str(a),
            "alpha": str(alpha),
            "d": str(d),
            "theta": "0",
            "lower": "-170",
            "upper": "170",
        }
        for joint, (a, alpha, d) in zip(joints, links, strict=True)
    ]


def _check(call: Call[Reader[Any]], content: bytes, file: Path) -> None:
    """Reads a template, so that its user starts with a table without errors."""
    with spooled(content, str(file), file.suffix) as path:
        (item,) = read_items(call, path)
    if not isinstance(item, Manipulator):
        problems = [replace(problem, mark=COMMAND_LINE) for problem in item.problems]
        raise ConfigError(problems)


def run_template(table: Path, run: Path) -> bytes:
    """A run file for a table, with comments.

    Args:
        table: the table.
        run: where the run file will be; the table is named by its path from there.
    """
    path = os.path.relpath(table, run.parent).replace(os.sep, "/")
    return encoded(_RUN.format(run=run.name, table=yaml_word(path)))


def write_new(files: dict[Path, bytes]) -> None:
    """Write files that are not there yet: all of them, or none.

    Raises:
        OutputError: one of them is there, or they cannot be written.
    """
    problems = [
        Problem(
            message=f"{shown(str(path), 200)} is there already, and is not overwritten",
            mark=COMMAND_LINE,
            found=str(path),
            suggestion="give another name, or move the file away",
        )
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
