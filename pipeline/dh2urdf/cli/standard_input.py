"""`-` in place of a table: what comes from standard input, as a file for its reader."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from dh2urdf.documents.text_files import MAX_BYTES
from dh2urdf.errors import ConfigError, TableError
from dh2urdf.output.spooled import spooled
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import ReadsDescriptions

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.plugin_system.catalog import Catalog

DASH = "-"
FILE = "/dev/stdin"
"""The file that standard input comes from, where the shell has redirected one and the system has such a name."""
NAME = "standard input"
"""What messages call standard input."""


def given_table(table: Path, reader: str | None, catalog: Catalog) -> tuple[Path, str | None]:
    """A table of the command line, and the name of its reader; standard input where the table is a dash.

    What comes from there is kept in a file until the command ends.

    Raises:
        TableError: standard input is empty, too long or closed, or its format is not sure.
        UnknownStageError: there is no such reader.
    """
    if str(table) != DASH:
        return table, reader
    content = _standard_input()
    if reader is None:
        reader = _format_of(content, catalog)
    return _kept(content, catalog.get("reader", reader).suffixes), reader


def refuse_dash(files: Iterable[Path | str | None], command: str) -> None:
    """Refuses a dash where a command reads files, and not standard input.

    Raises:
        ConfigError: one of the files is a dash.
    """
    if any(str(file) == DASH for file in files):
        message = f"`dh2urdf {command}` reads no standard input"
        raise ConfigError(Problem(message=message, mark=COMMAND_LINE, found=DASH, accepted="the name of a file"))


def files_behind(tables: Iterable[Path]) -> list[Path]:
    """The files that the tables of a command line are read from."""
    return [Path(FILE) if str(table) == DASH else table for table in tables]


def given_description(file: Path, emitter: str | None, catalog: Catalog) -> Path:
    """A robot description of the command line; standard input where the file is a dash.

    Raises:
        TableError: standard input is empty, too long or closed.
        ConfigError: the format of standard input is not said: of a URDF, which a xacro may be too, nobody can be sure.
        UnknownStageError: there is no such emitter.
    """
    if str(file) != DASH:
        return file
    if emitter is None:
        problem = Problem(message="the format of standard input is not said", mark=COMMAND_LINE, accepted="`--as NAME`")
        raise ConfigError(problem)
    return _kept(_standard_input(), catalog.get("emitter", emitter).suffixes)


def _kept(content: bytes, suffixes: tuple[str, ...]) -> Path:
    """A file with some content, until the command ends."""
    return click.get_current_context().with_resource(spooled(content, NAME, suffixes[0] if suffixes else ""))


def _standard_input() -> bytes:
    try:
        content = sys.stdin.buffer.read(MAX_BYTES + 1)
    except (AttributeError, OSError, ValueError) as error:  # closed by the program that started the command
        content, wrong = b"", f"standard input cannot be read: {getattr(error, 'strerror', None) or 'it is closed'}"
    else:
        wrong = "" if content.strip() else "there is nothing in it"
        if len(content) > MAX_BYTES:
            wrong = f"there are more than {MAX_BYTES / 2**20:.0f} MiB, too much to be read at once"
    if wrong:
        raise TableError(Problem(message=wrong, mark=Mark(file=NAME)))
    return content


def _format_of(content: bytes, catalog: Catalog) -> str:
    """The reader of some content: the one that reads it as a table, where no other does.

    Raises:
        TableError: no reader does, or several do.
    """
    names: list[str] = []
    readers: list[Any] = [provided.stage for provided in catalog.provided("reader")]
    is_markup = content.lstrip().startswith(b"<")
    for reader in (each for each in readers if is_markup or not each.can(ReadsDescriptions)):
        with spooled(content, NAME, (*reader.suffixes, "")[0]) as path, suppress(Exception):
            # A reader may raise anything of what is not its own format.
            if next(iter(reader.read(path, reader.options())), None) is not None:
                names.append(reader.name)
    if len(names) == 1:
        return names[0]
    wrong = f"{' and '.join(names)} both read this" if names else "no reader surely reads this as it is"
    accepted = f"`--from NAME`, with one of {', '.join(names or [reader.name for reader in readers])}"
    message = f"the format is not sure: {wrong}"
    raise TableError(Problem(message=message, mark=Mark(file=NAME), accepted=accepted))
