"""The stage ``alpha-swap``: from a DH table to joints and links.

Two variants. `exact` is the default and gives the arm of the table. `paper` does what "URDF Generator for Manipulator
Robot" describes, for those who want to see that: its links end up in a straight line.
"""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.errors import TransformError
from dh2urdf.stages import Transform
from dh2urdf_plugins.transforms.alpha_swap_options import AlphaSwapOptions
from dh2urdf_plugins.transforms.checks import angle_notices, paper_problems, table_problems, with_inertia_floor
from dh2urdf_plugins.transforms.exact import exact
from dh2urdf_plugins.transforms.meshes import mesh_problems, unplaced_meshes
from dh2urdf_plugins.transforms.paper import paper
from dh2urdf_plugins.transforms.unused import unused_in_paper, unused_shapes

if TYPE_CHECKING:
    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot


def alpha_swap(manipulator: Manipulator, options: AlphaSwapOptions) -> Robot:
    """The robot of a manipulator.

    Raises:
        TransformError: no arm can be made of the table; all its problems are named.
    """
    manipulator, raised = with_inertia_floor(manipulator, options.inertia_floor)
    given, problems = manipulator, table_problems(manipulator)
    if options.near_parallel == "split" and options.variant == "exact" and not problems:
        from dh2urdf_plugins.extraction.split_tables import with_split_links

        manipulator, problems = with_split_links(manipulator)
    table = None if manipulator is given else manipulator
    if options.variant == "paper":
        problems += [*paper_problems(manipulator, options.snap), *unplaced_meshes(manipulator)]
        problems += unused_in_paper(manipulator)
    else:
        problems += [*mesh_problems(manipulator), *unused_shapes(manipulator, options)]
    if any(problem.severity == "error" for problem in problems):
        raise TransformError([problem.about(robot=manipulator.name, mark=manipulator.mark) for problem in problems])
    if options.variant == "paper":
        robot = paper(manipulator, options)
    else:
        robot = exact(manipulator, options)
        problems += [*raised, *angle_notices(given)]
    notices = tuple(notice.about(robot=robot.name, mark=manipulator.mark) for notice in problems)
    return replace(robot, notices=notices, manipulator=table)


def alpha_swap_columns(
    columns: ManipulatorColumns, options: AlphaSwapOptions
) -> list[tuple[list[int], RobotColumns]] | None:
    """The robots of many manipulators, in groups.

    None for the paper's variant and for split rows, which nobody makes by the thousand.
    """
    if options.variant == "paper" or options.near_parallel == "split":
        return None
    from dh2urdf_plugins.transforms.columns import exact_columns

    return exact_columns(columns, options)


def keeps_kinematics(options: AlphaSwapOptions) -> bool:
    """Whether the robot is the arm of the table: the paper's algorithm does not promise it."""
    return options.variant == "exact"


TRANSFORM = Transform(
    name="alpha-swap",
    is_usual=True,
    compared="variant",
    summary="the arm of the table, its link frames parallel to the base or as in the table; or the paper's algorithm",
    transform=alpha_swap,
    options=AlphaSwapOptions,
    keeps_kinematics=keeps_kinematics,
    transform_columns=alpha_swap_columns,
)
