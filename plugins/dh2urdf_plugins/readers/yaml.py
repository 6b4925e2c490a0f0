"""The stage ``yaml``: tables as YAML or JSON. What reads them is imported late."""

from __future__ import annotations

from dh2urdf.stages import HasSchema, Reader, Traces, WritesTables
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.readers.options import TableOptions

_SOURCES = "dh2urdf_plugins.readers.sources"

read = Late(f"{_SOURCES}.documents:read_documents")
READER: Reader[TableOptions] = Reader(
    name="yaml",
    summary="tables as YAML or JSON, one manipulator or a list of them",
    read=read,
    options=TableOptions,
    suffixes=(".yaml", ".yml", ".json"),
    capabilities=(
        WritesTables(
            Late(f"{_SOURCES}.typed:write_yaml"), Late(f"{_SOURCES}.typed:typed_texts"), not_written=(".json",)
        ),
        Traces(read),
        HasSchema(Late(f"{_SOURCES}.yaml_schema:table_schema")),
    ),
)
