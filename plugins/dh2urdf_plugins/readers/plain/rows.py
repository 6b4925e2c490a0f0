"""The fast way through a table: rows about which there is nothing to say.

Most rows of a large table are plain numbers, known words and multiples of π that were seen before. They are read column
by column, at the speed of Python's own loops. Whatever is not surely plain is left to `RowReader`, which alone defines
what a table means: here a row is read as that would read it, or not at all. A small sample is read in both ways, in
every run, and must give the same records.
"""

from __future__ import annotations

import math
import re
import sys
from collections import defaultdict
from dataclasses import fields, replace
from itertools import accumulate, pairwise, starmap
from operator import add
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.columns import COM, DYNAMICS, INERTIA, LIMITS, NUMBERS, ROW_FIELDS, column
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Inertia, JointType, Limits, Manipulator, new_dh_row
from dh2urdf.quantities import QuantityError, evaluate
from dh2urdf.rotations import HALF_PI
from dh2urdf.source import Messages
from dh2urdf.table_text import GEOMETRY
from dh2urdf_plugins.readers.header.columns import is_value
from dh2urdf_plugins.readers.header.header_rows import is_beside, is_number
from dh2urdf_plugins.readers.header.units import OF_RATES, group_of
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.rows.rows import LARGEST_LIMIT, meant_by
from dh2urdf_plugins.readers.words.bounds import FULL_TURN, LONGEST_ARM, NEARLY, REMEMBERED, SHORTEST_ARM
from dh2urdf_plugins.readers.words.cells import LINE_END, SPACES, text_of
from dh2urdf_plugins.readers.words.fields import FIELDS, is_no_joint, joint_type, unheld
from dh2urdf_plugins.readers.words.names import MAX_NAME, RESERVED, added_joints

if TYPE_CHECKING:
    from collections.abc import Hashable, Iterator, Mapping, Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.stages import Rejected
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.header.units import Units
    from dh2urdf_plugins.readers.words.cells import Value

Rows: TypeAlias = slice | list[int]
"""Where the same row of many manipulators is among the rows of all."""

_WORDS = frozenset(("robot", "convention", "index", "joint", "link", "type"))
_NUMBERS = tuple(dict.fromkeys((*GEOMETRY, *NUMBERS, *COM, *INERTIA, "sign", *LIMITS)))
_POSITIVE = tuple(name for name in _NUMBERS if name not in {*GEOMETRY, "sign", "lower", "upper"})
"""Numbers that have to do with no other number of their row."""
_STILL = dict.fromkeys(DYNAMICS, ()) | dict.fromkeys(LIMITS, (None,)) | {"offset": (0.0,), "sign": (1.0,)}
"""What a joint that does not move may have of what is about motion."""
_LARGEST = {JointType.REVOLUTE: LARGEST_LIMIT, JointType.PRISMATIC: sys.float_info.max}
"""The largest bound that needs no word, by the type of a joint; the other types have no bounds."""
_PLAIN_NAME = re.compile(rf"(?![xyzXYZ]$)[A-Za-z](?:[\w .:/+-]{{0,{MAX_NAME - 2}}}\w)?", re.ASCII).fullmatch
"""A name that is no axis of a frame and no number, and that has no typesetting: `_j1_` is j1 in Markdown."""

_TINY = "[eE]-[0-9]{3}"
"""An exponent, or what looks like one, of numbers too small for a double."""
HEAD = 50
"""Rows of one manipulator that are read again at most, and rows that are read again in any file."""
EVERY = 20_000
"""One row of this many is read again: a careful row takes 30 times as long as a fast one."""

say = Messages(__file__)


