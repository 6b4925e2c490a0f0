"""Reads Denavit-Hartenberg tables as Parquet, one manipulator or a million in a file.

A row of the file is a row of the table, and its columns are called as in CSV. Numbers are taken as they are, and text
is read as the cells of a CSV file are. What comment lines say there, metadata of the file say here.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from contextlib import contextmanager, suppress
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.documents import check_file, load_yaml, refuse_other_kind
from dh2urdf.errors import MissingDependencyError, TableError
from dh2urdf.source import Mark, Problem, did_you_mean, shown
from dh2urdf.table_text import METADATA, STATEMENTS, CellRow
from dh2urdf_plugins.readers.comments.declared import declared_key
from dh2urdf_plugins.readers.comments.sentences import names_measure, said_in
from dh2urdf_plugins.readers.header.header_rows import completed
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.parquet_file.columns import (
    INDEX,
    holds_numbers,
    is_accepted,
    is_readable,
    is_text,
    numbers_of,
    texts_of,
    unread,
    with_unit,
)
from dh2urdf_plugins.readers.parquet_file.sizes import refuse_large, refuse_many_columns, refuse_one_manipulator
from dh2urdf_plugins.readers.table import TableOptions, read_table_columns
from dh2urdf_plugins.readers.words.comment_lines import Comment

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.columns import PlaceInFile
    from dh2urdf.documents import Node
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.header.columns import Columns
    from dh2urdf_plugins.readers.rows.source import Row
    from dh2urdf_plugins.readers.words.cells import Value

_ATTRIBUTES = "PANDAS_ATTRS"
"""The metadata that pandas writes for the attributes of a data frame."""
_ALMOST = r"(?i)dh2urdf[\W_]*"
"""What the keys begin with of metadata that say something of all rows."""
_BATCH = 3000
"""Rows that pyarrow reads at once."""
_PART = 200
"""Rows that are handed on at once: they are gone before Python's collector has to look at them twice."""
_BUFFER = 2**17
"""Bytes of a column that are held at once [B]; pyarrow alone would hold all that are in a row group."""


