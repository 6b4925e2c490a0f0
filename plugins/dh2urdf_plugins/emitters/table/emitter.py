"""The stage ``table``: the DH tables of a robot, for papers and scripts.

A robot has its table from the pipeline (`Robot.manipulator`); a cell has one for each kind of arm. Tables as YAML, CSV
and JSON are read back and compared before anybody gets them.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.commands import left_out_of, table_file_as
from dh2urdf.errors import EmitterError, InputError, RecordValueError
from dh2urdf.source import Problem
from dh2urdf.stages import EmittedFile, Emitter
from dh2urdf_plugins.emitters.table.json_file import json_file
from dh2urdf_plugins.emitters.table.latex import latex_file
from dh2urdf_plugins.emitters.table.markdown import markdown_file
from dh2urdf_plugins.emitters.table.matlab import left_out_of_matlab, matlab_file
from dh2urdf_plugins.emitters.table.options import SUFFIXES, TableOptions
from dh2urdf_plugins.emitters.table.toolbox import left_out_of_toolbox, toolbox_file
from dh2urdf_plugins.read_back.table_reader import read_table

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf_plugins.emitters.table.options import Format

_READ_BACK = ("yaml", "csv", "json")


def emit(robot: Robot, stem: str, options: TableOptions) -> tuple[EmittedFile, ...]:
    """A file of tables in each format that is asked for, as ``<stem>.yaml``, ``<stem>.tex`` and so on.

    Raises:
        EmitterError: no table of the robot is known, or a format cannot hold it.
    """
    arms = manipulators_of(robot)
    return tuple(
        EmittedFile(
            name=f"{stem}{SUFFIXES[name]}",
            content=_written(name, arms, options)[0],
            is_robot=name in _READ_BACK and not robot.arms,
        )
        for name in _formats(options)
    )


def manipulators_of(robot: Robot) -> list[Manipulator]:
    """The table of a robot, or one of each kind of arm of a cell.

    Raises:
        EmitterError: one is not known.
    """
    kinds = {id(arm.kind): arm.kind for arm in robot.arms}.values() if robot.arms else (robot,)
    arms: dict[int, Manipulator] = {}
    for kind in kinds:
        if kind.manipulator is None:
            raise EmitterError(
                Problem(
                    message="the table of this robot is not known, and a table is what is written",
                    robot=kind.name,
                    accepted="a robot that a run or `dh2urdf convert` has made of a table or of a description",
                )
            )
        arms[id(kind.manipulator)] = kind.manipulator
    return list(arms.values())


def _formats(options: TableOptions) -> tuple[Format, ...]:
    return tuple(dict.fromkeys(options.formats)) or ("yaml",)


def _written(name: Format, arms: Sequence[Manipulator], options: TableOptions) -> tuple[bytes, tuple[Problem, ...]]:
    """A file in a format, and notices of what the format leaves out.

    Raises:
        EmitterError: the format cannot hold the tables.
    """
    try:
        match name:
            case "yaml" | "csv":
                file = table_file_as(name, arms, length_unit=options.length_unit, angle_unit=options.angle_unit)
                return file.content, file.left_out
            case "json":
                content = json_file(arms)
                return content, left_out_of("yaml", arms, content)
            case "markdown":
                return markdown_file(arms, options), ()
            case "latex":
                return latex_file(arms, options), ()
            case "matlab":
                return matlab_file(arms), tuple(left_out_of_matlab(arms))
            case "roboticstoolbox":
                return toolbox_file(arms), tuple(left_out_of_toolbox(arms))
    except (InputError, RecordValueError) as error:
        raise EmitterError(error.problems) from error


def for_suffix(options: TableOptions, suffix: str) -> TableOptions:
    """The options that make a main file of what its suffix names."""
    named: Format = next((name for name, known in SUFFIXES.items() if known == suffix), "yaml")
    return replace(options, formats=(named, *(name for name in options.formats if name != named)))


def one_file(options: TableOptions) -> TableOptions:
    """The options that write the first format alone, for standard output."""
    return replace(options, formats=options.formats[:1])


def notices(robot: Robot, options: TableOptions) -> list[Problem]:
    """What the formats leave out, and that a table does not say where the arms of a cell are."""
    arms = manipulators_of(robot)
    found = [notice for name in _formats(options) for notice in _written(name, arms, options)[1]]
    return [*found, *_of_a_cell(robot, len(arms))]


def _of_a_cell(robot: Robot, count: int) -> Iterator[Problem]:
    if robot.arms:
        message = (
            f"the tables are those of {count} kind{'' if count == 1 else 's'} of arms; they do not say where the "
            f"{len(robot.arms)} arms of the cell are"
        )
        yield Problem(message=message, severity="notice", suggestion="a URDF, SDF or MJCF describes the whole cell")


EMITTER = Emitter(
    name="table",
    summary="the DH table: YAML, CSV, JSON, Markdown, LaTeX, and code for MATLAB and Robotics Toolbox for Python",
    suffixes=(*SUFFIXES.values(), ".yml"),
    options=TableOptions,
    emit=emit,
    read_back=read_table,
    one_file=one_file,
    for_suffix=for_suffix,
    notices=notices,
)
