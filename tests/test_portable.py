"""One portable URDF for all: every reader, asked directly, takes every arm without a word that is not expected.

The readers' own loaders (tests/plugins/loaders) measure more; here no code of this project stands between the written
file and the reader. docs/simulators.md and docs/profiles.md say what is expected of whom.
"""

from __future__ import annotations

import ctypes
import json
import logging
import re
import shutil
import subprocess
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest
from lxml import etree
from sdformat_calls import sdformat

from dh2urdf.cli import exit_status_of
from dh2urdf.kinematics import KinematicChain
from dh2urdf.manipulator import JointType
from dh2urdf_plugins.formats.urdf.reader import read_urdf

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from conftest import ReferenceRobot

    Poses = Sequence[tuple[dict[str, float], dict[str, np.ndarray]]]

TABLES = Path(__file__).parents[1] / "configs" / "tables"
REFERENCE = Path(__file__).with_name("reference") / "robots.json"
CELL = "workshop"


class Case(NamedTuple):
    """A written arm or cell.

    Attributes:
        urdf: the URDF.
        root: its root link.
        mass: that of all its links [kg].
        poses: joint values by name, and where every tool0 is in the root.
    """

    urdf: Path
    root: str
    mass: float
    poses: Poses


@pytest.fixture(scope="module")
def cases(
    tmp_path_factory: pytest.TempPathFactory,
    reference_robots: Sequence[ReferenceRobot],
    as_table: Callable[..., str],
) -> dict[str, Case]:
    """All published arms, the UR5 and the Panda of configs, and a cell of three arms, one of them on another."""
    folder = tmp_path_factory.mktemp("portable")
    for robot in reference_robots:
        (folder / f"{robot.id}.yaml").write_text(as_table(robot.manipulator, "yaml"), "utf-8")
    for table in ("ur5.csv", "panda.yaml", "track.csv"):
        shutil.copy(TABLES / table, folder)
    (folder / "run").write_text(
        f"""
inputs: ["*.yaml", "*.csv"]
cells:
  - name: {CELL}
    arms:
      - {{name: track, of: track}}
      - {{name: rider, of: ur5, parent: track/tool0, xyz: [0, 0, 50 mm]}}
      - {{name: beside, of: panda, xyz: [-1.5, 0, 0], rpy: [0, 0, pi]}}
emitters: [urdf]
output: {{directory: out}}
execution: {{stage: local, options: {{workers: 1}}}}
"""
    )
    assert exit_status_of(["run", str(folder / "run")], debug=False) == 0
    published = {robot.id: robot for robot in reference_robots}
    return {path.stem: written_case(path, published.get(path.stem)) for path in sorted((folder / "out").glob("*.urdf"))}


def written_case(path: Path, published: ReferenceRobot | None) -> Case:
    """A case; the poses are its publisher's, or else those of the file as this project reads it."""
    tree = etree.parse(path)
    mass = sum(float(element.get("value")) for element in tree.iter("mass"))
    moving = [joint.get("name") for joint in tree.iter("joint") if joint.get("type") not in {None, "fixed"}]
    poses: list[tuple[dict[str, float], dict[str, np.ndarray]]] = []
    if published:
        root = "base_link"
        for q, pose in zip(published.q, published.poses, strict=True):
            poses.append((dict(zip(moving, q, strict=True)), {"tool0": np.array(pose)}))
    else:
        robot = read_urdf(path)
        root = robot.root
        tips = [link.name for link in robot.links if link.name.endswith("tool0")]
        draw = np.random.default_rng(11)
        for _ in range(4):
            q = {joint.name: float(draw.uniform(-1, 1)) for joint in robot.moving_joints}
            poses.append((q, {tip: pose_in_root(robot, tip, q) for tip in tips}))
    return Case(path, root, mass, poses)


def pose_in_root(robot: Any, tip: str, q: dict[str, float]) -> np.ndarray:
    chain = KinematicChain.between(robot, robot.root, tip)
    pose = chain.forward_kinematics([q[each.name] for each in chain.joints if each.type is not JointType.FIXED])
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = np.reshape(pose.rotation, (3, 3)), pose.translation
    return T


