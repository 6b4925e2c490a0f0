"""What colours mean in the scene."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from dh2urdf.manipulator import JointType

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

Colour: TypeAlias = tuple[float, float, float]
"""Red, green, blue in 0..1."""

GREY: Colour = (0.72, 0.74, 0.77)
WHITE: Colour = (1.0, 1.0, 1.0)
COLLISION: Colour = (0.85, 0.2, 0.45)
MASS: Colour = (0.45, 0.3, 0.75)
CENTRE: Colour = (1.0, 0.85, 0.1)
PAPER: Colour = (0.45, 0.24, 0.72)
BESIDE: Colour = (0.03, 0.55, 0.42)
_TURNS: tuple[Colour, ...] = ((0.85, 0.1, 0.6), (1.0, 0.85, 0.1))
AXIS_COLOURS: Mapping[JointType, tuple[Colour, ...]] = {
    JointType.REVOLUTE: _TURNS,
    JointType.CONTINUOUS: _TURNS,
    JointType.PRISMATIC: ((0.0, 0.72, 0.62), (0.75, 0.95, 0.2)),
}
"""Colours of a joint's axis: the usual one, and the one for links of nearly that colour."""
APART = 0.3
"""Distance of two colours that are told apart."""


def axis_colour(kind: JointType, links: Iterable[Colour]) -> Colour | None:
    """The colour of a joint's axis, which is never that of the links it joins; None for a joint that does not move."""
    choices, near = AXIS_COLOURS.get(kind), tuple(links)
    if choices is None:
        return None
    return next((one for one in choices if all(math.dist(one, other) >= APART for other in near)), choices[-1])
