"""How many digits numbers have on the page: as many that count, however small the arm is."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dh2urdf.quantities.units import Unit

_SMALL = 0.1
"""Of an arm that is smaller [m], lengths have more digits."""


USUAL = 6
"""Digits behind the point of a number that a person reads or changes, where its arm is not small."""


def decimals(length: Unit, reach: float) -> int:
    """The digits behind the point of a length.

    Args:
        length: the unit that it is shown in.
        reach: how far the arm reaches [m].
    """
    more = math.ceil(math.log10(_SMALL / reach)) if 0.0 < reach < _SMALL else 0
    return max(2, 5 + min(0, length.power) + more)


def plain(number: float, digits: int) -> str:
    """A number with some digits behind the point, and without a minus before a zero."""
    text = f"{number:.{digits}f}"
    return text.lstrip("-") if float(text) == 0 else text


def short(number: float, digits: int) -> str:
    """The same without zeros at its end; with more digits than is usual, as many as count."""
    text = plain(number, digits).rstrip("0").rstrip(".")
    return text if digits <= USUAL else f"{float(text):.{USUAL}g}"
