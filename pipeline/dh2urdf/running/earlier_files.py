"""The files of earlier runs: whether they are still there, byte for byte, and how they get into a new shard."""

from __future__ import annotations

from hashlib import sha256
from typing import TYPE_CHECKING

from dh2urdf.errors import OutputError
from dh2urdf.output.shards import members

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.conversion.outcome import ManifestRow
    from dh2urdf.output.layouts import Layout, Put
    from dh2urdf.output.store import Store
    from dh2urdf.results import FileEntry


class EarlierFiles:
    """What earlier runs have left of the files of a batch."""

    def __init__(self, store: Store, layout: Layout) -> None:
        """Takes the store, and how files lie in it."""
        self._store, self._layout = store, layout
        self._meshes: dict[str, str] = {}
        self._shards: dict[str, dict[str, bytes]] = {}
        self._damaged: set[str] = set()

    def has(self, index: int, row: ManifestRow) -> bool:
        """Whether all files and pictures of a row are there, with the bytes that they were written with."""
        if not all(self.has_mesh(mesh["path"], mesh["sha256"]) for mesh in row.get("meshes", ())):
            return False
        digests = {file["path"]: file["sha256"] for file in row["files"]}
        for name, digest in _pictures(row).items():
            digests[name if self._layout.is_whole else self._layout.path(index, name)] = digest
        return bool(row["files"]) and all(self._digest(index, name) == digest for name, digest in digests.items())

    def are_all(self, index: int, rows: Iterable[ManifestRow]) -> bool:
        """Whether the earlier shard that a manipulator goes into is, byte for byte, the one of these rows.

        One of a run with larger shards, or with more manipulators, has other files behind them.
        """
        names = [name for row in rows for name in (*(file["path"] for file in row["files"]), *_pictures(row))]
        return list(self._members(index)) == names and self._layout.folder(index) not in self._damaged

    def moved(self, index: int, row: ManifestRow, put: Put) -> ManifestRow:
        """The row of a manipulator whose files go into a new shard, since the old one has not the same ones."""
        old = self._members(index)
        files: list[FileEntry] = []
        for file in row["files"]:
            stored = put(index, file["path"], old[file["path"]])
            files.append({**file, **stored})
        for name in _pictures(row):
            put(index, name, old[name])
        moved = row.copy()
        moved["files"] = files
        return moved

    def has_mesh(self, path: str, digest: str) -> bool:
        """Whether the copy of a mesh is there, with its bytes; many robots share it, and it is read once."""
        if path not in self._meshes:
            try:
                self._meshes[path] = sha256(self._store.read(path)).hexdigest()
            except OutputError:
                self._meshes[path] = ""
        return self._meshes[path] == digest

    def _digest(self, index: int, name: str) -> str:
        """The hash of an earlier file of a manipulator; empty where there is none."""
        try:
            content = self._members(index)[name] if self._layout.is_whole else self._store.read(name)
        except (KeyError, OutputError):
            return ""
        return sha256(content).hexdigest()

    def _members(self, index: int) -> dict[str, bytes]:
        """The files of the earlier shard that a manipulator goes into by their names, as far as it is whole."""
        name = self._layout.folder(index)
        if name not in self._shards:
            found = self._shards[name] = {}
            try:
                with self._store.open(name) as shard:
                    for member in members(shard):
                        if member.name in found:  # Readers of tar take the later one.
                            self._damaged.add(name)
                        found[member.name] = member.content
            except OutputError:
                self._damaged.add(name)
        return self._shards[name]


def _pictures(row: ManifestRow) -> dict[str, str]:
    """The pictures of a manipulator by their names, with the hashes of their bytes."""
    return row.get("pictures", {})
