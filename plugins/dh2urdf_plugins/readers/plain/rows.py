"""The fast way through a table: manipulators that are like one that was read with care, but for their numbers.

Most manipulators of a large table have the same words, expressions and empty cells, and differ in decimal numbers. The
first one of each form is read by `RowReader`, which alone defines what a table means; if there is nothing to say about
it, the numbers of the others take the place of its own, column by column, at the speed of Python's own loops. Whatever
is not surely plain is read with care. A small sample is read in both ways in every run, and must give the same records.
"""

from __future__ import annotations

import math
import re
import sys
from collections import defaultdict
from dataclasses import replace
from functools import lru_cache
from itertools import accumulate, chain, pairwise, repeat
from typing import TYPE_CHECKING, Any, TypeAlias

from dh2urdf.columns import BOUNDS, COM, INERTIA, LIMITS, NUMBERS, ROW_FIELDS, column
from dh2urdf.errors import TableError
from dh2urdf.fields import replace_unchecked
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.quantities import QuantityError, evaluate
from dh2urdf.rotations import HALF_PI
from dh2urdf.source import Messages
from dh2urdf.table_text import GEOMETRY
from dh2urdf_plugins.readers.header.columns import Rows, is_value
from dh2urdf_plugins.readers.header.header_rows import is_beside, is_number
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.rows.cells import unit_at_end
from dh2urdf_plugins.readers.rows.rows import LARGEST_LIMIT, meant_by
from dh2urdf_plugins.readers.words.bounds import FULL_TURN, LONGEST_ARM, NEARLY, REMEMBERED, SHORTEST_ARM
from dh2urdf_plugins.readers.words.cells import LINE_END, SPACES, text_of
from dh2urdf_plugins.readers.words.fields import FIELDS, is_no_joint, joint_type, unheld
from dh2urdf_plugins.readers.words.names import MAX_NAME, RESERVED, added_joints

if TYPE_CHECKING:
    from collections.abc import Callable, Container, Hashable, Iterator, Mapping, Sequence

    from dh2urdf.manipulator import DHRow
    from dh2urdf.quantities import Dimension, Unit
    from dh2urdf.stages import Rejected
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.header.units import Units
    from dh2urdf_plugins.readers.words.cells import Value

Places: TypeAlias = slice | list[int]
"""Where the same row of many manipulators is among the rows of all."""

_NAMES = ("joint", "link")
_TOLD = ("convention", "index", "type", "sign")
_WORDS = frozenset(("robot", *_NAMES, *_TOLD))
_NUMBERS = frozenset((*GEOMETRY, *NUMBERS, *COM, *INERTIA, *LIMITS))
_ANGLES = frozenset(("alpha", "theta", "offset"))
_ANY = frozenset((*GEOMETRY, "lower", "upper"))
"""Numbers that may be of any sign."""
_LARGEST = {JointType.REVOLUTE: LARGEST_LIMIT, JointType.PRISMATIC: sys.float_info.max}
"""The largest bound that needs no word, by the type of a joint; the other types have no bounds."""
_PLAIN_NAME = re.compile(rf"(?![xyzXYZ]$)[A-Za-z](?:[\w .:/+-]{{0,{MAX_NAME - 2}}}\w)?", re.ASCII).fullmatch
"""A name that is no axis of a frame and no number, and that has no typesetting: `_j1_` is j1 in Markdown."""
_EXPRESSION = re.compile(r"[-+*/(). 0-9eEpiπ]+").fullmatch
"""A number, a multiple of π or a sum of them; what else may look so is refused when it is read."""
_UNIT = "# "
"""What the form of a number with a unit begins with."""
_PROBE = "0.001"
"""What a zero becomes where the model is read again: a number that means something."""
_TINY = "[eE]-[0-9]{3}"
"""An exponent, or what looks like one, of numbers too small for a double."""
FEWEST = 2
"""Manipulators of each new form, on average: fewer are read with care in the time that their models take."""
HEAD = 50
"""Rows of one manipulator that are read again at most, and rows that are read again in any file."""
EVERY = 20_000
"""One row of this many is read again: a careful row takes 30 times as long as a fast one."""

