"""The files of a MoveIt package: joints and links of its description, typed numbers, and a package that is one."""

import runpy
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any, NamedTuple

import pytest
import yaml
from lxml import etree

import dh2urdf
from dh2urdf.stages import Expansion, GivesNotices
from dh2urdf_plugins.packages.ros2 import EMITTER, Ros2Options
from dh2urdf_plugins.packages.ros2.yaml_files import planning_limits
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

Cli = Callable[..., Any]

pytest.importorskip("pinocchio")

TABLES = Path(__file__).parents[4] / "configs" / "tables"
OPTIONS = Ros2Options(moveit=True, trials=300)
FORMAT = etree.RelaxNG(etree.parse(Path(__file__).with_name("package_format3.rng")))


def moveit_folder(description: Path) -> Path:
    return description.with_name(description.name.replace("_description", "_moveit_config"))


def content(folder: Path, name: str) -> Any:
    return yaml.safe_load((folder / "config" / f"{name}.yaml").read_text(encoding="utf-8"))


def expanded(folder: Path, **arguments: str) -> etree._Element:
    """The description that MoveIt is given, which includes that of the other package."""
    (top,) = folder.glob("config/*.urdf.xacro")
    expansion = Expansion(arguments=arguments, package_paths=(folder.parent,))
    return etree.fromstring(expand_foreign(top, expansion).content)


def moving(description: etree._Element) -> list[str]:
    return [each.get("name") for each in description.findall("joint") if each.get("type") != "fixed"]


@pytest.fixture
def ur5(package: Any) -> Path:
    return moveit_folder(package("ur5.csv", "aligned", OPTIONS)[0])


@pytest.fixture
def workshop(cli: Cli, tmp_path: Path, cell: str) -> Path:
    (tmp_path / "run.yaml").write_text(cell)
    cli("run", tmp_path / "run.yaml", "-o", tmp_path / "src")
    return tmp_path / "src" / "workshop_moveit_config"


def test_it_has_the_files_that_the_setup_assistant_writes(ur5: Path) -> None:
    """And its tests, a README and a changelog."""
    names = {str(path.relative_to(ur5)) for path in ur5.rglob("*") if path.is_file()}
    launches = ["demo", "move_group", "moveit_rviz", "rsp", "setup_assistant", "spawn_controllers"]
    config = ["initial_positions", "joint_limits", "kinematics", "moveit_controllers", "pilz_cartesian_limits"]
    assert names == {
        ".setup_assistant",
        "CHANGELOG.rst",
        "CMakeLists.txt",
        "README.md",
        "package.xml",
        "config/moveit.rviz",
        "config/ros2_controllers.yaml",
        "config/ur5.srdf",
        "config/ur5.urdf.xacro",
        "test/test_moveit_config.py",
        *(f"config/{name}.yaml" for name in config),
        *(f"launch/{name}.launch.py" for name in [*launches, "static_virtual_joint_tfs"]),
    }


@pytest.mark.parametrize("table", ["ur5.csv", "panda.yaml", "scara.csv"])
def test_all_files_have_the_joints_of_the_description(package: Any, table: str) -> None:
    """In the same order, with reals that are floats; initial positions and named states are within the limits."""
    folder = moveit_folder(package(table, "aligned", OPTIONS)[0])
    description = expanded(folder)
    joints = moving(description)
    limits = content(folder, "joint_limits")
    assert list(limits["joint_limits"]) == joints
    for limit in limits["joint_limits"].values():
        assert {name: type(value) for name, value in limit.items()} == {
            "has_velocity_limits": bool,
            "max_velocity": float,
            "has_acceleration_limits": bool,
            "max_acceleration": float,
        }
    manager = content(folder, "moveit_controllers")["moveit_simple_controller_manager"]
    (name,) = manager["controller_names"]
    assert (manager[name]["action_ns"], manager[name]["default"]) == ("follow_joint_trajectory", True)
    ros2 = content(folder, "ros2_controllers")
    assert name in ros2["controller_manager"]["ros__parameters"]
    assert manager[name]["joints"] == ros2[name]["ros__parameters"]["joints"] == joints
    positions = content(folder, "initial_positions")["initial_positions"]
    assert list(positions) == joints
    semantic = etree.parse(next(folder.glob("config/*.srdf"))).getroot()
    assert semantic.get("name") == description.get("name")
    states = {each.get("name"): float(each.get("value")) for each in semantic.find("group_state")}
    assert list(states) == joints
    for each in description.findall("joint"):
        lower, upper = (
            (each.find("limit").get(end) for end in ("lower", "upper")) if each.get("name") in joints else ("0", "0")
        )
        if each.get("name") in joints and lower is not None:
            for value in (states[each.get("name")], positions[each.get("name")]):
                assert float(lower) <= value <= float(upper)
    reals = [*positions.values(), *content(folder, "pilz_cartesian_limits")["cartesian_limits"].values()]
    assert {type(value) for value in reals} == {float}


