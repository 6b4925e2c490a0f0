"""`--edit` of `dh2urdf convert` and `edits` of `dh2urdf.convert`: the edits of a run file, for one table."""

from pathlib import Path
from typing import Any

import pytest
from command_line import Cli

import dh2urdf
from dh2urdf.errors import ConfigError

TABLE = "# convention: standard\njoint, a, alpha, d\nhip, 0.4, pi/2, 0.1\nknee, 0.3, 0, 0\n"
WORDS = ("payload: {mass: 2.5, size: [0.1, 0.1, 0.2]}", "rename: {prefix: left_}")
GIVEN = ({"payload": {"mass": 2.5, "size": (0.1, 0.1, 0.2)}}, {"rename": {"prefix": "left_"}})


@pytest.fixture(autouse=True)
def _folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("arm.csv").write_text(TABLE)


def test_command_program_and_run_file_make_the_same_file(cli: Cli) -> None:
    said = cli("convert", "arm.csv", "--edit", WORDS[0], "--edit", WORDS[1], "-o", "arm.urdf")
    assert "proved" in said.stderr
    typed = Path("arm.urdf").read_text("utf-8")
    assert 'name="left_hip"' in typed
    assert "edited by payload, rename" in typed
    assert dh2urdf.convert("arm.csv", edits=GIVEN).text == typed
    Path("run.yaml").write_text(f"inputs: arm.csv\nedits:\n{STAGES}output: {{directory: out}}\n")
    report: Any = dh2urdf.run("run.yaml")
    assert Path("out", "arm.urdf").read_text("utf-8") == typed
    edits = [stage for stage in report["reproduction"]["stages"] if stage["kind"] == "edit"]
    assert [stage["stage"] for stage in edits] == ["payload", "rename"]
    assert edits[0]["options"]["mass"] == 2.5
    assert edits[0]["options"]["size"] == [0.1, 0.1, 0.2]
    assert edits[1]["options"]["prefix"] == "left_"


STAGES = """  - {stage: payload, options: {mass: 2.5, size: [0.1, 0.1, 0.2]}}
  - {stage: rename, options: {prefix: left_}}
"""


def test_every_table_of_a_command_is_edited(cli: Cli) -> None:
    Path("other.csv").write_text(TABLE)
    cli("convert", "arm.csv", "other.csv", "--edit", "rename: {prefix: left_}", "-o", "out/")
    for name in ("arm", "other"):
        assert 'name="left_hip"' in Path("out", f"{name}.urdf").read_text("utf-8")


def test_a_file_of_an_edit_is_one_of_the_working_directory() -> None:
    Path("out").mkdir()
    Path("differences.csv").write_text("joint, a [mm], alpha, d\nknee, 1, 0, 0\n")
    made = dh2urdf.convert("arm.csv", "out/arm.urdf", edits={"calibrate": {"file": Path("differences.csv")}})
    assert made.proofs["urdf"] is not None
    assert "0.301" in made.text


def test_an_edit_may_be_written_as_in_a_run_file(cli: Cli) -> None:
    """Messages and pages write `{stage: NAME, options: {…}}`: it is the same edit on the command line and in Python."""
    short = cli("convert", "arm.csv", "--edit", "payload: {mass: 2}", "--quiet").stdout
    assert cli("convert", "arm.csv", "--edit", "{stage: payload, options: {mass: 2}}", "--quiet").stdout == short
    assert dh2urdf.convert("arm.csv", edits=[{"stage": "payload", "options": {"mass": 2}}]).text == short
    named = cli("convert", "arm.csv", "--edit", "stage: limits", "--quiet").stdout
    assert named == cli("convert", "arm.csv", "--edit", "limits", "--quiet").stdout


def test_all_that_is_wrong_is_reported_at_once() -> None:
    with pytest.raises(ConfigError) as refused:
        dh2urdf.convert("arm.csv", edits=["paylod", {"rename": {"prefx": "x"}}])
    assert len(refused.value.problems) == 2
