"""The main job, as a user does it: `dh2urdf run configs/ur5.yaml`.

`pytest --renew` writes its picture, which docs/ shows.
"""

import hashlib
import json
import shutil
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import numpy as np
import pytest
from child_python import python
from PIL import Image

pytest.importorskip("pybullet")
pytest.importorskip("mujoco")

PICTURE = Path(__file__).parents[1] / "docs" / "ur5.png"
CONFIGS = Path(__file__).parents[1] / "configs"
FILES = {"ur5.urdf", "ur5_macro.xacro", "ur5.urdf.xacro", "ur5.png", "ur5.mujoco.png"}


UNHURRIED = "from dh2urdf.cli import main, run; run.LINE_EVERY = float('inf'); main()"
"""The command, which says nothing of its progress on a machine where it takes more than ten seconds."""


def run_in(folder: Path) -> CompletedProcess[str]:
    """The command in a folder that holds a copy of configs."""
    done = python("-c", UNHURRIED, "run", "configs/ur5.yaml", folder=folder)
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture(scope="module")
def checkout(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder in which the main job was done."""
    folder = tmp_path_factory.mktemp("checkout")
    shutil.copytree(CONFIGS, folder / "configs")
    result = run_in(folder)
    (folder / "stdout").write_text(result.stdout, "utf-8")
    (folder / "stderr").write_text(result.stderr, "utf-8")
    return folder


@pytest.fixture(scope="module")
def output(checkout: Path) -> Path:
    """Where its files are."""
    return checkout / "build" / "ur5"


@pytest.fixture(scope="module")
def manipulator(output: Path) -> dict[str, Any]:
    """What the report declares about the UR5."""
    report = json.loads((output / "report.json").read_bytes())
    (entry,) = report["manipulators"]
    return dict(entry)


@pytest.mark.long
def test_all_files_are_there_and_nothing_else(output: Path, reports: frozenset[str]) -> None:
    """URDF, macro, top file, picture, and what tells of the run; no temporary file, no journal."""
    assert {path.name for path in output.iterdir()} == FILES | reports


def test_the_summary_tells_the_errors(checkout: Path) -> None:
    """Standard output has a table with the manipulator, its errors, the hold test and the files; no colour in a pipe."""
    printed = (checkout / "stdout").read_text("utf-8")
    assert (checkout / "stderr").read_text("utf-8") == ""
    assert "largest distance of tool0 from the DH product, in metres" in printed
    header = next(line for line in printed.splitlines() if "manipulator" in line)
    assert [cell.strip() for cell in header.strip("┃").split("┃")] == [
        *("manipulator", "status", "urdf", "xacro", "pybullet", "mujoco", "holds still", "files")
    ]
    rows = [line.strip("│").split("│") for line in printed.splitlines() if "│" in line]
    name, status, urdf, xacro, pybullet, mujoco, holds, files = (
        " ".join(parts).strip() for parts in zip(*([cell.strip() for cell in row] for row in rows), strict=True)
    )
    assert (name, status, holds) == ("ur5", "ok", "yes")
    assert float(urdf) < 1e-12
    assert float(xacro) < 1e-12
    assert 1e-9 < float(pybullet) < 1e-6
    assert float(mujoco) < 1e-12
    assert set(files.split(", ")) == FILES
    assert "1 made\n" in printed
    assert printed.endswith("written to build/ur5\n")
    assert "\x1b" not in printed


def test_the_report_knows_every_file(output: Path, manipulator: dict[str, Any]) -> None:
    """Size and hash of each written description are those of the file on the disk."""
    for file in manipulator["files"]:
        content = (output / file["path"]).read_bytes()
        assert (len(content), hashlib.sha256(content).hexdigest()) == (file["bytes"], file["sha256"])
    assert {file["path"] for file in manipulator["files"]} == {"ur5.urdf", "ur5_macro.xacro", "ur5.urdf.xacro"}


def test_an_oracle_agrees(
    output: Path, reference_robots: Sequence[Any], tool0_of: Callable[[Path], Callable[[Sequence[float]], np.ndarray]]
) -> None:
    """The file has the poses that Universal Robots' own figures give, within the tenth of a micrometre of their digits."""
    ur5 = next(robot for robot in reference_robots if robot.id == "urdoc_ur5")
    pose = tool0_of(output / "ur5.urdf")
    for q, expected in zip(ur5.q, ur5.poses, strict=True):
        np.testing.assert_allclose(pose(q), expected, rtol=0, atol=1e-9)


def test_the_picture_is_what_comes_out(*, output: Path, manipulator: dict[str, Any], renew: bool) -> None:
    """docs/ur5.png is the picture of a fresh run, within what renderers differ in."""
    assert manipulator["loaders"]["pybullet"]["picture"] == "ur5.png"
    if renew:
        shutil.copy(output / "ur5.png", PICTURE)
    drawn, shown = (np.asarray(Image.open(path).convert("RGB"), dtype=float) for path in (output / "ur5.png", PICTURE))
    assert drawn.shape == shown.shape
    different = np.abs(drawn - shown).max(axis=2) > 32
    assert different.mean() < 0.01


def test_a_simulator_that_is_not_installed(dh2urdf: Callable[..., CompletedProcess[str]], tmp_path: Path) -> None:
    """Without PyBullet the other simulators do the job, and a line says what to type."""
    shutil.copytree(CONFIGS, tmp_path / "configs")
    blocker = tmp_path / "blocker"
    blocker.mkdir()
    # Python runs this at its start, in every child process too.
    (blocker / "sitecustomize.py").write_text("import sys\nsys.modules['pybullet'] = None\n")
    done = dh2urdf("run", "configs/ur5.yaml", path=[blocker])
    assert [line for line in done.stdout.splitlines() if line.startswith("- ur5: ")] == [
        f"- ur5: loader 'pybullet' needs pybullet: {sys.executable} -m pip install 'dh2urdf[pybullet]'"
    ]
    assert "simulators: pybullet 0 of 1 (not installed), mujoco 1 of 1\n" in done.stdout
    required = dh2urdf("run", "configs/ur5.yaml", "--set", "loaders=[pybullet]", path=[blocker], status=3)
    assert required.stderr.endswith(f"{sys.executable} -m pip install 'dh2urdf[pybullet]'\n")