def test_velocities_are_those_of_the_table_and_reached_in_half_a_second(package: Any) -> None:
    """Unless an acceleration is given."""
    folder, robot, _ = package("panda.yaml", "aligned", OPTIONS)
    limits = content(moveit_folder(folder), "joint_limits")["joint_limits"]
    for joint in robot.moving_joints:
        assert limits[joint.name]["max_velocity"] == joint.limits.velocity
        assert limits[joint.name]["max_acceleration"] == pytest.approx(joint.limits.velocity / 0.5, rel=1e-12)
    folder, _, _ = package("panda.yaml", "aligned", replace(OPTIONS, acceleration=3))
    limits = content(moveit_folder(folder), "joint_limits")["joint_limits"]
    assert {limit["max_acceleration"] for limit in limits.values()} == {3.0}
    assert "max_acceleration: 3.0" in (moveit_folder(folder) / "config" / "joint_limits.yaml").read_text()


def test_accelerations_are_those_of_the_table() -> None:
    """And jerks; the option wins."""
    joints = [
        replace(joint, limits=replace(joint.limits, acceleration=4.5, jerk=60.0 if number else None))
        for number, joint in enumerate(dh2urdf.convert(TABLES / "ur5.csv").robot.moving_joints)
    ]
    first, *others = yaml.safe_load(planning_limits(joints, None))["joint_limits"].values()
    assert {limits["max_acceleration"] for limits in (first, *others)} == {4.5}
    assert "max_jerk" not in first
    assert {(limits["has_jerk_limits"], limits["max_jerk"]) for limits in others} == {(True, 60.0)}
    chosen = yaml.safe_load(planning_limits(joints, 3.0))["joint_limits"].values()
    assert {limits["max_acceleration"] for limits in chosen} == {3.0}


@pytest.mark.parametrize("table", ["ur5.csv", "panda.yaml", "scara.csv"])
def test_fewer_than_six_joints_reach_positions(package: Any, table: str) -> None:
    """The solver is asked for positions only, and a notice reports it."""
    folder, robot, _ = package(table, "aligned", OPTIONS)
    solver = content(moveit_folder(folder), "kinematics")["manipulator"]
    assert solver["kinematics_solver"] == "kdl_kinematics_plugin/KDLKinematicsPlugin"
    has_few = len(robot.moving_joints) < 6
    assert has_few is (table == "scara.csv")
    assert solver.get("position_only_ik", False) is has_few
    messages = [problem.message for problem in EMITTER.can(GivesNotices).notices(robot, OPTIONS)]
    assert any("leaves orientations free" in message for message in messages) is has_few
    assert any("the table has no acceleration of" in message for message in messages)
    assert not any(
        "acceleration" in problem.message for problem in EMITTER.can(GivesNotices).notices(robot, Ros2Options())
    )


def test_the_demonstration_has_hardware_that_runs_alone(package: Any) -> None:
    """Whatever the description has; another file of initial positions than that of the description."""
    folder = moveit_folder(package("ur5.csv", "aligned", replace(OPTIONS, hardware="gazebo"))[0])
    path = folder / "config" / "initial_positions.yaml"
    path.write_text(path.read_text().replace("elbow_joint: 0.0", "elbow_joint: 1.5"))
    description = expanded(folder)
    assert description.findtext("ros2_control/hardware/plugin") == "mock_components/GenericSystem"
    assert description.find("gazebo") is None
    values = [float(each.text) for each in description.iterfind("ros2_control/joint/state_interface/param")]
    assert values == [0.0, 0.0, 1.5, 0.0, 0.0, 0.0]
    gazebo = expanded(folder, hardware="gazebo")
    assert gazebo.find("gazebo/plugin") is not None


