import math
import re
from fractions import Fraction
from typing import Any

import pytest

from dh2urdf.quantities import UNITS, Dimension, QuantityError, evaluate, find_unit

INCH, POUND, GRAVITY = Fraction("0.0254"), Fraction("0.45359237"), Fraction("9.80665")
"""By definition, in m, kg and m/s²."""
PER_TIME = (("m", "1"), ("cm", "0.01"), ("mm", "0.001"), ("µm", "1e-6"), ("in", INCH), ("ft", 12 * INCH))
TIMES = (("s", 1), ("min", 60))
EXACT = {
    Dimension.LENGTH: {
        "m": "1",
        "cm": "0.01",
        "mm": "0.001",
        "µm": "1e-6",
        "nm": "1e-9",
        "in": INCH,
        "inch": INCH,
        "ft": 12 * INCH,
        "mil": INCH / 1000,
    },
    Dimension.ACCELERATION: {
        **dict.fromkeys(("m/s²", "m/s^2", "m/sec²", "m/s/s", "m/s2"), "1"),
        "cm/s²": "0.01",
        **dict.fromkeys(("mm/s²", "mm·s⁻²"), "0.001"),
        "µm/s²": "1e-6",
        "in/s²": INCH,
        "ft/s²": 12 * INCH,
    },
    Dimension.TURN_ACCELERATION: {"rad/s²": "1", "radians/s²": "1", "rad/s/s": "1", "rad·s⁻²": "1"},
    Dimension.JERK: {
        **dict.fromkeys(("m/s³", "m/s^3", "m·s⁻³"), "1"),
        "cm/s³": "0.01",
        "mm/s³": "0.001",
        "µm/s³": "1e-6",
        "in/s³": INCH,
        "ft/s³": 12 * INCH,
    },
    Dimension.TURN_JERK: {"rad/s³": "1", "rad/s^3": "1"},
    Dimension.SPEED: {
        "mm per second": "0.001",
        "mm·s⁻¹": "0.001",
        **{f"{word}/{time}": Fraction(length) / seconds for word, length in PER_TIME for time, seconds in TIMES},
    },
    Dimension.ANGLE: {"rad": "1", "radians": "1"},
    Dimension.TURN_RATE: {"rad/s": "1", "rad/min": "1/60"},
    Dimension.MASS: {
        "kg": "1",
        "g": "0.001",
        "t": "1000",
        "lb": POUND,
        "oz": POUND / 16,
        "slug": POUND * GRAVITY / (12 * INCH),
    },
    Dimension.FORCE: {
        "N": "1",
        "kN": "1000",
        "mN": "0.001",
        "lbf": POUND * GRAVITY,
        "lb": POUND * GRAVITY,
        "kgf": GRAVITY,
        "ozf": POUND / 16 * GRAVITY,
        "oz": POUND / 16 * GRAVITY,
    },
    Dimension.TORQUE: {
        "Nm": "1",
        "nm": "1",
        "N-m": "1",
        "N*m": "1",
        "kNm": "1000",
        "mNm": "0.001",
        "N·mm": "0.001",
        "N·cm": "0.01",
        "kgf·cm": GRAVITY / 100,
        "kgf·m": GRAVITY,
        "lb·in": POUND * GRAVITY * INCH,
        "lbf·ft": POUND * GRAVITY * 12 * INCH,
        "ft-lb": POUND * GRAVITY * 12 * INCH,
        "oz·in": POUND / 16 * GRAVITY * INCH,
    },
    Dimension.INERTIA: {
        "kg·m²": "1",
        "kgm2": "1",
        "kg·cm²": "1e-4",
        "kg·mm²": "1e-6",
        "g·cm²": "1e-7",
        "g·mm²": "1e-9",
        "g·m²": "0.001",
        "t·mm²": "0.001",
        "lb·in²": POUND * INCH**2,
        "lb·ft²": POUND * 144 * INCH**2,
        "oz·in²": POUND / 16 * INCH**2,
        "slug·ft²": POUND * GRAVITY * 12 * INCH,
    },
    Dimension.DAMPING: {"N·m·s/rad": "1", "Nms": "1", "N·mm·s/rad": "0.001"},
    Dimension.LINEAR_DAMPING: {"N·s/m": "1", "N·s/mm": "1000"},
    Dimension.DENSITY: {"kg/m³": "1", "g/cm³": "1000", "kg/dm^3": "1000", "g/mm³": "1e6", "lb/in³": POUND / INCH**3},
}
"""What one of each unit is in SI units, by the definitions of the units."""
QUARTERS = {
    Dimension.ANGLE: {"deg": 90, "°": 90, "degrees": 90, "rev": Fraction(1, 4), "turns": Fraction(1, 4)},
    Dimension.TURN_RATE: {
        "deg/s": 90,
        "°/s": 90,
        "deg/sec": 90,
        "°/min": 5400,
        "rev/s": Fraction(1, 4),
        "rps": Fraction(1, 4),
        **dict.fromkeys(("rpm", "1/min", "U/min", "rev/min", "r/min", "min⁻¹", "min^-1", "turns/min"), 15),
    },
    Dimension.TURN_ACCELERATION: {
        **dict.fromkeys(("deg/s²", "°/s²", "deg/s^2", "degrees/s²", "deg/s/s", "deg/sec²", "°·s⁻²"), 90),
        **dict.fromkeys(("rev/s²", "turns/s²"), Fraction(1, 4)),
    },
    Dimension.TURN_JERK: {
        **dict.fromkeys(("deg/s³", "°/s³", "deg/s^3"), 90),
        **dict.fromkeys(("rev/s³", "turns/s³"), Fraction(1, 4)),
    },
}
"""How many of each a quarter turn has, or a quarter turn per second, s² or s³."""


