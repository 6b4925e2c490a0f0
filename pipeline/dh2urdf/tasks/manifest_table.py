"""The manifest of a run as a Parquet file, for data science: a row for each manipulator, and a column for each fact.

It is written while the rows pass by; none is kept.
"""

from __future__ import annotations

from importlib.util import find_spec
from itertools import islice
from typing import TYPE_CHECKING, Any, BinaryIO, get_args, get_origin, get_type_hints, is_typeddict

from orjson import loads

from dh2urdf.results.run import ManipulatorEntry, ProblemEntry, ProofEntry

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator, Mapping, Sequence
    from pathlib import Path

    import numpy as np
    import pyarrow as pa
    from numpy.typing import NDArray
    from pyarrow.parquet import ParquetWriter

    from dh2urdf.conversion.outcome import ManifestRow

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
        self._columns = _Columns()
        self._waiting: list[bytes] = []
        self._writer: ParquetWriter | None = None
        self._is_outgrown = False

    def add(self, rows: Iterable[ManifestRow], lines: Iterable[bytes]) -> None:
        """Take rows of the manifest.

        Args:
            rows: those that may have other columns, or other kinds of values, than the rows before them.
            lines: all, as lines of JSON.

        Raises:
            OSError: the file cannot be written.
        """
        for row in rows:
            self._columns.see(row)
        self._waiting += lines
        while len(self._waiting) >= ROW_GROUP:
            self._write(self._waiting[:ROW_GROUP])
            del self._waiting[:ROW_GROUP]

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
            while some := list(islice(manifest, ROW_GROUP)):
                self._write(some)
            self._close()

    def _write(self, lines: list[bytes]) -> None:
        """Write a row group, if the columns are those of the groups before."""
        from pyarrow import parquet

        schema = self._columns.schema()
        if self._writer is None:
            self._writer = parquet.ParquetWriter(self.path, schema, use_dictionary=_REPEATED)
        self._is_outgrown = self._is_outgrown or self._writer.schema != schema
        if lines and not self._is_outgrown:
            self._writer.write_batch(self._columns.batch(lines), ROW_GROUP)

    def _close(self) -> None:
        if self._writer is not None:
            self._writer.close()
            self._writer = None


_REPEATED = ["status", "kind", "source"]
"""Columns of few different texts; a dictionary of any other would be as long as the column."""
_BLOCK = 1 << 20
"""How much text pyarrow reads at once [byte], besides the longest line."""


