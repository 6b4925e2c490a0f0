"""Many manipulators, or many robots, side by side: records whose numbers are columns.

Manipulators whose tables differ in numbers only are one table of which every number is a column: an array with an entry
for each of them. A formula of sums and products, applied to columns, is applied to all of them at once, to the last bit
as it would be to each. A number that all have alike is a float.

The numbers of a row are here in one place: what each measures, which joints have it, and which values it takes.
Columns, the keys of `--resume`, texts of tables, variations, checks and reports take their lists from here, and these
come from the fields of the records: a number that is added to `DHRow` and to `ROW_FIELDS` is in all of them.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cache, partial
from itertools import chain, repeat
from operator import attrgetter, is_, ne
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias, TypeVar, cast

from dh2urdf.fields import many_unchecked, members_of, replace_unchecked
from dh2urdf.manipulator import DHRow, Inertia, JointType, Limits, Manipulator
from dh2urdf.quantities.units import Dimension
from dh2urdf.robot import Joint, Robot
from dh2urdf.rotations import array_of, is_column
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Iterable, Sequence

# --- The numbers of a row ---------------------------------------------------------------------------------------------

NUMBERS = tuple(field.name for field in fields(DHRow) if field.type in {"float", "float | None"})
"""The fields of a row that are one number each."""
LIMITS = tuple(field.name for field in fields(Limits))
"""The limits of its joint."""
BOUNDS = ("lower", "upper")
"""Those of them that bound the joint value; the others are greater than 0."""
COM = ("com_x", "com_y", "com_z")
"""The coordinates of its centre of mass."""
INERTIA = tuple(field.name for field in fields(Inertia))
"""The elements of its inertia tensor."""
WORDS = tuple(field.name for field in fields(DHRow) if field.name not in {*NUMBERS, "limits", "com", "inertia", "mark"})
"""The fields of a row that are no numbers, or as the sign none that a column holds."""
COMMON = tuple(field.name for field in fields(Manipulator) if field.name not in {"name", "rows", "mark"})
"""The fields of a manipulator that its rows have nothing to do with."""
DYNAMICS = tuple(name for name in NUMBERS if name in {field.name for field in fields(Joint)})
"""What a joint resists its motion with: the numbers that go from the row to the joint as they are."""

_MOVING = frozenset(JointType) - {JointType.FIXED}
_BOUNDED = frozenset({JointType.REVOLUTE, JointType.PRISMATIC})

SI_UNITS = {
    Dimension.LENGTH: "m",
    Dimension.ANGLE: "rad",
    Dimension.SPEED: "m/s",
    Dimension.TURN_RATE: "rad/s",
    Dimension.ACCELERATION: "m/s²",
    Dimension.TURN_ACCELERATION: "rad/s²",
    Dimension.JERK: "m/s³",
    Dimension.TURN_JERK: "rad/s³",
    Dimension.FORCE: "N",
    Dimension.TORQUE: "N·m",
    Dimension.DAMPING: "N·m·s/rad",
    Dimension.LINEAR_DAMPING: "N·s/m",
    Dimension.MASS: "kg",
    Dimension.INERTIA: "kg·m²",
}
"""The unit of each dimension in records and reports."""


class RowField(NamedTuple):
    """A number of a row.

    Attributes:
        dimension: what it measures; None for words and counts.
        linear: what it measures in the row of a prismatic joint, where that is something else.
        types: the types of joints that have it.
        positive: whether it must be greater than 0.
        negative: whether it may be less than 0.
    """

    dimension: Dimension | None
    linear: Dimension | None = None
    types: frozenset[JointType] = frozenset(JointType)
    positive: bool = False
    negative: bool = True

    def of(self, kind: JointType) -> Dimension | None:
        """What it measures in the row of a type of joint."""
        return self.linear if self.linear and kind is JointType.PRISMATIC else self.dimension

    def takes(self, numbers: Any) -> Any:  # noqa: ANN401 - a number, or a column of them
        """Whether it may have a value, for each of a column; that numbers are finite is another matter."""
        if self.positive:
            return numbers > 0.0
        return (numbers >= 0.0) | self.negative

    @property
    def bound(self) -> str:
        """What `takes` asks of a number, as the end of a sentence; empty where it takes any."""
        return "greater than 0" if self.positive else "" if self.negative else "0 or greater"


ROW_FIELDS = {
    "a": RowField(Dimension.LENGTH),
    "d": RowField(Dimension.LENGTH),
    "alpha": RowField(Dimension.ANGLE),
    "theta": RowField(Dimension.ANGLE),
    "offset": RowField(Dimension.ANGLE, Dimension.LENGTH, types=_MOVING),
    "lower": RowField(Dimension.ANGLE, Dimension.LENGTH, types=_BOUNDED),
    "upper": RowField(Dimension.ANGLE, Dimension.LENGTH, types=_BOUNDED),
    "velocity": RowField(Dimension.TURN_RATE, Dimension.SPEED, types=_MOVING, positive=True),
    "effort": RowField(Dimension.TORQUE, Dimension.FORCE, types=_MOVING, positive=True),
    "acceleration": RowField(Dimension.TURN_ACCELERATION, Dimension.ACCELERATION, types=_MOVING, positive=True),
    "jerk": RowField(Dimension.TURN_JERK, Dimension.JERK, types=_MOVING, positive=True),
    "mass": RowField(Dimension.MASS, positive=True),
    "radius": RowField(Dimension.LENGTH, positive=True),
    "damping": RowField(Dimension.DAMPING, Dimension.LINEAR_DAMPING, types=_MOVING, negative=False),
    "friction": RowField(Dimension.TORQUE, Dimension.FORCE, types=_MOVING, negative=False),
    "armature": RowField(Dimension.INERTIA, Dimension.MASS, types=_MOVING, negative=False),
    **dict.fromkeys(COM, RowField(Dimension.LENGTH)),
    **dict.fromkeys(INERTIA, RowField(Dimension.INERTIA)),
}
"""All numbers of a row, by the names that tables and run files have for them."""


# --- Side by side -----------------------------------------------------------------------------------------------------

T = TypeVar("T")
Mask: TypeAlias = Any
"""An array of booleans; numpy is imported where there is one."""
Shape: TypeAlias = tuple[int, int]
"""A collision shape: the number of its link in the robot, and its own in the link, both from 0."""

PlaceInFile: TypeAlias = int | tuple[int | None, int | None, str | None]
"""A line; or line and column, and the name of the place where the format has one: what a mark has beside its file."""

_MARK = ("file", "line", "column", "place")
_parts_of = attrgetter(*_MARK)
_words_of = attrgetter(*WORDS)
_meshes_of = attrgetter("visual", "collision")
_numbers_of = attrgetter("com", "inertia", *NUMBERS, *(f"limits.{name}" for name in LIMITS))
_common_of = attrgetter(*COMMON)


@dataclass(frozen=True, slots=True, kw_only=True)
class ManipulatorColumns:
    """Manipulators whose tables differ in numbers only.

    Attributes:
        table: a manipulator whose rows hold floats, where all have the same number, and arrays of shape (N,) elsewhere.
        names: their names, N of them.
        marks: the place of each in its file.
        lines: the place of every row of each, in the same file.
    """

    table: Manipulator
    names: tuple[str, ...]
    marks: tuple[Mark | None, ...]
    lines: tuple[tuple[PlaceInFile | None, ...], ...]

    def __len__(self) -> int:
        return len(self.names)

    def __reduce_ex__(self, protocol: Any) -> tuple[Any, ...] | str:  # noqa: ANN401 - a number
        """Pickled with the parts of all marks in columns: mark by mark takes three times as long."""
        if set(map(type, self.marks)) != {Mark}:
            return object.__reduce_ex__(self, protocol)
        return _with_marks, (replace_unchecked(self, marks=()), *zip(*map(_parts_of, self.marks), strict=True))

    @classmethod
    def like(
        cls,
        model: Manipulator,
        *,
        rows: tuple[DHRow, ...],
        names: Iterable[str],
        marks: Iterable[Mark | None],
        lines: Iterable[tuple[PlaceInFile | None, ...]],
    ) -> ManipulatorColumns:
        """Manipulators of some rows that are like another one in everything else."""
        table = replace_unchecked(model, name="", rows=rows, mark=None)
        return cls(table=table, names=tuple(names), marks=tuple(marks), lines=tuple(lines))

    def pick(self, index: int) -> Manipulator:
        """One of them, as it was."""
        (table,) = self.tables([index])
        return table

    def tables(self, indices: Sequence[int] | None = None) -> list[Manipulator]:
        """Some of them, or all, as they were."""
        members = list(range(len(self)) if indices is None else indices)
        marks = [self.marks[index] for index in members]
        lines = [self.lines[index] for index in members]
        rows = [
            many_unchecked(
                row, len(members), **members_of(row, members), mark=_marks(marks, [own[n] for own in lines], row.mark)
            )
            for n, row in enumerate(self.table.rows)
        ]
        return many_unchecked(
            self.table,
            len(members),
            **members_of(replace_unchecked(self.table, rows=()), members),
            name=[self.names[index] for index in members],
            rows=list(zip(*rows, strict=True)),
            mark=marks,
        )

    def take(self, indices: Sequence[int]) -> ManipulatorColumns:
        """Some of them, in the order of their indices."""
        indices = list(indices)  # A tuple is another kind of index to numpy.
        return ManipulatorColumns(
            table=replaced(self.table, lambda numbers: _alike(numbers[indices])),
            names=tuple([self.names[index] for index in indices]),
            marks=tuple([self.marks[index] for index in indices]),
            lines=tuple([self.lines[index] for index in indices]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RobotColumns:
    """Robots that differ in numbers only.

    Attributes:
        robot: a robot whose links and joints hold floats, where all have the same number, and arrays of shape (N,)
            elsewhere; its name and its comment are the first one's.
        names: their names, N of them.
        comments: one line for a reader of each file.
        sure: array of N booleans: which of them are robots beyond doubt, about which there is nothing to say; the
            others have to be made one by one.
        present: for collision shapes that not all of them have: array of N booleans, which have it.
    """

    robot: Robot
    names: tuple[str, ...]
    comments: tuple[str, ...]
    sure: Mask
    present: dict[Shape, Mask] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.names)

    def pick(self, index: int) -> Robot:
        """One of them."""
        robot = member(self.robot, index)
        missing = {shape for shape, present in self.present.items() if not present[index]}
        links = []
        for place, link in enumerate(robot.links):
            there = [shape for number, shape in enumerate(link.collisions) if (place, number) not in missing]
            links.append(replace(link, collisions=tuple(there)))
        return replace(robot, name=self.names[index], comment=self.comments[index], links=tuple(links))


@dataclass(frozen=True, slots=True, kw_only=True)
class ManipulatorGroups:
    """Manipulators that follow each other, in groups that differ in numbers only.

    Attributes:
        groups: each with the places of its members among them all, in ascending order. Every place from 0 is in one.
    """

    groups: tuple[tuple[tuple[int, ...], ManipulatorColumns], ...]

    def __len__(self) -> int:
        return sum([len(places) for places, _ in self.groups])

    @property
    def names(self) -> list[str]:
        """Their names, in their order."""
        return self._in_order([some.names for _, some in self.groups])

    @property
    def marks(self) -> list[Mark | None]:
        """The place of each in its file, in their order."""
        return self._in_order([some.marks for _, some in self.groups])

    def tables(self) -> list[Manipulator]:
        """All of them, in their order."""
        return self._in_order([some.tables() for _, some in self.groups])

    def _in_order(self, values: Sequence[Sequence[T]]) -> list[T]:
        if len(values) == 1:
            return list(values[0])
        found = {
            place: value
            for (own, _), some in zip(self.groups, values, strict=True)
            for place, value in zip(own, some, strict=True)
        }
        return [found[place] for place in range(len(found))]

    def part(self, start: int, stop: int) -> ManipulatorGroups:
        """Those from one place to before another one."""
        found = []
        for places, some in self.groups:
            members = [member for member, place in enumerate(places) if start <= place < stop]
            if members:
                own = tuple([places[member] - start for member in members])
                found.append((own, some if len(members) == len(places) else some.take(members)))
        return ManipulatorGroups(groups=tuple(found))


def in_columns(
    manipulators: Sequence[Manipulator | ManipulatorColumns],
) -> list[tuple[list[int], ManipulatorColumns]]:
    """Manipulators in groups that differ in numbers only, each with the places of its members in the sequence.

    Columns in the sequence stand for as many manipulators as they have. Notices keep a manipulator apart from all that
    have others.
    """
    groups: defaultdict[Hashable, list[int]] = defaultdict(list)
    numbers: list[tuple[Any, ...]] = []
    starts: list[int] = []
    count = 0
    for index, each in enumerate(manipulators):
        table = each.table if isinstance(each, ManipulatorColumns) else each
        said = tuple(chain.from_iterable(map(_numbers_of, table.rows)))
        missing = bytes(map(is_, said, repeat(None)))
        words = tuple(map(_words_of, table.rows))
        # A mesh is named in one place for all of a group: problems with it are reported there.
        shapes = chain.from_iterable(map(_meshes_of, table.rows))
        marks = tuple([shape.mark for shape in shapes if shape])
        groups[_common_of(table), words, marks, missing].append(index)
        numbers.append(said)
        starts.append(count)
        count += len(each) if isinstance(each, ManipulatorColumns) else 1
    starts.append(count)
    return [
        (
            [place for index in indices for place in range(starts[index], starts[index + 1])],
            _columns([manipulators[index] for index in indices], [numbers[index] for index in indices]),
        )
        for indices in groups.values()
    ]


def _columns(some: list[Manipulator | ManipulatorColumns], numbers: list[tuple[Any, ...]]) -> ManipulatorColumns:
    first = some[0]
    if len(some) == 1 and isinstance(first, ManipulatorColumns):
        return first
    counts = [len(each) if isinstance(each, ManipulatorColumns) else 0 for each in some]
    joined = partial(_joined, counts=counts) if any(counts) else column
    columns = zip(*numbers, strict=True)
    model = first.table if isinstance(first, ManipulatorColumns) else first
    rows = []
    for row in model.rows:
        com, tensors = next(columns), next(columns)
        changes: dict[str, Any] = {name: joined(next(columns)) for name in NUMBERS}
        changes["limits"] = Limits(**{name: joined(next(columns)) for name in LIMITS})
        if com[0] is not None:
            changes["com"] = tuple([joined(coordinates) for coordinates in zip(*com, strict=True)])
        if tensors[0] is not None:
            of_all = {name: joined([getattr(tensor, name) for tensor in tensors]) for name in INERTIA}
            changes["inertia"] = Inertia(**of_all)
        rows.append(replace_unchecked(row, **changes, mark=None))
    told = [
        (each.names, each.marks, each.lines)
        if isinstance(each, ManipulatorColumns)
        else ((each.name,), (each.mark,), (row_places(each),))
        for each in some
    ]
    names, marks, lines = [tuple(chain.from_iterable(parts)) for parts in zip(*told, strict=True)]
    return ManipulatorColumns.like(model, rows=tuple(rows), names=names, marks=marks, lines=lines)


def row_places(table: Manipulator) -> tuple[PlaceInFile | None, ...]:
    """The place of every row."""
    return tuple([_parts_of(row.mark)[1:] if row.mark else None for row in table.rows])


def column(entries: Sequence[Any]) -> Any:  # noqa: ANN401 - None, a float or an array
    """Numbers as an array of float64; as one float where all are the same, None where there is none."""
    first = entries[0]
    if first is None or entries.count(first) == len(entries):
        return first
    return array_of(entries)


def _joined(entries: Sequence[Any], counts: Sequence[int]) -> Any:  # noqa: ANN401 - None, a float or an array
    """Columns and numbers behind each other, as `column` has them.

    A number is that of a column all of whose members have it, `counts` of them; 0 counts one by itself.
    """
    first = entries[0]
    if first is None or not (any(map(is_column, entries)) or any(map(ne, entries, repeat(first)))):
        return first
    import numpy as np

    parts = [
        each if is_column(each) else np.full(max(1, count), each) for each, count in zip(entries, counts, strict=True)
    ]
    return _alike(np.concatenate(parts, dtype=float))


def _alike(numbers: Any) -> Any:  # noqa: ANN401 - a float or an array
    """Numbers of an array, as one float where all are the same; an empty array stays one."""
    return float(numbers[0]) if len(numbers) and (numbers == numbers[0]).all() else numbers


_PLAIN = frozenset((float, int, bool, str, type(None), JointType, Mark))
"""Types of what is neither a column nor holds one: most of what is in a record."""


def replaced(record: T, change: Callable[[Any], Any]) -> T:
    """A record with something else in place of each of its columns."""
    value: Any = record
    kind: Any = type(value)
    if is_column(value):
        return cast("T", change(value))
    if isinstance(value, tuple):
        items = [item if type(item) in _PLAIN else replaced(item, change) for item in value]
        if all(map(is_, items, value)):
            return record
        return cast("T", kind(*items) if hasattr(value, "_fields") else tuple(items))
    changed = {}
    for name in _field_names(kind):
        old = getattr(value, name)
        if type(old) not in _PLAIN and (new := replaced(old, change)) is not old:
            changed[name] = new
    return cast("T", replace_unchecked(value, **changed)) if changed else record


def stacked(records: Sequence[T]) -> T:
    """One record for several that differ in numbers only: a float that not all of them have alike is a column.

    Texts and all else are those of the first record.

    Raises:
        ValueError: they have different structures.
    """
    first: Any = records[0]
    kind: Any = type(first)
    if any(type(other) is not kind for other in records):
        raise ValueError(f"not each of these records has a {kind.__name__} in the same place")
    if kind is float:
        return cast("T", column(records))
    if isinstance(first, tuple):
        items = [stacked(own) for own in zip(*cast("Any", records), strict=True)]
        return cast("T", kind(*items) if hasattr(first, "_fields") else tuple(items))
    if names := _field_names(kind):
        changes = {name: stacked([getattr(record, name) for record in records]) for name in names}
        return cast("T", replace_unchecked(first, **changes))
    return cast("T", first)


def _marks(
    marks: Sequence[Mark | None], places: Sequence[PlaceInFile | None], known: Mark | None
) -> Sequence[Mark | None]:
    """The places of a row of many manipulators, in the files of these; the known one where they have none."""
    found = [(mark, place) for mark, place in zip(marks, places, strict=True) if mark and place]
    if not found:
        return [known] * len(marks)
    whole = [(place, None, None) if isinstance(place, int) else place for _, place in found]
    others = iter(_marks_of([mark.file for mark, _ in found], *zip(*whole, strict=True)))
    return [next(others) if mark and place else known for mark, place in zip(marks, places, strict=True)]


def _marks_of(*parts: Sequence[Any]) -> list[Mark]:
    """Marks of files, lines, columns and names of places."""
    return many_unchecked(Mark(file=""), len(parts[0]), **dict(zip(_MARK, parts, strict=True)))


def _with_marks(some: ManipulatorColumns, *parts: Sequence[Any]) -> ManipulatorColumns:
    return replace_unchecked(some, marks=tuple(_marks_of(*parts)))


@cache
def _field_names(kind: Any) -> tuple[str, ...]:  # noqa: ANN401 - any type
    """The fields of a record; none of what is no record."""
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else ()


def member(record: T, index: int) -> T:
    """One of the members of a record whose numbers are columns."""
    return replaced(record, lambda numbers: float(numbers[index]))


def columns_of(record: object) -> list[Any]:
    """The columns of a record, in the order of its fields."""
    found: list[Any] = []

    def note(numbers: Any) -> Any:  # noqa: ANN401 - an array
        found.append(numbers)
        return numbers

    replaced(record, note)
    return found