def names() -> list[str]:
    records = json.loads(REFERENCE.read_text("utf-8"))["robots"]
    return [*(record["id"] for record in records), "ur5", "panda", "track", CELL]


@pytest.fixture(params=[*dict.fromkeys([*names()[::4], CELL])])
def case(request: pytest.FixtureRequest, cases: dict[str, Case]) -> Case:
    return cases[request.param]


@pytest.mark.long
def test_every_case_is_there(cases: dict[str, Case]) -> None:
    """What the run wrote is what is tested."""
    assert sorted(cases) == sorted(names())


def assert_poses(case: Case, frames: Callable[[dict[str, float], str], np.ndarray], tolerance: float = 1e-9) -> None:
    for q, tips in case.poses:
        for tip, expected in tips.items():
            assert np.abs(frames(q, tip) - expected).max() < tolerance


def flushed(capfd: pytest.CaptureFixture[str]) -> list[str]:
    """The lines that were printed, from C too."""
    ctypes.CDLL(None).fflush(None)
    out, err = capfd.readouterr()
    return [line for line in (out + err).splitlines() if line.strip()]


def test_mujoco(case: Case, capfd: pytest.CaptureFixture[str]) -> None:
    """MuJoCo keeps flange and tool0, has the mass, and says nothing."""
    mujoco = pytest.importorskip("mujoco")
    capfd.readouterr()
    model = mujoco.MjModel.from_xml_path(str(case.urdf))
    data = mujoco.MjData(model)
    assert model.body_mass.sum() == pytest.approx(case.mass, rel=1e-12)

    def frame(q: dict[str, float], tip: str) -> np.ndarray:
        for name, value in q.items():
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        T = np.eye(4)
        T[:3, :3], T[:3, 3] = data.body(tip).xmat.reshape(3, 3), data.body(tip).xpos
        return T

    assert_poses(case, frame)
    assert flushed(capfd) == []


def test_pinocchio(case: Case, capfd: pytest.CaptureFixture[str]) -> None:
    """Pinocchio keeps flange and tool0 as frames, has the mass, and says nothing."""
    pin = pytest.importorskip("pinocchio")
    capfd.readouterr()
    path = str(case.urdf)
    model = pin.buildModelFromUrdf(path)
    for kind in (pin.GeometryType.VISUAL, pin.GeometryType.COLLISION):
        pin.buildGeomFromUrdf(model, path, kind)
    data = model.createData()
    # What no joint moves, Pinocchio holds in its universe.
    assert sum(inertia.mass for inertia in model.inertias) == pytest.approx(case.mass, rel=1e-12)

    def frame(q: dict[str, float], tip: str) -> np.ndarray:
        vector = pin.neutral(model)
        for name, value in q.items():
            joint = model.joints[model.getJointId(name)]
            vector[joint.idx_q : joint.idx_q + joint.nq] = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        pin.framesForwardKinematics(model, data, vector)
        return np.array(data.oMf[model.getFrameId(tip)].homogeneous)

    assert_poses(case, frame)
    assert flushed(capfd) == []


def test_drake(case: Case, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]) -> None:
    """Drake keeps flange and tool0 as bodies, has the mass, and logs nothing."""
    pytest.importorskip("pydrake")
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
    from pydrake.multibody.tree import ModelInstanceIndex
    from pydrake.systems.framework import DiagramBuilder

    capfd.readouterr()
    plant, scene = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.001)
    with caplog.at_level(logging.INFO, "drake"):
        Parser(plant, scene).AddModelsFromString(case.urdf.read_text("utf-8"), "urdf")
        if case.root != "world":
            plant.WeldFrames(plant.world_frame(), plant.GetFrameByName(case.root))
        plant.Finalize()
    context = plant.CreateDefaultContext()
    models = map(ModelInstanceIndex, range(1, plant.num_model_instances()))  # Drake's own world has no mass.
    assert sum(
        plant.get_body(index).get_mass(context) for model in models for index in plant.GetBodyIndices(model)
    ) == pytest.approx(case.mass, rel=1e-12)

    def frame(q: dict[str, float], tip: str) -> np.ndarray:
        values = plant.GetPositions(context)
        for name, value in q.items():
            values[plant.GetJointByName(name).position_start()] = value
        plant.SetPositions(context, values)
        return np.array(plant.GetBodyByName(tip).EvalPoseInWorld(context).GetAsMatrix4())

    assert_poses(case, frame)
    assert [record.getMessage() for record in caplog.records if record.name.startswith("drake")] == []
    assert flushed(capfd) == []


