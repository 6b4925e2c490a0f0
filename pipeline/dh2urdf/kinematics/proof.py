"""The proof: what was written, read back by other code, moves tool0 as the DH product says, that of every arm.

The joint vectors are the same on every machine and in every run: zero, both ends of the limits, and pseudo-random
ones inside the limits. These are the same fractions of their limits for all arms of as many joints, so that arms with
the same limits are proved at the same joint vectors, and many of them at once (`dh2urdf.kinematics.proof_columns`).
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass, field
from functools import lru_cache
from operator import itemgetter
from typing import TYPE_CHECKING, TypeAlias

from dh2urdf.errors import ProofError
from dh2urdf.kinematics.chain import TOOL, KinematicChain, angle_error, joints_between, position_error
from dh2urdf.manipulator import JointType
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.kinematics.expected_poses import Tip, Truth
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.rotations import RigidTransform

Poses: TypeAlias = tuple[tuple[float, ...], ...]

TOLERANCE = 1e-9
"""What a written description may differ from the DH product: [m] per metre of arm, at least per 1 m, and [rad]."""
LARGEST_SAMPLE = 1e3
"""Joint values beyond this are not sampled [rad or m]: an arm is proved where it can be, not at limits of 1e300."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """How far a written description is from the DH product.

    Attributes:
        position_error: largest distance of a tool0 from where the DH product has it [m].
        angle_error: largest angle between them [rad].
        q: the joint vector of the largest position error, or of the largest angle error where positions agree.
        tolerance: what `position_error` may be [m].
        poses: how many joint vectors were compared.
        tip: the frame of the largest position error: tool0, with its arm's prefix in a cell.
        tips: the largest position error of every such frame [m].
    """

    position_error: float
    angle_error: float
    q: tuple[float, ...]
    tolerance: float
    poses: int
    tip: str = TOOL
    tips: dict[str, float] = field(default_factory=dict)

    @property
    def holds(self) -> bool:
        """Whether the description is the same arm."""
        return math.isfinite(self.position_error) and (
            self.position_error <= self.tolerance and self.angle_error <= TOLERANCE
        )


@lru_cache(maxsize=32)
def fractions(joints: int, count: int) -> Poses:
    """The random joint vectors, as fractions of the joints' ranges; the first of many are those of few."""
    draw = random.Random(f"dh2urdf {joints}")  # noqa: S311 - reproducible on purpose
    return tuple(tuple(draw.random() for _ in range(joints)) for _ in range(count))


def joint_vectors(truth: Truth, robot: Robot, count: int) -> Poses:
    """Joint vectors inside the limits: the one nearest to zero, then random ones [rad or m].

    Args:
        truth: what the tables say; a vector has a value for each of its joints, in order.
        robot: the robot made of them, whose joints have the limits that the tables left open.
        count: how many.
    """
    ranges = joint_ranges(truth, robot)
    nearest_to_zero = tuple(min(max(0.0, lower), upper) for lower, upper in ranges)
    others = (
        tuple(lower + u * (upper - lower) for u, (lower, upper) in zip(row, ranges, strict=True))
        for row in fractions(len(ranges), max(0, count - 1))
    )
    return (nearest_to_zero, *others) if count > 0 else ()


def proof_vectors(truth: Truth, robot: Robot, count: int) -> Poses:
    """The joint vectors of a proof: all zero (inside the limits or not), both ends, and `count` inside the limits."""
    ranges = joint_ranges(truth, robot)
    ends = [tuple(0.0 for _ in ranges), tuple(low for low, _ in ranges), tuple(high for _, high in ranges)]
    return (*ends, *joint_vectors(truth, robot, count))


def prove(truth: Truth, written: Robot, poses: Sequence[Sequence[float]]) -> Proof:
    """Compare T(root → tool0), of every arm, of what was written with the DH product.

    Args:
        truth: what the tables say.
        written: the robot read back from the file.
        poses: joint vectors, one value per joint of the truth [rad or m].

    Raises:
        ProofError: a written chain from the root to a tool0 does not have the tables' moving joints in order.
    """
    found = {tip.link: _largest(tip, KinematicChain.of(joints_to(truth, tip, written)), poses) for tip in truth.tips}
    worst = max(found, key=lambda link: found[link][:2])
    position, _, q = found[worst]
    return Proof(
        position_error=position,
        angle_error=max(angle for _, angle, _ in found.values()),
        q=q,
        tolerance=TOLERANCE * max(1.0, *(tip.reach(poses) for tip in truth.tips)),
        poses=len(poses),
        tip=worst,
        tips={link: largest for link, (largest, _, _) in found.items()},
    )


def joints_to(truth: Truth, tip: Tip, written: Robot) -> tuple[Joint, ...]:
    """The joints on the written way to a tip, of which those that move have to be those of the tables' way.

    Raises:
        ProofError: there is no way, or it moves other joints.
    """
    try:
        joints = joints_between(written, truth.root, tip.link)
    except ValueError as error:
        raise ProofError(Problem(message=str(error), robot=truth.name)) from error
    moving = [joint.name for joint in joints if joint.type is not JointType.FIXED]
    if moving != list(tip.joints):
        raise ProofError(
            Problem(
                message=f"the written chain moves the joints {_few(moving)}, the table {_few(tip.joints)}",
                robot=truth.name,
            )
        )
    return joints


def _largest(
    tip: Tip, chain: KinematicChain, poses: Sequence[Sequence[float]]
) -> tuple[float, float, tuple[float, ...]]:
    """Largest position error [m] and largest angle error [rad] of a tip, and the joint vector of the first."""
    errors = [(*_errors(tip.pose(q), chain.forward_kinematics(tip.values(q))), tuple(q)) for q in poses]
    position, _, q = max(errors, key=itemgetter(0, 1), default=(0.0, 0.0, ()))
    return position, max((angle for _, angle, _ in errors), default=0.0), q


def _errors(truth: RigidTransform, found: RigidTransform) -> tuple[float, float]:
    """Position error [m] and angle error [rad]; infinite where a description holds what is not a number."""
    position, angle = position_error(truth, found), angle_error(truth, found)
    return (math.inf if math.isnan(position) else position, math.inf if math.isnan(angle) else angle)


def joint_ranges(truth: Truth, robot: Robot) -> list[tuple[float, float]]:
    """The ends of every joint's limits, as far as they are sampled [rad or m]; a full turn where there are none."""
    joints = {joint.name: joint for joint in robot.joints}
    return [_range(joints.get(name)) for name in truth.joints]


def _range(joint: Joint | None) -> tuple[float, float]:
    lower = joint.limits.lower if joint else None
    upper = joint.limits.upper if joint else None
    if lower is None or upper is None:
        return -math.pi, math.pi
    return max(lower, -LARGEST_SAMPLE), min(upper, LARGEST_SAMPLE)


def _few(names: Sequence[str], most: int = 8) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "") or "none"
