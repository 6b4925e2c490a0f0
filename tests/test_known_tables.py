"""Tables of known arms through every reader: a bounded part of `fuzz/tables.py`, and that it finds what is wrong."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from known_arms import KnownArm, KnownRow
from known_quantities import ANGLE, LENGTH, Exact
from tables import Figures, WrongReading, counted_fast, run_case

from dh2urdf.columns import member, stacked
from dh2urdf.fields import replace_unchecked
from dh2urdf_plugins.readers.plain import rows as plain_rows
from dh2urdf_plugins.readers.plain.rows import PlainRows

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


def planted(monkeypatch: pytest.MonkeyPatch, change: Any) -> None:
    fast = PlainRows.read

    def wrong(self: PlainRows, arms: Any) -> Any:
        groups = fast(self, arms)
        return groups and [
            (members, replace_unchecked(arm, rows=tuple(changed(row, len(members)) for row in arm.rows)))
            for members, arm in groups
        ]

    def changed(row: Any, count: int) -> Any:
        return stacked([change(member(row, number)) for number in range(count)])

    monkeypatch.setattr(PlainRows, "read", wrong)
    monkeypatch.setattr(plain_rows, "compare", lambda *_arguments: None)  # the check of every run would be first


@pytest.mark.parametrize(
    "change",
    [
        lambda row: replace(row, a=row.a + 1e-9),
        lambda row: replace(row, limits=replace(row.limits, effort=7.0)),
    ],
    ids=["a", "effort"],
)
def test_a_wrong_reading_is_found(change: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A nanometre, a factor, a sign, a limit that nobody said, and the last bit of a length."""
    planted(monkeypatch, change)
    with pytest.raises(WrongReading):
        run_cases(tmp_path)


def exact(number: int, dimension: str) -> Exact:
    return Exact(Fraction(number), dimension, degrees=dimension == ANGLE)


@pytest.mark.parametrize(("convention", "tool"), [("standard", (0, 1, 2)), ("modified", (1, 0, 2))])
def test_the_kinematics_of_the_known_arms_are_those_of_the_definition(convention: str, tool: tuple[int, ...]) -> None:
    """One row of a = 1 m, theta = 90 deg and d = 2 m: the standard a lies along the turned x, the modified one does not."""
    row = KnownRow(None, None, "revolute")
    row.numbers = {"a": exact(1, LENGTH), "alpha": exact(0, ANGLE), "d": exact(2, LENGTH), "theta": exact(90, ANGLE)}
    pose = KnownArm("arm", convention, [row]).fk([0.0])
    np.testing.assert_allclose(pose, [[0, -1, 0, tool[0]], [1, 0, 0, tool[1]], [0, 0, 1, 2], [0, 0, 0, 1]], atol=1e-15)
