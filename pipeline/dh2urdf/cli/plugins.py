"""`dh2urdf plugins`: what is installed."""

from __future__ import annotations

from typing import Any

import click

from dh2urdf.options import describe_options
from dh2urdf.registry import KINDS, Catalog, load


@click.command(name="plugins")
@click.option("--json", "as_json", is_flag=True, help="Print the list as JSON.")
def command(as_json: bool) -> int:  # noqa: FBT001 - click hands flags over so
    """List every installed stage: kind, name, what it does, its options, and the distribution that provides it.

    A plugin that is broken is listed with the reason; it stops nothing but the runs that need it.

    \b
    dh2urdf plugins
    dh2urdf plugins --json
    """
    catalog = load()
    stages = [entry for kind in KINDS for entry in _entries(catalog, kind)]
    broken = [
        {"plugin": error.plugin, "distribution": error.distribution, "reason": error.reason} for error in catalog.broken
    ]
    if as_json:
        import json

        click.echo(json.dumps({"stages": stages, "broken": broken}, indent=2, ensure_ascii=False))
        return 0
    for kind in KINDS:
        click.echo(f"{kind}s")
        for entry in (entry for entry in stages if entry["kind"] == kind):
            click.echo(f"  {entry['name']}: {entry['summary']}  [{entry['distribution']}]")
            for option in entry["options"]:
                click.echo(f"      {option['name']} = {option['default']} ({option['type']}): {option['help']}")
    for error in broken:
        click.echo(f"broken: {error['plugin']} of {error['distribution']}: {error['reason']}")
    return 0


def _entries(catalog: Catalog, kind: Any) -> list[dict[str, Any]]:  # noqa: ANN401 - a kind of stage
    return [
        {
            "kind": kind,
            "name": item.stage.name,
            "summary": item.stage.summary,
            "distribution": item.plugin.distribution,
            "options": [
                {"name": name, "type": type_text, "default": default, "help": text}
                for name, type_text, default, text in describe_options(item.stage.options)
            ],
        }
        for item in catalog.provided(kind)
    ]
