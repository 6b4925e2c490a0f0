import math

import pytest
from hypothesis import given, strategies as st

from dh2urdf.manipulator import LinkGeometry
from dh2urdf.quantities import UNITS, Dimension, evaluate, number_in
from dh2urdf.rotations import RigidTransform
from dh2urdf.table_text import TableText
from dh2urdf.table_text.texts import transform_text, yaml_word

FINITE = st.floats(-1e6, 1e6, allow_subnormal=False)


@given(FINITE, st.sampled_from(["m", "cm", "mm", "rad"]))
def test_a_number_reads_back_to_the_same_double(value: float, unit: str) -> None:
    """In metres, their decimal parts and radians, the text of a value loses no bit."""
    assert evaluate(number_in(value, UNITS[unit]), UNITS[unit].dimension, UNITS[unit]).value == value


@given(FINITE)
def test_degrees_read_back_to_a_rounding(value: float) -> None:
    """Degrees are rounded once more; no double of degrees may mean the very same radians."""
    read = evaluate(number_in(value, UNITS["deg"]), UNITS["deg"].dimension, UNITS["deg"]).value
    assert math.isclose(read, value, rel_tol=4e-16)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (math.pi / 2, "rad", "pi/2"),
        (3 * math.pi / 4, "rad", "3*pi/4"),
        (-math.pi / 6, "rad", "-pi/6"),
        (1.5708, "rad", "1.5708"),
        (-0.0, "m", "0"),
        (math.radians(-12.5), "deg", "-12.5"),
        (0.10915, "mm", "109.15"),
        (1e-9, "m", "0.000000001"),
    ],
)
def test_numbers_are_written_as_people_write_them(value: float, unit: str, text: str) -> None:
    """Multiples of π by name, whole degrees, decimal points that are only moved."""
    assert number_in(value, UNITS[unit]) == text


def test_a_transform_says_what_is_not_zero() -> None:
    """The identity is no text; what else is said of the base is beside it."""
    m, rad = UNITS["m"], UNITS["rad"]
    assert transform_text(RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0)), m, rad) == ""
    assert transform_text(RigidTransform.from_xyz_rpy((0.0, 0.0, 0.3)), m, rad) == "{xyz: [0, 0, 0.3]}"
    turned = RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0), (0.0, 0.0, math.pi))
    body = {"mass": 4.0, "geometry": LinkGeometry(shape="box", radius=0.1)}
    assert transform_text(turned, m, rad, **body) == ("{rpy: [0, 0, pi], mass: 4, geometry: {shape: box, radius: 0.1}}")


@pytest.mark.parametrize("short", [0.0, 3e-9, 1e-8, 3.6732051e-6, 1e-4])
@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("roll", "yaw"), [(0.0, 0.0), (0.3, 0.0), (0.0, 0.5), (0.1, 0.5)])
def test_near_a_pitch_of_a_quarter_turn_zeros_are_written(side: float, short: float, roll: float, yaw: float) -> None:
    """Such as rpy="0 1.5708 0": the angles of the rotation alone were 1.85e-08, 1.570796324, 1.85e-08."""
    turned = RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0), (roll, side * round(math.pi / 2 - short, 10), yaw))
    text = transform_text(turned, UNITS["m"], UNITS["rad"])
    angles = (
        [evaluate(word, Dimension.ANGLE).value for word in text.removeprefix("{rpy: [")[:-2].split(",")] if text else []
    )
    assert RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0), tuple(angles or (0.0, 0.0, 0.0))) == turned
    assert max(len(word.strip()) for word in text[7:-2].split(",")) <= len("-1.570796326795")
    if short and roll * yaw == 0.0:
        assert text.count("0,") + text.count("0]") >= 1


def test_columns_are_those_in_use() -> None:
    """A column for every field that a row says anything of, and for those that no table may lack."""
    assert TableText().columns() == ("a", "alpha", "d")
    assert TableText(rows=({"joint": "x", "mass": "3"},)).columns() == ("joint", "a", "alpha", "d", "mass")


@pytest.mark.parametrize("word", ["", "a: b", "#1", "null", "True", "x ", "[0]", "~", "-", "- a", "a, b", "{x}"])
def test_a_word_that_means_something_else_is_quoted(word: str) -> None:
    """What YAML would take for something else than the text is in quotes."""
    assert yaml_word(word) != word
