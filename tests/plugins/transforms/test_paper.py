"""What the paper says, and nothing else."""

import math
from collections.abc import Callable

import pytest

from dh2urdf.errors import TransformError
from dh2urdf.manipulator import Manipulator
from dh2urdf.robot import Box, Robot
from dh2urdf.robot_check import check_robot
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM, AlphaSwapOptions

Table = Callable[..., Manipulator]
RobotOf = Callable[..., Robot]

HALF_PI = math.pi / 2
Y, Z = (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)


def test_the_papers_ur5(ur5: Manipulator, robot_of: RobotOf) -> None:
    """Section IV: the axes of its links 1 to 5 are y, y, y, z, y, and the five lengths are those of the table."""
    robot = robot_of(ur5, variant="paper")
    assert [joint.axis for joint in robot.moving_joints] == [Z, Y, Y, Y, Z, Y]
    sizes = [visual.geometry.size for link in robot.links[2:-2] for visual in link.visuals]
    assert sizes == [
        (0.01, 0.01, 0.089159),
        (0.01, 0.01, 0.425),
        (0.01, 0.01, 0.39225),
        (0.01, 0.10915, 0.01),
        (0.01, 0.01, 0.09465),
        (0.01, 0.0823, 0.01),
    ]


def test_each_angle_of_the_set_does_what_the_text_says(table: Table, robot_of: RobotOf) -> None:
    """0 and π nothing; π/2 swaps axes and lengths of all that follows; -π/2 their origins too. Twice is not at all."""
    turns = [0.0, math.pi, HALF_PI, -HALF_PI, HALF_PI, -HALF_PI, 0.0]
    robot = robot_of(table(*({"a": 0.2, "alpha": alpha, "d": 0.1} for alpha in turns)), variant="paper")
    assert [joint.axis for joint in robot.moving_joints] == [Z, Z, Z, Y, Z, Y, Z]
    steps = [joint.origin.xyz for joint in robot.joints[2:-1]]
    along_z, along_y = (0.0, 0.0, 0.2), (0.0, 0.2, 0.0)
    assert steps == [along_z] * 4 + [along_y] * 2 + [along_z]
    sizes = [link.visuals[0].geometry.size[1:] for link in robot.links[2:-2]]
    assert sizes == [(0.2, 0.1), (0.2, 0.1), (0.2, 0.1), (0.1, 0.2), (0.2, 0.1), (0.1, 0.2), (0.2, 0.1)]


def test_a_row_without_lengths_is_a_cube_of_the_papers_thickness(table: Table, robot_of: RobotOf) -> None:
    """0.01 m each way, and nothing that could touch."""
    link = robot_of(table({}, {"d": 0.1}), variant="paper").links[2]
    assert link.visuals[0].geometry == Box(size=(0.01, 0.01, 0.01))
    assert link.collisions == ()


def test_the_robot_keeps_the_rules_and_says_that_it_is_another_arm(ur5: Manipulator, robot_of: RobotOf) -> None:
    """It can be loaded and proved to be different; only the exact variant claims the kinematics."""
    assert check_robot(robot_of(ur5, variant="paper")) == ()
    assert not TRANSFORM.keeps_kinematics(AlphaSwapOptions(variant="paper"))
    assert TRANSFORM.keeps_kinematics(AlphaSwapOptions())


def test_an_angle_near_the_set_is_taken_for_it_with_a_notice(table: Table, robot_of: RobotOf) -> None:
    """1.5708 is π/2; how near is an option."""
    robot = robot_of(table({"alpha": 1.5708}, {"d": 0.1}), variant="paper")
    assert robot.moving_joints[1].axis == Y
    (notice,) = robot.notices
    assert (notice.severity, notice.joint, notice.field) == ("notice", "joint_1", "alpha")
    assert "pi/2" in notice.message
    with pytest.raises(TransformError):
        robot_of(table({"alpha": 1.5708}, {"d": 0.1}), variant="paper", snap=0.0)