class PlainRows:
    """Reads the rows of manipulators that are behind each other, where they are plain, in columns of some units."""

    def __init__(self, columns: Columns, units: Units) -> None:
        self.units, self.headers, self.holding_numbers = units, columns.headers, columns.numbers
        self.column = {name: index for index, name in enumerate(columns.fields) if name}
        self.silent = columns.silent  # to be spoken of as soon as one of them holds anything
        others = set(range(len(columns.fields))) - {*self.column.values(), *columns.ignored}
        self.others = {index: set[str]() for index in sorted(others)}
        self.usable = self._is_usable(columns, units)
        self.numbers = {name: PlainNumbers(name, units) for name in _NUMBERS if name in self.column}
        # Columns that have another unit in the rows of joints that slide, such as limits.
        linear = {name: kind for name in self.numbers if (kind := FIELDS[name].linear)}
        self.sliding = {name: PlainNumbers(name, units, slides=True) for name in linear}
        self.slides = not any(name in units.columns or units.doubt(kind, name) for name, kind in linear.items())
        self.kinds: dict[str, JointType] = {"": JointType.REVOLUTE, **columns.types}  # "": a table without types
        self.names = set[tuple[tuple[str, ...], tuple[str, ...]]]()
        self.sample = PlainSample()

    def _is_usable(self, columns: Columns, units: Units) -> bool:
        """Whether rows of these columns can be read here at all."""
        given = self.column.keys()
        # Without a column of types, one that no field knows may hold them.
        known = "type" in given or not any(columns.headers[index] for index in self.others)
        turned = columns.of_theta and {"theta", "offset", "sign"} & given
        parts = all(given >= {*group} or given.isdisjoint(group) for group in (COM, INERTIA))
        here = given <= {*_WORDS, *_NUMBERS} and ("ixx" not in given or "mass" in given)
        in_doubt = any(FIELDS[name].dimension and units.doubt(FIELDS[name].measures(), name) for name in given)
        # A header may say that a column is of joints that slide.
        turning = all(
            unit.dimension is FIELDS[name].measures() for name, unit in units.columns.items() if FIELDS[name].linear
        )
        return bool(known and not turned and parts and here and turning) and not in_doubt

    def read(
        self, rows: Sequence[Sequence[Value]], sizes: Sequence[int]
    ) -> list[tuple[Sequence[int], tuple[DHRow, ...]]] | None:
        """The rows of manipulators of some sizes in columns, or None where one of them is not surely plain.

        Manipulators that differ in numbers only are in one group: which of them these are, and their rows.
        """
        if not self.usable or set(map(len, rows)) != {len(self.headers)}:
            return None
        columns: list[Any] = list(zip(*rows, strict=True))  # of texts each, or of numbers
        for index in self.holding_numbers:
            if set(map(type, columns[index])) != {float}:  # a cell among them is empty
                columns[index] = tuple(map(text_of, columns[index]))
        words = columns[self.column["type"]] if "type" in self.column else ("",) * len(rows)
        names = self._names(columns, sizes)
        if names is None or not self._are_kinds(words) or not self._are_left_out(columns):
            return None
        kinds, values = [self.kinds[word] for word in words], dict[str, list[Any]]()
        slides = [kind is JointType.PRISMATIC for kind in kinds]
        for name in self.numbers:
            found = self._numbers(name, columns[self.column[name]], slides)
            if found is None:
                return None
            values[name] = list(found)
        lengths = list(map(add, map(abs, values["a"]), map(abs, values["d"])))
        arms = [sum(lengths[end - size : end]) for size, end in zip(sizes, accumulate(sizes), strict=True)]
        plain = all(SHORTEST_ARM <= arm <= LONGEST_ARM for arm in arms) and _are_plain_angles(values)
        if not plain or self._are_in_doubt() or not _fit(values, kinds):
            return None
        signs = list(map(int, values.pop("sign", [1.0] * len(rows))))
        alike: dict[str, Sequence[object]] = {"joint": names[0], "link": names[1], "type": kinds, "sign": signs}
        geometry = dict.fromkeys(GEOMETRY, [0.0] * len(rows)) | values
        missing = [[number is None for number in values[name]] for name in LIMITS if None in values.get(name, ())]
        return [
            (members, tuple([_row_in_columns(alike, geometry, where) for where in places]))
            for members, places in _forms((*alike.values(), *missing), sizes)
        ]

    def _numbers(self, name: str, cells: Sequence[Any], slides: Sequence[bool]) -> Sequence[float | None] | None:
        """The numbers of a column, given which rows slide; None where one of them is not plain."""
        if name not in self.sliding or not any(slides):
            return self.numbers[name].read(cells)
        given = []
        for numbers, which in ((self.numbers[name], False), (self.sliding[name], True)):
            some = [cell for cell, is_sliding in zip(cells, slides, strict=True) if is_sliding is which]
            found = numbers.read(some) if some else []
            if found is None or (which and numbers.has_expressions):  # A multiple of π is no length.
                return None
            given.append(iter(found))
        return [next(given[is_sliding]) for is_sliding in slides]

    def _are_left_out(self, columns: Sequence[Sequence[str]]) -> bool:
        """Whether columns that name no field hold nothing to speak of: what was spoken of, no quantities, no types."""
        for index, known in self.others.items():
            cells, header = columns[index], self.headers[index]
            if index in self.silent:
                if any(cells):
                    return False
                continue
            new = set(cells) - known
            texts = list(map(str.strip, new))
            counts = header or is_beside(index, self.headers) or _count(cells)
            if not counts or unheld(read_header(header).key) or any(map(is_value, texts)):
                return False
            if "type" not in self.column and any(map(joint_type, texts)):
                return False
            if len(known) < REMEMBERED:
                known.update(new)
        return True

    def _are_in_doubt(self) -> bool:
        """Whether cells name units, and a number that nothing says the unit of is beside them, or outside of rows."""
        readers = [*self.numbers.items(), *self.sliding.items()]
        named = [name for name, each in readers if each.foreign]
        beside = {other for name in named for other in group_of(name)}
        beside |= {*OF_RATES} if not beside.isdisjoint(group_of("offset")) else set()
        return bool(named and self.units.bare) or any(each.bare for name, each in readers if name in beside)

    # --- Words

    def _are_kinds(self, words: Sequence[str]) -> bool:
        """Whether all types of joints are known, and such as can be read here."""
        for word in set(words) - self.kinds.keys():
            kind = None if LINE_END in word else joint_type(word)
            if kind is None or (kind is JointType.PRISMATIC and not self.slides):
                return False
            self.kinds[word] = kind
        return "type" not in self.column or "" not in words  # an empty cell is worth a notice

    def _names(self, columns: Sequence[Sequence[str]], sizes: Sequence[int]) -> tuple[list[str], list[str]] | None:
        """The names of joints and of links; None where there is anything to say about them."""
        counted = [str(number) for size in sizes for number in range(1, size + 1)]
        index, joint, link = (self.column.get(name) for name in ("index", "joint", "link"))
        if index is not None and list(columns[index]) != counted:
            return None
        joints = [f"joint_{number}" for number in counted] if joint is None else list(columns[joint])
        links = [f"link_{number}" for number in counted] if link is None else list(columns[link])
        places = [slice(end - size, end) for size, end in zip(sizes, accumulate(sizes), strict=True)]
        new = {(tuple(joints[place]), tuple(links[place])) for place in places} - self.names
        if not all(starmap(self._are_plain_names, new)):
            return None
        if len(self.names) > REMEMBERED:
            self.names.clear()
        self.names |= new
        return joints, links

    def _are_plain_names(self, joints: tuple[str, ...], links: tuple[str, ...]) -> bool:
        """Whether the names of a manipulator are such that there is nothing to say about them."""
        alike = set(map(str.lower, (*joints, *links)))  # no casefold: they are ASCII
        return (
            all(map(_PLAIN_NAME, (*joints, *links)))
            and len(alike) == len(joints) + len(links)
            and alike.isdisjoint((*RESERVED, *added_joints(links[-1].lower())))
            and ("type" in self.column or not any(map(is_no_joint, alike)))
        )


