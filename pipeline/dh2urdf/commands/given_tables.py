"""Tables as programs have them: files, texts, streams, arrays, data frames and lists.

A text or a stream becomes a file for its reader, under a name that messages say. An array, a data frame or a list
becomes the rows of cells that every table consists of, so that the one grammar of tables says what it means.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterable, Mapping, Sequence, Set as AbstractSet
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, TypeAlias

from dh2urdf.commands.argument_words import words_of
from dh2urdf.commands.arguments import check_names, path_or_none, several
from dh2urdf.commands.chosen_table import chosen_manipulator, read_manipulator, reader_call
from dh2urdf.commands.options_of_stages import stage_calls
from dh2urdf.conversion.one_manipulator import checked_items
from dh2urdf.errors import ConfigError, RecordTypeError, RecordValueError, TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.spooled import STEM, spooled
from dh2urdf.plugin_system.catalog import load
from dh2urdf.source import Mark, Problem, shown
from dh2urdf.stage_calls.answers import items_of
from dh2urdf.stage_calls.calls import blaming
from dh2urdf.stages import ReadsCells
from dh2urdf.table_text import METADATA, PARAMETERS, REMARKS, STATEMENTS, CellRow
from dh2urdf.table_warnings import warn_of

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.stage_calls.calls import Call
    from dh2urdf.stages import Reader, Rejected

StrPath: TypeAlias = "str | os.PathLike[str]"
Source: TypeAlias = "StrPath | bytes | IO[str] | IO[bytes]"
"""A file, a text with several lines, bytes, or a stream."""
CellValue: TypeAlias = "str | float | Problem | None"

TEXT = "the text"
"""What messages call a table that is in no file."""
_NEARLY = (*STATEMENTS[1:], "unit", "length_unit", "angle_unit", "length unit", "angle unit")
_FILE = "a path, a text of several lines, bytes, or a stream"


# --- Files, texts and streams -----------------------------------------------------------------------------------------


@contextmanager
def as_file(source: Source, kind: str, name: str | None, catalog: Catalog, choice: str) -> Iterator[Path]:
    """A file that holds what was given, as long as the context is open.

    Args:
        source: a file, a text of several lines, bytes, or a stream.
        kind: ``reader`` or ``emitter``: what knows the format.
        name: the name of the format, where it is given.
        catalog: the stages that there are.
        choice: how the format is named, for messages: ``reader=NAME``.

    Raises:
        RecordTypeError: it is none of these.
        ConfigError: the format of a text or a stream is not said.
        UnknownStageError: there is no such format.
    """
    content = _content(source)
    if content is None:
        yield Path(source)  # type: ignore[arg-type]  # a path is left
        return
    given = getattr(source, "name", None)
    file = Path(given) if isinstance(given, str) else None
    if name is None and (file is None or not file.suffix):
        names = [item.stage.name for item in catalog.provided(kind)]  # type: ignore[arg-type]  # one of two kinds
        message = "a text has no suffix that says its format"
        problem = Problem(message=message, mark=Mark(file=TEXT), accepted=f"{choice}, with one of {', '.join(names)}")
        raise ConfigError(problem)
    suffix = file.suffix if file else ""
    if name is not None:
        stage: Any = catalog.get(kind, name)  # type: ignore[call-overload]  # one of two kinds
        suffix = stage.suffixes[0] if stage.suffixes else suffix
    with spooled(content, str(file) if file else TEXT, suffix, stem=file.stem if file else STEM) as path:
        yield path


def _content(source: Any) -> bytes | None:  # noqa: ANN401 - whatever is given
    """What a text or a stream holds; None for the path of a file."""
    if isinstance(source, (bytes, bytearray, memoryview)):
        return bytes(source)
    if isinstance(source, str):
        if "\n" in source or "\r" in source:
            return source.encode()
        if not source.strip():
            message = "the name of the file is empty"
            raise RecordValueError(Problem(message=message, mark=Mark(file="dh2urdf"), found=source, accepted=_FILE))
        return None
    if isinstance(source, os.PathLike):
        return None
    if callable(getattr(source, "read", None)):
        try:
            found = source.read()
        except (OSError, ValueError) as error:  # It is closed, opened for writing, or no text in its encoding.
            message = f"the stream {shown(repr(source))} cannot be read: {error}"
            raise RecordValueError(Problem(message=message, mark=Mark(file="dh2urdf"), accepted=_FILE)) from error
        return found.encode() if isinstance(found, str) else bytes(found)
    raise RecordTypeError(
        Problem(
            message=f"a {type(source).__name__} is no file",
            mark=Mark(file="dh2urdf"),
            accepted=_FILE,
            suggestion="`dh2urdf.Manipulator.from_dh` makes a table of arrays, data frames and lists",
        )
    )


def read_table(
    table: Source, robot: str | None, reader: str | None, options: Mapping[str, object], mark: Mark
) -> Manipulator:
    """The manipulator of a file, a text or a stream, without its warnings; ``mark`` is the function that was called."""
    check_names(mark, robot=robot, reader=reader)
    catalog = load()
    with as_file(table, "reader", reader, catalog, "reader=NAME") as path:
        call = reader_call(catalog, path, reader, mark, {"reader": words_of(options)})
        return read_manipulator(call, path, robot, mark)


# --- Arrays, data frames and lists ------------------------------------------------------------------------------------


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
    own = Mark(file="Manipulator.from_dh()")
    if mark is not None and not isinstance(mark, Mark):
        message = f"mark={shown(str(mark))} is no place in a file"
        raise ConfigError(Problem(message=message, mark=own, field="mark", accepted="a dh2urdf.source.Mark"))
    path = path_or_none("file", file, own)
    place = (mark or own) if path is None else replace(mark or own, file=path)
    check_names(own, robot=robot, name=name)
    catalog = load()
    reader = catalog.cell_reader()
    if isinstance(table, (str, bytes)) or hasattr(table, "read"):
        if columns is not None or types is not None or joints is not None or name is not None:
            message = "a text says its columns, types and names itself"
            raise ConfigError(Problem(message=message, mark=own, accepted="a text without these arguments"))
        if isinstance(table, str) and "\n" not in table:
            suggestion = f"`dh2urdf.read({table!r})` reads a file"
            message = f"{shown(table)} is no table: it has one line"
            raise TableError(Problem(message=message, mark=own, suggestion=suggestion))
        arm = read_table(table, robot, reader.name, options, own)  # type: ignore[arg-type]  # a text, bytes or a stream
        warn_of(arm.notices, 2)
        return arm
    for argument, value in (("columns", columns), ("types", types), ("joints", joints)):
        if value is not None:
            several(argument, value, own)
    given = GivenRows(table, columns, place)
    if types is not None:
        given.add_column("type", types, "types")
    if joints is not None:
        given.add_column("joint", joints, "joints")
    (call,) = stage_calls(catalog, {"reader": [reader]}, own, {"reader": words_of(options)})["reader"]
    rows = given.cell_rows({"name": STEM if name is None else name})
    arm = chosen_manipulator(_read_cells(call, rows, place.file), robot, place.file, own)
    if name is not None and arm.name != name.strip():
        message = f"name={name!r} has no effect: the table names its manipulator {shown(arm.name)}"
        accepted = "no name=, or a table without a column of names"
        raise ConfigError(Problem(message=message, mark=own, field="name", found=name, accepted=accepted))
    warn_of(arm.notices, 2)
    return arm


def _read_cells(call: Call[Reader[Any]], rows: Iterable[CellRow], file: str) -> Iterator[Manipulator | Rejected]:
    if reads := call.stage.can(ReadsCells):
        with blaming(call):
            items = items_of(reads.read_cells(rows, file, call.options), Manipulator)
        yield from checked_items(items, call)


class GivenRows:
    """The rows of a table that was given as an array, a data frame, a mapping of columns, or a list.

    Attributes:
        headers: the name of each column.
        rows: the cells of each row.
        place: where the table is, for messages: a file, a place in one, or the function that was called.
    """

    def __init__(self, table: Any, columns: Sequence[str] | None, place: Mark) -> None:  # noqa: ANN401 - whatever is given
        """Takes the table.

        Args:
            table: the table.
            columns: the names of the columns, in their order, where the table has none.
            place: where the table is, for messages.

        Raises:
            RecordTypeError: it is no table.
            RecordValueError: its columns are not named, or twice, or its rows differ in length.
        """
        self.place = place
        self.remarks: list[str] = []
        self.said = self._said(getattr(table, "attrs", None))
        labelled = _labelled(table, place)
        if labelled is None:
            rows = self._rows(table)
            if columns is None and rows and all(isinstance(cell, str) for cell in rows[0]):
                columns, rows = rows[0], rows[1:]
            if columns is None:
                raise self._wrong(
                    "the columns have no names, and their order is never guessed",
                    accepted="columns=, in the order of the table, such as columns=['theta', 'd', 'a', 'alpha']",
                )
            self.headers, self.rows = list(columns), [list(row) for row in rows]
        elif columns is not None:
            raise self._wrong("the columns have names already", accepted="no columns=, or an array without names")
        else:
            self.headers, self.rows = labelled
        for number, row in enumerate(self.rows, start=1):
            if len(row) != len(self.headers):
                message = f"row {number} has {len(row)} cells, and there are {len(self.headers)} columns"
                raise self._wrong(message, accepted=f"one cell for each of {', '.join(map(str, self.headers))}")
        if not all(isinstance(header, str) for header in self.headers):
            accepted = f"names, such as {', '.join(PARAMETERS)}"
            raise self._wrong(f"the columns are named {self.headers}", accepted=accepted)

    def _said(self, attributes: Any) -> dict[str, object]:  # noqa: ANN401 - whatever a table has
        """What the attributes of a data frame declare about all rows, as the metadata of a Parquet file do.

        Raises:
            RecordValueError: one of them seems to say something under a key that nothing reads.
        """
        said: dict[str, object] = {}
        for key, value in attributes.items() if isinstance(attributes, Mapping) else ():
            word = str(key)
            if word.startswith(METADATA):
                said[word.removeprefix(METADATA)] = value
            elif word.casefold() in REMARKS:
                self.remarks.append(f"# {word}: {value}")
            elif (meant := re.sub(r"^dh2urdf[\W_]*", "", word, flags=re.IGNORECASE).casefold()) in _NEARLY:
                message = f"the attributes say {shown(word)}, and only keys that begin with {METADATA} are read"
                raise self._wrong(message, accepted=f"the key {METADATA}{'units' if 'unit' in meant else meant}")
        if unknown := said.keys() - {*STATEMENTS}:
            message = f"the attributes say {shown(METADATA + min(unknown))}, which nothing is called"
            raise self._wrong(message, accepted=", ".join(f"{METADATA}{key}" for key in STATEMENTS))
        return said

    def add_column(self, header: str, cells: Iterable[str], argument: str) -> None:
        """A further column.

        Raises:
            RecordValueError: it has another length.
        """
        given = list(cells)
        if len(given) != len(self.rows):
            message = f"{argument}= has {len(given)} entries, and the table has {len(self.rows)} rows"
            raise self._wrong(message, accepted="one for each row")
        self.headers.append(header)
        for row, cell in zip(self.rows, given, strict=True):
            row.append(cell)

    def cell_rows(self, statements: Mapping[str, object]) -> Iterator[CellRow]:
        """The rows of cells: what holds for all rows, the header, and the rows."""
        whole = self.place
        for key, value in {**self.said, **statements}.items():
            yield CellRow([f"# {key}: {json.dumps(value, ensure_ascii=False)}"], whole)
        yield from (CellRow([remark], whole) for remark in self.remarks)
        yield CellRow(list(self.headers), whole)
        for number, row in enumerate(self.rows, start=1):
            mark = self._at(number, None, f"row {number}")
            marks = [
                self._at(number, column, f"row {number}, column {header}")
                for column, header in enumerate(self.headers, start=1)
            ]
            cells = [_cell(value, mark) for value, mark in zip(row, marks, strict=True)]
            yield CellRow(cells, mark, marks)

    def _at(self, row: int, column: int | None, words: str) -> Mark:
        """A row or a cell of the table; in a file, behind the table's own place in it."""
        place = ", ".join(filter(None, (self.place.in_file, words)))
        return Mark(file=self.place.file, line=self.place.line or row, column=column, place=place)

    def _rows(self, table: Any) -> list[Sequence[Any]]:  # noqa: ANN401 - whatever is given
        if isinstance(table, (str, bytes, Mapping, AbstractSet)) or not isinstance(table, Iterable):
            raise RecordTypeError(
                Problem(
                    message=f"a {type(table).__name__} is no table",
                    mark=self.place,
                    accepted="an array of shape (rows, columns), a DataFrame, a list of rows, a list of mappings, a "
                    "mapping of columns, or a text of several lines",
                )
            )
        tuples = getattr(table, "itertuples", None)  # of a DataFrame, which iterates over its columns
        rows = list(tuples(index=False, name=None) if tuples else table)
        for row in rows:
            if isinstance(row, (str, bytes, AbstractSet)) or not isinstance(row, Iterable):
                message = f"a row is {shown(str(row))}, and no list of cells"
                raise self._wrong(message, accepted="a table of two dimensions: rows of cells")
        return [list(row) for row in rows]

    def _wrong(self, message: str, *, accepted: str) -> RecordValueError:
        return RecordValueError(Problem(message=message, mark=self.place, accepted=accepted))


