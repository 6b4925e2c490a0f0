from __future__ import annotations

import io
import json
from collections import Counter
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf import __version__
from dh2urdf.conversion.outcome import Outcome, to_line, to_text
from dh2urdf.output.store import open_store
from dh2urdf.report.manifest import REPORTED, SCHEMA, ManifestWriter, run_report, write_reports, write_timing
from dh2urdf.tasks.batch_report import BatchReport
from dh2urdf.tasks.manifest_table import ManifestTable, table_rows
from dh2urdf.tasks.result import Result

if TYPE_CHECKING:
    from collections.abc import Iterable
    from pathlib import Path

    from dh2urdf.results import ManipulatorEntry


def row(name: str, status: Any = "ok", **facts: Any) -> ManipulatorEntry:
    plain: Any = Outcome(name=name, status=status, source="arm.csv").row("00ff", [])
    told: ManipulatorEntry = {**plain, **facts}
    return told


TOLD: Any = {"command": "dh2urdf run arm.yaml"}
ARM = row("arm")
BAD = row("bad", "failed", kind="table", errors=[{"message": "'x' is no number", "line": 3}])


def written_manifest(folder: Path, rows: Iterable[dict[str, Any]], *, with_table: bool = True) -> ManifestWriter:
    """What was gathered from some rows."""
    made = ManifestWriter((folder / "rows").open("w+b"), "manifest.jsonl", TOLD)
    if with_table:
        made.table = ManifestTable(folder / "table", f"{folder}/manifest.parquet")
    every: Any = list(rows)
    lines, statuses = b"".join(map(to_line, every)), Counter(row["status"] for row in every)
    made.add(
        BatchReport(first=0, rows=lines, statuses=statuses, kinds=Counter(), told=tuple(every), table=table_rows(every))
    )
    return made


def manifest(rows: Iterable[dict[str, Any]]) -> ManifestWriter:
    found = ManifestWriter(io.BytesIO(), "manifest.jsonl", TOLD)
    found.rows.write(b"".join(map(to_line, rows)))
    return found


def result(*reports: BatchReport) -> Result:
    found = Result()
    for report in reports:
        found.add(report)
    return found


def batch(**statuses: int) -> BatchReport:
    return BatchReport(first=0, rows=b"", statuses=Counter(statuses), kinds=Counter())


def test_a_run_has_schema_version_status_and_manipulators() -> None:
    """The whole has the form that is promised, in the order of the run, and the rows are those of the manifest."""
    report = run_report(manifest([ARM, BAD]), result(batch(ok=1, failed=1)))
    assert report == {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": 1,
        "reproduction": TOLD,
        "coverage": {},
        "simulator_notices": [],
        "manipulators": [ARM, BAD],
        "left_out": 0,
        "axes": [],
    }


def test_the_report_of_a_long_run_is_cut() -> None:
    """It has the first thousand rows and says how many are left out: the manifest has all of them."""
    rows = manifest([row(f"arm{number}") for number in range(REPORTED + 7)])
    rows.rows.seek(500)  # wherever its writer left it
    report = run_report(rows, result(batch(ok=REPORTED + 7)))
    assert [entry["name"] for entry in report["manipulators"]] == [f"arm{number}" for number in range(REPORTED)]
    assert report["left_out"] == 7


def test_the_exit_status() -> None:
    """1 as soon as one manipulator failed; one that a dry run skipped, or that is kept, has not."""
    assert result(batch(ok=1), batch(skipped=1), batch(kept=9)).exit_status == 0
    assert result(batch(ok=1), batch(kept=9, failed=1)).exit_status == 1


def timing(folder: Path, found: Result) -> dict[str, Any]:
    write_timing(open_store(folder), found)
    return dict(json.loads((folder / "timing.json").read_bytes()))


def test_durations_are_added_up(tmp_path: Path) -> None:
    """Those of the steps over all batches; those of single manipulators as far as they are told; a rate of all."""
    timings = ({"name": "a", "transform": 0.4}, {"name": "b", "transform": 0.6})
    found = result(
        replace(batch(ok=2), seconds={"transform": 1.0, "write": 0.5}, timings=timings),
        replace(batch(failed=1), kinds=Counter(table=1), seconds={"write": 1.0, "emit": 2.0}),
    )
    found.seconds["total"] = 1.5
    assert timing(tmp_path, found) == {
        "total": 1.5,
        "per_second": 2.0,
        "steps": {"transform": 1.0, "write": 1.5, "emit": 2.0},
        "manipulators": list(timings),
    }
    assert (found.statuses, found.kinds) == (Counter(ok=2, failed=1), Counter(table=1))
    assert timing(tmp_path, result(batch(ok=1)))["per_second"] is None


def test_all_files_are_written_whole(tmp_path: Path) -> None:
    """report.json, index.json and, with pyarrow, the manifest as a table; no temporary file."""
    pytest.importorskip("pyarrow")
    from pyarrow import parquet

    store, gathered = open_store(tmp_path / "out"), written_manifest(tmp_path, [ARM, BAD])
    found = result(batch(ok=1, failed=1))
    report = write_reports(store, gathered, found)
    found.seconds["total"] = 2.0
    write_timing(store, found)
    out = tmp_path / "out"
    written = {path.name for path in out.iterdir()} - {".dh2urdf"}
    assert written == {"report.json", "index.json", "manifest.parquet", "timing.json"}
    assert [path for path in (out / ".dh2urdf").rglob("*") if path.is_file()] == []
    assert (out / "report.json").read_bytes() == to_text(report) == to_text(run_report(gathered, found))
    index = json.loads((out / "index.json").read_bytes())
    assert (index["manipulators"], index["failures"]["table"]["names"]) == (2, ["bad"])
    assert parquet.read_table(out / "manifest.parquet")["name"].to_pylist() == ["arm", "bad"]
    assert json.loads((out / "timing.json").read_bytes())["per_second"] == 1.0


def test_where_there_is_no_table_none_is_written(tmp_path: Path) -> None:
    """pyarrow is an extra, and nobody is told of what is not installed."""
    out = tmp_path / "out"
    write_reports(open_store(out), written_manifest(tmp_path, [ARM], with_table=False), result(batch(ok=1)))
    assert {path.name for path in out.iterdir()} - {".dh2urdf"} == {"report.json", "index.json"}
