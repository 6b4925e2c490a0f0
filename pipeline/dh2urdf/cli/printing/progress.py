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
    severities = ("error",) if quiet else ("notice", "error")
    bar = None if quiet or not sys.stderr.isatty() else _bar()
    told: set[Problem] = set()
    found, printed = Counter[str](), Counter[str]()
    started = last = time.monotonic()
    made = failed = 0

    def say(text: str) -> None:
        if bar is None:
            click.echo(text, err=True)
        else:  # above the bar
            bar.console.print(text, soft_wrap=True, highlight=False, markup=False)

    def note(report: BatchReport, total: int | None) -> None:
        nonlocal last, made, failed
        made += report.count
        failed += report.statuses["failed"]
        found.update(report.severities)
        for problem in report.problems:
            severity = problem.severity
            if severity in severities and printed[severity] < SCREENFUL and is_new(problem, told):
                printed[severity] += 1
                say("\n".join(map(printable, str(problem).splitlines())))
        for traceback in report.tracebacks if debug else ():
            say(traceback)
        if bar is None and (quiet or time.monotonic() - last < LINE_EVERY):
            return
        last = time.monotonic()
        rate = made / max(last - started, 1e-9)
        left = f"{timedelta(seconds=round(max(0, total - made) / rate))} left" if total and rate else ""
        if bar is not None:
            many = f"{failed:,} failed" if failed else ""
            bar.update(bar.task_ids[0], completed=made, total=total, rate=f"{rate:,.0f}/s", left=left, failed=many)
            return
        of = f" of about {total:,}" if total else ""
        say(f"{made:,}{of} manipulators, {failed:,} failed, {', '.join(filter(None, (f'{rate:,.0f}/s', left)))}")

    try:
        if bar is not None:
            bar.start()
        yield note
    finally:
        if bar is not None:
            bar.stop()
            bar = None
        for severity in severities:
            if (more := found[severity] - printed[severity]) > 0:
                say(f"and {more:,} more {severity}{'s' if more > 1 else ''}: the manifest has all of them")


def _bar() -> Any:  # noqa: ANN401 - rich.progress.Progress, whose import takes a tenth of a short run
    """A bar with the rate, the time that remains and the failures."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn

    # The bar's own column of the time forgets its speed whenever the total changes, which it does with every batch.
    texts = [TextColumn(f"{{task.fields[{name}]}}", style=style) for name, style in _FIELDS]
    columns = (TextColumn("manipulators"), BarColumn(), MofNCompleteColumn(), *texts)
    bar = Progress(*columns, console=Console(stderr=True), transient=True)
    bar.add_task("", total=None, rate="", left="", failed="")
    return bar


_FIELDS = (("rate", "none"), ("left", "cyan"), ("failed", "red"))
