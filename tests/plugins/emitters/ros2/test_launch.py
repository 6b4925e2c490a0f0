"""Launch files, executed against a recorder of the names that they use; the packages themselves are in ROS 2 alone."""

from __future__ import annotations

import runpy
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest
import yaml
from lxml import etree

from dh2urdf_plugins.packages.ros2 import Ros2Options

if TYPE_CHECKING:
    from pathlib import Path

# The names and keyword arguments of ros2/launch 3.x, ros2/launch_ros 0.26 and moveit_configs_utils 2.x that launch files
# may use.
KNOWN = {
    "launch": {"LaunchDescription": ()},
    "launch.actions": {"DeclareLaunchArgument": ("default_value", "description", "choices")},
    "launch.conditions": {"IfCondition": (), "UnlessCondition": ()},
    "launch.substitutions": {
        "Command": ("on_stderr",),
        "FindExecutable": ("name",),
        "LaunchConfiguration": ("default",),
        "PathJoinSubstitution": (),
    },
    "launch_ros.actions": {
        "Node": ("package", "executable", "name", "namespace", "parameters", "arguments", "condition", "output")
    },
    "launch_ros.parameter_descriptions": {"ParameterValue": ("value_type",)},
    "launch_ros.substitutions": {"FindPackageShare": ("package",)},
    "moveit_configs_utils.launches": {
        f"generate_{name}_launch": ()
        for name in (
            "demo",
            "move_group",
            "moveit_rviz",
            "rsp",
            "setup_assistant",
            "spawn_controllers",
            "static_virtual_joint_tfs",
            "warehouse_db",
        )
    },
}


class Made(NamedTuple):
    """A call that a launch file made."""

    name: str
    given: tuple[Any, ...]
    named: dict[str, Any]


@pytest.fixture
def recorder(monkeypatch: pytest.MonkeyPatch) -> None:
    """Modules of the names above, whose calls give what they were called with."""

    def recording(name: str, accepted: tuple[str, ...]) -> Any:
        def record(*given: Any, **named: Any) -> Made:
            assert set(named) <= set(accepted), f"{name} has no argument {set(named) - set(accepted)}"
            return Made(name, given, named)

        return record

    class MoveItConfigsBuilder(Made):
        """The start of a chain of calls, which ends with the configuration."""

        def to_moveit_configs(self) -> Made:
            return Made("configs", self.given, self.named)

    def builder(*given: Any, **named: Any) -> MoveItConfigsBuilder:
        assert set(named) <= {"robot_description", "package_name"}
        return MoveItConfigsBuilder("MoveItConfigsBuilder", given, named)

    for module, names in {"launch_ros": {}, "moveit_configs_utils": {}, **KNOWN}.items():
        made = ModuleType(module)
        for name, accepted in names.items():
            setattr(made, name, recording(name, accepted))
        if module == "moveit_configs_utils":
            made.__dict__["MoveItConfigsBuilder"] = builder
        monkeypatch.setitem(sys.modules, module, made)


def executed(path: Path) -> list[Made]:
    description = runpy.run_path(str(path))["generate_launch_description"]()
    assert description.name == "LaunchDescription"
    (entities,) = description.given
    return list(entities)


@pytest.mark.usefixtures("recorder")
def test_the_launch_file_shows_the_installed_description(package: Any) -> None:
    """The nodes, the description as a text parameter, and an empty prefix that survives the shell."""
    folder, _, _ = package("ur5.csv", "aligned")
    entities = executed(folder / "launch" / "view_robot.launch.py")
    arguments = {
        each.given[0]: each.named["default_value"] for each in entities if each.name == "DeclareLaunchArgument"
    }
    assert list(arguments) == ["prefix", "gui", "rviz_config"]
    assert arguments["prefix"] == '""'
    nodes = {each.named["package"]: each.named for each in entities if each.name == "Node"}
    assert set(nodes) == {"robot_state_publisher", "joint_state_publisher_gui", "joint_state_publisher", "rviz2"}
    needed = {each.text for each in etree.parse(folder / "package.xml").getroot().findall("exec_depend")}
    assert {*nodes, "launch", "launch_ros", "xacro"} <= needed
    (parameters,) = nodes["robot_state_publisher"]["parameters"]
    value = parameters["robot_description"]
    assert (value.name, value.named) == ("ParameterValue", {"value_type": str})
    command = value.given[0]
    program, _, path, prefix, word = command.given[0]
    assert (command.name, program.named, prefix) == ("Command", {"name": "xacro"}, " prefix:=")
    assert word == Made("LaunchConfiguration", ("prefix",), {})
    share, *parts = path.given[0]
    assert share == Made("FindPackageShare", ("ur5_description",), {})
    assert folder.joinpath(*parts).is_file()
    share, *parts = arguments["rviz_config"].given[0]
    assert folder.joinpath(*parts).is_file()


@pytest.mark.usefixtures("recorder")
def test_launch_files_of_moveit_ask_its_builder_for_the_package(package: Any) -> None:
    """Each calls the function of its own name with the configuration of the robot's package."""
    pytest.importorskip("pinocchio")
    description, _, _ = package("ur5.csv", "aligned", Ros2Options(moveit=True, trials=10))
    launches = sorted(description.with_name("ur5_moveit_config").glob("launch/*.launch.py"))
    assert launches
    for path in launches:
        made = runpy.run_path(str(path))["generate_launch_description"]()
        assert made.name == f"generate_{path.name.removesuffix('.launch.py')}_launch"
        assert made.given == (Made("configs", ("ur5",), {"package_name": "ur5_moveit_config"}),)


def test_the_views_of_rviz_are_fixed_to_the_root(package: Any) -> None:
    """Grid, robot and frames, and the panel for plans; the topics are those of the nodes."""
    pytest.importorskip("pinocchio")
    folder, robot, _ = package("ur5.csv", "aligned", Ros2Options(moveit=True, trials=10))
    displays = {}
    for path in (folder / "rviz/view_robot.rviz", folder.with_name("ur5_moveit_config") / "config/moveit.rviz"):
        content = yaml.safe_load(path.read_text())["Visualization Manager"]
        assert content["Global Options"]["Fixed Frame"] == robot.root == "base_link"
        displays |= {each["Class"].rpartition("/")[2]: each for each in content["Displays"]}
    assert {"Grid", "RobotModel", "TF", "MotionPlanning"} <= set(displays)
    topic = displays["RobotModel"]["Description Topic"]
    assert (topic["Value"], topic["Durability Policy"]) == ("/robot_description", "Transient Local")
    assert displays["MotionPlanning"]["Robot Description"] == "robot_description"
    assert displays["MotionPlanning"]["Planning Scene Topic"] == "monitored_planning_scene"
