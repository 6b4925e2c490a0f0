"""A palletiser: two parallelograms as rows that follow, in every format, for every program that can ask them."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from pinocchio_frames import pinocchio_frames

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


def motors(q: Any) -> dict[str, float]:
    """The values of the joints that move by themselves."""
    return {f"joint_{number}": value for number, value in enumerate(q, start=1)}


def every(q: Any) -> dict[str, float]:
    return {"elbow": -q[1], "wrist": -q[2], **motors(q)}


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
    frame = pinocchio_frames(folder / "arm.urdf", mimic=mimic)
    for q in vectors(20):
        values = motors(q) if mimic else every(q)
        assert np.abs(frame(values, "tool0") - by_hand(q)).max() < 1e-9


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
        for joint, value in every(q).items():
            plant.GetJointByName(joint).set_angle(context, value)
        found = plant.GetFrameByName("tool0").CalcPoseInWorld(context).GetAsMatrix4()
        assert np.abs(found - by_hand(q)).max() < 1e-9
