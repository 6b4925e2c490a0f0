"""The files of a description package, held against the table by an oracle of its own."""

import math
import re
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from lxml import etree

import dh2urdf
from dh2urdf.errors import ConfigError, Dh2UrdfError
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.robot import Robot
from dh2urdf.rotations import RigidTransform
from dh2urdf.stages import Expansion, GivesNotices
from dh2urdf.testing.oracle import robot_pose, table_pose
from dh2urdf_plugins.formats.urdf import EMITTER as URDF, UrdfOptions
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.formats.xacro.reader import read_foreign_xacro
from dh2urdf_plugins.packages.ros2 import EMITTER, PLUGINS, Ros2Options
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

CONFIGS = Path(__file__).parents[4] / "configs"
TABLES = ["ur5.csv", "panda.yaml", "scara.csv", "stanford.csv"]


def dh_product(manipulator: Manipulator, rows: Mapping[str, Mapping[str, float]], q: list[float]) -> Any:
    """T(base → tool) of rows whose numbers may be others than those of the table."""
    return table_pose(replace(manipulator, rows=tuple(replace(row, **rows[row.joint]) for row in manipulator.rows)), q)


def numbers_of(manipulator: Manipulator) -> dict[str, dict[str, float]]:
    return {row.joint: {"a": row.a, "alpha": row.alpha, "d": row.d, "theta": row.theta} for row in manipulator.rows}


def joint_values(robot: Robot, count: int) -> list[list[float]]:
    random = np.random.default_rng(17)
    bounds = [(joint.limits.lower, joint.limits.upper) for joint in robot.moving_joints]
    ends = [(-3.0 if low is None else low, 3.0 if high is None else high) for low, high in bounds]
    return [[float(random.uniform(low, high)) for low, high in ends] for _ in range(count)]


def check_poses(found: Robot, manipulator: Manipulator, rows: Mapping[str, Any], prefix: str = "") -> None:
    for q in joint_values(found, 20):
        pose = np.array(robot_pose(found, q, f"{prefix}base_link", f"{prefix}tool0"))
        assert np.abs(pose - dh_product(manipulator, rows, q)).max() < 1e-12


@pytest.mark.parametrize("frames", ["dh", "aligned"])
@pytest.mark.parametrize("table", TABLES)
def test_the_expanded_description_is_the_urdf_for_ros(package: Any, table: str, frames: str) -> None:
    """Link by link and joint by joint, to the last bit, though its numbers come from YAML files."""
    folder, robot, _ = package(table, frames)
    (plain,) = URDF.emit(robot, "arm", UrdfOptions(profile="ros"))
    expected = parse_urdf(plain.content, "urdf")
    found = read_foreign_xacro(next(folder.glob("urdf/*.urdf.xacro")))
    assert (found.links, found.joints) == (expected.links, expected.joints)


@pytest.mark.parametrize("table", TABLES)
def test_tool0_is_where_the_table_has_it_with_a_prefix_and_on_a_parent(package: Any, table: str) -> None:
    """Within 1e-12 of the DH product at random joint vectors, mounted where xyz and rpy say."""
    folder, _, manipulator = package(table, "dh")
    arguments = {"prefix": "left_", "parent": "table", "xyz": "1 2 3", "rpy": "0 0 0.5"}
    found = read_foreign_xacro(next(folder.glob("urdf/*.urdf.xacro")), Expansion(arguments=arguments))
    assert found.root == "table"
    assert all(
        name.startswith("left_") for name in (*(j.name for j in found.joints), *(k.name for k in found.links[1:]))
    )
    check_poses(found, manipulator, numbers_of(manipulator), "left_")
    mounted = np.array(robot_pose(found, [], "table", "left_base_link"))
    assert np.allclose(
        mounted,
        [[math.cos(0.5), -math.sin(0.5), 0, 1], [math.sin(0.5), math.cos(0.5), 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]],
    )


