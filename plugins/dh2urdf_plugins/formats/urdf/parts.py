"""Cuts URDF files into parts and knows what each part means: for `urdf_scanner`.

A file is cut before each of its joints. What is before the first one, and each joint with the links after it, is a
*part*. Files of arms with many axes consist of few parts, though hardly two of them have all parts in common: an arm of
60 axes has a part for each, in which a link may have one shape less than in the next file.

Each part is learned once. The slow reader, `urdf_reader`, reads a file that has nothing but the first part of the files
in which it was met, where materials are defined, and the part itself. If that is the URDF of a robot, and the first
part by itself is as well, then the part begins and ends inside the root and outside all other elements, so that it is
well-formed after whatever other parts. And a file has the links and joints of its parts, one after the other, because
the slow reader reads each of them by itself; only materials come from elsewhere, and these must not be missing.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from operator import itemgetter
from typing import TypeAlias

import orjson
from lxml import etree

from dh2urdf.errors import ProofError
from dh2urdf.robot import Joint
from dh2urdf_plugins.formats.urdf.reader import robot_of
from dh2urdf_plugins.formats.xml_files import written_tree_of

Attribute: TypeAlias = tuple[str, str]
"""Tag and name of an attribute."""
Picker: TypeAlias = Callable[[Sequence[bytes]], tuple[bytes, ...]]
Read: TypeAlias = tuple["Part", bytes, bytes]
"""A part of a file, the numbers of its joints and the others, with commas between them."""

_ROOT, _END, _JOINT = b'<robot name="a"', b"</robot>", b"<joint "
_IN_NUMBERS = b"0123456789.eE+-"

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


def between_numbers(text: bytes) -> bytes:
    """What is in a text besides the characters of numbers."""
    return text.translate(None, _IN_NUMBERS)


def numbers_in(text: bytes) -> list[float] | None:
    """The numbers of a text, with a space or a comma between them; None where JSON does not write them so."""
    try:
        numbers: list[float] = orjson.loads(b"[%b]" % text.replace(b" ", b","))
    except orjson.JSONDecodeError:
        return None
    return numbers or None


def picker(places: Sequence[int]) -> Picker:
    """What picks the entries at some places."""
    if len(places) > 1:
        return itemgetter(*places)
    return lambda entries: tuple([entries[place] for place in places])


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Parts of files that are the same bytes, but for the numbers in them.

    Attributes:
        links: the names of their links.
        joints: their joints, with the numbers of one of them.
        places: for each joint, where among the numbers of joints those of its attributes begin.
        count: how many numbers of joints there are.
        of_joints: the places of the numbers of joints among the values of attributes.
        others: the places of the other numbers.
        values: how many values there are.
        kind: the same for parts whose joints differ in numbers only, whatever their links are made of.
    """

    links: tuple[str, ...]
    joints: tuple[Joint, ...]
    places: tuple[dict[Attribute, int], ...]
    count: int
    of_joints: tuple[int, ...]
    others: tuple[int, ...]
    values: int
    kind: tuple[object, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Layout:
    """Which values of parts with the same markup are words, and which are numbers.

    Attributes:
        words: picks the words.
        of_joints: picks the numbers of joints.
        others: picks the other numbers.
        known: the parts of such markup, by the words and by what is between the numbers.
    """

    words: Picker
    of_joints: Picker
    others: Picker
    known: dict[tuple[tuple[bytes, ...], bytes, bytes], Part] = field(default_factory=dict)


class _Place:
    """Where parts are in files, and the parts that were met there.

    Attributes:
        size: how many they are.
    """

    def __init__(self, before: bytes, after: bytes, links: int = 0, joints: int = 0) -> None:
        """A place in files.

        Args:
            before: what is before a part in the file in which it is learned, from the root on.
            after: what is after it there.
            links: how many links are before it.
            joints: how many joints are.
        """
        self._before, self._after, self._links, self._joints = before, after, links, joints
        self._layouts: dict[bytes, _Layout] = {}
        self.size = 0

    def read(self, text: bytes) -> Read | None:
        """The part that a text is; None where it is for the slow reader."""
        pieces = text.split(b'"')
        if len(pieces) % 2 == 0:
            return None
        markup, values = b'"'.join(pieces[::2]), pieces[1::2]
        layout = self._layouts.get(markup)
        if layout is not None:
            of_joints, others = b",".join(layout.of_joints(values)), b",".join(layout.others(values))
            part = layout.known.get((layout.words(values), between_numbers(of_joints), between_numbers(others)))
            if part is not None:
                return part, of_joints, others
        return self._learned(text, markup, values)

    def _learned(self, text: bytes, markup: bytes, values: Sequence[bytes]) -> Read | None:
        """A part that was not met before, as the slow reader reads it; None where that refuses it."""
        whole = b"".join((_ROOT, self._before, text, self._after))
        try:
            root = written_tree_of(whole, "")
            robot = robot_of(root, "")
        except ProofError:
            return None
        found = [
            (element, str(name), str(value))
            for element in root.iter(etree.Element)
            for name, value in element.attrib.items()
        ]
        if b"'" in whole or [value.encode() for _, _, value in found] != whole.split(b'"')[1::2]:
            return None  # A quote is not around an attribute, or a value holds an entity.
        attributes = [(element, name) for element, name, _ in found[len(found) - len(values) :]]
        numbers = [place for place, (element, name) in enumerate(attributes) if (str(element.tag), name) in _NUMBERS]
        if any(b"," in values[place] or numbers_in(values[place]) is None for place in numbers):
            return None  # What is not written so has spaces that may mean something else.
        of_joints = [place for place in numbers if _is_of_joint(attributes[place][0])]
        others = [place for place in numbers if place not in of_joints]
        layout = self._layouts.get(markup)
        if layout is None:
            words = picker(sorted({*range(len(values))}.difference(numbers)))
            layout = self._layouts[markup] = _Layout(words, picker(of_joints), picker(others))
        starts: dict[tuple[etree._Element, str], int] = {}
        count = 0
        for place in of_joints:
            starts[attributes[place]] = count
            count += len(values[place].split(b" "))
        places = tuple([_places(element, starts) for element in [*root.iterchildren("joint")][self._joints :]])
        joints = tuple([replace(joint, mark=None) for joint in robot.joints[self._joints :]])
        links = tuple([link.name for link in robot.links[self._links :]])
        forms = [(j.name, j.type, j.parent, j.child, *where.items()) for j, where in zip(joints, places, strict=True)]
        part = Part(
            links=links,
            joints=joints,
            places=places,
            count=count,
            of_joints=tuple(of_joints),
            others=tuple(others),
            values=len(values),
            kind=(links, *forms),
        )
        texts = b",".join(layout.of_joints(values)), b",".join(layout.others(values))
        layout.known[layout.words(values), between_numbers(texts[0]), between_numbers(texts[1])] = part
        self.size += 1
        return part, *texts


class Parts:
    """The parts of files that were met so far.

    What is remembered makes reading faster and changes nothing: a part is the same, whichever of the like comes first.
    """

    def __init__(self) -> None:
        self._whole, self._first = _Place(b"", b""), _Place(b"", _END)
        self._after: dict[tuple[bytes, Part], tuple[_Place, _Place]] = {}

    @property
    def size(self) -> int:
        """How many parts are remembered."""
        return sum([place.size for place in (self._whole, self._first, *chain(*self._after.values()))])

    def of(self, text: bytes) -> tuple[tuple[Part, ...], list[float]] | None:
        """The parts of a file, and its numbers.

        Args:
            text: what is after the robot's name.

        Returns:
            The parts; and the numbers, those of joints first. None where the file is for the slow reader.
        """
        read = self._cut(text)
        if read is None:
            whole = self._whole.read(text)
            read = [] if whole is None else [whole]
        parts, of_joints, others = zip(*read, strict=True) if read else ((), (), ())
        numbers = numbers_in(b",".join([each for each in (*of_joints, *others) if each]))
        return None if numbers is None else (parts, numbers)

    def _cut(self, text: bytes) -> list[Read] | None:
        """The parts of a file that can be cut; None of another one."""
        end = text.find(_JOINT)
        margin = text[text.rfind(b">", 0, end) + 1 : end]
        if end < 0 or margin.strip():
            return None
        before = margin + _JOINT
        first, *others, last = text.split(before)
        read = self._first.read(first)
        if read is None:
            return None
        head = read[0]
        places = self._after.get((margin, head))
        if places is None:
            counts = len(head.links), len(head.joints)
            places = _Place(first + before, _END, *counts), _Place(first + before, b"", *counts)
            self._after[margin, head] = places
        found = [read]
        for each in others:
            read = places[0].read(each)
            if read is None:
                return None
            found.append(read)
        read = places[1].read(last)
        return None if read is None else [*found, read]


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
