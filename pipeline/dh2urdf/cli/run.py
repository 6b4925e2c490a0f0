"""`dh2urdf run`: everything that a run file says; how it goes, and the table at the end."""

from __future__ import annotations

import sys
import time
from collections import Counter, deque
from contextlib import contextmanager
from datetime import timedelta
from functools import partial
from typing import TYPE_CHECKING, Any

import click
import orjson

from dh2urdf.cli import EXIT_STATUS, SETTLED
from dh2urdf.cli.answers import answer, answers
from dh2urdf.cli.shared_options import PATH, catalog, json_option, quiet_option, set_option, without_option
from dh2urdf.conversion.outcome import to_text
from dh2urdf.errors import SCREENFUL
from dh2urdf.report.conversions import counted
from dh2urdf.report.manifest import HOW_TO_GET, can_write_html
from dh2urdf.report.verdicts import coverage_line, holds_still, notice_line
from dh2urdf.running.run import execute, load_plan
from dh2urdf.source import Messages, Problem, printable, shown
from dh2urdf.tasks.batch_report import add_cause

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from rich.table import Table

    from dh2urdf.results import LoadEntry, ManipulatorEntry, ProofEntry, RunReport
    from dh2urdf.running.run import Note
    from dh2urdf.source import Cause
    from dh2urdf.tasks.batch_report import BatchReport, Result

say = Messages(__file__)

LINE_EVERY = 10.0  # time between two lines in a log [s]
WINDOW = 30.0  # over which the rate is taken [s]; longer where FEWEST batches take longer
FEWEST = 4  # batches between which a rate is taken
ENOUGH = 2.0  # of a window, from which on its rate means something [s]
FAST = 10  # manipulators per second from which on a rate has no decimals
MOST_ROWS = 40  # rows of a summary; of a longer run it shows the failures first and counts the rest
MOST_NOTICES = 20  # notices of simulators in a summary, each with the number of manipulators that it is about
MANY = 100  # manipulators from which on a run reports how many it made per second
NAME_WIDTH = 48  # characters of a name in one line; a longer one is folded


@click.command(name="run", epilog=EXIT_STATUS)
@click.argument("config", type=PATH)
@click.option("-o", "--output", metavar="DIR", help="Where to, not where CONFIG says: a folder or an address.")
@click.option("--workers", metavar="N", help="How many processes work; auto: one per processor.")
@click.option("--resume", is_flag=True, help="Keep what an earlier run has finished and what has not changed since.")
@set_option("Change a value of CONFIG for this run; repeatable.")
@click.option("--keep", is_flag=True, help="Leave the files of the last run into DIR that this one does not write.")
@click.option("--dry-run", is_flag=True, help="Read and check everything, write nothing.")
@click.option("--verbose", "is_whole", is_flag=True, help="Print every notice and error, not one for each cause.")
@json_option("Print the report as JSON in place of the summary.")
@quiet_option
@without_option
def command(
    config: Path, output: str | None, workers: str | None, settings: tuple[str, ...], *, as_json: bool, **flags: bool
) -> int:
    """Do the run that the YAML file CONFIG describes.

    Every manipulator is read, transformed, written, read back and compared with the DH product of its table; the
    loaders then ask the simulators. Beside the files, the output holds report.html and report.json, a manifest with a
    row for each manipulator, an index of the failures, and timing.json. Files that the last run wrote there and this
    one does not are removed at the end, unless they were changed.

    \b
    dh2urdf run configs/ur5.yaml
    dh2urdf run configs/ur5.yaml -o /tmp/ur5 --set transform.options.frames=dh
    dh2urdf run configs/folder.yaml --workers 4 --json > report.json
    dh2urdf run configs/folder.yaml --resume
    """
    overrides = [*settings, *([f"execution.options.workers={workers}"] if workers else [])]
    plan = load_plan(config, catalog(), overrides, output)
    context = click.get_current_context()
    quiet, dry_run = flags["quiet"], flags["dry_run"]
    try:
        debug = context.find_root().params["debug"]
        with progress(quiet=quiet, debug=debug, is_whole=flags["is_whole"]) as note:
            result, report = execute(plan, resume=flags["resume"], dry_run=dry_run, keep=flags["keep"], note=note)
    except KeyboardInterrupt as interrupt:
        if not dry_run:
            interrupt.add_note("`--resume` goes on from there")
        raise
    context.meta[SETTLED] = result.exit_status
    if as_json:
        answer(to_text(report), nl=False)
    elif not quiet:
        print_summary(result, report, str(plan.store), str(plan.report_store), dry_run=dry_run)
        if plan.html and not dry_run and not can_write_html():
            answer(HOW_TO_GET)
    return result.exit_status


