"""The grammar of expressions: ``pi/2``, ``-425 mm``, ``q2 + 90 deg``.

A grammar of its own, never `eval`; names other than those below, powers, attributes and calls of anything else are
refused::

    sum      = product (("+" | "-") product)*
    product  = factor (("*" | "/") factor)* [unit]
    factor   = ["+" | "-"] (number | constant | variable | function "(" sum ("," sum)* ")" | "(" sum ")")

A unit belongs to the product that it ends: ``pi/2 rad`` is (π/2) rad, since nothing is measured in 1/rad. A product
or quotient never mixes two units, and a sum has one unit throughout or none. What cannot be bounded otherwise is
bounded by `MAX_CHARACTERS` and `MAX_NESTING`.
"""

from __future__ import annotations

import math
import re
import unicodedata
from typing import TYPE_CHECKING, NamedTuple, NoReturn

from dh2urdf.rotations import HALF_PI, cos_sin
from dh2urdf.source import did_you_mean, shown
from dh2urdf.units import UNITS, Decimal, Dimension, QuantityError, accepted_forms, is_unit, unit_word

if TYPE_CHECKING:
    from collections.abc import Callable

MAX_CHARACTERS = 1000
"""Length of a number or an expression [1]: more digits than a double can use, and no work for an attacker."""
MAX_NESTING = 30
"""Brackets inside each other in an expression [1]."""


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


class Value(NamedTuple):
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


def parse(text: str, dimension: Dimension, *, decimal_comma: bool = False) -> Value:
    """The value of an expression.

    Args:
        text: the expression.
        dimension: what it should measure, for the message.
        decimal_comma: whether a comma may stand for the decimal point.

    Raises:
        QuantityError: it is no expression.
    """
    return _Parser(text, dimension, decimal_comma=decimal_comma).parse()


# --- Tokens -----------------------------------------------------------------------------------------------------------

SPACE = r"[^\S\x1c-\x1f]"
"""White space between the parts of a number; Python counts four control characters to it, and `float` does not."""

