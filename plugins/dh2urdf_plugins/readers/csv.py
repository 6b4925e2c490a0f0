"""The stage ``csv``: tables in texts of any form, many manipulators in a file. What reads them is imported late."""

from __future__ import annotations

from dh2urdf.stages import Reader, ReadsCells, ReadsInColumns, Traces, WritesTables
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.readers.options import TableOptions

_FILES = "dh2urdf_plugins.readers.sources.files"
TEXTS = (".txt", ".md", ".tex", ".py", ".m")
"""Suffixes of texts that are read and not written."""

read = Late(f"{_FILES}:read_file")
READER: Reader[TableOptions] = Reader(
    name="csv",
    summary="tables with one row per joint: CSV with many manipulators in a file, Markdown, LaTeX, columns, numbers in "
    "brackets",
    read=read,
    options=TableOptions,
    suffixes=(".csv", ".tsv", *TEXTS),
    capabilities=(
        WritesTables(
            Late("dh2urdf_plugins.readers.sources.typed:write_csv"),
            Late("dh2urdf_plugins.readers.sources.typed:typed_texts"),
            not_written=(".tsv", *TEXTS),
        ),
        Traces(read),
        ReadsCells(
            Late("dh2urdf_plugins.readers.table:read_table"), any_text=".txt", cells_of=Late(f"{_FILES}:cells_of")
        ),
        ReadsInColumns(Late(f"{_FILES}:read_file_columns")),
    ),
)
