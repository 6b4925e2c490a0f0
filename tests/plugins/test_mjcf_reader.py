"""The reader of MJCF beside MuJoCo: what it and the studio take that the emitter would never write."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dh2urdf.errors import TableError
from dh2urdf.kinematics import KinematicChain, link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf.stages.foreign_robot import ForeignRobot
from dh2urdf_plugins.descriptions.description import describe
from dh2urdf_plugins.formats import foreign_mjcf
from dh2urdf_plugins.formats.mjcf.reader import parse_mjcf

mujoco = pytest.importorskip("mujoco")

FOREIGN = """
<mujoco model="foreign">
  <compiler angle="{angle}" eulerseq="{sequence}"/>
  <default>
    <joint axis="0 2 0" damping="0.3"/>
    <default class="arm"><geom type="box" size="0.1 0.2 0.3"/>
      <default class="hand"><joint axis="1 1 0"/><site pos="0 0 0.1"/></default></default>
  </default>
  <worldbody>
    <geom type="sphere" size="0.01"/>
    <body name="a" pos="0.1 0.2 0.3" euler="10 20 30" childclass="arm">
      <inertial pos="0.01 0 0" quat="1 1 0 0" mass="2" diaginertia="1 2 2.5"/>
      <geom/>
      <joint name="j1" pos="0.1 0 0" ref="15"/>
      <body name="b" pos="0 0 0.4" quat="1 2 3 4">
        <joint name="j2" type="slide" axis="0 0 1" ref="0.1" range="-1 1"/>
        <joint name="j3" class="hand" range="-20 30"/>
        <geom class="arm" contype="0" conaffinity="0" rgba="1 0 0 1"/>
        <geom type="cylinder" size="0.1 0.2" euler="90 0 0"/>
        <body name="c" pos="0.2 0 0">
          <inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0.1 0 0"/>
          <joint name="j4" pos="0 0.1 0.2" actuatorfrcrange="-5 5" limited="false" range="-1 1"/>
          <site name="tool0" class="hand" euler="0 0 90"/>
          <site name="c"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("sequence", ["xyz", "XYZ", "zyx", "ZXz"])
@pytest.mark.parametrize("angle", ["degree", "radian"])
def test_frames_are_where_mujoco_has_them(sequence: str, angle: str) -> None:
    """Degrees, Euler sequences, quaternions, anchors, reference values, several joints of a body, default classes."""
    text = FOREIGN.format(sequence=sequence, angle=angle)
    robot = parse_mjcf(text.encode(), "foreign.xml")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    draw = np.random.default_rng(5)
    for _ in range(5):
        q = dict(zip(("j1", "j2", "j3", "j4"), draw.uniform(-1, 1, 4), strict=True))
        for name, value in q.items():
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        for link in ("a", "b", "c", "tool0"):
            chain = KinematicChain.between(robot, "world", link)
            values = [q[joint.name] for joint in chain.joints if joint.type is not JointType.FIXED]
            pose = chain.forward_kinematics(values)
            frame = data.site(link) if link == "tool0" else data.body(link)
            assert np.abs(frame.xpos - pose.translation).max() < 1e-13
            assert np.abs(frame.xmat - pose.rotation).max() < 1e-13


ARM = """<mujoco><default><equality active="false"/><default class="near"><site pos="0.1 0.2 0.3"/></default>
    <default class="far"><site pos="1 2 3"/></default><default class="ends"><site type="capsule" fromto="0 0 1 1 0.5 0" size="0.1"/>
    </default></default><worldbody><body name="a" euler="10 20 30"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    <joint name="j" axis="0 1 0"{}/>{}</body></worldbody>{}</mujoco>"""
SITES = {
    "given by its ends": '<site name="s" type="box" size="0.1 0.1 0.1" fromto="0 0 0 1 2 3"/>',
    "given by its ends in a class": '<site name="s" class="ends"/>',
    "pointing down as exactly as an exporter wrote it": '<site name="s" zaxis="6.1e-17 0 -1"/>',
    "in a frame with a class": '<frame class="near"><frame euler="0 10 0"><site name="s"/></frame></frame>',
    "in a frame with a class for what is in it": '<frame class="near" childclass="far"><site name="s"/></frame>',
}


@pytest.mark.parametrize("site", SITES)
def test_a_site_is_where_mujoco_has_it(site: str) -> None:
    """The tip of an arm was in the origin of its body."""
    text = ARM.format("", SITES[site], "")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.joint("j").qpos[0] = 0.7
    mujoco.mj_kinematics(model, data)
    pose = KinematicChain.between(parse_mjcf(text.encode(), "x"), "world", "s").forward_kinematics([0.7])
    assert pose.translation == pytest.approx(data.site("s").xpos, abs=1e-13)
    assert pose.rotation == pytest.approx(data.site("s").xmat, abs=1e-13)


