"""One portable URDF for all: MuJoCo, urdfdom and sdformat, asked directly, take every arm without a word.

`test_simulator_matrix.py` asks PyBullet, Pinocchio and Drake by their loaders; here no code of this project stands between
the written file and the reader. docs/simulators.md and docs/profiles.md say what is expected of whom.
"""

import ctypes
import json
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from lxml import etree
from sdformat_calls import sdformat

from dh2urdf.cli import exit_status_of
from dh2urdf.kinematics import KinematicChain
from dh2urdf.manipulator import JointType
from dh2urdf_plugins.formats.urdf.reader import read_urdf
from reference_arms import ReferenceRobot

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
    tmp_path_factory: pytest.TempPathFactory, reference_robots: Sequence[ReferenceRobot], as_table: Callable[..., str]
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
