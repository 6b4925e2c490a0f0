"""The reference of the command line, from the commands themselves."""

from __future__ import annotations

import inspect
import re
from typing import TYPE_CHECKING

import click

from dh2urdf.cli import EXIT_STATUS, dh2urdf
from pieces import code, prose, table

if TYPE_CHECKING:
    from collections.abc import Iterator

KEEP_LINES = "\b"
"""Click's mark of a paragraph whose lines are to stay as they are: an example."""


def commands() -> str:
    """A section for the program, and one for each command: its usage, what it does, what it takes."""
    context = click.Context(dh2urdf, info_name="dh2urdf", **dh2urdf.context_settings)
    found = [command for name in dh2urdf.list_commands(context) if (command := dh2urdf.get_command(context, name))]
    return "\n\n".join([*_program(context), *(text for command in found for text in _command(command, context))])


def _program(context: click.Context) -> Iterator[str]:
    yield table(("option of every command", "does"), _options(dh2urdf, context))
    yield EXIT_STATUS


def _command(command: click.Command, parent: click.Context) -> Iterator[str]:
    context = click.Context(command, info_name=command.name, parent=parent)
    yield f"## {context.command_path}"
    yield f"```text\n{context.command_path} {' '.join(command.collect_usage_pieces(context))}\n```"
    yield from _help(command.help or "")
    if options := list(_options(command, context)):
        yield table(("option", "does"), options)
    if command.epilog and command.epilog != EXIT_STATUS:
        yield command.epilog


def _help(text: str) -> Iterator[str]:
    """The paragraphs of a help text; examples are code."""
    for paragraph in re.split(r"\n\s*\n", inspect.cleandoc(text)):
        if paragraph.startswith(KEEP_LINES):
            yield f"```sh\n{paragraph.removeprefix(KEEP_LINES).strip()}\n```"
        else:
            yield " ".join(re.sub(r"(?<!\S)(--[a-z-]+)", r"`\1`", prose(paragraph)).split())


def _options(command: click.Command, context: click.Context) -> Iterator[tuple[str, str]]:
    for parameter in command.get_params(context):
        record = parameter.get_help_record(context)
        if isinstance(parameter, click.Option) and record:  # The text describes arguments.
            names, text = record
            yield code(names), prose(text)
