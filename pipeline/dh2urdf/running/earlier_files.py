"""The files of earlier runs, whether they are there byte for byte; and copies of meshes, each written once."""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.errors import OutputError
from dh2urdf.meshes.files import copy_name, copy_path, mesh_files, read_mesh
from dh2urdf.output.layouts import is_shard_of, members

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.conversion.outcome import ManifestRow
    from dh2urdf.manipulator import MeshFile
    from dh2urdf.output.layouts import Layout, Put
    from dh2urdf.output.store import Store
    from dh2urdf.robot import Robot


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


class MeshCopies:
    """The copies of meshes that the robots of a batch need.

    Several workers may write one copy at the same time: they write the same bytes, and a store replaces a file at once.
    """

    def __init__(self, store: Store, earlier: EarlierFiles, prefix: str | None) -> None:
        """Takes where copies go, what is there already, and what descriptions write before their names."""
        self._store, self._earlier, self._prefix = store, earlier, prefix
        self._there: set[MeshFile] = set()

    def of(self, robot: Robot) -> tuple[MeshFile, ...]:
        """The meshes of a robot that its descriptions name by their copies."""
        return () if self._prefix is None else mesh_files(robot)

    def put(self, files: Iterable[MeshFile]) -> None:
        """Put copies in their place, where they are not there already.

        Raises:
            OutputError: a mesh cannot be read any more, or a copy cannot be written.
        """
        for file in files:
            if file not in self._there and not self._earlier.has_mesh(copy_path(file), file.sha256):
                self._store.write(copy_path(file), read_mesh(file))
            self._there.add(file)

    @contextmanager
    def workplace(self, robot: Robot, *, loads: bool) -> Iterator[Path]:
        """A folder for the files of a robot in the making, in which simulators, if any, find its meshes."""
        if loads and self._prefix is not None and mesh_files(robot):
            with tempfile.TemporaryDirectory(prefix="dh2urdf-") as top:
                yield lay_out(Path(top), robot, self._prefix)
        else:
            with self._store.scratch() as folder:
                yield folder


def lay_out(top: Path, robot: Robot, prefix: str) -> Path:
    """Copy the meshes of a robot into a folder, as they will lie in the output.

    Args:
        top: an empty folder.
        robot: the robot.
        prefix: what descriptions write before the names of copies.

    Returns:
        The folder in which a description of the robot finds them. (That a package is beside or above a
        description that names it is how PyBullet finds packages.)
    """
    package = prefix.removeprefix("package://")
    folder = top / "descriptions"
    target = top / package if package != prefix else Path(os.path.normpath(folder / prefix))
    for each in (folder, target):
        each.mkdir(parents=True, exist_ok=True)
    for file in mesh_files(robot):
        (target / copy_name(file)).write_bytes(read_mesh(file))
    return folder
