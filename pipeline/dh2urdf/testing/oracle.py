"""T(q) of a table and of a robot by another way than the pipeline's: products of textbook matrices, element by element.

It shares no code with `dh2urdf.kinematics.chain` or `dh2urdf.rotations`, so that an error in those is found here.
"""

from __future__ import annotations

from math import atan2, cos, hypot, sin, sqrt
from typing import TYPE_CHECKING, TypeAlias

from dh2urdf.manipulator import Convention, JointType

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Joint, Robot

Matrix: TypeAlias = list[list[float]]
"""A homogeneous 4x4 matrix, its rows in order."""


def table_pose(manipulator: Manipulator, q: Sequence[float]) -> Matrix:
    """T(base_link → tool0) of a table at one value per moving joint [rad or m]."""
    values = iter(q)
    product = _of(manipulator.base.rotation, manipulator.base.translation)
    for row in manipulator.rows:
        value = 0.0 if row.type is JointType.FIXED else row.offset + row.sign * next(values)
        slides = row.type is JointType.PRISMATIC
        along_z = _product(_turn(2, row.theta + (0.0 if slides else value)), _along(0, 0, row.d + value * slides))
        along_x = _product(_along(row.a, 0, 0), _turn(0, row.alpha))
        factors = (along_z, along_x) if manipulator.convention is Convention.STANDARD else (along_x, along_z)
        product = _product(product, *factors)
    return _product(product, _of(manipulator.tool.rotation, manipulator.tool.translation))


def robot_pose(robot: Robot, q: Sequence[float], root: str, tip: str) -> Matrix:
    """T(root → tip) of a robot at one value per moving joint on the way [rad or m]."""
    way: list[Joint] = []
    while tip != root:
        (joint,) = [joint for joint in robot.joints if joint.child == tip]
        way.insert(0, joint)
        tip = joint.parent
    values = iter(q)
    product = _along(0, 0, 0)
    for joint in way:
        roll, pitch, yaw = joint.origin.rpy
        frame = _product(_along(*joint.origin.xyz), _turn(2, yaw), _turn(1, pitch), _turn(0, roll))
        product = _product(product, frame, _motion(joint, 0.0 if joint.type is JointType.FIXED else next(values)))
    return product


def gap(left: Matrix, right: Matrix) -> tuple[float, float]:
    """Distance of two frames [m] and the angle between them [rad]."""
    distance = sqrt(sum((left[i][3] - right[i][3]) ** 2 for i in range(3)))
    r = [[sum(left[k][i] * right[k][j] for k in range(3)) for j in range(3)] for i in range(3)]
    angle = atan2(hypot(r[2][1] - r[1][2], r[0][2] - r[2][0], r[1][0] - r[0][1]), r[0][0] + r[1][1] + r[2][2] - 1)
    return distance, angle


def _motion(joint: Joint, value: float) -> Matrix:
    """What a joint does at a value."""
    x, y, z = joint.axis
    if joint.type is JointType.PRISMATIC:
        return _along(value * x, value * y, value * z)
    # The axis is turned into z, the turn made about z, and the axis turned back.
    azimuth, polar = atan2(y, x), atan2(hypot(x, y), z)
    return _product(_turn(2, azimuth), _turn(1, polar), _turn(2, value), _turn(1, -polar), _turn(2, -azimuth))


def _product(*factors: Matrix) -> Matrix:
    product = factors[0]
    for factor in factors[1:]:
        product = [[sum(row[k] * factor[k][j] for k in range(4)) for j in range(4)] for row in product]
    return product


def _of(rotation: Sequence[float], translation: Sequence[float]) -> Matrix:
    rows = [[*rotation[3 * i : 3 * i + 3], translation[i]] for i in range(3)]
    return [*rows, [0.0, 0.0, 0.0, 1.0]]


def _along(x: float, y: float, z: float) -> Matrix:
    return [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z], [0.0, 0.0, 0.0, 1.0]]


def _turn(axis: int, angle: float) -> Matrix:
    """The turn by an angle about x (0), y (1) or z (2)."""
    turned, (i, j) = _along(0, 0, 0), ((axis + 1) % 3, (axis + 2) % 3)
    turned[i][i], turned[i][j], turned[j][i], turned[j][j] = cos(angle), -sin(angle), sin(angle), cos(angle)
    return turned
