"""What the rows of a manipulator are, before any of them is read: joints or fixed frames, with which names.

One row alone does not show it. Numbers in a column of names are names only together; a row without a joint variable is
fixed only where the other rows have one.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.quantities import Dimension, QuantityError, evaluate, plain_text, unwrapped
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import ACCEPTED_TYPES, FIELDS, is_no_joint, joint_type

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.source import Mark
    from dh2urdf_plugins.readers.rows.rows import RowReader

Cells = dict[str, Cell]
LABEL = ":"
"""What the key of a cell in a column that no field knows begins with; the header is behind it."""
NUMBER = r"([0-9]{1,9})(?:\.0+)?"
"""A name that is the number of a row."""
AXIS = r"(?i)[-+−–]?\s*[xyz]\s*[-+−–]?"
"""A name that is an axis of a frame."""
_LABELLED = rf"(?:[^\W\d_]{{1,12}}[\s_.#-]*)?{NUMBER}\s*[*†‡§]?(?:\s*[\W_].*)?"
"""The number of a row behind a word, or before one: ``J1``, ``Axis 1``, ``1 (base)``."""
_ZERO = r"(?:[^\W\d_]{1,12}[\s_.#-]*)?0+(?:\.0+)?(?:\s*[\W_].*)?"
"""The number 0 of a row: ``0``, ``J0``, ``0 (from base)``."""
_MEANT_VARIABLE = r"(?i)(?<![a-zA-Z])(?:q|θ|ϑ|th|theta)[\W_]{0,3}[0-9ij₀-₉]"
"""A joint variable, in a cell that cannot be read: ``θ2 - θ1``."""


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
        for _, cells, _ in self.rows:
            self._take_off_typesetting(cells)
        self._take_types()
        self.indexes = {place: cells.pop("index") for place, cells, _ in self.rows if "index" in cells}
        found = {place: self._variables_in(cells) for place, cells, _ in self.rows}
        self.variables = {place: next(iter(row.values())) for place, row in found.items() if row}
        numbers = list(self.variables.items())
        reader.from_zero = len(numbers) > 1 and numbers[0] == (0, 0) and all(place == row for place, row in numbers)
        at_most_one = not reader.type_is_given and all(len(row) <= 1 for row in found.values())
        self.sliding = {place for place, row in found.items() if at_most_one and "d" in row}
        self.first = 1

    def settle(self) -> int:
        """See above."""
        self._leave_out_axes()
        self._take_names_for_indexes()
        for place, cells, mark in self.rows:
            if not ("type" in cells and cells["type"].text):
                self._settle_type(place, cells, mark)
        if self.rows and self.rows[0][0] == 0 and _type_of(self.rows[0][1]) is JointType.FIXED:
            index = self.indexes[0].text if 0 in self.indexes else None
            is_base = (
                self._variables_are_places() if index is None else re.fullmatch(_ZERO, index) or is_no_joint(index)
            )
            self.first = 0 if is_base else 1
        self._check_indexes()
        for field in ("joint", "link"):
            self._name_by_number(field)
        return self.first

    # --- Cells --------------------------------------------------------------------------------------------------------

    def _take_off_typesetting(self, cells: Cells) -> None:
        """Makes plain texts of all cells, and takes the definitions of names in them."""
        for name, cell in cells.items():
            text = cell.text
            plain = text.isascii() and text.isalnum() and not text.lower().startswith("var")
            if not text or plain or cell.as_written or name.startswith(LABEL):
                continue
            if name in ("joint", "link", "robot"):
                text = unwrapped(text)
            elif name == "index" or name not in FIELDS or FIELDS[name].dimension is None:
                text = plain_text(text)
            else:
                units = self.reader.units
                text, problem = units.symbols.take_cell(plain_text(text), cell.mark, decimal_comma=units.decimal_comma)
                if problem:
                    self.reader.add(problem)
            if text != cell.text:
                cells[name] = cell._replace(text=text)

    def _variables_in(self, cells: Mapping[str, Cell]) -> dict[str, int | None]:
        """The numbers of the joint variables that a row names, by the cell: None for one without a number."""
        found: dict[str, int | None] = {}
        for name, dimension in (("theta", Dimension.ANGLE), ("d", Dimension.LENGTH)):
            cell = cells.get(name)
            if cell is None or not any(map(str.isalpha, cell.text)):
                continue
            try:
                quantity = evaluate(cell.text, dimension, decimal_comma=True, symbols=self.reader.units.symbols)
            except QuantityError:
                if name == "theta" and re.search(_MEANT_VARIABLE, cell.text):
                    found[name] = None  # the cell is refused, and lacks no variable besides
                continue
            if quantity.variable is not None:
                found[name] = quantity.variable.row
        return found

    # --- Types --------------------------------------------------------------------------------------------------------

    def _take_types(self) -> None:
        """Takes a column for one of types, where all its cells are words for types and there is no other."""
        others = {key: None for _, cells, _ in self.rows for key in cells if key == "joint" or key.startswith(LABEL)}
        given = any("type" in cells for _, cells, _ in self.rows)
        for key in others if not given and self.rows else ():
            named = [cells[key] for _, cells, _ in self.rows if key in cells]
            words = {cell.text.casefold() for cell in named}
            letters = len(words) == len(named) and max(map(len, words)) == 1 and "p" not in words  # axes A, B, C
            if len(named) < len(self.rows) or letters or None in map(joint_type, words) or any(map(str.isdigit, words)):
                continue
            for _, cells, _ in self.rows:
                cells["type"] = cells.pop(key)
            self.reader.types_from = key.removeprefix(LABEL)
            what = "the column of joints" if key == "joint" else f"the column {shown(key[1:])}"
            self._notice(f"{what} is read as that of types: {shown(named[0].text)}", named[0], "type")
            break
        for _, cells, _ in self.rows:
            for key in [key for key in cells if key.startswith(LABEL)]:
                del cells[key]

    def _settle_type(self, place: int, cells: Cells, mark: Mark) -> None:
        """Gives a row without a type its type where that is sure, and refuses it where it hardly is a joint."""
        name = next((cells[key].text for key in ("joint", "link") if key in cells), "")
        index = self.indexes[place].text if place in self.indexes else ""
        no_joint = is_no_joint(name) or is_no_joint(index)
        is_base = place == 0 and bool(re.fullmatch(_ZERO, index or name)) and self._variables_are_places()
        if place in self.sliding and "theta" in cells and cells["theta"].text:
            cells["type"] = Cell(JointType.PRISMATIC.value, mark)
        elif self.variables and place not in self.variables:
            if no_joint or is_base:
                cells["type"] = Cell(JointType.FIXED.value, mark)
                return
            self._refuse(
                f"row {place + 1} has no joint variable and no type, and other rows have a variable",
                place,
                mark,
                "write the type fixed if nothing moves there, or the variable if it does",
            )
        elif no_joint and place not in self.variables and not self.reader.type_is_given:
            self._refuse(
                f"the row {shown(name or index)} has no type, and is hardly called like a joint",
                place,
                mark,
                "write the type fixed if nothing moves there, revolute or prismatic if it does; remove a row of totals",
            )
        else:
            return
        cells.setdefault("type", Cell(JointType.REVOLUTE.value, mark))

    # --- Numbers and names --------------------------------------------------------------------------------------------

    def _variables_are_places(self) -> bool:
        """Whether joint variables are counted from the row behind the first one."""
        numbers = [(place, number) for place, number in self.variables.items() if number]
        return bool(numbers) and all(place == number for place, number in numbers)

    def _take_names_for_indexes(self) -> None:
        """Takes the column of numbers for one of names, where it has names and no other column has."""
        if not self.indexes or any("joint" in cells for _, cells, _ in self.rows):
            return
        texts = [index.text for index in self.indexes.values()]
        if len(texts) == len(self.rows) and not any(text.isdecimal() for text in texts[:2]):
            for place, cells, _ in self.rows:
                cells["joint"] = self.indexes.pop(place)

    def _leave_out_axes(self) -> None:
        """Leaves out a column of joints that has axes of frames: ``Z``, ``Y``, ``Y``."""
        named = [cells["joint"].text.casefold() for _, cells, _ in self.rows if "joint" in cells]
        if len(set(named)) < len(self.rows) and named and all(re.fullmatch(AXIS, name) for name in named):
            for _, cells, _ in self.rows:
                cells.pop("joint", None)

    def _check_indexes(self) -> None:
        """Refuses a row whose index is not its number, counted from 0 or 1."""
        if 0 not in self.indexes or not re.search("[0-9]", "".join(index.text for index in self.indexes.values())):
            return
        first = 0 if re.fullmatch(_ZERO, self.indexes[0].text) else self.first
        for place, index in self.indexes.items():
            match = re.fullmatch(_LABELLED, index.text)
            still = next((_type_of(cells) is JointType.FIXED for row, cells, _ in self.rows if row == place), False)
            if (match and int(match[1]) == place + first) or (still and is_no_joint(index.text)):
                continue
            self._refuse(
                f"the index is {shown(index.text)}, and this is row {place + first}",
                place,
                index.mark,
                field="index",
                accepted="0, 1, 2 … or 1, 2, 3 … in the order of the rows, from the base outwards",
            )

    def _name_by_number(self, field: str) -> None:
        """Makes names of numbers: a column of joints that holds 1, 2, 3 counts them."""
        cells = {place: row[field] for place, row, _ in self.rows if field in row}
        matches = {place: re.fullmatch(NUMBER, cell.text) for place, cell in cells.items()}
        numbers = {place: int(match[1]) for place, match in matches.items() if match}
        base = self.first == 0 and 0 in cells
        if not cells or len(numbers) < len(cells) - (base and 0 not in numbers):
            return
        counts = list(numbers.values())
        ids = counts[0] > 1 and all(left < right for left, right in pairwise(counts))  # of motors, say
        first = 0 if counts[0] == 0 else self.first
        for place, number in numbers.items():
            if not ids and number != place + first:
                self._refuse(
                    f"the number of the {field} is {shown(cells[place].text)}, and this is row {place + first}",
                    place,
                    cells[place].mark,
                    field=field,
                    accepted=f"1, 2, 3 … in the order of the rows, or names, such as {field}_{cells[place].text}",
                )
        for place, row, _ in self.rows:
            if place in numbers:
                row[field] = cells[place]._replace(text=f"{field}_{cells[place].text.partition('.')[0]}")

    # --- Messages -----------------------------------------------------------------------------------------------------

    def _notice(self, message: str, cell: Cell, field: str) -> None:
        self.reader.add(Problem(message=message, severity="notice", mark=cell.mark, field=field))

    def _refuse(
        self,
        message: str,
        place: int,
        mark: Mark,
        suggestion: str | None = None,
        *,
        field: str = "type",
        accepted: str = ACCEPTED_TYPES,
    ) -> None:
        self.reader.add(
            Problem(
                message=message,
                mark=mark,
                joint=f"joint_{place + 1}",
                field=field,
                accepted=accepted,
                suggestion=suggestion,
            )
        )


def _type_of(cells: Cells) -> JointType | None:
    cell = cells.get("type")
    return joint_type(cell.text) if cell and cell.text else None
