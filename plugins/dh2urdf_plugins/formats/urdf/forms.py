"""What URDF files with the same markup have in common, learned from the files themselves: for `urdf_scanner`.

Files of one skeleton differ in numbers only, and in few of these: most are the same text in every file, and many of the
others are there twice. What is the same is compared as bytes; the rest is read, of many files in one call.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from typing import TYPE_CHECKING, Any

from dh2urdf.elementwise import array_of
from dh2urdf.manipulator import Limits
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import ZERO
from dh2urdf_plugins.formats.urdf.parts import Attribute, Part, between_numbers, numbers_in, picker

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

ENOUGH = 32
"""Files of a skeleton from which on it pays to learn what they share: an expression takes as long as thirty files."""
_LOOKED_AT = 8
"""Of so many files of these the numbers are compared."""


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """The joints of files whose joints differ in numbers only.

    Attributes:
        robot: those of one of them, with the names of its links.
        places: for each joint, where among the numbers of a file those of its attributes begin.
    """

    robot: Robot
    places: tuple[dict[Attribute, int], ...]

    @property
    def kind(self) -> object:
        """The same for joints that differ in numbers only."""
        joints = zip(self.robot.joints, self.places, strict=True)
        forms = [(joint.name, joint.type, joint.parent, joint.child, *where.items()) for joint, where in joints]
        return (*[link.name for link in self.robot.links], *forms)

    def with_numbers(self, name: str, table: Any) -> Robot:  # noqa: ANN401 - an array
        """The joints with the numbers of many files, a row for each."""
        numbers = _columns(table)
        joints = zip(self.robot.joints, self.places, strict=True)
        return replace(self.robot, name=name, joints=tuple([_with_numbers(*each, numbers) for each in joints]))


def joints_of(parts: Sequence[Part]) -> Joints:
    """The joints of files of some parts."""
    links = tuple([Link(name=name) for part in parts for name in part.links])
    joints = tuple([joint for part in parts for joint in part.joints])
    starts = accumulate([part.count for part in parts], initial=0)
    places = [
        {attribute: start + place for attribute, place in each.items()}
        for start, part in zip(starts, parts, strict=False)
        for each in part.places
    ]
    return Joints(robot=Robot(name="", links=links, joints=joints), places=tuple(places))


class Skeleton:
    """Files that are the same bytes, but for the numbers in them.

    Attributes:
        joints: the joints of such files.
        count: how many numbers of joints there are.
    """

    def __init__(self, parts: Sequence[Part], joints: Joints) -> None:
        """Files of some parts, whose joints are known."""
        self.joints, self.count = joints, sum([part.count for part in parts])
        self._parts = parts
        self._seen = 0
        self._first: list[bytes] = []
        self._varying: set[int] = set()
        self._traces: dict[int, int] = {}

    @property
    def of_joints(self) -> list[int]:
        """The places of the numbers of joints among the values of a file."""
        return self._places([part.of_joints for part in self._parts])

    def _places(self, of_parts: Iterable[Sequence[int]]) -> list[int]:
        starts = accumulate([part.values for part in self._parts], initial=0)
        return [start + place for start, places in zip(starts, of_parts, strict=False) for place in places]

    def see(self, text: bytes) -> Form | None:
        """Take notice of one more file.

        Args:
            text: what is after the robot's name in it.

        Returns:
            What all of them have in common besides, every time that they are twice as many.
        """
        self._seen += 1
        if self._seen % max(1, ENOUGH // _LOOKED_AT):
            return None
        pieces = text.split(b'"')
        values = pieces[1::2]
        if not self._first:
            self._first = values
            self._traces = dict.fromkeys([*self.of_joints, *self._places([part.others for part in self._parts])], 0)
        self._varying.update([place for place in self._traces if values[place] != self._first[place]])
        # Numbers with the same trace were the same text in every file; if not, a file is of no form, and that is all.
        self._traces = {place: hash((trace, values[place])) for place, trace in self._traces.items()}
        if self._seen >= ENOUGH and self._seen.bit_count() == 1:
            return Form(self, pieces, {place: self._traces[place] for place in sorted(self._varying)})
        return None


class Form:
    """What the files of a skeleton have in common besides their markup and words: all bytes between some numbers.

    An expression takes the numbers out of a file by the lengths of what is between them. The file is of this form if
    the same bytes come of the numbers and of what is between them here.

    Attributes:
        joints: their joints.
    """

    def __init__(self, skeleton: Skeleton, pieces: list[bytes], traces: Mapping[int, int]) -> None:
        """Learn from one of the files.

        Args:
            skeleton: the skeleton.
            pieces: what quotes cut the file into.
            traces: the places of the numbers that vary, with what those have in common that are always the same.
        """
        first = {trace: place for place, trace in reversed([*traces.items()])}
        groups = {place: number for number, place in enumerate(sorted(first.values()))}
        cuts = [-1, *[2 * place + 1 for place in traces], len(pieces)]
        between = [b'"'.join(pieces[start + 1 : end]) for start, end in pairwise(cuts)]
        self._pieces = [b""] * (2 * len(between) - 1)
        self._pieces[::2] = [b'"%b"' % text for text in between]
        self._pieces[0], self._pieces[-1] = self._pieces[0][1:], self._pieces[-1][:-1]
        # The quote before a number is looked at: where it is not in its place, the file is of another form.
        steps = [b".{%d}+" % len(between[0])]
        for (place, trace), text in zip(traces.items(), between[1:], strict=True):
            name, is_first = b"_%d" % groups[first[trace]], place in groups
            steps += (b'"', b'(?P<%b>[^"]*+)' % name if is_first else b"(?P=%b)" % name, b".{%d}+" % (len(text) + 1))
        self._match = re.compile(b"".join(steps), re.DOTALL).fullmatch
        self._fillings = picker([groups[first[trace]] for trace in traces.values()])
        values = pieces[1::2]
        of_joints = skeleton.of_joints
        moving = [place for place in of_joints if place in traces]
        columns, sources = _spans(values, of_joints), _spans(values, groups)
        text = b",".join([values[place] for place in groups])
        self.joints = skeleton.joints
        self._between = between_numbers(text)
        self._count = text.count(b" ") + text.count(b",") + 1 if groups else 0
        self._columns = [column for place in moving for column in columns[place]]
        self._sources = [source for place in moving for source in sources[first[traces[place]]]]
        self._row = numbers_in(b",".join([values[place] for place in of_joints])) or []

    def numbers(self, content: bytes, start: int) -> bytes | None:
        """The numbers that are to be read in a file, with commas between them; None where it is of another form.

        Args:
            content: the file.
            start: where the robot's name ends.
        """
        match = self._match(content, start)
        if match is None:
            return None
        texts = match.groups()
        pieces = self._pieces.copy()
        pieces[0] = content[:start] + pieces[0]
        pieces[1::2] = self._fillings(texts)
        return b",".join(texts) if content == b"".join(pieces) else None

    def rows(self, texts: Sequence[bytes]) -> tuple[list[int], Any]:
        """The numbers of the joints of files of this form.

        Args:
            texts: the numbers that are to be read in each.

        Returns:
            The places of the files in which they are numbers, as many as there should be, and a table with a row of
            the numbers of joints for each of these.
        """
        import numpy as np

        good, read = list(range(len(texts))), self._read(texts)
        if read is None:
            alone = {place: row for place, text in enumerate(texts) if (row := self._read([text])) is not None}
            good, read = list(alone), np.array([*alone.values()]).reshape(len(alone), len(self._columns))
        table = np.empty((len(good), len(self._row)))
        table[:] = self._row
        table[:, self._columns] = read
        return good, table

    def _read(self, texts: Sequence[bytes]) -> Any | None:  # noqa: ANN401 - an array
        """The numbers of joints among those that are read, a row for each file; None if one holds something else."""
        numbers: list[float] = []
        if self._count:
            text = b",".join(texts)
            # As there is a comma at least between two values, none is in them, and each has its own number of spaces.
            if between_numbers(text) != b",".join([self._between] * len(texts)):
                return None
            found = numbers_in(text)
            if found is None:
                return None
            numbers = found
        return array_of(numbers).reshape(len(texts), self._count)[:, self._sources]


def _spans(values: Sequence[bytes], places: Iterable[int]) -> dict[int, range]:
    """Where the numbers of some values are among all of theirs, by the places of the values."""
    counts = {place: values[place].count(b" ") + 1 for place in places}
    ends = accumulate(counts.values())
    return {place: range(end - count, end) for (place, count), end in zip(counts.items(), ends, strict=True)}


def _columns(rows: Any) -> list[Any]:  # noqa: ANN401 - an array
    """The columns of a table as `dh2urdf.columns` has them: a float where all rows have the same number."""
    table = rows.T.copy()
    alike = (table == table[:, :1]).all(axis=1)
    return [float(column[0]) if same else column for column, same in zip(table, alike, strict=True)]


def _with_numbers(joint: Joint, places: dict[Attribute, int], numbers: Sequence[Any]) -> Joint:
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
