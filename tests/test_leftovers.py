"""A smaller run into the folder of a larger one: what the last manifest names goes, and nothing else does."""

import hashlib
import json
from pathlib import Path

import pytest
from command_line import Cli
from run_files import tree

import dh2urdf
from dh2urdf.output.layouts import Form

TABLE = "# convention: standard\njoint,a,alpha,d\nshoulder,0,pi/2,0.1\nelbow,0.4,0,0\n"
RUN = """\
inputs: arm.csv
variations: {of: arm, count: 25, vary: {field: a, joints: elbow, scale: [0.9, 1.1]}}
output: {directory: out}
report: {html: false}
"""
SMALLER = ("--set", "variations.0.count=7")
SIZED = ("--set", "output.size=10")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(RUN)
    return tmp_path


def run(cli: Cli, *words: str) -> str:
    return cli("run", "run.yaml", "--workers", 1, *words).stdout


@pytest.mark.parametrize(
    ("before", "after", "resume"),
    [
        (Form.FILES, Form.FOLDERS, ()),
        (Form.FOLDERS, Form.FILES, ("--resume",)),
        (Form.SHARDS, Form.SHARDS, ("--resume",)),
    ],
    ids=str,
)
def test_a_smaller_run_leaves_what_a_run_from_nothing_leaves(
    cli: Cli, folder: Path, before: Form, after: Form, resume: tuple[str, ...]
) -> None:
    """In any layout after any other, resumed or not; no folder stays empty."""
    sized = {form: () if form is Form.FILES else SIZED for form in Form}
    run(cli, "--set", f"output.layout={before}", *sized[before])
    words = ("--set", f"output.layout={after}", *sized[after], *SMALLER)
    told = run(cli, *words, *resume)
    run(cli, *words, "-o", "fresh")
    assert tree(folder / "out") == tree(folder / "fresh")
    assert all(any(path.iterdir()) for path in (folder / "out").rglob("*") if path.is_dir())
    assert "files of an earlier run: " in told


def test_they_are_kept_where_that_is_asked_for(cli: Cli, folder: Path) -> None:
    """`--keep` counts them, and `keep=True` is the same from Python."""
    run(cli)
    before = tree(folder / "out")
    assert "files of an earlier run: 25 kept" in run(cli, *SMALLER, "--keep")  # arm_01 became arm_1
    assert tree(folder / "out").keys() >= before.keys()
    dh2urdf.run(folder / "run.yaml", settings={"variations.0.count": 3}, keep=True)
    assert (folder / "out/arm_7.urdf").exists()
    dh2urdf.run(folder / "run.yaml", settings={"variations.0.count": 2})
    assert not (folder / "out/arm_3.urdf").exists()
    assert (folder / "out/arm_7.urdf").exists()  # no manifest names it any more


def test_nothing_else_is_removed(cli: Cli, folder: Path) -> None:
    """Files of the user among the run's, files that the user changed, and inputs stay, and their folders with them."""
    run(cli, "--set", "output.layout=folders", *SIZED)
    out = folder / "out"
    own = [out / "notes.txt", out / "00002/notes.txt", out / "arm_99.urdf"]
    for path in own:
        path.write_text("mine")
    (out / "00001/arm_15.urdf").write_text("changed")
    (out / "00001/arm_16.urdf").unlink()
    (out / "00001/more").mkdir()
    told = run(cli, *SMALLER)
    assert "24 removed, 1 kept, since they were changed" in told.replace("\n", " ")
    assert all(path.read_text() == "mine" for path in own)
    assert (out / "00001/arm_15.urdf").read_text() == "changed"
    assert {path.name for path in (out / "00001").iterdir()} == {"arm_15.urdf", "more"}
    assert not (out / "00000").exists()


def test_a_shard_that_was_changed_stays(cli: Cli, folder: Path) -> None:
    """A tar file is looked into at the places that the manifest names."""
    run(cli, "--set", "output.layout=shards", *SIZED)
    shard = folder / "out/000002.tar"
    shard.write_bytes(shard.read_bytes()[:-4000])
    run(cli, *SMALLER, "--set", "output.layout=shards", *SIZED)
    assert shard.exists()
    assert not (folder / "out/000001.tar").exists()


def test_an_input_is_never_removed(cli: Cli, folder: Path) -> None:
    """The last run wrote what this one reads."""
    run(cli, "--set", "emitters=[urdf, mjcf]")
    table = folder / "out/arm_03.xml"
    manifest = folder / "out/manifest.jsonl"
    table.write_text(TABLE)
    digest = hashlib.sha256(TABLE.encode()).hexdigest()
    rows = [json.loads(line) for line in manifest.read_bytes().splitlines()]
    for row in rows:
        for file in row["files"]:
            if file["path"] == table.name:
                file["sha256"] = digest
    manifest.write_text("".join(json.dumps(row) + "\n" for row in rows))
    run(cli, *SMALLER, "--set", "inputs=[{path: out/arm_03.xml, stage: csv}]", "--set", "variations.0.of=arm_03")
    assert table.read_text() == TABLE


@pytest.mark.parametrize(
    "line",
    [
        "nonsense",
        '{"files": [{"path": "../arm.csv", "sha256": "DIGEST"}], "loaders": {}}',
        '{"files": [{"path": "notes.txt", "sha256": "DIGEST"}], "loaders": {"a": {"picture": "../arm.csv"}}}',
    ],
)
def test_the_manifest_of_something_else_does_no_harm(cli: Cli, folder: Path, line: str) -> None:
    """Lines that are no rows are passed over, and no name leads out of the folder."""
    (folder / "out").mkdir()
    (folder / "out/notes.txt").write_text("mine")
    before = (folder / "arm.csv").read_bytes()
    digest = hashlib.sha256(before).hexdigest()
    (folder / "out/manifest.jsonl").write_text(line.replace("DIGEST", digest) + "\n")
    run(cli, *SMALLER)
    assert (folder / "arm.csv").read_bytes() == before
    assert (folder / "out/notes.txt").read_text() == "mine"
    assert len((folder / "out/manifest.jsonl").read_bytes().splitlines()) == 8
