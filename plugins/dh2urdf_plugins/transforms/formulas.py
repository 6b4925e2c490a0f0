"""Numbers that know how they follow from the table.

A `Quantity` is a value and the formula that gives it, made by the same operations in the same order: evaluating
the formula gives the value to the last bit. Formulas use + - * ( ), decimal numbers without exponents, the parameters'
names, and abs, max, sin, cos, atan2: Python and xacro read them alike.

At a quarter turn cos and sin of the parameter would be 6e-17 instead of 0. There the formula is written with the phase
taken out, cos θ = -sin(θ - π/2), which is the same function of θ and exactly 0 at the number of the table.

The value may be a column, of a quantity that no parameter changes: the numbers of many robots have no formulas.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING, TypeAlias

from dh2urdf.robot import new_origin
from dh2urdf.rotations import (
    HALF_PI,
    Number,
    atan2,
    exact_cos_sin,
    greater_of,
    is_column,
    mapped,
    nearest_quarter,
    where,
)

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Origin
    from dh2urdf.rotations import Vec3

_SUM, _PRODUCT, _ATOM = range(3)  # how tightly a formula holds together


class Quantity:
    """A value with its formula.

    Attributes:
        value: the number.
        constant: whether no parameter changes it.
    """

    __slots__ = ("_body", "_negative", "_rank", "constant", "value")

    def __init__(self, value: float, body: str = "", rank: int = _ATOM, *, negative: bool = False) -> None:
        self.value = value
        self.constant = not body
        self._body, self._rank, self._negative = body, rank, negative

    @classmethod
    def parameter(cls, name: str, value: float) -> Quantity:
        """A number of the table."""
        return cls(value, name)

    @property
    def formula(self) -> str:
        """The formula as text."""
        body, rank, negative = self._parts()
        return (f"-({body})" if rank == _SUM else f"-{body}") if negative else body

    def __add__(self, other: Quantity) -> Quantity:
        if self.constant and other.constant:
            return Quantity(self.value + other.value)
        if other.constant and not other.value:
            return self
        if self.constant and not self.value:
            return other
        body, rank, negative = other._parts()
        right = f"({body})" if rank == _SUM else body
        return Quantity(self.value + other.value, f"{self.formula} {'-' if negative else '+'} {right}", _SUM)

    def __sub__(self, other: Quantity) -> Quantity:
        return self + -other

    def __neg__(self) -> Quantity:
        if self.constant:
            return Quantity(-self.value)
        return Quantity(-self.value, self._body, self._rank, negative=not self._negative)

    def __mul__(self, other: Quantity) -> Quantity:
        if self.constant and other.constant:
            return Quantity(self.value * other.value)
        for factor, rest in ((self, other), (other, self)):
            if factor.constant and abs(factor.value) in (0.0, 1.0):
                if not factor.value:
                    return NOTHING
                return rest if factor.value > 0.0 else -rest
        first, second = (other, self) if other.constant else (self, other)
        left, left_rank, left_negative = first._parts()
        right, right_rank, right_negative = second._parts()
        left = f"({left})" if left_rank == _SUM else left
        right = right if right_rank == _ATOM else f"({right})"
        negative = left_negative is not right_negative
        return Quantity(self.value * other.value, f"{left}*{right}", _PRODUCT, negative=negative)

    def _parts(self) -> tuple[str, int, bool]:
        """Text without its sign, rank, and whether the sign is minus."""
        if self.constant:
            return _decimal(abs(self.value)), _ATOM, self.value < 0.0
        return self._body, self._rank, self._negative


Quantities: TypeAlias = tuple[Quantity, Quantity, Quantity]
"""A vector, or roll, pitch and yaw."""

Symbol: TypeAlias = Callable[[str, float], Quantity]
"""Makes a quantity of a number of the table, given its name and its value."""


def nameless(_name: str, value: float) -> Quantity:
    """A number of the table, or a column of such numbers, that no formula mentions."""
    return Quantity(value)


NOTHING = Quantity(0.0)
HALF = Quantity(0.5)
NO_VECTOR: Quantities = (NOTHING, NOTHING, NOTHING)


def constants(vector: Sequence[float]) -> Quantities:
    """A vector that no parameter changes."""
    return (Quantity(vector[0]), Quantity(vector[1]), Quantity(vector[2]))


def plus(left: Quantities, right: Quantities) -> Quantities:
    """The sum of two vectors."""
    return (left[0] + right[0], left[1] + right[1], left[2] + right[2])


def signed(sign: int, axis: Vec3) -> Vec3:
    """A joint's axis, turned round where it counts the other way, without -0.0."""
    return (sign * axis[0] + 0.0, sign * axis[1] + 0.0, sign * axis[2] + 0.0)


def times(factor: Quantity, vector: Quantities) -> Quantities:
    """A vector times a number."""
    return (factor * vector[0], factor * vector[1], factor * vector[2])


