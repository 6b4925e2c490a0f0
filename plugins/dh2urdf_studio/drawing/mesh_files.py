"""The triangles of mesh files as a browser takes them: corners with normals, one run of bytes for each file.

The pictures on triangles are files of their own, which the page asks for by keys. Each file is read once, and before
anybody asks for it. Children read them, see `dh2urdf.isolation.child_process`: the server answers meanwhile, and a file
that ends its reader ends nothing else.
"""

from __future__ import annotations

import io
import json
import math
import os
import struct
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.errors import CrashError, OutputError
from dh2urdf.isolation import Data, KeptChildren
from dh2urdf.meshes import FORMATS, REMEDY, read_parts
from dh2urdf.meshes.addresses import NamedFiles
from dh2urdf.rotations import Vec3
from dh2urdf.source import Messages, shown

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping

    from dh2urdf.meshes.triangles import Part

say = Messages(__file__)

SUFFIXES = (*FORMATS, ".glb", ".gltf")  # file name endings of the meshes that can be drawn
LARGEST = 512 * 2**20  # size of a mesh file that is read, and of each file that it names [B]
LARGEST_PICTURE = 2**26  # pixels of a texture that is drawn
_SHOWN = {"PNG": "image/png", "JPEG": "image/jpeg", "WEBP": "image/webp"}
"""Formats of pictures that all browsers show; others are sent as PNG."""
_SMOOTH = math.radians(40.0)  # the largest angle between neighbouring triangles of one smooth surface
_MOST_READERS = 4
"""Files that are read at a time, where there are so many processors beside the one of the server and the page."""


class Picture(NamedTuple):
    """A picture on triangles, as browsers show it: the bytes of a file."""

    content: bytes
    media_type: str  # such as ``image/png``


class Surface(NamedTuple):
    """Triangles, as arrays, with the picture on them."""

    positions: Any  # of the corners [m], of shape (N, 3)
    normals: Any  # the direction outwards at each corner, of shape (N, 3)
    faces: Any  # numbers of corners, anticlockwise as seen from outside, of shape (M, 3)
    uv: Any = None  # where the corners are in the texture, as `dh2urdf.meshes.triangles.Texture` has them, (N, 2)
    texture: Picture | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class DrawnMesh:
    """A mesh file, as the scene draws it."""

    path: Path
    scale: Vec3 = (1.0, 1.0, 1.0)  # factors along the axes of the mesh
    as_in_ros: bool = False  # whether the axis up of a COLLADA file is not followed: see `dh2urdf.meshes.read_parts`

    @property
    def key(self) -> str:
        """What the page asks for it by: nothing of the machine's folders is in it."""
        return sha256(f"{self.path}\0{self.scale}\0{self.as_in_ros}".encode()).hexdigest()[:32]


class DrawnTriangles(NamedTuple):
    """What the page gets of a mesh file: the bytes of `triangles`, and the textures by the keys that they name."""

    content: bytes
    pictures: dict[str, Picture]


