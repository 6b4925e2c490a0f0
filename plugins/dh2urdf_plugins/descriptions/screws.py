"""Screw axes as a robot description: files with Slist and M, Blist and M, or H and P.

    T(q) = exp([S_1] q_1) … exp([S_N] q_N) · M                        Slist: axes in the frame of the base
    T(q) = M · exp([B_1] q_1) … exp([B_N] q_N)                        Blist: axes in the frame of the tool
    T(q) = Tr(p_0) · Rot(h_1, q_1) · Tr(p_1) … Rot(h_N, q_N) · Tr(p_N) · R    H and P

Slist, Blist and M are those of K. Lynch and F. Park, Modern Robotics (2017), eqs. 4.14 and 4.16; H and P those of EAIK,
of ssik, and of the papers on subproblems. All frames of joints have the axes of one frame at q = 0, so that only shifts
are between them.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

from dh2urdf.columns import DYNAMICS
from dh2urdf.documents import Item, load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import ROOT, TOOL, JointType
from dh2urdf.quantities import Dimension
from dh2urdf.robot import Joint, Origin
from dh2urdf.rotations import IDENTITY, ZERO, RigidTransform, Vec3, add, cross, dot, norm, scale, subtract
from dh2urdf.source import Messages, Problem
from dh2urdf.stages import Rejected
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.descriptions.description import chain_description
from dh2urdf_plugins.formats.xml_files import LARGEST
from dh2urdf_plugins.readers.sources.documents import read_table
from dh2urdf_plugins.readers.statements.statements import Statements
from dh2urdf_plugins.readers.statements.values import (
    MORE_DIGITS,
    NEARLY_ORTHONORMAL,
    ORTHONORMAL,
    Values,
    refuse_unknown_keys,
)
from dh2urdf_plugins.readers.words.fields import joint_type

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.documents import Node
    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.descriptions.description import Description

say = Messages(__file__)

KEYS = ("name", "link", "type", "limits", *DYNAMICS)
"""Keys of a joint: those of a joint in a table that do not depend on its frame."""
FORMS = {"Slist": ("Slist", "M"), "Blist": ("Blist", "M"), "H": ("H", "P", "R")}
"""The keys of each form, by the one that it is known by."""
_EXAMPLE = "Slist, six rows and a column for each joint, and M; or Blist and M; or H and P"
_SCREW, _DIRECTION = 6, 3


class Axes(NamedTuple):
    """The axes of an arm at q = 0, all in one frame F."""

    directions: list[Vec3]  # of each joint, in F
    slides: list[bool]  # whether each joint slides
    places: list[Vec3]  # a point on each axis, in F [m]
    before: RigidTransform  # F in the frame of the base
    behind: RigidTransform  # the tip in F


def screws_description(path: Path) -> Description:
    """The description of a file of screw axes."""
    root = load_yaml(read_bytes(path, TableError, limit=LARGEST), str(path), TableError)
    file = _File(root)
    axes = file.axes()
    arm = file.arm(path.stem, axes.slides)
    start = RigidTransform(axes.before.rotation, (axes.before @ _shift(axes.places[0])).translation)
    origins = [start, *(_shift(subtract(there, here)) for here, there in pairwise(axes.places))]
    tip = RigidTransform(axes.behind.rotation, subtract(axes.behind.translation, axes.places[-1]))
    parents = [ROOT, *(row.link for row in arm.rows)]
    joints = [
        Joint(
            name=row.joint,
            type=row.type,
            parent=parent,
            child=row.link,
            origin=Origin.of(origin),
            axis=direction,
            limits=row.limits,
            mark=row.mark,
            **{name: getattr(row, name) for name in DYNAMICS},
        )
        for parent, row, origin, direction in zip(parents, arm.rows, origins, axes.directions, strict=False)
    ]
    fixed = Joint(name=f"{TOOL}_joint", type=JointType.FIXED, parent=parents[-1], child=TOOL, origin=Origin.of(tip))
    notices = [problem.about(mark=root.mark) for problem in (*file.problems, *arm.notices)]
    return chain_description(path, arm.name, [*joints, fixed], notices)


def _shift(by: Vec3) -> RigidTransform:
    return RigidTransform(IDENTITY.rotation, by)


def _items(node: Node | None) -> list[Node]:
    return node.value if node is not None and isinstance(node.value, list) else []


class _File:
    """A file that is being read; `problems` has its notices, and errors until `_check` raises them."""

    def __init__(self, root: Node) -> None:
        self.root, self.problems = root, list[Problem]()
        self.entries = root.value if isinstance(root.value, dict) else {}
        statements = Statements()
        if units := self.entries.get("units"):
            statements.declare_units(units, self.problems.append)
        self.values = Values(statements.units(), self.problems.append)

    def _check(self) -> None:
        errors = [problem for problem in self.problems if problem.severity == "error"]
        if errors:
            raise TableError(errors, [problem for problem in self.problems if problem.severity == "notice"])

    def _refuse(self, node: Node, field: str, code: str, **about: Any) -> NoReturn:  # noqa: ANN401 - of a message
        raise TableError(say(code, node.mark, field=field, found=node.text, **about))

    def axes(self) -> Axes:
        """The axes, in the one form that the file has."""
        found = [key for key in FORMS if key in self.entries]
        if len(found) != 1:
            field, code = (found[0], "axes-of-two-forms") if found else ("Slist", "no-axes")
            self._refuse(self.root, field, code, forms=" and ".join(found[:2]), accepted=_EXAMPLE)
        (form,) = found
        keys = FORMS[form]
        refuse_unknown_keys(self.root, ("name", "units", "joints", *keys), f"a file of {form}", self.problems.append)
        self._check()
        for key in keys:
            if key not in self.entries and key != "R":
                self._refuse(self.root, key, "screw-key-missing", accepted=_EXAMPLE)
        return self._by_steps() if form == "H" else self._by_points(form)

    def _by_points(self, form: str) -> Axes:
        """The axes of Slist or of Blist, by the points of them that are nearest to the frame they are in."""
        columns, pose = self._columns(form, _SCREW), self.values.read("placement", self.entries["M"], "M") or IDENTITY
        self._check()
        accepted = "ω of length 1, or ω = 0 and v of length 1 where the joint slides"
        screws: list[tuple[Vec3, Vec3, bool]] = []
        for number, column in enumerate(columns, start=1):
            omega = self._vector(form, column[:3], Dimension.NUMBER)
            turns = norm(omega) > ORTHONORMAL
            v = self._vector(form, column[3:], Dimension.LENGTH if turns else Dimension.NUMBER)
            self._check_unit(form, number, column[0], omega if turns else v, accepted)
            screws.append((omega, v, turns))
        size = max([norm(pose.translation), *(norm(v) for _, v, turns in screws if turns)])
        places: list[Vec3] = []
        for number, (omega, v, turns) in enumerate(screws, start=1):
            place = places[-1] if places else ZERO
            if turns:
                square = norm(omega) ** 2
                # Only a thread has a pitch [m/rad], but for what missing digits leave of it.
                node, pitch = columns[number - 1][0], dot(omega, v) / square
                if abs(pitch) > NEARLY_ORTHONORMAL * size:
                    self._refuse(node, form, "screw-of-thread", number=number, pitch=pitch)
                if abs(pitch) > ORTHONORMAL * size:
                    self.problems.append(say("pitch-left-out", node.mark, field=form, number=number, pitch=pitch))
                place = scale(1.0 / square, cross(omega, v))
            places.append(place)
        before, behind = (IDENTITY, pose) if form == "Slist" else (pose, IDENTITY)
        directions = [omega if turns else v for omega, v, turns in screws]
        return Axes(directions, [not turns for *_, turns in screws], places, before, behind)

    def _check_unit(self, form: str, number: int, node: Node, direction: Vec3, accepted: str) -> None:
        """Refuses a direction whose length is not 1 to four digits."""
        length = norm(direction)
        if abs(length * length - 1.0) > NEARLY_ORTHONORMAL:
            code = "screw-axis-length" if length else "screw-axis-0"
            advice = MORE_DIGITS if abs(length - 1.0) < 0.1 else None  # noqa: PLR2004 - as of a rotation that is rounded
            self._refuse(node, form, code, number=number, length=length, accepted=accepted, suggestion=advice)

    def _by_steps(self) -> Axes:
        """The axes of H, and the steps between them of P; R turns the tip."""
        columns, steps = self._columns("H", _DIRECTION), self._columns("P", _DIRECTION)
        if len(steps) != len(columns) + 1:
            counts = {"steps": len(steps), "axes": len(columns), "wanted": len(columns) + 1}
            self._refuse(self.entries["P"], "P", "steps-not-axes", **counts)
        turned = self._rotation()
        directions = [self._vector("H", column, Dimension.NUMBER) for column in columns]
        *places, tip = accumulate([self._vector("P", column, Dimension.LENGTH) for column in steps], add)
        self._check()
        for number, (column, direction) in enumerate(zip(columns, directions, strict=True), start=1):
            self._check_unit("H", number, column[0], direction, "a direction of length 1")
        named = _items(self.entries.get("joints"))
        words = [joint.value.get("type") if isinstance(joint.value, dict) else None for joint in named]
        slides = [word is not None and joint_type(word.text or "") is JointType.PRISMATIC for word in words]
        slides = [*slides, *[False] * len(directions)][: len(directions)]
        return Axes(directions, slides, places, IDENTITY, RigidTransform(turned.rotation, tip))

    def _rotation(self) -> RigidTransform:
        """R, read as the upper left part of a homogeneous matrix."""
        if (node := self.entries.get("R")) is None:
            return IDENTITY
        rows = _items(node)
        if [len(_items(row)) for row in rows] != [_DIRECTION] * _DIRECTION:
            self._refuse(node, "R", "screw-rotation-wrong", kind=node.describe())
        zero, one = (replace(node, value=number, text=str(number)) for number in (0, 1))
        wide = [replace(row, value=[*_items(row), zero]) for row in rows]
        matrix = replace(node, value=[*wide, replace(node, value=[zero, zero, zero, one])])
        return self.values.read("placement", matrix, "R") or IDENTITY

    def _columns(self, key: str, size: int) -> list[tuple[Node, ...]]:
        """The columns of a matrix of so many rows."""
        node = self.entries[key]
        rows = [_items(row) for row in _items(node)]
        widths = {len(row) for row in rows}
        accepted = f"{size} rows of numbers, as lists of one length, with a column for each joint"
        if len(widths) != 1 or 0 in widths:
            self._refuse(node, key, "screw-no-matrix", kind=node.describe(), accepted=accepted)
        (width,) = widths
        if len(rows) != size:
            advice = f"exchange rows and columns: {size} rows of {len(rows)} numbers" if width == size else None
            about = {"rows": len(rows), "width": width, "accepted": accepted, "suggestion": advice}
            self._refuse(node, key, "screw-matrix-shape", **about)
        return list(zip(*rows, strict=True))

    def _vector(self, key: str, nodes: Sequence[Node], dimension: Dimension) -> Vec3:
        x, y, z = (self.values.read("number", node, key, dimension) for node in nodes)
        self._check()
        return (x or 0.0, y or 0.0, z or 0.0)

    def arm(self, default_name: str, slides: Sequence[bool]) -> Manipulator:
        """A table with the arm's name, and a row for each joint whose numbers mean nothing."""
        node = self.entries.get("joints")
        joints = [replace(self.root, value={}) for _ in slides] if node is None else _items(node)
        if node is not None and len(joints) != len(slides):
            found = f"a list of {len(joints)}" if joints else node.describe()
            self._refuse(node, "joints", "joints-not-axes", what=found, count=len(slides), keys=KEYS)
        rows = [self._row(joint, is_sliding=is_sliding) for joint, is_sliding in zip(joints, slides, strict=True)]
        self._check()
        table = {key: self.entries[key] for key in ("name", "units") if key in self.entries} | {
            "convention": replace(self.root, value="standard", text="standard"),
            "joints": replace(self.root, value=rows),
        }
        arm = read_table(Item(replace(self.root, value=table)), default_name)
        if isinstance(arm, Rejected):
            raise TableError(arm.problems)
        for row, is_sliding in zip(arm.rows, slides, strict=True):
            if row.type is JointType.FIXED or (row.type is JointType.PRISMATIC) is not is_sliding:
                moves, accepted = ("slides", "prismatic") if is_sliding else ("turns", "revolute, continuous")
                about = {"joint_name": row.joint, "moves": moves, "accepted": accepted}
                raise TableError(say("type-not-of-axis", row.mark, field="type", found=row.type, **about))
        return arm

    def _row(self, node: Node, *, is_sliding: bool) -> Node:
        """A joint as the row of a table, all of whose numbers are 0; a text is its name."""
        entries = {"name": node} if node.text is not None else node.value
        if not isinstance(entries, dict):
            return node
        refuse_unknown_keys(replace(node, value=entries), KEYS, "a joint of screw axes", self.problems.append)
        zero, word = replace(node, value=0, text="0"), "prismatic" if is_sliding else "revolute"
        given = {"type": replace(node, value=word, text=word), **dict.fromkeys(REQUIRED, zero), **entries}
        return replace(node, value=given, text=None)
