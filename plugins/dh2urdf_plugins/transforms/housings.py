"""What a link of the shape ``arm`` looks like: a housing at its joint, and tubes that lead to the next one.

The housing is a cylinder along the joint's axis with a cap at each end, thicker than the tubes, so that the axis is
seen and neighbours seem to meet in it. All sizes follow the link's radius. The tubes lie where the segments of the
other shapes lie, and only they touch: bodies that are next to each other on the arm have a gap between them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf import unchecked_records as own
from dh2urdf.elementwise import where
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Cylinder
from dh2urdf_plugins.transforms.formulas import Quantity, constants, origin, plus, signed, times
from dh2urdf_plugins.transforms.shapes import BASE_COLOUR, Style, caps, visuals

if TYPE_CHECKING:
    from dh2urdf.elementwise import Number
    from dh2urdf.manipulator import DHRow
    from dh2urdf.robot import Material, Visual
    from dh2urdf.rotations import Vec3
    from dh2urdf_plugins.transforms.formulas import Quantities
    from dh2urdf_plugins.transforms.frames import LinkFrame

TUBE = 0.8
"""Radius of a tube, in radii of the link, like all sizes here."""
BARREL, BARREL_LENGTH = 1.25, 2.2
"""Radius and length of a housing."""
CAP, CAP_LENGTH = 1.1, 0.15
"""Radius and length of the caps at its ends."""
AHEAD = 0.3
"""How far a housing stands off its joint's origin to the side where its tube is."""


def tube_style(style: Style) -> Style:
    """How the tubes of a link are drawn."""
    return Style(shape="cylinder", radius=TUBE * style.radius, material=style.material)


def arm_visuals(row: DHRow, frame: LinkFrame, style: Style, *, is_first: bool) -> tuple[Visual, ...]:
    """The bodies of a link: tubes, a ball where two of them meet, and the housing of its joint.

    A fixed row is no joint: it has a housing only where it has no tube.

    Args:
        row: the row of the link.
        frame: where the link is.
        style: how it is drawn.
        is_first: whether the base carries it: its housing stands on the base, and not through it.

    Raises:
        DividedError: some of many robots are drawn otherwise.
    """
    prismatic, tube = row.type is JointType.PRISMATIC, tube_style(style)
    seen = visuals([frame.normal] if prismatic else [frame.offset, frame.normal], tube)
    has_offset = not prismatic and tube.draws(frame.offset)
    if has_offset and tube.draws(frame.normal):
        seen += caps([frame.corner], tube)
    if row.type is JointType.FIXED and seen:
        return seen
    along = signed(row.sign, frame.axis)
    if not has_offset:
        return housing_of(frame.corner, along, 0.0, frame.offset.rpy, style) + seen
    way = where(frame.offset.length.value < 0.0, -1.0, 1.0)
    ahead = 0.5 * BARREL_LENGTH + CAP_LENGTH if is_first else AHEAD
    return housing_of(frame.foot, along, way * (ahead * style.radius), frame.offset.rpy, style) + seen


def housing_of(at: Quantities, along: Vec3, ahead: Number, rpy: Quantities, style: Style) -> tuple[Visual, ...]:
    """A cylinder along an axis, and its caps.

    Args:
        at: a point on the axis [m].
        along: the axis, a unit vector.
        ahead: how far along it from the point the middle is [m].
        rpy: orientation of a body whose z axis lies along the axis [rad].
        style: how the link is drawn.
    """
    radius = style.radius
    half = 0.5 * (BARREL_LENGTH + CAP_LENGTH) * radius
    barrel = Cylinder(radius=BARREL * radius, length=BARREL_LENGTH * radius)
    cap = Cylinder(radius=CAP * radius, length=CAP_LENGTH * radius)

    def body(shape: Cylinder, offset: Number, material: Material) -> Visual:
        place = plus(at, times(Quantity(offset), constants(along)))
        return own.visual(geometry=shape, origin=origin(place, rpy), material=material)

    return (
        body(barrel, ahead, style.material),
        body(cap, ahead - half, BASE_COLOUR),
        body(cap, ahead + half, BASE_COLOUR),
    )
