"""Many manipulators, or many robots, side by side: records whose numbers are columns.

Manipulators whose tables differ in numbers only are one table of which every number is a column: an array with an entry
for each of them. A formula of sums and products, applied to columns, is applied to all of them at once, to the last bit
as it would be to each. A number that all have alike is a float.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field, replace
from operator import attrgetter
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.manipulator import DHRow, Inertia, Limits, Manipulator
from dh2urdf.robot import Robot
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Callable, Hashable, Sequence

Mask: TypeAlias = Any
"""An array of booleans; numpy is imported where there is one."""
Shape: TypeAlias = tuple[int, int]
"""A collision shape: the number of its link in the robot, and its own in the link, both from 0."""

_names_of = attrgetter("joint", "link", "type", "sign")
_NUMBERS = ("a", "alpha", "d", "theta", "offset", "mass", "radius", "damping", "friction")
_LIMITS = ("lower", "upper", "velocity", "effort")
_INERTIA = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
_numbers_of = attrgetter(*_NUMBERS, *(f"limits.{name}" for name in _LIMITS))


@dataclass(frozen=True, slots=True, kw_only=True)
class ManipulatorColumns:
    """Manipulators whose tables differ in numbers only.

    Attributes:
        table: a manipulator whose rows hold floats, where all have the same number, and arrays of shape (N,) elsewhere.
        names: their names, N of them.
        marks: the place of each in its file.
    """

    table: Manipulator
    names: tuple[str, ...]
    marks: tuple[Mark | None, ...]

    def __len__(self) -> int:
        return len(self.names)

    def pick(self, index: int) -> Manipulator:
        """One of them, as it was, but for the marks of its rows."""
        rows = tuple(_mapped(row, lambda numbers: entry(numbers, index)) for row in self.table.rows)
        return replace(self.table, name=self.names[index], rows=rows, mark=self.marks[index])

    def take(self, indices: Sequence[int]) -> ManipulatorColumns:
        """Some of them."""
        rows = tuple(_mapped(row, lambda numbers: _entries(numbers, indices)) for row in self.table.rows)
        return ManipulatorColumns(
            table=replace(self.table, rows=rows),
            names=tuple(self.names[index] for index in indices),
            marks=tuple(self.marks[index] for index in indices),
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


def in_columns(manipulators: Sequence[Manipulator]) -> list[tuple[list[int], ManipulatorColumns]]:
    """Manipulators in groups that differ in numbers only, each with the places of its members in the sequence.

    The marks of their rows are left out; notices keep a manipulator apart from all that have others.
    """
    groups: defaultdict[Hashable, list[int]] = defaultdict(list)
    numbers: list[list[tuple[Any, ...]]] = []
    for index, manipulator in enumerate(manipulators):
        rows = manipulator.rows
        values = [_numbers_of(row) for row in rows]
        shape = tuple([tuple([value is None for value in row]) for row in values])
        bodies = tuple([(row.com is None, row.inertia is None) for row in rows])
        groups[_common(manipulator), tuple(map(_names_of, rows)), shape, bodies].append(index)
        numbers.append(values)
    return [
        (indices, _columns([manipulators[i] for i in indices], [numbers[i] for i in indices]))
        for indices in groups.values()
    ]


def _common(manipulator: Manipulator) -> Hashable:
    """What is not in the rows, without the name."""
    m = manipulator
    return m.convention, m.base, m.tool, m.geometry, m.density, m.base_mass, m.base_geometry, m.notices


def _columns(manipulators: list[Manipulator], numbers: list[list[tuple[Any, ...]]]) -> ManipulatorColumns:
    model = manipulators[0]
    rows = []
    for index, row in enumerate(model.rows):
        columns = [column(entries) for entries in zip(*[table[index] for table in numbers], strict=True)]
        named = dict(zip(_NUMBERS, columns, strict=False))
        com, inertia = row.com, row.inertia
        if com is not None:
            x, y, z = (
                column(entries)
                for entries in zip(*[table.rows[index].com or () for table in manipulators], strict=True)
            )
            com = (x, y, z)
        if inertia is not None:
            tensors = [table.rows[index].inertia for table in manipulators]
            inertia = Inertia(**{name: column([getattr(tensor, name) for tensor in tensors]) for name in _INERTIA})
        limits = Limits(**dict(zip(_LIMITS, columns[len(_NUMBERS) :], strict=True)))
        rows.append(replace(row, **named, com=com, inertia=inertia, limits=limits, mark=None))
    return ManipulatorColumns(
        table=replace(model, name="", rows=tuple(rows), mark=None),
        names=tuple([manipulator.name for manipulator in manipulators]),
        marks=tuple([manipulator.mark for manipulator in manipulators]),
    )


def column(entries: Sequence[Any]) -> Any:  # noqa: ANN401 - None, a float or an array
    """Numbers as an array of float64; as one float where all are the same, None where there is none."""
    first = entries[0]
    if first is None or entries.count(first) == len(entries):
        return first
    import numpy as np

    return np.array(entries, dtype=float)


def entry(numbers: Any, index: int) -> Any:  # noqa: ANN401 - None, a float or an array
    """The number of one member of a column."""
    return float(numbers[index]) if hasattr(numbers, "shape") else numbers


def _entries(numbers: Any, indices: Sequence[int]) -> Any:  # noqa: ANN401 - None, a float or an array
    return column([float(numbers[index]) for index in indices]) if hasattr(numbers, "shape") else numbers


def _mapped(row: DHRow, change: Callable[[Any], Any]) -> DHRow:
    """A row with something else in place of each of its numbers."""
    numbers = {name: change(getattr(row, name)) for name in _NUMBERS}
    limits = Limits(**{name: change(getattr(row.limits, name)) for name in _LIMITS})
    com, inertia = row.com, row.inertia
    if com is not None:
        com = (change(com[0]), change(com[1]), change(com[2]))
    if inertia is not None:
        inertia = Inertia(**{name: change(getattr(inertia, name)) for name in _INERTIA})
    return replace(row, **numbers, limits=limits, com=com, inertia=inertia)
