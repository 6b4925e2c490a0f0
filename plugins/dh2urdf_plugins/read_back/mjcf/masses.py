"""The masses that bodies of an MJCF have from their shapes, where none are written."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Inertia
from dh2urdf.mass_properties import compound, placed, scaled, solid
from dh2urdf.robot import Box, Cylinder, Inertial, Sphere
from dh2urdf.rotations import IDENTITY_ROTATION, RigidTransform

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf_plugins.read_back.mjcf.elements import Elements
    from dh2urdf_plugins.read_back.mjcf.shapes import Geom

_WATER = 1000.0
"""The density of a shape that has none [kg/m³]."""
WITHOUT_MASS = ("plane", "hfield")
"""Shapes that have no mass."""


def mass_of_shapes(geoms: Iterable[Geom], elements: Elements) -> Inertial | None:
    """The mass of a body that follows from its shapes, as MuJoCo computes it; None where it has none.

    https://mujoco.readthedocs.io/en/stable/XMLreference.html#body-inertial
    """
    bodies: list[Inertial] = []
    first, last = elements.numbers(elements.root, elements.compiler, "inertiagrouprange", (0.0, 5.0))
    for geom in geoms:
        (group,) = elements.numbers(geom.element, geom.attributes, "group", (0.0,))
        if not first <= group <= last:
            continue
        mass, density = (
            elements.numbers(geom.element, geom.attributes, name, (default,))[0]
            for name, default in (("mass", -1.0), ("density", _WATER))
        )
        if geom.kind in WITHOUT_MASS or mass == 0.0 or (mass < 0.0 and density == 0.0):
            continue
        body = None if "mesh" in geom.attributes else _solid(geom)
        if body is None or not body.mass or geom.attributes.get("shellinertia") == "true":
            elements.not_read(geom.element, "a mass that follows from a mesh or a shell")
            return None
        factor = density if mass < 0.0 else mass / body.mass
        body = Inertial(mass=factor * body.mass, com=body.com, inertia=scaled(body.inertia, factor))
        bodies.append(placed(body, geom.pose))
    return compound(bodies) if bodies else None


def _solid(geom: Geom) -> Inertial | None:
    """A shape as a body of 1 kg/m³, in its own frame."""
    x, y, z = geom.size
    match geom.kind:
        case "box":
            return solid(Box(size=(2.0 * x, 2.0 * y, 2.0 * z)), 1.0)
        case "cylinder":
            return solid(Cylinder(radius=x, length=2.0 * y), 1.0)
        case "sphere":
            return solid(Sphere(radius=x), 1.0)
        case "ellipsoid":
            mass = 4.0 / 3.0 * math.pi * x * y * z
            squares = (y * y + z * z, x * x + z * z, x * x + y * y)
            ixx, iyy, izz = (mass / 5.0 * square for square in squares)
            return Inertial(mass=mass, inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz))
        case "capsule":
            ends = [placed(_half_ball(x), RigidTransform(IDENTITY_ROTATION, (0.0, 0.0, y)))]
            ends.append(
                placed(_half_ball(x), RigidTransform((1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0), (0.0, 0.0, -y)))
            )
            return compound([solid(Cylinder(radius=x, length=2.0 * y), 1.0), *ends])
    return None


def _half_ball(radius: float) -> Inertial:
    """The half of a ball above its middle; across its axis it has 83/320 m r² about its centre of mass."""
    mass, square = 2.0 / 3.0 * math.pi * radius**3, radius * radius
    across = 83.0 / 320.0 * mass * square
    inertia = Inertia(ixx=across, iyy=across, izz=0.4 * mass * square)
    return Inertial(mass=mass, com=(0.0, 0.0, 0.375 * radius), inertia=inertia)
