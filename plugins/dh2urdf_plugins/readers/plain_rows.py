"""The fast way through a CSV table: rows about which there is nothing to say.

Most rows of a large table are plain decimal numbers, known words and names that were seen before. They are read
column by column, at the speed of Python's own loops. Whatever is not surely plain is left to `RowReader`, which alone
defines what a table means: here a row is read as that would read it, or not at all.
"""

from __future__ import annotations

import math
from dataclasses import fields
from itertools import accumulate, chain, repeat
from operator import add
from typing import TYPE_CHECKING, Any

from dh2urdf.manipulator import DHRow, JointType, Limits
from dh2urdf.quantities import Dimension
from dh2urdf.rotations import HALF_PI, quarter_turns
from dh2urdf.source import Mark
from dh2urdf_plugins.readers.fields import FIELDS, joint_type
from dh2urdf_plugins.readers.names import END_NAMES, RowNames, name_fault, name_problems
from dh2urdf_plugins.readers.rows import FULL_TURN, LARGEST_ANGLE, LARGEST_LIMIT, NEARLY, NO_LIMITS
from dh2urdf_plugins.readers.tables import LONGEST_ARM

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    from dh2urdf.quantities import Unit
    from dh2urdf_plugins.readers.cells import Units
    from dh2urdf_plugins.readers.csv_header import Columns

_GEOMETRY = ("a", "alpha", "d", "theta", "offset")
_LIMITS = ("lower", "upper", "velocity", "effort")
_WORDS = ("robot", "index", "joint", "link", "type")
_REMEMBERED = 10_000
"""Sets of names, limits and angles that are remembered [1]."""


class _Row:
    """The same slots as a `DHRow`, filled without the price of a frozen dataclass.

    Frozen dataclasses set each slot through `object.__setattr__`: 1.4 µs for a row, seven times this. Python lets the
    class of an object be changed to one with the same slots, and so a `DHRow` is made that is like any other.
    """

    __slots__ = tuple(field.name for field in fields(DHRow))

    def __init__(  # noqa: PLR0917 - by position: this is the inner loop
        self,
        joint: str,
        link: str,
        kind: JointType,
        a: float,
        alpha: float,
        d: float,
        theta: float,
        offset: float,
        limits: Limits,
        mark: Mark,
    ) -> None:
        self.joint = joint
        self.link = link
        self.type = kind
        self.a = a
        self.alpha = alpha
        self.d = d
        self.theta = theta
        self.offset = offset
        self.sign = 1
        self.limits = limits
        self.mass = self.com = self.inertia = self.radius = self.damping = self.friction = None
        self.mark = mark
        self.__class__ = DHRow  # type: ignore[assignment]


class _LineMark:
    """The same for a `Mark` of a whole line."""

    __slots__ = ("column", "file", "line")

    def __init__(self, file: str, line: int) -> None:
        self.file = file
        self.line = line
        self.column = None
        self.__class__ = Mark  # type: ignore[assignment]  # noqa: PLE0237 - no slot, but the type


