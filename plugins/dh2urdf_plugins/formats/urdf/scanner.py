"""Reads the joints of many plain URDF files at once: the proof of every file of a long run.

The value of an attribute is between two quotes. Cut at its quotes, a text is a list of pieces, markup and values by
turns, and files whose pieces are the same bytes, but for the numbers in them, are the same elements with other numbers.
The slow reader, `reader`, reads each part of a file once; of all others the numbers are taken by their places. Nothing
here comes from the writer, and a file of any origin is read, or left to the slow reader.

What is read is what the slow reader would read, since of every file it is checked that

- before the root there is nothing but an XML declaration of UTF-8 and a comment, both well-formed, and the first
  attribute of the root is its name, which is printable text without entities;
- after that, all bytes are those of a file that the slow reader has read, names of links and joints included, but for
  the values of the attributes that URDF defines as numbers; in that file lxml has found the quotes around attributes,
  and nowhere else;
- each of these values has as many numbers as there, with one space between them, and each is a finite number as JSON
  writes it, whether the proof needs it or not.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import accumulate, chain
from typing import TYPE_CHECKING, Any

from lxml import etree

from dh2urdf.columns import INERTIA, LIMITS
from dh2urdf.errors import ProofError
from dh2urdf.robot import Link, Robot
from dh2urdf.rotations import array_of
from dh2urdf_plugins.formats.urdf.forms import FORMS, IN_NUMBERS, Alike, Form, Joints, Part, numbers_in, picker
from dh2urdf_plugins.formats.urdf.reader import model_of
from dh2urdf_plugins.formats.xml_files import written_tree_of

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf_plugins.formats.urdf.forms import Attribute

# XML 1.0: prolog (22), XML declaration (23), comment (15), in which no `--` is, start tag (40).
_HEAD = re.compile(
    rb"""(?: <\?xml[ ]version="1\.0" (?:[ ]encoding="(?:UTF|utf)-8")? \?> )?
    [ \t\r\n]*+ (?: <!-- [^-]*+ (?:-[^-]++)*+ --> [ \t\r\n]*+ )?
    <robot[ ]name="( [^"<&\t\r\n]*+ )" """,
    re.VERBOSE,
)
_LINE_ENDS_AND_TABS = b"\t\r\n"
_ROOT, _END, _JOINT = b'<robot name="a"', b"</robot>", b"<joint "
_MOST = 2**25
"""Files of so many bytes in all are remembered from call to call."""
_OF_ALIKE = 1000
"""Bytes that are counted for each combination of parts."""
_FILES_AT_ONCE = 32
"""Files whose numbers are read in one call: their texts stay in the processor's cache."""

# The attributes of the URDF specification (wiki.ros.org/urdf/XML) that are numbers; the joints' first.
_OF_JOINTS: tuple[Attribute, ...] = (
    *(("origin", "xyz"), ("origin", "rpy"), ("axis", "xyz")),
    *(("limit", name) for name in LIMITS),
    *(("dynamics", "damping"), ("dynamics", "friction")),
)
_NUMBERS = {
    *_OF_JOINTS,
    *(("mass", "value"), ("box", "size"), ("sphere", "radius"), ("mesh", "scale"), ("color", "rgba")),
    *(("cylinder", "radius"), ("cylinder", "length")),
    *(("inertia", name) for name in INERTIA),
}


class _Layout:
    """Which values of texts with the same markup are words and which are numbers."""

    def __init__(self, part: Part) -> None:
        self._words = picker(sorted({*range(part.values)}.difference(part.of_joints, part.others)))
        self._of_joints, self._others = picker(part.of_joints), picker(part.others)
        self.known: dict[tuple[object, ...], Part] = {}  # by the words and by what is between the numbers

    def key(self, values: Sequence[bytes]) -> tuple[tuple[object, ...], bytes, bytes]:
        """The key of a text in `known`, the numbers of its joints and the others, with commas between them."""
        of_joints, others = b",".join(self._of_joints(values)), b",".join(self._others(values))
        key = self._words(values), of_joints.translate(None, IN_NUMBERS), others.translate(None, IN_NUMBERS)
        return key, of_joints, others


