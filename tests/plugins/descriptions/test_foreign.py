"""Descriptions of unknown origin as they are shown: joints that follow others, colours, and what no table has."""

from pathlib import Path

import numpy as np
import pytest
from pinocchio_frames import pinocchio_frames

from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.robot import Follower, with_followers
from dh2urdf_plugins.formats import foreign_mjcf, foreign_sdf, foreign_urdf, foreign_xacro

GRIPPER, SHAPES, IN_SDF, FOLLOWING = (
    (Path(__file__).parent / "files" / name).read_text("utf-8")
    for name in ("gripper.urdf.in", "shapes.urdf", "shapes.sdf", "following.xml.in")
)


@pytest.mark.parametrize("suffix", [".urdf", ".urdf.xacro"])
def test_a_urdf_that_no_table_holds(tmp_path: Path, suffix: str) -> None:
    path = tmp_path / f"gripper{suffix}"
    path.write_text(GRIPPER.format(attributes="name='gripper'" if "xacro" in suffix else ""))
    found = foreign_urdf(path) if suffix == ".urdf" else foreign_xacro(path)
    assert found.robot.followers == {"b": Follower("a", -2.0, 0.25)}
    assert found.loose == {"c": "floating"}
    base, one, *_ = found.robot.links
    assert base.visuals[0].material
    assert base.visuals[0].material.rgba == (0.0, 0.0, 1.0, 1.0)
    assert one.visuals[0].material is None


@pytest.mark.parametrize(
    ("start", "attributes"),
    [
        ('<?xml version="0.0" ?>\n', ""),
        ('\n\n<?xml version="1.0" encoding="utf-8"?>\n', ""),
        ("", 'xmlns="http://drake.mit.edu" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'),
    ],
    ids=["version", "late declaration", "namespace"],
)
def test_xml_that_only_readers_of_robots_take(tmp_path: Path, start: str, attributes: str) -> None:
    """As in files of PyBullet and of Drake; it was refused, and Pinocchio takes it."""
    pinocchio = pytest.importorskip("pinocchio")
    path = tmp_path / "gripper.urdf"
    path.write_text(start + GRIPPER.format(attributes=f"name='gripper' {attributes}"))
    found = foreign_urdf(path).robot
    assert (found.name, len(found.links)) == ("gripper", 4)
    assert found.joints[0].mark is not None
    assert found.joints[0].mark.line == 6 + start.count("\n")
    if "0.0" not in start:  # Pinocchio 4 has no such version of XML.
        assert pinocchio.buildModelFromUrdf(str(path)).existJointName("a")


def test_shapes_that_urdf_has_no_word_for(tmp_path: Path) -> None:
    """A capsule is where that of an SDF is; others are left out with a notice. The whole file was refused."""
    path, other = tmp_path / "shapes.urdf", tmp_path / "shapes.sdf"
    path.write_text(SHAPES)
    other.write_text(IN_SDF)
    found = foreign_urdf(path)
    (link,) = found.robot.links
    same = next(each for each in foreign_sdf(other).robot.links if each.name == "a")
    assert [visual.geometry for visual in link.visuals] == [visual.geometry for visual in same.visuals]
    for ours, theirs in zip(link.visuals, same.visuals, strict=True):
        assert ours.origin.xyz == pytest.approx(theirs.origin.xyz, abs=1e-15)
        assert ours.origin.rpy == pytest.approx(theirs.origin.rpy, abs=1e-15)
        assert ours.material
        assert ours.material.name == "red"
    assert [type(collision.geometry).__name__ for collision in link.collisions] == ["Cylinder", "Sphere", "Sphere"]
    assert [(notice.message, notice.mark and notice.mark.line) for notice in found.notices] == [
        ("a shape 'ellipsoid' is left out", 4),
        ("the visual of link 'a' is left out: visual lacks geometry", 4),
        ("the collision of link 'a' is left out: the geometry has no shape", 4),
        ("the collision of link 'a' is left out: length of capsule is 'long'", 5),
    ]


def test_a_mimic_joint_is_where_pinocchio_has_it(tmp_path: Path) -> None:
    """Pinocchio reads the mimic element itself."""
    path = tmp_path / "gripper.urdf"
    path.write_text(GRIPPER.format(attributes="name='gripper'").replace("floating", "fixed"))
    found = foreign_urdf(path)
    poses = link_poses(found.robot, {"a": 0.7})
    held = pinocchio_frames(path, mimic=True)({"a": 0.7}, "two")
    assert as_matrices(poses["two"]) == pytest.approx(held, abs=1e-12)


@pytest.mark.parametrize(("angle", "a", "b"), [("radian", 0.3, -0.2), ("degree", 20, 10)])
def test_a_joint_equality_is_kept_where_mujoco_wants_it(tmp_path: Path, angle: str, a: float, b: float) -> None:
    """MuJoCo finds nothing to correct, polynomials and joints without a leader included."""
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "gripper.xml"
    path.write_text(FOLLOWING.format(angle=angle, a=a, b=b))
    found = foreign_mjcf(path)
    assert found.folder == tmp_path / "assets"
    followers = found.robot.followers
    assert set(followers) == {"b", "c", "e"}
    values = with_followers({"a": 0.7}, followers)
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    for name, value in values.items():
        data.joint(name).qpos = value
    mujoco.mj_forward(model, data)
    assert data.ne == 3
    assert np.abs(data.efc_pos[:3]).max() < 1e-12


def test_an_sdf_mimic(tmp_path: Path) -> None:
    """-2 (a - 0.1) + 0.05."""
    path = tmp_path / "gripper.sdf"
    path.write_text(
        "<sdf version='1.11'><model name='g'><link name='base'/><link name='one'/><link name='two'/>"
        "<joint name='w' type='fixed'><parent>world</parent><child>base</child></joint>"
        "<joint name='a' type='continuous'><parent>base</parent><child>one</child><axis><xyz>0 0 1</xyz></axis></joint>"
        "<joint name='b' type='continuous'><parent>one</parent><child>two</child><axis><xyz>0 0 1</xyz>"
        "<mimic joint='a'><multiplier>-2</multiplier><offset>0.05</offset><reference>0.1</reference></mimic>"
        "</axis></joint></model></sdf>"
    )
    followers = foreign_sdf(path).robot.followers
    assert with_followers({"a": 0.4}, followers)["b"] == pytest.approx(-0.55)
