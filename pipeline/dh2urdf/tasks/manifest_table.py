"""The manifest of a run as a Parquet file, for data science: a row for each manipulator, and a column for each fact.

It is written while the rows pass by; none is kept.
"""

from __future__ import annotations

from array import array
from importlib.util import find_spec
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, BinaryIO, get_args, get_origin, get_type_hints, is_typeddict

from orjson import loads

from dh2urdf.errors import MissingDependencyError
from dh2urdf.results.run import ManipulatorEntry
from dh2urdf.tasks.manifest_columns import PLAIN, Lists, columns_of

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence
    from pathlib import Path

    import numpy as np
    import pyarrow as pa
    from numpy.typing import NDArray
    from pyarrow.parquet import ParquetWriter

    from dh2urdf.tasks.manifest_columns import ManifestColumns

ROW_GROUP = 10_000
"""Manipulators in a row group of the Parquet file: as many are in memory at once."""


def can_write_parquet() -> bool:
    """Whether pyarrow is installed; it is not imported."""
    return find_spec("pyarrow") is not None


class ManifestTable:
    """A manifest as a Parquet file: a row for each manipulator, in the same order, and a column for each fact.

    ===============================  ===================================================================================
    name, status, kind, source, key  text; `kind` of the failure is null where there is none
    keeps_kinematics                 whether the transform keeps T(q)
    files                            list of path, stage, bytes, sha256; with shard and offset in tar shards
    position_error, angle_error      largest difference from the DH product over all files that were proved [m, rad]
    proved                           list of the emitters whose files were
    error                            message of the first error
    errors, notices                  lists of messages
    drawn.<field>                    what was drawn for it [SI]: numbers, or text for types of joints
    loaders.<loader>.verdict         passed, failed, missing, not in the sample, or no file
    loaders.<loader>.<field>         what a simulator reported, `hold.stayed` and the like included: numbers, truth
                                     values and text; of its findings and errors the messages; other lists are left out
    ===============================  ===================================================================================

    A column `drawn` or `loaders` that no manipulator fills is left out. The same rows give the same bytes with the same
    version of pyarrow, however many come at once.

    Attributes:
        path: the file that is written.
        place: where it will be in the end, which errors name.
    """

    def __init__(self, path: Path, place: str | None = None) -> None:
        self.path = path
        self.place = place or str(path)
        self._kinds: dict[str, type] = {}
        self._waiting: list[ManifestColumns] = []
        self._writer: ParquetWriter | None = None
        self._is_outgrown = False

    def add(self, rows: ManifestColumns) -> None:
        """Take rows of the manifest.

        Raises:
            OSError: the file cannot be written.
        """
        self._see(rows)
        while rows.size >= (room := ROW_GROUP - sum([part.size for part in self._waiting])):
            self._write([*self._waiting, rows.part(0, room)])
            self._waiting, rows = [], rows.part(room, rows.size)
        self._waiting.append(rows)

    def finish(self, manifest: BinaryIO) -> None:
        """Complete the file, or write it anew where late rows have columns that the first ones had not.

        Args:
            manifest: all lines.

        Raises:
            OSError: the file cannot be written.
        """
        self._write(self._waiting)
        self._close()
        if self._is_outgrown:
            self._is_outgrown = False
            manifest.seek(0)
            while some := [loads(line) for line in islice(manifest, ROW_GROUP)]:
                self._write([columns_of(some)])
            self._close()

    def _see(self, rows: ManifestColumns) -> None:
        """Learn of facts that not all runs have whether they are truth values, numbers, text or lists of text.

        What is of several kinds is text.
        """
        for name, column in rows.columns.items():
            if name.startswith(_OF_SOME_RUNS):
                kinds = {float} if isinstance(column, array) else {*map(type, column)}.difference({type(None)})
                for kind in {float if kind is int else kind for kind in kinds}:
                    if self._kinds.setdefault(name, kind) is not kind:
                        self._kinds[name] = str

    def _schema(self) -> pa.Schema:
        """The columns and their types."""
        import pyarrow as pa

        text, number, texts = pa.string(), pa.float64(), pa.list_(pa.string())
        kinds = {bool: pa.bool_(), float: number, str: text, list: texts}
        types = {
            **_types(ManipulatorEntry, *PLAIN, "files"),
            **dict.fromkeys(("position_error", "angle_error"), number),
            "proved": texts,
            "error": text,
            **dict.fromkeys(("errors", "notices"), texts),
        }
        for some in _OF_SOME_RUNS:
            types |= {name: kinds[kind] for name, kind in self._kinds.items() if name.startswith(some)}
        return pa.schema(types)

    def _write(self, parts: Sequence[ManifestColumns]) -> None:
        """Write a row group, if the columns are those of the groups before.

        Raises:
            MissingDependencyError: pyarrow is installed and cannot be imported.
        """
        try:
            import pyarrow as pa
            from pyarrow import parquet
        except ImportError as error:
            raise MissingDependencyError("manifest.parquet", "pyarrow", "dh2urdf[parquet]", error) from error

        schema = self._schema()
        if self._writer is None:
            self._writer = parquet.ParquetWriter(self.path, schema, use_dictionary=_REPEATED)
        self._is_outgrown = self._is_outgrown or self._writer.schema != schema
        if any(part.size for part in parts) and not self._is_outgrown:
            columns = [
                _array_of(field.type, [part.columns.get(field.name) or [None] * part.size for part in parts])
                for field in schema
            ]
            self._writer.write_batch(pa.record_batch(columns, schema=schema), ROW_GROUP)

    def _close(self) -> None:
        if self._writer is not None:
            self._writer.close()
            self._writer = None


