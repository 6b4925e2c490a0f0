"""MJCF of any origin beside MuJoCo: what its readers and the studio take that the emitter would never write."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from dh2urdf.errors import TableError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf_plugins.formats import foreign_mjcf

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.stages.foreign_robot import ForeignRobot

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
    return pytest.importorskip("mujoco").MjModel.from_xml_path(str(path))


VALUES = {"a": 0.3, "b": -0.4, "c": 1.2, "d": 0.5}


def _placed(model: Any) -> Any:
    """The model with its joints at `VALUES`."""
    mujoco = pytest.importorskip("mujoco")
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


BLANK = """<mujoco model="blank"><default><joint axis="0 1 0" pos="0.1 0 0" ref="20" range="-20 30"/>
  <site euler="10 20 30"/></default><worldbody><body name="one" pos="" euler=" " axisangle="0 1 0 40">
  <frame pos="" quat=""><joint name="a" axis="" pos=" " ref="" range=""/><geom size="0.1"/>
  <body name="two" pos="0 0 1" zaxis=""><joint name="ball" type="ball" ref="40" range="0 30"/>
  <joint name="b" type="slide"/><geom type="capsule" size="0.1 0.1" fromto=""/>
  <site name="three" euler=""/><site name="four" quat="" pos="1 0 0"/></body></frame></body></worldbody></mujoco>"""


def test_blank_attributes_and_references_of_balls_are_what_mujoco_has(tmp_path: Path) -> None:
    """What is blank is not there, but a quaternion, which turns nothing; a ball joint has no reference value."""
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "blank.xml"
    path.write_text(BLANK)
    model = mujoco.MjModel.from_xml_path(str(path))
    data, robot, values = mujoco.MjData(model), foreign_mjcf(path).robot, {"a": 0.3, "b": -0.2}
    for name, value in values.items():
        data.joint(name).qpos = value
    mujoco.mj_kinematics(model, data)
    poses = link_poses(robot, values)
    for name, found in (("one", data.body), ("two", data.body), ("three", data.site), ("four", data.site)):
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
    mujoco = pytest.importorskip("mujoco")
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
    mujoco = pytest.importorskip("mujoco")
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


def test_what_is_left_out_is_noticed(found: ForeignRobot, path: Path) -> None:
    notices = {notice.message: notice for notice in found.notices}
    assert set(notices) == {
        "a shape 'plane' is left out",
        "a shape 'ellipsoid' is left out",
        "the constraint connect is left out",
    }
    assert all(notice.mark and notice.mark.file == str(path) for notice in notices.values())


@pytest.mark.parametrize(
    ("include", "message"),
    [
        ("none.xml", "'none.xml' is not there"),
        ("arm.xml", "'arm.xml' is included a second time"),
        ("../../secret.xml", "is not in the folder of the file, nor in one beside that"),
        ("text.xml", "this is not XML"),
        ("twice.xml", "'more.xml' is included a second time"),
    ],
)
def test_an_include_that_is_refused(tmp_path: Path, include: str, message: str) -> None:
    folder = tmp_path / "one/two"
    folder.mkdir(parents=True)
    for name, text in {
        "../../secret.xml": "<x/>",
        "text.xml": "no XML",
        "more.xml": "<x/>",
        "twice.xml": '<x><include file="more.xml"/><include file="more.xml"/></x>',
        "arm.xml": f'<mujoco><include file="{include}"/><worldbody/></mujoco>',
    }.items():
        (folder / name).write_text(text)
    with pytest.raises(TableError, match=message) as caught:
        foreign_mjcf(folder / "arm.xml")
    assert caught.value.problems[0].mark is not None
