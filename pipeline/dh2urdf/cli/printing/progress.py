"""What a run says while it works: a bar on a terminal, a line now and then in a log, and what is noticed and fails.

A screenful of notices and of errors is printed and the rest counted: a run may hold a million manipulators.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from contextlib import contextmanager
from functools import cached_property
from typing import TYPE_CHECKING

from dh2urdf.errors import SCREENFUL
from dh2urdf.tasks.batch_report import is_new

if TYPE_CHECKING:
    from collections.abc import Iterator

    from rich.console import Console
    from rich.progress import Progress

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
    if quiet:
        shown = _Silent(debug=debug)
    elif sys.stderr.isatty():
        shown = _Bar(debug=debug)
    else:
        shown = _Lines(debug=debug)
    try:
        yield shown.note
    finally:
        shown.close()


class _Silent:
    """Says what fails."""

    severities: tuple[str, ...] = ("error",)

    def __init__(self, *, debug: bool) -> None:
        self._debug = debug
        self._found: Counter[str] = Counter()
        self._printed: Counter[str] = Counter()
        self._said: set[Problem] = set()
        self.made = 0
        self.failed = 0

    @cached_property
    def console(self) -> Console:
        """Standard error, when there is something to print: the import takes a tenth of a short run."""
        from rich.console import Console

        return Console(stderr=True, soft_wrap=True, highlight=False, markup=False)

    def note(self, report: BatchReport, total: int | None) -> None:
        """Takes what became of a batch."""
        self.made += report.count
        self.failed += report.statuses["failed"]
        for problem in report.problems:
            severity = problem.severity
            if severity in self.severities and self._printed[severity] < SCREENFUL and is_new(problem, self._said):
                self._printed[severity] += 1
                self.console.print(str(problem))
        self._found += report.severities
        for traceback in report.tracebacks if self._debug else ():
            self.console.print(traceback)
        self.show(total)

    def show(self, total: int | None) -> None:
        """Says how far the run has come."""

    def close(self) -> None:
        """Says how much was left unsaid."""
        for severity in self.severities:
            if (more := self._found[severity] - self._printed[severity]) > 0:
                self.console.print(
                    f"and {more:,} more {severity}{'s' if more > 1 else ''}: the manifest has all of them"
                )


class _Lines(_Silent):
    """Says a line now and then."""

    severities = ("notice", "error")

    def __init__(self, *, debug: bool) -> None:
        super().__init__(debug=debug)
        self._started = self._said_last = time.monotonic()

    def show(self, total: int | None) -> None:
        now = time.monotonic()
        if now - self._said_last < LINE_EVERY:
            return
        self._said_last = now
        of = f" of about {total:,}" if total else ""
        pace = filter(None, _pace(self.made, total, now - self._started))
        self.console.print(f"{self.made:,}{of} manipulators, {self.failed:,} failed, {', '.join(pace)}")


class _Bar(_Silent):
    """Shows a bar with the rate, the time that remains and the failures."""

    severities = ("notice", "error")

    def __init__(self, *, debug: bool) -> None:
        super().__init__(debug=debug)
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

        columns = (
            TextColumn("manipulators"),
            BarColumn(),
            MofNCompleteColumn(),
            TextColumn("{task.fields[rate]}"),
            # The bar's own column forgets its speed whenever the total changes, which it does with every batch.
            TextColumn("{task.fields[left]}", style="cyan"),
            TextColumn("{task.fields[failed]}", style="red"),
        )
        self._bar: Progress = Progress(*columns, console=self.console, transient=True)
        self._task = self._bar.add_task("", total=None, rate="", left="", failed="")
        self._started = time.monotonic()
        self._bar.start()

    def show(self, total: int | None) -> None:
        rate, left = _pace(self.made, total, time.monotonic() - self._started)
        failed = f"{self.failed:,} failed" if self.failed else ""
        self._bar.update(self._task, completed=self.made, total=total, rate=rate, left=left, failed=failed)

    def close(self) -> None:
        self._bar.stop()
        super().close()


def _pace(made: int, total: int | None, seconds: float) -> tuple[str, str]:
    """How fast a run goes, and how long it will still take; empty where there is no saying."""
    rate = made / max(seconds, 1e-9)
    left = f"{_duration(max(0, total - made) / rate)} left" if total and rate else ""
    return f"{rate:,.0f}/s", left


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02d}:{rest:02d}" if hours else f"{minutes}:{rest:02d}"
