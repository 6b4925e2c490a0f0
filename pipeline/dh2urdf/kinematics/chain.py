"""Forward kinematics: the DH product that everything written is measured against.

The one place that knows what the rows of a table mean. Every function takes joint values as floats or as numpy arrays
of one shape, by the same spelled-out sums; the functions with `matrices` in their name give arrays of shape
(..., 4, 4). A DH table of N rows, n of them moving, has joint vectors q of n entries [rad or m]. Tables and chains of
joints are compiled into the moves and turns of `dh2urdf.kinematics.walk`, which alone makes their products.

Source: Denavit and Hartenberg (1955) in the form of Paul (1981) for the standard convention, Craig (Introduction to
Robotics, 3rd edition, eq. 3.6) for the modified one; Rodrigues' formula for the joints of a robot description.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dh2urdf.errors import RecordValueError
from dh2urdf.kinematics.walk import CompiledChain, JointValue, rotation_about, values_of
from dh2urdf.manipulator import ROOT, TOOL, Convention, DHRow, JointType, Manipulator
from dh2urdf.robot import with_followers
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    ZERO,
    RigidTransform,
    Rotation,
    Vec3,
    cos_sin,
    multiply,
    norm,
    rotate,
    scale,
    subtract,
    total,
    transpose,
    z_axis_of,
)
from dh2urdf.source import Messages, did_you_mean

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import ArrayLike, NDArray

    from dh2urdf.manipulator import Follower
    from dh2urdf.robot import Joint, Robot

say = Messages(__file__)

JointVector: TypeAlias = Sequence[Any]
"""One value per joint that moves by itself, each a float or an array [rad or m]."""
NO_FOLLOWERS: Mapping[str, Follower] = MappingProxyType({})


def dh_transform(convention: Convention, *, a: Any, alpha: Any, d: Any, theta: Any) -> RigidTransform:  # noqa: ANN401 - floats and arrays alike
    """The transform A of one row.

    Standard: A = Rz(theta)·Tz(d)·Tx(a)·Rx(alpha). Modified: A = Rx(alpha)·Tx(a)·Rz(theta)·Tz(d).

    Args:
        convention: which of the two.
        a: length of the common normal [m].
        alpha: twist [rad].
        d: offset along the joint axis, joint value included [m].
        theta: angle about the joint axis, joint value included [rad].
    """
    return dh_transform_of(convention, a=a, d=d, twist=cos_sin(alpha), turn=cos_sin(theta))


def dh_transform_of(
    convention: Convention,
    *,
    a: Any,  # noqa: ANN401 - floats and arrays alike
    d: Any,  # noqa: ANN401
    twist: tuple[Any, Any],
    turn: tuple[Any, Any],
) -> RigidTransform:
    """The transform A of one row, given cosine and sine of alpha (twist) and of theta (turn)."""
    (ca, sa), (ct, st) = twist, turn
    if convention is Convention.STANDARD:
        return RigidTransform((ct, -st * ca, st * sa, st, ct * ca, -ct * sa, 0.0, sa, ca), (a * ct, a * st, d))
    return RigidTransform((ct, -st, 0.0, st * ca, ct * ca, -sa, st * sa, ct * sa, ca), (a, -d * sa, d * ca))


def joint_variables(row: DHRow, q: Any = 0.0) -> tuple[Any, Any]:  # noqa: ANN401 - floats and arrays alike
    """The angle theta [rad] and the offset d [m] of a row at joint value q [rad or m]."""
    if row.type is JointType.FIXED:
        return row.theta, row.d
    if row.type is JointType.PRISMATIC:
        return row.theta, row.d + row.offset + row.sign * q
    return row.theta + row.offset + row.sign * q, row.d


def row_transform(convention: Convention, row: DHRow, q: Any = 0.0) -> RigidTransform:  # noqa: ANN401 - floats and arrays alike
    """The transform A of a row at joint value q [rad or m]."""
    theta, d = joint_variables(row, q)
    return dh_transform(convention, a=row.a, alpha=row.alpha, d=d, theta=theta)


def forward_kinematics(manipulator: Manipulator, q: JointVector) -> RigidTransform:
    """T(q) = base · A_1 · … · A_N · tool: the truth for everything that is written.

    Args:
        manipulator: the table.
        q: one value per joint that moves by itself [rad or m].

    Raises:
        ValueError: q has another number of entries than the table has such joints.
    """
    values = _values(q, len(manipulator.actuated_rows), manipulator.name)
    return table_chain(manipulator).walk(values)[0].transform


def table_chain(manipulator: Manipulator) -> CompiledChain:
    """The way base · A_1 · … · A_N · tool of a table, compiled for many joint vectors; takes columns."""
    chain = CompiledChain()
    compile_table(chain, manipulator)
    chain.stop()
    return chain


def compile_table(
    chain: CompiledChain,
    manipulator: Manipulator,
    numbers: Mapping[str, int] | None = None,
    *,
    with_frames: bool = False,
) -> None:
    """Add base · A_1 · … · A_N · tool to a chain; takes columns.

    The joints that move by themselves have these numbers in the joint vector, or are counted from 0. With frames, a
    walk stops before the first row and after each: it returns the DH frames 0 … N.
    """
    chain.transform(manipulator.base)
    if with_frames:
        chain.stop()
    if numbers is None:
        numbers = {row.joint: number for number, row in enumerate(manipulator.actuated_rows)}
    numbers = numbered(chain, [row.joint for row in manipulator.moving_rows], manipulator.followers, numbers)
    is_standard = manipulator.convention is Convention.STANDARD
    for row in manipulator.rows:
        if not is_standard:
            chain.move(0, row.a)
            chain.turn(0, row.alpha)
        theta, d = joint_variables(row)
        number = numbers.get(row.joint)
        slides = row.type is JointType.PRISMATIC
        chain.turn(2, theta, joint=None if slides else number, sign=row.sign)
        chain.move(2, d, joint=number if slides else None, factor=row.sign)
        if is_standard:
            chain.move(0, row.a)
            chain.turn(0, row.alpha)
        if with_frames:
            chain.stop()
    chain.transform(manipulator.tool)


def numbered(
    chain: CompiledChain, joints: Iterable[str], followers: Mapping[str, Follower], numbers: Mapping[str, int]
) -> dict[str, int]:
    """The numbers of some moving joints in a walk: those that are known, and those of the joints that follow them."""
    laws = {name: followers[name] for name in joints if name in followers}
    leaders = {name: numbers[law.leader] if law.leader else None for name, law in laws.items()}
    return {**numbers, **{name: chain.follow(leaders[name], law) for name, law in laws.items()}}


def leading(moving: Sequence[str], followers: Mapping[str, Follower]) -> tuple[str, ...]:
    """Names of the joints that decide where moving joints are: of these in order, then of others that they follow."""
    leaders = [followers[name].leader for name in moving if name in followers]
    return tuple(dict.fromkeys([*[name for name in moving if name not in followers], *filter(None, leaders)]))


def compile_joints(
    joints: Sequence[Joint],
    numbers: Mapping[str, int] | None = None,
    followers: Mapping[str, Follower] = NO_FOLLOWERS,
    *,
    with_axes: bool = False,
) -> CompiledChain:
    """The way along joints of a description, from the root outwards, each with its origin and motion; takes columns.

    Those that follow none have these numbers in the joint vector, or are counted from 0. With axes, a walk stops where
    each joint that moves is, before it moves.
    """
    chain = CompiledChain()
    moving = [joint.name for joint in joints if joint.type is not JointType.FIXED]
    if numbers is None:
        numbers = {name: number for number, name in enumerate(leading(moving, followers))}
    numbers = numbered(chain, moving, followers, numbers)
    for joint in joints:
        for along, length in enumerate(joint.origin.xyz):
            chain.move(along, length)
        for about in (2, 1, 0):
            chain.turn(about, joint.origin.rpy[about])
        if joint.type is JointType.FIXED:
            continue
        if with_axes:
            chain.stop()
        number = numbers[joint.name]
        if joint.type is JointType.PRISMATIC:
            for along, factor in enumerate(joint.axis):
                chain.move(along, 0.0, joint=number, factor=factor)
        else:
            chain.turn_about(joint.axis, number)
    chain.stop()
    return chain


class KinematicChain(NamedTuple):
    """The joints from one link of a robot to another, ready for many joint vectors.

    Attributes:
        joints: from the root outwards.
        compiled: their moves and turns.
        followers: the joints of the robot that follow others, by name, and how.
    """

    joints: tuple[Joint, ...]
    compiled: CompiledChain
    followers: Mapping[str, Follower] = NO_FOLLOWERS

    @property
    def moving(self) -> tuple[Joint, ...]:
        """Those that move, in order: by themselves, or because they follow another one."""
        return tuple(joint for joint in self.joints if joint.type is not JointType.FIXED)

    @property
    def actuated(self) -> tuple[str, ...]:
        """Names of the joints that have a value in a joint vector: those of the chain in order, then other leaders."""
        return leading([joint.name for joint in self.moving], self.followers)

    @classmethod
    def of(cls, joints: Sequence[Joint], followers: Mapping[str, Follower] = NO_FOLLOWERS) -> KinematicChain:
        """The chain of some joints, from the root outwards, and how they follow others."""
        return cls(tuple(joints), compile_joints(joints, followers=followers), followers)

    @classmethod
    def between(cls, robot: Robot, root: str = ROOT, tip: str = TOOL) -> KinematicChain:
        """The chain from a root link to a tip link.

        Raises:
            ValueError: there is no way from the root to the tip.
        """
        return cls.of(joints_between(robot, root, tip), robot.followers)

    def forward_kinematics(self, q: JointVector) -> RigidTransform:
        """T(root → tip) at one value per actuated joint of the chain, from the root outwards [rad or m].

        Raises:
            ValueError: q has another number of entries than the chain has such joints.
        """
        return self.compiled.walk(_values(q, len(self.actuated), "the chain"))[0].transform


def joints_between(robot: Robot, root: str, tip: str) -> tuple[Joint, ...]:
    """The joints from a root link to a tip link, from the root outwards.

    Raises:
        RecordValueError: there is no way from the root to the tip; also a ValueError.
    """
    above = {joint.child: joint for joint in robot.joints}
    found: list[Joint] = []
    link = tip
    while link != root:
        joint = above.pop(link, None)  # A cycle finds nothing on its second round.
        if joint is None:
            links = [name for each in robot.joints for name in (each.parent, each.child)]
            near = did_you_mean(tip, links) if tip not in links else None
            raise RecordValueError(say("no-way", field="tip", found=tip, robot=robot.name, root=root, suggestion=near))
        found.append(joint)
        link = joint.parent
    return tuple(reversed(found))


def link_poses(robot: Robot, q: Mapping[str, float]) -> dict[str, RigidTransform]:
    """T(root → link) of every link that the root holds, by name.

    Args:
        robot: the robot, its links and joints in any order.
        q: values of actuated joints by name [rad or m]; those that are missing are 0. Followers follow them.
    """
    if followers := robot.followers:
        q = with_followers({**dict.fromkeys([joint.name for joint in robot.actuated_joints], 0.0), **q}, followers)
    below: dict[str, list[Joint]] = {}
    for joint in robot.joints:
        below.setdefault(joint.parent, []).append(joint)
    held = {joint.child for joint in robot.joints}
    waiting = [link.name for link in robot.links if link.name not in held]
    poses = dict.fromkeys(waiting, IDENTITY)
    while waiting:
        for joint in below.get(parent := waiting.pop(), ()):
            if joint.child not in poses:  # What two joints hold stays with the first of them.
                poses[joint.child] = (
                    poses[parent] @ joint.origin.transform @ joint_motion(joint, q.get(joint.name, 0.0))
                )
                waiting.append(joint.child)
    return poses


def dh_frames(manipulator: Manipulator, q: JointVector) -> tuple[RigidTransform, ...]:
    """The DH frames 0 … N in base_link: the base transform, and the frame after every row.

    Args:
        manipulator: the table.
        q: one value per joint that moves by itself [rad or m].

    Raises:
        ValueError: q has another number of entries than the table has such joints.
    """
    values = _values(q, len(manipulator.actuated_rows), manipulator.name)
    chain = CompiledChain()
    compile_table(chain, manipulator, with_frames=True)
    return tuple(frame.transform for frame in chain.walk(values))


class Screw(NamedTuple):
    """The axis of a joint at some q."""

    direction: Vec3  # unit vector, in the direction that the joint counts
    point: Vec3  # a point of the axis [m]
    slides: bool = False  # whether the joint is prismatic


def screws_in_frames(manipulator: Manipulator, frames: Sequence[RigidTransform]) -> list[Screw]:
    """The axes of a table's moving rows, given its DH frames 0 … N, in the frame of its base link; takes columns."""
    # In the standard convention a joint turns about z of the frame before its row, in the modified one of its own.
    before = manipulator.convention is Convention.STANDARD
    return [
        Screw(scale(row.sign, z_axis_of(frame.rotation)), frame.translation, row.type is JointType.PRISMATIC)
        for row, frame in zip(manipulator.rows, frames[:-1] if before else frames[1:], strict=True)
        if row.type is not JointType.FIXED
    ]


