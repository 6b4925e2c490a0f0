"""The fast way through a table: rows about which there is nothing to say.

Most rows of a large table are plain numbers, known words and expressions such as pi/2 that were seen before. They are
read column by column, at the speed of Python's own loops. Whatever is not surely plain is left to `RowReader`, which
alone defines what a table means: here a row is read as that would read it, or not at all.
"""

from __future__ import annotations

import math
import re
from collections import defaultdict
from itertools import accumulate, chain, pairwise
from math import remainder
from operator import add, methodcaller
from typing import TYPE_CHECKING, Any, TypeAlias, TypeVar

from dh2urdf.columns import column
from dh2urdf.manipulator import Inertia, JointType, Limits, new_dh_row
from dh2urdf.rotations import HALF_PI, quarter_turns
from dh2urdf.row_fields import COM, DYNAMICS, INERTIA, LIMITS, NUMBERS, ROW_FIELDS
from dh2urdf.table_text import GEOMETRY
from dh2urdf_plugins.readers.header.header_rows import is_beside
from dh2urdf_plugins.readers.header.units import group_of
from dh2urdf_plugins.readers.header.unknown_columns import is_number, is_value
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.plain.limits import PlainLimits
from dh2urdf_plugins.readers.plain.numbers import PlainNumbers, foreign_unit, names_foreign_unit
from dh2urdf_plugins.readers.plain.sample import PlainSample
from dh2urdf_plugins.readers.rows.joint_rows import AXIS, NUMBER
from dh2urdf_plugins.readers.statements.plausibility import LONGEST_ARM, SHORTEST_ARM
from dh2urdf_plugins.readers.words.bounds import FULL_TURN, NEARLY, REMEMBERED
from dh2urdf_plugins.readers.words.cells import LINE_END, SPACES, text_of
from dh2urdf_plugins.readers.words.fields import FIELDS, is_no_joint, joint_type, unheld
from dh2urdf_plugins.readers.words.names import MAX_NAME, RESERVED

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.words.cells import Units, Value

T = TypeVar("T")
Rows: TypeAlias = slice | list[int]
"""Where the same row of many manipulators is among the rows of all."""

_WORDS = ("robot", "convention", "index", "joint", "link", "type")
_OTHERS = tuple(name for name in (*NUMBERS, *COM, *INERTIA) if name not in GEOMETRY)
"""Numbers that have to do with no other number of their row."""
_HASH = methodcaller("startswith", "#")


