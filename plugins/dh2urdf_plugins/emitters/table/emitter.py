"""The stage ``table``: the DH tables of a robot. What writes and reads them is imported when it is called."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.stages import EmittedFile, Emitter, GivesNotices, OtherFiles, ReadsBack
from dh2urdf_plugins.emitters.table.options import SUFFIXES, TableOptions
from dh2urdf_plugins.read_back import read_table

if TYPE_CHECKING:
    from dh2urdf.robot import Robot
    from dh2urdf.source import Problem
    from dh2urdf_plugins.emitters.table.options import Format


def emit(robot: Robot, stem: str, options: TableOptions) -> tuple[EmittedFile, ...]:
    """A file of tables in each format that is asked for, as ``<stem>.yaml``, ``<stem>.tex`` and so on.

    Raises:
        EmitterError: no table of the robot is known, or a format cannot hold it.
    """
    from dh2urdf_plugins.emitters.table.files import tables_of

    return tables_of(robot, stem, options)


def for_suffix(options: TableOptions, suffix: str) -> TableOptions:
    """The options that make a main file of what its suffix names."""
    named: Format = next((name for name, known in SUFFIXES.items() if known == suffix), "yaml")
    return replace(options, formats=(named, *(name for name in options.formats if name != named)))


def one_file(options: TableOptions) -> TableOptions:
    """The options that write the first format alone, for standard output."""
    return replace(options, formats=options.formats[:1])


def notices(robot: Robot, options: TableOptions) -> list[Problem]:
    """What the formats leave out, and that a table does not say where the arms of a cell are."""
    from dh2urdf_plugins.emitters.table.files import notices_of_tables

    return notices_of_tables(robot, options)


EMITTER = Emitter(
    name="table",
    summary="the DH table: YAML, CSV, JSON, Markdown, LaTeX, and code for MATLAB and Robotics Toolbox for Python",
    suffixes=(*SUFFIXES.values(), ".yml"),
    options=TableOptions,
    emit=emit,
    capabilities=(
        ReadsBack(read_table),
        OtherFiles(one_file=one_file, for_suffix=for_suffix),
        GivesNotices(notices),
    ),
)