def screws_of_table(manipulator: Manipulator, q: JointVector | None = None) -> list[Screw]:
    """The axes of a table's moving rows at a joint vector [rad or m], at zero without it; takes columns."""
    return screws_in_frames(manipulator, dh_frames(manipulator, q or (0.0,) * len(manipulator.actuated_rows)))


def screws_of_chain(chain: KinematicChain, q: JointVector | None = None) -> tuple[list[Screw], RigidTransform]:
    """The axes of a chain's moving joints at a joint vector [rad or m], at zero without it, and T(root → tip)."""
    compiled = compile_joints(chain.joints, followers=chain.followers, with_axes=True)
    *frames, tip = [frame.transform for frame in compiled.walk(values_of(q or [0.0] * len(chain.actuated)))]
    return screws_in_links(chain, frames), tip


def screws_in_links(chain: KinematicChain, frames: Sequence[RigidTransform]) -> list[Screw]:
    """The axes of a chain's moving joints, given the frames of their children in the root link; takes columns."""
    return [
        Screw(rotate(frame.rotation, joint.axis), frame.translation, joint.type is JointType.PRISMATIC)
        for joint, frame in zip(chain.moving, frames, strict=True)
    ]


def joint_motion(joint: Joint, value: Any) -> RigidTransform:  # noqa: ANN401 - floats and arrays alike
    """What a joint does to its child's frame at a joint value [rad or m]."""
    if joint.type is JointType.FIXED:
        return IDENTITY
    if joint.type is JointType.PRISMATIC:
        return RigidTransform(IDENTITY_ROTATION, scale(value, joint.axis))
    return RigidTransform(axis_rotation(joint.axis, value), ZERO)


