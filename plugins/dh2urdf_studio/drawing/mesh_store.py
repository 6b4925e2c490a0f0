"""The triangles of the mesh files that pages ask for: each file is read once, and before anybody asks for it.

Children read them, see `dh2urdf.isolation.child_process`: the server answers meanwhile, and a file that ends its reader
ends nothing else.
"""

from __future__ import annotations

import os
from concurrent.futures import Future, ThreadPoolExecutor
from typing import TYPE_CHECKING

from dh2urdf.errors import CrashError, OutputError
from dh2urdf.isolation.child_process import Child
from dh2urdf.isolation.encodings import Data
from dh2urdf.source import Messages, shown
from dh2urdf_studio.drawing.mesh_files import DrawnTriangles, triangles

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping

    from dh2urdf_studio.drawing.mesh_files import DrawnMesh, Picture

say = Messages(__file__)

_MOST_READERS = 4
"""Files that are read at a time, where there are so many processors beside the one of the server and the page."""
_READ: Data[DrawnTriangles] = Data(DrawnTriangles)


class MeshStore:
    """What the pages serve of mesh files, by the keys that pages ask for them by."""

    def __init__(self, meshes: Mapping[str, DrawnMesh]) -> None:
        self._meshes = dict(meshes)
        readers = max(1, min(_MOST_READERS, (os.cpu_count() or 1) - 1))
        self._pool = ThreadPoolExecutor(readers, thread_name_prefix="dh2urdf-mesh")
        self._idle: list[Child] = []
        self._busy: set[Child] = set()
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

    @property
    def is_reading(self) -> bool:
        """Whether a file is being read."""
        return bool(self._busy)

    def picture(self, key: str) -> Picture | None:
        """The texture with a key, which the triangles of a file have named; None if none has."""
        return self._pictures.get(key)

    def triangles(self, key: str) -> Future[DrawnTriangles]:
        """The triangles of a file, as soon as they are read; of a file that has changed, anew.

        The future raises `OutputError` where the file cannot be read.
        """
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
        name = shown(mesh.path.name)
        try:
            child = self._idle.pop() if self._idle else Child.started()
            self._busy.add(child)
            try:
                found = child.call(triangles, (mesh,), None, f"the reader of {name}", _READ).value
            finally:
                self._busy.discard(child)
                if child.is_alive():
                    self._idle.append(child)
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
        for child in tuple(self._busy):
            child.kill()  # its thread ends it: two at once would close what the other one reads
        while self._idle:
            self._idle.pop().end()
