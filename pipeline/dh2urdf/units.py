"""Units of measure, and what their words mean."""

from __future__ import annotations

import re
import unicodedata
from dataclasses import dataclass
from enum import StrEnum
from typing import NamedTuple

from dh2urdf.rotations import HALF_PI
from dh2urdf.source import did_you_mean, shown


class Dimension(StrEnum):
    """What a quantity measures."""

    NUMBER = "a bare number"
    LENGTH = "a length"
    ANGLE = "an angle"
    SPEED = "a speed"
    TURN_RATE = "an angular speed"
    MASS = "a mass"
    EFFORT = "a force or torque"
    DAMPING = "a coefficient of friction"
    INERTIA = "a moment of inertia"

    @property
    def plain(self) -> str:
        """The words without their article."""
        return self.split(" ", 1)[1]


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit of measure.

    Attributes:
        symbol: how messages write it.
        dimension: what it measures.
        power: the power of ten that it is of the SI unit [1].
        degrees: whether it counts degrees in place of radians.
    """

    symbol: str
    dimension: Dimension
    power: int = 0
    degrees: bool = False

    def si(self, number: float, decimal: Decimal | None = None) -> float:
        """A number of this unit in SI units [m, rad, kg, s].

        Args:
            number: how many.
            decimal: the text that the number was read from, where it is a bare decimal number.
        """
        if self.degrees:
            return number / 90 * HALF_PI  # a multiple of 90 is a whole number of quarter turns, to the last bit
        if self.power == 0:
            return number
        if decimal is not None:
            return float(f"{decimal.digits}e{decimal.exponent + self.power}")
        return number * 10.0**self.power if self.power > 0 else number / 10.0**-self.power


class Decimal(NamedTuple):
    """A decimal number as text: digits with sign and point, and a power of ten."""

    digits: str
    exponent: int


def _units() -> dict[str, Unit]:
    units: dict[str, Unit] = {}

    def define(unit: Unit, *words: str) -> None:
        units.update(dict.fromkeys((unit.symbol.casefold(), *words), unit))

    for symbol, power, word in (("m", 0, ""), ("cm", -2, "centi"), ("mm", -3, "milli"), ("µm", -6, "micro")):
        names = (f"{word}{stem}" for stem in ("meter", "meters", "metre", "metres"))
        define(Unit(symbol, Dimension.LENGTH, power), *names, *(("um",) if symbol == "µm" else ()))
        define(Unit(f"{symbol}/s", Dimension.SPEED, power), *(("um/s",) if symbol == "µm" else ()))
    for symbol, degrees, words in (("rad", False, ("radian", "radians")), ("deg", True, ("degree", "degrees", "°"))):
        define(Unit(symbol, Dimension.ANGLE, degrees=degrees), *words)
        define(Unit(f"{symbol}/s", Dimension.TURN_RATE, degrees=degrees), *(f"{word}/s" for word in words))
    define(Unit("kg", Dimension.MASS))
    define(Unit("N", Dimension.EFFORT))
    define(Unit("Nm", Dimension.EFFORT))
    define(Unit("N·m·s/rad", Dimension.DAMPING), "nms/rad", "nms")
    define(Unit("N·s/m", Dimension.DAMPING), "ns/m")
    define(Unit("kg·m²", Dimension.INERTIA), "kgm2")
    return units


UNITS = _units()
"""The units by their words, as `unit_word` has these."""
_SYMBOLS = {
    Dimension.NUMBER: "no unit",
    Dimension.LENGTH: "m, cm, mm, µm",
    Dimension.ANGLE: "rad, deg, °",
    Dimension.SPEED: "m/s, cm/s, mm/s, µm/s",
    Dimension.TURN_RATE: "rad/s, deg/s, °/s",
    Dimension.MASS: "kg",
    Dimension.EFFORT: "N, Nm",
    Dimension.DAMPING: "N·m·s/rad, N·s/m",
    Dimension.INERTIA: "kg·m²",
}


_CONVERT = "convert the numbers: 1 inch is 25.4 mm, 1 foot is 304.8 mm, 1 gon is 0.9 deg"
_DEGREES = "write deg for degrees; gradians have to be converted: 1 gon is 0.9 deg"
_MULTIPLES = "write rad, and the multiples of π in the cells: 0.5*pi"
_OTHER_UNITS = {
    **dict.fromkeys(
        ("in", "inch", "inches", '"', "″", "ft", "foot", "feet", "gon", "gons", "gradian", "gradians"), _CONVERT
    ),
    **dict.fromkeys(("grad", "grads", "grado", "grados", "gradi", "degré", "degrés", "grau", "graus"), _DEGREES),
    **dict.fromkeys(("pi", "π", "pirad", "πrad", "radpi", "radπ", "rad/pi", "rad/π", "×π"), _MULTIPLES),
}
"""What to do about units that people write and that are none here, by their words as `unit_word` has these."""


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
    return f"a number such as 0.5 or an expression such as {example}, bare or with a unit ({_SYMBOLS[dimension]})"


def find_unit(text: str, dimension: Dimension) -> Unit:
    """The unit that a word stands for.

    Args:
        text: the word, such as ``mm``, ``°`` or ``kg m^2``.
        dimension: what it has to measure.

    Raises:
        QuantityError: it is no unit, or one of something else.
    """
    word = unit_word(text)
    unit = UNITS.get(word)
    if unit is None:
        near = _OTHER_UNITS.get(word) or did_you_mean(
            word, [word for word, unit in UNITS.items() if unit.dimension is dimension]
        )
        raise QuantityError(f"{shown(text)} is no unit of {dimension.plain} that is known", _SYMBOLS[dimension], near)
    if unit.dimension is not dimension:
        message = f"{shown(text)} is a unit of {unit.dimension.plain}, and one of {dimension.plain} is needed"
        raise QuantityError(message, _SYMBOLS[dimension])
    return unit


def is_unit(text: str) -> bool:
    """Whether a word is a unit of any dimension."""
    return unit_word(text) in UNITS


def unit_word(text: str) -> str:
    """The word of a unit without case, spaces and signs of multiplication: ``kg m^2`` is ``kgm2``."""
    word = unicodedata.normalize("NFKC", re.sub("[º˚]", "°", text)).casefold()
    return re.sub(r"[\s·⋅*^.]", "", word).replace("sec", "s")
