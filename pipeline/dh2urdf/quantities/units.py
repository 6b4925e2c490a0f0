"""Units of measure, and what their words mean.

Every factor is an exact fraction, so that a number of any unit is the double nearest to its value in SI units. Angles
are the exception that no fraction can have: they are quarter turns first, so that 90° is the double π/2.
"""

from __future__ import annotations

import math
import re
import tomllib
import unicodedata
from dataclasses import dataclass
from enum import StrEnum
from functools import lru_cache
from itertools import accumulate
from pathlib import Path
from typing import NamedTuple

from dh2urdf.quantities.spellings import composed
from dh2urdf.rotations import HALF_PI
from dh2urdf.source import did_you_mean, shown


class Dimension(StrEnum):
    """What a quantity measures.

    `EFFORT` is a force or a torque, where the type of the joint is not known yet; `FORCE` and `TORQUE` are one each.
    """

    NUMBER = "a bare number"
    LENGTH = "a length"
    ANGLE = "an angle"
    SPEED = "a speed"
    TURN_RATE = "an angular speed"
    ACCELERATION = "an acceleration"
    TURN_ACCELERATION = "an angular acceleration"
    JERK = "a jerk"
    TURN_JERK = "an angular jerk"
    MASS = "a mass"
    EFFORT = "a force or torque"
    FORCE = "a force"
    TORQUE = "a torque"
    DAMPING = "a rotational damping"
    LINEAR_DAMPING = "a linear damping"
    INERTIA = "a moment of inertia"
    DENSITY = "a density"

    @property
    def plain(self) -> str:
        """The words without their article."""
        return self.split(" ", 1)[1]

    def holds(self, other: Dimension) -> bool:
        """Whether a quantity of another dimension is one of this."""
        return self is other or (self is Dimension.EFFORT and other in (Dimension.FORCE, Dimension.TORQUE))


RATES = {
    Dimension.SPEED: (Dimension.LENGTH, "/s"),
    Dimension.TURN_RATE: (Dimension.ANGLE, "/s"),
    Dimension.ACCELERATION: (Dimension.LENGTH, "/s²"),
    Dimension.TURN_ACCELERATION: (Dimension.ANGLE, "/s²"),
    Dimension.JERK: (Dimension.LENGTH, "/s³"),
    Dimension.TURN_JERK: (Dimension.ANGLE, "/s³"),
}
"""What is a length or an angle per time, and what follows the unit of these."""