@pytest.mark.parametrize(
    ("word", "dimension", "symbol"),
    [
        ("millimetres", Dimension.LENGTH, "mm"),
        ("\N{GREEK SMALL LETTER MU}m", Dimension.LENGTH, "µm"),
        ("º", Dimension.ANGLE, "deg"),
        ("˚", Dimension.ANGLE, "deg"),
        ("\N{WHITE BULLET}", Dimension.ANGLE, "deg"),  # of LaTeX, as PDF viewers copy it
        ("\N{RING OPERATOR}/s", Dimension.TURN_RATE, "deg/s"),
        ("rad/sec", Dimension.TURN_RATE, "rad/s"),
        ("N m", Dimension.EFFORT, "Nm"),
        ("kg m^2", Dimension.INERTIA, "kg·m²"),
    ],
)
def test_a_unit_is_known_by_its_usual_words(word: str, dimension: Dimension, symbol: str) -> None:
    """Case, spaces and signs of multiplication do not matter."""
    assert find_unit(word, dimension).symbol == symbol


def words_of(table: dict[Dimension, dict[str, Any]]) -> list[Any]:
    return [
        pytest.param(word, dimension, amount, id=f"{word} as {dimension}")
        for dimension, words in table.items()
        for word, amount in words.items()
    ]


NUMBERS = ["1", "-0.1", "12.7", "109.15", "0.3333333333333333", "1e3", "-2.5e-7", "123456789.987654321", ".5", "7."]


@pytest.mark.parametrize(("word", "dimension", "factor"), words_of(EXACT))
def test_a_number_of_a_unit_is_the_double_nearest_to_its_value(
    word: str, dimension: Dimension, factor: Fraction | str
) -> None:
    """As exact fractions have it: declared for the number, and as its own unit where it is no name of several words."""
    unit = find_unit(word, dimension)
    for number in NUMBERS:
        exact = float(Fraction(number) * Fraction(factor))
        assert evaluate(number, dimension, unit).value == exact
        if not re.search("per|⁻", word):
            said = evaluate(f"{number} {word}", dimension)
            assert (said.value, said.has_unit) == (exact, True)


@pytest.mark.parametrize(("word", "dimension", "parts"), words_of(QUARTERS))
def test_a_part_of_a_turn_is_right_to_the_last_digits(word: str, dimension: Dimension, parts: Fraction) -> None:
    """Whole quarter turns are the multiples of the double π/2; all else is right to two roundings."""
    unit = find_unit(word, dimension)
    quarter = Fraction("1.5707963267948966192313216916397514420985846996875529")
    for number in NUMBERS:
        found = evaluate(number, dimension, unit).value
        exact = Fraction(number) / parts * quarter
        assert abs(Fraction(found) - exact) <= 2 * Fraction(math.ulp(found))
    for turns in range(-8, 9):
        number = Fraction(turns) * parts
        assert evaluate(str(float(number)), dimension, unit).value == turns * (math.pi / 2)


