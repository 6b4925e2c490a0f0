"""Edits in runs: inputs, variations, cells, resumed runs, and what is wrong with a run file."""

import json
from pathlib import Path
from typing import Any

import pytest
from command_line import Cli
from lxml import etree

ARM = "# convention: standard\njoint, link, a, alpha, d\nhip, thigh, 0.4, pi/2, 0.1\nknee, shin, 0.3, 0, 0\n"
EDITS = """
edits:
  - {stage: payload, options: {mass: 2, radius: 0.05}}
  - {stage: rename, options: {prefix: my_}}
"""
RUN = f"inputs: arm.csv\n{EDITS}\noutput: out\nreport: {{html: false}}\n"


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "arm.csv").write_text(ARM)
    (tmp_path / "run.yaml").write_text(RUN)
    return tmp_path


def report(folder: Path) -> dict[str, Any]:
    found: dict[str, Any] = json.loads((folder / "out" / "report.json").read_bytes())
    return found


def moving(path: Path) -> list[str]:
    return [joint.get("name") for joint in etree.parse(path).iter("joint") if joint.get("type") == "revolute"]


def test_every_variant_is_edited_and_proved(cli: Cli, folder: Path) -> None:
    """Also where there are enough to be made side by side: the numbers are drawn, the names are the edit's."""
    with (folder / "run.yaml").open("a") as file:
        file.write("variations: {of: arm, count: 40, vary: {joints: hip, field: a, uniform: [0.2, 0.6]}}\n")
    cli("run", "run.yaml")
    rows = report(folder)["manipulators"]
    assert len(rows) == 41
    for row in rows[1:]:
        root = etree.parse(folder / "out" / row["files"][0]["path"]).getroot()
        assert root.find("link[@name='payload']/inertial/mass").get("value") == "2"
        x, *_ = map(float, root.find("joint[@name='my_knee']/origin").get("xyz").split())
        assert x == pytest.approx(row["drawn"]["a_1"])
        assert row["proof"]["urdf"]["position_error"] < 1e-12


def test_each_arm_of_a_cell_is_edited(cli: Cli, folder: Path) -> None:
    """The names of the edit are behind the prefix of the arm, and the proof finds both tips."""
    with (folder / "run.yaml").open("a") as file:
        file.write("cells: {name: pair, arms: [{name: l, of: arm}, {name: r, of: arm, parent: l/tool0}]}\n")
    cli("run", "run.yaml")
    assert moving(folder / "out" / "pair.urdf") == ["l_my_hip", "l_my_knee", "r_my_hip", "r_my_knee"]
    links = {link.get("name") for link in etree.parse(folder / "out" / "pair.urdf").iter("link")}
    assert {"l_payload", "r_payload"} <= links
    (_, pair) = report(folder)["manipulators"]
    assert pair["proof"]["urdf"]["tips"] == pytest.approx({"l_tool0": 0.0, "r_tool0": 0.0}, abs=1e-12)


def test_a_resumed_run_notices_another_edit(cli: Cli, folder: Path) -> None:
    """The same edits leave the files alone; another mass, another order or no edit makes them again."""
    assert "1 made" in cli("run", "run.yaml").stdout
    assert "1 unchanged" in cli("run", "run.yaml", "--resume").stdout
    assert "1 made" in cli("run", "run.yaml", "--resume", "--set", "edits.0.options.mass=3").stdout
    assert moving(folder / "out" / "arm.urdf") == ["my_hip", "my_knee"]
    assert "1 made" in cli("run", "run.yaml", "--resume", "--set", "edits=[]").stdout
    assert moving(folder / "out" / "arm.urdf") == ["hip", "knee"]


def test_a_refusal_costs_one_manipulator(cli: Cli, folder: Path) -> None:
    """A pattern that makes two joints one is an error of that arm; the other arm is made."""
    (folder / "other.csv").write_text(ARM.replace("hip", "axis 1").replace("knee", "axis 2"))
    change = "edits=[{stage: rename, options: {pattern: ' .', of: joints}}]"
    answer = cli("run", "run.yaml", "--set", "inputs=[arm.csv, other.csv]", "--set", change, status=1)
    assert "'axis 1'" in answer.stderr
    rows = {row["name"]: (row["status"], row.get("kind")) for row in report(folder)["manipulators"]}
    assert rows == {"arm": ("ok", None), "other": ("failed", "edit")}
