"""Known tables as files of every format, and as arguments of Python, in the forms that people and programs use."""

from __future__ import annotations

import json
import re
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from file_texts import NUMBER, WORDS, File, flow, statements
from known_arms import COM, LIMITS, TENSOR
from known_tables import GROUPS
from known_units import as_matrix
from known_words import header_words
from row_dialects import as_csv, as_xlsx, first_headers

if TYPE_CHECKING:
    import random
    from collections.abc import Callable
    from pathlib import Path

    from known_quantities import Text
    from known_tables import Arm, Column, Table

__all__ = ["WRITERS", "File", "as_arguments", "as_csv", "flow", "write"]


# --- YAML and JSON ----------------------------------------------------------------------------------------------------


def as_yaml(rng: random.Random, table: Table, *, bulk: bool) -> File:
    """A YAML file: in flow style, or with a line for every key."""
    document = _document(rng, table, bulk=bulk)
    block = rng.random() < 0.5
    text = "\n".join(_block(document, "")) if block else flow(document)
    return File(rng.choice([".yaml", ".yml"]), text.encode(), f"yaml {block}")


def as_json(rng: random.Random, table: Table, *, bulk: bool) -> File:
    """A JSON file, whose numbers are numbers or texts."""
    document = _document(rng, table, bulk=bulk)
    quoted, indent = rng.random() < 0.5, rng.choice([None, 2])
    ascii_only = rng.random() < 0.5
    numbers: list[str] = []

    def leaf(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: leaf(item) for key, item in value.items()}
        if isinstance(value, list):
            return list(map(leaf, value))
        if isinstance(value, str) and not quoted and NUMBER.fullmatch(value):
            numbers.append(value)
            return f"\x00{len(numbers) - 1}\x00"
        return value

    text = json.dumps(leaf(document), indent=indent, ensure_ascii=ascii_only)
    text = re.sub(r'"(?:\\u0000|\x00)(\d+)(?:\\u0000|\x00)"', lambda match: numbers[int(match[1])], text)
    return File(".json", text.encode(), f"json {quoted} {indent} {ascii_only}")


def _document(rng: random.Random, table: Table, *, bulk: bool) -> dict[str, Any]:
    arms = [_mapping(rng, table, arm) for arm in table.arms]
    return {"robots": arms} if bulk else arms[0]


def _mapping(rng: random.Random, table: Table, arm: Arm) -> dict[str, Any]:
    said = {"name": arm.known.name, **table.said, **arm.said}
    nested, listed = rng.random() < 0.5, rng.random() < 0.5
    keys = {part: _key(rng, part, table.language) for column in table.columns for part in parts_of(column)}
    joints = [_joint(table, row, keys, nested=nested, listed=listed) for row in arm.rows]
    return {**said, "joints": joints}


def _key(rng: random.Random, field: str, language: str) -> str:
    found = [*header_words(field, language), *header_words(field)]
    # In modified rows r is Khalil's and Kleinfinger's offset, or is refused beside d.
    choices = [word for word in found if re.fullmatch(r"[\w ]+", word) and (field, word) != ("a", "r")]
    return rng.choice(choices) if rng.random() < 0.3 else field if field != "joint" else "name"


def parts_of(column: Column) -> tuple[str, ...]:
    """The fields of a column, of which keys of YAML have one each; an index is no key."""
    return () if column.field == "index" else GROUPS.get(column.field, (column.field,))


def _joint(table: Table, row: dict[str, Text], keys: dict[str, str], *, nested: bool, listed: bool) -> dict[str, Any]:
    """A joint: keys have no units, so that every number of a column with a unit has it itself."""
    texts = {
        part: row[part].full if column.unit else row[part].bare for column in table.columns for part in parts_of(column)
    }
    texts = {key: text for key, text in texts.items() if text}
    joint: dict[str, Any] = {}
    if listed and set(COM) <= texts.keys():
        joint["com"] = [texts.pop(key) for key in COM]
    if set(TENSOR) <= texts.keys():
        parts = {key: texts.pop(key) for key in TENSOR}
        joint["inertia"] = as_matrix(parts) if listed else parts
    limits = {key: texts.pop(key) for key in LIMITS if nested and key in texts}
    if limits:
        joint["limits"] = limits
    return {keys[key]: text for key, text in texts.items()} | joint


def _block(value: Any, indent: str) -> list[str]:
    """A mapping with a line for each key, its lists of mappings with a dash for each item."""
    lines = []
    for key, item in value.items():
        if isinstance(item, list) and item and isinstance(item[0], dict):
            lines.append(f"{indent}{key}:")
            for part in item:
                first, *rest = _block(part, indent + "    ")
                lines += [f"{indent}  - {first.strip()}", *rest]
        else:
            lines.append(f"{indent}{key}: {flow(item)}")
    return lines