def test_no_unit_goes_without_its_definition_here() -> None:
    """Every unit that has a word is in one of the two tables, and no two are called alike."""
    tried = {find_unit(word, each).symbol for table in (EXACT, QUARTERS) for each in table for word in table[each]}
    assert {unit.symbol for unit in UNITS.values()} <= tried
    assert len({unit.symbol for unit in UNITS.values()}) == len(set(UNITS.values()))


@pytest.mark.parametrize(
    ("dimension", "words"),
    [
        (Dimension.LENGTH, "Nm"),
        (Dimension.TORQUE, "N MNm"),
        (Dimension.FORCE, "Nm kg MN"),
        (Dimension.DAMPING, "N·s/m"),
        (Dimension.ANGLE, "mm gon Grad ″ ' "),
        (Dimension.TURN_RATE, "1/s Hz deg/s² rad/s/s"),
    ],
)
def test_a_word_that_is_another_unit_or_none_is_refused(dimension: Dimension, words: str) -> None:
    """As the unit declared for a number, and behind it."""
    for word in words.split():
        with pytest.raises(QuantityError):
            find_unit(word, dimension)
        with pytest.raises(QuantityError):
            evaluate(f"2 {word}", dimension)


@pytest.mark.parametrize("text", ["1 m m", "1 c m", "1 c m/s", "1 d e g", "1 m m/s", "1 mm mm", "2 N m m"])
def test_letters_with_spaces_between_them_are_no_unit(text: str) -> None:
    """Only units of several words have spaces: `N m`, `kg m^2`."""
    for dimension in (Dimension.LENGTH, Dimension.SPEED, Dimension.ANGLE, Dimension.TORQUE):
        with pytest.raises(QuantityError):
            evaluate(text, dimension)


@pytest.mark.parametrize("word", ["m·m", "m*m", "c.m", "k g", "de*g", "N·m·m", "lb*s", "ra·d/s", "g m·m²", "gm·m^2"])
def test_a_sign_of_multiplication_within_a_factor_makes_no_unit(word: str) -> None:
    """`m·m` is an area, and not mm; where it is between the factors, it does not matter."""
    for dimension in (Dimension.LENGTH, Dimension.ANGLE, Dimension.MASS, Dimension.TORQUE, Dimension.INERTIA):
        with pytest.raises(QuantityError):
            find_unit(word, dimension)
        with pytest.raises(QuantityError):
            evaluate(f"1 {word}", dimension)


@pytest.mark.parametrize("text", ["1e308 t", "-1e308 slug", "1e999999999999999999 in"])
def test_a_number_beyond_all_doubles_is_refused(text: str) -> None:
    """At once, however large its exponent is."""
    with pytest.raises(QuantityError, match="beyond the largest number"):
        evaluate(text, Dimension.LENGTH if text.endswith("in") else Dimension.MASS)
    with pytest.raises(QuantityError, match="below the smallest number"):
        evaluate("1e-999999999999999999 in", Dimension.LENGTH)
    assert evaluate("4e-320 in", Dimension.LENGTH).value == float(Fraction("4e-320") * INCH)


@pytest.mark.parametrize(
    ("word", "dimension", "advice"),
    [
        ("gon", Dimension.ANGLE, "1 gon is 0.9 deg"),
        ("″", Dimension.LENGTH, "write in, ft or deg"),
        ("1/s", Dimension.TURN_RATE, "whichever it is"),
        ("ton", Dimension.MASS, "write t for 1000 kg"),
        ("Grad", Dimension.ANGLE, "write deg for degrees"),
        ("π rad", Dimension.ANGLE, r"0\.5\*pi"),
    ],
)
def test_a_unit_of_other_people_comes_with_advice(word: str, dimension: Dimension, advice: str) -> None:
    """The nearest known word would mislead: `Grad` is a degree in German, and no rad."""
    with pytest.raises(QuantityError) as refused:
        find_unit(word, dimension)
    assert re.search(advice, refused.value.suggestion or "")
