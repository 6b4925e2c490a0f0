"""How a value is drawn: what becomes of a number between 0 and 1.

Every law is the inverse of a cumulative distribution, so that samples keep their spread (a stratum, a point of a Sobol
sequence). Results are the same on every machine: where logarithms and powers are needed, they come from decimal
arithmetic, which is rounded correctly everywhere, and not from the system's C library.

Sources: Wichura, algorithm AS241 (Applied Statistics 37, 1988), for quantiles of the normal distribution; Marsaglia,
Evaluating the normal distribution (J. Stat. Software 11(4), 2004), for its cumulative distribution.
"""

from __future__ import annotations

from decimal import Context, Decimal
from functools import lru_cache
from math import sqrt
from typing import TypeAlias

from dh2urdf.elementwise import Number, is_column, where
from dh2urdf.late_dataclasses import dataclass

DrawnValue: TypeAlias = float | str
"""A number in SI units, a whole number of axes, or the word of a joint type."""

_CONTEXT = Context(prec=25)
_FINE = Context(prec=60)
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
        low, high = _logarithm(self.low), _logarithm(self.high)
        exponent = _CONTEXT.fma(Decimal(u), _CONTEXT.subtract(high, low), low)
        return float(_clamped(float(_CONTEXT.exp(exponent)), self.low, self.high))


@dataclass(frozen=True, slots=True, kw_only=True)
class Normal:
    """A normal distribution, cut off at two bounds.

    Attributes:
        mean: of the distribution before it is cut; None for the nominal value.
        deviation: its standard deviation.
        low: the lower bound.
        high: the upper bound.
    """

    mean: float | None
    deviation: float
    low: float
    high: float

    def draw(self, u: float, nominal: float | None = None) -> float:
        """The value of a number u between 0 and 1."""
        mean = self._mean(nominal)
        side, low, high = self._probabilities(mean)
        z = side * normal_quantile(_between(low, high, u if side > 0 else 1.0 - u))
        return float(_clamped(mean + self.deviation * z, self.low, self.high))

    def probability(self, nominal: float | None = None) -> float:
        """How much of the whole distribution lies between the bounds."""
        _, low, high = self._probabilities(self._mean(nominal))
        return high - low

    def _mean(self, nominal: float | None) -> float:
        mean = nominal if self.mean is None else self.mean
        if mean is None:
            raise ValueError("a normal distribution without a mean needs a nominal value")
        return mean

    def _probabilities(self, mean: float) -> tuple[int, float, float]:
        """The cumulative distribution at the bounds; mirrored, side -1, where both are above the mean.

        Small probabilities have all their digits, those near 1 have lost them.
        """
        low, high = (self.low - mean) / self.deviation, (self.high - mean) / self.deviation
        return (-1, normal_cdf(-high), normal_cdf(-low)) if low > 0 else (1, normal_cdf(low), normal_cdf(high))


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
        values: list[DrawnValue] = law.draw(u, nominal).tolist()
        return values
    return [law.draw(each, nominal) for each in u.tolist()]


def _between(low: float, high: float, u: Number) -> Number:
    return _clamped(low + (high - low) * u, low, high)


def _clamped(value: Number, low: float, high: float) -> Number:
    if is_column(value):  # as `max` and `min` choose, also between zeros
        return where(high < (raised := where(low > value, low, value)), high, raised)
    return min(max(value, low), high)


def _nominal(nominal: float | None) -> float:
    if nominal is None:
        raise ValueError("a scale or an offset needs a nominal value")
    return nominal


@lru_cache(maxsize=4096)
def _logarithm(number: float) -> Decimal:
    return _CONTEXT.ln(Decimal(number))


# --- The normal distribution ------------------------------------------------------------------------------------------


@lru_cache(maxsize=4096)
def normal_cdf(z: float) -> float:
    """How much of a standard normal distribution lies below z.

    Marsaglia's series, of positive terms only: Φ(z) = 1/2 + φ(z)·(z + z³/3 + z⁵/(3·5) + …).
    """
    if abs(z) > FARTHEST:
        return 0.0 if z < 0 else 1.0
    x = Decimal(z)
    square = _FINE.multiply(x, x)
    total, term, factor = x, x, 1
    while term.copy_abs() > _NOTHING:
        factor += 2
        term = _FINE.divide(_FINE.multiply(term, square), Decimal(factor))
        total = _FINE.add(total, term)
    density = _FINE.divide(_FINE.exp(_FINE.divide(square, Decimal(-2))), _SQRT_TAU)
    return float(_FINE.add(Decimal("0.5"), _FINE.multiply(density, total)))


_NOTHING = Decimal("1e-60")
_SQRT_TAU = _FINE.sqrt(Decimal("6.28318530717958647692528676655900576839433879875021164194988918461563281257"))


def normal_quantile(probability: float) -> float:
    """The z below which a probability of a standard normal distribution lies: AS241, PPND16, to about 1e-16."""
    q = probability - 0.5
    if abs(q) <= 0.425:  # noqa: PLR2004 - as in AS241
        r = 0.180625 - q * q
        return q * _polynomial(_A, r) / _polynomial(_B, r)
    tail = min(probability, 1.0 - probability)
    if tail <= 0.0:
        return -FARTHEST if q < 0.0 else FARTHEST
    r = sqrt(-float(_CONTEXT.ln(Decimal(tail))))
    if r <= 5.0:  # noqa: PLR2004 - as in AS241
        z = _polynomial(_C, r - 1.6) / _polynomial(_D, r - 1.6)
    else:
        z = _polynomial(_E, r - 5.0) / _polynomial(_F, r - 5.0)
    return -z if q < 0.0 else z


def _polynomial(coefficients: tuple[float, ...], x: float) -> float:
    """By Horner's rule, the highest power first."""
    total = 0.0
    for coefficient in coefficients:
        total = total * x + coefficient
    return total


# The coefficients of AS241, the highest power first: of numerators and denominators, from the middle outwards.
_A = (
    2509.0809287301227,
    33430.57558358813,
    67265.7709270087,
    45921.95393154987,
    13731.69376550946,
    1971.5909503065513,
    133.14166789178438,
    3.3871328727963665,
)
_B = (
    5226.495278852854,
    28729.085735721943,
    39307.89580009271,
    21213.794301586597,
    5394.196021424751,
    687.1870074920579,
    42.31333070160091,
    1.0,
)
_C = (
    0.0007745450142783414,
    0.022723844989269184,
    0.2417807251774506,
    1.2704582524523684,
    3.6478483247632045,
    5.769497221460691,
    4.630337846156546,
    1.4234371107496835,
)
_D = (
    1.0507500716444169e-09,
    0.0005475938084995345,
    0.015198666563616457,
    0.14810397642748008,
    0.6897673349851,
    1.6763848301838038,
    2.053191626637759,
    1.0,
)
_E = (
    2.0103343992922881e-07,
    2.7115555687434876e-05,
    0.0012426609473880784,
    0.026532189526576124,
    0.29656057182850487,
    1.7848265399172913,
    5.463784911164114,
    6.657904643501103,
)
_F = (
    2.0442631033899397e-15,
    1.421511758316446e-07,
    1.8463183175100548e-05,
    0.0007868691311456133,
    0.014875361290850615,
    0.1369298809227358,
    0.599832206555888,
    1.0,
)
