"""The section `meshes` of a run file: which mesh files the links of a manipulator are drawn and touched as.

It is for tables that cannot say it, such as CSV files. What it says of a joint holds before what the table says.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from dh2urdf.errors import ConfigError
from dh2urdf.manipulator import Manipulator, MeshShape
from dh2urdf.meshes.files import find_mesh
from dh2urdf.quantities.quantity import Dimension
from dh2urdf.rotations import RigidTransform, Vec3
from dh2urdf.run_file.placements import PlacementReader
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.documents.document import Node

SHAPE_KEYS = ("visual", "collision", "mesh")
MESH_KEYS = ("file", "xyz", "rpy", "scale")
ACCEPTED_MESH = "the path of a file, or {file: PATH, xyz: [0, 0, 0], rpy: [0, 0, 0], scale: 1}"
SHOWN = 20
"""Names that a message lists."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Shapes:
    """The meshes of one link.

    Attributes:
        visual: what it is seen as; None leaves that to the table.
        collision: what it touches with.
        mark: where its joint is named.
    """

    visual: MeshShape | None = None
    collision: MeshShape | None = None
    mark: Mark | None = field(default=None, compare=False)


@dataclass(frozen=True, slots=True, kw_only=True)
class MeshCall:
    """The meshes of some manipulators, as a run file asks for them.

    Attributes:
        of: name of the manipulators; `*` stands for any text in it.
        base: of the base.
        joints: of the link that each joint moves, by the joint's name.
        mark: where the manipulators are named.
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
        problems = [
            Problem(
                message=f"the table of {shown(manipulator.name)} has no joint {shown(joint)}",
                mark=shapes.mark,
                robot=manipulator.name,
                field="meshes",
                found=joint,
                accepted=", ".join(names[:SHOWN]),
                suggestion=did_you_mean(joint, names),
            )
            for joint, shapes in self.joints
            if joint not in names
        ]
        if problems:
            return Rejected(
                name=manipulator.name, problems=tuple(problems), mark=self.mark, notices=manipulator.notices
            )
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


class MeshGiver:
    """Gives the manipulators of a run their meshes, and knows whose were never seen."""

    def __init__(self, calls: Sequence[MeshCall]) -> None:
        self._waiting = dict(enumerate(calls))
        self._calls = calls
        self._names: list[str] = []

    def give(self, item: Manipulator | Rejected) -> Manipulator | Rejected:
        """What a reader gave, with its meshes."""
        for number, call in enumerate(self._calls):
            if call.fits(item.name):
                self._waiting.pop(number, None)
                if isinstance(item, Manipulator):
                    item = call.given_to(item)
        if self._waiting and len(self._names) < SHOWN:
            self._names.append(item.name)
        return item

    def left_over(self) -> Iterator[Rejected]:
        """Once all have been seen: the meshes that nobody has got."""
        for call in self._waiting.values():
            problem = Problem(
                message=f"the meshes of {shown(call.of)} are for no manipulator of the run",
                mark=call.mark,
                field="meshes",
                found=call.of,
                accepted=", ".join(self._names) or None,
                suggestion=did_you_mean(call.of, self._names),
            )
            yield Rejected(name=call.of, problems=(problem,), mark=call.mark)


class MeshesReader(PlacementReader):
    """Reads the meshes of a run file and gathers what is wrong with them."""

    def __init__(self, problems: list[Problem], folder: Path) -> None:
        """Takes the list of problems, and the folder of the run file, from which paths lead."""
        super().__init__(problems)
        self._folder = folder

    def read(self, section: Node) -> tuple[MeshCall, ...]:
        """The meshes that nothing is wrong with."""
        entries = section.value if isinstance(section.value, list) else []
        calls = [self._call(node, f"meshes.{index}") for index, node in enumerate(entries)]
        return tuple([call for call in calls if call])

    def _call(self, node: Node, field: str) -> MeshCall | None:
        before = len(self.problems)
        if isinstance(node.value, dict) and "convert" in node.value:
            message = "this section says which meshes links have; what becomes of them is said of the output"
            accepted = "output: {meshes: {convert: …}}"
            self.say(message, node, f"{field}.convert", mark=node.key_mark("convert"), accepted=accepted)
            return None
        given = self.entries(node, ("of", "base", "joints"), field)
        of = self.name(given.get("of"), f"{field}.of")
        if "of" not in given and isinstance(node.value, dict):
            accepted = "`of: NAME`, the name of a manipulator of this run; `*` stands for any text"
            self.say("it is not said whose meshes these are", node, f"{field}.of", accepted=accepted)
        base = self._shapes(given["base"], f"{field}.base") if "base" in given else Shapes()
        joints: list[tuple[str, Shapes]] = []
        if (named := given.get("joints")) is not None:
            if not isinstance(named.value, dict):
                accepted = "{JOINT: {visual: FILE, collision: FILE}}"
                self.say(f"this cannot be {named.describe()}", named, f"{field}.joints", accepted=accepted)
            else:
                for joint, entry in named.value.items():
                    shapes = self._shapes(entry, f"{field}.joints.{joint}")
                    joints.append((joint, replace(shapes, mark=named.key_mark(joint))))
        if len(self.problems) > before or of is None:
            return None
        return MeshCall(of=of, base=base, joints=tuple(joints), mark=given["of"].mark)

    def _shapes(self, node: Node, field: str) -> Shapes:
        """The meshes of a link: `mesh` is both."""
        given = self.entries(node, SHAPE_KEYS, field)
        found = {key: self._mesh(given[key], f"{field}.{key}") for key in SHAPE_KEYS if key in given}
        both = found.get("mesh")
        return Shapes(visual=found.get("visual") or both, collision=found.get("collision") or both)

    def _mesh(self, node: Node, field: str) -> MeshShape | None:
        given = {"file": node} if isinstance(node.value, str) else self.entries(node, MESH_KEYS, field)
        if "file" not in given and isinstance(node.value, dict):
            self.say("this mesh has no file", node, field, accepted=ACCEPTED_MESH)
        text = self.name(given.get("file"), f"{field}.file")
        pose = RigidTransform.from_xyz_rpy(
            self.vector(given.get("xyz"), f"{field}.xyz", Dimension.LENGTH),
            self.vector(given.get("rpy"), f"{field}.rpy", Dimension.ANGLE),
        )
        scale = self._scale(given.get("scale"), f"{field}.scale")
        if text is None:
            return None
        try:
            file = find_mesh(text, self._folder, links=True)  # A run file is the user's own.
        except ConfigError as error:
            mark = given["file"].mark
            self.problems.extend(replace(problem, mark=mark, field=f"{field}.file") for problem in error.problems)
            return None
        return MeshShape(file=file, pose=pose, scale=scale, mark=given["file"].mark)

    def _scale(self, node: Node | None, field: str) -> Vec3:
        """One factor, or one for each axis."""
        if node is None:
            return (1.0, 1.0, 1.0)
        if isinstance(node.value, list):
            return self.vector(node, field, Dimension.NUMBER)
        factor = self.number(node, field, Dimension.NUMBER)
        return (factor, factor, factor)
