"""The edit `attach`: a gripper from its own file on an arm, in every format."""

import math
import re
import warnings
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import two_fingers
from lxml import etree
from plain_frames import rpy, shift
from two_fingers import TWO_JOINTS as TABLE, hand_frames

import dh2urdf
from dh2urdf.errors import InputError, ProofError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.attached import prove_attachments
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.robot import Box, Follower, Robot
from dh2urdf_plugins.formats import read_mjcf, read_sdf, read_urdf, read_xacro

HAND = two_fingers.HAND.read_text("utf-8")
MOUNT = {"xyz": [0.0, 0.02, "11 mm"], "rpy": [0.1, 0.2, "30 deg"]}
READERS = {".urdf": read_urdf, ".urdf.xacro": read_xacro, ".sdf": read_sdf, ".xml": read_mjcf}


@pytest.fixture(name="convert")
def _convert(tmp_path: Path) -> Callable[..., tuple[Path, Robot]]:
    """Writes an arm with what is attached to it, and reads the file again."""

    def convert(suffix: str, hand: str = HAND, **options: Any) -> tuple[Path, Robot]:
        (tmp_path / "arm.csv").write_text(TABLE, "utf-8")
        (tmp_path / "hand.urdf").write_text(hand, "utf-8")
        edit = {"attach": {"file": str(tmp_path / "hand.urdf"), "name": "hand", **MOUNT, **options}}
        path = tmp_path / f"out{suffix}"
        dh2urdf.convert(tmp_path / "arm.csv", path, edits=[edit])
        return path, READERS[suffix](path)

    return convert


@pytest.mark.parametrize("suffix", READERS)
def test_every_format_has_it(suffix: str, convert: Callable[..., tuple[Path, Robot]]) -> None:
    """Poses of all links of the hand in tool0, at joint values at which the follower follows, and their masses."""
    _, robot = convert(suffix)
    assert robot.followers == {"hand_right": Follower("hand_left", -0.05, 0.001)}
    assert [joint.name for joint in robot.actuated_joints] == ["one", "two", "hand_left"]
    masses = {link.name: link.inertial.mass for link in robot.links if link.inertial}
    assert [masses[f"hand_{name}"] for name in ("base_link", "right_finger", "left_finger")] == [0.6, 0.1, 0.2]
    place = shift(0.0, 0.02, 0.011) @ rpy(0.1, 0.2, math.radians(30.0))
    for left in (0.0, 0.3, -0.2):
        q = {"one": 0.4, "two": 0.4, "hand_left": left}
        poses = {name: as_matrices(pose) for name, pose in link_poses(robot, q).items()}
        for link, wanted in hand_frames(left).items():
            assert np.allclose(poses[f"hand_{link}"], poses["tool0"] @ place @ wanted, atol=1e-12), link


def test_mujoco_drives_the_leader_alone(convert: Callable[..., tuple[Path, Robot]]) -> None:
    """One actuator for the hand; the constraint moves the follower as the file of the hand has it."""
    mujoco = pytest.importorskip("mujoco")
    path, _ = convert(".xml")
    model = mujoco.MjModel.from_xml_path(str(path))
    assert [model.actuator(number).name for number in range(model.nu)] == ["one", "two", "hand_left"]
    data = mujoco.MjData(model)
    data.ctrl[model.actuator("hand_left").id] = 0.3
    for _ in range(3000):
        mujoco.mj_step(model, data)
    left, right = (float(data.joint(f"hand_{name}").qpos[0]) for name in ("left", "right"))
    assert left == pytest.approx(0.3, abs=2e-3)
    assert right == pytest.approx(-0.05 * left + 0.001, abs=1e-3)


