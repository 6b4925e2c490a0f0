"""What is in a mesh file: whether there is a mesh in it, how large it is, and what the header of a COLLADA file says.

A first look finds what is plain: a binary STL is a table of numbers, an OBJ has lines of vertices and faces, and a
COLLADA file its numbers in XML. Where that look finds something odd, or a size that no link has, trimesh reads the
file, behind the fence: any file may be at the address of a mesh. Without trimesh, or without the wall of the kernel,
what is odd stays unknown.
"""

from __future__ import annotations

import math
import re
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from lxml import etree

from dh2urdf.documents import ForbiddenXmlError, xml_root
from dh2urdf.errors import CrashError
from dh2urdf.isolation import Data, enter, run_in_child
from dh2urdf.isolation.fence import refuse_without_wall

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.rotations import Vec3

LARGEST = 2**25
"""Size of a mesh file that is read [B]."""
_SECONDS = 60.0
"""How long all meshes of a description may take [s]."""
_HEADER, _TRIANGLE = 84, 50
"""Bytes of a binary STL: 80 of any text with the number of triangles in 4, and each triangle."""
_READ = (".stl", ".obj", ".dae")
_FLAT = 1e-9
"""How thin a flat mesh is, as a share of its longest side: STL has seven digits."""
_POINTER = b"version https://git-lfs"
_VERTEX = re.compile(rb"^[ \t]*v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)", re.MULTILINE)
_FACE = re.compile(rb"^[ \t]*f[ \t]+\S", re.MULTILINE)
_CORNERS = 3
_PRIMITIVES = ("triangles", "polylist", "polygons", "trifans", "tristrips")
LONGEST = 50.0
"""The size from which on lengths are taken for millimetres [m]: no arm, leg or vehicle has a link so long."""


class MeshFile(NamedTuple):
    """What a file holds.

    Attributes:
        problem: why no mesh can be read from it; empty where one can, or may.
        sides: its extents along x, y and z in its own frame, in its own unit; None where they are not known.
        is_planar: whether all its corners are in one plane.
        triangles: how many an STL has; of other files, 0.
        is_text: whether it is an STL of text.
        unit: the unit of a COLLADA file [m].
        header: what PyBullet cannot take of the header of a COLLADA file; empty where there is nothing.
        has_faces: whether a first look found faces.
        is_odd: whether a first look did not settle it.
    """

    problem: str = ""
    sides: Vec3 | None = None
    is_planar: bool = False
    triangles: int = 0
    is_text: bool = False
    unit: float = 1.0
    header: str = ""
    has_faces: bool = False
    is_odd: bool = False


class Measured(NamedTuple):
    """What trimesh reads of a file: its extents, and whether it is flat; or why it reads none."""

    problem: str
    sides: list[float]
    is_planar: bool


def read_meshes(paths: Iterable[Path]) -> dict[Path, MeshFile]:
    """What is in some mesh files, as far as it is known."""
    found: dict[Path, MeshFile] = {}
    left: dict[Path, bytes] = {}
    for path in paths:
        if path.suffix.lower() not in _READ or path.stat().st_size > LARGEST:
            continue
        content = path.read_bytes()
        file = found[path] = _at_first_sight(content, path.suffix.lower())
        if not file.problem and file.is_odd:
            left[path] = content
    for path, measured in _measured(left).items():
        sides = measured.sides
        problem = "" if found[path].has_faces else measured.problem  # trimesh knows less of COLLADA than readers do.
        known = found[path]._replace(problem=problem, is_planar=measured.is_planar)
        found[path] = known._replace(sides=(sides[0], sides[1], sides[2]) if sides else None)
    return found


def _at_first_sight(content: bytes, suffix: str) -> MeshFile:
    """What is known of a file without a package for meshes."""
    if not content.strip(b"\0 \t\r\n"):
        return MeshFile("it is empty")
    if content.startswith(_POINTER):
        return MeshFile("it is a pointer of Git LFS, and not the file")
    if suffix == ".stl":
        return _stl(content)
    return _collada(content) if suffix == ".dae" else _obj(content)


def _stl(content: bytes) -> MeshFile:
    is_text = content.lstrip().startswith(b"solid") and b"facet" in content[: 2**12]
    count = struct.unpack_from("<I", content, _HEADER - 4)[0] if len(content) >= _HEADER else 0
    if is_text and len(content) != _HEADER + count * _TRIANGLE:
        return MeshFile(is_text=True, is_odd=True)
    if len(content) < _HEADER + max(count, 1) * _TRIANGLE:
        return MeshFile(f"it has {len(content):,} bytes, too few for an STL of {count:,} triangles")
    import numpy as np

    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    corners = np.frombuffer(content, kind, count, _HEADER)["corners"].reshape(-1, 3).astype(float)
    sides, is_planar = _extents(corners)
    return MeshFile(sides=sides, is_planar=is_planar, triangles=count)


