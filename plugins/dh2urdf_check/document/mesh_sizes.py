"""What a mesh file holds, read without a package for meshes: whether there is a mesh in it, and how large it is.

Any file may be at the address of a mesh, so its size is bounded.
"""

from __future__ import annotations

import math
import re
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

from lxml import etree

from dh2urdf.documents import ForbiddenXmlError, xml_root
from dh2urdf_check.document.corners import has_hull, is_planar, summed_volume
from dh2urdf_check.document.obj import (
    KNOW_COMMENTS,
    has_area,
    problem_of_assimp,
    read_obj,
    read_obj_as,
    triangles_of,
)

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from numpy.typing import NDArray

    from dh2urdf.rotations import Vec3

LARGEST = 2**25
"""Size of a mesh file that is read [B]."""
STL_HEADER, STL_TRIANGLE = 84, 50  # bytes: 80 of any text, then the number of triangles in 4
_INSTANCES = ("instance_geometry", "instance_controller")
_PRIMITIVES = ("triangles", "polylist", "polygons", "trifans", "tristrips")
_NO_ELEMENT = re.compile(
    rb"(?:\xef\xbb\xbf)?\s*(?:<(?:\?.*?\?>|!--.*?-->|!\[CDATA\[.*?\]\]>|![^>]*>)\s*)+\0*", re.DOTALL
)
"""Declarations, comments and the like, and nothing else."""
_MOST_NODES = 10_000
_VERTEX = re.compile(rb"^[ \t]*vertex[ \t]+([^\r\n]+)", re.MULTILINE)
SOLID = 4
"""The least number of vertices that enclose anything."""


class MeshFile(NamedTuple):
    """What a file holds.

    Attributes:
        problem: why no mesh can be read from it; empty where one can, or may.
        of_pybullet: why PyBullet alone cannot read one.
        is_text: whether it is an STL of text.
        triangles: how many an STL of numbers has; of other files, 0.
        vertices: how many different ones there are, counted up to `SOLID`; None where they are not known.
        stray: a number in a face of an OBJ that is none of a vertex; None where there is no such one.
        stray_in_line: the same of a line or point, 0 or too far back.
        stray_to_none_of: the readers to which no such number is one of a face, line or point, but of a comment.
        has_area: whether a triangle of it has three different corners, as far as that is known.
        of_assimp: why assimp alone, with which Pinocchio reads meshes, cannot read one.
        lacks_normals: whether it is an OBJ with normals, and with a face that has none of them.
        is_finite: whether all coordinates are finite in single precision.
        has_nan: whether one of them is not a number.
        farthest: the largest coordinate, in the unit of the file.
        volume: what MuJoCo computes of the triangles, in the unit of the file; None where it is not known.
        is_planar: whether all vertices are in one plane, or in one line.
        has_hull: whether Drake makes a hull of the vertices, as far as that is known.
        sides: the sides of the box around the mesh in its own axes, in the unit of the file or, of COLLADA, in metres;
            None where they are not known.
        is_hollow: whether it is a COLLADA file without an element, without `library_geometries` or with an empty list
            of numbers in one, or an OBJ with faces and no vertices.
    """

    problem: str = ""
    of_pybullet: str = ""
    is_text: bool = False
    triangles: int = 0
    vertices: int | None = None
    stray: int | None = None
    stray_in_line: int | None = None
    stray_to_none_of: frozenset[str] = frozenset()
    has_area: bool = True
    of_assimp: str = ""
    lacks_normals: bool = False
    is_finite: bool = True
    has_nan: bool = False
    farthest: float = 0.0
    volume: float | None = None
    is_planar: bool = False
    has_hull: bool = True
    sides: Vec3 | None = None
    is_hollow: bool = False


def read_mesh(path: Path) -> MeshFile | None:
    """What there is to know of a file that is there; its suffix says which format it has.

    Returns:
        The answer; None where the file cannot be opened, or has another format than STL, OBJ and DAE. Of a file that is
        too large, no more than the header is read.
    """
    suffix = path.suffix.lower()
    if suffix not in _READ:
        return None
    try:
        size = path.stat().st_size
        with path.open("rb") as file:
            content = file.read(STL_HEADER if size > LARGEST else size)
    except OSError:
        return None
    triangles = int.from_bytes(content[80:STL_HEADER], "little") if suffix == ".stl" else 0
    is_binary = suffix == ".stl" and size == STL_HEADER + STL_TRIANGLE * triangles
    if size > LARGEST:
        return MeshFile(is_text=suffix == ".stl" and not is_binary, triangles=triangles if is_binary else 0)
    return _of_binary_stl(content, triangles) if is_binary else _of_content(content, suffix)


def _of_content(content: bytes, suffix: str) -> MeshFile:
    if not content:
        return MeshFile("it is empty")
    if content.startswith(b"version https://git-lfs"):
        return MeshFile("it is a pointer of Git LFS, which `git lfs pull` replaces")
    try:
        return _READ[suffix](content)
    except ValueError:
        return MeshFile()


