"""What the rows of a manipulator are, before any of them is read: joints or fixed frames, with which names.

One row alone does not show it. Numbers in a column of names are names only together; a row without a joint variable is
fixed only where the other rows have one.
"""

from __future__ import annotations

import re
from itertools import pairwise
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.quantities import Dimension, QuantityError, evaluate
from dh2urdf.source import Messages, shown
from dh2urdf_plugins.readers.rows.cells import LABEL
from dh2urdf_plugins.readers.words.cells import Cell
from dh2urdf_plugins.readers.words.fields import is_no_joint, joint_type

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from dh2urdf.source import Mark
    from dh2urdf_plugins.readers.rows.rows import RowReader

Cells = dict[str, Cell]
_NUMBER = r"([0-9]{1,9})(?:\.0+)?"
"""A name that is the number of a row."""
_AXIS = r"(?i)[-+−–]?\s*[xyz]\s*[-+−–]?"
"""A name that is an axis of a frame."""
_LABELLED = rf"(?:[^\W\d_]{{1,12}}[\s_.#-]*)?{_NUMBER}\s*[*†‡§]?(?:\s*[\W_].*)?"
"""The number of a row behind a word, or before one: ``J1``, ``Axis 1``, ``1 (base)``."""
_MEANT_VARIABLE = r"(?i)(?<![a-zA-Z])(?:q|θ|ϑ|th|theta)[\W_]{0,3}[0-9ij₀-₉]"
"""A joint variable, in a cell that cannot be read: ``θ2 - θ1``."""
_ZERO = r"(?:[^\W\d_]{1,12}[\s_.#-]*)?0+(?:\.0+)?(?:\s*[\W_].*)?"
"""The number 0 of a row: ``0``, ``J0``, ``0 (from base)``."""
say = Messages(__file__)


