"""`dh2urdf new-plugin`: for each kind of stage, what an author types, from the name to a run."""

import json
import os
import re
import site
import subprocess
import sys
import venv
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
from child_python import ADDOPTS, python
from command_line import Cli

from dh2urdf.plugin_system import KINDS
from dh2urdf.scaffold import LONGEST
from dh2urdf.stages import Kind

CSV = "# convention: standard\nrobot, a, alpha, d\none, 0.4, pi/2, 0.1\ntwo, 0.3, 0, 0\n"
LINES = '{"name": "one", "convention": "standard", "rows": [{"a": 0.4}]}\n{"name": "bent", "rows": [1]}\n'


class Trial(NamedTuple):
    """A run of an author's stage.

    Attributes:
        table: what is in the input.
        suffix: that of the input.
        sections: the sections of the run file that name the stage.
        status: the exit status of the run.
        written: files that it leaves.
    """

    table: str
    suffix: str
    sections: str
    status: int
    written: tuple[str, ...]


TRIALS: dict[Kind, Trial] = {
    "reader": Trial(LINES, ".trial.jsonl", "emitters: urdf", 1, ("one.urdf",)),
    "transform": Trial(CSV, ".csv", "transform: {stage: trial, options: {radius: 0.02}}", 0, ("one.urdf", "two.urdf")),
    "edit": Trial(CSV, ".csv", "edits: {stage: trial, options: {mass: 2.5}}", 0, ("one.urdf", "two.urdf")),
    "emitter": Trial(CSV, ".csv", "emitters: {stage: trial, options: {digits: 3}}", 0, ("one.trial.csv",)),
    "loader": Trial(CSV, ".csv", "loaders: {stage: trial, options: {poses: 5}}", 0, ("one.urdf",)),
    "executor": Trial(CSV, ".csv", "execution: {stage: trial, options: {workers: 2}}", 0, ("one.urdf", "two.urdf")),
}


@pytest.fixture
def environment(tmp_path: Path) -> Path:
    """The commands of a fresh virtual environment, which sees what is installed here: there may be no network."""
    folder = tmp_path / "venv"
    venv.create(folder, with_pip=False)
    (packages,) = folder.glob("lib/python*/site-packages")
    seen = [path for path in site.getsitepackages() if Path(path).is_dir()]
    packages.joinpath("host.pth").write_text("".join(f"import site; site.addsitedir({path!r})\n" for path in seen))
    return folder / "bin"


@pytest.fixture
def author(environment: Path, types_cache: Path, undrawn: str) -> Callable[[Path], Callable[..., str]]:
    """An author who types commands in a folder, in an environment, and gets what they print."""

    def in_folder(folder: Path) -> Callable[..., str]:
        def types(*words: str, status: int = 0) -> str:
            program, *options = words
            begin = undrawn if options[0] == "run" else ""
            calling = (
                ["-c", f"{begin}from dh2urdf.cli import main; main()"] if program == "dh2urdf" else ["-m", program]
            )
            python = sys.executable if program == "ruff" else environment / "python"  # Ruff is no package of Python's.
            result = subprocess.run(
                [python, *calling, *options],
                cwd=folder,
                env={**os.environ, "PYTEST_ADDOPTS": ADDOPTS, "MYPY_CACHE_DIR": str(types_cache), "NO_COLOR": "1"},
                capture_output=True,
                text=True,
                encoding="utf-8",
                check=False,
            )
            assert result.returncode == status, f"{words}: {result.returncode}\n{result.stdout}\n{result.stderr}"
            return result.stdout

        return types

    return in_folder


def leaves_ruff_nothing_to_say(folder: Path) -> None:
    for words in (("check",), ("format", "--check")):
        checked = python("-m", "ruff", *words, "--no-cache", ".", folder=folder)
        assert checked.returncode == 0, checked.stdout


@pytest.mark.long
def test_what_an_author_types(
    dh2urdf: Callable[..., object], author: Callable[[Path], Callable[..., str]], tmp_path: Path
) -> None:
    """new-plugin, pip install, pytest, ruff, mypy --strict, plugins, and a run, for each kind: each works at once."""
    pytest.importorskip("ruff")
    names = {kind: f"dh2urdf-trial-{kind}" for kind in KINDS}
    for kind, name in names.items():
        dh2urdf("new-plugin", name, "--kind", kind)
    offline = ("--no-index", "--no-deps", "--no-build-isolation", "--quiet", "--disable-pip-version-check")
    author(tmp_path)("pip", "install", *offline, *(f"./{name}" for name in names.values()))
    for kind, name in names.items():
        types = author(tmp_path / name)
        tested = types("pytest", "-p", "no:cacheprovider")
        assert " passed" in tested
        assert "skipped" not in tested
        types("mypy", "--strict")
        types("ruff", "check", "--no-cache", ".")
        types("ruff", "format", "--no-cache", "--check", ".")
        trial, stage = TRIALS[kind], f"trial-{kind}"
        listed = json.loads(types("dh2urdf", "plugins", "--json"))
        assert listed["broken"] == []
        (mine,) = [each for each in listed["stages"] if each["distribution"] == f"{name} 0.1.0"]
        assert (mine["kind"], mine["name"]) == (kind, stage)
        suffix, sections = (text.replace("trial", stage) for text in (trial.suffix, trial.sections))
        (tmp_path / name / f"table{suffix}").write_text(trial.table, "utf-8")
        (tmp_path / name / "run.yaml").write_text(f"inputs: table{suffix}\n{sections}\noutput: {{directory: build}}\n")
        types("dh2urdf", "run", "run.yaml", status=trial.status)
        written = {file.replace("trial", stage) for file in trial.written}
        assert written <= {path.name for path in (tmp_path / name / "build").iterdir()}


