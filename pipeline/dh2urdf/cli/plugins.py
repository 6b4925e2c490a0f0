"""`dh2urdf plugins`: what is installed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import catalog, option, without_option
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.report.plugins import plugins_report
from dh2urdf.source import printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.results import PluginsReport


@click.command(name="plugins")
@option("--json", "as_json", is_flag=True, help="Print the list as JSON.")
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

        answer(json.dumps(report, indent=2, ensure_ascii=False))
    else:
        debug = click.get_current_context().find_root().params["debug"]
        answer("\n".join(map(printable, _lines(report, debug=debug))))
    return 0


def _lines(report: PluginsReport, *, debug: bool) -> Iterator[str]:
    for kind in KINDS:
        yield f"{kind}s"
        for entry in (entry for entry in report["stages"] if entry["kind"] == kind):
            yield f"  {entry['name']}: {entry['summary']}  [{entry['distribution']}]"
            for setting in entry["options"]:
                yield f"      {setting['name']} = {setting['default']} ({setting['type']}): {setting['help']}"
    for clash in report["clashes"]:
        choice = f"; say {' or '.join(clash['choices'])}" if clash["choices"] else ""
        yield f"claimed twice: {clash['kind']} {clash['name']} by {' and '.join(clash['distributions'])}{choice}"
    for each in report["shadowed"]:
        yield (
            f"shadowed: {each['kind']} {each['name']} of {each['distribution']} "
            f"by {each['winner']}; say {each['choice']}"
        )
    for broken in report["broken"]:
        yield f"broken: {broken['plugin']} of {broken['distribution']}: {broken['reason']}"
        if debug:
            yield from broken["traceback"].splitlines()
    for refused in report["incompatible"]:
        yield f"incompatible: {refused['plugin']} of {refused['distribution']}: {refused['reason']}"
    for left in report["left_out"]:
        yield f"left out: {left['plugin']} of {left['distribution']}"
