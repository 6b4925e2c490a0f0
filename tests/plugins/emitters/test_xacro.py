import math
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree as ET

import pytest
from hypothesis import given, strategies as st
from lxml import etree
from two_fingers import HAND

from dh2urdf.cells.attachments import attached
from dh2urdf.errors import EmitterError, ProofError
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Follower, Robot
from dh2urdf_plugins.edits.attach import AttachOptions
from dh2urdf_plugins.formats.urdf import EMITTER as URDF
from dh2urdf_plugins.formats.urdf.reader import parse_urdf
from dh2urdf_plugins.formats.xacro import EMITTER, XacroOptions
from dh2urdf_plugins.formats.xacro.reader import expand, read_xacro
from dh2urdf_plugins.formats.xacro.writer import angle_text, macro_name

SCENE = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="scene">{}</robot>'


def write(robot: Robot, folder: Path, stem: str = "arm") -> Path:
    """Writes the files of a robot; gives the one to open."""
    files = EMITTER.emit(robot, stem, XacroOptions())
    for file in files:
        (folder / file.name).write_bytes(file.content)
    return folder / files[0].name


def scene(folder: Path, body: str) -> Robot:
    """The robot of a file that a person writes around the macros in a folder."""
    return read_xacro(written(folder / "scene.urdf.xacro", body))


def test_the_xacro_command_expands_it_without_a_warning(arm: Robot, tmp_path: Path) -> None:
    """A user's way: the command of the xacro package, from another folder, with an argument."""
    (tmp_path / "arms").mkdir()
    path = write(arm, tmp_path / "arms")
    run = subprocess.run(
        [sys.executable, "-c", "import xacro; xacro.main()", str(path), "prefix:=left_"],
        capture_output=True,
        check=True,
        cwd=tmp_path,
    )
    assert run.stderr == b""
    assert parse_urdf(run.stdout, "out").links[0].name == "left_base_link"


def test_the_prefix_goes_before_every_name(arm: Robot, tmp_path: Path) -> None:
    """Links, joints, materials, and the references to them; nothing else changes."""
    plain = URDF.emit(arm, "arm", URDF.options())[0].content.decode()
    prefixed = re.sub(r'(<(?:link|joint|material) name="|(?:parent|child) link=")', r"\1left_", plain)
    robot = parse_urdf(expand(write(arm, tmp_path), {"prefix": "left_"}), "arm")
    assert robot == parse_urdf(prefixed.encode(), "arm")


@pytest.mark.parametrize("name", ["01", "1e3", "true", "7"])
def test_a_name_that_xacro_could_take_for_a_number_stays_what_it_is(arm: Robot, tmp_path: Path, name: str) -> None:
    """Of `01` it made 1: the prefix was another, and the arm was mounted on a link that was not there."""
    robot = parse_urdf(expand(write(arm, tmp_path), {"prefix": name, "parent": name}), "arm")
    assert (robot.root, robot.joints[0].parent, robot.joints[0].child) == (name, name, f"{name}base_link")
    include = f'<xacro:include filename="arm_macro.xacro"/><link name="{name}"/>'
    mounting = scene(tmp_path, f"""{include}<xacro:arm_at prefix="'{name}'" parent="'{name}'"/>""").joints[0]
    assert (mounting.parent, mounting.child) == (name, f"{name}base_link")


