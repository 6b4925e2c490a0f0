"""Columns of plain numbers, read at the speed of Python's own loops."""

from __future__ import annotations

import math
import re
from contextlib import suppress
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

_WITHOUT_UNIT = frozenset("0123456789.+-*/() eEpiPI")
"""What numbers and multiples of pi consist of."""
_TINY = "[eE]-[0-9]{3}"
"""An exponent, or what looks like one, of numbers too small for a double."""


class PlainNumbers:
    """Reads a column of numbers.

    Attributes:
        has_expressions: whether anything but decimal numbers was among those that were read last.
    """

    def __init__(self, name: str, units: Units) -> None:
        """Takes the field of the column, and the units of the table."""
        self.name = name
        self.units = units
        self.has_expressions = False
        unit = foreign_unit(units, name)
        self._converted = _converter(unit)
        self._is_si = unit is None
        self._shifts = bool(unit and unit.power)
        self._known: dict[Any, float] = {}
        self._is_declared = is_declared(units, name)
        self._named = set[Any]()  # cells that name a unit where nothing declares one

    def read(self, column: Sequence[Any]) -> list[float] | None:
        """The SI numbers of a column of texts, or of numbers; None where one of them is not plain."""
        numbers = self.decimals(column)
        self.has_expressions = numbers is None
        return self._by_text(column) if numbers is None else numbers

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

    def _by_text(self, column: Sequence[Any]) -> list[float] | None:
        """The same where some are expressions, of which a table has few that differ."""
        known = self._known
        if len(known) > REMEMBERED:
            known.clear()
        for cell in set(column) - known.keys():
            value = plain_quantity(text_of(cell), self.units, self.name)
            if value is None:
                return None
            known[cell] = value
            if not self._is_declared and names_foreign_unit(text_of(cell), self.name):
                self._named.add(cell)
        return list(map(known.__getitem__, column))

    def names_units(self, column: Sequence[Any]) -> bool:
        """Whether a cell of the column that was read last names a unit, not the SI unit, that nothing declares."""
        return bool(self._named) and self.has_expressions and not self._named.isdisjoint(column)

    def has_bare(self, column: Sequence[Any], numbers: Sequence[float]) -> bool:
        """Whether a cell of that column is no 0 and names no such unit."""
        return any(number and cell not in self._named for cell, number in zip(column, numbers, strict=True))


def plain_quantity(text: str, units: Units, name: str, *, linear: bool = False) -> float | None:
    """The SI number that a cell says, or None where there is anything else to report about it.

    Args:
        text: the cell.
        units: the units of the table.
        name: the field.
        linear: whether the joint is prismatic.
    """
    field = FIELDS[name]
    dimension = (field.linear if linear else None) or field.dimension or Dimension.NUMBER
    unit = units.columns.get(name) or units.of(dimension)
    if (unit and unit.dimension is not dimension) or (units.decimal_comma and "," in text) or LINE_END in text:
        return None
    if unit is None and text.isascii() and "_" not in text:
        with suppress(ValueError):
            number = float(text)  # as most are; `evaluate` takes eight times as long
            if math.isfinite(number) and _is_held(text, number):
                return number + 0.0
    try:
        quantity = evaluate(text.strip(SPACES), dimension, unit, angle=units.in_functions)
    except QuantityError:
        return None
    return None if quantity.variable else quantity.value


def names_foreign_unit(text: str, name: str, *, linear: bool = False) -> bool:
    """Whether a cell that is a quantity names another unit than the SI unit."""
    if _WITHOUT_UNIT.issuperset(text):
        return False
    field = FIELDS[name]
    with suppress(QuantityError):
        return evaluate(
            text.strip(SPACES), (field.linear if linear else None) or field.dimension or Dimension.NUMBER
        ).foreign
    return False


def is_declared(units: Units, name: str, *, linear: bool = False) -> bool:
    """Whether a table declares the unit of a column, or of its cells in the rows of prismatic joints."""
    field = FIELDS[name]
    dimension = (field.linear if linear else None) or field.dimension or Dimension.NUMBER
    return (units.columns.get(name) or units.of(dimension)) is not None


def foreign_unit(units: Units, name: str, *, linear: bool = False) -> Unit | None:
    """The unit of a column, or of its cells in the rows of prismatic joints; None where it is the SI unit."""
    field = FIELDS[name]
    dimension = (field.linear if linear else None) or field.dimension or Dimension.NUMBER
    unit = units.columns.get(name) or units.of(dimension)
    return unit if unit and not unit.is_si else None


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
