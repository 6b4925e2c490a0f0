"""Runs that are killed, that meet stages which crash, hang or raise, and that go on later: nothing is lost."""

import json
import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import pytest
from command_line import Cli
from run_files import tree

pytestmark = pytest.mark.skipif(not hasattr(os, "killpg"), reason="the system has no process groups")

COUNT = 3000
UR5 = """\
# convention: standard
joint,a,alpha,d
j1,0,pi/2,0.089
j2,-0.425,0,0
j3,-0.392,0,0
j4,0,pi/2,0.109
j5,0,-pi/2,0.0947
j6,0,0,0.0823
"""
MANY = f"""\
inputs: ur5.csv
variations:
  - {{of: ur5, count: {COUNT}, seed: 7, vary: [{{joints: [2, 3], field: a, scale: [0.5, 1.5]}}]}}
output: {{directory: out, size: 100}}
"""
COMMAND = (sys.executable, "-c", "from dh2urdf.cli import main; main()")


def manifest(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "manifest.jsonl").open("rb")]


@pytest.fixture
def many(tmp_path: Path) -> Path:
    (tmp_path / "ur5.csv").write_text(UR5)
    (tmp_path / "run.yaml").write_text(MANY.replace(", size: 100", ""))
    (tmp_path / "sized.yaml").write_text(MANY)
    return tmp_path


