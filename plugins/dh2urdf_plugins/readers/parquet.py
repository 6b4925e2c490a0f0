"""Reads Denavit-Hartenberg tables as Parquet, one manipulator or a million in a file.

A row of the file is a row of the table, and its columns are called as in CSV. Numbers are taken as they are, and text
is read as the cells of a CSV file are. What comment lines say there, metadata of the file say here.
"""

from __future__ import annotations

from collections import Counter
from contextlib import contextmanager
from dataclasses import replace
from itertools import islice
from typing import TYPE_CHECKING, Any

from dh2urdf.documents import load_yaml
from dh2urdf.errors import MissingDependencyError, TableError
from dh2urdf.source import Problem, did_you_mean, shown
from dh2urdf.stages import Reader, Rejected
from dh2urdf.textfiles import check_file
from dh2urdf_plugins.readers.cells import RowMark, text_of
from dh2urdf_plugins.readers.csv_comments import STATEMENTS
from dh2urdf_plugins.readers.fields import FIELDS
from dh2urdf_plugins.readers.headers import name_columns
from dh2urdf_plugins.readers.row_table import RowTable
from dh2urdf_plugins.readers.statements import TableOptions

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.documents import Node
    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.readers.cells import Value
    from dh2urdf_plugins.readers.headers import Columns
    from dh2urdf_plugins.readers.row_table import Row

METADATA = "dh2urdf."
"""What the keys begin with of metadata that say something of all rows."""
_BATCH = 3000
"""Rows that pyarrow reads at once [1]."""
_PART = 200
"""Rows that are handed on at once [1]: they are gone before Python's collector has to look at them twice."""
_BUFFER = 2**17
"""Bytes of a column that are held at once [B]; pyarrow alone would hold all that stand in a row group."""