class PlainRows:
    """Reads the rows of manipulators that are behind each other, where they are plain."""

    def __init__(self, columns: Columns, units: Units) -> None:
        """Takes what holds for all rows of a table.

        Args:
            columns: its columns.
            units: the units of its numbers.
        """
        self.units = units
        self.headers = columns.headers
        self.width = len(columns.fields)
        self.holding_numbers = columns.numbers
        self.column = {name: index for index, name in enumerate(columns.fields) if name}
        self.silent = columns.silent  # to be spoken of as soon as one of them holds anything
        others = set(range(self.width)) - {*self.column.values(), *columns.ignored}
        self.others = {index: set[str]() for index in sorted(others)}
        self.strays = {k for k in self.others if not columns.headers[k] and not is_beside(k, columns.headers)}
        # Without a column of types, one that no field knows may hold them.
        known = "type" in self.column or not any(columns.headers[index] for index in self.others)
        turned = columns.of_theta and {"theta", "offset", "sign"} & self.column.keys()
        plain = known and not turned and not set(self.column) - {*_WORDS, *GEOMETRY, *LIMITS, *_OTHERS, "sign"}
        plain &= all(
            self.column.keys() >= {*group} for group in (COM, INERTIA) if not self.column.keys().isdisjoint(group)
        )
        plain &= "ixx" not in self.column or "mass" in self.column
        self.numbers = {
            name: PlainNumbers(name, units) for name in (*GEOMETRY, *_OTHERS, "sign") if name in self.column
        }
        # A column that is an angle in one row and a length in the next is read as one only where both are in SI units,
        # and as angles only where its header does not say otherwise.
        mixed = [name for name in self.column if FIELDS[name].linear]
        self.usable = plain and all(_header_fits(units, name) for name in mixed) and not _doubtful(units, self.column)
        self.slides = not any(
            name in units.columns or foreign_unit(units, name) or foreign_unit(units, name, linear=True)
            for name in mixed
        ) and not _doubtful(units, mixed, linear=True)
        self.kinds: dict[str, JointType] = {"": JointType.REVOLUTE, **columns.types}  # "": a table without types
        self.names: set[tuple[tuple[str, ...], tuple[str, ...]]] = set()
        self.sample = PlainSample()
        self.limits = PlainLimits(self.column, units, self.kinds)

    def read(
        self, rows: Sequence[Sequence[Value]], sizes: Sequence[int]
    ) -> list[tuple[Sequence[int], tuple[DHRow, ...]]] | None:
        """The rows of manipulators in columns, or None where one of them is not surely plain.

        Args:
            rows: the cells of each row.
            sizes: how many rows each manipulator has.

        Returns:
            Groups of manipulators that differ in numbers only: which of them these are, and their rows.
        """
        if not self.usable or set(map(len, rows)) != {self.width}:
            return None
        columns: list[Any] = list(zip(*rows, strict=True))  # of texts each, or of numbers
        for index in self.holding_numbers:
            if set(map(type, columns[index])) != {float}:  # a cell among them is empty
                columns[index] = tuple(map(text_of, columns[index]))
        words = columns[self.column["type"]] if "type" in self.column else ("",) * len(rows)
        names = self._names(columns, sizes)
        if not self._are_kinds(words) or names is None or not self._are_left_out(columns):
            return None
        zeros = [0.0] * len(rows)
        values: dict[str, list[float]] = {}
        for name, numbers in self.numbers.items():
            if (read := numbers.read(columns[self.column[name]])) is None:
                return None
            values[name] = read
        a, alpha, d = values["a"], values["alpha"], values["d"]
        theta, offset = values.get("theta", zeros), values.get("offset", zeros)
        limits = self.limits.read(words, columns)
        usual = limits is not None and not self._are_of_one(limits, columns, sizes)
        if not (limits and usual and self._are_plain_angles(values) and self._are_plain_lengths(a, d, sizes)):
            return None
        kinds = [self.kinds[word] for word in words]
        plain = "offset" not in values or self._are_plain_offsets(kinds, offset, columns[self.column["offset"]])
        others = {name: values[name] for name in _OTHERS if name in values}
        signs = list(map(int, values.get("sign", [1.0] * len(rows))))
        in_doubt = self._are_foreign(columns) or self._are_mixed(columns, values)
        if in_doubt or not (plain and _are_taken(others, kinds) and _are_signs(values.get("sign", ()), kinds)):
            return None
        geometry = {"a": a, "alpha": alpha, "d": d, "theta": theta, "offset": offset, **others}
        return [
            (members, tuple([_row_in_columns(*names, kinds, signs, limits, geometry, where) for where in places]))
            for members, places in _forms((*names, kinds, signs), limits, sizes)
        ]

    def _are_left_out(self, columns: Sequence[Sequence[str]]) -> bool:
        """Whether columns that name no field hold nothing to speak of: what was spoken of, no quantities, no types."""
        for index, known in self.others.items():
            if index in self.silent:
                if any(columns[index]):
                    return False
                continue
            if index in self.strays and not _count(columns[index]):
                return False
            new = set(columns[index]) - known
            if unheld(read_header(self.headers[index]).key) or any(map(is_value, map(str.strip, new))):
                return False
            if "type" not in self.column and any(map(joint_type, map(str.strip, new))):
                return False
            if len(known) < REMEMBERED:
                known.update(new)
        return True

    # --- Words

    def _are_kinds(self, words: Sequence[str]) -> bool:
        """Whether all types of joints are known, and such as can be read here."""
        for word in set(words) - self.kinds.keys():
            kind = None if not word or LINE_END in word else joint_type(word)  # an empty cell is worth a notice
            if kind is None or (kind is JointType.PRISMATIC and not self.slides):
                return False
            self.kinds[word] = kind
        return "type" not in self.column or "" not in words

    def _names(
        self, columns: Sequence[tuple[str, ...]], sizes: Sequence[int]
    ) -> tuple[Sequence[str], Sequence[str]] | None:
        """The names of joints and of links; None where there is anything to say about them."""
        numbers = {size: tuple(map(str, range(1, size + 1))) for size in set(sizes)}
        counted = tuple(chain.from_iterable([numbers[size] for size in sizes]))
        index, joint, link = (self.column.get(name) for name in ("index", "joint", "link"))
        if index is not None and columns[index] != counted:
            return None
        joints = tuple(map("joint_".__add__, counted)) if joint is None else columns[joint]
        links = tuple(map("link_".__add__, counted)) if link is None else columns[link]
        if len(numbers) == 1:  # The arms of a table mostly have the same names: then those of the first one tell.
            size, count = sizes[0], len(sizes)
            if joints == joints[:size] * count and links == links[:size] * count:
                sizes = sizes[:1]
        start = 0
        for size in sizes:
            key = (joints[start : start + size], links[start : start + size])
            if key not in self.names:
                if not self._are_plain_names(*key):
                    return None
                if len(self.names) > REMEMBERED:
                    self.names.clear()
                self.names.add(key)
            start += size
        return joints, links

    def _are_plain_names(self, joints: tuple[str, ...], links: tuple[str, ...]) -> bool:
        """Whether the names of a manipulator are such that there is nothing to say about them."""
        names = (*joints, *links)
        text = "".join(names)
        if not (text.isascii() and text.isprintable() and all(names)) or "*" in text or max(map(len, names)) > MAX_NAME:
            return False
        alike = set(map(str.lower, names))  # no casefold: they are ASCII
        ends = {f"{links[-1].lower()}-tool0", f"{links[-1].lower()}-flange", "base_link-base_link_inertia"}
        return (
            len(alike) == len(names)
            and alike.isdisjoint(RESERVED)
            and alike.isdisjoint(ends)
            and list(map(str.strip, names)) == list(names)
            and not any(map(_HASH, names))
            and not any(re.fullmatch(NUMBER, name) for name in names)  # a column of numbers counts the joints
            and not all(re.fullmatch(AXIS, joint) for joint in joints)  # which may be no names
            and ("type" in self.column or not any(map(is_no_joint, alike)))
        )

    # --- Numbers

    def _are_foreign(self, columns: Sequence[Sequence[Any]]) -> bool:
        """Whether a cell of geometry names another unit than the SI unit where a number outside of rows names none."""
        names = self.numbers.keys() - {"offset"} if self.units.bare else ()
        with_words = [name for name in names if self.numbers[name].has_expressions]
        cells = ((name, cell) for name in with_words for cell in set(columns[self.column[name]]))
        return any(names_foreign_unit(text_of(cell), name) for name, cell in cells)

    def _are_mixed(self, columns: Sequence[Sequence[Any]], values: Mapping[str, list[float]]) -> bool:
        """Whether cells have no unit in a column of which others, or those of one beside it, name one."""
        named = [name for name, numbers in self.numbers.items() if numbers.names_units(columns[self.column[name]])]
        if "offset" in values and (self.limits.named or (named and self.limits.columns)):
            return True
        return any(
            beside in values and self.numbers[beside].has_bare(columns[self.column[beside]], values[beside])
            for name in named
            for beside in group_of(name)
        )

    def _are_of_one(self, limits: Sequence[Limits], columns: Sequence[Sequence[Any]], sizes: Sequence[int]) -> bool:
        """Whether a limit is that of one joint of a manipulator alone, in a column with empty cells."""
        texts = {name: columns[index] for name, index in self.limits.columns.items()}
        gaps = [name for name, cells in texts.items() if isinstance(cells[0], str) and not all(map(str.strip, cells))]
        ends = zip(accumulate(sizes), sizes, strict=True) if gaps else ()
        return any(
            sum(getattr(each, name) is not None for each in limits[end - size : end]) == 1
            for end, size in ends
            for name in gaps
        )

    def _are_plain_angles(self, values: dict[str, list[float]]) -> bool:
        """Whether all angles are of a size that needs no word, and none is nearly a quarter turn."""
        for name in ("alpha", "theta", "offset"):
            if name not in values:
                continue
            angles = set(values[name])
            # A number that is none is in no bounds, wherever it is in the set.
            if not (math.isfinite(sum(angles)) and min(angles) >= -FULL_TURN and max(angles) <= FULL_TURN):
                return False
            # Somewhat more than what is nearly a quarter turn to `RowReader`: it counts x in rad, not in turns.
            close = NEARLY * HALF_PI * FULL_TURN
            some = [x for x in angles if not close < x % HALF_PI < HALF_PI - close]  # a few more: no call for each
            near = [x for x in some if abs(remainder(x, HALF_PI)) <= NEARLY * HALF_PI * abs(x)]
            if not all(x == 0 or quarter_turns(x) is not None for x in near):
                return False
        return True

    def _are_plain_offsets(self, kinds: Sequence[JointType], offset: Sequence[float], cells: Sequence[Any]) -> bool:
        """Whether no fixed joint has an offset, and no offset names a unit that may matter elsewhere in its row."""
        if self.numbers["offset"].has_expressions:
            if JointType.PRISMATIC in kinds:
                return False
            if self.limits.bare_speed[False] and any(
                names_foreign_unit(text_of(cell), "offset") for cell in set(cells)
            ):
                return False
        return not any(value and kind is JointType.FIXED for kind, value in zip(kinds, offset, strict=True))

    @staticmethod
    def _are_plain_lengths(a: list[float], d: list[float], sizes: Sequence[int]) -> bool:
        """Whether every arm is of a length that needs no word."""
        size, largest = sizes[0], max(map(abs, (max(a), min(a), max(d), min(d))))
        first = min(d[::size]) if sizes == [size] * len(sizes) else 0.0
        if first >= SHORTEST_ARM and 2.0 * size * largest <= LONGEST_ARM and math.isfinite(sum(a) + sum(d)):
            return True  # so much is sure of every arm without its own sum
        totals = list(map(sum, _by_arm(list(map(add, map(abs, a), map(abs, d))), sizes)))
        return not math.isnan(sum(totals)) and min(totals) >= SHORTEST_ARM and max(totals) <= LONGEST_ARM


