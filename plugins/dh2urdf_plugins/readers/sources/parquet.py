"""Tables as Parquet, one manipulator or a million in a file.

A row of the file is a row of the table, and its columns are called as in CSV. Numbers are taken as they are, and text
is read as the cells of a CSV file are. What comment lines say there, metadata of the file say here.
"""

from __future__ import annotations

import json
import re
from collections import Counter
from contextlib import contextmanager, suppress
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from pyarrow import ArrowException, float64, types
from pyarrow.parquet import ParquetFile

from dh2urdf.documents import check_file, load_yaml, refuse_other_kind
from dh2urdf.errors import TableError
from dh2urdf.fields import many_unchecked
from dh2urdf.source import Mark, Messages, Problem, did_you_mean, shown
from dh2urdf.table_text import METADATA, STATEMENTS, CellRow
from dh2urdf_plugins.readers.header.header_rows import text_in
from dh2urdf_plugins.readers.header.words import read_header
from dh2urdf_plugins.readers.table import one_by_one, read_rows
from dh2urdf_plugins.readers.tables.cell_rows import CellRows, choose
from dh2urdf_plugins.readers.tables.row_table import too_many_joints
from dh2urdf_plugins.readers.words.bounds import MAX_COLUMNS, MAX_JOINTS
from dh2urdf_plugins.readers.words.fields import FIELDS, GROUPS, IGNORED

if TYPE_CHECKING:
    from collections.abc import Callable, Collection, Iterator, Sequence
    from pathlib import Path

    from dh2urdf.columns import ManipulatorGroups
    from dh2urdf.documents import Node
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import Trace
    from dh2urdf_plugins.readers.header.columns import Columns, Row
    from dh2urdf_plugins.readers.options import TableOptions
    from dh2urdf_plugins.readers.words.cells import Value

INDEX = "__index_level_0__"
"""The column that pandas writes for an index without a name."""
_ATTRIBUTES = "PANDAS_ATTRS"
"""The metadata that pandas writes for the attributes of a data frame."""
_BATCH = 3000
"""Rows that pyarrow reads at once."""
_BUFFER = 2**17
"""Bytes of a column that are held at once [B]; pyarrow alone would hold all that are in a row group."""
MAX_UNPACKED = 2**26
"""Bytes of a column in one row group when unpacked [B]."""
MAX_CELL = 2**14
"""Bytes of a text that several rows share [B]: some thousand rows are read at once, and each has it then."""
_MOST_IN_LIST, _SPARE = 12, 1000
"""Numbers in the list that a cell is, on average: an inertia has nine at most."""
_SMALL = 2**16
"""Bytes of a column that cannot become too much, however often a row repeats a part of it [B]."""

say = Messages(__file__)


