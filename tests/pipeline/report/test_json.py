import io
import json
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import Any

from dh2urdf.conversion.outcome import Outcome, to_line
from dh2urdf.output.store import open_store
from dh2urdf.report.manifest import REPORTED, ManifestWriter, run_report, write_timing
from dh2urdf.results import ManipulatorEntry
from dh2urdf.tasks.batch_report import BatchReport, Result


def row(name: str, status: Any = "ok", **facts: Any) -> ManipulatorEntry:
    plain: Any = Outcome(name=name, status=status, source="arm.csv").row("00ff", [])
    told: ManipulatorEntry = {**plain, **facts}
    return told


TOLD: Any = {"command": "dh2urdf run arm.yaml"}


def manifest(rows: Iterable[ManipulatorEntry]) -> ManifestWriter:
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


def test_the_report_of_a_long_run_is_cut() -> None:
    """It has the first thousand rows and says how many are left out: the manifest has all of them."""
    rows = manifest([row(f"arm{number}") for number in range(REPORTED + 7)])
    rows.rows.seek(500)  # wherever its writer left it
    report = run_report(rows, result(batch(ok=REPORTED + 7)))
    assert [entry["name"] for entry in report["manipulators"]] == [f"arm{number}" for number in range(REPORTED)]
    assert report["left_out"] == 7


def timing(folder: Path, found: Result) -> dict[str, Any]:
    write_timing(open_store(folder), found)
    return dict(json.loads((folder / "timing.json").read_bytes()))


def test_durations_are_added_up(tmp_path: Path) -> None:
    """Those of the steps over all batches; those of single manipulators as far as they are known; a rate of all."""
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