class Decimal(NamedTuple):
    """A decimal number as text, digits with sign and point, and a power of ten: `decimal` takes long to import."""

    digits: str
    exponent: int

    @property
    def is_zero(self) -> bool:
        """Whether the number is 0, whatever a double can hold of it."""
        return not self.digits.strip("+-0.")


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of measure.

    A number of it is number · factor · 10^power of the SI unit. Where it counts parts of a turn, a number of it is
    number / parts quarter turns.

    Attributes:
        symbol: how messages write it.
        dimension: what it measures.
        power: the power of ten that it is of the SI unit.
        factor: what else it is of the SI unit: a decimal number, or a fraction of two; empty for 1.
        parts: how many of it a quarter turn has, or a quarter turn per second; None for what is no part of a turn.
    """

    symbol: str
    dimension: Dimension
    power: int = 0
    factor: str = ""
    parts: float | None = None

    @property
    def degrees(self) -> bool:
        """Whether it counts degrees in place of radians."""
        return self.parts == 90  # noqa: PLR2004 - degrees of a quarter turn

    @property
    def is_shifted(self) -> bool:
        """Whether a decimal point in another place makes its numbers those of the SI unit."""
        return not self.factor and self.parts is None

    @property
    def is_si(self) -> bool:
        """Whether its numbers are those of the SI unit."""
        return self.power == 0 and self.is_shifted

    def number(self, value: float) -> float:
        """How many of this unit a value in SI units is, to within rounding."""
        return math.degrees(value) if self.degrees else value / self.si(1.0)

    def si(self, number: float, decimal: Decimal | None = None) -> float:
        """A number of this unit in SI units [m, rad, kg, s].

        Args:
            number: how many.
            decimal: the text that the number was read from, where it is a bare decimal number.
        """
        if self.parts is not None:
            return number / self.parts * HALF_PI  # a multiple of 90° is whole quarter turns, to the last bit
        if self.is_si or number == 0 or not math.isfinite(number):
            return number
        if not self.factor and decimal is not None:
            return float(f"{decimal.digits}e{decimal.exponent + self.power}")
        if not self.factor:
            return number * 10.0**self.power if self.power > 0 else number / 10.0**-self.power
        from fractions import Fraction

        over, _, under = self.factor.partition("/")
        exact = Fraction(number) if decimal is None else Fraction(decimal.digits) * Fraction(10) ** decimal.exponent
        try:
            return float(exact * Fraction(over) / Fraction(under or 1) * Fraction(10) ** self.power)
        except OverflowError:
            return math.copysign(math.inf, number)


# --- Words ------------------------------------------------------------------------------------------------------------

with (Path(__file__).parent / "units.toml").open("rb") as _file:
    _TABLES = tomllib.load(_file)
_LATIN = {word: unit for unit, words in _TABLES["scripts"].items() for word in words.split()}
_FIRST_OF_OTHERS = "\u0400"
_IN_OTHERS = rf"[{_FIRST_OF_OTHERS}-\uffff]+"


LONGEST_UNIT = 100
"""Characters of a text that may be a unit."""


def _factors(text: str) -> list[str]:
    """The factors of a unit as they are written, without case: ``kg m^2`` is kg and m2, ``kgm²`` is one word."""
    if len(text) > LONGEST_UNIT:
        return [text]
    if text.isascii() and text.replace("_", "").isalnum() and "sec" not in (word := text.lower()) and "min" not in word:
        return [word]
    word = composed(text).casefold().strip()
    if max(word, default="") >= _FIRST_OF_OTHERS:  # мм/с is mm/s
        word = re.sub(_IN_OTHERS, lambda match: _LATIN.get(match[0], match[0]), word)
    word = re.sub(r"sec(?:onds?)?", "s", re.sub(r"\s*\bper\s+", "/", word)).replace("minute", "min")
    if word.isalpha():
        return [word]
    if word.endswith(("1", "2", "3")):
        word = re.sub(r"(s|min)\s*\^?\s*[-\N{MINUS SIGN}](?:1|([23]))$", r"/\1\2", word)
    word = re.sub(_NO_FACTOR, "", f"1{word}" if word.startswith("/") else word)
    return [factor for factor in re.split(_TIMES, word) if factor]


_TIMES = r"(?<=\w)-(?=\w)|[\s·⋅∙•*^.]+"
_NO_FACTOR = r"[\s·⋅∙•*^.]+(?=[\d/])|(?<=/)\s+"
"""What is between a unit and its power, or beside a sign of division."""


@lru_cache(maxsize=1024)
def unit_word(text: str) -> str:
    """The word of a unit without case, spaces and signs of multiplication: ``kg m^2`` is ``kgm2``.

    Where these are in the middle of a factor they remain, and it is the word of no unit: ``m·m`` is not ``mm``.
    """
    factors = _factors(text)
    word = "".join(factors)
    if len(factors) > 1 and word in _FACTOR_ENDS and not _FACTOR_ENDS[word].issuperset(accumulate(map(len, factors))):
        return "·".join(factors)
    return word


def _units() -> tuple[dict[str, Unit], dict[str, set[int]]]:
    """The units of `units.toml` by their words, and where in each word a factor may end."""
    units: dict[str, Unit] = {}
    ends: dict[str, set[int]] = {}
    for dimension, table in _TABLES["units"].items():
        for symbol, entry in table.items():
            words = entry.pop("words", "").split()
            unit = Unit(symbol, Dimension[dimension.upper()], **entry)
            for text in (symbol, *words):
                factors = unicodedata.normalize("NFKC", text).casefold().split("·")  # What `_factors` finds, too.
                word = "".join(factors)
                units[word] = unit
                ends.setdefault(word, set()).update(accumulate(map(len, factors)))
    return units, ends


UNITS, _FACTOR_ENDS = _units()
"""The units by their words, as `unit_word` has these; and where in a word a factor may end."""
_MEANT_THERE = {
    ("nm", Dimension.LENGTH): Unit("nm", Dimension.LENGTH, -9),
    **{(word, Dimension.FORCE): UNITS[unit] for unit, words in _TABLES["force"].items() for word in words.split()},
}
"""Words that are another unit where a quantity of some dimension stands."""
_USUAL = {Dimension[name.upper()]: units for name, units in _TABLES["usual"].items()}
_OTHER_UNITS = {word: advice for advice, words in _TABLES["advice"].items() for word in words.split()}
"""What to do about units that people write and that are none here, by their words as `unit_word` has these."""
_MEGA = r"M\s*N"


class QuantityError(ValueError):
    """A text is no quantity of the kind asked for.

    Attributes:
        message: what is wrong, with the text found.
        accepted: what is accepted in its place.
        suggestion: what was probably meant.
    """

    def __init__(self, message: str, accepted: str, suggestion: str | None = None) -> None:
        self.message, self.accepted, self.suggestion = message, accepted, suggestion
        super().__init__(message, accepted, suggestion)

    def __str__(self) -> str:
        return f"{self.message}; accepted: {self.accepted}"


def accepted_forms(dimension: Dimension) -> str:
    """What is accepted for a quantity of a dimension, in words."""
    if dimension is Dimension.NUMBER:
        return "a number such as 0.5, or an expression such as 0.1 + 0.02"
    example = "pi/2" if dimension is Dimension.ANGLE else "0.1 + 0.02"
    return f"a number such as 0.5 or an expression such as {example}, bare or with a unit ({_USUAL[dimension]})"


def accepted_units(dimension: Dimension) -> str:
    """All units of a dimension, in words."""
    symbols = (unit.symbol for unit in UNITS.values() if dimension.holds(unit.dimension))
    return ", ".join(dict.fromkeys(symbols)) or "no unit"


def find_unit(text: str, dimension: Dimension) -> Unit:
    """The unit that a word stands for.

    Args:
        text: the word, such as ``mm``, ``°`` or ``kg m^2``.
        dimension: what it has to measure.

    Raises:
        QuantityError: it is no unit, one of something else, or one of two that differ in case only.
    """
    unit = unit_where(text, dimension)
    if unit is None:
        raise unknown_unit(text, dimension)
    if not dimension.holds(unit.dimension):
        message = f"{shown(text)} is a unit of {unit.dimension.plain}, and one of {dimension.plain} is needed"
        raise QuantityError(message, accepted_units(dimension))
    return unit


def unit_where(text: str, dimension: Dimension) -> Unit | None:
    """The unit of any dimension that a word stands for where some dimension is wanted; None where it is no unit.

    ``nm`` is a nanometre where a length is wanted, ``lb`` a pound-force where a force is.

    Raises:
        QuantityError: it is one of two units that differ in case only.
    """
    word = unit_word(text)
    unit = UNITS.get(word)
    if unit and word.startswith("mn") and re.match(_MEGA, text.strip()):
        milli = unit.symbol
        message = f"{shown(text)} may be M{milli[1:]} or {milli}, a thousandth"
        raise QuantityError(message, accepted_units(dimension), f"write {milli}, or the numbers in k{milli[1:]}")
    there = _MEANT_THERE.get((word, dimension))
    if there and word == "nm" and text.strip() != "nm":
        return unit  # N m and Nm are no lengths
    return there or unit


def unknown_unit(text: str, dimension: Dimension) -> QuantityError:
    """What is wrong with a word that is no unit."""
    word = unit_word(text)
    fitting = [name for name, unit in UNITS.items() if dimension.holds(unit.dimension)]
    advice = _OTHER_UNITS.get(word) or did_you_mean(word, fitting)
    message = f"{shown(text)} is no unit of {dimension.plain} that is known"
    return QuantityError(message, accepted_units(dimension), advice)


def is_unit(text: str, *, others: bool = False) -> bool:
    """Whether a word is a unit of any dimension, or, with others, one that people write and that is none here."""
    return (word := unit_word(text)) in UNITS or (others and word in _OTHER_UNITS)
