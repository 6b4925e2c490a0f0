"""Columns of plain numbers, read at the speed of Python's own loops.

A column is plain where all of its cells are decimal numbers, or where few expressions are in all of them. Where cells
name units of their own, the columns beside them show whether that is plain, too.
"""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

from dh2urdf.quantities import Dimension, QuantityError, evaluate
from dh2urdf.rotations import HALF_PI
from dh2urdf_plugins.readers.words.bounds import REMEMBERED
from dh2urdf_plugins.readers.words.cells import LINE_END, SPACES, text_of
from dh2urdf_plugins.readers.words.fields import FIELDS

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.quantities import Unit
    from dh2urdf_plugins.readers.words.cells import Units

_TINY = "[eE]-[0-9]{3}"
"""An exponent, or what looks like one, of numbers too small for a double."""


def dimension_of(name: str, *, linear: bool = False) -> Dimension:
    """What a field measures, or what it does in the rows of prismatic joints."""
    field = FIELDS[name]
    return (field.linear if linear else None) or field.dimension or Dimension.NUMBER


def declared_unit(units: Units, name: str, *, linear: bool = False) -> Unit | None:
    """The unit that a table declares for the bare numbers of a field; None where nothing does."""
    return units.columns.get(name) or units.of(dimension_of(name, linear=linear))


class PlainNumbers:
    """Reads a column of numbers.

    Attributes:
        has_expressions: whether anything but decimal numbers was among those that were read last.
        foreign: whether any cell so far names another unit than the SI unit.
        bare: whether any number so far, 0 left aside, is in the SI unit since nothing says its unit.
    """

    def __init__(self, name: str, units: Units) -> None:
        """Takes the field of the column, and the units of the table."""
        self.has_expressions = self.foreign = self.bare = False
        self._angle = units.in_functions
        self._dimension, unit = dimension_of(name), declared_unit(units, name)
        self._unit = unit
        self._is_si = unit is None or unit.is_si
        self._converted = _converter(None if self._is_si else unit)
        self._shifts = not self._is_si and bool(unit and unit.power)
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

    def read_some(self, column: Sequence[Any]) -> list[float | None] | None:
        """The same of a column with empty cells, which are None."""
        if isinstance(column[0], float) or all(map(str.strip, column)):
            return [*found] if (found := self.read(column)) else None
        filled = [bool(cell.strip(SPACES)) for cell in column]
        if not any(filled):
            self.has_expressions = False
            return [None] * len(column)
        numbers = self.read([cell for cell, is_filled in zip(column, filled, strict=True) if is_filled])
        if numbers is None:
            return None
        given = iter(numbers)
        return [next(given) if is_filled else None for is_filled in filled]

    def decimals(self, column: Sequence[Any]) -> list[float] | None:
        """The same where all are decimal numbers; infinities and what is no number may be among them."""
        if self._shifts and isinstance(column[0], float):
            column = list(map(text_of, column))
        text = "" if isinstance(column[0], float) else ",".join(column)
        try:
            numbers = (self._is_si and text and _json_numbers(text, len(column))) or self._converted(column)
        except ValueError:
            return None
        if isinstance(column[0], float):
            return [number + 0.0 for number in numbers]  # 0 for each −0
        # `float` reads 1_0 and digits of other scripts too
        if "_" in text or LINE_END in text or not text.isascii():
            return None
        if 0.0 not in numbers:
            return numbers
        if ("e" in text or "E" in text) and re.search(_TINY, text) and not all(map(_is_held, column, numbers)):
            return None
        return [number + 0.0 for number in numbers] if "-" in text else numbers

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


def _is_held(text: str, number: float) -> bool:
    """Whether a double holds a decimal number: `float` makes 0 of 1e-400."""
    return bool(number) or not text.lower().partition("e")[0].strip(f"{SPACES}+-0.")


def _json_numbers(text: str, count: int) -> list[float] | None:
    """Decimal numbers with commas between them, where all are as JSON has them, in a quarter of the time of `float`.

    Args:
        text: some texts, joined by commas.
        count: how many.
    """
    import orjson

    try:
        numbers: list[Any] = orjson.loads(f"[{text}]")
    except orjson.JSONDecodeError:
        return None
    kinds = set(map(type, numbers))
    # A text with a comma is more than one number; a text in brackets or quotes that holds several is none.
    if len(numbers) != count or not kinds <= {float, int}:
        return None
    return list(map(float, numbers)) if int in kinds else numbers


def _converter(unit: Unit | None) -> Callable[[Sequence[Any]], list[float]]:
    """What makes SI numbers of a column of decimal numbers; it raises ValueError where a text is something else.

    Numbers that are none of texts are taken too, unless a power of ten is to be applied, which is done to texts.
    """
    if unit is None:
        return lambda column: list(map(float, column))
    if (parts := unit.parts) is not None:
        return lambda column: [float(text) / parts * HALF_PI for text in column]
    if not unit.is_shifted:
        return _no_decimals
    suffix = f"e{unit.power}"  # a text with an exponent of its own becomes no number, and is read as an expression
    return lambda column: [float(text + suffix) for text in column]


def _no_decimals(_column: Sequence[Any]) -> list[float]:
    """Leaves a column to be read text by text, where a number is more than its digits and a power of ten.

    Raises:
        ValueError: always, as for a text that is no decimal number.
    """
    raise ValueError
