"""Where the joints and links of the exact variant are.

`aligned_frames` draws every link frame parallel to base_link at q = 0: each joint's origin is a bare offset and the
turns of the table are in the joint axes. `standard_frames` and `modified_frames` keep the frames of the DH table: the
joint axes are z and the turns are in rpy. The kinematics is the same.

In both conventions a link is an L: the offset d along its joint's axis, then the length a along the common normal. A
row of the standard convention says both; in the modified one a and α are in the row of the next joint, and those of
the first row belong to the base.

Names below: R is the accumulated rotation at q = 0; ϑ and δ are the angle and the offset of a joint at q = 0.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, cast

from dh2urdf.kinematics import dh_transform_of, joint_variables
from dh2urdf.manipulator import Convention, DHRow, JointType
from dh2urdf.rotations import (
    HALF_PI,
    IDENTITY,
    IDENTITY_ROTATION,
    X_AXIS,
    Z_AXIS,
    RigidTransform,
    Vec3,
    exact_cos_sin,
    multiply,
    rotate,
    rotation_from_rpy,
    rotation_x,
    rotation_z,
    rpy_from_rotation,
    x_axis_of,
    z_axis_of,
)
from dh2urdf_plugins.transforms.formulas import (
    NO_VECTOR,
    NOTHING,
    Quantities,
    Quantity,
    constants,
    cos_sin_of,
    plus,
    rpy_of,
    signed,
    times,
    values,
)
from dh2urdf_plugins.transforms.shapes import Segment, direction_rpy

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.transforms.formulas import Symbol

    Angles: TypeAlias = tuple[Quantity, Quantity, tuple[Quantity, Quantity], tuple[Quantity, Quantity]]
    """α and ϑ of a row [rad], and the cosine and sine of each."""

FLANGE_RPY: Vec3 = (0.0, -HALF_PI, -HALF_PI)
"""The flange in the last DH frame: x points out of the arm, as in ROS-Industrial."""

_X = constants(X_AXIS)
_Z = constants(Z_AXIS)
_DOWN = constants((0.0, 0.0, -1.0))
_ALONG_X = constants((0.0, HALF_PI, 0.0))
_ROUNDING = 1e-15


class Pose(NamedTuple):
    """A frame in another one: position [m]; roll, pitch and yaw [rad]."""

    xyz: Quantities
    rpy: Quantities


class Line(NamedTuple):
    """A point [m], a direction, and the roll, pitch and yaw [rad] of a body whose z axis lies along it."""

    at: Quantities
    along: Quantities
    rpy: Quantities


class LinkFrame(NamedTuple):
    """Where a row's joint and link are."""

    joint: Pose  # the link's frame in the frame of the link before
    axis: Vec3  # the joint's axis in the link's frame, with the joint's sign
    rail: Line  # the joint's axis without its sign, from δ = 0 on, in the frame of the link before
    foot: Quantities  # where the segment d begins, in the link's frame
    corner: Quantities  # where it ends and the segment a begins
    end: Quantities  # where the segment a ends
    offset: Segment  # the segment d
    normal: Segment  # the segment a
    dh_frame: RigidTransform  # the DH frame after the row, in the link's frame


class Frames(NamedTuple):
    """All frames of an arm."""

    base: Pose  # base_link_inertia in base_link
    pedestal: Line  # the z axis of the first DH frame, in base_link_inertia
    front: Segment  # the segment a between them and the first joint: of the modified convention
    links: list[LinkFrame]  # one per row
    flange: Pose  # in the last link's frame
    tool0: Pose  # in the last link's frame