class _Columns:
    """The columns that rows of a manifest fill.

    pyarrow reads them from the lines by itself, in a quarter of the time that they would take as objects of Python. It
    cannot read a value that is a number here and text there, nor reports of simulators, of which no two are alike.
    """

    def __init__(self) -> None:
        self._drawn, self._loaders = _Kinds(), _Kinds()
        self._stages: dict[str, None] = {}

    def see(self, row: ManifestRow) -> None:
        """Learns from one row."""
        self._drawn.see(row["drawn"])
        if loads := _loads(row):
            self._loaders.see(loads)
        self._stages |= dict.fromkeys(row["proof"])

    def schema(self) -> pa.Schema:
        """The columns and their types."""
        import pyarrow as pa

        text, number, texts = pa.string(), pa.float64(), pa.list_(pa.string())
        types = {
            **_common_types(),
            **dict.fromkeys(("position_error", "angle_error"), number),
            "proved": texts,
            "error": text,
            **dict.fromkeys(("errors", "notices"), texts),
            **{f"drawn.{name}": kind for name, kind in self._drawn.types().items()},
            **{f"loaders.{name}": kind for name, kind in self._loaders.types().items()},
        }
        return pa.schema(types)

    def batch(self, lines: list[bytes]) -> pa.RecordBatch:
        """Some rows, as lines of JSON, in columns."""
        import pyarrow as pa

        schema = self.schema()
        read = self._read(lines)
        proofs = read["proof"].flatten() if self._stages else []
        drawn = read["drawn"].flatten() if self._drawn.alike() else []
        errors, notices = _messages_of(read["errors"]), _messages_of(read["notices"])
        columns = {
            **{name: read[name] for name in _common_types()},
            "position_error": _largest([proof.field("position_error") for proof in proofs], len(lines)),
            "angle_error": _largest([proof.field("angle_error") for proof in proofs], len(lines)),
            "proved": _where_there(list(self._stages), proofs, len(lines)),
            "error": _first_of(errors),
            "errors": errors,
            "notices": notices,
            **{f"drawn.{name}": column for name, column in zip(self._drawn.alike(), drawn, strict=True)},
        }
        if self._drawn.mixed or self._loaders.kinds:
            rows = [loads(line) for line in lines]
            by_hand = self._drawn.columns("drawn", self._drawn.mixed, [row["drawn"] for row in rows])
            reports = [_loads(row) for row in rows]
            by_hand |= self._loaders.columns("loaders", self._loaders.kinds, reports)
            columns |= {name: pa.array(values, schema.field(name).type) for name, values in by_hand.items()}
        return pa.record_batch([columns[name] for name in schema.names], schema=schema)

    def _read(self, lines: list[bytes]) -> dict[str, pa.Array]:
        """What pyarrow makes of the lines."""
        import pyarrow as pa
        from pyarrow import json

        problems = pa.list_(pa.struct(_types(ProblemEntry, "message")))
        types = {**_common_types(), "errors": problems, "notices": problems}
        if self._stages:
            proof = pa.struct(_types(ProofEntry, "position_error", "angle_error"))
            types["proof"] = pa.struct(dict.fromkeys(self._stages, proof))
        if drawn := self._drawn.alike():
            types["drawn"] = pa.struct(drawn)
        table = json.read_json(
            pa.BufferReader(b"".join(lines)),
            read_options=json.ReadOptions(use_threads=False, block_size=_BLOCK + max(map(len, lines))),
            parse_options=json.ParseOptions(explicit_schema=pa.schema(types), unexpected_field_behavior="ignore"),
        )
        return {name: table[name].combine_chunks() for name in types}


def _common_types() -> dict[str, pa.DataType]:
    """The columns that are in a row as they are."""
    return _types(ManipulatorEntry, "name", "status", "kind", "source", "key", "keeps_kinematics", "files")


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


# `pyarrow.array`, `pyarrow.scalar` and `to_numpy` import pandas where it is installed, which takes 0.2 s; `take`,
# `cast` and `is_valid` import `pyarrow.compute`, which takes 0.06 s, a tenth of a short run.


def _largest(columns: Sequence[pa.Array], count: int) -> pa.Array:
    """The largest number of each of `count` rows, nulls aside."""
    import numpy as np

    largest, present = np.full(count, -np.inf), np.zeros(count, dtype=bool)
    for column in columns:
        valid = _present(column)
        largest = np.maximum(largest, np.where(valid, _numbers(column, "float64"), -np.inf))
        present |= valid
    return _array(largest, present)


def _where_there(names: Sequence[str], columns: Sequence[pa.Array], count: int) -> pa.Array:
    """For each of `count` rows, the names of the columns in which it is not null."""
    import numpy as np
    import pyarrow as pa

    there = np.zeros((count, len(names)), dtype=bool)
    for index, column in enumerate(columns):
        there[:, index] = _present(column)
    ends = np.cumsum([0, *there.sum(axis=1)], dtype="int32")
    texts = [name.encode() for name in names]
    words = [texts[index] for index in there.nonzero()[1].tolist()]
    starts = np.cumsum([0, *map(len, words)], dtype="int32")
    strings = pa.StringArray.from_buffers(len(words), pa.py_buffer(starts), pa.py_buffer(b"".join(words)))
    return pa.ListArray.from_arrays(_array(ends), strings)


def _present(array: pa.Array) -> NDArray[np.bool_]:
    """Which entries of an array are not null."""
    import numpy as np

    if not array.null_count:
        return np.ones(len(array), dtype=bool)
    bits = np.frombuffer(array.buffers()[0], dtype="uint8")
    return np.unpackbits(bits, count=array.offset + len(array), bitorder="little")[array.offset :].astype(bool)


