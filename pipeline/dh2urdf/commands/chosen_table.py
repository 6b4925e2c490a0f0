"""One manipulator of one table: the reader of the file, and the manipulator that is meant."""

from __future__ import annotations

from contextlib import contextmanager, suppress
from typing import TYPE_CHECKING, Any

from dh2urdf.commands.options_of_stages import option, stage_calls
from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.documents.text_files import check_file, is_file
from dh2urdf.errors import ConfigError, TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.stages import Rejected

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping
    from pathlib import Path

    from dh2urdf.commands.options_of_stages import Setting
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stage_calls.calls import Call
    from dh2urdf.stages import Reader
    from dh2urdf.table_text import Trace


def chosen_reader(catalog: Catalog, table: Path, name: str | None, mark: Mark) -> Reader[Any]:
    """The reader that is named, or the one by the table's suffix.

    Raises:
        InputError: there is none, or several are.
        PluginError: it is broken, or two plugins claim its name.
    """
    if name:
        return catalog.get("reader", name)
    return catalog.reader_for(table, f"`{option(mark, 'reader', 'NAME')}` chooses a reader")


def reader_call(
    catalog: Catalog,
    table: Path,
    name: str | None,
    mark: Mark,
    given: Mapping[str, Mapping[str, str | None]],
    *,
    settings: Iterable[Setting] = (),
) -> Call[Reader[Any]]:
    """The reader of a table, with its options.

    Args:
        catalog: the readers that there are.
        table: the table's file.
        name: name of the reader; None for the one by the table's suffix.
        mark: the place that problems name: the command line, or the function that was called.
        given: options by kind of stage, as words.
        settings: further options.

    Raises:
        TableError: there is no such table.
        ConfigError: an option is unknown or its value wrong.
        InputError: there is no reader, or several are.
        PluginError: the reader is broken, or two plugins claim its name.
    """
    check_file(table, TableError)
    stages = {"reader": [chosen_reader(catalog, table, name, mark)]}
    return stage_calls(catalog, stages, mark, given, settings)["reader"][0]


def is_table(path: Path, catalog: Catalog) -> bool:
    """Whether a file is surely a table: one of a kind that only readers take, or one that can be read as it is."""
    from dh2urdf.run_file.config import RUN_SUFFIXES

    with suppress(Exception):  # Whatever it is instead, it is no table.
        reader = catalog.reader_for(path)
        if not path.name.lower().endswith(RUN_SUFFIXES):
            return is_file(path)
        return isinstance(next(iter(reader.read(path, reader.options())), None), Manipulator)
    return False


def read_manipulator(
    call: Call[Reader[Any]], table: Path, robot: str | None, mark: Mark, trace: Trace | None = None
) -> Manipulator:
    """The manipulator of a table that is meant.

    Raises:
        TableError: it cannot be read, there is none, or which of several is not said.
        ConfigError: the file is a run file.
    """
    with refuse_run_file(table):
        return chosen_manipulator(read_items(call, table, trace), robot, str(table), mark)


@contextmanager
def refuse_run_file(table: Path) -> Iterator[None]:
    """Reports that a file which cannot be read as a table is a run file, where it is one.

    Raises:
        ConfigError: it is one.
    """
    try:
        yield
    except TableError:
        import shlex  # Neither of these is needed where all is well.

        from dh2urdf.run_file.config import is_run_file

        if not is_run_file(table):
            raise
        advice = f"`dh2urdf run {shlex.quote(str(table))}`, or in Python `dh2urdf.run({str(table)!r})`, runs it"
        message = "this is a run file, not a table"
        raise ConfigError(Problem(message=message, mark=Mark(file=str(table)), suggestion=advice)) from None


def chosen_manipulator(
    items: Iterator[Manipulator | Rejected], robot: str | None, file: str, mark: Mark
) -> Manipulator:
    """The manipulator that is meant.

    Raises:
        TableError: it cannot be read, there is none, or which of several is not said.
    """
    others: list[str] = []
    chosen: Manipulator | Rejected | None = None
    for item in items:
        if robot is None and chosen is not None:
            names = [option(mark, "robot", shown(name)) for name in (chosen.name, item.name)]
            message = "the table holds several manipulators, and one conversion makes one"
            choices = f"{option(mark, 'robot', 'NAME')}, such as {' or '.join(names)}"
            advice = "`dh2urdf run` with a run file makes all of them, and `dh2urdf.read_all` reads them"
            raise TableError(Problem(message=message, mark=Mark(file=file), accepted=choices, suggestion=advice))
        if robot in (None, item.name):
            chosen = item
            if robot is not None:
                break
        others.append(item.name)
    if isinstance(chosen, Rejected):
        raise TableError(chosen.problems, chosen.notices)
    if chosen is None:
        message = f"the table holds no manipulator{f' {shown(robot)}' if robot else ''}"
        near, accepted = did_you_mean(robot or "", others), ", ".join(others[:20]) or None
        problem = Problem(message=message, mark=Mark(file=file), found=robot, accepted=accepted, suggestion=near)
        raise TableError(problem)
    return chosen


def table_as_run_file(path: Path) -> Problem:
    """The message about a table where a run file is expected."""
    import shlex

    return Problem(
        message="this is a table, not a run file",
        mark=Mark(file=str(path)),
        suggestion=f"`dh2urdf convert {shlex.quote(str(path))}` converts it; a run file names it: "
        f"`inputs: {path.name}`",
    )
