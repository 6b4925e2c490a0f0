from __future__ import annotations

import math
import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dh2urdf.units import Decimal, Dimension, QuantityError, find_unit

LENGTHS = {"m": 0, "cm": -2, "mm": -3, "µm": -6}


@pytest.mark.parametrize(
    ("word", "dimension", "symbol"),
    [
        ("MM", Dimension.LENGTH, "mm"),
        ("millimetres", Dimension.LENGTH, "mm"),
        ("um", Dimension.LENGTH, "µm"),
        ("\N{GREEK SMALL LETTER MU}m", Dimension.LENGTH, "µm"),
        ("°", Dimension.ANGLE, "deg"),
        ("º", Dimension.ANGLE, "deg"),
        ("Degrees", Dimension.ANGLE, "deg"),
        ("°/s", Dimension.TURN_RATE, "deg/s"),
        ("rad/sec", Dimension.TURN_RATE, "rad/s"),
        ("mm / s", Dimension.SPEED, "mm/s"),
        ("N m", Dimension.EFFORT, "Nm"),
        ("kg m^2", Dimension.INERTIA, "kg·m²"),
        ("kg·m²", Dimension.INERTIA, "kg·m²"),
    ],
)
def test_a_unit_is_known_by_its_usual_words(word: str, dimension: Dimension, symbol: str) -> None:
    """Case, spaces and signs of multiplication do not matter."""
    assert find_unit(word, dimension).symbol == symbol


@pytest.mark.parametrize(("word", "dimension"), [("inch", Dimension.LENGTH), ("gon", Dimension.ANGLE)])
def test_an_unknown_unit_is_named_with_those_that_are_known(word: str, dimension: Dimension) -> None:
    """Nothing is converted by a factor that nobody asked for."""
    with pytest.raises(QuantityError, match=f"'{word}' is no unit of {dimension.plain} that is known"):
        find_unit(word, dimension)


@pytest.mark.parametrize(
    ("word", "dimension", "advice"),
    [
        ("inch", Dimension.LENGTH, "1 inch is 25.4 mm"),
        ("Grad", Dimension.ANGLE, "write deg for degrees"),
        ("π rad", Dimension.ANGLE, r"0\.5\*pi"),
    ],
)
def test_a_unit_of_other_people_comes_with_advice(word: str, dimension: Dimension, advice: str) -> None:
    """The nearest known word would mislead: `Grad` is a degree in German, and no rad."""
    with pytest.raises(QuantityError) as refused:
        find_unit(word, dimension)
    assert re.search(advice, refused.value.suggestion or "")


def test_a_unit_of_something_else_is_refused() -> None:
    """An angle has no millimetres."""
    with pytest.raises(QuantityError, match="'mm' is a unit of length, and one of angle is needed"):
        find_unit("mm", Dimension.ANGLE)


@given(st.decimals(-10_000, 10_000, places=4), st.sampled_from(sorted(LENGTHS)))
def test_a_power_of_ten_is_applied_to_the_text(number: object, word: str) -> None:
    """109.15 mm is the double that is nearest to 0.10915: no second rounding."""
    digits = f"{number:f}"
    unit = find_unit(word, Dimension.LENGTH)
    assert unit.si(float(digits), Decimal(digits, 0)) == float(f"{digits}e{LENGTHS[word]}")


@given(st.integers(-40, 40))
def test_multiples_of_90_degrees_are_quarter_turns_to_the_last_bit(turns: int) -> None:
    """The file can say 0 and 1 where the table said 90."""
    assert find_unit("deg", Dimension.ANGLE).si(90.0 * turns) == turns * (math.pi / 2)


@given(st.floats(-1000, 1000))
def test_degrees_are_right_to_rounding(degrees: float) -> None:
    """Whatever the angle, the conversion costs no more than rounding."""
    assert find_unit("deg", Dimension.ANGLE).si(degrees) == pytest.approx(math.radians(degrees), rel=1e-15, abs=1e-300)
