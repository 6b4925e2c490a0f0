"""The mesh files that a table names for its links and its base."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import MeshShape
from dh2urdf.meshes import find_mesh
from dh2urdf.quantities import Dimension
from dh2urdf.rotations import IDENTITY, Vec3
from dh2urdf.source import Problem
from dh2urdf_plugins.readers.statements.placements import TransformReader

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from dh2urdf.documents import Node
    from dh2urdf_plugins.readers.words.cells import Units

MESH_KEYS = ("visual", "collision", "mesh")
"""Keys of a joint, and of the base, that hold meshes; `mesh` is both of the others."""

_KEYS = ("file", "scale")
ACCEPTED = "the path of a file, or {file: link.stl, xyz: [0, 0, 0], rpy: [0, 0, 0], scale: 0.001}"


class Meshes(NamedTuple):
    """What a link is seen as and what it touches with; None where the table leaves that to the transform."""

    visual: MeshShape | None = None
    collision: MeshShape | None = None


class MeshReader:
    """Reads meshes and hands over what is wrong with them."""

    def __init__(self, units: Units, add: Callable[[Problem], None], *, links: bool = False) -> None:
        """Takes the units of numbers, what is called with every problem, and whether links may leave the folder."""
        self._links = links
        self._placements = TransformReader(units, add)
        self._add = add

    def read(self, entries: Mapping[str, Node], prefix: str = "") -> Meshes:
        """The meshes among the entries of a joint or of the base.

        Args:
            entries: the entries.
            prefix: what stands before their names in messages.
        """
        found = {key: self._shape(entries[key], prefix + key) for key in MESH_KEYS if key in entries}
        both = found.get("mesh")
        return Meshes(found.get("visual") or both, found.get("collision") or both)

    def _shape(self, node: Node, field: str) -> MeshShape | None:
        if isinstance(node.value, str):
            return self._of_file(node, field)
        if not isinstance(node.value, dict) or "file" not in node.value:
            message = f"{field} has no file" if isinstance(node.value, dict) else f"{field} is {node.describe()}"
            self._error(node, field, message, ACCEPTED)
            return None
        pose = self._placements.read(node, field, other_keys=_KEYS)
        scale = self._scale(node.value.get("scale"), f"{field}.scale")
        shape = self._of_file(node.value["file"], f"{field}.file")
        return shape and replace(shape, pose=pose or IDENTITY, scale=scale)

    def _of_file(self, node: Node, field: str) -> MeshShape | None:
        if not node.text or not isinstance(node.value, str):
            self._error(node, field, f"{field} is {node.describe()}", "the path of a file")
            return None
        try:
            return MeshShape(file=find_mesh(node.text, Path(node.file).parent, links=self._links), mark=node.mark)
        except ConfigError as error:
            for problem in error.problems:
                self._add(replace(problem, mark=node.mark, field=field))
            return None

    def _scale(self, node: Node | None, field: str) -> Vec3:
        """One factor, or one for each axis."""
        if node is None:
            return (1.0, 1.0, 1.0)
        if isinstance(node.value, list):
            return self._placements.vector(node, field, Dimension.NUMBER) or (1.0, 1.0, 1.0)
        factor = self._placements.number(node, field, Dimension.NUMBER)
        return (1.0, 1.0, 1.0) if factor is None else (factor, factor, factor)

    def _error(self, node: Node, field: str, message: str, accepted: str) -> None:
        self._add(Problem(message=message, mark=node.mark, field=field, found=node.text, accepted=accepted))


def drawn_or_not(node: Node, field: str, add: Callable[[Problem], None]) -> bool | None:
    """What `visuals` or `collisions` of a table says."""
    if node.value in ("all", "none"):
        return node.value == "all"
    add(
        Problem(
            message=f"{field} is {node.describe()}",
            mark=node.mark,
            field=field,
            found=node.text,
            accepted="all, none",
        )
    )
    return None