say = Messages(__file__)


class PlainRows:
    """Reads the rows of manipulators, where they are plain, in columns of some units; `careful` reads those of one."""

    def __init__(self, columns: Columns, units: Units, careful: Callable[[Rows], Manipulator | Rejected]) -> None:
        self.units, self.careful, self.headers, self.holding_numbers = units, careful, columns.headers, columns.numbers
        self.column = {name: index for index, name in enumerate(columns.fields) if name}
        self.numbers = [name for name in self.column if name in _NUMBERS]
        self.silent = columns.silent  # to be spoken of as soon as one of them holds anything
        self.others = sorted({*range(len(columns.fields))} - {*self.column.values(), *columns.ignored})
        headers = [columns.headers[index] for index in self.others]
        # Without a column of types, one that no field knows may hold them.
        known = "type" in self.column or not any(headers)
        held = not any(unheld(read_header(header).key) for header in headers)
        self.usable = known and held and self.column.keys() <= _WORDS | _NUMBERS
        self.models: dict[Hashable, Manipulator | None] = {}  # by what has to be alike; None: to be read with care
        self.known: dict[tuple[str, Dimension], dict[Value, float]] = {}  # the SI numbers of expressions
        self.names = set[tuple[tuple[str, ...], ...]]()
        self.sample = PlainSample()

    def read(self, groups: Sequence[Rows]) -> list[tuple[Sequence[int], Manipulator]] | None:
        """Manipulators in columns, or None where one of them is not surely plain.

        Those that differ in numbers only are in one group: which of them these are, and what they are.
        """
        rows = list(chain.from_iterable(own.cells for own in groups))
        if not self.usable or set(map(len, rows)) != {len(self.headers)}:
            return None
        columns: list[Any] = list(zip(*rows, strict=True))  # of texts each, or of numbers
        for index in self.holding_numbers:
            if set(map(type, columns[index])) != {float}:  # a cell among them is empty
                columns[index] = tuple(map(text_of, columns[index]))
        sizes = [len(own.cells) for own in groups]
        numbers = {name: found for name in self.numbers if (found := decimals(columns[self.column[name]])) is not None}
        words = self._words(columns, numbers)
        if words is None or not self._are_left_out(columns) or not self._are_plain_names(columns, sizes):
            return None
        names = [columns[self.column[name]] for name in _NAMES if name in self.column]
        starts, forms, made = list(accumulate(sizes, initial=0)), [], []
        for members, places in _forms((*words.values(), *names), sizes):
            start, size = starts[members[0]], len(places)
            form = (size, *((name, tuple(each[start : start + size])) for name, each in words.items()))
            forms.append((form, members, places))
        if FEWEST * len({form for form, *_ in forms} - self.models.keys()) > len(groups):
            return None
        for form, members, places in forms:
            model = self._model(form, groups[members[0]])
            in_columns = model and self._rows(model, places, columns, numbers)
            if not model or not in_columns:
                return None
            made.append((members, replace_unchecked(model, rows=in_columns)))
        return made

    def _words(
        self, columns: Sequence[Sequence[Any]], numbers: Container[str]
    ) -> dict[str, Sequence[Value | None]] | None:
        """What is alike in manipulators of one form, by field, with None for each number; None where all need care."""
        words = {name: columns[index] for name, index in self.column.items() if name in _TOLD}
        for name in self.numbers:
            if name not in numbers:
                words[name] = list(map(number_form, columns[self.column[name]]))
                texts = set(words[name]) - {None}
                # A comma says what the points beside it are; a unit asks for that of numbers outside of rows.
                if any("," in text or (self.units.bare and text.startswith(_UNIT)) for text in texts if text):
                    return None
        return words

    # --- The model of a form ------------------------------------------------------------------------------------------

    def _model(self, form: Hashable, rows: Rows) -> Manipulator | None:
        """The manipulator whose numbers may be exchanged for those of all of a form; None where there is none."""
        if form not in self.models:
            self.models = self.models if len(self.models) < REMEMBERED else {}
            self.models[form] = self._new_model(rows)
        return self.models[form]

    def _new_model(self, rows: Rows) -> Manipulator | None:
        """A manipulator about which there is nothing to say, nor if no number were sure by itself."""
        found = self._probed(rows, [self.numbers] * len(rows.cells))
        if found is None and isinstance(own := self.careful(rows), Manipulator) and not own.notices:
            # A joint that does not move has zeros that must be zeros.
            carried = [[name for name in self.numbers if row.type in ROW_FIELDS[name].types] for row in own.rows]
            found = self._probed(rows, carried)
        return found

    def _probed(self, rows: Rows, names: Sequence[Sequence[str]]) -> Manipulator | None:
        """A manipulator with other numbers in some fields of each row; None where there is anything to report."""
        cells = [list(each) for each in rows.cells]
        for each, own in zip(cells, names, strict=True):
            for index in map(self.column.__getitem__, own):
                each[index] = probe(each[index])
        found = self.careful(replace(rows, cells=cells))  # type: ignore[arg-type]
        if not isinstance(found, Manipulator) or found.notices:
            return None
        made = self._rows(found, [slice(k, k + 1) for k in range(len(cells))], list(zip(*cells, strict=True)), {})
        # A record may have another number than the cell, such as a sum with what is in another cell.
        return found if made == tuple([replace_unchecked(row, mark=None) for row in found.rows]) else None

    def _rows(
        self,
        model: Manipulator,
        places: Sequence[Places],
        columns: Sequence[Sequence[Any]],
        numbers: Mapping[str, Sequence[float]],
    ) -> tuple[DHRow, ...] | None:
        """The rows of manipulators like a model, in columns; None where there is anything to say about a number.

        `numbers` are those of the columns that hold nothing else, in their own units.
        """
        made, arms = [], [0.0] * len(_at(columns[0], places[0]))
        for row, where in zip(model.rows, places, strict=True):
            found: dict[str, Sequence[float]] = {}
            for name in self.numbers:
                cells = _at(columns[self.column[name]], where)
                if name not in numbers and not is_quantity(cells[0]):
                    continue
                if row.type not in ROW_FIELDS[name].types:
                    if any(text_of(cell).strip("+-0.") for cell in set(cells)):
                        return None
                    continue
                values = self._values(name, cells, _at(numbers[name], where) if name in numbers else None, row.type)
                if values is None:
                    return None
                found[name] = values
            if not _are_plain(found, row):
                return None
            for name in ("a", "d"):
                lengths = found.get(name) or repeat(getattr(row, name))
                arms = [arm + abs(length) for arm, length in zip(arms, lengths, strict=False)]
            names = {name: _at(columns[self.column[name]], where)[0] for name in _NAMES if name in self.column}
            made.append(_row_in_columns(row, names, found))
        return tuple(made) if all(SHORTEST_ARM <= arm <= LONGEST_ARM for arm in arms) else None

    def _values(
        self, name: str, cells: Sequence[Any], numbers: Sequence[float] | None, kind: JointType
    ) -> Sequence[float] | None:
        """The SI numbers of cells, which may be numbers as they are, in rows of a type; None where one is wrong."""
        dimension = FIELDS[name].measures(slides=kind is JointType.PRISMATIC)
        unit = self.units.unit_of(name, dimension)
        found = numbers if numbers is not None and (unit is None or unit.is_si) else decimals(cells, unit)
        if found is not None:
            return found
        known = self.known.setdefault((name, dimension), {})
        if len(known) > REMEMBERED:
            known.clear()
        for cell in set(cells) - known.keys():
            try:
                known[cell] = evaluate(text_of(cell), dimension, unit, angle=self.units.in_functions).value
            except QuantityError:
                return None
        return [known[cell] for cell in cells]

    # --- Words --------------------------------------------------------------------------------------------------------

    def _are_left_out(self, columns: Sequence[Sequence[str]]) -> bool:
        """Whether columns that name no field hold nothing to speak of: what was spoken of, no quantities, no types."""
        for index in self.others:
            cells, header = columns[index], self.headers[index]
            texts = set(map(str.strip, cells))
            counts = header or is_beside(index, self.headers) or _count(cells)
            is_new = index in self.silent and any(cells)
            may_be_type = "type" not in self.column and any(map(joint_type, texts))
            if is_new or not counts or may_be_type or any(map(is_value, texts)):
                return False
        return True

    def _are_plain_names(self, columns: Sequence[Sequence[str]], sizes: Sequence[int]) -> bool:
        """Whether there is nothing to say about the names of joints and links."""
        places = [slice(end - size, end) for size, end in zip(sizes, accumulate(sizes), strict=True)]
        given = {name: columns[self.column[name]] for name in _NAMES if name in self.column}
        new = {tuple([tuple(names[place]) for names in given.values()]) for place in places if given} - self.names
        for own in new:
            names, size = list(chain(*own)), len(own[0])
            alike = set(map(str.lower, names))  # no casefold: they are ASCII
            taken = {f"{name}_{number}" for name in _NAMES if name not in given for number in range(size + 1)}
            taken |= {*RESERVED, *added_joints(names[-1].lower() if "link" in given else f"link_{size}")}
            if not all(map(_PLAIN_NAME, names)) or len(alike) < len(names) or not alike.isdisjoint(taken):
                return False
            if "type" not in self.column and any(is_no_joint(name) or joint_type(name) for name in alike):
                return False
        if len(self.names) > REMEMBERED:
            self.names.clear()
        self.names |= new
        return True


