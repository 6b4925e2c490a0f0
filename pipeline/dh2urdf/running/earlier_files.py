"""The files of earlier runs: whether they are still there, byte for byte, and how they get into a new shard."""

from __future__ import annotations

from hashlib import sha256
from typing import TYPE_CHECKING

from dh2urdf.errors import OutputError
from dh2urdf.output.shards import is_shard_of, members

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.conversion.outcome import ManifestRow
    from dh2urdf.output.layouts import Layout, Put
    from dh2urdf.output.store import Store


class EarlierFiles:
    """What earlier runs have left of the files of a batch."""

    def __init__(self, store: Store, layout: Layout) -> None:
        """Takes the store, and how files lie in it."""
        self._store, self._layout = store, layout
        self._meshes: dict[str, str] = {}
        self._shards: dict[str, bytes] = {}
        self._members: dict[str, dict[str, memoryview]] = {}

    def has(self, index: int, row: ManifestRow) -> bool:
        """Whether all files and pictures of a row are there, with the bytes that they were written with."""
        if not all(self.has_mesh(mesh["path"], mesh["sha256"]) for mesh in row.get("meshes", ())):
            return False
        digests = [*(file["sha256"] for file in row["files"]), *row.get("pictures", {}).values()]
        try:
            found = [sha256(content).hexdigest() for _, content in self._contents(index, row)]
        except (KeyError, OutputError):
            return False
        return bool(row["files"]) and found == digests

    def are_all(self, index: int, rows: Iterable[ManifestRow]) -> bool:
        """Whether the earlier shard that a manipulator goes into is, byte for byte, the one of these rows.

        One of a run with larger shards, or with more manipulators, has other files behind them.
        """
        files = (file for row in rows for file in self._contents(index, row))
        return is_shard_of(self._shard(index), files)

    def moved(self, index: int, row: ManifestRow, put: Put) -> ManifestRow:
        """The row of a manipulator whose files go into a new shard, since the old one has not the same ones."""
        stored = [put(index, name, bytes(content)) for name, content in self._contents(index, row)]
        return {**row, "files": [{**file, **place} for file, place in zip(row["files"], stored, strict=False)]}

    def has_mesh(self, path: str, digest: str) -> bool:
        """Whether the copy of a mesh is there, with its bytes; many robots share it, and it is read once."""
        if path not in self._meshes:
            try:
                self._meshes[path] = sha256(self._store.read(path)).hexdigest()
            except OutputError:
                self._meshes[path] = ""
        return self._meshes[path] == digest

    def _contents(self, index: int, row: ManifestRow) -> Iterator[tuple[str, memoryview]]:
        """The files of a manipulator, then its pictures, with their names.

        Raises:
            OutputError: one is not there.
            KeyError: a picture is not in its shard.
        """
        for file in row["files"]:
            if self._layout.is_whole:
                yield file["path"], memoryview(self._shard(index))[file["offset"] :][: file["bytes"]]
            else:
                yield file["path"], memoryview(self._store.read(file["path"]))
        for name in row.get("pictures", {}):
            if self._layout.is_whole:
                shard = self._layout.folder(index)
                if shard not in self._members:
                    self._members[shard] = members(self._shard(index))
                yield name, self._members[shard][name]
            else:
                yield name, memoryview(self._store.read(self._layout.path(index, name)))

    def _shard(self, index: int) -> bytes:
        """The earlier shard that a manipulator goes into; empty where there is none."""
        name = self._layout.folder(index)
        if name not in self._shards:
            try:
                self._shards[name] = self._store.read(name)
            except OutputError:
                self._shards[name] = b""
        return self._shards[name]
