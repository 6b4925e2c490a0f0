import math

import pytest

from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.rotations import RigidTransform

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
