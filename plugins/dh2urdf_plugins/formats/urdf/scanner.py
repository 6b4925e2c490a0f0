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
from dataclasses import dataclass, replace
from itertools import accumulate, chain, pairwise
from operator import itemgetter
from typing import TYPE_CHECKING, Any, TypeAlias

import orjson
from lxml import etree

from dh2urdf.elementwise import array_of
from dh2urdf.errors import ProofError
from dh2urdf.manipulator import Limits
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import ZERO
from dh2urdf_plugins.formats.urdf.reader import robot_of
from dh2urdf_plugins.formats.xml_files import written_tree_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence

    Attribute: TypeAlias = tuple[str, str]  # tag and name
    Picker: TypeAlias = Callable[[Sequence[bytes]], Sequence[bytes]]

# XML 1.0: prolog (22), XML declaration (23), comment (15), in which no `--` is, start tag (40).
_HEAD = re.compile(
    rb"""(?: <\?xml[ ]version="1\.0" (?:[ ]encoding="(?:UTF|utf)-8")? \?> )?
    [ \t\r\n]*+ (?: <!-- [^-]*+ (?:-[^-]++)*+ --> [ \t\r\n]*+ )?
    <robot[ ]name="( [^"<&\t\r\n]*+ )" """,
    re.VERBOSE,
)
_LINE_ENDS_AND_TABS = b"\t\r\n"
_ROOT, _END, _JOINT = b'<robot name="a"', b"</robot>", b"<joint "
_IN_NUMBERS = b"0123456789.eE+-"
_MOST = 2**25
"""Files of so many bytes in all are remembered from call to call."""
_ENOUGH = 32
"""Files of the same parts from which on it pays to learn a form: an expression takes as long as thirty files."""
_LOOKED_AT = 4
"""Of every so many of them one is compared with the others."""
_OF_ALIKE = 1000
"""Bytes that are counted for each combination of parts."""
_FORMS, _FILES_AT_ONCE = 4, 32
"""Forms that a file is compared with, and files whose numbers are read in one call: they stay in the cache."""

