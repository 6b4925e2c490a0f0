"""The reader `cisst`: one arm as a kinematic file of cisst and of the da Vinci Research Kit has it.

What the keys mean is taken from `robManipulator`, `robDH`, `robModifiedDH` and `robJoint` of cisst, which compute with
them, and from `ConfigureDH` of the research kit, which reads the base; the README has the addresses.
"""

from __future__ import annotations

import math
import re
import sys
from typing import TYPE_CHECKING

from dh2urdf.documents import Node, decoded, load_yaml, read_bytes
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.rotations import IDENTITY, RigidTransform, nearest_rotation
from dh2urdf.source import Problem, did_you_mean
from dh2urdf.stages import NoOptions, Reader

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

SUFFIX = ".cisst.json"
TYPES = {
    "revolute": JointType.REVOLUTE,
    "hinge": JointType.REVOLUTE,
    "prismatic": JointType.PRISMATIC,
    "slider": JointType.PRISMATIC,
}
MASSES = frozenset(
    ("mass", "cx", "cy", "cz", "Ixx", "Iyy", "Izz", *(f"{axis}{n}" for axis in "xyz" for n in (1, 2, 3)))
)
KEYS = ("name", "convention", "type", "mode", "alpha", "A", "theta", "D", "offset", "qmin", "qmax", "ftmax", "tmax")
RIGHT_ANGLE = 1.5708
"""What cisst takes for π/2 in an alpha, and only there [rad]."""
RIGID = 1e-4
"""How far the rotation in a matrix may be from being one: published files have four digits."""

# Files have comments, as JsonCpp lets them; YAML, of which JSON is a part, takes no tabs where JSON does.
_STRING_OR_NOT_JSON = re.compile(r'("(?:[^"\\]|\\.)*")|//[^\r\n]*|/\*.*?\*/|\t', re.DOTALL)


def read(path: Path, _options: NoOptions) -> Iterator[Manipulator]:
    """The arm of a file.

    Raises:
        TableError: the file is no JSON, or something in it cannot be read; all problems are reported at once.
    """
    text = decoded(read_bytes(path, TableError), str(path), TableError)
    root = load_yaml(_STRING_OR_NOT_JSON.sub(_blank, text), str(path), TableError)
    problems: list[Problem] = []
    arm = _File(root, problems).arm(path.name.removesuffix(SUFFIX).removesuffix(".json"))
    if problems or arm is None:
        raise TableError(problems)
    yield arm


def _blank(found: re.Match[str]) -> str:
    """A string as it is; of anything else only the lines, so that all that follows keeps its place."""
    return found[1] or re.sub(r"[^\r\n]", " ", found[0])


class _File:
    """What a file says; what is wrong with it is added to the problems."""

    def __init__(self, root: Node, problems: list[Problem]) -> None:
        self.root, self.problems = root, problems

    def arm(self, name: str) -> Manipulator | None:
        """The arm; None where there is no table at all."""
        top = self.entries(self.root, "the file")
        dh = top.get("DH", self.root)  # robManipulator is handed what stands under DH
        table = self.entries(dh, "DH") if "DH" in top else top
        joints = table.get("joints", table.get("links"))
        if joints is None or not isinstance(joints.value, list) or not joints.value:
            place = joints or dh
            self.refuse(place, "joints", f"{place.describe()} holds no joints", "a list `joints` or `links`")
            return None
        entries = [self.entries(joint, f"joint {number}") for number, joint in enumerate(joints.value, start=1)]
        convention = self.convention(table, entries, dh)
        rows = tuple(
            _Joint(self, number, node, entry).row()
            for number, (node, entry) in enumerate(zip(joints.value, entries, strict=True), start=1)
        )
        notices: tuple[Problem, ...] = ()
        if any(MASSES & entry.keys() for entry in entries):
            message = "the masses of the file are not read: those of the links' shapes take their place"
            notices = (Problem(message=message, severity="notice", mark=joints.mark),)
        return Manipulator(
            name=name,
            convention=convention,
            rows=rows,
            base=self.frame(top.get("base-offset"), "base-offset"),
            tool=self.frame(top.get("tooltip-offset"), "tooltip-offset"),
            mark=joints.mark,
            notices=notices,
        )

    def convention(self, table: dict[str, Node], joints: list[dict[str, Node]], place: Node) -> Convention:
        """The convention of the whole table; older files say it with each joint."""
        said = [entry["convention"] for entry in (table, *joints) if "convention" in entry]
        for node in said:
            if node.value not in tuple(Convention):
                self.refuse(node, "convention", f"{node.describe()} is no convention", " or ".join(Convention))
                return Convention.STANDARD
        if not said:
            self.refuse(place, "convention", "the file does not say its convention", " or ".join(Convention))
            return Convention.STANDARD
        for other in said[1:]:
            if other.value != said[0].value:
                self.refuse(other, "convention", "a table is written in one convention", str(said[0].value))
        return Convention(str(said[0].value))

    def frame(self, node: Node | None, name: str) -> RigidTransform:
        """The rigid transform of a 4x4 matrix; the identity where there is none."""
        if node is None:
            return IDENTITY
        rows = [row.value if isinstance(row.value, list) else [] for row in self.items(node)]
        numbers = [_number(entry) for row in rows for entry in row]
        if [len(row) for row in rows] != [4, 4, 4, 4] or None in numbers:
            self.refuse(node, name, f"{node.describe()} is no matrix", "four rows of four numbers")
            return IDENTITY
        a, b, c, x, d, e, f, y, g, h, i, z, *last = (number or 0.0 for number in numbers)
        rotation, deviation = nearest_rotation((a, b, c, d, e, f, g, h, i))
        if not deviation <= RIGID or last != [0.0, 0.0, 0.0, 1.0]:
            self.refuse(node, name, "the matrix is no rigid transform", "a rotation, a position, and 0 0 0 1 below")
            return IDENTITY
        return RigidTransform(rotation, (x, y, z))

    def entries(self, node: Node, what: str) -> dict[str, Node]:
        if isinstance(node.value, dict):
            return node.value
        self.refuse(node, None, f"{what} is {node.describe()}", "an object { … }")
        return {}

    @staticmethod
    def items(node: Node) -> list[Node]:
        return node.value if isinstance(node.value, list) else []

    def refuse(
        self, node: Node, field: str | None, message: str, accepted: str | None, joint: str | None = None
    ) -> None:
        self.problems.append(
            Problem(message=message, mark=node.mark, joint=joint, field=field, found=node.text, accepted=accepted)
        )


