"""Resumed runs after files were damaged or code has changed: nothing old is passed off as new."""

import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from subprocess import CompletedProcess
from typing import Any

import pytest
from command_line import Cli
from run_files import tree

LAYOUTS = {"files": "", "shards": ", layout: shards, size: 4"}
TABLE = "# convention: standard\nrobot, joint, a, alpha, d\nr1, j1, 0.4, pi/2, 0.1\nr1, j2, 0.3, 0, 0\n"
RUN = """\
inputs: t.csv
variations: [{of: r1, count: 9, seed: 7, vary: {joints: all, field: mass, uniform: [1, 5]}}]
output: {directory: outLAYOUT}
execution: {stage: local, options: {workers: 1}}
report: {html: false}
"""


def run(layout: str) -> str:
    """A run file with ten manipulators."""
    return RUN.replace("LAYOUT", LAYOUTS[layout])


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "t.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(run("files"))
    return tmp_path


# --- Damaged files ----------------------------------------------------------------------------------------------------


DAMAGE: dict[str, Callable[[bytes], bytes]] = {
    "the end cut": lambda content: content.rstrip(b"\0")[:-1],
    "garbage behind the end": lambda content: content + b"G" * 10_240,
    "another byte": lambda content: content.replace(b"0.4", b"0.5", 1),
    "nothing left": lambda _: b"",
}


@pytest.mark.parametrize("layout", LAYOUTS)
def test_damaged_files_are_written_anew(folder: Path, cli: Cli, layout: str) -> None:
    """Whatever has happened to a file or a shard, a resumed run leaves the bytes of one that was never interrupted."""
    (folder / "run.yaml").write_text(run(layout))
    words = ("run", "run.yaml", "--quiet")
    cli(*words)
    whole = tree(folder / "out")
    path = folder / "out" / {"files": "r1_5.urdf", "shards": "000001.tar"}[layout]
    sound = path.read_bytes()
    for what, damage in DAMAGE.items():
        path.write_bytes(damage(sound))
        assert path.read_bytes() != sound
        cli(*words, "--resume")
        assert tree(folder / "out") == whole, what


def test_a_sound_shard_is_not_written_again(folder: Path, cli: Cli) -> None:
    """Of three shards, one of which is damaged, the other two keep their time of modification."""
    (folder / "run.yaml").write_text(run("shards"))
    words = ("run", "run.yaml")
    cli(*words)
    shards = sorted((folder / "out").glob("*.tar"))
    before = [path.stat().st_mtime_ns for path in shards]
    shards[1].write_bytes(shards[1].read_bytes() + bytes(10_240))
    assert "10 unchanged" in cli(*words, "--resume").stdout
    changed = [path.stat().st_mtime_ns != moment for path, moment in zip(shards, before, strict=True)]
    assert changed == [False, True, False]


# --- Changed code -----------------------------------------------------------------------------------------------------

EMITTER = """
from dataclasses import dataclass
from dh2urdf.hookspecs import hookimpl
from dh2urdf.stages import EmittedFile, Emitter, Loader, LoadReport, NoOptions
from {helper} import length

def emit(robot, stem, options):
    return [EmittedFile(name=f"{{stem}}.txt", content=str(length()).encode())]

def load(request, options):
    request.picture.write_bytes(b"a picture of " + request.robot.name.encode())
    return LoadReport(simulator="camera", version="1", picture=request.picture.name)

@hookimpl
def dh2urdf_emitters():
    return [Emitter(name="ruler", summary="measures", emit=emit, options=NoOptions, suffixes=(".txt",))]

@hookimpl
def dh2urdf_loaders():
    return [Loader(name="camera", summary="takes pictures", open=load, options=Settings)]

@dataclass(frozen=True)
class Settings:
    poses, picture, time_limit = 1, True, 60.0
"""
HELPER = "def length():\n    return 1\n"
SHAPES = {
    "a package": ("ruler.plugin", {"ruler/__init__.py": "", "ruler/plugin.py": EMITTER.format(helper=".lengths")}),
    "a module": ("ruler", {"ruler.py": EMITTER.format(helper="lengths")}),
}
"""Plugins by their entry points; each has its length in a module of its own."""


def install(folder: Path, shape: str, *, editable: bool) -> tuple[Path, list[Path]]:
    """Install a plugin as pip does; its module with the length, and the folders that Python searches."""
    entry, files = SHAPES[shape]
    site = folder / "site-packages"
    home = folder / "src" if editable else site
    helper = "lengths.py" if shape == "a module" else f"{entry.partition(':')[0].removesuffix('.plugin')}/lengths.py"
    helper = helper.replace(".ruler", "/ruler")
    for name, text in {**files, helper: HELPER}.items():
        path = home / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    info = site / "ruler-1.0.dist-info"
    info.mkdir(parents=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: ruler\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text(f"[dh2urdf]\nruler = {entry}\n")
    recorded = ["_ruler.pth"] if editable else [*files, helper]
    (info / "RECORD").write_text("".join(f"{name},,\n" for name in (*recorded, "ruler-1.0.dist-info/METADATA")))
    return home / helper, [site, home]


@pytest.mark.parametrize("editable", [True, False], ids=["editable", "installed"])
@pytest.mark.parametrize("shape", SHAPES)
def test_changed_code_of_a_plugin_makes_its_files_anew(
    folder: Path, dh2urdf: Callable[..., CompletedProcess[str]], shape: str, *, editable: bool
) -> None:
    """Its version stands still, and only a module changes that the plugin imports: the files are those of the new code."""
    helper, path = install(folder, shape, editable=editable)
    words = ("run", "run.yaml", "--set", "emitters=ruler")
    dh2urdf(*words, path=path)
    helper.write_text(HELPER.replace("return 1", "return 1 * 2"))
    assert "10 made" in dh2urdf(*words, "--resume", path=path).stdout
    assert {file.read_text() for file in (folder / "out").glob("*.txt")} == {"2"}


def test_a_damaged_picture_is_taken_anew(folder: Path, dh2urdf: Callable[..., CompletedProcess[str]]) -> None:
    """The manifest has the hashes of the pictures that simulators took."""
    _, path = install(folder, "a package", editable=True)
    (folder / "run.yaml").write_text(run("shards") + "emitters: [urdf, ruler]\nloaders: camera\n")
    words = ("run", "run.yaml")
    dh2urdf(*words, path=path)
    whole = tree(folder / "out")
    rows: list[dict[str, Any]] = [json.loads(line) for line in (folder / "out/manifest.jsonl").open("rb")]
    digest = hashlib.sha256(b"a picture of r1_5").hexdigest()
    assert [row["pictures"] for row in rows if row["name"] == "r1_5"] == [{"r1_5.png": digest}]
    file = folder / "out" / "000001.tar"
    file.write_bytes(file.read_bytes().replace(b"a picture of r1_5", b"a blemish of r1_5"))
    assert "1 made, 9 unchanged" in dh2urdf(*words, "--resume", path=path).stdout
    assert tree(folder / "out") == whole
