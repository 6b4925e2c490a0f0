"""What the rows of a manipulator are, before any of them is read: joints, fixed frames, or no joints at all.

One row alone does not show it. Numbers in a column of names are names only together; a row without a joint variable is
fixed only where the other rows have one.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.readers.header.unknown_columns import is_direction
from dh2urdf_plugins.readers.rows.cells import variables_in
from dh2urdf_plugins.readers.rows.names import holds_type, is_base, is_first_joint, kind_of, kind_of_name
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import ACCEPTED_TYPES, joint_type

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.source import Mark
    from dh2urdf_plugins.readers.rows.names import RowKind
    from dh2urdf_plugins.readers.rows.rows import RowReader

Cells = dict[str, Cell]
LABEL = ""
"""The key of a cell that names its row in a column that no field knows."""
NUMBER_TEXT = r"([0-9]{1,9})(?:\.0+)?"
NUMBER = NUMBER_TEXT
"""A name that is the number of a row."""
AXIS = r"(?i)([-+−–])?\s*[xyz]\s*([-+−–])?"
"""A name that is an axis of a frame."""
DECIMAL = r"[-+]?[0-9]*[.,][0-9]+"
TWISTING = ("T", "t")
"""A type that may be that of a joint that turns about the axis of its link."""
MOST_CHANCE = 3
"""From this number of rows on, a theta that has the number of each row counts them."""
_AT_START = frozenset("+-.,0123456789")
"""What either may begin with."""
_ZERO = r"0+(?:\.0+)?"
_LABELLED = rf"(?:[^\W\d_]{{1,12}}[\s_.#-]*)?{NUMBER_TEXT}\s*[*†‡§]?"
"""The number of a row behind a word, or before the mark of a footnote: ``J1``, ``Axis 1``, ``1*``."""
_BOUND = r"(?i)[1-9]|pi|π"
_MEANT: dict[RowKind, str] = {
    "total": "remove the row, or write its type if it is a joint",
    "frame": "write fixed if nothing moves there, or revolute if it does",
    "slide": "write prismatic if the joint slides, or revolute if it turns",
}


def settle(rows: Sequence[tuple[Cells | None, Mark]], reader: RowReader) -> int:
    """Gives each row its type and its names as far as only all rows together show them.

    Args:
        rows: the cells of each row by field, and its place; None where they cannot be told apart. They are changed.
        reader: what takes the problems.

    Returns:
        The number of the first row: 1, or 0 where it is the base and the joints are counted from the next one.
    """
    return _Rows(rows, reader).settle()


class _Rows:
    """The rows of one manipulator."""

    def __init__(self, rows: Sequence[tuple[Cells | None, Mark]], reader: RowReader) -> None:
        self.rows = [(place, cells, mark) for place, (cells, mark) in enumerate(rows) if cells is not None]
        self.reader = reader
        self.labels = {place: cells.pop(LABEL) for place, cells, _ in self.rows if LABEL in cells}
        self.indexes = {place: cells.pop("index") for place, cells, _ in self.rows if "index" in cells}
        variables = {place: variables_in(cells) for place, cells, _ in self.rows}
        self.variables = {place: next(iter(found.values())) for place, found in variables.items() if found}
        numbers = list(self.variables.items())
        reader.from_zero = len(numbers) > 1 and numbers[0] == (0, 0) and all(place == row for place, row in numbers)
        at_most_one = not reader.type_is_given and all(len(found) <= 1 for found in variables.values())
        self.sliding = {place for place, found in variables.items() if at_most_one and "d" in found}
        self.first = 1

    def settle(self) -> int:
        """See above."""
        self._take_types()
        self._leave_out_axes()
        if self.reader.from_zero:
            place, cells, mark = self.rows[0]
            message = "the joint variables are counted from 0: the first row has number 0"
            self._add_problem(message, place, cells, mark, notice=True, field="theta")
        self._look_at_counts()
        if self._index_has_names():
            for place, cells, _ in self.rows:
                cells["joint"] = self.indexes.pop(place)
        self._look_at_twisting()
        for place, cells, mark in self.rows:
            self._settle_type(place, cells, mark)
        self.first = 1 - self._counts_from_base()
        self._settle_indexes()
        still = {place for place, cells, _ in self.rows if _type_of(cells) is JointType.FIXED}
        for place, index in self.indexes.items():
            if not (place in still and kind_of(index.text) == "frame"):  # `EE` behind 1, 2, 3
                self._check_index(index, place)
        for field in ("joint", "link"):
            self._name_by_number(field)
        return self.first

    # --- Numbers ------------------------------------------------------------------------------------------------------

    def _variables_are_places(self) -> bool:
        """Whether joint variables are counted from the row behind the first one."""
        numbers = [(place, number) for place, number in self.variables.items() if number]
        return bool(numbers) and all(place == number for place, number in numbers)

    def _index_has_names(self) -> bool:
        """Whether the column of numbers holds names, as it may where no column is for names."""
        if not self.indexes or any("joint" in cells for _, cells, _ in self.rows):
            return False
        texts = [index.text for index in self.indexes.values()]
        return len(texts) == len(self.rows) and not any(text.isdecimal() for text in texts[:2])

    def _counts_from_base(self) -> bool:
        """Whether the first row is fixed, and the joints are numbered from the second one on."""
        if not self.rows or self.rows[0][0] != 0 or _type_of(self.rows[0][1]) is not JointType.FIXED:
            return False
        if 0 in self.indexes:
            return is_base(self.indexes[0].text)
        return self._variables_are_places()

    def _settle_indexes(self) -> None:
        """Leaves out a column of numbers that has other labels, where another one names the joints."""
        first = next(iter(self.indexes.values()), None)
        if first is None or first.text.isdigit() or not all("joint" in cells for _, cells, _ in self.rows):
            return
        if any(re.fullmatch(_LABELLED, index.text) for index in self.indexes.values()):
            return
        message = f"the column of numbers holds none, and is left out: {shown(first.text)}"
        self.reader.add(Problem(message=message, severity="notice", mark=first.mark, field="index"))
        for place, index in self.indexes.items():
            if is_direction(index.text):
                self._refuse_direction(index, place, "number")
        self.indexes = {}

    def _refuse_direction(self, cell: Cell, place: int, what: str) -> None:
        message = f"{shown(cell.text)} seems to be a direction, and is where the {what} of the joint should be"
        accepted = "a column sign with 1 or -1, or a column flip with true or false"
        joint = f"joint_{place + 1}"
        self.reader.add(
            Problem(message=message, mark=cell.mark, joint=joint, field="sign", found=cell.text, accepted=accepted)
        )

    def _leave_out_axes(self) -> None:
        """Leaves out a column of joints that holds axes of frames: ``Z``, ``Y``, ``-Y``."""
        named = {place: cells["joint"] for place, cells, _ in self.rows if "joint" in cells}
        axes = [(place, re.fullmatch(AXIS, cell.text)) for place, cell in named.items()]
        signs = {place: match[1] or match[2] or "" for place, match in axes if match}
        are_names = len({cell.text.casefold() for cell in named.values()}) == len(self.rows) and not any(signs.values())
        if not named or len(signs) < len(named):
            return
        if are_names:
            if named.keys() - {0} and not self.variables and not any(_type_of(cells) for _, cells, _ in self.rows):
                called = ", ".join(cell.text for cell in named.values())
                meant = "write the type prismatic if they slide, as the axes of a gantry do"
                message = f"the joints are called {called} and have no types: they turn"
                self._add_problem(message, *self.rows[0], suggestion=meant, notice=True)
            return
        first = next(iter(named.values()))
        message = f"the column of joints holds axes, not names, and is left out: {shown(first.text)}"
        self.reader.add(Problem(message=message, severity="notice", mark=first.mark, field="joint", found=first.text))
        for place in (place for place, sign in signs.items() if sign not in ("", "+")):
            self._refuse_direction(named[place], place, "name")
        for _, cells, _ in self.rows:
            cells.pop("joint", None)

    def _number_of(self, place: int, first: Cell) -> int:
        """The number of a row in a column that counts the rows as its first cell does."""
        return place if self.reader.from_zero and re.fullmatch(_ZERO, first.text) else place + self.first

    def _check_index(self, index: Cell, place: int) -> None:
        """Refuses the index of a row that is not the row's number."""
        number = self._number_of(place, self.indexes.get(0, index))
        if index.text == str(number):
            return
        match = re.fullmatch(_LABELLED, index.text)
        if (match and int(match[1]) == number) or (number == 0 and is_base(index.text)):
            return
        zero = place == 0 and re.fullmatch(_ZERO, index.text)
        self.reader.add(
            Problem(
                message=f"the index is {shown(index.text)}, and this is row {number}",
                mark=index.mark,
                joint=f"joint_{number}",
                field="index",
                found=index.text,
                accepted="1, 2, 3 … in the order of the rows, from the base outwards",
                suggestion="a row 0 that leads from the base to the first joint has the type fixed" if zero else None,
            )
        )

    def _name_by_number(self, field: str) -> None:
        """Makes names of numbers: a column of joints that holds 1, 2, 3 counts them."""
        cells = {place: row[field] for place, row, _ in self.rows if field in row and not self._is_base(place)}
        if not any(cell.text[:1] in _AT_START for cell in cells.values()):
            return
        matches = {place: re.fullmatch(NUMBER, cell.text) for place, cell in cells.items()}
        if cells and not any(matches.values()) and all(re.fullmatch(DECIMAL, cell.text) for cell in cells.values()):
            first = next(iter(cells.values()))
            message = f"the column of {field}s holds decimal numbers, which are kept as names: {shown(first.text)}"
            self.reader.add(Problem(message=message, severity="notice", mark=first.mark, field=field, found=first.text))
        if not cells or not all(matches.values()):
            return
        numbers = {place: int(match[1]) for place, match in matches.items() if match}
        counts = list(numbers.values())
        ids = counts[0] > 1 and all(left < right for left, right in pairwise(counts))  # of motors, say
        right = {place: self._number_of(place, next(iter(cells.values()))) for place in numbers}
        wrong = [] if ids else [place for place, number in numbers.items() if number != right[place]]
        for place in wrong:
            cell, number = cells[place], right[place]
            self.reader.add(
                Problem(
                    message=f"the number of the {field} is {shown(cell.text)}, and this is row {number}",
                    mark=cell.mark,
                    joint=f"joint_{number}",
                    field=field,
                    found=cell.text,
                    accepted="1, 2, 3 … in the order of the rows, from the base outwards; or names, such as "
                    f"{field}_{cell.text}",
                )
            )
        names = {place: f"{field}_{match[1]}" for place, match in matches.items() if match}
        base = next((row[field] for place, row, _ in self.rows if field in row and self._is_base(place)), None)
        if base and re.fullmatch(_ZERO, base.text):
            names, cells = {0: f"{field}_0", **names}, {0: base, **cells}
        for place, row, _ in self.rows:
            if place in names:
                row[field] = cells[place]._replace(text=names[place])
        if not wrong:
            few = ", ".join([*names.values()][:2]) + (" …" if len(names) > 2 else "")  # noqa: PLR2004 - the first two
            one = "the joint is" if len(names) == 1 else f"the {field}s are"
            self.reader.add(
                Problem(
                    message=f"the column of {field}s holds numbers: {one} named {few}",
                    severity="notice",
                    mark=next(iter(cells.values())).mark,
                    field=field,
                )
            )

    def _is_base(self, place: int) -> bool:
        return place == 0 and self.first == 0

    def _look_at_counts(self) -> None:
        """Refuses a theta that is a joint variable whose letter became a zero; a notice of one that counts the rows."""
        texts = {place: cells["theta"].text for place, cells, _ in self.rows if "theta" in cells}
        for place, cells, mark in self.rows:
            number, text = f"0{place + 1}", texts.get(place, "")
            if text.startswith(number) and text[len(number) :].lstrip()[:1] in ("", *"+-−–"):
                message = f"{shown(text)} may be the joint variable θ{place + 1}, whose letter became a zero"
                advice = f"write q{place + 1}, or the angle without a zero before it"
                self._add_problem(message, place, cells, mark, field="theta", suggestion=advice, accepted=None)
                return
        if len(texts) >= MOST_CHANCE and all(text == str(place + 1) for place, text in texts.items()):
            place, cells, mark = self.rows[0]
            message = f"theta counts the rows: {shown(', '.join(texts.values()))}"
            meant = "write q1, q2 … if these are the joint variables"
            self._add_problem(message, place, cells, mark, field="theta", suggestion=meant, notice=True)

    # --- Types --------------------------------------------------------------------------------------------------------

    def _take_types(self) -> None:
        """Takes a column of joints for one of types, where it holds nothing else: ``R``, ``R``, ``P``."""
        names = [cells["joint"] for _, cells, _ in self.rows if "joint" in cells and "type" not in cells]
        words = {name.text.casefold() for name in names}
        if len(names) < len(self.rows) or not names[1:] or not all(map(str.isalpha, words)):
            return
        if (len(words) == len(names) and max(map(len, words)) == 1 and "p" not in words) or None in map(
            joint_type, words
        ):
            return  # axes called by letters
        for _, cells, _ in self.rows:
            cells["type"] = cells.pop("joint")
        message = f"the column of joints holds their types: {shown(names[0].text)}"
        self.reader.add(Problem(message=message, severity="notice", mark=names[0].mark, field="type"))

    def _look_at_twisting(self) -> None:
        """A notice of the type T, a translation to most and a twisting joint to some, where no variable shows which."""
        for place, cells, mark in self.rows:
            if "type" in cells and cells["type"].text in TWISTING and "d" not in variables_in(cells):
                meant = "write R if it is a twisting joint, as beside the letters L, O, R and V"
                self._add_problem("T is read as a translation", place, cells, mark, suggestion=meant, notice=True)
                return

    def _settle_type(self, place: int, cells: Cells, mark: Mark) -> None:
        """Gives a row without a type its type where that is sure, and refuses it where it hardly is a joint."""
        if "type" in cells and cells["type"].text:
            return
        name = self._name_of(place, cells)
        kind = kind_of_name(name) if name else None
        if kind == "frame" and (has := self._shows_that_it_moves(place, cells, name)):
            message = f"the row {shown(name)} is called like a frame, and has {has}: it moves"
            meant = "write the type fixed if nothing moves there"
            self._add_problem(message, place, cells, mark, suggestion=meant, notice=True)
            kind = None
        if kind == "slide" and place in self.variables:
            kind = None  # the variable shows what moves
        if place in self.sliding and kind is None and "theta" in cells and cells["theta"].text:
            message = f"row {place + 1} has no type, and its variable is in d, not in theta: it is prismatic"
            self._add_problem(message, place, cells, mark, notice=True)
            cells["type"] = Cell(JointType.PRISMATIC.value, mark)
            return
        still = self.variables and place not in self.variables
        is_zero = place == 0 and (
            is_base(self.indexes[0].text)
            if place in self.indexes
            else bool(re.fullmatch(_ZERO, name)) and self._variables_are_places()
        )
        if still and kind not in ("total", "slide") and (kind or is_zero):
            called = shown(name or self.indexes[0].text)
            self._add_problem(
                f"the row {called} has no type and no joint variable, and the other rows have one: it is fixed",
                place,
                cells,
                mark,
                notice=True,
            )
            cells["type"] = Cell(JointType.FIXED.value, mark)
            return
        if kind:
            self._add_problem(
                f"the row {shown(name)} seems to be no joint: in a table of joints it would be one more"
                if kind == "total"
                else f"the row {shown(name)} has no type, and by its name it hardly is a revolute joint",
                place,
                cells,
                mark,
                suggestion=_MEANT[kind],
            )
        elif still:
            self._add_problem(
                f"row {place + 1} has no joint variable and no type, and other rows have a variable",
                place,
                cells,
                mark,
                suggestion="write fixed if nothing moves there, or the variable if it does",
            )
        else:
            return
        cells["type"] = Cell(JointType.REVOLUTE.value, mark)

    def _shows_that_it_moves(self, place: int, cells: Cells, name: str) -> str | None:
        """What a row has that moves: its variable, or, where no row has one, bounds, or the number of joint 1."""
        if place in self.variables:
            return "a joint variable"
        bounds = [cells[bound].text for bound in ("lower", "upper") if bound in cells]
        if not self.variables and any(re.search(_BOUND, bound) for bound in bounds) and not holds_type(name, place + 1):
            return "bounds"
        names = [self._name_of(row, cells) for row, cells, _ in self.rows]
        is_first = place == 0 and not self.variables and is_first_joint(names)
        return "the number of the first joint" if is_first else None

    def _name_of(self, place: int, cells: Cells) -> str:
        """What a row is called: its joint, else its link, else what is in a column that no field knows."""
        for cell in (cells.get("joint"), cells.get("link"), self.labels.get(place)):
            if cell is not None:
                return cell.text
        index = self.indexes.get(place)
        return index.text if index and not re.fullmatch(NUMBER, index.text) and not is_base(index.text) else ""

    def _add_problem(
        self,
        message: str,
        place: int,
        cells: Cells,
        mark: Mark,
        *,
        suggestion: str | None = None,
        notice: bool = False,
        field: str = "type",
        accepted: str | None = ACCEPTED_TYPES,
    ) -> None:
        cell = cells.get(field)
        self.reader.add(
            Problem(
                message=message,
                severity="notice" if notice else "error",
                mark=cell.mark if cell else mark,
                joint=(cells["joint"].text if "joint" in cells else "") or f"joint_{place + 1}",
                field=field,
                found=cell.text if cell else None,
                accepted=None if notice else accepted,
                suggestion=suggestion,
            )
        )


def _type_of(cells: Cells) -> JointType | None:
    cell = cells.get("type")
    return joint_type(cell.text) if cell and cell.text else None
