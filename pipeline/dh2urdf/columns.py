"""Many manipulators, or many robots, side by side: records whose numbers are columns.

Manipulators whose tables differ in numbers only are one table of which every number is a column: an array with an entry
for each of them. A formula of sums and products, applied to columns, is applied to all of them at once, to the last bit
as it would be to each. A number that all have alike is a float.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import cache
from itertools import chain, repeat
from operator import attrgetter, is_
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar, cast

from dh2urdf.elementwise import is_column
from dh2urdf.manipulator import Inertia, Limits, Manipulator
from dh2urdf.robot import Robot
from dh2urdf.row_fields import COMMON, INERTIA, LIMITS, NUMBERS, WORDS
from dh2urdf.source import Mark
from dh2urdf.validation.coercion import replace_unchecked

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

T = TypeVar("T")
Mask: TypeAlias = Any
"""An array of booleans; numpy is imported where there is one."""
Shape: TypeAlias = tuple[int, int]
"""A collision shape: the number of its link in the robot, and its own in the link, both from 0."""

PlaceInFile: TypeAlias = tuple[int | None, int | None, str | None]
"""Line and column, and the name of the place where the format has one: what a mark has beside its file."""

_place_of = attrgetter("line", "column", "place")
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

    def pick(self, index: int) -> Manipulator:
        """One of them, as it was."""
        table = member(self.table, index)
        mark = self.marks[index]
        rows = [
            replace(row, mark=replace(mark, line=place[0], column=place[1], place=place[2])) if mark and place else row
            for row, place in zip(table.rows, self.lines[index], strict=True)
        ]
        return replace(table, name=self.names[index], rows=tuple(rows), mark=mark)

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
        links = [
            replace(
                link,
                collisions=tuple(
                    shape for number, shape in enumerate(link.collisions) if (place, number) not in missing
                ),
            )
            for place, link in enumerate(robot.links)
        ]
        return replace(robot, name=self.names[index], comment=self.comments[index], links=tuple(links))


def in_columns(manipulators: Sequence[Manipulator]) -> list[tuple[list[int], ManipulatorColumns]]:
    """Manipulators in groups that differ in numbers only, each with the places of its members in the sequence.

    Notices keep a manipulator apart from all that have others.
    """
    groups: defaultdict[Hashable, list[int]] = defaultdict(list)
    numbers: list[tuple[Any, ...]] = []
    for index, manipulator in enumerate(manipulators):
        said = tuple(chain.from_iterable(map(_numbers_of, manipulator.rows)))
        missing = bytes(map(is_, said, repeat(None)))
        words = tuple(map(_words_of, manipulator.rows))
        # A mesh is named in one place for all of a group: problems with it are reported there.
        shapes = chain.from_iterable(map(_meshes_of, manipulator.rows))
        marks = tuple([shape.mark for shape in shapes if shape])
        groups[_common_of(manipulator), words, marks, missing].append(index)
        numbers.append(said)
    return [
        (indices, _columns([manipulators[i] for i in indices], [numbers[i] for i in indices]))
        for indices in groups.values()
    ]


def _columns(manipulators: list[Manipulator], numbers: list[tuple[Any, ...]]) -> ManipulatorColumns:
    model = manipulators[0]
    columns = zip(*numbers, strict=True)
    rows = []
    for row in model.rows:
        com, tensors = next(columns), next(columns)
        named = {name: column(next(columns)) for name in NUMBERS}
        limits = Limits(**{name: column(next(columns)) for name in LIMITS})
        rows.append(replace_unchecked(row, **named, com=_com(com), inertia=_inertia(tensors), limits=limits, mark=None))
    return ManipulatorColumns(
        table=replace_unchecked(model, name="", rows=tuple(rows), mark=None),
        names=tuple([manipulator.name for manipulator in manipulators]),
        marks=tuple([manipulator.mark for manipulator in manipulators]),
        lines=tuple([row_places(table) for table in manipulators]),
    )


def row_places(table: Manipulator) -> tuple[PlaceInFile | None, ...]:
    """The place of every row."""
    return tuple([_place_of(row.mark) if row.mark else None for row in table.rows])


def _com(centres: Sequence[Any]) -> Any:  # noqa: ANN401 - None, or a vector of columns
    if centres[0] is None:
        return None
    return tuple([column(coordinates) for coordinates in zip(*centres, strict=True)])


def _inertia(tensors: Sequence[Any]) -> Inertia | None:
    if tensors[0] is None:
        return None
    return Inertia(**{name: column([getattr(tensor, name) for tensor in tensors]) for name in INERTIA})


def column(entries: Sequence[Any]) -> Any:  # noqa: ANN401 - None, a float or an array
    """Numbers as an array of float64; as one float where all are the same, None where there is none."""
    first = entries[0]
    if first is None or entries.count(first) == len(entries):
        return first
    import numpy as np

    return np.array(entries, dtype=float)


def _alike(numbers: Any) -> Any:  # noqa: ANN401 - a float or an array
    """Numbers of an array, as one float where all are the same; an empty array stays one."""
    return float(numbers[0]) if len(numbers) and (numbers == numbers[0]).all() else numbers


def replaced(record: T, change: Callable[[Any], Any]) -> T:
    """A record with something else in place of each of its columns."""
    value: Any = record
    kind: Any = type(value)
    if is_column(value):
        return cast("T", change(value))
    if isinstance(value, tuple):
        items = [replaced(item, change) for item in value]
        if all(new is old for new, old in zip(items, value, strict=True)):
            return record
        return cast("T", kind(*items) if hasattr(value, "_fields") else tuple(items))
    changed = {}
    for name in _field_names(kind):
        old = getattr(value, name)
        if (new := replaced(old, change)) is not old:
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