def aligned_frames(manipulator: Manipulator, symbol: Symbol) -> Frames:
    """Link frames parallel to base_link at q = 0; the base transform is folded into the first joint."""
    modified = manipulator.convention is Convention.MODIFIED
    base, tool = settled(manipulator.base), settled(manipulator.tool)
    lengths = _lengths(manipulator, symbol)
    a_of_rows = [a for a, _ in lengths]
    normals = [*a_of_rows, NOTHING] if modified else [NOTHING, *a_of_rows]  # after the base's and every link's offset
    R = base.rotation
    here = constants(base.translation)  # where the chain has come to, in the frame of the last link
    pedestal, ahead = _line(here, z_axis_of(R)), _line(here, x_axis_of(R))
    front = Segment.between(ahead.at, ahead.along, normals[0], ahead.rpy)
    links = []
    for row, (a, delta), normal in zip(manipulator.rows, lengths, normals[1:], strict=True):
        twist = exact_cos_sin(row.alpha)
        if modified:
            here = plus(here, times(a, constants(x_axis_of(R))))
            R = multiply(R, rotation_x(*twist))
        joint, z = here, z_axis_of(R)
        R = multiply(R, rotation_z(*exact_cos_sin(joint_variables(row)[0])))
        rail = _line(joint, z)
        corner = times(delta, rail.along)
        normal_line = _line(corner, x_axis_of(R))
        end = plus(corner, times(normal, normal_line.along))
        here = corner if modified else end
        R = R if modified else multiply(R, rotation_x(*twist))
        links.append(
            LinkFrame(
                joint=Pose(joint, NO_VECTOR),
                axis=signed(row.sign, z),
                rail=rail,
                foot=NO_VECTOR,
                corner=corner,
                end=end,
                offset=Segment.between(NO_VECTOR, rail.along, delta, rail.rpy),
                normal=Segment.between(corner, normal_line.along, normal, normal_line.rpy),
                dh_frame=RigidTransform(R, values(here)),
            )
        )
    return Frames(
        base=Pose(NO_VECTOR, NO_VECTOR),
        pedestal=pedestal,
        front=front,
        links=links,
        flange=Pose(here, constants(rpy_from_rotation(multiply(R, rotation_from_rpy(FLANGE_RPY))))),
        tool0=Pose(
            plus(here, constants(rotate(R, tool.translation))),
            constants(rpy_from_rotation(multiply(R, tool.rotation))),
        ),
    )


def standard_frames(manipulator: Manipulator, symbol: Symbol) -> Frames:
    """Link i in DH frame i-1 of the standard convention, turned or moved by its joint."""
    base = settled(manipulator.base)
    place, axis = Pose(NO_VECTOR, NO_VECTOR), _Z  # of the next joint, and its axis there
    links = []
    angles = [_angles(number, row, symbol) for number, row in enumerate(manipulator.rows, start=1)]
    for row, (a, delta), (alpha, theta, (ca, sa), (ct, st)) in zip(
        manipulator.rows, _lengths(manipulator, symbol), angles, strict=True
    ):
        corner, along_x = (NOTHING, NOTHING, delta), (ct, st, NOTHING)
        end = (a * ct, a * st, delta)
        links.append(
            LinkFrame(
                joint=place,
                axis=signed(row.sign, Z_AXIS),
                rail=Line(place.xyz, axis, place.rpy),
                foot=NO_VECTOR,
                corner=corner,
                end=end,
                offset=Segment.between(NO_VECTOR, _Z, delta, NO_VECTOR),
                normal=Segment.between(corner, along_x, a, (NOTHING, Quantity(HALF_PI), theta)),
                dh_frame=dh_transform_of(
                    Convention.STANDARD,
                    a=a.value,
                    d=delta.value,
                    twist=(ca.value, sa.value),
                    turn=(ct.value, st.value),
                ),
            )
        )
        # Rz(ϑ) Tz(δ) Tx(a) Rx(α): in fixed-axis angles that is roll α and yaw ϑ.
        place = Pose(end, (alpha, NOTHING, theta))
        axis = (sa * st, -(sa * ct), ca)
    # Rz(ϑ)·Rx(α)·rpy(0, -π/2, -π/2) is pitch α - π/2 and yaw ϑ - π/2.
    quarter = Quantity(-HALF_PI)
    return Frames(
        base=Pose(constants(base.translation), constants(base.rpy)),
        pedestal=Line(NO_VECTOR, _Z, NO_VECTOR),
        front=Segment(NO_VECTOR, NOTHING, NO_VECTOR),
        links=links,
        flange=Pose(place.xyz, (NOTHING, alpha + quarter, theta + quarter)),
        tool0=_standard_tool(place, angles[-1], settled(manipulator.tool)),
    )


