"""Copies of mesh files beside the descriptions that name them: each once, however many robots share it."""

from __future__ import annotations

import os
import tempfile
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from dh2urdf.meshes.files import copy_name, copy_path, mesh_files, read_mesh

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.manipulator import MeshFile
    from dh2urdf.output.store import Store
    from dh2urdf.robot import Robot
    from dh2urdf.running.earlier_files import EarlierFiles


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
