"""The exact variant for many tables at once.

The functions that make one robot make a column of them: what differs is only that the numbers are arrays. Where robots
are not all drawn alike, because a length is nothing for some, they are divided, and each half is made by itself.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.columns import ManipulatorColumns, RobotColumns
from dh2urdf.elementwise import DividedError, is_column
from dh2urdf.robot_check import sure_columns
from dh2urdf_plugins.transforms.checks import sure_tables
from dh2urdf_plugins.transforms.exact import exact
from dh2urdf_plugins.transforms.formulas import nameless
from dh2urdf_plugins.transforms.robots import of_meshes, unused_shapes
from dh2urdf_plugins.transforms.shapes import remains

if TYPE_CHECKING:
    from dh2urdf.elementwise import Condition
    from dh2urdf.robot import Robot
    from dh2urdf_plugins.transforms.alpha_swap_options import AlphaSwapOptions

FEWEST = 8
"""Robots that are worth being made at once when others are drawn differently."""


def exact_columns(columns: ManipulatorColumns, options: AlphaSwapOptions) -> list[tuple[list[int], RobotColumns]]:
    """The robots of many manipulators, in groups that are drawn alike, each with the places of its members.

    Those about which there is a doubt, and those that few others are drawn like, are left out.
    """
    import numpy as np

    if any(of_meshes(columns.table)) or (len(columns) and any(unused_shapes(columns.pick(0), options))):
        return []
    groups = []
    waiting = [np.flatnonzero(sure_tables(columns))]
    # What a number too large or too small makes of others is no fault: such a robot is not sure.
    with np.errstate(all="ignore"):
        while waiting:
            members = waiting.pop()
            places = members.tolist()
            if not places:
                continue
            some = columns if len(places) == len(columns) else columns.take(places)
            try:
                groups.append((places, _robots(some, options)))
            except DividedError as divided:
                halves = (members[~divided.condition], members[divided.condition])
                waiting += [half for half in halves if len(half) >= FEWEST]
    return groups


def _robots(columns: ManipulatorColumns, options: AlphaSwapOptions) -> RobotColumns:
    """The robots of tables that are all drawn alike.

    Raises:
        DividedError: they are not.
    """
    robot = exact(columns.table, options, nameless)
    # A table of many has no name, so the comment of its robot begins where a name would end.
    comments = tuple([name + robot.comment for name in columns.names])
    return RobotColumns(
        robot=replace(robot, name=columns.names[0], comment=comments[0]),
        names=columns.names,
        comments=comments,
        sure=sure_columns(robot, columns.names),
        present=_present(robot),
    )


def _present(robot: Robot) -> dict[tuple[int, int], Condition]:
    """Which robots have those collision shapes that not all of them have."""
    return {
        (place, number): mask
        for place, link in enumerate(robot.links)
        for number, collision in enumerate(link.collisions)
        if is_column(mask := remains(collision.geometry)) and not mask.all()
    }
