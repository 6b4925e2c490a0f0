"""A table that a program has at hand, as a manipulator: what `dh2urdf.read` and `Manipulator.from_dh` do."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

from dh2urdf.commands.argument_words import words_of
from dh2urdf.commands.chosen_table import chosen_manipulator, read_manipulator, reader_call
from dh2urdf.commands.given_tables import GivenRows, as_file
from dh2urdf.commands.options_of_stages import Asker, asker_of, stage_calls
from dh2urdf.conversion.one_manipulator import checked_items
from dh2urdf.errors import ConfigError, TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.spooled import STEM
from dh2urdf.plugin_system.catalog import load
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.stage_calls.answers import items_of
from dh2urdf.stage_calls.calls import blaming
from dh2urdf.table_warnings import warn_of
from dh2urdf.validation.arguments import check_names, path_or_none, several

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    from dh2urdf.commands.given_tables import Source, StrPath
    from dh2urdf.stage_calls.calls import Call
    from dh2urdf.stages import Reader, Rejected
    from dh2urdf.table_text import CellRow

_FROM_DH = "Manipulator.from_dh()"


def read_table(table: Source, robot: str | None, reader: str | None, options: Mapping[str, object]) -> Manipulator:
    """The manipulator of a file, a text or a stream: what `dh2urdf.read` gives, without its warnings."""
    asker = asker_of("dh2urdf.read()")
    check_names(asker.mark, robot=robot, reader=reader)
    with as_file(table, "reader", reader, load(), "reader=NAME") as path:
        return read_manipulator(reading(path, reader, asker, options), path, robot, asker)


def reading(table: Path, reader: str | None, asker: Asker, options: Mapping[str, object]) -> Call[Reader[Any]]:
    """The reader of a table, with its options."""
    return reader_call(load(), table, reader, asker, {"reader": words_of(options)})


def manipulator_of(
    table: object,
    *,
    columns: Sequence[str] | None,
    types: str | Sequence[str] | None,
    joints: Sequence[str] | None,
    name: str | None,
    robot: str | None,
    file: StrPath | None,
    mark: Mark | None,
    options: Mapping[str, object],
) -> Manipulator:
    """The manipulator of an array, a data frame, a list or a text: `Manipulator.from_dh`, which says what is what."""
    arm = _manipulator_of(
        table,
        columns=columns,
        types=types,
        joints=joints,
        name=name,
        robot=robot,
        place=_place(file, mark),
        options=options,
    )
    warn_of(arm.notices, 2)
    return arm


def _place(file: StrPath | None, mark: Mark | None) -> Mark:
    """Where a table of `from_dh` is, for messages: the function, unless its file or its place is given.

    Raises:
        ConfigError: a value is no path, or no mark.
    """
    asker = asker_of(_FROM_DH)
    if mark is not None and not isinstance(mark, Mark):
        message = f"mark={shown(str(mark))} is no place in a file"
        raise ConfigError(Problem(message=message, mark=asker.mark, field="mark", accepted="a dh2urdf.source.Mark"))
    path = path_or_none("file", file, asker.mark)
    if path is None:
        return mark or asker.mark
    return replace(mark, file=path) if mark else Mark(file=path)


def _manipulator_of(
    table: object,
    *,
    columns: Sequence[str] | None,
    types: str | Sequence[str] | None,
    joints: Sequence[str] | None,
    name: str | None,
    robot: str | None,
    place: Mark,
    options: Mapping[str, object],
) -> Manipulator:
    asker = asker_of(_FROM_DH)
    check_names(asker.mark, robot=robot, name=name)
    if isinstance(table, (str, bytes)) or hasattr(table, "read"):
        if columns is not None or types is not None or joints is not None or name is not None:
            message = "a text says its columns, types and names itself"
            raise ConfigError(Problem(message=message, mark=asker.mark, accepted="a text without these arguments"))
        if isinstance(table, str) and "\n" not in table:
            suggestion = f"`dh2urdf.read({table!r})` reads a file"
            message = f"{shown(table)} is no table: it has one line"
            raise TableError(Problem(message=message, mark=asker.mark, suggestion=suggestion))
        source: Any = table
        return read_table(source, robot, load().cell_reader().name, options)
    for argument, value in (("columns", columns), ("types", types), ("joints", joints)):
        if value is not None:
            several(argument, value, asker.mark)
    given = GivenRows(table, columns, place)
    if types is not None:
        given.add_column("type", types, "types")
    if joints is not None:
        given.add_column("joint", joints, "joints")
    catalog = load()
    reader = catalog.cell_reader()
    (call,) = stage_calls(catalog, {"reader": [reader]}, asker, {"reader": words_of(options)})["reader"]
    rows = given.cell_rows({"name": STEM if name is None else name})
    arm = chosen_manipulator(_read_cells(call, rows, place.file), robot, place.file, asker)
    if name is not None and arm.name != name.strip():
        message = f"name={name!r} has no effect: the table names its manipulator {shown(arm.name)}"
        accepted = "no name=, or a table without a column of names"
        raise ConfigError(Problem(message=message, mark=asker.mark, field="name", found=name, accepted=accepted))
    return arm


def _read_cells(call: Call[Reader[Any]], rows: Iterable[CellRow], file: str) -> Iterator[Manipulator | Rejected]:
    if call.stage.read_cells is not None:
        with blaming(call):
            items = items_of(call.stage.read_cells(rows, file, call.options), Manipulator)
        yield from checked_items(items, call)
