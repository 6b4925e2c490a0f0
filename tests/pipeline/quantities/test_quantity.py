import contextlib
import math

import pytest
from hypothesis import given, strategies as st

from dh2urdf.quantities import Dimension, QuantityError, Unit, evaluate, find_unit

ANGLE, LENGTH = Dimension.ANGLE, Dimension.LENGTH
DEGREES, MILLIMETRES = find_unit("deg", ANGLE), find_unit("mm", LENGTH)


@pytest.mark.parametrize(
    ("text", "dimension", "unit", "value"),
    [
        ("0.3", LENGTH, None, 0.3),
        ("+3e-1", LENGTH, None, 0.3),
        ("-425 mm", LENGTH, None, -0.425),
        ("1e3mm", LENGTH, None, 1.0),
        ("1e308-pi", LENGTH, None, 1e308),
        ("0.10915 m", LENGTH, MILLIMETRES, 0.10915),
        ("90", ANGLE, DEGREES, math.pi / 2),
        ("90\N{WHITE BULLET}", ANGLE, None, math.pi / 2),
        ("−90 \N{RING OPERATOR}", ANGLE, None, -math.pi / 2),
        ("−π/2", ANGLE, None, -math.pi / 2),  # U+2212
        ("–π/2", ANGLE, None, -math.pi / 2),  # U+2013: what PDF copies make of a minus
        ("np.pi/2", ANGLE, None, math.pi / 2),
        ("-M_PI/2", ANGLE, None, -math.pi / 2),
        ("PI()/2", ANGLE, None, math.pi / 2),
        ("2 × π", ANGLE, None, 2 * math.pi),
        ("pi/2 rad", ANGLE, DEGREES, math.pi / 2),
        ("2pi", ANGLE, None, 2 * math.pi),
        ("2π/3", ANGLE, None, 2 * math.pi / 3),
        ("-3 pi/2", ANGLE, None, -3 * math.pi / 2),
        ("2*45 deg", ANGLE, None, math.pi / 2),
        ("atan2(1, 1)", ANGLE, DEGREES, math.pi / 4),
        ("np.deg2rad(90)", ANGLE, None, math.pi / 2),
        ("sqrt(2)/10", LENGTH, None, math.sqrt(2) / 10),
        ("0.3*sin(pi)", LENGTH, None, 0.0),
        ("100 mm + 2 cm", LENGTH, None, 0.1 + 0.02),
        ("0.1 - -0.02", LENGTH, None, 0.1 + 0.02),
        ("(1 - 0.5)*(2 + 2)", LENGTH, None, 2.0),
        ("(425 mm)/(1000 mm)", Dimension.NUMBER, None, 0.425),
        ("1.57079632679489661923132169163975144209858", ANGLE, None, math.pi / 2),
    ],
)
def test_a_quantity_means_its_value_in_si_units(
    text: str, dimension: Dimension, unit: Unit | None, value: float
) -> None:
    """Numbers, units and expressions as tables have them."""
    assert evaluate(text, dimension, unit).value == value


def test_a_comma_may_be_the_decimal_point_where_the_table_says_so() -> None:
    """European spreadsheets write 0,425."""
    assert evaluate("-0,425", LENGTH, decimal_comma=True).value == -0.425
    assert evaluate("1,5 + 0,5", LENGTH, decimal_comma=True).value == 2.0
    with pytest.raises(QuantityError):
        evaluate("0,425", LENGTH)


