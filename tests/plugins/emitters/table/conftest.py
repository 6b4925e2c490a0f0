from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.rotations import RigidTransform

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from numpy.typing import NDArray

POSE = RigidTransform.from_xyz_rpy((0.1, -0.2, 0.3), (0.4, -0.5, 0.6))


@pytest.fixture(params=list(Convention))
def arm(request: pytest.FixtureRequest) -> Manipulator:
    """An arm with one of everything that code has to get right: signs, offsets, both kinds of joints, base and tool."""
    return Manipulator(
        name="one of everything",
        convention=request.param,
        base=POSE,
        tool=POSE.inverse,
        rows=(
            DHRow(joint="mount", link="plate", type=JointType.FIXED, a=0.1, alpha=0.2, d=0.3, theta=0.4),
            DHRow(
                joint="turn",
                link="turned",
                a=0.5,
                alpha=math.pi / 2,
                d=-0.25,
                theta=0.125,
                offset=-math.pi / 4,
                sign=-1,
                limits=Limits(lower=-3 * math.pi / 4, upper=2.0),
                mass=2.0,
                com=(0.1, -0.2, 0.3),
                inertia=Inertia(ixx=0.3, iyy=0.4, izz=0.5, ixy=0.01, ixz=-0.02, iyz=0.03),
                damping=0.5,
                friction=0.25,
                armature=0.125,
            ),
            DHRow(
                joint="slide",
                link="slider",
                type=JointType.PRISMATIC,
                a=0.05,
                alpha=-1.1,
                d=0.4,
                theta=0.7,
                offset=0.2,
                sign=-1,
                limits=Limits(lower=0.0, upper=0.75),
            ),
            DHRow(joint="spin", link="spun", type=JointType.CONTINUOUS, a=0.0, alpha=0.3, d=0.1),
            DHRow(joint="reach", link="hand", type=JointType.PRISMATIC, a=0.2, alpha=0.0, d=0.0, theta=-0.6),
            DHRow(joint="last", link="plate_2", type=JointType.FIXED, a=0.0, alpha=math.pi, d=0.05, theta=math.pi / 3),
        ),
    )


@pytest.fixture(scope="session")
def product() -> Callable[[Manipulator, Sequence[float]], NDArray[np.float64]]:
    """T(q) as the product of elementary matrices, in the order in which the textbooks have them."""

    def turn(axis: int, angle: float) -> NDArray[np.float64]:
        one, two = {0: (1, 2), 2: (0, 1)}[axis]
        matrix = np.eye(4)
        matrix[one, one] = matrix[two, two] = np.cos(angle)
        matrix[one, two], matrix[two, one] = -np.sin(angle), np.sin(angle)
        return matrix

    def shift(axis: int, length: float) -> NDArray[np.float64]:
        matrix = np.eye(4)
        matrix[axis, 3] = length
        return matrix

    def whole(transform: RigidTransform) -> NDArray[np.float64]:
        matrix = np.eye(4)
        matrix[:3, :3] = np.reshape(transform.rotation, (3, 3))
        matrix[:3, 3] = transform.translation
        return matrix

    def pose(arm: Manipulator, q: Sequence[float]) -> NDArray[np.float64]:
        values, matrix = iter(q), whole(arm.base)
        for row in arm.rows:
            moved = 0.0 if row.type is JointType.FIXED else row.offset + row.sign * next(values)
            slides = row.type is JointType.PRISMATIC
            about_z = turn(2, row.theta + (0.0 if slides else moved)) @ shift(2, row.d + (moved if slides else 0.0))
            about_x = shift(0, row.a) @ turn(0, row.alpha)
            first, last = (about_z, about_x) if arm.convention is Convention.STANDARD else (about_x, about_z)
            matrix = matrix @ first @ last
        return matrix @ whole(arm.tool)

    return pose
