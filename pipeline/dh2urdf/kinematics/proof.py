"""The proof: what was written, read back by other code, moves tool0 as the DH product says, that of every arm.

Both ways from the root to a tool0, that of the tables and that of the file, are walked by `dh2urdf.kinematics.walk`:
those of one robot at one joint vector after the other, which needs no numpy; or at all joint vectors together, for one
robot or for many that differ in numbers only. Their arrays have the shape (P, N), for P joint vectors of N arms, and a
dimension of 1 where all are alike.

An arm's figures do not depend on the arms beside it. Elementwise sums do not. The cosine of an angle that moves is
numpy's, also where all arms have the same limits; that of one that does not is `exact_cos_sin`'s, which gives a column
what it gives a float.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from itertools import repeat
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.columns import replaced
from dh2urdf.errors import ProofError, RecordError
from dh2urdf.fields import many_unchecked, replace_unchecked
from dh2urdf.kinematics.chain import compile_joints, joints_between, leading, reach
from dh2urdf.kinematics.expected_poses import ExpectedPoses, joint_columns
from dh2urdf.kinematics.walk import CompiledChain, Frame, values_of
from dh2urdf.manipulator import TOOL, JointType
from dh2urdf.rotations import is_column
from dh2urdf.source import Messages, listed

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.kinematics.expected_poses import Array, Tip
    from dh2urdf.kinematics.walk import Numbers, Vector
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Joint, Robot

say = Messages(__file__)

TOLERANCE = 1e-9
"""What a written description may differ from the DH product: [m] per metre of arm, at least per 1 m, and [rad]."""
TOGETHER = 12_000
"""Joint vectors, counted for each arm, that are walked together: so many that their arrays stay in the cache."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Proof:
    """How far a written description is from the DH product."""

    position_error: float  # largest distance of a tool0 from where the DH product has it [m]
    angle_error: float  # largest angle between them [rad]
    # the joint vector of the largest position error, or of the largest angle error where positions agree
    q: tuple[float, ...]
    tolerance: float  # what `position_error` may be [m]
    poses: int  # how many joint vectors were compared
    tip: str = TOOL  # the frame of the largest position error: tool0, with its arm's prefix in a cell
    tips: dict[str, float] = field(default_factory=dict)  # the largest position error of every such frame [m]

    @property
    def holds(self) -> bool:
        """Whether the description is the same arm."""
        return math.isfinite(self.position_error) and (
            self.position_error <= self.tolerance and self.angle_error <= TOLERANCE
        )


def prove(expected: ExpectedPoses, written: Robot, poses: Sequence[Sequence[float]], *, at_once: bool = False) -> Proof:
    """Compare T(root → tool0), of every arm, of what was read back from the file with the DH product at joint vectors.

    At once, all of them are walked together: several times as fast, where numpy has been imported.

    Raises:
        ProofError: a written chain from the root to a tool0 does not have the tables' moving joints in order.
    """
    ways = {
        tip.link: (tip.compiled(), compile_joints(joints_to(expected, tip, written), tip.columns, written.followers))
        for tip in expected.tips
    }
    largest = _largest_at_once if at_once and poses else largest_errors
    found = {link: largest(said, way, poses) for link, (said, way) in ways.items()}
    worst = max(found, key=lambda link: found[link][:2])
    return Proof(
        position_error=found[worst].position,
        angle_error=max(errors.angle for errors in found.values()),
        q=found[worst].q,
        tolerance=TOLERANCE * max(1.0, *(tip.reach(poses) for tip in expected.tips)),
        poses=len(poses),
        tip=worst,
        tips={link: errors.position for link, errors in found.items()},
    )


