"""Rules about the mesh files of an MJCF: their formats, and what MuJoCo and Drake cannot read in them."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.source import shown
from dh2urdf_check.document.mesh_faults import MOST_TRIANGLES, SMALLEST_VOLUME
from dh2urdf_check.document.mesh_sizes import SOLID, read_mesh
from dh2urdf_check.models.models import Hit, elements_of, numbers
from dh2urdf_check.shapes import SMALLEST_SCALE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from lxml import etree

    from dh2urdf_check.document.mesh_sizes import MeshFile
    from dh2urdf_plugins.formats.mjcf.elements import Elements

_TAKES = {"mujoco": {".stl", ".obj", ".msh", ".ply"}, "drake": {".obj"}, "pybullet": {".stl", ".obj", ".dae"}}
"""The formats that a reader takes."""


def format_hits(mesh: etree._Element, file: str) -> Iterator[Hit]:
    """Whether readers take the format of a file, by its suffix; MuJoCo goes by the type where one is written."""
    of = {reader for reader, formats in _TAKES.items() if Path(file).suffix.lower() not in formats}
    if of := of - ({"mujoco"} if mesh.get("content_type") else set()):
        yield Hit("mesh-format", mesh, f"the mesh file {shown(file)} is of a format that is not read", of)


class _Use(NamedTuple):
    """How geoms use a mesh.

    Attributes:
        collides: whether one of them touches other geoms.
        is_weighed: whether one is in a body without mass properties, so that Drake computes those of the mesh.
    """

    collides: bool = False
    is_weighed: bool = False


def _uses(elements: Elements) -> dict[str, _Use]:
    uses: dict[str, _Use] = {}
    for geom in elements_of(elements.root, "geom"):
        above = geom.getparent()
        if above is None or above.tag in {"default", "spatial"}:
            continue
        given = elements.attributes(geom)
        if name := given.get("mesh"):
            before = uses.get(name, _Use())
            collides = not given.get("contype") == given.get("conaffinity") == "0"
            uses[name] = _Use(before.collides or collides, before.is_weighed or above.find("inertial") is None)
    return uses


def hits(elements: Elements, files: dict[etree._Element, Path]) -> Iterator[Hit]:
    """Findings about what is in the files; `files` are those of the meshes that are there."""
    uses = _uses(elements)
    for mesh, path in files.items():
        file, given = read_mesh(path), elements.attributes(mesh)
        use = uses.get(mesh.get("name") or path.stem, _Use())
        scale = numbers(given.get("scale"), 3) or (1.0, 1.0, 1.0)
        about = f"the mesh {shown(path.name)}"
        is_shrunk = any(abs(factor) < SMALLEST_SCALE for factor in scale)
        flat = {"drake"} if is_shrunk and path.suffix.lower() in _TAKES["drake"] else set[str]()
        if file is not None:
            fault, minding = _unreadable(file, path)
            minding &= {"mujoco", "drake", "pybullet"} if any(use) else {"mujoco"}
            if minding:
                yield Hit("unreadable-mesh", mesh, f"{about} {fault}", minding)
            is_thin = (file.vertices or SOLID) < SOLID or file.is_planar
            if _is_flat(file, scale, use, is_shell=given.get("inertia") == "shell"):
                flat.add("mujoco")
            if (is_thin and use.is_weighed) or (use.collides and not file.has_hull):
                flat.add("drake")
            flat -= minding
        if flat:
            yield Hit("flat-mesh", mesh, f"{about} is flat, with the scale {shown(given.get('scale', '1 1 1'))}", flat)


def _unreadable(file: MeshFile, path: Path) -> tuple[str, set[str]]:
    """What is wrong in a file, and for which readers; Drake reads OBJ alone."""
    of = {"mujoco", "drake"} if path.suffix.lower() == ".obj" else {"mujoco"}
    if file.problem:  # MuJoCo takes vertices without faces.
        of.add("pybullet")
        return f"cannot be read: {file.problem}", of - ({"mujoco"} if file.vertices == SOLID else set())
    if file.stray is not None or file.lacks_normals:
        what = "with a vertex that is not there" if file.stray is not None else "without normals, which others have"
        return f"has a face {what}", of if file.stray is not None else {"mujoco"}
    if file.is_text:
        return "is an STL of text", of
    return f"has more than {MOST_TRIANGLES} triangles", of if file.triangles > MOST_TRIANGLES else set()


def _is_flat(file: MeshFile, scale: tuple[float, ...], use: _Use, *, is_shell: bool) -> bool:
    """Whether MuJoCo finds no volume in a mesh, or no hull for a geom that collides."""
    if (file.vertices or SOLID) < SOLID or (file.is_planar and use.collides):
        return True
    volume = math.prod(file.sides) if file.volume is None and file.sides else file.volume
    return volume is not None and abs(volume * math.prod(scale)) < SMALLEST_VOLUME and not is_shell
