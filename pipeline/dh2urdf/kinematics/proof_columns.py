"""The proof of many written descriptions at once: as `proof`, for manipulators that differ in numbers only.

Both ways from base_link to tool0, that of the tables and that of the files, are walked for many arms and all joint
vectors together. Arrays have the shape (P, N), for P joint vectors of N arms, and a dimension of 1 where all are alike.
A walk carries the three axes of a frame and its origin; every step turns two of the axes or moves the origin, by one
elementwise sum for x, y and z of all arms.

An arm's figures do not depend on the arms beside it. Elementwise sums do not. A product with a 0, 1 or −1 that all arms
have alike is left out, which changes no digit. The cosine of an angle that moves is numpy's, also where all arms have
the same limits; that of one that does not is `exact_cos_sin`'s, which gives a column what it gives a float.
"""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import repeat
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.elementwise import greater_of, is_column, smaller_of
from dh2urdf.errors import ProofError
from dh2urdf.kinematics.chain import TOOL, joint_variables, reach
from dh2urdf.kinematics.expected_poses import Truth
from dh2urdf.kinematics.proof import LARGEST_SAMPLE, TOLERANCE, Proof, fractions, joints_to
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.rotations import exact_cos_sin
from dh2urdf.validation.coercion import replace_unchecked

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from dh2urdf.columns import ManipulatorColumns, RobotColumns
    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.rotations import RigidTransform

Array: TypeAlias = Any
"""An array of numpy, which is imported where one is made."""
Numbers: TypeAlias = Any
"""A float, or an array of shape (N,), (P, N) or (P, 1)."""
Turn: TypeAlias = tuple[Numbers, Numbers]
"""Cosine and sine of an angle."""
Pick: TypeAlias = "Callable[[Numbers], Numbers]"
"""Gives the numbers of some arms of those of all."""

BLOCK = 256
"""Arms that are walked together: so many that their arrays stay in the processor's cache."""


def prove_columns(
    tables: ManipulatorColumns, robots: RobotColumns, written: Sequence[tuple[Sequence[int], Robot]], count: int
) -> list[Proof | ProofError | None]:
    """Compare T(base_link → tool0) of what was written with the DH product, at the joint vectors of `proof_vectors`.

    Args:
        tables: what the tables say.
        robots: the robots made of them, whose joints have the limits that the tables left open.
        written: what was read back from the files, in groups, each with the places of its members among the tables.
        count: random joint vectors of each proof, besides zero, both ends of the limits and the nearest to zero.

    Returns:
        For each table its proof; why there is none, where the written chain does not have the table's moving joints in
        order; None where no group has its file.
    """
    found: dict[int, Proof | ProofError] = {}
    truth = Truth.of(tables.table)
    for places, described in written:
        try:
            joints = joints_to(truth, truth.tips[0], described)
        except ProofError:
            found.update(_refusals(tables, places, described))
            continue
        for first in range(0, len(places), BLOCK):
            block = places[first : first + BLOCK]
            proofs = _proofs(tables.table, robots.robot, joints, places=block, first=first, count=count)
            found.update(zip(block, proofs, strict=True))
    return [found.get(place) for place in range(len(tables))]


def _refusals(tables: ManipulatorColumns, places: Sequence[int], described: Robot) -> Iterator[tuple[int, ProofError]]:
    """Why there is no proof, for each of the members of a group, with its name."""
    for place in places:
        truth = Truth.of(tables.pick(place))
        try:
            joints_to(truth, truth.tips[0], replace(described, name=truth.name))
        except ProofError as error:
            yield place, error


def _proofs(
    table: Manipulator, robot: Robot, joints: Sequence[Joint], *, places: Sequence[int], first: int, count: int
) -> list[Proof]:
    """The proofs of a block of arms.

    Args:
        table: what the tables say, in columns.
        robot: the robots made of them, in columns.
        joints: those of the written ways to tool0, in columns of their own.
        places: where the arms stand in the columns of the first two.
        first: where the first of them stands in the columns of the written ways; the others follow.
        count: random joint vectors.
    """
    import numpy as np

    chosen = np.array(places)

    def of_tables(numbers: Numbers) -> Numbers:
        return numbers[chosen] if is_column(numbers) else numbers

    def of_files(numbers: Numbers) -> Numbers:
        return numbers[first : first + len(places)] if is_column(numbers) else numbers

    table = replace_unchecked(table, rows=tuple([_row(row, of_tables) for row in table.rows]))
    with np.errstate(all="ignore"):  # What is not a number is an infinite error.
        q = _joint_values(table, robot, of_tables, count)
        turns = [(np.cos(values), np.sin(values)) for values in q]
        said, found = _walk_table(table, q, turns), _walk_joints(joints, q, turns, of_files)
        position, angle = (
            np.broadcast_to(square, (3 + count, len(places))) for square in _squared_differences(said, found)
        )
        return _worst(position, angle, q, _tolerances(table, q, len(places)))


