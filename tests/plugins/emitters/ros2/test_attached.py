"""Packages and SRDFs of arms that hold something: a hand with a joint that follows another one, and its files."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from lxml import etree
from two_fingers import HAND

import dh2urdf
from dh2urdf.cells.attachments import attached
from dh2urdf.cells.cell import ArmCall, Cell, CellCall, compose
from dh2urdf.errors import EmitterError
from dh2urdf.robot import Origin, Robot
from dh2urdf.stages import Expansion, GivesNotices
from dh2urdf_plugins.collision_pairs.options import PairOptions
from dh2urdf_plugins.collision_pairs.search import robot_pairs
from dh2urdf_plugins.edits.attach import AttachOptions
from dh2urdf_plugins.formats import mjcf
from dh2urdf_plugins.formats.urdf import EMITTER as URDF, UrdfOptions
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.packages.ros2 import EMITTER, Ros2Options
from dh2urdf_plugins.packages.srdf import EMITTER as SRDF, SrdfOptions
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap
from dh2urdf_plugins.xacro_fence.expansion import expand_foreign

HERE = Path(__file__).parent
UR5 = HERE.parents[3] / "configs" / "tables" / "ur5.csv"
SEMANTICS = etree.RelaxNG(etree.parse(HERE.parent / "srdf" / "srdf.rng"))
PLANNED = Ros2Options(moveit=True, trials=300)
TETRAHEDRON = """solid tip
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0.02 0 vertex 0.02 0 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0.02 0 0 vertex 0 0 0.02 endloop endfacet
facet normal 0 0 0 outer loop vertex 0 0 0 vertex 0 0 0.02 vertex 0 0.02 0 endloop endfacet
facet normal 0 0 0 outer loop vertex 0.02 0 0 vertex 0 0.02 0 vertex 0 0 0.02 endloop endfacet
endsolid tip
"""


def arm(**options: Any) -> Robot:
    """A UR5 with a hand, whose efforts are those that it needs."""
    table = dh2urdf.read(UR5)
    rows = tuple(replace(row, limits=replace(row.limits, effort=None)) for row in table.rows)
    return holding(alpha_swap(replace(table, rows=rows), AlphaSwapOptions(frames="dh")), **options)


def holding(robot: Robot, **options: Any) -> Robot:
    """A robot with a hand, whose joints have no hardware of their own unless that is asked for."""
    given = {"file": HAND, "name": "hand", "keep": "none", "xyz": (0.0, 0.0, 0.011), **options}
    return attached(robot, AttachOptions(**given).attachment[0])


def two_arms() -> Robot:
    """A cell of two arms with a hand each, of which one bears another one, and a hand on the floor."""
    kind = arm()
    calls = [
        ArmCall(name=name, of="ur5", prefix=f"{name}_", placement=Origin(xyz=(at, 0.0, 0.0)))
        for name, at in (("left", 0.0), ("right", 1.0))
    ]
    cell = compose(Cell(call=CellCall(name="cell", arms=tuple(calls)), manipulators={}), {"ur5": kind})
    return holding(holding(cell, name="floor", parent="world"), name="extra", parent="left_hand_tool0")


def written(robot: Robot, folder: Path, options: Ros2Options = PLANNED, name: str = "cell") -> tuple[Path, Path]:
    """The folders of the description and of the configuration of MoveIt."""
    for file in EMITTER.emit(robot, name, options):
        path = folder / file.name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(file.content)
    return folder / f"{name}_description", folder / f"{name}_moveit_config"


def expanded(path: Path, **arguments: str) -> etree._Element:
    expansion = Expansion(arguments=arguments, package_paths=(path.parents[2],))
    return etree.fromstring(expand_foreign(path, expansion).content)


@pytest.mark.parametrize("make", [arm, two_arms])
def test_the_expanded_description_is_the_urdf_for_ros(make: Any, tmp_path: Path) -> None:
    """Link by link and joint by joint, with laws of followers and efforts that bear the hands."""
    robot = make()
    (plain,) = URDF.emit(robot, "arm", UrdfOptions(profile="ros"))
    expected = parse_urdf(plain.content, "urdf")
    description, _ = written(robot, tmp_path, Ros2Options())
    found = parse_urdf(etree.tostring(expanded(description / "urdf" / "cell.urdf.xacro")), "xacro")
    roots = (
        {link.name for link in expected.links if link.name.endswith("base_link") and not link.inertial.mass}
        if robot.arms
        else set()
    )
    links = {link.name: replace(link, inertial=None) if link.name in roots else link for link in expected.links}
    assert {link.name: link for link in found.links} == links
    assert {joint.name: joint for joint in found.joints} == {joint.name: joint for joint in expected.joints}
    assert found.followers.keys() == robot.followers.keys() != set()


def test_a_joint_that_follows_has_states_and_no_commands(tmp_path: Path) -> None:
    """What ros2_control demands since Jazzy: no commands for it, and its leader in the same element (component_parser)."""
    options = Ros2Options(command_interfaces=("position", "effort"))
    description, _ = written(arm(), tmp_path, options)
    root = expanded(description / "urdf" / "cell.urdf.xacro", prefix="l_")
    systems = {each.get("name"): each for each in root.findall("ros2_control")}
    assert list(systems) == ["l_cell", "l_hand_part_hand"]
    joints = {each.get("name"): each for each in systems["l_hand_part_hand"].findall("joint")}
    commands = {
        name: [each.get("name") for each in joint.findall("command_interface")] for name, joint in joints.items()
    }
    assert commands == {"l_hand_right": [], "l_hand_left": ["position", "effort"]}
    assert {each.get("name") for each in joints["l_hand_right"].findall("state_interface")} >= {"position", "velocity"}
    leaders = {
        each.get("name"): each.find("mimic").get("joint")
        for each in root.findall("joint")
        if len(each.findall("mimic"))
    }
    assert leaders == {"l_hand_right": "l_hand_left"}


def test_a_hand_with_a_system_of_its_own_keeps_it(tmp_path: Path) -> None:
    """No joint is in two elements: a notice says that the hardware of the hand is its own."""
    robot = arm(keep=None)
    description, _ = written(robot, tmp_path, Ros2Options())
    root = expanded(description / "urdf" / "cell.urdf.xacro")
    assert [each.get("name") for each in root.findall("ros2_control")] == ["hand_system", "cell"]
    joints = [each.get("name") for each in root.iterfind("ros2_control/joint")]
    assert sorted(joints) == sorted({*joints})
    notices = EMITTER.can(GivesNotices).notices
    assert "part-drives-itself" in {each.code for each in notices(robot, Ros2Options())}
    assert "part-drives-itself" not in {each.code for each in notices(arm(), Ros2Options())}


@pytest.mark.parametrize(
    ("joints", "systems"),
    [
        (
            '<sensor name="force"><state_interface name="x"/></sensor><gpio name="valve"/>',
            ["force", "left", "right", "b"],
        ),
        ('<joint name="left"/>', ["left", "b"]),
        ('<joint name="b"/>', ["b", "left", "right"]),
    ],
)
def test_joints_without_a_system_of_the_hand_get_one(joints: str, systems: list[str], tmp_path: Path) -> None:
    """A block of sensors drives nothing, and one of some joints not the others; a follower goes with its leader."""
    more = (
        '<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
        '</link><joint name="b" type="continuous"><parent link="base_link"/><child link="b"/></joint>'
    )
    hand = HAND.read_text().replace('<joint name="left"><param name="mimic">right</param></joint>', joints)
    (tmp_path / "hand.urdf").write_text(hand.replace("</robot>", f"{more}</robot>"))
    robot = arm(file=tmp_path / "hand.urdf", keep=None)
    description, _ = written(robot, tmp_path, Ros2Options())
    blocks = expanded(description / "urdf" / "cell.urdf.xacro").findall("ros2_control")
    names = [each.get("name") for block in blocks for each in block if str(each.get("name")).startswith("hand_")]
    assert sorted({*names} - {"hand_valve"}) == sorted(f"hand_{name}" for name in systems)
    assert len(names) == len({*names})
    own = yaml.safe_load(next((description / "config").glob("part_*/initial_positions.yaml")).read_text())
    driven = {name for name in systems if f"hand_{name}" not in {each.get("name") for each in blocks[0]}}
    assert own["initial_positions"].keys() == driven - {"right", "force"}


def test_each_hand_has_a_controller_a_file_and_a_group(tmp_path: Path) -> None:
    """Followers are in none of them; the limits of MoveIt are those of all joints that move by themselves."""
    robot = two_arms()
    description, moveit = written(robot, tmp_path)
    parts = ["left_hand", "right_hand", "floor", "extra"]
    for folder in (description, moveit):
        manager = yaml.safe_load((folder / "config" / "ros2_controllers.yaml").read_text())
        joints = {
            name: each["ros__parameters"]["joints"] for name, each in manager.items() if name != "controller_manager"
        }
        assert [name.removesuffix("_joint_trajectory_controller") for name in joints] == ["left", "right", *parts]
        assert sorted(name for names in joints.values() for name in names) == sorted(
            joint.name for joint in robot.actuated_joints
        )
        assert joints["floor_joint_trajectory_controller"] == ["floor_left"]
    planned = yaml.safe_load((moveit / "config" / "joint_limits.yaml").read_text())["joint_limits"]
    assert list(planned) == [joint.name for joint in robot.actuated_joints]
    path = moveit / "config" / "floor_initial_positions.yaml"
    path.write_text(path.read_text().replace("left: 0.0", "left: 0.25"))
    root = expanded(moveit / "config" / "cell.urdf.xacro")
    started = {each.get("name"): each.findtext("state_interface/param") for each in root.iterfind("ros2_control/joint")}
    assert (started["floor_left"], started["extra_left"], started["extra_right"]) == ("0.25", "0.0", None)
    kinds = {path.parent.name for path in description.glob("config/*/joint_limits.yaml")}
    assert kinds == {"ur5", "ur5_2"}  # the arm that bears another hand has other efforts


def test_a_part_that_is_twice_in_a_cell_is_one_macro(tmp_path: Path) -> None:
    """Called after the part; its meshes are once in the package, in a folder of its name, and named by package://."""
    maker = tmp_path / "maker"
    (maker / "meshes").mkdir(parents=True)
    (maker / "meshes" / "tip.stl").write_text(TETRAHEDRON)
    shape = '<geometry><mesh filename="meshes/tip.stl"/></geometry>'
    (maker / "hand.urdf").write_text(
        f'<robot name="hand"><link name="palm"><visual>{shape}</visual><collision>{shape}</collision></link></robot>'
    )
    part = AttachOptions(file=maker / "hand.urdf", name="gripper").attachment[0]
    calls = [ArmCall(name=name, of="ur5", prefix=f"{name}_") for name in ("left", "right")]
    for name in ("left", "right"):
        tool = f"{name}_tool"
        calls.append(ArmCall(name=tool, of="gripper", prefix=f"{tool}_", parent=name, link="tool0", part=part))
    robot = compose(
        Cell(call=CellCall(name="cell", arms=tuple(calls)), manipulators={}), {"ur5": arm(file=maker / "hand.urdf")}
    )
    description, _ = written(robot, tmp_path, Ros2Options())
    macros = etree.parse(str(description / "urdf" / "cell_parts.xacro")).findall("{*}macro")
    assert [each.get("name") for each in macros] == ["part_gripper", "part_hand"]
    root = expanded(description / "urdf" / "cell.urdf.xacro")
    found: dict[str, set[str]] = {}
    for link in root.findall("link"):
        if link.get("name").endswith("_palm"):
            found[link.get("name")] = {each.get("filename") for each in link.iter("mesh")}
    (copy,) = (tmp_path / "cell_description" / "meshes" / "gripper").iterdir()
    assert copy.read_text() == TETRAHEDRON
    files = {name: {f"package://cell_description/meshes/{name}/{copy.name}"} for name in ("gripper", "hand")}
    sides = ("left", "right")
    assert found == {
        **{f"{side}_hand_palm": files["hand"] for side in sides},
        **{f"{side}_tool_palm": files["gripper"] for side in sides},
    }


