"""The table of a chain: with the coarsest numbers that keep the tolerance, as measured against the chain itself.

The measurement uses nothing of the extraction: the table goes through the DH product, and the chain through the origins
and axes of its joints, as in every proof of the project.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics import KinematicChain, largest_errors, table_chain
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf_plugins.extraction import TOLERANCE
from dh2urdf_plugins.extraction.chain import Chain, Precision
from dh2urdf_plugins.extraction.ends import place_sliding_axes
from dh2urdf_plugins.extraction.rows import rows_of
from dh2urdf_plugins.extraction.splitting import NearlyParallel, split_links

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.kinematics import CompiledChain
    from dh2urdf.robot import Joint

RANDOM_VECTORS = 32
"""Random joint vectors at which poses are compared, besides zero."""
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


class Solution(NamedTuple):
    """The table of a chain, without what is not kinematics.

    Attributes:
        table: rows with the names of their joints; a fixed row has that of the joint before it, with ``_split``.
        difference: how far its tip is from the chain's at most [m, rad].
        length: the arm's length [m].
        nearly_parallel: the neighbours whose axes are nearly parallel, and far enough for it to be noticed.
    """

    table: Manipulator
    difference: tuple[float, float]
    length: float
    nearly_parallel: tuple[NearlyParallel, ...]

    @property
    def error(self) -> float:
        """The larger of position and angle, as a tolerance counts them [m, rad]."""
        return max(self.difference)


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
    found: list[Solution] = []
    while len(found) < _ATTEMPTS and not (found and found[-1].error <= choices.tolerance / 2):
        placed = place_sliding_axes(given, precision, length)
        chain, nearly_parallel = split_links(placed, precision, length, choices.tolerance, choices.near_parallel)
        numbers = rows_of(chain, choices.convention, precision, length, origins=choices.origins)
        names = [f"{axis.joint}_split" if axis.type is JointType.FIXED else axis.joint for axis in chain.axes]
        rows = [
            DHRow(joint=name, link=name, type=axis.type, **row._asdict())
            for name, axis, row in zip(names, chain.axes, numbers.rows, strict=True)
        ]
        table = Manipulator(
            name="extracted",
            convention=choices.convention,
            rows=tuple(rows),
            base=numbers.base,
            tool=numbers.tool,
        )
        difference = _difference(table_chain(table), KinematicChain.of(joints).compiled, joints)
        found.append(Solution(table, difference, length, nearly_parallel))
        precision = precision.finer()
    return min(found, key=lambda solution: solution.error)


def chain_difference(one: Sequence[Joint], other: Sequence[Joint]) -> tuple[float, float]:
    """How far two chains of the same joints are from each other, at q = 0 and at random q within the limits."""
    return _difference(KinematicChain.of(one).compiled, KinematicChain.of(other).compiled, one)


def _difference(one: CompiledChain, other: CompiledChain, joints: Sequence[Joint]) -> tuple[float, float]:
    moving = [each for each in joints if each.type is not JointType.FIXED]
    position, angle, _ = largest_errors(one, other, _joint_vectors(moving))
    return position, angle


def _joint_vectors(moving: Sequence[Joint]) -> Iterator[tuple[float, ...]]:
    yield (0.0,) * len(moving)
    ranges = []
    for joint in moving:
        widest = 1.0 if joint.type is JointType.PRISMATIC else math.pi
        lower, upper = joint.limits.lower, joint.limits.upper
        if lower is None or upper is None or not lower < upper:
            lower, upper = -widest, widest
        ranges.append((max(lower, -2 * widest), min(upper, 2 * widest)))
    draw = random.Random(f"dh2urdf {len(moving)}")  # noqa: S311 - reproducible on purpose
    for _ in range(RANDOM_VECTORS):
        yield tuple([lower + (upper - lower) * draw.random() for lower, upper in ranges])
