"""Numbers as people write them in tables: ``pi/2``, ``90°``, ``-425 mm``, ``q2 + pi/2``.

A grammar of its own, never `eval`; names other than those below, powers, attributes and calls of anything else are
refused::

    sum      = product (("+" | "-") product)*
    product  = factor (("*" | "/") factor)* [unit]
    factor   = ["+" | "-"] (number | constant | variable | function "(" sum ("," sum)* ")" | "(" sum ")")

A unit belongs to the product that it ends: ``pi/2 rad`` is (π/2) rad, since nothing is measured in 1/rad. A product
or quotient never mixes two units, and a sum has one unit throughout or none. What cannot be bounded otherwise is
bounded by `MAX_CHARACTERS` and `MAX_NESTING`.

A unit that is a power of ten is applied to the decimal text, so that 109.15 mm is the double 0.10915 and not its
neighbour; degrees are whole quarter turns first, so that 90° is the double π/2.
"""

from __future__ import annotations

import math
import re
import unicodedata
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, NamedTuple, NoReturn

from dh2urdf.rotations import HALF_PI, cos_sin
from dh2urdf.source import did_you_mean, shown

if TYPE_CHECKING:
    from collections.abc import Callable

MAX_CHARACTERS = 1000
"""Length of a number or an expression [1]: more digits than a double can use, and no work for an attacker."""
MAX_NESTING = 30
"""Brackets inside each other in an expression [1]."""


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


_UNITS = _units()
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


class Variable(NamedTuple):
    """The joint variable as an expression names it.

    Attributes:
        kind: ``q``, ``theta`` or ``d``.
        row: the row that it names, counted from 1; None for ``q``, ``q_i`` and the like.
        text: how it is written.
    """

    kind: str
    row: int | None
    text: str


@dataclass(frozen=True, slots=True)
class Quantity:
    """What an expression says.

    Attributes:
        value: the number, or what is added to the joint variable [SI].
        has_unit: whether it names its unit itself.
        variable: the joint variable in it.
        sign: 1 or -1, the factor of the joint variable.
    """

    value: float
    has_unit: bool = False
    variable: Variable | None = None
    sign: int = 1


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
    word = _unit_word(text)
    unit = _UNITS.get(word)
    if unit is None:
        near = did_you_mean(word, [word for word, unit in _UNITS.items() if unit.dimension is dimension])
        raise QuantityError(f"{shown(text)} is no unit of {dimension.plain} that is known", _SYMBOLS[dimension], near)
    if unit.dimension is not dimension:
        message = f"{shown(text)} is a unit of {unit.dimension.plain}, and one of {dimension.plain} is needed"
        raise QuantityError(message, _SYMBOLS[dimension])
    return unit


def is_unit(text: str) -> bool:
    """Whether a word is a unit of any dimension."""
    return _unit_word(text) in _UNITS


def _unit_word(text: str) -> str:
    word = unicodedata.normalize("NFKC", re.sub("[º˚]", "°", text)).casefold()
    return re.sub(r"[\s·⋅*^.]", "", word).replace("μ", "µ").replace("sec", "s")


_DECIMAL = re.compile(r"\s*([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+))(?:[eE]([+-]?[0-9]{1,18}))?\s*")


def evaluate(text: str, dimension: Dimension, unit: Unit | None = None, *, decimal_comma: bool = False) -> Quantity:
    """The quantity that a text says, in SI units.

    Args:
        text: a number or an expression.
        dimension: what it has to measure.
        unit: the unit of a number that names none; the SI unit where it is None.
        decimal_comma: whether a comma may stand for the decimal point.

    Raises:
        QuantityError: it is no such quantity, or not a finite one.
    """
    plain = _DECIMAL.fullmatch(text)
    if plain and len(text) <= MAX_CHARACTERS:
        decimal = Decimal(plain[1], int(plain[2] or 0))
        value = _Value(float(text), decimal)
    else:
        value = _Parser(text, dimension, decimal_comma=decimal_comma).parse()
    return _in_si(text, value, dimension, unit)


