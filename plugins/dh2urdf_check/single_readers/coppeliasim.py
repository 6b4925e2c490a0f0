"""Rules that only CoppeliaSim's importer breaks: scales, colours and visuals that everybody else takes as they are."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.source import shown
from dh2urdf_check.document.description import Hit, few

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description

LARGEST_SCALE = 0.99999
"""Scales whose factors have a product above this are ignored; seen: 0.999995 is, 0.99998 is not."""


def hits(description: Description) -> Iterator[Hit]:
    """What there is to say, once for a file."""
    yield from _scales(description)
    yield from _named_colours(description)
    yield from _unseen(description)


def _scales(description: Description) -> Iterator[Hit]:
    scaled = [
        mesh
        for link in description.links
        for shape in link.shapes
        if (mesh := shape.first("geometry", "mesh")) is not None
        and (scale := mesh.numbers("scale", 3))
        and math.prod(scale) > LARGEST_SCALE
        and set(scale) != {1.0}
    ]
    if scaled:
        first = shown(scaled[0].get("scale") or "")
        message = (
            f"the scale of a mesh is {first}" if len(scaled) == 1 else f"{len(scaled)} meshes have one, first {first}"
        )
        yield Hit("mesh-scale", scaled[0], message)


def _named_colours(description: Description) -> Iterator[Hit]:
    """Materials of visuals without a colour of their own, where some element defines it."""
    defined = {
        material.get("name")
        for material in description.root.walk()
        if material.tag == "material" and material.first("color") is not None
    }
    named = [
        material
        for link in description.links
        for shape in link.shapes
        if shape.tag == "visual"
        and (material := shape.first("material")) is not None
        and material.first("color") is None
        and material.get("name") in defined - {None, ""}
    ]
    if named:
        names = few(material.get("name") or "" for material in named)
        yield Hit("named-colour", named[0], f"visuals name the materials {names}")


def _unseen(description: Description) -> Iterator[Hit]:
    unseen = [link for link in description.links if link.shapes and all(s.tag == "collision" for s in link.shapes)]
    if unseen:
        yield Hit("collision-without-visual", unseen[0].shapes[0], f"no visual has {few(link.name for link in unseen)}")
