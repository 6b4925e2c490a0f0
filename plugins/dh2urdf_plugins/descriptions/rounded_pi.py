"""Numbers of orientations that were meant to be parts of π and were rounded when they were written: 1.5708 for π/2."""

from __future__ import annotations

import math
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, Decimal, InvalidOperation
from typing import NamedTuple

_PI = Decimal("3.1415926535897932384626433832795028841972")
_FEWEST, _MOST = 3, 14
"""Decimals of a number that was rounded: with fewer it may be any angle, with more it is what a double holds."""
_WORDS = {1: "pi/4", 2: "pi/2", 3: "3*pi/4", 4: "pi"}


class Rounded(NamedTuple):
    """A rounded part of π.

    Attributes:
        text: the number as it is written.
        word: what it stands for.
        line: the line of the file.
    """

    text: str
    word: str
    line: int | None


def part_of_pi(text: str) -> tuple[float, str] | None:
    """The multiple of π/4 that a number is, rounded or cut to its last digit, and its word; None where it is none."""
    try:
        number = Decimal(text)
    except InvalidOperation:
        return None
    exponent = number.as_tuple().exponent
    if not isinstance(exponent, int) or not _FEWEST <= -exponent <= _MOST or not number:
        return None
    quarters = round(abs(float(number)) * 4 / math.pi)
    if not 1 <= quarters <= 2 * len(_WORDS):
        return None
    exact, place = _PI * quarters / 4, Decimal(1).scaleb(exponent)
    if abs(number) not in (exact.quantize(place, ROUND_HALF_EVEN), exact.quantize(place, ROUND_DOWN)):
        return None
    sign = -1.0 if number < 0 else 1.0
    word = _WORDS.get(quarters, f"{quarters}*pi/4")
    return sign * quarters * math.pi / 4, word if sign > 0 else f"-{word}"


def repaired(words: str, line: int | None, first: int = 0) -> tuple[str, list[Rounded]]:
    """The numbers of an orientation with their parts of π written out, and those that were rounded.

    Args:
        words: the numbers, with spaces between them.
        line: where they are written.
        first: how many of them are no angles.
    """
    written, found = words.split(), list[Rounded]()
    for index, text in enumerate(written):
        if index >= first and (meant := part_of_pi(text)):
            written[index] = repr(meant[0])
            found.append(Rounded(text, meant[1], line))
    return " ".join(written) if found else words, found
