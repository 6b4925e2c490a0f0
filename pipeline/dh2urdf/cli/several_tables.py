"""`dh2urdf convert` of several tables into a folder: one that fails does not stop the others."""

from __future__ import annotations

import unicodedata
from typing import TYPE_CHECKING

import click

from dh2urdf.cli.printing.conversion_rows import print_report, row_of
from dh2urdf.cli.standard_input import DASH, NAME
from dh2urdf.documents.text_files import is_folder, is_there
from dh2urdf.errors import ConfigError, Dh2UrdfError, InputError, ManipulatorError, TableError, UnknownStageError
from dh2urdf.output.spooled import STEM
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.source import Problem, printable, shown

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from dh2urdf.commands.convert import Conversion, Planned
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.results import ConversionEntry

_PATTERN = frozenset("*?[")
_OF_THE_TABLE = (ManipulatorError, TableError, ConfigError)
"""What fails one table: it cannot be read, is a run file, or no description of it can be made."""


def files_of(
    tables: Sequence[Path], folder: Path | None, format_name: str | None, catalog: Catalog
) -> dict[Path, Path]:
    """The file that each of several tables becomes.

    Args:
        tables: the tables as they were given.
        folder: the folder of the files.
        format_name: the name of the emitter; URDF without it.
        catalog: the emitters that there are.

    Raises:
        ConfigError: no folder is given, or two tables would become one file.
        UnknownStageError: there is no such emitter.
    """
    if folder is None or (is_there(folder) and not is_folder(folder)):
        found = "" if folder is None else f", and {shown(str(folder))} is a file"
        raise _wrong(f"{len(tables)} tables go into a folder{found}", accepted="-o FOLDER, with any name")
    emitter = catalog.get("emitter", format_name) if format_name else catalog.usual("emitter")
    if emitter.suffixes and not is_folder(folder) and folder.name.lower().endswith(emitter.suffixes):
        message = f"-o {shown(str(folder))} names one file, and there are {len(tables)} tables"
        raise _wrong(message, accepted=f"-o FOLDER, such as -o {folder.stem}")
    suffix = emitter.suffixes[0] if emitter.suffixes else ""
    files: dict[Path, Path] = {}
    taken: dict[str, Path] = {}
    problems: list[Problem] = []
    for table in tables:
        stem = STEM if str(table) == DASH else safe_stem(table.stem)
        key = unicodedata.normalize("NFC", stem).casefold()  # as on file systems that ignore case
        if key in taken:
            same = "is given twice" if table in files else f"and {shown(str(taken[key]))} would both become"
            message = f"{shown(str(table))} {same}{'' if table in files else f' {stem}{suffix}'}"
            problems.append(
                Problem(
                    message=message,
                    mark=COMMAND_LINE,
                    found=str(table),
                    accepted="tables whose names differ in more than their folder, their suffix and their case",
                    suggestion="convert them one by one, or into folders of their own",
                )
            )
            continue
        taken[key] = table
        files[table] = folder if emitter.in_folders else folder / f"{stem}{suffix}"
    if problems:
        raise ConfigError(problems)
    return files


def _wrong(message: str, *, accepted: str) -> ConfigError:
    return ConfigError(Problem(message=message, mark=COMMAND_LINE, field="-o", accepted=accepted))


def convert_several(
    files: dict[Path, Path],
    plan: Callable[[Path, Path | None], Planned],
    note: Callable[[Sequence[Problem]], None],
    said: Callable[[Conversion, Path | None], None],
    *,
    as_json: bool,
) -> int:
    """Convert tables one after the other; the exit status is 1 where one failed.

    Args:
        files: the file that each table becomes.
        plan: resolves the stages of a conversion.
        note: takes notices.
        said: takes what was converted.
        as_json: whether to print what became of the tables.

    Raises:
        ConfigError: an option is wrong, whatever the table: nothing is written then.
        OutputError: nothing can be written.
        PluginError: a plugin that is needed is broken.
    """
    rows: list[ConversionEntry] = []
    plans = {table: _planned(plan, table, file) for table, file in files.items()}
    for table, planned in plans.items():
        if isinstance(planned, InputError):
            rows.append(_failed(table, planned))
            continue
        try:
            conversion = planned.carry_out(note)
        except _OF_THE_TABLE as error:
            rows.append(_failed(table, error))
        else:
            said(conversion, files[table])
            rows.append(row_of(conversion, table, files[table]))
    failed = sum(row["status"] == "failed" for row in rows)
    if failed:
        click.echo(f"{len(rows) - failed:,} of {len(rows):,} tables converted, {failed:,} failed", err=True)
    if as_json:
        print_report(rows)
    return int(failed > 0)


def _planned(plan: Callable[[Path, Path | None], Planned], table: Path, file: Path) -> Planned | InputError:
    """The plan of a table, or why there is none."""
    try:
        return plan(table, file)
    except (ConfigError, UnknownStageError):  # Whatever the table: a word of the command line is wrong.
        raise
    except InputError as error:  # There is no such table, or no reader for it.
        return _with_advice(error, table)


def _failed(table: Path, error: Dh2UrdfError) -> ConversionEntry:
    """Says on standard error why a table failed; its row."""
    from dh2urdf.conversion.outcome import kind_of
    from dh2urdf.report.answers.conversions import failed_row

    click.echo("\n".join(map(printable, str(error).splitlines())), err=True)
    return failed_row(NAME if str(table) == DASH else str(table), kind_of(error), error)


def _with_advice(error: InputError, table: Path) -> InputError:
    """The error of a table that is not there; with advice, where its name is a pattern."""
    if _PATTERN.isdisjoint(str(table)):
        return error
    message = f"no file is called {shown(str(table), 200)}"
    advice = "write a pattern without quotes, so that the shell puts the names of the files in its place"
    return type(error)(Problem(message=message, mark=COMMAND_LINE, found=str(table), suggestion=advice))
