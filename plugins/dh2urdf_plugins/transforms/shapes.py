"""What a link looks like: the segments of a DH link as solid bodies.

A DH link is an L: the offset d along its joint's axis, then the length a along the common normal. Each segment that is
not zero is a body of its own, so the model looks like the arm. The offset of a prismatic joint changes as it moves:
there the link before carries a rail from the lower limit to the upper one, with a foot that reaches it, and the link
itself is a carriage on it. A link with no segment gets a joint housing. `housings` has the shape ``arm``.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import reduce
from typing import TYPE_CHECKING, NamedTuple, get_args

from dh2urdf import unchecked_records as own
from dh2urdf.elementwise import agreed, atan2, for_some, greater_of, hypot, smaller_of, where
from dh2urdf.robot import Box, Collision, Cylinder, Material, Sphere, Visual
from dh2urdf_plugins.transforms.alpha_swap_options import Shape
from dh2urdf_plugins.transforms.formulas import HALF, NO_VECTOR, Quantities, Quantity, length_of, origin, plus, times

if TYPE_CHECKING:
    from dh2urdf.elementwise import Condition
    from dh2urdf.robot import Geometry
    from dh2urdf.rotations import Vec3

SHAPES: tuple[str, ...] = get_args(Shape)

DEFAULT_RADIUS = 0.04
"""Radius of links at most [m]; a tenth of the longest segment where that is smaller."""

BASE_WIDTH = 1.5
"""Radius of the base in radii of a link; it is one radius high."""

SHORTEST = 1e-3
"""Length of a body in radii; what is not longer is nothing to draw."""

SMALLEST = 1e-6
"""Length [m] up to which an arm has no segment that could give it a scale."""

BASE_COLOUR = Material(name="graphite", rgba=(0.2, 0.21, 0.23, 1.0))
LINK_COLOURS = (
    Material(name="silver", rgba=(0.78, 0.8, 0.82, 1.0)),
    Material(name="blue", rgba=(0.16, 0.42, 0.68, 1.0)),
    Material(name="orange", rgba=(0.93, 0.5, 0.13, 1.0)),
)


class Segment(NamedTuple):
    """A straight part of a link, in the link's frame.

    Attributes:
        centre: its middle [m].
        length: its length; the sign does not matter [m].
        rpy: orientation of a body whose z axis lies along it [rad].
    """

    centre: Quantities
    length: Quantity
    rpy: Quantities

    @classmethod
    def between(cls, start: Quantities, direction: Quantities, length: Quantity, rpy: Quantities) -> Segment:
        """The segment that begins at a point and runs a signed length along a direction."""
        return cls(plus(start, times(length, times(HALF, direction))), length, rpy)


@dataclass(frozen=True, slots=True, kw_only=True)
class Style:
    """How a link is drawn.

    Attributes:
        shape: of its segments, one of `SHAPES`.
        radius: radius, or half the thickness of a box [m].
        material: its colour.
    """

    shape: str
    radius: float
    material: Material

    @property
    def shortest(self) -> float:
        """Length up to which there is nothing to draw [m]."""
        return SHORTEST * self.radius

    def draws(self, segment: Segment) -> bool:
        """Whether a segment is long enough to be drawn.

        Raises:
            DividedError: those of some of many robots are.
        """
        return agreed(abs(segment.length.value) > self.shortest)


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
    return tuple(
        own.visual(
            geometry=_prism(style, length_of(segment.length, least=style.shortest)),
            origin=origin(segment.centre, segment.rpy),
            material=style.material,
        )
        for segment in segments
        if style.draws(segment)
    )


def caps(points: list[Quantities], style: Style) -> tuple[Visual, ...]:
    """The spheres at the ends of a capsule's segments."""
    return tuple(
        own.visual(geometry=Sphere(radius=style.radius), origin=origin(point), material=style.material)
        for point in points
    )


def collisions(segments: list[Segment], style: Style) -> tuple[Collision, ...]:
    """The bodies of segments, one radius shorter at each end so that neighbours do not touch.

    They are left out where nothing remains, and have no caps. Of many robots, what remains for some is there for all;
    `remains` tells for which.
    """
    both_ends = 2.0 * style.radius
    return tuple(
        own.collision(
            geometry=_prism(style, length_of(segment.length, both_ends, least=style.shortest)),
            origin=origin(segment.centre, segment.rpy),
        )
        for segment in segments
        if for_some(abs(segment.length.value) - both_ends > style.shortest)
    )


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
    geometry: Geometry
    if style.shape == "capsule":
        geometry, rpy = Sphere(radius=style.radius), NO_VECTOR
    else:
        geometry = _prism(style, Quantity(2.0 * style.radius))
    return own.visual(geometry=geometry, origin=origin(at, rpy), material=style.material)


def pedestal(at: Quantities, up: Quantities, rpy: Quantities, style: Style) -> Visual:
    """The body of the base, at a point: 1.5 radii in radius, one radius high."""
    wide = Style(shape=style.shape, radius=BASE_WIDTH * style.radius, material=style.material)
    segment = Segment.between(at, up, Quantity(style.radius), rpy)
    shape = _prism(wide, segment.length)
    return own.visual(geometry=shape, origin=origin(segment.centre, rpy), material=style.material)


def _prism(style: Style, length: Quantity) -> Box | Cylinder:
    """A straight body along z."""
    formula = None if length.constant else length.formula
    if style.shape == "box":
        side = Quantity(2.0 * style.radius)
        return Box(
            size=(side.value, side.value, length.value),
            size_formula=(side.formula, side.formula, formula) if formula else None,
        )
    return Cylinder(radius=style.radius, length=length.value, length_formula=formula)
