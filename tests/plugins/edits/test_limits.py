"""The edit `limits`: factors about the middle, a margin at both ends, and nothing where a table has no limit."""

import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.errors import EditError
from dh2urdf.manipulator import JointType, Limits, Manipulator
from dh2urdf.testing import reference_manipulators
from dh2urdf_plugins.edits.limits import LimitsOptions, edit_table

UR5 = reference_manipulators()[0]


def with_limits(limits: Limits, kind: JointType = JointType.REVOLUTE) -> Manipulator:
    return replace(UR5, rows=tuple(replace(row, type=kind, limits=limits) for row in UR5.rows))


def first(limits: Limits, **options: Any) -> Limits:
    return edit_table(with_limits(limits), LimitsOptions(**options)).rows[0].limits


@pytest.mark.parametrize(
    ("options", "found"),
    [
        ({"range": 0.5}, (0.0, 2.0, 3.0, 50.0)),
        ({"range": 0.5, "margin": 0.25}, (0.25, 1.75, 3.0, 50.0)),
        ({"velocity": 0.1, "effort": 2.0}, (-1.0, 3.0, pytest.approx(0.3), 100.0)),
        ({"margin": -0.5}, (-1.5, 3.5, 3.0, 50.0)),
    ],
)
def test_by_hand(options: dict[str, Any], found: tuple[float, ...]) -> None:
    """Of a joint from -1 to 3, 3 rad/s and 50 N·m."""
    limits = first(Limits(lower=-1.0, upper=3.0, velocity=3.0, effort=50.0), **options)
    assert (limits.lower, limits.upper, limits.velocity, limits.effort) == found


@pytest.mark.parametrize(
    ("margin", "turning", "sliding"),
    [
        ("5 deg", math.radians(5), 0.0),
        ("-20 mm", 0.0, -0.02),
        ("pi/36", math.pi / 36, math.pi / 36),
        (0.05, 0.05, 0.05),
    ],
)
def test_a_margin_with_a_unit_is_about_the_joints_that_have_it(
    margin: float | str, turning: float, sliding: float
) -> None:
    """An angle narrows joints that turn, a length those that slide; a bare number is rad for the ones, m for the others."""
    limits = Limits(lower=-2.0, upper=4.0)
    for kind, expected in ((JointType.REVOLUTE, turning), (JointType.PRISMATIC, sliding)):
        found = edit_table(with_limits(limits, kind), LimitsOptions(margin=margin)).rows[0].limits
        assert (found.lower, found.upper) == pytest.approx((-2.0 + expected, 4.0 - expected), abs=1e-15)


@given(st.floats(-10.0, 0.0), st.floats(0.1, 10.0), st.floats(0.01, 5.0))
def test_the_middle_stays(lower: float, upper: float, factor: float) -> None:
    """Whatever the factor; and what a factor does its inverse undoes."""
    once = first(Limits(lower=lower, upper=upper), range=factor)
    assert once.lower is not None
    assert once.upper is not None
    assert once.lower + once.upper == pytest.approx(lower + upper, abs=1e-12)
    back = first(once, range=1.0 / factor)
    assert (back.lower, back.upper) == pytest.approx((lower, upper), abs=1e-12)


def test_what_a_table_leaves_out_stays_left_out() -> None:
    """A continuous joint has no range, a joint without an effort gets none; where nothing changes, that is noticed."""
    arm = with_limits(Limits(velocity=2.0), JointType.CONTINUOUS)
    edited = edit_table(arm, LimitsOptions(range=0.5, margin=0.1, velocity=0.5, effort=0.5))
    assert edited.rows[0].limits == Limits(velocity=1.0)
    (notice,) = edit_table(arm, LimitsOptions(effort=0.5)).notices
    assert notice.message == "the edit `limits` changes no limit of this arm"


def test_some_joints() -> None:
    """The others keep theirs; an unknown name is refused with the nearest."""
    arm = with_limits(Limits(lower=-1.0, upper=1.0))
    edited = edit_table(arm, LimitsOptions(margin=0.5, joints=("joint_2",)))
    assert [row.limits.upper for row in edited.rows[:3]] == [1.0, 0.5, 1.0]
    with pytest.raises(EditError, match="no moving joint 'joint2'") as refused:
        edit_table(arm, LimitsOptions(joints=("joint2",)))
    assert "joint_2" in str(refused.value.problems[0].suggestion)