@pytest.mark.parametrize("suffix", [".urdf", ".urdf.xacro"])
def test_every_reference_has_the_prefix(suffix: str, convert: Callable[..., tuple[Path, Robot]]) -> None:
    """Those of the elements for other programs, too; the two elements for MuJoCo are one, and the arm's counts."""
    path, _ = convert(suffix)
    if suffix == ".urdf":
        root = etree.parse(str(path)).getroot()
    else:
        import xacro

        root = etree.fromstring(xacro.process_file(str(path)).toxml().encode())
    names = {each.get("name") for each in root.iterfind("link")} | {each.get("name") for each in root.iterfind("joint")}
    assert {each.get("joint") for each in root.iterfind("joint/mimic")} == {"hand_left"}
    assert [each.get("reference") for each in root.iterfind("gazebo")] == ["hand_left_finger"]
    assert [each.get("name") for each in root.iterfind("transmission//*[@name]")] == ["hand_left", "hand_motor"]
    assert [each.get("name") for each in root.iterfind("transmission")] == ["hand_drive"]
    (system,) = root.iterfind("ros2_control")
    assert (system.get("name"), system.get("type")) == ("hand_system", "system")
    assert system.findtext("joint/param") == "hand_right"
    assert {each.get("name") for each in root.iter("material")} >= {"hand_grey"}
    (options,) = root.iterfind("mujoco")
    assert dict(options.find("compiler").attrib) == {
        "fusestatic": "false",
        "discardvisual": "false",
        "angle": "radian",
    }
    assert options.find("option").get("timestep") == "0.001"
    assert {"hand_base_link", "tool0", "hand_tool0"} <= names


def test_mujoco_has_the_settings_of_two_hands(tmp_path: Path) -> None:
    """In one element, the first of each; the profile for ROS has none."""
    mujoco = pytest.importorskip("mujoco")
    edits = []
    for name, parent, step, flag in (("a", "tool0", 0.001, "gravity"), ("b", "a_tool0", 0.004, "contact")):
        settings = f'<option timestep="{step}"><flag {flag}="disable"/></option><size nkey="3"/>'
        (tmp_path / f"{name}.urdf").write_text(HAND.replace('<option timestep="0.001"/>', settings), "utf-8")
        edits.append({"attach": {"file": str(tmp_path / f"{name}.urdf"), "name": name, "parent": parent}})
    with pytest.warns(dh2urdf.TableWarning, match="option timestep=0.004"):
        dh2urdf.convert(dh2urdf.read(TABLE), tmp_path / "out.urdf", edits=edits)
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out.urdf"))
    flags = mujoco.mjtDisableBit.mjDSBL_GRAVITY | mujoco.mjtDisableBit.mjDSBL_CONTACT
    assert (model.opt.timestep, model.opt.disableflags, model.nkey) == (0.001, flags, 3)
    dh2urdf.convert(dh2urdf.read(TABLE), tmp_path / "out.urdf", edits=edits, profile="ros")
    assert etree.parse(str(tmp_path / "out.urdf")).find("mujoco") is None


def test_the_efforts_carry_it(convert: Callable[..., tuple[Path, Robot]], tmp_path: Path) -> None:
    """Twice the weight at the end of the way, at least; an effort of the table stays."""
    _, laden = convert(".urdf")
    bare = dh2urdf.convert(tmp_path / "arm.csv").robot
    for new, old, arm in zip(laden.actuated_joints[:2], bare.actuated_joints, (0.7, 0.3), strict=True):
        assert new.limits.effort >= old.limits.effort + 2 * 9.81 * 0.9 * arm
        assert new.limits.effort <= old.limits.effort + 2 * 9.81 * 0.9 * (arm + 0.3) * 1.1
    table = "# convention: standard\nname, a, alpha, d, effort\none, 0.4, pi/2, 0.1, 33\ntwo, 0.3, 0, 0, 44\n"
    edit = {"attach": {"file": str(tmp_path / "hand.urdf"), "name": "hand"}}
    given = dh2urdf.convert(dh2urdf.read(table), edits=[edit]).robot
    assert [joint.limits.effort for joint in given.actuated_joints] == [33.0, 44.0, 10.0]