def length_of(quantity: Quantity, shorter: float = 0.0, *, least: float) -> Quantity:
    """The absolute value of a length less a number [m], and never less than `least`, whatever a person edits."""
    value = abs(quantity.value) - shorter
    if quantity.constant:
        return Quantity(greater_of(value, least))
    body, _, _ = quantity._parts()  # noqa: SLF001 - of the class above
    less = f" - {_decimal(shorter)}" if shorter else ""
    return Quantity(max(value, least), f"max(abs({body}){less}, {_decimal(least)})")


def greater(left: Quantity, right: Quantity) -> Quantity:
    """The greater of two absolute values."""
    value = max(abs(left.value), abs(right.value))
    return Quantity(value, f"max(abs({left.formula}), abs({right.formula}))")


def cos_sin_of(angle: Quantity, parameter: Quantity) -> tuple[Quantity, Quantity]:
    """Cosine and sine of an angle [rad] that is a parameter plus a constant."""
    if is_column(angle.value):
        cosine, sine = exact_cos_sin(angle.value)
        return Quantity(cosine), Quantity(sine)
    turns, is_whole = nearest_quarter(angle.value)
    if not is_whole:
        return _cosine(angle), _sine(angle)
    phase = parameter + Quantity(-parameter.value)
    return _turned(_cosine(phase), _sine(phase), turns)


def rpy_of(r: tuple[Quantity, ...]) -> Quantities:
    """URDF's roll, pitch and yaw [rad] of a rotation whose nine elements follow parameters.

    The steps of `dh2urdf.rotations.rpy_from_rotation`, which hold at every pitch. Where yaw is a quarter turn its
    arctangent is taken with the phase out, so that its cosine and sine are exactly 0 and ±1.
    """
    r00, r01, r02, r10, r11, r12, r20, _, _ = r
    turns, is_whole = nearest_quarter(atan2(r10.value + 0.0, r00.value + 0.0))
    turns = where(is_whole, turns, 0)
    cosine, sine = _turned(r00, r10, -turns)
    y = _atan2(sine, cosine)
    c, s = _turned(_cosine(y), _sine(y), turns)
    yaw = Quantity(turns * HALF_PI) + y
    pitch = _atan2(-r20, c * r00 + s * r10)
    roll = _atan2(s * r02 - c * r12, c * r11 - s * r01)
    return (roll, pitch, yaw)


def origin(xyz: Quantities, rpy: Quantities = NO_VECTOR) -> Origin:
    """The origin [m, rad] with its formulas; those of a part that no parameter changes are left out."""
    return new_origin(xyz=values(xyz), rpy=values(rpy), xyz_formula=_formulas(xyz), rpy_formula=_formulas(rpy))


def _formulas(vector: Quantities) -> tuple[str, str, str] | None:
    x, y, z = vector
    return None if x.constant and y.constant and z.constant else (x.formula, y.formula, z.formula)


def values(vector: Quantities) -> Vec3:
    """The numbers of a vector, without -0.0."""
    return (vector[0].value + 0.0, vector[1].value + 0.0, vector[2].value + 0.0)


def _turned(cosine: Quantity, sine: Quantity, turns: Number) -> tuple[Quantity, Quantity]:
    """Cosine and sine of an angle after some quarter turns, which may be a column."""
    quarters = ((cosine, sine), (-sine, cosine), (-cosine, -sine), (sine, -cosine))
    if not is_column(turns):
        return quarters[turns % 4]
    import numpy as np

    which = (turns % 4).astype(int)
    chosen = [Quantity(np.choose(which, [each.value for each in four])) for four in zip(*quarters, strict=True)]
    return chosen[0], chosen[1]


def _cosine(angle: Quantity) -> Quantity:
    return Quantity(mapped(math.cos, angle.value), "" if angle.constant else f"cos({angle.formula})")


def _sine(angle: Quantity) -> Quantity:
    return Quantity(mapped(math.sin, angle.value), "" if angle.constant else f"sin({angle.formula})")


def _atan2(sine: Quantity, cosine: Quantity) -> Quantity:
    """The angle of a sine and a cosine; adding 0 makes 0 of a -0.0, which atan2 tells apart."""
    is_constant = sine.constant and cosine.constant
    body = "" if is_constant else f"atan2({sine.formula} + 0, {cosine.formula} + 0)"
    return Quantity(atan2(sine.value + 0.0, cosine.value + 0.0), body)


def _decimal(number: float) -> str:
    """The shortest decimal text of a number, 0 or more, that reads back to it, without an exponent."""
    text, _, power = repr(number).removesuffix(".0").partition("e")
    shift, digits = int(power or 0), text.replace(".", "")
    return text if not shift else "0." + "0" * ~shift + digits if shift < 0 else digits.ljust(shift + 1, "0")