def _labelled(table: Any, place: Mark) -> tuple[list[Any], list[list[Any]]] | None:  # noqa: ANN401 - whatever is given
    """The headers and the rows of a table whose columns have names; None of any other."""
    if fields := getattr(getattr(table, "dtype", None), "names", None):  # a structured array
        return list(fields), [list(row) for row in table.tolist()]
    if hasattr(table, "columns") and hasattr(table, "itertuples"):
        headers = list(table.columns)
        if all(isinstance(header, int) for header in headers):  # nobody named them
            return None
        rows = [list(row) for row in table.itertuples(index=False, name=None)]
        labels = list(table.index)
        if any(isinstance(label, str) for label in labels):  # the names of the joints
            headers.insert(0, table.index.name or "joint")
            rows = [[label, *row] for label, row in zip(labels, rows, strict=True)]
        return headers, [[None if _is_missing(cell) else cell for cell in row] for row in rows]
    if isinstance(table, Mapping):
        columns = {key: _column(key, column, place) for key, column in table.items()}
        _check_labels(table, place)
        count = max(map(len, columns.values()), default=0)
        # A column that is too short has nothing in its last cells, and the reader says which they are.
        return list(columns), [
            [column[number] if number < len(column) else None for column in columns.values()] for number in range(count)
        ]
    if isinstance(table, (list, tuple)) and table and all(isinstance(row, Mapping) for row in table):
        headers = list(dict.fromkeys(key for row in table for key in row))
        return headers, [[row.get(header) for header in headers] for row in table]
    return None