def test_a_name_that_no_controller_can_have(tmp_path: Path) -> None:
    with pytest.raises(EmitterError) as caught:
        written(arm(name="1_hand", prefix="h_"), tmp_path, Ros2Options())
    assert [each.code for each in caught.value.problems] == ["ros-part-wrong"]
    written(arm(name="1_hand", prefix="h_"), tmp_path, Ros2Options(hardware="none"))


# --- SRDF -------------------------------------------------------------------------------------------------------------


def semantics(robot: Robot) -> etree._Element:
    (file,) = SRDF.emit(robot, "arm", SrdfOptions(trials=300))
    root = etree.fromstring(file.content)
    SEMANTICS.assertValid(root)
    return root


def test_a_hand_is_a_group_and_an_end_effector() -> None:
    """MoveIt looks for the parent link in the parent group: on a flange, the link that the group goes through."""
    pytest.importorskip("pinocchio")
    for parent, expected in (("tool0", "tool0"), ("flange", "link_6"), ("link_4", None)):
        robot = arm(parent=parent)
        root = semantics(robot)
        arm_group, hand = root.findall("group")
        assert dict(arm_group[0].attrib) == {"base_link": "base_link", "tip_link": "tool0"}
        links = [f"hand_{name}" for name in ("base_link", "right_finger", "left_finger", "tool0")]
        assert (hand.get("name"), sorted(each.get("name") for each in hand)) == ("hand", sorted(links))
        effectors = [dict(each.attrib) for each in root.findall("end_effector")]
        wanted = {"name": "hand", "parent_link": expected, "group": "hand", "parent_group": "manipulator"}
        assert effectors == ([wanted] if expected else [])
        assert [each.get("name") for each in root.findall("passive_joint")] == ["hand_right"]
        states = {each.get("group"): [joint.get("name") for joint in each] for each in root.findall("group_state")}
        assert states["hand"] == ["hand_left"]
        assert len(states["manipulator"]) == 6


