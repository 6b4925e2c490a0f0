from __future__ import annotations

import math
from decimal import Decimal
from typing import TYPE_CHECKING, Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.rotations import rotation_from_rpy
from dh2urdf_plugins.transforms.formulas import (
    Quantity,
    cos_sin_of,
    length_of,
    rpy_of,
)

if TYPE_CHECKING:
    from collections.abc import Callable

A, B = Quantity.parameter("a", 0.7), Quantity.parameter("b", -1.3)
NAMES: dict[str, Any] = {"a": 0.7, "b": -1.3, "sin": math.sin, "cos": math.cos, "atan2": math.atan2}
NAMES |= {"abs": abs, "max": max}


def value_of(formula: str, **names: float) -> float:
    return float(eval(formula, {"__builtins__": {}}, NAMES | names))  # noqa: S307 - the project's own text


def n(value: float) -> Quantity:
    return Quantity(value)


@pytest.mark.parametrize(
    ("quantity", "formula"),
    [
        (n(-0.5) * A, "-0.5*a"),
        (n(-1e-07) * A, "-0.0000001*a"),
        (A + n(-0.25), "a - 0.25"),
        (A - (B + n(1.0)), "a - (b + 1)"),
        ((A + B) * n(0.5), "0.5*(a + b)"),
        ((A * B) * B, "a*b*b"),
        (length_of(B, 0.08, least=0.001), "max(abs(b) - 0.08, 0.001)"),
    ],
)
def test_formulas_are_short_and_give_the_value(quantity: Quantity, formula: str) -> None:
    """What changes nothing is not written, signs are in front, and the value is the formula's."""
    assert quantity.formula == formula
    assert value_of(formula) == quantity.value


numbers = st.floats(-1e3, 1e3).map(Quantity)
leaves = numbers | st.sampled_from([A, B, n(0.0), n(1.0), n(-1.0)])
operations: st.SearchStrategy[Callable[[Quantity, Quantity], Quantity]] = st.sampled_from(
    [lambda x, y: x + y, lambda x, y: x - y, lambda x, y: x * y, lambda x, _: -x]
)
trees = st.recursive(leaves, lambda inner: st.builds(lambda f, x, y: f(x, y), operations, inner, inner), max_leaves=12)


@given(trees)
def test_any_expression_gives_its_value_to_the_last_bit(quantity: Quantity) -> None:
    """The formula does the same operations in the same order."""
    assert value_of(quantity.formula) == quantity.value


@given(st.integers(-8, 8), st.sampled_from([0.0, 0.3]), st.floats(-7, 7))
def test_cosine_and_sine_at_quarter_turns_are_exact_and_still_functions(k: int, offset: float, edited: float) -> None:
    """At the table's number they are 0 and ±1 to the last bit, elsewhere the cosine and sine of the angle."""
    parameter = Quantity.parameter("t", k * math.pi / 2 - offset)
    angle = parameter + n(offset)
    c, s = cos_sin_of(angle, parameter)
    assert (c.value, s.value) in {(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)}
    for quantity, function in ((c, math.cos), (s, math.sin)):
        assert value_of(quantity.formula, t=parameter.value) == quantity.value
        assert value_of(quantity.formula, t=edited) == pytest.approx(function(edited + offset), abs=4e-15)


angles = st.sampled_from([i * math.pi / 2 for i in range(-4, 5)]) | st.floats(-7, 7)


@given(angles, angles, angles, angles)
def test_rpy_formulas_hold_for_every_angle_that_a_person_may_enter(
    alpha: float, theta: float, other_alpha: float, other_theta: float
) -> None:
    """Rx(α)·Rz(θ) comes out of the formulas, at the table's angles and at any others, the singular pitch included."""
    p, t = Quantity.parameter("p", alpha), Quantity.parameter("t", theta)
    (ca, sa), (ct, st_) = cos_sin_of(p, p), cos_sin_of(t, t)
    rpy = rpy_of((ct, -st_, n(0.0), ca * st_, ca * ct, -sa, sa * st_, sa * ct, ca))
    for names in ({"p": alpha, "t": theta}, {"p": other_alpha, "t": other_theta}):
        roll, pitch, yaw = (value_of(quantity.formula, **names) for quantity in rpy)
        (c, s), (cz, sz) = ((math.cos(angle), math.sin(angle)) for angle in (names["p"], names["t"]))
        expected = (cz, -sz, 0, c * sz, c * cz, -s, s * sz, s * cz, c)
        assert rotation_from_rpy((roll, pitch, yaw)) == pytest.approx(expected, abs=5e-15)


@given(
    st.floats(0.0, 1e30)
    | st.floats(0.0, 1e-3)
    | st.sampled_from([1e-6, 2.0**-24, 5e-324, 1e16, 1e23, 1.7976931348623157e308])
)
def test_numbers_have_no_exponents(value: float) -> None:
    """A number in a formula is its shortest decimal text, written out as `decimal` writes it."""
    assert Quantity(value).formula == format(Decimal(repr(value)), "f").removesuffix(".0")
