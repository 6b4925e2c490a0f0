"""An arm on a track is one chain: for its table, its inverse kinematics and its group of MoveIt."""

from collections.abc import Callable, Sequence
from math import cos, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from lxml import etree
from pinocchio_frames import pinocchio_frames

import dh2urdf
from dh2urdf.errors import RecordError
from dh2urdf_plugins.formats.urdf.reader import parse_urdf

TABLES = Path(__file__).parents[3] / "configs/tables"
RUN = f"""
inputs: [{TABLES}/ur5.csv, {TABLES}/track.csv, jaw.csv]
cells:
  - name: cell
    arms:
      - {{name: track, of: track, xyz: [0.2, 0, 0], rpy: [0, 0, 0.4]}}
      - {{name: rider, of: ur5, parent: track/tool0, xyz: [0, 0, 50 mm]}}
      - {{name: hand, of: jaw, parent: rider/tool0}}
      - {{name: fixed, of: ur5, xyz: [0, 3, 0]}}
emitters: [urdf, {{stage: srdf, options: {{trials: 100}}}}]
"""
JAW = "# convention: standard\njoint,type,a,alpha,d,lower,upper,velocity,effort\njaw,prismatic,0,0,0.02,0,0.05,0.1,20\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The files of a cell: an arm on a track with a hand, and an arm that stands alone."""
    pytest.importorskip("pinocchio")  # It finds the collision pairs of the SRDF.
    folder = tmp_path_factory.mktemp("chain")
    (folder / "jaw.csv").write_text(JAW)
    (folder / "run.yaml").write_text(RUN)
    dh2urdf.run(folder / "run.yaml", folder / "out")
    return folder / "out"


@pytest.fixture(scope="module")
def pose_of(folder: Path) -> Callable[[dict[str, float], str], np.ndarray]:
    """T(world → link) as Pinocchio has it."""
    return pinocchio_frames(folder / "cell.urdf")


def vectors(joints: Sequence[Any], count: int) -> np.ndarray:
    ends = [(joint.limits.lower, joint.limits.upper) for joint in joints]
    lower, upper = np.maximum([end[0] for end in ends], -3.0), np.minimum([end[1] for end in ends], 3.0)
    return np.random.default_rng(7).uniform(lower, upper, (count, len(ends)))


def test_extract_prints_one_table(cli: Cli, folder: Path, tmp_path: Path, pose_of: Callable[..., np.ndarray]) -> None:
    """The rows of the track, then those of the arm; the product is where Pinocchio has the tool."""
    cli("extract", folder / "cell.urdf", "--tip-link", "rider_tool0", "-o", tmp_path / "chain.yaml")
    chain = dh2urdf.read(tmp_path / "chain.yaml")
    names = [row.joint for row in chain.moving_rows]
    assert names[0] == "track_track_joint"
    assert len(names) == 7
    for q in vectors(chain.moving_rows, 10):
        wanted = pose_of(dict(zip(names, q, strict=True)), "rider_tool0")
        assert np.abs(chain.fk(q) - wanted).max() < 1e-9


@pytest.mark.parametrize(("link", "count"), [("rider_tool0", 7), ("hand_tool0", 8), ("track_tool0", 1)])
def test_inverse_kinematics_goes_through_the_whole_chain(
    folder: Path, pose_of: Callable[..., np.ndarray], link: str, count: int
) -> None:
    """Every pose that some joint values have is reached inside the limits, and Pinocchio finds the link there."""
    robot = parse_urdf((folder / "cell.urdf").read_bytes(), "cell.urdf")
    way = [joint for joint in robot.moving_joints if not joint.name.startswith("fixed_")][:count]
    names = [joint.name for joint in way]
    for q in vectors(way, 8):
        pose = pose_of(dict(zip(names, q, strict=True)), link)
        found = dh2urdf.inverse_kinematics(robot, pose, link=link)
        assert found.reached
        assert len(found.q) == count
        assert np.abs(pose_of(dict(zip(names, found.q, strict=True)), link) - pose).max() < 1e-7
        for joint, value in zip(way, found.q, strict=True):
            assert joint.limits.lower <= value <= joint.limits.upper  # type: ignore[operator]


def test_the_track_moves_where_the_arm_is_too_short(folder: Path, pose_of: Callable[..., np.ndarray]) -> None:
    """A pose at the end of the track is out of the arm's reach at its middle; of the start, by names, the rest is kept."""
    robot = parse_urdf((folder / "cell.urdf").read_bytes(), "cell.urdf")
    names = [joint.name for joint in robot.moving_joints][:7]
    end = robot.moving_joints[0].limits.upper
    assert end is not None
    pose = pose_of(dict(zip(names, (end, -1.9, -0.2, 0.3, 0.2, 0.3, 0.1), strict=True)), "rider_tool0")
    start = dict.fromkeys(names, 0.3)
    found = dh2urdf.inverse_kinematics(robot, pose, start, link="rider_tool0")
    assert found.reached
    assert found.q[0] > 0.1
    base = pose_of({}, "rider_base_link")
    beside = np.linalg.inv(base) @ pose
    assert np.linalg.norm(beside[:3, 3]) > 0.95  # m: the longest reach of a UR5 with its wrist stretched out
    assert not dh2urdf.inverse_kinematics(dh2urdf.read(TABLES / "ur5.csv"), beside).reached


