"""Reads the joints of many plain URDF files at once: the proof of every file of a long run.

An attribute stands between two quotes. Cut at its quotes, a file is a list of pieces, markup and values by turns, and
files whose pieces are the same bytes, but for the numbers in them, are the same tree with other numbers in it. So the
slow reader, `urdf_reader` beside this one, reads one file of each such *skeleton* and says what it means; of all others
the numbers are taken by their places. Nothing here comes from the emitter, and nothing is taken for granted of the form
that it gives to files: a file of any origin is read, or left to the slow reader.

What is read is what the slow reader would read, well-formedness included, since of every file it is checked that

- before the root there is nothing but an XML declaration of UTF-8 and a comment, both well-formed, and the first
  attribute of the root is its name, which is printable text without entities;
- after that, all bytes are those of a file that the slow reader has read, the names of links and joints included, but
  for the values of the attributes that URDF defines as numbers; in that file lxml has found the quotes around
  attributes, and nowhere else;
- each of these values has as many numbers as in that file, with one space between them, and each is a finite number as
  JSON writes it, whether the proof needs it or not.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from operator import itemgetter
from typing import TYPE_CHECKING, Any, TypeAlias

import orjson
from lxml import etree

from dh2urdf.errors import ProofError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.manipulator import Limits
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import ZERO
from dh2urdf_plugins.read_back.urdf_reader import parse_urdf

if TYPE_CHECKING:
    from collections.abc import Hashable, Sequence

_Values: TypeAlias = list[bytes]
"""The values of the attributes that follow the robot's name, in the order of the file."""
_Attribute: TypeAlias = tuple[str, str]
"""Tag and name of an attribute."""

# XML 1.0: prolog (22), XML declaration (23), comment (15), in which no `--` is, start tag (40).
_HEAD = re.compile(
    rb"""(?: <\?xml[ ]version="1\.0" (?:[ ]encoding="(?:UTF|utf)-8")? \?> )?
    [ \t\r\n]*+ (?: <!-- [^-]*+ (?:-[^-]++)*+ --> [ \t\r\n]*+ )?
    <robot[ ]name="( [^"<&\t\r\n]*+ )" """,
    re.VERBOSE,
)
_LINE_ENDS_AND_TABS = b"\t\r\n"

