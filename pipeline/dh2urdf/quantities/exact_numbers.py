"""Fractions, and decimal numbers as text: `fractions` and `decimal` would take long at every start."""

from __future__ import annotations

import math

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.late_tuples import NamedTuple


@dataclass(frozen=True, slots=True)
class Ratio:
    """A fraction in its lowest terms.

    Attributes:
        over: the numerator.
        under: the denominator.
    """

    over: int
    under: int = 1

    def __mul__(self, other: Ratio | int) -> Ratio:
        over, under = (other, 1) if isinstance(other, int) else (other.over, other.under)
        common = math.gcd(self.over * over, self.under * under)
        return Ratio(self.over * over // common, self.under * under // common)

    def __truediv__(self, other: Ratio | int) -> Ratio:
        return self * (Ratio(1, other) if isinstance(other, int) else Ratio(other.under, other.over))


ONE = Ratio(1)


class Decimal(NamedTuple):
    """A decimal number as text: digits with sign and point, and a power of ten."""

    digits: str
    exponent: int

    @property
    def is_zero(self) -> bool:
        """Whether the number is 0, whatever a double can hold of it."""
        return not self.digits.strip("+-0.")
