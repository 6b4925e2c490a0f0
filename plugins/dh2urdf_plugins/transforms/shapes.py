"""What a link looks like: the segments of a DH link as solid bodies.

A DH link is an L: the offset d along its joint's axis, then the length a along the common normal. Each segment that is
not zero is a body of its own, so the model looks like the arm. The offset of a prismatic joint changes as it moves:
there the link before carries a rail from the lower limit to the upper one, with a foot that reaches it, and the link
itself is a carriage on it. A link with no segment gets a joint housing.

The shape ``arm`` has a housing at each joint, and tubes that lead to the next one. The housing is a cylinder along the
joint's axis with a cap at each end, thicker than the tubes, so that the axis is seen and neighbours seem to meet in it.
The tubes lie where the segments of the other shapes lie, and only they touch.
"""

from __future__ import annotations

from functools import reduce
from typing import TYPE_CHECKING, NamedTuple, get_args

from dh2urdf.robot import Box, Collision, Cylinder, Material, Sphere, Visual, new_collision, new_visual
from dh2urdf.rotations import agreed, atan2, for_some, greater_of, hypot, smaller_of, where
from dh2urdf_plugins.transforms.alpha_swap import Shape
from dh2urdf_plugins.transforms.formulas import (
    HALF,
    NO_VECTOR,
    Quantities,
    Quantity,
    length_of,
    origin,
    plus,
    times,
)

if TYPE_CHECKING:
    from dh2urdf.robot import Geometry
    from dh2urdf.rotations import Condition, Vec3

SHAPES: tuple[str, ...] = get_args(Shape)

DEFAULT_RADIUS = 0.04
"""Radius of links at most [m]; a tenth of the longest segment where that is smaller."""
BASE_WIDTH = 1.5
"""Radius of the base in radii of a link; it is one radius high."""
SHORTEST = 1e-3
"""Length of a body in radii; what is not longer is nothing to draw."""
SMALLEST = 1e-6
"""Length [m] up to which an arm has no segment that could give it a scale."""
TUBE = 0.8
"""Radius of a tube of the shape ``arm``, in radii of the link, like all sizes of that shape."""
BARREL, BARREL_LENGTH = 1.25, 2.2
"""Radius and length of a housing."""
CAP, CAP_LENGTH = 1.1, 0.15
"""Radius and length of the caps at its ends."""
AHEAD = 0.3
"""How far a housing stands off its joint's origin to the side where its tube is."""

BASE_COLOUR = Material(name="graphite", rgba=(0.2, 0.21, 0.23, 1.0))
LINK_COLOURS = (
    Material(name="silver", rgba=(0.78, 0.8, 0.82, 1.0)),
    Material(name="blue", rgba=(0.16, 0.42, 0.68, 1.0)),
    Material(name="orange", rgba=(0.93, 0.5, 0.13, 1.0)),
)


class Segment(NamedTuple):
    """A straight part of a link, in the link's frame."""

    centre: Quantities  # its middle [m]
    length: Quantity  # its length; the sign does not matter [m]
    rpy: Quantities  # orientation of a body whose z axis lies along it [rad]

    @classmethod
    def between(cls, start: Quantities, direction: Quantities, length: Quantity, rpy: Quantities) -> Segment:
        """The segment that begins at a point and runs a signed length along a direction."""
        return cls(plus(start, times(length, times(HALF, direction))), length, rpy)


class Style(NamedTuple):
    """How a link is drawn."""

    shape: str  # of its segments, one of `SHAPES`
    radius: float  # radius, or half the thickness of a box [m]
    material: Material

    def draws(self, segment: Segment) -> bool:
        """Whether a segment is long enough to be drawn.

        Raises:
            DividedError: those of some of many robots are.
        """
        return agreed(abs(segment.length.value) > SHORTEST * self.radius)

    def prism(self, length: Quantity) -> Box | Cylinder:
        """A straight body along z."""
        formula = None if length.constant else length.formula
        if self.shape == "box":
            side = Quantity(2.0 * self.radius)
            size_formula = (side.formula, side.formula, formula) if formula else None
            return Box(size=(side.value, side.value, length.value), size_formula=size_formula)
        return Cylinder(radius=self.radius, length=length.value, length_formula=formula)


