"""Where readers look for mesh files, and what is in them: a mesh, how large it is, and the header of a COLLADA file.

A first look finds what is plain: a binary STL is a table of numbers, an OBJ has lines of vertices and faces, and a
COLLADA file its numbers in XML. Where that look finds something odd, or a size that no link has, trimesh reads the
file, behind the fence: any file may be at the address of a mesh. Without trimesh, or without the wall of the kernel,
what is odd stays unknown.
"""

from __future__ import annotations

import math
import os
import re
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from lxml import etree

from dh2urdf.documents import ForbiddenXmlError, is_file, is_folder, xml_root
from dh2urdf.errors import CrashError
from dh2urdf.isolation import Data, enter, run_in_child
from dh2urdf.isolation.fence import refuse_without_wall
from dh2urdf.meshes import FILE, PACKAGE, path_of_address

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

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
    """What is known of a file."""

    problem: str = ""  # why no mesh can be read from it; empty where one can, or may
    sides: tuple[float, float, float] | None = None  # along x, y and z, in its own frame and unit
    is_planar: bool = False  # whether all its corners are in one plane
    triangles: int = 0  # how many a binary STL has
    is_text: bool = False  # whether it is an STL of text
    unit: float = 1.0  # of a COLLADA file [m]
    header: str = ""  # what PyBullet cannot take of the header of a COLLADA file
    has_faces: bool = False  # whether a first look at a COLLADA file found faces
    is_odd: bool = False  # whether a first look did not settle it


_MEASURED: Data[list[MeshFile]] = Data(list[MeshFile])


def read_meshes(paths: Iterable[Path]) -> dict[Path, MeshFile]:
    """What is in some mesh files, as far as it is known."""
    found: dict[Path, MeshFile] = {}
    left: dict[Path, tuple[bytes, str]] = {}
    for path in paths:
        suffix = path.suffix.lower()
        if suffix not in _READ or path.stat().st_size > LARGEST:
            continue
        content = path.read_bytes()
        if not content.strip(b"\0 \t\r\n"):
            found[path] = MeshFile("it is empty")
        elif content.startswith(_POINTER):
            found[path] = MeshFile("it is a pointer of Git LFS, and not the file")
        else:
            found[path] = {".stl": _stl, ".obj": _obj, ".dae": _collada}[suffix](content)
        if found[path].is_odd:
            left[path] = content, suffix
    if not left:
        return found
    try:
        refuse_without_wall()
        given = list(left.values())
        answer = run_in_child(_behind_fence, given, timeout=_SECONDS, who="trimesh", encoding=_MEASURED)
    except (ImportError, MemoryError, CrashError, ValueError):  # There is no trimesh, or no wall of the kernel.
        return found
    for path, each in zip(left, answer.value, strict=True):
        problem = "" if found[path].has_faces else each.problem  # trimesh knows less of COLLADA than readers do.
        found[path] = found[path]._replace(problem=problem, sides=each.sides, is_planar=each.is_planar)
    return found


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
    return _measured(corners)._replace(triangles=count)


def _obj(content: bytes) -> MeshFile:
    import numpy as np

    try:
        corners = np.array(_VERTEX.findall(content), dtype=float).reshape(-1, 3)
    except ValueError:
        return MeshFile(is_odd=True)
    known = _measured(corners) if len(corners) >= _CORNERS and _FACE.search(content) else MeshFile()
    return known._replace(is_odd=known.sides is None)


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


def _behind_fence(files: list[tuple[bytes, str]]) -> list[MeshFile]:
    """Measure files in this process, which can do nothing else from then on."""
    import numpy as np
    import trimesh

    from dh2urdf.meshes import load_scene

    for suffix in {suffix for _, suffix in files}:  # Behind the fence, no module can be read.
        sample = trimesh.creation.box().export(file_type=suffix[1:])
        load_scene(sample.encode() if isinstance(sample, str) else sample, suffix, process=False)
    enter([Path(__file__).parent], _SECONDS)
    found: list[MeshFile] = []
    for content, suffix in files:
        try:
            scene = load_scene(content, suffix, process=False)
            placed = [
                trimesh.transform_points(scene.geometry[name].vertices[np.unique(scene.geometry[name].faces)], matrix)
                for matrix, name in (scene.graph[node] for node in scene.graph.nodes_geometry)
                if len(getattr(scene.geometry[name], "faces", ()))
            ]
        except Exception as error:  # noqa: BLE001 - what a reader of other people's files raises is anything
            found.append(MeshFile(f"it cannot be read: {error!s:.100}"))
            continue
        found.append(_measured(np.concatenate(placed)) if placed else MeshFile("it has no triangles"))
    return found


def _measured(corners: Any) -> MeshFile:  # noqa: ANN401 - an array of shape (N, 3)
    """A mesh whose triangles have these corners, of which only finite ones have sides."""
    import numpy as np

    if not np.isfinite(corners).all():
        return MeshFile()
    low, high = corners.min(axis=0), corners.max(axis=0)
    # The spread across the plane that fits best, by the singular values of the corners about their middle.
    spread = np.linalg.svd(corners - corners.mean(axis=0), compute_uv=False, full_matrices=False)
    x, y, z = (float(side) for side in high - low)
    is_planar = bool(spread[-1] <= _FLAT * max(spread[0], 1e-300) * math.sqrt(len(corners)))
    return MeshFile(sides=(x, y, z), is_planar=is_planar)


# --- Where readers look for the files that a description names --------------------------------------------------------


_MODEL = "model://"


def resolved(address: str, description: Path, packages: Mapping[str, Path]) -> Path | None:
    """The file that an address means, whether there is one or not; None where its package is not found."""
    folder = Path(os.path.abspath(description)).parent  # noqa: PTH100 - links in the path stay
    if not address.startswith(PACKAGE):
        return folder / path_of_address(address)
    package, _, rest = address.removeprefix(PACKAGE).partition("/")
    if not package:
        return None
    searched = [place for inner in (folder, *folder.parents) for place in (inner, inner.parent / package)]
    for variable, below in (("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")):
        searched += [Path(each, below, package) for each in os.environ.get(variable, "").split(os.pathsep) if each]
    found = [place / rest for place in searched if place.name == package and is_folder(place)]
    if package in packages:
        found.append(packages[package] / rest)
    return next((file for file in found if is_file(file)), found[0] if found else None)


def is_found_by_pybullet(address: str, description: Path) -> bool:
    """PyBullet knows no packages: it looks for the path behind `package://` in the folder and in all above it."""
    if address.startswith(FILE):
        address = path_of_address(address)
    rest = address.removeprefix(PACKAGE).removeprefix(_MODEL).lstrip("/")
    folder = Path(os.path.abspath(description)).parent  # noqa: PTH100 - links in the path stay
    return is_file(Path(address)) or any(is_file(above / rest) for above in (folder, *folder.parents))
