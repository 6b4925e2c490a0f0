"""The proof: what was written, read back by other code, moves tool0 as the DH product says.

The joint vectors are the same on every machine and in every run: zero, both ends of the limits, and pseudo-random
ones inside the limits, seeded by the manipulator's name.
"""

from __future__ import annotations

import math
import random
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeAlias

from dh2urdf.errors import ProofError
from dh2urdf.kinematics import KinematicChain, angle_error, forward_kinematics, position_error, reach
from dh2urdf.manipulator import JointType
from dh2urdf.source import Problem

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import Manipulator
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
        position_error: largest distance of tool0 from where the DH product has it [m].
        angle_error: largest angle between them [rad].
        q: the joint vector of the largest position error, or of the largest angle error where positions agree.
        tolerance: what `position_error` may be [m].
        poses: how many joint vectors were compared.
    """

    position_error: float
    angle_error: float
    q: tuple[float, ...]
    tolerance: float
    poses: int

    @property
    def holds(self) -> bool:
        """Whether the description is the same arm."""
        return self.position_error <= self.tolerance and self.angle_error <= TOLERANCE


def joint_vectors(manipulator: Manipulator, robot: Robot, count: int) -> Poses:
    """Joint vectors inside the limits: the one nearest to zero, then random ones [rad or m].

    Args:
        manipulator: the table; a vector has a value for each of its moving rows, in order.
        robot: the robot made of it, whose joints have the limits that the table left open.
        count: how many.
    """
    joints = {joint.name: joint for joint in robot.joints}
    ranges = [_range(joints.get(row.joint)) for row in manipulator.moving_rows]
    draw = random.Random(f"dh2urdf {manipulator.name}")  # noqa: S311 - reproducible on purpose
    nearest_to_zero = tuple(min(max(0.0, lower), upper) for lower, upper in ranges)
    others = (tuple(draw.uniform(*limits) for limits in ranges) for _ in range(count - 1))
    return (nearest_to_zero, *others) if count > 0 else ()


def proof_vectors(manipulator: Manipulator, robot: Robot, count: int) -> Poses:
    """The joint vectors of a proof: all zero (inside the limits or not), both ends, and `count` inside the limits."""
    joints = {joint.name: joint for joint in robot.joints}
    ranges = [_range(joints.get(row.joint)) for row in manipulator.moving_rows]
    ends = [tuple(0.0 for _ in ranges), tuple(low for low, _ in ranges), tuple(high for _, high in ranges)]
    return (*ends, *joint_vectors(manipulator, robot, count))


def prove(manipulator: Manipulator, written: Robot, poses: Sequence[Sequence[float]]) -> Proof:
    """Compare T(base_link → tool0) of what was written with the DH product.

    Args:
        manipulator: the table.
        written: the robot read back from the file.
        poses: joint vectors, one value per moving row [rad or m].

    Raises:
        ProofError: the written chain from base_link to tool0 does not have the table's moving joints in order.
    """
    try:
        chain = KinematicChain.between(written)
    except ValueError as error:
        raise ProofError(Problem(message=str(error), robot=manipulator.name)) from error
    names = [row.joint for row in manipulator.moving_rows]
    moving = [joint.name for joint in chain.joints if joint.type is not JointType.FIXED]
    if moving != names:
        raise ProofError(
            Problem(
                message=f"the written chain moves the joints {_few(moving)}, the table {_few(names)}",
                robot=manipulator.name,
            )
        )
    errors = [(*_errors(forward_kinematics(manipulator, q), chain.forward_kinematics(q)), tuple(q)) for q in poses]
    worst_position, _, worst_q = max(errors, default=(0.0, 0.0, ()))
    return Proof(
        position_error=worst_position,
        angle_error=max((angle for _, angle, _ in errors), default=0.0),
        q=worst_q,
        tolerance=TOLERANCE * max(1.0, reach(manipulator) + _travel(manipulator, poses)),
        poses=len(poses),
    )


def _errors(truth: RigidTransform, found: RigidTransform) -> tuple[float, float]:
    """Position error [m] and angle error [rad]; infinite where a description holds what is not a number."""
    position, angle = position_error(truth, found), angle_error(truth, found)
    return (math.inf if math.isnan(position) else position, math.inf if math.isnan(angle) else angle)


def _range(joint: Joint | None) -> tuple[float, float]:
    lower = joint.limits.lower if joint else None
    upper = joint.limits.upper if joint else None
    if lower is None or upper is None:
        return -math.pi, math.pi
    return max(lower, -LARGEST_SAMPLE), min(upper, LARGEST_SAMPLE)


def _travel(manipulator: Manipulator, poses: Sequence[Sequence[float]]) -> float:
    """How far prismatic joints take tool0 beyond the reach at zero [m]."""
    sliding = [i for i, row in enumerate(manipulator.moving_rows) if row.type is JointType.PRISMATIC]
    return max((sum(abs(q[i]) for i in sliding) for q in poses), default=0.0)


def _few(names: Sequence[str], most: int = 8) -> str:
    return ", ".join(names[:most]) + (f" and {len(names) - most} more" if len(names) > most else "") or "none"
