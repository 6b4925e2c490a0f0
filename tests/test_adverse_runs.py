"""Runs that the system is against: no permission, a full disk, inputs that change, a clock set back, an upgrade."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from command_line import Cli
from permissions import ordinary, pytest_linux
from run_files import tree

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.file_patterns import matching
from dh2urdf.plugin_system import load
from dh2urdf.running.run import load_plan
from dh2urdf.tasks.batch import Expected, items

HEAD = "# convention: standard\n"
TABLE = f"{HEAD}joint,a,alpha,d\nshoulder,0,pi/2,0.1\nelbow,0.4,0,0\n"
RUN = """\
inputs: arm.csv
variations: {of: arm, count: 12, vary: {field: a, joints: elbow, scale: [0.9, 1.1]}}
output: {directory: out, layout: folders, size: 5}
report: {html: false}
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(RUN)
    return tmp_path


# --- Inputs that change -----------------------------------------------------------------------------------------------


def many_arms(a: float, count: int = 3000) -> str:
    rows = [f"arm_{number},joint,{a},pi/2,0.1" for number in range(count)]
    return "\n".join([f"{HEAD}robot,joint,a,alpha,d", *rows, ""])


def replaced(path: Path) -> None:
    path.with_suffix(".new").write_text(many_arms(0.5))
    path.with_suffix(".new").replace(path)


CHANGES: dict[str, Callable[[Path], Any]] = {
    "replaced": replaced,
    "cut off": lambda path: os.truncate(path, path.stat().st_size // 2),
    "removed": lambda path: path.unlink(),
}


@pytest.mark.parametrize("change", CHANGES.values(), ids=CHANGES)
def test_an_input_that_changes_while_it_is_read_fails(folder: Path, change: Callable[[Path], Any]) -> None:
    """What was read may be of two versions; of a run it is one failure more, and the other inputs are made."""
    path = folder / "many.csv"
    path.write_text(many_arms(0.4))
    read = dh2urdf.read_all(path)
    next(read)
    change(path)
    with pytest.raises(TableError, match="the file has changed while it was read"):
        list(read)
    path.write_text(many_arms(0.4))
    (folder / "run.yaml").write_text("inputs: [many.csv, arm.csv]\n")
    plan = load_plan(folder / "run.yaml", load())
    found = items(plan, Expected(plan))
    next(found)
    change(path)
    *others, failed, last = [what for item in found for what in item.each]
    assert isinstance(last, Manipulator)
    assert "the file has changed while it was read" in str(failed)
    assert all(isinstance(item, Manipulator) for item in others)


# --- The clock, and an upgrade ----------------------------------------------------------------------------------------


def test_a_clock_set_back_changes_nothing(cli: Cli, folder: Path) -> None:
    """What is finished is known by its bytes, whatever the times of files are."""
    cli("run", "run.yaml", "--workers", 1)
    for path in [*folder.rglob("*")]:
        moment = path.stat().st_mtime - 4000 * 86400
        os.utime(path, (moment, moment))
    (folder / "out/00001/arm_08.urdf").write_text("cut off")
    answer = cli("run", "run.yaml", "--resume", "--workers", 1).stdout
    assert "1 made, 12 unchanged" in answer
    cli("run", "run.yaml", "--workers", 1, "-o", "fresh")
    assert tree(folder / "out") == tree(folder / "fresh")


@pytest.mark.parametrize("layout", ["files", "shards"])
def test_an_upgrade_between_a_killed_run_and_its_resumption_makes_everything_again(
    cli: Cli, folder: Path, monkeypatch: pytest.MonkeyPatch, layout: str
) -> None:
    """Files of an older version are not those of the new one; the result is the one of a run from nothing."""
    words = ("run", "run.yaml", "--workers", 1, "--set", f"output.layout={layout}")
    words = words if layout != "files" else ("run", "run.yaml", "--workers", 1, "--set", "output={directory: out}")
    cli(*words)
    # As a kill leaves it: a journal in place of the manifest.
    journal = folder / "out/.dh2urdf/journal/0001"
    journal.mkdir(parents=True)
    rows = (folder / "out/manifest.jsonl").read_bytes().splitlines(keepends=True)
    (folder / "out/manifest.jsonl").unlink()
    (journal / "000000000.jsonl").write_bytes(b"".join(rows[:-1]) + rows[-1][:40])
    for module in ("conversion.keys", "report.manifest"):
        monkeypatch.setattr(f"dh2urdf.{module}.__version__", "99.0")
    told = cli(*words, "--resume").stdout
    assert "13 made" in told
    cli(*words, "-o", "fresh")
    assert tree(folder / "out") == tree(folder / "fresh")


# --- No permission ----------------------------------------------------------------------------------------------------


@pytest_linux
def test_a_file_of_the_last_run_that_cannot_be_removed_is_told(cli: Cli, folder: Path) -> None:
    """The run ends before its manifest is in place, so that it goes on later, and `--keep` does without."""
    cli("run", "run.yaml", "--workers", 1)
    (folder / "out/00002").chmod(0o555)
    smaller = ("run", "run.yaml", "--workers", "1", "--set", "variations.0.count=10", "--resume")
    try:
        refused, kept = ordinary(folder, *smaller), ordinary(folder, *smaller, "--keep")
    finally:
        (folder / "out/00002").chmod(0o755)
    assert refused.returncode == 2
    assert "cannot remove 'out/00002/arm_1" in refused.stderr
    assert "`--keep` leaves files of an earlier run" in refused.stderr
    assert kept.returncode == 0, kept.stderr


# --- Patterns ---------------------------------------------------------------------------------------------------------


def test_a_pattern_over_a_whole_disk_has_a_bound(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The message says how many files and folders it leads past, though few match."""
    for number in range(30):
        (folder / f"{number}.txt").touch()
    monkeypatch.setattr("dh2urdf.output.file_patterns.MOST_ENTRIES", 20)
    with pytest.raises(dh2urdf.errors.ConfigError, match="leads past more than 20 files and folders"):
        matching(folder, "**/*.csv")
