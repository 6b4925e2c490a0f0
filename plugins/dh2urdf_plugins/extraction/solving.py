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
    from collections.abc import Sequence

    from dh2urdf.kinematics import CompiledChain
    from dh2urdf.robot import Joint

RANDOM_VECTORS = 32
"""Random joint vectors at which poses are compared, besides zero."""
_ATTEMPTS = 12


@dataclass(frozen=True, slots=True, kw_only=True)
class Choices:
    """What is left to the person who asks for a table."""

    convention: Convention = Convention.STANDARD
    tolerance: float = TOLERANCE  # how far the tip of the table may be from the file's [m, rad]
    near_parallel: str = "auto"  # dh: one row, however large its d; split: a fixed row
    origins: str = "fewest"  # one d for a run of parallel axes; file: each d as the file's origins have it


class Solution(NamedTuple):
    """The table of a chain, without what is not kinematics."""

    table: Manipulator  # with the names of the joints; a fixed row has that of the joint before it, with `_split`
    difference: tuple[float, float]  # how far its tip is from the chain's at most [m, rad]
    length: float  # of the arm [m]
    nearly_parallel: tuple[NearlyParallel, ...]  # neighbours whose common normal is far enough for it to be noticed

    @property
    def error(self) -> float:
        """The larger of position and angle, as a tolerance counts them [m, rad]."""
        return max(self.difference)


def solve(joints: Sequence[Joint], choices: Choices) -> Solution:
    """The table of a chain.

    Numbers begin with a quarter of the tolerance each. Where that is too much for all of them together, they become
    finer, until the table is measured to be nearer than half the tolerance, or as near as doubles get. At least one of
    the joints moves.
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
        base, tool = numbers.base, numbers.tool
        table = Manipulator(name="extracted", convention=choices.convention, rows=tuple(rows), base=base, tool=tool)
        difference = _difference(table_chain(table), KinematicChain.of(joints).compiled, joints)
        found.append(Solution(table, difference, length, nearly_parallel))
        precision = precision.finer()
    return min(found, key=lambda solution: solution.error)


def chain_difference(one: Sequence[Joint], other: Sequence[Joint]) -> tuple[float, float]:
    """How far two chains of the same joints are from each other, at q = 0 and at random q within the limits."""
    return _difference(KinematicChain.of(one).compiled, KinematicChain.of(other).compiled, one)


def _difference(one: CompiledChain, other: CompiledChain, joints: Sequence[Joint]) -> tuple[float, float]:
    moving = [each for each in joints if each.type is not JointType.FIXED]
    ranges = []
    for joint in moving:
        widest = 1.0 if joint.type is JointType.PRISMATIC else math.pi
        lower, upper = joint.limits.lower, joint.limits.upper
        if lower is None or upper is None or not lower < upper:
            lower, upper = -widest, widest
        ranges.append((max(lower, -2 * widest), min(upper, 2 * widest)))
    draw = random.Random(f"dh2urdf {len(moving)}")  # noqa: S311 - reproducible on purpose
    vectors = [(0.0,) * len(moving)]
    vectors += [tuple([a + (b - a) * draw.random() for a, b in ranges]) for _ in range(RANDOM_VECTORS)]
    position, angle, _ = largest_errors(one, other, vectors)
    return position, angle