def test_followers_are_in_the_order_of_the_joints() -> None:
    """As from every process: a set of names has another order in each."""
    pytest.importorskip("pinocchio")
    robot = two_arms()
    names = [each.get("name") for each in semantics(robot).findall("passive_joint")]
    assert names == [each.name for each in robot.joints if each.follows] == list(robot.followers)


def test_the_group_of_the_arm_ends_at_the_tip() -> None:
    pytest.importorskip("pinocchio")
    chain = semantics(arm(tip="tool0")).find("group/chain")
    assert dict(chain.attrib) == {"base_link": "base_link", "tip_link": "hand_tool0"}
    (named,) = [each for each in semantics(two_arms()).findall("end_effector") if each.get("name") == "right_hand"]
    assert dict(named.attrib) == {
        "name": "right_hand",
        "parent_link": "right_tool0",
        "group": "right_hand",
        "parent_group": "right_manipulator",
    }


HAND_SRDF = """<robot name="hand"><!-- @ is where a prefix comes -->
  <virtual_joint name="v" type="fixed" parent_frame="world" child_link="base_link"/>
  <group name="@fingers"><link name="@left_finger"/><joint name="@left"/></group>
  <group name="@reach"><chain base_link="@base_link" tip_link="@tool0"/></group>
  <group name="@every"><group name="@fingers"/><group name="@reach"/></group>
  <group_state name="open" group="@fingers"><joint name="@left" value="0.5"/></group_state>
  <end_effector name="@grip" parent_link="@tool0" group="@fingers"/>
  <end_effector name="@tips" parent_link="@base_link" group="@fingers" parent_group="@reach"/>
  <passive_joint name="@right"/>
  <joint_property joint_name="@left" property_name="angular_distance_weight" value="2"/>
  <disable_default_collisions link="@tool0"/>
  <enable_collisions link1="@tool0" link2="@base_link"/>
  <disable_collisions link1="@right_finger" link2="@left_finger" reason="User"/>
</robot>"""


