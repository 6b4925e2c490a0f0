"""SRDFs of robots and cells: what srdfdom reads, with names that the URDF has."""

from dataclasses import replace
from pathlib import Path

import pytest
from command_line import Cli
from lxml import etree

import dh2urdf
from dh2urdf.errors import EmitterError
from dh2urdf.manipulator import Limits
from dh2urdf.robot import Robot
from dh2urdf_plugins.formats import urdf
from dh2urdf_plugins.packages.srdf import EMITTER, SrdfOptions
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap

pytest.importorskip("pinocchio")

TABLES = Path(__file__).parents[4] / "configs" / "tables"
SCHEMA = etree.RelaxNG(etree.parse(Path(__file__).with_name("srdf.rng")))
OPTIONS = SrdfOptions(trials=300)
CELL = f"""
inputs: [{TABLES}/ur5.csv, {TABLES}/track.csv]
cells:
  - name: workshop
    arms:
      - {{name: track, of: track}}
      - {{name: rider, of: ur5, parent: track/tool0}}
      - {{name: fixed, of: ur5, prefix: f_, xyz: [-0.6, 0, 0]}}
emitters: [urdf, {{stage: srdf, options: {{trials: 300}}}}]
"""


def robot_of(table: str, limits: Limits | None = None) -> Robot:
    robot = alpha_swap(dh2urdf.read(TABLES / table), AlphaSwapOptions())
    if limits is None:
        return robot
    joints = tuple(replace(joint, limits=limits) if joint in robot.moving_joints else joint for joint in robot.joints)
    return replace(robot, joints=joints)


def made(robot: Robot, options: SrdfOptions = OPTIONS) -> tuple[etree._Element, etree._Element]:
    """The SRDF and the URDF of a robot."""
    (file,) = EMITTER.emit(robot, "arm", options)
    assert file.name == "arm.srdf"
    (description,) = urdf.EMITTER.emit(robot, "arm", urdf.UrdfOptions())
    return checked(file.content, description.content)


def checked(srdf: bytes, description: bytes) -> tuple[etree._Element, etree._Element]:
    """The trees of an SRDF and a URDF: the first has the form of SRDFs, names of the second, and chains in it."""
    semantic, model = etree.fromstring(srdf), etree.fromstring(description)
    SCHEMA.assertValid(semantic)
    assert semantic.get("name") == model.get("name")
    links = {each.get("name") for each in model.findall("link")}
    parents = {each.find("child").get("link"): each for each in model.findall("joint")}
    moving = {each.get("name") for each in model.findall("joint") if each.get("type") != "fixed"}
    groups = {each.get("name"): each for each in semantic.findall("group")}
    for each in semantic.findall("disable_collisions"):
        assert {each.get("link1"), each.get("link2")} <= links
    for each in semantic.iter("chain"):
        link, joints = each.get("tip_link"), 0
        while link != each.get("base_link"):
            joints += parents[link].get("name") in moving
            link = parents[link].find("parent").get("link")
        assert joints
    for state in semantic.findall("group_state"):
        assert state.get("group") in groups
        for each in state:
            assert each.get("name") in moving
            joint = next(joint for joint in model.findall("joint") if joint.get("name") == each.get("name"))
            limit = joint.find("limit")
            if limit.get("lower") is not None:
                assert float(limit.get("lower")) <= float(each.get("value")) <= float(limit.get("upper"))
    return semantic, model


