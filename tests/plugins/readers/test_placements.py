import json
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dh2urdf.manipulator import Manipulator
from dh2urdf.rotations import nearest_rotation, rotation_from_rpy

angles = st.tuples(*[st.floats(-math.pi, math.pi)] * 3)


@given(angles)
def test_a_rotation_is_its_own_nearest_rotation(rpy: tuple[float, float, float]) -> None:
    """What is orthonormal to rounding is not touched by more than rounding."""
    rotation = rotation_from_rpy(rpy)
    nearest, deviation = nearest_rotation(rotation)
    assert deviation < 1e-14
    np.testing.assert_allclose(nearest, rotation, rtol=0, atol=2e-15)


@given(angles, st.lists(st.floats(-1e-4, 1e-4), min_size=9, max_size=9))
def test_a_rounded_rotation_is_brought_to_its_polar_factor(rpy: tuple[float, float, float], noise: list[float]) -> None:
    """The nearest rotation in the Frobenius norm, as singular values give it."""
    given_matrix = np.array(rotation_from_rpy(rpy)) + noise
    nearest, _ = nearest_rotation(tuple(given_matrix))
    left, _, right = np.linalg.svd(given_matrix.reshape(3, 3))
    np.testing.assert_allclose(np.reshape(nearest, (3, 3)), left @ right, rtol=0, atol=1e-14)


def test_a_mirror_is_far_from_any_rotation() -> None:
    """Its columns are orthonormal, and yet it is none."""
    assert nearest_rotation((1, 0, 0, 0, 1, 0, 0, 0, -1))[1] >= 2


def test_rounding_of_quarter_turns_is_taken_off(read_one: Callable[..., Manipulator]) -> None:
    """6.1e-17 is 0, as in the matrices that libraries print."""
    matrix = [[6.123233995736766e-17, -1.0, 0, 0.1], [1.0, 6.123233995736766e-17, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    arm = read_one(f"base: {json.dumps(matrix)}\njoints: [{{a: 0, alpha: 0, d: 1}}]", ".yaml")
    assert arm.base.rotation == (0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    assert arm.notices == ()


def test_elements_of_a_matrix_may_be_expressions(read_one: Callable[..., Manipulator]) -> None:
    """cos(30 deg) has all its digits; the translation may have a unit."""
    rows = "[[cos(30 deg), -1/2, 0, 100 mm], [1/2, sqrt(3)/2, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]"
    arm = read_one(f"tool: {rows}\njoints: [{{a: 0, alpha: 0, d: 1}}]", ".yaml")
    assert arm.tool.rotation[:2] == pytest.approx((math.cos(math.pi / 6), -0.5), abs=1e-15)
    assert (arm.tool.translation, arm.notices) == ((0.1, 0.0, 0.0), ())