def _numbers(array: pa.Array, dtype: str) -> NDArray[Any]:
    """The numbers of an array without nulls."""
    import numpy as np

    return np.frombuffer(array.buffers()[1], dtype=dtype)[array.offset : array.offset + len(array)]


def _array(numbers: NDArray[Any], present: NDArray[np.bool_] | None = None) -> pa.Array:
    """Doubles, or whole numbers of 32 bits, as an array, null where they are not present."""
    import numpy as np
    import pyarrow as pa

    kind = pa.float64() if numbers.dtype == np.float64 else pa.int32()
    bits = None if present is None or present.all() else pa.py_buffer(np.packbits(present, bitorder="little"))
    return pa.Array.from_buffers(kind, len(numbers), [bits, pa.py_buffer(numbers)])


def _messages_of(problems: pa.Array) -> pa.Array:
    """The messages of lists of problems."""
    import pyarrow as pa

    return pa.ListArray.from_arrays(problems.offsets, problems.values.field("message"))


def _first_of(lists: pa.Array) -> pa.Array:
    """The first entry of each list; null where it is empty."""
    import pyarrow as pa

    offsets = _numbers(lists.offsets, "int32")
    present = offsets[1:] > offsets[:-1]
    return lists.values.take(_array(offsets[:-1], present)) if present.any() else pa.nulls(len(lists), pa.string())


class _Kinds:
    """The facts of some mappings that are not alike, and what they are: truth values, numbers, text, lists of text.

    Attributes:
        kinds: by name, in the order of their first appearance; what is of several kinds is text.
        mixed: the names of what is of several kinds.
    """

    def __init__(self) -> None:
        self.kinds: dict[str, type] = {}
        self.mixed: dict[str, None] = {}
        self._last: tuple[tuple[str, ...], tuple[type, ...]] = (), ()

    def see(self, facts: Mapping[str, Any]) -> None:
        """Learns from one mapping."""
        form = tuple(facts), tuple(map(type, facts.values()))
        if form == self._last:
            return
        self._last = form
        for name, value in facts.items():
            if value is not None:
                kind = float if type(value) is int else type(value)
                if self.kinds.setdefault(name, kind) is not kind:
                    self.kinds[name] = str
                    self.mixed[name] = None

    def types(self) -> dict[str, pa.DataType]:
        """The types of their columns."""
        import pyarrow as pa

        of_kind = {bool: pa.bool_(), float: pa.float64(), str: pa.string(), list: pa.list_(pa.string())}
        return {name: of_kind[kind] for name, kind in self.kinds.items()}

    def alike(self) -> dict[str, pa.DataType]:
        """The types of those that are of one kind."""
        return {name: kind for name, kind in self.types().items() if name not in self.mixed}

    def columns(self, prefix: str, names: Iterable[str], rows: Sequence[Mapping[str, Any]]) -> dict[str, list[Any]]:
        """The facts of some names, by column."""
        columns = {}
        for name in names:
            values = [row.get(name) for row in rows]
            if self.kinds[name] is str:
                values = [value if value is None else str(value) for value in values]
            columns[f"{prefix}.{name}"] = values
        return columns


def _messages(problems: Iterable[Mapping[str, Any]]) -> list[str]:
    return [problem["message"] for problem in problems]


def _loads(row: ManifestRow) -> dict[str, Any]:
    """What is known of the loaders of a run, of those too that a manipulator did not go through."""
    unasked = {f"{name}.verdict": why for name, why in row.get("not_loaded", {}).items()}
    return {**dict(_leaves(row["loaders"])), **unasked}


def _leaves(facts: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The facts in mappings inside each other, by the names that lead to them; of lists only those of problems."""
    waiting = list(facts.items())[::-1]
    while waiting:
        name, value = waiting.pop()
        if isinstance(value, dict):
            waiting += [(f"{name}.{key}", entry) for key, entry in value.items()][::-1]
        elif not isinstance(value, list):
            yield name, value
        elif name.endswith((".findings", ".errors")):
            yield name, _messages(value)
