"""The shapes of an MJCF, made of those that a robot has: box, cylinder, sphere and mesh.

The masses that bodies of an MJCF have from their shapes, where none are written.
"""

from __future__ import annotations

import math
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.mass import compound, placed, scaled, solid
from dh2urdf.manipulator import Inertia
from dh2urdf.robot import Collision, Cylinder, Inertial, Material, Mesh, Origin, Visual
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    ZERO,
    RigidTransform,
    Vec3,
    rotate,
    rotation_from_quaternion,
    transpose,
)
from dh2urdf.source import shown
from dh2urdf_plugins.formats.mjcf.elements import Elements
from dh2urdf_plugins.formats.xml_files import Placed, parts_of

if TYPE_CHECKING:
    from lxml import etree


_GRAY = (0.5, 0.5, 0.5, 1.0)
"""The colour of a shape that has none."""
_HIDDEN = ("3", "4", "5")
"""Groups that MuJoCo's viewer does not draw unless it is asked."""
_ROUND = ("cylinder", "capsule")
_LONG = (*_ROUND, "box", "ellipsoid")
"""Shapes that may be placed by their ends."""
_SIZES = {"box": 3, "ellipsoid": 3, "cylinder": 2, "capsule": 2, "sphere": 1}
"""How many sizes a shape has."""
_WATER = 1000.0
"""The density of a shape that has none [kg/m³]."""
_WITHOUT_MASS = ("plane", "hfield")
"""Shapes that have no mass."""


class Geom(NamedTuple):
    """A shape of a body."""

    element: etree._Element
    attributes: dict[str, str]  # of the element, those of its class included
    kind: str
    size: Vec3  # half of a box's sides or an ellipsoid's axes; else radius, and half of the length [m]
    pose: RigidTransform  # its frame in the body

    @property
    def touches(self) -> bool:
        """Whether it is more than what is seen."""
        return not self.attributes.get("contype") == self.attributes.get("conaffinity") == "0"