@pytest.mark.parametrize("limited", ["", "true", "false"])
@pytest.mark.parametrize("ends", ["0 0", "1 1", "2 -1", "-1 2"])
@pytest.mark.parametrize(("name", "switch"), [("range", "limited"), ("actuatorfrcrange", "actuatorfrclimited")])
def test_a_range_counts_where_it_counts_in_mujoco(name: str, switch: str, ends: str, limited: str) -> None:
    """One that is empty held the joint at one value, and a force that is not limited was its effort."""
    text = ARM.format(f' {name}="{ends}"' + (f' {switch}="{limited}"' if limited else ""), "", "")
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError:  # limited by an empty range
        return
    (joint,) = parse_mjcf(text.encode(), "x").moving_joints
    counts = (model.jnt_limited if name == "range" else model.jnt_actfrclimited)[0]
    limits = joint.limits
    assert (limits.lower is not None or limits.effort is not None) == counts
    assert (joint.type is JointType.REVOLUTE) == (bool(counts) and name == "range")


def test_constraints_are_those_that_hold(tmp_path: Path) -> None:
    """One that its class switches off made the joint a follower; one of tendons, which couples joints, had no notice."""
    path = tmp_path / "arm.xml"
    for tag, words in (("joint", 'joint1="j"'), ("connect", 'body1="a" anchor="0 0 0"'), ("tendon", 'tendon1="t"')):
        for active in ("", ' active="true"'):
            tendon = '<tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>' if tag == "tendon" else ""
            path.write_text(ARM.format("", "", f"{tendon}<equality><{tag} {words}{active}/></equality>"))
            found = describe("mjcf", path)
            holds = bool(any(joint.follows for joint in found.robot.joints) or found.notices)
            assert holds == bool(mujoco.MjModel.from_xml_path(str(path)).eq_active0[0])
            assert bool(found.doubly) == (holds and tag == "connect")


def test_what_it_holds() -> None:
    """Losses, efforts, turned inertias and colours, defaults included; what is compared with MuJoCo below is not repeated."""
    robot = parse_mjcf(FOREIGN.format(sequence="xyz", angle="degree").encode(), "foreign.xml")
    assert (robot.name, robot.root) == ("foreign", "world")
    j1, _, _, j4 = robot.moving_joints
    assert (j1.axis, j1.damping, j1.friction, j4.limits.effort) == ((0.0, 1.0, 0.0), 0.3, None, 5.0)
    links = {link.name: link for link in robot.links}
    inertial, (shape,) = links["a"].inertial, links["b"].visuals
    assert inertial is not None
    assert shape.material is not None
    # Turned by 90° about x, the second and the third moment change places.
    assert (inertial.mass, inertial.inertia.iyy, inertial.inertia.izz) == pytest.approx((2.0, 2.5, 2.0))
    assert shape.material.rgba == (1.0, 0.0, 0.0, 1.0)
    assert links["world"].collisions[0].geometry == Sphere(radius=0.01)


MAIN = """<mujoco model="arm"><compiler meshdir="meshes"/><include file="parts/common.xml"/>
  <worldbody>
    <geom name="floor" type="plane" size="1 1 0.1"/>
    <frame name="table" pos="0.1 0.2 0.3" euler="0 0 30" childclass="sideways">
      <body name="base" axisangle="0 2 0 40"><freejoint name="loose"/><geom class="main" size="0.1"/><body name="one">
        <frame pos="0 0 0.1" xyaxes="1 1 0 0 1 0.5"><joint name="a" pos="0.1 0 0" range="-20 30"/>
          <geom type="capsule" fromto="0 0 0 0.1 0.2 0.3" size="0.05" material="red"/>
          <frame zaxis="0 0 -1"><body name="two" pos="0 0 0.4" zaxis="1 2 -3"><joint name="ball" type="ball"/>
            <joint name="b" type="slide" axis="1 0 1" limited="false" range="-1 1"/>
            <geom type="ellipsoid" size="0.1 0.2 0.3" euler="10 20 30" mass="2"/><geom type="box" size="0.1 0.2 0.3"/>
            <include file="parts/tip.xml"/></body></frame></frame></body></body>
    </frame>
  </worldbody>
  <worldbody><body name="other"><joint name="d" limited="true" range="-1 2"/><geom type="box" size="0.1" fromto="0 0 0 0 0 1"
    rgba="0 1 0 1" material="red" group="3"/></body></worldbody>
  <equality><connect body1="two" body2="other" anchor="0 0 0"/></equality>
</mujoco>"""
COMMON = """<mujocoinclude><compiler angle="degree" autolimits="true" inertiagrouprange="0 4"/>
  <asset><material name="red" rgba="1 0 0 1"/><mesh file="tetra.obj" scale="2 2 2" refpos="0.1 0.2 0.3"
    refquat="1 2 3 4"/></asset>
  <default><default class="sideways"><joint axis="0 1 0"/><geom euler="0 0 90"/></default></default></mujocoinclude>"""
