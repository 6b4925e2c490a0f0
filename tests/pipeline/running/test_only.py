"""Emitters that write only arms by themselves, or only cells."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from command_line import Cli

TABLES = Path(__file__).parents[3] / "configs/tables"
RUN = f"""
inputs: {TABLES}/ur5.csv
variations: {{name: v, of: ur5, count: 3, vary: {{joints: [2, 3], field: a, scale: [0.9, 1.1]}}}}
cells: {{name: c, arms: [{{name: l, of: v}}, {{name: r, of: ur5, xyz: [2, 0, 0]}}]}}
"""


@pytest.fixture
def rows(cli: Cli, tmp_path: Path) -> Callable[..., dict[str, Any]]:
    """The rows of a run, by the names of its manipulators."""

    def run(more: str, *words: str) -> dict[str, Any]:
        (tmp_path / "run.yaml").write_text(RUN + more)
        cli("run", tmp_path / "run.yaml", "-o", tmp_path / "out", *words)
        report = json.loads((tmp_path / "out/report.json").read_bytes())
        assert {row["status"] for row in report["manipulators"]} == {"ok"}
        return {row["name"]: row for row in report["manipulators"]}

    return run


def stages(row: dict[str, Any]) -> list[str]:
    assert sorted({file["stage"] for file in row["files"]}) == sorted(row["proof"])
    return list(row["proof"])


@pytest.mark.parametrize("words", [(), ("--set", "execution.options.workers=2")])
def test_each_writes_what_it_is_for(rows: Callable[..., Any], tmp_path: Path, words: tuple[str, ...]) -> None:
    """Arms, variants in columns included, have the files of some emitters, and cells those of others."""
    found = rows("emitters: [{stage: urdf, only: arms}, {stage: xacro, only: cells}, sdf]", *words)
    assert {name: stages(row) for name, row in found.items()} == {
        **{name: ["urdf", "sdf"] for name in ("ur5", "v_1", "v_2", "v_3")},
        **{name: ["xacro", "sdf"] for name in ("c_1", "c_2", "c_3")},
    }
    assert {path.name for path in (tmp_path / "out").glob("*.urdf")} == {
        f"{name}.urdf" for name in found if name[0] != "c"
    }


def test_arms_may_have_no_files_at_all(rows: Callable[..., Any]) -> None:
    """They are made and checked all the same, and so are the cells of them."""
    found = rows("emitters: {stage: urdf, only: cells}")
    assert {name: stages(row) for name, row in found.items()} == {
        **{name: [] for name in ("ur5", "v_1", "v_2", "v_3")},
        **{name: ["urdf"] for name in ("c_1", "c_2", "c_3")},
    }
    assert all(row["proof"]["urdf"]["position_error"] < 1e-14 for name, row in found.items() if name[0] == "c")


def test_a_simulator_is_asked_where_there_is_a_file(
    rows: Callable[..., Any], require_loaders: Callable[..., None]
) -> None:
    """Of the others the report has that there was none."""
    require_loaders("pybullet")
    found = rows("emitters: [{stage: urdf, only: cells}, {stage: sdf, only: arms}]\nloaders: pybullet")
    for name, row in found.items():
        passed = {"pybullet": "passed"} if name[0] == "c" else {}
        assert {loader: load["verdict"] for loader, load in row["loaders"].items()} == passed
        assert row.get("not_loaded", {}) == ({} if passed else {"pybullet": "no file"})


def test_files_are_made_anew_where_the_rule_changes(rows: Callable[..., Any]) -> None:
    """A run that resumes does not keep an arm without the file that it gets now."""
    assert stages(rows("emitters: {stage: urdf, only: cells}")["ur5"]) == []
    assert stages(rows("emitters: urdf", "--resume")["ur5"]) == ["urdf"]
