"""What shows a robot in ROS 2, and the test that a package runs: a launch file, a view of RViz, expected poses."""

from __future__ import annotations

import pprint
from typing import TYPE_CHECKING

from dh2urdf.elementwise import total
from dh2urdf.kinematics import link_poses
from dh2urdf.manipulator import TOOL, JointType
from dh2urdf.rotations import norm
from dh2urdf_plugins.emitters.ros2.package_files import filled
from dh2urdf_plugins.home_pose import initial_position

if TYPE_CHECKING:
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.rotations import RigidTransform

_PARTS = (0.5, 0.2, 0.9)
"""Where between their limits the joints are in the test of a package."""
_UNLIMITED = 3.0
"""The bound of a joint without limits in that test [rad]."""


def launch_file(package: str, name: str, robot: Robot) -> bytes:
    """``view_robot.launch.py``; the arms of a cell have their prefixes already."""
    has_prefix = not robot.arms
    argument = '\n            " prefix:=",\n            LaunchConfiguration("prefix"),'
    # The command is split as a shell does: an empty text is two quotes.
    declaration = (
        "\n            DeclareLaunchArgument(\n"
        '                "prefix", default_value=\'""\', description="Prefix of the names of links and joints."\n'
        "            ),"
    )
    return filled(
        "view_robot.launch.py",
        PACKAGE=package,
        NAME=name,
        PREFIX_ARGUMENT=argument if has_prefix else "",
        PREFIX_DECLARATION=declaration if has_prefix else "",
    )


def rviz_file(robot: Robot) -> bytes:
    """``view_robot.rviz``: the robot from a distance that suits its size."""
    return _view("view_robot.rviz", robot)


def planning_view(robot: Robot) -> bytes:
    """``moveit.rviz``: the same view, with MoveIt's panel for plans."""
    return _view("moveit.rviz", robot)


def _view(template: str, robot: Robot) -> bytes:
    size = max(total(norm(joint.origin.xyz) for joint in robot.joints) / max(len(robot.arms), 1), 0.1)
    numbers = {"CELL": size / 5.0, "MARKER": size / 3.0, "DISTANCE": 2.0 * size, "HEIGHT": size / 3.0}
    return filled(template, ROOT=robot.root, **{name: f"{value:.3g}" for name, value in numbers.items()})


def test_file(package: str, name: str, robot: Robot) -> bytes:
    """``test_description.py``: T(root → tool) at some joint vectors, as numbers."""
    tools = [arm.prefix + TOOL for arm in robot.arms] or [TOOL]
    tools = [tool for tool in tools if any(link.name == tool for link in robot.links)] or [robot.links[-1].name]
    poses = []
    for part in (None, *_PARTS):
        values = {joint.name: _value(joint, part, place) for place, joint in enumerate(robot.moving_joints)}
        frames = link_poses(robot, values)
        poses.append((values, {tool: _rows(frames[tool]) for tool in tools}))
    return filled(
        "test_description.py",
        PACKAGE=package,
        NAME=name,
        PREFIXES='[""]' if robot.arms else '["", "left_"]',
        ROOT=robot.root,
        POSES=pprint.pformat(poses, width=110, sort_dicts=False),
    )


def _value(joint: Joint, part: float | None, place: int) -> float:
    if part is None:
        return initial_position(joint)
    lower, upper = joint.limits.lower, joint.limits.upper
    if joint.type is JointType.CONTINUOUS or lower is None or upper is None:
        lower, upper = -_UNLIMITED, _UNLIMITED
    part = part if place % 2 else 1.0 - part
    return round(lower + part * (upper - lower), 6)


def _rows(pose: RigidTransform) -> list[list[float]]:
    r, t = pose
    return [*([*(x + 0.0 for x in r[3 * i : 3 * i + 3]), t[i] + 0.0] for i in range(3)), [0.0, 0.0, 0.0, 1.0]]
