"""The exact α-swap: a chain whose forward kinematics is the DH product, for every table.

The paper's idea, made right: if all link frames are drawn parallel to the base frame at q = 0, each α turns the joint
axes and lengths of all that follows. Here they are turned by the whole rotation accumulated so far, with its signs.

`aligned_frames` draws the links so. `standard_frames` and `modified_frames` keep the frames of the DH table instead
and put the turns into rpy. All three give one `LinkFrame` per row; `arm_parts` makes joints and bodies of them.

In both conventions a link is an L, the offset d along its joint's axis and the length a along the common normal after
it. A row of the standard convention says both; in the modified one a stands in the row of the next joint, and the
first row's a belongs to the base.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics import dh_transform, joint_variables
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.robot import Parameter
from dh2urdf.rotations import (
    HALF_PI,
    IDENTITY_ROTATION,
    X_AXIS,
    Z_AXIS,
    ZERO,
    RigidTransform,
    Rotation,
    Vec3,
    cos_sin,
    multiply,
    rotate,
    rotation_x,
    rotation_z,
    rpy_from_rotation,
    scale,
)
from dh2urdf_plugins.transforms.formulas import (
    HALF,
    NO_VECTOR,
    NOTHING,
    Quantities,
    Quantity,
    constants,
    cos_sin_of,
    origin,
    plus,
    rpy_of,
    times,
)
from dh2urdf_plugins.transforms.shapes import direction_rpy

if TYPE_CHECKING:
    from dh2urdf.manipulator import DHRow, Manipulator

# The flange's x axis points out of the arm, as in ROS-Industrial: rpy (0, -π/2, -π/2) from the last DH frame.
FLANGE_RPY = (0.0, -HALF_PI, -HALF_PI)
_FLANGE = multiply(rotation_z(0.0, -1.0), (0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0))

_ONE = Quantity(1.0)
_X = constants(X_AXIS)
_Z = constants(Z_AXIS)
_ALONG_X = constants((0.0, HALF_PI, 0.0))
_ROUNDING = 1e-15


class Pose(NamedTuple):
    """A frame in another one: position [m], roll, pitch and yaw [rad]."""

    xyz: Quantities
    rpy: Quantities


class Axis(NamedTuple):
    """A line in space: a point [m], a unit vector, and the orientation of a body whose z axis lies along it [rad]."""

    at: Quantities
    along: Quantities
    rpy: Quantities


class LinkFrame(NamedTuple):
    """Where a row's joint and link are.

    Attributes:
        joint: the link's frame in the frame of the link before.
        axis: the joint's axis in the link's frame, with the joint's sign.
        outer: the joint's axis, without the sign, in the frame of the link before, at d = 0.
        offset: the segment d in the link's frame: its foot, z, and the length.
        middle: the middle of the segment d.
        normal: the segment a in the link's frame: the corner between d and a, and x.
        dh_frame: the DH frame after the row, in the link's frame.
    """

    joint: Pose
    axis: Vec3
    outer: Axis
    offset: Axis
    middle: Quantities
    normal: Axis
    dh_frame: RigidTransform


class Frames(NamedTuple):
    """All frames of an arm.

    Attributes:
        base: base_link_inertia in base_link.
        foot: the first joint's axis and, as `front`, the x axis of the frame before it, in base_link_inertia.
        front: see `foot`.
        links: one per row.
        flange: in the last link's frame.
        tool0: in the last link's frame.
    """

    base: Pose
    foot: Axis
    front: Axis
    links: list[LinkFrame]
    flange: Pose
    tool0: Pose


class RowQuantities(NamedTuple):
    """A row with its formulas: the joint's variables at q = 0."""

    a: Quantity
    alpha: Quantity
    d: Quantity
    theta: Quantity
    named_theta: Quantity


def row_quantities(number: int, row: DHRow) -> RowQuantities:
    """A row's lengths and angles as quantities, named after the row's number from 1."""
    theta, d = Quantity.parameter(f"theta_{number}", row.theta), Quantity.parameter(f"d_{number}", row.d)
    offset = Quantity(row.offset)
    return RowQuantities(
        a=Quantity.parameter(f"a_{number}", row.a),
        alpha=Quantity.parameter(f"alpha_{number}", row.alpha),
        d=d + offset if row.type is JointType.PRISMATIC else d,
        theta=theta + offset if row.type in (JointType.REVOLUTE, JointType.CONTINUOUS) else theta,
        named_theta=theta,
    )


def parameters(manipulator: Manipulator, *, angles: bool) -> tuple[Parameter, ...]:
    """The numbers that a person may edit: lengths and, in `dh` frames, angles."""
    units = {"a": "m", "alpha": "rad", "d": "m", "theta": "rad"} if angles else {"a": "m", "d": "m"}
    return tuple(
        Parameter(name=f"{name}_{number}", value=getattr(row, name) + 0.0, unit=unit, joint=row.joint)
        for number, row in enumerate(manipulator.rows, start=1)
        for name, unit in units.items()
    )