def read_parquet(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a Parquet file."""
    return one_by_one(read_columns(path, options, trace))


def read_columns(
    path: Path, options: TableOptions, trace: Trace | None = None
) -> Iterator[Manipulator | ManipulatorGroups | Rejected]:
    """The same as `read_parquet`, most of them in columns."""
    check_file(path, TableError)
    choose([path], ["row 1"], options.table_number, path)
    with path.open("rb") as binary:
        if not (start := binary.read(100)).startswith(b"PAR1"):
            refuse_other_kind(start, str(path), TableError, "a Parquet file", "a whole Parquet file")
        with _reporting_errors(Mark(file=str(path)), "this is no Parquet file that can be read"):
            file = ParquetFile(binary, buffer_size=_BUFFER, pre_buffer=False)
            if (count := file.metadata.num_columns) > MAX_COLUMNS:
                raise TableError(say("many-columns", Mark(file=str(path)), count=f"{count:,}", most=f"{MAX_COLUMNS:,}"))
            fields = list(file.schema_arrow)
            _refuse_large(file, path, [field.name for field in fields if _is_readable(field)])
        said = _statements(file.metadata.metadata or {}, str(path))
        rows = _ParquetRows(file, fields, str(path))
        yield from read_rows(rows, str(path), options, path.stem, statements=said, trace=trace)


def _statements(metadata: dict[bytes, bytes], file: str) -> dict[str, Node]:
    """What the metadata of a file declare about all rows, by key, and those of a data frame (`DataFrame.attrs`)."""
    said: dict[str, Node] = {}
    texts = {name.decode(errors="replace"): text for name, text in metadata.items()}
    with suppress(ValueError):
        attributes = json.loads(texts.pop(_ATTRIBUTES, b"{}"))
        words = attributes.items() if isinstance(attributes, dict) else ()
        texts |= {name: (word if isinstance(word, str) else json.dumps(word)).encode() for name, word in words}
    for name, text in texts.items():
        key = re.sub(r"(?i)^dh2urdf[\W_]+", "", name).casefold()
        if name == f"{METADATA}{key}" and key in STATEMENTS and text.strip():
            said[key] = load_yaml(text, f"{file}, metadata {name}", TableError)
        elif key != name.casefold() or (key in STATEMENTS and key != "name") or key.endswith(("_unit", "_units")):
            known = [f"{METADATA}{each}" for each in STATEMENTS]
            empty, near = "" if text.strip() else ", and its value is empty", did_you_mean(name, known)
            raise TableError(
                say("unknown-metadata", Mark(file=file), found=name, empty=empty, keys=known, suggestion=near)
            )
    return said


class _ParquetRows(CellRows):
    """The rows of a file, which has neither comments nor notes; their numbers are counted from 1."""

    are_values = True

    def __init__(self, file: Any, columns: list[Any], path: str) -> None:  # noqa: ANN401 - a ParquetFile, and its fields
        super().__init__(self._rows(), prose=False)
        self.file, self.columns, self.path = file, columns, path
        self.cells: list[Callable[[Any], Sequence[Value]] | None] = []  # None: a column that is not read
        self.constant: list[str] = []  # what stands for each of its cells: nothing, or its type

    def _rows(self) -> Iterator[CellRow]:
        """The names of the columns, above which a file has nothing, and the rows below."""
        names = [field.name for field in self.columns]
        if twins := [name for name, count in Counter(names).items() if count > 1]:
            raise TableError(say("columns-of-one-name", Mark(file=self.path), found=twins[0]))
        marks = [Mark(file=self.path, place=f"column {name}") for name in names]
        headers = [_with_unit(field, mark) for field, mark in zip(self.columns, marks, strict=True)]
        if not any((field := read_header(header).field) and field.name == "joint" for header in headers):
            labels = [field.name == INDEX and _kind(field.type) == "text" for field in self.columns]  # of a data frame
            headers = ["joint" if is_label else header for is_label, header in zip(labels, headers, strict=True)]
        yield CellRow(headers, Mark(file=self.path), marks)
        read = [name for name, cells_of in zip(names, self.cells, strict=True) if cells_of]
        batches = self.file.iter_batches(_BATCH, columns=read, use_threads=False)
        start = 1
        while True:
            mark = Mark(file=self.path, line=start, place=f"row {start}")
            with _reporting_errors(mark, "the file is broken from here on"):
                batch = next(batches, None)
                if batch is None:
                    return
                cells = [
                    cells_of(batch.column(name)) if cells_of else [constant] * batch.num_rows
                    for name, cells_of, constant in zip(names, self.cells, self.constant, strict=True)
                ]
            numbers = range(start, start + batch.num_rows)
            marks = many_unchecked(mark, batch.num_rows, line=numbers, place=map("row {}".format, numbers))
            yield from map(CellRow, zip(*cells, strict=True), marks)
            start += batch.num_rows

    def start(self, columns: Columns) -> Columns:
        """Takes the columns of the rows to come; none of them holds moments, lists or the like."""
        columns = super().start(columns)
        kinds, numbers, problems = [field.type for field in self.columns], set[int](), []
        for index, (name, kind) in enumerate(zip(columns.fields, kinds, strict=True)):
            kept = index not in columns.ignored
            if kept and name and not _is_accepted(kind, name):
                header = columns.headers[index]
                mark = Mark(file=self.path, place=f"column {header}")
                problems.append(say("column-of-a-kind", mark, field=name, found=str(kind), header=header))
            is_read = kept and _is_readable(self.columns[index])
            if kept and name and FIELDS[name].dimension and _kind(kind) == "number":
                numbers.add(index)
            self.cells.append(_numbers_of if index in numbers else _texts_of if is_read else None)
            self.constant.append(str(kind) if kept and not is_read else "")
        if problems:
            raise TableError(problems)
        robot = self.columns[columns.fields.index("robot")].name if "robot" in columns.fields else None
        _refuse_one_manipulator(self.file, self.path, robot)
        return replace(columns, numbers=frozenset(numbers), quoted_commas=True, as_written=False)

    def row(self, key: CellRow, cells: Row, number: int) -> tuple[CellRow, list[Problem]]:  # noqa: ARG002
        """A row with the place of each cell; every row has a cell in every column."""
        places = enumerate((f"{key.mark.place}, column {field.name}" for field in self.columns), start=1)
        marks = [replace(key.mark, column=index, place=place) for index, place in places]
        return CellRow(cells, key.mark, marks), []


@contextmanager
def _reporting_errors(mark: Mark, what: str) -> Iterator[None]:
    """Turn errors of pyarrow into a `TableError`."""
    try:
        yield
    except (ArrowException, OSError, UnicodeDecodeError) as error:
        (reason, *_) = str(error).splitlines() or [type(error).__name__]
        raise TableError(say("broken-parquet", mark, what=what, reason=reason)) from None


# --- Columns ----------------------------------------------------------------------------------------------------------


def _with_unit(field: Any, mark: Mark) -> str:  # noqa: ANN401 - a field of pyarrow
    """The header of a column: its name, and the unit that its metadata say."""
    metadata = {key.decode(errors="replace").casefold(): text for key, text in (field.metadata or {}).items()}
    units = {metadata[key].decode(errors="replace").strip() for key in ("unit", "units") if key in metadata} - {""}
    name = str(field.name)
    said = read_header(name).unit
    if not units or (len(units) == 1 and said == min(units).casefold()):
        return name
    if said or len(units) > 1:
        others = " and ".join(map(shown, sorted(units | ({said} if said else set()))))
        raise TableError(say("units-of-a-column", mark, found=others, name=name))
    return f"{name} [{min(units)}]"


def _kind(kind: Any) -> str:  # noqa: ANN401 - a type of pyarrow
    """What the cells of a column are: ``text``, ``number``, another kind that is read, or nothing."""
    kind = kind.value_type if types.is_dictionary(kind) else kind
    if str(kind) in ("string", "large_string", "string_view"):
        return "text"
    if types.is_integer(kind) or types.is_floating(kind):
        return "number"
    return "other" if types.is_decimal(kind) or types.is_boolean(kind) or types.is_null(kind) else ""


def _is_accepted(kind: Any, field: str | None) -> bool:  # noqa: ANN401 - a type of pyarrow
    """Whether a field can be read from a column of a type: one of several numbers from lists, too."""
    while field in GROUPS and (types.is_list(kind) or types.is_large_list(kind) or types.is_fixed_size_list(kind)):
        kind = kind.value_type
    return bool(_kind(kind))


def _is_readable(field: Any) -> bool:  # noqa: ANN401 - a field of pyarrow
    """Whether cells of a column are read whatever it is called: others are of types that no field has, or left out."""
    is_left_out = field.name.startswith(IGNORED) and field.name != INDEX
    return not is_left_out and _is_accepted(field.type, next(iter(GROUPS)))


def _numbers_of(array: Any) -> Sequence[Value]:  # noqa: ANN401 - an array of pyarrow
    """The numbers of a column, as they were written."""
    array = array.dictionary_decode() if types.is_dictionary(array.type) else array
    # A whole number that no double can hold becomes the nearest one, as it does when it is read as text.
    numbers: list[float | None] = array.cast(float64(), safe=False).to_pylist()
    return ["" if number is None else number for number in numbers]


def _texts_of(array: Any) -> list[str]:  # noqa: ANN401 - an array of pyarrow
    """The cells of a column as texts: ``1`` for 1.0, which a column of whole numbers with gaps holds."""
    values = array.to_pylist()
    return [value if type(value) is str else "" if value != value else text_in(value) for value in values]  # noqa: PLR0124 - not a number


# --- What reading would cost ------------------------------------------------------------------------------------------
# A file of a few kilobytes may hold a cell of gigabytes, or one that millions of rows share. Its metadata has the bytes
# and the values of each column of a row group when unpacked (parquet.thrift, ``ColumnMetaData``).


def _refuse_large(file: Any, path: Path, names: Collection[str]) -> None:  # noqa: ANN401 - a ParquetFile
    """Refuses a file whose columns would take too much memory."""
    shared: dict[str, list[int]] = {}

    def refuse(name: str, size: str, most: str) -> None:
        mark = Mark(file=str(path), place=f"column {name}")
        raise TableError(say("large-column", mark, name=name, size=size, most=most))

    for group, name, chunk in _chunks(file, names):
        rows, size = file.metadata.row_group(group).num_rows, chunk.total_uncompressed_size
        if size > MAX_UNPACKED or chunk.num_values > _MOST_IN_LIST * rows + _SPARE:
            found = f"{chunk.num_values:,} values, {size / 2**20:,.0f} MiB when unpacked, in {rows:,} rows"
            refuse(name, found, f"a number or a list of nine in each row, and at most {MAX_UNPACKED / 2**20:,.0f} MiB")
        if size > _SMALL and chunk.physical_type == "BYTE_ARRAY" and any("DICT" in each for each in chunk.encodings):
            shared.setdefault(name, []).append(group)
    for name, groups in shared.items():
        if (longest := _longest_text(path, name, groups)) > MAX_CELL:
            refuse(name, f"a text of {longest:,} bytes", f"at most {MAX_CELL:,} bytes in a cell")


def _chunks(file: Any, names: Collection[str]) -> Iterator[tuple[int, str, Any]]:  # noqa: ANN401
    """The parts of some columns that are in each row group, with the numbers of these and the columns' names."""
    for group in range(file.metadata.num_row_groups):
        metadata = file.metadata.row_group(group)
        for index in range(metadata.num_columns):
            chunk = metadata.column(index)
            path = chunk.path_in_schema
            ends = [k for k, letter in enumerate(path) if letter == "."]  # `com.list.element`
            name = next((path[:end] for end in (len(path), *ends) if path[:end] in names), None)
            if name is not None:
                yield group, name, chunk


def _longest_text(path: Path, name: str, groups: list[int]) -> int:
    """Bytes of the longest text of a column [B], in which each is kept once for all rows that have it."""
    from pyarrow import compute

    with path.open("rb") as binary:
        file = ParquetFile(binary, read_dictionary=[name], pre_buffer=False)
        longest = 0
        for group in groups:
            for part in file.read_row_group(group, columns=[name], use_threads=False).column(0).chunks:
                texts = getattr(part, "dictionary", part)
                longest = max(longest, (compute.max(compute.binary_length(texts)).as_py() if len(texts) else 0) or 0)
        return longest


def _refuse_one_manipulator(file: Any, path: str, robot: str | None) -> None:  # noqa: ANN401
    """Refuses a file that declares more rows of one manipulator than are read."""
    if robot is None:
        if (count := file.metadata.num_rows) > MAX_JOINTS:
            raise TableError(too_many_joints(count, Mark(file=path)))
        return
    for group, _, chunk in _chunks(file, (robot,)):
        rows, said = file.metadata.row_group(group).num_rows, chunk.statistics
        if rows > MAX_JOINTS and said is not None and said.has_min_max and said.min == said.max:
            raise TableError(too_many_joints(rows, Mark(file=path)).about(robot=str(said.min)))