def axis_rotation(axis: Vec3, angle: Any) -> Rotation:  # noqa: ANN401 - floats and arrays alike
    """Rotation by an angle [rad] about a unit vector (Rodrigues' formula)."""
    c, s = cos_sin(angle)
    _, xy, xz, yx, _, yz, zx, zy, _ = rotation_about(axis, c, s)
    xx, yy, zz = (c + k * k * (1.0 - c) for k in axis)  # the last digits that files have had
    return (xx, xy, xz, yx, yy, yz, zx, zy, zz)


def position_error(left: RigidTransform, right: RigidTransform) -> float:
    """Distance between the origins of two frames [m]."""
    return norm(subtract(left.translation, right.translation))


def angle_error(left: RigidTransform, right: RigidTransform) -> float:
    """Angle of the rotation between two frames [rad], right for small angles and for half turns."""
    r = multiply(transpose(left.rotation), right.rotation)
    twice_sine = math.hypot(r[7] - r[5], r[2] - r[6], r[3] - r[1])
    return math.atan2(twice_sine, r[0] + r[4] + r[8] - 1.0)


def reach(manipulator: Manipulator) -> float:
    """An upper bound of the distance from base_link to tool0, prismatic joints at 0 and the others anywhere [m].

    Takes columns.
    """
    segments = (abs(row.a) + abs(joint_variables(row)[1]) for row in manipulator.rows)
    return norm(manipulator.base.translation) + total(segments) + norm(manipulator.tool.translation)