class _Place:
    """The parts, of `size` bytes, that were met at a place of files.

    They are learned between the texts `before`, from the root on, and `after`, behind the joints of `head`; `kinds` are
    the joints that were met anywhere, by their kind.
    """

    def __init__(
        self, kinds: dict[object, Joints], before: bytes = b"", after: bytes = b"", head: Joints | None = None
    ) -> None:
        self.size = 0
        self._kinds, self._before, self._after = kinds, before, after
        self._links, self._joints = (len(head.robot.links), len(head.robot.joints)) if head else (0, 0)
        self._layouts: dict[bytes, _Layout] = {}

    def read(self, text: bytes) -> tuple[Part, bytes, bytes] | None:
        """The part that a text is, and its numbers; None where it is for the slow reader, or was never met."""
        pieces = text.split(b'"')
        if len(pieces) % 2 == 0:
            return None
        layout = self._layouts.get(b'"'.join(pieces[::2]))
        if layout is None:
            return None
        key, of_joints, others = layout.key(pieces[1::2])
        part = layout.known.get(key)
        return None if part is None else (part, of_joints, others)

    def learned(self, text: bytes) -> tuple[Part, bytes, bytes] | None:
        """The same as `read`, or what the slow reader reads in the text and around it; None where it refuses."""
        known = self.read(text)
        if known is not None:
            return known
        whole, values = b"".join((_ROOT, self._before, text, self._after)), text.split(b'"')[1::2]
        try:
            root = written_tree_of(whole, "")
            robot = model_of(root, "").whole()
        except ProofError:
            return None
        items = [(element, str(k), str(v)) for element in root.iter(etree.Element) for k, v in element.items()]
        if b"'" in whole or [value.encode() for _, _, value in items] != whole.split(b'"')[1::2]:
            return None  # A quote is not around an attribute, or a value holds an entity.
        attributes = [(element, name) for element, name, _ in items[len(items) - len(values) :]]
        numbers = [place for place, (element, name) in enumerate(attributes) if (str(element.tag), name) in _NUMBERS]
        if any(b"," in values[place] or numbers_in(values[place]) is None for place in numbers):
            return None  # What is not written so has spaces that may mean something else.
        own = {each for joint in root.iterchildren("joint") for each in joint}
        of_joints = [place for place in numbers if attributes[place][0] in own]
        counts = [len(values[place].split(b" ")) for place in of_joints]
        starts = {
            attributes[place]: start for place, start in zip(of_joints, accumulate(counts, initial=0), strict=False)
        }
        joints = Joints(
            robot=Robot(
                name="",
                links=tuple([Link(name=link.name) for link in robot.links[self._links :]]),
                joints=tuple([replace(joint, mark=None) for joint in robot.joints[self._joints :]]),
            ),
            places=tuple([_places(joint, starts) for joint in [*root.iterchildren("joint")][self._joints :]]),
            count=sum(counts),
        )
        others = tuple([place for place in numbers if place not in of_joints])
        joints = self._kinds.setdefault(joints.kind, joints)
        part = Part(joints, tuple(of_joints), others, len(values))
        layout = self._layouts.setdefault(b'"'.join(text.split(b'"')[::2]), _Layout(part))
        layout.known[layout.key(values)[0]] = part
        self.size += len(text)
        return self.read(text)


