"""Exact quantities, and the many ways in which tables write them."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from fractions import Fraction
from typing import TYPE_CHECKING

from known_words import unit_words

if TYPE_CHECKING:
    import random

LENGTH, ANGLE, SPEED, RATE, NUMBER = "a length", "an angle", "a speed", "an angular speed", ""
MASS, INERTIA, TORQUE, FORCE = "a mass", "a moment of inertia", "a torque", "a force"
TURNING, SLIDING, DENSITY = "a rotational damping", "a linear damping", "a density"


def _scales() -> dict[str, dict[str, Fraction]]:
    """Units by what they measure, in SI units; of those that count degrees, in degrees.

    The pound, the inch and standard gravity are exact by definition (NIST SP 811, appendix B).
    """
    inch, pound, gravity = Fraction("0.0254"), Fraction("0.45359237"), Fraction("9.80665")
    lengths = {"m": Fraction(1), "cm": Fraction(1, 100), "mm": Fraction(1, 1000), "µm": Fraction(1, 10**6)}
    lengths |= {"in": inch, "ft": 12 * inch, "mil": inch / 1000}
    angles = {"rad": Fraction(1), "deg": Fraction(1), "rev": Fraction(360)}
    of_time = {"s": Fraction(1), "min": Fraction(60)}
    slug = pound * gravity / lengths["ft"]
    masses = {"kg": Fraction(1), "g": Fraction(1, 1000), "t": Fraction(1000)}
    masses |= {"lb": pound, "oz": pound / 16, "slug": slug}
    pairs = [(mass, side) for mass in ("kg", "g") for side in ("m", "cm", "mm")]
    pairs += [("t", "mm"), ("lb", "in"), ("lb", "ft"), ("oz", "in"), ("slug", "ft")]
    forces = {"N": Fraction(1), "kN": Fraction(1000), "mN": Fraction(1, 1000), "kgf": gravity}
    forces |= {"lbf": pound * gravity, "ozf": pound * gravity / 16}
    torques = {"Nm": Fraction(1), "kNm": Fraction(1000), "mNm": Fraction(1, 1000)}
    arms = [("N", "cm"), ("N", "mm"), ("kgf", "m"), ("kgf", "cm"), ("lbf", "in"), ("lbf", "ft"), ("ozf", "in")]
    return {
        LENGTH: lengths,
        ANGLE: angles,
        SPEED: {
            f"{name}/{time}": lengths[name] / of_time[time] for time in of_time for name in lengths if name != "mil"
        },
        RATE: {f"{name}/{time}": size / of_time[time] for time in of_time for name, size in angles.items()},
        MASS: masses,
        INERTIA: {f"{mass}·{side}²": masses[mass] * lengths[side] ** 2 for mass, side in pairs},
        TORQUE: torques | {f"{force}·{side}": forces[force] * lengths[side] for force, side in arms},
        FORCE: forces,
        TURNING: {"N·m·s/rad": Fraction(1), "N·mm·s/rad": Fraction(1, 1000)},
        SLIDING: {"N·s/m": Fraction(1), "N·s/mm": Fraction(1000)},
        DENSITY: {"kg/m³": Fraction(1), "g/cm³": Fraction(1000), "kg/dm³": Fraction(1000), "lb/in³": pound / inch**3},
    }


SCALES = _scales()
SI = {dimension: next(iter(units)) for dimension, units in SCALES.items()}
"""The SI unit of each kind."""


def counts_degrees(unit: str) -> bool:
    """Whether a unit is so many degrees, or so many of them in some time."""
    return unit.partition("/")[0] in ("deg", "rev")


@dataclass(frozen=True)
class Exact:
    """A quantity without rounding.

    Attributes:
        number: how many SI units; of an angle in degrees, how many degrees.
        dimension: what it measures.
        degrees: whether the number counts degrees.
    """

    number: Fraction
    dimension: str
    degrees: bool = False

    @property
    def si(self) -> float:
        """The SI number."""
        return math.pi * float(self.number / 180) if self.degrees else float(self.number)


@dataclass(frozen=True)
class Text:
    """A cell.

    Attributes:
        bare: what is in a column whose header may have a unit.
        full: the same where nothing outside the cell has one.
    """

    bare: str
    full: str


EMPTY = Text("", "")


def is_decimal(number: Fraction) -> bool:
    """Whether a number has finitely many decimals, and not too many."""
    rest = number.denominator
    for factor in (2, 5):
        while rest % factor == 0:
            rest //= factor
    return rest == 1 and number.denominator < 10**15


def decimal(number: Fraction) -> str:
    """A decimal number, digit by digit; never one whose point may separate thousands."""
    digits, scale = abs(number), 0
    while digits.denominator != 1:
        digits, scale = digits * 10, scale + 1
        if scale > 40:
            raise ValueError(f"{number} is no decimal number")
    text = str(digits.numerator).rjust(scale + 1, "0")
    text = f"{text[:-scale]}.{text[-scale:]}" if scale else text
    if re.fullmatch(r"[1-9][0-9]{0,2}\.[0-9]{3}", text):
        text += "0"
    return f"-{text}" if number < 0 else text


class Speller:
    """Writes quantities in the many ways in which tables have them."""

    def __init__(self, rng: random.Random, *, plain: bool = False) -> None:
        """Takes a source of chance; `plain` numbers are the shortest decimal ones, without units of their own."""
        self.rng = rng
        self.plain = plain

    def text(self, value: Exact, unit: str | None) -> Text:
        """A cell that says a quantity.

        Args:
            value: the quantity.
            unit: the unit of a bare number there; None where nothing says one, and the cell has to.
        """
        explicit = unit is None or (not self.plain and bool(value.dimension) and self.rng.random() < 0.15)
        if unit is None or explicit or (counts_degrees(unit) and not value.degrees):
            unit, explicit = self.unit_for(value), True
        number = self.number(value, unit)
        full = self.with_unit(number, unit, value.dimension) if value.dimension else number
        return Text(full if explicit else number, full)

    def variable(self, symbol: str, sign: int, value: Exact, unit: str | None) -> Text:
        """A cell that says the joint variable, with its sign, and what is added to it."""
        minus = "-" if sign < 0 else ""
        if not value.number:
            return Text(minus + symbol, minus + symbol)
        size = Exact(abs(value.number), value.dimension, value.degrees)
        plus = "-" if value.number < 0 else "+"
        text = Speller(self.rng, plain=True).text(size, unit)
        if plus == "+" and self.rng.random() < 0.4:
            after = f"- {symbol}" if sign < 0 else f"+ {symbol}"
            return Text(f"{text.bare} {after}", f"{text.full} {after}")
        return Text(f"{minus}{symbol} {plus} {text.bare}", f"{minus}{symbol} {plus} {text.full}")

    def unit_for(self, value: Exact) -> str:
        """Some unit in which a quantity can be written."""
        if value.dimension in (ANGLE, RATE):
            degrees = value.degrees and self.rng.random() < 0.8
            return self.rng.choice([unit for unit in SCALES[value.dimension] if counts_degrees(unit) == degrees])
        return self.rng.choice(list(SCALES[value.dimension]))

    def number(self, value: Exact, unit: str) -> str:
        """A number of a unit, as a decimal number or an expression."""
        rng = self.rng
        scale = SCALES.get(value.dimension, {}).get(unit, Fraction(1))
        if value.degrees and not counts_degrees(unit):
            turns = value.number / 180 / scale
            if self.plain or turns == 0 or rng.random() < 0.3:
                return repr(math.pi * float(turns)).removesuffix(".0")
            over = f"/{turns.denominator}" if turns.denominator > 1 else ""
            pi = rng.choice(["pi", "π", "np.pi"])
            return {1: pi, -1: f"-{pi}"}.get(turns.numerator, f"{turns.numerator}*{pi}") + over
        number = value.number / scale
        if not is_decimal(number):  # of an inch, or of a turn
            return self._fraction(number)
        text = decimal(number)
        if self.plain or rng.random() < 0.6:
            return text
        forms = [f"{text}0" if "." in text else f"{text}.0", f"{decimal(number * 1000)}e-3", text.replace("-", "−")]
        forms += [re.sub(r"^(-?)0\.", r"\1.", text), f"2*{decimal(number / 2)}" if number > 0 else text]
        forms += [f"{decimal(number / 4)} + {decimal(number * 3 / 4)}" if number > 0 else f"+{text}".replace("+-", "-")]
        # Never a point, or a comma, that may separate thousands.
        return re.sub(r"(?<![0-9.])([1-9][0-9]{0,2}\.[0-9]{3})(?![0-9])", r"\g<1>0", rng.choice(forms))

    def _fraction(self, number: Fraction) -> str:
        """A number that no decimal one is, as the nearest double or as a fraction of small numbers."""
        if not self.plain and number.denominator < 10**6 and self.rng.random() < 0.5:
            # Two large numbers without spaces may be two lengths, and are refused.
            sign = " / " if min(abs(number.numerator), number.denominator) > 99 else "/"
            return f"{number.numerator}{sign}{number.denominator}"
        text = repr(float(number))
        return f"{text}0" if re.fullmatch(r"-?[1-9][0-9]{0,2}\.[0-9]{3}", text) else text

    def with_unit(self, number: str, unit: str, dimension: str) -> str:
        """A number with its unit behind it."""
        word = self.rng.choice(unit_words(dimension, unit) or (unit,))
        if " + " in number:
            number = f"({number})"
        tight = number[-1].isdigit() and "/" not in number and not word[0].isdigit() and self.rng.random() < 0.3
        return f"{number}{'' if tight else ' '}{word}"
