"""`report.json` and `timing.json`.

All that a run found stands in `report.json`, and no duration: a repeated run writes the same bytes. Durations stand in
`timing.json`.
"""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING, Any

from dh2urdf import __version__
from dh2urdf.output import write_whole

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.conversion import Written
    from dh2urdf.run import Outcome
    from dh2urdf.stages import LoadReport

SCHEMA = "dh2urdf-report/1"
"""Name and version of the form of `report.json`."""


def exit_status(outcomes: Sequence[Outcome]) -> int:
    """0 where all is done, 1 where a manipulator failed."""
    return int(any(outcome.status == "failed" for outcome in outcomes))


def run_report(outcomes: Sequence[Outcome]) -> dict[str, Any]:
    """The report of a run as plain data."""
    return {
        "schema": SCHEMA,
        "version": __version__,
        "exit_status": exit_status(outcomes),
        "manipulators": [_manipulator(outcome) for outcome in outcomes],
    }


def timing(outcomes: Sequence[Outcome], total: float) -> dict[str, Any]:
    """How long a run and each of its steps took [s]."""
    return {
        "total": total,
        "manipulators": [{"name": outcome.name, **outcome.seconds} for outcome in outcomes],
    }


def to_text(data: dict[str, Any]) -> bytes:
    """Plain data as indented JSON with a newline at its end."""
    import orjson

    options = orjson.OPT_INDENT_2 | orjson.OPT_APPEND_NEWLINE | orjson.OPT_NON_STR_KEYS
    try:
        return orjson.dumps(data, option=options)
    except orjson.JSONEncodeError:
        return orjson.dumps(_in_utf_8(data), option=options)


def _in_utf_8(value: Any) -> Any:  # noqa: ANN401 - plain data
    """The same data, lone surrogates spelled out: the name of a file may hold bytes that are no UTF-8."""
    if isinstance(value, str):
        return value.encode("utf-8", "backslashreplace").decode("utf-8")
    if isinstance(value, dict):
        return {_in_utf_8(key): _in_utf_8(entry) for key, entry in value.items()}
    return [_in_utf_8(entry) for entry in value] if isinstance(value, (list, tuple)) else value


def write_reports(directory: Path, outcomes: Sequence[Outcome], total: float) -> None:
    """Write `report.json` and `timing.json` into the output folder.

    Raises:
        OutputError: they cannot be written.
    """
    write_whole(directory / "report.json", to_text(run_report(outcomes)))
    write_whole(directory / "timing.json", to_text(timing(outcomes, total)))


def _manipulator(outcome: Outcome) -> dict[str, Any]:
    return {
        "name": outcome.name,
        "status": outcome.status,
        "source": outcome.source,
        "drawn": outcome.drawn,
        "keeps_kinematics": outcome.keeps_kinematics,
        "files": [
            {"path": file.name, "stage": file.stage, "bytes": file.size, "sha256": file.sha256}
            for written in outcome.written
            for file in written.files
        ],
        "proof": {written.stage: _proof(written) for written in outcome.written},
        "loaders": {name: _load(report) for name, report in outcome.loads.items()},
        "notices": [problem.as_json() for problem in outcome.notices],
        "errors": [problem.as_json() for problem in outcome.errors],
    }


def _proof(written: Written) -> dict[str, Any] | None:
    return asdict(written.proof) if written.proof else None


def _load(report: LoadReport) -> dict[str, Any]:
    return {**asdict(report), "findings": [finding.as_json() for finding in report.findings]}
