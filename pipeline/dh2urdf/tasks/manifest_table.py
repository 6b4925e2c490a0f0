"""The manifest of a run as a Parquet file, for data science: a row for each manipulator, and a column for each fact.

It is written while the rows pass by; none is kept.
"""

from __future__ import annotations

import io
from importlib.util import find_spec
from itertools import islice
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple, get_args, get_origin, get_type_hints, is_typeddict

import orjson

from dh2urdf.errors import MissingDependencyError
from dh2urdf.results import ManipulatorEntry

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence
    from pathlib import Path

    import pyarrow as pa
    from pyarrow.parquet import ParquetWriter

    from dh2urdf.conversion.outcome import ManifestRow

ROW_GROUP = 10_000
"""Manipulators in a row group of the Parquet file: as many are in memory at once."""
_PLAIN = ("name", "status", "kind", "source", "key", "keeps_kinematics")
"""What a table has of a row as it is."""
_REPEATED = ["status", "kind", "source"]
"""Columns of few different texts; a dictionary of any other would be as long as the column."""
_OF_SOME_RUNS = ("drawn.", "loaders.")
"""How the names of columns begin that not all runs have."""


def can_write_parquet() -> bool:
    """Whether pyarrow is installed; it is not imported."""
    return find_spec("pyarrow") is not None


class TableRows(NamedTuple):
    """Rows of the table, which a worker makes of rows of the manifest that it has at hand.

    Attributes:
        lines: each as a line of JSON.
        kinds: the columns that not all runs have, in the order in which they have a value for the first time: whether
            they hold truth values, numbers, text, lists of text, or objects of several kinds, which become text.
    """

    lines: Sequence[bytes]
    kinds: Mapping[str, type]


def table_rows(rows: Sequence[ManifestRow]) -> TableRows:
    """The rows of the table for some rows of the manifest."""
    lines, seen = [], dict[tuple[str, type], None]()
    for row in rows:
        flat = _flat(row)
        seen.update(dict.fromkeys(zip(flat, map(type, flat.values()), strict=True)))
        lines.append(orjson.dumps(flat))
    kinds: dict[str, type] = {}
    for name, kind in seen:
        if name.startswith(_OF_SOME_RUNS) and kind is not type(None):
            _see(kinds, name, float if kind is int else kind)
    return TableRows(lines, kinds)


def _see(kinds: dict[str, type], name: str, kind: type) -> None:
    if kinds.setdefault(name, kind) is not kind:
        kinds[name] = object


def _flat(row: ManifestRow) -> dict[str, Any]:
    """A row of the table by the names of its columns."""
    every: Any = row
    proofs = [(stage, proof) for stage, proof in row["proof"].items() if proof]
    flat: dict[str, Any] = {name: every[name] for name in _PLAIN}
    flat["files"] = row["files"]
    flat["position_error"] = _largest([proof["position_error"] for _, proof in proofs])
    flat["angle_error"] = _largest([proof["angle_error"] for _, proof in proofs])
    flat["proved"] = [stage for stage, _ in proofs]
    flat["errors"] = errors = [problem["message"] for problem in row["errors"]]
    flat["error"] = errors[0] if errors else None
    flat["notices"] = [problem["message"] for problem in row["notices"]]
    for name, value in row["drawn"].items():
        flat[f"drawn.{name}"] = value
    if row["loaders"]:
        flat |= _leaves("loaders", row["loaders"])
    for name, why in row.get("not_loaded", {}).items():
        flat[f"loaders.{name}.verdict"] = why
    return flat


def _largest(numbers: Sequence[float | None]) -> float | None:
    """The largest number that is there; None where none is."""
    return max([number for number in numbers if number is not None], default=None)


def _leaves(prefix: str, facts: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    """The facts in mappings inside each other, by the names that lead to them; of lists only those of problems."""
    for key, value in facts.items():
        name = f"{prefix}.{key}"
        if isinstance(value, dict):
            yield from _leaves(name, value)
        elif not isinstance(value, list):
            yield name, value
        elif key in ("findings", "errors"):
            yield name, [problem["message"] for problem in value]


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
        self._waiting: list[bytes] = []
        self._writer: ParquetWriter | None = None
        self._is_outgrown = False

    def add(self, rows: TableRows) -> None:
        """Take rows of the manifest.

        Raises:
            OSError: the file cannot be written.
        """
        for name, kind in rows.kinds.items():
            _see(self._kinds, name, kind)
        self._waiting += rows.lines
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
            while some := [orjson.loads(line) for line in islice(manifest, ROW_GROUP)]:
                self._write(table_rows(some).lines)
            self._close()

    def _write(self, lines: Sequence[bytes]) -> None:
        """Write a row group, if the columns are those of the groups before.

        Raises:
            MissingDependencyError: pyarrow is installed and cannot be imported.
        """
        try:
            from pyarrow import json, parquet
        except ImportError as error:
            raise MissingDependencyError("manifest.parquet", "pyarrow", "dh2urdf[parquet]", error) from error

        schema = self._schema()
        if self._writer is None:
            self._writer = parquet.ParquetWriter(self.path, schema, use_dictionary=_REPEATED)
        self._is_outgrown = self._is_outgrown or self._writer.schema != schema
        if lines and not self._is_outgrown:
            # Unlike what it is given as Python's lists, pyarrow reads JSON without importing pandas, which takes 0.2 s.
            if mixed := [name for name, kind in self._kinds.items() if kind is object]:
                rows = [orjson.loads(line) for line in lines]
                texts = [{name: str(row[name]) for name in mixed if row.get(name) is not None} for row in rows]
                lines = [orjson.dumps(row | text) for row, text in zip(rows, texts, strict=True)]
            data = b"\n".join(lines)
            columns = json.read_json(
                io.BytesIO(data),
                json.ReadOptions(use_threads=False, block_size=len(data) + 1),
                json.ParseOptions(explicit_schema=schema, unexpected_field_behavior="ignore"),
            )
            self._writer.write_table(columns, ROW_GROUP)

    def _close(self) -> None:
        if self._writer is not None:
            self._writer.close()
            self._writer = None

    def _schema(self) -> pa.Schema:
        """The columns and their types."""
        import pyarrow as pa

        text, number, texts = pa.string(), pa.float64(), pa.list_(pa.string())
        kinds = {bool: pa.bool_(), float: number, str: text, object: text, list: texts}
        types = {
            **_types(ManipulatorEntry, *_PLAIN, "files"),
            **dict.fromkeys(("position_error", "angle_error"), number),
            "proved": texts,
            "error": text,
            **dict.fromkeys(("errors", "notices"), texts),
        }
        for some in _OF_SOME_RUNS:
            types |= {name: kinds[kind] for name, kind in self._kinds.items() if name.startswith(some)}
        return pa.schema(types)


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