class Shapes(Elements):
    """The elements of a model, and the shapes of its bodies."""

    def __init__(self, root: etree._Element, file: str) -> None:
        super().__init__(root, file)
        # A mesh without a name has that of its file.
        self._meshes = {
            mesh.get("name") or PurePosixPath((mesh.get("file") or "").replace("\\", "/")).stem: mesh
            for mesh in root.iterfind("asset/mesh")
        }
        self._materials = {each.get("name", ""): each for each in root.iterfind("asset/material")}

    def shapes_of(self, body: etree._Element) -> tuple[tuple[Visual, ...], tuple[Collision, ...]]:
        """What a body is seen as, and what it touches with.

        A shape that touches is seen, too, unless it is hidden, or the body has shapes that are only seen.
        """
        visuals: list[Visual] = []
        collisions: list[Collision] = []
        elements = self.held(body, "geom")
        drawn = [found for element in elements if (found := self.part(element, self._drawn, None))]
        has_own_look = not all(geom.touches for geom, _, _ in drawn)
        for geom, parts, material in drawn:
            is_seen = not geom.touches or not (has_own_look or geom.attributes.get("group", "0") in _HIDDEN)
            for geometry, pose in parts:
                origin = Origin.of(geom.pose if pose is IDENTITY else geom.pose @ pose)
                if geom.touches:
                    collisions.append(Collision(geometry=geometry, origin=origin))
                if is_seen:
                    visuals.append(Visual(geometry=geometry, origin=origin, material=material))
        return tuple(visuals), tuple(collisions)

    def _geom(self, element: etree._Element) -> Geom:
        """A shape of a body."""
        attributes = self.attributes(element)
        kind = attributes.get("type", "sphere")
        is_long = "fromto" in attributes and kind in _LONG
        count = 1 if is_long else 0 if "mesh" in attributes else _SIZES.get(kind, 0)
        numbers = self.numbers(element, attributes, "size", (0.0,) * count, most=3)
        if count and min(numbers) <= 0.0:
            accepted = "above 0" if is_long else f"{count} numbers above 0"
            text = shown(attributes.get("size", ""))
            raise self.error(element, "geom-size-wrong", text=text, accepted=accepted)
        x, y, z, *_ = (*numbers, 0.0, 0.0, 0.0)
        size = (x, y, z)
        if is_long:
            own, half = self.between_ends(element, attributes)
            size = (x, half if kind in _ROUND else x, half)
        else:
            own = self.own_pose(element, attributes)
        return Geom(element, attributes, kind, size, self.around(element, own))

    def _drawn(self, element: etree._Element) -> tuple[Geom, list[Placed], Material | None]:
        """A shape of a body, its parts, and its colour."""
        geom = self._geom(element)
        parts = self._mesh(geom) if "mesh" in geom.attributes else _parts(geom)
        if parts is None:
            self.not_read(element, f"a shape {shown(geom.kind)}")
        return geom, parts or [], self._colour(geom)

    def _mesh(self, geom: Geom) -> list[Placed]:
        mesh = self._meshes.get(name := geom.attributes["mesh"])
        if mesh is None:
            raise self.error(geom.element, "mesh-undefined", name=name)
        attributes = self.attributes(mesh)
        if geom.kind != "mesh":
            self.not_read(geom.element, f"a shape {shown(geom.kind)} that is fitted to a mesh")
            return []
        if not (file := attributes.get("file", "")):
            self.not_read(mesh, "a mesh without a file")
            return []
        if self.compiler.get("strippath") == "true":
            file = PurePosixPath(file.replace("\\", "/")).name
        factors = self.vector(mesh, attributes, "scale", (1.0, 1.0, 1.0))
        w, x, y, z = self.numbers(mesh, attributes, "refquat", (1.0, 0.0, 0.0, 0.0))
        back = transpose(rotation_from_quaternion((x, y, z, w))) if (x, y, z) != ZERO else IDENTITY_ROTATION
        if back != IDENTITY_ROTATION and len(set(factors)) > 1:
            self.not_read(mesh, "a mesh that is turned by refquat and scaled")
            return []
        moved = rotate(back, self.vector(mesh, attributes, "refpos", ZERO))
        x, y, z = (0.0 - factor * value for factor, value in zip(factors, moved, strict=True))
        return [Placed(Mesh(filename=file, scale=factors), RigidTransform(back, (x, y, z)))]

    def _colour(self, geom: Geom) -> Material | None:
        """The colour of a shape: its own unless that is the usual gray, else that of its material."""
        given = geom.attributes
        own = tuple(self.numbers(geom.element, given, "rgba", _GRAY))
        material = self._materials.get(given.get("material", ""))
        if material is not None and own == _GRAY:
            own = tuple(self.numbers(material, self.attributes(material), "rgba", (1.0, 1.0, 1.0, 1.0)))
        elif "rgba" not in given:
            return None
        r, g, b, a = own
        return Material(name="", rgba=(r, g, b, a))

    def mass_of_shapes(self, body: etree._Element) -> Inertial | None:
        """The mass of a body that follows from its shapes, as MuJoCo computes it; None where it has none.

        https://mujoco.readthedocs.io/en/stable/XMLreference.html#body-inertial
        """
        bodies: list[Inertial] = []
        first, last = self.numbers(self.root, self.compiler, "inertiagrouprange", (0.0, 5.0))
        for geom in map(self._geom, self.held(body, "geom")):
            group, mass, density = (
                self.numbers(geom.element, geom.attributes, name, (default,))[0]
                for name, default in (("group", 0.0), ("mass", -1.0), ("density", _WATER))
            )
            is_weightless = geom.kind in _WITHOUT_MASS or mass == 0.0 or (mass < 0.0 and density == 0.0)
            if is_weightless or not first <= group <= last:
                continue
            shape = None if "mesh" in geom.attributes else _solid(geom)
            if shape is None or not shape.mass or geom.attributes.get("shellinertia") == "true":
                self.not_read(geom.element, "a mass that follows from a mesh or a shell")
                return None
            factor = density if mass < 0.0 else mass / shape.mass
            shape = Inertial(mass=factor * shape.mass, com=shape.com, inertia=scaled(shape.inertia, factor))
            bodies.append(placed(shape, geom.pose))
        return compound(bodies) if bodies else None


def _parts(geom: Geom) -> list[Placed] | None:
    """The parts of a shape, whose sizes MuJoCo counts from the middle; None of one that no robot has."""
    x, y, z = (2.0 * half for half in geom.size)
    numbers = {"size": (x, y, z), "radius": (geom.size[0],), "length": (y,)}
    kind = "sphere" if geom.kind == "ellipsoid" and x == y == z else geom.kind
    return None if kind == "mesh" else parts_of(kind, lambda name, _: numbers[name], str)


def _solid(geom: Geom) -> Inertial | None:
    """A shape as a body of 1 kg/m³, in its own frame."""
    x, y, z = geom.size
    match geom.kind:
        case "box" | "cylinder" | "sphere" if parts := _parts(geom):
            return solid(parts[0].geometry, 1.0)
        case "ellipsoid":
            mass = 4.0 / 3.0 * math.pi * x * y * z
            ixx, iyy, izz = (mass / 5.0 * square for square in (y * y + z * z, x * x + z * z, x * x + y * y))
            return Inertial(mass=mass, inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz))
        case "capsule":  # The half of a ball has 83/320 m r² across its axis about its centre of mass.
            mass, square = 2.0 / 3.0 * math.pi * x**3, x * x
            across = 83.0 / 320.0 * mass * square
            inertia = Inertia(ixx=across, iyy=across, izz=0.4 * mass * square)
            half = Inertial(mass=mass, com=(0.0, 0.0, 0.375 * x), inertia=inertia)
            turned = (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0)
            ends = [
                placed(half, RigidTransform(turn, (0.0, 0.0, end)))
                for turn, end in ((IDENTITY_ROTATION, y), (turned, -y))
            ]
            return compound([solid(Cylinder(radius=x, length=2.0 * y), 1.0), *ends])
    return None
