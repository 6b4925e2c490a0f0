"""The MoveIt package of a robot or a cell, which goes with its description package.

Its files are those that MoveIt's setup assistant writes and that ``moveit_configs_utils`` looks for (moveit/moveit2).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from lxml import etree

from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import WORLD
from dh2urdf.source import Problem, markdown_text, shown
from dh2urdf_plugins.formats.urdf.writer import serialise
from dh2urdf_plugins.formats.xacro.writer import NAMESPACE, XacroNotation, append_element
from dh2urdf_plugins.packages.ros2.description_xacro import arms_of, positions_argument
from dh2urdf_plugins.packages.ros2.package_files import (
    CONTROLLING,
    changelog,
    cmake_lists,
    filled,
    license_file,
    package_xml,
    planning_view,
)
from dh2urdf_plugins.packages.ros2.yaml_files import (
    SPEED_UP,
    arm_joints,
    controllers,
    initial_positions,
    is_no_text_to_launch,
    kinematics,
    moveit_controllers,
    planning_limits,
    reaches_positions_only,
    setup_assistant,
)
from dh2urdf_plugins.packages.srdf import srdf
from dh2urdf_plugins.packages.srdf.semantics import groups

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Robot
    from dh2urdf_plugins.packages.ros2.options import Ros2Options

PLANNING = (
    "moveit_configs_utils",
    "moveit_kinematics",
    "moveit_planners",
    "moveit_ros_move_group",
    "moveit_ros_visualization",
    "moveit_setup_assistant",
    "moveit_simple_controller_manager",
    "robot_state_publisher",
    "rviz2",
    "tf2_ros",
    "xacro",
)
_TESTED = ("ament_cmake_pytest", "python3-yaml", "xacro")
_TEST = "test_moveit_config"


def moveit_package(robot: Robot, name: str, description: str, options: Ros2Options) -> dict[str, bytes]:
    """The files of a MoveIt package by their places in it.

    Args:
        robot: the robot of the description package.
        name: the name of the robot in the names of packages.
        description: the name of the description package.
        options: what a person chose.

    Raises:
        EmitterError: nothing of the robot moves, or a mesh cannot be read.
        MissingDependencyError: what finds collision pairs is not installed.
    """
    if not robot.moving_joints:
        message = "MoveIt plans for joints that move, and this robot has none"
        raise EmitterError(Problem(message=message, field="moveit", accepted="a robot with a moving joint, or false"))
    package = moveit_name(name)
    files = dict(_config(robot, name, package, description, options))
    for what in _launches(robot, options):
        files[f"launch/{what}.launch.py"] = filled("moveit.launch.py", PACKAGE=package, NAME=name, WHAT=what)
    files[f"test/{_TEST}.py"] = filled(f"{_TEST}.py", NAME=name)
    files[".setup_assistant"] = setup_assistant(name, description, options)
    needed = sorted({description, *PLANNING, *(CONTROLLING if options.controlled else ())})
    summary = f"The configuration of MoveIt for {robot.name}"
    files["package.xml"] = package_xml(package, summary, options, needed, _TESTED)
    files["CMakeLists.txt"] = cmake_lists(package, ("config", "launch"), _TEST, (".setup_assistant",))
    files["README.md"] = filled(
        "moveit_README.md",
        PACKAGE=package,
        DESCRIPTION=description,
        ROBOT=markdown_text(robot.name),
        START=filled("moveit_demo.md", PACKAGE=package).decode() if options.controlled else "",
    )
    files["CHANGELOG.rst"] = changelog(package, options.version)
    if options.license:
        files["LICENSE"] = license_file(options)
    return files


def moveit_name(name: str) -> str:
    """The name of the MoveIt package of a robot."""
    return f"{name}_moveit_config"


def moveit_notices(robot: Robot, options: Ros2Options) -> Iterator[Problem]:
    """What a person should know of the MoveIt package of a robot."""
    if options.acceleration is None:
        yield Problem(
            message=f"no table has accelerations: MoveIt gets those that reach full velocity in {SPEED_UP} s",
            severity="notice",
            suggestion="set the option `acceleration`, or edit joint_limits.yaml",
        )
    for name in (joint.name for joint in robot.moving_joints if is_no_text_to_launch(joint.name)):
        yield Problem(
            message=f"MoveIt does not start with the joint {shown(name)}: launch_ros hands the name on without quotes, "
            "and ROS then reads a truth value or a number",
            severity="notice",
            suggestion=f"rename the joint, for example to {shown(f'joint_{name}')}",
        )
    for group in groups(robot, options.group):
        if reaches_positions_only(group):
            yield Problem(
                message=f"the group {group.name!r} has {_joints(len(group.joints))}: MoveIt finds positions for it, "
                "and leaves orientations free",
                severity="notice",
            )


def _joints(count: int) -> str:
    return f"{count} joint{'' if count == 1 else 's'}"


def _launches(robot: Robot, options: Ros2Options) -> Iterator[str]:
    """The launch files, by the functions of ``moveit_configs_utils.launches`` that they call."""
    yield from ("move_group", "moveit_rviz", "rsp", "setup_assistant")
    if robot.root != WORLD:
        yield "static_virtual_joint_tfs"
    if options.controlled:
        yield from ("demo", "spawn_controllers")


def _config(
    robot: Robot, name: str, package: str, description: str, options: Ros2Options
) -> Iterator[tuple[str, bytes]]:
    """The files of the folder ``config``."""
    arms = arm_joints(robot)
    yield f"config/{name}.srdf", srdf(robot, options, options.group)
    yield f"config/{name}.urdf.xacro", _description(robot, name, package, description, options)
    yield "config/kinematics.yaml", kinematics(groups(robot, options.group))
    yield "config/joint_limits.yaml", planning_limits(robot.moving_joints, options.acceleration)
    yield "config/moveit_controllers.yaml", moveit_controllers(arms)
    if options.controlled:
        yield "config/ros2_controllers.yaml", controllers(arms)
        for prefix, arm in arms_of(robot):
            yield f"config/{prefix}initial_positions.yaml", initial_positions(arm)
    yield "config/pilz_cartesian_limits.yaml", filled("pilz_cartesian_limits.yaml")
    yield "config/moveit.rviz", planning_view(robot)


def _description(robot: Robot, name: str, package: str, description: str, options: Ros2Options) -> bytes:
    """The description that MoveIt shows: that of the other package, with hardware that a demonstration can run."""
    top = etree.Element("robot", name=XacroNotation().text(robot.name), nsmap={"xacro": NAMESPACE})
    if options.controlled:
        append_element(top, "arg", name="hardware", default="mock")
        for prefix, _ in arms_of(robot):
            place = f"$(find {package})/config/{prefix}initial_positions.yaml"
            append_element(top, "arg", name=positions_argument(prefix), default=place)
    append_element(top, "include", filename=f"$(find {description})/urdf/{name}.urdf.xacro")
    return serialise(top)
