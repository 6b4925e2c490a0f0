"""Points and commas that may separate thousands: ``1.250`` is 1.25 to one spreadsheet and 1250 to another.

Where cells are separated by semicolons or tabs, a number with three digits behind its only sign can be read in two
ways. The other numbers of the same arm decide: ``0.5`` or ``12.25`` in it shows that the point is its decimal sign, and
so does an ``87.456`` among its lengths in mm, since no link is 87 m long. An arm without such a number is refused, and
so is one in which both signs are decimal signs. Other arms of the file count for nothing, so that a row means the same
wherever it stands.
"""

from __future__ import annotations

import re
from itertools import accumulate
from typing import TYPE_CHECKING, Any

from dh2urdf.quantities import UNITS, Dimension
from dh2urdf.source import Problem, shown
from dh2urdf_plugins.readers.words.bounds import LONG_ARM
from dh2urdf_plugins.readers.words.fields import FIELDS

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf_plugins.readers.words.cells import Cell, Units

_WORDS = {".": "point", ",": "comma"}
_GROUPED = {sign: (rf"(?<![\w.,])[1-9][0-9]{{0,2}}[{sign}][0-9]{{3}}(?![0-9.,]|[eE][+-]?[0-9])") for sign in ".,"}
"""A number that may have its sign between thousands."""
_SURE = {
    sign: (
        rf"(?<![\w.,])(?:0[0-9]*|[0-9]{{4,}}|)[{sign}][0-9]+(?![0-9.,])"
        rf"|(?<![\w.,])[0-9]+[{sign}](?:[0-9]{{1,2}}|[0-9]{{4,}}|[0-9]+[eE][+-]?[0-9]+)(?![0-9.,])"
    )
    for sign in ".,"
}
"""A number whose sign can only be the decimal one."""
_PLAIN = {sign: rf"(?m)^[ \t]*[-+−–]?[0-9]*[{sign}][0-9]+[ \t]*$" for sign in ".,"}


_THOUSAND = 1000
"""The smallest number that may have a sign between thousands; in rad and in degrees it is no angle of a table."""


def largest(fields: Iterable[str | None], units: Units) -> dict[str, float]:
    """The number in each column of geometry from which on it is none of a table, so that its sign is a decimal one."""
    found = dict.fromkeys(("alpha", "theta"), float(_THOUSAND))
    for name in ("a", "d"):
        unit = units.columns.get(name) or units.of(Dimension.LENGTH) or UNITS["mm"]  # which may be meant
        found[name] = LONG_ARM / unit.si(1.0)
    return {name: number for name, number in found.items() if name in fields}


class DecimalSigns:
    """Remembers what the numbers of one arm show of their signs.

    Attributes:
        has_commas: whether any arm so far had a number with a decimal comma.
    """

    def __init__(self, largest: Mapping[str, float]) -> None:
        """Takes the numbers of `largest`."""
        self._largest = largest
        self._sure: dict[str, Cell] = {}
        self._grouped: dict[str, tuple[Cell, str, int]] = {}
        self.has_commas = False

    def note(self, cell: Cell, name: str, number: int) -> None:
        """Looks at a number: its cell, its field, and the number of its row."""
        for sign in _WORDS:
            if sign not in cell.text:
                continue
            self.has_commas |= sign == "," and any(re.search(form[sign], cell.text) for form in (_SURE, _GROUPED))
            is_grouped = not re.search(_SURE[sign], cell.text)
            if not is_grouped or self._is_too_large(cell.text, name, sign):
                self._sure.setdefault(sign, cell)
            if is_grouped and sign not in self._grouped and re.search(_GROUPED[sign], cell.text):
                self._grouped[sign] = (cell, name, number)

    def _is_too_large(self, text: str, name: str, sign: str) -> bool:
        """Whether a number would be none of a table if the sign separated thousands."""
        if name not in self._largest or not re.fullmatch(_PLAIN[sign], text):
            return False
        return int(text.strip(" \t+-−–").replace(sign, "")) >= self._largest[name]

    def note_point(self, cell: Cell) -> None:
        """Looks at a number whose point separates no thousands, since commas separate the cells."""
        self._sure.setdefault(".", cell)

    def note_list(self, cell: Cell, parts: Iterable[str]) -> None:
        """Looks at a cell of several numbers: a comma between them is no decimal sign, so that a point is one."""
        if "," in cell.text and "." in cell.text and not any("," in part for part in parts):
            self._sure.setdefault(".", cell)

    def problem(self) -> Problem | None:
        """What is wrong with the arm's numbers, where one may have a sign between thousands; forgets the arm."""
        grouped, sure = self._grouped, self._sure
        self._grouped, self._sure = {}, {}
        problems = [_in_doubt(sign, *found, sure) for sign, found in grouped.items()]
        return next((problem for problem in problems if problem), None)


def _in_doubt(sign: str, cell: Cell, name: str, number: int, sure: Mapping[str, Cell]) -> Problem | None:
    """What is wrong with a number that may have its sign between thousands, where the other numbers show so much."""
    other = "," if sign == "." else "."
    if other in sure:
        return Problem(
            message=f"{shown(cell.text)} can be read in two ways, since {shown(sure[other].text)} in "
            f"{sure[other].mark.in_file} has a decimal {_WORDS[other]}: the {_WORDS[sign]} may separate thousands",
            mark=cell.mark,
            joint=f"joint_{number}",
            found=cell.text,
            accepted="decimal commas alone, or decimal points alone, without separators of thousands",
        )
    if sign in sure:
        return None
    return Problem(
        message=f"{shown(cell.text)} can be read in two ways: the {_WORDS[sign]} is a decimal sign or separates "
        "thousands, and no other number of the manipulator shows which",
        mark=cell.mark,
        joint=f"joint_{number}",
        field=name,
        found=cell.text,
        accepted="numbers without separators of thousands",
        suggestion=_both_readings(cell.text, sign),
    )


def _both_readings(text: str, sign: str) -> str:
    match = re.search(_GROUPED[sign], text)
    number = match.group() if match else text
    decimal = number.rstrip("0").rstrip(sign)
    if decimal == number:
        decimal += "0"  # four digits behind the sign can only be decimals
    return f"write {decimal if sign in decimal else f'{decimal}{sign}0'}, or {number.replace(sign, '')}"


class PlainPoints:
    """The same of columns of plain numbers, which have no commas."""

    def __init__(self, column: Mapping[str, int], units: Units) -> None:
        """Takes the places of the columns, and the units of the table."""
        sure = [name for name, number in largest(column, units).items() if number <= _THOUSAND]
        numbers = [name for name in column if units.decimal_comma and FIELDS[name].dimension is not None]
        self._numbers = [(column[name], _PLAIN["."] if name in sure else _SURE["."]) for name in numbers]

    def are_sure(self, columns: Sequence[Sequence[Any]], sizes: Sequence[int]) -> bool:
        """Whether no point of any arm may separate thousands.

        Args:
            columns: the cells of the table by column.
            sizes: how many rows each arm has.
        """
        if not self._numbers:
            return True
        ends = accumulate(sizes)
        return all(self._is_sure(columns, end - size, end) for size, end in zip(sizes, ends, strict=True))

    def _is_sure(self, columns: Sequence[Sequence[Any]], start: int, end: int) -> bool:
        texts = [
            ("\n".join(columns[index][start:end]), form)
            for index, form in self._numbers
            if isinstance(columns[index][start], str)  # numbers have no such signs
        ]
        return any("." in text and re.search(form, text) for text, form in texts) or not any(
            "." in text and re.search(_GROUPED["."], text) for text, _ in texts
        )
