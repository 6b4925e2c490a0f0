"""The table at the end of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.cli.answers import answers
from dh2urdf.report.verdicts import coverage_line, notice_line
from dh2urdf.source import printable

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rich.table import Table

    from dh2urdf.results import LoadEntry, ManipulatorEntry, ProofEntry, RunReport
    from dh2urdf.tasks.result import Result

MOST_ROWS = 40
"""Rows that a summary shows; of a longer run it shows the failures first and counts the rest."""

MOST_NOTICES = 20
"""Notices of simulators that a summary shows, each with the number of manipulators that it is about."""

MANY = 100
"""Manipulators from which on a run reports how many it made per second."""

NAME_WIDTH = 48
"""Characters of a name in one line; a longer one is folded."""


def print_summary(result: Result, report: RunReport, where: str, reports: str, *, dry_run: bool) -> None:
    """Print what became of each manipulator, with the largest error of every file and simulator, and the counts.

    Args:
        result: what became of the run.
        report: its report.
        where: where its output is.
        reports: where its report is.
        dry_run: whether nothing was written.
    """
    from rich.console import Console

    console = Console(file=answers(), highlight=False)
    if not console.is_terminal:
        console = Console(file=answers(), highlight=False, width=140)
    rows = report["manipulators"]
    if any(row["files"] for row in rows):
        console.print("largest distance of tool0 from the DH product, in metres:")
    console.print(_table(rows))
    count = sum(result.statuses.values())
    if (more := count - min(len(rows), MOST_ROWS)) > 0:
        console.print(f"and {more:,} more manipulators")
    words = {"ok": "made", "kept": "unchanged", "skipped": "skipped", "failed": "failed"}
    counts = [f"{result.statuses[status]:,} {word}" for status, word in words.items() if result.statuses[status]]
    kinds = ", ".join(f"{kind}: {number:,}" for kind, number in result.kinds.most_common())
    seconds = result.seconds["total"]
    rate = f"; {result.made / seconds:,.0f} per second" if result.made >= MANY and seconds else ""
    what = f"{', '.join(counts)}{f' ({kinds})' if kinds else ''}{rate}"
    console.print(f"{what}{' (dry run: nothing was written)' if dry_run else ''}", markup=False)
    if not result.keeps_kinematics:
        console.print("the transform does not keep the kinematics: differences are reported and fail nothing")
    if not dry_run and report["coverage"]:
        console.print(f"simulators: {coverage_line(report['coverage'])}", markup=False)
        notices = report["simulator_notices"]
        for notice in notices[:MOST_NOTICES]:
            console.print(f"- {printable(notice_line(notice))}", markup=False, soft_wrap=True)
        if (more := len(notices) - MOST_NOTICES) > 0:
            console.print(f"and {more:,} more notices of simulators: report.json has all of them")
    if told := result.leftovers.told:
        console.print(told)
    if not dry_run:
        beside = "" if reports == where else f", report and manifest to {reports}"
        console.print(f"written to {where}{beside}", markup=False, soft_wrap=True)


def _table(rows: Sequence[ManipulatorEntry]) -> Table:
    from rich.table import Table

    emitters = list(dict.fromkeys(stage for row in rows for stage in row["proof"]))
    loaders = list(dict.fromkeys(name for row in rows for name in row["loaders"]))
    table = Table()
    table.add_column("manipulator", overflow="fold", max_width=NAME_WIDTH)
    table.add_column("status")
    for name in (*emitters, *loaders):
        table.add_column(name, justify="right")
    if loaders:
        table.add_column("holds still")
    table.add_column("files", overflow="fold")
    for row in sorted(rows, key=lambda row: row["status"] != "failed")[:MOST_ROWS]:
        asked = {**row["proof"], **row["loaders"]}
        cells = [_asked(asked.get(name)) for name in (*emitters, *loaders)]
        if loaders:
            cells.append(_holds(row))
        files = _main_files(row)
        files += [report["picture"] for report in row["loaders"].values() if report["picture"]]
        colour = {"ok": "green", "failed": "red", "skipped": "yellow"}[row["status"]]
        table.add_row(_plain(row["name"]), f"[{colour}]{row['status']}[/]", *cells, _plain(", ".join(files)))
    return table


def _main_files(row: ManipulatorEntry) -> list[str]:
    """The main file of each emitter, and those beside it: an emitter may write whole folders of files."""
    folders: dict[str, str] = {}
    return [
        file["path"]
        for file in row["files"]
        if folders.setdefault(file["stage"], file["path"].rpartition("/")[0]) == file["path"].rpartition("/")[0]
    ]


def _asked(facts: ProofEntry | LoadEntry | None) -> str:
    verdict = facts.get("verdict", "passed") if facts else None
    if verdict in {"failed", "missing"}:
        return str(verdict)
    error = facts["position_error"] if facts else None
    if error is None:
        return "–"
    return f"{error:.1e}" if error else "0"


def _holds(row: ManipulatorEntry) -> str:
    stays = [report["hold"].get("stayed") for report in row["loaders"].values() if report["hold"]]
    return "–" if not stays else "yes" if all(stays) else "no"


def _plain(text: str) -> str:
    """A text from a table, with nothing in it that a terminal or rich would act on."""
    from rich.markup import escape

    return escape("".join(c if c.isprintable() else "�" for c in text))