def test_it_is_held_by_another_link(convert: Callable[..., tuple[Path, Robot]]) -> None:
    """The fixed joint above that link is turned round: its root hangs below it."""
    _, robot = convert(".urdf", root="tool0", xyz=[0, 0, 0], rpy=[0, 0, 0])
    poses = link_poses(robot, {})
    found = np.linalg.inv(as_matrices(poses["tool0"])) @ as_matrices(poses["hand_base_link"])
    assert np.allclose(found, [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, -0.1], [0, 0, 0, 1]], atol=1e-15)
    assert {joint.name: joint.parent for joint in robot.joints}["hand_fixed"] == "hand_tool0"


def test_the_joint_that_holds_it_takes_no_name(tmp_path: Path) -> None:
    """Neither one of the arm nor one of the hand with its prefix."""
    (tmp_path / "hand.urdf").write_text(HAND.replace('name="fixed"', 'name="joint_"'), "utf-8")
    edit = {"attach": {"file": str(tmp_path / "hand.urdf"), "name": "hand"}}
    robot = dh2urdf.convert(dh2urdf.read(TABLE.replace("one,", "hand_joint,")), edits=[edit]).robot
    names = [joint.name for joint in robot.joints]
    assert len({*names}) == len(names)
    assert {"hand_joint", "hand_joint_"} <= {*names}


def faulty(robot: Robot, **changes: Any) -> Robot:
    """A robot whose joint or link of the hand was written otherwise."""
    kind, name, new = changes["kind"], changes["name"], changes["new"]
    records = tuple([replace(each, **new) if each.name == name else each for each in getattr(robot, kind)])
    return replace(robot, **{kind: records})


@pytest.mark.parametrize(
    ("changes", "code"),
    [
        ({"kind": "joints", "name": "hand_right", "new": {"follows": None}}, "attached-link-moved"),
        (
            {"kind": "joints", "name": "hand_right", "new": {"follows": Follower("hand_left", 0.5, 0.001)}},
            "attached-link-moved",
        ),
        ({"kind": "joints", "name": "hand_left", "new": {"axis": (0.0, 1.0, 0.0)}}, "attached-link-moved"),
        (
            {"kind": "joints", "name": "hand_joint", "new": {"origin": dh2urdf.robot.Origin(xyz=(0, 0.02, 0.011))}},
            "attached-link-moved",
        ),
        ({"kind": "links", "name": "hand_left_finger", "new": {"inertial": None}}, "attached-mass-changed"),
        ({"kind": "links", "name": "hand_base_link", "new": {"visuals": ()}}, "attached-shapes-lost"),
        ({"kind": "links", "name": "hand_tool0", "new": {"name": "tool1"}}, "attached-link-missing"),
    ],
)
def test_the_proof_finds_every_fault(
    changes: dict[str, Any], code: str, convert: Callable[..., tuple[Path, Robot]], tmp_path: Path
) -> None:
    _, written = convert(".urdf")
    edit = {"attach": {"file": str(tmp_path / "hand.urdf"), "name": "hand", **MOUNT}}
    robot = dh2urdf.convert(tmp_path / "arm.csv", edits=[edit]).robot
    prove_attachments(robot, written)
    with pytest.raises(ProofError) as caught:
        prove_attachments(robot, faulty(written, **changes))
    assert [problem.code for problem in caught.value.problems] == [code]


def test_a_possible_inertia_is_taken_where_that_is_asked(convert: Callable[..., tuple[Path, Robot]]) -> None:
    bad = HAND.replace('ixx="0.001"', 'ixx="0.009"', 1)
    assert convert(".urdf", bad)[1].links[-4].inertial.inertia.ixx > 0.0088
    repaired = convert(".urdf", bad, keep={"inertia": "repair"})[1].links[-4].inertial.inertia
    tensor = np.array([[getattr(repaired, "i" + "".join(sorted(a + b))) for b in "xyz"] for a in "xyz"])
    small, middle, large = np.linalg.eigvalsh(tensor)
    assert large <= small + middle


