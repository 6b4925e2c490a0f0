"""Rules about shapes and mesh files."""

from __future__ import annotations

import os
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.documents import is_file, is_folder
from dh2urdf.meshes import FILE, PACKAGE, path_of_address
from dh2urdf.source import did_you_mean, shown
from dh2urdf_check.document.description import ALL, SHAPES, Hit
from dh2urdf_check.document.tree import numbers_of
from dh2urdf_check.meshes import read_meshes
from dh2urdf_check.numbers import drake_numbers, drake_scale, mujoco_numbers
from dh2urdf_check.rules import rules

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.description import Description
    from dh2urdf_check.document.tree import Element
    from dh2urdf_check.meshes import MeshFile

SMALLEST = 1e-3
"""The size that CoppeliaSim makes of a smaller one [m]."""
SMALLEST_SCALE = 1e-8
"""The factor of a mesh that Drake takes for 0."""
_COUNT = {"size": 3}
_TAKES = {
    "pybullet": {".stl", ".obj", ".dae", ".vtk", ".cdf"},
    "mujoco": {".stl", ".obj"},
    "drake": {".obj", ".vtk", ".gltf"},
}
"""The formats of meshes that a reader takes: Drake, of collisions; it draws what it can of the others."""
MOST_BYTES = 2**27
"""Size of all mesh files of a description that are read [B]."""
MOST_TRIANGLES = 200_000
"""The largest number of triangles in an STL that MuJoCo takes."""
_OF_VISUALS: dict[bool, set[str]] = {False: {"drake"}, True: set()}
"""The readers that do not mind a mesh, by whether it is one of a collision shape."""
_MODEL = "model://"
_OF_DRAKE = {"drake:capsule", "drake:ellipsoid"}


class Use(NamedTuple):
    """A mesh where it is used."""

    element: Element
    is_collision: bool
    address: str


def hits(description: Description) -> Iterator[Hit]:
    """Findings about every shape."""
    meshes: list[Use] = []
    compiler = description.root.first("mujoco", "compiler")
    draws = compiler is not None and compiler.get("discardvisual") == "false"
    capsules: list[Element] = []
    touches = False
    for link in description.links:
        for shape in link.shapes:
            hidden: frozenset[str] = frozenset() if draws or shape.tag == "collision" else frozenset({"mujoco"})
            for hit in _of_shape(shape, f"a {shape.tag} of link {shown(link.name)}"):
                of = rules()[hit.rule].outcomes.keys() if hit.of is None else frozenset(hit.of)
                if of - hidden:
                    yield hit._replace(of=of - hidden)
            for body in [body for geometry in shape.all("geometry")[:1] for body in geometry.children[:1]]:
                if body.tag == "capsule":
                    capsules.append(body)
                    touches = touches or shape.tag == "collision"
                if body.tag == "capsule" and shape.tag == "visual":
                    message = f"a visual of link {shown(link.name)} is a capsule"
                    yield Hit("unknown-geometry", body, message, {"coppeliasim"})
                if body.tag == "mesh" and (address := body.get("filename")):
                    meshes.append(Use(body, shape.tag == "collision", address))
    if capsules:
        message = f"{len(capsules)} capsules" if len(capsules) > 1 else "a capsule"
        yield Hit("capsule", capsules[0], message, None if touches else ALL - {"coppeliasim"})
    yield from _tiny(description)
    yield from _meshes(description, meshes, draws=draws)


def _of_shape(shape: Element, about: str) -> Iterator[Hit]:
    if (shape.get("name") or "x").isspace() or shape.get("name") == "":
        yield Hit("missing-name", shape, f"{about} has a blank name", {"drake"})
    geometries = shape.all("geometry")
    if len(geometries) > 1:
        yield Hit("repeated-element", geometries[1], f"{about} has a second geometry", {"mujoco"})
    if not geometries or not geometries[0].children:
        yield Hit("missing-geometry", shape, f"{about} has no shape")
        return
    bodies = geometries[0].children
    tags = [body.tag for body in bodies]
    if again := next((body for i, body in enumerate(bodies) if body.tag in SHAPES and body.tag in tags[:i]), None):
        yield Hit("repeated-element", again, f"{about} has a second {again.tag}", {"mujoco"})
    first = bodies[0]
    if first.tag not in SHAPES:
        near = did_you_mean(first.tag, SHAPES)
        message = f"{about} is {shown(first.tag)}"
        knows = {"mujoco", "drake"} if any(tag in SHAPES for tag in tags) else set()  # They look for what they know.
        knows |= {"drake"} if any(tag in _OF_DRAKE for tag in tags) else set()
        of = ALL - knows - ({"pybullet"} if first.tag == "plane" and first.get("normal") else set())
        yield Hit("unknown-geometry", first, f"{message}: {near}" if near else message, of)
    for index, body in enumerate(bodies):
        for hit in _sizes(body, about):
            said_of = frozenset(hit.of or rules()[hit.rule].outcomes)
            if left := said_of & {"mujoco", "drake"} if index else said_of:
                yield hit._replace(of=left)