# --- What is in bounds ------------------------------------------------------------------------------------------------


def _are_plain(numbers: Mapping[str, Sequence[float]], row: DHRow) -> bool:
    """Whether there is nothing to say about the numbers of a row of many manipulators, which are like another row."""
    close = NEARLY * HALF_PI * FULL_TURN  # a few more than `meant_by` knows: no call for each
    for angles in (set(numbers[name]) for name in _ANGLES & numbers.keys()):
        if not all(-FULL_TURN <= x <= FULL_TURN for x in angles):
            return False
        if any(meant_by(x) for x in angles if not close < x % HALF_PI < HALF_PI - close):
            return False
    for name, given in numbers.items():
        if name not in _ANY and not (math.isfinite(sum(given)) and ROW_FIELDS[name].takes(min(given))):
            return False
    bounds = [numbers.get(name) or repeat(getattr(row.limits, name)) for name in BOUNDS]
    largest = _LARGEST.get(row.type, 0.0)
    return numbers.keys().isdisjoint(BOUNDS) or all(
        -largest <= low <= high <= largest for low, high in zip(*bounds, strict=False)
    )


def _count(cells: Sequence[str]) -> bool:
    """Whether cells without a header hold no number, or count all rows of the table one by one, as pandas does."""
    if not all(text.isascii() and text.isdigit() for text in cells):
        return not any(is_number(text.strip(SPACES)) for text in cells)
    return list(map(int, cells)) == list(range(int(cells[0]), int(cells[0]) + len(cells)))