class TestOneArm:
    @pytest.mark.parametrize("table", ["ur5.csv", "panda.yaml", "scara.csv", "track.csv"])
    def test_it_has_one_group_from_base_link_to_tool0(self, table: str) -> None:
        semantic, _ = made(robot_of(table))
        (held,) = semantic.findall("virtual_joint")
        assert (held.get("parent_frame"), held.get("child_link"), held.get("type")) == ("world", "base_link", "fixed")
        (group,) = semantic.findall("group")
        assert group.get("name") == "manipulator"
        assert [dict(each.attrib) for each in group] == [{"base_link": "base_link", "tip_link": "tool0"}]

    def test_the_state_is_zero_where_0_is_within_all_limits(self) -> None:
        semantic, model = made(robot_of("ur5.csv"))
        (state,) = semantic.findall("group_state")
        assert state.get("name") == "zero"
        moving = [each.get("name") for each in model.findall("joint") if each.get("type") != "fixed"]
        assert [(each.get("name"), each.get("value")) for each in state] == [(name, "0") for name in moving]

    def test_the_state_is_home_where_0_is_outside(self) -> None:
        limits = Limits(lower=0.5, upper=1.0, velocity=1.0, effort=1.0)
        (state,) = made(robot_of("ur5.csv", limits))[0].findall("group_state")
        assert state.get("name") == "home"
        assert {each.get("value") for each in state} == {"0.75"}

    def test_the_group_has_the_name_that_is_given(self) -> None:
        semantic, _ = made(robot_of("scara.csv"), SrdfOptions(trials=10, group="arm"))
        assert semantic.find("group").get("name") == semantic.find("group_state").get("group") == "arm"
        with pytest.raises(EmitterError):
            made(robot_of("scara.csv"), SrdfOptions(trials=10, group=" "))


def test_what_an_arm_holds_is_an_end_effector(cli: Cli, tmp_path: Path) -> None:
    """A gripper at a flange or a tool, of fewer joints; neither an arm on a track, nor what stands on the floor.

    The flange is beside the way to tool0, and MoveIt looks for the parent link in the parent group.
    """
    (tmp_path / "gripper.csv").write_text(
        "# convention: standard\njoint,type,a,alpha,d,lower,upper,velocity,effort\njaw,prismatic,0,0,0.02,0,0.05,0.1,20\n"
    )
    held = (
        "      - {name: hand, of: gripper, parent: fixed/flange}\n      - {name: shelf, of: gripper, xyz: [2, 0, 0]}\n"
    )
    text = CELL.replace(f"{TABLES}/track.csv", f"{TABLES}/track.csv, gripper.csv").replace(
        "emitters:", held + "emitters:"
    )
    (tmp_path / "run.yaml").write_text(text)
    cli("run", tmp_path / "run.yaml", "-o", tmp_path / "out")
    out = tmp_path / "out"
    semantic, _ = checked((out / "workshop.srdf").read_bytes(), (out / "workshop.urdf").read_bytes())
    assert [dict(each.attrib) for each in semantic.findall("end_effector")] == [
        {"name": "hand", "parent_link": "f_link_6", "group": "hand_manipulator", "parent_group": "f_manipulator"}
    ]


def test_a_cell_has_a_group_for_each_arm_and_one_of_all(cli: Cli, tmp_path: Path) -> None:
    """Its root is world, so nothing is held by it; chains go over the arm's own joints."""
    (tmp_path / "run.yaml").write_text(CELL)
    cli("run", tmp_path / "run.yaml", "-o", tmp_path / "out")
    out = tmp_path / "out"
    semantic, model = checked((out / "workshop.srdf").read_bytes(), (out / "workshop.urdf").read_bytes())
    assert semantic.findall("virtual_joint") == []
    groups = {group.get("name"): group for group in semantic.findall("group")}
    arms = ["track_manipulator", "rider_manipulator", "f_manipulator"]
    assert list(groups) == [*arms, "track_rider_manipulator", "all"]
    assert dict(groups["rider_manipulator"][0].attrib) == {"base_link": "rider_base_link", "tip_link": "rider_tool0"}
    assert [each.get("name") for each in groups["all"]] == arms
    states = {state.get("group"): [each.get("name") for each in state] for state in semantic.findall("group_state")}
    moving = [each.get("name") for each in model.findall("joint") if each.get("type") != "fixed"]
    assert sorted(states["all"]) == sorted(moving)
    assert len(states["rider_manipulator"]) == 6
    # The two arms can meet: their links are checked against each other.
    disabled = {(each.get("link1"), each.get("link2")) for each in semantic.findall("disable_collisions")}
    assert ("f_link_3", "rider_link_3") not in disabled
    again = tmp_path / "again"
    cli("run", tmp_path / "run.yaml", "-o", again)
    assert (again / "workshop.srdf").read_bytes() == (out / "workshop.srdf").read_bytes()