@pytest.mark.parametrize(
    ("text", "kind", "row", "value", "sign"),
    [
        ("q", "q", None, 0.0, 1),
        ("θ₂", "theta", 2, 0.0, 1),
        (r"\theta_{2}", "theta", 2, 0.0, 1),
        ("theta_i", "theta", None, 0.0, 1),
        ("theta2* + pi/2", "theta", 2, math.pi / 2, 1),
        ("q2 + 90°", "q", 2, math.pi / 2, 1),
        ("-q2", "q", 2, 0.0, -1),
        ("pi/2 - q2", "q", 2, math.pi / 2, -1),
        ("theta2* - 90°", "theta", 2, -math.pi / 2, 1),
        ("q2*(-1)", "q", 2, 0.0, -1),
        ("-1*q2", "q", 2, 0.0, -1),
    ],
)
def test_a_symbol_is_the_joint_variable(text: str, kind: str, row: int | None, value: float, sign: int) -> None:
    """What is added to it is the offset, a minus before it is the sign."""
    quantity = evaluate(text, ANGLE)
    assert quantity.variable is not None
    assert (quantity.variable.kind, quantity.variable.row, quantity.value, quantity.sign) == (kind, row, value, sign)


DATES = (
    *("3-4", "3–4", "10-12", "1/2/3", "12/31/24", "1.2.2024", "31.12.24", "1.2.", "2024-01", "2024-01-03 12:30:00"),
    *("Jan 3", "3-Jan", "03-Apr", "Apr-03", "3. Mai", "Mrz 24", "5-janv.", "12:30", "1:30 PM"),
)
POWERS = ("3×10-3", "1.2*10−3", "-2,5 × 10-4", "1.2×10-3 m", "5*10 -3", "3×10+2")
RANGES = ("0.3–0.5", "0.3 – 0.5", "0.3-0.5", "0,3−0,5", "0.25 m-0.5 m", "100-500 mm", "0-0.5", "90-180")
PAIRS = ("90/-90", "-90/+90", "90°/-90°", "0/90", "0⁄0.5")
STARS = ("q1*-1", "q1 *-1", "q1* -1", "q1* - 1", "q1*+1", "q*-1.0", "-q1*-1", "pi/2+q1*-1", "(q1*-1)", "q1*-3", "θ1∗-1")


SLIPS = (
    *("", "-", "5 -", "5-", "abc", "true", "0. 425", "1 234", "1\u202f234", "1.2.3.4", "1'234.5", "1_000", "1 1/2"),
    *(
        "--0.5",
        "+-170",
        "±170",
        "1/2π",
        "L1 + a2",
        "12 el",
        "0.1 m + 20",
        "2 m * 2 m",
        "90 deg",
        "50 %",
        "$425",
        "90°30'",
    ),
    *("2*q1", "q1*q1", "q1 - q1", "1/q1", "q1 m", "(1", "1)", "1/0", "1e400", "1e308*10"),
    *("sqrt(-1)", "sqrt(1, 2)", "sqrt(0.1 m)", "sqrt(q1)", "tan(pi/2)", "tan(45)", "asin(2)", "atan2(0, 0)", "sin"),
    *("radians(60 deg)", "radians(pi/2)", "pi/2", "-π", "2*pi", "pi*0.25", "d3 + pi/2", "PI()/6"),
    *("(425)", "( 1.5 )", "(425 mm)", "(425) mm", "(1e3)", "2020-01-02", "1/2/2021", "01-02-21"),
)
NO_NUMBERS = (
    *("０．４２５", "٣", "½", "1½", "5²", "10⁻³", "0x10", "nan", "-inf", "7 % 0", "9**9**9", "2^9", "1<<9"),
    *("pi.real", "(1).real", "__import__('os').system('x')", "factorial(9)"),
)


@pytest.mark.parametrize("text", [*SLIPS, *NO_NUMBERS, *DATES, *POWERS, *RANGES, *PAIRS, *STARS])
def test_what_is_no_length_is_refused(text: str) -> None:
    """Attacks, slips of the pen, two meanings and forms of other languages: never half read, never evaluated."""
    with pytest.raises(QuantityError):
        evaluate(text, LENGTH)


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("3 - 4", -1.0),
        ("1 / 2 / 4", 0.125),
        ("0.5–0.3", 0.5 - 0.3),
        ("3×10-0.3", 29.7),
        ("0.9/-0.3", 0.9 / -0.3),
        ("2*pi*0.05", 2 * math.pi * 0.05),
        ("pi/2 m", math.pi / 2),
        *(("0.3 / 0.4", 0.3 / 0.4), ("425/2", 212.5), ("25/32", 25 / 32), ("0.5/3", 0.5 / 3), ("300/1000", 0.3)),
        *(("7387/2540", 7387 / 2540), ("10.0/25.4", 10 / 25.4), ("-4291/3048", -4291 / 3048)),  # inches and feet
        ("-(425)", -425.0),
        ("(0.0)", 0.0),
    ],
)
def test_what_has_one_meaning_is_read(text: str, value: float) -> None:
    """Beside dates, negative numbers of accountants and the like."""
    assert evaluate(text, LENGTH).value == value