# --- Rows in columns --------------------------------------------------------------------------------------------------


def _forms(words: Sequence[Sequence[object]], sizes: Sequence[int]) -> Iterator[tuple[Sequence[int], Sequence[Places]]]:
    """Manipulators that differ in numbers only: which these are, and where each of their rows is among all rows."""
    size, count = sizes[0], len(sizes)
    if [size] * count == sizes and all(list(each) == list(each[:size]) * count for each in words):
        yield range(count), [slice(row, None, size) for row in range(size)]
        return
    forms: defaultdict[Hashable, list[int]] = defaultdict(list)
    starts = list(accumulate(sizes, initial=0))
    for member, (start, end) in enumerate(pairwise(starts)):
        forms[end - start, *(tuple(each[start:end]) for each in words)].append(member)
    for members in forms.values():
        yield members, [[starts[member] + row for member in members] for row in range(sizes[members[0]])]


def _at(entries: Sequence[Any], where: Places) -> Sequence[Any]:
    """The entries of the same row of many manipulators."""
    return entries[where] if isinstance(where, slice) else [entries[place] for place in where]


def _row_in_columns(model: DHRow, names: Mapping[str, str], numbers: Mapping[str, Sequence[float]]) -> DHRow:
    """One row of many manipulators that are like a model but for their names and numbers."""
    found: dict[str, Any] = {name: column(entries) for name, entries in numbers.items()}
    limits = replace_unchecked(model.limits, **{name: found.pop(name) for name in LIMITS if name in found})
    com = model.com and tuple([found.pop(name, own) for name, own in zip(COM, model.com, strict=True)])
    moments = {name: found.pop(name) for name in INERTIA if name in found}
    inertia = model.inertia and replace_unchecked(model.inertia, **moments)
    return replace_unchecked(model, **names, **found, limits=limits, com=com, inertia=inertia, mark=None)


