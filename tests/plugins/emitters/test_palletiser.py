"""A palletiser: two parallelograms as rows that follow, in every format, for every program that can ask them."""

import json
import math
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from lxml import etree
from pinocchio_frames import pinocchio_frames

import dh2urdf
from dh2urdf.errors import ProofError
from dh2urdf.manipulator import Follower, Limits
from dh2urdf.stages import Question
from dh2urdf_plugins.formats.mjcf.reader import parse_mjcf, read_mjcf
from dh2urdf_plugins.loaders.mujoco import inspect

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


@pytest.fixture(scope="module")
def barred(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The arm as MJCF with two bars."""
    path = tmp_path_factory.mktemp("bars") / "arm.xml"
    dh2urdf.convert(TABLE, out=path, followers="connect")
    return path


@pytest.mark.parametrize("target", [(0, 0, 0, 0), (0.4, 0.3, 0.2, -0.5), (1, 1.4, 2, 0), (0, -0.65, -0.3, 0)])
def test_bars_make_elbow_and_wrist_follow(barred: Path, target: tuple[float, ...]) -> None:
    """To 1e-5 rad at rest, also near both ends of the limits, and to 2e-3 rad on the way."""
    mujoco = pytest.importorskip("mujoco")
    model = mujoco.MjModel.from_xml_path(str(barred))
    assert [int(each) for each in model.eq_type] == [int(mujoco.mjtEq.mjEQ_CONNECT)] * 2
    data, off = mujoco.MjData(model), []
    mujoco.mj_resetDataKeyframe(model, data, 0)
    data.ctrl[:] = target
    for _ in range(3000):
        mujoco.mj_step(model, data)
        q = {model.joint(number).name: float(data.qpos[number]) for number in range(model.njnt)}
        off.append(max(abs(q["elbow"] + q["joint_2"]), abs(q["wrist"] + q["joint_3"])))
    assert [q["joint_2"], q["joint_3"]] == pytest.approx(target[1:3], abs=1e-3)
    assert max(off) < 2e-3
    assert off[-1] < 1e-5
    assert q["elbow_bar"] == pytest.approx(q["joint_2"], abs=1e-5)


def test_bars_are_read_back_as_the_laws(barred: Path, folder: Path) -> None:
    """Their masses are all that the file has more; no parallelogram is refused, and another law is another one."""
    content, (mine, other) = barred.read_bytes(), (read_mjcf(each) for each in (folder / "arm.xml", barred))
    assert (other.links, other.joints) == (mine.links, mine.joints)
    assert dh2urdf.extract(barred, convention="modified").fk([0.1, 0.2, 0.3, 0.4]) == pytest.approx(
        by_hand((0.1, 0.2, 0.3, 0.4)), abs=1e-9
    )
    mujoco = pytest.importorskip("mujoco")
    masses = [mujoco.MjModel.from_xml_path(str(each)).body_mass.sum() for each in (barred, folder / "arm.xml")]
    assert masses[0] - masses[1] == pytest.approx(2e-6, rel=1e-6)
    for old in (b'<site name="wrist_bar" pos="1.02', b'<body name="wrist_bar" pos="-0.1'):
        assert content.count(old) == 1
        with pytest.raises(ProofError) as caught:
            parse_mjcf(content.replace(old, old + b"8"), "arm.xml")
        assert caught.value.problems[0].code == "bar-without-parallelogram"
    text = content.decode()
    (end,) = re.findall('name="wrist_bar_end" pos="([^"]+)"', text)
    x, y, z = map(float, end.split())
    turned = " ".join(map(repr, (x * math.cos(0.1) + z * math.sin(0.1), y, z * math.cos(0.1) - x * math.sin(0.1))))
    other_text = text.replace(f'name="wrist_bar_end" pos="{end}"', f'name="wrist_bar_end" pos="{turned}"')
    law = parse_mjcf(other_text.encode(), "arm.xml").followers["wrist"]
    assert law == ("joint_3", -1.0, pytest.approx(-0.1, abs=1e-12), ())


@pytest.mark.parametrize("loader", ["mujoco"])
def test_a_loader_knows_the_bars(loader: str, cli: Cli, tmp_path: Path, require_loaders: Callable[..., None]) -> None:
    """It finds no joint that was not written, holds the weight by them, and `check` reports no joint as free."""
    require_loaders(loader)
    pytest.importorskip("mujoco")
    run = tmp_path / "run.yaml"
    emitter = {"stage": "mjcf", "options": {"followers": "connect"}}
    run.write_text(json.dumps({"inputs": str(TABLE), "emitters": [emitter], "loaders": [loader]}), "utf-8")
    cli("run", run, "-o", tmp_path / "out")
    (entry,) = json.loads((tmp_path / "out" / "report.json").read_bytes())["manipulators"]
    found = entry["loaders"][loader]
    assert (found["hold"]["stayed"], found["findings"], found["mass_error"]) == (True, [], 0.0)
    held = inspect(Question(path=tmp_path / "out" / "irb460.xml", format="mjcf", packages={}, postures=()))
    assert {joint["name"] for joint in held.joints if "mimic" not in joint} == {"elbow", "wrist"}


@pytest.mark.parametrize(("sign", "multiplier"), [(1, -1.0), (-1, 1.0)])
@pytest.mark.parametrize("offset", [0.0, 0.4])
@pytest.mark.parametrize("frames", ["aligned", "dh"])
def test_a_bar_is_where_mujoco_wants_it(
    tmp_path: Path, sign: int, multiplier: float, offset: float, frames: str
) -> None:
    """With axes beside each other along their direction, one against the other, and a law with an offset."""
    mujoco = pytest.importorskip("mujoco")
    rows = [
        dh2urdf.DHRow(joint="turn", link="l1", a=0.1, alpha=0.7, d=0.3, theta=0.2),
        dh2urdf.DHRow(joint="lift", link="l2", a=0.5, alpha=0.0, d=0.1, limits=Limits(lower=-0.5, upper=0.9)),
        dh2urdf.DHRow(joint="bolt", link="l3", type="fixed", a=0.2, alpha=0.0, d=0.05, theta=0.6),
        dh2urdf.DHRow(joint="level", link="l4", a=0.2, alpha=0.3, d=0.1, sign=sign),
    ]
    rows[-1] = replace(rows[-1], follows=Follower("lift", multiplier, offset))
    table = dh2urdf.Manipulator(name="arm", convention="standard", rows=tuple(rows))
    path = tmp_path / "arm.xml"
    dh2urdf.convert(table, out=path, followers="connect", frames=frames)
    assert read_mjcf(path).followers["level"] == ("lift", multiplier, pytest.approx(offset, abs=1e-12), ())
    model = mujoco.MjModel.from_xml_path(str(path))
    data = mujoco.MjData(model)
    for lift in (-0.5, 0.2, 0.9):
        values = {"turn": 0.3, "lift": lift, "level": multiplier * lift + offset, "level_bar": lift}
        for name, value in values.items():
            data.joint(name).qpos = value
        mujoco.mj_forward(model, data)
        assert data.ne == 3
        assert np.abs(data.efc_pos[:3]).max() < 1e-12


def test_another_law_keeps_the_equality(tmp_path: Path) -> None:
    table = dh2urdf.read(TABLE)
    half = [replace(row, follows=Follower("joint_2", -0.5)) if row.joint == "elbow" else row for row in table.rows]
    with pytest.warns(dh2urdf.TableWarning, match="no bar holds the joint"):
        dh2urdf.convert(replace(table, rows=tuple(half)), out=tmp_path / "arm.xml", followers="connect")
    equalities = etree.parse(tmp_path / "arm.xml").find("equality")
    assert [each.tag for each in equalities] == ["joint", "connect"]


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
