"""Numbers as every written file has them: the one float formatter.

A number is written as the shortest decimal digits that read back to the same double, without ``.0`` on whole numbers
and without a sign on zero: ``0.089159``, ``-1``, ``0``, ``0.00001``, ``1e-7``, ``1e16``. Where exponents begin is
orjson's choice: it formats a whole list in one call, in a fraction of the time that `repr` takes. The text is a Python
float and an ``xsd:double`` alike.
"""

from __future__ import annotations

import math
from itertools import chain, repeat
from typing import TYPE_CHECKING, Any

from dh2urdf.quantities.units import Dimension

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Sequence

    from dh2urdf.quantities.units import Unit

_PARTS_OF_PI = (1, 2, 3, 4, 6, 12)
_LARGEST_MULTIPLE = 48
_PLAIN_LENGTH = 24
_MANY = 16
"""Numbers that orjson formats faster than `repr`, by more than the call takes."""
_AT_ONCE = 64
"""Rows of a table that are formatted in one call: so many that their texts stay in the processor's cache."""


def format_number(number: float) -> str:
    """The text of one number.

    Raises:
        ValueError: the number is not finite.
    """
    return format_numbers((number,))[0]


def format_numbers(numbers: Iterable[float]) -> list[str]:
    """The texts of several numbers, formatted in one call.

    Raises:
        ValueError: one of the numbers is not finite.
    """
    # Adding 0.0 drops the sign of a zero and leaves every other number as it is.
    doubles = [float(number) + 0.0 for number in numbers]
    # `repr` has the same digits; only where exponents begin, and what is not finite, differ. A conversion that needs
    # no more is spared the import of orjson, which imports the standard library's JSON.
    if len(doubles) < _MANY and "e" not in (text := ",".join(map(repr, doubles))) and "n" not in text:
        return _words(text) if doubles else []
    import orjson

    text = orjson.dumps(doubles).decode("ascii")
    if "null" in text:  # JSON has no other word for what is not finite.
        culprit = next(double for double, word in zip(doubles, text[1:-1].split(","), strict=True) if word == "null")
        raise ValueError(f"{culprit} is not a finite number and cannot be written")
    return _words(text[1:-1]) if doubles else []


def number_in(value: float, unit: Unit) -> str:
    """The text of an SI value in a unit: the shortest that reads back to the same double, where there is one."""
    if unit.degrees:
        number = math.degrees(value)
        rounded = (float(f"{number:.{digits}g}") for digits in (6, 9, 12, 14))
        near = (number, math.nextafter(number, -math.inf), math.nextafter(number, math.inf))
        return format_number(next((each for each in chain(rounded, near) if unit.si(each) == value), number))
    if unit.dimension is Dimension.ANGLE:
        return _multiple_of_pi(value) or format_number(value)
    from decimal import Decimal

    shifted = Decimal(repr(float(value))).scaleb(-unit.power).normalize()
    plain = format(shifted, "f")
    return format_number(0.0) if not shifted else plain if len(plain) <= _PLAIN_LENGTH else str(shifted)


def _multiple_of_pi(value: float) -> str | None:
    """``pi/2``, ``-3*pi/4``: a simple multiple of π that is the value to the last bit; None where it is none."""
    for part in _PARTS_OF_PI:
        times = round(value / math.pi * part)
        if times and abs(times) <= _LARGEST_MULTIPLE and times * math.pi / part == value:
            factor = "" if abs(times) == 1 else f"{abs(times)}*"
            return f"{'-' if times < 0 else ''}{factor}pi{f'/{part}' if part > 1 else ''}"
    return None


def format_rows(columns: Sequence[Any]) -> tuple[list[bytes | int], Iterator[list[bytes]]]:
    """The texts of many columns of numbers.

    Equal columns share their texts: robots hold most of their numbers twice.

    Args:
        columns: arrays of shape (N,), N > 0.

    Returns:
        For each column the text of all its numbers where they are the same, else its place in a row of texts; and these
        rows, one for each of the N.

    Raises:
        ValueError: one of the numbers is not finite.
    """
    if not columns:
        return [], iter(())
    import numpy as np

    table = np.array(columns, dtype=float) + 0.0  # without -0.0, as above
    if not np.isfinite(table).all():
        raise ValueError(f"{table[~np.isfinite(table)][0]} is not a finite number and cannot be written")
    is_constant = (table == table[:, :1]).all(axis=1).tolist()
    places: dict[bytes, int] = {}  # of the columns that vary, each once
    varying: dict[int, int] = {}
    found: list[bytes | int] = []
    for index, constant in enumerate(is_constant):
        if constant:
            found.append(format_number(table[index, 0]).encode("ascii"))
        else:
            place = places.setdefault(table[index].tobytes(), len(places))
            varying.setdefault(place, index)
            found.append(place)
    return found, _rows(table[[*varying.values()]].T)


def _rows(table: Any) -> Iterator[list[bytes]]:  # noqa: ANN401 - an array
    """The texts of the numbers in each row of a table."""
    import numpy as np
    import orjson

    count, width = table.shape
    if not width:
        yield from repeat([], count)
        return
    for first in range(0, count, _AT_ONCE):
        numbers = table[first : first + _AT_ONCE].ravel()
        texts = orjson.dumps(numbers, option=orjson.OPT_SERIALIZE_NUMPY)[1:-1].split(b",")
        for place in np.flatnonzero(numbers == np.rint(numbers)).tolist():  # No other has an exponent that is positive.
            texts[place] = texts[place].replace(b"e+", b"e").removesuffix(b".0")
        for start in range(0, len(numbers), width):
            yield texts[start : start + width]


def _words(numbers: str) -> list[str]:
    """The project's texts of orjson's numbers, given with commas between them.

    Versions of orjson differ in 1e16 and 1e+16; the shorter form is the project's.
    """
    return f"{numbers},".replace("e+", "e").replace(".0,", ",")[:-1].split(",")
