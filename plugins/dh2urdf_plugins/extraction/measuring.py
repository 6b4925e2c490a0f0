"""How far a table is from the chain of the file that it was extracted from.

Nothing here comes from the extraction: the table goes through the DH product, and the chain through the origins and
axes of its joints, as in every proof of the project.
"""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics import KinematicChain, largest_errors, table_chain
from dh2urdf.manipulator import JointType

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.kinematics import CompiledChain
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Joint

RANDOM_VECTORS = 32
"""Random joint vectors at which poses are compared, besides zero."""
_WIDEST_TURN = math.pi
_WIDEST_SLIDE = 1.0


class Difference(NamedTuple):
    """The largest difference of two chains.

    Attributes:
        position: distance of the tips [m].
        angle: angle between them [rad].
    """

    position: float
    angle: float

    @property
    def largest(self) -> float:
        """The larger of the two, as a tolerance counts them [m, rad]."""
        return max(self.position, self.angle)


def difference(table: Manipulator, joints: Sequence[Joint]) -> Difference:
    """How far the table of a chain is from its joints, at q = 0 and at random q within the limits."""
    return _difference(table_chain(table), KinematicChain.of(joints).compiled, joints)


def chain_difference(one: Sequence[Joint], other: Sequence[Joint]) -> Difference:
    """How far two chains of the same joints are from each other, at the same joint vectors."""
    return _difference(KinematicChain.of(one).compiled, KinematicChain.of(other).compiled, one)


def _difference(one: CompiledChain, other: CompiledChain, joints: Sequence[Joint]) -> Difference:
    moving = [joint for joint in joints if joint.type is not JointType.FIXED]
    errors = largest_errors(one, other, _joint_vectors(moving))
    return Difference(errors.position, errors.angle)


def _joint_vectors(moving: Sequence[Joint]) -> Iterator[tuple[float, ...]]:
    yield (0.0,) * len(moving)
    ranges = [_range(joint) for joint in moving]
    draw = random.Random(f"dh2urdf {len(moving)}")  # noqa: S311 - reproducible on purpose
    for _ in range(RANDOM_VECTORS):
        yield tuple([lower + (upper - lower) * draw.random() for lower, upper in ranges])


def _range(joint: Joint) -> tuple[float, float]:
    widest = _WIDEST_SLIDE if joint.type is JointType.PRISMATIC else _WIDEST_TURN
    lower, upper = joint.limits.lower, joint.limits.upper
    if lower is None or upper is None or not lower < upper:
        return -widest, widest
    return max(lower, -2 * widest), min(upper, 2 * widest)
