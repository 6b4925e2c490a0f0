"""The files about a run: its report, the index of its failures, the manifest as a table, and its durations.

All that a run found is in its manifest, and no duration: a repeated run writes the same bytes. Durations are in
`timing.json`.
"""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING, Any, Final

import orjson

from dh2urdf._version import __version__
from dh2urdf.conversion.outcome import to_text
from dh2urdf.output.whole_files import reporting_os_errors
from dh2urdf.report.manifest_writer import REPORTED

if TYPE_CHECKING:
    from dh2urdf.output.store import Store
    from dh2urdf.report.manifest_writer import ManifestWriter
    from dh2urdf.results import RunReport
    from dh2urdf.tasks.result import Result

SCHEMA: Final = "dh2urdf-report/1"
"""Name and version of the form of `report.json`."""
INDEX, REPORT, TIMING = "index.json", "report.json", "timing.json"
TABLE = "manifest.parquet"
"""The manifest as a table."""


def run_report(manifest: ManifestWriter, result: Result) -> RunReport:
    """The report of a run as plain data."""
    manifest.rows.seek(0)
    count = sum(result.statuses.values())
    return {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": result.exit_status,
        "reproduction": manifest.reproduction,
        "coverage": manifest.verdicts.coverage(),
        "simulator_notices": manifest.verdicts.notices(),
        "manipulators": [orjson.loads(row) for row in islice(manifest.rows, REPORTED)],
        "left_out": max(0, count - REPORTED),
        "axes": manifest.axes.entries,
    }


def timing(result: Result) -> dict[str, Any]:
    """How long a run and its steps took, added up over all its workers [s]."""
    steps = dict(result.seconds)
    total = steps.pop("total", 0.0)
    rate = result.made / total if total else None
    return {"total": total, "per_second": rate, "steps": steps, "manipulators": result.timings[:REPORTED]}


def write_reports(store: Store, manifest: ManifestWriter, result: Result) -> RunReport:
    """Write `index.json`, `report.json` and, where the manifest has one, `manifest.parquet`.

    Returns:
        The report as plain data.

    Raises:
        OutputError: they cannot be written.
    """
    store.write(INDEX, to_text(manifest.index.as_json()))
    report = run_report(manifest, result)
    store.write(REPORT, to_text(report))
    if manifest.table:
        with reporting_os_errors(manifest.table.place):
            manifest.table.finish(manifest.rows)
        store.put(TABLE, manifest.table.path)
    else:
        store.remove(TABLE)  # An older one would describe another run.
    return report


def write_timing(store: Store, result: Result) -> None:
    """Write `timing.json`.

    Raises:
        OutputError: it cannot be written.
    """
    store.write(TIMING, to_text(timing(result)))