_TOKEN = re.compile(
    f"(?P<space>{SPACE}+)"
    r"""
      | (?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,18}(?![0-9]))?)
      | (?P<word>\\?[^\W\d]\w*(?:_?\{\w+\})?(?:\.[^\W\d]\w*)*)
      | (?P<degree>[°º˚])
      | (?P<sign>.)""",
    re.VERBOSE | re.DOTALL,
)
# What a spreadsheet makes of 1/2 and 3-4 where it takes them for dates; as an expression it would be a number.
_DATE = re.compile(r"\s*([0-9]{4}([-/])[0-9]{1,2}\2[0-9]{1,2}|[0-9]{1,2}([-/])[0-9]{1,2}\3([0-9]{2}|[0-9]{4}))\s*")
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

    def parse(self) -> Value:
        if len(self.tokens) == 1:
            raise QuantityError("there is nothing", self.accepted)
        if _DATE.fullmatch(self.text):
            self.fail("it is a date", "a spreadsheet makes dates of fractions: format the column as text")
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

    def sum(self) -> Value:
        value = self.product()
        while sign := self.take("+", "-"):
            other = self.product()
            value = self.add(value, other if sign == "+" else _negative(other))
        return value

    def add(self, left: Value, right: Value) -> Value:
        if left.variable and right.variable:
            self.fail("it names a joint variable twice")
        dimension = left.dimension or right.dimension
        for value in (left, right):
            only_variable = value.variable is not None and value.number == 0
            if value.dimension is not dimension and not only_variable:
                self.fail("one part of the sum has a unit and another has none, or another one")
        number = self.finite(left.number + right.number)
        variable, factor = left.variable or right.variable, left.factor + right.factor
        return Value(number, None, dimension, variable, factor, left.uses_pi or right.uses_pi)

    def product(self) -> Value:
        value = self.unit(self.factor())
        while sign := self.take("*", "/"):
            other = self.factor()
            value = self.unit(self.multiply(value, other) if sign == "*" else self.divide(value, other))
        return value

    def unit(self, value: Value) -> Value:
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
        unit = UNITS[unit_word(word)]
        if value.uses_pi and unit.degrees:
            self.fail("it is a multiple of π in degrees", "write the angle in degrees without pi, or in rad")
        return Value(self.finite(unit.si(value.number, value.decimal)), dimension=unit.dimension)

    def unknown_unit(self) -> NoReturn:
        word = self.next.text
        name = word.removeprefix("\\").casefold()
        if name in _CONSTANTS or name in _FUNCTIONS or any(name.startswith(module) for module in _MODULES):
            self.unexpected()
        units = [known for known, unit in UNITS.items() if unit.dimension in (Dimension.LENGTH, Dimension.ANGLE)]
        self.fail(f"{shown(word)} is no unit that is known", did_you_mean(word, units))

    def multiply(self, left: Value, right: Value) -> Value:
        if left.variable and right.variable:
            self.fail("it multiplies joint variables")
        if left.dimension and right.dimension:
            self.fail("it multiplies two quantities with units")
        if right.variable:
            left, right = right, left
        return self.scaled(left, right, left.number * right.number, left.factor * right.number)

    def divide(self, left: Value, right: Value) -> Value:
        if right.variable:
            self.fail("it divides by a joint variable")
        if right.number == 0:
            self.fail("it divides by zero")
        if right.dimension and right.dimension is not left.dimension:
            self.fail("it divides by a quantity with a unit")
        value = self.scaled(left, right, left.number / right.number, left.factor / right.number)
        return value._replace(dimension=None) if right.dimension else value

    def scaled(self, left: Value, right: Value, number: float, factor: float) -> Value:
        uses_pi = left.uses_pi or right.uses_pi
        dimension = left.dimension or right.dimension
        return Value(self.finite(number), None, dimension, left.variable, self.finite(factor), uses_pi)

    def factor(self) -> Value:
        sign = self.take("+", "-")
        if sign and self.next.text in ("+", "-"):
            self.fail("two signs follow each other")
        value = self.primary()
        return _negative(value) if sign == "-" else value

    def primary(self) -> Value:
        token = self.next
        if token.kind == "number":
            self.position += 1
            digits, _, exponent = token.text.lower().partition("e")
            return Value(self.finite(float(token.text)), Decimal(digits, int(exponent or 0)))
        if token.kind == "word":
            self.position += 1
            return self.named(token)
        if self.take("("):
            value = self.inside(self.sum)
            return value._replace(decimal=None)
        return self.unexpected()

    def inside(self, read: Callable[[], Value]) -> Value:
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

    def named(self, token: _Token) -> Value:
        name = unicodedata.normalize("NFKC", token.text).casefold().removeprefix("\\")
        name = next((name.removeprefix(module) for module in _MODULES if name.startswith(module)), name)
        name = _OTHER_NAMES.get(name, name)
        if name in _CONSTANTS:
            if self.next.text == "(" and self.tokens[self.position + 1].text == ")":  # PI() of spreadsheets
                self.position += 2
            return Value(_CONSTANTS[name], uses_pi=True)
        if name in _FUNCTIONS and self.take("("):
            return self.inside(lambda: self.call(token.text, _FUNCTIONS[name]))
        if match := _VARIABLE.fullmatch(name):
            self.skip_variable_star(token)
            row = int(match[2]) if match[2] and match[2] != "i" else None
            return Value(0.0, variable=Variable(_VARIABLE_KINDS.get(match[1], match[1]), row, token.text), factor=1.0)
        if self.next.text == "(" and name not in UNITS:
            names = ", ".join(_FUNCTIONS)
            self.fail(f"{shown(token.text)} is no function that is known", f"the functions are {names}")
        self.position -= 1
        return self.unexpected()

    def skip_variable_star(self, token: _Token) -> None:
        """Passes over the star that marks a variable in textbooks (Spong): ``theta2*``, ``theta2* + pi/2``."""
        star, after = self.next, self.tokens[min(self.position + 1, len(self.tokens) - 1)]
        attached = star.text == "*" and star.start == token.start + len(token.text)
        if attached and (after.kind == "end" or after.text in ("+", "-", ")")):
            self.position += 1

    def call(self, written: str, function: _Function) -> Value:
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
        if not ratio and function.call is not abs and dimensions - {None, function.takes}:
            self.fail(f"{written} is taken of a quantity with a unit")
        if function.call is math.atan2 and not any(argument.number for argument in arguments):
            self.fail(f"{written} has no value there")
        try:
            number = function.call(*(argument.number for argument in arguments))
        except (ValueError, ZeroDivisionError, OverflowError):
            self.fail(f"{written} has no value there")
        if function.call is abs:
            return arguments[0]._replace(number=number, decimal=None)
        return Value(self.finite(number), dimension=function.gives)

    def finite(self, number: float) -> float:
        if not math.isfinite(number):
            self.fail("it is beyond the largest number that can be held")
        return number


def _negative(value: Value) -> Value:
    decimal = value.decimal
    if decimal is not None:
        digits = decimal.digits[1:] if decimal.digits.startswith("-") else f"-{decimal.digits}"
        decimal = Decimal(digits, decimal.exponent)
    return value._replace(number=-value.number, decimal=decimal, factor=-value.factor)
