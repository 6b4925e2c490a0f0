"""The manifest of a run as a Parquet file, for data science: a row for each manipulator, and a column for each fact.

It is written while the rows pass by; none is kept.
"""

from __future__ import annotations

import io
from importlib.util import find_spec
from itertools import islice
from typing import TYPE_CHECKING, Any, BinaryIO, NamedTuple

import orjson

from dh2urdf.errors import MissingDependencyError

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
    whole: Any = row
    proofs: list[tuple[str, Any]] = [(stage, proof) for stage, proof in row["proof"].items() if proof]
    flat: dict[str, Any] = {name: whole[name] for name in _PLAIN}
    flat["files"] = row["files"]
    for name in ("position_error", "angle_error"):  # the largest that is there
        flat[name] = max((every[name] for _, every in proofs if every[name] is not None), default=None)
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
        if self._is_outgrown:
            self._close()
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
        file = {"path": text, "stage": text, "bytes": pa.int64(), "sha256": text, "shard": text, "offset": pa.int64()}
        types = {
            **dict.fromkeys(_PLAIN, text),
            "keeps_kinematics": pa.bool_(),
            "files": pa.list_(pa.struct(file)),
            **dict.fromkeys(("position_error", "angle_error"), number),
            "proved": texts,
            "error": text,
            **dict.fromkeys(("errors", "notices"), texts),
        }
        for some in _OF_SOME_RUNS:
            types |= {name: kinds[kind] for name, kind in self._kinds.items() if name.startswith(some)}
        return pa.schema(types)
