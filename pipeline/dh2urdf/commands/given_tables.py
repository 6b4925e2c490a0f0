"""Tables as programs have them: files, texts, streams, arrays, data frames, lists and screw axes.

A text or a stream becomes a file for its reader, under a name that messages say. An array, a data frame or a list
becomes the rows of cells that every table consists of, so that the one grammar of tables says what it means.
"""

# ruff: noqa: N803 - Slist, M, H, P and R are the names of the books and of other libraries

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterable, Mapping, Sequence, Set as AbstractSet
from contextlib import contextmanager
from dataclasses import replace
from itertools import zip_longest
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, TypeAlias

from dh2urdf.commands.arguments import check_arguments, path_or_none, several, word_of, words_of
from dh2urdf.commands.choices import chosen_manipulator, read_manipulator, reader_call, stage_calls
from dh2urdf.conversion.one_manipulator import checked_items
from dh2urdf.errors import ConfigError, RecordTypeError, RecordValueError, TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.output.spooled import STEM, spooled
from dh2urdf.plugin_system.calls import blaming, items_of, warn_of
from dh2urdf.plugin_system.catalog import load
from dh2urdf.source import Mark, Messages, Problem, shown
from dh2urdf.stages import ReadsCells
from dh2urdf.table_text import METADATA, PARAMETERS, STATEMENTS, CellRow

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.plugin_system.catalog import Catalog

say = Messages(__file__)

StrPath: TypeAlias = "str | os.PathLike[str]"
Source: TypeAlias = "StrPath | bytes | IO[str] | IO[bytes]"
"""A file, a text with several lines, bytes, or a stream."""

TEXT = "the text"  # what messages call a table that is in no file


# --- Files, texts and streams -----------------------------------------------------------------------------------------


@contextmanager
def as_file(source: Source, kind: str, name: str | None, catalog: Catalog, choice: str) -> Iterator[Path]:
    """A file that holds what was given, as long as the context is open.

    A reader or an emitter (`kind`) of the name knows the format; `choice` is how it is named, for messages.
    """
    content = _content(source)
    if content is None:
        yield Path(source)  # type: ignore[arg-type]  # a path is left
        return
    given = getattr(source, "name", None)
    file = Path(given) if isinstance(given, str) else None
    any_text = catalog.any_text() if kind == "reader" and not content.lstrip().startswith(b"<") else ""
    if name is None and not any_text and (file is None or not file.suffix):
        names = [item.stage.name for item in catalog.provided(kind)]  # type: ignore[arg-type]  # one of two kinds
        raise ConfigError(say("text-without-format", Mark(file=TEXT), option=choice, formats=names))
    suffix = (file.suffix if file else "") or any_text
    if name is not None:
        stage: Any = catalog.get(kind, name)  # type: ignore[call-overload]  # one of two kinds
        suffix = stage.suffixes[0] if stage.suffixes else suffix
    with spooled(content, str(file) if file else TEXT, suffix, stem=file.stem if file else STEM) as path:
        yield path


def _content(source: Any) -> bytes | None:  # noqa: ANN401 - whatever is given
    """What a text or a stream holds; None for the path of a file."""
    found, mark = source, Mark(file="dh2urdf")
    if callable(getattr(source, "read", None)):
        try:
            found = source.read()
        except (OSError, ValueError) as error:  # It is closed, opened for writing, or no text in its encoding.
            raise RecordValueError(say("stream-unreadable", mark, stream=shown(repr(source)), reason=error)) from error
    elif isinstance(source, os.PathLike) or (isinstance(source, str) and not _is_text(source)):
        if not os.fspath(source).strip():
            raise RecordValueError(say("file-name-empty", mark))
        return None
    if isinstance(found, str):
        return found.encode()
    if isinstance(found, (bytes, bytearray, memoryview)):
        return bytes(found)
    raise RecordTypeError(say("not-a-file", mark, kind=type(found).__name__))


def _is_text(source: str) -> bool:
    """Whether a text is a table, and no path: it has several lines, or is JSON."""
    return (
        "\n" in source or "\r" in source or (source.lstrip()[:1] in ("{", "[") and source.rstrip()[-1:] in ("}", "]"))
    )


