"""Launch files, executed against a recorder of the names that they use; the packages themselves are in ROS 2 alone."""

from __future__ import annotations

import runpy
import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any, NamedTuple

import pytest
import yaml

if TYPE_CHECKING:
    from pathlib import Path

# The names and keyword arguments of ros2/launch 3.x and ros2/launch_ros 0.26 that launch files may use.
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

    for module, names in {"launch_ros": {}, **KNOWN}.items():
        made = ModuleType(module)
        for name, accepted in names.items():
            setattr(made, name, recording(name, accepted))
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


def test_the_view_of_rviz_is_fixed_to_the_root(package: Any) -> None:
    """Grid, robot and frames; the topic of the description is latched."""
    folder, robot, _ = package("ur5.csv", "aligned")
    content = yaml.safe_load((folder / "rviz" / "view_robot.rviz").read_text())["Visualization Manager"]
    assert content["Global Options"]["Fixed Frame"] == robot.root == "base_link"
    displays = {each["Class"]: each for each in content["Displays"]}
    assert set(displays) == {f"rviz_default_plugins/{name}" for name in ("Grid", "RobotModel", "TF")}
    topic = displays["rviz_default_plugins/RobotModel"]["Description Topic"]
    assert (topic["Value"], topic["Durability Policy"]) == ("/robot_description", "Transient Local")


@pytest.mark.usefixtures("recorder")
def test_every_package_that_a_launch_file_uses_is_a_dependency(package: Any) -> None:
    """rosdep installs what package.xml names."""
    from lxml import etree

    folder, _, _ = package("ur5.csv", "aligned")
    needed = {each.text for each in etree.parse(folder / "package.xml").getroot().findall("exec_depend")}
    entities = executed(folder / "launch" / "view_robot.launch.py")
    assert {each.named["package"] for each in entities if each.name == "Node"} <= needed
    assert {"launch", "launch_ros", "xacro"} <= needed