# --- Columns of numbers -----------------------------------------------------------------------------------------------


@lru_cache(maxsize=REMEMBERED)
def number_form(cell: Value) -> str | None:
    """What a cell has in common with others of its form: the unit of a number, or None, and all of another text."""
    if isinstance(cell, float) or _EXPRESSION(cell):
        return None
    unit = unit_at_end(cell)
    return f"{_UNIT}{unit}" if unit and _EXPRESSION(cell.removesuffix(unit)) else cell


def is_quantity(cell: Value) -> bool:
    """Whether a cell is a number, with a unit or without one."""
    form = number_form(cell)
    return form is None or form.startswith(_UNIT)


def probe(cell: Value) -> Value:
    """A cell of the same form with another number in place of one that needs no unit: a zero, or a multiple of π."""
    if isinstance(cell, float):
        return cell or float(_PROBE)
    is_sure = "p" in cell or "π" in cell or not re.search("[1-9]", cell)
    if not (is_sure and is_quantity(cell)):
        return cell
    unit = (number_form(cell) or "").removeprefix(_UNIT)
    return f"{_PROBE} {unit}" if unit else _PROBE


def decimals(cells: Sequence[Any], unit: Unit | None = None) -> list[float] | None:
    """The SI numbers of a column of texts, or of numbers, where all are decimal numbers in a unit."""
    are_floats = isinstance(cells[0], float)
    if are_floats and unit and unit.power:
        cells, are_floats = list(map(text_of, cells)), False
    text = "" if are_floats else ",".join(cells)
    try:
        if unit is None or unit.is_si:
            numbers = list(map(float, cells))
        elif unit.parts:
            numbers = [float(cell) / unit.parts * HALF_PI for cell in cells]
        elif unit.is_shifted:  # a text with an exponent of its own becomes no number, and is read as an expression
            numbers = [float(f"{cell}e{unit.power}") for cell in cells]
        else:
            return None
    except ValueError:
        return None
    # `float` reads 1_0 and digits of other scripts too, and makes 0 of 1e-400.
    if "_" in text or LINE_END in text or not text.isascii() or (0.0 in numbers and re.search(_TINY, text)):
        return None
    return [number + 0.0 for number in numbers] if are_floats or "-" in text else numbers  # 0 for each −0


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
    rows = zip(fast.rows, careful.rows, strict=False) if isinstance(careful, Manipulator) else ()
    pairs: list[tuple[Any, Any]] = [*rows, *([(fast, careful)] if count == len(fast.rows) else [])]
    for one, other in pairs:
        if repr(one) != repr(other):
            about = {"joint": getattr(one, "joint", None), "fast": repr(one), "careful": repr(other)}
            raise TableError(say("two-readings", one.mark, robot=fast.name, **about))