def _of_binary_stl(content: bytes, count: int) -> MeshFile:
    import numpy as np

    if not count:
        return MeshFile("it has no triangles")
    triangle = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("colour", "<u2")])
    corners = np.frombuffer(content, triangle, count, STL_HEADER)["corners"].reshape(-1, 3).astype(float)
    first, second, third = corners[0::3], corners[1::3], corners[2::3]
    pairs = ((first, second), (second, third), (third, first))
    is_line = np.logical_or.reduce([(one == other).all(axis=1) for one, other in pairs])
    return MeshFile(triangles=count, has_area=not is_line.all())._replace(
        **_extent(corners, np.arange(len(corners)).reshape(-1, 3))
    )


def _extent(vertices: NDArray[Any], triangles: NDArray[Any] | None) -> dict[str, Any]:
    """What follows from the vertices, which readers keep in single precision, and from the triangles."""
    import numpy as np

    with np.errstate(over="ignore"):
        read = vertices.astype(np.float32).astype(float)
    sides = _sides(_around(vertices))
    is_finite = bool(np.isfinite(read).all())
    return {
        "vertices": _distinct(vertices),
        "sides": sides,
        "has_nan": bool(np.isnan(read).any()),
        "is_finite": is_finite,
        "farthest": float(np.abs(read).max(initial=0.0)),
        "volume": summed_volume(read, triangles) if is_finite and triangles is not None else None,
        "is_planar": is_finite and is_planar(read),
    }


def _of_text_stl(content: bytes) -> MeshFile:
    import numpy as np

    texts = [match[1].decode() for match in _VERTEX.finditer(content)]
    if not texts:
        return MeshFile("it has no triangles of text, nor the size of an STL of numbers", vertices=0)
    vertices = np.loadtxt(texts, comments=None, usecols=(0, 1, 2), ndmin=2)
    return MeshFile(is_text=True)._replace(**_extent(vertices, None))


def _of_obj(content: bytes) -> MeshFile:
    lines = content.replace(b"\r", b"\n") if b"\r" in content else content
    found = read_obj(lines)
    has_faces = len(found.counts) > 0
    if not len(found.vertices):
        return MeshFile("it has no vertices", vertices=0, is_hollow=has_faces)
    triangles = triangles_of(found) if found.stray is None else None
    seen = {reader: found if found.is_sound else read_obj_as(reader, lines) for reader in KNOW_COMMENTS}
    is_taken = not has_faces or has_area(found)
    return MeshFile(
        "" if has_faces else "it has no faces",
        "its lines end with a carriage return alone" if lines is not content and b"\n" not in content else "",
        stray=found.stray,
        stray_in_line=found.stray_in_line,
        stray_to_none_of=frozenset(reader for reader, each in seen.items() if each.is_sound),
        has_area=is_taken,
        of_assimp=problem_of_assimp(seen["pinocchio"]) if has_faces and is_taken else "",
        lacks_normals=has_faces and found.lacks_normals,
        has_hull=has_hull(found.vertices),
    )._replace(**_extent(found.vertices, triangles))


def _distinct(corners: NDArray[Any]) -> int:
    """How many different vertices there are, counted up to `SOLID`."""
    found = set()
    for corner in map(tuple, corners):
        found.add(corner)
        if len(found) == SOLID:
            break
    return len(found)


def _sides(box: NDArray[Any] | None) -> Vec3 | None:
    if box is None or not all(map(math.isfinite, box.flat)):
        return None
    x, y, z = (float(side) for side in box[1] - box[0])
    return (x, y, z) if all(map(math.isfinite, (x, y, z))) else None


def _around(corners: NDArray[Any]) -> NDArray[Any] | None:
    """The least and the greatest coordinates, of shape (2, 3)."""
    import numpy as np

    return np.stack([corners.min(axis=0), corners.max(axis=0)]) if len(corners) else None


def _around_all(boxes: Iterator[NDArray[Any] | None]) -> NDArray[Any] | None:
    import numpy as np

    found = [box for box in boxes if box is not None]
    return _around(np.concatenate(found)) if found else None


# --- COLLADA 1.4.1 ----------------------------------------------------------------------------------------------------


def _of_collada(content: bytes) -> MeshFile:
    """What is certain of it, and the box around all geometries where the scene has them.

    Raises:
        ValueError: it is XML that is not read.
    """
    try:
        root = xml_root(content)
    except ForbiddenXmlError as error:
        raise ValueError(error.msg) from error
    except etree.XMLSyntaxError:  # which readers may read all the same
        plain = content.replace(b"\0", b"")
        is_whole = b"<COLLADA" in plain and b"</COLLADA" in plain
        is_hollow = _NO_ELEMENT.fullmatch(content) is not None
        return MeshFile("" if is_whole else "it is no COLLADA, or a part of one", is_hollow=is_hollow)
    for element in root.iter():
        element.tag = str(element.tag).rpartition("}")[2]
    problem, is_hollow = _problem_of_collada(root)
    is_of_polygons = all(root.find(f".//{name}") is None for name in ("triangles", "polylist"))
    of_pybullet = "it has neither `triangles` nor a `polylist`" if is_of_polygons else ""
    try:
        return MeshFile(problem, of_pybullet, sides=_sides(_box_of_collada(root)), is_hollow=is_hollow)
    except (ValueError, LookupError):
        return MeshFile(problem, of_pybullet, is_hollow=is_hollow)


