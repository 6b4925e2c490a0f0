from __future__ import annotations

import json
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from dh2urdf import __version__
from dh2urdf.conversion import Written, WrittenFile
from dh2urdf.errors import OutputError
from dh2urdf.proof import Proof
from dh2urdf.report.json import SCHEMA, exit_status, run_report, timing, to_text, write_reports
from dh2urdf.run import Outcome
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import LoadReport

if TYPE_CHECKING:
    from pathlib import Path

PROOF = Proof(position_error=1e-16, angle_error=2e-16, q=(0.5, -1.0), tolerance=1e-9, poses=35)
ARM = Outcome(
    name="arm",
    status="ok",
    source="arm.csv",
    written=(
        Written(
            stage="urdf",
            files=(WrittenFile(name="arm.urdf", stage="urdf", size=7, sha256="ab"),),
            proof=PROOF,
        ),
        Written(
            stage="text",
            files=(
                WrittenFile(name="arm.txt", stage="text", size=3, sha256="cd"),
                WrittenFile(name="arm_more.txt", stage="text", size=4, sha256="ef"),
            ),
            proof=None,
        ),
    ),
    loads={
        "paper": LoadReport(
            simulator="Paper",
            version="1",
            mass=2.5,
            findings=(Problem(message="it is flat", severity="notice", joint="turn"),),
        )
    },
    notices=(Problem(message="an ignored column", severity="notice", mark=Mark(file="arm.csv", line=1, column=9)),),
    seconds={"transform": 0.25, "write": 0.5},
)
BAD = Outcome(
    name="bad",
    status="failed",
    source="arm.csv",
    was_read=False,
    errors=(
        Problem(
            message="'x' is no number",
            mark=Mark(file="arm.csv", line=3, column=5),
            joint="elbow",
            field="alpha",
            found="x",
            accepted="a number",
            suggestion="did you mean '0'?",
        ),
    ),
)


def test_a_run_has_schema_version_status_and_manipulators() -> None:
    """The whole has the form that is promised, in the order of the run."""
    report = run_report([ARM, BAD])
    assert {key: report[key] for key in ("schema", "version", "exit_status")} == {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": 1,
    }
    assert [entry["name"] for entry in report["manipulators"]] == ["arm", "bad"]


def test_a_manipulator_has_files_proofs_loaders_and_notices() -> None:
    """Every file with its emitter, size and hash; a proof per emitter, null where there is none; a report per loader."""
    (entry,) = run_report([ARM])["manipulators"]
    assert entry["files"] == [
        {"path": "arm.urdf", "stage": "urdf", "bytes": 7, "sha256": "ab"},
        {"path": "arm.txt", "stage": "text", "bytes": 3, "sha256": "cd"},
        {"path": "arm_more.txt", "stage": "text", "bytes": 4, "sha256": "ef"},
    ]
    assert entry["proof"]["text"] is None
    assert {key: entry["proof"]["urdf"][key] for key in ("position_error", "angle_error", "q")} == {
        "position_error": 1e-16,
        "angle_error": 2e-16,
        "q": (0.5, -1.0),
    }
    assert entry["loaders"]["paper"]["mass"] == 2.5
    assert entry["loaders"]["paper"]["findings"][0]["joint"] == "turn"
    assert [(notice["line"], notice["message"]) for notice in entry["notices"]] == [(1, "an ignored column")]
    assert entry["errors"] == []


def test_an_error_has_its_place_and_its_words() -> None:
    """File, line, column, joint, field, found, accepted and message; a suggestion is part of the message."""
    (entry,) = run_report([BAD])["manipulators"]
    assert entry["errors"] == [
        {
            "file": "arm.csv",
            "line": 3,
            "column": 5,
            "joint": "elbow",
            "field": "alpha",
            "found": "x",
            "accepted": "a number",
            "message": "'x' is no number; did you mean '0'?",
        }
    ]
    assert (entry["status"], entry["files"], entry["proof"], entry["loaders"]) == ("failed", [], {}, {})


def test_durations_stand_in_timing_alone() -> None:
    """The report of a run that took longer is the same; timing has the steps of each manipulator, and the whole."""
    slower = replace(ARM, seconds={"transform": 1.0, "write": 2.0})
    assert to_text(run_report([ARM])) == to_text(run_report([slower]))
    assert timing([slower, BAD], 4.0) == {
        "total": 4.0,
        "manipulators": [{"name": "arm", "transform": 1.0, "write": 2.0}, {"name": "bad"}],
    }


@pytest.mark.parametrize(("statuses", "status"), [(["ok", "ok"], 0), (["ok", "failed"], 1), (["skipped"], 0)])
def test_the_exit_status(statuses: list[str], status: int) -> None:
    """1 as soon as one manipulator failed; one that a dry run skipped has not."""
    assert exit_status([replace(ARM, status=word) for word in statuses]) == status  # type: ignore[arg-type]


def test_the_text_is_indented_json_with_a_line_end() -> None:
    """A person reads it, and so does any JSON parser."""
    text = to_text(run_report([ARM]))
    assert text.endswith(b"}\n")
    assert b'\n      "name": "arm"' in text
    assert json.loads(text)["manipulators"][0]["proof"]["urdf"]["q"] == [0.5, -1.0]


def test_names_that_are_no_unicode_are_spelled_out() -> None:
    """The name of a file may hold bytes that are no UTF-8: they do not keep the report from being written."""
    odd = replace(ARM, name="arm\udcff", source="a\udcff.csv")
    assert json.loads(to_text(run_report([odd])))["manipulators"][0]["name"] == "arm\\udcff"


def test_what_is_no_number_is_null() -> None:
    """JSON has no infinity."""
    broken = replace(ARM, written=(replace(ARM.written[0], proof=replace(PROOF, position_error=float("inf"))),))
    assert json.loads(to_text(run_report([broken])))["manipulators"][0]["proof"]["urdf"]["position_error"] is None


def test_both_files_are_written_whole(tmp_path: Path) -> None:
    """report.json and timing.json, and no temporary file."""
    write_reports(tmp_path / "out", [ARM], 1.5)
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"report.json", "timing.json"}
    assert json.loads((tmp_path / "out" / "timing.json").read_bytes())["total"] == 1.5
    assert (tmp_path / "out" / "report.json").read_bytes() == to_text(run_report([ARM]))


def test_a_folder_that_is_a_file(tmp_path: Path) -> None:
    """It is told in one line."""
    (tmp_path / "out").write_text("")
    with pytest.raises(OutputError, match=r"cannot write '.*out"):
        write_reports(tmp_path / "out", [ARM], 1.5)
