"""The table of any chain is the chain: random ones, and some with nearly parallel axes."""

import math
import os
import random

import pytest
from random_chains import largest_difference, random_chain

from dh2urdf.manipulator import Convention, JointType
from dh2urdf.robot import Joint, Origin
from dh2urdf_plugins.extraction.solving import Choices, Solution, solve

SEED = int(os.environ.get("GITHUB_RUN_NUMBER", "0"))
"""Another one in each run of the CI; a failure names the chain."""
CHAINS = 150
HALF_PI, PI = math.pi / 2, math.pi


def joint(
    name: str,
    xyz: tuple[float, float, float] = (0, 0, 0),
    rpy: tuple[float, float, float] = (0, 0, 0),
    axis: tuple[float, float, float] = (0, 0, 1),
    kind: str = "revolute",
) -> Joint:
    """A joint as a maker writes it; its links are named after it."""
    origin = Origin(xyz=xyz, rpy=rpy)
    return Joint(name=name, type=JointType(kind), parent=f"before {name}", child=name, origin=origin, axis=axis)


def rows(solution: Solution) -> list[tuple[float, float, float, float]]:
    """a, α, d, θ of the rows."""
    return [(row.a, row.alpha, row.d, row.theta) for row in solution.table.rows]


@pytest.mark.parametrize("convention", list(Convention))
def test_random_chains(convention: Convention) -> None:
    """To 1e-12 of the arm's size, held against numpy's products."""
    for number in range(CHAINS):
        seed = f"{SEED}.{number}"
        draw = random.Random(seed)  # noqa: S311 - reproducible on purpose
        joints = random_chain(draw)
        solution = solve(joints, Choices(convention=convention, tolerance=1e-12))
        size = max(1.0, solution.length)
        assert largest_difference(joints, solution.table, draw) <= 1e-12 * size, f"chain {seed}, {convention}"
        assert solution.error <= 1e-12 * size


@pytest.mark.parametrize("near_parallel", ["dh", "split", "auto"])
def test_random_chains_however_nearly_parallel_axes_are_written(near_parallel: str) -> None:
    """Without fixed rows, the numbers of far normals lose what doubles lose at their size."""
    for number in range(60):
        draw = random.Random(f"near {number}")  # noqa: S311 - reproducible on purpose
        joints = random_chain(draw)
        solution = solve(joints, Choices(tolerance=1e-12, near_parallel=near_parallel))
        far = max([1.0, solution.length, *(abs(row.d) for row in solution.table.rows)])
        assert largest_difference(joints, solution.table, draw) <= 1e-12 * max(1.0, solution.length) + 4e-15 * far
        fixed = any(row.type is JointType.FIXED for row in solution.table.rows)
        assert not (fixed and near_parallel == "dh")


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_a_tolerance_is_kept(tolerance: float) -> None:
    for number in range(40):
        draw = random.Random(f"tolerance {number}")  # noqa: S311 - reproducible on purpose
        joints = random_chain(draw)
        solution = solve(joints, Choices(tolerance=tolerance))
        assert solution.error <= tolerance


def test_a_cartesian_arm() -> None:
    """Three prismatic joints at right angles, wherever the file has their axes."""
    joints = (
        joint("x", (0, 0.3, 0.2), axis=(1, 0, 0), kind="prismatic"),
        joint("y", (0.1, 0, 0), axis=(0, 1, 0), kind="prismatic"),
        joint("z", (0, 0, 0.4), axis=(0, 0, 1), kind="prismatic"),
    )
    solution = solve(joints, Choices())
    assert solution.error < 1e-15
    assert all(row[0] == 0 for row in rows(solution))


class TestNearlyParallelAxes:
    """A calibrated UR5: α of two links is 1e-4 … 1e-3 rad, and the common normals lie hundreds of metres away."""

    # theta, d, a, alpha of each row, of the size that calibration files have
    ROWS = (
        *((0.0, 0.0892, 0.0001, HALF_PI + 1e-5), (-1.2, 574.24, -0.0567, 0.00074)),
        *((2.1, -507.36, 0.0181, 0.00084), (-0.9, -66.77, -3e-5, HALF_PI + 2e-4)),
        *((0.0, 0.0946, 2e-5, -HALF_PI - 3e-4), (0.0, 0.0823, 0.0, 0.0)),
    )

    def chain(self) -> list[Joint]:
        """Its joints as the rows have them: frames far away."""
        found: list[Joint] = []
        before = ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
        for number, (theta, d, a, alpha) in enumerate(self.ROWS, start=1):
            found.append(joint(f"joint_{number}", *before))
            c, s = math.cos(theta), math.sin(theta)
            before = ((a * c, a * s, d), (alpha, 0.0, theta))
        return [*found, joint("tool0", *before, kind="fixed")]

    def test_its_rows_come_back(self) -> None:
        solution = solve(self.chain(), Choices(tolerance=1e-9, near_parallel="dh"))
        for (theta, d, a, alpha), row in zip(self.ROWS, solution.table.rows, strict=True):
            assert row.d == pytest.approx(d, abs=1e-6)
            assert abs(row.a) == pytest.approx(abs(a), abs=1e-9)
            assert abs(row.alpha) == pytest.approx(abs(alpha), abs=1e-11)
            assert math.sin(row.theta - theta) == pytest.approx(0, abs=1e-9)
        assert {(pair.first, pair.split) for pair in solution.nearly_parallel} == {
            ("joint_2", False),
            ("joint_3", False),
        }

    @pytest.mark.parametrize("convention", list(Convention))
    def test_split_rows_are_of_the_arms_size(self, convention: Convention) -> None:
        solution = solve(self.chain(), Choices(convention=convention, tolerance=1e-9, near_parallel="split"))
        fixed = [row for row in solution.table.rows if row.type is JointType.FIXED]
        assert len(fixed) == 2
        assert len(solution.table.moving_rows) == 6
        assert max(abs(number) for row in solution.table.rows for number in (row.a, row.d)) < 1.5
        assert solution.error < 1e-9

    def test_auto_splits_what_no_double_holds(self) -> None:
        joints = [joint("a"), joint("b", (0.4, 0, 0), (3e-8, 0, 0)), joint("tip", (0, 0.3, 0.1), kind="fixed")]
        solution = solve(joints, Choices(tolerance=1e-10))
        assert [row.type for row in solution.table.rows] == ["revolute", "revolute"]  # they meet: nothing is far away
        skew = [joint("a"), joint("b", (0.4, 0.2, 0), (3e-8, 0, 0)), joint("tip", (0, 0.3, 0.1), kind="fixed")]
        solution = solve(skew, Choices(tolerance=1e-10))
        assert [row.type for row in solution.table.rows] == ["revolute", "fixed", "revolute"]
        assert solution.error < 1e-10
