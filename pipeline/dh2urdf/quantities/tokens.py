"""What the grammar of expressions works with: tokens, variables and intermediate results."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING

from dh2urdf.late_tuples import NamedTuple
from dh2urdf.patterns import late_pattern
from dh2urdf.quantities.exact_numbers import Decimal

if TYPE_CHECKING:
    from dh2urdf.quantities.units import Dimension

MAX_CHARACTERS = 1000
"""Length of a number or an expression: more digits than a double can use, and no work for an attacker."""


MAX_NESTING = 30
"""Brackets inside each other in an expression."""


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


class Intermediate(NamedTuple):
    """An intermediate result.

    Attributes:
        number: the number, in the unit that the text means; in SI units where it has a dimension.
        decimal: the decimal text of a bare number.
        dimension: what it measures, where it names a unit.
        variable: the joint variable in it.
        factor: of the joint variable.
        uses_pi: whether it is a number that was made of π, so that it can only be radians.
        foreign: whether it names a unit other than the SI unit.
    """

    number: float
    decimal: Decimal | None = None
    dimension: Dimension | None = None
    variable: Variable | None = None
    factor: float = 0.0
    uses_pi: bool = False
    foreign: bool = False


SPACE = r"[^\S\x1c-\x1f]"
"""White space between the parts of a number; Python counts four control characters to it, and `float` does not."""


TOKEN = late_pattern(
    f"(?P<space>{SPACE}+)"
    r"""
      | (?P<number>(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,18}(?![0-9]))?)
      | (?P<word>\\?[^\W\d]\w*(?:_?\{\w+\})?(?:\.[^\W\d]\w*)*)
      | (?P<degree>°)
      | (?P<sign>.)""",
    re.VERBOSE | re.DOTALL,
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