def test_a_parent_gives_a_mounting_joint_with_the_origin(arm: Robot, tmp_path: Path) -> None:
    """The arm hangs on the caller's link, whose name is not prefixed: by a block, by numbers, or by the file to open."""
    place = {"prefix": "a_", "parent": "world", "xyz": "0 0.5 1", "rpy": "0 0 ${pi/2}"}
    top = write(arm, tmp_path)
    include = '<xacro:include filename="arm_macro.xacro"/><link name="world"/>'
    block = '<xacro:arm prefix="a_" parent="world"><origin xyz="0 0.5 1" rpy="0 0 ${pi/2}"/></xacro:arm>'
    call = '<xacro:arm_at prefix="a_" parent="world" xyz="0 0.5 1" rpy="0 0 ${pi/2}"/>'
    robot, opened = scene(tmp_path, include + block), parse_urdf(expand(top, place | {"rpy": "0 0 0.5"}), "arm")
    assert scene(tmp_path, include + call) == robot
    for found, yaw in ((robot, math.pi / 2), (opened, 0.5)):
        mounting = found.joints[0]
        assert (mounting.name, mounting.type) == ("a_base_joint", JointType.FIXED)
        assert (found.root, mounting.parent, mounting.child) == ("world", "world", "a_base_link")
        assert (mounting.origin.xyz, mounting.origin.rpy) == ((0, 0.5, 1), (0, 0, yaw))
        assert len(found.joints) == len(arm.joints) + 1
    mounting = scene(tmp_path, f'{include}<xacro:arm_at parent="world"/>').joints[0]
    assert (mounting.child, mounting.origin.xyz, mounting.origin.rpy) == ("base_link", (0, 0, 0), (0, 0, 0))
    assert parse_urdf(expand(top), "arm").root == "base_link"


def test_the_mounting_joint_takes_no_name_of_the_table(arm: Robot, tmp_path: Path) -> None:
    """A joint or link may be called base_joint."""
    joints = tuple(replace(joint, name="base_joint") if joint.name == "lift" else joint for joint in arm.joints)
    write(replace(arm, joints=joints), tmp_path)
    body = '<xacro:include filename="arm_macro.xacro"/><xacro:arm prefix="a_" parent="w"><origin/></xacro:arm>'
    names = [joint.name for joint in scene(tmp_path, body).joints]
    assert names[0] == "a_base_joint_"
    assert len(set(names)) == len(names)


def test_two_macros_and_two_calls_do_not_disturb_each_other(arm: Robot, tmp_path: Path) -> None:
    """Properties of one name are each macro's own, and one macro serves two arms with unique names."""
    other = replace(
        arm,
        name="other",
        parameters=tuple(replace(parameter, value=2 * parameter.value) for parameter in arm.parameters),
    )
    write(arm, tmp_path, "arm")
    write(other, tmp_path, "other")
    robot = scene(
        tmp_path,
        """<xacro:include filename="arm_macro.xacro"/><xacro:include filename="other_macro.xacro"/><link name="world"/>
        <xacro:arm prefix="a_" parent="world"><origin xyz="0 1 0"/></xacro:arm>
        <xacro:other prefix="b_" parent="world"><origin xyz="0 2 0"/></xacro:other>
        <xacro:arm prefix="c_" parent="world"><origin xyz="0 3 0"/></xacro:arm>""",
    )
    names = [part.name for part in (*robot.links, *robot.joints)]
    assert len(set(names)) == len(names)
    at = {joint.name: joint.origin for joint in robot.joints}
    for prefix, factor in (("a_", 1), ("b_", 2), ("c_", 1)):
        assert at[f"{prefix}lift"].xyz == (0, 0, 0.089159 * factor)
        assert at[f"{prefix}turn"].xyz == (-0.425 * factor, 0, 0)
        assert at[f"{prefix}turn"].rpy == (-math.pi / 2 * factor, 0, 0.3)


def with_part(robot: Robot, file: Path, **options: Any) -> Robot:
    return attached(robot, AttachOptions(file=file, **options).attachment[0])


