"""The stage ``parquet``: tables in the columns of Parquet files. What reads them is imported late."""

from __future__ import annotations

from dh2urdf.stages import Reader, ReadsInColumns, Traces
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.readers.options import TableOptions

_PARQUET = "dh2urdf_plugins.readers.sources.parquet"

read = Late(f"{_PARQUET}:read_parquet")
READER: Reader[TableOptions] = Reader(
    name="parquet",
    summary="tables with one row per joint in the columns of a Parquet file; many manipulators in a file",
    read=read,
    options=TableOptions,
    suffixes=(".parquet",),
    capabilities=(Traces(read), ReadsInColumns(Late(f"{_PARQUET}:read_columns"))),
)
