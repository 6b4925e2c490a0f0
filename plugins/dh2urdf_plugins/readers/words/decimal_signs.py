"""Commas in numbers: a comma is the decimal sign where it cannot separate thousands.

`1,250` alone is refused: it is 1.25 in one country and 1250 in another; beside `0,3` it is 1.25. Beside decimal commas
`1.250` is refused for the same reason, and `304.8` is read. Other arms of the file do not matter.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.source import Problem, shown

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf_plugins.readers.words.cells import Cell

_GROUPED = r"[-+−–]?[1-9][0-9]{0,2}(?:,[0-9]{3})+(?![0-9])"
"""A number whose commas may separate thousands."""
_GROUPED_BY_POINTS = r"(?<![0-9.,])[1-9][0-9]{0,2}(?:\.[0-9]{3})+(?![0-9])"
"""A number whose points may separate thousands."""
_COMMA = r"[0-9],[0-9]|(?<![0-9]),[0-9]"


class DecimalSigns:
    """Remembers the signs in the numbers of one arm.

    Attributes:
        has_commas: whether any arm so far had a number with a comma.
    """

    def __init__(self) -> None:
        """Starts with no number."""
        self.has_commas = False
        self._comma: Cell | None = None
        self._point: Cell | None = None  # one that may separate thousands
        self._sure = False  # whether a comma cannot separate thousands

    def note(self, cell: Cell) -> None:
        """Looks at a number."""
        if "," in cell.text and re.search(_COMMA, cell.text):
            self.has_commas = True
            self._sure |= not re.search(_GROUPED, cell.text)
            self._comma = self._comma or cell
        if "." in cell.text and re.search(_GROUPED_BY_POINTS, cell.text):
            self._point = self._point or cell

    def note_list(self, cell: Cell, parts: Iterable[str]) -> None:
        """Looks at a cell of several numbers: a comma between them is no decimal sign."""
        for part in parts:
            self.note(cell._replace(text=part))

    def problem(self) -> Problem | None:
        """What is wrong with the arm's numbers; forgets the arm."""
        comma, point, sure = self._comma, self._point, self._sure
        self._comma, self._point, self._sure = None, None, False
        if comma is None or (sure and point is None):
            return None
        if point is not None:
            why = f"and {shown(point.text)} in {point.mark.in_file} has a point, which may separate thousands"
        else:
            why = "and no other number of the manipulator shows whether its comma separates thousands"
        return Problem(
            message=f"{shown(comma.text)} can be read in two ways, {why}",
            mark=comma.mark,
            found=comma.text,
            accepted="decimal commas alone, or decimal points alone, without separators of thousands",
        )