def read_parquet(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a Parquet file.

    Args:
        path: the file.
        options: what the table does not say itself.
        trace: takes what the cells of each manipulator say, where it is wanted.

    Yields:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no Parquet file, is broken, or its columns or metadata are wrong.
        MissingDependencyError: pyarrow is not installed.
    """
    for item in _items(path, options, trace):
        if isinstance(item, ManipulatorGroups):
            yield from item.tables()
        else:
            yield item


def read_parquet_columns(path: Path, options: TableOptions) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """The same as `read`, most of them in columns.

    Raises:
        TableError: as of `read`.
        MissingDependencyError: as of `read`.
    """
    return _items(path, options, None)


def _items(
    path: Path, options: TableOptions, trace: Trace | None
) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    try:
        from pyarrow.parquet import ParquetFile
    except ImportError as error:
        raise MissingDependencyError("reader 'parquet'", "pyarrow", "dh2urdf[parquet]", error) from None
    check_file(path, TableError)
    with path.open("rb") as binary:
        if not (start := binary.read(100)).startswith(b"PAR1"):
            refuse_other_kind(start, str(path), TableError, "a Parquet file", "a whole Parquet file")
        with _reporting_errors(Mark(file=str(path)), "this is no Parquet file that can be read"):
            file = ParquetFile(binary, buffer_size=_BUFFER, pre_buffer=False)
            refuse_many_columns(file, str(path))
            fields = list(file.schema_arrow)
            refuse_large(file, path, [field.name for field in fields if is_readable(field)])
        metadata = file.metadata.metadata or {}
        said = _statements(metadata, str(path))
        file_rows = _ParquetRows(file, fields, str(path))
        yield from read_table_columns(file_rows, str(path), options, name=path.stem, statements=said, trace=trace)


def _statements(metadata: dict[bytes, bytes], file: str) -> dict[str, Node]:
    """What the metadata of a file declare about all rows, by key.

    Raises:
        TableError: a key is unknown, or its value is not YAML.
    """
    said: dict[str, Node] = {}
    for word, text in metadata.items():
        name = word.decode(errors="replace")
        if name == _ATTRIBUTES:
            said |= _statements(_attributes(text), file)
            continue
        if not name.startswith(METADATA):
            _refuse_without_prefix(name, text.decode(errors="replace"), file)
            continue
        key = name.removeprefix(METADATA)
        if key not in STATEMENTS:
            raise TableError(
                Problem(
                    message=f"the metadata say {shown(name)}, which nothing is called",
                    mark=Mark(file=file),
                    found=name,
                    accepted=", ".join(f"{METADATA}{key}" for key in STATEMENTS),
                    suggestion=did_you_mean(name, [f"{METADATA}{key}" for key in STATEMENTS]),
                )
            )
        if not text.strip():
            message = f"the metadata {shown(name)} are empty"
            raise TableError(Problem(message=message, mark=Mark(file=file), field=key, accepted="a value, as YAML"))
        said[key] = load_yaml(text, f"{file}, metadata {name}", TableError)
    return said


def _refuse_without_prefix(name: str, text: str, file: str) -> None:
    """Refuses metadata that seem to say something of the table, under a key that nothing reads.

    Raises:
        TableError: they do.
    """
    prefixed = re.match(_ALMOST, name)
    word = (name[prefixed.end() :] if prefixed else name).casefold()
    mark = Mark(file=file)
    says_unit = said_in(Comment(f"{word.replace('_', ' ')}: {text[:200]}", mark, word, mark))
    key = "units" if says_unit and says_unit.units and names_measure(word) else declared_key(word) or word
    if key in STATEMENTS and (prefixed or key != "name"):
        raise TableError(
            Problem(
                message=f"the metadata say {shown(name)}, and only keys that begin with {METADATA} are read",
                mark=Mark(file=file),
                found=name,
                accepted=f"the key {METADATA}{key}, or no such key",
            )
        )


def _attributes(text: bytes) -> dict[bytes, bytes]:
    """The attributes of a data frame (`DataFrame.attrs`) as metadata; none where they are no mapping as JSON."""
    with suppress(ValueError):
        found = json.loads(text)
        if isinstance(found, dict):
            texts = {key: word if isinstance(word, str) else json.dumps(word) for key, word in found.items()}
            return {key.encode(): word.encode() for key, word in texts.items()}
    return {}


def _with_labels(headers: list[str], fields: Sequence[Any]) -> list[str]:
    """Headers with the index of a data frame as the joints' names: pandas gives it this name where it has none."""
    if any((field := read_header(header).field) and field.name == "joint" for header in headers):
        return headers
    are_labels = [field.name == INDEX and is_text(field.type) for field in fields]
    return ["joint" if labels else header for labels, header in zip(are_labels, headers, strict=True)]


def _is_missing(cell: object) -> bool:
    return cell is None or cell != cell  # noqa: PLR0124 - not a number


class _ParquetRows:
    """The rows of a file; the key of a row is its number, counted from 1."""

    def __init__(self, file: Any, fields: list[Any], path: str) -> None:  # noqa: ANN401 - a ParquetFile and its columns
        self.below: list[Comment] = []
        self.file = file
        self.fields = fields
        self.path = path
        self.cells: list[Callable[[Any], Sequence[Value]]] = []
        self.constant: list[str] = []  # what stands for each cell of a column that is not read: nothing, or its type
        self.skipped = 0  # rows at the top that are no joints

    def __iter__(self) -> Iterator[CellRow]:
        """The names of the columns: a file has nothing above them."""
        names = [field.name for field in self.fields]
        _refuse_twins(names, Mark(file=self.path))
        marks = [Mark(file=self.path, place=f"column {name}") for name in names]
        headers = [with_unit(field, mark) for field, mark in zip(self.fields, marks, strict=True)]
        yield CellRow(_with_labels(headers, self.fields), Mark(file=self.path), marks)

    def complete(self, header: CellRow) -> CellRow:
        """The header with a row of units below it, which columns of text may hold.

        Raises:
            TableError: the row of units contradicts the header.
        """
        if not any(is_text(field.type) for field in self.fields):
            return header
        names = [field.name for field in self.fields if is_readable(field)]
        with _reporting_errors(Mark(file=self.path, line=1, place="row 1"), "the file is broken from here on"):
            first = next(self.file.iter_batches(1, columns=names, use_threads=False), None)
        if first is None or not first.num_rows:
            return header
        found = {name: first.column(name).to_pylist()[0] for name in names}
        cells = [None if _is_missing(cell := found.get(field.name)) else cell for field in self.fields]
        joined = completed(header, CellRow(cells, Mark(file=self.path, line=1, place="row 1"), self.marks(1, ())))
        self.skipped = joined is not None
        return joined or header

    def start(self, columns: Columns) -> Columns:
        """Takes the columns of the rows to come.

        Raises:
            TableError: one of them holds moments, lists or the like.
        """
        kinds = [field.type for field in self.fields]
        kept = [index for index in range(len(kinds)) if index not in columns.ignored]
        _refuse_others(columns, kinds, kept)
        robot = self.fields[columns.fields.index("robot")].name if "robot" in columns.fields else None
        refuse_one_manipulator(self.file, self.path, robot, self.skipped)
        numbers = frozenset(index for index in kept if holds_numbers(columns.fields[index], kinds[index]))
        for index, kind in enumerate(kinds):
            is_read = index in kept and is_readable(self.fields[index])
            self.cells.append(numbers_of if index in numbers else texts_of if is_read else unread)
            self.constant.append(str(kind) if index in kept and not is_read else "")
        return replace(columns, numbers=numbers, quoted_commas=True)

    def batches(self) -> Iterator[tuple[Sequence[int], Sequence[Row]]]:
        """Some hundred rows at a time, with their numbers."""
        names = [field.name for field in self.fields]
        read = [name for name, cells_of in zip(names, self.cells, strict=True) if cells_of is not unread]
        batches = self.file.iter_batches(_BATCH, columns=read, use_threads=False)
        start = 1
        while True:
            with _reporting_errors(
                Mark(file=self.path, line=start, place=f"row {start}"), "the file is broken from here on"
            ):
                batch = next(batches, None)
                if batch is None:
                    return
                cells = [
                    [constant] * batch.num_rows if cells_of is unread else cells_of(batch.column(name))
                    for name, cells_of, constant in zip(names, self.cells, self.constant, strict=True)
                ]
            rows = zip(*cells, strict=True)
            while start <= self.skipped and next(rows, None):
                start += 1
            while part := list(islice(rows, _PART)):
                yield range(start, start + len(part)), part
                start += len(part)

    def row_places(self, keys: Iterable[int]) -> Iterator[PlaceInFile]:
        """The numbers of rows."""
        return ((key, None, f"row {key}") for key in keys)

    def row_marks(self, keys: Iterable[int]) -> Iterator[Mark]:
        """The same, with the file."""
        return (Mark(file=self.path, line=key, place=f"row {key}") for key in keys)

    def marks(self, key: int, texts: Sequence[str]) -> list[Mark]:  # noqa: ARG002 - as of each source
        """The place of each cell of a row."""
        return [
            Mark(file=self.path, line=key, column=index, place=f"row {key}, column {field.name}")
            for index, field in enumerate(self.fields, start=1)
        ]

    def row_problems(self, key: int, texts: Sequence[str], number: int) -> tuple[()]:  # noqa: ARG002 - as of each source
        """Nothing: every row has a cell in every column."""
        return ()


# --- Columns ----------------------------------------------------------------------------------------------------------


def _refuse_twins(names: Sequence[str], mark: Mark) -> None:
    """Refuses columns that cannot be told apart.

    Raises:
        TableError: two have one name.
    """
    twins = [name for name, count in Counter(names).items() if count > 1]
    if twins:
        message = f"two columns are called {shown(twins[0])}"
        raise TableError(Problem(message=message, mark=mark, found=twins[0], accepted="names that differ"))


def _refuse_others(columns: Columns, kinds: Sequence[Any], kept: Sequence[int]) -> None:
    """Refuses columns that are read and hold moments, lists or the like.

    Raises:
        TableError: there are some.
    """
    problems = [
        Problem(
            message=f"the column {shown(columns.headers[index])} holds {kinds[index]}",
            mark=Mark(file=columns.mark.file, place=f"column {columns.headers[index]}"),
            field=columns.fields[index],
            found=str(kinds[index]),
            accepted="numbers or text",
        )
        for index in kept
        if columns.fields[index] and not is_accepted(kinds[index], columns.fields[index])
    ]
    if problems:
        raise TableError(problems)


@contextmanager
def _reporting_errors(mark: Mark, what: str) -> Iterator[None]:
    """Turn what pyarrow reports about a file into an error of the table.

    Raises:
        TableError: pyarrow raised anything.
    """
    from pyarrow import ArrowException

    try:
        yield
    except (ArrowException, OSError, UnicodeDecodeError) as error:
        (reason, *_) = str(error).splitlines() or [type(error).__name__]
        raise TableError(Problem(message=f"{what}: {reason}", mark=mark, accepted="a whole Parquet file")) from None
