"""Rules about what is in a mesh file."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.source import shown
from dh2urdf_check.document.description import Hit
from dh2urdf_check.document.mesh_sizes import SOLID

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_check.document.mesh_sizes import MeshFile
    from dh2urdf_check.document.tree import Element

SMALLEST_VOLUME = 1e-15
"""What MuJoCo takes for no volume of a mesh [m³]."""
FARTHEST = 2.0**30
"""The largest coordinate in an STL that MuJoCo takes."""
MOST_TRIANGLES = 200_000
"""The largest number of triangles in an STL that MuJoCo takes."""


class Use(NamedTuple):
    """A mesh where it is used."""

    element: Element
    is_collision: bool
    address: str


def faults_of(file: MeshFile, use: Use, readers: set[str], of_format: set[str]) -> Iterator[Hit]:
    """What is wrong in a mesh file; `readers` are those that read the shape, `of_format` those that take the format."""
    about, of = f"the mesh {shown(use.address)}", readers & of_format
    if file.is_hollow:
        yield Hit("hollow-mesh", use.element, f"{about} lacks its geometries, or numbers in one of them")
    if file.problem:
        needs = {"pybullet": not file.is_hollow, "mujoco": file.vertices != SOLID, "drake": use.is_collision}
        hit = {reader for reader in of if needs.get(reader, True)}
        yield Hit("unreadable-mesh", use.element, f"{about}: {file.problem}", hit)
    elif file.stray is not None or file.stray_in_line is not None:
        yield from _of_stray(file, use, of)
    elif not file.has_area:
        hit = of - {"pybullet", "drake", "coppeliasim"}
        yield Hit("unreadable-mesh", use.element, f"{about}: no triangle of it has three different corners", hit)
    elif file.of_pybullet:
        yield Hit("unreadable-mesh", use.element, f"{about}: {file.of_pybullet}", {"pybullet"})
    elif file.lacks_normals:
        message = f"{about}: it has normals, and a face with a corner that has none of them"
        yield Hit("unreadable-mesh", use.element, message, of & {"mujoco"})
    if file.of_assimp:
        yield Hit("unreadable-mesh", use.element, f"{about}: {file.of_assimp}", {"pinocchio"})
    if file.is_text:
        yield Hit("text-stl", use.element, f"{about} is an STL of text", readers)
        of.discard("mujoco")  # It does not come so far.
    yield from _of_extent(file, use, about, of)
    if "mujoco" in of and file.triangles > MOST_TRIANGLES:
        yield Hit("many-triangles", use.element, f"{about} has {file.triangles:,} triangles")


def _of_extent(file: MeshFile, use: Use, about: str, of: set[str]) -> Iterator[Hit]:
    """Vertices that are no corners of a body."""
    is_stl = use.address.lower().endswith(".stl")
    refused = set[str]()
    message = f"{about} is flat, or has less than {SOLID} different vertices"
    if not file.is_finite:
        message = f"{about} has a vertex that is not finite"
        refused |= {"mujoco"} if file.has_nan or use.is_collision or is_stl else set()
        refused |= set() if file.sides else {"coppeliasim"}
    elif is_stl and file.farthest > FARTHEST:
        message = f"{about} has a coordinate of {file.farthest:g}, and MuJoCo takes up to 2^30"
        refused = {"mujoco"}
    elif _is_flat(file, use):
        refused = {"mujoco"}
    if use.is_collision and not file.has_hull:
        refused |= {"drake"}
    if refused & of:
        yield Hit("mesh-without-volume", use.element, message, of & refused)


def _of_stray(file: MeshFile, use: Use, of: set[str]) -> Iterator[Hit]:
    """Of a face or line with a vertex that is not there: PyBullet leaves a mesh with a face of vertex 0 out."""
    vertex, what, minding = file.stray, "face", of
    if vertex is None:
        vertex, what, minding = file.stray_in_line or 0, "line or point", of & {"mujoco", "drake", "pinocchio"}
    has = "vertices are counted from 1" if vertex == 0 else "has fewer" if vertex > 0 else "has fewer before it"
    message = f"the mesh {shown(use.address)} has a {what} with the vertex {vertex:,}, and {has}"
    loses = minding & {"pybullet"} if vertex == 0 else set()
    minding = minding - loses - (set() if use.is_collision else {"drake"}) - file.stray_to_none_of
    yield Hit("missing-vertex", use.element, message, minding)
    if loses:
        yield Hit("unreadable-mesh", use.element, message, loses)


def _is_flat(file: MeshFile, use: Use) -> bool:
    """Whether MuJoCo finds no volume in it; of a scale of 0 another rule speaks.

    The volume is that of the faces. The hull of a collision shape, and of a file without faces, is one of all vertices.
    """
    if (file.vertices or SOLID) < SOLID:
        return True
    scale = math.prod(use.element.numbers("scale", 3) or (1.0,))
    volume = math.prod(file.sides) if file.volume is None and file.sides else file.volume
    if scale == 0.0 or volume is None:
        return False
    needs_hull = use.is_collision or file.volume is None
    return abs(volume * scale) < SMALLEST_VOLUME or (file.is_planar and needs_hull)