def _obj(content: bytes) -> MeshFile:
    import numpy as np

    try:
        corners = np.array(_VERTEX.findall(content), dtype=float).reshape(-1, 3)
    except ValueError:
        return MeshFile(is_odd=True)
    if len(corners) < _CORNERS or not _FACE.search(content):
        return MeshFile(is_odd=True)
    sides, is_planar = _extents(corners)
    return MeshFile(sides=sides, is_planar=is_planar, is_odd=sides is None)


def _collada(content: bytes) -> MeshFile:
    """The unit of a file, and what its header lacks: seen, PyBullet 3.2.7 ends with a signal there."""
    try:
        root = xml_root(content)
    except ForbiddenXmlError as error:
        return MeshFile(error.msg)
    except etree.XMLSyntaxError as error:
        return MeshFile(f"it is not XML: {error.msg}")
    asset = root.find("{*}asset")
    if asset is None:
        return MeshFile(header="it has no `<asset>`")
    unit, up = asset.find("{*}unit"), asset.find("{*}up_axis")
    header = "its `<unit>` has no `meter`" if unit is not None and unit.get("meter") is None else ""
    if up is not None and not (up.text or "").strip():
        header = "its `<up_axis>` is empty"
    if root.find("{*}library_geometries") is None:
        header = "it has no `<library_geometries>`"
    try:
        metres = float(unit.get("meter", "1")) if unit is not None else 1.0
    except ValueError:
        metres = 1.0
    known = MeshFile(header=header, unit=metres if 0.0 < metres < math.inf else 1.0)
    numbers = [_largest(root, "float_array"), max(_largest(root, "matrix"), _largest(root, "scale"), 1.0)]
    has_faces = any(next(root.iter(f"{{*}}{tag}"), None) is not None for tag in _PRIMITIVES)
    is_plain = has_faces and known.unit * math.prod(numbers) < LONGEST
    return known._replace(has_faces=has_faces, is_odd=not is_plain)


def _largest(root: etree._Element, tag: str) -> float:
    """The largest number in the elements of a name; infinite where a text is not of numbers."""
    import numpy as np

    largest = 0.0
    for element in root.iter(f"{{*}}{tag}"):
        try:
            numbers = np.array((element.text or "").split(), dtype=float)
        except ValueError:
            return math.inf
        largest = max(largest, float(np.abs(numbers).max(initial=0.0)))
    return largest if math.isfinite(largest) else math.inf


# --- What trimesh reads -----------------------------------------------------------------------------------------------


def _measured(files: dict[Path, bytes]) -> dict[Path, Measured]:
    """What trimesh reads of some files, in a child behind the fence; nothing where it cannot be asked."""
    if not files:
        return {}
    try:
        refuse_without_wall()
    except ValueError:
        return {}
    given = [(content, path.suffix.lower()) for path, content in files.items()]
    try:
        answer = run_in_child(
            _behind_fence, given, timeout=_SECONDS, who="trimesh", encoding=Data(list[Measured])
        ).value
    except (ImportError, MemoryError, CrashError):
        return {}
    return dict(zip(files, answer, strict=True))


def _behind_fence(files: list[tuple[bytes, str]]) -> list[Measured]:
    """Measure files in this process, which can do nothing else from then on."""
    import numpy as np
    import trimesh

    from dh2urdf.meshes import load_scene

    for suffix in {suffix for _, suffix in files}:  # Behind the fence, no module can be read.
        sample = trimesh.creation.box().export(file_type=suffix[1:])
        load_scene(sample.encode() if isinstance(sample, str) else sample, suffix, process=False)
    enter([Path(__file__).parent], _SECONDS)
    found: list[Measured] = []
    for content, suffix in files:
        try:
            scene = load_scene(content, suffix, process=False)
            placed = [
                trimesh.transform_points(scene.geometry[name].vertices[np.unique(scene.geometry[name].faces)], matrix)
                for matrix, name in (scene.graph[node] for node in scene.graph.nodes_geometry)
                if len(getattr(scene.geometry[name], "faces", ()))
            ]
        except Exception as error:  # noqa: BLE001 - what a reader of other people's files raises is anything
            found.append(Measured(f"it cannot be read: {error!s:.100}", [], is_planar=False))
            continue
        if not placed:
            found.append(Measured("it has no triangles", [], is_planar=False))
            continue
        sides, is_planar = _extents(np.concatenate(placed))
        found.append(Measured("", list(sides or ()), is_planar))
    return found


def _extents(corners: Any) -> tuple[Vec3 | None, bool]:  # noqa: ANN401 - an array of shape (N, 3)
    """The extents of corners along x, y and z, and whether they are in a plane; None where one is not finite."""
    import numpy as np

    if not np.isfinite(corners).all():
        return None, False
    low, high = corners.min(axis=0), corners.max(axis=0)
    # The spread across the plane that fits best, by the singular values of the corners about their middle.
    spread = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False, full_matrices=False)
    x, y, z = (float(side) for side in high - low)
    return (x, y, z), bool(spread[-1] <= _FLAT * max(spread[0], 1e-300) * math.sqrt(len(corners)))
