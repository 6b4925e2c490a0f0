"""Every rigid transform is Z·S·Z, and the numbers of a table are what they were meant to be."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dh2urdf.rotations import RigidTransform
from dh2urdf_plugins.descriptions.description import part_of_pi
from dh2urdf_plugins.extraction.chain import (
    LinkScrews,
    Precision,
    between_decimals,
    decimal_of,
    decompose,
    turn_of_z,
    x_screw,
    z_screw,
)

ANGLES = st.one_of(
    st.floats(-math.pi, math.pi),
    st.integers(-4, 4).map(lambda number: number * math.pi / 4),
    st.builds(lambda number, small: number * math.pi / 2 + small, st.integers(-2, 2), st.floats(-1e-6, 1e-6)),
)
LENGTHS = st.one_of(st.just(0.0), st.floats(-2, 2), st.integers(-2000, 2000).map(lambda number: number / 1000))
EXACT = Precision(0.0, 0.0)


def matrix(pose: RigidTransform) -> np.ndarray:
    """A homogeneous matrix."""
    result = np.eye(4)
    result[:3, :3] = np.reshape(pose.rotation, (3, 3))
    result[:3, 3] = pose.translation
    return result


def product(screws: LinkScrews) -> np.ndarray:
    """The product of the three screws, in numpy."""
    first, middle, last = z_screw(screws.phi, screws.b), x_screw(screws.a, screws.alpha), z_screw(screws.psi, screws.e)
    return matrix(first) @ matrix(middle) @ matrix(last)


class TestDecompose:
    @given(rpy=st.tuples(ANGLES, ANGLES, ANGLES), xyz=st.tuples(LENGTHS, LENGTHS, LENGTHS))
    def test_any_transform_is_the_product_of_its_screws(
        self, rpy: tuple[float, float, float], xyz: tuple[float, float, float]
    ) -> None:
        """To rounding, where the common normal is at hand and where it is far away."""
        pose = RigidTransform.from_xyz_rpy(xyz, rpy)
        screws = decompose(pose, Precision(1e-13, 1e-13))
        far = max(1.0, abs(screws.b), abs(screws.e))
        assert np.abs(product(screws) - matrix(pose)).max() < 2e-12 + 1e-15 * far

    @given(rpy=st.tuples(ANGLES, ANGLES, ANGLES), xyz=st.tuples(LENGTHS, LENGTHS, LENGTHS))
    def test_the_normal_may_point_the_other_way(
        self, rpy: tuple[float, float, float], xyz: tuple[float, float, float]
    ) -> None:
        screws = decompose(RigidTransform.from_xyz_rpy(xyz, rpy), EXACT)
        far = max(1.0, abs(screws.b), abs(screws.e))
        assert np.abs(product(screws) - product(screws.flipped)).max() < 4e-15 * far
        assert (screws.flipped.a, screws.flipped.alpha) == (
            (-screws.a, -screws.alpha) if screws.parallel != -1 else (-screws.a, math.pi)
        )

    @pytest.mark.parametrize(
        ("rpy", "xyz", "parallel", "collinear"),
        [
            ((0, 0, 0.3), (0, 0, 1), 1, True),
            ((math.pi, 0, 0.3), (0, 0, 1), -1, True),
            ((0, 0, 0.3), (0.2, 0, 1), 1, False),
            ((math.pi, 0, 0), (0.2, 0.1, 1), -1, False),
            ((math.pi / 2, 0, 0), (0, 0, 1), 0, False),
        ],
    )
    def test_degenerate_cases_are_told_apart(
        self, *, rpy: tuple[float, float, float], xyz: tuple[float, float, float], parallel: int, collinear: bool
    ) -> None:
        screws = decompose(RigidTransform.from_xyz_rpy(xyz, rpy), EXACT)
        assert (screws.parallel, screws.is_collinear) == (parallel, collinear)


class TestTurnOfZ:
    @given(st.tuples(st.floats(-1, 1), st.floats(-1, 1), st.floats(-1, 1)).filter(lambda axis: math.hypot(*axis) > 0.1))
    def test_it_takes_z_to_the_axis(self, axis: tuple[float, float, float]) -> None:
        rotation = np.reshape(turn_of_z(axis), (3, 3))
        assert np.abs(rotation @ rotation.T - np.eye(3)).max() < 1e-14
        assert np.linalg.det(rotation) > 0
        assert np.abs(rotation[:, 2] - np.array(axis) / math.hypot(*axis)).max() < 1e-15

    @pytest.mark.parametrize("axis", [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)])
    def test_along_the_axes_it_is_exact(self, axis: tuple[float, float, float]) -> None:
        rotation = turn_of_z(axis)
        assert set(rotation) <= {-1.0, 0.0, 1.0}
        assert (rotation[2], rotation[5], rotation[8]) == axis


class TestNumbers:
    @given(st.floats(-1000, 1000), st.floats(1e-12, 1e-2))
    def test_a_decimal_is_within_the_tolerance_and_stays(self, value: float, tolerance: float) -> None:
        step = between_decimals(tolerance)
        written = decimal_of(value, step)
        assert abs(written - value) <= step * (1 + 1e-9)
        assert decimal_of(written, step) == written

    @pytest.mark.parametrize(
        ("value", "written"),
        [(0.10915000000000001, 0.10915), (-0.4249999999999, -0.425), (1e-11, 0.0), (0.123456789, 0.123456789)],
    )
    def test_it_is_the_shortest(self, value: float, written: float) -> None:
        assert decimal_of(value, 2.5e-10) == written

    @pytest.mark.parametrize("part", [2, 4, 6])
    def test_angles_are_parts_of_pi(self, part: int) -> None:
        precision = Precision.of(1e-9, 1.0)
        for number in range(-part, part + 1):
            exact = number * math.pi / part
            wanted = exact if number != -part else math.pi
            assert precision.angle_of(exact + 1e-10) == pytest.approx(wanted, abs=0)
        assert precision.angle_of(1.5708) == 1.5708

    def test_a_coarser_tolerance_is_never_finer(self) -> None:
        steps = [between_decimals(10.0**-power) for power in range(2, 15)]
        assert steps == sorted(steps, reverse=True)
        assert all(step <= 10.0**-power for power, step in enumerate(steps, start=2))


class TestRoundedPi:
    @pytest.mark.parametrize(
        ("text", "word"),
        [
            *[("1.5708", "pi/2"), ("-1.571", "-pi/2"), ("1.570796327", "pi/2"), ("3.14159", "pi")],
            *[("3.1415", "pi"), ("0.785", "pi/4"), ("2.356194", "3*pi/4"), ("-3.142", "-pi"), ("4.712388", "6*pi/4")],
        ],
    )
    def test_rounded_and_cut_ones_are_known(self, text: str, word: str) -> None:
        found = part_of_pi(text)
        assert found is not None
        value, said = found
        assert said == word
        assert value == pytest.approx(float(text), abs=1e-3)
        assert value * 4 / math.pi == pytest.approx(round(value * 4 / math.pi), abs=1e-15)

    @pytest.mark.parametrize("text", ["1.57", "3.14", "1.5709", "1.5", "0", "0.000", "1.570796326794896", "pi", "nan"])
    def test_other_numbers_are_not(self, text: str) -> None:
        assert part_of_pi(text) is None
