"""Where the tables have the tips of a robot: what everything that is written is measured against.

A robot made of one table has one tip, tool0, and its pose is the DH product. A cell of several arms has a tool0 of
each, whose pose is a product of such products: along every arm on the way, from the world outwards, its placement and
then its rows, up to the link that holds the next arm.

The joint vectors of proofs and of simulators are the same on every machine and in every run: zero, both ends of the
limits, and pseudo-random ones inside the limits. These are the same fractions of their limits for all arms of as many
joints, so that arms with the same limits are proved at the same joint vectors, and many of them at once.
"""

from __future__ import annotations

import math
import random
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dh2urdf.kinematics.chain import compile_table, leading, reach
from dh2urdf.kinematics.walk import CompiledChain, values_of
from dh2urdf.manipulator import ROOT, TOOL, JointType, Manipulator
from dh2urdf.robot import with_followers
from dh2urdf.rotations import IDENTITY, RigidTransform, greater_of, norm, smaller_of, total
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.kinematics.walk import Numbers
    from dh2urdf.robot import Joint, Robot

Poses: TypeAlias = tuple[tuple[float, ...], ...]
Array: TypeAlias = Any
"""An array of numpy, which is imported where one is made."""

LARGEST_SAMPLE = 1e3
"""Joint values beyond this are not sampled [rad or m]: an arm is proved where it can be, not at limits of 1e300."""


class Stretch(NamedTuple):
    """The way along one arm."""

    manipulator: Manipulator  # its table as far as the way goes; what follows the last of these rows is its tool
    prefix: str = ""  # what stands before the names of its joints in the robot
    placement: RigidTransform = IDENTITY  # the arm's root link in what holds it

    @property
    def leading(self) -> tuple[str, ...]:
        """Names of the joints in the robot that decide where these are: one of them may be behind the last row."""
        moving = [row.joint for row in self.manipulator.moving_rows]
        return tuple([self.prefix + name for name in leading(moving, self.manipulator.followers)])

    def travel(self, values: Mapping[str, Numbers]) -> Numbers:
        """How far its joints slide altogether [m], at values of the joints that lead [rad or m]; takes columns."""
        own = {name.removeprefix(self.prefix): values[name] for name in self.leading}
        every, rows = with_followers(own, self.manipulator.followers), self.manipulator.moving_rows
        return total(abs(every[row.joint]) for row in rows if row.type is JointType.PRISMATIC)


@dataclass(frozen=True, slots=True, kw_only=True)
class Tip:
    """A frame whose pose the tables say."""

    link: str
    way: tuple[Stretch, ...]  # the arms on the way to it, from the root outwards
    columns: Mapping[str, int]  # by joint the entries of the robot's joint vector that move it, as the way has them
    root: str | None = None  # the link where the way begins, where that is not the root of the robot

    @property
    def joints(self) -> tuple[str, ...]:
        """The moving joints on the way, from the root outwards."""
        return tuple([each.prefix + row.joint for each in self.way for row in each.manipulator.moving_rows])

    def compiled(self) -> CompiledChain:
        """The way to it, as moves and turns, at joint vectors of the robot: the product of the DH products."""
        chain = CompiledChain()
        for stretch in self.way:
            chain.transform(stretch.placement)
            numbers = {name.removeprefix(stretch.prefix): self.columns[name] for name in stretch.leading}
            compile_table(chain, stretch.manipulator, numbers)
        chain.stop()
        return chain

    def pose(self, q: Sequence[float]) -> RigidTransform:
        """T(root → tip) at a joint vector of the robot [rad or m]."""
        return self.compiled().walk(values_of(q))[0].transform

    def reach(self, poses: Sequence[Sequence[float]]) -> float:
        """An upper bound of its distance from the root at some joint vectors [m]."""
        length = total(norm(placement.translation) + reach(table) for table, _, placement in self.way)
        if not any(row.type is JointType.PRISMATIC for stretch in self.way for row in stretch.manipulator.rows):
            return length
        values = ({name: q[column] for name, column in self.columns.items()} for q in poses)
        return length + max((total(stretch.travel(own) for stretch in self.way) for own in values), default=0.0)


