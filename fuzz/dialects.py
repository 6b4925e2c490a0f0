"""Known tables as files of every format, and as arguments of Python, in the forms that people and programs use."""

from __future__ import annotations

import codecs
import json
import re
from dataclasses import dataclass
from decimal import Decimal
from typing import TYPE_CHECKING, Any

from known_arms import COM, LIMITS, TENSOR, Text, words

if TYPE_CHECKING:
    import random
    from collections.abc import Callable, Sequence
    from pathlib import Path

    from known_tables import Arm, Table

WORDS = ("joint", "link", "type", "sign", "flip")
"""Fields whose cells are no quantities; of these, sign and flip are written the same in every dialect."""
_NUMBER = re.compile(r"-?(0|[1-9][0-9]*)(\.[0-9]+)?(e-?[0-9]+)?")
_SAFE = re.compile(r"[-+.(]?[^\W_][\w .°·²*/()+−-]*(?<! )")
_WORD_OF_YAML = re.compile(r"(?i)true|false|yes|no|on|off|null|~|[-+]?\.?(inf|nan)|[yn]")


@dataclass(frozen=True)
class File:
    """A file, and what describes its dialect in figures."""

    suffix: str
    content: bytes
    dialect: str


# --- CSV --------------------------------------------------------------------------------------------------------------


def as_csv(rng: random.Random, table: Table, *, bulk: bool, plain: bool = False) -> File:
    """A CSV file of all arms of a table, or of its only one."""
    delimiter = "," if plain else rng.choice(",,;\t")
    comma = delimiter != "," and rng.random() < 0.5
    always = not plain and rng.random() < 0.2
    padding = 0 if plain or rng.random() < 0.7 else rng.randint(1, 4)
    space = "" if plain or always or rng.random() < 0.6 else " "
    columns = table.columns
    header = [column.header for column in columns]
    lines = [f"# {key}: {flow(value)}" for key, value in _statements(table, bulk=bulk).items()]
    if not plain and rng.random() < 0.3:
        lines.insert(rng.randint(0, len(lines)), rng.choice(["", "# from a data sheet, page 12", "#"]))

    def line(texts: Sequence[str]) -> str:
        cells = [_cell(text, delimiter, always=always) for text in texts] + [""] * padding
        return delimiter.join(space + cell if space and not cell.startswith('"') else cell for cell in cells)

    before = (["robot"] if bulk else []) + (["convention"] if table.convention_column else [])
    lines.append(line([*before, *header]))
    for arm in table.arms:
        for row in arm.rows:
            texts = [
                _with_comma(row[column.field].bare, comma=comma and column.field not in WORDS) for column in columns
            ]
            lines.append(line(([arm.known.name] if bulk else []) + list(arm.said.values()) + texts))
            if not plain and rng.random() < 0.05:
                lines.append(rng.choice(["", "# a note", delimiter * len(header), " "]))
    if delimiter != "," and rng.random() < 0.2:
        lines.insert(0, f"sep={delimiter}")
    end = "\n" if plain else rng.choice(["\n", "\n", "\r\n", "\r"])
    encoding = "utf-8" if plain else rng.choice(["utf-8", "utf-8", "utf-8-sig", "utf-16", "utf-16-le", "utf-16-be"])
    bom = {"utf-16-le": codecs.BOM_UTF16_LE, "utf-16-be": codecs.BOM_UTF16_BE}.get(encoding, b"")
    text = end.join(lines) + rng.choice(["", end])
    dialect = f"csv {delimiter!r} {comma} {always} {bool(padding)} {bool(space)} {end!r} {encoding}"
    return File(".csv" if delimiter != "\t" else ".tsv", bom + text.encode(encoding), dialect)


def _statements(table: Table, *, bulk: bool) -> dict[str, Any]:
    """What a file of rows says above them."""
    return table.said if bulk else {"name": table.arms[0].known.name, **table.said}


def _cell(text: str, delimiter: str, *, always: bool) -> str:
    if always or delimiter in text or '"' in text or text.startswith("#"):
        return '"' + text.replace('"', '""') + '"'
    return text


def _with_comma(text: str, *, comma: bool) -> str:
    return re.sub(r"(?<=[0-9])\.(?=[0-9])", ",", text) if comma else text


