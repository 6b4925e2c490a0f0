"""The files of earlier runs: whether they are still there, byte for byte, and how they get into a new shard."""

from __future__ import annotations

from contextlib import suppress
from hashlib import sha256
from typing import TYPE_CHECKING

from dh2urdf.errors import OutputError
from dh2urdf.output.shards import members

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.conversion.outcome import ManifestRow
    from dh2urdf.output.layouts import Destination, Layout
    from dh2urdf.output.store import Store
    from dh2urdf.results import FileEntry


class EarlierFiles:
    """What earlier runs have left of the files of a batch."""

    def __init__(self, store: Store, layout: Layout) -> None:
        """Takes the store, and how files lie in it."""
        self._store, self._layout = store, layout
        self._meshes: dict[str, str] = {}
        self._shards: dict[str, dict[str, bytes]] = {}

    def has(self, index: int, row: ManifestRow) -> bool:
        """Whether all files of a row are there, with the bytes that they were written with, and all pictures."""
        if not all(self.has_mesh(mesh["path"], mesh["sha256"]) for mesh in row.get("meshes", ())):
            return False
        pictures = _pictures(row)
        if self._layout.is_whole:
            old = self._members(index)
            contents = [old.get(file["path"]) for file in row["files"]]
            return _are_same(contents, row) and all(name in old for name in pictures)
        try:
            contents = [self._store.read(file["path"]) for file in row["files"]]
        except OutputError:
            return False
        return _are_same(contents, row) and all(self._store.size(self._layout.path(index, name)) for name in pictures)

    def are_all(self, index: int, rows: Iterable[ManifestRow]) -> bool:
        """Whether the files of these rows are all of the earlier shard that a manipulator goes into, in this order.

        One of a run with larger shards, or with more manipulators, has others behind them.
        """
        return list(self._members(index)) == [
            name for row in rows for name in (*(file["path"] for file in row["files"]), *_pictures(row))
        ]

    def moved(self, index: int, row: ManifestRow, target: Destination) -> ManifestRow:
        """The row of a manipulator whose files go into a new shard, since the old one has not the same ones."""
        old = self._members(index)
        files: list[FileEntry] = []
        for file in row["files"]:
            stored = target.put(index, file["path"], old[file["path"]])
            files.append({**file, **stored})
        for name in _pictures(row):
            target.put(index, name, old[name])
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

    def _members(self, index: int) -> dict[str, bytes]:
        """The files of the earlier shard that a manipulator goes into by their names, as far as it is whole."""
        name = self._layout.folder(index)
        if name not in self._shards:
            found = self._shards[name] = {}
            with suppress(OutputError), self._store.open(name) as shard:
                for member in members(shard):
                    found[member.name] = member.content
        return self._shards[name]


def _are_same(contents: list[bytes] | list[bytes | None], row: ManifestRow) -> bool:
    return bool(contents) and all(
        content is not None and sha256(content).hexdigest() == file["sha256"]
        for content, file in zip(contents, row["files"], strict=True)
    )


def _pictures(row: ManifestRow) -> list[str]:
    return [report["picture"] for report in row["loaders"].values() if report["picture"]]
