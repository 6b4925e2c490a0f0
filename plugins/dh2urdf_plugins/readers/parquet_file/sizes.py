"""What reading a Parquet file would cost, by what it declares about itself: looked at before any cell is read.

A file of a few kilobytes may hold a cell of gigabytes, or one that millions of rows share. Its metadata has the number
of columns and, for each column of a row group, the bytes and the values when unpacked (parquet.thrift,
``ColumnMetaData``).
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.errors import TableError
from dh2urdf.source import Mark, Problem, shown
from dh2urdf_plugins.readers.tables.tables import too_many_joints
from dh2urdf_plugins.readers.words.bounds import MAX_COLUMNS, MAX_JOINTS

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator
    from pathlib import Path

MAX_UNPACKED = 2**26
"""Bytes of a column in one row group when unpacked [B]."""
MAX_CELL = 2**14
"""Bytes of a text that several rows share [B]: some thousand rows are read at once, and each has it then."""
_MOST_IN_LIST = 12
"""Numbers in the list that a cell is, on average: an inertia has nine at most."""
_SPARE = 1000
_SMALL = 2**16
"""Bytes of a column that cannot become too much, however often a row repeats a part of it [B]."""


def refuse_many_columns(file: Any, path: str) -> None:  # noqa: ANN401 - a ParquetFile
    """Refuses a file of more columns than are read.

    Raises:
        TableError: it is such a file.
    """
    if file.metadata.num_columns > MAX_COLUMNS:
        message = f"the file has {file.metadata.num_columns:,} columns"
        accepted = f"at most {MAX_COLUMNS:,} columns"
        raise TableError(Problem(message=message, mark=Mark(file=path), accepted=accepted))


def refuse_large(file: Any, path: Path, names: Collection[str]) -> None:  # noqa: ANN401 - a ParquetFile
    """Refuses a file whose columns would take too much memory.

    Args:
        file: the file.
        path: where it is.
        names: the columns that are read.

    Raises:
        TableError: one of them would.
    """
    shared: dict[str, list[int]] = {}
    for group, name, chunk in _chunks(file, names):
        mark = Mark(file=str(path), place=f"column {name}")
        rows, size = file.metadata.row_group(group).num_rows, chunk.total_uncompressed_size
        if size > MAX_UNPACKED:
            raise TableError(
                Problem(
                    message=f"the column {shown(name)} has {size / 2**20:,.0f} MiB in {rows:,} rows when unpacked",
                    mark=mark,
                    accepted=f"at most {MAX_UNPACKED / 2**20:,.0f} MiB of a column in one row group",
                    suggestion=_ADVICE,
                )
            )
        if chunk.num_values > _MOST_IN_LIST * rows + _SPARE:
            message = f"the column {shown(name)} has {chunk.num_values:,} values in {rows:,} rows"
            raise TableError(
                Problem(message=message, mark=mark, accepted="a number, or a list of nine at most, in each row")
            )
        if size > _SMALL and chunk.physical_type == "BYTE_ARRAY" and any("DICT" in each for each in chunk.encodings):
            shared.setdefault(name, []).append(group)
    for name, groups in shared.items():
        _refuse_long_texts(path, name, groups)


_ADVICE = "write fewer rows into a row group; begin the name of a column that is to be left out with _"


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


def _refuse_long_texts(path: Path, name: str, groups: list[int]) -> None:
    """Refuses a column in which a long text is kept once for all rows that have it.

    Raises:
        TableError: it is such a column.
    """
    from pyarrow import compute
    from pyarrow.parquet import ParquetFile

    with path.open("rb") as binary:
        file = ParquetFile(binary, read_dictionary=[name], pre_buffer=False)
        for group in groups:
            column = file.read_row_group(group, columns=[name], use_threads=False).column(0)
            for part in column.chunks:
                texts = getattr(part, "dictionary", part)
                longest = compute.max(compute.binary_length(texts)).as_py() if len(texts) else 0
                if (longest or 0) > MAX_CELL:
                    raise TableError(
                        Problem(
                            message=f"the column {shown(name)} holds a text of {longest:,} bytes",
                            mark=Mark(file=str(path), place=f"column {name}"),
                            accepted=f"at most {MAX_CELL:,} bytes",
                            suggestion=_ADVICE,
                        )
                    )


def refuse_one_manipulator(file: Any, path: str, robot: str | None, skipped: int) -> None:  # noqa: ANN401
    """Refuses a file that declares more rows of one manipulator than are read.

    Args:
        file: the file.
        path: where it is.
        robot: the column that names the manipulators; None where all rows are of one.
        skipped: rows that are no joints.

    Raises:
        TableError: it is such a file.
    """
    if robot is None:
        count = file.metadata.num_rows - skipped
        if count > MAX_JOINTS:
            raise TableError(too_many_joints(count, Mark(file=path)))
        return
    for group, _, chunk in _chunks(file, (robot,)):
        rows, said = file.metadata.row_group(group).num_rows, chunk.statistics
        if rows > MAX_JOINTS and said is not None and said.has_min_max and said.min == said.max:
            raise TableError(too_many_joints(rows, Mark(file=path)).about(robot=str(said.min)))