# --- While it works ---------------------------------------------------------------------------------------------------


@contextmanager
def progress(*, quiet: bool, debug: bool, is_whole: bool = False) -> Iterator[Note]:
    """Say on standard error how a run goes: a bar on a terminal, a line now and then in a log.

    The first error of each cause is printed as soon as it comes; at the end each cause of notices and errors is a line
    with its first place and how often it came. `is_whole` prints each as it comes instead, and `debug` also where
    stages failed.
    """
    causes = Causes(("error",) if quiet else ("notice", "error"), is_whole=is_whole)
    bar = _bar() if sys.stderr.isatty() and not quiet else None
    pace, failed, last = Pace(), 0, time.monotonic()

    # Above the bar, where there is one.
    above = {"soft_wrap": True, "highlight": False, "markup": False}
    say = partial(click.echo, err=True) if bar is None else partial(bar.console.print, **above)

    def note(report: BatchReport, total: int | None) -> None:
        nonlocal failed, last
        failed += report.statuses["failed"]
        for text in (*causes.at_once(report), *(report.tracebacks if debug else ())):
            say(text)
        now = time.monotonic()
        pace.note(now, report)
        rate, left = pace.words(total)
        if bar is not None:
            fields = {"rate": rate, "left": left, "failed": f"{failed:,} failed" if failed else ""}
            bar.update(bar.task_ids[0], completed=pace.done, total=total, **fields)
        elif not quiet and now - last >= LINE_EVERY:
            last = now
            of = f" of about {total:,}" if total else ""
            say(", ".join(filter(None, (f"{pace.done:,}{of} manipulators", f"{failed:,} failed", rate, left))))

    try:
        yield note
    finally:
        if bar is not None:
            bar.stop()
        for text in causes.at_the_end():
            click.echo(text, err=True)


class Causes:
    """What is noticed and what fails in a run, as texts: each cause once, a screenful of notices and of errors."""

    def __init__(self, severities: Sequence[str], *, is_whole: bool) -> None:
        self.severities, self.is_whole = severities, is_whole
        self._causes: dict[tuple[str | None, ...], Cause[Problem]] = {}
        self._found = Counter[str]()
        self._errors = 0  # causes of errors that came so far

    def at_once(self, report: BatchReport) -> Iterator[str]:
        """What is printed as soon as a batch is done."""
        if self.is_whole:
            yield from (_printable(each) for each in _problems(report) if each.severity in self.severities)
            return
        self._found.update(report.severities)
        for key, cause in report.causes.items():
            if add_cause(self._causes, key, cause) and cause.first.severity == "error":
                self._errors += 1
                if self._errors <= SCREENFUL:
                    yield _printable(cause.first)

    def at_the_end(self) -> Iterator[str]:
        """Each cause of notices, how often causes of errors came besides, and how many more there are of each."""
        for severity in () if self.is_whole else self.severities:
            some = [cause for cause in self._causes.values() if cause.first.severity == severity][:SCREENFUL]
            for cause in some:
                (head, *tail), more = _printable(cause.first).split("\n"), printable(cause.elsewhere)
                if severity == "notice":
                    yield "\n".join([head, *([f"    and {more}"] if more else []), *tail])
                elif more:
                    yield f"{cause.first.mark or shown(cause.first.robot or '')}: {severity}: and {more}"
            if (rest := self._found[severity] - sum(cause.count for cause in some)) > 0:
                others = counted(rest, f"more {severity}")
                yield f"and {others}: the manifest has all of them, and --verbose prints them"


def _printable(problem: Problem) -> str:
    return "\n".join(map(printable, str(problem).splitlines()))


def _problems(report: BatchReport) -> Iterator[Problem]:
    """Every notice and error of a batch, also of what `--resume` kept: from its rows, where it still has them."""
    if not report.rows:
        yield from report.problems
    for row in map(orjson.loads, report.rows.splitlines()):
        yield from (Problem.from_json(entry, "notice", row["name"]) for entry in row["notices"])
        yield from (Problem.from_json(entry, "error", row["name"]) for entry in row["errors"])