@dataclass(frozen=True, slots=True, kw_only=True)
class ExpectedPoses:
    """What the tables declare about a robot."""

    name: str
    root: str = ROOT  # name of its root link
    tips: tuple[Tip, ...]  # the frames whose poses follow from the tables
    joints: tuple[str, ...]  # its actuated joints; a joint vector has an entry for each
    mark: Mark | None = None  # where the robot is in its file

    @classmethod
    def of(cls, manipulator: Manipulator) -> ExpectedPoses:
        """The poses of a robot that is one arm."""
        joints = tuple(row.joint for row in manipulator.actuated_rows)
        columns = {name: number for number, name in enumerate(joints)}
        tip = Tip(link=TOOL, way=(Stretch(manipulator),), columns=columns)
        return cls(name=manipulator.name, tips=(tip,), joints=joints, mark=manipulator.mark)


# --- Joint vectors


@lru_cache(maxsize=32)
def fractions(joints: int, count: int) -> Poses:
    """The random joint vectors, as fractions of the joints' ranges; the first of many are those of few."""
    draw = random.Random(f"dh2urdf {joints}")  # noqa: S311 - reproducible on purpose
    return tuple(tuple(draw.random() for _ in range(joints)) for _ in range(count))


def joint_vectors(expected: ExpectedPoses, robot: Robot, count: int) -> Poses:
    """So many joint vectors inside the limits of a robot: the one nearest to zero, then random ones [rad or m]."""
    ranges = joint_ranges(expected, robot)
    nearest_to_zero = tuple(min(max(0.0, lower), upper) for lower, upper in ranges)
    others = (
        tuple(lower + u * (upper - lower) for u, (lower, upper) in zip(row, ranges, strict=True))
        for row in fractions(len(ranges), max(0, count - 1))
    )
    return (nearest_to_zero, *others) if count > 0 else ()


def proof_vectors(expected: ExpectedPoses, robot: Robot, count: int) -> Poses:
    """The joint vectors of a proof: all zero (inside the limits or not), both ends, and `count` inside the limits."""
    ranges = joint_ranges(expected, robot)
    ends = [tuple(0.0 for _ in ranges), tuple(low for low, _ in ranges), tuple(high for _, high in ranges)]
    return (*ends, *joint_vectors(expected, robot, count))


def joint_columns(table: Manipulator, moving: Sequence[Joint], count: int) -> list[Array]:
    """For each actuated joint its values [rad or m], of shape (P, N), or (P, 1) where all arms have the same limits."""
    import numpy as np

    joints = {joint.name: joint for joint in moving}
    names = [row.joint for row in table.actuated_rows]
    inside = np.array(fractions(len(names), max(0, count - 1))).reshape(max(0, count - 1), len(names), 1)
    values = []
    for index, name in enumerate(names):
        lower, upper = _range(joints.get(name))
        nearest_to_zero = np.minimum(np.maximum(0.0, lower), upper)
        ends = np.stack(np.broadcast_arrays(0.0, lower, upper, nearest_to_zero)).reshape(4, -1)
        values.append(np.concatenate((ends, lower + inside[:, index] * (upper - lower)))[: 3 + count])
    return values


def joint_ranges(expected: ExpectedPoses, robot: Robot) -> list[tuple[float, float]]:
    """The ends of every joint's limits, as far as they are sampled [rad or m]; a full turn where there are none."""
    joints = {joint.name: joint for joint in robot.joints}
    return [_range(joints.get(name)) for name in expected.joints]


def _range(joint: Joint | None) -> tuple[Numbers, Numbers]:
    """The joint values that are sampled [rad or m]; takes columns."""
    if joint is None or joint.limits.lower is None or joint.limits.upper is None:
        return -math.pi, math.pi
    return greater_of(joint.limits.lower, -LARGEST_SAMPLE), smaller_of(joint.limits.upper, LARGEST_SAMPLE)