def test_the_srdf_of_a_hand_is_in_that_of_the_cell(tmp_path: Path) -> None:
    """Once for each hand, with a prefix before each name, beside what there is without it."""
    pytest.importorskip("pinocchio")
    shape = "<collision><geometry><sphere radius='0.01'/></geometry></collision>"
    (tmp_path / "hand.urdf").write_text(HAND.read_text().replace('"right_finger">', f'"right_finger">{shape}', 1))
    (tmp_path / "hand.srdf").write_text(HAND_SRDF.replace("@", ""))
    options = AttachOptions(file=tmp_path / "hand.urdf", name="grip", keep="none", srdf=tmp_path / "hand.srdf")
    part, notices = options.attachment
    assert [each.code for each in notices] == ["attached-srdf-left-out"]  # the virtual joint: another link holds it
    calls = [ArmCall(name="arm", of="ur5", prefix="arm_")]
    for name, link in (("a", "tool0"), ("b", "link_4")):
        calls.append(ArmCall(name=name, of="grip", prefix=f"{name}_", parent="arm", link=link, part=part))
    kind = alpha_swap(dh2urdf.read(UR5), AlphaSwapOptions())
    robot = compose(Cell(call=CellCall(name="cell", arms=tuple(calls)), manipulators={}), {"ur5": kind})
    bare = replace(robot, attachments=tuple(replace(each, semantics=()) for each in robot.attachments))

    def elements(root: etree._Element) -> Counter[str]:
        texts = [etree.tostring(each, method="c14n", with_tail=False).decode() for each in root.iterchildren("*")]
        return Counter(re.sub(r">\s+<", "><", text) for text in texts if "virtual" not in text)

    found, without = elements(semantics(robot)), elements(semantics(bare))
    carried = elements(etree.fromstring(HAND_SRDF.replace("@", "a_")))
    carried += elements(etree.fromstring(HAND_SRDF.replace("@", "b_")))
    assert {*found.values()} == {1}
    assert found - without == carried - without
    gone = [dict(etree.fromstring(text).attrib) for text in without - found]
    pairs = [{"link1": f"{side}_left_finger", "link2": f"{side}_right_finger", "reason": "Adjacent"} for side in "ab"]
    assert sorted(gone, key=str) == pairs  # the hand's own reason takes their place
    _, moveit = written(robot, tmp_path)
    assert elements(etree.parse(str(moveit / "config" / "cell.srdf")).getroot()) == found