def test_sdf_and_mjcf_are_refused(tmp_path: Path) -> None:
    (tmp_path / "hand.sdf").write_text("<sdf/>", "utf-8")
    with pytest.raises(InputError, match="no URDF and no xacro"):
        dh2urdf.convert(dh2urdf.read(TABLE), edits=[{"attach": {"file": str(tmp_path / "hand.sdf"), "name": "h"}}])


def test_what_no_robot_has_is_told(convert: Callable[..., tuple[Path, Robot]]) -> None:
    """A safety controller, a calibration and a texture are left out with a notice each."""
    more = HAND.replace(
        '<axis xyz="1 0 0"/>', '<axis xyz="1 0 0"/><safety_controller k_velocity="1"/><calibration rising="0"/>'
    )
    more = more.replace('<color rgba="0.5 0.5 0.5 1"/>', '<texture filename="a.png"/>')
    with pytest.warns(dh2urdf.TableWarning) as told:
        convert(".urdf", more)
    words = " ".join(str(each.message) for each in told)
    assert all(word in words for word in ("safety_controller", "calibration", "texture"))


@pytest.mark.parametrize("suffix", READERS)
def test_elements_for_other_programs_are_counted_where_they_are_left_out(
    suffix: str, convert: Callable[..., tuple[Path, Robot]]
) -> None:
    """One notice for each tag, in SDF and MJCF; URDF and xacro have the elements."""
    hand = HAND.replace("<mujoco>", '<gazebo><plugin name="p" filename="f"/></gazebo><mujoco>')
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always")
        convert(suffix, hand)
    found = re.findall(r"elements (\w+) \((\d+)\)", " ".join(str(each.message) for each in told))
    lost = {"gazebo": "2", "transmission": "1", "ros2_control": "1", "mujoco": "1"}
    assert dict(found) == (lost if suffix in {".sdf", ".xml"} else {})
    assert len(found) == len(dict(found))


def test_two_meshes_of_one_name_stay_two(convert: Callable[..., tuple[Path, Robot]], tmp_path: Path) -> None:
    """Copied beside the output with what is in them, each with its scale; the words of addresses are the copies'."""
    bodies = {}
    for number, folder in enumerate(("visual", "collision"), start=1):
        (tmp_path / folder).mkdir()
        bodies[folder] = b"solid " + bytes([64 + number]) + b"\nendsolid\n" * number
        (tmp_path / folder / "body.stl").write_bytes(bodies[folder])
    shapes = "".join(
        f'<{kind}><geometry><mesh filename="{kind}/body.stl" scale="0.001 0.001 0.002"/></geometry></{kind}>'
        for kind in bodies
    )
    _, robot = convert(".urdf", HAND.replace('<link name="tool0"/>', f'<link name="tool0">{shapes}</link>'))
    (link,) = (each for each in robot.links if each.name == "hand_tool0")
    found = {}
    for kind, (shape,) in (("visual", link.visuals), ("collision", link.collisions)):
        assert shape.geometry.scale == (0.001, 0.001, 0.002)
        found[kind] = (tmp_path / shape.geometry.filename).read_bytes()
    assert found == bodies


