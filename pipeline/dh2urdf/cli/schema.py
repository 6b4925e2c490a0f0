"""`dh2urdf schema`: JSON Schema for editors."""

from __future__ import annotations

import json
from typing import Any

import click

from dh2urdf.cli.answers import answer
from dh2urdf.cli.shared_options import catalog, without_option
from dh2urdf.report.schema import (
    conversions_schema,
    error_schema,
    info_schema,
    manifest_schema,
    plugins_schema,
    report_schema,
)
from dh2urdf.run_file.schema import run_schema, table_schema

SCHEMAS: dict[str, Any] = {
    "run": lambda: run_schema(catalog()),
    "table": lambda: table_schema(catalog()),
    "report": report_schema,
    "manifest": manifest_schema,
    "plugins": plugins_schema,
    "conversions": conversions_schema,
    "info": info_schema,
    "error": error_schema,
}


@click.command(name="schema")
@click.argument("what", type=click.Choice(list(SCHEMAS)), default="run")
@without_option
def command(what: str) -> int:
    """Print the JSON Schema of run files, every installed stage's options included, or of what WHAT says.

    table: of YAML tables; report: of report.json; manifest: of a line of manifest.jsonl; plugins: of what
    `dh2urdf plugins --json` prints; conversions: of what `dh2urdf convert --json` prints; info: of what
    `dh2urdf info --json` prints; error: of what a command with --json prints where it fails.

    \b
    dh2urdf schema > run.schema.json
    dh2urdf schema table > table.schema.json
    dh2urdf schema report > report.schema.json
    """
    answer(json.dumps(SCHEMAS[what](), indent=2, ensure_ascii=False))
    return 0