class _Scanner:
    """Reads files and remembers what it has met: that makes reading faster and changes nothing.

    Files of arms with many axes consist of few parts, though hardly two of the files are alike: a link may have one
    shape less than in the next one. So a file is cut before each of its joints, and each part is read once by the slow
    reader: after the first part of the file, where materials are defined. If that is the URDF of a robot, and the first
    part by itself is as well, then the part begins and ends inside the root and outside all other elements, so that it
    is well-formed after whatever other parts. Where a quarter of the files have the same parts, their form is learned.
    A file that cannot be cut so is for the slow reader.
    """

    def __init__(self) -> None:
        self._kinds: dict[object, Joints] = {}
        self._first = _Place(self._kinds, after=_END)
        self._others: dict[tuple[bytes, Part], tuple[_Place, _Place]] = {}  # by margin and first part: those, the last
        self._joined: dict[tuple[Joints, ...], Joints] = {}
        self._alike: dict[tuple[Part, ...], Alike] = {}
        self._count = 0
        self._forms: list[Form] = []  # the last one first: often the next file has it too

    @property
    def size(self) -> int:
        """Bytes of the parts and files that are remembered."""
        places = (self._first, *chain(*self._others.values()))
        return sum([place.size for place in places]) + _OF_ALIKE * len(self._alike)

    def scan(self, heads: Mapping[int, re.Match[bytes]]) -> Iterator[tuple[Joints, list[int], Any]]:
        """The joints of files and a table of their numbers, by the places of the files, and the heads of these."""
        formed: dict[Form, tuple[list[int], list[bytes]]] = {}
        rest = []
        for place, head in heads.items():
            if found := self._form(head.string, head.end()):
                places, texts = formed.setdefault(found[0], ([], []))
                places.append(place)
                texts.append(found[1])
            else:
                rest.append(place)
        for form, (places, texts) in formed.items():
            if (table := form.rows(texts)) is not None:
                yield form.part.joints, places, table
            else:
                rest += places
        for place in rest:
            if alone := self.read(heads[place].string[heads[place].end() :]):
                yield alone[0], [place], array_of(alone[1]).reshape(1, -1)

    def _form(self, content: bytes, start: int) -> tuple[Form, bytes] | None:
        """The form of a file and the numbers that vary in it; None where it has none."""
        for place, form in enumerate(self._forms):
            if (numbers := form.varying(content, start)) is not None:
                if place:
                    self._forms.insert(0, self._forms.pop(place))
                return form, numbers
        return None

    def read(self, text: bytes) -> tuple[Joints, list[float]] | None:
        """The joints of a file and their numbers, of what is after its name; None where it is for the slow reader."""
        cut = self._cut(text)
        if cut is None:
            return None
        parts, of_joints, others = zip(*cut, strict=True)
        numbers = numbers_in(b",".join(filter(None, (*of_joints, *others))))
        if numbers is None:
            return None
        self._count += 1
        alike = self._alike.get(parts)
        if alike is None:
            alike = self._alike[parts] = Alike(self._joints_of(parts), parts)
        if form := alike.see(text, self._count):
            self._forms = [form, *[each for each in self._forms if each.part is not form.part][: FORMS - 1]]
        return alike.joints, numbers[: alike.joints.count]

    def _cut(self, text: bytes) -> list[tuple[Part, bytes, bytes]] | None:
        """The parts of a file; None where it cannot be cut into parts that stand by themselves."""
        start = text.find(_JOINT)
        margin = text[text.rfind(b">", 0, start) + 1 : start]
        if start < 0 or margin.strip():
            return None
        before = margin + _JOINT
        first, *others, last = text.split(before)
        if (head := self._first.learned(first)) is None:
            return None
        places = self._others.get((margin, head[0]))
        if places is None:
            inner, end = (_Place(self._kinds, first + before, after, head[0].joints) for after in (_END, b""))
            places = self._others[margin, head[0]] = inner, end
        found = [head]
        for each, place in [*((each, places[0]) for each in others), (last, places[1])]:
            if (read := place.learned(each)) is None:
                return None
            found.append(read)
        return found

    def _joints_of(self, parts: tuple[Part, ...]) -> Joints:
        """The joints of files of some parts; the same ones for files whose joints differ in numbers only."""
        alone = tuple([part.joints for part in parts])
        found = self._joined.get(alone)
        if found is None:
            starts = accumulate([each.count for each in alone], initial=0)
            robot = Robot(
                name="",
                links=tuple([link for each in alone for link in each.robot.links]),
                joints=tuple([joint for each in alone for joint in each.robot.joints]),
            )
            places = [
                {attribute: start + place for attribute, place in where.items()}
                for start, each in zip(starts, alone, strict=False)
                for where in each.places
            ]
            made = Joints(robot, tuple(places), sum([each.count for each in alone]))
            found = self._joined[alone] = self._kinds.setdefault(made.kind, made)
        return found


_scanner = _Scanner()


def scan_columns(contents: Sequence[bytes]) -> list[tuple[list[int], Robot]]:
    """The joints of many URDF files, in groups whose members differ in numbers only.

    A file that is not surely read as `reader` reads it is in no group, whatever the others are. Each group is the
    places of its members among the files, and a robot with their joints, whose numbers are columns as in
    `dh2urdf.columns`, and the names of their links; its name is the first one's.
    """
    import numpy as np

    global _scanner  # noqa: PLW0603 - what was learned is remembered from call to call
    if _scanner.size > _MOST:
        _scanner = _Scanner()
    found = ((place, _HEAD.match(content)) for place, content in enumerate(contents))
    # Neither is there what is not UTF-8 or XML cannot hold, nor what nobody sees.
    heads = [
        (place, head)
        for place, head in found
        if head and head[0].translate(None, _LINE_ENDS_AND_TABS).decode(errors="surrogateescape").isprintable()
    ]
    groups: dict[Joints, tuple[list[int], list[Any]]] = {}
    for start in range(0, len(heads), _FILES_AT_ONCE):
        for joints, some, table in _scanner.scan(dict(heads[start : start + _FILES_AT_ONCE])):
            places, tables = groups.setdefault(joints, ([], []))
            places += some
            tables.append(table)
    names = dict(heads)
    read = []
    for joints, (places, tables) in groups.items():
        order = np.argsort(places)
        ordered = [places[index] for index in order]
        name = names[ordered[0]][1].decode()
        read.append((ordered, joints.with_numbers(name, np.concatenate(tables)[order])))
    return sorted(read, key=lambda group: group[0][0])


def _places(joint: etree._Element, starts: dict[tuple[etree._Element, str], int]) -> dict[Attribute, int]:
    """Where the numbers of a joint's attributes begin; the first element of a tag is the one that is read."""
    found = {}
    for tag, name in _OF_JOINTS:
        element = joint.find(tag)
        if element is not None and (element, name) in starts and not (tag == "axis" and joint.get("type") == "fixed"):
            found[tag, name] = starts[element, name]
    return found