def _sizes(body: Element, about: str) -> Iterator[Hit]:
    names = SHAPES.get(body.tag, ())
    if missing := [name for name in names if body.get(name) is None]:
        of = {"pybullet", "mujoco", "drake"} if body.tag == "capsule" else None
        yield Hit("missing-size", body, f"the {body.tag} of {about} has no {', no '.join(missing)}", of)
    elif body.tag == "mesh" and not body.get("filename"):
        of = {"pybullet", "mujoco", "gazebo", "coppeliasim"} | ({"drake"} if "collision" in about else set())
        yield Hit("empty-mesh-name", body, f"the mesh of {about} has an empty filename", of)
    if body.tag == "mesh":
        yield from _scale(body, about)
        return
    for name in names:
        text = body.get(name)
        if text is None:
            continue
        count, about_it = _COUNT.get(name, 1), f"{name} of {about} is {shown(text)}"
        of = {
            reader
            for reader, values in _read_as(text, count).items()
            if values and not all(value > 0.0 for value in values)
        }
        if body.tag == "sphere" and "drake" in of and min(drake_numbers(text)) == 0.0:
            of -= {"drake"}  # To Drake, a point.
        if of:
            yield Hit("size-not-positive", body, about_it, of)


def _scale(body: Element, about: str) -> Iterator[Hit]:
    text = body.get("scale") or ""
    of = {reader for reader, numbers in _read_as(text, 3).items() if reader != "drake" and 0.0 in numbers}
    of |= {"drake"} if any(abs(factor) < SMALLEST_SCALE for factor in drake_scale(text)) else set()
    if of:
        yield Hit("scale-zero", body, f"the scale of {about} is {shown(text)}", of)


def _read_as(text: str, count: int) -> dict[str, tuple[float, ...]]:
    """The numbers that each reader reads which minds them; none where it refuses the text."""
    plain, drake = numbers_of(text, count) or (), drake_numbers(text)
    return {
        "mujoco": mujoco_numbers(text, count) or (),
        "drake": drake if len(drake) == count else (),
        "coppeliasim": plain,
    }


def _tiny(description: Description) -> Iterator[Hit]:
    tiny = [
        body
        for link in description.links
        for shape in link.shapes
        for geometry in shape.all("geometry")[:1]
        for body in geometry.children[:1]
        for name in SHAPES.get(body.tag, ())
        if (numbers := body.numbers(name, _COUNT.get(name, 1))) and 0.0 < min(numbers) < SMALLEST
    ]
    if tiny:
        count = "a shape is" if len(tiny) == 1 else f"{len(tiny)} shapes are"
        yield Hit("tiny-size", tiny[0], f"{count} smaller than 1 mm")


# Meshes.


def _meshes(description: Description, uses: list[Use], *, draws: bool) -> Iterator[Hit]:
    """A fault of a file is reported for every mesh; a fact about a format or a form of address, once."""
    files = description.once(mesh_files)
    formats: dict[tuple[str, tuple[str, ...]], list[Use]] = {}
    forms: dict[str, list[Use]] = {}
    for use in uses:
        read_by_mujoco = use.is_collision or draws
        rest = {"pybullet", "pinocchio", "drake", "ros", "gazebo", "coppeliasim"}
        rest |= {"mujoco"} if read_by_mujoco else set()
        path = resolved(use.address, description)
        in_pybullet = is_found_by_pybullet(use.address, description.path)
        if path is None or not is_file(path):
            rule, what = "missing-mesh", f"there is no mesh file {shown(use.address)}"
            if path is None:
                rule, what = "unresolved-package", f"the package of {shown(use.address)} is not found"
            else:
                forms.setdefault(_form(use.address), []).append(use)
            yield Hit(rule, use.element, what, rest - {"pybullet"} if in_pybullet else rest)
            if in_pybullet and "pybullet" in _strangers(Path(use.address), use, read_by_mujoco=False):
                formats.setdefault((Path(use.address).suffix.lower(), ("pybullet",)), []).append(use)
            continue
        forms.setdefault(_form(use.address), []).append(use)
        if use.address.startswith(FILE) and not use.address.startswith(f"{FILE}/"):
            message = f"there is no absolute path behind {FILE} in {shown(use.address)}"
            yield Hit("missing-mesh", use.element, message, {"drake"})
        if not in_pybullet and not use.address.startswith(PACKAGE):
            message = f"there is no mesh file {shown(use.address)} in the folders above the description"
            yield Hit("missing-mesh", use.element, message, {"pybullet"})
            continue
        if file := files.get(path):
            yield from _faults(file, use, rest & _readers_of(use.address))
        if of := _strangers(path, use, read_by_mujoco=read_by_mujoco):
            formats.setdefault((path.suffix.lower(), tuple(sorted(of))), []).append(use)
    for (name, of_names), found in formats.items():
        yield Hit("mesh-format", found[0].element, f"{_count_of(found, 'is', 'are')} {shown(name)}", of_names)
    yield from _addresses(forms, description, draws=draws)


