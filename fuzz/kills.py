"""Runs that are killed again and again and resumed: nothing is lost, in each layout and with each executor.

    python fuzz/kills.py --kills 20

For each layout (files, folders, shards) and each executor (one process, two processes, Dask) a run is killed with
SIGKILL at random moments, alone or with all its workers, and begun again with `--resume`, until it has been killed so
often. Whenever a run comes to its end, its folder must hold what a run holds that was never killed, byte for byte, and
no file besides; then it begins from nothing. `tests/test_nothing_lost.py` does a part of this in every round of tests.
"""

from __future__ import annotations

import argparse
import hashlib
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

TABLE = """\
# convention: standard
joint,a,alpha,d
j1,0,pi/2,0.089
j2,-0.425,0,0
j3,-0.392,0,0
j4,0,pi/2,0.109
j5,0,-pi/2,0.0947
j6,0,0,0.0823
"""
RUN = """\
inputs: arm.csv
variations: {{of: arm, count: {count}, seed: 7, vary: {{joints: [2, 3], field: a, scale: [0.5, 1.5]}}}}
output: {{layout: {layout}{size}}}
execution: {{stage: {stage}, options: {{workers: {workers}}}}}
"""
COMMAND = (sys.executable, "-c", "from dh2urdf.cli import main; main()")
LAYOUTS = ("files", "folders", "shards")
EXECUTORS = (("local", 1), ("local", 2), ("dask", 2))
PATIENCE = 600
"""How long one run may take [s]."""


class Result(NamedTuple):
    """What became of one layout with one executor."""

    kills: int
    ends: int
    differences: list[str]


def tree(folder: Path) -> dict[str, str]:
    """The files of a folder by their names, as hashes; not durations."""
    files = [path for path in folder.rglob("*") if path.is_file() and path.name != "timing.json"]
    return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def begin(folder: Path, *words: str) -> subprocess.Popen[bytes]:
    """Begins a run in a process group of its own."""
    return subprocess.Popen([*COMMAND, "run", "run.yaml", "-q", *words], cwd=folder, start_new_session=True)


def try_one(folder: Path, rng: random.Random, kills: int) -> Result:
    """Kills a run so often, and compares it whenever it comes to its end."""
    began = time.monotonic()
    if begin(folder, "-o", "whole").wait(PATIENCE):
        return Result(0, 0, ["the run failed without being killed"])
    length = time.monotonic() - began
    expected, out = tree(folder / "whole"), folder / "out"
    killed = ends = 0
    differences: list[str] = []
    while killed < kills or not ends:
        with begin(folder, "-o", "out", "--resume") as process:
            try:
                process.wait(rng.uniform(0.1, 0.9) * length if killed < kills else PATIENCE)
            except subprocess.TimeoutExpired:
                killed += 1
                (os.killpg if rng.random() < 0.5 else os.kill)(process.pid, signal.SIGKILL)
                continue
        found = tree(out)
        ends += 1
        differences += [name for name in found.keys() | expected.keys() if found.get(name) != expected.get(name)]
        if process.returncode:
            differences.append(f"exit status {process.returncode}")
        shutil.rmtree(out, ignore_errors=True)  # A run that failed may have none.
    return Result(killed, ends, differences)


def main() -> int:
    """Try every layout with every executor, and print what came of it."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--kills", type=int, default=20, help="how often each run is killed")
    parser.add_argument("--count", type=int, default=3000, help="manipulators of each run")
    parser.add_argument("--layouts", nargs="+", choices=LAYOUTS, default=LAYOUTS)
    parser.add_argument("--executors", nargs="+", choices=("local", "dask"), default=("local", "dask"))
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    failed = False
    print(f"{'layout':8} {'executor':9} {'kills':>5} {'runs to the end':>15}  differences")
    for layout in given.layouts:
        for stage, workers in (each for each in EXECUTORS if each[0] in given.executors):
            rng = random.Random(f"{given.seed} {layout} {stage} {workers}")
            size = "" if layout == "files" else ", size: 100"
            with tempfile.TemporaryDirectory(prefix="dh2urdf-kills-") as name:
                folder = Path(name)
                (folder / "arm.csv").write_text(TABLE)
                text = RUN.format(count=given.count, layout=layout, size=size, stage=stage, workers=workers)
                (folder / "run.yaml").write_text(text)
                result = try_one(folder, rng, given.kills)
            failed = failed or bool(result.differences)
            told = ", ".join(result.differences[:5]) or "none"
            print(f"{layout:8} {stage:6} {workers:2} {result.kills:5} {result.ends:15}  {told}", flush=True)
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