class JointRows:
    """The rows of one manipulator, which get their types and names as far as only all rows together show them.

    The cells of each row are changed; they are None where they cannot be told apart.
    """

    def __init__(self, rows: Sequence[tuple[Cells | None, Mark]], reader: RowReader) -> None:
        self.rows = {place: cells for place, (cells, _) in enumerate(rows) if cells is not None}
        self.marks = [mark for _, mark in rows]
        self.reader = reader
        self._take_types()
        self._leave_out_axes()
        self.indexes = {place: cells.pop("index") for place, cells in self.rows.items() if "index" in cells}
        self._take_indexes_for_names()
        found = {place: _variables_in(cells, reader) for place, cells in self.rows.items()}
        variables = {place: next(iter(row.values())) for place, row in found.items() if row}
        numbers = [(place, number) for place, number in variables.items() if number]
        self.variables, self.count_from_second = variables, bool(numbers) and all(k == number for k, number in numbers)
        reader.from_zero = 0 in variables and len(variables) > 1 and all(k == row for k, row in variables.items())
        one_each = not reader.type_is_given and all(len(row) <= 1 for row in found.values())
        for place, cells in self.rows.items():
            if not ("type" in cells and cells["type"].text):
                self._settle_type(place, cells, slides=one_each and "d" in found[place])
        index, is_fixed = self.indexes.get(0), _type_of(self.rows.get(0, {})) is JointType.FIXED
        is_base = (re.fullmatch(_ZERO, index.text) or is_no_joint(index.text)) if index else self.count_from_second
        self.first = 0 if is_fixed and is_base else 1  # 0: the base, and joints are counted from the next row
        self._check_indexes()
        self._name_by_number("joint")
        self._name_by_number("link")

    # --- Types --------------------------------------------------------------------------------------------------------

    def _take_types(self) -> None:
        """Takes a column for one of types, where all its cells are words for types and there is no other."""
        rows = self.rows.values()
        others = {key: None for cells in rows for key in cells if key == "joint" or key.startswith(LABEL)}
        for key in () if any("type" in cells for cells in rows) else others:
            named = [cells[key] for cells in rows if key in cells]
            words = {cell.text.casefold() for cell in named}
            letters = len(words) == len(named) and max(map(len, words)) == 1 and "p" not in words  # axes A, B, C
            if len(named) < len(rows) or letters or None in map(joint_type, words) or any(map(str.isdigit, words)):
                continue
            for cells in rows:
                cells["type"] = cells.pop(key)
            self.reader.types_from = key.removeprefix(LABEL)
            what = "the column of joints" if key == "joint" else f"the column {shown(key[1:])}"
            self.reader.add(say("types-taken", named[0].mark, field="type", what=what, first=shown(named[0].text)))
            break
        for cells in rows:
            for key in [key for key in cells if key.startswith(LABEL)]:
                del cells[key]

    def _settle_type(self, place: int, cells: Cells, *, slides: bool) -> None:
        """Gives a row without a type its type where that is sure, and refuses it where it hardly is a joint."""
        name = next((cells[key].text for key in ("joint", "link") if key in cells), "")
        index = self.indexes[place].text if place in self.indexes else ""
        kind, refusal = JointType.REVOLUTE, ""
        no_joint = is_no_joint(name) or is_no_joint(index)
        if slides and "theta" in cells and cells["theta"].text:
            kind = JointType.PRISMATIC
        elif self.variables and place not in self.variables:
            is_base = place == 0 and self.count_from_second and re.fullmatch(_ZERO, index or name)
            kind, refusal = (JointType.FIXED, "") if no_joint or is_base else (kind, "row-without-variable")
        elif no_joint and not self.variables and not self.reader.type_is_given:
            refusal = "row-no-joint"
        else:
            return
        if refusal:
            about = {"joint": f"joint_{place + 1}", "field": "type", "row": shown(name or index)}
            self.reader.add(say(refusal, self.marks[place], **about, number=place + 1))
        cells["type"] = Cell(kind.value, self.marks[place])

    # --- Numbers and names --------------------------------------------------------------------------------------------

    def _leave_out_axes(self) -> None:
        """Leaves out a column of joints that has axes of frames: ``Z``, ``Y``, ``Y``."""
        named = [cells["joint"].text.casefold() for cells in self.rows.values() if "joint" in cells]
        if len(set(named)) < len(self.rows) and all(re.fullmatch(_AXIS, name) for name in named):
            for cells in self.rows.values():
                cells.pop("joint", None)

    def _take_indexes_for_names(self) -> None:
        """Takes the column of numbers for one of names, where it has names and no other column has."""
        texts = [index.text for index in self.indexes.values()]
        has_names = any("joint" in cells for cells in self.rows.values())
        if has_names or len(texts) < len(self.rows) or any(text.isdecimal() for text in texts[:2]):
            return
        for place, cells in self.rows.items():
            cells["joint"] = self.indexes.pop(place)

    def _check_indexes(self) -> None:
        """Refuses a row whose index is not its number, counted from 0 or 1."""
        if 0 not in self.indexes or not re.search("[0-9]", "".join(index.text for index in self.indexes.values())):
            return
        first = 0 if re.fullmatch(_ZERO, self.indexes[0].text) else self.first
        for place, index in self.indexes.items():
            match = re.fullmatch(_LABELLED, index.text)
            stands = is_no_joint(index.text) and _type_of(self.rows[place]) is JointType.FIXED
            if not (match and int(match[1]) == place + first) and not stands:
                self._refuse_number(place, "index", index, place + first)

    def _refuse_number(self, place: int, field: str, cell: Cell, number: int) -> None:
        about = {"joint": f"joint_{place + 1}", "field": field, "text": cell.text}
        self.reader.add(say("number-wrong", cell.mark, **about, number=number))

    def _name_by_number(self, field: str) -> None:
        """Makes names of numbers: a column of joints that holds 1, 2, 3 counts them."""
        cells = {place: row[field] for place, row in self.rows.items() if field in row}
        matches = {place: re.fullmatch(_NUMBER, cell.text) for place, cell in cells.items()}
        numbers = {place: int(match[1]) for place, match in matches.items() if match}
        base = self.first == 0 and 0 in cells
        if not cells or len(numbers) < len(cells) - (base and 0 not in numbers):
            return
        counts = list(numbers.values())
        ids = counts[0] > 1 and all(left < right for left, right in pairwise(counts))  # of motors, say
        first = 0 if counts[0] == 0 else self.first
        for place, number in numbers.items():
            cell = cells[place]
            if not ids and number != place + first:
                self._refuse_number(place, field, cell, place + first)
            self.rows[place][field] = cell._replace(text=f"{field}_{cell.text.partition('.')[0]}", typed=cell.text)


def _variables_in(cells: Mapping[str, Cell], reader: RowReader) -> dict[str, int | None]:
    """The numbers of the joint variables that a row names, by the cell: None for one without a number."""
    found: dict[str, int | None] = {}
    for name, dimension in (("theta", Dimension.ANGLE), ("d", Dimension.LENGTH)):
        text = cells[name].text if name in cells else ""
        if not any(map(str.isalpha, text)):
            continue
        try:
            variable = evaluate(text, dimension, decimal_comma=True, symbols=reader.units.symbols).variable
        except QuantityError:
            if name == "theta" and re.search(_MEANT_VARIABLE, text):
                found[name] = None  # the cell is refused, and lacks no variable besides
        else:
            found |= {name: variable.row} if variable else {}
    return found


def _type_of(cells: Cells) -> JointType | None:
    cell = cells.get("type")
    return joint_type(cell.text) if cell and cell.text else None
