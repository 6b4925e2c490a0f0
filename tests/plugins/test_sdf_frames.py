"""What the frames of an SDF move with, and are placed by, beside Drake: each case was read as another arm, or refused."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from drake_frames import drake_frames

import dh2urdf
from dh2urdf.errors import ProofError, TableError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf_plugins.formats import foreign_sdf
from dh2urdf_plugins.formats.sdf.reader import parse_sdf

if TYPE_CHECKING:
    from pathlib import Path

TURNED = "<pose>1 0 0 1.2 0.3 0.4</pose>"
HELD = '<joint name="w" type="fixed"><parent>world</parent><child>a</child></joint>'
LINKS = f'<link name="a">{TURNED}</link><link name="b"><pose>0 1 0.2 0.3 0 0.5</pose></link>'
ABOUT_Z = "<axis><xyz>0 0 1</xyz></axis></joint>"
JOINT = f'<joint name="j" type="revolute"><parent>a</parent><child>b</child>{ABOUT_Z}'
IN_MODEL = "<xyz>0 0 1</xyz><use_parent_model_frame>1</use_parent_model_frame>"


def _model(version: str, content: str, attributes: str = "") -> str:
    return f'<sdf version="{version}"><model name="m"{attributes}>{content}</model></sdf>'


CASES = {
    "a frame of the model, which moves with its canonical link": _model(
        "1.9", f'{HELD}{LINKS}{JOINT}<frame name="tip"><pose>0 0 1 0.1 0 0</pose></frame>', ' canonical_link="b"'
    ),
    "a frame of the model, which moves with its first link": _model(
        "1.7",
        f'<frame name="tip"><pose>0 0 1 0 1 0</pose></frame><link name="b"/><link name="a">{TURNED}</link>{JOINT}{HELD}',
    ),
    "a model whose own link is canonical, behind the one in it": _model(
        "1.9",
        f'{HELD}<link name="a"/><model name="n">{TURNED}<model name="deep"><link name="c"/></model><link name="b"/>'
        f'{JOINT.replace("<parent>a", "<parent>deep::c")}</model><frame name="tip" attached_to="n"/>'
        '<joint name="k" type="fixed"><parent>a</parent><child>n::deep::c</child></joint>',
    ),
    "an axis in the frame of a model in the model": _model(
        "1.6",
        f'{HELD.replace("<child>a", "<child>n::a")}<model name="n">{TURNED}{LINKS}{JOINT.replace("<xyz>0 0 1</xyz>", IN_MODEL)}</model>',
    ),
    "an axis of version 1.4": _model("1.4", f"{HELD}{LINKS}{JOINT}"),
    "an axis of version 1.4 that says where it is": _model(
        "1.4", f"{HELD}{LINKS}{JOINT.replace('<xyz>0 0 1</xyz>', IN_MODEL.replace('1</use', '0</use'))}"
    ),
    "an axis of version 1.4 in a model in the model": _model(
        "1.4", f'{HELD.replace("<child>a", "<child>n::a")}<model name="n">{TURNED}{LINKS}{JOINT}</model>'
    ),
    "a model that is placed by one of its frames": _model(
        "1.9",
        f'{HELD}<link name="a"/><model name="n" placement_frame="deep::grip"><pose relative_to="a">1 2 3 0 0.3 0</pose>'
        f'<model name="deep" placement_frame="b"><pose>0 0.2 0 0 0 0.7</pose><link name="c"/><link name="b">{TURNED}</link>'
        f'<frame name="grip" attached_to="c"><pose relative_to="b">0 0.1 0 0.2 0 0</pose></frame><joint name="k" type="fixed">'
        '<parent>b</parent><child>c</child></joint></model></model><frame name="tip" attached_to="n::deep::grip"/>'
        f"{JOINT.replace('<child>b', '<child>n::deep::b')}",
    ),
    "a model that is placed by a frame of the world": '<sdf version="1.9"><world name="w"><frame name="far" attached_to="near">'
    f'<pose>0 0 0.2 0 0.4 0</pose></frame><frame name="near"><pose relative_to="o">0 0.3 0 0 0 1</pose></frame><model name="m">'
    f'<pose relative_to="far">1 0 0 0.5 0 0</pose>{HELD}{LINKS}{JOINT}</model><model name="o"><pose>0 0 5 0 0 0.3</pose>'
    '<link name="x"/></model></world></sdf>',
    "a pose in a frame, in the words of older versions": _model(
        "1.6", f'{HELD}<link name="a">{TURNED}</link><link name="b"><pose frame="a">0 1 0 0.3 0 0</pose></link>{JOINT}'
    ),
    "degrees and a type in other letters": _model(
        "1.9",
        f'{HELD}<link name="a"/><link name="b"><pose degrees=" True">1 0 0 90 20 0</pose></link>'
        f"{JOINT.replace('revolute', 'Revolute')}",
    ),
}


@pytest.mark.parametrize("case", CASES)
def test_everything_is_where_drake_has_it(tmp_path: Path, case: str) -> None:
    path = tmp_path / "m.sdf"
    path.write_text(CASES[case])
    frame, robot = drake_frames(path), foreign_sdf(path).robot
    names = [link.name for link in robot.links if link.name.rpartition("::")[2] in {"a", "b", "c", "tip"}]
    base = next(name for name in names if name.endswith("a"))
    tip = next(name for name in reversed(names) if name.endswith(("tip", "b")))
    arm = dh2urdf.extract(path, base_link=base, tip_link=tip)
    for value in (0.0, 0.4, -0.7):
        poses = {name: as_matrices(pose) for name, pose in link_poses(robot, {"j": value, "n::j": value}).items()}
        for name in names:
            assert poses[name] == pytest.approx(frame({"j": value}, name), abs=1e-12)
        apart = np.linalg.solve(frame({"j": value}, base), frame({"j": value}, tip))
        assert np.array(arm.fk([value])) == pytest.approx(apart, abs=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (_model("1.9", LINKS + JOINT.replace("<child>b", "<child>world")), "the joint moves the world"),
        (
            f'<sdf version="1.9"><world name="w"><model name="m"><pose relative_to="o::x"/>{LINKS}{JOINT}</model></world></sdf>',
            "the model is placed by 'o::x'",
        ),
    ],
)
def test_what_would_be_another_arm_is_refused(text: str, message: str) -> None:
    """The joint was no part of the robot, and the model was in the origin, without a word."""
    with pytest.raises(ProofError, match=message):
        parse_sdf(text.encode(), "m.sdf")


INCLUDED = '<include{}><uri>model://elbow</uri><name>e</name><pose relative_to="a"/></include>'
AT_ELBOW = JOINT.replace('"j"', '"k"').replace("<parent>a", "<parent>{}").replace("<child>b", "<child>c")


@pytest.mark.parametrize(("nested", "parent"), [("", "e::palm"), (' merge="true"', "palm"), ("", "n::e::palm")])
def test_a_chain_through_an_included_model_is_refused(tmp_path: Path, nested: str, parent: str) -> None:
    """The joint behind it was left out, and the arm had one joint less; the parts before and behind it are arms."""
    included = INCLUDED.format(nested)
    if parent.startswith("n::"):
        included = f'<model name="n"><pose relative_to="a"/>{included}</model><frame name="f" attached_to="n"/>'
    behind = '<link name="c"/><link name="d"/>' + JOINT.replace('"j"', '"i"').replace("<parent>a", "<parent>c").replace(
        "<child>b", "<child>d"
    )
    placed = '<frame name="far" attached_to="d"><pose relative_to="k"/></frame>'
    path = tmp_path / "m.sdf"
    path.write_text(_model("1.9", f"{HELD}{LINKS}{JOINT}{included}{AT_ELBOW.format(parent)}{behind}{placed}"))
    with pytest.raises(TableError, match="the chain holds 'k', which is at an included model"):
        dh2urdf.extract(path, tip_link="d")
    for base, tip, joint in (("a", "b", "j"), ("c", "d", "i")):
        assert [row.joint for row in dh2urdf.extract(path, base_link=base, tip_link=tip).rows] == [joint]
    links = {link.name for link in foreign_sdf(path).robot.links}
    assert links.isdisjoint({"n", "f", "far"})


def test_a_joint_of_the_world_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "m.sdf"
    rail = '<joint name="rail" type="prismatic"><parent>world</parent><child>m</child><axis><xyz>0 1 0</xyz></axis></joint>'
    path.write_text(f'<sdf version="1.11"><world name="w"><model name="m">{LINKS}{JOINT}</model>{rail}</world></sdf>')
    assert [notice.message for notice in foreign_sdf(path).notices] == ["a joint of the world is left out"]


def test_a_word_that_version_1_7_has_no_more_means_nothing(tmp_path: Path) -> None:
    """sdformat passes `use_parent_model_frame` over, and Drake refuses it; the axis was in the frame of the model."""
    path = tmp_path / "m.sdf"
    path.write_text(_model("1.7", f"{HELD}{LINKS}{JOINT}"))
    frame = drake_frames(path)
    path.write_text(_model("1.7", f"{HELD}{LINKS}{JOINT.replace('<xyz>0 0 1</xyz>', IN_MODEL)}"))
    found = foreign_sdf(path)
    assert as_matrices(link_poses(found.robot, {"j": 0.7})["b"]) == pytest.approx(frame({"j": 0.7}, "b"), abs=1e-12)
    message = "use_parent_model_frame, which SDF has no more since version 1.7, is left out"
    assert [notice.message for notice in found.notices] == [message]


def test_only_angles_are_taken_for_a_rounded_pi(tmp_path: Path) -> None:
    """A part of a quaternion was, and so were degrees where the file says so by 1."""
    path = tmp_path / "m.sdf"
    poses = (
        '<pose rotation_format="quat_xyzw">1 0 0 0.785 0.1 0 0.6</pose>',
        '<pose degrees="1">1 0 0 0.785 0 0</pose>',
        "<pose>1 0 0 0.785 0 0</pose>",
    )
    for pose, count in zip(poses, (0, 0, 1), strict=True):
        path.write_text(_model("1.9", f'<link name="a"/><link name="b">{pose}</link>{JOINT}'))
        notices = dh2urdf.extract(path, base_link="a", tip_link="b").notices
        assert len([notice for notice in notices if notice.field == "rounded_pi"]) == count
