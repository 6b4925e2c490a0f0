"""The files that tell of a run: its report, the index of its failures, the manifest as a table, and its durations.

All that a run found stands in its manifest, and no duration: a repeated run writes the same bytes. Durations stand in
`timing.json`.
"""

from __future__ import annotations

from itertools import islice
from typing import TYPE_CHECKING, Any, BinaryIO

import orjson

from dh2urdf import __version__
from dh2urdf.manifest import Index, can_write_parquet, write_parquet
from dh2urdf.outcome import to_text
from dh2urdf.output import reporting_os_errors

if TYPE_CHECKING:
    from dh2urdf.runs import Result
    from dh2urdf.stores import Store

SCHEMA = "dh2urdf-report/1"
"""Name and version of the form of `report.json`."""
REPORTED = 1000
"""Manipulators that the report repeats from the manifest [1]: the first ones; `timing.json` tells of as many."""


def run_report(rows: BinaryIO, result: Result) -> dict[str, Any]:
    """The report of a run as plain data."""
    rows.seek(0)
    count = sum(result.statuses.values())
    return {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": result.exit_status,
        "manipulators": [orjson.loads(row) for row in islice(rows, REPORTED)],
        "left_out": max(0, count - REPORTED),
    }


def timing(result: Result) -> dict[str, Any]:
    """How long a run and its steps took, added up over all its workers [s]."""
    steps = dict(result.seconds)
    total = steps.pop("total", 0.0)
    rate = result.made / total if total else None
    return {"total": total, "per_second": rate, "steps": steps, "manipulators": result.timings[:REPORTED]}


def write_reports(store: Store, rows: BinaryIO, result: Result) -> dict[str, Any]:
    """Write `report.json`, `index.json` and, with pyarrow, `manifest.parquet`, from the rows of the manifest.

    Returns:
        The report as plain data.

    Raises:
        OutputError: they cannot be written.
    """
    index = Index()
    rows.seek(0)
    for row in rows:
        index.add_line(row)
    store.write("index.json", to_text(index.as_json()))
    report = run_report(rows, result)
    store.write("report.json", to_text(report))
    if can_write_parquet():
        with store.scratch() as folder:
            with reporting_os_errors(f"{store}/manifest.parquet"):
                write_parquet(rows, folder / "manifest.parquet")
            store.put("manifest.parquet", folder / "manifest.parquet")
    return report


def write_timing(store: Store, result: Result) -> None:
    """Write `timing.json`.

    Raises:
        OutputError: it cannot be written.
    """
    store.write("timing.json", to_text(timing(result)))
