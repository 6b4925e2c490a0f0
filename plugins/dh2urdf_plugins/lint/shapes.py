"""Rules about shapes, materials and mesh files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple
from urllib.parse import unquote

from dh2urdf.source import did_you_mean, shown
from dh2urdf_plugins.lint.description import Hit

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_plugins.lint.description import Description
    from dh2urdf_plugins.lint.tree import Element

SIZES = {"box": ("size",), "cylinder": ("radius", "length"), "sphere": ("radius",), "mesh": ("filename",)}
SMALLEST = 1e-3
"""The size that CoppeliaSim makes of a smaller one [m]."""
_COUNT = {"size": 3}
_EXTENSIONS = ("capsule", "plane", "cdf")
"""Shapes that PyBullet or Drake has besides those of URDF."""

_TAKES = {
    "pybullet": {".stl", ".obj", ".dae"},
    "mujoco": {".stl", ".obj"},
    "drake": {".obj", ".vtk", ".gltf"},
}
"""The formats of meshes that a reader takes: Drake, of collisions; it draws what it can of the others."""
_PACKAGE, _FILE = "package://", "file://"
_STL_HEADER = 84  # bytes: 80 of any text, then the number of triangles in 4
_STL_TRIANGLE = 50


class _Use(NamedTuple):
    """A mesh where it is used."""

    element: Element
    is_collision: bool
    address: str


def hits(description: Description) -> Iterator[Hit]:
    """What there is to say of every shape."""
    meshes: list[_Use] = []
    for link in description.links:
        for shape in link.shapes:
            geometry = shape.first("geometry")
            about = f"a {shape.tag} of link {shown(link.name)}"
            if geometry is None or not geometry.children:
                yield Hit("missing-geometry", shape, f"{about} has no shape")
                continue
            body = geometry.children[0]
            yield from _sizes(body, about)
            if body.tag == "mesh" and (address := body.get("filename")):
                meshes.append(_Use(body, shape.tag == "collision", address))
    yield from _tiny(description)
    yield from _materials(description)
    yield from _meshes(description, meshes)


def _sizes(body: Element, about: str) -> Iterator[Hit]:
    names = SIZES.get(body.tag)
    if names is None:
        if body.tag not in _EXTENSIONS:
            near = did_you_mean(body.tag, SIZES)
            message = f"{about} is {shown(body.tag)}"
            yield Hit("unknown-geometry", body, f"{message}: {near}" if near else message)
        return
    if missing := [name for name in names if not body.get(name)]:
        yield Hit("missing-size", body, f"the {body.tag} of {about} has no {', no '.join(missing)}")
    if body.tag == "mesh":
        scale = body.numbers("scale", 3)
        if scale and 0.0 in scale:
            yield Hit(
                "size-not-positive",
                body,
                f"the scale of {about} is {shown(body.get('scale') or '')}",
                {"mujoco", "drake"},
            )
        return
    for name in names:
        numbers = body.numbers(name, _COUNT.get(name, 1))
        if numbers and min(numbers) <= 0.0:
            of = (
                {"mujoco", "coppeliasim"} if body.tag == "sphere" and min(numbers) == 0.0 else None
            )  # to Drake, a point
            yield Hit("size-not-positive", body, f"{name} of {about} is {shown(body.get(name) or '')}", of)


def _tiny(description: Description) -> Iterator[Hit]:
    tiny = [
        body
        for link in description.links
        for shape in link.shapes
        for geometry in shape.all("geometry")[:1]
        for body in geometry.children[:1]
        for name in SIZES.get(body.tag, ())
        if (numbers := body.numbers(name, _COUNT.get(name, 1))) and 0.0 < min(numbers) < SMALLEST
    ]
    if tiny:
        count = "a shape is" if len(tiny) == 1 else f"{len(tiny)} shapes are"
        yield Hit("tiny-size", tiny[0], f"{count} smaller than 1 mm")


# Materials.


def _materials(description: Description) -> Iterator[Hit]:
    defined: dict[str, str] = {}
    for material in description.root.all("material"):
        name = material.get("name") or ""
        if name and name in defined:
            yield Hit("duplicate-material", material, f"material {shown(name)} is defined a second time")
        defined[name] = _colour(material)
    for link in description.links:
        for shape in link.shapes:
            if shape.tag == "visual" and (used := shape.first("material")):
                yield from _use_of_material(used, defined)


def _use_of_material(material: Element, defined: dict[str, str]) -> Iterator[Hit]:
    """A visual's material, which may define what later ones name; an empty name is none, and all take it so."""
    name = material.get("name")
    if name is None:
        yield Hit("material-without-name", material, "a material has no name")
    elif name and material.first("color") is None and material.first("texture") is None:
        if name not in defined:
            near = did_you_mean(name, defined)
            message = f"material {shown(name)} is defined nowhere above"
            yield Hit("undefined-material", material, f"{message}: {near}" if near else message)
    elif name and (colour := _colour(material)) != defined.setdefault(name, colour):
        message = f"material {shown(name)} is defined a second time, with another colour"
        yield Hit("duplicate-material", material, message, {"drake"})