def _column(header: object, column: Any, place: Mark) -> list[Any]:  # noqa: ANN401 - whatever is given
    """The cells of a column that is given by its name."""
    if isinstance(column, Mapping):  # such as those of `DataFrame.to_dict()`
        return list(column.values())
    if isinstance(column, (str, bytes, AbstractSet)) or not isinstance(column, Iterable):
        raise RecordTypeError(
            Problem(
                message=f"the column {shown(str(header))} is {shown(str(column))}, and no list of cells",
                mark=place,
                field=str(header),
                accepted="a list with one cell for each row",
                suggestion="a list of mappings is a table of one mapping for each row",
            )
        )
    return list(column)


def _check_labels(table: Mapping[Any, Any], place: Mark) -> None:
    """Refuse columns whose cells have labels, where they differ: what is in one row would be a guess."""
    labels = {key: list(column) for key, column in table.items() if isinstance(column, Mapping)}
    first = next(iter(labels), None)
    for key, found in labels.items():
        if found != labels[first]:
            message = f"the rows of the columns {shown(str(first))} and {shown(str(key))} have different labels"
            accepted = f"the labels {', '.join(map(str, labels[first]))} in this order, in each column"
            raise RecordValueError(Problem(message=message, mark=place, accepted=accepted))


def _is_missing(cell: Any) -> bool:  # noqa: ANN401 - whatever is given
    """Whether a data frame has nothing in a cell: None, NaN, NaT or NA, none of which is equal to itself."""
    return (
        cell is None or type(cell).__name__ in ("NAType", "NaTType") or (isinstance(cell, float) and math.isnan(cell))
    )


def _cell(value: Any, mark: Mark) -> CellValue:  # noqa: ANN401 - whatever is given
    """What a cell of a table holds."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, str):
        return str.__str__(value)
    if isinstance(value, (list, tuple)) or getattr(value, "ndim", None):  # a range, a centre of mass, an inertia tensor
        return json.dumps(value, default=lambda items: items.tolist() if hasattr(items, "tolist") else str(items))
    from dh2urdf.record_fields import as_number

    try:
        number = as_number(value)
    except RecordTypeError as error:
        (problem,) = error.problems
        return Problem(message=problem.message, mark=mark, found=problem.found, accepted="a number or text")
    if not math.isfinite(number):
        return Problem(message=f"{number} is not a finite number", mark=mark, found=str(value), accepted="a number")
    return int(number) if isinstance(value, int) else number