@pytest.mark.parametrize(("variable", "inner"), [("ROS_PACKAGE_PATH", ""), ("AMENT_PREFIX_PATH", "share")])
def test_packages_of_the_environment_are_found(
    variable: str,
    inner: str,
    convert: Callable[..., tuple[Path, Robot]],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Among folders that are not there or hold no package."""
    package = tmp_path / "overlay" / inner / "hands"
    package.mkdir(parents=True)
    (tmp_path / "empty" / inner).mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>hands</name></package>", "utf-8")
    (package / "palm.stl").write_bytes(b"solid palm\nendsolid\n")
    folders = [tmp_path / name for name in ("gone", "empty", "overlay")]
    monkeypatch.setenv(variable, ":".join(map(str, folders)))
    visual = '<visual><geometry><mesh filename="package://hands/palm.stl"/></geometry></visual>'
    convert(".urdf", HAND.replace('<link name="tool0"/>', f'<link name="tool0">{visual}</link>'))
    (copy,) = (tmp_path / "meshes").glob("palm-*.stl")
    assert copy.read_bytes() == b"solid palm\nendsolid\n"


def test_a_xacro_gets_arguments_and_packages(tmp_path: Path) -> None:
    """The expansion of a strange file goes through the fence, and package:// addresses to the folders that are named."""
    package = tmp_path / "hands"
    (package / "meshes").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>hands</name></package>", "utf-8")
    (package / "meshes" / "palm.stl").write_bytes(b"solid palm\nendsolid\n")
    text = (
        '<robot name="h" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="long" default="false"/>'
        '<xacro:arg name="d" default="1"/><link name="world"/><link name="palm"><visual><geometry>'
        '<mesh filename="package://hands/meshes/palm.stl"/></geometry></visual></link>'
        '<joint name="mount" type="fixed"><parent link="world"/><child link="palm"/><origin xyz="$(arg d) 0 0"/></joint>'
        '<xacro:if value="$(arg long)"><link name="tip"/><joint name="on" type="fixed"><parent link="palm"/>'
        '<child link="tip"/></joint></xacro:if></robot>'
    )
    (tmp_path / "h.urdf.xacro").write_text(text, "utf-8")
    options = {"args": {"long": True, "d": 0.25}, "packages": {"hands": str(package)}}
    edit = {"attach": {"file": str(tmp_path / "h.urdf.xacro"), "name": "h", "parent": "flange", **options}}
    robot = dh2urdf.convert(dh2urdf.read(TABLE), tmp_path / "out.urdf", edits=[edit]).robot
    assert [link.name for link in robot.links][-2:] == ["h_palm", "h_tip"]
    mounting = next(joint for joint in robot.joints if joint.name == "h_joint")
    assert mounting.origin.xyz == (0.25, 0.0, 0.0)
    (copy,) = (tmp_path / "meshes").glob("palm-*.stl")
    assert copy.read_bytes() == b"solid palm\nendsolid\n"


def test_a_table_has_the_arm_alone_and_says_so(convert: Callable[..., tuple[Path, Robot]], tmp_path: Path) -> None:
    convert(".urdf")
    edit = {"attach": {"file": str(tmp_path / "hand.urdf"), "name": "hand"}}
    with pytest.warns(dh2urdf.TableWarning, match="hand_base_link"):
        dh2urdf.convert(tmp_path / "arm.csv", tmp_path / "arm.yaml", edits=[edit])
    again, given = dh2urdf.read(tmp_path / "arm.yaml"), dh2urdf.read(tmp_path / "arm.csv")
    assert np.allclose(again.fk([0.3, -0.7]), given.fk([0.3, -0.7]), atol=1e-12)


def test_an_arm_stands_on_a_finger_of_another_arm(tmp_path: Path) -> None:
    """The proof of its tool begins at the link of the hand, which the hand's own proof has."""
    (tmp_path / "arm.csv").write_text(TABLE, "utf-8")
    (tmp_path / "hand.urdf").write_text(HAND, "utf-8")
    (tmp_path / "run.yaml").write_text(
        "inputs: arm.csv\noutput: out\nedits: [{stage: attach, options: {file: hand.urdf, name: hand}}]\n"
        "cells: {name: c, arms: [{name: l, of: arm}, {name: r, of: arm, parent: l/hand_left_finger}]}\n"
    )
    dh2urdf.run(tmp_path / "run.yaml")
    robot, q = read_urdf(tmp_path / "out" / "c.urdf"), {"l_one": 0.3, "l_hand_left": 0.4, "r_two": -0.2}
    found, alone = link_poses(robot, q), link_poses(read_urdf(tmp_path / "out" / "arm.urdf"), {"two": -0.2})
    finger, tool = found["l_hand_left_finger"], found["r_tool0"]
    assert np.allclose(as_matrices(finger @ alone["tool0"]), as_matrices(tool), atol=1e-12)


def test_a_changed_mesh_makes_the_arm_anew(tmp_path: Path) -> None:
    """A run that resumes knows what the description names, too."""
    stl = "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex {} 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid s\n"
    mesh = '<visual><geometry><mesh filename="palm.stl"/></geometry></visual>'
    (tmp_path / "arm.csv").write_text(TABLE, "utf-8")
    (tmp_path / "hand.urdf").write_text(f'<robot name="h"><link name="palm">{mesh}</link></robot>', "utf-8")
    (tmp_path / "run.yaml").write_text(
        "inputs: arm.csv\noutput: out\nedits: [{stage: attach, options: {file: hand.urdf, name: hand}}]\n"
    )
    written = []
    for width in (1, 1, 2):
        (tmp_path / "palm.stl").write_text(stl.format(width), "utf-8")
        dh2urdf.run(tmp_path / "run.yaml", resume=True)
        written.append((tmp_path / "out" / "arm.urdf").stat().st_mtime_ns)
    assert written[0] == written[1] < written[2]


def test_links_of_a_file_have_any_order(convert: Callable[..., tuple[Path, Robot]]) -> None:
    """The root is the link that nothing holds, and a frame without mass may have a shape."""
    box = "<visual><geometry><box size='1 1 1'/></geometry></visual>"
    held = "<joint name='j' type='fixed'><parent link='palm'/><child link='eye'/></joint>"
    hand = f"<robot name='h'><link name='eye'>{box}</link><link name='palm'/>{held}</robot>"
    for suffix in READERS:
        (shape,) = [
            shape
            for link in convert(suffix, hand)[1].links
            for shape in link.visuals
            if shape.geometry == Box(size=(1.0, 1.0, 1.0))
        ]
        assert shape


@pytest.mark.parametrize("emitter", ["urdf", "srdf"])
def test_the_report_names_the_tool(emitter: str, tmp_path: Path) -> None:
    """Of one arm and of its variants, which are made side by side; a group of the SRDF ends there."""
    (tmp_path / "arm.csv").write_text(TABLE, "utf-8")
    (tmp_path / "hand.urdf").write_text(HAND, "utf-8")
    variations = [{"name": "v", "of": "arm", "count": 3, "vary": {"joints": 1, "field": "a", "uniform": [0.3, 0.5]}}]
    attach = {"stage": "attach", "options": {"file": str(tmp_path / "hand.urdf"), "name": "hand", "tip": "tool0"}}
    run = {"inputs": str(tmp_path / "arm.csv"), "edits": [attach], "emitters": [emitter], "variations": variations}
    rows = dh2urdf.run({**run, "output": str(tmp_path / "out")})["manipulators"]
    assert [row["tools"] for row in rows] == [["hand_tool0"]] * 4
    for srdf in tmp_path.rglob("*.srdf"):
        assert etree.parse(str(srdf)).find("group/chain").get("tip_link") == "hand_tool0"
    (row,) = dh2urdf.run({**run, "edits": [], "variations": [], "output": str(tmp_path / "bare")})["manipulators"]
    assert "tools" not in row


def test_mujoco_takes_a_mesh_without_a_volume(convert: Callable[..., tuple[Path, Robot]], tmp_path: Path) -> None:
    """A label that is flat, or a screw of a micrometre: pieces of published visuals."""
    mujoco = pytest.importorskip("mujoco")
    flat = "".join(f"v {x} {y} 0\n" for x, y in ((0, 0), (1, 0), (0, 1), (1, 1))) + "f 1 2 3\nf 2 4 3\n"
    (tmp_path / "label.obj").write_text(flat, "utf-8")
    mesh = "<visual><geometry><mesh filename='label.obj'/></geometry></visual>"
    path, _ = convert(".xml", f"<robot name='h'><link name='palm'>{mesh}</link></robot>")
    assert mujoco.MjModel.from_xml_path(str(path)).nmesh == 1
