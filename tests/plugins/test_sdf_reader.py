"""The reader of SDF beside Drake's: files that the emitter would never write; each case was once another arm, or refused."""

from pathlib import Path

import numpy as np
import pytest
from drake_frames import drake_frames

import dh2urdf
from dh2urdf.errors import ProofError, TableError
from dh2urdf.kinematics import KinematicChain, link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf_plugins.formats import foreign_sdf
from dh2urdf_plugins.formats.sdf.reader import parse_sdf

INERTIAL = "<inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial>"
FOREIGN = f"""<?xml version="1.0"?>
<sdf version="1.7">
  <model name="foreign">
    <frame name="far" attached_to="base"><pose relative_to="near">0 0 0.2 0.3 0 0</pose></frame>
    <frame name="near"><pose>0.1 0 0 0 0 0.4</pose></frame>
    <link name="base"><pose>0 0.3 0 0.1 0.2 0.3</pose>{INERTIAL}</link>
    <joint name="hold" type="fixed"><parent>world</parent><child>base</child></joint>
    <link name="a"><pose relative_to="j1">0.05 0 0.1 0 0 0.7</pose>
      <inertial><pose>0.01 0 0 1.5707963267948966 0 0</pose><mass>3</mass>
        <inertia><ixx>1</ixx><iyy>2</iyy><izz>2.5</izz></inertia></inertial>
      <visual name="v"><pose relative_to="side">0 0 0.1 0 0 0</pose><geometry><sphere><radius>0.1</radius></sphere>
        </geometry><material><diffuse>1 0 0 1</diffuse></material></visual>
      <collision name="c"><geometry><box><size>1 2 3</size></box></geometry></collision>
      <collision name="d"><geometry><cylinder><radius>1</radius><length>2</length></cylinder></geometry></collision>
      <visual name="m"><geometry><mesh><uri>a.stl</uri></mesh></geometry></visual>
    </link>
    <joint name="j1" type="revolute"><pose relative_to="base">0 0 0.3 0.2 0 0</pose>
      <parent>base</parent><child>a</child>
      <axis><xyz>0 1 0</xyz><limit><lower>-1</lower><upper>2</upper><effort>5</effort><velocity>-1</velocity></limit>
        <dynamics><damping>0.1</damping><friction>0.2</friction></dynamics></axis></joint>
    <frame name="side" attached_to="a"><pose>0 0.1 0 0 0.5 0</pose></frame>
    <link name="b"><pose relative_to="side">0 0 0.4 0 0 0</pose>{INERTIAL}</link>
    <joint name="j2" type="prismatic"><pose>0 0 0.1 0 0 0.5</pose><parent>side</parent><child>b</child>
      <axis><xyz expressed_in="base">0 0 1</xyz><limit><lower>-1e16</lower><upper>1e16</upper></limit></axis></joint>
    <link name="c"><pose>0.5 0.6 0.7 0 0 0</pose>{INERTIAL}</link>
    <joint name="j3" type="continuous"><parent>b</parent><child>c</child><axis><xyz>1 0 0</xyz></axis></joint>
    <frame name="tool0" attached_to="j3"><pose>0 0 0.1 0 1 0</pose></frame>
  </model>
</sdf>
"""
FOREIGN_FRAMES = ("near", "far", "base", "a", "side", "b", "c", "tool0")


def test_frames_are_where_drake_has_them(tmp_path: Path) -> None:
    """Poses relative to joints, links and frames, joints away from their links, axes in other frames."""
    path = tmp_path / "foreign.sdf"
    path.write_text(FOREIGN)
    frame = drake_frames(path)
    robot = parse_sdf(FOREIGN.encode(), "foreign.sdf")
    draw = np.random.default_rng(5)
    for _ in range(5):
        values = dict(zip(("j1", "j2", "j3"), draw.uniform(-1, 1, 3), strict=True))
        for name in FOREIGN_FRAMES:
            chain = KinematicChain.between(robot, "world", name)
            q = [values[joint.name] for joint in chain.joints if joint.type is not JointType.FIXED]
            pose = chain.forward_kinematics(q)
            T = frame(values, name)
            assert np.abs(T[:3, :3].ravel() - pose.rotation).max() < 1e-13
            assert np.abs(T[:3, 3] - pose.translation).max() < 1e-13


