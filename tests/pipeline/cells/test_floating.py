"""Arms and parts that nothing holds in the world, where MuJoCo, Drake, Pinocchio and PyBullet have them."""

import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lxml import etree
from plain_frames import Matrix, rpy, shift, turn
from two_fingers import TWO_JOINTS as TABLE

import dh2urdf
from dh2urdf.cells.floating import prove_floating
from dh2urdf.errors import EditError, InputError, ProofError
from dh2urdf.testing.oracle import table_pose
from dh2urdf_plugins.formats import read_mjcf, read_sdf

BODY = '<inertial><origin xyz="0.01 0 0.1"/><mass value="{}"/><inertia ixx="1" iyy="1.5" izz="1.8" ixy="0.01" ixz="0" iyz="0"/></inertial>'
CART = """<robot name="cart"><link name="foot">{foot}</link><link name="body">{body}</link><link name="plate"/><link name="wheel">{wheel}</link>
<joint name="up" type="fixed"><parent link="foot"/><child link="body"/><origin xyz="0 0 0.13"/></joint>
<joint name="on_top" type="fixed"><parent link="body"/><child link="plate"/><origin xyz="0.05 0 0.24" rpy="0 0 0.3"/></joint>
<joint name="roll" type="continuous"><parent link="body"/><child link="wheel"/><origin xyz="0.2 0.3 0.03"/><axis xyz="0 1 0"/></joint></robot>"""
RUN = """
inputs: arm.csv
parts: [{name: cart, file: cart.urdf}]
cells:
- name: cell
  arms:
  - {name: base, of: cart, floating: true, xyz: [0.3, 0.2, 0.4], rpy: [0.1, 0.2, 0.3]}
  - {name: arm, of: arm, parent: base/plate, xyz: [0.2, 0, 0]}
emitters: [urdf, xacro, mjcf, sdf, srdf]
output: out
"""


def run(folder: Path, text: str = RUN, *, foot: float = 1.0, body: float = 40.0) -> dict[str, Any]:
    """What became of the cell; the files are in the folder `out`."""
    bodies = {"foot": foot, "body": body, "wheel": 2.0}
    cart = CART.format(**{name: BODY.format(mass) if mass else "" for name, mass in bodies.items()})
    for name, content in (("arm.csv", TABLE), ("cart.urdf", cart), ("run.yaml", text)):
        (folder / name).write_text(content, "utf-8")
    return next(row for row in dh2urdf.run(folder / "run.yaml")["manipulators"] if row["name"] == "cell")


@pytest.fixture(name="out", params=[1.0, 0.0], ids=["heavy-root", "weightless-root"])
def _out(tmp_path: Path, request: pytest.FixtureRequest) -> Path:
    assert run(tmp_path, foot=request.param)["status"] == "ok"
    return tmp_path / "out"


STARTS = [shift(0.3, 0.2, 0.4) @ rpy(0.1, 0.2, 0.3), shift(-1.0, 2.0, 3.0) @ rpy(1.0, -0.5, 2.5)]
"""Where the base stands: as in the run file, and elsewhere."""
Q = {"base_roll": 0.7, "arm_one": 0.4, "arm_two": -1.1}


def wanted(start: Matrix) -> dict[str, Matrix]:
    body = start @ shift(z=0.13)
    plate = body @ shift(0.05, 0.0, 0.24) @ turn("z", 0.3) @ shift(0.2)
    tool = plate @ table_pose(dh2urdf.read(TABLE), [Q["arm_one"], Q["arm_two"]])
    return {"base_wheel": body @ shift(0.2, 0.3, 0.03) @ turn("y", Q["base_roll"]), "arm_tool0": tool}


def quaternion(start: Matrix) -> tuple[float, float, float, float]:
    """(w, x, y, z); no start is near a half turn."""
    w = 0.5 * math.sqrt(1.0 + np.trace(start[:3, :3]))
    R = start[:3, :3]
    return w, (R[2, 1] - R[1, 2]) / (4 * w), (R[0, 2] - R[2, 0]) / (4 * w), (R[1, 0] - R[0, 1]) / (4 * w)


def pose(rotation: Any, translation: Any) -> Matrix:
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = np.reshape(rotation, (3, 3)), translation
    return found


def compare(found: Callable[[str], Matrix], start: Matrix, tolerance: float = 1e-12) -> None:
    for link, frame_of_link in wanted(start).items():
        assert np.allclose(found(link), frame_of_link, atol=tolerance), link


