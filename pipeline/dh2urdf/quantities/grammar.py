"""The grammar of expressions: ``pi/2``, ``-425 mm``, ``q2 + 90 deg``.

A grammar of its own, never `eval`; names other than those below, powers, attributes and calls of anything else are
refused::

    sum      = product (("+" | "-") product)*
    product  = factor (("*" | "/") factor)* [unit]
    factor   = ["+" | "-"] (number [constant] | constant | name | variable | call | "(" sum ")")
    call     = function "(" sum ("," sum)* ")"

A unit belongs to the product that it ends: ``pi/2 rad`` is (π/2) rad, since nothing is measured in 1/rad. A product
or quotient never mixes two units, and a sum has one unit throughout or none. What cannot be bounded otherwise is
bounded by `MAX_CHARACTERS` and `MAX_NESTING`.
"""

from __future__ import annotations

import math
import re
import unicodedata
from typing import TYPE_CHECKING, NamedTuple, NoReturn

from dh2urdf.quantities.spellings import SIGNS, advice, misreading
from dh2urdf.quantities.units import (
    UNITS,
    Decimal,
    Dimension,
    QuantityError,
    Unit,
    accepted_forms,
    is_unit,
    unit_where,
    unknown_unit,
)
from dh2urdf.rotations import HALF_PI, cos_sin
from dh2urdf.source import Messages, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Mapping

    from dh2urdf.source import Problem


say = Messages(__file__)

# --- Tokens -----------------------------------------------------------------------------------------------------------

MAX_CHARACTERS = 1000
"""Length of a number or an expression: more digits than a double can use, and no work for an attacker."""
MAX_NESTING = 30
"""Brackets inside each other in an expression."""


class Variable(NamedTuple):
    """The joint variable as an expression names it."""

    kind: str  # ``q``, ``theta`` or ``d``
    row: int | None  # the row that it names, counted from 1; None for ``q``, ``q_i`` and the like
    text: str  # how it is written


class Intermediate(NamedTuple):
    """An intermediate result."""

    number: float  # the number, in the unit that the text means; in SI units where it has a dimension
    decimal: Decimal | None = None  # the decimal text of a bare number
    dimension: Dimension | None = None  # what it measures, where it names a unit
    variable: Variable | None = None  # the joint variable in it
    factor: float = 0.0  # of the joint variable
    uses_pi: bool = False  # whether it is a number that was made of π, so that it can only be radians
    foreign: bool = False  # whether it names a unit other than the SI unit


SPACE = r"[^\S\x1c-\x1f]"
"""White space between the parts of a number; Python counts four control characters to it, and `float` does not."""


TOKEN = (
    f"(?xs)(?P<space>{SPACE}+)"
    r"""
      | (?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,18}(?![0-9]))?)
      | (?P<word>\\?[^\W\d]\w*(?:_?\{\w+\})?(?:\.[^\W\d]\w*)*)
      | (?P<degree>°)
      | (?P<sign>.)"""
)


class Token(NamedTuple):
    """A piece of an expression."""

    kind: str
    text: str
    start: int


def negative(value: Intermediate) -> Intermediate:
    """The value with the other sign, of its decimal text too."""
    decimal = value.decimal
    if decimal is not None:
        digits = decimal.digits[1:] if decimal.digits.startswith("-") else f"-{decimal.digits}"
        decimal = Decimal(digits, decimal.exponent)
    return value._replace(number=-value.number, decimal=decimal, factor=-value.factor)