def triangles(mesh: DrawnMesh) -> DrawnTriangles:
    """The triangles of a file in metres, z up, for `arm_view.js`.

    The length of a header (four bytes, little-endian), the header as JSON, and for each of its parts the corners:
    positions as 32-bit floats (N, 3), normals of 8 bits (N, 4), of which the fourth is 0, for a part with a texture the
    places in the picture as 32-bit floats (N, 2), and the numbers of corners (3 M) as 32-bit integers, three for each
    triangle. A part has the colour that the file gives it, or null, and the key of its texture, or null. `unread` of
    the header has messages about the files that the mesh file names and that are not shown.
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
        bodies.append(surface.faces.astype("<u4").tobytes())
        told.append({"rgba": rgba, "vertices": len(packed), "corners": surface.faces.size, "texture": key})
    unread = [f"{shown(mesh.path.name)} names {shown(name)}: {why}" for name, why in named.unread.items()]
    header = json.dumps({"parts": told, "unread": unread}).encode()
    header += b" " * (-len(header) % 4)
    return DrawnTriangles(b"".join([struct.pack("<I", len(header)), header, *bodies]), pictures)


def surfaces(
    mesh: DrawnMesh, named: NamedFiles | None = None
) -> Iterator[tuple[tuple[float, float, float, float] | None, Surface]]:
    """The triangles of a file in metres, z up: the surface of each part with its colour; an `OutputError` of none."""
    named = named or NamedFiles(mesh.path, LARGEST)
    try:
        if mesh.path.stat().st_size > LARGEST:
            raise ValueError(f"it is larger than {LARGEST // 2**20} MB")
        content, suffix = mesh.path.read_bytes(), mesh.path.suffix.lower()
        parts = read_parts(content, suffix, mesh.scale, as_in_ros=mesh.as_in_ros, named=named)
    except OutputError:
        raise
    except ImportError as error:
        raise OutputError(say("mesh-package-missing", name=mesh.path.name, remedy=REMEDY)) from error
    except Exception as error:
        why = getattr(error, "strerror", None) or str(error)[:200]
        raise OutputError(say("file-unreadable", name=mesh.path.name, reason=why)) from error
    for part in parts:
        yield part.rgba, creased(part.vertices, part.faces, *(_textured(part, named) or ()))


def creased(vertices: Any, faces: Any, uv: Any = None, picture: Picture | None = None) -> Surface:  # noqa: ANN401 - arrays
    """The surface of triangles (M, 3) between vertices (N, 3), with edges where neighbours are more than 40° apart.

    Where there is a picture, `uv` of shape (3 M, 2) tells the places of the triangles' corners in it.
    """
    import numpy as np
    import trimesh

    whole = trimesh.Trimesh(vertices, faces, process=False)
    near = whole.face_adjacency[whole.face_adjacency_angles <= _SMOOTH]
    graph: Any = trimesh.graph  # its functions have no types
    smooth = graph.connected_component_labels(near, node_count=len(faces))
    rows = np.column_stack([np.repeat(smooth, 3), np.asarray(faces).reshape(-1)])
    if uv is not None:
        rows = np.column_stack([rows, uv.astype("<f4").view("<u4")])
    _, first, number = np.unique(rows, axis=0, return_index=True, return_inverse=True)
    number = number.reshape(-1, 3)
    # Of one smooth surface a vertex has one normal, though its triangles have several places in the picture.
    _, group = np.unique(rows[first, :2], axis=0, return_inverse=True)
    group, sums = group.reshape(-1), np.zeros((len(first), 3))
    np.add.at(sums, group[number].reshape(-1), np.repeat(whole.triangles_cross, 3, axis=0))
    normals = sums[group]
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    normals = np.where(lengths > 0.0, normals / np.where(lengths > 0.0, lengths, 1.0), (0.0, 0.0, 1.0))
    places = None if uv is None else uv[first]
    return Surface(np.asarray(vertices)[rows[first, 1]], normals, number, places, picture)


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


_READ: Data[DrawnTriangles] = Data(DrawnTriangles)


class MeshStore:
    """What the pages serve of mesh files, by the keys that pages ask for them by."""

    def __init__(self, meshes: Mapping[str, DrawnMesh]) -> None:
        self._meshes = dict(meshes)
        readers = max(1, min(_MOST_READERS, (os.cpu_count() or 1) - 1))
        self._pool = ThreadPoolExecutor(readers, thread_name_prefix="dh2urdf-mesh")
        self._children = KeptChildren()
        self._read: dict[str, tuple[tuple[int, int], Future[DrawnTriangles]]] = {}
        self._pictures: dict[str, Picture] = {}

    def add(self, meshes: Mapping[str, DrawnMesh]) -> None:
        """Serve more files; they are read before pages ask for them."""
        self._meshes.update(meshes)
        self.begin(meshes)

    def forget(self, keys: Iterable[str]) -> None:
        """Serve these files no longer."""
        for key in keys:
            self._meshes.pop(key, None)
            self._read.pop(key, None)

    def __contains__(self, key: str) -> bool:
        """Whether there is a file with this key."""
        return key in self._meshes

    def picture(self, key: str) -> Picture | None:
        """The texture with a key, which the triangles of a file have named; None if none has."""
        return self._pictures.get(key)

    def triangles(self, key: str) -> Future[DrawnTriangles]:
        """The triangles of a file, or an `OutputError`, as soon as it is read; of a file that has changed, anew."""
        mesh = self._meshes[key]
        try:
            status = mesh.path.stat()
            stamp = status.st_mtime_ns, status.st_size
        except OSError:  # which reading the file reports
            stamp = 0, 0
        if key not in self._read or self._read[key][0] != stamp:
            self._read[key] = stamp, self._pool.submit(self._triangles, mesh)
        return self._read[key][1]

    def _triangles(self, mesh: DrawnMesh) -> DrawnTriangles:
        who = f"the reader of {shown(mesh.path.name)}"
        try:
            with self._children.child(who) as child:
                found = child.call(triangles, (mesh,), None, who, _READ).value
        except CrashError as error:
            raise OutputError(say("file-unreadable", name=mesh.path.name, reason=error.problems[0].message)) from error
        self._pictures.update(found.pictures)
        return found

    def begin(self, keys: Iterable[str]) -> None:
        """Begin to read files that pages will surely ask for."""
        for key in keys:
            self.triangles(key)

    def close(self) -> None:
        """Read nothing more, also of the files that are being read."""
        self._pool.shutdown(wait=False, cancel_futures=True)
        self._children.end()