# --- What is in bounds ------------------------------------------------------------------------------------------------


def _are_plain_angles(values: Mapping[str, list[float]]) -> bool:
    """Whether all angles are of a size that needs no word, and none is nearly a quarter turn."""
    close = NEARLY * HALF_PI * FULL_TURN  # a few more than `meant_by` knows: no call for each
    for angles in (set(values.get(name, ())) for name in ("alpha", "theta", "offset")):
        if not all(-FULL_TURN <= x <= FULL_TURN for x in angles):
            return False
        if any(meant_by(x) for x in angles if not close < x % HALF_PI < HALF_PI - close):
            return False
    return True


def _fit(values: Mapping[str, list[Any]], kinds: Sequence[JointType]) -> bool:
    """Whether numbers beside the geometry are such as their fields take, in rows that have them."""
    still = [index for index, kind in enumerate(kinds) if kind is JointType.FIXED] if JointType.FIXED in kinds else []
    for name in values if still else ():
        if name in _STILL and not {values[name][index] for index in still}.issubset(_STILL[name]):
            return False
    none: list[float | None] = [None] * len(kinds)
    for kind, low, high in set(zip(kinds, values.get("lower", none), values.get("upper", none), strict=True)):
        bound = _LARGEST.get(kind)
        if (low, high) != (None, None) and (None in (low, high, bound) or not -bound <= low <= high <= bound):  # type: ignore[operator]
            return False
    for name in _POSITIVE:
        given = [number for number in values.get(name, ()) if number is not None]
        if given and not (math.isfinite(sum(given)) and ROW_FIELDS[name].takes(min(given))):
            return False
    return set(values.get("sign", ())) <= {1.0, -1.0}


