"""The stage ``yaml``: tables as YAML or JSON. What reads them is imported when it is called."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from dh2urdf.stages import HasSchema, Reader, Traces, WritesTables
from dh2urdf_plugins.readers.options import TableOptions

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence
    from pathlib import Path

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.stages import Rejected
    from dh2urdf.table_text import TableText, Trace, WrittenTable


def read(path: Path, options: TableOptions, trace: Trace | None = None) -> Iterator[Manipulator | Rejected]:
    """The manipulators of a YAML or JSON file.

    Args:
        path: the file.
        options: what the table does not say itself.
        trace: takes what the cells of each manipulator say, where it is wanted.

    Returns:
        Each manipulator, or what is wrong with it.

    Raises:
        TableError: the file is no YAML document, or one that holds no table.
    """
    from dh2urdf_plugins.readers.sources.documents import read_documents

    return read_documents(path, options, trace)


def schema() -> dict[str, Any]:
    """The JSON Schema of the files."""
    from dh2urdf_plugins.readers.sources.yaml_schema import table_schema

    return table_schema()


def write(tables: Sequence[TableText]) -> WrittenTable:
    """The file of some tables.

    Raises:
        InputError: the format cannot hold them.
    """
    from dh2urdf_plugins.readers.sources import yaml_texts as texts

    return texts.write(tables)


def typed_texts(path: Path) -> Iterator[TableText]:
    """The tables of a file as their authors typed them."""
    from dh2urdf_plugins.readers.sources import yaml_texts as texts

    return texts.texts(path)


READER: Reader[TableOptions] = Reader(
    name="yaml",
    summary="tables as YAML or JSON, one manipulator or a list of them",
    read=read,
    options=TableOptions,
    suffixes=(".yaml", ".yml", ".json"),
    capabilities=(
        WritesTables(write, typed_texts, not_written=(".json",)),
        Traces(read),
        HasSchema(schema),
    ),
)
