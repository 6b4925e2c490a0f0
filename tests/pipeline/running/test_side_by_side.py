"""Tables with something to declare about each are made side by side as others are, and their notices are kept."""

from pathlib import Path
from typing import Any

import pytest

import dh2urdf
from dh2urdf.running.batch_work import Work

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