def joints_to(expected: ExpectedPoses, tip: Tip, written: Robot) -> tuple[Joint, ...]:
    """The joints on the written way to a tip, of which those that move have to be those of the tables' way.

    Those that follow none have to be the same, too; how the others follow is seen in their poses.

    Raises:
        ProofError: there is no way, or it moves other joints.
    """
    try:
        joints = joints_between(written, tip.root or expected.root, tip.link)
    except RecordError as error:
        raise ProofError(problem.about(robot=expected.name) for problem in error.problems) from error
    moving = [joint.name for joint in joints if joint.type is not JointType.FIXED]
    if moving != list(tip.joints):
        written_joints, wanted = listed(moving, 8) or "none", listed(tip.joints, 8) or "none"
        raise ProofError(say("other-joints-move", robot=expected.name, moving=written_joints, wanted=wanted))
    if apart := sorted({*leading(moving, written.followers)} ^ tip.columns.keys()):
        raise ProofError(say("other-joints-lead", robot=expected.name, joints=listed(apart, 8)))
    return joints


# --- Errors


class LargestErrors(NamedTuple):
    """How far two chains of the same joints are from each other at most."""

    position: float  # largest distance [m]
    angle: float  # largest angle [rad]
    q: tuple[float, ...]  # the joint vector of the largest distance, and of the largest angle where distances agree


def largest_errors(said: CompiledChain, found: CompiledChain, poses: Iterable[Sequence[float]]) -> LargestErrors:
    """How far two chains of floats are from each other at most, at some joint vectors [rad or m]."""
    worst, largest = LargestErrors(0.0, 0.0, ()), 0.0
    for q in poses:
        values = values_of(q)
        [one], [other] = said.walk(values), found.walk(values)
        position = math.dist(one.origin, other.origin)
        chord = math.hypot(*map(math.dist, one.axes, other.axes))
        angle = _angle(chord) if math.isfinite(chord) else math.inf
        if not (math.isfinite(position) and angle < math.inf):
            position = math.inf
        largest = max(largest, angle)
        if not worst.q or (position, angle) > worst[:2]:
            worst = LargestErrors(position, angle, tuple(q))
    return worst._replace(angle=largest)


def _largest_at_once(said: CompiledChain, found: CompiledChain, poses: Sequence[Sequence[float]]) -> LargestErrors:
    """The largest errors of floats, all joint vectors walked together."""
    import numpy as np

    q = np.array(poses, dtype=float).reshape(len(poses), len(poses[0])).T[:, :, None].copy()
    with np.errstate(all="ignore"):  # What is not a number is an infinite error.
        values = values_of(q)
        frames = [chain.walk(values)[-1] for chain in (said, found)]
        position, angle, worst = _largest_of_arms(*_squared_differences(*frames, shape=(len(poses), 1)))
    return LargestErrors(position[0], angle[0], tuple(q[:, worst[0], 0].tolist()))


def _largest_of_arms(position: Array, angle: Array) -> tuple[list[float], list[float], Array]:
    """The largest errors of each of N arms, and the number of the joint vector of `LargestErrors.q`.

    Both arrays are of shape (P, N): squared distances of the tips [m²], sums of the squared differences of their axes.
    """
    import numpy as np

    # What is not a number is an infinite error.
    angle = np.where(np.isfinite(angle), angle, math.inf)
    position = np.where(np.isfinite(position) & (angle < math.inf), position, math.inf)
    largest = position.max(axis=0)
    worst = np.where(position == largest, angle, -1.0).argmax(axis=0)
    angles = list(map(_angle, np.sqrt(angle.max(axis=0)).tolist()))
    return np.sqrt(largest).tolist(), angles, worst


def _squared_differences(one: Frame, other: Frame, *, shape: tuple[int, int]) -> tuple[Array, Array]:
    """The squared distance of two frames' origins [m²], and the sum of the squared differences of their axes."""
    import numpy as np

    position = _squared_distance(one.origin, other.origin)
    x, y, z = map(_squared_distance, one.axes, other.axes)
    return np.broadcast_to(position, shape), np.broadcast_to(x + y + z, shape)


def _squared_distance(one: Vector, other: Vector) -> Numbers:
    x, y, z = [left - right for left, right in zip(one, other, strict=True)]
    return x * x + y * y + z * z


