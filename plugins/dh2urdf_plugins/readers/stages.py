"""The stages that read tables: texts of any form, YAML, workbooks and Parquet. What reads them is imported late."""

from __future__ import annotations

from dh2urdf.stages import HasSchema, Reader, ReadsCells, ReadsInColumns, Traces, WritesTables
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.readers.options import TableOptions, XlsxOptions

_SOURCES = "dh2urdf_plugins.readers.sources"
_TYPED = f"{_SOURCES}.typed"
_TEXTS = (".txt", ".md", ".tex", ".py", ".m")
"""Suffixes of texts that are read and not written."""

_read_text = Late(f"{_SOURCES}.files:read_file")
CSV: Reader[TableOptions] = Reader(
    name="csv",
    summary="tables with one row per joint: CSV with many manipulators in a file, Markdown, LaTeX, columns, numbers in "
    "brackets",
    read=_read_text,
    options=TableOptions,
    suffixes=(".csv", ".tsv", *_TEXTS),
    capabilities=(
        WritesTables(Late(f"{_TYPED}:write_csv"), Late(f"{_TYPED}:typed_texts"), not_written=(".tsv", *_TEXTS)),
        Traces(_read_text),
        ReadsCells(
            Late("dh2urdf_plugins.readers.table:read_table"),
            any_text=".txt",
            cells_of=Late(f"{_SOURCES}.files:cells_of"),
        ),
        ReadsInColumns(Late(f"{_SOURCES}.files:read_file_columns")),
    ),
)

_read_yaml = Late(f"{_SOURCES}.documents:read_documents")
YAML: Reader[TableOptions] = Reader(
    name="yaml",
    summary="tables as YAML or JSON, one manipulator or a list of them",
    read=_read_yaml,
    options=TableOptions,
    suffixes=(".yaml", ".yml", ".json"),
    capabilities=(
        WritesTables(Late(f"{_TYPED}:write_yaml"), Late(f"{_TYPED}:typed_texts"), not_written=(".json",)),
        Traces(_read_yaml),
        HasSchema(Late(f"{_SOURCES}.yaml_schema:table_schema")),
    ),
)

_read_workbook = Late(f"{_SOURCES}.workbook:read_workbook", ("reader 'xlsx'", "openpyxl", "dh2urdf[xlsx]"))
XLSX: Reader[XlsxOptions] = Reader(
    name="xlsx",
    summary="tables with one row per joint in the sheets of an Excel or LibreOffice workbook",
    read=_read_workbook,
    options=XlsxOptions,
    suffixes=(".xlsx", ".xlsm"),
    capabilities=(Traces(_read_workbook),),
)

_PYARROW = ("reader 'parquet'", "pyarrow", "dh2urdf[parquet]")
_read_parquet = Late(f"{_SOURCES}.parquet:read_parquet", _PYARROW)
PARQUET: Reader[TableOptions] = Reader(
    name="parquet",
    summary="tables with one row per joint in the columns of a Parquet file; many manipulators in a file",
    read=_read_parquet,
    options=TableOptions,
    suffixes=(".parquet",),
    capabilities=(Traces(_read_parquet), ReadsInColumns(Late(f"{_SOURCES}.parquet:read_columns", _PYARROW))),
)
