"""Random chains of joints, and their forward kinematics by code of its own: what extracted tables are held against."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from dh2urdf.manipulator import Convention, JointType, Manipulator
from dh2urdf.robot import Joint, Origin

if TYPE_CHECKING:
    import random
    from collections.abc import Sequence

    from numpy.typing import NDArray

    Matrix = NDArray[np.float64]

STYLES = ("quarter", "any", "near", "rounded", "mixed")
"""Quarter turns; any angle; quarter turns but for 1e-12 … 0.1 rad; quarter turns of 2 … 12 decimals; all of them."""


def random_chain(draw: random.Random) -> list[Joint]:
    """One to nine moving joints, fixed ones between them; axes that coincide, meet, are parallel or antiparallel."""
    style, joints, parent = draw.choice(STYLES), list[Joint](), "link_0"

    def add(kind: JointType) -> None:
        nonlocal parent
        number = len(joints) + 1
        origin = Origin(
            xyz=(_length(draw), _length(draw), _length(draw)),
            rpy=(_angle(draw, style), _angle(draw, style), _angle(draw, style)),
        )
        child = f"link_{number}"
        joints.append(
            Joint(name=f"joint_{number}", type=kind, parent=parent, child=child, origin=origin, axis=_axis(draw))
        )
        parent = child

    for _ in range(draw.randint(1, 9)):
        for _ in range(draw.choice((0, 0, 0, 1, 2))):
            add(JointType.FIXED)
        add(draw.choices((JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC), (5, 1, 2))[0])
    for _ in range(draw.choice((0, 1, 2))):
        add(JointType.FIXED)
    return joints


def _angle(draw: random.Random, style: str) -> float:
    style = draw.choice(STYLES[:-1]) if style == "mixed" else style
    quarter = draw.randint(-2, 2) * math.pi / 2
    if style == "any":
        return draw.uniform(-math.pi, math.pi)
    if style == "near" and draw.random() < 0.5:
        return quarter + draw.choice((-1, 1)) * 10.0 ** draw.uniform(-12, -1)
    return round(quarter, draw.randint(2, 12)) if style == "rounded" else quarter


def _length(draw: random.Random) -> float:
    return draw.choice((0.0, 0.0, round(draw.uniform(-1, 1), 3), draw.uniform(-1, 1)))


def _axis(draw: random.Random) -> tuple[float, float, float]:
    if draw.random() < 0.6:
        axis = [0.0, 0.0, 0.0]
        axis[draw.randint(0, 2)] = draw.choice((1.0, -1.0))
    else:
        axis = [draw.gauss(0, 1) for _ in range(3)]
        axis = [each / math.hypot(*axis) for each in axis]
    return (axis[0], axis[1], axis[2])


def chain_pose(joints: Sequence[Joint], q: Sequence[float]) -> Matrix:
    """T(base → tip) of the joints, by matrices of numpy."""
    values, pose = iter(q), np.eye(4)
    for joint in joints:
        roll, pitch, yaw = joint.origin.rpy
        origin = np.eye(4)
        origin[:3, :3] = turn((0, 0, 1), yaw) @ turn((0, 1, 0), pitch) @ turn((1, 0, 0), roll)
        origin[:3, 3] = joint.origin.xyz
        motion = np.eye(4)
        if joint.type is JointType.PRISMATIC:
            motion[:3, 3] = next(values) * np.array(joint.axis)
        elif joint.type is not JointType.FIXED:
            motion[:3, :3] = turn(joint.axis, next(values))
        pose = pose @ origin @ motion
    return pose


def table_pose(table: Manipulator, q: Sequence[float]) -> Matrix:
    """T(base → tool) of a table without offsets and signs, by the textbooks' products of four matrices."""
    values, pose = iter(q), matrix(table.base.rotation, table.base.translation)
    for row in table.rows:
        theta, d = row.theta, row.d
        if row.type is JointType.PRISMATIC:
            d += next(values)
        elif row.type is not JointType.FIXED:
            theta += next(values)
        about_z = matrix(turn((0, 0, 1), theta).ravel(), (0, 0, d))
        about_x = matrix(turn((1, 0, 0), row.alpha).ravel(), (row.a, 0, 0))
        pose = pose @ (about_z @ about_x if table.convention is Convention.STANDARD else about_x @ about_z)
    return pose @ matrix(table.tool.rotation, table.tool.translation)


def turn(axis: Sequence[float], angle: float) -> Matrix:
    """The rotation about a unit vector, by the exponential's three terms (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=float)
    return np.eye(3) + math.sin(angle) * cross + 2 * math.sin(angle / 2) ** 2 * cross @ cross


def matrix(rotation: Sequence[float] | Matrix, translation: Sequence[float]) -> Matrix:
    """A homogeneous matrix of nine and three numbers."""
    pose = np.eye(4)
    pose[:3, :3] = np.reshape(np.asarray(rotation, dtype=float), (3, 3))
    pose[:3, 3] = translation
    return pose


def largest_difference(joints: Sequence[Joint], table: Manipulator, draw: random.Random, poses: int = 5) -> float:
    """The largest element of the difference of both poses [m, 1], at 0 and at random joint values.

    Joints turn by 3 rad to both sides, and slide by 1 m: the travel that is assumed where a joint has no limits.
    """
    widest = [1 if joint.type is JointType.PRISMATIC else 3 for joint in joints if joint.type is not JointType.FIXED]
    vectors = [[0.0] * len(widest), *([draw.uniform(-most, most) for most in widest] for _ in range(poses))]
    return max(float(np.abs(chain_pose(joints, q) - table_pose(table, q)).max()) for q in vectors)