class PlainRows:
    """Reads the rows of manipulators that stand behind each other, where they are plain."""

    def __init__(self, columns: Columns, units: Units, file: str) -> None:
        """Takes the columns and units of the table, once for all of its rows."""
        self.file = file
        self.width = len(columns.fields)
        self.column = {name: index for index, name in enumerate(columns.fields) if name}
        self.nameless = [index for index, header in enumerate(columns.headers) if not header]
        names = [name for name in (*_GEOMETRY, *_LIMITS) if name in self.column]
        self.numbers = [(name, self.column[name], _converter(_unit(units, name))) for name in names]
        self.has_limits = "lower" in names
        complete = sum(name in names for name in _LIMITS) in (0, len(_LIMITS))
        self.usable = complete and not columns.unheld and not set(self.column) - {*_WORDS, *names}
        # A column that is an angle in one row and a length in the next has two units, unless they are SI units.
        slides = all(_unit(units, name) is None for name in ("offset", "lower", "upper", "velocity") if name in names)
        # Fixed and continuous joints have rules of their own.
        self.plain_kinds = (JointType.REVOLUTE, JointType.PRISMATIC) if slides else (JointType.REVOLUTE,)
        self.alpha_bound = LARGEST_ANGLE if units.angle or "alpha" in units.columns else FULL_TURN
        self.limit_bounds = [
            math.inf if units.angle or name in units.columns else LARGEST_LIMIT for name in ("lower", "upper")
        ]
        self.kinds: dict[str, JointType] = {}
        self.names: set[tuple[tuple[str, ...], tuple[str, ...]]] = set()
        self.limits: dict[tuple[float, ...], Limits] = {}
        self.angles: set[float] = {0.0}

    def read(
        self, rows: Sequence[Sequence[str]], lines: Iterable[int], sizes: Sequence[int]
    ) -> list[tuple[DHRow, ...]] | None:
        """The rows of each manipulator, or None where one of them is not surely plain.

        Args:
            rows: the cells of each row.
            lines: the line of each row.
            sizes: how many rows each manipulator has.
        """
        if not self.usable or set(map(len, rows)) != {self.width}:
            return None
        columns = list(zip(*rows, strict=True))
        try:
            values = {name: convert(columns[index]) for name, index, convert in self.numbers}
        except ValueError:
            return None
        text = "".join(["".join(columns[index]) for _, index, _ in self.numbers])
        # `float` reads 1_0, digits of other scripts, nan and inf too; the last two are in no bounds.
        plain = text.isascii() and text.isprintable() and "_" not in text
        kinds = self._kinds(columns, len(rows))
        names = self._names(columns, sizes)
        if not plain or kinds is None or names is None or any(map(any, (columns[k] for k in self.nameless))):
            return None
        zeros = [0.0] * len(rows)
        a, alpha, d = values["a"], values["alpha"], values["d"]
        theta, offset = values.get("theta", zeros), values.get("offset", zeros)
        limits = self._limits(values, kinds) if self.has_limits else [NO_LIMITS] * len(rows)
        if limits is None or not (self._are_plain_angles(alpha, theta, offset) and _are_plain_lengths(a, d, sizes)):
            return None
        marks = map(_LineMark, repeat(self.file), lines)
        read: list[DHRow] = list(map(_Row, *names, kinds, a, alpha, d, theta, offset, limits, marks))  # type: ignore[arg-type]
        ends = list(accumulate(sizes))
        return [tuple(read[end - size : end]) for size, end in zip(sizes, ends, strict=True)]

    def _kinds(self, columns: Sequence[tuple[str, ...]], count: int) -> list[JointType] | None:
        """The types of the joints."""
        if "type" not in self.column:
            return [JointType.REVOLUTE] * count
        words = columns[self.column["type"]]
        for word in set(words) - self.kinds.keys():
            kind = joint_type(word)
            if kind is None or kind not in self.plain_kinds:
                return None
            self.kinds[word] = kind
        return list(map(self.kinds.__getitem__, words))

    def _names(
        self, columns: Sequence[tuple[str, ...]], sizes: Sequence[int]
    ) -> tuple[Iterable[str], Iterable[str]] | None:
        """The names of joints and of links; None where there is anything to say about them."""
        numbers = {size: tuple(map(str, range(1, size + 1))) for size in set(sizes)}
        counted = list(chain.from_iterable(numbers[size] for size in sizes))
        index, joint, link = (self.column.get(name) for name in ("index", "joint", "link"))
        if index is not None and list(columns[index]) != counted:
            return None
        joints = tuple(map("joint_".__add__, counted)) if joint is None else columns[joint]
        links = tuple(map("link_".__add__, counted)) if link is None else columns[link]
        start = 0
        for size in sizes:
            key = (joints[start : start + size], links[start : start + size])
            if key not in self.names:
                if not _are_plain_names(*key):
                    return None
                _remember(self.names, key)
            start += size
        return joints, links

    def _are_plain_angles(self, alpha: list[float], theta: list[float], offset: list[float]) -> bool:
        for angle in {*alpha, *theta, *offset} - self.angles:
            turns = round(angle / HALF_PI) if math.isfinite(angle) else 1
            if abs(angle - turns * HALF_PI) <= NEARLY * abs(turns * HALF_PI) and quarter_turns(angle) is None:
                return False
            _remember(self.angles, angle)
        return (
            max(map(abs, alpha)) <= self.alpha_bound
            and max(map(abs, theta)) <= FULL_TURN
            and max(map(abs, offset)) <= LARGEST_ANGLE
            and math.isfinite(sum(alpha) + sum(theta) + sum(offset))
        )

    def _limits(self, values: dict[str, list[float]], kinds: list[JointType]) -> list[Limits] | None:
        rows = list(zip(kinds, *(values[name] for name in _LIMITS), strict=True))
        for row in set(rows) - self.limits.keys():
            kind, lower, upper, velocity, effort = row
            smallest, largest = (LONGEST_ARM,) * 2 if kind is JointType.PRISMATIC else self.limit_bounds
            if not (-smallest <= lower <= upper <= largest and math.isfinite(upper - lower)):
                return None
            if not (0 < velocity < math.inf and 0 < effort < math.inf):
                return None
            if len(self.limits) > _REMEMBERED:
                self.limits.clear()
                return None
            self.limits[row] = Limits(lower=lower, upper=upper, velocity=velocity, effort=effort)
        return [self.limits[row] for row in rows]


def _remember(known: set[Any], value: Any) -> None:  # noqa: ANN401 - a set of one kind, and one of that kind
    if len(known) > _REMEMBERED:
        known.clear()
    known.add(value)


def _are_plain_lengths(a: list[float], d: list[float], sizes: Sequence[int]) -> bool:
    """Whether every arm is of a length that needs no word."""
    lengths = list(map(add, map(abs, a), map(abs, d)))
    if sum(lengths) <= LONGEST_ARM:
        return True
    ends = list(accumulate(sizes))
    return all(sum(lengths[end - size : end]) <= LONGEST_ARM for size, end in zip(sizes, ends, strict=True))


def _are_plain_names(joints: tuple[str, ...], links: tuple[str, ...]) -> bool:
    for name in (*joints, *links):
        if (
            name != name.strip()
            or name_fault(name)
            or not name.isascii()
            or name.startswith("#")
            or name.casefold() in END_NAMES
        ):
            return False
    return not name_problems(list(map(RowNames, joints, links)))


def _unit(units: Units, name: str) -> Unit | None:
    """The unit of a column, None where it is the SI unit."""
    unit = units.columns.get(name) or units.of(FIELDS[name].dimension or Dimension.NUMBER)
    return unit if unit and (unit.power or unit.degrees) else None


def _converter(unit: Unit | None) -> Callable[[Sequence[str]], list[float]]:
    """What makes SI numbers of a column of plain decimal numbers; it raises ValueError where one is not plain.

    There is no −0 among them: 0 is added to each.
    """
    if unit is None:
        return lambda column: [float(text) + 0.0 for text in column]
    if unit.degrees:
        return lambda column: [float(text) / 90 * HALF_PI + 0.0 for text in column]
    suffix = f"e{unit.power}"  # a text with an exponent of its own becomes no number, and is read with care
    return lambda column: [float(text + suffix) + 0.0 for text in column]
