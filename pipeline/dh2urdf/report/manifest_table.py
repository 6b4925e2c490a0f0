"""The manifest of a run as a Parquet file, for data science: a row for each manipulator, and a column for each fact.

Its rows are read from the manifest, group by group.
"""

from __future__ import annotations

import io
from importlib.util import find_spec
from itertools import islice
from typing import TYPE_CHECKING, Any, BinaryIO

import orjson

from dh2urdf.errors import MissingDependencyError

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping
    from pathlib import Path

    from dh2urdf.conversion.outcome import ManifestRow

ROW_GROUP = 10_000  # manipulators in a row group of the Parquet file: as many are in memory at once
_PLAIN = ("name", "status", "kind", "source", "key", "keeps_kinematics")  # what a table has of a row as it is
_REPEATED = ["status", "kind", "source"]
"""Columns of few different texts; a dictionary of any other would be as long as the column."""


def can_write_parquet() -> bool:
    """Whether pyarrow is installed; it is not imported."""
    return find_spec("pyarrow") is not None


def _flat(row: ManifestRow) -> dict[str, Any]:
    """A row of the table by the names of its columns."""
    whole: Any = row
    proofs: list[tuple[str, Any]] = [(stage, proof) for stage, proof in row["proof"].items() if proof]
    flat: dict[str, Any] = {name: whole[name] for name in (*_PLAIN, "files")}
    for name in ("position_error", "angle_error"):  # the largest that is there
        flat[name] = max((every[name] for _, every in proofs if every[name] is not None), default=None)
    flat["proved"] = [stage for stage, _ in proofs]
    flat["errors"] = errors = [problem["message"] for problem in row["errors"]]
    flat["error"] = errors[0] if errors else None
    flat["notices"] = [problem["message"] for problem in row["notices"]]
    return flat | dict(_of_some_runs(row))


def _of_some_runs(row: ManifestRow) -> Iterator[tuple[str, Any]]:
    """The facts of a row that not all runs have, by the names of their columns."""
    for name, value in row["drawn"].items():
        yield f"drawn.{name}", value
    yield from _leaves("loaders", row["loaders"])
    for name, why in row.get("not_loaded", {}).items():
        yield f"loaders.{name}.verdict", why


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
    """A manifest as a Parquet file; docs/report.md lists its columns.

    The same rows give the same bytes with the same version of pyarrow.
    """

    def __init__(self) -> None:
        self._kinds: dict[str, type] = {}

    def add(self, row: ManifestRow) -> None:
        """Note the columns of a row that not all runs have, with their types; values of several types become text."""
        for name, value in _of_some_runs(row):
            if value is not None:
                kind = float if type(value) is int else type(value)
                if self._kinds.setdefault(name, kind) is not kind:
                    self._kinds[name] = object

    def write(self, path: Path, manifest: BinaryIO) -> None:
        """Write the file of the rows of a manifest, each of which was added."""
        try:
            import pyarrow as pa
            from pyarrow import json, parquet
        except ImportError as error:
            raise MissingDependencyError("manifest.parquet", "pyarrow", "dh2urdf[parquet]", error) from error

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
        for some in ("drawn.", "loaders."):
            types |= {name: kinds[kind] for name, kind in self._kinds.items() if name.startswith(some)}
        schema = pa.schema(types)
        mixed = [name for name, kind in self._kinds.items() if kind is object]
        manifest.seek(0)
        with parquet.ParquetWriter(path, schema, use_dictionary=_REPEATED) as writer:
            while rows := [_flat(orjson.loads(line)) for line in islice(manifest, ROW_GROUP)]:
                for row in rows if mixed else ():
                    row |= {name: str(row[name]) for name in mixed if row.get(name) is not None}
                # Unlike what it is given as Python's lists, pyarrow reads JSON without importing pandas: 0.2 s.
                data = b"\n".join(map(orjson.dumps, rows))
                columns = json.read_json(
                    io.BytesIO(data),
                    json.ReadOptions(use_threads=False, block_size=len(data) + 1),
                    json.ParseOptions(explicit_schema=schema, unexpected_field_behavior="ignore"),
                )
                writer.write_table(columns, ROW_GROUP)