def read(path: Path, options: TableOptions) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a Parquet file.

    Args:
        path: the file.
        options: what the table does not say itself.

    Yields:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no Parquet file, is broken, or its columns or metadata are wrong.
        MissingDependencyError: pyarrow is not installed.
    """
    try:
        from pyarrow.parquet import ParquetFile
    except ImportError:
        raise MissingDependencyError("reader 'parquet'", "pyarrow", "dh2urdf[parquet]") from None
    check_file(path, TableError)
    with path.open("rb") as binary:
        with _reporting_errors(RowMark(file=str(path)), "this is no Parquet file that can be read"):
            file = ParquetFile(binary, buffer_size=_BUFFER, pre_buffer=False)
            fields = list(file.schema_arrow)
        said = _statements(file.metadata.metadata or {}, str(path))
        rows = _ParquetRows(file, fields, str(path))
        yield from RowTable(path, options, rows.columns, said, rows).manipulators()


READER: Reader[TableOptions] = Reader(
    name="parquet",
    summary="tables with one row per joint in the columns of a Parquet file; many manipulators in a file",
    read=read,
    options=TableOptions,
    suffixes=(".parquet",),
)


def _statements(metadata: dict[bytes, bytes], file: str) -> dict[str, Node]:
    """What the metadata of a file say of all rows, by key.

    Raises:
        TableError: a key is unknown, or what it says is not YAML.
    """
    said = {}
    for word, text in metadata.items():
        name = word.decode(errors="replace")
        if not name.startswith(METADATA):
            continue
        key = name.removeprefix(METADATA)
        if key not in STATEMENTS:
            raise TableError(
                Problem(
                    message=f"the metadata say {shown(name)}, which nothing is called",
                    mark=RowMark(file=file),
                    found=name,
                    accepted=", ".join(f"{METADATA}{key}" for key in STATEMENTS),
                    suggestion=did_you_mean(name, [f"{METADATA}{key}" for key in STATEMENTS]),
                )
            )
        if not text.strip():
            message = f"the metadata {shown(name)} are empty"
            raise TableError(Problem(message=message, mark=RowMark(file=file), field=key, accepted="a value, as YAML"))
        said[key] = load_yaml(text, f"{file}, metadata {name}", TableError)
    return said


class _ParquetRows:
    """The rows of a file.

    Attributes:
        columns: its columns, without those that are not read.
        notices: always none.
    """

    def __init__(self, file: Any, fields: list[Any], path: str) -> None:  # noqa: ANN401 - a ParquetFile and its columns
        self.file = file
        self.path = path
        self.notices: list[Problem] = []
        mark = RowMark(file=path)
        columns = name_columns([field.name for field in fields], [mark] * len(fields), mark)
        _refuse_twins(columns)
        kept = [k for k, field in enumerate(fields) if _is_read(columns, k, field.type)]
        kinds = [fields[k].type for k in kept]
        self.columns = _some(columns, kept, kinds)
        self.cells = {
            header: _numbers if index in self.columns.numbers else _texts
            for index, header in enumerate(self.columns.headers)
        }

    def batches(self) -> Iterator[tuple[Sequence[int], Sequence[Row]]]:
        """Some hundred rows at a time, with their numbers."""
        batches = self.file.iter_batches(_BATCH, columns=list(self.cells), use_threads=False)
        start = 1
        while True:
            with _reporting_errors(self.mark(start), "the file is broken from here on"):
                batch = next(batches, None)
                if batch is None:
                    return
                cells = [cells_of(batch.column(header)) for header, cells_of in self.cells.items()]
            rows = zip(*cells, strict=True)
            while part := list(islice(rows, _PART)):
                yield range(start, start + len(part)), part
                start += len(part)

    def mark(self, line: int) -> RowMark:
        """A row."""
        return RowMark(file=self.path, line=line)

    def marks(self, line: int, texts: Sequence[str]) -> list[RowMark]:
        """A row, for each of its cells."""
        return [self.mark(line)] * len(texts)

    def row_problem(self, line: int, texts: Sequence[str], number: int) -> None:  # noqa: ARG002 - as of every source
        """Nothing: every row has a cell in every column."""
        return


# --- Columns ----------------------------------------------------------------------------------------------------------


def _is_read(columns: Columns, index: int, kind: Any) -> bool:  # noqa: ANN401 - a type of pyarrow
    """Whether a column is a field, or geometry that no field holds, or text that may be types under another name."""
    if columns.fields[index] is not None or index in columns.unheld:
        return True
    return "type" not in columns.fields and _is_text(kind)


def _refuse_twins(columns: Columns) -> None:
    """Refuses columns that cannot be told apart.

    Raises:
        TableError: two have one name.
    """
    twins = [header for header, count in Counter(columns.headers).items() if count > 1]
    if twins:
        message = f"two columns are called {shown(twins[0])}"
        raise TableError(Problem(message=message, mark=columns.mark, found=twins[0], accepted="names that differ"))


def _is_text(kind: Any) -> bool:  # noqa: ANN401 - a type of pyarrow
    return str(kind) in ("string", "large_string", "string_view")


def _is_number(kind: Any) -> bool:  # noqa: ANN401 - a type of pyarrow
    from pyarrow import types

    return bool(types.is_integer(kind) or types.is_floating(kind))


def _some(columns: Columns, kept: list[int], kinds: list[Any]) -> Columns:
    """Some of the columns of a table.

    Raises:
        TableError: one of them holds moments, lists or the like.
    """
    some = replace(
        columns,
        headers=[columns.headers[index] for index in kept],
        fields=[columns.fields[index] for index in kept],
        unheld={kept.index(index): reason for index, reason in columns.unheld.items()},
        modified=None if columns.modified is None else kept.index(columns.modified),
    )
    problems = [
        Problem(
            message=f"the column {shown(header)} holds {kind}",
            mark=columns.mark,
            field=name,
            found=str(kind),
            accepted="numbers or text",
        )
        for header, name, kind in zip(some.headers, some.fields, kinds, strict=True)
        if not _is_accepted(kind)
    ]
    if problems:
        raise TableError(problems)
    numbers = [
        bool(name and FIELDS[name].dimension) and _is_number(kind)
        for name, kind in zip(some.fields, kinds, strict=True)
    ]
    return replace(some, numbers=frozenset(index for index, is_number in enumerate(numbers) if is_number))


def _is_accepted(kind: Any) -> bool:  # noqa: ANN401 - a type of pyarrow
    from pyarrow import types

    if types.is_dictionary(kind):
        kind = kind.value_type
    return bool(
        _is_text(kind) or _is_number(kind) or types.is_decimal(kind) or types.is_boolean(kind) or types.is_null(kind)
    )


def _numbers(array: Any) -> Sequence[Value]:  # noqa: ANN401 - an array of pyarrow
    import pyarrow as pa

    # A whole number that no double can hold becomes the nearest one, as it does when it is read as text.
    numbers: list[float | None] = array.cast(pa.float64(), safe=False).to_pylist()
    return ["" if number is None else number for number in numbers]


def _texts(array: Any) -> list[str]:  # noqa: ANN401 - an array of pyarrow
    values = array.to_pylist()
    return [value if type(value) is str else _word(value) for value in values]


def _word(value: Any) -> str:  # noqa: ANN401 - whatever a cell holds
    """What a cell of a column of words says: ``1`` for 1.0, which a column of whole numbers with gaps holds."""
    if value is None or value != value:  # noqa: PLR0124 - not a number
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return text_of(value) if isinstance(value, float) else str(value)


@contextmanager
def _reporting_errors(mark: RowMark, what: str) -> Iterator[None]:
    """Turn what pyarrow says of a file into an error of the table.

    Raises:
        TableError: pyarrow raised anything.
    """
    from pyarrow import ArrowException

    try:
        yield
    except (ArrowException, OSError, UnicodeDecodeError) as error:
        (reason, *_) = str(error).splitlines() or [type(error).__name__]
        raise TableError(Problem(message=f"{what}: {reason}", mark=mark, accepted="a whole Parquet file")) from None
