"""`dh2urdf convert`: tables into robot descriptions."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any
from unicodedata import normalize

import click

from dh2urdf.cli import EXIT_STATUS, shared_options as shared
from dh2urdf.cli.answers import answer
from dh2urdf.commands.convert import plan_conversion
from dh2urdf.documents.text_files import is_folder, is_there
from dh2urdf.errors import SCREENFUL, ConfigError, InputError, ManipulatorError, OutputError, UnknownStageError
from dh2urdf.output.spooled import STEM
from dh2urdf.output.whole_files import safe_stem
from dh2urdf.plugin_system.options import COMMAND_LINE
from dh2urdf.report.conversions import closing_line, conversion_row, conversions_report, failed_row
from dh2urdf.source import Messages, Problem, printable, shown
from dh2urdf.stages import WritesFolders

if TYPE_CHECKING:
    from collections.abc import Sequence
    from functools import partial

    from dh2urdf.commands.convert import Conversion
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.results import ConversionEntry

say = Messages(__file__)


@click.command(name="convert", cls=shared.StageCommand, kinds=("reader", "transform", "emitter"), epilog=EXIT_STATUS)
@click.argument("tables", type=shared.PATH, nargs=-1, required=True, metavar="TABLE…")
@click.option(
    "-o", "--output", "output", metavar="FILE", help="File to write, or folder; standard output without the option."
)
@click.option("--to", "format_name", metavar="NAME", help="Format; by FILE's suffix, else urdf.")
@shared.table_options
@click.option("--transform", metavar="NAME", help="Transform; the usual one.")
@click.option(
    "--edit", "edits", multiple=True, metavar="YAML", help="'payload: {mass: 2.5}', a change of the arm; repeatable."
)
@click.option("--meshes", metavar="M", help="relative (copies beside FILE), file (file:// paths) or package://NAME.")
@click.option(
    "--convert-meshes", metavar="C", help="auto (OBJ), hull or decomposition (OBJ, and what touches is convex)."
)
@shared.set_option("Any other option of a stage.")
@shared.json_option("Print what became of the tables as JSON; without -o with the description in it.")
@shared.quiet_option
@shared.without_option
def command(
    tables: tuple[Path, ...],
    output: str | None,
    format_name: str | None,
    reader_name: str | None,
    *,
    as_json: bool,
    quiet: bool,
    **flags: Any,  # noqa: ANN401 - of several options
) -> int:
    """Turn TABLE into a robot description and prove that it is the same arm.

    The reader goes by TABLE's suffix, such as .csv or .yaml, the format by FILE's, such as .urdf or .xacro. A xacro
    has its macro in a file beside FILE; on standard output both are one. TABLE may be -, which is standard input;
    `--from` then says its format. Several tables go into a folder, each as a file of the table's name: one that fails
    does not stop the others. The last line on standard error says how far the description is from the table, and what
    was filled in. `dh2urdf plugins` lists all stages and their options.

    \b
    dh2urdf convert ur5.csv -o ur5.urdf
    dh2urdf convert panda.csv --convention modified --angle-unit deg > panda.urdf
    dh2urdf convert ur5.csv -o ur5.urdf.xacro --frames dh
    dh2urdf convert arms.csv --robot ur10 --set shape=box --set density=1500
    dh2urdf convert tables/*.csv -o build --to sdf
    my-program | dh2urdf convert - --from csv -o arm.urdf
    """
    installed = shared.catalog()
    target = None if output is None or output == shared.DASH else Path(output)
    are_several = len(tables) > 1 or (target is not None and (str(output).endswith("/") or is_folder(target)))
    files = _files_of(tables, target, format_name, installed) if are_several else {tables[0]: target}
    chosen = {name: flags[name] for name in ("robot", "transform", "settings", "edits", "meshes", "convert_meshes")}
    chosen |= {"formats": (format_name,) if format_name else (), "given": shared.given_options(flags)}
    inputs = shared.files_behind(tables)
    plans: dict[Path, partial[Conversion] | InputError] = {}
    for table, file in files.items():  # Nothing is written before a wrong word is found.
        try:
            path, reader = shared.given_table(table, reader_name, installed)
            plans[table] = plan_conversion(path, file, COMMAND_LINE, installed, reader=reader, inputs=inputs, **chosen)
        except InputError as error:
            if not are_several or isinstance(error, (ConfigError, UnknownStageError)):
                raise
            plans[table] = error
    rows: list[ConversionEntry | None] = []
    failed = 0
    for table, planned in plans.items():
        source = shared.NAME if str(table) == shared.DASH else str(table)
        try:
            if isinstance(planned, InputError):
                raise planned
            row = _carry_out(planned, source, files[table], as_json=as_json, quiet=quiet)
        except (InputError, ManipulatorError) as error:  # It cannot be read, or no description of it can be made.
            if not are_several or isinstance(error, OutputError):
                raise
            from dh2urdf.conversion.outcome import kind_of

            click.echo("\n".join(map(printable, str(error).splitlines())), err=True)
            row = failed_row(source, kind_of(error), error)
            failed += 1
        rows.append(row)
    if failed:
        click.echo(f"{len(plans) - failed:,} of {len(plans):,} tables converted, {failed:,} failed", err=True)
    if as_json:
        from dh2urdf.conversion.outcome import to_text

        answer(to_text(conversions_report([row for row in rows if row])), nl=False)
    return int(failed > 0)


def _carry_out(
    planned: partial[Conversion], source: str, file: Path | None, *, as_json: bool, quiet: bool
) -> ConversionEntry | None:
    """Convert a table, say what became of it, and print the description where it is asked for; its row for --json."""
    made = planned() if quiet else planned(note=print_notices)
    if file is None and not as_json:
        answer(made.written[0].files[0].content, nl=False)
    if not quiet:
        click.echo(closing_line(made, "standard output" if file is None else str(file)), err=True)
    if not as_json:
        return None
    in_folders = any("/" in name for name in made.files)
    return conversion_row(made, source, file if file is None or in_folders else file.parent)


def _files_of(
    tables: Sequence[Path], folder: Path | None, format_name: str | None, catalog: Catalog
) -> dict[Path, Path | None]:
    """The file in a folder that each of several tables becomes, in the format that is named."""
    emitter = catalog.get("emitter", format_name) if format_name else catalog.usual("emitter")
    suffix = (*emitter.suffixes, "")[0]
    if folder is None or (is_there(folder) and not is_folder(folder)):
        file = f", and {shown(str(folder))} is a file" if folder else ""
        raise ConfigError(say("tables-into-folder", COMMAND_LINE, count=len(tables), file=file))
    if emitter.suffixes and not is_folder(folder) and folder.name.lower().endswith(emitter.suffixes):
        raise ConfigError(say("tables-into-file", COMMAND_LINE, folder=folder, stem=folder.stem, count=len(tables)))
    files: dict[Path, Path | None] = {}
    taken: dict[str, Path] = {}
    problems = []
    for table in tables:
        stem = STEM if str(table) == shared.DASH else safe_stem(table.stem)
        first = taken.setdefault(normalize("NFC", stem).casefold(), table)  # as on file systems that ignore case
        if table in files or first != table:
            code = "table-twice" if table in files else "tables-of-one-name"
            problems.append(say(code, COMMAND_LINE, table=table, first=first, name=f"{stem}{suffix}"))
        files[table] = folder if emitter.can(WritesFolders) else Path(str(folder), f"{stem}{suffix}")
    if problems:
        raise ConfigError(problems)
    return files


def print_notices(notices: Sequence[Problem]) -> None:
    """Print a screenful of notices on standard error, and how many more there are."""
    for notice in notices[:SCREENFUL]:
        click.echo(notice, err=True)
    if (more := len(notices) - SCREENFUL) > 0:
        click.echo(f"and {more} more notice{'s' if more > 1 else ''}", err=True)