# --- Parquet ----------------------------------------------------------------------------------------------------------


def as_parquet(rng: random.Random, table: Table, *, bulk: bool) -> File:
    """A Parquet file, whose columns of numbers are texts, doubles, decimals or whole numbers."""
    import io

    import pyarrow as pa
    from pyarrow import parquet

    in_metadata = rng.random() < 0.4
    columns: list[tuple[str, list[str], bool, dict[str, str]]] = []
    before = first_headers(rng, table, bulk=bulk)
    if bulk:
        columns.append((before[0], [arm.known.name for arm in table.arms for _ in arm.rows], True, {}))
    if table.convention_column:
        columns.append((before[-1], [arm.said["convention"] for arm in table.arms for _ in arm.rows], True, {}))
    for column in table.columns:
        header, unit = column.header, {}
        if in_metadata and column.parts and column.parts.unit:
            header, unit = column.parts.stem, {rng.choice(["unit", "units"]): column.parts.unit}
        texts = [row[column.field].bare for arm in table.arms for row in arm.rows]
        columns.append((header, texts, column.field in WORDS, unit))
    arrays, parts, kinds = [], [], []
    for header, texts, is_word, unit in columns:
        kind, array = _array(rng, texts, is_word=is_word)
        arrays.append(array)
        parts.append(pa.field(header, array.type, metadata=unit or None))
        kinds.append(kind)
    said = {f"dh2urdf.{key}": flow(value) for key, value in statements(table, bulk=bulk).items()}
    schema_table = pa.table(arrays, schema=pa.schema(parts, metadata=said))
    file = io.BytesIO()
    parquet.write_table(schema_table, file, row_group_size=rng.choice([1, 7, 100_000]))
    return File(".parquet", file.getvalue(), f"parquet {in_metadata} {' '.join(sorted(set(kinds)))}")


def _array(rng: random.Random, texts: list[str], *, is_word: bool) -> tuple[str, Any]:
    import pyarrow as pa

    gaps = [text or None for text in texts] if rng.random() < 0.5 else texts
    if is_word or not all(NUMBER.fullmatch(text) or not text for text in texts):
        if rng.random() < 0.3:
            return "dictionary", pa.array(gaps, pa.string()).dictionary_encode()
        return "text", pa.array(gaps, rng.choice([pa.string(), pa.large_string()]))
    kinds: dict[str, Callable[[], Any]] = {
        "double": lambda: pa.array([float(text) if text else None for text in texts], pa.float64()),
        "dictionary of doubles": lambda: pa.array(
            [float(text) if text else None for text in texts], pa.float64()
        ).dictionary_encode(),
        "number as text": lambda: pa.array(gaps, pa.string()),
    }
    if all(re.fullmatch("(-?[0-9]{1,9})?", text) for text in texts):
        kinds["int64"] = lambda: pa.array([int(text) if text else None for text in texts], pa.int64())
    if all(re.fullmatch(r"-?[0-9]{1,9}(\.[0-9]{1,12})?", text) for text in texts):
        kinds["decimal"] = lambda: pa.array([Decimal(text) for text in texts], pa.decimal128(30, 12))
    kind = rng.choice(sorted(kinds))
    return kind, kinds[kind]()


# --- Python -----------------------------------------------------------------------------------------------------------


def as_arguments(rng: random.Random, table: Table) -> tuple[Any, dict[str, Any]]:
    """The only arm of a table as rows for `Manipulator.from_dh`, and the other arguments."""
    arm = table.arms[0]
    numbers = rng.random() < 0.5 and not table.in_texts

    def value(text: str, field: str) -> Any:
        if numbers and field not in WORDS and NUMBER.fullmatch(text):
            return float(text)
        return text

    before = dict(zip(first_headers(rng, table, bulk=False), arm.said.values(), strict=True))
    rows = [
        {**before, **{column.header: value(row[column.field].bare, column.field) for column in table.columns}}
        for row in arm.rows
    ]
    if rng.random() < 0.5:
        header = list(rows[0])
        return [header, *([row[name] for name in header] for row in rows)], _arguments(table)
    return rows, _arguments(table)


def _arguments(table: Table) -> dict[str, Any]:
    units = (
        {**table.said["units"], **table.options["units"]} if {"units"} <= table.said.keys() & table.options else None
    )
    return {"name": table.arms[0].known.name, **table.said, **table.options} | ({"units": units} if units else {})


WRITERS: dict[str, Callable[..., File]] = {
    "csv": as_csv,
    "yaml": as_yaml,
    "json": as_json,
    "parquet": as_parquet,
    "xlsx": as_xlsx,
}


def write(file: File, folder: Path, stem: str) -> Path:
    """Writes a file into a folder."""
    path = folder / f"{stem}{file.suffix}"
    path.write_bytes(file.content)
    return path
