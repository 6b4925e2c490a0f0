"""How far a table is from the chain of the file that it was extracted from.

Nothing here comes from the extraction: the table goes through the DH product, and the chain through the origins and
axes of its joints, as in every proof of the project.
"""

from __future__ import annotations

import math
import random
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics import KinematicChain, angle_error, forward_kinematics, position_error
from dh2urdf.manipulator import JointType

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

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
    chain = KinematicChain.of(joints)
    position = angle = 0.0
    for q in _joint_vectors([joint for joint in joints if joint.type is not JointType.FIXED]):
        one, other = forward_kinematics(table, q), chain.forward_kinematics(q)
        position = max(position, position_error(one, other))
        angle = max(angle, angle_error(one, other))
    return Difference(position, angle)


def chain_difference(one: Sequence[Joint], other: Sequence[Joint]) -> Difference:
    """How far two chains of the same joints are from each other, at the same joint vectors."""
    left, right = KinematicChain.of(one), KinematicChain.of(other)
    position = angle = 0.0
    for q in _joint_vectors([joint for joint in one if joint.type is not JointType.FIXED]):
        here, there = left.forward_kinematics(q), right.forward_kinematics(q)
        position = max(position, position_error(here, there))
        angle = max(angle, angle_error(here, there))
    return Difference(position, angle)


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
