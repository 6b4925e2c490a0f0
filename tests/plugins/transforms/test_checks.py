from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import TransformError
from dh2urdf.manipulator import Inertia, Limits, LinkGeometry, Manipulator
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.robot import Robot

    Table = Callable[..., Manipulator]
    RobotOf = Callable[..., Robot]


MARK = Mark(file="arm.csv", line=3)


@pytest.mark.parametrize(
    ("row", "more", "code", "field"),
    [
        ({"limits": Limits(lower=0.0)}, {}, "limit-alone", "limits.upper"),
        ({"limits": Limits(upper=0.0)}, {}, "limit-alone", "limits.lower"),
        ({"mass": 0.0}, {}, "not-above-0", "mass"),
        ({"radius": -0.1}, {}, "not-above-0", "radius"),
        ({"inertia": Inertia(ixx=0.0, iyy=0.35, izz=0.0)}, {}, "inertia-of-no-body", "inertia"),
        ({"inertia": Inertia(ixx=1.0, iyy=1.0, izz=2.1)}, {}, "inertia-of-no-body", "inertia"),
        ({}, {"geometry": LinkGeometry(shape="cilinder")}, "shape-unknown", "geometry.shape"),
        ({}, {"base_geometry": LinkGeometry(radius=0.0)}, "not-above-0", "base.geometry.radius"),
        ({}, {"density": -1.0}, "not-above-0", "density"),
        ({}, {"base_mass": -1.0}, "not-above-0", "base.mass"),
    ],
)
def test_a_table_that_makes_no_arm_is_refused(
    row: dict[str, Any], more: dict[str, Any], *, code: str, field: str, table: Table, robot_of: RobotOf
) -> None:
    """The error names the field, and of a row the joint and its place."""
    with pytest.raises(TransformError) as caught:
        robot_of(table({"d": 0.1}, row | {"mark": MARK}, **more))
    (problem,) = caught.value.problems
    assert (problem.code, problem.field, problem.robot) == (code, field, "arm")
    assert (problem.joint, problem.mark) == (("joint_2", MARK) if row else (None, None))


@pytest.mark.parametrize(
    ("row", "meant"),
    [
        ({"alpha": 1.5708}, "pi/2"),
        ({"alpha": -1.57}, "-pi/2"),
        ({"theta": 3.14159}, "pi"),
        ({"offset": -3.142}, "-pi"),
        ({"theta": 4.7124}, "3*pi/2"),
    ],
)
def test_an_angle_that_was_probably_a_quarter_turn_is_kept_with_a_notice(
    row: dict[str, float], meant: str, table: Table, robot_of: RobotOf
) -> None:
    """Nothing is snapped in silence, and nothing at all in the exact variant."""
    robot = robot_of(table(row, {"d": 0.1}))
    (notice,) = robot.notices
    assert notice.severity == "notice"
    assert f"; {meant} was probably meant" in notice.message
    assert (notice.joint, notice.robot) == ("joint_1", "arm")