TURNED = "<pose>1 0 0 1.2 0.3 0.4</pose>"
HELD = '<joint name="w" type="fixed"><parent>world</parent><child>a</child></joint>'
LINKS = f'<link name="a">{TURNED}</link><link name="b"><pose>0 1 0.2 0.3 0 0.5</pose></link>'
ABOUT_Z = "<axis><xyz>0 0 1</xyz></axis></joint>"
TURNING = f'<joint name="j" type="revolute"><parent>a</parent><child>b</child>{ABOUT_Z}'
IN_MODEL = "<xyz>0 0 1</xyz><use_parent_model_frame>1</use_parent_model_frame>"


def _model(version: str, content: str, attributes: str = "") -> str:
    return f'<sdf version="{version}"><model name="m"{attributes}>{content}</model></sdf>'


CASES = {
    "a quaternion": _model(
        "1.9",
        f'<link name="a"/><link name="b"><pose rotation_format="quat_xyzw">1 2 3 0.5 0.5 -0.5 0.5</pose></link>{TURNING}',
    ),
    "a joint between frames": _model(
        "1.9",
        f'{HELD}<frame name="fa" attached_to="a"><pose>0 0 0.5 0 0 1</pose></frame><frame name="fb" attached_to="b">'
        f'<pose>0 0.1 0 0.1 0.2 0.3</pose></frame><link name="a"/><link name="b">{TURNED}</link><joint name="j" type="revolute">'
        "<pose>0.1 0.2 0.3 0.4 0.5 0.6</pose><parent>fa</parent><child>fb</child>"
        '<axis><xyz expressed_in="__model__">0 0 1</xyz></axis></joint>',
    ),
    "a prefix that nothing declares": _model(
        "1.9", f'{HELD}{LINKS}<plugin filename="p" name="p"><gz:link gz:of="b">other</gz:link></plugin>{TURNING}'
    ),
    "a frame of the model, which moves with its canonical link": _model(
        "1.9", f'{HELD}{LINKS}{TURNING}<frame name="tip"><pose>0 0 1 0.1 0 0</pose></frame>', ' canonical_link="b"'
    ),
    "a frame of the model, which moves with its first link": _model(
        "1.7",
        f'<frame name="tip"><pose>0 0 1 0 1 0</pose></frame><link name="b"/><link name="a">{TURNED}</link>{TURNING}{HELD}',
    ),
    "a model whose own link is canonical, behind the one in it": _model(
        "1.9",
        f'{HELD}<link name="a"/><model name="n">{TURNED}<model name="deep"><link name="c"/></model><link name="b"/>'
        f'{TURNING.replace("<parent>a", "<parent>deep::c")}</model><frame name="tip" attached_to="n"/>'
        '<joint name="k" type="fixed"><parent>a</parent><child>n::deep::c</child></joint>',
    ),
    "an axis in the frame of a model in the model": _model(
        "1.6",
        f'{HELD.replace("<child>a", "<child>n::a")}<model name="n">{TURNED}{LINKS}{TURNING.replace("<xyz>0 0 1</xyz>", IN_MODEL)}</model>',
    ),
    "an axis of version 1.4": _model("1.4", f"{HELD}{LINKS}{TURNING}"),
    "an axis of version 1.4 that says where it is": _model(
        "1.4", f"{HELD}{LINKS}{TURNING.replace('<xyz>0 0 1</xyz>', IN_MODEL.replace('1</use', '0</use'))}"
    ),
    "an axis of version 1.4 in a model in the model": _model(
        "1.4", f'{HELD.replace("<child>a", "<child>n::a")}<model name="n">{TURNED}{LINKS}{TURNING}</model>'
    ),
    "a model that is placed by one of its frames": _model(
        "1.9",
        f'{HELD}<link name="a"/><model name="n" placement_frame="deep::grip"><pose relative_to="a">1 2 3 0 0.3 0</pose>'
        f'<model name="deep" placement_frame="b"><pose>0 0.2 0 0 0 0.7</pose><link name="c"/><link name="b">{TURNED}</link>'
        f'<frame name="grip" attached_to="c"><pose relative_to="b">0 0.1 0 0.2 0 0</pose></frame><joint name="k" type="fixed">'
        '<parent>b</parent><child>c</child></joint></model></model><frame name="tip" attached_to="n::deep::grip"/>'
        f"{TURNING.replace('<child>b', '<child>n::deep::b')}",
    ),
    "a model that is placed by a frame of the world": '<sdf version="1.9"><world name="w"><frame name="far" attached_to="near">'
    f'<pose>0 0 0.2 0 0.4 0</pose></frame><frame name="near"><pose relative_to="o">0 0.3 0 0 0 1</pose></frame><model name="m">'
    f'<pose relative_to="far">1 0 0 0.5 0 0</pose>{HELD}{LINKS}{TURNING}</model><model name="o"><pose>0 0 5 0 0 0.3</pose>'
    '<link name="x"/></model></world></sdf>',
    "a pose in a frame, in the words of older versions": _model(
        "1.6",
        f'{HELD}<link name="a">{TURNED}</link><link name="b"><pose frame="a">0 1 0 0.3 0 0</pose></link>{TURNING}',
    ),
    "degrees and a type in other letters": _model(
        "1.9",
        f'{HELD}<link name="a"/><link name="b"><pose degrees=" True">1 0 0 90 20 0</pose></link>'
        f"{TURNING.replace('revolute', 'Revolute')}",
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
    ("text", "code"),
    [
        (_model("1.9", LINKS + TURNING.replace("<child>b", "<child>world")), "joint-moves-world"),
        (
            f'<sdf version="1.9"><world name="w"><model name="m"><pose relative_to="o::x"/>{LINKS}{TURNING}</model></world></sdf>',
            "model-placed-elsewhere",
        ),
    ],
)
def test_what_would_be_another_arm_is_refused(text: str, code: str) -> None:
    """The joint was no part of the robot, and the model was in the origin, without a word."""
    with pytest.raises(ProofError) as caught:
        parse_sdf(text.encode(), "m.sdf")
    assert [problem.code for problem in caught.value.problems] == [code]


INCLUDED = '<include{}><uri>model://elbow</uri><name>e</name><pose relative_to="a"/></include>'
AT_ELBOW = TURNING.replace('"j"', '"k"').replace("<parent>a", "<parent>{}").replace("<child>b", "<child>c")


@pytest.mark.parametrize(("nested", "parent"), [("", "e::palm"), (' merge="true"', "palm"), ("", "n::e::palm")])
def test_a_chain_through_an_included_model_is_refused(tmp_path: Path, nested: str, parent: str) -> None:
    """The joint behind it was left out, and the arm had one joint less; the parts before and behind it are arms."""
    included = INCLUDED.format(nested)
    if parent.startswith("n::"):
        included = f'<model name="n"><pose relative_to="a"/>{included}</model><frame name="f" attached_to="n"/>'
    behind = '<link name="c"/><link name="d"/>' + TURNING.replace('"j"', '"i"').replace(
        "<parent>a", "<parent>c"
    ).replace("<child>b", "<child>d")
    placed = '<frame name="far" attached_to="d"><pose relative_to="k"/></frame>'
    path = tmp_path / "m.sdf"
    path.write_text(_model("1.9", f"{HELD}{LINKS}{TURNING}{included}{AT_ELBOW.format(parent)}{behind}{placed}"))
    with pytest.raises(TableError, match="the chain holds 'k', which is at an included model"):
        dh2urdf.extract(path, tip_link="d")
    for base, tip, joint in (("a", "b", "j"), ("c", "d", "i")):
        assert [row.joint for row in dh2urdf.extract(path, base_link=base, tip_link=tip).rows] == [joint]
    links = {link.name for link in foreign_sdf(path).robot.links}
    assert links.isdisjoint({"n", "f", "far"})


def test_a_joint_of_the_world_is_noticed(tmp_path: Path) -> None:
    path = tmp_path / "m.sdf"
    rail = '<joint name="rail" type="prismatic"><parent>world</parent><child>m</child><axis><xyz>0 1 0</xyz></axis></joint>'
    path.write_text(f'<sdf version="1.11"><world name="w"><model name="m">{LINKS}{TURNING}</model>{rail}</world></sdf>')
    assert [notice.message for notice in foreign_sdf(path).notices] == ["a joint of the world is left out"]


def test_a_word_that_version_1_7_has_no_more_means_nothing(tmp_path: Path) -> None:
    """sdformat passes `use_parent_model_frame` over, and Drake refuses it; the axis was in the frame of the model."""
    path = tmp_path / "m.sdf"
    path.write_text(_model("1.7", f"{HELD}{LINKS}{TURNING}"))
    frame = drake_frames(path)
    path.write_text(_model("1.7", f"{HELD}{LINKS}{TURNING.replace('<xyz>0 0 1</xyz>', IN_MODEL)}"))
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
        path.write_text(_model("1.9", f'<link name="a"/><link name="b">{pose}</link>{TURNING}'))
        notices = dh2urdf.extract(path, base_link="a", tip_link="b").notices
        assert len([notice for notice in notices if notice.field == "rounded_pi"]) == count


def test_a_joint_may_have_the_name_of_its_link(tmp_path: Path) -> None:
    """As in PX4's rovers; sdformat took it before 1.7. A frame that was attached to itself came out."""
    text = (
        '<sdf version="1.6"><model name="m"><link name="a"/><link name="b">' + TURNED + '</link><joint name="{}" '
        'type="revolute"><pose>0.1 0.2 0.3 0 0 0</pose><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz>'
        "<use_parent_model_frame>1</use_parent_model_frame></axis></joint></model></sdf>"
    )
    path = tmp_path / "m.sdf"
    path.write_text(text.format("j"))
    frame, robot = drake_frames(path), parse_sdf(text.format("b").encode(), "m.sdf")
    for value in (0.0, 0.4, -0.7):
        poses = {name: as_matrices(pose) for name, pose in link_poses(robot, {"b": value}).items()}
        theirs = np.linalg.solve(frame({"j": value}, "a"), frame({"j": value}, "b"))
        assert np.linalg.solve(poses["a"], poses["b"]) == pytest.approx(theirs, abs=1e-12)


def test_what_is_at_an_included_model_goes_with_it(tmp_path: Path) -> None:
    """An arm with an included gripper, as PX4's with included sensors, is an arm; it was refused."""
    path = tmp_path / "m.sdf"
    path.write_text(
        '<sdf version="1.10"><model name="m"><link name="a"/><link name="b"><pose>0 0 1 0 0 0</pose></link>\n'
        '<joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz></axis></joint>\n'
        '<include merge="true"><uri>model://gripper</uri><pose relative_to="b"/></include>\n'
        '<joint name="hold" type="fixed"><parent>b</parent><child>palm</child></joint>\n'
        '<frame name="grasp" attached_to="palm"/><frame name="point" attached_to="grasp"/></model></sdf>'
    )
    for _ in range(2):
        found = foreign_sdf(path)
        assert [(joint.name, joint.child) for joint in found.robot.moving_joints] == [("j", "b")]
        assert [(notice.message, notice.mark and notice.mark.line) for notice in found.notices] == [
            ("an included model is left out", 3),
            ("a joint at an included model is left out", 4),
            ("a frame at an included model is left out, in 2 places (lines 5, 5)", 5),
        ]
    path.write_text('<sdf version="1.9"><world name="w"><include><uri>model://arm</uri></include></world></sdf>')
    with pytest.raises(TableError, match="it includes 'model://arm': give the file of that model"):
        foreign_sdf(path)


def test_shapes_and_colours_as_the_specification_fills_them_in(tmp_path: Path) -> None:
    """An opaque colour of three numbers, shapes without sizes, none, and those that robots have no place for."""
    shapes = "".join(
        f'<visual name="v{number}"><geometry>{shape}</geometry><material><diffuse>{colour}</diffuse></material></visual>'
        for number, (shape, colour) in enumerate(
            (
                ("<box/>", "1 0 0"),
                ("<sphere/>", "0 1 0 0.5"),
                ("<cylinder/>", "0 0 1"),
                ("", "0 0 1"),
                ("<gear/>", "0 0 1"),
            )
        )
    )
    path = tmp_path / "m.sdf"
    path.write_text(f'<sdf version="1.9"><model name="m"><link name="a">{shapes}</link></model></sdf>')
    found = foreign_sdf(path)
    visuals = next(link for link in found.robot.links if link.name == "a").visuals
    assert [(shape.geometry, shape.material and shape.material.rgba) for shape in visuals] == [
        (Box(size=(1.0, 1.0, 1.0)), (1.0, 0.0, 0.0, 1.0)),
        (Sphere(radius=1.0), (0.0, 1.0, 0.0, 0.5)),
        (Cylinder(radius=1.0, length=1.0), (0.0, 0.0, 1.0, 1.0)),
    ]
    assert [notice.message for notice in found.notices] == ["a shape 'gear' is left out"]


def test_a_link_may_be_the_world() -> None:
    """As in PyBullet's grippers; a loop of a link with itself came out."""
    robot = parse_sdf(
        b'<sdf version="1.6"><model name="m"><link name="world"/><link name="b"/><joint name="j" type="fixed">'
        b"<parent>world</parent><child>b</child></joint></model></sdf>",
        "m.sdf",
    )
    assert [link.name for link in robot.links] == ["world", "b"]
    assert [(joint.parent, joint.child) for joint in robot.joints] == [("world", "b")]


def test_what_a_robot_has_no_place_for_is_noticed(tmp_path: Path) -> None:
    """Shapes, other models, included ones; a capsule is a cylinder and two balls, and a ball joint is drawn as fixed."""
    shapes = "".join(
        f'<visual name="v{number}"><pose>0 0 1 0 0 0</pose><geometry>{shape}</geometry></visual>'
        for number, shape in enumerate(
            (
                "<plane><normal>0 0 1</normal></plane>",
                "<plane><normal>0 0 1</normal></plane>",
                "<capsule><radius>0.1</radius><length>0.4</length></capsule>",
                "<empty/>",
            )
        )
    )
    path = tmp_path / "m.sdf"
    path.write_text(
        f'<sdf version="1.9"><world name="w"><model name="m"><link name="a">{shapes}</link><link name="b"/>'
        '<joint name="j" type="ball"><parent>a</parent><child>b</child></joint>\n<include><uri>model://x</uri></include>'
        '<joint name="again" type="fixed"><parent>world</parent><child>b</child></joint></model>\n<model name="o"><link name="c"/></model></world></sdf>'
    )
    found = foreign_sdf(path)
    assert found.loose == {"j": "ball"}
    a = next(link for link in found.robot.links if link.name == "a")
    assert [(type(shape.geometry), shape.origin.xyz[2]) for shape in a.visuals] == [
        (Cylinder, 1.0),
        (Sphere, 1.2),
        (Sphere, 0.8),
    ]
    assert [(notice.message, notice.mark and notice.mark.line) for notice in found.notices] == [
        ("a model besides the first one is left out", 3),
        ("an included model is left out", 2),
        ("a second joint of a link is left out", 2),
        ("a shape 'plane' is left out, in 2 places (lines 1, 1)", 1),
    ]


def test_a_frame_may_be_attached_to_a_frame() -> None:
    """It is in that one (which Drake 1.51 has otherwise)."""
    frames = '<frame name="g" attached_to="f"><pose>0 0 1 0 0 0</pose></frame>'
    frames += '<frame name="f" attached_to="b"><pose>1 0 0 0 1.5707963267948966 0</pose></frame>'
    robot = parse_sdf(MODEL.format(frames).encode(), "x")
    assert KinematicChain.between(robot, "b", "g").forward_kinematics([]).translation == (2.0, 0.0, 0.0)


def test_what_it_holds() -> None:
    """Types, limits, losses, masses, shapes and colours; a limit that is none is none."""
    robot = parse_sdf(FOREIGN.encode(), "foreign.sdf")
    assert robot.name == "foreign"
    joints = {joint.name: joint for joint in robot.joints}
    assert (joints["j1"].limits.lower, joints["j1"].limits.upper) == (-1.0, 2.0)
    assert (joints["j1"].limits.effort, joints["j1"].limits.velocity) == (5.0, None)
    assert (joints["j1"].damping, joints["j1"].friction) == (0.1, 0.2)
    assert (joints["j2"].limits.lower, joints["j2"].type) == (None, JointType.PRISMATIC)
    assert joints["j3"].type is JointType.CONTINUOUS
    a = next(link for link in robot.links if link.name == "a")
    assert a.inertial is not None
    assert (a.inertial.mass, a.inertial.com) == (3.0, (0.01, 0.0, 0.0))
    assert (a.inertial.inertia.iyy, a.inertial.inertia.izz) == pytest.approx((2.5, 2.0))
    assert [collision.geometry for collision in a.collisions] == [
        Box(size=(1.0, 2.0, 3.0)),
        Cylinder(radius=1.0, length=2.0),
    ]
    sphere, mesh = a.visuals
    assert sphere.geometry == Sphere(radius=0.1)
    assert sphere.origin.xyz == pytest.approx((0.1 * np.sin(0.5), 0.1, 0.1 * np.cos(0.5)))
    assert sphere.material is not None
    assert (mesh.geometry, mesh.material) == (Mesh(filename="a.stl"), None)


def test_a_link_without_mass_weighs_what_sdf_says() -> None:
    """1 kg, and 1 kg·m² about each axis."""
    robot = parse_sdf(b'<sdf version="1.7"><model name="m"><link name="a"/></model></sdf>', "x")
    inertial = robot.links[1].inertial
    assert inertial is not None
    assert (inertial.mass, inertial.inertia.ixx, inertial.inertia.ixy) == (1.0, 1.0, 0.0)


MODEL = '<sdf version="1.7"><model name="m"><link name="a"/><link name="b"/>{}</model></sdf>'
