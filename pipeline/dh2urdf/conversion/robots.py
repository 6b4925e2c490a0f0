"""The robot of a manipulator or of a cell: edits of the table, the transform, edits of the robot, and a check."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any, TypeVar

from dh2urdf.errors import ManipulatorError, RobotError
from dh2urdf.fields import replace_unchecked
from dh2urdf.kinematics.expected_poses import ExpectedPoses
from dh2urdf.manipulator import BASE, ROOT, Manipulator
from dh2urdf.plugin_system.calls import Call, a_record, blaming, depending_on
from dh2urdf.robot import Robot
from dh2urdf.robot_check import check_robot, sure_columns
from dh2urdf.rotations import DividedError
from dh2urdf.stages import Edit, NeedsMasses
from dh2urdf.variations.drawn_links import torn_links

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from dh2urdf.cells.cell import Cell
    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.source import Mark, Problem
    from dh2urdf.stages import Transform

R = TypeVar("R", Manipulator, Robot)


def make_item(
    item: Manipulator | Cell, transform: Call[Transform[Any]], edits: Sequence[Call[Edit[Any]]] = ()
) -> tuple[Robot, ExpectedPoses]:
    """Return the robot of a manipulator or cell, checked, and what its tables declare about it after the edits.

    Notices about an arm of a cell go with its manipulator. Edits change each arm, not the cell.

    Raises:
        ManipulatorError: a stage refuses an arm, the arms of a cell do not go together, or the robot breaks a rule.
    """
    if isinstance(item, Manipulator):
        table = edited_table(item, transform, edits)
        return _robot_of(table, item, transform, edits), ExpectedPoses.of(table)
    from dh2urdf.cells.cell import cannot_be, compose, expected_poses_of

    robots: dict[str, Robot] = {}
    tables: dict[str, Manipulator] = {}
    problems: list[Problem] = []
    for arm in {arm.of: arm for arm in reversed(item.call.arms) if arm.part is None}.values():
        table = item.manipulators[arm.of]
        try:
            tables[arm.of] = edited_table(table, transform, edits)
            robots[arm.of] = _robot_of(tables[arm.of], table, transform, edits)
        except ManipulatorError as error:
            problems += cannot_be(arm, error.problems)
    if problems:
        raise RobotError(problems)
    edited = replace(item, manipulators=tables)
    composed = compose(edited, robots)
    robot = replace(composed, notices=(*composed.notices, *_found_wrong(composed, item.mark)))
    return robot, expected_poses_of(edited, robots)


def make_robot(
    manipulator: Manipulator, transform: Call[Transform[Any]], edits: Sequence[Call[Edit[Any]]] = ()
) -> Robot:
    """Return the robot of a manipulator, as `make_item`."""
    return make_item(manipulator, transform, edits)[0]


def edited_table(
    manipulator: Manipulator, transform: Call[Transform[Any]], edits: Iterable[Call[Edit[Any]]]
) -> Manipulator:
    """A manipulator after the edits of tables.

    Raises:
        ManipulatorError: an edit refuses it, or is at fault; or no robot can be made to weigh it.
    """
    table = manipulator
    for call in edits:
        if call.stage.edit_table is not None:
            if _needs_masses(call) and lacks_masses(table):
                with blaming(transform):
                    table = with_masses(table, a_record(transform.stage.transform(table, transform.options), Robot))
            table = _edited(call, call.stage.edit_table, table)
    return table if table is manipulator else _with_torn_links(table, manipulator)


def _needs_masses(call: Call[Edit[Any]]) -> bool:
    needs = call.stage.can(NeedsMasses)
    if needs is None:
        return False
    with blaming(call):
        return a_record(needs.applies(call.options), bool)


def lacks_masses(table: Manipulator) -> bool:
    """Whether a table does not say what the base and every link weigh."""
    return table.base_mass is None or any(row.mass is None for row in table.rows)


def with_masses(table: Manipulator, robot: Robot) -> Manipulator:
    """A table with the masses of its robot where it has none itself."""
    masses = {link.name: link.inertial.mass for link in robot.links if link.inertial}
    rows = [row if row.mass is not None else replace_unchecked(row, mass=masses.get(row.link)) for row in table.rows]
    base = masses.get(BASE, masses.get(ROOT, 0.0)) if table.base_mass is None else table.base_mass
    return replace_unchecked(table, rows=tuple(rows), base_mass=base)


def _with_torn_links(table: Manipulator, original: Manipulator) -> Manipulator:
    """An edited table, with a notice where its links do not follow the edits."""
    torn = tuple(torn_links(original, table, "the edits change"))
    return replace_unchecked(table, notices=(*table.notices, *torn)) if torn else table


def keeps_kinematics(call: Call[Transform[Any]] | Call[Edit[Any]]) -> bool:
    """Whether the robot that a stage makes has the T(base_link → tool0) of the table."""
    if isinstance(call.stage, Edit) and call.stage.edit_robot is None:
        return True
    with depending_on(call, "keeps_kinematics"):
        return a_record(call.stage.keeps_kinematics(call.options), bool)


def _robot_of(
    table: Manipulator, original: Manipulator, transform: Call[Transform[Any]], edits: Sequence[Call[Edit[Any]]]
) -> Robot:
    """The robot of an edited table, checked after every stage that has made or changed it."""
    with blaming(transform):
        robot = a_record(transform.stage.transform(table, transform.options), Robot)
    found = _found_wrong(robot, table.mark)
    known: Manipulator | None = robot.manipulator or table
    for call in edits:
        if call.stage.edit_robot is not None:
            robot = _edited(call, call.stage.edit_robot, robot)
            found = _found_wrong(robot, table.mark, after=call)
            known = known if keeps_kinematics(call) else None
    new = [] if table is original else [notice.about(robot=table.name) for notice in new_notices(table, original)]
    comment = _with_edits(robot.comment, edits) if edits else robot.comment
    return replace(robot, notices=(*new, *robot.notices, *found), manipulator=known, comment=comment)


def new_notices(table: Manipulator, original: Manipulator) -> list[Problem]:
    """What the edits of a table have noticed."""
    return [notice for notice in table.notices if notice not in original.notices]


def _with_edits(comment: str, edits: Sequence[Call[Edit[Any]]]) -> str:
    """A comment that also names the edits, so that a reader of the file knows that the table was changed."""
    named = f"edited by {', '.join(call.stage.name for call in edits)}" if edits else ""
    return "; ".join(filter(None, (comment, named)))


def _edited(call: Call[Edit[Any]], function: Callable[[R, Any], R], record: R) -> R:
    """What an edit makes of a table or of a robot, of one or of many in columns.

    Raises:
        DividedError: it would make different things of the members of columns.
        ManipulatorError: it refuses the record, or is at fault.
    """
    with blaming(call):
        try:
            changed = a_record(function(record, call.options), type(record))
        except DividedError as error:
            divided = error
        else:
            if changed.name != record.name:
                found = f"{record.name!r:.60} to {changed.name!r:.60}"
                raise ValueError(f"it changed the name {found}; files are named before edits are made")
            return changed
    raise divided


def _found_wrong(robot: Robot, mark: Mark | None, after: Call[Edit[Any]] | None = None) -> list[Problem]:
    """The notices of the check of a robot.

    Raises:
        RobotError: it breaks a rule.
    """
    problems = [problem.about(robot=robot.name, mark=mark) for problem in check_robot(robot)]
    if any(problem.severity == "error" for problem in problems):
        if after is not None:
            whose = f" of {after.plugin.distribution}" if after.plugin else ""
            problems = [replace(each, message=f"after the {after}{whose}: {each.message}") for each in problems]
        raise RobotError(problems)
    return problems


# --- Many at once, in columns -----------------------------------------------------------------------------------------


def edited_tables(
    columns: ManipulatorColumns, transform: Call[Transform[Any]], edits: Sequence[Call[Edit[Any]]]
) -> ManipulatorColumns:
    """Many manipulators after the edits of tables.

    Raises:
        DividedError: an edit would make different things of the members.
        ManipulatorError: an edit refuses a member, or is at fault.
    """
    original = columns.table
    for call in edits:
        if call.stage.edit_table is not None:
            if _needs_masses(call) and lacks_masses(columns.table):
                columns = replace(columns, table=with_masses(columns.table, _robots_alike(columns, transform)))
            columns = replace(columns, table=_edited(call, call.stage.edit_table, columns.table))
            if len(columns.table.rows) != len(columns.lines[0]):
                columns = replace(columns, lines=((None,) * len(columns.table.rows),) * len(columns))
            with blaming(call):
                columns.pick(0)  # The checks of a manipulator, which a table of columns does without.
    if columns.table is original:
        return columns
    table = _with_torn_links(columns.table, original)
    return columns if table is columns.table else replace(columns, table=table)


def _robots_alike(columns: ManipulatorColumns, transform: Call[Transform[Any]]) -> Robot:
    """The robots of many manipulators in one record of columns.

    Raises:
        DividedError: some of them are made in another way than the others.
    """
    import numpy as np

    from dh2urdf.plugin_system.column_calls import transform_columns

    alike = np.zeros(len(columns), dtype=bool)
    for places, robots in transform_columns(transform, columns)[:1]:
        alike[list(places)] = robots.sure
        if alike.all() and list(places) == sorted(places):
            return robots.robot
    raise DividedError(alike)


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
        robot=replace(robot, notices=(*notices, *robot.notices), comment=_with_edits(robot.comment, edits)),
        comments=tuple([_with_edits(comment, edits) for comment in robots.comments]),
    )


def _shapes(robot: Robot) -> list[tuple[str, int]]:
    """The links, each with its number of collision shapes."""
    return [(link.name, len(link.collisions)) for link in robot.links]