class _Value(NamedTuple):
    """An intermediate result.

    Attributes:
        number: the number, in the unit that the text means; in SI units where it has a dimension.
        decimal: the decimal text of a bare number.
        dimension: what it measures, where it names a unit.
        variable: the joint variable in it.
        factor: of the joint variable.
        uses_pi: whether it is a number that was made of π, so that it can only be radians.
    """

    number: float
    decimal: Decimal | None = None
    dimension: Dimension | None = None
    variable: Variable | None = None
    factor: float = 0.0
    uses_pi: bool = False


def _in_si(text: str, value: _Value, dimension: Dimension, unit: Unit | None) -> Quantity:
    accepted = accepted_forms(dimension)
    number = value.number
    if value.dimension is None and unit is not None:
        if value.uses_pi and unit.degrees:
            message = f"{shown(text)} is a multiple of π, and the unit declared for numbers here is degrees"
            clean = text.strip()
            raise QuantityError(message, accepted, f"write the angle in degrees, or name its unit: '{clean} rad'")
        number = unit.si(number, value.decimal)
    elif value.dimension is not None and value.dimension is not dimension:
        raise QuantityError(f"{shown(text)} is {value.dimension}, and {dimension} is needed", accepted)
    if not math.isfinite(number):
        raise QuantityError(f"{shown(text)} is beyond the largest number that can be held", accepted)
    if value.variable and value.factor not in (1.0, -1.0):
        message = f"{shown(text)} takes {value.variable.text} times {value.factor:g}"
        raise QuantityError(message, f"{value.variable.text}, or its negative, and a number added to it")
    return Quantity(number + 0.0, value.dimension is not None, value.variable, -1 if value.factor < 0 else 1)


# --- Tokens -----------------------------------------------------------------------------------------------------------

_TOKEN = re.compile(
    r"""(?P<space>\s+)
      | (?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,18}(?![0-9]))?)
      | (?P<word>\\?[^\W\d]\w*(?:_?\{\w+\})?(?:\.[^\W\d]\w*)*)
      | (?P<degree>[°º˚])
      | (?P<sign>.)""",
    re.VERBOSE | re.DOTALL,
)
_DECIMAL_COMMA = re.compile(r"(?<![0-9.,])([0-9]*),([0-9]+)(?![0-9.,])")
# What typesetting and PDF copies make of the signs. The raised dot is missing: it is a decimal point to some.
_SIGNS = str.maketrans({"−": "-", "–": "-", "‐": "-", "‑": "-", "×": "*", "÷": "/", "⁄": "/", "∕": "/"})
_CONSTANTS = {"pi": math.pi, "π": math.pi, "m_pi": math.pi}
_MODULES = ("np.", "numpy.", "math.")
_VARIABLE = re.compile(r"\\?(q|th|theta|θ|d)_?\{?([0-9]{1,9}|i)?\}?")
_VARIABLE_KINDS = {"th": "theta", "θ": "theta"}

_ADVICE = (
    (re.compile(r"\s*[+-]?(nan|inf|infinity)\s*", re.IGNORECASE), "write a finite number"),
    (re.compile(r"\s*[+-]?[0-9]*,[0-9]+\s*$"), "write a decimal point, and no separators of thousands: 0.425, 1234.5"),
    (re.compile(r"\s*[+-]?[0-9]{1,3}(?:[.,'’ ][0-9]{3})+"), "write the number without separators of thousands: 1234.5"),
    (re.compile(r".*[0-9]_[0-9]"), "write the number without underscores"),
    (re.compile(r".*\b0[xXbBoO]"), "write a decimal number"),
    (re.compile(r".*(\*\*|\^|[²³])"), "powers are not accepted: write the product, or the number"),
    (re.compile(r".*%"), "percentages and remainders are not accepted: write the number"),
    (re.compile(r"\s*[+-]?[0-9.]+[dD][+-]?[0-9]+\s*"), "write the exponent with e: 1e-3"),
    (re.compile(r".*[0-9](pi|π)"), "write the product with its sign: 2*pi"),
    (re.compile(r"\s*(#[A-Z]|=|')"), "write the number itself, without what the spreadsheet puts before it"),
)


