"""`dh2urdf run`: everything that a run file says."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from dh2urdf.cli import EXIT_STATUS, SETTLED
from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import PATH, catalog, option, without_option
from dh2urdf.cli.standard_input import refuse_dash
from dh2urdf.conversion.outcome import to_text
from dh2urdf.report.manifest import HOW_TO_GET, can_write_html
from dh2urdf.running.run import execute, load_plan

if TYPE_CHECKING:
    from pathlib import Path


@click.command(name="run", epilog=EXIT_STATUS)
@click.argument("config", type=PATH)
@option("-o", "--output", metavar="DIR", help="Where to, not where CONFIG says: a folder or an address.")
@option("--workers", metavar="N", help="How many processes work; auto: one per processor.")
@option("--resume", is_flag=True, help="Keep what an earlier run has finished and what has not changed since.")
@option(
    "--set", "settings", multiple=True, metavar="KEY=VALUE", help="Change a value of CONFIG for this run; repeatable."
)
@option("--keep", is_flag=True, help="Leave the files of the last run into DIR that this one does not write.")
@option("--dry-run", is_flag=True, help="Read and check everything, write nothing.")
@option("--json", "as_json", is_flag=True, help="Print the report as JSON in place of the summary.")
@option("-q", "--quiet", is_flag=True, help="Say only what fails.")
@without_option
def command(  # noqa: PLR0917 - click hands everything over by name
    config: Path,
    output: str | None,
    workers: str | None,
    resume: bool,  # noqa: FBT001 - click hands flags over so
    settings: tuple[str, ...],
    keep: bool,  # noqa: FBT001
    dry_run: bool,  # noqa: FBT001
    as_json: bool,  # noqa: FBT001
    quiet: bool,  # noqa: FBT001
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
    from dh2urdf.cli.printing.progress import progress

    refuse_dash([config], "run")
    overrides = [*settings, *([f"execution.options.workers={workers}"] if workers else [])]
    plan = load_plan(config, catalog(), overrides, output)
    debug = click.get_current_context().find_root().params["debug"]
    try:
        with progress(quiet=quiet, debug=debug) as note:
            result, report = execute(plan, resume=resume, dry_run=dry_run, keep=keep, note=note)
    except KeyboardInterrupt as interrupt:
        if not dry_run:
            interrupt.add_note("`--resume` goes on from there")
        raise
    click.get_current_context().meta[SETTLED] = result.exit_status
    if as_json:
        answer(to_text(report), nl=False)
    elif not quiet:
        from dh2urdf.cli.printing.summary import print_summary

        print_summary(result, report, str(plan.store), str(plan.report_store), dry_run=dry_run)
        if plan.html and not dry_run and not can_write_html():
            answer(HOW_TO_GET)
    return result.exit_status