def _angle(chord: float) -> float:
    """The angle [rad] between two rotations R and S whose difference has a Frobenius norm of `chord`.

    ‖R − S‖ = 2√2·sin(angle/2); no two rotations are further apart than half a turn, and infinity is kept.
    """
    half_sine = chord / math.sqrt(8.0)
    return 2.0 * math.asin(half_sine) if half_sine <= 1.0 else max(math.pi, half_sine)


# --- Many at once


def prove_columns(
    tables: ManipulatorColumns, robots: RobotColumns, written: Sequence[tuple[Sequence[int], Robot]], count: int
) -> list[Proof | ProofError | None]:
    """Compare T(base_link → tool0) of what was written with the DH product, at the joint vectors of `proof_vectors`.

    What was read back from the files is in groups, each with the places of its members among the tables.

    Returns:
        For each table its proof; why there is none, where the written chain does not have the table's moving joints in
        order; None where no group has its file.
    """
    found: dict[int, Proof | ProofError] = {}
    expected = ExpectedPoses.of(tables.table)
    for places, described in written:
        if robots.robot.attachments:
            from dh2urdf.kinematics.attached import prove_attachments

            try:
                prove_attachments(robots.robot, described, masses=False)
            except ProofError as error:
                found.update(dict.fromkeys(places, error))
                continue
        try:
            tip, followers = expected.tips[0], described.followers
            joints = joints_to(expected, tip, described)
        except ProofError:  # Of each of the group, with its own name.
            for place in places:
                own = ExpectedPoses.of(tables.pick(place))
                try:
                    joints_to(own, own.tips[0], replace(described, name=own.name))
                except ProofError as error:
                    found[place] = error
            continue
        way = compile_joints(joints, tip.columns, followers)
        proofs = _proofs(tables.table, robots.robot, way, places=places, count=count)
        found.update(zip(places, proofs, strict=True))
    return [found.get(place) for place in range(len(tables))]


def _proofs(table: Manipulator, robot: Robot, way: CompiledChain, *, places: Sequence[int], count: int) -> list[Proof]:
    """The proofs of arms whose files move the joints of their tables.

    Table and robot are in columns, in which the arms have these places; the way of the files is in columns of its own.
    """
    import numpy as np

    chosen = np.array(places)

    def of_places(numbers: Numbers) -> Numbers:
        return numbers[chosen]

    table = replace_unchecked(table, rows=replaced(table.rows, of_places))
    q = joint_columns(table, replaced(robot.joints, of_places), count)
    with np.errstate(all="ignore"):
        tip = ExpectedPoses.of(table).tips[0]
        chains = tip.compiled(), way
        values = values_of(q)
    poses, arms = 3 + count, len(places)
    at_once = max(1, TOGETHER // arms)
    differences = []
    with np.errstate(all="ignore"):
        for first in range(0, poses, at_once):
            some = [tuple([number[first : first + at_once] for number in value]) for value in values]
            tips = [frame for chain in chains for frame in chain.walk(some)]
            differences.append(_squared_differences(*tips, shape=(min(at_once, poses - first), arms)))
    positions, angles, worst = _largest_of_arms(*map(np.concatenate, zip(*differences, strict=True)))
    vectors = [value[worst, range(arms) if value.shape[1] > 1 else 0].tolist() for value in q]
    travel = tip.way[0].travel(dict(zip(tip.columns, q, strict=True)))
    travel = travel.max(axis=0) if is_column(travel) else travel
    return many_unchecked(
        Proof(position_error=0.0, angle_error=0.0, q=(), tolerance=0.0, poses=poses),
        arms,
        position_error=positions,
        angle_error=angles,
        q=zip(*vectors, strict=True) if vectors else repeat(()),
        tolerance=np.broadcast_to(TOLERANCE * np.maximum(1.0, reach(table) + travel), arms).tolist(),
        tips=[{TOOL: position} for position in positions],
    )
