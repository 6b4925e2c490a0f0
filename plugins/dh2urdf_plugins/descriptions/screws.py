"""Screw axes as a robot description: files with Slist and M, Blist and M, or H and P.

    T(q) = exp([S_1] q_1) … exp([S_N] q_N) · M                        Slist: axes in the frame of the base
    T(q) = M · exp([B_1] q_1) … exp([B_N] q_N)                        Blist: axes in the frame of the tool
    T(q) = Tr(p_0) · Rot(h_1, q_1) · Tr(p_1) … Rot(h_N, q_N) · Tr(p_N) · R    H and P

Slist, Blist and M are those of K. Lynch and F. Park, Modern Robotics (2017), eqs. 4.14 and 4.16; H and P those of EAIK,
of ssik, and of the papers on subproblems. All frames of joints have the axes of one frame at q = 0, so that only shifts
are between them.

The joints of a file of screw axes: names, types and limits, as the reader of YAML tables reads them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.documents import Item, load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import ROOT, TOOL, JointType
from dh2urdf.quantities import Dimension
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import IDENTITY, ZERO, RigidTransform, Vec3, cross, norm, scale, subtract
from dh2urdf.source import Problem, shown
from dh2urdf.stages import Rejected
from dh2urdf.table_text import REQUIRED
from dh2urdf_plugins.descriptions.description import Description
from dh2urdf_plugins.read_back.xml_files import LARGEST
from dh2urdf_plugins.readers.statements.placements import NEARLY_ORTHONORMAL, ORTHONORMAL, TransformReader
from dh2urdf_plugins.readers.statements.shapes import refuse_unknown_keys
from dh2urdf_plugins.readers.statements.statements import Statements
from dh2urdf_plugins.readers.words.fields import joint_type
from dh2urdf_plugins.readers.yaml_file.reading import read_table

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from dh2urdf.documents import Node
    from dh2urdf.manipulator import DHRow


KEYS = ("name", "link", "type", "limits", "damping", "friction", "armature")
"""Keys of a joint: those of a joint in a table that do not depend on its frame."""
_OF_TABLE = ("name", "units")


def is_said_to_slide(root: Node, number: int) -> bool:
    """Whether the file declares a joint as prismatic."""
    entries = root.value if isinstance(root.value, dict) else {}
    joints = entries.get("joints")
    listed = joints.value if joints is not None and isinstance(joints.value, list) else []
    joint = listed[number].value if number < len(listed) else None
    word = joint.get("type") if isinstance(joint, dict) else None
    return word is not None and joint_type(word.text or "") is JointType.PRISMATIC


def read_joints(
    root: Node, default_name: str, slides: Sequence[bool], add: Callable[[Problem], None]
) -> tuple[str, tuple[DHRow, ...]]:
    """The arm's name, and a row for each joint whose numbers mean nothing.

    Args:
        root: the file.
        default_name: the arm's name where the file has none.
        slides: whether each joint slides.
        add: takes what is wrong, and notices; there are no rows where something is wrong.
    """
    entries = root.value if isinstance(root.value, dict) else {}
    joints = entries.get("joints")
    count = len(slides)
    listed = [replace(root, value={}) for _ in slides]
    if joints is not None:
        listed = joints.value if isinstance(joints.value, list) else []
        if len(listed) != count:
            found = f"a list of {len(listed)}" if listed else joints.describe()
            message = f"joints is {found}, and there are {count} axes"
            accepted = f"a list of {count} names, or of {count} mappings with {', '.join(KEYS)}"
            add(Problem(message=message, mark=joints.mark, field="joints", found=joints.text, accepted=accepted))
            return "", ()
    rows = [_row(node, add, is_sliding=is_sliding) for node, is_sliding in zip(listed, slides, strict=True)]
    table = {key: entries[key] for key in _OF_TABLE if key in entries} | {
        "convention": replace(root, value="standard", text="standard"),
        "joints": replace(root, value=rows),
    }
    arm = read_table(Item(replace(root, value=table)), default_name)
    if isinstance(arm, Rejected):
        for problem in arm.problems:
            add(problem)
        return "", ()
    for notice in arm.notices:
        add(notice)
    for row, is_sliding in zip(arm.rows, slides, strict=True):
        _check_type(row, add, is_sliding=is_sliding)
    return arm.name, arm.rows


def _row(node: Node, add: Callable[[Problem], None], *, is_sliding: bool) -> Node:
    """A joint as the row of a table, all of whose numbers are 0; a text is its name."""
    entries = {"name": node} if node.text is not None else node.value
    if not isinstance(entries, dict):
        return node
    refuse_unknown_keys(replace(node, value=entries), KEYS, "a joint of screw axes", add)
    zero = replace(node, value=0, text="0")
    word = "prismatic" if is_sliding else "revolute"
    given = {"type": replace(node, value=word, text=word), **dict.fromkeys(REQUIRED, zero), **entries}
    return replace(node, value=given, text=None)


def _check_type(row: DHRow, add: Callable[[Problem], None], *, is_sliding: bool) -> None:
    if row.type is JointType.FIXED or (row.type is JointType.PRISMATIC) is not is_sliding:
        add(
            Problem(
                message=f"joint {shown(row.joint)} is {row.type}, and its axis is that of a joint that "
                f"{'slides' if is_sliding else 'turns'}",
                mark=row.mark,
                joint=row.joint,
                field="type",
                found=row.type,
                accepted="prismatic" if is_sliding else "revolute, continuous",
            )
        )


FORMS = {"Slist": ("Slist", "M"), "Blist": ("Blist", "M"), "H": ("H", "P", "R")}
"""The keys of each form, by the one that it is known by."""
_STATED = ("name", "units", "joints")
_EXAMPLE = "Slist, six rows and a column for each joint, and M; or Blist and M; or H and P"
_SCREW, _DIRECTION = 6, 3
_AXIS = "ω of length 1, or ω = 0 and v of length 1 where the joint slides"


class Screw(NamedTuple):
    """A column of Slist or Blist.

    Attributes:
        omega: the direction of an axis of rotation, or 0.
        v: the velocity of the frame's origin [m/rad]; the direction of the motion where omega is 0.
    """

    omega: Vec3
    v: Vec3

    @property
    def turns(self) -> bool:
        """Whether the joint turns."""
        return norm(self.omega) > ORTHONORMAL

    @property
    def pitch(self) -> float:
        """The motion along an axis of rotation [m/rad]."""
        x, y, z = (one * other for one, other in zip(self.omega, self.v, strict=True))
        return (x + y + z) / norm(self.omega) ** 2

    @property
    def point(self) -> Vec3:
        """The point of an axis of rotation that is nearest to the frame's origin [m]."""
        return scale(1.0 / norm(self.omega) ** 2, cross(self.omega, self.v))