def _colour(material: Element) -> str:
    colour, texture = material.first("color"), material.first("texture")
    numbers = colour.numbers("rgba", 4) if colour else None
    return f"{numbers} {texture.get('filename') if texture else None}"


# Meshes.


def _meshes(description: Description, uses: list[_Use]) -> Iterator[Hit]:
    """What is wrong with a file is said of every mesh; what is so with a format or a form of address, once."""
    compiler = description.root.first("mujoco", "compiler")
    draws = compiler is not None and compiler.get("discardvisual") == "false"
    formats: dict[tuple[str, tuple[str, ...]], list[_Use]] = {}
    forms: dict[str, list[_Use]] = {}
    for use in uses:
        read_by_mujoco = use.is_collision or draws
        rest = {"pybullet", "pinocchio", "drake", "ros", "gazebo", "coppeliasim"}
        rest |= {"mujoco"} if read_by_mujoco else set()
        path = _resolved(use.address, description.path)
        if path is None:
            # Of an address without a package, PyBullet looks for the path alone, in the folders above.
            of = rest if not use.address.startswith(f"{_PACKAGE}/") else rest - {"pybullet"}
            yield Hit("unresolved-package", use.element, f"the package of {shown(use.address)} is not found", of)
            continue
        forms.setdefault(_form(use.address), []).append(use)
        if not _is_there(path, is_file=True):
            yield Hit("missing-mesh", use.element, f"there is no mesh file {shown(use.address)}", rest)
            continue
        if path.suffix.lower() == ".stl" and not _is_binary_stl(path):
            yield Hit("text-stl", use.element, f"the mesh {shown(use.address)} is an STL of text", rest)
        if of := _strangers(path, use, read_by_mujoco=read_by_mujoco):
            formats.setdefault((path.suffix.lower(), tuple(sorted(of))), []).append(use)
    for (name, of_names), found in formats.items():
        yield Hit("mesh-format", found[0].element, f"{_count_of(found, 'is', 'are')} {shown(name)}", of_names)
    for form, found in forms.items():
        of = set() if form in {"", "file-address"} else {"drake", "pinocchio", "coppeliasim"}
        if form and (draws or any(use.is_collision for use in found)):
            of.add("mujoco")
        if of:
            yield Hit(form, found[0].element, f"{_count_of(found, 'has', 'have')} such an address", of)


def _count_of(uses: list[_Use], one: str, many: str) -> str:
    first = shown(uses[0].address)
    return f"the mesh {first} {one}" if len(uses) == 1 else f"{len(uses)} meshes, {first} the first, {many}"


def _form(address: str) -> str:
    """The rule about addresses of a form; empty for absolute paths, of which there is none."""
    if address.startswith(_PACKAGE):
        return "package-address"
    if address.startswith(_FILE):
        return "file-address"
    return "" if os.path.isabs(address) else "relative-mesh"  # noqa: PTH117 - a text that may be no path


def _resolved(address: str, description: Path) -> Path | None:
    """The file that an address means, whether there is one or not; None where its package is not found."""
    folder = Path(os.path.abspath(description)).parent  # noqa: PTH100 - links in the path stay
    if not address.startswith(_PACKAGE):
        return folder / Path(unquote(address.removeprefix(_FILE)) if address.startswith(_FILE) else address)
    package, _, rest = address.removeprefix(_PACKAGE).partition("/")
    if not package:
        return None
    searched = [
        *(place for above in (folder, *folder.parents) for place in (above, above.parent / package)),
        *(Path(entry) / package for entry in _entries("ROS_PACKAGE_PATH")),
        *(Path(entry) / "share" / package for entry in _entries("AMENT_PREFIX_PATH")),
    ]
    found = [place for place in searched if place.name == package and _is_there(place, is_file=False)]
    return next(
        (place / rest for place in found if _is_there(place / rest, is_file=True)), found[0] / rest if found else None
    )


def _is_there(path: Path, *, is_file: bool) -> bool:
    """Whether there is such a file or folder; a text that can be no path leads to nothing."""
    try:
        return path.is_file() if is_file else path.is_dir()
    except (OSError, ValueError):
        return False


def _entries(variable: str) -> list[str]:
    return [entry for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _strangers(path: Path, use: _Use, *, read_by_mujoco: bool) -> set[str]:
    """The readers that do not take a format."""
    readers = {"pybullet", *(["mujoco"] if read_by_mujoco else []), *(["drake"] if use.is_collision else [])}
    return {reader for reader in readers if path.suffix.lower() not in _TAKES[reader]}


def _is_binary_stl(path: Path) -> bool:
    """Whether a file has the size that its number of triangles asks for."""
    with path.open("rb") as file:
        header = file.read(_STL_HEADER)
    triangles = int.from_bytes(header[80:], "little")
    return len(header) == _STL_HEADER and path.stat().st_size >= _STL_HEADER + _STL_TRIANGLE * triangles
