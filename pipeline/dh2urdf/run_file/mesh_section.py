"""The section `meshes` of a run file: which mesh files the links of a manipulator are drawn and touched as.

It is for tables that cannot say it, such as CSV files. Its values for a joint override those of the table.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING, Any

from dh2urdf.cells.cell import SHOWN_NAMES
from dh2urdf.manipulator import Manipulator, MeshShape
from dh2urdf.meshes.files import find_mesh
from dh2urdf.rotations import RigidTransform
from dh2urdf.source import Mark, Messages, did_you_mean
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.documents.document import Node
    from dh2urdf.run_file.reading import Reading
    from dh2urdf.run_file.sections import MeshesSection, ShapesSection

say = Messages(__file__)


@dataclass(frozen=True, slots=True, kw_only=True)
class Shapes:
    """The meshes of one link: what it is seen as, where that is not left to the table, and what it touches with."""

    visual: MeshShape | None = None
    collision: MeshShape | None = None
    mark: Mark | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshCall:
    """The meshes of some manipulators, as a run file asks for them: of the base, and of the link that each joint moves.

    `of` names the manipulators; `*` stands for any text in it.
    """

    of: str
    base: Shapes = Shapes()
    joints: tuple[tuple[str, Shapes], ...] = ()
    mark: Mark | None = field(default=None, compare=False)

    def fits(self, name: str) -> bool:
        """Whether a manipulator of a name is meant."""
        return self.of == name or ("*" in self.of and fnmatchcase(name, self.of.replace("[", "[[]")))

    def given_to(self, manipulator: Manipulator) -> Manipulator | Rejected:
        """A manipulator with these meshes; why not, where it has no such joint."""
        names = [row.joint for row in manipulator.rows]
        problems = []
        for joint, shapes in self.joints:
            if joint not in names:
                about: Any = {"robot": manipulator.name, "field": "meshes", "found": joint, "table": manipulator.name}
                about |= {"names": names[:SHOWN_NAMES], "suggestion": did_you_mean(joint, names)}
                problems.append(say("mesh-joint-unknown", shapes.mark, **about))
        if problems:
            told = {"problems": tuple(problems), "notices": manipulator.notices}
            return Rejected(name=manipulator.name, mark=self.mark, **told)
        shapes_of = dict(self.joints)
        rows = []
        for row in manipulator.rows:
            own = shapes_of.get(row.joint, Shapes())
            rows.append(replace(row, visual=own.visual or row.visual, collision=own.collision or row.collision))
        return replace(
            manipulator,
            rows=tuple(rows),
            base_visual=self.base.visual or manipulator.base_visual,
            base_collision=self.base.collision or manipulator.base_collision,
        )


# --- What the section says --------------------------------------------------------------------------------------------


def read_meshes(entries: Iterable[tuple[Node, str]], to: Reading) -> tuple[MeshCall, ...]:
    """The meshes of manipulators, each in its node at its place."""
    from dh2urdf.run_file.sections import MeshesSection  # with pydantic, which a worker that has a plan needs not

    return tuple([call for call, _, _ in to.entries(entries, MeshesSection, _meshes)])


def _meshes(given: MeshesSection, node: Node, place: str, to: Reading) -> MeshCall:
    base = _shapes(given.base, node.entry("base"), f"{place}.base", to)
    joints, by_joint = [], node.entry("joints")
    for joint, shapes in (given.joints or {}).items():
        entry = by_joint.entry(joint) if by_joint else None
        read = _shapes(shapes, entry, f"{place}.joints.{joint}", to)
        joints.append((joint, replace(read, mark=by_joint.key_mark(joint) if by_joint else None)))
    return MeshCall(of=given.of, base=base, joints=tuple(joints), mark=(node.entry("of") or node).mark)


def _shapes(given: ShapesSection | None, node: Node | None, place: str, to: Reading) -> Shapes:
    """The meshes of a link: `mesh` is both."""
    made: dict[str, MeshShape] = {}
    for name in ("visual", "collision", "mesh") if given and node else ():
        mesh, entry = getattr(given, name), node.entry(name) if node else None
        file = entry.entry("file") if entry else None
        if mesh is None or file is None:
            continue
        with to.noting(file, f"{place}.{name}.file"):
            made[name] = MeshShape(
                file=find_mesh(mesh.file, to.folder_of(file), links=True),  # A run file is the user's own.
                pose=RigidTransform.from_xyz_rpy(mesh.xyz, mesh.rpy),
                scale=mesh.scale if isinstance(mesh.scale, tuple) else (mesh.scale,) * 3,
                mark=file.mark,
            )
    both = made.get("mesh")
    return Shapes(visual=made.get("visual", both), collision=made.get("collision", both))
