"""How a value is drawn: what becomes of a number between 0 and 1.

Every law is the inverse of a cumulative distribution, so that samples keep their spread (a stratum, a point of a Sobol
sequence). Logarithms and powers come from decimal arithmetic, which is rounded correctly on every machine. The normal
distribution comes from the standard library, and with it from the C library of the system, whose last bit may differ.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from decimal import Context, Decimal
from typing import TypeAlias

from dh2urdf.rotations import Number, is_column, where

DrawnValue: TypeAlias = float | str
"""A number in SI units, a whole number of axes, or the word of a joint type."""

_CONTEXT = Context(prec=25)
FARTHEST = 10.0
"""Standard deviations beyond which nothing is left of a normal distribution: 8e-24."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choices:
    """One of some values, all equally likely."""

    values: tuple[DrawnValue, ...]

    def draw(self, u: float, nominal: float | None = None) -> DrawnValue:  # noqa: ARG002 - laws are called alike
        """The value of a number u between 0 and 1."""
        return self.values[int(u * len(self.values))]


@dataclass(frozen=True, slots=True, kw_only=True)
class Grid:
    """Every one of some values, combined with every one of all other grids."""

    values: tuple[DrawnValue, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class Uniform:
    """Any value of a range, all equally likely."""

    low: float
    high: float

    def draw(self, u: Number, nominal: float | None = None) -> Number:  # noqa: ARG002 - laws are called alike
        """The value of a number u between 0 and 1, or of each of a column."""
        return _between(self.low, self.high, u)


@dataclass(frozen=True, slots=True, kw_only=True)
class LogUniform:
    """Any value of a range above 0, all orders of magnitude equally likely."""

    low: float
    high: float

    def draw(self, u: float, nominal: float | None = None) -> float:  # noqa: ARG002 - laws are called alike
        """The value of a number u between 0 and 1."""
        low, high = (_CONTEXT.ln(Decimal(end)) for end in (self.low, self.high))
        exponent = _CONTEXT.fma(Decimal(u), _CONTEXT.subtract(high, low), low)
        return float(_clamped(float(_CONTEXT.exp(exponent)), self.low, self.high))


@dataclass(frozen=True, slots=True, kw_only=True)
class Normal:
    """A normal distribution, cut off at two bounds."""

    mean: float | None  # of the distribution before it is cut; None for the nominal value
    deviation: float
    low: float
    high: float

    def draw(self, u: float, nominal: float | None = None) -> float:
        """The value of a number u between 0 and 1: by AS241, to about 1e-16."""
        from statistics import NormalDist  # 10 ms, for those who draw so

        mean, (side, low, high) = self._cut(nominal)
        probability = _between(low, high, u if side > 0 else 1.0 - u)
        if 0.0 < probability < 1.0:
            z = side * NormalDist().inv_cdf(probability)
        else:
            z = side * (FARTHEST if probability > 0.0 else -FARTHEST)
        return float(_clamped(mean + self.deviation * z, self.low, self.high))

    def probability(self, nominal: float | None = None) -> float:
        """How much of the whole distribution lies between the bounds."""
        _, (_, low, high) = self._cut(nominal)
        return high - low

    def _cut(self, nominal: float | None) -> tuple[float, tuple[int, float, float]]:
        """The mean, and the cumulative distribution at the bounds; mirrored, side -1, where both are above the mean.

        Small probabilities have all their digits, those near 1 have lost them.
        """
        mean = _nominal(nominal) if self.mean is None else self.mean
        low, high = (self.low - mean) / self.deviation, (self.high - mean) / self.deviation
        return mean, (-1, normal_cdf(-high), normal_cdf(-low)) if low > 0 else (1, normal_cdf(low), normal_cdf(high))


@dataclass(frozen=True, slots=True, kw_only=True)
class Scale:
    """The nominal value times any factor of a range."""

    low: float
    high: float

    def draw(self, u: Number, nominal: float | None = None) -> Number:
        """The value of a number u between 0 and 1, or of each of a column."""
        return _nominal(nominal) * _between(self.low, self.high, u)


@dataclass(frozen=True, slots=True, kw_only=True)
class Offset:
    """The nominal value plus any number of a range."""

    low: float
    high: float

    def draw(self, u: Number, nominal: float | None = None) -> Number:
        """The value of a number u between 0 and 1, or of each of a column."""
        return _nominal(nominal) + _between(self.low, self.high, u)


Law: TypeAlias = Choices | Grid | Uniform | LogUniform | Normal | Scale | Offset


def is_relative(law: Law) -> bool:
    """Whether a law needs a nominal value."""
    return isinstance(law, Scale | Offset) or (isinstance(law, Normal) and law.mean is None)


def ends(law: Law, nominal: float) -> tuple[float, ...]:
    """The numbers between which a law draws all values, or all but one in a thousand of a normal distribution."""
    if isinstance(law, Choices | Grid):
        return tuple(map(float, law.values))
    rare = 5e-4 if isinstance(law, Normal) else 0.0
    return law.draw(rare, nominal), law.draw(1.0 - rare, nominal)


def evenly_spaced(low: float, high: float, points: int) -> tuple[float, ...]:
    """Numbers at equal distances, both ends included."""
    return (*(low + (high - low) * index / (points - 1) for index in range(points - 1)), high)


def draw_many(
    law: Choices | Uniform | LogUniform | Normal | Scale | Offset, u: Number, nominal: float | None
) -> list[DrawnValue]:
    """The values of a column of numbers between 0 and 1: to the last bit what `draw` returns for each."""
    if isinstance(law, Uniform | Scale | Offset):
        import numpy as np

        with np.errstate(over="ignore"):  # A number that is too large is reported where the table is made.
            return list(law.draw(u, nominal).tolist())
    return [law.draw(each, nominal) for each in u.tolist()]


def _between(low: float, high: float, u: Number) -> Number:
    return _clamped(low + (high - low) * u, low, high)


def _clamped(value: Number, low: float, high: float) -> Number:
    if is_column(value):  # as `max` and `min` choose, also between zeros
        return where(high < (raised := where(low > value, low, value)), high, raised)
    return min(max(value, low), high)


def _nominal(nominal: float | None) -> float:
    if nominal is None:
        raise ValueError("a law that starts from the nominal value needs a nominal value")
    return nominal


# --- The normal distribution ------------------------------------------------------------------------------------------


def normal_cdf(z: float) -> float:
    """How much of a standard normal distribution lies below z, with all digits in the tails."""
    return 0.5 * math.erfc(-z / math.sqrt(2.0)) if abs(z) <= FARTHEST else float(z > 0)