_DECIMAL_COMMA = r"(?<![0-9.,])([0-9]*),([0-9]+)(?![0-9.,])"
_LONGEST_UNIT = 7
"""Tokens of the longest unit: ``N * m * s / rad``."""
_TORN = r"(?i)[\s*·]\d|(?<!\w)(?!(?:N|kN|mN|kg|kgf|g|t|lb|lbf|oz|ozf|slug|ft|in|s)\s)\w+\s+\w"
"""A power without its sign, and a word with a space behind it that is no factor: `m m` is no mm, `N m` is Nm."""
_CONSTANTS = {"pi": math.pi, "π": math.pi, "m_pi": math.pi}
_MODULES = ("np.", "numpy.", "math.")
_VARIABLE = r"\\?(q|th|theta|θ|d)_?\{?([0-9]{1,9}|i)?\}?"
_NAME = r"[^\W\d_][^\W_]{0,15}(?:_?\{?[^\W_]{1,8}\}?)?"
_NO_NAMES = frozenset(("nan", "inf", "infinity", "true", "false", "none", "null", "var"))
_VARIABLE_KINDS = {"th": "theta", "θ": "theta"}

# --- Functions --------------------------------------------------------------------------------------------------------


def from_degrees(number: float) -> float:
    """An angle in rad, of a number of degrees."""
    return number / 90 * HALF_PI


class Function(NamedTuple):
    """A function of numbers."""

    call: Callable[..., float]  # what computes it
    takes: Dimension | None = None  # what its argument may measure besides nothing
    gives: Dimension | None = None  # what its value measures; None for a bare number
    arguments: int = 1  # how many it has


FUNCTIONS = {
    "sqrt": Function(math.sqrt),
    "abs": Function(abs),
    "sin": Function(lambda angle: float(cos_sin(angle)[1]), takes=Dimension.ANGLE),
    "cos": Function(lambda angle: float(cos_sin(angle)[0]), takes=Dimension.ANGLE),
    "tan": Function(lambda angle: float(cos_sin(angle)[1] / cos_sin(angle)[0]), takes=Dimension.ANGLE),
    "asin": Function(math.asin, gives=Dimension.ANGLE),
    "acos": Function(math.acos, gives=Dimension.ANGLE),
    "atan": Function(math.atan, gives=Dimension.ANGLE),
    "atan2": Function(math.atan2, gives=Dimension.ANGLE, arguments=2),
    "radians": Function(from_degrees, gives=Dimension.ANGLE),
}
"""The functions by their names."""
OTHER_NAMES = {"arcsin": "asin", "arccos": "acos", "arctan": "atan", "arctan2": "atan2", "deg2rad": "radians"}
"""Names that people write for them."""


# --- Parser -----------------------------------------------------------------------------------------------------------


def symbol_key(name: str) -> str:
    """A name as it is looked up: ``L_1``, ``L_{1}`` and ``L₁`` are one."""
    return re.sub(r"[\\\\_{}]", "", unicodedata.normalize("NFKC", name)).casefold()


def is_symbol(name: str) -> bool:
    """Whether a text can be a name for a length or an angle: no unit, constant, function or variable q."""
    if not re.fullmatch(_NAME, name) or name.casefold() in _NO_NAMES or is_unit(name):
        return False
    key = symbol_key(name)
    variable = re.fullmatch(_VARIABLE, key)
    return key not in (*_CONSTANTS, *FUNCTIONS, *OTHER_NAMES) and not (variable and variable[1] != "d")


