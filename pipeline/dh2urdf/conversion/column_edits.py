"""Edits of many arms at once: of the tables before the transform, of the robots after it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.conversion.robots import refuse_new_name, with_edits, with_torn_links
from dh2urdf.elementwise import DividedError
from dh2urdf.manipulator import Manipulator
from dh2urdf.robot import Robot
from dh2urdf.robot_check import sure_columns
from dh2urdf.stage_calls.calls import Call, a_record, blaming

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.source import Problem
    from dh2urdf.stages import Edit

R = TypeVar("R", Manipulator, Robot)


def edited_tables(columns: ManipulatorColumns, edits: Sequence[Call[Edit[Any]]]) -> ManipulatorColumns:
    """Many manipulators after the edits of tables.

    Raises:
        DividedError: an edit would make different things of the members.
        ManipulatorError: an edit refuses a member, or is at fault.
    """
    original = columns.table
    for call in edits:
        if call.stage.edit_table is not None:
            columns = replace(columns, table=_edited(call, call.stage.edit_table, columns.table))
            if len(columns.table.rows) != len(columns.lines[0]):
                columns = replace(columns, lines=((None,) * len(columns.table.rows),) * len(columns))
            with blaming(call):
                columns.pick(0)  # The checks of a manipulator, which a table of columns does without.
    table = with_torn_links(columns.table, original)
    return columns if table is columns.table else replace(columns, table=table)


def edited_robots(robots: RobotColumns, edits: Sequence[Call[Edit[Any]]], notices: Sequence[Problem]) -> RobotColumns:
    """Many robots after the edits of robots.

    Args:
        robots: what the transform made.
        edits: all edits of the run.
        notices: what the edits of their tables have noticed.

    Raises:
        DividedError: an edit would make different things of the members.
        ManipulatorError: an edit refuses a member, or is at fault.
    """
    for call in edits:
        if call.stage.edit_robot is not None:
            robot = _edited(call, call.stage.edit_robot, robots.robot)
            if robots.present and _shapes(robot)[: len(robots.robot.links)] != _shapes(robots.robot):
                raise DividedError(robots.sure)  # Which shapes only some of them have is no longer known.
            robots = replace(robots, robot=robot, sure=robots.sure & sure_columns(robot, robots.names))
    robot = robots.robot
    return replace(
        robots,
        robot=replace(robot, notices=(*notices, *robot.notices), comment=with_edits(robot.comment, edits)),
        comments=tuple([with_edits(comment, edits) for comment in robots.comments]),
    )


def _edited(call: Call[Edit[Any]], function: Callable[[R, Any], R], record: R) -> R:
    with blaming(call):
        try:
            changed = a_record(function(record, call.options), type(record))
        except DividedError as error:
            divided = error
        else:
            refuse_new_name(changed.name, record.name)
            return changed
    raise divided


def _shapes(robot: Robot) -> list[tuple[str, int]]:
    """The links, each with its number of collision shapes."""
    return [(link.name, len(link.collisions)) for link in robot.links]
