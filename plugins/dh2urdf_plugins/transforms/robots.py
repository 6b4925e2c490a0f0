"""The robot of a table, in the variant that the options name, with what is wrong or odd about the table."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.drawn_links import other_lengths
from dh2urdf.errors import TransformError
from dh2urdf_plugins.transforms.checks import angle_notices, paper_problems, table_problems, with_inertias
from dh2urdf_plugins.transforms.exact import exact
from dh2urdf_plugins.transforms.unused import unused_in_paper, unused_shapes

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf.source import Problem
    from dh2urdf_plugins.transforms.alpha_swap_options import AlphaSwapOptions


def robot_of(manipulator: Manipulator, options: AlphaSwapOptions) -> Robot:
    """The robot of a manipulator.

    Raises:
        TransformError: no arm can be made of the table; all its problems are named.
    """
    manipulator, raised = with_inertias(manipulator, options.inertias, options.inertia_floor)
    given, problems = manipulator, table_problems(manipulator)
    if options.near_parallel == "split" and options.variant == "exact" and not problems:
        from dh2urdf_plugins.extraction.split_tables import with_split_links

        manipulator, problems = with_split_links(manipulator)
    table = None if manipulator is given else manipulator
    if options.variant == "paper":
        problems += [*paper_problems(manipulator, options.snap), *of_meshes(manipulator, placed=False)]
        problems += unused_in_paper(manipulator, options)
    else:
        problems += [*of_meshes(manipulator), *unused_shapes(manipulator, options)]
    if any(problem.severity == "error" for problem in problems):
        raise TransformError([problem.about(robot=manipulator.name, mark=manipulator.mark) for problem in problems])
    if options.variant == "paper":
        from dh2urdf_plugins.transforms.paper import paper

        robot = paper(manipulator, options)
    else:
        robot = exact(manipulator, options)
        problems += [*raised, *angle_notices(given), *other_lengths(given)]
    notices = tuple(notice.about(robot=robot.name, mark=manipulator.mark) for notice in problems)
    return replace(robot, notices=notices, manipulator=table)


def of_meshes(manipulator: Manipulator, *, placed: bool = True) -> Iterable[Problem]:
    """What is wrong with the meshes of a table; most tables have none."""
    meshes = [manipulator.base_visual, manipulator.base_collision]
    if not any(meshes) and not any(row.visual or row.collision for row in manipulator.rows):
        return ()
    from dh2urdf_plugins.transforms.meshes import mesh_problems, unplaced_meshes

    return mesh_problems(manipulator) if placed else unplaced_meshes(manipulator)