def read_table(
    table: Source, robot: str | None, reader: str | None, options: Mapping[str, object], mark: Mark
) -> Manipulator:
    """The manipulator of a file, a text or a stream, without its warnings; ``mark`` is the function that was called."""
    check_arguments("name", mark, robot=robot, reader=reader)
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
    path = path_or_none("file", file, own)
    if not isinstance(mark, Mark | None):
        raise ConfigError(say("not-a-mark", own, field="mark", value=shown(str(mark))))
    place = (mark or own) if path is None else replace(mark or own, file=path)
    check_arguments("name", own, robot=robot, name=name)
    catalog = load()
    reader = catalog.cell_reader()
    if isinstance(table, (str, bytes)) or hasattr(table, "read"):
        if (types, joints, name) != (None, None, None):
            raise ConfigError(say("arguments-beside-text", own))
        if isinstance(table, str) and not _is_text(table):
            raise TableError(say("table-of-one-line", own, found=table))
        text: Any = table
        arm = read_table(text, robot, None, options if columns is None else {**options, "columns": [*columns]}, own)
        warn_of(arm.notices, 2)
        return arm
    given: dict[str, list[Any]] = {}
    for argument, value in (("columns", columns), ("types", types), ("joints", joints)):
        if value is not None:
            several(argument, value, own)
            given[argument] = list(value)
    headers, rows = _headers_and_rows(table, given.pop("columns", None), place)
    for argument, cells in given.items():
        if len(cells) != len(rows):
            raise _wrong(place, "entries-not-rows", argument=argument, count=len(cells), rows=len(rows))
        headers = [*headers, argument.removesuffix("s")]
        rows = [[*row, cell] for row, cell in zip(rows, cells, strict=True)]
    (call,) = stage_calls(catalog, {"reader": [reader]}, own, {"reader": words_of(options)})["reader"]
    entries = _cell_rows(headers, rows, {**_said(table, place), "name": STEM if name is None else name}, place)
    reads: Any = reader.can(ReadsCells)
    with blaming(call):
        items = items_of(reads.read_cells(entries, place.file, call.options), Manipulator)
    arm = chosen_manipulator(checked_items(items, call), robot, place.file, own)
    if name is not None and arm.name != name.strip():
        raise ConfigError(say("name-without-effect", own, field="name", found=name, named=shown(arm.name)))
    warn_of(arm.notices, 2)
    return arm


def _said(table: object, place: Mark) -> dict[str, object]:
    """What the attributes of a data frame declare about all rows, as the metadata of a Parquet file do."""
    attributes = getattr(table, "attrs", None)
    given = attributes if isinstance(attributes, Mapping) else {}
    said = {str(key).removeprefix(METADATA): value for key, value in given.items() if str(key).startswith(METADATA)}
    if unknown := said.keys() - {*STATEMENTS}:
        names = [f"{METADATA}{key}" for key in STATEMENTS]
        raise _wrong(place, "attribute-unknown", attribute=shown(METADATA + min(unknown)), names=names)
    return said


def _headers_and_rows(table: Any, columns: list[Any] | None, place: Mark) -> tuple[list[Any], list[list[Any]]]:  # noqa: ANN401
    """The header and the rows of a table of any form, every row as long as the header."""
    headers, rows = _labelled(table, place)
    if headers is not None and columns is not None:
        raise _wrong(place, "columns-named-already")
    headers = columns if headers is None else headers
    if headers is None and rows and all(isinstance(cell, str) for cell in rows[0]):
        headers, *rows = rows
    if headers is None:
        raise _wrong(place, "columns-unnamed")
    for number, row in enumerate(rows, start=1):
        if len(row) != len(headers):
            counts = {"number": number, "cells": len(row), "count": len(headers)}
            raise _wrong(place, "row-of-other-length", headers=headers, **counts)
    if not all(isinstance(header, str) for header in headers):
        raise _wrong(place, "column-names-no-text", headers=f"{headers}", names=PARAMETERS)
    return headers, rows


def _labelled(table: Any, place: Mark) -> tuple[list[Any] | None, list[list[Any]]]:  # noqa: ANN401 - whatever is given
    """The names of the columns of a table, None where they have none, and the rows."""
    if hasattr(table, "itertuples"):  # a DataFrame
        headers, labels = list(table.columns), list(table.index)
        rows = table.astype(object).where(table.notna(), None).to_numpy().tolist()
        if all(isinstance(header, int) for header in headers):  # nobody named them
            return None, rows
        if any(isinstance(label, str) for label in labels):  # the names of the joints
            headers.insert(0, table.index.name or "joint")
            rows = [[label, *row] for label, row in zip(labels, rows, strict=True)]
        return headers, rows
    if names := getattr(getattr(table, "dtype", None), "names", None):  # a structured array
        return list(names), [list(row) for row in table.tolist()]
    if isinstance(table, Mapping):  # of columns, which may be mappings themselves, as those of `DataFrame.to_dict()`
        labels = next((list(column) for column in table.values() if isinstance(column, Mapping)), [])
        columns = [
            [column.get(label) for label in labels] if isinstance(column, Mapping) else _cells(column, place)
            for column in table.values()
        ]
        return list(table), [list(row) for row in zip_longest(*columns)]  # The reader says what a short column lacks.
    if isinstance(table, (list, tuple)) and table and all(isinstance(row, Mapping) for row in table):
        headers = list(dict.fromkeys(key for row in table for key in row))
        return headers, [[row.get(header) for header in headers] for row in table]
    return None, [_cells(row, place) for row in _cells(table, place)]