def test_without_hardware_nothing_starts_controllers(package: Any) -> None:
    """MoveIt still knows the controllers that a driver brings."""
    folder = moveit_folder(package("ur5.csv", "aligned", replace(OPTIONS, hardware="none"))[0])
    names = {path.name for path in folder.rglob("*")}
    assert not names & {
        "ros2_controllers.yaml",
        "initial_positions.yaml",
        "demo.launch.py",
        "spawn_controllers.launch.py",
    }
    assert "moveit_controllers.yaml" in names
    assert "demo.launch.py" not in (folder / "README.md").read_text()
    assert expanded(folder).find("ros2_control") is None


def test_a_cell_has_a_group_and_a_controller_for_each_arm(workshop: Path) -> None:
    """Its root is world, so no virtual joint is published."""
    description = expanded(workshop)
    manager = content(workshop, "moveit_controllers")["moveit_simple_controller_manager"]
    assert manager["controller_names"] == [f"{arm}joint_trajectory_controller" for arm in ("track_", "r_", "f_")]
    joints = [joint for name in manager["controller_names"] for joint in manager[name]["joints"]]
    assert joints == list(content(workshop, "joint_limits")["joint_limits"]) == moving(description)
    semantic = etree.parse(workshop / "config" / "workshop.srdf").getroot()
    groups = [group.get("name") for group in semantic.findall("group")]
    of_arms = [f"{arm}manipulator" for arm in ("track_", "r_", "f_")]
    assert groups == [*content(workshop, "kinematics"), "all"] == [*of_arms, "track_rider_manipulator", "all"]
    links = {link.get("name") for link in description.findall("link")}
    for pair in semantic.findall("disable_collisions"):
        assert {pair.get("link1"), pair.get("link2")} <= links
    assert not (workshop / "launch" / "static_virtual_joint_tfs.launch.py").exists()


def test_each_arm_of_a_cell_starts_where_its_file_says(workshop: Path) -> None:
    """Two arms of one kind have a file each: the positions in one of them move that arm, and no other."""
    path = workshop / "config" / "r_initial_positions.yaml"
    assert (workshop / "config" / "f_initial_positions.yaml").read_bytes() == path.read_bytes()
    path.write_text(path.read_text().replace("elbow_joint: 0.0", "elbow_joint: 1.25"))
    started = {
        joint.get("name"): joint.findtext("state_interface/param")
        for joint in expanded(workshop).iterfind("ros2_control/joint")
    }
    assert started["r_elbow_joint"] == "1.25"
    assert started["f_elbow_joint"] == "0.0"


@pytest.mark.parametrize("hardware", ["mock", "none"])
def test_package_xml_has_the_form_of_rep_149(package: Any, hardware: Any) -> None:
    """Both packages; that of MoveIt needs the other one."""
    description = package("ur5.csv", "aligned", replace(OPTIONS, hardware=hardware))[0]
    for folder in (description, moveit_folder(description)):
        document = etree.parse(folder / "package.xml")
        FORMAT.assertValid(document)
        assert document.findtext("name") == folder.name
    needed = [each.text for each in document.findall("exec_depend")]
    assert "ur5_description" in needed
    assert ("controller_manager" in needed) is (hardware == "mock")


# --- Launch files, executed against a recorder of the names that they use; the packages themselves are in ROS 2 alone

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
    description, _, _ = package("ur5.csv", "aligned", Ros2Options(moveit=True, trials=10))
    launches = sorted(description.with_name("ur5_moveit_config").glob("launch/*.launch.py"))
    assert launches
    for path in launches:
        made = runpy.run_path(str(path))["generate_launch_description"]()
        assert made.name == f"generate_{path.name.removesuffix('.launch.py')}_launch"
        assert made.given == (Made("configs", ("ur5",), {"package_name": "ur5_moveit_config"}),)


def test_the_views_of_rviz_are_fixed_to_the_root(package: Any) -> None:
    """Grid, robot and frames, and the panel for plans; the topics are those of the nodes."""
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
