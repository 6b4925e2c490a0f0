from __future__ import annotations

import json
import shutil
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from child_python import ADDOPTS, python

if TYPE_CHECKING:
    from collections.abc import Callable

    Command = Callable[..., subprocess.CompletedProcess[str]]

EXAMPLE = Path(__file__).with_name("example_plugin")
RUN = """\
inputs: scara.dh.toml
emitters:
  - urdf
  - {stage: datasheet, options: {angles: rad, digits: 3}}
output: {directory: build}
"""
DATASHEET = """\
# scara

| joint | type | lower | upper | unit |
|---|---|--:|--:|---|
| shoulder | revolute | -2.27 | 2.27 | rad |
| elbow | revolute | -2.62 | 2.62 | rad |
| quill | prismatic | 0 | 0.21 | m |
| wrist | continuous | – | – | rad |
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder into which pip has installed the example plugin, from a copy of its folder, without a network."""
    folder = tmp_path_factory.mktemp("third_party")
    shutil.copytree(EXAMPLE, folder / "source")
    offline = ("--no-index", "--no-deps", "--no-build-isolation", "--quiet", "--disable-pip-version-check")
    subprocess.run(
        [sys.executable, "-m", "pip", "install", *offline, "--target", folder / "site", folder / "source"], check=True
    )
    return folder / "site"


@pytest.fixture
def table(tmp_path: Path) -> Path:
    return Path(shutil.copy(EXAMPLE / "examples" / "scara.dh.toml", tmp_path))


def test_both_stages_work_in_a_run(dh2urdf: Command, site: Path, table: Path) -> None:
    """An installed third party's reader and emitter work in a run file beside the built-in stages, and are proved."""
    table.with_name("run.yaml").write_text(RUN)
    dh2urdf("run", "run.yaml", path=[site])
    build = table.with_name("build")
    assert (build / "scara.datasheet.md").read_text("utf-8").startswith(DATASHEET)
    report = json.loads((build / "report.json").read_bytes())
    (arm,) = report["manipulators"]
    assert arm["status"] == "ok"
    assert [(file["path"], file["stage"]) for file in arm["files"]] == [
        ("scara.urdf", "urdf"),
        ("scara.datasheet.md", "datasheet"),
    ]
    assert arm["proof"]["urdf"]["position_error"] < 1e-12
    assert arm["proof"]["datasheet"] is None


@pytest.mark.long
def test_it_keeps_the_contracts(site: Path, tmp_path: Path) -> None:
    """Its own tests, three lines for each stage, hold it to all that the pipeline relies on."""
    words = ("-m", "pytest", "-p", "no:cacheprovider", "--rootdir", tmp_path, site.with_name("source"))
    tested = python(*words, folder=tmp_path, path=(site,), PYTEST_ADDOPTS=ADDOPTS)
    assert tested.returncode == 0, tested.stdout
    assert "skipped" not in tested.stdout


def test_it_is_typed_and_a_function_that_takes_other_options_is_no_valid_type(
    tmp_path: Path, types_cache: Path
) -> None:
    """mypy --strict accepts the plugin, and rejects a record whose function does not take its options."""
    (tmp_path / "wrong.py").write_text(
        "from dh2urdf_example_plugin.emitter import DatasheetOptions, emit\n"
        "from dh2urdf.stages import Emitter, NoOptions\n"
        "right: Emitter[DatasheetOptions] = Emitter(\n"
        "    name='right', summary='', emit=emit, options=DatasheetOptions, suffixes=())\n"
        "wrong: Emitter[NoOptions] = Emitter(name='wrong', summary='', emit=emit, options=NoOptions, suffixes=())\n"
    )
    words = ("-m", "mypy", "--strict", "--config-file=", "--cache-dir", types_cache, "wrong.py")
    package = EXAMPLE / "src" / "dh2urdf_example_plugin"
    checked = python(*words, package, folder=tmp_path, MYPYPATH=str(EXAMPLE / "src"))
    assert checked.returncode == 1
    assert [line.split(": error:")[0] for line in checked.stdout.splitlines()[:-1] if "error" in line] == ["wrong.py:5"]
