"""The fast way through a table: rows about which there is nothing to say.

Most rows of a large table are plain numbers, known words and expressions such as pi/2 that were seen before. They are
read column by column, at the speed of Python's own loops. Whatever is not surely plain is left to `RowReader`, which
alone defines what a table means: here a row is read as that would read it, or not at all.
"""

from __future__ import annotations

import math
from itertools import accumulate, chain
from operator import add, methodcaller
from typing import TYPE_CHECKING, Any

from dh2urdf.manipulator import JointType
from dh2urdf.rotations import HALF_PI, quarter_turns
from dh2urdf_plugins.readers.cells import text_of
from dh2urdf_plugins.readers.fields import joint_type
from dh2urdf_plugins.readers.names import END_NAMES, MAX_NAME, RESERVED, are_out_of_order
from dh2urdf_plugins.readers.plain_limits import LIMITS, PlainLimits
from dh2urdf_plugins.readers.plain_numbers import LINE_END, REMEMBERED, PlainNumbers, foreign_unit
from dh2urdf_plugins.readers.records import make_rows
from dh2urdf_plugins.readers.row_cells import FULL_TURN, LARGEST_ANGLE
from dh2urdf_plugins.readers.rows import NEARLY
from dh2urdf_plugins.readers.tables import LONGEST_ARM

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.source import Mark
    from dh2urdf_plugins.readers.cells import Units, Value
    from dh2urdf_plugins.readers.headers import Columns

_GEOMETRY = ("a", "alpha", "d", "theta", "offset")
_WORDS = ("robot", "convention", "index", "joint", "link", "type")
_HASH = methodcaller("startswith", "#")


class PlainRows:
    """Reads the rows of manipulators that stand behind each other, where they are plain."""

    def __init__(self, columns: Columns, units: Units, place: Mark) -> None:
        """Takes the columns and units of the table and the place of any row, once for all of its rows."""
        self.place = place
        self.units = units
        self.width = len(columns.fields)
        self.holding_numbers = columns.numbers
        self.column = {name: index for index, name in enumerate(columns.fields) if name}
        self.nameless = [index for index, header in enumerate(columns.headers) if not header]
        # Without a column of types, one that no field knows may hold them.
        known = "type" in self.column or all(
            name or not text for name, text in zip(columns.fields, columns.headers, strict=True)
        )
        self.usable = known and not columns.unheld and not set(self.column) - {*_WORDS, *_GEOMETRY, *LIMITS}
        self.numbers = {name: PlainNumbers(name, units) for name in _GEOMETRY if name in self.column}
        # A column that is an angle in one row and a length in the next has two units, unless they are SI units.
        several = ("offset", "lower", "upper", "velocity")
        self.slides = not any(foreign_unit(units, name) for name in several if name in self.column)
        self.alpha_bound = LARGEST_ANGLE if units.angle or "alpha" in units.columns else FULL_TURN
        self.kinds: dict[str, JointType] = {"": JointType.REVOLUTE}  # the word of a table without types
        self.names: set[tuple[tuple[str, ...], tuple[str, ...]]] = set()
        self.limits = PlainLimits(self.column, units, self.kinds)

    def read(
        self, rows: Sequence[Sequence[Value]], lines: Iterable[int], sizes: Sequence[int]
    ) -> list[tuple[DHRow, ...]] | None:
        """The rows of each manipulator, or None where one of them is not surely plain.

        Args:
            rows: the cells of each row.
            lines: the line of each row.
            sizes: how many rows each manipulator has.
        """
        if not self.usable or set(map(len, rows)) != {self.width}:
            return None
        columns: list[Any] = list(zip(*rows, strict=True))  # of texts each, or of numbers
        for index in self.holding_numbers:
            if set(map(type, columns[index])) != {float}:  # a cell among them is empty
                columns[index] = tuple(map(text_of, columns[index]))
        words = columns[self.column["type"]] if "type" in self.column else ("",) * len(rows)
        names = self._names(columns, sizes)
        if not self._are_kinds(words) or names is None or any(map(any, (columns[k] for k in self.nameless))):
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
        if limits is None or not (self._are_plain_angles(values) and _are_plain_lengths(a, d, sizes)):
            return None
        kinds = [self.kinds[word] for word in words]
        if "offset" in values and not self._are_plain_offsets(kinds, offset):
            return None
        made = make_rows(self.place, zip(*names, kinds, a, alpha, d, theta, offset, limits, lines, strict=True))
        ends = accumulate(sizes)
        return [tuple(made[end - size : end]) for size, end in zip(sizes, ends, strict=True)]

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
        if not (text.isascii() and text.isprintable() and all(names)) or max(map(len, names)) > MAX_NAME:
            return False
        alike = set(map(str.lower, names))  # no casefold: they are ASCII
        ends = {f"{links[-1].lower()}-tool0", f"{links[-1].lower()}-flange", "base_link-base_link_inertia"}
        return (
            len(alike) == len(names)
            and alike.isdisjoint(RESERVED)
            and alike.isdisjoint(ends)
            and list(map(str.strip, names)) == list(names)
            and not are_out_of_order(joints)
            and not any(map(_HASH, names))
            # A row named flange is a question where no type is given.
            and ("type" in self.column or not any("".join(filter(str.isalnum, name)) in END_NAMES for name in alike))
        )

    # --- Numbers

    def _are_plain_angles(self, values: dict[str, list[float]]) -> bool:
        """Whether all angles are of a size that needs no word, and none is nearly a quarter turn."""
        bounds = {"alpha": self.alpha_bound, "theta": FULL_TURN, "offset": FULL_TURN}
        for name in bounds.keys() & values.keys():
            angles = set(values[name])
            # A number that is none is in no bounds, wherever it stands in the set.
            if not (math.isfinite(sum(angles)) and -bounds[name] <= min(angles) and max(angles) <= bounds[name]):
                return False
            # Somewhat more than what is nearly a quarter turn to `RowReader`: it counts x in rad, not in turns.
            near = [x for x in angles if abs(x / HALF_PI - round(x / HALF_PI)) <= NEARLY * abs(x)]
            if not all(x == 0 or quarter_turns(x) is not None for x in near):
                return False
        return True

    def _are_plain_offsets(self, kinds: Sequence[JointType], offset: Sequence[float]) -> bool:
        """Whether no fixed joint has an offset, and no prismatic one an expression, which may name an angle's unit."""
        if JointType.PRISMATIC in kinds and self.numbers["offset"].has_expressions:
            return False
        return not any(value and kind is JointType.FIXED for kind, value in zip(kinds, offset, strict=True))


def _are_plain_lengths(a: list[float], d: list[float], sizes: Sequence[int]) -> bool:
    """Whether every arm is of a length that needs no word."""
    lengths = list(map(add, map(abs, a), map(abs, d)))
    if max(lengths) * max(sizes) <= LONGEST_ARM:
        return not math.isnan(sum(lengths))
    ends = accumulate(sizes)
    return all(sum(lengths[end - size : end]) <= LONGEST_ARM for size, end in zip(sizes, ends, strict=True))