@pytest.mark.parametrize("frames", ["dh", "aligned"])
def test_the_controller_s_frame_is_where_the_base_of_the_table_is(frames: str, tmp_path: Path) -> None:
    """REP 199: a fixed link without a shape, with the prefix; tool0 stays where it was. Without a base there is none."""
    base = RigidTransform.from_xyz_rpy((0.1, -0.2, 0.3), (0.4, -0.5, math.pi))
    plain = dh2urdf.read(CONFIGS / "tables" / "ur5.csv")
    for manipulator in (plain, replace(plain, base=base)):
        arm = replace(alpha_swap(manipulator, AlphaSwapOptions(frames=frames)), manipulator=manipulator)
        for file in EMITTER.emit(arm, "arm", Ros2Options()):
            path = tmp_path / file.name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(file.content)
        top = tmp_path / "arm_description" / "urdf" / "arm.urdf.xacro"
        found = read_foreign_xacro(top, Expansion(arguments={"prefix": "left_"}))
        frame = [link for link in found.links if link.name == "left_base"]
        assert [(link.visuals, link.collisions, link.inertial) for link in frame] == [((), (), None)] * (
            manipulator is not plain
        )
        check_poses(found, manipulator, numbers_of(manipulator), "left_")
    (joint,) = [joint for joint in found.joints if joint.child == "left_base"]
    assert (joint.name, joint.type, joint.parent) == ("left_base_link-base", JointType.FIXED, "left_base_link")
    pose = np.array(robot_pose(found, [0.0] * 6, "left_base_link", "left_base"))
    assert np.abs(pose - as_matrices(base)).max() < 1e-15


def test_each_arm_of_a_cell_has_the_frame_of_its_controller(cli: Any, tmp_path: Path) -> None:
    """With its prefix, where its table has a base; a link of this name that a table has stays what it is."""
    (tmp_path / "named.csv").write_text(
        "# convention: standard\n# base: {xyz: [0, 0, 1]}\njoint,link,a,alpha,d,lower,upper,velocity,effort\n"
        "turn,base,0.4,0,0.1,-1,1,1,10\n"
    )
    (tmp_path / "run.yaml").write_text(
        f"inputs: [{CONFIGS}/tables/ur5.csv, {CONFIGS}/tables/track.csv, named.csv]\n"
        "cells:\n  - name: lab\n    arms:\n      - {name: left, of: track}\n      - {name: right, of: track, xyz: [1, 0, 0]}\n"
        "      - {name: rider, of: ur5, parent: left/tool0}\n      - {name: own, of: named, xyz: [2, 0, 0]}\n"
        "emitters: [{stage: ros2, options: {license: MIT, maintainer: A, email: a@b.org}}]\n"
    )
    answer = cli("run", tmp_path / "run.yaml", "-o", tmp_path / "out")
    assert "own_base is the name of a link of the table: no frame of the controller is written" in answer.stderr
    found = read_foreign_xacro(tmp_path / "out" / "lab_description" / "urdf" / "lab.urdf.xacro")
    frames = {joint.child: joint.name for joint in found.joints if joint.child.endswith("_base")}
    assert frames == {"left_base": "left_base_link-base", "right_base": "right_base_link-base", "own_base": "own_turn"}
    pose = np.array(robot_pose(found, [0.0] * 9, "right_base_link", "right_base"))
    assert np.abs(pose - as_matrices(dh2urdf.read(CONFIGS / "tables" / "track.csv").base)).max() < 1e-15


@pytest.mark.parametrize("table", TABLES)
def test_a_calibrated_table_takes_the_place_of_a_file(package: Any, table: str) -> None:
    """Other lengths and angles in a YAML file of the same form, and the arm is the one of these rows; both conventions."""
    folder, _, manipulator = package(table, "dh")
    random = np.random.default_rng(3)
    rows = {
        joint: {name: float(value + random.normal(scale=2e-3)) for name, value in row.items()}
        for joint, row in numbers_of(manipulator).items()
    }
    content = yaml.safe_load((folder / "config" / "dh.yaml").read_text())
    assert content["dh"]["joints"] == numbers_of(manipulator)
    content["dh"]["joints"] = rows
    calibrated = folder / "config" / "calibrated.yaml"
    calibrated.write_text(yaml.safe_dump(content))
    arguments = {"dh_file": str(calibrated), "prefix": "a_"}
    found = read_foreign_xacro(next(folder.glob("urdf/*.urdf.xacro")), Expansion(arguments=arguments))
    check_poses(found, manipulator, rows, "a_")