def dh_transforms(
    convention: Convention, a: ArrayLike, alpha: ArrayLike, d: ArrayLike, theta: ArrayLike
) -> NDArray[np.float64]:
    """The transforms A of many rows at once.

    Args:
        convention: which of the two.
        a: lengths of the common normals [m], of any shape that broadcasts with the others.
        alpha: twists [rad].
        d: offsets along the joint axes [m].
        theta: angles about the joint axes [rad].

    Returns:
        Homogeneous matrices of shape (..., 4, 4).
    """
    import numpy as np

    arrays = (np.asarray(value, dtype=float) for value in (a, alpha, d, theta))
    a_, alpha_, d_, theta_ = np.broadcast_arrays(*arrays)
    return as_matrices(dh_transform(convention, a=a_, alpha=alpha_, d=d_, theta=theta_))


def as_matrices(transform: RigidTransform) -> NDArray[np.float64]:
    """A rigid transform, its elements floats or arrays of one shape, as homogeneous matrices (..., 4, 4)."""
    import numpy as np

    r, t = transform
    elements = np.broadcast_arrays(*r[0:3], t[0], *r[3:6], t[1], *r[6:9], t[2], 0.0, 0.0, 0.0, 1.0)
    return np.stack(elements, axis=-1).reshape(*elements[0].shape, 4, 4)


def _values(q: JointVector, moving: int, whose: str) -> list[JointValue]:
    if len(q) != moving:
        raise ValueError(f"{whose} has {moving} moving joints, the joint vector has {len(q)} entries")
    return values_of(q)
