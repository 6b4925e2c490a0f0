"""What became of converted tables, as `dh2urdf convert --json` prints it."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.cli.answers import answer
from dh2urdf.cli.standard_input import DASH, NAME

if TYPE_CHECKING:
    from collections.abc import Sequence
    from pathlib import Path

    from dh2urdf.commands.convert import Conversion
    from dh2urdf.results import ConversionEntry


def row_of(conversion: Conversion, table: Path, file: Path | None) -> ConversionEntry:
    """What became of a table, as plain data."""
    from dh2urdf.report.answers.conversions import conversion_row

    source = NAME if str(table) == DASH else str(table)
    in_folders = any("/" in name for name in conversion.files)
    return conversion_row(conversion, source, file if file is None or in_folders else file.parent)


def print_report(rows: Sequence[ConversionEntry]) -> None:
    """Print what became of tables, as JSON."""
    from dh2urdf.conversion.outcome import to_text
    from dh2urdf.report.answers.conversions import conversions_report

    answer(to_text(conversions_report(rows)), nl=False)
