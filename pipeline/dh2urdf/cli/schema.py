"""`dh2urdf schema`: JSON Schema for editors."""

from __future__ import annotations

import json

import click

from dh2urdf.registry import load
from dh2urdf.schema import run_schema, table_schema


@click.command(name="schema")
@click.argument("what", type=click.Choice(["run", "table"]), default="run")
def command(what: str) -> int:
    """Print the JSON Schema of run files, every installed stage's options included, or of tables.

    \b
    dh2urdf schema > run.schema.json
    dh2urdf schema table > table.schema.json
    """
    schema = run_schema(load()) if what == "run" else table_schema(load())
    click.echo(json.dumps(schema, indent=2, ensure_ascii=False))
    return 0