class Pace:
    """How fast a run goes, over the last while: what an earlier run has finished, and the start, do not count."""

    def __init__(self) -> None:
        self.done = self.made = 0
        self._seen = deque[tuple[float, int]]()  # times [s], and how many were made by then

    def note(self, now: float, report: BatchReport) -> None:
        """Take a batch that ended at a time [s]."""
        self.done += report.count
        self.made += report.count - report.statuses["kept"]
        self._seen.append((now, self.made))
        while len(self._seen) > FEWEST and self._seen[1][0] <= now - WINDOW:
            self._seen.popleft()

    def words(self, total: int | None) -> tuple[str, str]:
        """The rate, and how long what remains of a total takes at that rate; empty as long as too little is known."""
        (before, fewer), (now, made) = self._seen[0], self._seen[-1]
        if now - before < ENOUGH or made == fewer:
            return "", ""
        rate = (made - fewer) / (now - before)
        seconds = round(max(0, (total or 0) - self.done) / rate)
        at_most = "at most " if self.made < self.done else ""  # More of the rest may be finished.
        left = f"{at_most}{timedelta(seconds=seconds)} left" if total else ""
        return f"{rate:,.0f}/s" if rate >= FAST else f"{rate:.2g}/s", left


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


# --- At the end -------------------------------------------------------------------------------------------------------


def print_summary(result: Result, report: RunReport, where: str, reports: str, *, dry_run: bool) -> None:
    """Print what became of each manipulator, with the largest error of every file and simulator, and the counts."""
    from rich.console import Console

    rows = report["manipulators"]
    console = Console(file=answers(), width=None if answers().isatty() else 140)
    with console.capture() as captured:
        console.print(_table(rows))
    lines = ["largest distance of tool0 from the DH product, in metres:"] if any(row["files"] for row in rows) else []
    lines.append(captured.get().rstrip("\n"))
    if (more := sum(result.statuses.values()) - min(len(rows), MOST_ROWS)) > 0:
        lines.append(f"and {more:,} more manipulators")
    words = {"ok": "made", "kept": "unchanged", "planned": "planned", "failed": "failed"}
    counts = [f"{result.statuses[status]:,} {word}" for status, word in words.items() if result.statuses[status]]
    kinds = ", ".join(f"{kind}: {number:,}" for kind, number in result.kinds.most_common())
    seconds, is_partial = result.seconds["total"], result.statuses["kept"]
    rate = f"; {result.made / seconds:,.0f} per second" if result.made >= MANY and seconds and not is_partial else ""
    what = f"{', '.join(counts)}{f' ({kinds})' if kinds else ''}{rate}"
    lines.append(f"{what}{' (dry run: nothing was written)' if dry_run else ''}")
    if not result.keeps_kinematics:
        lines.append("the transform does not keep the kinematics: differences are reported and fail nothing")
    if not dry_run and report["coverage"]:
        lines.append(f"simulators: {coverage_line(report['coverage'])}")
        notices = report["simulator_notices"]
        lines += [f"- {printable(notice_line(notice))}" for notice in notices[:MOST_NOTICES]]
        if (more := len(notices) - MOST_NOTICES) > 0:
            lines.append(f"and {more:,} more notices of simulators: report.json has all of them")
    if told := result.leftovers.told:
        lines.append(told)
    if not dry_run:
        beside = "" if reports == where else f", report and manifest to {reports}"
        lines.append(f"written to {where}{beside}")
    answer("\n".join(lines))


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
            cells.append({None: "–", True: "yes", False: "no"}[holds_still(row)])
        # The main file of each emitter, and those beside it: an emitter may write whole folders of files.
        folders: dict[str, str] = {}
        placed = [(file["stage"], file["path"], file["path"].rpartition("/")[0]) for file in row["files"]]
        files = [path for stage, path, folder in placed if folders.setdefault(stage, folder) == folder]
        files += [load["picture"] for load in row["loaders"].values() if load["picture"]]
        colour = {"ok": "green", "failed": "red", "planned": "yellow"}[row["status"]]
        table.add_row(_plain(row["name"]), f"[{colour}]{row['status']}[/]", *cells, _plain(", ".join(files)))
    return table


def _asked(facts: ProofEntry | LoadEntry | None) -> str:
    if facts is None:
        return "–"
    if (verdict := facts.get("verdict", "passed")) != "passed":
        return str(verdict)
    error = facts["position_error"]
    return "–" if error is None else f"{error:.1e}" if error else "0"


def _plain(text: str) -> str:
    """A text from a table, with nothing in it that a terminal or rich would act on."""
    from rich.markup import escape

    return escape("".join(c if c.isprintable() else "�" for c in text))
