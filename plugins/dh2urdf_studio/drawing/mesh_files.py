"""The triangles of mesh files as a browser takes them: corners with normals, one run of bytes for each file.

The pictures on triangles are files of their own, which the page asks for by keys.
"""

from __future__ import annotations

import io
import json
import struct
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import OutputError
from dh2urdf.meshes import FORMATS, REMEDY, read_parts
from dh2urdf.meshes.addresses import NamedFiles
from dh2urdf.rotations import Vec3
from dh2urdf.source import Problem, shown
from dh2urdf_studio.drawing.solids import Picture, Surface

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.meshes.triangles import Part
    from dh2urdf.robot import Mesh

SUFFIXES = (*FORMATS, ".glb", ".gltf")
"""How the names of the files end that can be drawn."""
LARGEST = 512 * 2**20
"""Size of a mesh file that is read, and of each file that it names [B]."""
LARGEST_PICTURE = 2**26
"""Pixels of a texture that is drawn."""
_SHOWN = {"PNG": "image/png", "JPEG": "image/jpeg", "WEBP": "image/webp"}
"""Formats of pictures that all browsers show; others are sent as PNG."""
_SMOOTH = 0.77
"""Cosine of the largest angle between two triangles that are parts of one smooth surface: 40°."""
_HALF = ((1.0 + _SMOOTH) / 2.0) ** 0.5
"""Cosine of half of that angle."""
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


class DrawnTriangles(NamedTuple):
    """What the page gets of a mesh file.

    Attributes:
        content: see `triangles`.
        pictures: the textures by the keys that the page asks for them by.
    """

    content: bytes
    pictures: dict[str, Picture]


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


def triangles(mesh: DrawnMesh) -> DrawnTriangles:
    """The triangles of a file in metres, z up, for `arm_view.js`.

    The length of a header (four bytes, little-endian), the header as JSON, and for each of its parts the corners:
    positions as 32-bit floats (N, 3), normals of 8 bits (N, 4), of which the fourth is 0, for a part with a texture the
    places in the picture as 32-bit floats (N, 2), and the numbers of corners (3 M) as 32-bit integers, three for each
    triangle. A part has the colour that the file gives it, or null, and the key of its texture, or null. `unread` of
    the header has messages about the files that the mesh file names and that are not shown.

    Raises:
        OutputError: the file cannot be read, or holds no triangles.
    """
    import numpy as np

    told, bodies, pictures = [], [], {}
    named = NamedFiles(mesh.path, LARGEST)
    for rgba, surface in surfaces(mesh, named):
        packed = np.zeros((len(surface.normals), 4), dtype=np.int8)
        packed[:, :3] = np.rint(127 * surface.normals)
        bodies += [surface.positions.astype("<f4").tobytes(), packed.tobytes()]
        key = None
        if surface.texture is not None:
            key = sha256(surface.texture.content).hexdigest()[:32]
            pictures[key] = surface.texture
            bodies.append(surface.uv.astype("<f4").tobytes())
        bodies.append(surface.corners.astype("<u4").tobytes())
        told.append({"rgba": rgba, "vertices": len(packed), "corners": len(surface.corners), "texture": key})
    unread = [f"{shown(mesh.path.name)} names {shown(name)}: {why}" for name, why in named.unread.items()]
    header = json.dumps({"parts": told, "unread": unread}).encode()
    header += b" " * (-len(header) % 4)
    return DrawnTriangles(b"".join([struct.pack("<I", len(header)), header, *bodies]), pictures)


def _textured(part: Part, named: NamedFiles) -> tuple[Any, Picture] | None:
    """The texture of a part, with the places of its corners; one that cannot be shown is added to the unread names."""
    if part.texture is None:
        return None
    uv, image = part.texture
    try:
        if image.width * image.height > LARGEST_PICTURE:
            raise ValueError(f"it has more than {LARGEST_PICTURE // 2**20} million pixels")
        if image.format in _SHOWN and getattr(image, "fp", None):  # the file as it is
            image.fp.seek(0)
            return uv, Picture(image.fp.read(), _SHOWN[image.format])
        target = io.BytesIO()
        image.convert("RGBA").save(target, "PNG", compress_level=1)
    except Exception as error:  # noqa: BLE001 - of a stranger's file: anything
        named.unread["a texture"] = str(error)[:200]
        return None
    return uv, Picture(target.getvalue(), "image/png")