def _cells(given: Any, place: Mark) -> list[Any]:  # noqa: ANN401 - whatever is given
    if isinstance(given, (str, bytes, bytearray, AbstractSet)) or not isinstance(given, Iterable):
        raise RecordTypeError(say("not-cells", place, found=str(given), kind=type(given).__name__))
    return list(given)


def _cell_rows(headers: list[str], rows: list[list[Any]], said: Mapping[str, object], whole: Mark) -> Iterator[CellRow]:
    """The rows of cells: what holds for all rows, the header, and the rows."""

    def at(row: int, column: int | None, words: str) -> Mark:  # in a file, behind the table's own place in it
        place = ", ".join(filter(None, (whole.in_file, words)))
        return Mark(file=whole.file, line=whole.line or row, column=column, place=place)

    for key, value in said.items():
        yield CellRow([f"# {key}: {json.dumps(value, ensure_ascii=False)}"], whole)
    yield CellRow(list(headers), whole)
    for number, row in enumerate(rows, start=1):
        marks = [at(number, column, f"row {number}, column {header}") for column, header in enumerate(headers, start=1)]
        cells = [_cell(value, mark) for value, mark in zip(row, marks, strict=True)]
        yield CellRow(cells, at(number, None, f"row {number}"), marks)


def _cell(value: Any, mark: Mark) -> str | float | Problem | None:  # noqa: ANN401 - whatever is given
    """What a cell of a table holds."""
    if value is None or isinstance(value, bool):
        return value
    if isinstance(value, str):
        return str.__str__(value)
    if isinstance(value, (list, tuple)) or getattr(value, "ndim", None):  # a range, a centre of mass, an inertia tensor
        return json.dumps(value, default=lambda items: items.tolist() if hasattr(items, "tolist") else str(items))
    from dh2urdf.fields import RefusedError, as_number

    try:
        number = as_number(value)
        if not math.isfinite(number):
            raise RefusedError("number-infinite", value, number=number)
    except RefusedError as refused:
        return replace(refused.problem, mark=mark, accepted="a number or text")
    return int(number) if isinstance(value, int) else number


def _wrong(place: Mark, code: str, **values: Any) -> RecordValueError:  # noqa: ANN401 - of a message
    return RecordValueError(say(code, place, **values))


# --- Screw axes -------------------------------------------------------------------------------------------------------


def from_screws(
    Slist: object = None,
    M: object = None,
    *,
    Blist: object = None,
    H: object = None,
    P: object = None,
    R: object = None,
    joints: Sequence[str | Mapping[str, object]] | None = None,
    name: str = "robot",
    **options: object,
) -> Manipulator:
    """The table of an arm of screw axes.

    ::

        arm = dh2urdf.from_screws(Slist, M)
        arm = dh2urdf.from_screws(H=H, P=P, joints=["pan", {"name": "rail", "type": "prismatic"}])

    Arrays and nested lists mean what they mean in a file for the reader ``screws``, in m and rad.

    Args:
        Slist: a 6xN matrix, a column ω, v for each joint, in the frame of the base; or Blist.
        M: the 4x4 pose of the tool at q = 0.
        Blist: a 6xN matrix, a column ω, v for each joint, in the frame of the tool.
        H: a 3xN matrix, the axes at q = 0; with P, in place of Slist and M.
        P: a 3x(N+1) matrix, from the base to a point on the first axis, on to the next ones, and to the tool.
        R: the 3x3 rotation of the tool at q = 0; none without it.
        joints: the name of each joint, or a mapping with ``name``, ``link``, ``type``, ``limits``, ``damping``,
            ``friction`` and ``armature``. With H, a joint slides where its type is ``prismatic``.
        name: the name of the manipulator.
        options: options of the reader: ``convention``, ``tolerance``, ``near_parallel``, ``origins``.

    Returns:
        The manipulator. Its notices say how far the table is from the axes.

    Raises:
        TableError: the axes are none of an arm; the column is named.
        ConfigError: an option is unknown or its value wrong.
    """
    from dh2urdf.commands.extract import description_reader, the_one

    given = {"name": name, "Slist": Slist, "M": M, "Blist": Blist, "H": H, "P": P, "R": R, "joints": joints}
    text = word_of({key: value for key, value in given.items() if value is not None})
    mark, catalog = Mark(file="dh2urdf.from_screws()"), load()
    with as_file(text.encode(), "reader", "screws", catalog, "reader=NAME") as path:
        return the_one(description_reader(catalog, path, mark, reader="screws", given=words_of(options)), path)
