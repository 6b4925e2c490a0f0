"""The table at the end of a run."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from rich.table import Table

    from dh2urdf.run import Outcome

MOST_ROWS = 40
"""Rows that a summary shows [1]; of a longer run it shows the failures first and counts the rest."""

NAME_WIDTH = 48
"""Characters of a name in one line [1]; a longer one is folded."""


def print_summary(outcomes: Sequence[Outcome], directory: Path, *, dry_run: bool) -> None:
    """Print what became of each manipulator, with the largest error of every file and simulator."""
    from rich.console import Console

    console = Console(highlight=False)
    if not console.is_terminal:
        console = Console(highlight=False, width=140)
    if any(outcome.written for outcome in outcomes):
        console.print("largest distance of tool0 from the DH product, in metres:")
    console.print(_table(outcomes))
    if len(outcomes) > MOST_ROWS:
        console.print(f"and {len(outcomes) - MOST_ROWS} more manipulators")
    counts = [
        f"{count} {word}"
        for word in ("ok", "failed", "skipped")
        if (count := sum(outcome.status == word for outcome in outcomes))
    ]
    console.print(f"{', '.join(counts)}{' (dry run: nothing was written)' if dry_run else ''}")
    if any(not outcome.keeps_kinematics for outcome in outcomes):
        console.print("the transform does not keep the kinematics: differences are reported and fail nothing")
    if not dry_run:
        console.print(f"written to {directory}", markup=False, soft_wrap=True)


def _table(outcomes: Sequence[Outcome]) -> Table:
    from rich.table import Table

    emitters = list(dict.fromkeys(written.stage for outcome in outcomes for written in outcome.written))
    loaders = list(dict.fromkeys(name for outcome in outcomes for name in outcome.loads))
    table = Table()
    table.add_column("manipulator", overflow="fold", max_width=NAME_WIDTH)
    table.add_column("status")
    for name in (*emitters, *loaders):
        table.add_column(name, justify="right")
    if loaders:
        table.add_column("holds still")
    table.add_column("files", overflow="fold")
    for outcome in sorted(outcomes, key=lambda outcome: outcome.status != "failed")[:MOST_ROWS]:
        errors: dict[str, float | None] = {
            written.stage: written.proof.position_error for written in outcome.written if written.proof
        }
        errors |= {name: report.position_error for name, report in outcome.loads.items()}
        cells = [_metres(errors.get(name)) for name in (*emitters, *loaders)]
        if loaders:
            cells.append(_holds(outcome))
        files = [file.name for written in outcome.written for file in written.files]
        files += [report.picture for report in outcome.loads.values() if report.picture]
        colour = {"ok": "green", "failed": "red", "skipped": "yellow"}[outcome.status]
        table.add_row(_plain(outcome.name), f"[{colour}]{outcome.status}[/]", *cells, _plain(", ".join(files)))
    return table


def _metres(error: float | None) -> str:
    if error is None:
        return "–"
    return f"{error:.1e}" if error else "0"


def _holds(outcome: Outcome) -> str:
    stays = [report.hold.get("stayed") for report in outcome.loads.values() if report.hold]
    return "–" if not stays else "yes" if all(stays) else "no"


def _plain(text: str) -> str:
    """A text from a table, with nothing in it that a terminal or rich would act on."""
    from rich.markup import escape

    return escape("".join(c if c.isprintable() else "�" for c in text))