def test_mujoco_has_seven_more_positions_and_lets_it_fall(out: Path) -> None:
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(out / "cell.xml"))
    assert (model.nq, model.nv) == (3 + 7, 3 + 6)
    data = mujoco.MjData(model)
    for number, start in enumerate(STARTS):
        mujoco.mj_resetDataKeyframe(model, data, 0)
        base = data.joint("base_joint").qpos
        if number:  # The first is that of the file.
            base[:] = (*start[:3, 3], *quaternion(start))
        for joint, value in Q.items():
            data.joint(joint).qpos = value
        mujoco.mj_kinematics(model, data)
        frames = {"arm_tool0": data.site("arm_tool0"), "base_wheel": data.body("base_wheel")}
        compare(lambda link: pose(frames[link].xmat, frames[link].xpos), start)  # noqa: B023 - called here
    mujoco.mj_resetDataKeyframe(model, data, 0)
    mujoco.mj_forward(model, data)
    before = data.subtree_com[0].copy()
    while data.time < 0.3:
        mujoco.mj_step(model, data)
    assert data.subtree_com[0] - before == pytest.approx([0.0, 0.0, -0.5 * 9.81 * data.time**2], abs=5e-3)


@pytest.mark.parametrize("suffix", ["sdf", "urdf"])
def test_drake_has_a_quaternion(out: Path, suffix: str) -> None:
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    from pydrake.math import RigidTransform
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.001)
    parsing.Parser(plant).AddModels(str(out / f"cell.{suffix}"))
    plant.Finalize()
    (free,) = map(plant.get_body, plant.GetFloatingBaseBodies())
    assert plant.num_positions() == 3 + 7
    context, in_body = plant.CreateDefaultContext(), np.eye(4)
    if free.name() == "base_body":  # SDF knows bodies, and a root without a mass is a frame on one.
        in_body = shift(z=0.13)
    for number, start in enumerate(STARTS):
        if number or suffix == "urdf":  # A URDF does not say where the robot stands.
            plant.SetFreeBodyPose(context, free, RigidTransform(start @ in_body))
        for joint, value in Q.items():
            plant.GetJointByName(joint).set_angle(context, value)
        of = {name: plant.GetFrameByName(name).CalcPoseInWorld(context) for name in wanted(start)}
        compare(lambda link: of[link].GetAsMatrix4(), start)  # noqa: B023 - called here


@pytest.mark.parametrize("suffix", ["urdf", "urdf.xacro"])
def test_pinocchio_has_it_on_a_free_flyer(out: Path, suffix: str) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    content = (out / "cell.urdf").read_text("utf-8")
    if suffix != "urdf":
        import xacro

        content = xacro.process_file(str(out / "cell.urdf.xacro")).toxml()
    model = pinocchio.buildModelFromXML(content, pinocchio.JointModelFreeFlyer())
    data, q = model.createData(), pinocchio.neutral(model)
    assert (model.nv, model.frames[model.getFrameId("base_foot")].name) == (3 + 6, "base_foot")
    for start in STARTS:
        w, *xyz = quaternion(start)
        q[:7] = (*start[:3, 3], *xyz, w)
        for name, value in Q.items():
            joint = model.joints[model.getJointId(name)]
            q[joint.idx_q : joint.idx_q + joint.nq] = (math.cos(value), math.sin(value)) if joint.nq == 2 else value
        pinocchio.framesForwardKinematics(model, data, q)
        compare(lambda link: data.oMf[model.getFrameId(link)].homogeneous, start)


def test_pybullet_lets_it_fall_unless_its_root_weighs_nothing(out: Path) -> None:
    bullet = pytest.importorskip("pybullet")
    client = bullet.connect(bullet.DIRECT)
    try:
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        body = bullet.loadURDF(str(out / "cell.urdf"), useFixedBase=False, flags=flags)
        infos = [bullet.getJointInfo(body, number) for number in range(bullet.getNumJoints(body))]
        joints, links = ({info[column].decode(): info[0] for info in infos} for column in (1, 12))
        com, axes = bullet.getDynamicsInfo(body, -1)[3:5]
        for start in STARTS:
            w, *xyz = quaternion(start)
            centre = bullet.multiplyTransforms(start[:3, 3].tolist(), [*xyz, w], com, axes)
            bullet.resetBasePositionAndOrientation(body, *centre)
            for joint, value in Q.items():
                bullet.resetJointState(body, joints[joint], value)
            states = {
                name: bullet.getLinkState(body, links[name], computeForwardKinematics=1) for name in wanted(start)
            }
            rotations = {name: bullet.getMatrixFromQuaternion(state[5]) for name, state in states.items()}
            compare(lambda link: pose(rotations[link], states[link][4]), start, 1e-6)  # noqa: B023 - called here
        bullet.setGravity(0, 0, -9.81)
        before = bullet.getBasePositionAndOrientation(body)[0][2]
        for _ in range(72):
            bullet.stepSimulation()
        fallen = before - bullet.getBasePositionAndOrientation(body)[0][2]
        assert fallen > 0.3 or (bullet.getDynamicsInfo(body, -1)[0] == 0.0 and fallen == 0.0)
    finally:
        bullet.disconnect(client)