@pytest.mark.parametrize("angle", ["sin(60)", "cos(-30)", "tan(0.5)", "np.cos(90 - 45)"])
def test_a_bare_angle_of_a_function_is_refused_beside_degrees(angle: str) -> None:
    """It is degrees to one person, and radians to the function."""
    for unit in (None, MILLIMETRES):
        with pytest.raises(QuantityError):
            evaluate(f"100*{angle}", LENGTH, unit, angle=DEGREES)
    with pytest.raises(QuantityError):
        evaluate(angle, ANGLE, DEGREES)


@pytest.mark.parametrize(
    "text", ["cos(0)", "cos(60 deg)", "sin(pi/6)", "cos(radians(60))", "cos(acos(0.5))", "cos(1 rad)"]
)
def test_an_angle_that_says_its_unit_is_the_same_beside_degrees(text: str) -> None:
    """A unit, π, a function that returns an angle, or 0."""
    assert evaluate(text, LENGTH, angle=DEGREES) == evaluate(text, LENGTH)


def test_a_bare_angle_of_a_function_is_in_rad_where_nothing_else_is_said() -> None:
    """Up to a full turn; more is read where radians are declared."""
    assert evaluate("cos(6.28)", LENGTH).value == pytest.approx(math.cos(6.28), abs=1e-15)
    assert evaluate("cos(60)", LENGTH, angle=find_unit("rad", ANGLE)).value == pytest.approx(math.cos(60), abs=1e-15)


@pytest.mark.parametrize(
    "text", ["(" * 10_000, "-" * 999 + "1", "sqrt(" * 200, "1+" * 499 + "1x", "9" * 1001, "((1)+" * 199, "q" * 999]
)
def test_an_expression_cannot_cost_more_than_its_bounds(text: str) -> None:
    """Length and nesting are bounded, so that there is no recursion to exhaust."""
    with pytest.raises(QuantityError):
        evaluate(text, LENGTH)


def test_a_thousand_characters_of_sums_are_read() -> None:
    """A person does not meet the bounds."""
    assert evaluate("+".join(["1"] * 500), LENGTH).value == 500
    assert evaluate("(" * 30 + "1" + ")" * 30, LENGTH).value == 1


numbers = st.one_of(st.integers(0, 1000).map(str), st.floats(0.001, 1000).map(repr))
expressions = st.recursive(
    numbers,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*"), inner).map(lambda parts: f"({parts[0]} {parts[1]} {parts[2]})"),
        st.tuples(inner, numbers).map(lambda parts: f"{parts[0]} / {parts[1]}" if float(parts[1]) else parts[0]),
        inner.map(lambda text: f"(-{text})" if text[0] != "-" else text),
    ),
    max_leaves=8,
)


@given(expressions)
def test_arithmetic_is_that_of_python(text: str) -> None:
    """The grammar gives precedence and grouping their usual meaning."""
    assert evaluate(text, LENGTH).value == eval(text)  # noqa: S307 - arithmetic that the strategy wrote


@given(st.text(max_size=40) | st.text("0123456789.,+-*/()eE piqdmrad°θπ", max_size=40))
def test_any_text_is_a_quantity_or_an_error(text: str) -> None:
    """No other exception, whatever is typed; and what is read is finite."""
    for dimension in (LENGTH, ANGLE):
        for comma in (False, True):
            with contextlib.suppress(QuantityError):
                assert math.isfinite(evaluate(text, dimension, decimal_comma=comma).value)