def _forms(
    words: Sequence[Sequence[object]], limits: list[Limits], sizes: Sequence[int]
) -> Iterator[tuple[Sequence[int], list[Rows]]]:
    """Manipulators that differ in numbers only: which these are, and where each of their rows is among all rows.

    Args:
        words: what rows say besides numbers, by column.
        limits: the limits of the rows, some of which may not be given.
        sizes: how many rows each manipulator has.
    """
    size, count = sizes[0], len(sizes)
    same = [size] * count == sizes and all(list(each) == list(each[:size]) * count for each in words)
    if same and limits == limits[:size] * count:
        yield range(count), [slice(row, None, size) for row in range(size)]
        return
    given = [(own.lower is None, own.upper is None, own.velocity is None, own.effort is None) for own in limits]
    forms: defaultdict[Hashable, list[int]] = defaultdict(list)
    starts = list(accumulate(sizes, initial=0))
    for member, (start, end) in enumerate(pairwise(starts)):
        forms[tuple([tuple(each[start:end]) for each in (*words, given)])].append(member)
    for members in forms.values():
        rows = range(sizes[members[0]])
        yield members, [[starts[member] + row for member in members] for row in rows]


def _row_in_columns(  # noqa: PLR0917 - what a row consists of
    joints: Sequence[str],
    links: Sequence[str],
    kinds: Sequence[JointType],
    signs: Sequence[int],
    limits: Sequence[Limits],
    numbers: Mapping[str, Sequence[float]],
    where: Rows,
) -> DHRow:
    """One row of many manipulators, which is in some places among the rows of all."""
    first = where.start if isinstance(where, slice) else where[0]
    bounds = _some(limits, where)
    found = {name: column(_some(entries, where)) for name, entries in numbers.items()}
    com = tuple([found.pop(name) for name in COM]) if "com_x" in found else None
    inertia = Inertia(**{name: found.pop(name) for name in INERTIA}) if "ixx" in found else None
    return new_dh_row(
        joint=joints[first],
        link=links[first],
        type=kinds[first],
        sign=signs[first],
        limits=bounds[0]
        if bounds.count(bounds[0]) == len(bounds)
        else Limits(**{name: column([getattr(each, name) for each in bounds]) for name in LIMITS}),
        com=com,
        inertia=inertia,
        **found,
    )


