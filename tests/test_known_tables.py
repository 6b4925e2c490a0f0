"""Tables of known arms through every reader: a bounded part of `fuzz/tables.py`."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import numpy as np
import pytest
from known_arms import KnownArm, KnownRow
from known_quantities import ANGLE, LENGTH, Exact
from tables import Figures, counted_fast, run_case

if TYPE_CHECKING:
    from pathlib import Path

CASES = range(1, 18)


def run_cases(folder: Path) -> Figures:
    figures = Figures()
    with counted_fast(figures):
        for number in CASES:
            run_case(1, number, folder, figures)
    return figures


@pytest.mark.long
def test_every_known_table_is_read_as_the_arm_that_it_is(tmp_path: Path) -> None:
    """Through CSV, YAML, JSON, Parquet, workbooks and Python, alone and among others, fast and with care; `fuzz/tables.py` reads more."""
    figures = run_cases(tmp_path)
    assert figures.tables > 100
    assert figures.fast > 50
    assert min(figures.by_reader[name] for name in ("csv", "yaml", "json", "parquet", "xlsx")) > 100


def exact(number: int, dimension: str) -> Exact:
    return Exact(Fraction(number), dimension, degrees=dimension == ANGLE)


@pytest.mark.parametrize(("convention", "tool"), [("standard", (0, 1, 2)), ("modified", (1, 0, 2))])
def test_the_kinematics_of_the_known_arms_are_those_of_the_definition(convention: str, tool: tuple[int, ...]) -> None:
    """One row of a = 1 m, theta = 90 deg and d = 2 m: the standard a lies along the turned x, the modified one does not."""
    row = KnownRow(None, None, "revolute")
    row.numbers = {"a": exact(1, LENGTH), "alpha": exact(0, ANGLE), "d": exact(2, LENGTH), "theta": exact(90, ANGLE)}
    pose = KnownArm("arm", convention, [row]).fk([0.0])
    np.testing.assert_allclose(pose, [[0, -1, 0, tool[0]], [1, 0, 0, tool[1]], [0, 0, 1, 2], [0, 0, 0, 1]], atol=1e-15)
