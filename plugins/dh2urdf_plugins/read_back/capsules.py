"""Capsules, which robots have as a cylinder with a ball at each end."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.late_tuples import NamedTuple
from dh2urdf.robot import Cylinder, Sphere
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, RigidTransform

if TYPE_CHECKING:
    from dh2urdf.robot import Geometry


class Placed(NamedTuple):
    """A part of a shape, and where it is in the frame of the shape."""

    geometry: Geometry
    pose: RigidTransform = IDENTITY


def capsule(radius: float, length: float) -> list[Placed]:
    """The parts of a capsule along z; its length is that between the middles of its ends [m]."""
    ends = [RigidTransform(IDENTITY_ROTATION, (0.0, 0.0, end)) for end in (0.5 * length, -0.5 * length)]
    return [Placed(Cylinder(radius=radius, length=length)), *(Placed(Sphere(radius=radius), end) for end in ends)]
