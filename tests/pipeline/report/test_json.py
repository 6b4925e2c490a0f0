from __future__ import annotations

import json
import math
import os
from typing import TYPE_CHECKING

import pytest

from dh2urdf.report.json import exit_status, run_report, timing, to_text
from dh2urdf.run import Outcome
from dh2urdf.source import Mark, Problem

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path
    from subprocess import CompletedProcess

DONE = Outcome(name="good", status="ok", source="a.csv", seconds={"transform": 0.25})
FAILED = Outcome(
    name="bad",
    status="failed",
    source="a.csv",
    errors=(Problem(message="no", mark=Mark(file="a.csv", line=2)),),
    seconds={"transform": 0.5},
)


def test_the_status_is_that_of_the_worst_manipulator() -> None:
    """A run in which one manipulator failed ends with 1; one in which none did, or that only looked, with 0."""
    looked = Outcome(name="x", status="skipped", source="a.csv")
    assert exit_status([DONE, looked]) == 0
    assert exit_status([DONE, FAILED]) == 1


def test_a_report_holds_no_duration() -> None:
    """A repeated run writes the same report: how long it took stands in timing.json alone."""
    assert "0.25" not in str(run_report([DONE, FAILED]))
    assert timing([DONE, FAILED], 2.0)["manipulators"] == [
        {"name": "good", "transform": 0.25},
        {"name": "bad", "transform": 0.5},
    ]


def test_a_report_has_the_fields_that_scripts_ask_for() -> None:
    """The report has the form that the documentation promises."""
    report = run_report([DONE, FAILED])
    assert set(report) == {"schema", "version", "exit_status", "manipulators"}
    for manipulator in report["manipulators"]:
        assert {"name", "status", "source", "files", "proof", "loaders", "notices", "errors"} <= set(manipulator)
    (error,) = report["manipulators"][1]["errors"]
    assert set(error) == {"file", "line", "column", "joint", "field", "found", "accepted", "message"}


def test_any_text_and_any_number_can_be_written() -> None:
    """Lone surrogates are spelled out, what is no finite number is null, and the file is UTF-8 JSON."""
    written = to_text({"a\udcff.csv": ["é", "\ud800", {"x": (1.5, "\udc80")}], "nan": math.nan, "inf": math.inf})
    assert written.endswith(b"\n")
    assert json.loads(written.decode("utf-8")) == {
        "a\\udcff.csv": ["é", "\\ud800", {"x": [1.5, "\\udc80"]}],
        "nan": None,
        "inf": None,
    }


def test_a_table_whose_file_name_is_no_utf_8(dh2urdf: Callable[..., CompletedProcess[str]], tmp_path: Path) -> None:
    """A file name in another encoding is no reason to lose the report of a run."""
    try:
        (tmp_path / os.fsdecode(b"arm\xff.csv")).write_text("# convention: standard\nrobot,a,alpha,d\narm,1,0,0\n")
    except OSError:
        pytest.skip("the file system takes UTF-8 names only")
    (tmp_path / "run.yaml").write_text('inputs: "*.csv"\nemitters: [urdf]\noutput: {directory: out}\n')
    dh2urdf("run", "run.yaml")
    (arm,) = json.loads((tmp_path / "out" / "report.json").read_bytes())["manipulators"]
    assert (arm["name"], arm["source"]) == ("arm", "arm\\udcff.csv")


def test_what_cannot_be_read_is_said_once(dh2urdf: Callable[..., CompletedProcess[str]], tmp_path: Path) -> None:
    """A run of one bad table prints each problem once; beside a good table it is a failed manipulator."""
    (tmp_path / "bad.csv").write_text("# convention: standard\na,alpha,d\none,0,0\n")
    (tmp_path / "run.yaml").write_text('inputs: "*.csv"\nemitters: [urdf]\noutput: {directory: out}\n')
    assert dh2urdf("run", "run.yaml", status=2).stderr.count("bad.csv:3:1: error") == 1
    (tmp_path / "good.csv").write_text("# convention: standard\na,alpha,d\n1,0,0\n")
    assert dh2urdf("run", "run.yaml", status=1).stderr.count("bad.csv:3:1: error") == 1
