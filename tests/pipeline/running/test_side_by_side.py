"""Tables with something to declare about each are made side by side as others are, and their notices are kept."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import orjson
import pytest

import dh2urdf
from dh2urdf.report.manifest import ManifestWriter
from dh2urdf.running.batch_work import Work
from dh2urdf.tasks.manifest_table import table_rows

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.conversion.outcome import ManifestRow
    from dh2urdf.tasks.batch_report import BatchReport

ARMS = 12
TABLE = "# convention: standard\n# name: {name}\njoint, a, alpha, d\none, 0.4, 0, {d}\ntwo, 0.3, pi/2, 0\n"


@pytest.fixture(name="inputs")
def _inputs(tmp_path: Path) -> Path:
    """Descriptions that differ in a length, whose reader has notices of each."""
    for number in range(ARMS):
        path = tmp_path / "inputs" / f"arm_{number:02}.urdf"
        dh2urdf.convert(TABLE.format(name=path.stem, d=0.1 + number / 97), path, reader="csv")
    return tmp_path


@pytest.fixture(name="by_themselves")
def _by_themselves(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """The places in their batches of those that are made one by one, in a run with one worker."""
    places: list[int] = []
    one = Work._one

    def noted(self: Work, place: int) -> Any:
        places.append(place)
        return one(self, place)

    monkeypatch.setattr(Work, "_one", noted)
    return places


def made(folder: Path, emitters: str) -> tuple[dict[str, bytes], dict[str, list[str]]]:
    """The URDFs of a run, and the notices of each manipulator."""
    run_file = folder / "run.yaml"
    run_file.write_text(
        f"inputs: ['inputs/*.urdf']\nemitters: {emitters}\noutput: out\nreport: {{html: false}}\n"
        "execution: {options: {workers: 1}}\nsample: {first: 0}\n"
    )
    report = dh2urdf.run(run_file)
    files = {path.name: path.read_bytes() for path in (folder / "out").glob("arm_??.urdf")}
    return files, {row["name"]: [str(notice) for notice in row["notices"]] for row in report["manipulators"]}


def test_they_are_what_they_are_by_themselves(inputs: Path, by_themselves: list[int]) -> None:
    """The same bytes and the same notices, each with its own file; none is made by itself."""
    together, notices = made(inputs, "[urdf]")
    assert by_themselves == []
    alone, others = made(inputs, "[urdf, xacro]")  # xacro is made one by one
    assert len(by_themselves) == ARMS
    assert together == alone
    assert len(together) == ARMS
    assert notices == others
    for name, told in notices.items():
        [of_the_reader] = [notice for notice in told if "tip is within" in notice]
        assert f"{name}.urdf" in of_the_reader


MANY = """
inputs: {path: arms.csv, options: {convention: standard}}
emitters: [urdf]
report: {html: false}
execution: {options: {workers: 1}}
variations:
  - {of: arm, name: long, count: 5, vary: [{joints: one, field: a, uniform: [0.2, 0.4]}]}
  - {of: arm, name: heavy, count: 5, vary: [{joints: one, field: mass, uniform: [1, 2]}]}
  - {of: arm, name: sliding, count: 5, vary: [{joints: two, field: type, choices: [revolute, prismatic]}]}
"""


def test_rows_that_are_not_read_change_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Index and table are the same of the lines of the manifest and of what workers send beside these."""
    rows = ["bad,one,x,0,0.1", "arm,one,0.3,0,0.1", "arm,two,0.2,0,0.1", *[f"arm_{d},one,0.3,0,0.{d}" for d in "123"]]
    (tmp_path / "arms.csv").write_text("robot,joint,a,alpha,d\n" + "\n".join(rows) + "\n")
    (tmp_path / "run.yaml").write_text(MANY)
    add = ManifestWriter.add
    told: list[ManifestRow] = []

    def of_lines(self: ManifestWriter, report: BatchReport) -> None:
        told.extend(report.told)
        rows = [orjson.loads(line) for line in report.rows.splitlines()]
        add(self, replace(report, told=rows, table=table_rows(rows)))

    dh2urdf.run(tmp_path / "run.yaml", tmp_path / "some", settings={"output.layout": "shards"})
    monkeypatch.setattr(ManifestWriter, "add", of_lines)
    dh2urdf.run(tmp_path / "run.yaml", tmp_path / "all", settings={"output.layout": "shards"})
    assert [row["name"] for row in told] == ["bad"]
    for name in ("index.json", "manifest.parquet"):
        assert (tmp_path / "some" / name).read_bytes() == (tmp_path / "all" / name).read_bytes()


LIMITED = """# convention: standard
joint, a, alpha, d, lower, upper
one, 0.4, 0, 0.1, -1, 1
two, 0.3, pi/2, 0, -2, 2
three, 0.2, 0, 0.1, -2, 2
"""
VARIATIONS = """
variations:
  of: arm
  count: 60
  seed: 4
  vary:
    - {joints: all, field: d, uniform: [0.05, 0.3]}
    - {joints: two, field: upper, uniform: [-1.9, 2]}
"""
EDITS = """
edits:
  - {stage: payload, options: {mass: 2, radius: 0.05}}
  - {stage: limits, options: {margin: 0.2, effort: 0.5, joints: [two]}}
  - {stage: rename, options: {prefix: my_}}
  - {stage: mount, options: {name: camera, parent: flange, xyz: [0.1, 0, 0], rpy: [0, pi/3, 0], optical: true}}
  - {stage: rename, options: {pattern: none, replacement: one}}
"""


def test_edited_arms_are_what_they_are_by_themselves(tmp_path: Path, by_themselves: list[int]) -> None:
    """The same rows and bytes; those whose range is too narrow for the margin fail alone, with the edit's message."""
    (tmp_path / "arm.csv").write_text(LIMITED)
    found = []
    for emitters in ("[urdf]", "[urdf, xacro]"):
        run_file = tmp_path / "run.yaml"
        run_file.write_text(
            f"inputs: arm.csv\nemitters: {emitters}\noutput: out\nreport: {{html: false}}\n"
            f"execution: {{options: {{workers: 1}}}}\nsample: {{first: 0}}\n{VARIATIONS}{EDITS}"
        )
        by_themselves.clear()
        rows = dh2urdf.run(run_file)["manipulators"]
        failed = [number for number, row in enumerate(rows) if row["status"] == "failed"]
        if emitters == "[urdf]":
            assert 0 < len(failed) < 20
            assert len(by_themselves) == len(failed)  # They are looked at again, to say why.
        files = {row["name"]: (tmp_path / "out" / f"{row['name']}.urdf").read_bytes() for row in rows if row["files"]}
        told = {row["name"]: [*map(str, row["notices"]), *map(str, row["errors"])] for row in rows}
        proofs = {row["name"]: row["proof"].get("urdf") is not None for row in rows}
        found.append((files, told, proofs))
    assert len(by_themselves) == 61
    assert found[0] == found[1]
    assert all("nothing is left of the range" in told[-1] for told in [found[0][1][rows[n]["name"]] for n in failed])
    assert sum("changes no name" in str(each) for each in found[0][1].values()) == 61 - len(failed)