class Parser:
    """Reads one expression, by recursive descent that `MAX_NESTING` bounds; `evaluate` says what it is given.

    Raises:
        QuantityError: it is too long, or, of every method, it is no expression, or one that can be read in two ways.
    """

    def __init__(
        self,
        text: str,
        dimension: Dimension,
        *,
        decimal_comma: bool = False,
        angle: Unit | None = None,
        symbols: Mapping[str, Intermediate] | None = None,
    ) -> None:
        self.text, self.dimension, self.angle, self.symbols = text, dimension, angle, symbols or {}
        self.accepted = accepted_forms(dimension)
        if len(text) > MAX_CHARACTERS:
            message = f"{shown(text)} has {len(text)} characters"
            raise QuantityError(message, f"at most {MAX_CHARACTERS} characters")
        self.plain = text.translate(SIGNS)
        if decimal_comma:
            self.plain = re.sub(_DECIMAL_COMMA, r"\1.\2", self.plain)
        matches = (match for match in re.finditer(TOKEN, self.plain) if match.lastgroup != "space")
        self.tokens = [Token(match.lastgroup or "", match.group(), match.start()) for match in matches]
        self.tokens.append(Token("end", "", len(self.plain)))
        self.position = self.depth = 0

    def parse(self) -> Intermediate:
        """The value of the expression."""
        if len(self.tokens) == 1:
            raise QuantityError("there is nothing", self.accepted)
        if wrong := misreading(self.text):
            self._fail(say("misreading", reason=wrong[0], suggestion=wrong[1]))
        value = self._sum()
        if self._next.kind != "end":
            self._unexpected()
        return value

    @property
    def _next(self) -> Token:
        return self.tokens[self.position]

    def _take(self, *signs: str) -> str | None:
        """The next token, where it is one of some signs; it is passed over then."""
        if self._next.kind == "sign" and self._next.text in signs:
            self.position += 1
            return self.tokens[self.position - 1].text
        return None

    def _fail(self, fault: Problem) -> NoReturn:
        suggestion = advice(self.text) if fault.suggestion is None else fault.suggestion
        raise QuantityError(f"{shown(self.text)} cannot be read: {fault.message}", self.accepted, suggestion)

    def _unexpected(self) -> NoReturn:
        token = self._next
        if token.kind == "end":
            self._fail(say("no-end"))
        if token.kind in ("number", "word", "degree") and self.position:
            before = self.tokens[self.position - 1].text
            if token.kind == "number" or OTHER_NAMES.get(token.text, token.text) in (*_CONSTANTS, *FUNCTIONS):
                self._fail(say("no-sign", before=before, found=token.text))
            if token.kind == "word" and is_unit(token.text):
                self._fail(say("unit-there", found=token.text))
        if token.kind == "word":
            if is_symbol(token.text) and not is_unit(token.text):
                self._fail(say("undefined", found=token.text))
            self._fail(say("unknown-word", found=token.text))
        self._fail(say("unexpected", found=token.text))

    def _sum(self) -> Intermediate:
        left = self._product()
        while sign := self._take("+", "-"):
            right = self._product()
            right = right if sign == "+" else negative(right)
            if left.variable and right.variable:
                self._fail(say("variable-twice" if left.variable.row == right.variable.row else "two-variables"))
            dimension = left.dimension or right.dimension
            for value in (left, right):
                only_variable = value.variable is not None and value.number == 0
                if value.dimension is not dimension and not only_variable:
                    self._fail(say("half-a-unit"))
            left = self._joined(left, right, left.number + right.number, left.factor + right.factor, dimension)
        return left

    def _joined(
        self, left: Intermediate, right: Intermediate, number: float, factor: float, dimension: Dimension | None
    ) -> Intermediate:
        """What two values make together: a number, and a factor of their joint variable."""
        variable = left.variable or right.variable
        uses_pi, foreign = left.uses_pi or right.uses_pi, left.foreign or right.foreign
        return Intermediate(self._finite(number), None, dimension, variable, self._finite(factor), uses_pi, foreign)

    def _product(self) -> Intermediate:
        value = self._unit(self._factor())
        while sign := self._take("*", "/"):
            other = self._factor()
            value = self._unit(self._multiply(value, other) if sign == "*" else self._divide(value, other))
        return value

    def _multiply(self, left: Intermediate, right: Intermediate) -> Intermediate:
        if left.variable and right.variable:
            self._fail(say("variables-multiplied"))
        if left.dimension and right.dimension:
            self._fail(say("units-multiplied"))
        if right.variable:
            left, right = right, left
        dimension = left.dimension or right.dimension
        return self._joined(left, right, left.number * right.number, left.factor * right.number, dimension)

    def _divide(self, left: Intermediate, right: Intermediate) -> Intermediate:
        if right.variable:
            self._fail(say("divided-by-a-variable"))
        if right.number == 0:
            self._fail(say("divided-by-zero"))
        if right.dimension and right.dimension is not left.dimension:
            self._fail(say("divided-by-a-unit"))
        dimension = None if right.dimension else left.dimension
        return self._joined(left, right, left.number / right.number, left.factor / right.number, dimension)

    def _unit(self, value: Intermediate) -> Intermediate:
        """The value in SI units, where a unit follows it."""
        token = self._next
        count = self._words_of_unit()
        if not count:
            if token.kind == "word" and self.tokens[self.position - 1].kind == "number":
                self._unknown_unit()
            return value
        word = self._between(self.position, self.position + count)
        self.position += count
        if value.dimension is not None:
            self._fail(say("unit-twice", found=token.text))
        if value.variable:
            self._fail(say("unit-of-a-variable", found=value.variable.text))
        unit = unit_where(word, self.dimension)
        if unit is None:
            self._unknown_unit()
        if value.uses_pi and unit.parts:
            self._fail(say("pi-in-degrees", unit="degrees" if unit.degrees else unit.symbol))
        number = self._finite(unit.si(value.number, value.decimal))
        return Intermediate(number, dimension=unit.dimension, foreign=not unit.is_si)

    def _words_of_unit(self) -> int:
        """How many tokens ahead are one unit, such as ``kg m^2``, ``deg/s`` or ``1/min``; 0 where there is none."""
        start, first = self.position, self._next
        if first.kind not in ("word", "degree") and self._between(start, start + 2) != "1/":
            return 0
        for count in range(min(_LONGEST_UNIT, len(self.tokens) - 1 - start), 0, -1):
            word = self._between(start, start + count)
            whole = self.tokens[start + count - 1].kind != "sign" and not re.search(_TORN, word)
            if whole and is_unit(word):
                return count
        return 0

    def _between(self, start: int, end: int) -> str:
        """The text from one token to before another."""
        last = self.tokens[min(end, len(self.tokens)) - 1]
        return self.plain[self.tokens[start].start : last.start + len(last.text)]

    def _unknown_unit(self) -> NoReturn:
        word = self._next.text
        name = word.removeprefix("\\").casefold()
        if name in _CONSTANTS or name in FUNCTIONS or any(name.startswith(module) for module in _MODULES):
            self._unexpected()
        self._fail(say("unknown-unit", found=word, suggestion=unknown_unit(word, self.dimension).suggestion))

    def _factor(self) -> Intermediate:
        sign = self._take("+", "-")
        if sign and self._next.text in ("+", "-"):
            self._fail(say("two-signs"))
        value = self._primary()
        return negative(value) if sign == "-" else value

    def _primary(self) -> Intermediate:
        token = self._next
        if token.kind == "number":
            self.position += 1
            digits, _, exponent = token.text.lower().partition("e")
            decimal, number = Decimal(digits, int(exponent or 0)), self._finite(float(token.text))
            if number == 0 and not decimal.is_zero:
                self._fail(say("too-small", found=token.text))
            constant = _CONSTANTS.get(self._next.text.casefold())
            if constant is None:
                return Intermediate(number, decimal)
            if self.position > 1 and self.tokens[self.position - 2].text == "/":
                self._fail(say("pi-below-the-line"))
            self.position += 1
            return Intermediate(self._finite(number * constant), uses_pi=True)
        if token.kind == "word":
            self.position += 1
            return self._named(token)
        if self._take("("):
            value = self._inside(self._sum)
            return value._replace(decimal=None)
        return self._unexpected()

    def _inside(self, read: Callable[[], Intermediate]) -> Intermediate:
        """What is in a bracket that was just opened."""
        self.depth += 1
        if self.depth > MAX_NESTING:
            self._fail(say("deep", limit=MAX_NESTING))
        value = read()
        if not self._take(")"):
            if self._next.kind == "end":
                self._fail(say("open-bracket"))
            self._unexpected()
        self.depth -= 1
        return value

    def _named(self, token: Token) -> Intermediate:
        name = unicodedata.normalize("NFKC", token.text).casefold().removeprefix("\\")
        name = next((name.removeprefix(module) for module in _MODULES if name.startswith(module)), name)
        name = OTHER_NAMES.get(name, name)
        if name in _CONSTANTS:
            if self._next.text == "(" and self.tokens[self.position + 1].text == ")":  # PI() of spreadsheets
                self.position += 2
            return Intermediate(_CONSTANTS[name], uses_pi=True)
        if name in FUNCTIONS and self._take("("):
            return self._inside(lambda: self._call(token.text, FUNCTIONS[name]))
        if (value := self.symbols.get(symbol_key(token.text))) is not None:
            return value
        if match := re.fullmatch(_VARIABLE, name):
            self._skip_variable_star(token)
            row = int(match[2]) if match[2] and match[2] != "i" else None
            variable = Variable(_VARIABLE_KINDS.get(match[1], match[1]), row, token.text)
            return Intermediate(0.0, variable=variable, factor=1.0)
        if self._next.text == "(" and name not in UNITS and not is_symbol(token.text):
            self._fail(say("unknown-function", found=token.text, functions=[*FUNCTIONS]))
        self.position -= 1
        return self._unexpected()

    def _skip_variable_star(self, token: Token) -> None:
        """Passes over the star that marks a variable in textbooks (Spong): ``theta2*``, ``theta2* + pi/2``.

        The star may be a product's as well: ``q1*-1`` is -q1 to one person, and q1 - 1 to another.
        """
        star, sign, number, end = (*self.tokens[self.position :], *self.tokens[-1:] * 3)[:4]
        if star.text != "*":
            return
        attached = star.start == token.start + len(token.text)
        if sign.text in ("+", "-") and number.kind == "number" and end.kind not in ("word", "degree"):
            touching = sign.start == star.start + 1
            # A number with π is an angle, and no factor of a variable.
            ahead = {token.text.casefold().rpartition(".")[2] for token in self.tokens[self.position :]}
            if (touching or (attached and float(number.text) == 1)) and ahead.isdisjoint(_CONSTANTS):
                self._fail(say("star", found=token.text, sign=sign.text, number=number.text))
        if attached and (sign.kind == "end" or sign.text in ("+", "-", ")")):
            self.position += 1

    def _call(self, written: str, function: Function) -> Intermediate:
        arguments = [self._sum()]
        while self._take(","):
            arguments.append(self._sum())
        if len(arguments) != function.arguments:
            self._fail(say("one-argument" if function.arguments == 1 else "two-arguments", found=written))
        if any(argument.variable for argument in arguments):
            self._fail(say("function-of-a-variable", found=written))
        dimensions = {argument.dimension for argument in arguments}
        ratio = function.arguments > 1 and len(dimensions) == 1  # atan2 of two lengths
        if not ratio and function.call is not abs and dimensions - {None, function.takes}:
            self._fail(say("function-of-a-unit", found=written))
        if function.call is math.atan2 and not any(argument.number for argument in arguments):
            self._fail(say("no-value-there", found=written))
        if function.takes is Dimension.ANGLE:
            self._refuse_bare_angle(written, arguments[0])
        if function.call is from_degrees and arguments[0].uses_pi:
            self._fail(say("function-of-radians", found=written))
        try:
            number = function.call(*(argument.number for argument in arguments))
        except (ValueError, ZeroDivisionError, OverflowError):
            self._fail(say("no-value-there", found=written))
        if function.call is abs:
            return arguments[0]._replace(number=number, decimal=None)
        return Intermediate(self._finite(number), dimension=function.gives)

    def _refuse_bare_angle(self, written: str, argument: Intermediate) -> None:
        """Refuses a bare number whose unit a function of an angle would have to guess."""
        if argument.dimension is not None or argument.uses_pi or argument.number == 0:
            return
        number, unit = f"{argument.number:.12g}", self.angle
        if unit is not None and unit.parts:
            declared = "degrees" if unit.degrees else unit.symbol
            self._fail(say("angle-without-a-unit", found=written, number=number, declared=declared, unit=unit.symbol))
        if unit is None and abs(argument.number) > math.tau:
            self._fail(say("angle-above-a-turn", found=written, number=number))

    def _finite(self, number: float) -> float:
        if not math.isfinite(number):
            self._fail(say("too-large"))
        return number
