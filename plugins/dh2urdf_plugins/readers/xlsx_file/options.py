"""The options of the reader of workbooks."""

from __future__ import annotations

from dataclasses import field

from dh2urdf.late_dataclasses import dataclass
from dh2urdf_plugins.readers.options import TableOptions


@dataclass(frozen=True, slots=True, kw_only=True)
class XlsxOptions(TableOptions):
    """What a workbook does not say itself."""

    sheet: str | None = field(
        default=None, metadata={"help": "title of the sheet to read; every sheet with a table by default"}
    )