def grasping() -> Robot:
    """A hand whose fingers collide: they would meet if the right one moved by itself, and do not as it follows."""
    robot = arm(xyz=(0.0, 0.0, 0.3))
    shape = next(link for link in robot.links if link.name == "hand_left_finger").collisions
    links = [
        replace(link, collisions=shape) if link.name in {"hand_right_finger", "hand_base_link"} else link
        for link in robot.links
    ]
    joints = [
        replace(
            joint,
            origin=Origin(xyz=(0.0, -0.06 if joint.name == "hand_right" else 0.0, 0.05)),
            axis=(0.0, 1.0, 0.0) if joint.name == "hand_right" else (1.0, 0.0, 0.0),
            limits=replace(joint.limits, lower=-0.06, upper=0.06) if joint.name == "hand_right" else joint.limits,
        )
        if joint.name in {"hand_left", "hand_right"}
        else joint
        for joint in robot.joints
    ]
    return replace(robot, links=tuple(links), joints=tuple(joints))


def test_pairs_of_a_hand_are_those_of_the_law() -> None:
    """The fingers touch at values that the follower never takes; MuJoCo measures them at values that it does."""
    pytest.importorskip("pinocchio")
    mujoco = pytest.importorskip("mujoco")
    robot = grasping()
    reasons = {(each.link1, each.link2): each.reason for each in robot_pairs(robot, PairOptions(trials=500)).disabled}
    assert reasons["hand_left_finger", "hand_right_finger"] == "Never"
    free = replace(robot, joints=tuple(replace(joint, follows=None) for joint in robot.joints))
    reasons = {(each.link1, each.link2): each.reason for each in robot_pairs(free, PairOptions(trials=500)).disabled}
    assert reasons.get(("hand_left_finger", "hand_right_finger")) is None
    (file,) = mjcf.EMITTER.emit(robot, "arm", mjcf.MjcfOptions())
    model = mujoco.MjModel.from_xml_string(file.content.decode())
    data = mujoco.MjData(model)
    fingers = [model.body(f"hand_{side}_finger").geomadr[0] for side in ("left", "right")]
    for value in np.linspace(-0.4, 0.7, 23):
        data.joint("hand_left").qpos, data.joint("hand_right").qpos = value, -0.05 * value + 0.001
        mujoco.mj_kinematics(model, data)
        assert mujoco.mj_geomDistance(model, data, *fingers, 1.0, None) > 0.0


@pytest.mark.parametrize("excludes", ["neighbours", "home", "touching"])
def test_nothing_touches_across_the_mount(excludes: Any) -> None:
    """A palm inside the last link: MuJoCo finds no contact between the hand and the links beside its joint."""
    pytest.importorskip("pinocchio")
    mujoco = pytest.importorskip("mujoco")
    robot = arm(xyz=(0.0, 0.0, -0.02))
    shape = next(link for link in robot.links if link.name == "hand_left_finger").collisions
    links = [replace(link, collisions=shape) if link.name == "hand_base_link" else link for link in robot.links]
    robot = replace(robot, links=tuple(links))
    (file,) = mjcf.EMITTER.emit(robot, "arm", mjcf.MjcfOptions(excludes=excludes))
    model = mujoco.MjModel.from_xml_string(file.content.decode())
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    touching = [{model.body(model.geom_bodyid[geom]).name for geom in contact.geom} for contact in data.contact]
    assert not [pair for pair in touching if "hand_base_link" in pair]
