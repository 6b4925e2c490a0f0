"""The same input gives the same bytes: on every run, with any hash seed, with any number of workers."""

import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from reference_arms import ReferenceRobot

TABLES = Path(__file__).parents[1] / "configs" / "tables"
QUARTER_TURNS = (
    "rtb_Puma560",
    "rtb_Stanford",
    "kst_iiwa_14R820",
    "urdoc_ur5",
    "franka_fr3",
    "arte_ABB_IRB120",
    "arte_KUKA_KR16_2",
)
"""Published robots all of whose angles are quarter turns."""


@pytest.fixture(scope="module")
def folder(
    tmp_path_factory: pytest.TempPathFactory, reference_robots: Sequence[ReferenceRobot], as_table: Callable[..., str]
) -> Path:
    """Tables of quarter-turn robots, and two run files for them and a cell of two."""
    folder = tmp_path_factory.mktemp("determinism")
    (folder / "tables").mkdir()
    for path in TABLES.iterdir():
        (folder / "tables" / path.name).write_bytes(path.read_bytes())
    for robot in reference_robots:
        if robot.id in QUARTER_TURNS:
            (folder / "tables" / f"{robot.id}.csv").write_text(as_table(robot.manipulator, "csv"), "utf-8")
    for frames in ("aligned", "dh"):
        (folder / f"{frames}.yaml").write_text(
            f"inputs: [tables/*.csv, tables/*.yaml]\n"
            f"cells: {{name: pair, arms: [{{name: a, of: ur5}}, {{name: b, of: panda, parent: a/link_3, rpy: [1, 0, 0]}}]}}\n"
            f"transform: {{stage: alpha-swap, options: {{frames: {frames}}}}}\n"
            f"emitters: [urdf, xacro]\n"
            f"proof: {{poses: 4}}\n"
        )
    return folder


def written(folder: Path, frames: str, out: str, *, begin: str, seed: str, workers: int) -> dict[str, bytes]:
    """All files of a run, but for its durations."""
    subprocess.run(
        [
            *(sys.executable, "-c", f"{begin}from dh2urdf.cli import main; main()"),
            *("run", f"{frames}.yaml", "-o", out, "--workers", str(workers)),
        ],
        cwd=folder,
        env={**os.environ, "PYTHONHASHSEED": seed},
        capture_output=True,
        check=True,
    )
    return {path.name: path.read_bytes() for path in (folder / out).iterdir() if path.name != "timing.json"}


@pytest.fixture(scope="module", params=["aligned", "dh"])
def frames(request: pytest.FixtureRequest) -> str:
    """The link frames."""
    return str(request.param)


@pytest.fixture(scope="module")
def begin(frames: str, undrawn: str) -> str:
    """How the runs begin: the reports of one of the two have drawings."""
    return undrawn if frames == "dh" else ""


@pytest.fixture(scope="module")
def first(folder: Path, frames: str, begin: str) -> dict[str, bytes]:
    """The files of a first run, by one process without hash randomisation."""
    return written(folder, frames, f"first_{frames}", begin=begin, seed="0", workers=1)


@pytest.mark.parametrize(("seed", "workers"), [("1", 1), ("random", 2)])
@pytest.mark.long
def test_every_run_writes_the_same_bytes(
    *, folder: Path, frames: str, begin: str, first: dict[str, bytes], seed: str, workers: int, reports: frozenset[str]
) -> None:
    """Another hash seed, number of workers or folder: not a byte differs, not in report, manifest and index either."""
    again = written(folder, frames, f"again_{frames}_{seed}", begin=begin, seed=seed, workers=workers)
    robots = len(list(TABLES.iterdir())) + len(QUARTER_TURNS) + 1  # the cell
    assert len(first) == 3 * robots + len(reports - {"timing.json"})
    assert set(again) == set(first)
    assert [name for name in first if first[name] != again[name]] == []