def test_the_prefix_goes_before_every_name_of_what_is_attached(arm: Robot, tmp_path: Path) -> None:
    """And before those that its other elements name; the joint that holds it is the arm's."""
    path = write(with_part(arm, HAND, name="hand", prefix="h_"), tmp_path)
    root = etree.fromstring(expand(path, {"prefix": "01"}))
    named = [
        *root.iterfind("link"),
        *root.iterfind("joint"),
        *root.iterfind("transmission"),
        *root.iterfind("material"),
    ]
    assert {name[:2] for name in (each.get("name") for each in named)} == {"01"}
    assert root.find("joint/mimic").get("joint") == root.find("transmission/joint").get("name") == "01h_left"
    assert root.find("gazebo").get("reference") == "01h_left_finger"
    assert root.findtext("ros2_control/joint/param") == "01h_right"
    assert "01hand_joint" in {each.get("name") for each in root.iterfind("joint")}


def test_a_part_is_called_by_hand(arm: Robot, tmp_path: Path) -> None:
    """Twice in a robot of somebody else, with the macro's file alone."""
    write(with_part(arm, HAND, name="hand"), tmp_path)
    call = '<xacro:part_hand prefix="{0}_" parent="plate"><origin xyz="0 {1} 0"/></xacro:part_hand>'
    include = '<xacro:include filename="arm_parts.xacro"/><link name="plate"/>'
    robot = scene(tmp_path, include + call.format("l", 1) + call.format("r", 2))
    held = {joint.name: joint.origin.xyz for joint in robot.joints if joint.parent == "plate"}
    assert held == {"l_joint": (0, 1, 0), "r_joint": (0, 2, 0)}
    assert robot.followers == {f"{side}_right": Follower(f"{side}_left", -0.05, 0.001) for side in "lr"}


def test_a_material_of_arm_and_part_is_defined_once(arm: Robot, tmp_path: Path) -> None:
    """Without a prefix both may have it: readers refuse two definitions, and two colours are an error as in a URDF."""
    (tmp_path / "pen.urdf").write_text(PEN.format(0.5))
    robot = with_part(arm, tmp_path / "pen.urdf", name="pen", prefix="")
    root = etree.fromstring(expand(write(robot, tmp_path)))
    assert [each.get("name") for each in root.iterfind("material")] == ["grey", "orange"]
    assert parse_urdf(etree.tostring(root), "arm") == robot
    (tmp_path / "pen.urdf").write_text(PEN.format(0.6))
    with pytest.raises(EmitterError):
        write(with_part(arm, tmp_path / "pen.urdf", name="pen", prefix=""), tmp_path)


PEN = """<robot name="pen"><material name="grey"><color rgba="{0} 0.5 0.5 1"/></material><link name="pen"><visual>
<geometry><sphere radius="0.1"/></geometry><material name="grey"/></visual></link></robot>"""


HOSTILE = "${xacro.fatal('evaluated')} $(env HOME) $${x} $(arg prefix) '\" {a} }&<]]> xacro:eval-comments --"


def test_nobody_evaluates_a_name(arm: Robot, tmp_path: Path) -> None:
    """A name that is an expression, an argument or markup comes out of xacro as the same text, prefixed or not."""
    joints = tuple(replace(joint, name=HOSTILE) if joint.name == "lift" else joint for joint in arm.joints)
    parameters = tuple(replace(parameter, joint=HOSTILE) for parameter in arm.parameters)
    robot = replace(arm, name=HOSTILE, joints=joints, parameters=parameters, comment=HOSTILE)
    path = write(robot, tmp_path)
    assert read_xacro(path) == robot
    prefixed = parse_urdf(expand(path, {"prefix": "${1/0}_"}), "arm")
    assert prefixed.name == HOSTILE
    assert prefixed.joints[1].name == "${1/0}_" + HOSTILE


def test_nobody_evaluates_what_a_file_has_for_other_programs(arm: Robot, tmp_path: Path) -> None:
    """The texts, attributes and options of an attached URDF are text, and its comments are gone."""
    text = "${xacro.fatal('evaluated')} $(env HOME) $${x}"
    inner = f'<!-- xacro:eval-comments --><!-- {text} --><a b="{text}">{text}<c/>{text}</a>'
    (tmp_path / "pen.urdf").write_text(
        f'<robot name="pen"><link name="pen"/><gazebo>{inner}</gazebo>'
        f'<mujoco><custom><text name="t" data="{text}"/></custom></mujoco></robot>'
    )
    root = etree.fromstring(expand(write(with_part(arm, tmp_path / "pen.urdf", name="pen"), tmp_path)))
    found = root.find("gazebo/a")
    assert (found.get("b"), found.text.strip(), found.find("c").tail.strip()) == (text, text, text)
    assert root.find("mujoco/custom/text").get("data") == text


