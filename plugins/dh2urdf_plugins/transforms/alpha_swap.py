"""The stage ``alpha-swap``: from a DH table to joints and links.

Two variants. `exact` is the default and gives the arm of the table. `paper` does what "URDF Generator for Manipulator
Robot" describes, for those who want to see that: its links end up in a straight line.
What makes the robots is imported when it is called.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.stages import Compares, KeepsKinematics, Transform, TransformsInColumns, Usual
from dh2urdf_plugins.transforms.alpha_swap_options import AlphaSwapOptions

if TYPE_CHECKING:
    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot


def alpha_swap(manipulator: Manipulator, options: AlphaSwapOptions) -> Robot:
    """The robot of a manipulator.

    Raises:
        TransformError: no arm can be made of the table; all its problems are named.
    """
    from dh2urdf_plugins.transforms.robots import robot_of

    return robot_of(manipulator, options)


def alpha_swap_columns(
    columns: ManipulatorColumns, options: AlphaSwapOptions
) -> list[tuple[list[int], RobotColumns]] | None:
    """The robots of many manipulators, in groups.

    None for the paper's variant and for split rows, which nobody makes by the thousand.
    """
    if options.variant == "paper" or options.near_parallel == "split":
        return None
    from dh2urdf_plugins.transforms.exact import exact_columns
    from dh2urdf_plugins.transforms.robots import of_meshes, without_effect

    has_notices = any(of_meshes(columns.table)) or (len(columns) and any(without_effect(columns.pick(0), options)))
    return [] if has_notices else exact_columns(columns, options)


TRANSFORM = Transform(
    name="alpha-swap",
    summary="the arm of the table, its link frames parallel to the base or as in the table; or the paper's algorithm",
    transform=alpha_swap,
    options=AlphaSwapOptions,
    capabilities=(
        Usual(),
        KeepsKinematics(lambda options: options.variant == "exact"),  # the paper's algorithm does not promise it
        TransformsInColumns(alpha_swap_columns),
        Compares("variant"),
    ),
)
