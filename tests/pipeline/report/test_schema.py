import json
import re
from copy import deepcopy
from dataclasses import fields
from pathlib import Path
from typing import Any, get_args, get_type_hints

import pytest
from command_line import Cli
from jsonschema import Draft202012Validator

from dh2urdf import results
from dh2urdf.cli.listings import SCHEMAS
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.plugin_system import KINDS
from dh2urdf.report.conversions import FILLED_IN
from dh2urdf.report.schema import manifest_schema, report_schema
from dh2urdf.stages import LoadReport

CONFIGS = Path(__file__).parents[3] / "configs"
ARMS = "# convention: standard\nrobot,a,alpha,d\narm,0,pi/2,0.2\narm,0.4,0,0.1\nbad,0,0,x\n"
VARIATION = "variations: {of: arm, count: 3, vary: {joints: 1, field: d, uniform: [0.1, 0.3]}}\n"
CELL = "cells: {name: pair, arms: [{name: left, of: arm}, {name: right, of: arm, xyz: [1, 0, 0]}]}\n"


@pytest.fixture
def out(cli: Cli, tmp_path: Path) -> Path:
    """The output of a run that has a little of everything: failures, variants, a cell, shards, a simulator."""
    pytest.importorskip("pybullet")
    (tmp_path / "arms.csv").write_text(ARMS)
    (tmp_path / "run.yaml").write_text(
        "inputs: arms.csv\nemitters: [urdf, xacro]\nloaders: {stage: pybullet, options: {poses: 2}}\n"
        f"output: {{directory: out, layout: shards}}\nsample: {{first: 2, every: 6}}\n{VARIATION}{CELL}"
        "report: {html: false}\n"
    )
    cli("run", "run.yaml", status=1)
    return tmp_path / "out"


def errors(schema: dict[str, Any], data: Any) -> list[str]:
    return [error.message for error in Draft202012Validator(schema).iter_errors(data)]


@pytest.mark.long
def test_they_are_schemas(cli: Cli) -> None:
    """All that the command prints are valid themselves, and every reference in them leads to a definition."""
    for name in SCHEMAS:
        schema = json.loads(cli("schema", name).stdout)
        Draft202012Validator.check_schema(schema)
        missing = set(re.findall(r'"#/\$defs/([\w.]+)"', json.dumps(schema))) - schema.get("$defs", {}).keys()
        assert missing == set(), name


def test_they_hold_for_what_a_run_writes(out: Path) -> None:
    """report.json and every line of the manifest are as their schemas say, and nothing of them is left to chance."""
    report = json.loads((out / "report.json").read_bytes())
    assert {row["status"] for row in report["manipulators"]} == {"ok", "failed"}
    assert any(row["drawn"] for row in report["manipulators"])
    assert any(row["loaders"] for row in report["manipulators"])
    assert any("tips" in (row["proof"].get("urdf") or {}) for row in report["manipulators"])
    assert None in [proof for row in report["manipulators"] for proof in row["proof"].values()]
    assert errors(report_schema(), report) == []
    for line in (out / "manifest.jsonl").read_bytes().splitlines():
        assert errors(manifest_schema(), json.loads(line)) == []


def test_they_refuse_anything_else(out: Path) -> None:
    """A fact that is missing, one more, or one of another kind, is found, at every depth."""
    report = json.loads((out / "report.json").read_bytes())
    changed: list[Any] = [{**report, "more": 1}, {**report, "left_out": -1}]
    for change in (
        lambda row: row.pop("source"),
        lambda row: row.update(status="fine"),
        lambda row: row["files"][0].update(sha256="x"),
        lambda row: row["files"][0].pop("offset"),
        lambda row: row["proof"]["urdf"].update(position_error="0"),
        lambda row: row["loaders"]["pybullet"].pop("mass"),
        lambda row: row["errors"].append({"message": "no place"}),
    ):
        other = deepcopy(report)
        change(other["manipulators"][0])
        changed.append(other)
    assert all(errors(report_schema(), other) for other in changed)


def test_a_loaders_report_is_described_as_it_is() -> None:
    """The schema has every field of a loader's report, in its order."""
    described = list(manifest_schema()["$defs"]["load"]["properties"])
    assert described == ["verdict", "optional", "errors", *(field.name for field in fields(LoadReport))]


def test_names_are_those_of_the_records() -> None:
    """The words for conventions, joint types, kinds of stages, and what a conversion may fill in."""
    assert get_args(results.ConventionName) == tuple(Convention)
    assert get_args(results.JointTypeName) == tuple(JointType)
    assert get_args(results.KindName) == KINDS
    assert list(get_type_hints(results.FilledInEntry)) == [words.replace(" ", "_") for words in FILLED_IN]