def flow(value: Any) -> str:
    """A value of YAML in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{flow(key)}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(flow, value)) + "]"
    if value is None:
        return "null"
    return value if _SAFE.fullmatch(value) and not _WORD_OF_YAML.fullmatch(value) else json.dumps(value)


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
        if isinstance(value, str) and not quoted and _NUMBER.fullmatch(value):
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
    keys = {column.field: _key(rng, column.field) for column in table.columns}
    joints = [_joint(table, row, keys, nested=nested, listed=listed) for row in arm.rows]
    return {**said, "joints": joints}


def _key(rng: random.Random, field: str) -> str:
    choices = [word for word in words("headers", field) if re.fullmatch(r"[\w ]+", word) and word.isascii()]
    return rng.choice(choices) if rng.random() < 0.3 else field if field != "joint" else "name"


def _joint(table: Table, row: dict[str, Text], keys: dict[str, str], *, nested: bool, listed: bool) -> dict[str, Any]:
    """A joint: keys have no units, so that every number of a column with a unit has it itself."""
    texts = {
        column.field: row[column.field].full if column.unit else row[column.field].bare for column in table.columns
    }
    texts = {key: text for key, text in texts.items() if text}
    joint: dict[str, Any] = {}
    if listed and set(COM) <= texts.keys():
        joint["com"] = [texts.pop(key) for key in COM]
    if set(TENSOR) <= texts.keys():
        xx, yy, zz, xy, xz, yz = (texts.pop(key) for key in TENSOR)
        joint["inertia"] = (
            [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
            if listed
            else dict(zip(TENSOR, (xx, yy, zz, xy, xz, yz), strict=True))
        )
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

    columns: dict[str, list[str]] = {}
    if bulk:
        columns["robot"] = [arm.known.name for arm in table.arms for _ in arm.rows]
    if table.convention_column:
        columns["convention"] = [arm.said["convention"] for arm in table.arms for _ in arm.rows]
    for column in table.columns:
        columns[column.header] = [row[column.field].bare for arm in table.arms for row in arm.rows]
    words_ = {"robot", "convention", *(column.header for column in table.columns if column.field in WORDS)}
    arrays, kinds = {}, []
    for header, texts in columns.items():
        kind, array = _array(rng, texts, is_word=header in words_)
        arrays[header] = array
        kinds.append(kind)
    said = {f"dh2urdf.{key}": flow(value) for key, value in _statements(table, bulk=bulk).items()}
    schema_table = pa.table(arrays).replace_schema_metadata(said)
    file = io.BytesIO()
    parquet.write_table(schema_table, file, row_group_size=rng.choice([1, 7, 100_000]))
    return File(".parquet", file.getvalue(), f"parquet {' '.join(sorted(set(kinds)))}")


def _array(rng: random.Random, texts: list[str], *, is_word: bool) -> tuple[str, Any]:
    import pyarrow as pa

    gaps = [text or None for text in texts] if rng.random() < 0.5 else texts
    if is_word or not all(_NUMBER.fullmatch(text) or not text for text in texts):
        if rng.random() < 0.3:
            return "dictionary", pa.array(gaps, pa.string()).dictionary_encode()
        return "text", pa.array(gaps, rng.choice([pa.string(), pa.large_string()]))
    kinds: dict[str, Callable[[], Any]] = {
        "double": lambda: pa.array([float(text) if text else None for text in texts], pa.float64()),
        "number as text": lambda: pa.array(gaps, pa.string()),
    }
    if all(re.fullmatch("(-?[0-9]{1,9})?", text) for text in texts):
        kinds["int64"] = lambda: pa.array([int(text) if text else None for text in texts], pa.int64())
    if all(re.fullmatch(r"-?[0-9]{1,9}(\.[0-9]{1,12})?", text) for text in texts):
        kinds["decimal"] = lambda: pa.array([Decimal(text) for text in texts], pa.decimal128(30, 12))
    kind = rng.choice(sorted(kinds))
    return kind, kinds[kind]()


# --- Workbooks --------------------------------------------------------------------------------------------------------


def as_xlsx(rng: random.Random, table: Table, *, bulk: bool) -> File:
    """A workbook, whose table stands anywhere on its sheet, with numbers as numbers or as texts."""
    import io

    from openpyxl import Workbook

    book = Workbook()
    sheet = book.active
    row, left = rng.randint(1, 4), rng.randint(1, 3)
    numbers, beside = rng.random() < 0.7, rng.random() < 0.5
    for key, value in _statements(table, bulk=bulk).items():
        parts = [key, flow(value)] if beside else [f"{rng.choice(['# ', ''])}{key}: {flow(value)}"]
        for column, text in enumerate(parts, start=left):
            sheet.cell(row, column, text)
        row += 1
    before = (["robot"] if bulk else []) + (["convention"] if table.convention_column else [])
    for column, text in enumerate([*before, *(column.header for column in table.columns)], start=left):
        sheet.cell(row, column, text)
    for arm in table.arms:
        for cells in arm.rows:
            row += 1
            texts = [(text, False) for text in ([arm.known.name] if bulk else []) + list(arm.said.values())]
            texts += [(cells[column.field].bare, column.field not in WORDS) for column in table.columns]
            for column, (text, is_quantity) in enumerate(texts, start=left):
                is_number = is_quantity and numbers and bool(_NUMBER.fullmatch(text))
                is_number = is_number and float(f"{float(text):.16g}") == float(text)  # openpyxl writes 16 digits
                if text:
                    sheet.cell(row, column).value = float(text) if is_number else text
    file = io.BytesIO()
    book.save(file)
    return File(".xlsx", file.getvalue(), f"xlsx {numbers} {beside}")


# --- Python -----------------------------------------------------------------------------------------------------------


def as_arguments(rng: random.Random, table: Table) -> tuple[Any, dict[str, Any]]:
    """The only arm of a table as rows for `Manipulator.from_dh`, and the other arguments."""
    arm = table.arms[0]
    numbers = rng.random() < 0.5

    def value(text: str, field: str) -> Any:
        if numbers and field not in WORDS and _NUMBER.fullmatch(text):
            return float(text)
        return text

    before = {"convention": arm.said["convention"]} if table.convention_column else {}
    rows = [
        {**before, **{column.header: value(row[column.field].bare, column.field) for column in table.columns}}
        for row in arm.rows
    ]
    if rng.random() < 0.5:
        header = list(rows[0])
        return [header, *([row[name] for name in header] for row in rows)], _arguments(table)
    return rows, _arguments(table)


def _arguments(table: Table) -> dict[str, Any]:
    return {"name": table.arms[0].known.name, **table.said, **table.options}


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