@pytest.mark.parametrize("stem", ["a$(b)", "${c}", "a b", "[ab]*?", "é"])
def test_a_file_name_is_no_expression_and_no_pattern(
    arm: Robot, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, stem: str
) -> None:
    """xacro evaluates the name of an included file, and then takes it for a pattern."""
    path = write(arm, tmp_path, stem)
    monkeypatch.chdir(tmp_path)  # Where xacro looks for a pattern.
    assert read_xacro(path).joints[0] == arm.joints[0]


@pytest.mark.parametrize(
    ("robot", "stem", "macro"),
    [
        ("ur5", "x", "ur5"),
        ("机械臂", "robot_3", "robot_3"),
        ("2link", "2link", "_2link"),
        ("include", "include", "_include"),
    ],
)
def test_the_macro_has_the_robots_name_where_xacro_can_take_it(robot: str, stem: str, macro: str) -> None:
    """Else the file's, with what a tag cannot hold replaced; xacro's own elements are no macros."""
    assert macro_name(robot, stem) == macro


@given(robot=st.text(), stem=st.text())
def test_a_macro_name_is_always_a_tag(robot: str, stem: str) -> None:
    """Whatever the names are, the macro can be called."""
    tag = macro_name(robot, stem)
    assert ET.fromstring(f"<{tag}/>").tag == tag  # noqa: S314


@pytest.mark.parametrize(
    ("angle", "text"),
    [
        (-0.0, "0"),
        (-math.pi, "${-pi}"),
        (-3 * math.pi / 4, "${-3*pi/4}"),
        (math.radians(30), "${pi/6}"),
        (math.nextafter(math.pi / 2, 2), "1.5707963267948968"),
        (1e16, "1e16"),
    ],
)
def test_multiples_of_pi_are_readable(angle: float, text: str) -> None:
    """Only the very double that xacro computes is written so; nothing is rounded to it."""
    assert angle_text(angle) == text


@given(st.floats(-100, 100) | st.builds(lambda k, m: k * math.pi / m, st.integers(-99, 99), st.integers(1, 12)))
def test_the_text_of_an_angle_is_the_angle(angle: float) -> None:
    """Evaluated as xacro does, it is the same double."""
    assert eval(angle_text(angle).strip("${}"), {"pi": math.pi}) == angle  # noqa: S307 - our own text


# --- The reader


def written(path: Path, body: str) -> Path:
    path.write_text(SCENE.format(body), encoding="utf-8")
    return path


def test_a_folder_with_brackets_is_no_pattern(tmp_path: Path) -> None:
    """xacro takes an included file's name for a pattern; the folder of the file has no part in it."""
    folder = tmp_path / "arms [2024]*"
    folder.mkdir()
    written(folder / "part.xacro", '<link name="l"/>')
    path = written(folder / "r.xacro", '<xacro:include filename="part.xacro"/>')
    assert [link.name for link in read_xacro(path).links] == ["l"]


def test_nothing_is_printed_and_no_state_is_left(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """xacro prints warnings to the terminal and keeps its root folder in a global."""
    import xacro

    before = xacro.root_dir
    read_xacro(written(tmp_path / "r.xacro", '<xacro:property name="pi" value="3"/><link name="l" xacro:x="1"/>'))
    with pytest.raises(ProofError):
        read_xacro(tmp_path / "none.xacro")
    assert capfd.readouterr() == ("", "")
    assert xacro.root_dir == before
