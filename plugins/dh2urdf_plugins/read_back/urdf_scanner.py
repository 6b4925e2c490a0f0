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
from dataclasses import field, replace
from itertools import chain
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.errors import ProofError
from dh2urdf.late_dataclasses import dataclass
from dh2urdf.late_tuples import NamedTuple
from dh2urdf.robot import Link, Robot
from dh2urdf_plugins.read_back.urdf_forms import (
    Attribute,
    Form,
    Joints,
    Picker,
    Skeleton,
    between_numbers,
    numbers_in,
    picker,
)
from dh2urdf_plugins.read_back.urdf_reader import parse_urdf

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Iterator, Sequence

# XML 1.0: prolog (22), XML declaration (23), comment (15), in which no `--` is, start tag (40).
_HEAD = re.compile(
    rb"""(?: <\?xml[ ]version="1\.0" (?:[ ]encoding="(?:UTF|utf)-8")? \?> )?
    [ \t\r\n]*+ (?: <!-- [^-]*+ (?:-[^-]++)*+ --> [ \t\r\n]*+ )?
    <robot[ ]name="( [^"<&\t\r\n]*+ )" """,
    re.VERBOSE,
)
_LINE_ENDS_AND_TABS = b"\t\r\n"

# The attributes of the URDF specification (wiki.ros.org/urdf/XML) that are numbers; the joints' first.
_NUMBERS: tuple[Attribute, ...] = (
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

_FILES_AT_ONCE = 64
"""Files whose numbers are read in one call: so many that their texts stay in the processor's cache."""
_MOST_REMEMBERED = 1000
"""Layouts and skeletons that are remembered from call to call, some kilobytes each."""


@dataclass(frozen=True, slots=True, eq=False)
class _Layout:
    """Which values of files with the same markup are words, and which are numbers.

    Attributes:
        words: picks the words.
        numbers: picks the numbers, those of joints first.
        of_joints: the places of the numbers of joints among the values.
        others: the places of the other numbers.
        known: the skeletons of such files, by the words and by what stands between the numbers.
    """

    words: Picker
    numbers: Picker
    of_joints: tuple[int, ...]
    others: tuple[int, ...]
    known: dict[tuple[tuple[bytes, ...], bytes], Skeleton] = field(default_factory=dict)


class _Found(NamedTuple):
    """Files whose joints differ in numbers only.

    Attributes:
        joints: their joints.
        indices: which files they are.
        name: the robot's name in the first of them.
        table: the numbers of their joints, a row for each.
    """

    joints: Joints
    indices: list[int]
    name: str
    table: Any


def _together(form: Form, files: Sequence[tuple[int, str, bytes]]) -> Iterator[_Found]:
    """The joints of files of one form, given with their indices, names and numbers."""
    good, table = form.rows([text for _, _, text in files])
    if good:
        yield _Found(form.joints, [files[place][0] for place in good], files[good[0]][1], table)


class _Scanner:
    """Reads files, and remembers the skeletons that it has met.

    What it remembers makes it faster and changes nothing: a skeleton is the same, whichever of its files comes first.
    """

    def __init__(self) -> None:
        self._layouts: dict[bytes, _Layout] = {}
        self._joints: dict[Hashable, Joints] = {}
        self._last: list[Form] = []  # that of the last file that had one: often the next file has it too
        self._with_form: dict[tuple[int, ...], dict[Skeleton, Form]] = {}  # by the number of quotes about each link
        self.size = 0

    def scan(self, contents: Iterable[tuple[int, bytes]]) -> Iterator[_Found]:
        """The joints of files, given with their indices, that are plain."""
        import numpy as np

        alone: dict[Joints, list[tuple[int, str, list[float]]]] = {}
        waiting: dict[Form, list[tuple[int, str, bytes]]] = {}
        for index, content in contents:
            head = _HEAD.match(content)
            if head is None or not _is_printable(head[0]):
                continue
            for form in self._candidates(content):
                if (text := form.numbers(content, head.end())) is not None:
                    files = waiting.setdefault(form, [])
                    files.append((index, head[1].decode(), text))
                    if len(files) == _FILES_AT_ONCE:
                        yield from _together(form, waiting.pop(form))
                    self._last = [form]
                    break
            else:
                if found := self._one(content, head.end()):
                    alone.setdefault(found[0], []).append((index, head[1].decode(), found[1]))
        for joints, numbers in alone.items():
            indices, names, rows = zip(*numbers, strict=True)
            yield _Found(joints, list(indices), names[0], np.array(rows, dtype=float))
        for form, files in waiting.items():
            yield from _together(form, files)

    def _candidates(self, content: bytes) -> Iterator[Form]:
        """The forms that a file may have."""
        yield from self._last
        yield from self._with_form.get(_quotes(content), {}).values()

    def _one(self, content: bytes, start: int) -> tuple[Joints, list[float]] | None:
        """The joints of a file and their numbers; None where the file is not plain."""
        pieces = content[start:].split(b'"')
        if len(pieces) % 2 == 0:
            return None
        markup, values = b'"'.join(pieces[::2]), pieces[1::2]
        layout = self._layouts.get(markup)
        attributes: list[tuple[etree._Element, str]] = []
        if layout is None:
            attributes = _attributes(content, start)
            layout = self._lay_out(markup, attributes)
        if layout is None:
            return None
        text = b",".join(layout.numbers(values))
        if text.count(b",") != len(layout.of_joints) + len(layout.others) - 1:
            return None
        numbers = numbers_in(text)
        if numbers is None:
            return None  # And nothing is learned from what is not written so: its spaces may mean something else.
        key = (layout.words(values), between_numbers(text))
        skeleton = layout.known.get(key)
        if skeleton is None:
            skeleton = self._learn(key, layout, content, start, attributes or _attributes(content, start))
        if skeleton is None:
            return None
        if form := skeleton.see(pieces):
            self._with_form.setdefault(_quotes(content), {})[skeleton] = form
        return skeleton.joints, numbers[: skeleton.count]

    def _lay_out(self, markup: bytes, attributes: Sequence[tuple[etree._Element, str]]) -> _Layout | None:
        kinds = [(str(element.tag), name) for element, name in attributes]
        numbers = [index for index, kind in enumerate(kinds) if kind in _NUMBERS]
        words = [index for index, kind in enumerate(kinds) if kind not in _NUMBERS]
        if not (numbers and words):
            return None
        of_joints = tuple([index for index in numbers if _is_of_joint(attributes[index][0])])
        others = tuple([index for index in numbers if not _is_of_joint(attributes[index][0])])
        layout = _Layout(words=picker(words), numbers=picker(of_joints + others), of_joints=of_joints, others=others)
        self._layouts[markup] = layout
        self.size += 1
        return layout

    def _learn(
        self,
        key: tuple[tuple[bytes, ...], bytes],
        layout: _Layout,
        content: bytes,
        start: int,
        attributes: Sequence[tuple[etree._Element, str]],
    ) -> Skeleton | None:
        try:
            robot = parse_urdf(content, "")
        except ProofError:
            return None
        if not attributes:
            return None
        values = _values(content, start)
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
        found = self._joints.setdefault((names, *shape), Joints(robot=robot, places=places))
        skeleton = Skeleton(joints=found, of_joints=layout.of_joints, others=layout.others, count=count)
        layout.known[key] = skeleton
        self.size += 1
        return skeleton


def _quotes(content: bytes) -> tuple[int, ...]:
    """How many quotes are about each link: files whose links have other shapes differ in it."""
    return tuple([part.count(b'"') for part in content.split(b"<link ")])


def _is_printable(head: bytes) -> bool:
    """Whether a text is UTF-8 without any character that XML cannot hold, or that nobody sees."""
    try:
        return head.translate(None, _LINE_ENDS_AND_TABS).decode().isprintable()
    except UnicodeDecodeError:
        return False


def _values(content: bytes, start: int) -> list[bytes]:
    """What stands between the quotes, from a place on."""
    return content[start:].split(b'"')[1::2]


def _attributes(content: bytes, start: int) -> list[tuple[etree._Element, str]]:
    """The elements and the names of the attributes after the robot's name.

    None are given where lxml finds others than stand between the quotes: where a quote is not around an attribute, or a
    value holds an entity.
    """
    try:
        root = etree.fromstring(content, etree.XMLParser(resolve_entities=False, no_network=True, load_dtd=False))
    except etree.XMLSyntaxError:
        return []
    found = [(element, *item) for element in root.iter(etree.Element) for item in element.attrib.items()][1:]
    if content.find(b"'", start) >= 0 or [value.encode() for _, _, value in found] != _values(content, start):
        return []
    return [(element, str(name)) for element, name, _ in found]


def _is_of_joint(element: etree._Element) -> bool:
    """Whether an element is what a joint of the robot declares itself."""
    joint = element.getparent()
    return joint is not None and joint.tag == "joint" and joint.getparent() is element.getroottree().getroot()


def _places(joint: etree._Element, starts: dict[tuple[etree._Element, str], int]) -> dict[Attribute, int]:
    """Where the numbers of a joint's attributes begin; the first element of a tag is the one that is read."""
    found = {}
    for tag, name in _OF_JOINTS:
        element = joint.find(tag)
        if element is not None and (element, name) in starts and not (tag == "axis" and joint.get("type") == "fixed"):
            found[tag, name] = starts[element, name]
    return found


def _frame(name: str) -> Link:
    return Link(name=name)


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
    import numpy as np

    global _scanner  # noqa: PLW0603 - the skeletons are remembered from call to call
    if _scanner.size > _MOST_REMEMBERED:
        _scanner = _Scanner()
    groups: dict[Joints, list[_Found]] = {}
    for found in _scanner.scan(enumerate(contents)):
        groups.setdefault(found.joints, []).append(found)
    read = []
    for joints, parts in groups.items():
        indices = np.array(list(chain.from_iterable([part.indices for part in parts])))
        order = np.argsort(indices)
        name = min(parts, key=lambda part: part.indices[0]).name
        table = np.concatenate([part.table for part in parts])[order]
        read.append((indices[order].tolist(), joints.with_numbers(name, table)))
    return sorted(read, key=lambda group: group[0][0])
