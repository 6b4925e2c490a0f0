"""The rows of a chain, measured against it: with the coarsest numbers that keep the tolerance."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf_plugins.extraction import TOLERANCE
from dh2urdf_plugins.extraction.chain import Chain, Precision
from dh2urdf_plugins.extraction.ends import place_sliding_axes
from dh2urdf_plugins.extraction.gluing import glue
from dh2urdf_plugins.extraction.measuring import Difference, difference
from dh2urdf_plugins.extraction.splitting import NearlyParallel, split_links

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Joint
    from dh2urdf_plugins.extraction.chain import Axis
    from dh2urdf_plugins.extraction.gluing import Numbers

_ATTEMPTS = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class Choices:
    """What is left to the person who asks for a table.

    Attributes:
        convention: of the rows.
        tolerance: how far the tip of the table may be from the file's [m, rad].
        near_parallel: ``auto``, ``dh`` (one row, however large its d) or ``split`` (a fixed row).
        origins: ``fewest`` (one d for a run of parallel axes) or ``file`` (each d as the file's origins have it).
    """

    convention: Convention = Convention.STANDARD
    tolerance: float = TOLERANCE
    near_parallel: str = "auto"
    origins: str = "fewest"


@dataclass(frozen=True, slots=True, kw_only=True)
class Solution:
    """The table of a chain, without what is not kinematics.

    Attributes:
        table: rows with the names of their joints; a fixed row has that of the joint before it, with ``_split``.
        difference: how far its tip is from the chain's.
        length: the arm's length [m].
        nearly_parallel: the neighbours whose axes are nearly parallel, and far enough for it to be noticed.
    """

    table: Manipulator
    difference: Difference
    length: float
    nearly_parallel: tuple[NearlyParallel, ...]


def solve(joints: Sequence[Joint], choices: Choices) -> Solution:
    """The table of a chain.

    Numbers begin with a quarter of the tolerance each. Where that is too much for all of them together, they become
    finer, until the table is measured to be nearer than half the tolerance, or as near as doubles get.

    Args:
        joints: the joints from the base link to the tip link, fixed ones among them; at least one moves.
        choices: what is left to choose.
    """
    given = Chain.of(joints)
    length = given.length
    precision = Precision.of(choices.tolerance, length)
    best: Solution | None = None
    for _ in range(_ATTEMPTS):
        found = _solved(given, joints, choices, precision, length)
        if best is None or found.difference.largest < best.difference.largest:
            best = found
        if best.difference.largest <= choices.tolerance / 2:
            break
        precision = precision.finer()
    return best  # type: ignore[return-value]  # there was an attempt


def _solved(given: Chain, joints: Sequence[Joint], choices: Choices, precision: Precision, length: float) -> Solution:
    placed = place_sliding_axes(given, precision, length)
    chain, nearly_parallel = split_links(placed, precision, length, choices.tolerance, choices.near_parallel)
    glued = glue(chain, choices.convention, precision, length, origins=choices.origins)
    table = Manipulator(
        name="extracted",
        convention=choices.convention,
        rows=tuple([_row(axis, row) for axis, row in zip(chain.axes, glued.rows, strict=True)]),
        base=glued.base,
        tool=glued.tool,
    )
    return Solution(table=table, difference=difference(table, joints), length=length, nearly_parallel=nearly_parallel)


def _row(axis: Axis, row: Numbers) -> DHRow:
    name = f"{axis.joint}_split" if axis.type is JointType.FIXED else axis.joint
    return DHRow(joint=name, link=name, type=axis.type, a=row.a, alpha=row.alpha, d=row.d, theta=row.theta)