class _Joint:
    """One entry of ``joints``."""

    def __init__(self, file: _File, number: int, node: Node, entries: dict[str, Node]) -> None:
        self.file, self.number, self.node, self.entries = file, number, node, entries
        name = entries.get("name")
        self.name = str(name.text) if name and name.text else f"joint_{number}"

    def row(self) -> DHRow:
        """The row in SI units, in which these files are."""
        for key in self.entries:
            if key not in KEYS and key not in MASSES:
                self.refuse(key, f"no joint has the key {key!r}", did_you_mean(key, KEYS) or ", ".join(KEYS))
        alpha = self.number_of("alpha", needed=True)
        return DHRow(
            joint=self.name,
            link=f"link_{self.number}",
            type=self.type(),
            a=self.number_of("A", needed=True),
            alpha=math.copysign(math.pi / 2, alpha) if abs(alpha) == RIGHT_ANGLE else alpha,
            d=self.number_of("D", needed=True),
            theta=self.number_of("theta", needed=True),
            offset=self.number_of("offset"),
            limits=self.limits(),
            mark=self.node.mark,
        )

    def type(self) -> JointType:
        node = self.entries.get("type")
        kind = TYPES.get(str(node.value).lower()) if node else JointType.REVOLUTE
        if kind is None:
            self.refuse("type", "cisst computes with no such joint", ", ".join(TYPES))
        return kind or JointType.REVOLUTE

    def limits(self) -> Limits:
        """Of q; two zeros are what cisst has where a file says nothing."""
        lower, upper = self.number_of("qmin"), self.number_of("qmax")
        effort = self.number_of("ftmax") or self.number_of("tmax") or None
        if lower > upper:
            self.refuse("qmin", "it is larger than qmax", "a range of joint values")
            return Limits(effort=effort)
        return Limits(effort=effort) if lower == upper == 0 else Limits(lower=lower, upper=upper, effort=effort)

    def number_of(self, key: str, *, needed: bool = False) -> float:
        node = self.entries.get(key)
        if node is None:
            if needed:
                self.refuse(key, "it is missing", "a number, 0 included")
            return 0.0
        number = _number(node)
        if number is None:
            self.refuse(key, f"{node.describe()} is no number", "a number in m or rad")
        return number or 0.0

    def refuse(self, key: str, message: str, accepted: str) -> None:
        self.file.refuse(self.entries.get(key, self.node), key, message, accepted, self.name)


def _number(node: Node) -> float | None:
    """The finite number that a value is."""
    value = node.value
    if isinstance(value, bool) or not isinstance(value, (int, float)) or not abs(value) <= sys.float_info.max:
        return None
    return float(value)


READER = Reader(
    name="cisst",
    summary="kinematic files of cisst and of the da Vinci Research Kit (JSON)",
    read=read,
    options=NoOptions,
    suffixes=(SUFFIX,),
)