def default_radius(segments: list[float]) -> float:
    """The radius of an arm's links [m], given the lengths of its segments [m]."""
    longest = reduce(greater_of, segments, 0.0)
    radius: float = where(longest > SMALLEST, smaller_of(DEFAULT_RADIUS, longest / 10.0), DEFAULT_RADIUS)
    return radius


def direction_rpy(direction: Vec3) -> Vec3:
    """Roll, pitch and yaw [rad] of a body whose z axis lies along a unit vector, whichever way round.

    Rz(0)·Ry(pitch)·Rx(roll) turns z into (sin pitch cos roll, -sin roll, cos pitch cos roll).
    """
    x, y, z = direction
    is_reversed = (z < 0.0) | ((z == 0.0) & ((x < 0.0) | ((x == 0.0) & (y > 0.0))))
    way = where(is_reversed, -1.0, 1.0)
    x, y, z = way * x, way * y, way * z
    return (atan2(-y + 0.0, hypot(x, z)), atan2(x + 0.0, z + 0.0), 0.0)


def visuals(segments: list[Segment], style: Style) -> tuple[Visual, ...]:
    """The bodies of segments; those that are too short to see are left out."""
    seen = []
    for segment in filter(style.draws, segments):
        body = style.prism(length_of(segment.length, least=SHORTEST * style.radius))
        seen.append(new_visual(geometry=body, origin=origin(segment.centre, segment.rpy), material=style.material))
    return tuple(seen)


def caps(points: list[Quantities], style: Style) -> tuple[Visual, ...]:
    """The spheres at the ends of a capsule's segments."""
    ball = Sphere(radius=style.radius)
    return tuple(new_visual(geometry=ball, origin=origin(point), material=style.material) for point in points)


def collisions(segments: list[Segment], style: Style) -> tuple[Collision, ...]:
    """The bodies of segments, one radius shorter at each end so that neighbours do not touch.

    They are left out where nothing remains, and have no caps. Of many robots, what remains for some is there for all;
    `remains` tells for which.
    """
    both_ends, shortest = 2.0 * style.radius, SHORTEST * style.radius
    touching = []
    for segment in segments:
        if for_some(abs(segment.length.value) - both_ends > shortest):
            body = style.prism(length_of(segment.length, both_ends, least=shortest))
            touching.append(new_collision(geometry=body, origin=origin(segment.centre, segment.rpy)))
    return tuple(touching)


def remains(body: Geometry) -> Condition:
    """Whether a body is longer than the shortest of its radius: the others are nothing to touch."""
    match body:
        case Box(size=(width, _, length)):
            return length > SHORTEST * (0.5 * width)
        case Cylinder(radius=radius, length=length):
            return length > SHORTEST * radius
    return True


def housing(at: Quantities, rpy: Quantities, style: Style) -> Visual:
    """The body of a link without segments: as long as it is thick, along its joint's axis."""
    geometry: Geometry = style.prism(Quantity(2.0 * style.radius))
    if style.shape == "capsule":
        geometry, rpy = Sphere(radius=style.radius), NO_VECTOR
    return new_visual(geometry=geometry, origin=origin(at, rpy), material=style.material)


def pedestal(at: Quantities, up: Quantities, rpy: Quantities, style: Style) -> Visual:
    """The body of the base, at a point: 1.5 radii in radius, one radius high."""
    segment = Segment.between(at, up, Quantity(style.radius), rpy)
    shape = style._replace(radius=BASE_WIDTH * style.radius).prism(segment.length)
    return new_visual(geometry=shape, origin=origin(segment.centre, rpy), material=style.material)