def _row(row: DHRow, pick: Pick) -> DHRow:
    """The kinematics of a row, for some arms."""
    return replace_unchecked(
        row, a=pick(row.a), alpha=pick(row.alpha), d=pick(row.d), theta=pick(row.theta), offset=pick(row.offset)
    )


# --- Joint vectors


def _joint_values(table: Manipulator, robot: Robot, pick: Pick, count: int) -> list[Array]:
    """For each moving joint its values [rad or m], of shape (P, N), or (P, 1) where all arms have the same limits."""
    import numpy as np

    joints = {joint.name: joint for joint in robot.joints}
    names = [row.joint for row in table.moving_rows]
    inside = np.array(fractions(len(names), max(0, count - 1))).reshape(max(0, count - 1), len(names), 1)
    values = []
    for index, name in enumerate(names):
        lower, upper = _range(joints.get(name), pick)
        nearest_to_zero = np.minimum(np.maximum(0.0, lower), upper)
        ends = np.stack(np.broadcast_arrays(0.0, lower, upper, nearest_to_zero)).reshape(4, -1)
        values.append(np.concatenate((ends, lower + inside[:, index] * (upper - lower)))[: 3 + count])
    return values


def _range(joint: Joint | None, pick: Pick) -> tuple[Numbers, Numbers]:
    """The joint values that are sampled [rad or m]."""
    lower = pick(joint.limits.lower) if joint else None
    upper = pick(joint.limits.upper) if joint else None
    if lower is None or upper is None:
        return -math.pi, math.pi
    return greater_of(lower, -LARGEST_SAMPLE), smaller_of(upper, LARGEST_SAMPLE)


# --- Walks from base_link to tool0


class _CarriedFrame:
    """A frame of each arm at each joint vector, carried from step to step.

    Attributes:
        axes: its x, y and z axis in base_link, of shape (3, P, N) each.
        origin: its origin in base_link, of the same shape [m].
    """

    def __init__(self) -> None:
        import numpy as np

        self.axes: list[Array] = [axis.reshape(3, 1, 1) for axis in np.eye(3)]
        self.origin: Array = np.zeros((3, 1, 1))

    def move(self, along: int, length: Numbers) -> None:
        """A step along one of its axes: 0, 1, 2 for x, y, z [m]."""
        self.origin = _sum((1.0, self.origin), (length, self.axes[along]))

    def turn(self, about: int, cosine: Numbers, sine: Numbers) -> None:
        """A turn about one of its axes."""
        after, last = (about + 1) % 3, (about + 2) % 3
        u, v = self.axes[after], self.axes[last]
        self.axes[after], self.axes[last] = _sum((cosine, u), (sine, v)), _sum((cosine, v), (-sine, u))

    def transform(self, transform: RigidTransform) -> None:
        """A rigid transform."""
        r, t = transform
        for along, length in enumerate(t):
            self.move(along, length)
        self._mix(r)

    def turn_about(self, axis: Sequence[Numbers], cosine: Numbers, sine: Numbers) -> None:
        """A turn about a vector, given in the frame (Rodrigues' formula).

        The diagonal x² + c·(1 − x²) is c + x²·(1 − c), and exact about the axes of the frame.
        """
        x, y, z = axis
        versine = 1.0 - cosine
        xx, yy, zz = (_sum((k * k, 1.0), (1.0 - k * k, cosine)) for k in axis)
        xs, ys, zs = (_product(k, sine) for k in axis)
        xy, xz, yz = (_product(k, versine) for k in (x * y, x * z, y * z))
        self._mix(
            (
                *(xx, _difference(xy, zs), _sum((1.0, xz), (1.0, ys))),
                *(_sum((1.0, xy), (1.0, zs)), yy, _difference(yz, xs)),
                *(_difference(xz, ys), _sum((1.0, yz), (1.0, xs)), zz),
            )
        )

    def _mix(self, matrix: Sequence[Numbers]) -> None:
        """Takes the columns of a matrix, row by row, for new axes."""
        self.axes = [_sum(*zip(matrix[i::3], self.axes, strict=True)) for i in range(3)]


def _walk_table(table: Manipulator, q: Sequence[Array], turns: Sequence[Turn]) -> _CarriedFrame:
    """T(q) = base · A_1 · … · A_N · tool, of rows that are Rz(theta)·Tz(d) and Tx(a)·Rx(alpha), in either order."""
    frame = _CarriedFrame()
    frame.transform(table.base)
    moving = iter(zip(q, turns, strict=True))
    for row in table.rows:
        turn, d = exact_cos_sin(joint_variables(row)[0]), row.d
        if row.type is not JointType.FIXED:
            value, turned = next(moving)
            if row.type is JointType.PRISMATIC:
                d = joint_variables(row, value)[1]
            else:
                turn = _together(turn, turned, row.sign)
        if table.convention is Convention.STANDARD:
            frame.turn(2, *turn)
            frame.move(2, d)
            frame.move(0, row.a)
            frame.turn(0, *exact_cos_sin(row.alpha))
        else:
            frame.move(0, row.a)
            frame.turn(0, *exact_cos_sin(row.alpha))
            frame.turn(2, *turn)
            frame.move(2, d)
    frame.transform(table.tool)
    return frame


