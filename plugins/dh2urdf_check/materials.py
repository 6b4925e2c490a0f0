"""Rules about materials, of the robot and of its visuals."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.documents import is_file
from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.document.description import Hit
from dh2urdf_check.numbers import drake_numbers
from dh2urdf_check.shapes import resolved

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description
    from dh2urdf_check.document.tree import Element


def hits(description: Description) -> Iterator[Hit]:
    """Findings about every material."""
    defined: dict[str, Element] = {}
    for material in description.root.all("material"):
        name = material.get("name") or ""
        if name in defined:
            yield Hit("duplicate-material", material, f"material {shown(name)} is defined a second time")
        if not name:
            yield Hit("material-without-name", material, "a material of the robot has no name", {"drake"})
        if material.first("color") is None and not _is_there(material, description):
            message = f"material {shown(name)} of the robot has neither a colour nor a texture that is there"
            yield Hit("material-without-colour", material, message)
        yield from _bare_colour(material, {"mujoco", "drake", "ros", "gazebo"})
        defined.setdefault(name, material)
    for link in description.links:
        for shape in link.shapes:
            if shape.tag == "visual" and (used := shape.first("material")):
                yield from _of_visual(used, defined, description)


def _bare_colour(material: Element, of: set[str]) -> Iterator[Hit]:
    colour = material.first("color")
    if colour is not None and colour.get("rgba") is None and of:
        yield Hit("colour-without-components", colour, "a colour has no rgba", of)


def _of_visual(material: Element, defined: dict[str, Element], description: Description) -> Iterator[Hit]:
    """A visual's material, which may define what later ones name; an empty name is none, and all take it so."""
    name, colour, texture = material.get("name"), material.first("color"), material.first("texture")
    if name is None:
        of = {"pybullet", "pinocchio", "ros", "gazebo"}
        if colour is None:
            of.add("mujoco")
        yield Hit("material-without-name", material, "a material has no name", of)
    yield from _bare_colour(material, {"mujoco", "drake", "ros", "gazebo"})
    file = texture.get("filename") if texture else None
    if texture and file and not _is_there(material, description):
        yield Hit("missing-texture", texture, f"there is no texture {shown(file)}")
    if colour is not None or file:
        if _is_out_of_range(material):
            yield Hit("colour-out-of-range", colour or material, f"rgba is {shown(_rgba(material))}")
        if name and _colour(material) != _colour(defined.setdefault(name, material)):
            message = f"material {shown(name)} is defined a second time, with another colour"
            yield Hit("duplicate-material", material, message, {"drake"})
    elif name and name not in defined:
        near = did_you_mean(name, defined)
        message = f"material {shown(name)} is defined nowhere above"
        yield Hit("undefined-material", material, f"{message}: {near}" if near else message)
    elif name and _is_out_of_range(defined[name]):
        yield Hit("colour-out-of-range", material, f"rgba of material {shown(name)} is {shown(_rgba(defined[name]))}")


def _is_there(material: Element, description: Description) -> bool:
    texture = material.first("texture")
    found = resolved((texture.get("filename") if texture else None) or "", description)
    return found is not None and is_file(found)


def _rgba(material: Element) -> str:
    colour = material.first("color")
    return (colour.get("rgba") if colour else None) or ""


def _is_out_of_range(material: Element) -> bool:
    return any(not 0.0 <= number <= 1.0 for number in drake_numbers(_rgba(material)))


def _colour(material: Element) -> str:
    texture = material.first("texture")
    return f"{drake_numbers(_rgba(material))} {texture.get('filename') if texture else None}"