# The attributes of the URDF specification (wiki.ros.org/urdf/XML) that are numbers; the joints' first.
_OF_JOINTS: tuple[Attribute, ...] = (
    *(("origin", "xyz"), ("origin", "rpy"), ("axis", "xyz")),
    *(("limit", name) for name in ("lower", "upper", "velocity", "effort")),
    *(("dynamics", "damping"), ("dynamics", "friction")),
)
_NUMBERS = {
    *_OF_JOINTS,
    *(("mass", "value"), ("box", "size"), ("sphere", "radius"), ("mesh", "scale"), ("color", "rgba")),
    *(("cylinder", "radius"), ("cylinder", "length")),
    *(("inertia", name) for name in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")),
}


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """The joints of parts of files, or of files, that differ in numbers only.

    Attributes:
        robot: those of one of them, with the names of its links.
        places: for each joint, where among the numbers of joints those of its attributes begin.
        count: how many numbers of joints there are.
    """

    robot: Robot
    places: tuple[dict[Attribute, int], ...]
    count: int

    @property
    def kind(self) -> object:
        """The same for joints that differ in numbers only."""
        joints = zip(self.robot.joints, self.places, strict=True)
        forms = [(joint.name, joint.type, joint.parent, joint.child, *where.items()) for joint, where in joints]
        return (*[link.name for link in self.robot.links], *forms)

    def with_numbers(self, name: str, rows: Any) -> Robot:  # noqa: ANN401 - an array
        """The joints with the numbers of many files, a row for each: a float where all rows have the same number."""
        table = rows.T.copy()
        alike = (table == table[:, :1]).all(axis=1)
        numbers = [float(column[0]) if same else column for column, same in zip(table, alike, strict=True)]
        joints = zip(self.robot.joints, self.places, strict=True)
        return replace(self.robot, name=name, joints=tuple([_with_numbers(*each, numbers) for each in joints]))


@dataclass(frozen=True, slots=True, eq=False)
class _Part:
    """Parts of files, or files, that are the same bytes but for the numbers in them.

    Attributes:
        joints: their joints.
        of_joints: the places of the numbers of joints among the values of attributes.
        others: the places of the other numbers.
        values: how many values there are.
    """

    joints: Joints
    of_joints: tuple[int, ...]
    others: tuple[int, ...]
    values: int


class _Layout:
    """Which values of texts with the same markup are words and which are numbers.

    Attributes:
        known: the parts of such markup, by the words and by what is between the numbers.
    """

    def __init__(self, part: _Part) -> None:
        self._words = _picker(sorted({*range(part.values)}.difference(part.of_joints, part.others)))
        self._of_joints, self._others = _picker(part.of_joints), _picker(part.others)
        self.known: dict[tuple[object, ...], _Part] = {}

    def key(self, values: Sequence[bytes]) -> tuple[tuple[object, ...], bytes, bytes]:
        """The key of a text in `known`, the numbers of its joints and the others, with commas between them."""
        of_joints, others = b",".join(self._of_joints(values)), b",".join(self._others(values))
        key = self._words(values), of_joints.translate(None, _IN_NUMBERS), others.translate(None, _IN_NUMBERS)
        return key, of_joints, others


class _Place:
    """The parts that were met at a place of files.

    Args:
        kinds: the joints that were met anywhere, by their kind.
        before: what is before the parts in the file in which they are learned, from the root on.
        after: what is after them there.
        head: the joints before them.

    Attributes:
        size: bytes of the parts.
    """

    def __init__(
        self, kinds: dict[object, Joints], before: bytes = b"", after: bytes = b"", head: Joints | None = None
    ) -> None:
        self.size = 0
        self._kinds, self._before, self._after = kinds, before, after
        self._links, self._joints = (len(head.robot.links), len(head.robot.joints)) if head else (0, 0)
        self._layouts: dict[bytes, _Layout] = {}

    def read(self, text: bytes) -> tuple[_Part, bytes, bytes] | None:
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

    def learn(self, text: bytes, part: _Part) -> None:
        """Remembers what a text is."""
        self.size += len(text)
        pieces = text.split(b'"')
        markup = b'"'.join(pieces[::2])
        layout = self._layouts[markup] = self._layouts.get(markup) or _Layout(part)
        layout.known[layout.key(pieces[1::2])[0]] = part

    def learned(self, text: bytes) -> tuple[_Part, bytes, bytes] | None:
        """The same as `read`, or what the slow reader reads in the text and around it; None where it refuses."""
        known = self.read(text)
        if known is not None:
            return known
        whole, values = b"".join((_ROOT, self._before, text, self._after)), text.split(b'"')[1::2]
        try:
            root = written_tree_of(whole, "")
            robot = robot_of(root, "")
        except ProofError:
            return None
        items = [(element, str(k), str(v)) for element in root.iter(etree.Element) for k, v in element.items()]
        if b"'" in whole or [value.encode() for _, _, value in items] != whole.split(b'"')[1::2]:
            return None  # A quote is not around an attribute, or a value holds an entity.
        attributes = [(element, name) for element, name, _ in items[len(items) - len(values) :]]
        numbers = [place for place, (element, name) in enumerate(attributes) if (str(element.tag), name) in _NUMBERS]
        if any(b"," in values[place] or _numbers_in(values[place]) is None for place in numbers):
            return None  # What is not written so has spaces that may mean something else.
        of_joints = [place for place in numbers if _is_of_joint(attributes[place][0])]
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
        self.learn(text, _Part(joints, tuple(of_joints), others, len(values)))
        return self.read(text)


class _Alike:
    """Files that consist of the same parts.

    Attributes:
        joints: their joints.
    """

    def __init__(self, joints: Joints, parts: tuple[_Part, ...]) -> None:
        self.joints, self._parts = joints, parts
        self._seen, self._since = 0, 0
        self._first: list[bytes] = []
        self._varying: set[int] = set()
        self._traces: dict[int, int] = {}

    def see(self, text: bytes, total: int) -> _Form | None:
        """Compares the numbers of some files, and returns their form each time that they are twice as many.

        Args:
            text: what is after the name in one more file.
            total: how many files were read in all, of any parts.
        """
        self._since = self._since or total
        self._seen += 1
        if self._seen % _LOOKED_AT or self._seen * _FORMS < total - self._since:
            return None
        values = text.split(b'"')[1::2]
        if not self._first:
            self._first, self._part = values, _together(self.joints, self._parts)
            self._traces = dict.fromkeys(sorted((*self._part.of_joints, *self._part.others)), 0)
        self._varying.update([place for place in self._traces if values[place] != self._first[place]])
        # Numbers with the same trace were the same text in every file. Where this is wrong, a file has no form.
        self._traces = {place: hash((trace, values[place])) for place, trace in self._traces.items()}
        if self._seen < _ENOUGH or self._seen.bit_count() != 1:
            return None
        return _Form(self._part, text.split(b'"'), {place: self._traces[place] for place in sorted(self._varying)})


class _Form:
    """What files of the same parts have in common besides: all bytes between the numbers that vary.

    An expression takes these numbers out of a file by the lengths of what is between them; a number that is written
    twice is taken once. If the numbers and what is between them here make the same bytes again, the file has this form.

    Args:
        part: what such files are.
        pieces: what the quotes cut one of them into.
        traces: the places of the values that vary; values with the same trace are the same text.

    Attributes:
        part: what such files are.
    """

    def __init__(self, part: _Part, pieces: list[bytes], traces: dict[int, int]) -> None:
        self.part, values = part, pieces[1::2]
        first = {trace: place for place, trace in reversed(traces.items())}
        groups = {place: number for number, place in enumerate(sorted(first.values()))}
        cuts = [-1, *[2 * place + 1 for place in traces], len(pieces)]
        between = [b'"'.join(pieces[start + 1 : end]) for start, end in pairwise(cuts)]
        # The quote before a number is looked at: where it is not in its place, the file has another form.
        steps = [b".{%d}+" % len(between[0])]
        for (place, trace), text in zip(traces.items(), between[1:], strict=True):
            name = b"_%d" % groups[first[trace]]
            steps += (b'"', b'(?P<%b>[^"]*+)' % name if place in groups else b"(?P=%b)" % name)
            steps.append(b".{%d}+" % (len(text) + 1))
        self._match = re.compile(b"".join(steps), re.DOTALL).fullmatch
        self._fillings = _picker([groups[first[trace]] for trace in traces.values()])
        self._pieces = [b""] * (2 * len(between) - 1)
        self._pieces[::2] = [b'"%b"' % text for text in between]
        self._pieces[0] = self._pieces[0][1:]
        self._pieces[-1] = self._pieces[-1][:-1]
        columns, sources = _spans(values, part.of_joints), _spans(values, groups)
        moving = [place for place in part.of_joints if place in traces]
        text = b",".join([values[place] for place in groups])
        self._between, self._count = text.translate(None, _IN_NUMBERS), sum(map(len, sources.values()))
        self._columns = [column for place in moving for column in columns[place]]
        self._sources = [source for place in moving for source in sources[first[traces[place]]]]
        self._row = _numbers_in(b",".join([values[place] for place in part.of_joints])) or []

    def varying(self, content: bytes, start: int) -> bytes | None:
        """The numbers of a file that vary, with commas between them; None where it has another form."""
        match = self._match(content, start)
        if match is None:
            return None
        pieces, texts = self._pieces.copy(), match.groups()
        pieces[0] = content[:start] + pieces[0]
        pieces[1::2] = self._fillings(texts)
        return b",".join(texts) if content == b"".join(pieces) else None

    def rows(self, texts: Sequence[bytes]) -> Any | None:  # noqa: ANN401 - an array
        """The numbers of the joints of files, by the numbers that vary; None where one of these is no number."""
        import numpy as np

        table = np.empty((len(texts), len(self._row)))
        table[:] = self._row
        if self._count:
            text = b",".join(texts)
            # A comma is between two values at least, so none is in them, and each has its own number of spaces.
            if text.translate(None, _IN_NUMBERS) != b",".join([self._between] * len(texts)):
                return None
            if (numbers := _numbers_in(text)) is None:
                return None
            table[:, self._columns] = array_of(numbers).reshape(len(texts), self._count)[:, self._sources]
        return table


def _spans(values: Sequence[bytes], places: Iterable[int]) -> dict[int, range]:
    """Where the numbers of some values are among the numbers of all of these, by the places of the values."""
    counts = {place: values[place].count(b" ") + 1 for place in places}
    ends = accumulate(counts.values())
    return {place: range(end - count, end) for (place, count), end in zip(counts.items(), ends, strict=True)}


def _together(joints: Joints, parts: Sequence[_Part]) -> _Part:
    """A file of some parts as one part."""
    starts = [*accumulate([part.values for part in parts], initial=0)]
    of_joints, others = (
        tuple([start + place for start, each in zip(starts, places, strict=False) for place in each])
        for places in ([part.of_joints for part in parts], [part.others for part in parts])
    )
    return _Part(joints, of_joints, others, starts[-1])


class _Scanner:
    """Reads files and remembers what it has met: that makes reading faster and changes nothing.

    Files of arms with many axes consist of few parts, though hardly two of the files are alike: a link may have one
    shape less than in the next one. So a file is cut before each of its joints, and each part is read once by the slow
    reader: after the first part of the file, where materials are defined. If that is the URDF of a robot, and the first
    part by itself is as well, then the part begins and ends inside the root and outside all other elements, so that it
    is well-formed after whatever other parts. Where a quarter of the files have the same parts, their form is learned.
    """

    def __init__(self) -> None:
        self._kinds: dict[object, Joints] = {}
        self._whole, self._first = _Place(self._kinds), _Place(self._kinds, after=_END)
        self._others: dict[tuple[bytes, _Part], tuple[_Place, _Place]] = {}  # by margin and first part: those, the last
        self._joined: dict[tuple[Joints, ...], Joints] = {}
        self._alike: dict[tuple[_Part, ...], _Alike] = {}
        self._count = 0
        self._forms: list[_Form] = []  # the last one first: often the next file has it too

    @property
    def size(self) -> int:
        """Bytes of the parts and files that are remembered."""
        places = (self._whole, self._first, *chain(*self._others.values()))
        return sum([place.size for place in places]) + _OF_ALIKE * len(self._alike)

    def scan(self, heads: Mapping[int, re.Match[bytes]]) -> Iterator[tuple[Joints, list[int], Any]]:
        """The joints of files and a table of their numbers, by the places of the files.

        Args:
            heads: what is before and in the name of each file's robot.
        """
        formed: dict[_Form, tuple[list[int], list[bytes]]] = {}
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

    def _form(self, content: bytes, start: int) -> tuple[_Form, bytes] | None:
        """The form of a file and the numbers that vary in it; None where it has none."""
        for place, form in enumerate(self._forms):
            if (numbers := form.varying(content, start)) is not None:
                if place:
                    self._forms.insert(0, self._forms.pop(place))
                return form, numbers
        return None

    def read(self, text: bytes) -> tuple[Joints, list[float]] | None:
        """The joints of a file and their numbers, of what is after its name; None where it is for the slow reader."""
        found = self._whole.read(text) if self._whole.size else None
        cut = [found] if found else self._cut(text)
        if cut is None and (found := self._whole.learned(text)):
            cut = [found]
        if cut is None:
            return None
        parts, of_joints, others = zip(*cut, strict=True)
        numbers = _numbers_in(b",".join(filter(None, (*of_joints, *others))))
        if numbers is None:
            return None
        self._count += 1
        alike = self._alike.get(parts)
        if alike is None:
            alike = self._alike[parts] = _Alike(self._joints_of(parts), parts)
        if form := alike.see(text, self._count):
            self._forms = [form, *[each for each in self._forms if each.part is not form.part][: _FORMS - 1]]
        return alike.joints, numbers[: alike.joints.count]

    def _cut(self, text: bytes) -> list[tuple[_Part, bytes, bytes]] | None:
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

    def _joints_of(self, parts: tuple[_Part, ...]) -> Joints:
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

    A file that is not surely read as `reader` reads it is in no group, whatever the others are.

    Args:
        contents: the files.

    Returns:
        For each group the places of its members among the files, and a robot with their joints, whose numbers are
        columns as in `dh2urdf.columns`, and the names of their links; its name is the first one's.
    """
    import numpy as np

    global _scanner  # noqa: PLW0603 - what was learned is remembered from call to call
    if _scanner.size > _MOST:
        _scanner = _Scanner()
    found = ((place, _HEAD.match(content)) for place, content in enumerate(contents))
    heads = [(place, head) for place, head in found if head and _is_printable(head[0])]
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


def _numbers_in(text: bytes) -> list[float] | None:
    """The numbers of a text, with a space or a comma between them; None where JSON does not write them so."""
    try:
        numbers: list[float] = orjson.loads(b"[%b]" % text.replace(b" ", b","))
    except orjson.JSONDecodeError:
        return None
    return numbers or None


def _picker(places: Sequence[int]) -> Picker:
    """What picks the values at some places."""
    return itemgetter(*places) if len(places) > 1 else lambda values: tuple([values[place] for place in places])


def _is_printable(head: bytes) -> bool:
    """Whether a text is UTF-8 without any character that XML cannot hold, or that nobody sees."""
    try:
        return head.translate(None, _LINE_ENDS_AND_TABS).decode().isprintable()
    except UnicodeDecodeError:
        return False


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


def _with_numbers(joint: Joint, places: dict[Attribute, int], numbers: Sequence[Any]) -> Joint:
    """A joint with other numbers in the place of those that its file has."""

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