def test_limits_and_masses_come_from_files(package: Any) -> None:
    """Another file of limits changes the limits, another one of masses the masses."""
    folder, robot, _ = package("ur5.csv", "dh")
    limits = yaml.safe_load((folder / "config" / "joint_limits.yaml").read_text())
    numbers = {"min_position": -1.0, "max_position": 2.0, "max_velocity": 0.5, "max_effort": 7.0}
    limits["joint_limits"]["elbow_joint"] = numbers
    bodies = yaml.safe_load((folder / "config" / "physical_parameters.yaml").read_text())
    bodies["links"][robot.links[4].name]["mass"] = 99.5
    for name, content in (("limits", limits), ("bodies", bodies)):
        (folder / "config" / f"{name}.yaml").write_text(yaml.safe_dump(content))
    arguments = {
        "limits_file": str(folder / "config" / "limits.yaml"),
        "physical_file": str(folder / "config" / "bodies.yaml"),
    }
    found = read_foreign_xacro(folder / "urdf" / "ur5.urdf.xacro", Expansion(arguments=arguments))
    elbow = next(joint for joint in found.joints if joint.name == "elbow_joint")
    assert (elbow.limits.lower, elbow.limits.upper, elbow.limits.velocity, elbow.limits.effort) == (-1.0, 2.0, 0.5, 7.0)
    assert 99.5 in [link.inertial.mass for link in found.links if link.inertial]


def test_two_arms_are_called_by_hand_one_of_them_without_an_origin(package: Any) -> None:
    """One macro, two prefixes and two calibrations: nothing of the first arm is in the second."""
    folder, _, manipulator = package("ur5.csv", "dh")
    rows = numbers_of(manipulator)
    rows["elbow_joint"]["a"] -= 0.01
    content = {"dh": {"hash": "x", "joints": rows}}
    (folder / "config" / "other.yaml").write_text(yaml.safe_dump(content))
    scene = folder / "urdf" / "scene.urdf.xacro"
    scene.write_text(
        """<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="scene">
  <xacro:include filename="$(find ur5_description)/urdf/ur5_macro.xacro"/>
  <link name="world"/>
  <xacro:ur5_at prefix="l_" parent="world" dh_file="$(find ur5_description)/config/other.yaml"/>
  <xacro:ur5 prefix="r_" parent="world"><origin xyz="0 1 0" rpy="0 0 0"/></xacro:ur5>
</robot>"""
    )
    found = read_foreign_xacro(scene)
    assert len(found.moving_joints) == 12
    q = [0.1 * place for place in range(6)]
    for prefix, numbers, y in (("l_", rows, 0.0), ("r_", numbers_of(manipulator), 1.0)):
        expected = dh_product(manipulator, numbers, q)
        expected[1, 3] += y
        assert np.abs(np.array(robot_pose(found, q, "world", f"{prefix}tool0")) - expected).max() < 1e-12


# --- YAML -------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("table", TABLES)
def test_all_files_have_the_same_joints_and_typed_numbers(package: Any, table: str) -> None:
    """The moving joints in their order, each real a float, initial positions inside the limits."""
    folder, robot, _ = package(table, "dh")
    read = {path.name: yaml.safe_load(path.read_text()) for path in folder.glob("config/*.yaml")}
    names = [joint.name for joint in robot.moving_joints]
    positions = read["initial_positions.yaml"]["initial_positions"]
    limits = read["joint_limits.yaml"]["joint_limits"]
    controller = read["ros2_controllers.yaml"]["joint_trajectory_controller"]["ros__parameters"]
    assert list(positions) == list(limits) == controller["joints"] == names
    numbers = [*positions.values(), *(value for row in limits.values() for value in row.values())]
    numbers += [value for row in read["dh.yaml"]["dh"]["joints"].values() for value in row.values()]
    for body in read["physical_parameters.yaml"]["links"].values():
        numbers += [body["mass"], *body["com"], *body["inertia"].values()]
    assert {type(number) for number in numbers} == {float}
    for name, value in positions.items():
        assert limits[name].get("min_position", -math.inf) <= value <= limits[name].get("max_position", math.inf)


def test_ros2_control_has_the_joints_and_the_chosen_hardware(package: Any) -> None:
    """Command and state interfaces for each joint; the plugin of Gazebo comes with its hardware alone."""
    folder, robot, _ = package("ur5.csv", "aligned")
    top = folder / "urdf" / "ur5.urdf.xacro"
    for hardware, plugin in PLUGINS.items():
        arguments = {"hardware": hardware, "prefix": "01"}  # Of which xacro would make 1, were it not in quotes.
        root = etree.fromstring(expand_foreign(top, Expansion(arguments=arguments)).content)
        (control,) = root.findall("ros2_control")
        assert control.get("name") == "01ur5"
        assert control.findtext("hardware/plugin") == plugin
        joints = control.findall("joint")
        assert [each.get("name") for each in joints] == [f"01{joint.name}" for joint in robot.moving_joints]
        assert {f"01{joint.name}" for joint in robot.joints} == {each.get("name") for each in root.iterfind("joint")}
        assert [float(each.findtext("state_interface/param[@name='initial_value']")) for each in joints] == [0.0] * 6
        assert (root.find("gazebo/plugin") is not None) is (hardware == "gazebo")


