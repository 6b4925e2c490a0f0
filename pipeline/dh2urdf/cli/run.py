"""`dh2urdf run`: everything that a run file says."""

from __future__ import annotations

import sys
import time
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from dh2urdf.cli import EXIT_STATUS
from dh2urdf.config import load_config
from dh2urdf.errors import SCREENFUL
from dh2urdf.registry import load
from dh2urdf.report.json import exit_status, run_report, to_text, write_reports
from dh2urdf.run import Outcome, execute, make_plan

if TYPE_CHECKING:
    from collections.abc import Callable


@click.command(name="run", epilog=EXIT_STATUS)
@click.argument("config", type=click.Path(path_type=Path))
@click.option("-o", "--output", type=click.Path(path_type=Path), metavar="DIR", help="Where to, not where CONFIG says.")
@click.option("--workers", metavar="N", help="How many processes work; auto: one per processor.")
@click.option(
    "--set", "settings", multiple=True, metavar="KEY=VALUE", help="Change a value of CONFIG for this run; repeatable."
)
@click.option("--dry-run", is_flag=True, help="Read and check everything, write nothing.")
@click.option("--json", "as_json", is_flag=True, help="Print the report as JSON in place of the summary.")
def command(  # noqa: PLR0917 - click hands everything over by name
    config: Path,
    output: Path | None,
    workers: str | None,
    settings: tuple[str, ...],
    dry_run: bool,  # noqa: FBT001 - click hands flags over so
    as_json: bool,  # noqa: FBT001
) -> int:
    """Do the run that the YAML file CONFIG describes.

    Every manipulator is read, transformed, written, read back and compared with the DH product of its table; the
    loaders then ask the simulators. The output folder holds the files, report.json and timing.json.

    \b
    dh2urdf run configs/ur5.yaml
    dh2urdf run configs/ur5.yaml -o /tmp/ur5 --set transform.options.frames=dh
    dh2urdf run configs/folder.yaml --workers 4 --json > report.json
    """
    started = time.perf_counter()
    overrides = [*settings, *([f"execution.options.workers={workers}"] if workers else [])]
    plan = make_plan(load_config(config, overrides), load())
    if output is not None:
        plan = replace(plan, directory=output)
    with _progress() as note:
        outcomes = execute(plan, dry_run=dry_run, note=note)
    if not dry_run:
        write_reports(plan.directory, outcomes, time.perf_counter() - started)
    if as_json:
        click.echo(to_text(run_report(outcomes)), nl=False)
        return exit_status(outcomes)
    from dh2urdf.cli.summary import print_summary

    print_summary(outcomes, plan.directory, dry_run=dry_run)
    return exit_status(outcomes)


class _progress:  # noqa: N801 - used like a function
    """A bar on a terminal; what is noticed and what fails is said as it comes, on standard error.

    Of notices and of errors a screenful is said and the rest counted: a run may hold a million manipulators.
    """

    def __enter__(self) -> Callable[[Outcome], None]:
        from rich.console import Console
        from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

        self._console = Console(stderr=True, soft_wrap=True, highlight=False, markup=False)
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
        self._bar = Progress(*columns, console=self._console, transient=True)
        self._is_shown = sys.stderr.isatty()
        if self._is_shown:
            self._bar.start()
        self._task = self._bar.add_task("manipulators", total=None)
        self._said = {"error": 0, "notice": 0}
        self._debug = click.get_current_context().find_root().params["debug"]
        return self._note

    def _note(self, outcome: Outcome) -> None:
        self._bar.advance(self._task)
        findings = [finding for report in outcome.loads.values() for finding in report.findings]
        for problem in (*outcome.notices, *findings, *outcome.errors):
            self._said[problem.severity] += 1
            if self._said[problem.severity] <= SCREENFUL:
                self._console.print(str(problem))
        if self._debug and outcome.traceback:
            self._console.print(outcome.traceback)

    def __exit__(self, *_error: object) -> None:
        if self._is_shown:  # It prints an empty line otherwise.
            self._bar.stop()
        for severity, count in self._said.items():
            if (more := count - SCREENFUL) > 0:
                self._console.print(f"and {more} more {severity}{'s' if more > 1 else ''}: the report has all of them")