NO_INERTIAL = "No inertial data for link, using mass=1, localinertiadiagonal = 1,1,1, identity local inertial frame"


def test_pybullet(case: Case, capfd: pytest.CaptureFixture[str]) -> None:
    """PyBullet keeps flange and tool0 as links, has the mass, and says that base_link has no inertial, as expected; of a world it does not."""
    bullet = pytest.importorskip("pybullet")
    capfd.readouterr()
    client = bullet.connect(bullet.DIRECT)
    try:
        bullet.setPhysicsEngineParameter(enableFileCaching=0)
        flags = bullet.URDF_USE_INERTIA_FROM_FILE
        arm = bullet.loadURDF(str(case.urdf), useFixedBase=True, flags=flags, physicsClientId=client)
        numbers = range(bullet.getNumJoints(arm))
        info = {number: bullet.getJointInfo(arm, number) for number in numbers}
        links = {each[12].decode(): number for number, each in info.items()}
        joints = {each[1].decode(): number for number, each in info.items()}
        masses = [bullet.getDynamicsInfo(arm, number)[0] for number in numbers]
        assert sum(masses) == pytest.approx(case.mass, rel=1e-6)

        def frame(q: dict[str, float], tip: str) -> np.ndarray:
            for name, value in q.items():
                bullet.resetJointState(arm, joints[name], value)
            state = bullet.getLinkState(arm, links[tip], computeForwardKinematics=True)
            T = np.eye(4)
            T[:3, :3] = np.reshape(bullet.getMatrixFromQuaternion(state[5]), (3, 3))
            T[:3, 3] = state[4]
            return T

        assert_poses(case, frame, 1e-5)
    finally:
        bullet.disconnect(client)
    text = re.sub(r"b3Warning\[[^\]]*\]:", "\n", "\n".join(flushed(capfd)))
    said = [line.strip() for line in text.splitlines() if line.strip() and not line.startswith("pybullet build time")]
    assert said == ([] if case.root == "world" else [NO_INERTIAL, case.root])


def test_check_urdf(case: Case) -> None:
    """urdfdom's tool finds the root and every link, flange and tool0 included, and says nothing on standard error."""
    command = shutil.which("check_urdf")
    if command is None:
        pytest.skip("check_urdf is not installed (Debian: liburdfdom-tools)")
    done = subprocess.run([command, str(case.urdf)], capture_output=True, text=True, check=True)
    assert done.stderr == ""
    assert "Successfully Parsed XML" in done.stdout
    assert f"root Link: {case.root} has" in done.stdout
    assert all(f":  {tip}" in done.stdout for _, tips in case.poses for tip in tips)


@pytest.mark.parametrize("case", [*dict.fromkeys([*names()[::12], CELL])], indirect=True)
def test_sdformat(case: Case) -> None:
    """sdformat converts the file without a word and with the whole mass; it lumps tool0 into the link that carries it. It starts slowly, so it takes a sample."""
    model = etree.fromstring(sdformat("--print", case.urdf).encode()).find("model")
    moving = [joint.get("name") for joint in model.findall("joint") if joint.get("type") != "fixed"]
    assert sorted(moving) == sorted(case.poses[0][0])
    assert sum(float(mass.text) for mass in model.iter("mass")) == pytest.approx(case.mass, rel=1e-9)