@pytest.mark.parametrize(
    ("simulator", "emitter"),
    [
        ("mujoco", "mjcf"),
        ("mujoco", "urdf"),
        ("pinocchio", "urdf"),
        ("drake", "sdf"),
        ("drake", "urdf"),
        ("pybullet", "urdf"),
    ],
)
@pytest.mark.parametrize("foot", [1.0, 0.0])
def test_loaders_know_it(
    tmp_path: Path, simulator: str, emitter: str, foot: float, require_loaders: Callable[..., None]
) -> None:
    """Each measures tool0 and the wheel; PyBullet holds a root without a mass, and its loader says so."""
    require_loaders(simulator)
    text = RUN.replace("emitters: [urdf, xacro, mjcf, sdf, srdf]", f"emitters: [{emitter}]\nloaders: [{simulator}]")
    load = run(tmp_path, text, foot=foot)["loaders"][simulator]
    assert load["verdict"] == "passed"
    assert load["position_error"] <= load["tolerance"]
    told = [finding["code"] for finding in load["findings"]]
    assert ("pybullet-holds-root" in told) == (simulator == "pybullet" and not foot)


def test_moveit_has_a_floating_virtual_joint(out: Path) -> None:
    (joint,) = etree.parse(str(out / "cell.srdf")).iterfind("virtual_joint")
    assert dict(joint.attrib) == {
        "name": "virtual_joint",
        "type": "floating",
        "parent_frame": "world",
        "child_link": "base_foot",
    }


def test_a_ros_2_package_has_its_root(tmp_path: Path) -> None:
    """MoveIt has a floating joint and no static transform from the world, and rviz does not begin there."""
    text = RUN.replace(
        "emitters: [urdf, xacro, mjcf, sdf, srdf]", "emitters: [{stage: ros2, options: {moveit: true}, only: cells}]"
    )
    assert run(tmp_path, text)["status"] == "ok"
    (srdf,) = tmp_path.rglob("*.srdf")
    assert 'type="floating"' in srdf.read_text("utf-8")
    assert "world" not in next(tmp_path.rglob("view_robot.rviz")).read_text("utf-8")
    (launches,) = tmp_path.rglob("move_group.launch.py")
    assert not [*launches.parent.glob("static_virtual_joint_tfs*")]


def test_two_float_in_mjcf_and_sdf(tmp_path: Path) -> None:
    """Each by itself, beside what is held; a URDF has one root, and says so."""
    two = RUN.replace(
        "  - {name: arm,",
        "  - {name: other, of: cart, floating: true, xyz: [2, 0, 1]}\n  - {name: fixed, of: arm, xyz: [0, 3, 0]}\n  - {name: arm,",
    )
    row = run(tmp_path, two)
    assert [error["code"] for error in row["errors"]] == ["world-of-several"]
    row = run(tmp_path, two.replace("[urdf, xacro, mjcf, sdf, srdf]", "[mjcf, sdf]"), foot=0.0)
    assert row["status"] == "ok"
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "out" / "cell.xml"))
    assert model.nq == 2 * 7 + 2 + 4
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    while data.time < 0.2:
        mujoco.mj_step(model, data)
    heights = {name: float(data.body(name).xpos[2]) for name in ("base_foot", "other_foot", "fixed_base_link")}
    assert heights["fixed_base_link"] == 0.0
    assert heights["other_foot"] < 0.9
    assert heights["base_foot"] < 0.35
    parsing = pytest.importorskip("pydrake.multibody.parsing")
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(0.001)
    parsing.Parser(plant).AddModels(str(tmp_path / "out" / "cell.sdf"))
    plant.Finalize()
    assert {plant.get_body(index).name() for index in plant.GetFloatingBaseBodies()} == {"base_body", "other_body"}


def test_the_proof_sees_what_floats(tmp_path: Path) -> None:
    """A file in which the base is held is not the robot, nor one in which something else floats."""
    run(tmp_path)
    free, other = read_mjcf(tmp_path / "out" / "cell.xml"), read_sdf(tmp_path / "out" / "cell.sdf")
    prove_floating(free, other)
    prove_floating(other, free)
    for wrong in ((), ("base_wheel",), ("base_foot", "base_wheel")):
        with pytest.raises(ProofError, match="float"):
            prove_floating(free, replace(other, floating=wrong))


def test_what_cannot_float_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="floats is on no link") as caught:
        run(tmp_path, RUN.replace("parent: base/plate", "parent: base/plate, floating: true"))
    assert "cells.0.arms.1.floating" in [problem.field for problem in caught.value.problems]
    row = run(tmp_path, foot=0.0, body=0.0)
    assert [error["code"] for error in row["errors"]] == ["moves-without-mass"]
    edit = {"attach": {"file": str(tmp_path / "cart.urdf"), "name": "cart", "floating": True}}
    with pytest.raises((InputError, EditError), match="floating"):
        dh2urdf.convert(dh2urdf.read(TABLE), edits=[edit])
