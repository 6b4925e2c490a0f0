"""The stage ``xlsx``: tables in the sheets of workbooks. What reads them is imported late."""

from __future__ import annotations

from dh2urdf.stages import Reader, Traces
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.readers.options import XlsxOptions

read = Late("dh2urdf_plugins.readers.sources.workbook:read_workbook")
READER: Reader[XlsxOptions] = Reader(
    name="xlsx",
    summary="tables with one row per joint in the sheets of an Excel or LibreOffice workbook",
    read=read,
    options=XlsxOptions,
    suffixes=(".xlsx", ".xlsm"),
    capabilities=(Traces(read),),
)
