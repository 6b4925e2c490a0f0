"""`dh2urdf plugins` and `schema`: what is installed, and JSON Schema for editors."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import click

from dh2urdf._version import __version__
from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import catalog, json_option, without_option
from dh2urdf.errors import BrokenPluginError, IncompatiblePluginError
from dh2urdf.hookspecs import INTERFACE_VERSION
from dh2urdf.plugin_system.calls import Call, depending_on
from dh2urdf.plugin_system.catalog import KINDS
from dh2urdf.plugin_system.option_types import describe_options
from dh2urdf.source import printable

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.plugin_system.catalog import Catalog, Plugin, Provided
    from dh2urdf.results import PluginEntry, PluginsReport

SCHEMAS = ("run", "table", "report", "manifest", "plugins", "conversions", "info", "error")


@click.command(name="plugins")
@json_option("Print the list as JSON.")
@without_option
def plugins(*, as_json: bool) -> int:
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
        answer(json.dumps(report, indent=2, ensure_ascii=False))
    else:
        debug = click.get_current_context().find_root().params["debug"]
        answer("\n".join(map(printable, _lines(report, debug=debug))))
    return 0


def plugins_report(catalog: Catalog) -> PluginsReport:
    """Every stage with its options, and every plugin that gives none: broken, incompatible, or left out."""
    failed: list[BrokenPluginError] = []
    stages: list[Any] = []
    words = ("name", "type", "default", "help")
    for item in [item for kind in KINDS for item in catalog.provided(kind)]:
        options: list[Any] = []
        try:
            with depending_on(Call(stage=item.stage, options=None, plugin=item.plugin), "options"):
                options = [dict(zip(words, each, strict=True)) for each in describe_options(item.stage.options)]
        except BrokenPluginError as error:  # A default describes itself by code of the plugin.
            failed.append(error)
        stages.append({**_named(item), "summary": item.stage.summary, "options": options})
    # Plugins are asked for their stages above, and are known as broken since.
    broken: list[Any] = []
    incompatible: list[Any] = []
    for each in (*catalog.broken, *failed):
        entry = {"plugin": each.plugin, "distribution": each.distribution, "reason": each.reason}
        if isinstance(each, IncompatiblePluginError):
            incompatible.append(entry)
        else:
            broken.append(entry | {"traceback": each.traceback})
    clashes: list[Any] = [
        {"kind": each.kind, "name": each.name, "distributions": [*each.distributions], "choices": [*each.choices]}
        for each in catalog.clashes()
    ]
    shadowed: list[Any] = [
        {**_named(loser), "winner": winner.plugin.distribution, "choice": loser.full_name}
        for loser, winner in catalog.shadowed()
    ]
    return {
        "schema": "dh2urdf-plugins/1",
        "version": __version__,
        "interface": INTERFACE_VERSION,
        "stages": stages,
        "clashes": clashes,
        "shadowed": shadowed,
        "broken": broken,
        "incompatible": incompatible,
        "left_out": [_whose(plugin) for plugin in catalog.left_out],
    }


def _named(item: Provided) -> dict[str, str]:
    return {"kind": item.kind, "name": item.stage.name, **_whose(item.plugin)}  # type: ignore[dict-item] # texts


def _whose(plugin: Plugin) -> PluginEntry:
    return {"plugin": plugin.name, "distribution": plugin.distribution}


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
        what = f"{each['kind']} {each['name']} of {each['distribution']}"
        yield f"shadowed: {what} by {each['winner']}; say {each['choice']}"
    for broken in report["broken"]:
        yield f"broken: {broken['plugin']} of {broken['distribution']}: {broken['reason']}"
        if debug:
            yield from broken["traceback"].splitlines()
    for refused in report["incompatible"]:
        yield f"incompatible: {refused['plugin']} of {refused['distribution']}: {refused['reason']}"
    for left in report["left_out"]:
        yield f"left out: {left['plugin']} of {left['distribution']}"


@click.command(name="schema")
@click.argument("what", type=click.Choice(SCHEMAS), default="run")
@without_option
def schema(what: str) -> int:
    """Print the JSON Schema of run files, every installed stage's options included, or of what WHAT says.

    table: of YAML tables; report: of report.json; manifest: of a line of manifest.jsonl; plugins: of what
    `dh2urdf plugins --json` prints; conversions: of what `dh2urdf convert --json` prints; info: of what
    `dh2urdf info --json` prints; error: of what a command with --json prints where it fails.

    \b
    dh2urdf schema > run.schema.json
    dh2urdf schema table > table.schema.json
    dh2urdf schema report > report.schema.json
    """
    from dh2urdf.report import schema as results
    from dh2urdf.run_file.schema import run_schema, table_schema

    made: Any
    if what in ("run", "table"):
        made = (run_schema if what == "run" else table_schema)(catalog())
    else:
        made = getattr(results, f"{what}_schema")()
    answer(json.dumps(made, indent=2, ensure_ascii=False))
    return 0