class _Token(NamedTuple):
    kind: str
    text: str
    start: int


# --- Functions --------------------------------------------------------------------------------------------------------


def _sine(angle: float) -> float:
    return float(cos_sin(angle)[1])


def _cosine(angle: float) -> float:
    return float(cos_sin(angle)[0])


def _tangent(angle: float) -> float:
    cosine, sine = cos_sin(angle)
    return float(sine / cosine)


def _degrees(number: float) -> float:
    return number / 90 * HALF_PI


class _Function(NamedTuple):
    call: Callable[..., float]
    takes: Dimension | None = None
    gives: Dimension | None = None
    arguments: int = 1


_FUNCTIONS = {
    "sqrt": _Function(math.sqrt),
    "abs": _Function(abs),
    "sin": _Function(_sine, takes=Dimension.ANGLE),
    "cos": _Function(_cosine, takes=Dimension.ANGLE),
    "tan": _Function(_tangent, takes=Dimension.ANGLE),
    "asin": _Function(math.asin, gives=Dimension.ANGLE),
    "acos": _Function(math.acos, gives=Dimension.ANGLE),
    "atan": _Function(math.atan, gives=Dimension.ANGLE),
    "atan2": _Function(math.atan2, gives=Dimension.ANGLE, arguments=2),
    "radians": _Function(_degrees, gives=Dimension.ANGLE),
}
_OTHER_NAMES = {"arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "deg2rad": "radians"}


# --- Parser -----------------------------------------------------------------------------------------------------------


class _Parser:
    """Reads one expression, by recursive descent that `MAX_NESTING` bounds."""

    def __init__(self, text: str, dimension: Dimension, *, decimal_comma: bool) -> None:
        self.text = text
        self.accepted = accepted_forms(dimension)
        if len(text) > MAX_CHARACTERS:
            message = f"{shown(text)} has {len(text)} characters"
            raise QuantityError(message, f"at most {MAX_CHARACTERS} characters")
        plain = text.translate(_SIGNS)
        if decimal_comma:
            plain = _DECIMAL_COMMA.sub(r"\1.\2", plain)
        matches = (match for match in _TOKEN.finditer(plain) if match.lastgroup != "space")
        self.tokens = [_Token(match.lastgroup or "", match.group(), match.start()) for match in matches]
        self.tokens.append(_Token("end", "", len(plain)))
        self.position = 0
        self.depth = 0

    def parse(self) -> _Value:
        if len(self.tokens) == 1:
            raise QuantityError("there is nothing", self.accepted)
        value = self.sum()
        if self.next.kind != "end":
            self.unexpected()
        return value

    @property
    def next(self) -> _Token:
        return self.tokens[self.position]

    def take(self, *signs: str) -> str | None:
        """The next token, where it is one of some signs; it is passed over then."""
        if self.next.kind == "sign" and self.next.text in signs:
            self.position += 1
            return self.tokens[self.position - 1].text
        return None

    def fail(self, reason: str, suggestion: str | None = None) -> NoReturn:
        if suggestion is None:
            suggestion = next((advice for pattern, advice in _ADVICE if pattern.match(self.text)), None)
        raise QuantityError(f"{shown(self.text)} cannot be read: {reason}", self.accepted, suggestion)

    def unexpected(self) -> NoReturn:
        token = self.next
        if token.kind == "end":
            self.fail("something is missing at its end")
        if token.kind in ("number", "word", "degree") and self.position:
            before = self.tokens[self.position - 1].text
            if token.kind == "number" or _OTHER_NAMES.get(token.text, token.text) in (*_CONSTANTS, *_FUNCTIONS):
                self.fail(f"no sign stands between {shown(before)} and {shown(token.text)}")
            if token.kind == "word" and is_unit(token.text):
                self.fail(f"the unit {shown(token.text)} does not belong there")
        if token.kind == "word":
            self.fail(f"{shown(token.text)} is no number, unit, constant or function that is known")
        self.fail(f"{shown(token.text)} does not belong there")

    def sum(self) -> _Value:
        value = self.product()
        while sign := self.take("+", "-"):
            other = self.product()
            value = self.add(value, other if sign == "+" else _negative(other))
        return value

    def add(self, left: _Value, right: _Value) -> _Value:
        if left.variable and right.variable:
            self.fail("it names a joint variable twice")
        dimension = left.dimension or right.dimension
        for value in (left, right):
            only_variable = value.variable is not None and value.number == 0
            if value.dimension is not dimension and not only_variable:
                self.fail("one part of the sum has a unit and another has none, or another one")
        number = self.finite(left.number + right.number)
        variable, factor = left.variable or right.variable, left.factor + right.factor
        return _Value(number, None, dimension, variable, factor, left.uses_pi or right.uses_pi)

    def product(self) -> _Value:
        value = self.unit(self.factor())
        while sign := self.take("*", "/"):
            other = self.factor()
            value = self.unit(self.multiply(value, other) if sign == "*" else self.divide(value, other))
        return value

    def unit(self, value: _Value) -> _Value:
        """The value in SI units, where a unit follows it."""
        token = self.next
        if token.kind == "degree":
            word = "deg"
        elif token.kind == "word" and is_unit(token.text):
            word = token.text
        elif token.kind == "word" and self.tokens[self.position - 1].kind == "number":
            self.unknown_unit()
        else:
            return value
        self.position += 1
        ahead = self.tokens[self.position : self.position + 2]
        if [token.text for token in ahead] == ["/", "s"]:
            self.position += 2
            word += "/s"
        if value.dimension is not None:
            self.fail(f"{shown(token.text)} follows a quantity that has a unit already")
        if value.variable:
            self.fail(f"the variable {shown(value.variable.text)} takes no unit")
        unit = _UNITS[_unit_word(word)]
        if value.uses_pi and unit.degrees:
            self.fail("it is a multiple of π in degrees", "write the angle in degrees without pi, or in rad")
        return _Value(self.finite(unit.si(value.number, value.decimal)), dimension=unit.dimension)

    def unknown_unit(self) -> NoReturn:
        word = self.next.text
        name = word.removeprefix("\\").casefold()
        if name in _CONSTANTS or name in _FUNCTIONS or any(name.startswith(module) for module in _MODULES):
            self.unexpected()
        units = [known for known, unit in _UNITS.items() if unit.dimension in (Dimension.LENGTH, Dimension.ANGLE)]
        self.fail(f"{shown(word)} is no unit that is known", did_you_mean(word, units))

    def multiply(self, left: _Value, right: _Value) -> _Value:
        if left.variable and right.variable:
            self.fail("it multiplies joint variables")
        if left.dimension and right.dimension:
            self.fail("it multiplies two quantities with units")
        if right.variable:
            left, right = right, left
        return self.scaled(left, right, left.number * right.number, left.factor * right.number)

    def divide(self, left: _Value, right: _Value) -> _Value:
        if right.variable:
            self.fail("it divides by a joint variable")
        if right.number == 0:
            self.fail("it divides by zero")
        if right.dimension and right.dimension is not left.dimension:
            self.fail("it divides by a quantity with a unit")
        value = self.scaled(left, right, left.number / right.number, left.factor / right.number)
        return value._replace(dimension=None) if right.dimension else value

    def scaled(self, left: _Value, right: _Value, number: float, factor: float) -> _Value:
        uses_pi = left.uses_pi or right.uses_pi
        dimension = left.dimension or right.dimension
        return _Value(self.finite(number), None, dimension, left.variable, self.finite(factor), uses_pi)

    def factor(self) -> _Value:
        sign = self.take("+", "-")
        if sign and self.next.text in ("+", "-"):
            self.fail("two signs follow each other")
        value = self.primary()
        return _negative(value) if sign == "-" else value

    def primary(self) -> _Value:
        token = self.next
        if token.kind == "number":
            self.position += 1
            digits, _, exponent = token.text.lower().partition("e")
            return _Value(self.finite(float(token.text)), Decimal(digits, int(exponent or 0)))
        if token.kind == "word":
            self.position += 1
            return self.named(token)
        if self.take("("):
            value = self.inside(self.sum)
            return value._replace(decimal=None)
        self.unexpected()

    def inside(self, read: Callable[[], _Value]) -> _Value:
        """What stands in a bracket that was just opened."""
        self.depth += 1
        if self.depth > MAX_NESTING:
            self.fail(f"its brackets are nested more than {MAX_NESTING} deep")
        value = read()
        if not self.take(")"):
            if self.next.kind == "end":
                self.fail("a bracket is not closed")
            self.unexpected()
        self.depth -= 1
        return value

    def named(self, token: _Token) -> _Value:
        name = unicodedata.normalize("NFKC", token.text).casefold().removeprefix("\\")
        name = next((name.removeprefix(module) for module in _MODULES if name.startswith(module)), name)
        name = _OTHER_NAMES.get(name, name)
        if name in _CONSTANTS:
            if self.next.text == "(" and self.tokens[self.position + 1].text == ")":  # PI() of spreadsheets
                self.position += 2
            return _Value(_CONSTANTS[name], uses_pi=True)
        if name in _FUNCTIONS and self.take("("):
            return self.inside(lambda: self.call(token.text, _FUNCTIONS[name]))
        if match := _VARIABLE.fullmatch(name):
            self.skip_variable_star(token)
            row = int(match[2]) if match[2] and match[2] != "i" else None
            return _Value(0.0, variable=Variable(_VARIABLE_KINDS.get(match[1], match[1]), row, token.text), factor=1.0)
        if self.next.text == "(" and name not in _UNITS:
            names = ", ".join(_FUNCTIONS)
            self.fail(f"{shown(token.text)} is no function that is known", f"the functions are {names}")
        self.position -= 1
        self.unexpected()

    def skip_variable_star(self, token: _Token) -> None:
        """Passes over the star that marks a variable in textbooks (Spong): ``theta2*``, ``theta2* + pi/2``."""
        star, after = self.next, self.tokens[min(self.position + 1, len(self.tokens) - 1)]
        attached = star.text == "*" and star.start == token.start + len(token.text)
        if attached and (after.kind == "end" or after.text in ("+", "-", ")")):
            self.position += 1

    def call(self, written: str, function: _Function) -> _Value:
        arguments = [self.sum()]
        while self.take(","):
            arguments.append(self.sum())
        if len(arguments) != function.arguments:
            wanted = "one argument" if function.arguments == 1 else "two arguments, with a comma between them"
            self.fail(f"{written} takes {wanted}")
        if any(argument.variable for argument in arguments):
            self.fail(f"{written} is taken of a joint variable")
        dimensions = {argument.dimension for argument in arguments}
        ratio = function.arguments > 1 and len(dimensions) == 1  # atan2 of two lengths
        if not ratio and not (function.call is abs) and dimensions - {None, function.takes}:
            self.fail(f"{written} is taken of a quantity with a unit")
        try:
            number = function.call(*(argument.number for argument in arguments))
        except (ValueError, ZeroDivisionError, OverflowError):
            self.fail(f"{written} has no value there")
        if function.call is abs:
            return arguments[0]._replace(number=number, decimal=None)
        return _Value(self.finite(number), dimension=function.gives)

    def finite(self, number: float) -> float:
        if not math.isfinite(number):
            self.fail("it is beyond the largest number that can be held")
        return number


def _negative(value: _Value) -> _Value:
    decimal = value.decimal
    if decimal is not None:
        digits = decimal.digits[1:] if decimal.digits.startswith("-") else f"-{decimal.digits}"
        decimal = Decimal(digits, decimal.exponent)
    return value._replace(number=-value.number, decimal=decimal, factor=-value.factor)