def _problem_of_collada(root: etree._Element) -> tuple[str, bool]:
    """Why no mesh can be read from it; and whether it is hollow: PyBullet looks at all geometries, shown or not."""
    library = root.find("library_geometries")
    is_broken, is_hollow, has_triangles = False, library is None, False
    for mesh in library.iterfind("geometry/mesh") if library is not None else ():
        faces = {name: [each.find("p") for each in mesh.iterfind(name)] for name in _PRIMITIVES}
        used = {given.get("source") for given in mesh.iterfind("vertices/input")}
        positions = [each.find("float_array") for each in mesh.iterfind("source") if f"#{each.get('id')}" in used]
        lacks_vertices = mesh.find("vertices") is None
        is_broken |= any(faces.values()) and (lacks_vertices or any(map(_is_blank, positions)))
        is_hollow |= is_broken or lacks_vertices or any(map(_is_blank, [*faces["triangles"], *faces["polylist"]]))
        has_triangles |= not all(_is_blank(each) for corners in faces.values() for each in corners)
    if is_broken:
        return "a geometry of it has no vertices", is_hollow
    if not has_triangles:
        return "it has no triangles", is_hollow
    has_scene = root.find("scene") is not None and any(root.find(f".//{name}") is not None for name in _INSTANCES)
    return "" if has_scene else "it has no scene with a geometry", is_hollow


def _is_blank(element: etree._Element | None) -> bool:
    return element is None or not (element.text or "").strip()


def _box_of_collada(root: etree._Element) -> NDArray[Any] | None:
    """Around the boxes of all geometries where the scene has them.

    Raises:
        ValueError: what should be a number is none.
        LookupError: something is missing.
    """
    unit = root.find("asset/unit")
    metres = float(unit.get("meter", "1")) if unit is not None else 1.0
    boxes = {f"#{geometry.get('id')}": _geometry(geometry) for geometry in root.iterfind("library_geometries/geometry")}
    box = _around_all(_placed(root, boxes))
    return None if box is None else metres * box


def _geometry(geometry: etree._Element) -> NDArray[Any] | None:
    """The box around the vertices of a geometry."""
    import numpy as np

    sources = {f"#{source.get('id')}": source for source in geometry.iterfind("mesh/source")}
    boxes = []
    for given in geometry.iterfind("mesh/vertices/input[@semantic='POSITION']"):
        source = sources[given.get("source", "")]
        accessor = source.find("technique_common/accessor")
        stride = int(accessor.get("stride", "1")) if accessor is not None else 3
        numbers = np.array((source.findtext("float_array") or "").split(), dtype=float)
        boxes.append(_around(numbers.reshape(-1, stride)[:, :3]))
    return _around_all(iter(boxes))


def _placed(root: etree._Element, boxes: dict[str, NDArray[Any] | None]) -> Iterator[NDArray[Any]]:
    """The corners of each geometry's box where a node of the scene has it."""
    import numpy as np

    waiting = [(node, np.eye(4)) for node in root.iterfind("library_visual_scenes/visual_scene/node")]
    for node, above in waiting:
        if len(waiting) > _MOST_NODES:
            raise ValueError
        place = above
        for step in node:
            place = place @ _transform(step)
        for instance in node.iterfind("instance_geometry"):
            if (box := boxes[instance.get("url", "")]) is not None:
                corners = np.array([[*corner, 1.0] for corner in product(*box.T)])
                yield corners @ place[:3].T
        waiting.extend((child, place) for child in node.iterfind("node"))


def _transform(step: etree._Element) -> NDArray[Any]:
    """The matrix of a child of a node; that of what does not move anything is the identity."""
    import numpy as np

    matrix = np.eye(4)
    if step.tag not in {"matrix", "translate", "scale", "rotate"}:
        return matrix
    numbers = np.array((step.text or "").split(), dtype=float)
    match step.tag:
        case "matrix":
            return numbers.reshape(4, 4)
        case "rotate":
            matrix[:3, :3] = _turn(*numbers.reshape(4).tolist())
        case "translate":
            matrix[:3, 3] = numbers.reshape(3)
        case _:
            matrix[:3, :3] = np.diag(numbers.reshape(3))
    return matrix


def _turn(x: float, y: float, z: float, degrees: float) -> NDArray[Any]:
    """The rotation about an axis, after Rodrigues."""
    import numpy as np

    length, angle = math.hypot(x, y, z) or 1.0, math.radians(degrees)
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) / length
    return np.eye(3) + math.sin(angle) * k + (1.0 - math.cos(angle)) * k @ k


_READ = {".stl": _of_text_stl, ".obj": _of_obj, ".dae": _of_collada}
"""What reads the text of a file, by its suffix."""