TIP = """<mujocoinclude><body name="three" pos="0 0 1"><joint name="c" axis="0 0 1" range="1 2"/><body>
  <geom type="mesh" mesh="tetra" quat="1 1 0 0" contype="0" conaffinity="0" mass="0"/><geom class="main" size="0.1"
  group="5"/><geom type="cylinder" size="0.1 0.2 0" density="3000"/></body></body></mujocoinclude>"""
TETRA = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A model in three files, whose mesh is beside the file that names it."""
    folder = tmp_path_factory.mktemp("model")
    (folder / "parts").mkdir()
    for name, text in (("common.xml", COMMON), ("tip.xml", TIP), ("tetra.obj", TETRA)):
        (folder / "parts" / name).write_text(text)
    (folder / "arm.xml").write_text(MAIN)
    return folder / "arm.xml"


@pytest.fixture(scope="module")
def found(path: Path) -> ForeignRobot:
    return foreign_mjcf(path)


@pytest.fixture(scope="module")
def model(path: Path) -> Any:
    return mujoco.MjModel.from_xml_path(str(path))


VALUES = {"a": 0.3, "b": -0.4, "c": 1.2, "d": 0.5}


def _placed(model: Any) -> Any:
    """The model with its joints at `VALUES`."""
    data = mujoco.MjData(model)
    for name, value in VALUES.items():
        data.joint(name).qpos = value
    mujoco.mj_kinematics(model, data)
    return data


def _frame(position: Any, matrix: Any) -> Any:
    frame = np.eye(4)
    frame[:3, :3], frame[:3, 3] = np.reshape(matrix, (3, 3)), position
    return frame


def test_every_body_is_where_mujoco_has_it(found: ForeignRobot, model: Any) -> None:
    """Frames, included files, classes of frames, every kind of orientation, joints that no table has."""
    data, poses = _placed(model), link_poses(found.robot, VALUES)
    for name in ("base", "one", "two", "three", "other"):
        body = data.body(name)
        assert as_matrices(poses[name]) == pytest.approx(_frame(body.xpos, body.xmat), abs=1e-12)
    assert found.loose == {"loose": "floating", "ball": "ball"}
    assert [joint.name for joint in found.robot.moving_joints] == ["a", "b", "c", "d"]
    assert [notice.code for notice in found.notices] == ["left-out"] * 3


BALL = """<mujoco model="ball"><default><joint axis="0 1 0" pos="0.1 0 0" ref="20" range="-20 30"/></default>
  <worldbody><body name="one" axisangle="0 1 0 40"><joint name="a"/><geom size="0.1"/>
  <body name="two" pos="0 0 1"><joint name="ball" type="ball" ref="40" range="0 30"/>
  <joint name="b" type="slide"/><geom type="capsule" size="0.1 0.1"/><site name="three" quat="1 0 0 0" pos="1 0 0"/>
  </body></body></worldbody></mujoco>"""


def test_a_ball_joint_has_no_reference_value(tmp_path: Path) -> None:
    path = tmp_path / "ball.xml"
    path.write_text(BALL)
    model = mujoco.MjModel.from_xml_path(str(path))
    data, robot, values = mujoco.MjData(model), foreign_mjcf(path).robot, {"a": 0.3, "b": -0.2}
    for name, value in values.items():
        data.joint(name).qpos = value
    mujoco.mj_kinematics(model, data)
    poses = link_poses(robot, values)
    for name, found in (("one", data.body), ("two", data.body), ("three", data.site)):
        assert as_matrices(poses[name]) == pytest.approx(_frame(found(name).xpos, found(name).xmat), abs=1e-12)
    limits = robot.moving_joints[0].limits
    assert (limits.lower, limits.upper) == pytest.approx(model.joint("a").range)


def test_limits_are_those_that_count(found: ForeignRobot, model: Any) -> None:
    for joint in found.robot.moving_joints:
        if model.joint(joint.name).limited:
            assert (joint.limits.lower, joint.limits.upper) == pytest.approx(model.joint(joint.name).range)
        else:
            assert (joint.limits.lower, joint.limits.upper) == (None, None)


def test_every_shape_is_where_mujoco_has_it(found: ForeignRobot, model: Any) -> None:
    """A capsule is a cylinder with a ball at each end; what is hidden only touches; a mesh is where it is drawn."""
    data, poses = _placed(model), link_poses(found.robot, VALUES)
    ours = {
        (type(shape.geometry), link.name): (shape, as_matrices(poses[link.name] @ shape.origin.transform))
        for link in found.robot.links
        for shape in (*link.visuals, *link.collisions)
    }
    nameless = next(link.name for link in found.robot.links if link.name.startswith("body in line"))
    kinds = {"BOX": Box, "CAPSULE": Cylinder, "CYLINDER": Cylinder, "MESH": Mesh}
    compared = 0
    for number in range(model.ngeom):
        kind = mujoco.mjtGeom(model.geom_type[number]).name.removeprefix("mjGEOM_")
        if kind not in kinds:
            continue
        link = model.body(model.geom_bodyid[number]).name or nameless
        shape, pose = ours[kinds[kind], link]
        theirs = _frame(data.geom_xpos[number], data.geom_xmat[number])
        if kind == "MESH":  # MuJoCo moves it to its centre of mass and principal axes.
            corners = model.mesh_vert @ theirs[:3, :3].T + theirs[:3, 3]
            scaled = np.array(shape.geometry.scale) * CORNERS
            own = scaled @ pose[:3, :3].T + pose[:3, 3]
            assert np.array(sorted(map(tuple, corners.round(6)))) == pytest.approx(
                np.array(sorted(map(tuple, own.round(6)))), abs=1e-5
            )
        else:
            size = model.geom_size[number]
            own = shape.geometry
            half = own.size if isinstance(own, Box) else (2 * own.radius, own.length)
            assert np.array(half) / 2 == pytest.approx(size[: len(half)])
        if kind == "BOX" and link == "two":
            assert pose == pytest.approx(theirs, abs=1e-12)
        elif kind != "MESH":  # round, or given by its ends: turned about its axis at will
            assert pose[:3, 2:] == pytest.approx(theirs[:3, 2:], abs=1e-12)
        compared += 1
    assert compared == 5
    one = next(link for link in found.robot.links if link.name == "one")
    assert [type(shape.geometry) for shape in one.visuals] == [Cylinder, Sphere, Sphere]
    ends = [np.array(shape.origin.xyz) for shape in one.visuals[1:]]
    assert np.linalg.norm(ends[0] - ends[1]) == pytest.approx(np.linalg.norm((0.1, 0.2, 0.3)))
    assert {shape.material.rgba for shape in one.visuals if shape.material} == {(1.0, 0.0, 0.0, 1.0)}
    other = next(link for link in found.robot.links if link.name == "other")
    assert (len(other.visuals), len(other.collisions)) == (0, 1)
    with_look = next(link for link in found.robot.links if link.name == nameless)
    assert [type(shape.geometry) for shape in with_look.visuals] == [Mesh]
    assert len(with_look.collisions) == 2


def test_masses_follow_from_shapes(found: ForeignRobot, model: Any) -> None:
    compared = 0
    for link in found.robot.links:
        name = "" if link.name.startswith("body in line") else link.name
        number = next((number for number in range(model.nbody) if model.body(number).name == name), 0)
        if not number or link.inertial is None:
            continue
        R = np.zeros(9)
        mujoco.mju_quat2Mat(R, model.body_iquat[number])
        R = R.reshape(3, 3)
        i = link.inertial.inertia
        tensor = np.array([[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]])
        assert link.inertial.mass == pytest.approx(model.body_mass[number])
        assert link.inertial.com == pytest.approx(model.body_ipos[number], abs=1e-12)
        assert tensor == pytest.approx(R @ np.diag(model.body_inertia[number]) @ R.T, rel=1e-6, abs=1e-9)
        compared += 1
    assert compared == 5


def test_no_file_of_another_folder_is_included(tmp_path: Path) -> None:
    (tmp_path / "one" / "two").mkdir(parents=True)
    (tmp_path / "secret.xml").write_text("<x/>")
    path = tmp_path / "one" / "two" / "arm.xml"
    path.write_text('<mujoco><include file="../../secret.xml"/><worldbody/></mujoco>')
    with pytest.raises(TableError) as caught:
        foreign_mjcf(path)
    assert [problem.code for problem in caught.value.problems] == ["include-refused"]