def _are_taken(numbers: Mapping[str, Sequence[float]], kinds: Sequence[JointType]) -> bool:
    """Whether numbers beside the geometry are such as their fields take, in rows that have them."""
    if JointType.FIXED in kinds and not numbers.keys().isdisjoint(DYNAMICS):
        return False
    for name, column_ in numbers.items():
        field, smallest = ROW_FIELDS[name], min(column_)
        if not (math.isfinite(sum(column_)) and field.takes(smallest)):
            return False
    return True


def _are_signs(numbers: Sequence[float], kinds: Sequence[JointType]) -> bool:
    """Whether numbers are directions, and none of them is that of a joint that does not move."""
    return set(numbers) <= {1.0, -1.0} and not any(
        number < 0 and kind is JointType.FIXED for number, kind in zip(numbers, kinds, strict=False)
    )


def _some(entries: Sequence[T], where: Rows) -> Sequence[T]:
    return entries[where] if isinstance(where, slice) else [entries[place] for place in where]


def _count(cells: Sequence[str]) -> bool:
    """Whether cells without a header hold no number, or count all rows of the table one by one, as pandas does."""
    if not any(is_number(text.strip(SPACES)) for text in cells):
        return True
    if not all(text.isascii() and text.isdigit() for text in cells):
        return False
    first = int(cells[0])
    return list(map(int, cells)) == list(range(first, first + len(cells)))


def _by_arm(column: Sequence[float], sizes: Sequence[int]) -> Iterable[Sequence[float]]:
    """The numbers of a column, arm by arm."""
    if len(set(sizes)) == 1:
        return zip(*[iter(column)] * sizes[0], strict=True)
    return (column[end - size : end] for size, end in zip(sizes, accumulate(sizes), strict=True))


def _header_fits(units: Units, name: str) -> bool:
    """Whether the unit of a column's header, where it has one, is that of a joint that turns."""
    unit = units.columns.get(name)
    return unit is None or unit.dimension is FIELDS[name].dimension


def _doubtful(units: Units, names: Iterable[str], *, linear: bool = False) -> bool:
    """Whether bare numbers of some fields have no sure unit in rows of joints that turn, or of those that slide."""
    dimensions = {name: FIELDS[name].linear if linear else FIELDS[name].dimension for name in names}
    return any(dimension and units.doubt(dimension, name) for name, dimension in dimensions.items())