@dataclass(frozen=True, slots=True)
class Axes:
    """The axes of an arm at q = 0, all in axes of one frame.

    Attributes:
        directions: of each joint.
        slides: whether each joint slides.
        first: from the base to the first joint's frame, which is turned as all others are.
        shifts: from each joint's frame to the next one's [m].
        last: from the last joint's frame to the tip.
    """

    directions: tuple[Vec3, ...]
    slides: tuple[bool, ...]
    first: RigidTransform
    shifts: tuple[Vec3, ...]
    last: RigidTransform


def screws_description(path: Path) -> Description:
    """The description of a file of screw axes.

    Raises:
        TableError: the file cannot be read, or its axes are none of an arm.
    """
    root = load_yaml(read_bytes(path, TableError, limit=LARGEST), str(path), TableError)
    if not isinstance(root.value, dict):
        message = f"the file is {root.describe()}"
        raise TableError(Problem(message=message, mark=root.mark, accepted=f"a mapping with {_EXAMPLE}"))
    return _File(root, path).description()


class _File:
    """A file that is being read."""

    def __init__(self, root: Node, path: Path) -> None:
        self.root, self.path = root, path
        self.entries = root.value if isinstance(root.value, dict) else {}
        self.problems: list[Problem] = []
        statements = Statements()
        if units := self.entries.get("units"):
            statements.declare_units(units, self.problems.append)
        self.transforms = TransformReader(statements.units(), self.problems.append)

    def description(self) -> Description:
        """The description, if nothing is wrong with the file."""
        form = self._form()
        if form is None:
            raise self._refused()
        axes = self._by_points(form) if "M" in FORMS[form] else self._by_steps()
        name, rows = (
            ("", ()) if axes is None else read_joints(self.root, self.path.stem, axes.slides, self.problems.append)
        )
        if axes is None or self._has_errors():
            raise self._refused()
        links = [ROOT, *(row.link for row in rows), TOOL]
        origins = [axes.first, *(RigidTransform(IDENTITY.rotation, shift) for shift in axes.shifts)]
        joints = [
            Joint(
                name=row.joint,
                type=row.type,
                parent=parent,
                child=row.link,
                origin=Origin.of(origin),
                axis=direction,
                limits=row.limits,
                damping=row.damping,
                friction=row.friction,
                armature=row.armature,
                mark=row.mark,
            )
            for parent, row, origin, direction in zip(links, rows, origins, axes.directions, strict=False)
        ]
        tip = Origin.of(axes.last)
        joints.append(Joint(name=f"{TOOL}_joint", type=JointType.FIXED, parent=links[-2], child=TOOL, origin=tip))
        return Description(
            robot=Robot(name=name, links=tuple(Link(name=link) for link in links), joints=tuple(joints)),
            file=str(self.path),
            folder=self.path.absolute().parent,
            notices=tuple(problem.about(mark=self.root.mark) for problem in self.problems),
        )

    def _refused(self) -> TableError:
        errors, notices = (
            [problem for problem in self.problems if problem.severity == severity] for severity in ("error", "notice")
        )
        return TableError(errors, notices)

    def _has_errors(self) -> bool:
        return any(problem.severity == "error" for problem in self.problems)

    def _error(
        self,
        node: Node,
        field: str,
        message: str,
        *,
        accepted: str,
        suggestion: str | None = None,
    ) -> None:
        self.problems.append(
            Problem(
                message=message,
                mark=node.mark,
                field=field,
                found=node.text,
                accepted=accepted,
                suggestion=suggestion,
            )
        )

    def _form(self) -> str | None:
        """Which axes the file has; None where it has none, or two kinds."""
        found = [key for key in FORMS if key in self.entries]
        keys = (
            FORMS[found[0]] if len(found) == 1 else tuple(dict.fromkeys(key for form in FORMS.values() for key in form))
        )
        refuse_unknown_keys(
            self.root,
            (*_STATED, *keys),
            f"a file of {found[0]}" if found else "a file of screw axes",
            self.problems.append,
        )
        if len(found) != 1:
            message = f"it has {found[0]} and {found[1]}" if found else "there are no axes in it"
            self._error(self.root, found[0] if found else "Slist", message, accepted=_EXAMPLE)
            return None
        for key in keys:
            if key not in self.entries and key != "R":
                self._error(self.root, key, f"there is no key {key}", accepted=_EXAMPLE)
        return None if self._has_errors() else found[0]

    # --- Slist and Blist ----------------------------------------------------------------------------------------------

    def _by_points(self, form: str) -> Axes | None:
        """The axes of Slist or of Blist, by the points of them that are nearest to the frame they are in."""
        columns = self._columns(form, _SCREW)
        pose = self.transforms.read(self.entries["M"], "M")
        if columns is None or pose is None:
            return None
        screws = [self._screw(form, number, column) for number, column in enumerate(columns, start=1)]
        found = [screw for screw in screws if screw is not None]
        size = max([norm(pose.translation), *(norm(screw.v) for screw in found if screw.turns)])
        for number, screw in enumerate(screws, start=1):
            if screw is not None and screw.turns:
                self._check_pitch(form, number, columns[number - 1][0], screw.pitch, size)
        if len(found) < len(screws) or self._has_errors():
            self._advise_to_transpose(form, columns)
            return None
        first, last = (IDENTITY, pose) if form == "Slist" else (pose, IDENTITY)
        places: list[Vec3] = []
        for screw in found:
            places.append(screw.point if screw.turns else places[-1] if places else ZERO)
        return Axes(
            directions=tuple(screw.omega if screw.turns else screw.v for screw in found),
            slides=tuple(not screw.turns for screw in found),
            first=RigidTransform(first.rotation, (first @ RigidTransform(IDENTITY.rotation, places[0])).translation),
            shifts=tuple(subtract(there, here) for here, there in pairwise(places)),
            last=RigidTransform(last.rotation, subtract(last.translation, places[-1])),
        )

    def _screw(self, form: str, number: int, column: Sequence[Node]) -> Screw | None:
        """What a column means; None where it is no axis, or holds what is no number."""
        omega = self._numbers(form, column[:3], Dimension.NUMBER)
        if omega is None:
            return None
        turns = Screw(omega, ZERO).turns
        v = self._numbers(form, column[3:], Dimension.LENGTH if turns else Dimension.NUMBER)
        if v is None or not self._is_unit(form, number, column[0], omega if turns else v):
            return None
        return Screw(omega, v)

    def _check_pitch(self, form: str, number: int, node: Node, pitch: float, size: float) -> None:
        """Refuses a thread; what digits that are missing leave of one is left out."""
        if abs(pitch) > NEARLY_ORTHONORMAL * size:
            self._error(
                node,
                form,
                f"column {number} of {form} is the screw of a thread: it moves {pitch:.4g} m along it for each rad",
                accepted="v perpendicular to ω: v = −ω × (a point on the axis)",
            )
        elif abs(pitch) > ORTHONORMAL * size:
            message = f"column {number} of {form} has a pitch of {pitch:.2g} m/rad, which is left out"
            self.problems.append(Problem(message=message, severity="notice", mark=node.mark, field=form))

    def _is_unit(self, form: str, number: int, node: Node, direction: Vec3) -> bool:
        """Whether a direction has the length 1, to four digits."""
        length = norm(direction)
        if abs(length * length - 1.0) <= NEARLY_ORTHONORMAL:
            return True
        self._error(
            node,
            form,
            f"column {number} of {form} has an axis of the length {length:.6g}"
            if length
            else f"column {number} of {form} is 0: nothing moves",
            accepted=_AXIS if form != "H" else "a direction of length 1",
            suggestion="write its elements with more digits, or as expressions such as sqrt(2)/2"
            if abs(length - 1.0) < 0.1  # noqa: PLR2004 - as of a rotation that is rounded
            else None,
        )
        return False

    def _advise_to_transpose(self, form: str, columns: Sequence[Sequence[Node]]) -> None:
        """Where the rows of a square list are screws, and its columns are none, that is what is wrong with it."""
        others = _File(self.root, self.path)  # its problems are those of nobody
        rows = enumerate(zip(*columns, strict=True), start=1)
        if len(columns) == _SCREW and all(others._screw(form, number, row) for number, row in rows):
            self.problems = [problem for problem in self.problems if problem.field != form]
            self._transposed(form, _SCREW, _SCREW)

    def _transposed(self, key: str, rows: int, joints: int) -> None:
        self._error(
            self.entries[key],
            key,
            f"{key} has a row for each joint",
            accepted=f"{rows} rows, and a column for each joint",
            suggestion=f"exchange rows and columns: {rows} rows of {joints} numbers",
        )

    # --- H and P ------------------------------------------------------------------------------------------------------

    def _by_steps(self) -> Axes | None:
        """The axes of H, and the steps between them of P; R turns the tip."""
        columns, steps = self._columns("H", _DIRECTION), self._columns("P", _DIRECTION)
        turned = self._turn()
        if columns is None or steps is None or turned is None:
            return None
        if len(steps) != len(columns) + 1:
            self._error(
                self.entries["P"],
                "P",
                f"P has {len(steps)} columns, and H has {len(columns)}",
                accepted=f"{len(columns) + 1} columns in P: from the base to joint 1, between joints, to the tool",
            )
            return None
        directions = [self._numbers("H", column, Dimension.NUMBER) for column in columns]
        shifts = [self._numbers("P", column, Dimension.LENGTH) for column in steps]
        found = [each for each in directions if each is not None]
        lengths = [each for each in shifts if each is not None]
        if len(found) < len(directions) or len(lengths) < len(shifts):
            return None
        if not all(self._is_unit("H", number, columns[number - 1][0], each) for number, each in enumerate(found, 1)):
            return None
        return Axes(
            directions=tuple(found),
            slides=tuple(is_said_to_slide(self.root, number) for number in range(len(found))),
            first=RigidTransform(IDENTITY.rotation, lengths[0]),
            shifts=tuple(lengths[1:-1]),
            last=RigidTransform(turned.rotation, lengths[-1]),
        )

    def _turn(self) -> RigidTransform | None:
        """The rotation from the last joint to the tip."""
        node = self.entries.get("R")
        if node is None:
            return IDENTITY
        rows = node.value if isinstance(node.value, list) else []
        if [len(row.value) if isinstance(row.value, list) else 0 for row in rows] != [_DIRECTION] * _DIRECTION:
            self._error(node, "R", f"R is {node.describe()}", accepted="a rotation as three rows of three numbers")
            return None
        zero, one = (replace(node, value=number, text=str(number)) for number in (0, 1))
        wide = [replace(row, value=[*(row.value if isinstance(row.value, list) else ()), zero]) for row in rows]
        last = replace(node, value=[zero, zero, zero, one])
        return self.transforms.read(replace(node, value=[*wide, last]), "R")

    # --- Numbers ------------------------------------------------------------------------------------------------------

    def _columns(self, key: str, size: int) -> list[list[Node]] | None:
        """The columns of a matrix of so many rows."""
        node = self.entries[key]
        rows = node.value if isinstance(node.value, list) else []
        widths = {len(row.value) if isinstance(row.value, list) else 0 for row in rows}
        accepted = f"{size} rows of numbers, as lists of one length, with a column for each joint"
        if len(widths) != 1 or 0 in widths:
            self._error(node, key, f"{key} is no matrix: it is {node.describe()}", accepted=accepted)
            return None
        (width,) = widths
        if len(rows) != size and width == size:
            self._transposed(key, size, len(rows))
            return None
        if len(rows) != size:
            self._error(node, key, f"{key} has {len(rows)} rows of {width} numbers", accepted=accepted)
            return None
        return [
            list(column) for column in zip(*(row.value for row in rows if isinstance(row.value, list)), strict=True)
        ]

    def _numbers(self, key: str, nodes: Sequence[Node], dimension: Dimension) -> Vec3 | None:
        x, y, z = (self.transforms.number(node, key, dimension) for node in nodes)
        return None if x is None or y is None or z is None else (x, y, z)
