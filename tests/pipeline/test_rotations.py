import math
from collections.abc import Sequence
from itertools import product

import numpy as np
import pytest
from hypothesis import given, strategies as st
from numpy.typing import NDArray

from dh2urdf.rotations import (
    HALF_PI,
    IDENTITY,
    IDENTITY_ROTATION,
    RigidTransform,
    Rotation,
    Vec3,
    add,
    cos_sin,
    exact_cos_sin,
    multiply,
    norm,
    quarter_turns,
    quaternion_from_rotation,
    rotate,
    rotation_from_quaternion,
    rotation_from_rpy,
    rounded_quarter_turn,
    rpy_from_rotation,
    scale,
    subtract,
    transpose,
)

EXACT = 1e-15
"""Rounding of a few operations on numbers up to 1."""
MADE_QUARTER_TURNS = 1e-14
"""Angles within 1e-15 of quarter turns, relatively, are made ones: 3e-15 rad at π, three times."""


# The oracle: the same product of three turns in extended precision, as numpy multiplies it.


def turned(rpy: Sequence[float]) -> NDArray[np.longdouble]:
    roll, pitch, yaw = (np.longdouble(angle) for angle in rpy)
    one, nil = np.longdouble(1), np.longdouble(0)
    cr, sr, cp, sp, cy, sy = (f(angle) for angle in (roll, pitch, yaw) for f in (np.cos, np.sin))
    x = np.array([[one, nil, nil], [nil, cr, -sr], [nil, sr, cr]])
    y = np.array([[cp, nil, sp], [nil, one, nil], [-sp, nil, cp]])
    z = np.array([[cy, -sy, nil], [sy, cy, nil], [nil, nil, one]])
    return z @ y @ x


def matrix(rotation: Rotation) -> NDArray[np.longdouble]:
    return np.array(rotation, dtype=np.longdouble).reshape(3, 3)


angles = st.floats(-math.pi, math.pi) | st.sampled_from([k * HALF_PI for k in range(-4, 5)])
near_zero = st.sampled_from([0.0, 1e-17, -1e-16, 1e-12, -1e-9, 1e-8, 1e-5])
singular = st.builds(lambda sign, distance: sign * HALF_PI + distance, st.sampled_from([1, -1]), near_zero)
vectors = st.tuples(*[st.floats(-10, 10)] * 3)


@given(angles, angles | singular, angles)
def test_rpy_and_back_is_the_same_rotation(roll: float, pitch: float, yaw: float) -> None:
    """At every pitch, ±π/2 and its neighbourhood included, nothing is lost but rounding."""
    rotation = rotation_from_rpy((roll, pitch, yaw))
    again = turned(rpy_from_rotation(rotation))
    assert abs(again - matrix(rotation)).max() <= EXACT


@given(vectors, angles, angles, angles)
def test_the_inverse_leads_back(xyz: tuple[float, float, float], roll: float, pitch: float, yaw: float) -> None:
    """A transform and its inverse, in either order, are the identity within rounding."""
    there = RigidTransform.from_xyz_rpy(xyz, (roll, pitch, yaw))
    for round_trip in (there @ there.inverse, there.inverse @ there):
        assert abs(matrix(round_trip.rotation) - np.eye(3)).max() <= EXACT
        assert max(map(abs, round_trip.translation)) <= 1e-13


@given(angles, angles | singular, angles)
def test_a_rotation_of_rpy_is_the_product_of_three_turns(roll: float, pitch: float, yaw: float) -> None:
    """Rz(yaw)·Ry(pitch)·Rx(roll), about fixed axes."""
    difference = turned((roll, pitch, yaw)) - matrix(rotation_from_rpy((roll, pitch, yaw)))
    assert abs(difference).max() <= MADE_QUARTER_TURNS


@pytest.mark.parametrize("turns", list(product(range(-2, 3), repeat=3)))
def test_quarter_turns_have_whole_numbers(turns: tuple[int, int, int]) -> None:
    """All elements are -1, 0 or 1, rpy consists of multiples of π/2, and there is no -0.0."""
    roll, pitch, yaw = (k * HALF_PI for k in turns)
    rotation = rotation_from_rpy((roll, pitch, yaw))
    assert set(rotation) <= {-1.0, 0.0, 1.0}
    rpy = rpy_from_rotation(rotation)
    assert all(angle / HALF_PI in range(-2, 3) for angle in rpy)
    assert all(math.copysign(1, angle) == 1 for angle in rpy if angle == 0)
    assert rotation_from_rpy(rpy) == rotation


@pytest.mark.parametrize("zero", [0.0, -0.0])
def test_the_sign_of_a_zero_turns_nothing(zero: float) -> None:
    """atan2 tells 0.0 from -0.0; a rotation does not."""
    rotation = (zero, zero, -1.0, zero, 1.0, zero, 1.0, zero, zero)
    assert rpy_from_rotation(rotation) == (0.0, -HALF_PI, 0.0)


@pytest.mark.parametrize(
    ("angle", "turns"),
    [(0.0, 0), (math.pi, 2), (-3 * math.pi / 2, -3), (math.nextafter(HALF_PI, 2), 1), (1e6 * HALF_PI, 1000000)],
)
def test_a_multiple_of_a_quarter_turn_is_known_as_one(angle: float, turns: int) -> None:
    """Up to the rounding of its computation."""
    assert quarter_turns(angle) == turns


rotations = st.builds(lambda *rpy: rotation_from_rpy(rpy), angles, angles, angles)


