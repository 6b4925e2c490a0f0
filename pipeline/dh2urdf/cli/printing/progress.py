"""What a run says while it works: a bar on a terminal, a line now and then in a log, and what is noticed and fails.

A screenful of notices and of errors is printed and the rest counted: a run may hold a million manipulators.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from contextlib import contextmanager
from datetime import timedelta
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.errors import SCREENFUL
from dh2urdf.source import printable
from dh2urdf.tasks.batch_report import is_new

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.running.run import Note
    from dh2urdf.source import Problem
    from dh2urdf.tasks.batch_report import BatchReport

LINE_EVERY = 10.0
"""Time between two lines in a log [s]."""


@contextmanager
def progress(*, quiet: bool, debug: bool) -> Iterator[Note]:
    """Says on standard error how a run goes.

    Args:
        quiet: say only what fails.
        debug: say where stages failed.
    """
    shown = _Progress(quiet=quiet, debug=debug)
    try:
        yield shown.note
    finally:
        shown.close()


class _Progress:
    def __init__(self, *, quiet: bool, debug: bool) -> None:
        self._quiet, self._debug = quiet, debug
        self._severities = ("error",) if quiet else ("notice", "error")
        self._bar = _bar() if sys.stderr.isatty() and not quiet else None
        self._told: set[Problem] = set()
        self._found, self._printed = Counter[str](), Counter[str]()
        self._started = self._last = time.monotonic()
        self._made = self._failed = 0

    def note(self, report: BatchReport, total: int | None) -> None:
        """Takes what became of a batch."""
        self._made += report.count
        self._failed += report.statuses["failed"]
        self._found.update(report.severities)
        for problem in report.problems:
            severity = problem.severity
            if severity in self._severities and self._printed[severity] < SCREENFUL and is_new(problem, self._told):
                self._printed[severity] += 1
                self._say("\n".join(map(printable, str(problem).splitlines())))
        for traceback in report.tracebacks if self._debug else ():
            self._say(traceback)
        now = time.monotonic()
        if self._bar is not None or (not self._quiet and now - self._last >= LINE_EVERY):
            self._last = now
            self._show(total, self._made / max(now - self._started, 1e-9))

    def close(self) -> None:
        """Says how much was left unsaid."""
        if self._bar is not None:
            self._bar.stop()
            self._bar = None
        for severity in self._severities:
            if (more := self._found[severity] - self._printed[severity]) > 0:
                self._say(f"and {more:,} more {severity}{'s' if more > 1 else ''}: the manifest has all of them")

    def _show(self, total: int | None, rate: float) -> None:
        left = f"{timedelta(seconds=round(max(0, total - self._made) / rate))} left" if total and rate else ""
        if self._bar is not None:
            failed = f"{self._failed:,} failed" if self._failed else ""
            fields = {"rate": f"{rate:,.0f}/s", "left": left, "failed": failed}
            self._bar.update(self._bar.task_ids[0], completed=self._made, total=total, **fields)
            return
        of = f" of about {total:,}" if total else ""
        pace = ", ".join(filter(None, (f"{rate:,.0f}/s", left)))
        self._say(f"{self._made:,}{of} manipulators, {self._failed:,} failed, {pace}")

    def _say(self, text: str) -> None:
        if self._bar is None:
            click.echo(text, err=True)
        else:  # above the bar
            self._bar.console.print(text, soft_wrap=True, highlight=False, markup=False)


def _bar() -> Any:  # noqa: ANN401 - rich.progress.Progress, whose import takes a tenth of a short run
    """A bar with the rate, the time that remains and the failures."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    # The bar's own column of the time forgets its speed whenever the total changes, which it does with every batch.
    styles = {"rate": "none", "left": "cyan", "failed": "red"}
    texts = [TextColumn(f"{{task.fields[{name}]}}", style=style) for name, style in styles.items()]
    columns = (TextColumn("manipulators"), BarColumn(), MofNCompleteColumn(), *texts)
    bar = Progress(*columns, console=Console(stderr=True), transient=True)
    bar.start()
    bar.add_task("", total=None, rate="", left="", failed="")
    return bar
