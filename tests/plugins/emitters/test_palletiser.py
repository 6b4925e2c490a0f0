"""A palletiser: two parallelograms as rows that follow, in every format, for every program that can ask them."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli

import dh2urdf

TABLE = Path(__file__).parents[3] / "configs" / "palletiser" / "irb460.yaml"
FILES = ("arm.urdf", "arm.sdf", "arm.xml", "arm.urdf.xacro")
RNG = np.random.default_rng(460)
LOWER, UPPER = np.radians([-165, -40, -20, -300]), np.radians([165, 85, 120, 300])


def vectors(count: int) -> Any:
    """Joint vectors inside the ranges of the four motors."""
    return RNG.uniform(LOWER, UPPER, (count, 4))


def by_hand(q: Any) -> Any:
    """T(base_link → tool0) in the vertical plane of the arm: lengths and angles of a drawing, no rows."""
    first, second, third, fourth = q
    out = 0.26 + 0.945 * np.sin(second) + 1.025 * np.cos(third) + 0.225
    up = 0.745 + 0.945 * np.cos(second) - 1.025 * np.sin(third) - 0.2515
    turn = first - fourth  # joint 4 points down
    pose = np.diag([-1.0, 1.0, -1.0, 1.0])
    pose[:2, :2] = [[-np.cos(turn), -np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    pose[:3, 3] = out * np.cos(first), out * np.sin(first), up
    return pose


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The arm in each format."""
    folder = tmp_path_factory.mktemp("irb460")
    for name in FILES:
        dh2urdf.convert(TABLE, out=folder / name)
    return folder


def test_the_flange_stays_level() -> None:
    """At any joint vector the tool is that of a drawing, and turned about the vertical alone."""
    arm = dh2urdf.read(TABLE)
    for q in vectors(200):
        pose = arm.fk(q)
        assert np.abs(pose - by_hand(q)).max() < 1e-12
        assert np.abs(pose[2, :3] - (0.0, 0.0, -1.0)).max() < 1e-12


@pytest.mark.parametrize("name", FILES)
def test_the_table_comes_back(folder: Path, name: str) -> None:
    """`extract` finds the same laws, and the same arm."""
    arm = dh2urdf.extract(folder / name, convention="modified")
    assert [row.joint for row in arm.rows] == ["joint_1", "joint_2", "elbow", "joint_3", "wrist", "joint_4"]
    laws = {row.joint: row.follows for row in arm.rows if row.follows}
    assert laws == {"elbow": dh2urdf.robot.Follower("joint_2", -1.0), "wrist": dh2urdf.robot.Follower("joint_3", -1.0)}
    for q in vectors(20):
        assert np.abs(arm.fk(q) - by_hand(q)).max() < 1e-8
    again = dh2urdf.read(arm.to_yaml())
    assert again.rows == arm.rows


def test_the_printed_table_has_the_laws(folder: Path, cli: Cli) -> None:
    """Of an arm without followers it has no such column."""
    rows = cli("extract", folder / "arm.urdf").stdout.splitlines()
    assert rows[1].split()[-1] == "follows"
    assert {row.split()[0]: row.split()[-1] for row in rows if "-joint_" in row} == {
        "elbow": "-joint_2",
        "wrist": "-joint_3",
    }


@pytest.mark.parametrize("form", ["csv", "json", "md", "tex"])
def test_every_text_of_the_table_reads_back(tmp_path: Path, form: str) -> None:
    path = tmp_path / f"arm.{form}"
    dh2urdf.convert(TABLE, out=path, formats="table")
    given, found = dh2urdf.read(TABLE), dh2urdf.read(path, convention="modified")
    assert [row.follows for row in found.rows] == [row.follows for row in given.rows]
    for q in vectors(5):
        assert np.abs(found.fk(q) - by_hand(q)).max() < 1e-9


def test_code_has_the_laws(tmp_path: Path) -> None:
    """The function beside the DHRobot gives a value to each of its joints."""
    path = tmp_path / "arm.py"
    dh2urdf.convert(TABLE, out=path, formats="table")
    text = path.read_text("utf-8")
    made: dict[str, Any] = {}
    exec(text[text.index("def robot_q") :], made)  # noqa: S102 - what was written
    assert made["robot_q"]([0.1, 0.2, 0.3, 0.4]) == [0.1, 0.2, -0.2, 0.3, -0.3, 0.4]
    dh2urdf.convert(TABLE, out=tmp_path / "arm.m", formats="table")
    assert "robot_q = @(q) [q(1), q(2), -q(2), q(3), -q(3), q(4)];" in (tmp_path / "arm.m").read_text("utf-8")


