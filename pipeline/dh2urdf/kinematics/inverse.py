"""Inverse kinematics: a joint vector inside the limits that brings a link to a pose, or as near as it comes.

Levenberg-Marquardt on the geometric Jacobian (Sugihara, Solvability-Unconcerned Inverse Kinematics by the
Levenberg-Marquardt Method, IEEE T-RO 27, 2011), with joints that are held at a limit while the step leads out of it.
Lengths are divided by the reach of the arm, or by the distance of a pose beyond it: a small robot and a crane converge
alike, and where a pose cannot be reached, a length counts as a turn of that part of the reach.

How well an arm can move from a joint vector: Yoshikawa, Manipulability of Robotic Mechanisms, IJRR 4(2), 1985. Lengths
are in m, and are not weighed against angles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import RecordValueError
from dh2urdf.fields import Record
from dh2urdf.kinematics.chain import (
    angle_error,
    compile_joints,
    compile_table,
    position_error,
    reach,
    screws_in_frames,
    screws_in_links,
)
from dh2urdf.kinematics.joint_vectors import joint_values
from dh2urdf.kinematics.pose_arrays import Way, jacobian_of, joints_of, led, table_jacobian
from dh2urdf.kinematics.walk import CompiledChain, values_of
from dh2urdf.manipulator import TOOL, JointType, Manipulator
from dh2urdf.rotations import RigidTransform, multiply, norm, transpose
from dh2urdf.source import Mark, Messages

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from dh2urdf.kinematics.joint_vectors import JointNames
    from dh2urdf.manipulator import DHRow, Follower, JointVectors, Limits
    from dh2urdf.robot import Joint, Robot

    Vector = NDArray[np.float64]

say = Messages(__file__)

ATTEMPTS = 24
"""Joint vectors from which a solution is looked for: the one that is given, and random ones, always the same."""
REACHED = 1e-9
"""How far tool0 may be from the pose [m for an arm that reaches 1 m, and rad]."""
STEPS = 200
_LONGEST = 0.5  # of a step [rad, or part of the reach]: nothing jumps at a singularity
_STIFFEST = 1e9  # damping from which no step is long enough to change a double
_NEAR_HALF_TURN = -0.9  # cosine of an angle below which its sine is no good measure of the axis
_TINY = 1e-300
_FUNCTION = "inverse_kinematics()"


class InverseSolution(NamedTuple):
    """The joint vector that brings a link nearest to a pose.

    Attributes:
        q: one value per joint that moves the link, inside its limits and those of its followers [rad or m].
        position_error: how far the link is from the pose [m].
        angle_error: the angle between them [rad].
        reached: whether both are rounding only.
    """

    q: tuple[float, ...]
    position_error: float
    angle_error: float
    reached: bool


@dataclass(frozen=True)
class _Target(Record):
    pose: RigidTransform


def inverse_kinematics(
    manipulator: Manipulator | Robot,
    pose: RigidTransform | ArrayLike,
    start: JointVectors | None = None,
    *,
    link: str = TOOL,
    attempts: int = ATTEMPTS,
) -> InverseSolution:
    """A joint vector that brings a link to a pose, through all joints from the root to the link.

    Args:
        manipulator: the arm; or a robot, such as a cell, where an arm may be on the tool of another one.
        pose: T(base_link → tool0) of an arm, T(root → link) of a robot, as a transform or as a 4x4 matrix.
        start: the joint vector to begin at, as `Manipulator.fk` and `Robot.fk` accept it; by default the middle of
            the limits, or 0. The solution is usually the one nearest to it.
        link: the link of a robot: in a cell the tool0 of an arm has the arm's prefix. Of an arm it is tool0.
        attempts: how many joint vectors to begin at. 1 follows a target without a change of branch.

    Returns:
        The first solution that reaches the pose; else the nearest that was found.

    Raises:
        RecordError: the pose is none, the start is no joint vector of the arm, or there is no such link.
    """
    import numpy as np

    target = _Target(pose).pose  # type: ignore[arg-type]  # a record takes matrices
    if attempts < 1:
        raise RecordValueError(say("no-attempts", Mark(file=_FUNCTION), field="attempts", attempts=attempts))
    search = _PoseSearch(_moved_link(manipulator, link), target)
    if start is None:
        first = search.middle
    else:
        values, _ = joint_values(start, search.names)
        first = np.clip(np.array([float(value) for value in values]), search.lower, search.upper)
    search.start = first
    random = np.random.default_rng(0)
    best = search.descend(first)
    for _ in range(attempts - 1):
        if best.reached:
            break
        drawn = search.begin + random.random(len(first)) * search.range
        other = search.descend(np.clip(drawn, search.lower, search.upper))
        if search.cost(other) < search.cost(best):
            best = other
    return best


class _MovedLink(NamedTuple):
    """The link that is to reach a pose, and what moves it."""

    names: JointNames
    moving: Sequence[DHRow | Joint]  # the joints that move by themselves, with their types and limits
    followers: Sequence[tuple[Follower, Limits]]  # how others follow them, and the limits of these
    reach: float  # distance from the root to the link at most, prismatic joints at 0 [m]
    # frames by which the axes are known, and that of the link at last, in the root link, from one value for each joint
    frames: Callable[[Sequence[float]], list[RigidTransform]]
    # the geometric Jacobian of shape (6, n), given these frames and values
    jacobian: Callable[[Sequence[RigidTransform], Sequence[float]], Vector]


def _moved_link(model: Manipulator | Robot, link: str) -> _MovedLink:
    if isinstance(model, Manipulator):
        if link != TOOL:
            raise RecordValueError(say("link-of-table", Mark(file=_FUNCTION), field="link", found=link))
        table, compiled = model, CompiledChain()
        compile_table(compiled, table, with_frames=True)
        compiled.stop()
        names, followers = joints_of(table, _FUNCTION), table.followers
        rows = {row.joint: row for row in table.moving_rows}

        def of_table(frames: Sequence[RigidTransform], values: Sequence[float]) -> Vector:
            columns = jacobian_of(screws_in_frames(table, frames[:-1]), frames[-1].translation, (), _FUNCTION)
            return led(columns, rows, dict(zip(names.moving, values, strict=True)), followers)

        return _MovedLink(
            names=names,
            moving=table.actuated_rows,
            followers=[(law, rows[name].limits) for name, law in followers.items()],
            reach=reach(table),
            frames=partial(_walked, compiled),
            jacobian=of_table,
        )
    way = Way.to(model, link, _FUNCTION)
    by_name = {joint.name: joint for joint in model.joints}
    joints = compile_joints(way.chain.joints, followers=way.chain.followers, with_axes=True)
    laws, moved = way.chain.followers, {joint.name: joint for joint in way.chain.moving}

    def of_robot(frames: Sequence[RigidTransform], values: Sequence[float]) -> Vector:
        screws = screws_in_links(way.chain, frames[:-1])
        columns = jacobian_of(screws, frames[-1].translation, (), _FUNCTION)
        return led(columns, moved, dict(zip(way.names.moving, values, strict=True)), laws)

    return _MovedLink(
        names=way.names,
        moving=[by_name[name] for name in way.names.moving],
        followers=[(laws[name], joint.limits) for name, joint in moved.items() if name in laws],
        reach=sum(norm(joint.origin.xyz) for joint in way.chain.joints),
        frames=partial(_walked, joints),
        jacobian=of_robot,
    )


def _walked(chain: CompiledChain, values: Sequence[float]) -> list[RigidTransform]:
    return [frame.transform for frame in chain.walk(values_of(values))]


class _PoseSearch:
    """The way down from a joint vector to one that is nearer to a pose."""

    def __init__(self, link: _MovedLink, target: RigidTransform) -> None:
        import numpy as np

        self._link, self._target = link, target
        rows = link.moving
        self.names = link.names
        ranges = [_range(name, row.limits, link.followers) for name, row in zip(link.names.moving, rows, strict=True)]
        self.lower, self.upper = np.array([low for low, _ in ranges]), np.array([high for _, high in ranges])
        with np.errstate(invalid="ignore"):
            span = self.upper - self.lower
            middle = 0.5 * self.lower + 0.5 * self.upper
        is_bounded = np.isfinite(span)
        # Joint vectors are drawn from here; a joint without limits is within ±π.
        self.begin = np.where(is_bounded, self.lower, -np.pi)
        self.range = np.where(is_bounded, span, 2.0 * np.pi)
        self.middle = np.clip(np.where(np.isfinite(middle), middle, 0.0), self.lower, self.upper)
        self._turns = np.array([row.type is not JointType.PRISMATIC for row in rows], dtype=bool)
        ends = np.abs(np.concatenate([self.lower[~self._turns], self.upper[~self._turns]]))
        travel = float(ends[np.isfinite(ends)].sum())
        self._length = max(link.reach + travel, norm(target.translation), 1e-6)
        # A prismatic joint counts in reaches, as a revolute one in radians.
        self._scale = np.where(self._turns, 1.0, self._length)
        self.start = self.middle

    def cost(self, solution: InverseSolution) -> float:
        """What is left, lengths as parts of the reach."""
        return (solution.position_error / self._length) ** 2 + solution.angle_error**2

    def descend(self, q: Vector) -> InverseSolution:
        """The nearest pose that is found on the way down from a joint vector inside the limits."""
        import numpy as np

        damping, (frames, error) = 1e-3, self._at(q)
        for _ in range(STEPS):
            cost = float(error @ error)
            if cost <= (1e-3 * REACHED) ** 2 or not len(q):
                break
            jacobian = self._link.jacobian(frames, q.tolist()) * self._scale
            jacobian[:3] /= self._length
            downhill = jacobian.T @ error
            free = ~(((q <= self.lower) & (downhill < 0.0)) | ((q >= self.upper) & (downhill > 0.0)))
            if not free.any():
                break
            part, slope = jacobian[:, free], downhill[free]
            normal = part.T @ part
            while damping < _STIFFEST:
                step = np.linalg.solve(normal + damping * np.eye(len(slope)), slope)
                step *= min(1.0, _LONGEST / max(float(np.abs(step).max()), _TINY))
                moved = q.copy()
                moved[free] += step * self._scale[free]
                moved = np.clip(moved, self.lower, self.upper)
                there, left = self._at(moved)
                if float(left @ left) < cost:
                    break
                damping *= 4.0
            else:
                break  # No step leads down any more.
            gained = cost - float(left @ left)
            q, frames, error, damping = moved, there, left, max(damping / 8.0, 1e-15)
            if gained <= 1e-14 * cost:
                break
        # The same pose without whole turns away from the start, where the limits allow it.
        near = q - 2.0 * np.pi * np.round((q - self.start) / (2.0 * np.pi))
        q = np.where(self._turns & (near >= self.lower) & (near <= self.upper), near, q)
        found = self._frames(q)[-1]
        position, angle = position_error(self._target, found), angle_error(self._target, found)
        is_there = position <= REACHED * max(self._length, 1e-3) and angle <= REACHED
        return InverseSolution(tuple(q.tolist()), position, angle, is_there)

    def _frames(self, q: Vector) -> list[RigidTransform]:
        """The frames by which the axes are known and that of the link, in the root link."""
        return self._link.frames(q.tolist())

    def _at(self, q: Vector) -> tuple[list[RigidTransform], Vector]:
        """The frames, and what leads from tool0 to the target.

        That is a shift as a part of the reach, and a turn [rad], of shape (6,).
        """
        import numpy as np

        frames = self._frames(q)
        found = frames[-1]
        shift = (np.array(self._target.translation) - found.translation) / self._length
        return frames, np.concatenate([shift, _turn(multiply(self._target.rotation, transpose(found.rotation)))])


def _range(name: str, limits: Limits, followers: Sequence[tuple[Follower, Limits]]) -> tuple[float, float]:
    """The values of a joint at which its followers are inside their limits, too [rad or m]; else those of its own."""
    own = low, high = _ends(limits)
    for law, own_limits in followers:
        if law.leader == name and law.multiplier and not law.higher:
            ends = sorted((end - law.offset) / law.multiplier for end in _ends(own_limits))
            low, high = max(low, ends[0]), min(high, ends[1])
    return (low, high) if low <= high else own


def _ends(limits: Limits) -> tuple[float, float]:
    return -math.inf if limits.lower is None else limits.lower, math.inf if limits.upper is None else limits.upper


def _turn(rotation: Any) -> Vector:  # noqa: ANN401 - nine numbers
    """The axis of a rotation times its angle [rad]; at a half turn one of the two axes."""
    import numpy as np

    r = np.reshape(rotation, (3, 3))
    sine = 0.5 * np.array([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    size, cosine = float(np.linalg.norm(sine)), 0.5 * float(np.trace(r) - 1.0)
    angle = np.arctan2(size, cosine)
    if cosine > _NEAR_HALF_TURN:
        vector: Vector = sine * (angle / size if size > _TINY else 1.0)
        return vector
    outer = r + r.T + (1.0 - float(np.trace(r))) * np.eye(3)  # 2 (1 − cos) a aᵀ
    axis = outer[:, int(np.argmax(np.diag(outer)))]
    axis = axis / np.linalg.norm(axis)
    turned: Vector = axis * (angle if float(axis @ sine) >= 0.0 else -angle)
    return turned


# --- How well an arm can move


class Dexterity(NamedTuple):
    """What an arm can do from a joint vector."""

    manipulability: float  # the product of the singular values of the Jacobian of tool0, lengths in m
    smallest_singular_value: float  # 0 at a singularity
    # by joint, how far its value is from the nearer limit [rad or m]; negative outside. Joints without limits are left
    # out
    margins: dict[str, float]


def dexterity(manipulator: Manipulator, q: JointVectors) -> Dexterity:
    """What an arm can do from a joint vector, as `Manipulator.fk` accepts it [rad or m].

    Raises:
        RecordError: q is no joint vector of the arm.
    """
    import numpy as np

    rows = manipulator.actuated_rows
    joints = tuple(row.joint for row in rows)
    values, _ = joint_values(q, joints_of(manipulator, "dexterity()"))
    singular = np.linalg.svd(np.asarray(table_jacobian(manipulator, values, full=False)), compute_uv=False)
    margins = {}
    for row, value in zip(rows, values, strict=True):
        ends = [value - row.limits.lower] if row.limits.lower is not None else []
        ends += [row.limits.upper - value] if row.limits.upper is not None else []
        if ends:
            margins[row.joint] = float(min(ends))
    return Dexterity(float(np.prod(singular)), float(singular.min(initial=np.inf)) if joints else 0.0, margins)