FOLLOWS = """<robot name="r"><link name="base"/><link name="a"/><link name="b"/><link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/><LIMITS/></joint>
<joint name="j2" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0.5 0 0"/><axis xyz="0 0 1"/>
<LIMITS/><mimic joint="j1" multiplier="0.5" offset="0.2"/></joint>
<joint name="j3" type="prismatic"><parent link="b"/><child link="tip"/><origin xyz="0.4 0 0"/><axis xyz="1 0 0"/><LIMITS/>
</joint></robot>""".replace("<LIMITS/>", '<limit lower="-2" upper="2" effort="1" velocity="1"/>')


def test_a_joint_that_follows_moves_with_its_leader() -> None:
    """There is one value for each joint that moves by itself: x and y of a plane arm, in closed form."""
    robot = parse_urdf(FOLLOWS.encode(), "r.urdf")
    for first, slide in ((0.4, 0.1), (-0.9, 0.5), (1.3, -0.2)):
        angle, pose = 1.5 * first + 0.2, np.eye(4)
        pose[:2, :2] = [[cos(angle), -sin(angle)], [sin(angle), cos(angle)]]
        pose[0, 3] = 0.5 * cos(first) + (0.4 + slide) * cos(angle)
        pose[1, 3] = 0.5 * sin(first) + (0.4 + slide) * sin(angle)
        found = dh2urdf.inverse_kinematics(robot, pose, link="tip")
        assert found.reached
        assert found.q == pytest.approx((first, slide), abs=1e-7)


def test_a_table_has_one_pose() -> None:
    """No other link of it can be asked for."""
    arm = dh2urdf.read(TABLES / "ur5.csv")
    with pytest.raises(RecordError):
        dh2urdf.inverse_kinematics(arm, np.eye(4), link="link_3")
    with pytest.raises(RecordError):
        dh2urdf.inverse_kinematics(dh2urdf.convert(arm).robot, np.eye(4), link="nowhere")


def test_the_srdf_has_a_group_of_the_whole_chain(folder: Path) -> None:
    """Beside the groups of each arm and of all; what an arm holds as its tool ends no chain."""
    semantic = etree.parse(folder / "cell.srdf").getroot()
    chains = {
        group.get("name"): (group[0].get("base_link"), group[0].get("tip_link"))
        for group in semantic.findall("group")
        if group[0].tag == "chain"
    }
    assert chains == {
        **{
            f"{name}_manipulator": (f"{name}_base_link", f"{name}_tool0")
            for name in ("track", "rider", "hand", "fixed")
        },
        "track_rider_manipulator": ("track_base_link", "rider_tool0"),
    }
    (everything,) = (group for group in semantic.findall("group") if group.get("name") == "all")
    assert [each.get("name") for each in everything] == [
        f"{name}_manipulator" for name in ("track", "rider", "hand", "fixed")
    ]
    (state,) = (each for each in semantic.findall("group_state") if each.get("group") == "track_rider_manipulator")
    assert len(state) == 7
    assert state[0].get("name") == "track_track_joint"


def test_an_arm_on_a_gantry_from_a_file_has_a_group_of_both(tmp_path: Path) -> None:
    """From the floor to the tool, or to the tip of what it holds; one on a table that stands still has its own alone."""
    pytest.importorskip("pinocchio")
    body = '<inertial><mass value="9"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    joint = (
        '<joint name="{0}" type="prismatic"><parent link="{1}"/><child link="{2}"/><axis xyz="{3}"/>'
        '<limit lower="-1" upper="1" effort="900" velocity="1"/></joint>'
    )
    links = "".join(f'<link name="{name}">{body}</link>' for name in ("frame", "bridge", "cart", "hook"))
    links += joint.format("x", "frame", "bridge", "1 0 0") + joint.format("y", "bridge", "cart", "0 1 0")
    hook = '<joint name="z" type="fixed"><parent link="cart"/><child link="hook"/></joint>'
    (tmp_path / "gantry.urdf").write_text(f'<robot name="gantry">{links}{hook}</robot>')
    (tmp_path / "plate.urdf").write_text(
        '<robot name="plate"><link name="top"/><link name="edge"/>'
        '<joint name="j" type="fixed"><parent link="top"/><child link="edge"/></joint></robot>'
    )
    (tmp_path / "run.yaml").write_text(f"""
inputs: {TABLES}/ur5.csv
parts: [{{name: gantry, file: gantry.urdf}}, {{name: plate, file: plate.urdf}}, {{name: tool, file: plate.urdf, tip: edge}}]
cells:
  - name: cell
    arms:
      - {{name: g, of: gantry, xyz: [0, 0, 3]}}
      - {{name: hung, of: ur5, parent: g/hook, rpy: [pi, 0, 0]}}
      - {{name: pen, of: tool, parent: hung/tool0}}
      - {{name: table, of: plate, xyz: [3, 0, 0]}}
      - {{name: other, of: ur5, parent: table/edge}}
emitters: [{{stage: srdf, options: {{trials: 100}}}}]
""")
    dh2urdf.run(tmp_path / "run.yaml", tmp_path / "out")
    semantic = etree.parse(tmp_path / "out" / "cell.srdf").getroot()
    chains = {each.getparent().get("name"): tuple(each.attrib.values()) for each in semantic.iter("chain")}
    assert chains == {
        "hung_manipulator": ("hung_base_link", "pen_edge"),
        "other_manipulator": ("other_base_link", "other_tool0"),
        "g_hung_manipulator": ("g_frame", "pen_edge"),
    }
    (state,) = (each for each in semantic.findall("group_state") if each.get("group") == "g_hung_manipulator")
    names = [each.get("name") for each in state]
    assert (names[:2], len(names)) == (["g_x", "g_y"], 8)
    assert [each.get("name") for each in semantic.findall("group")][-1] == "g"