def test_the_argument_hardware_is_one_of_the_options_words(package: Any) -> None:
    """`hardware:=none` leaves ros2_control out; xacro refuses any other word, also the name of a plugin."""
    folder, robot, _ = package("ur5.csv", "aligned", Ros2Options(hardware="gazebo"))
    top = folder / "urdf" / "ur5.urdf.xacro"
    root = etree.fromstring(expand_foreign(top, Expansion(arguments={"hardware": "none"})).content)
    assert root.find("ros2_control") is None
    assert root.find("gazebo") is None
    assert len(root.findall("joint")) == len(robot.joints)
    for other in ("gz_ros2_control/GazeboSimSystem", ""):
        with pytest.raises(Dh2UrdfError):
            expand_foreign(top, Expansion(arguments={"hardware": other}))


@pytest.mark.parametrize(
    ("options", "states"),
    [
        (("position",), ["position", "velocity"]),
        (("position", "velocity"), ["position", "velocity"]),
        (("effort", "position"), ["position", "velocity", "effort"]),
    ],
)
def test_joints_have_the_interfaces_that_are_asked_for(package: Any, options: Any, states: list[str]) -> None:
    """Beside positions, on request; the trajectory controller stays with positions."""
    folder, _, _ = package("ur5.csv", "aligned", Ros2Options(command_interfaces=options))
    root = etree.fromstring(expand_foreign(folder / "urdf" / "ur5.urdf.xacro", Expansion()).content)
    for joint in root.findall("ros2_control/joint"):
        assert [each.get("name") for each in joint.findall("command_interface")] == list(options)
        assert [each.get("name") for each in joint.findall("state_interface")] == states
    (controller,) = [
        each["ros__parameters"]
        for each in yaml.safe_load((folder / "config" / "ros2_controllers.yaml").read_text()).values()
        if "command_interfaces" in each["ros__parameters"]
    ]
    assert controller["command_interfaces"] == ["position"]


@pytest.mark.parametrize("options", [("velocity",), (), ("position", "position")])
def test_positions_are_always_commanded(options: Any) -> None:
    """The controller that is written needs them."""
    with pytest.raises(ConfigError) as caught:
        Ros2Options(command_interfaces=options)
    assert caught.value.problems[0].field == "command_interfaces"


def test_without_hardware_there_is_no_ros2_control(package: Any) -> None:
    """No element, no controllers, no dependency on them."""
    folder, _, _ = package("ur5.csv", "aligned", Ros2Options(hardware="none"))
    names = {str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file()}
    assert not [name for name in names if "control" in name or "initial" in name]
    assert b"controller" not in (folder / "package.xml").read_bytes()
    assert b"ros2_control" not in (folder / "urdf" / "ur5.urdf.xacro").read_bytes()


def test_aligned_frames_have_no_table_to_replace(package: Any) -> None:
    """The angles of the table are in the axes: a table with others would be another arm, and no file invites it."""
    folder, _, _ = package("ur5.csv", "aligned")
    assert not (folder / "config" / "dh.yaml").exists()
    assert "dh_file" not in (folder / "urdf" / "ur5_macro.xacro").read_text()
    assert "run dh2urdf on the calibrated table" in (folder / "README.md").read_text().replace("\n", " ")


# --- Names ------------------------------------------------------------------------------------------------------------


def test_what_a_person_gives_is_in_package_xml(package: Any) -> None:
    """Maintainer, address, license and version; the license has a file then."""
    options = Ros2Options(maintainer="A & B", email="a@b.org", license="BSD-3-Clause", version="2.1.0", package="lab")
    folder, _, _ = package("ur5.csv", "aligned", options)
    root = etree.parse(folder / "package.xml").getroot()
    assert folder.name == root.findtext("name") == "lab_description"
    assert (root.findtext("maintainer"), root.find("maintainer").get("email")) == ("A & B", "a@b.org")
    assert (root.findtext("license"), root.findtext("version")) == ("BSD-3-Clause", "2.1.0")
    assert (folder / "LICENSE").read_text() == "SPDX-License-Identifier: BSD-3-Clause\n"
    assert (folder / "urdf" / "lab.urdf.xacro").is_file()