def mesh_files(description: Description) -> dict[Path, MeshFile]:
    """What is in the mesh files of a description that are there, up to a size of them all."""
    paths: dict[Path, None] = {}
    left = MOST_BYTES
    for mesh in description.root.walk():
        path = resolved(mesh.get("filename") or "", description) if mesh.tag == "mesh" else None
        if path and path not in paths and is_file(path) and (left := left - path.stat().st_size) >= 0:
            paths[path] = None
    return read_meshes(paths)


def _faults(file: MeshFile, use: Use, of: set[str]) -> Iterator[Hit]:
    """What is wrong in a mesh file; `of` are the readers that read the shape, and take its format."""
    about = f"the mesh {shown(use.address)}"
    if file.header:
        yield Hit("hollow-mesh", use.element, f"{about}: {file.header}")
    if file.unit != 1.0:
        yield Hit("collada-unit", use.element, f"{about} has the unit {file.unit:g} m")
    if file.problem:
        yield Hit("unreadable-mesh", use.element, f"{about}: {file.problem}", of - _OF_VISUALS[use.is_collision])
    elif file.is_text:
        yield Hit("text-stl", use.element, f"{about} is an STL of text", of)
    elif file.is_planar:
        yield Hit("mesh-without-volume", use.element, f"{about} is flat", of & {"mujoco"})
    if file.triangles > MOST_TRIANGLES:
        yield Hit("many-triangles", use.element, f"{about} has {file.triangles:,} triangles", of & {"mujoco"})


def _addresses(forms: dict[str, list[Use]], description: Description, *, draws: bool) -> Iterator[Hit]:
    for form, found in forms.items():
        of = set() if form in {"", "file-address"} else {"drake", "pinocchio", "coppeliasim"}
        if form and (draws or any(use.is_collision for use in found)):
            of.add("mujoco")
        if form == "package-address" and any(_is_lost_in_pybullet_alone(use.address, description) for use in found):
            of.add("pybullet")
        if of:
            yield Hit(form, found[0].element, f"{_count_of(found, 'has', 'have')} such an address", of)


def _count_of(uses: list[Use], one: str, many: str) -> str:
    first = shown(uses[0].address)
    return f"the mesh {first} {one}" if len(uses) == 1 else f"{len(uses)} meshes, {first} the first, {many}"


def _form(address: str) -> str:
    """The rule about addresses of a form; empty for absolute paths, of which there is none."""
    if address.startswith(PACKAGE):
        return "package-address"
    if address.startswith(FILE):
        return "file-address"
    return "" if os.path.isabs(address) else "relative-mesh"  # noqa: PTH117 - a text that may be no path


def resolved(address: str, description: Description) -> Path | None:
    """The file that an address means, whether there is one or not; None where its package is not found."""
    folder = Path(os.path.abspath(description.path)).parent  # noqa: PTH100 - links in the path stay
    if not address.startswith(PACKAGE):
        return folder / path_of_address(address)
    package, _, rest = address.removeprefix(PACKAGE).partition("/")
    if not package:
        return None
    searched = [
        *(place for inner in (folder, *folder.parents) for place in (inner, inner.parent / package)),
        *(Path(entry) / package for entry in _entries("ROS_PACKAGE_PATH")),
        *(Path(entry) / "share" / package for entry in _entries("AMENT_PREFIX_PATH")),
    ]
    found = [place / rest for place in searched if place.name == package and is_folder(place)]
    if package in description.packages:
        found.append(description.packages[package] / rest)
    return next((file for file in found if is_file(file)), found[0] if found else None)


def is_found_by_pybullet(address: str, description: Path) -> bool:
    """PyBullet knows no packages: it looks for the path behind `package://` in the folder and in all above it."""
    if address.startswith(FILE):
        address = path_of_address(address)
    rest = address.removeprefix(PACKAGE).removeprefix(_MODEL).lstrip("/")
    folder = Path(os.path.abspath(description)).parent  # noqa: PTH100 - links in the path stay
    places = [above / rest for above in (folder, *folder.parents)]
    return is_file(Path(address)) or any(is_file(place) for place in places)


def _is_lost_in_pybullet_alone(address: str, description: Description) -> bool:
    file = resolved(address, description)
    return file is not None and is_file(file) and not is_found_by_pybullet(address, description.path)


def _entries(variable: str) -> list[str]:
    return [entry for entry in os.environ.get(variable, "").split(os.pathsep) if entry]


def _readers_of(address: str) -> set[str]:
    """The readers that take the format of an address."""
    suffix = Path(address).suffix.lower()
    return set(ALL) - {reader for reader, formats in _TAKES.items() if suffix not in formats}


def _strangers(path: Path, use: Use, *, read_by_mujoco: bool) -> set[str]:
    """The readers that do not take a format."""
    readers = {"pybullet", *(["mujoco"] if read_by_mujoco else []), *(["drake"] if use.is_collision else [])}
    return {reader for reader in readers if path.suffix.lower() not in _TAKES[reader]}
