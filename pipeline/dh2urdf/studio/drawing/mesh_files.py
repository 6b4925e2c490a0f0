"""The triangles of mesh files as a browser takes them: corners with normals, one run of bytes for each file."""

from __future__ import annotations

import json
import struct
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.errors import OutputError
from dh2urdf.meshes import FORMATS, REMEDY, read_parts
from dh2urdf.rotations import Vec3
from dh2urdf.source import Problem, shown
from dh2urdf.studio.drawing.solids import Surface

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.meshes.triangles import Part
    from dh2urdf.robot import Mesh

SUFFIXES = (*FORMATS, ".glb", ".gltf")
"""How the names of the files end that can be drawn."""
LARGEST = 512 * 2**20
"""Size of a mesh file that is read [B]."""
_SMOOTH = 0.77
"""Cosine of the largest angle between two triangles that are parts of one smooth surface: 40°."""
_AT_ONCE = 2**22
"""Pairs of corners that are compared at a time."""


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnMesh:
    """A mesh file with a scale, as the scene draws it.

    Attributes:
        path: the file.
        scale: factors along the axes of the mesh.
        as_in_ros: whether the axis up of a COLLADA file is not followed: see `dh2urdf.meshes.read_parts`.
    """

    path: Path
    scale: Vec3 = (1.0, 1.0, 1.0)
    as_in_ros: bool = False

    @property
    def key(self) -> str:
        """What the page asks for it by: nothing of the machine's folders is in it."""
        return sha256(f"{self.path}\0{self.scale}\0{self.as_in_ros}".encode()).hexdigest()[:32]


def drawn_mesh(mesh: Mesh, path: Path | None, *, as_in_ros: bool) -> DrawnMesh | None:
    """What is drawn of a mesh; None where there is no file, or none of a kind that can be drawn.

    Args:
        mesh: the mesh.
        path: the file that its address means; a mesh of a table knows its own.
        as_in_ros: whether the axis up of a COLLADA file is not followed; it always is for a table's mesh.
    """
    path = Path(mesh.file.path) if mesh.file is not None else path
    if path is None or path.suffix.lower() not in SUFFIXES:
        return None
    return DrawnMesh(path=path, scale=mesh.scale, as_in_ros=as_in_ros and mesh.file is None)


def triangles(mesh: DrawnMesh) -> bytes:
    """The triangles of a file in metres, z up, for `arm_view.js`.

    The length of a header (four bytes, little-endian), the header as JSON, and for each of its parts the corners of all
    triangles, three after three: positions as 32-bit floats (N, 3), then normals of 8 bits (N, 4), of which the fourth
    is 0. A part has the colour that the file gives it, or null.

    Raises:
        OutputError: the file cannot be read, or holds no triangles.
    """
    import numpy as np

    told, bodies = [], []
    for part in _parts(mesh):
        corners, normals = _corners(part.vertices, part.faces)
        packed = np.zeros((len(normals), 4), dtype=np.int8)
        packed[:, :3] = np.rint(127 * normals)
        told.append({"rgba": part.rgba, "corners": len(corners)})
        bodies += [corners.tobytes(), packed.tobytes()]
    header = json.dumps({"parts": told}).encode()
    header += b" " * (-len(header) % 4)
    return b"".join([struct.pack("<I", len(header)), header, *bodies])


def surfaces(mesh: DrawnMesh) -> Iterator[tuple[tuple[float, float, float, float] | None, Surface]]:
    """The same triangles, for files: the surface of each part with its colour, corners that are alike once.

    Raises:
        OutputError: the file cannot be read, or holds no triangles.
    """
    import numpy as np

    for part in _parts(mesh):
        positions, normals = _corners(part.vertices, part.faces)
        normals[~normals.any(axis=1)] = (0.0, 0.0, 1.0)  # of triangles without an area
        both = np.concatenate([positions, normals.round(3)], axis=1, dtype="<f4") + np.float32(0.0)  # no -0
        _, first, corners = np.unique(both.view("V24").ravel(), return_index=True, return_inverse=True)
        yield part.rgba, Surface(positions[first], _unit(normals[first]), corners)


def _parts(mesh: DrawnMesh) -> list[Part]:
    """What a file holds.

    Raises:
        OutputError: the file cannot be read, or holds no triangles.
    """
    name = shown(mesh.path.name)
    try:
        if mesh.path.stat().st_size > LARGEST:
            raise OutputError(Problem(message=f"{name} is larger than {LARGEST // 2**20} MB"))
        content = mesh.path.read_bytes()
        return read_parts(content, mesh.path.suffix.lower(), mesh.scale, as_in_ros=mesh.as_in_ros)
    except OSError as error:
        raise OutputError(Problem(message=f"{name} cannot be read: {error.strerror}")) from error
    except ImportError as error:
        message = f"{name} needs a package that is not installed"
        raise OutputError(Problem(message=message, suggestion=REMEDY)) from error
    except OutputError:
        raise
    except Exception as error:
        raise OutputError(Problem(message=f"{name} cannot be read: {str(error)[:200]}")) from error


def _corners(vertices: Any, faces: Any) -> tuple[Any, Any]:  # noqa: ANN401 - arrays
    """Positions and unit normals of the corners of all triangles; the normals of triangles without an area are 0.

    A corner has the mean of the normals of the triangles that meet there, weighted by their areas, without those that
    are at an edge from its own one.
    """
    import numpy as np

    triangles = vertices[faces]
    areas = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    flat = _unit(areas)
    meeting = faces.reshape(-1)
    order = np.argsort(meeting, kind="stable")  # corners at one vertex, one after the other
    _, first, counts = np.unique(meeting[order], return_index=True, return_counts=True)
    normals = np.empty((len(meeting), 3))
    for count in np.unique(counts):
        starts = first[counts == count]
        for some in np.array_split(starts, 1 + len(starts) * count * count // _AT_ONCE):
            corners = order[some[:, None] + np.arange(count)]  # (vertices, corners there)
            near, own = areas[corners // 3], flat[corners // 3]
            smooth = own @ own.transpose(0, 2, 1) > _SMOOTH
            normals[corners.reshape(-1)] = (smooth @ near).reshape(-1, 3)
    return triangles.reshape(-1, 3).astype("<f4"), _unit(normals)


def _unit(vectors: Any) -> Any:  # noqa: ANN401 - arrays (N, 3)
    import numpy as np

    lengths = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0)