NO_TEXTS = re.compile(
    r"[yYnN]|yes|Yes|YES|no|No|NO|true|True|TRUE|false|False|FALSE|on|On|ON|off|Off|OFF"
    r"|[-+]?(?:0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)"
    r"|[-+]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?"
    r"|[-+]?0[xX](?:[0-9a-fA-F]+\.?[0-9a-fA-F]*|\.[0-9a-fA-F]+)(?:[pP][-+]?[0-9]+)?"
    r"|[-+]?(?i:inf|infinity|nan)"
)
"""The words without quotes that rcl_yaml_param_parser, `get_value` in parse.c, takes for truth values and numbers."""
JOINTS = ["x", "y", "z", "n", "Y", "1e3", "0x10", "0x1p3", "inf", "NaN", "infinity", "08", "-1", "yes", "off", "1_000"]


def test_names_of_joints_are_texts_to_ros() -> None:
    """A gantry of x, y and z: ROS has a parser of its own, to which `y` is true and `1e3` a number.

    A sequence of texts with a truth value in it ends each node that reads the file.
    """
    row = dh2urdf.read(CONFIGS / "tables" / "ur5.csv").rows[1]
    arm = dh2urdf.read(CONFIGS / "tables" / "ur5.csv")
    rows = tuple(replace(row, joint=name, link=f"link_{number}") for number, name in enumerate(JOINTS))
    robot = alpha_swap(replace(arm, rows=rows), AlphaSwapOptions(frames="dh"))
    files = {file.name: file.content.decode() for file in EMITTER.emit(robot, "arm", Ros2Options())}
    for name, text in files.items():
        if name.endswith(".yaml"):
            plain = [token.value for token in yaml.scan(text) if isinstance(token, yaml.ScalarToken) and token.plain]
            words = [word for word in plain if NO_TEXTS.fullmatch(word)]
            assert not set(words) & set(JOINTS), name
    controllers = yaml.safe_load(files["arm_description/config/ros2_controllers.yaml"])
    assert controllers["joint_trajectory_controller"]["ros__parameters"]["joints"] == JOINTS


def test_moveit_does_not_start_with_joints_that_are_no_texts() -> None:
    """launch_ros writes parameters with `yaml.dump`, which leaves `y` and `1e3` without quotes: a notice for each."""
    arm = dh2urdf.read(CONFIGS / "tables" / "ur5.csv")
    rows = tuple(
        replace(row, joint=name) for row, name in zip(arm.rows, ("x", "y", "z", "1e3", "yes", "q"), strict=True)
    )
    robot = alpha_swap(replace(arm, rows=rows), AlphaSwapOptions(frames="dh"))
    gives = EMITTER.can(GivesNotices)
    told = [notice.message for notice in gives.notices(robot, Ros2Options(moveit=True))]
    told = [message for message in told if "launch_ros" in message]
    lost = [name for name in ("x", "y", "z", "1e3", "yes", "q") if NO_TEXTS.fullmatch(yaml.dump([name])[2:-1])]
    assert lost == ["y", "1e3"]
    assert [message.partition("'")[2].partition("'")[0] for message in told] == lost
    assert not [notice for notice in gives.notices(robot, Ros2Options()) if "launch_ros" in notice.message]


@pytest.mark.parametrize("prefix", ["left-arm_", "1_"])
def test_a_prefix_that_no_node_can_have(tmp_path: Path, prefix: str) -> None:
    """A controller is a node, whose name begins with the prefix of its arm; without controllers any prefix will do."""
    run = {
        "inputs": str(CONFIGS / "tables" / "ur5.csv"),
        "cells": [{"name": "cell", "arms": [{"name": "one", "of": "ur5", "prefix": prefix}]}],
        "emitters": [{"stage": "ros2", "options": {}}],
        "output": {"directory": str(tmp_path / "out")},
        "report": {"html": False},
    }
    (failed,) = [each for each in dh2urdf.run(run)["manipulators"] if each["status"] == "failed"]
    assert failed["errors"][0]["found"] == prefix
    run["emitters"] = [{"stage": "ros2", "options": {"hardware": "none"}}]
    assert not [each for each in dh2urdf.run(run)["manipulators"] if each["status"] == "failed"]


def test_the_readme_names_any_robot(cli: Any, tmp_path: Path) -> None:
    """Also one whose name is that of a place in the template: another text was there."""
    name = "@USE@ & @CALIBRATION@"
    (tmp_path / f"{name}.csv").write_bytes((CONFIGS / "tables/ur5.csv").read_bytes())
    cli("convert", f"{name}.csv", "--to", "ros2", "--set", "package=my_arm", "-o", "src")
    readme = (tmp_path / "src/my_arm_description/README.md").read_text()
    assert "The description of @USE@ &#38; @CALIBRATION@ for ROS 2" in readme
