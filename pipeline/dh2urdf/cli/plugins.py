"""`dh2urdf plugins`: what is installed."""

from __future__ import annotations

from typing import Any

import click

from dh2urdf.cli.leaving_out import catalog, without_option
from dh2urdf.registry import KINDS
from dh2urdf.report.plugins import plugins_report


@click.command(name="plugins")
@click.option("--json", "as_json", is_flag=True, help="Print the list as JSON.")
@without_option
def command(as_json: bool) -> int:  # noqa: FBT001 - click hands flags over so
    """List every installed stage: kind, name, what it does, its options, and the distribution that provides it.

    A plugin that is broken, or made for another version of the plugin interface, is listed with the reason; it stops
    nothing but the runs that need it. `dh2urdf --debug plugins` shows where it broke.

    \b
    dh2urdf plugins
    dh2urdf plugins --json
    dh2urdf plugins --without my-lab
    """
    report = plugins_report(catalog())
    if as_json:
        import json

        click.echo(json.dumps(report, indent=2, ensure_ascii=False))
        return 0
    for kind in KINDS:
        click.echo(f"{kind}s")
        for entry in (entry for entry in report["stages"] if entry["kind"] == kind):
            click.echo(f"  {entry['name']}: {entry['summary']}  [{entry['distribution']}]")
            for option in entry["options"]:
                click.echo(f"      {option['name']} = {option['default']} ({option['type']}): {option['help']}")
    _print_the_others(report, debug=click.get_current_context().find_root().params["debug"])
    return 0


def _print_the_others(report: dict[str, Any], *, debug: bool) -> None:
    """What there is to know besides the stages."""
    for clash in report["clashes"]:
        choice = f"; say {' or '.join(clash['choices'])}" if clash["choices"] else ""
        click.echo(f"claimed twice: {clash['kind']} {clash['name']} by {' and '.join(clash['distributions'])}{choice}")
    for what in ("broken", "incompatible"):
        for entry in report[what]:
            click.echo(f"{what}: {entry['plugin']} of {entry['distribution']}: {entry['reason']}")
            if debug and "traceback" in entry:
                click.echo(entry["traceback"])
    for entry in report["left_out"]:
        click.echo(f"left out: {entry['plugin']} of {entry['distribution']}")