def modified_frames(manipulator: Manipulator, symbol: Symbol) -> Frames:
    """Link i in DH frame i of the modified convention."""
    base, tool = settled(manipulator.base), settled(manipulator.tool)
    lengths = _lengths(manipulator, symbol)
    normals = [*(a for a, _ in lengths), NOTHING]
    links = []
    for number, (row, (a, delta), normal) in enumerate(zip(manipulator.rows, lengths, normals[1:], strict=True), 1):
        alpha, _, (ca, sa), (ct, st) = _angles(number, row, symbol)
        # Rx(α) Tx(a) Rz(ϑ) Tz(δ)
        pivot, along = (a, NOTHING, NOTHING), (NOTHING, -sa, ca)
        turn = (ct, -st, NOTHING, ca * st, ca * ct, -sa, sa * st, sa * ct, ca)
        links.append(
            LinkFrame(
                joint=Pose(plus(pivot, times(delta, along)), rpy_of(turn)),
                axis=signed(row.sign, Z_AXIS),
                rail=Line(pivot, along, (alpha, NOTHING, NOTHING)),
                foot=(NOTHING, NOTHING, -delta),
                corner=NO_VECTOR,
                end=(normal, NOTHING, NOTHING),
                offset=Segment.between(NO_VECTOR, _DOWN, delta, NO_VECTOR),
                normal=Segment.between(NO_VECTOR, _X, normal, _ALONG_X),
                dh_frame=IDENTITY,
            )
        )
    return Frames(
        base=Pose(constants(base.translation), constants(base.rpy)),
        pedestal=Line(NO_VECTOR, _Z, NO_VECTOR),
        front=Segment.between(NO_VECTOR, _X, normals[0], _ALONG_X),
        links=links,
        flange=Pose(NO_VECTOR, constants(FLANGE_RPY)),
        tool0=Pose(constants(tool.translation), constants(tool.rpy)),
    )


def composed(first: Pose, second: Pose) -> Pose:
    """A frame that is in a frame that is in another one."""
    if all(angle is NOTHING for angle in first.rpy):
        return Pose(plus(first.xyz, second.xyz), second.rpy)
    outer, xyz = _rotation_of(first.rpy), cast("Any", second.xyz)
    moved, product = cast("Any", rotate(outer, xyz)), cast("Any", multiply(outer, _rotation_of(second.rpy)))
    return Pose(plus(first.xyz, moved), rpy_of(product))


def _rotation_of(rpy: Quantities) -> Any:  # noqa: ANN401 - a rotation of quantities
    """Rz(yaw)·Ry(pitch)·Rx(roll), row by row."""
    (cr, sr), (cp, sp), (cy, sy) = (cos_sin_of(angle, angle) for angle in rpy)
    return (
        *(cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        *(sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        *(-sp, cp * sr, cp * cr),
    )


def settled(transform: RigidTransform) -> RigidTransform:
    """A transform whose rotation, where it is one of the 24 quarter turns but for rounding, is exactly that.

    A table may give base and tool as a matrix, with 6.1e-17 where a computed cosine should be 0.
    """
    whole = tuple(float(round(element)) + 0.0 for element in transform.rotation)
    if any(abs(element - n) > _ROUNDING for element, n in zip(transform.rotation, whole, strict=True)):
        return transform
    a, b, c, d, e, f, g, h, i = whole
    return RigidTransform((a, b, c, d, e, f, g, h, i), transform.translation)


def _standard_tool(place: Pose, angles: Angles, tool: RigidTransform) -> Pose:
    """The tool after the last row, whose frame is `place`: Rz(ϑ) Tz(δ) Tx(a) Rx(α) · tool."""
    _, theta, (ca, sa), (ct, st) = angles
    xyz, rpy = place
    if any(tool.translation):
        x, y, z = constants(tool.translation)
        across = ca * y - sa * z
        xyz = plus(xyz, (ct * x - st * across, st * x + ct * across, sa * y + ca * z))
    if tool.rotation != IDENTITY_ROTATION:
        first, second, third = (constants(tool.rotation[k : k + 3]) for k in (0, 3, 6))
        middle, last = plus(times(ca, second), times(-sa, third)), plus(times(sa, second), times(ca, third))
        roll, pitch, yaw = rpy_of((*first, *middle, *last))
        rpy = (roll, pitch, yaw + theta)
    return Pose(xyz, rpy)


def _lengths(manipulator: Manipulator, symbol: Symbol) -> list[tuple[Quantity, Quantity]]:
    """A and δ of every row [m], as quantities named after its number from 1."""
    lengths = []
    for number, row in enumerate(manipulator.rows, start=1):
        a, d = symbol(f"a_{number}", row.a), symbol(f"d_{number}", row.d)
        lengths.append((a, d + Quantity(row.offset) if row.type is JointType.PRISMATIC else d))
    return lengths


def _angles(number: int, row: DHRow, symbol: Symbol) -> Angles:
    """The angles of a row, as quantities named after its number from 1."""
    alpha, theta = symbol(f"alpha_{number}", row.alpha), symbol(f"theta_{number}", row.theta)
    turned = theta + Quantity(row.offset) if row.type in (JointType.REVOLUTE, JointType.CONTINUOUS) else theta
    return alpha, turned, cos_sin_of(alpha, alpha), cos_sin_of(turned, theta)


def _line(at: Quantities, along: Vec3) -> Line:
    """A line in a direction that no parameter changes."""
    return Line(at, constants(along), constants(direction_rpy(along)))
