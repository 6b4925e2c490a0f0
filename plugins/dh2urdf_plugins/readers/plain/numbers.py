"""Columns of plain numbers, read at the speed of Python's own loops.

A column is plain where all of its cells are decimal numbers, or where few expressions are in all of them. Where cells
name units of their own, the columns beside them show whether that is plain, too.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dh2urdf.quantities import QuantityError, evaluate
from dh2urdf.rotations import HALF_PI
from dh2urdf_plugins.readers.words.bounds import REMEMBERED
from dh2urdf_plugins.readers.words.cells import LINE_END, SPACES, text_of
from dh2urdf_plugins.readers.words.fields import FIELDS

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.readers.header.units import Units

_TINY = "[eE]-[0-9]{3}"
"""An exponent, or what looks like one, of numbers too small for a double."""


class PlainNumbers:
    """Reads the columns of a field, in rows of joints that turn or slide, in a table of some units."""

    def __init__(self, name: str, units: Units, *, slides: bool = False) -> None:
        self.has_expressions = False  # whether anything but decimal numbers was among those that were read last
        self.foreign = False  # whether any cell so far names another unit than the SI unit
        self.bare = False  # whether any number so far, 0 left aside, is in the SI unit since nothing says its unit
        self._dimension = FIELDS[name].measures(slides=slides)
        self._unit, self._angle = units.unit_of(name, self._dimension), units.in_functions
        self._known: dict[Any, float] = {}

    def read(self, column: Sequence[Any]) -> list[float] | None:
        """The SI numbers of a column of texts, or of numbers; None where one of them is not plain."""
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

    def read_some(self, column: Sequence[Any]) -> Sequence[float | None] | None:
        """The same of a column with empty cells, which are None."""
        if isinstance(column[0], float) or all(column):
            return self.read(column)
        filled = [cell for cell in column if cell]
        numbers = self.read(filled) if filled else []
        given = iter(numbers or ())
        return None if numbers is None else [next(given) if cell else None for cell in column]

    def decimals(self, column: Sequence[Any]) -> list[float] | None:
        """The same where all are decimal numbers, infinities and NaN among them."""
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
