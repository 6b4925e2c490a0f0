"""The files of the stage ``table``: the DH tables of a robot, for papers and scripts.

A robot has its table from the pipeline (`Robot.manipulator`); a cell has one for each kind of arm. The pipeline reads
tables as YAML, CSV and JSON back and compares T(q); every other field is compared where the notices are made.
"""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING

from dh2urdf.commands import left_out_of, table_content
from dh2urdf.errors import EmitterError, InputError, RecordValueError
from dh2urdf.manipulator import BASE, FLANGE, ROOT, TOOL, WORLD
from dh2urdf.source import Problem, listed, shown
from dh2urdf.stages import EmittedFile
from dh2urdf_plugins.emitters.table.json_file import json_file
from dh2urdf_plugins.emitters.table.latex import latex_file
from dh2urdf_plugins.emitters.table.markdown import markdown_file
from dh2urdf_plugins.emitters.table.matlab import left_out_of_matlab, matlab_file
from dh2urdf_plugins.emitters.table.options import SUFFIXES
from dh2urdf_plugins.emitters.table.toolbox import left_out_of_toolbox, toolbox_file

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf_plugins.emitters.table.options import Format, TableOptions

_READ_BACK = ("yaml", "csv", "json")
_LINKS = {WORLD, ROOT, BASE, "base", FLANGE, TOOL, "payload"}
"""Links beside those of the rows that a table says by itself, or that every robot has."""
_MOST_LINKS = 6


def tables_of(robot: Robot, stem: str, options: TableOptions) -> tuple[EmittedFile, ...]:
    """A file of tables in each format that is asked for, as ``<stem>.yaml``, ``<stem>.tex`` and so on.

    Raises:
        EmitterError: no table of the robot is known, or a format cannot hold it.
    """
    arms = manipulators_of(robot)
    return tuple(
        EmittedFile(
            name=f"{stem}{SUFFIXES[name]}",
            content=_content(name, arms, options),
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


def _content(name: Format, arms: Sequence[Manipulator], options: TableOptions) -> bytes:
    """A file in a format.

    Raises:
        EmitterError: the format cannot hold the tables.
    """
    match name:
        case "yaml" | "csv":
            with _as_emitter_errors():
                return table_content(name, arms, length_unit=options.length_unit, angle_unit=options.angle_unit)
        case "json":
            return json_file(arms)
        case "markdown":
            return markdown_file(arms, options)
        case "latex":
            return latex_file(arms, options)
        case "matlab":
            return matlab_file(arms)
        case "roboticstoolbox":
            return toolbox_file(arms)


def _left_out(name: Format, arms: Sequence[Manipulator], options: TableOptions) -> Iterable[Problem]:
    """Notices of what a format leaves out; a file that our readers read is read back.

    Raises:
        EmitterError: the format cannot hold the tables, or what was written reads back as other arms.
    """
    match name:
        case "yaml" | "csv" | "json":
            reader = "csv" if name == "csv" else "yaml"
            with _as_emitter_errors():
                return left_out_of(reader, arms, _content(name, arms, options))
        case "matlab":
            return left_out_of_matlab(arms)
        case "roboticstoolbox":
            return left_out_of_toolbox(arms)
        case "markdown" | "latex":
            return ()


@contextmanager
def _as_emitter_errors() -> Iterator[None]:
    try:
        yield
    except (InputError, RecordValueError) as error:
        raise EmitterError(error.problems) from error


def notices_of_tables(robot: Robot, options: TableOptions) -> list[Problem]:
    """What the formats leave out, and that a table does not say where the arms of a cell are."""
    arms = manipulators_of(robot)
    found = [notice for name in _formats(options) for notice in _left_out(name, arms, options)]
    return [*found, *_of_a_cell(robot, len(arms)), *_of_other_links(robot, arms)]


def _of_other_links(robot: Robot, arms: Sequence[Manipulator]) -> Iterator[Problem]:
    """Of links that the table does not have, such as a camera that an edit has mounted."""
    if robot.arms or not arms:
        return
    known = {*_LINKS, *(row.link for row in arms[0].rows)}
    if others := [link.name for link in robot.links if link.name not in known]:
        message = f"a table has no place for {listed([shown(name) for name in others], _MOST_LINKS)}"
        yield Problem(message=message, severity="notice", suggestion="a URDF, SDF or MJCF describes the whole robot")


def _of_a_cell(robot: Robot, count: int) -> Iterator[Problem]:
    if robot.arms:
        message = (
            f"the tables are those of {count} kind{'' if count == 1 else 's'} of arms; they do not say where the "
            f"{len(robot.arms)} arms of the cell are"
        )
        yield Problem(message=message, severity="notice", suggestion="a URDF, SDF or MJCF describes the whole cell")
