"""The shapes of a URDF that its reader has no word for: capsules become what robots have, and others are left out."""

from __future__ import annotations

from copy import deepcopy
from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.robot import Cylinder, Origin
from dh2urdf.source import shown
from dh2urdf_plugins.read_back.capsules import capsule

if TYPE_CHECKING:
    from collections.abc import Iterator

_READ = ("box", "cylinder", "sphere", "mesh")


def with_known_shapes(root: etree._Element) -> Iterator[tuple[str, etree._Element]]:
    """Changes the elements of a URDF so that every shape can be read.

    Args:
        root: the outermost element; it is changed.

    Yields:
        What is left out, in words, and where.
    """
    for shape in [*root.iterfind("link/visual"), *root.iterfind("link/collision")]:
        geometry = shape.find("geometry")
        kind = None if geometry is None else next(geometry.iterchildren(etree.Element), None)
        if kind is not None and kind.tag in _READ:
            continue
        link = shape.getparent()
        if link is None:  # It is the child of a link.
            continue
        parts = _capsule(shape, kind) if kind is not None and kind.tag == "capsule" else None
        if parts is None:
            yield f"a {shape.tag} without a shape" if kind is None else f"a shape {shown(str(kind.tag))}", shape
        for part in parts or ():
            shape.addprevious(part)
        link.remove(shape)


def _capsule(shape: etree._Element, kind: etree._Element) -> list[etree._Element] | None:
    """A cylinder and two balls in the place of a capsule; None where its numbers cannot be read."""
    origin = shape.find("origin")
    try:
        radius, length = (float(kind.get(name, "")) for name in ("radius", "length"))
        (x, y, z), (roll, pitch, yaw) = (
            map(float, ("0 0 0" if origin is None else origin.get(name, "0 0 0")).split()) for name in ("xyz", "rpy")
        )
    except ValueError:
        return None
    place = Origin(xyz=(x, y, z), rpy=(roll, pitch, yaw)).transform
    parts = []
    for geometry, pose in capsule(radius, length):
        part = deepcopy(shape)
        for old in [*part.iterchildren("origin", "geometry")]:
            part.remove(old)
        xyz, rpy = ((place @ pose).translation, (roll, pitch, yaw))
        etree.SubElement(part, "origin", xyz=" ".join(map(repr, xyz)), rpy=" ".join(map(repr, rpy)))
        attributes = {"radius": repr(radius)}
        if isinstance(geometry, Cylinder):
            attributes["length"] = repr(length)
        etree.SubElement(etree.SubElement(part, "geometry"), type(geometry).__name__.lower(), attributes)
        for element in part.iter():
            element.sourceline = shape.sourceline
        parts.append(part)
    return parts