# The attributes of the URDF specification (wiki.ros.org/urdf/XML) that are numbers; the joints' first.
_NUMBERS: tuple[_Attribute, ...] = (
    ("origin", "xyz"),
    ("origin", "rpy"),
    ("axis", "xyz"),
    ("limit", "lower"),
    ("limit", "upper"),
    ("limit", "velocity"),
    ("limit", "effort"),
    ("dynamics", "damping"),
    ("dynamics", "friction"),
    ("mass", "value"),
    *(("inertia", name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")),
    ("box", "size"),
    ("cylinder", "radius"),
    ("cylinder", "length"),
    ("sphere", "radius"),
    ("mesh", "scale"),
    ("color", "rgba"),
)
_OF_JOINTS = _NUMBERS[:9]
_IN_NUMBERS = b"0123456789.eE+-"

_MOST_REMEMBERED = 1000
"""Layouts and skeletons that are remembered from call to call, some kilobytes each."""


@dataclass(frozen=True, slots=True, eq=False)
class _Joints:
    """The joints of files whose joints differ in numbers only.

    Attributes:
        robot: those of one of them, with the names of its links.
        places: for each joint, where among the numbers of a file those of its attributes begin.
    """

    robot: Robot
    places: tuple[dict[_Attribute, int], ...]

    def with_numbers(self, name: str, rows: Sequence[Sequence[float]]) -> Robot:
        """The joints with the numbers of many files, a row for each."""
        numbers = _columns(rows)
        joints = zip(self.robot.joints, self.places, strict=True)
        return replace(self.robot, name=name, joints=tuple([_with_numbers(*each, numbers) for each in joints]))


@dataclass(frozen=True, slots=True, eq=False)
class _Layout:
    """Which values of files with the same markup are words, and which are numbers.

    Attributes:
        words: picks the words.
        numbers: picks the numbers, those of joints first.
        of_joints: the places of the latter among the values.
        commas: how many are between the numbers, where none is in them.
        known: the joints of such files, and how many numbers they have, by the words and by what stands between the
            numbers.
    """

    words: Callable[[_Values], tuple[bytes, ...]]
    numbers: Callable[[_Values], tuple[bytes, ...]]
    of_joints: tuple[int, ...]
    commas: int
    known: dict[tuple[tuple[bytes, ...], bytes], tuple[_Joints, int]]


class _Scanner:
    """Reads files one by one, and remembers the skeletons that it has met.

    What it remembers makes it faster and changes nothing: a skeleton is the same, whichever of its files comes first.
    """

    def __init__(self) -> None:
        self._layouts: dict[bytes, _Layout] = {}
        self._joints: dict[Hashable, _Joints] = {}
        self.size = 0

    def scan(self, content: bytes) -> tuple[str, _Joints, list[float]] | None:
        """The robot's name, its joints and their numbers; None where the file is not plain."""
        head = _HEAD.match(content)
        if head is None or not _is_printable(head[0]):
            return None
        body = content[head.end() :]
        pieces = body.split(b'"')
        if len(pieces) % 2 == 0:
            return None
        markup, values = b'"'.join(pieces[::2]), pieces[1::2]
        layout = self._layouts.get(markup) or self._lay_out(markup, content, body)
        if layout is None:
            return None
        text = b",".join(layout.numbers(values))
        if text.count(b",") != layout.commas:
            return None
        try:
            numbers = orjson.loads(b"[%b]" % text.replace(b" ", b","))
        except orjson.JSONDecodeError:
            return None  # And nothing is learned from what is not written so: its spaces may mean something else.
        key = (layout.words(values), text.translate(None, _IN_NUMBERS))
        known = layout.known.get(key) or self._learn(key, layout, content, body)
        return known and (head[1].decode(), known[0], numbers[: known[1]])

    def _lay_out(self, markup: bytes, content: bytes, body: bytes) -> _Layout | None:
        attributes = _attributes(content, body)
        kinds = [(str(element.tag), name) for element, name in attributes]
        numbers = [index for index, kind in enumerate(kinds) if kind in _NUMBERS]
        words = [index for index, kind in enumerate(kinds) if kind not in _NUMBERS]
        if len(numbers) < 2 or len(words) < 2:  # noqa: PLR2004 - `itemgetter` gives a tuple from two on
            return None
        of_joints = [index for index in numbers if _is_of_joint(attributes[index][0])]
        others = [index for index in numbers if not _is_of_joint(attributes[index][0])]
        layout = _Layout(
            words=itemgetter(*words),
            numbers=itemgetter(*of_joints, *others),
            of_joints=tuple(of_joints),
            commas=len(numbers) - 1,
            known={},
        )
        self._layouts[markup] = layout
        self.size += 1
        return layout

    def _learn(
        self, key: tuple[tuple[bytes, ...], bytes], layout: _Layout, content: bytes, body: bytes
    ) -> tuple[_Joints, int] | None:
        try:
            robot = parse_urdf(content, "")
        except ProofError:
            return None
        attributes = _attributes(content, body)
        if not attributes:
            return None
        values = _values(body)
        starts: dict[tuple[etree._Element, str], int] = {}
        count = 0
        for index in layout.of_joints:
            starts[attributes[index]] = count
            count += len(values[index].split(b" "))
        root = attributes[0][0].getroottree().getroot()
        places = tuple([_places(element, starts) for element in root.iterchildren("joint")])
        joints = [replace(joint, mark=None) for joint in robot.joints]
        shape = [(j.name, j.type, j.parent, j.child, *where.items()) for j, where in zip(joints, places, strict=True)]
        names = tuple([link.name for link in robot.links])
        robot = Robot(name=robot.name, links=tuple(map(_frame, names)), joints=tuple(joints))
        found = self._joints.setdefault((names, *shape), _Joints(robot=robot, places=places))
        layout.known[key] = found, count
        self.size += 1
        return found, count


def _is_printable(head: bytes) -> bool:
    """Whether a text is UTF-8 without any character that XML cannot hold, or that nobody sees."""
    try:
        return head.translate(None, _LINE_ENDS_AND_TABS).decode().isprintable()
    except UnicodeDecodeError:
        return False


def _values(body: bytes) -> _Values:
    """What stands between the quotes."""
    return body.split(b'"')[1::2]


def _attributes(content: bytes, body: bytes) -> list[tuple[etree._Element, str]]:
    """The elements and the names of the attributes after the robot's name.

    None are given where lxml finds others than stand between the quotes: where a quote is not around an attribute, or a
    value holds an entity.
    """
    try:
        root = etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False))
    except etree.XMLSyntaxError:
        return []
    found = [(element, *item) for element in root.iter(etree.Element) for item in element.attrib.items()][1:]
    if b"'" in body or [value.encode() for _, _, value in found] != _values(body):
        return []
    return [(element, str(name)) for element, name, _ in found]