_REPEATED = ["status", "kind", "source"]
"""Columns of few different texts; a dictionary of any other would be as long as the column."""
_OF_SOME_RUNS = ("drawn.", "loaders.")
"""How the names of columns begin that not all runs have."""


def _types(record: type, *names: str) -> dict[str, pa.DataType]:
    """The types of some keys of a record of `dh2urdf.results`, of all where none is named."""
    hints = get_type_hints(record)
    return {name: _type(hints[name]) for name in names or hints}


def _type(hint: Any) -> pa.DataType:  # noqa: ANN401 - any type
    """The type of a column for values of a type, or null."""
    import pyarrow as pa

    if is_typeddict(hint):
        return pa.struct(_types(hint))
    parts = get_args(hint)
    if get_origin(hint) is list:
        return pa.list_(_type(parts[0]))
    kinds = {bool: pa.bool_(), int: pa.int64(), float: pa.float64()}
    return next((column for kind, column in kinds.items() if kind in (hint, *parts)), pa.string())


_UTF_8 = "utf-8", "backslashreplace"
"""Encoding and handling of errors as in the manifest: names of files may hold bytes that are no UTF-8."""


def _array_of(kind: pa.DataType, parts: Sequence[Any]) -> pa.Array:
    """The parts of a column behind each other, each of them a `Column`.

    (`pyarrow.array` would import pandas where it is installed, which takes 0.2 s, half of a short run.)
    """
    import numpy as np
    import pyarrow as pa

    if pa.types.is_struct(kind):
        fields = [kind.field(place) for place in range(kind.num_fields)]
        columns = [_array_of(field.type, [part[field.name] for part in parts]) for field in fields]
        return pa.StructArray.from_arrays(columns, fields=fields)
    if pa.types.is_floating(kind) and all(isinstance(part, array) for part in parts):
        return _from_buffers(kind, np.concatenate([np.array(part) for part in parts]))
    if all(isinstance(part, Lists) for part in parts):
        counts = list(chain.from_iterable([part.counts for part in parts]))
        return _lists(kind, counts, _array_of(kind.value_type, [part.entries for part in parts]))
    values = list(chain.from_iterable(parts))
    present = np.array([value is not None for value in values], dtype=bool)
    if pa.types.is_list(kind):
        entries = list(chain.from_iterable([value or () for value in values]))
        return _lists(kind, [len(value or ()) for value in values], _array_of(kind.value_type, [entries]), present)
    if not pa.types.is_string(kind):
        numbers = np.array([0 if value is None else value for value in values], dtype=kind.to_pandas_dtype())
        return _from_buffers(kind, numbers, present)
    texts = ["" if value is None else str(value) for value in values]
    data = "".join(texts).encode(*_UTF_8)
    starts = _starts(map(len, texts))
    if starts[-1] < len(data):  # They are not ASCII alone.
        starts = _starts([len(text.encode(*_UTF_8)) for text in texts])
    return pa.Array.from_buffers(kind, len(texts), [_bits(present), pa.py_buffer(starts), pa.py_buffer(data)])


def _from_buffers(kind: pa.DataType, numbers: NDArray[Any], present: NDArray[np.bool_] | None = None) -> pa.Array:
    """Numbers or truth values, null where they are not present."""
    import numpy as np
    import pyarrow as pa

    data = np.packbits(numbers, bitorder="little") if numbers.dtype == bool else numbers
    return pa.Array.from_buffers(kind, len(numbers), [_bits(present), pa.py_buffer(data)])


def _lists(
    kind: pa.DataType, counts: Sequence[int], entries: pa.Array, present: NDArray[np.bool_] | None = None
) -> pa.Array:
    """Lists of entries that are one behind the other, null where they are not present."""
    import pyarrow as pa

    buffers = [_bits(present), pa.py_buffer(_starts(counts))]
    return pa.Array.from_buffers(kind, len(counts), buffers, children=[entries])


def _starts(lengths: Iterable[int]) -> NDArray[np.int32]:
    """Where each of some values begins, and where the last one ends."""
    import numpy as np

    return np.cumsum([0, *lengths], dtype="int32")


def _bits(present: NDArray[np.bool_] | None) -> pa.Buffer | None:
    """Which values are not null; None where all are there."""
    import numpy as np
    import pyarrow as pa

    return None if present is None or present.all() else pa.py_buffer(np.packbits(present, bitorder="little"))
