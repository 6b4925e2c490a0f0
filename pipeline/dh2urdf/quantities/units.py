"""Units of measure, and what their words mean.

Every factor is an exact fraction, so that a number of any unit is the double nearest to its value in SI units. Angles
are the exception that no fraction can have: they are quarter turns first, so that 90° is the double π/2.
"""

from __future__ import annotations

import math
import re
import unicodedata
from enum import StrEnum
from functools import lru_cache
from itertools import accumulate

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.patterns import late_pattern
from dh2urdf.quantities.exact_numbers import ONE, Decimal, Ratio
from dh2urdf.quantities.spellings import composed, in_latin_letters
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


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of measure.

    A number of it is number · factor · 10^power of the SI unit. Where it counts parts of a turn, a number of it is
    number / parts quarter turns.

    Attributes:
        symbol: how messages write it.
        dimension: what it measures.
        power: the power of ten that it is of the SI unit.
        factor: what else it is of the SI unit.
        parts: how many of it a quarter turn has, or a quarter turn per second; None for what is no part of a turn.
    """

    symbol: str
    dimension: Dimension
    power: int = 0
    factor: Ratio = ONE
    parts: float | None = None

    @property
    def degrees(self) -> bool:
        """Whether it counts degrees in place of radians."""
        return self.parts == _DEGREES

    @property
    def is_shifted(self) -> bool:
        """Whether a decimal point in another place makes its numbers those of the SI unit."""
        return self.factor == ONE and self.parts is None

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
        if self.factor == ONE:
            return self._shifted(number, decimal)
        if number == 0 or not math.isfinite(number):
            return number
        from fractions import Fraction

        exact = Fraction(number) if decimal is None else Fraction(decimal.digits) * Fraction(10) ** decimal.exponent
        try:
            return float(exact * Fraction(self.factor.over, self.factor.under) * Fraction(10) ** self.power)
        except OverflowError:
            return math.copysign(math.inf, number)

    def _shifted(self, number: float, decimal: Decimal | None) -> float:
        """A number times the power of ten."""
        if self.power == 0:
            return number
        if decimal is not None:
            return float(f"{decimal.digits}e{decimal.exponent + self.power}")
        return number * 10.0**self.power if self.power > 0 else number / 10.0**-self.power


# --- Words ------------------------------------------------------------------------------------------------------------

_DEGREES = 90.0
_POWERS = {"k": 3, "": 0, "c": -2, "m": -3, "µ": -6}
_SECONDS = {"s": 1, "min": 60}
_INCH = Ratio(254, 10_000)
_POUND = Ratio(45_359_237, 100_000_000)
_GRAVITY = Ratio(980_665, 100_000)
"""Standard gravity, which makes a force of a mass, by the General Conference on Weights and Measures, 1901 [m/s²]."""
_INCHES = {"in": 1, "ft": 12}
_OUNCE = _POUND / 16
_SLUG = _POUND * _GRAVITY / (_INCH * 12)


class _Words:
    """The units by their words, while they are being defined."""

    def __init__(self) -> None:
        self.units: dict[str, Unit] = {}
        self.ends: dict[str, set[int]] = {}

    def define(self, unit: Unit, *words: str) -> None:
        for text in (unit.symbol, *words):
            factors = unicodedata.normalize("NFKC", text).casefold().split("·")  # What `_factors` finds, too.
            word = "".join(factors)
            self.units[word] = unit
            self.ends.setdefault(word, set()).update(accumulate(map(len, factors)))

    def lengths(self) -> None:
        """Lengths, and those that machines move by per second and per minute."""
        for prefix, spoken in {"": "", "c": "centi", "m": "milli", "µ": "micro"}.items():
            stems = ("meter", "meters", "metre", "metres")
            unit = Unit(f"{prefix}m", Dimension.LENGTH, _POWERS[prefix])
            self.define(unit, *(f"{spoken}{stem}" for stem in stems), *(("um",) if prefix == "µ" else ()))
            self.speeds(unit, "um" if prefix == "µ" else unit.symbol)
        for symbol, words in {"in": ("inch", "inches"), "ft": ("foot", "feet")}.items():
            unit = Unit(symbol, Dimension.LENGTH, factor=_INCH * _INCHES[symbol])
            self.define(unit, *words)
            self.speeds(unit, symbol)
        self.define(Unit("mil", Dimension.LENGTH, factor=_INCH / 1000), "mils", "thou")

    def speeds(self, length: Unit, word: str) -> None:
        """A length per second and per minute."""
        for time, seconds in _SECONDS.items():
            speed = Unit(f"{length.symbol}/{time}", Dimension.SPEED, length.power, length.factor / seconds)
            self.define(speed, f"{word}/{time}")

    def angles(self) -> None:
        """Angles, and each of them per second and per minute."""
        turns = ("turn", "turns", "revolution", "revolutions")
        for symbol, parts, words in (
            ("rad", None, ("radian", "radians")),
            ("deg", _DEGREES, ("degree", "degrees", "°")),
            ("rev", 0.25, turns),
        ):
            self.define(Unit(symbol, Dimension.ANGLE, parts=parts), *words)
            for time, seconds in _SECONDS.items():
                factor = ONE if parts else Ratio(1, seconds)
                rate = Unit(f"{symbol}/{time}", Dimension.TURN_RATE, factor=factor, parts=parts and parts * seconds)
                rates = {"rev/s": ("rps", "U/s"), "rev/min": ("rpm", "1/min", "U/min", "r/min")}
                self.define(rate, *(f"{word}/{time}" for word in words), *rates.get(rate.symbol, ()))

    def masses(self) -> None:
        """Masses, moments of inertia and densities."""
        metric = (("m", 0), ("cm", -2), ("mm", -3))
        for unit, words, lengths in (
            (Unit("kg", Dimension.MASS), ("kilogram", "kilograms"), metric),
            (Unit("g", Dimension.MASS, -3), ("gram", "grams"), metric),
            (Unit("t", Dimension.MASS, 3), ("tonne", "tonnes"), metric[2:]),
        ):
            self.define(unit, *words)
            for length, power in lengths:
                self.define(Unit(f"{unit.symbol}·{length}²", Dimension.INERTIA, unit.power + 2 * power))
        for unit, names, inches in (
            (Unit("lb", Dimension.MASS, factor=_POUND), ("lbs", "lbm", "pound", "pounds"), ("in", "ft")),
            (Unit("oz", Dimension.MASS, factor=_OUNCE), ("ounce", "ounces"), ("in",)),
            (Unit("slug", Dimension.MASS, factor=_SLUG), ("slugs",), ("ft",)),
        ):
            self.define(unit, *names)
            for length in inches:
                factor = unit.factor * _INCH * _INCH * _INCHES[length] ** 2
                self.define(Unit(f"{unit.symbol}·{length}²", Dimension.INERTIA, factor=factor))
        for symbol, power in (("kg/m³", 0), ("g/cm³", 3), ("kg/dm³", 3), ("g/mm³", 6)):
            self.define(Unit(symbol, Dimension.DENSITY, power))
        self.define(Unit("lb/in³", Dimension.DENSITY, factor=_POUND / _INCH / _INCH / _INCH))

    def efforts(self) -> None:
        """Forces, torques, and what damps with them."""
        force, torque = Dimension.FORCE, Dimension.TORQUE
        for prefix in ("", "k", "m"):
            self.define(Unit(f"{prefix}N", force, _POWERS[prefix]), *(("newton", "newtons") if not prefix else ()))
            self.define(Unit(f"{prefix}Nm", torque, _POWERS[prefix]), f"{prefix}N·m")
        self.define(Unit("N·cm", torque, -2))
        self.define(Unit("N·mm", torque, -3))
        self.define(Unit("kgf", force, factor=_GRAVITY), "kp", "kg·f")
        self.define(Unit("kgf·m", torque, factor=_GRAVITY))
        self.define(Unit("kgf·cm", torque, factor=_GRAVITY / 100), "kg·cm")
        self.define(Unit("lbf", force, factor=_POUND * _GRAVITY), "lb·f")
        self.define(Unit("ozf", force, factor=_OUNCE * _GRAVITY), "oz·f")
        for symbol, mass, length in (("lbf·in", _POUND, "in"), ("lbf·ft", _POUND, "ft"), ("ozf·in", _OUNCE, "in")):
            short = symbol.replace("f", "", 1)
            words = (short, *("·".join(reversed(word.split("·"))) for word in (symbol, short)))
            self.define(Unit(symbol, torque, factor=mass * _GRAVITY * _INCH * _INCHES[length]), *words)
        self.define(Unit("N·m·s/rad", Dimension.DAMPING), "N·m·s")
        self.define(Unit("N·mm·s/rad", Dimension.DAMPING, -3))
        self.define(Unit("N·s/m", Dimension.LINEAR_DAMPING))
        self.define(Unit("N·s/mm", Dimension.LINEAR_DAMPING, 3))


LONGEST_UNIT = 100
"""Characters of a text that may be a unit."""


def _factors(text: str) -> list[str]:
    """The factors of a unit as they are written, without case: ``kg m^2`` is kg and m2, ``kgm²`` is one word."""
    if len(text) > LONGEST_UNIT:
        return [text]
    if text.isascii() and text.replace("_", "").isalnum() and "sec" not in (word := text.lower()) and "min" not in word:
        return [word]
    word = in_latin_letters(composed(text).casefold().strip())
    word = re.sub(r"sec(?:onds?)?", "s", re.sub(r"\s*\bper\s+", "/", word)).replace("minute", "min")
    if word.isalpha():
        return [word]
    if word.endswith("1"):
        word = re.sub(r"(s|min)\s*\^?\s*[-\N{MINUS SIGN}]1$", r"/\1", word)
    word = _NO_FACTOR.sub("", f"1{word}" if word.startswith("/") else word)
    return [factor for factor in _TIMES.split(word) if factor]


_TIMES = late_pattern(r"(?<=\w)-(?=\w)|[\s·⋅∙•*^.]+")
_NO_FACTOR = late_pattern(r"[\s·⋅∙•*^.]+(?=[\d/])|(?<=/)\s+")
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
    words = _Words()
    for define in (words.lengths, words.angles, words.masses, words.efforts):
        define()
    return words.units, words.ends


UNITS, _FACTOR_ENDS = _units()
"""The units by their words, as `unit_word` has these; and where in a word a factor may end."""
_MEANT_THERE = {
    ("nm", Dimension.LENGTH): Unit("nm", Dimension.LENGTH, -9),
    **{(word, Dimension.FORCE): UNITS["lbf"] for word in ("lb", "lbs", "pound", "pounds")},
    **{(word, Dimension.FORCE): UNITS["ozf"] for word in ("oz", "ounce", "ounces")},
}
"""Words that are another unit where a quantity of some dimension stands."""
_USUAL = {
    Dimension.NUMBER: "no unit",
    Dimension.LENGTH: "m, cm, mm, µm",
    Dimension.ANGLE: "rad, deg, °",
    Dimension.SPEED: "m/s, cm/s, mm/s, m/min, in/s",
    Dimension.TURN_RATE: "rad/s, deg/s, °/s, rpm, rev/s",
    Dimension.MASS: "kg, g, t, lb, oz",
    Dimension.EFFORT: "N, kN, lbf, Nm, kNm, N·mm, lbf·in",
    Dimension.FORCE: "N, kN, kgf, lbf",
    Dimension.TORQUE: "Nm, kNm, N·cm, N·mm, kgf·cm, lbf·in, lbf·ft",
    Dimension.DAMPING: "N·m·s/rad, N·mm·s/rad",
    Dimension.LINEAR_DAMPING: "N·s/m, N·s/mm",
    Dimension.INERTIA: "kg·m², kg·cm², kg·mm², g·cm², g·mm², lb·in²",
    Dimension.DENSITY: "kg/m³, g/cm³",
}

_DEGREES_OR_GON = "write deg for degrees; gradians have to be converted: 1 gon is 0.9 deg"
_MULTIPLES = "write rad, and the multiples of π in the cells: 0.5*pi"
_PRIMES = "write in, ft or deg"
_OTHER_UNITS = {
    **dict.fromkeys(("gon", "gons", "gradian", "gradians"), "convert the numbers: 1 gon is 0.9 deg"),
    **dict.fromkeys("grad grads grado grados gradi degré degrés grau graus град".split(), _DEGREES_OR_GON),  # noqa: SIM905
    **dict.fromkeys(("pi", "π", "pirad", "πrad", "radpi", "radπ", "rad/pi", "rad/π", "×π"), _MULTIPLES),
    **dict.fromkeys(('"', "'", "''", "″", "′", "′′", "“", "”", "’"), _PRIMES),
    **dict.fromkeys(("hz", "1/s"), "write rev/s, rad/s or deg/s, whichever it is"),
    **dict.fromkeys(("ton", "tons"), "write t for 1000 kg, or the numbers in kg"),
}
"""What to do about units that people write and that are none here, by their words as `unit_word` has these."""
_MEGA = late_pattern(r"M\s*N")


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

    Args:
        text: the word. ``nm`` is a nanometre where a length is wanted, ``lb`` a pound-force where a force is.
        dimension: what is wanted.

    Raises:
        QuantityError: it is one of two units that differ in case only.
    """
    word = unit_word(text)
    unit = UNITS.get(word)
    if unit and word.startswith("mn") and _MEGA.match(text.strip()):
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
    advice = _OTHER_UNITS.get(word) or did_you_mean(
        word, [word for word, unit in UNITS.items() if dimension.holds(unit.dimension)]
    )
    if re.fullmatch(r".*/s(2|/s)", word):
        advice = "a table has no field for accelerations: leave the column out"
    return QuantityError(
        f"{shown(text)} is no unit of {dimension.plain} that is known", accepted_units(dimension), advice
    )


def is_unit(text: str, *, others: bool = False) -> bool:
    """Whether a word is a unit of any dimension, or, with others, one that people write and that is none here."""
    return (word := unit_word(text)) in UNITS or (others and word in _OTHER_UNITS)