def surfaces(
    mesh: DrawnMesh, named: NamedFiles | None = None
) -> Iterator[tuple[tuple[float, float, float, float] | None, Surface]]:
    """The triangles of a file in metres, z up: the surface of each part with its colour. Like corners are one.

    A corner has the mean of the normals of the triangles that meet there, weighted by their areas, without those that
    are at an edge from its own one; a triangle without an area has normals along z.

    Args:
        mesh: the file.
        named: reads the files that it names, and has the messages about those that cannot be shown.

    Raises:
        OutputError: the file cannot be read, or holds no triangles.
    """
    import numpy as np

    named = named or NamedFiles(mesh.path, LARGEST)
    for part in _parts(mesh, named):
        normals, alike = _normals(part.vertices, part.faces)
        uv, picture = _textured(part, named) or (None, None)
        if uv is not None:
            rows = np.column_stack([alike, uv.astype("<f4").view("<u4")])
            _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
            alike = first[number.reshape(-1)]
        is_first = alike == np.arange(len(alike))
        corners = (np.cumsum(is_first) - 1)[alike]
        places = None if uv is None else uv[is_first]
        yield (
            part.rgba,
            Surface(part.vertices[part.faces.reshape(-1)[is_first]], normals[is_first], corners, places, picture),
        )


def _parts(mesh: DrawnMesh, named: NamedFiles) -> list[Part]:
    """What a file holds.

    Raises:
        OutputError: the file cannot be read, or holds no triangles.
    """
    name = shown(mesh.path.name)
    try:
        if mesh.path.stat().st_size > LARGEST:
            raise OutputError(Problem(message=f"{name} is larger than {LARGEST // 2**20} MB"))
        content = mesh.path.read_bytes()
        return read_parts(content, mesh.path.suffix.lower(), mesh.scale, as_in_ros=mesh.as_in_ros, named=named)
    except OSError as error:
        raise OutputError(Problem(message=f"{name} cannot be read: {error.strerror}")) from error
    except ImportError as error:
        message = f"{name} needs a package that is not installed"
        raise OutputError(Problem(message=message, suggestion=REMEDY)) from error
    except OutputError:
        raise
    except Exception as error:
        raise OutputError(Problem(message=f"{name} cannot be read: {str(error)[:200]}")) from error


def _normals(vertices: Any, faces: Any) -> tuple[Any, Any]:  # noqa: ANN401 - arrays
    """Unit normals of the corners of all triangles, see `surfaces`, and the first corner that each is the same as."""
    import numpy as np

    a, b, c = (vertices[faces[:, corner]] for corner in range(3))
    areas = np.cross(b - a, c - a)
    flat = _unit(areas)
    meeting = faces.reshape(-1)
    order = np.argsort(meeting, kind="stable")  # corners at one vertex, one after the other
    counts = np.bincount(meeting)
    counts = counts[counts > 0]
    first = np.cumsum(counts) - counts
    # Where all triangles are within half of the angle from one direction, they are one surface.
    total = np.add.reduceat(areas[order // 3], first)
    apart = np.einsum("ij,ij->i", flat[order // 3], np.repeat(_unit(total), counts, axis=0))
    is_edge = np.minimum.reduceat(apart, first) <= _HALF
    normals, alike = np.empty((len(meeting), 3)), np.empty_like(order)
    normals[order], alike[order] = np.repeat(total, counts, axis=0), np.repeat(order[first], counts)
    for count in np.unique(counts[is_edge]):
        starts = first[is_edge & (counts == count)]
        for some in np.array_split(starts, 1 + len(starts) * count * count // _AT_ONCE):
            corners = order[some[:, None] + np.arange(count)]  # (vertices, corners there)
            near, own = areas[corners // 3], flat[corners // 3]
            mean = (own @ own.transpose(0, 2, 1) > _SMOOTH) @ near
            x, y, z = (mean[:, :, None, axis] == mean[:, None, :, axis] for axis in range(3))
            normals[corners], alike[corners] = mean, np.take_along_axis(corners, (x & y & z).argmax(axis=2), axis=1)
    normals = _unit(normals)
    normals[~normals.any(axis=1)] = (0.0, 0.0, 1.0)
    return normals, alike


def _unit(vectors: Any) -> Any:  # noqa: ANN401 - arrays (N, 3)
    import numpy as np

    lengths = np.sqrt(np.einsum("ij,ij->i", vectors, vectors))[:, None]
    return np.divide(vectors, lengths, out=np.zeros_like(vectors), where=lengths > 0.0)