def _together(first: Turn, second: Turn, sign: int) -> Turn:
    """Cosine and sine of the sum of two angles, or of their difference."""
    (c, s), (cosine, sine) = first, second
    return _sum((c, cosine), (-sign * s, sine)), _sum((s, cosine), (sign * c, sine))


def _walk_joints(joints: Sequence[Joint], q: Sequence[Array], turns: Sequence[Turn], pick: Pick) -> _CarriedFrame:
    """T(q) of a description: at each joint its origin, xyz and then yaw, pitch and roll, and its motion."""
    frame = _CarriedFrame()
    moving = iter(zip(q, turns, strict=True))
    for joint in joints:
        for along, length in enumerate(joint.origin.xyz):
            frame.move(along, pick(length))
        for about in (2, 1, 0):
            frame.turn(about, *exact_cos_sin(pick(joint.origin.rpy[about])))
        if joint.type is JointType.FIXED:
            continue
        axis = [pick(k) for k in joint.axis]
        value, turned = next(moving)
        if joint.type is JointType.PRISMATIC:
            for along, k in enumerate(axis):
                frame.move(along, _product(k, value))
        else:
            frame.turn_about(axis, *turned)
    return frame


# --- Sums that leave out what is nothing for all


def _product(factor: Numbers, numbers: Numbers) -> Numbers:
    if is_column(factor):
        return factor * numbers
    if factor == 0:
        return 0.0
    if factor == 1:
        return numbers
    return -numbers if factor == -1 else factor * numbers


def _sum(*products: tuple[Numbers, Numbers]) -> Numbers:
    total: Numbers = 0.0
    for factor, numbers in products:
        term = _product(factor, numbers)
        total = term if _is_nothing(total) else total if _is_nothing(term) else total + term
    return total


def _difference(left: Numbers, right: Numbers) -> Numbers:
    return -right if _is_nothing(left) else left if _is_nothing(right) else left - right


def _is_nothing(numbers: Numbers) -> bool:
    return not is_column(numbers) and numbers == 0


# --- Errors


def _squared_differences(said: _CarriedFrame, found: _CarriedFrame) -> tuple[Array, Array]:
    """The squared distance of two frames' origins [m²], and the sum of the squared differences of their axes."""
    position = _squared(said.origin - found.origin)
    x, y, z = (_squared(one - other) for one, other in zip(said.axes, found.axes, strict=True))
    return position, x + y + z


def _squared(vectors: Array) -> Array:
    x, y, z = vectors * vectors
    return x + y + z


def _worst(position: Array, angle: Array, q: Sequence[Array], tolerances: Sequence[float]) -> list[Proof]:
    """The proofs of squared errors of shape (P, N)."""
    import numpy as np

    poses, arms = position.shape
    angle = np.where(np.isfinite(angle), angle, math.inf)
    position = np.where(np.isfinite(position) & (angle < math.inf), position, math.inf)
    largest = position.max(axis=0)
    worst = np.where(position == largest, angle, -1.0).argmax(axis=0)
    every = range(arms)
    vectors = [np.broadcast_to(values, position.shape)[worst, every].tolist() for values in q]
    return [
        Proof(
            position_error=distance,
            angle_error=_angle(chord),
            q=vector,
            tolerance=tolerance,
            poses=poses,
            tips={TOOL: distance},
        )
        for distance, chord, tolerance, vector in zip(
            np.sqrt(largest).tolist(),
            np.sqrt(angle.max(axis=0)).tolist(),
            tolerances,
            zip(*vectors, strict=True) if q else repeat(()),
            strict=bool(q),
        )
    ]


def _angle(chord: float) -> float:
    """The angle [rad] between two rotations R and S whose difference has a Frobenius norm of `chord`.

    ‖R − S‖ = 2√2·sin(angle/2); no two rotations are further apart than half a turn, and infinity is kept.
    """
    half_sine = chord / math.sqrt(8.0)
    return 2.0 * math.asin(half_sine) if half_sine <= 1.0 else max(math.pi, half_sine)


def _tolerances(table: Manipulator, q: Sequence[Array], arms: int) -> list[float]:
    """What each position error may be [m]."""
    import numpy as np

    slides = [abs(v) for row, v in zip(table.moving_rows, q, strict=True) if row.type is JointType.PRISMATIC]
    travel = sum(slides[1:], slides[0]).max(axis=0) if slides else 0.0
    tolerances: list[float] = np.broadcast_to(TOLERANCE * np.maximum(1.0, reach(table) + travel), arms).tolist()
    return tolerances