# --- Programs ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("loader", ["pybullet", "mujoco", "pinocchio", "drake", "gazebo"])
def test_a_loader_confirms_it(loader: str, cli: Cli, tmp_path: Path, require_loaders: Callable[..., None]) -> None:
    """Its joints, its limits and masses are found, tool0 is where the table has it, and it holds its weight."""
    require_loaders(loader)
    run = tmp_path / "run.yaml"
    run.write_text(f"inputs: {json.dumps(str(TABLE))}\nemitters: [urdf, sdf, mjcf]\nloaders: [{loader}]\n", "utf-8")
    cli("run", run, "-o", tmp_path / "out")
    (entry,) = json.loads((tmp_path / "out" / "report.json").read_bytes())["manipulators"]
    found = entry["loaders"][loader]
    assert found["position_error"] < found["tolerance"]
    assert {finding["code"] for finding in found["findings"]} <= {"drake-without-actuators"}  # as of any portable URDF


def test_mujoco_keeps_the_flange_level_while_it_moves(folder: Path) -> None:
    """The servos of the four motors follow a step; the constraints keep elbow and wrist, and so tool0, where they are."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(folder / "arm.xml"))
    assert [model.actuator(number).name for number in range(model.nu)] == ["joint_1", "joint_2", "joint_3", "joint_4"]
    data, target = mujoco.MjData(model), np.array([0.4, 0.3, 0.2, -0.5])
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.ctrl[:] = target
    for _ in range(4000):
        mujoco.mj_step(model, data)
    q = np.array([float(data.joint(f"joint_{number}").qpos[0]) for number in (1, 2, 3, 4)])
    assert np.abs(q - target).max() < 0.02
    elbow, wrist = (float(data.joint(name).qpos[0]) for name in ("elbow", "wrist"))
    assert elbow == pytest.approx(-q[1], abs=5e-3)
    assert wrist == pytest.approx(-q[2], abs=5e-3)
    assert data.body("link_6").xmat[8] == pytest.approx(1.0, abs=1e-4)  # its z is up where all values are 0


@pytest.mark.parametrize("mimic", [True, False])
def test_pinocchio(folder: Path, mimic: bool) -> None:  # noqa: FBT001 - a parameter
    """With its mimic joints the model has four coordinates; without, elbow and wrist get their values."""
    pin = pytest.importorskip("pinocchio")
    try:
        model = pin.buildModelFromUrdf(str(folder / "arm.urdf"), mimic=mimic)
    except TypeError:
        pytest.skip("this Pinocchio has no mimic joints")
    assert model.nq == (4 if mimic else 6)
    data, frame = model.createData(), model.getFrameId("tool0")
    for q in vectors(20):
        whole = np.array([q[0], q[1], -q[1], q[2], -q[2], q[3]])
        pin.framesForwardKinematics(model, data, q if mimic else whole)
        assert np.abs(data.oMf[frame].homogeneous - by_hand(q)).max() < 1e-9


@pytest.mark.parametrize("name", ["arm.urdf", "arm.sdf"])
def test_drake_couples_the_joints(folder: Path, name: str) -> None:
    """Drake makes a coupler constraint of each law, and has the pose where the values obey it."""
    pytest.importorskip("pydrake")
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import DiscreteContactApproximation, MultibodyPlant

    plant = MultibodyPlant(time_step=1e-3)
    plant.set_discrete_contact_approximation(DiscreteContactApproximation.kSap)
    Parser(plant).AddModels(str(folder / name))
    if name == "arm.urdf":
        plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("base_link"))
    plant.Finalize()
    assert plant.num_constraints() == 2
    context = plant.CreateDefaultContext()
    for q in vectors(5):
        values = {"elbow": -q[1], "wrist": -q[2], **{f"joint_{number + 1}": q[number] for number in range(4)}}
        for joint, value in values.items():
            plant.GetJointByName(joint).set_angle(context, value)
        found = plant.GetFrameByName("tool0").CalcPoseInWorld(context).GetAsMatrix4()
        assert np.abs(found - by_hand(q)).max() < 1e-9


def test_pybullet_has_the_pose_where_the_values_obey(folder: Path) -> None:
    """Bullet knows no mimic: a program sets all six."""
    bullet = pytest.importorskip("pybullet")
    client = bullet.connect(bullet.DIRECT)
    try:
        arm = bullet.loadURDF(str(folder / "arm.urdf"), useFixedBase=True, physicsClientId=client)
        infos = [
            bullet.getJointInfo(arm, index, physicsClientId=client)
            for index in range(bullet.getNumJoints(arm, physicsClientId=client))
        ]
        joints, links = ({info[place].decode(): info[0] for info in infos} for place in (1, 12))
        for q in vectors(5):
            values = {"elbow": -q[1], "wrist": -q[2], **{f"joint_{number + 1}": q[number] for number in range(4)}}
            for name, value in values.items():
                bullet.resetJointState(arm, joints[name], value, physicsClientId=client)
            state = bullet.getLinkState(arm, links["tool0"], computeForwardKinematics=True, physicsClientId=client)
            assert np.abs(np.array(state[4]) - by_hand(q)[:3, 3]).max() < 1e-5
            rotation = np.reshape(bullet.getMatrixFromQuaternion(state[5]), (3, 3))
            assert np.abs(rotation - by_hand(q)[:3, :3]).max() < 1e-5
    finally:
        bullet.disconnect(client)
