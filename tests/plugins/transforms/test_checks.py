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


@pytest.mark.parametrize(
    ("row", "field", "says"),
    [
        ({"limits": Limits(lower=0.0)}, "limits.upper", "without upper"),
        ({"limits": Limits(upper=0.0)}, "limits.lower", "without lower"),
        ({"mass": 0.0}, "mass", "greater than 0"),
        ({"radius": -0.1}, "radius", "greater than 0"),
        ({"inertia": Inertia(ixx=0.0, iyy=0.35, izz=0.0)}, "inertia", "positive definite"),
        ({"inertia": Inertia(ixx=1.0, iyy=1.0, izz=2.1)}, "inertia", "triangle inequality"),
    ],
)
def test_a_row_that_makes_no_arm_is_refused(
    row: dict[str, Any], field: str, says: str, table: Table, robot_of: RobotOf
) -> None:
    """The error names the joint, its place and the field, says what is wrong and what is accepted."""
    mark = Mark(file="arm.csv", line=3)
    with pytest.raises(TransformError, match=says) as caught:
        robot_of(table({"d": 0.1}, row | {"mark": mark}))
    (problem,) = caught.value.problems
    assert (problem.joint, problem.field, problem.mark, problem.robot) == ("joint_2", field, mark, "arm")
    assert problem.accepted


@pytest.mark.parametrize(
    ("more", "field", "says"),
    [
        ({"geometry": LinkGeometry(shape="cilinder")}, "geometry.shape", "did you mean 'cylinder'"),
        ({"base_geometry": LinkGeometry(radius=0.0)}, "base.geometry.radius", "greater than 0"),
        ({"density": -1.0}, "density", "greater than 0"),
        ({"base_mass": -1.0}, "base.mass", "greater than 0"),
    ],
)
def test_a_table_that_makes_no_arm_is_refused(
    more: dict[str, Any], field: str, says: str, table: Table, robot_of: RobotOf
) -> None:
    """Shapes, density, base and tool are checked like the rows."""
    with pytest.raises(TransformError, match=says) as caught:
        robot_of(table({"d": 0.1}, **more))
    (problem,) = caught.value.problems
    assert problem.field == field


@pytest.mark.parametrize(
    ("row", "meant"),
    [
        ({"alpha": 1.5708}, "pi/2"),
        ({"alpha": -1.57}, "-pi/2"),
        ({"theta": 3.14159}, "pi"),
        ({"offset": -3.142}, "-pi"),
        ({"theta": 4.7124}, "3\\*pi/2"),
    ],
)
def test_an_angle_that_was_probably_a_quarter_turn_is_kept_with_a_notice(
    row: dict[str, float], meant: str, table: Table, robot_of: RobotOf
) -> None:
    """Nothing is snapped in silence, and nothing at all in the exact variant."""
    robot = robot_of(table(row, {"d": 0.1}))
    (notice,) = robot.notices
    assert notice.severity == "notice"
    assert f"; {meant.replace(chr(92), '')} was probably meant" in notice.message
    assert (notice.joint, notice.robot) == ("joint_1", "arm")
