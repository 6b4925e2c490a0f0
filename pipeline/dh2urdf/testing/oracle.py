"""T(q) of a table and of a robot, computed in another way than by the pipeline: products of textbook 4x4 matrices.

The code is not shared with `dh2urdf.kinematics.chain` or `dh2urdf.rotations`, so that an error there is found here.
"""

from __future__ import annotations

from functools import reduce
from math import cos, sin
from typing import TYPE_CHECKING, TypeAlias

import numpy as np  # noqa: TID253 - this module is imported where arms are compared, and nowhere else
from numpy.typing import NDArray  # noqa: TID253

from dh2urdf.manipulator import Convention, JointType

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf.manipulator import Follower, Manipulator
    from dh2urdf.robot import Joint, Robot

Matrix: TypeAlias = NDArray[np.float64]
"""A homogeneous 4x4 matrix."""


def table_pose(manipulator: Manipulator, q: Sequence[float]) -> Matrix:
    """T(base_link → tool0) of a table at one value per joint that moves by itself [rad or m]."""
    known = _values({row.joint: row.follows for row in manipulator.rows if row.type is not JointType.FIXED}, q)
    factors = [_frame(np.reshape(manipulator.base.rotation, (3, 3)), manipulator.base.translation)]
    for row in manipulator.rows:
        value = 0.0 if row.type is JointType.FIXED else row.offset + row.sign * known[row.joint]
        turn, slide = (0.0, value) if row.type is JointType.PRISMATIC else (value, 0.0)
        along_z = _turn((0, 0, 1), row.theta + turn) @ _shift(0, 0, row.d + slide)
        along_x = _shift(row.a, 0, 0) @ _turn((1, 0, 0), row.alpha)
        factors += [along_z, along_x] if manipulator.convention is Convention.STANDARD else [along_x, along_z]
    tool = _frame(np.reshape(manipulator.tool.rotation, (3, 3)), manipulator.tool.translation)
    return reduce(np.matmul, [*factors, tool])


def robot_pose(robot: Robot, q: Sequence[float], root: str, tip: str) -> Matrix:
    """T(root → tip) of a robot at one value per joint on the way that moves by itself [rad or m]."""
    way: list[Joint] = []
    while tip != root:
        (joint,) = [joint for joint in robot.joints if joint.child == tip]
        way.insert(0, joint)
        tip = joint.parent
    known = _values({joint.name: joint.follows for joint in way if joint.type is not JointType.FIXED}, q)
    product = np.eye(4)
    for joint in way:
        roll, pitch, yaw = joint.origin.rpy
        origin = _shift(*joint.origin.xyz) @ _turn((0, 0, 1), yaw) @ _turn((0, 1, 0), pitch) @ _turn((1, 0, 0), roll)
        value = known.get(joint.name, 0.0)
        slides = joint.type is JointType.PRISMATIC
        motion = _shift(*(value * u for u in joint.axis)) if slides else _turn(joint.axis, value)
        product = product @ origin @ motion
    return product


def _values(laws: Mapping[str, Follower | None], q: Iterable[float]) -> dict[str, float]:
    """The values of joints, given those without a law in order; a follower may follow one that comes later."""
    numbers = iter(q)
    given = {name: next(numbers) for name, law in laws.items() if law is None}

    def value(name: str) -> float:
        law = laws[name]
        return given[name] if law is None else law.multiplier * value(law.leader) + law.offset

    return {name: value(name) for name in laws}


def gap(left: Matrix, right: Matrix) -> tuple[float, float]:
    """Distance of two frames [m] and the angle between them [rad]."""
    r = left[:3, :3].T @ right[:3, :3]
    across = np.linalg.norm([r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]])
    return float(np.linalg.norm(left[:3, 3] - right[:3, 3])), float(np.arctan2(across, np.trace(r) - 1))


def _frame(rotation: Matrix, translation: Sequence[float]) -> Matrix:
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = rotation, translation
    return frame


def _shift(x: float, y: float, z: float) -> Matrix:
    return _frame(np.eye(3), (x, y, z))


def _turn(axis: Sequence[float], angle: float) -> Matrix:
    """The rotation by an angle about an axis: Rodrigues' formula."""
    x, y, z = np.array(axis) / np.linalg.norm(axis)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return _frame(np.eye(3) + sin(angle) * k + (1.0 - cos(angle)) * (k @ k), (0, 0, 0))