def _count(cells: Sequence[str]) -> bool:
    """Whether cells without a header hold no number, or count all rows of the table one by one, as pandas does."""
    if not all(text.isascii() and text.isdigit() for text in cells):
        return not any(is_number(text.strip(SPACES)) for text in cells)
    return list(map(int, cells)) == list(range(int(cells[0]), int(cells[0]) + len(cells)))


# --- Rows in columns --------------------------------------------------------------------------------------------------


def _forms(words: Sequence[Sequence[object]], sizes: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Rows]]]:
    """Manipulators that differ in numbers only: which these are, and where each of their rows is among all rows."""
    size, count = sizes[0], len(sizes)
    if [size] * count == sizes and all(list(each) == list(each[:size]) * count for each in words):
        yield range(count), [slice(row, None, size) for row in range(size)]
        return
    forms: defaultdict[Hashable, list[int]] = defaultdict(list)
    starts = list(accumulate(sizes, initial=0))
    for member, (start, end) in enumerate(pairwise(starts)):
        forms[tuple([tuple(each[start:end]) for each in words])].append(member)
    for members in forms.values():
        yield members, [[starts[member] + row for member in members] for row in range(sizes[members[0]])]


def _row_in_columns(
    alike: Mapping[str, Sequence[object]], numbers: Mapping[str, Sequence[float]], where: Rows
) -> DHRow:
    """One row of many manipulators that are alike but for their numbers, by its places among the rows of all."""
    first = where.start if isinstance(where, slice) else where[0]
    found: dict[str, Any] = {
        name: column(entries[where] if isinstance(where, slice) else [entries[place] for place in where])
        for name, entries in numbers.items()
    }
    limits = Limits(**{name: found.pop(name, None) for name in LIMITS})
    com = tuple([found.pop(name) for name in COM]) if "com_x" in found else None
    inertia = Inertia(**{name: found.pop(name) for name in INERTIA}) if "ixx" in found else None
    words: dict[str, Any] = {name: entries[first] for name, entries in alike.items()}
    return new_dh_row(**words, limits=limits, com=com, inertia=inertia, **found)


# --- Columns of numbers -----------------------------------------------------------------------------------------------