# --- Killed and resumed -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("layout", "workers", "to_all"), [("files", 1, False), ("shards", 2, True)])
@pytest.mark.long
def test_a_killed_run_goes_on_where_it_was(
    many: Path, dh2urdf: Callable[..., CompletedProcess[str]], *, layout: str, workers: int, to_all: bool
) -> None:
    """Killed several times, the run alone or its workers too, and resumed: the same bytes, and nothing else."""
    config = many / ("run.yaml" if layout == "files" else "sized.yaml")
    words = ["run", config, "--quiet", "--workers", str(workers), "--set", f"output.layout={layout}"]
    started = time.monotonic()
    dh2urdf(*words, "-o", many / "whole")
    length = time.monotonic() - started
    draw = random.Random(f"{layout} {workers}")  # noqa: S311 - any moments will do
    killed = 0
    for _ in range(4):
        with subprocess.Popen(
            [*COMMAND, *map(str, words), "-o", str(many / "out"), "--resume"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        ) as process:
            time.sleep(0.3 + draw.random() * length / 3)
            if process.poll() is None:
                killed += 1
                (os.killpg if to_all else os.kill)(process.pid, signal.SIGKILL)
    assert killed
    dh2urdf(*words, "-o", many / "out", "--resume")
    assert tree(many / "out") == tree(many / "whole")
    assert not [path for path in (many / "out").rglob("*") if path.name.startswith(".")]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Ten tables, the third of which has a notice, and a run of them that was made."""
    for number in range(10):
        (tmp_path / f"arm{number}.csv").write_text(UR5.replace("-0.425", f"-0.4{number}"))
    table = tmp_path / "arm3.csv"
    table.write_text(table.read_text().replace("j6,0,0,", "j6,0,1.57,"))
    (tmp_path / "run.yaml").write_text(
        "inputs: arm*.csv\noutput: {directory: out}\nexecution: {stage: local, options: {workers: 1}}\n"
    )
    return tmp_path


def made_again(folder: Path, cli: Cli, change: Callable[[], Any], *words: str) -> set[str]:
    """What a resumed run makes again after a change; its output is the one of a run from nothing."""
    cli("run", "run.yaml", "--quiet")
    before = {path.stem: path.stat().st_mtime_ns for path in (folder / "out").glob("*.urdf")}
    change()
    cli("run", "run.yaml", "--quiet", "--resume", *words)
    after = {path.stem: path.stat().st_mtime_ns for path in (folder / "out").glob("*.urdf")}
    cli("run", "run.yaml", "--quiet", *words, "-o", "fresh")
    assert tree(folder / "out") == tree(folder / "fresh")
    return {name for name, moment in after.items() if before.get(name) != moment}


@pytest.mark.parametrize("changed", ["arm.csv", "difference.csv", "link.stl"])
def test_a_cell_is_made_again_when_an_arm_of_it_changes(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, cli: Cli, changed: str
) -> None:
    """The table of the arm, its calibration or its mesh: the arm and the cell are other ones, and the second cell not."""
    monkeypatch.chdir(tmp_path)
    for name, a in (("arm", 0.4), ("other", 0.5)):
        (tmp_path / f"{name}.csv").write_text(f"# convention: standard\njoint, a, alpha, d\nhip, {a}, 0, 0.1\n")
    (tmp_path / "difference.csv").write_text("joint, a, alpha, d\nhip, 0.01, 0, 0\n")
    corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
    sides = [[corners[k] for k in side] for side in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))]
    facets = [
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {} {} {}\n".format(*corner) for corner in side)
        for side in sides
    ]
    (tmp_path / "link.stl").write_text("solid a\n" + "endloop\nendfacet\n".join([*facets, ""]) + "endsolid a\n")
    (tmp_path / "run.yaml").write_text("""
inputs: [{path: arm.csv, calibration: difference.csv}, other.csv]
meshes: {of: arm, joints: {hip: {mesh: link.stl}}}
cells:
  - {name: pair, arms: [{name: left, of: arm}, {name: right, of: other}]}
  - {name: alone, arms: [{name: only, of: other}]}
output: {directory: out}
""")
    path = tmp_path / changed
    change = path.read_text().replace("0.4,", "0.45,").replace("0.01,", "0.02,").replace("vertex 0.1 ", "vertex 0.2 ")
    assert change != path.read_text()
    assert made_again(tmp_path, cli, lambda: path.write_text(change)) == {"arm", "pair"}


@pytest.mark.parametrize(
    ("before", "after"), [("output.size=7", "output.size=3"), ("inputs=arm*.csv", "inputs=arm[0-4].csv")]
)
def test_a_shard_has_what_the_manifest_has_and_nothing_else(folder: Path, cli: Cli, before: str, after: str) -> None:
    """Shards are those of a run from nothing; of smaller ones, the first kept what is in the next ones, too."""
    shards = ("--quiet", "--set", "output.layout=shards", "--set", "report.html=false")
    cli("run", "run.yaml", *shards, "--set", before)
    cli("run", "run.yaml", *shards, "--set", after, "--resume")
    cli("run", "run.yaml", *shards, "--set", after, "-o", "fresh")
    assert tree(folder / "out") == tree(folder / "fresh")


# --- Stages that misbehave --------------------------------------------------------------------------------------------

MISFITS = """
import os, signal, time
from dh2urdf.hookspecs import hookimpl
from dh2urdf.stages import EmittedFile, Emitter, NoOptions

def misbehave(name):
    if "segfault" in name:
        os.kill(os.getpid(), signal.SIGSEGV)
    if "hang" in name:
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
        while True:
            time.sleep(60)
    if "raise" in name:
        raise ZeroDivisionError("division by nothing")

def emit(robot, stem, options):
    misbehave(robot.name)
    return [EmittedFile(name=f"{stem}.txt", content=robot.name.encode())]

@hookimpl
def dh2urdf_emitters():
    return [Emitter(name="misfit", summary="misbehaves", emit=emit, options=NoOptions, suffixes=(".txt",))]
"""
NAMES = ["a", "segfault", "b", "hang", "c", "raise", *(f"arm{number}" for number in range(40))]


@pytest.fixture
def misfits(tmp_path: Path, install: Callable[..., None]) -> Path:
    """A plugin whose stage misbehaves with some manipulators, and a table of these among others."""
    install(tmp_path / "site", "misfits", MISFITS)
    rows = [f"{name},{cells}" for name in NAMES for cells in UR5.splitlines()[2:]]
    (tmp_path / "arms.csv").write_text("\n".join(["# convention: standard", "robot,joint,a,alpha,d", *rows]))
    return tmp_path


@pytest.mark.long
def test_a_stage_that_misbehaves_costs_one_manipulator(
    misfits: Path, dh2urdf: Callable[..., CompletedProcess[str]]
) -> None:
    """One that crashes its process, one that hangs and one that raises: three failed rows that say so, exit status 1."""
    (misfits / "run.yaml").write_text(
        "inputs: arms.csv\nemitters: [urdf, misfit]\noutput: {directory: out, layout: shards}\n"
        "execution: {stage: local, options: {workers: 2}, time_limit: 4}\nreport: {html: false}\n"
    )
    answer = dh2urdf("run", "run.yaml", path=[misfits / "site"], status=1)
    rows = {row["name"]: row for row in manifest(misfits / "out")}
    assert list(rows) == NAMES
    failed = {name: (row["kind"], row["errors"][0]["message"]) for name, row in rows.items() if row["status"] != "ok"}
    assert failed.keys() == {"segfault", "hang", "raise"}
    assert failed["segfault"][0] == "crash"
    assert "crashed (segmentation fault)" in failed["segfault"][1]
    assert failed["hang"][0] == "time limit"
    assert "did not finish within 4 s" in failed["hang"][1]
    assert failed["raise"][0] == "stage"
    assert "ZeroDivisionError: division by nothing" in failed["raise"][1]
    written = {file["path"] for name, row in rows.items() if row["status"] == "ok" for file in row["files"]}
    assert {f"{name}.urdf" for name in NAMES if name not in failed} <= written
    assert "3 failed" in answer.stdout
    index = json.loads((misfits / "out/index.json").read_bytes())
    assert {kind: entry["names"] for kind, entry in index["failures"].items()} == {
        "crash": ["segfault"],
        "time limit": ["hang"],
        "stage": ["raise"],
    }
    assert "Traceback" not in answer.stderr
