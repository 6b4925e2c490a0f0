"""What plain URDF files with the same parts have in common, learned from the files: for `scanner`."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from operator import itemgetter
from typing import TYPE_CHECKING, Any, TypeAlias

import orjson

from dh2urdf.columns import LIMITS
from dh2urdf.manipulator import Limits
from dh2urdf.robot import Joint, Origin, Robot
from dh2urdf.rotations import ZERO, array_of

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    Attribute: TypeAlias = tuple[str, str]  # tag and name
    Picker: TypeAlias = Callable[[Sequence[bytes]], Sequence[bytes]]

IN_NUMBERS = b"0123456789.eE+-"
ENOUGH = 32
"""Files of the same parts from which on it pays to learn a form: an expression takes as long as thirty files."""
_LOOKED_AT = 4
"""Of every so many of them one is compared with the others."""
FORMS = 4
"""Forms that a file is compared with: files with the same parts are a quarter of all where they have one."""


@dataclass(frozen=True, slots=True, eq=False)
class Joints:
    """The joints of parts of files, or of files, that differ in numbers only."""

    robot: Robot  # with the joints of one of them, and the names of its links
    places: tuple[dict[Attribute, int], ...]  # for each joint, where among the numbers those of its attributes begin
    count: int  # how many numbers of joints there are

    @property
    def kind(self) -> object:
        """The same for joints that differ in numbers only."""
        joints = zip(self.robot.joints, self.places, strict=True)
        forms = [(each.name, each.type, each.parent, each.child, each.follows, *at.items()) for each, at in joints]
        return (*[link.name for link in self.robot.links], *forms)

    def with_numbers(self, name: str, rows: Any) -> Robot:  # noqa: ANN401 - an array
        """The joints with the numbers of many files, a row for each: a float where all rows have the same number."""
        table = rows.T.copy()
        alike = (table == table[:, :1]).all(axis=1)
        numbers = [float(column[0]) if same else column for column, same in zip(table, alike, strict=True)]
        joints = zip(self.robot.joints, self.places, strict=True)
        return replace(self.robot, name=name, joints=tuple([_with_numbers(*each, numbers) for each in joints]))


@dataclass(frozen=True, slots=True, eq=False)
class Part:
    """Parts of files, or files, that are the same bytes but for the numbers in them."""

    joints: Joints
    of_joints: tuple[int, ...]  # the places of the numbers of joints among the values of attributes
    others: tuple[int, ...]  # the places of the other numbers
    values: int  # how many values there are


class Alike:
    """Files that consist of the same parts, and their joints."""

    def __init__(self, joints: Joints, parts: tuple[Part, ...]) -> None:
        self.joints, self._parts = joints, parts
        self._seen, self._since = 0, 0
        self._first: list[bytes] = []
        self._varying: set[int] = set()
        self._traces: dict[int, int] = {}

    def see(self, text: bytes, total: int) -> Form | None:
        """Compares one more file of `total`, of any parts; returns their form each time that they are twice as many."""
        self._since = self._since or total
        self._seen += 1
        if self._seen % _LOOKED_AT or self._seen * FORMS < total - self._since:
            return None
        values = text.split(b'"')[1::2]
        if not self._first:
            starts = [*accumulate([part.values for part in self._parts], initial=0)]
            of_joints, others = (
                tuple([start + place for start, each in zip(starts, places, strict=False) for place in each])
                for places in ([part.of_joints for part in self._parts], [part.others for part in self._parts])
            )
            self._first, self._part = values, Part(self.joints, of_joints, others, starts[-1])
            self._traces = dict.fromkeys(sorted((*self._part.of_joints, *self._part.others)), 0)
        self._varying.update([place for place in self._traces if values[place] != self._first[place]])
        # Numbers with the same trace were the same text in every file. Where this is wrong, a file has no form.
        self._traces = {place: hash((trace, values[place])) for place, trace in self._traces.items()}
        if self._seen < ENOUGH or self._seen.bit_count() != 1:
            return None
        return Form(self._part, text.split(b'"'), {place: self._traces[place] for place in sorted(self._varying)})


class Form:
    """What files of the same parts have in common besides: all bytes between the numbers that vary.

    An expression takes these numbers out of a file by the lengths of what is between them; a number that is written
    twice is taken once. If the numbers and what is between them here make the same bytes again, the file has this form.

    Args:
        part: what such files are.
        pieces: what the quotes cut one of them into.
        traces: the places of the values that vary; values with the same trace are the same text.
    """

    def __init__(self, part: Part, pieces: list[bytes], traces: dict[int, int]) -> None:
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
        self._fillings = picker([groups[first[trace]] for trace in traces.values()])
        self._pieces = [b""] * (2 * len(between) - 1)
        self._pieces[::2] = [b'"%b"' % text for text in between]
        self._pieces[0] = self._pieces[0][1:]
        self._pieces[-1] = self._pieces[-1][:-1]
        columns, sources = _spans(values, part.of_joints), _spans(values, groups)
        moving = [place for place in part.of_joints if place in traces]
        text = b",".join([values[place] for place in groups])
        self._between, self._count = text.translate(None, IN_NUMBERS), sum(map(len, sources.values()))
        self._columns = [column for place in moving for column in columns[place]]
        self._sources = [source for place in moving for source in sources[first[traces[place]]]]
        self._row = numbers_in(b",".join([values[place] for place in part.of_joints])) or []

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
            if text.translate(None, IN_NUMBERS) != b",".join([self._between] * len(texts)):
                return None
            if (numbers := numbers_in(text)) is None:
                return None
            table[:, self._columns] = array_of(numbers).reshape(len(texts), self._count)[:, self._sources]
        return table


def _spans(values: Sequence[bytes], places: Iterable[int]) -> dict[int, range]:
    """Where the numbers of some values are among the numbers of all of these, by the places of the values."""
    counts = {place: values[place].count(b" ") + 1 for place in places}
    ends = accumulate(counts.values())
    return {place: range(end - count, end) for (place, count), end in zip(counts.items(), ends, strict=True)}


def numbers_in(text: bytes) -> list[float] | None:
    """The numbers of a text, with a space or a comma between them; None where JSON does not write them so."""
    try:
        numbers: list[float] = orjson.loads(b"[%b]" % text.replace(b" ", b","))
    except orjson.JSONDecodeError:
        return None
    return numbers or None


def picker(places: Sequence[int]) -> Picker:
    """What picks the values at some places."""
    return itemgetter(*places) if len(places) > 1 else lambda values: tuple([values[place] for place in places])


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
        limits=Limits(**{name: number("limit", name) for name in LIMITS}),
        damping=number("dynamics", "damping"),
        friction=number("dynamics", "friction"),
    )