class PlainNumbers:
    """Reads the columns of a field, in rows of joints that turn or slide, in a table of some units.

    A column is plain where all of its cells are decimal numbers, or where few expressions are in all of them. Where
    cells name units of their own, the columns beside them show whether that is plain, too.
    """

    def __init__(self, name: str, units: Units, *, slides: bool = False) -> None:
        self.has_expressions = False  # whether anything but decimal numbers was among those that were read last
        self.foreign = False  # whether any cell so far names another unit than the SI unit
        self.bare = False  # whether any number so far, 0 left aside, is in the SI unit since nothing says its unit
        self._dimension = FIELDS[name].measures(slides=slides)
        self._unit, self._angle = units.unit_of(name, self._dimension), units.in_functions
        self._known: dict[Any, float] = {}
        self._has_gaps = name in LIMITS

    def read(self, column: Sequence[Any]) -> Sequence[float | None] | None:
        """The SI numbers of a column of texts, or of numbers; None where one of them is not plain.

        The cells of limits may be empty, which are None.
        """
        if self._has_gaps and not isinstance(column[0], float) and not all(column):
            filled = [cell for cell in column if cell]
            given = self.read(filled) if filled else ()
            numbers_left = iter(given or ())
            return None if given is None else [next(numbers_left) if cell else None for cell in column]
        numbers = self.decimals(column)
        self.has_expressions = numbers is None
        if numbers is not None:
            self.bare = self.bare or (self._unit is None and any(numbers))
            return numbers
        known = self._known  # a table has few expressions that differ
        if len(known) > REMEMBERED:
            known.clear()
        for cell in set(column) - known.keys():
            value = self._expression(text_of(cell))
            if value is None:
                return None
            known[cell] = value
        return list(map(known.__getitem__, column))

    def decimals(self, column: Sequence[Any]) -> list[float] | None:
        """The SI numbers of a column where all are decimal numbers, infinities and NaN among them."""
        unit, are_floats = self._unit, isinstance(column[0], float)
        if are_floats and unit and unit.power:
            column, are_floats = list(map(text_of, column)), False
        text = "" if are_floats else ",".join(column)
        try:
            if unit is None or unit.is_si:
                numbers = (text and _json_numbers(text, len(column))) or list(map(float, column))
            elif unit.parts:
                numbers = [float(cell) / unit.parts * HALF_PI for cell in column]
            elif unit.is_shifted:  # a text with an exponent of its own becomes no number, and is read as an expression
                numbers = [float(f"{cell}e{unit.power}") for cell in column]
            else:
                return None
        except ValueError:
            return None
        # `float` reads 1_0 and digits of other scripts too, and makes 0 of 1e-400.
        if "_" in text or LINE_END in text or not text.isascii() or (0.0 in numbers and re.search(_TINY, text)):
            return None
        return [number + 0.0 for number in numbers] if are_floats or "-" in text else numbers  # 0 for each −0

    def _expression(self, text: str) -> float | None:
        """The SI number that a cell says, or None where there is anything else to report about it."""
        if "," in text or LINE_END in text:
            return None
        try:
            quantity = evaluate(text.strip(SPACES), self._dimension, self._unit, angle=self._angle)
        except QuantityError:
            return None
        has_unit = quantity.has_unit or quantity.is_radians(self._dimension)
        self.foreign = self.foreign or quantity.foreign
        self.bare = self.bare or (self._unit is None and bool(quantity.value) and not has_unit)
        return None if quantity.variable else quantity.value


def _json_numbers(text: str, count: int) -> list[float] | None:
    """Decimal numbers with commas between them, where all are as JSON has them, in a quarter of the time of `float`."""
    import orjson

    try:
        numbers: list[Any] = orjson.loads(f"[{text}]")
    except orjson.JSONDecodeError:
        return None
    # A text with a comma is more than one number; a text in brackets or quotes that holds several is none.
    return list(map(float, numbers)) if len(numbers) == count and set(map(type, numbers)) <= {float, int} else None


# --- A sample that is read again --------------------------------------------------------------------------------------


class PlainSample:
    """Chooses the manipulators of a file that are read again: always the same ones, at changing places of a batch."""

    _read = _again = 0

    def choose(self, sizes: Sequence[int]) -> int | None:
        """The index of the manipulator that is read again, or None."""
        index = self._read % len(sizes)
        self._read += sum(sizes)
        rows = min(sizes[index], HEAD)
        if self._again + rows > HEAD + self._read // EVERY:
            return None
        self._again += rows
        return index


def compare(fast: Manipulator, careful: Manipulator | Rejected, count: int) -> None:
    """Refuses two readings of one manipulator that differ in a bit, in a mark or in a notice.

    Some rows were read with care, or all; the first rows of a longer arm may be refused as an arm.
    """
    is_whole = count == len(fast.rows)
    if isinstance(careful, Manipulator):
        pairs: list[tuple[Any, Any]] = [*zip(fast.rows, careful.rows, strict=False)]
        for one, other in [*pairs, (fast, careful)] if is_whole else pairs:
            for name in (field.name for field in fields(one)):
                readings = [repr(getattr(record, name)) for record in (one, other)]
                if readings[0] != readings[1]:
                    about = {"field": name, "fast": readings[0], "careful": readings[1]}
                    about |= {"joint": one.joint} if one is not fast else {}
                    raise TableError(say("two-readings", one.mark, robot=fast.name, **about))
    elif is_whole:
        refused = careful.problems[0]
        row = next((row for row in fast.rows if row.joint == refused.joint), fast)
        problem = say("only-fast", refused.mark, robot=fast.name, reason=refused.message, row=repr(row))
        raise TableError(replace(problem, joint=refused.joint, field=refused.field, found=refused.found))
