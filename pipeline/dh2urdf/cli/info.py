"""`dh2urdf info`: what was understood of a table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click

from dh2urdf.cli import EXIT_STATUS, SETTLED, shared_options as shared
from dh2urdf.cli.answers import answer, answers
from dh2urdf.commands.choices import chosen_manipulator, read_manipulator, reader_call, refuse_run_file
from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.conversion.robots import make_robot
from dh2urdf.errors import ManipulatorError
from dh2urdf.plugin_system.calls import default_call
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.report.info import brief, details, in_lines, info_report, markdown
from dh2urdf.stages import Traces
from dh2urdf.table_text import Trace

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system.calls import Call
    from dh2urdf.results import BriefEntry
    from dh2urdf.stages import Reader, Rejected


@click.command(name="info", cls=shared.StageCommand, kinds=("reader",), epilog=EXIT_STATUS)
@click.argument("table", type=shared.PATH)
@shared.table_options
@shared.set_option("Any other option of the reader.")
@click.option("--json", "form", flag_value="json", help="Print it as JSON.")
@click.option("--markdown", "form", flag_value="markdown", help="Print it as Markdown.")
@click.option("--cells", is_flag=True, help="A line for each field: its value, as typed, its unit, and the cell.")
@shared.without_option
def command(table: Path, *, form: str | None, cells: bool, **flags: Any) -> int:  # noqa: ANN401 - of several options
    """Print what is understood of TABLE: as a paper prints it, a row for each joint, in m and rad.

    What TABLE does not say is marked with a star. With --cells there is a line for each field: its value, as it is
    typed, its unit, and the cell; or where else it comes from: a default, the transform, or a reader that does not tell
    cells from defaults, as most readers of plugins. The pose of tool0 at zero, a bound of its
    distance and the mass of the arm are those that `dh2urdf convert` proves and writes. Of several manipulators there
    is a line each; `--robot` shows one. TABLE may be -, which is standard input.

    \b
    dh2urdf info ur5.csv
    dh2urdf info ur5.csv --cells
    dh2urdf info arms.csv --robot ur10 --json > ur10.json
    dh2urdf info panda.yaml --markdown > panda.md
    dh2urdf info arms.xlsx --set sheet=Left
    """
    installed = shared.catalog()
    path, reader = shared.given_table(table, flags["reader_name"], installed)
    given, settings = shared.given_options(flags), flags["settings"]
    call = reader_call(installed, path, reader, COMMAND_LINE, given, settings=settings)
    arms, chosen, trace = _read(call, path, flags["robot"])
    detail = None
    if chosen is not None:  # with what the default transform makes of it
        known = trace if call.stage.can(Traces) else None
        try:
            made = make_robot(chosen, default_call(installed, installed.usual("transform")))
            detail = details(chosen, known, made)
        except ManipulatorError as error:
            detail = details(chosen, known, None, error.problems)
    report = info_report(str(path), arms, detail)
    click.get_current_context().meta[SETTLED] = report["exit_status"]
    if form == "json":
        from dh2urdf.conversion.outcome import to_text

        answer(to_text(report), nl=False)
    elif form == "markdown":
        answer("\n".join(markdown(report, cells=cells)))
    else:
        answer(in_lines(report, terminal=answers().isatty(), cells=cells))
    return report["exit_status"]


def _read(call: Call[Reader[Any]], path: Path, robot: str | None) -> tuple[list[BriefEntry], Manipulator | None, Trace]:
    """The manipulators of a table in short, the one that is meant, and what its cells say."""
    trace = Trace()
    if robot is not None:
        chosen = read_manipulator(call, path, robot, COMMAND_LINE, trace)
        return [brief(chosen)], chosen, trace
    arms: list[BriefEntry] = []
    last: list[Manipulator | Rejected] = []
    with refuse_run_file(path):
        for item in read_items(call, path, trace):
            arms.append(brief(item))
            last = [item]
        if len(arms) > 1:
            return arms, None, trace
        return arms, chosen_manipulator(iter(last), None, str(path), COMMAND_LINE), trace