@given(rotations, rotations, vectors, vectors, st.floats(-3, 3))
def test_spelled_out_sums_are_the_matrix_products(
    left: Rotation, right: Rotation, u: Vec3, v: Vec3, factor: float
) -> None:
    """Product, transpose and the operations on vectors, against numpy."""
    np.testing.assert_allclose(matrix(multiply(left, right)), matrix(left) @ matrix(right), atol=EXACT)
    np.testing.assert_array_equal(matrix(transpose(left)), matrix(left).T)
    np.testing.assert_allclose(rotate(left, u), (matrix(left) @ u).astype(float), atol=1e-14)
    np.testing.assert_allclose(multiply(left, transpose(left)), IDENTITY_ROTATION, atol=EXACT)
    np.testing.assert_array_equal(add(u, v), np.add(u, v))
    np.testing.assert_array_equal(subtract(u, v), np.subtract(u, v))
    np.testing.assert_array_equal(scale(factor, u), np.multiply(factor, u))
    assert norm(u) == pytest.approx(float(np.linalg.norm(u)))


@given(vectors, st.tuples(angles, angles, angles), vectors, st.tuples(angles, angles, angles))
def test_rigid_transforms_multiply_like_their_matrices(xyz: Vec3, rpy: Vec3, other_xyz: Vec3, other_rpy: Vec3) -> None:
    """4x4, from xyz and rpy as in URDF."""
    left, right = RigidTransform.from_xyz_rpy(xyz, rpy), RigidTransform.from_xyz_rpy(other_xyz, other_rpy)
    both = left @ right
    expected = turned(rpy) @ np.array(other_xyz) + np.array(xyz)
    np.testing.assert_allclose(both.translation, expected.astype(float), atol=1e-14)
    np.testing.assert_allclose(matrix(both.rotation), turned(rpy) @ turned(other_rpy), atol=2 * EXACT)
    assert left @ IDENTITY == left
    np.testing.assert_allclose(matrix(rotation_from_rpy(left.rpy)), matrix(left.rotation), atol=EXACT)


# Columns.


many_angles = st.lists(
    st.floats(-20.0, 20.0)
    | st.sampled_from([k * HALF_PI for k in range(-9, 10)])
    | st.sampled_from([1.5708, 3.14, -0.0]),
    min_size=3,
    max_size=9,
)


@given(many_angles)
def test_the_cosines_and_sines_of_a_column_are_those_of_its_angles(angles: list[float]) -> None:
    """To the last bit: a robot is the same alone and beside others."""
    cosines, sines = exact_cos_sin(np.array(angles))
    assert list(zip(cosines.tolist(), sines.tolist(), strict=True)) == [cos_sin(angle) for angle in angles]


@given(many_angles, many_angles, st.sampled_from([0.0, HALF_PI, 0.3]))
def test_the_rotations_of_a_column_are_those_of_its_angles(rolls: list[float], yaws: list[float], pitch: float) -> None:
    """There and back, to the last bit, some of the angles the same for all."""
    columns = zip(rolls, yaws, strict=False)
    single = [rotation_from_rpy((roll, pitch, yaw)) for roll, yaw in columns]
    size = len(single)
    together = rotation_from_rpy((np.array(rolls[:size]), pitch, np.array(yaws[:size])))  # type: ignore[arg-type]
    assert list(zip(*(np.broadcast_to(element, size).tolist() for element in together), strict=True)) == single
    back = rpy_from_rotation(together)
    expected = [rpy_from_rotation(rotation) for rotation in single]
    assert list(zip(*(np.broadcast_to(angle, size).tolist() for angle in back), strict=True)) == expected


@pytest.mark.parametrize(
    ("angle", "turns"),
    [
        *((1.5708, 1), (-1.571, -1), (1.57, 1), (3.14, 2), (3.1416, 2), (4.71239, 3)),
        *((math.radians(89.9), 1), (math.radians(180.01), 2), (math.radians(-90.0001), -1)),
        *((math.pi / 2, None), (0.001, None), (1.6, None), (2.0, None), (1.0, None)),
        *((1.57195248426, None), (1.5719, None), (1.57079, 1), (1.5707, 1), (1.5705, None)),
        *((math.radians(89.95), None), (math.radians(90.0662), None), (math.radians(89.0), None)),
    ],
)
def test_an_angle_that_was_rounded_from_a_quarter_turn(angle: float, turns: int | None) -> None:
    """By its own last decimal, in radians or in degrees; what has more decimals was measured."""
    assert rounded_quarter_turn(angle) == turns


# --- Quaternions ---


@given(st.tuples(*[st.floats(-7.0, 7.0)] * 3))
def test_a_quaternion_is_that_of_scipy(rpy: Vec3) -> None:
    """Both ways, also at half turns, where w is 0; of the two quaternions always the same."""
    from scipy.spatial.transform import Rotation as Oracle

    for angles in (rpy, tuple(round(angle / HALF_PI) * HALF_PI for angle in rpy)):
        rotation = rotation_from_rpy(angles)
        quaternion = quaternion_from_rotation(rotation)
        expected = Oracle.from_matrix(np.reshape(rotation, (3, 3))).as_quat()
        assert np.abs(np.outer(quaternion, quaternion) - np.outer(expected, expected)).max() < EXACT
        first = next(part for part in (quaternion[3], *quaternion[:3]) if part)
        assert first > 0.0
        back = rotation_from_quaternion([3.0 * part for part in quaternion])
        assert np.abs(np.subtract(back, rotation)).max() < 4.0 * EXACT