@pytest.mark.long
def test_the_smallest_plugins_work_at_once(
    dh2urdf: Callable[..., object], author: Callable[[Path], Callable[..., str]], tmp_path: Path
) -> None:
    """`--minimal`: three files of each kind, which keep the contract, satisfy mypy --strict and ruff, and are listed."""
    pytest.importorskip("ruff")
    (folder := tmp_path / "plugins").mkdir()
    for kind in KINDS:
        dh2urdf("new-plugin", f"tiny-{kind}", "--kind", kind, "--minimal", "--dir", str(folder))
        files = {path.name for path in (folder / f"tiny-{kind}").rglob("*")}
        assert files == {"pyproject.toml", f"tiny_{kind}.py", f"test_tiny_{kind}.py"}
        assert len((folder / f"tiny-{kind}" / f"tiny_{kind}.py").read_text("utf-8").splitlines()) <= 35
    types = author(folder)
    offline = ("--no-index", "--no-deps", "--no-build-isolation", "--quiet", "--disable-pip-version-check")
    types("pip", "install", *offline, *(f"./tiny-{kind}" for kind in KINDS))
    tested = types("pytest", "-p", "no:cacheprovider", "--import-mode=importlib")
    assert " passed" in tested
    assert "skipped" not in tested
    types("mypy", "--strict", *(f"tiny-{kind}/tiny_{kind}.py" for kind in KINDS))
    listed = json.loads(types("dh2urdf", "plugins", "--json"))
    assert listed["broken"] == []
    mine = {(each["kind"], each["name"]) for each in listed["stages"]}
    assert {(kind, f"tiny-{kind}") for kind in KINDS} <= mine


def test_the_tutorial_writes_what_the_checks_of_the_plugin_take(cli: Cli, tmp_path: Path) -> None:
    """The code of docs/first-plugin.md, put where it says, leaves the new plugin's ruff nothing to say."""
    pytest.importorskip("ruff")
    cli("new-plugin", "wall-sheet", "--kind", "emitter")
    page = Path(__file__).parents[1] / "docs" / "first-plugin.md"
    written = re.findall(r'^```python title="([^"]+)"\n(.*?)^```$', page.read_text("utf-8"), re.DOTALL | re.MULTILINE)
    assert len(written) == 2
    for name, code in written:
        (tmp_path / name).write_text(code, "utf-8")
    leaves_ruff_nothing_to_say(tmp_path / "wall-sheet")


def test_what_is_written_does_not_depend_on_the_length_of_the_name(cli: Cli, tmp_path: Path) -> None:
    """Ruff finds nothing to change with the shortest and the longest name."""
    pytest.importorskip("ruff")
    for name in ("q", "q" * LONGEST):
        for size in ("", "--minimal"):
            place = tmp_path / f"sized{size}"
            place.mkdir(exist_ok=True)
            cli("new-plugin", name, "--kind", "emitter", "--dir", str(place), *filter(None, [size]))
            leaves_ruff_nothing_to_say(place / name)


def test_a_function_that_takes_other_options_is_no_valid_type(tmp_path: Path, types_cache: Path) -> None:
    """mypy --strict rejects a record whose function does not take its options."""
    lines = (
        "from collections.abc import Sequence",
        "from dh2urdf.robot import Robot",
        "from dh2urdf.stages import EmittedFile, Emitter, NoOptions",
        "class Other: ...",
        "def emit(robot: Robot, stem: str, options: Other, /) -> Sequence[EmittedFile]: return ()",
        "right: Emitter[Other] = Emitter(name='right', summary='', emit=emit, options=Other, suffixes=())",
        "wrong: Emitter[NoOptions] = Emitter(name='wrong', summary='', emit=emit, options=NoOptions, suffixes=())",
    )
    (tmp_path / "stages.py").write_text("\n".join(lines), "utf-8")
    words = ("-m", "mypy", "--strict", "--config-file=", "--cache-dir", types_cache, "stages.py")
    checked = python(*words, folder=tmp_path)
    assert checked.returncode == 1
    assert [line.split(": error:")[0] for line in checked.stdout.splitlines() if "error:" in line] == ["stages.py:7"]