def _is_of_joint(element: etree._Element) -> bool:
    """Whether an element is what a joint of the robot declares itself."""
    joint = element.getparent()
    return joint is not None and joint.tag == "joint" and joint.getparent() is element.getroottree().getroot()


def _places(joint: etree._Element, starts: dict[tuple[etree._Element, str], int]) -> dict[_Attribute, int]:
    """Where the numbers of a joint's attributes begin; the first element of a tag is the one that is read."""
    found = {}
    for tag, name in _OF_JOINTS:
        element = joint.find(tag)
        if element is not None and (element, name) in starts and not (tag == "axis" and joint.get("type") == "fixed"):
            found[tag, name] = starts[element, name]
    return found


def _frame(name: str) -> Link:
    return Link(name=name)


def _columns(rows: Sequence[Sequence[float]]) -> list[Any]:
    """The columns of a table as `dh2urdf.columns` has them: a float where all rows have the same number."""
    import numpy as np

    table = np.array(rows, dtype=float).T.copy()
    alike = (table == table[:, :1]).all(axis=1)
    return [float(column[0]) if same else column for column, same in zip(table, alike, strict=True)]


def _with_numbers(joint: Joint, places: dict[_Attribute, int], numbers: Sequence[Any]) -> Joint:
    """A joint with other numbers in the place of those that its file says."""

    def number(tag: str, name: str) -> Any:  # noqa: ANN401 - a float or an array
        place = places.get((tag, name))
        return None if place is None else numbers[place]

    def vector(tag: str, name: str, default: Any) -> Any:  # noqa: ANN401 - three floats or arrays
        place = places.get((tag, name))
        return default if place is None else tuple(numbers[place : place + 3])

    return replace(
        joint,
        origin=Origin(xyz=vector("origin", "xyz", ZERO), rpy=vector("origin", "rpy", ZERO)),
        axis=vector("axis", "xyz", joint.axis),
        limits=Limits(**{name: number("limit", name) for name in ("lower", "upper", "velocity", "effort")}),
        damping=number("dynamics", "damping"),
        friction=number("dynamics", "friction"),
    )


_scanner = _Scanner()


def scan_columns(contents: Sequence[bytes]) -> list[tuple[list[int], Robot]]:
    """The joints of many URDF files, in groups whose members differ in numbers only.

    A file that is not surely read as `urdf_reader` reads it is in no group, whatever the others are.

    Args:
        contents: the files.

    Returns:
        For each group the places of its members among the files, and a robot with their joints, whose numbers are
        columns as in `dh2urdf.columns`, and the names of their links; its name is the first one's.
    """
    global _scanner  # noqa: PLW0603 - the skeletons are remembered from call to call
    if _scanner.size > _MOST_REMEMBERED:
        _scanner = _Scanner()
    groups: dict[_Joints, tuple[str, list[int], list[list[float]]]] = {}
    for index, content in enumerate(contents):
        if found := _scanner.scan(content):
            name, joints, numbers = found
            _, indices, rows = groups.setdefault(joints, (name, [], []))
            indices.append(index)
            rows.append(numbers)
    return [(indices, joints.with_numbers(name, rows)) for joints, (name, indices, rows) in groups.items()]
