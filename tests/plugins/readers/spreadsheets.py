"""What spreadsheets make of a CSV file that a person opens and saves, without any intent to change it.

A model of Excel, LibreOffice Calc and Google Sheets, as far as it matters to a table: which cells become numbers, dates
or formulas, how each is written back, where quotes stand, how far lines are filled up, and which bytes the file has.
That of LibreOffice was compared with LibreOffice 7.4 (`soffice --headless --convert-to csv`) on every table of
`configs/`, in English and in German, with and without "quote all text cells".
"""

from __future__ import annotations

import csv
import io
import re
from dataclasses import dataclass
from typing import TypeAlias

Value: TypeAlias = str | float | bool


@dataclass(frozen=True, kw_only=True)
class Spreadsheet:
    """A program with its language and its settings.

    Attributes:
        name: for the names of tests.
        opens: what separates the cells when the file is opened; the table's own delimiter where it is None.
        separator: what it writes between cells.
        decimal: its decimal sign when it reads and writes numbers.
        reads: its decimal sign when it reads them, where the person has chosen another one.
        scientific: how it writes a small number: as ``1.00E-05``, or in full.
        formulas: whether a cell that begins with a sign is computed, as Excel does.
        quotes_text: whether all cells of text are put into quotes.
        quotes_commas: whether a comma is quoted though it separates nothing, as Excel does in text with tabs.
        truth: how it writes true and false.
        encoding: of the file.
        line_end: of the lines.
        last_line_end: whether the last line has one.
    """

    name: str
    opens: str | None = None
    separator: str = ","
    decimal: str = "."
    reads: str | None = None
    scientific: bool = True
    formulas: bool = False
    quotes_text: bool = False
    quotes_commas: bool = False
    truth: tuple[str, str] = ("TRUE", "FALSE")
    encoding: str = "utf-8"
    line_end: str = "\r\n"
    last_line_end: bool = True

    def saved(self, content: str, delimiter: str = ",") -> bytes:
        """A file as it is after it was opened and saved.

        Args:
            content: what it contained.
            delimiter: what separates its cells.
        """
        rows = [
            [self._value(cell) for cell in row]
            for row in csv.reader(io.StringIO(content), delimiter=self.opens or delimiter)
        ]
        width = max(map(len, rows))
        lines = [self.separator.join([*map(self._text, row), *[""] * (width - len(row))]) for row in rows]
        text = self.line_end.join(lines) + (self.line_end if self.last_line_end else "")
        return text.encode(self.encoding)

    def _value(self, cell: str) -> Value:
        """What a cell becomes when the file is opened."""
        text = cell.strip(" ")
        words = {"TRUE": True, "FALSE": False, self.truth[0]: True, self.truth[1]: False}
        if text.upper() in words:
            return words[text.upper()]
        decimal = re.escape(self.reads or self.decimal)
        if re.fullmatch(rf"[+-]?([0-9]+{decimal}?[0-9]*|{decimal}[0-9]+)([eE][+-]?[0-9]+)?", text):
            return float(text.replace(self.reads or self.decimal, "."))
        thousands = "," if (self.reads or self.decimal) == "." else "\\."
        if re.fullmatch(rf"[+-]?[0-9]{{1,3}}({thousands}[0-9]{{3}})+", text):
            return float(re.sub(thousands, "", text))
        if self.formulas and re.fullmatch(r"[+=-][0-9*/+]*[a-z_]+([*/+-][0-9a-z_]+)*", cell):
            return "#NAME?"
        return cell

    def _text(self, value: Value) -> str:
        """How a cell is written."""
        if isinstance(value, bool):
            return self.truth[not value]
        text = self._number(value) if isinstance(value, float) else value
        special = {self.separator, '"', "\n", *([","] if self.quotes_commas else [])}
        if (self.quotes_text and text is value and text) or special.intersection(text):
            return '"' + text.replace('"', '""') + '"'
        return text

    def _number(self, value: float) -> str:
        if self.scientific and value and not 1e-4 <= abs(value) < 1e11:
            text = f"{value:.2E}"
        else:
            digits = f"{value:.9f}" if self.scientific else f"{value:.15f}"
            text = digits.rstrip("0").rstrip(".")
        return text.replace(".", self.decimal)


ENGLISH = (
    Spreadsheet(name="Excel, CSV", formulas=True),
    Spreadsheet(name="Excel, CSV UTF-8", formulas=True, encoding="utf-8-sig"),
    Spreadsheet(name="Excel, Unicode text", formulas=True, separator="\t", quotes_commas=True, encoding="utf-16"),
    Spreadsheet(name="LibreOffice", scientific=False, line_end="\n"),
    Spreadsheet(name="LibreOffice, all text quoted", scientific=False, line_end="\n", quotes_text=True),
    Spreadsheet(name="LibreOffice, tabs", scientific=False, line_end="\n", separator="\t"),
    Spreadsheet(name="LibreOffice, UTF-16", scientific=False, line_end="\n", encoding="utf-16"),
    Spreadsheet(name="Google Sheets", last_line_end=False),
)
"""Programs whose language has the decimal point."""

_GERMAN = {"separator": ";", "decimal": ",", "truth": ("WAHR", "FALSCH")}
GERMAN = (
    Spreadsheet(name="Excel, German", formulas=True, reads=".", **_GERMAN),  # type: ignore[arg-type] - of all kinds
    Spreadsheet(name="Excel, German, UTF-8", formulas=True, reads=".", encoding="utf-8-sig", **_GERMAN),  # type: ignore[arg-type]
    Spreadsheet(name="LibreOffice, German", reads=".", scientific=False, line_end="\n", **_GERMAN),  # type: ignore[arg-type]
    Spreadsheet(
        name="LibreOffice, German, all text quoted",
        reads=".",
        scientific=False,
        line_end="\n",
        quotes_text=True,
        **_GERMAN,  # type: ignore[arg-type]
    ),
    Spreadsheet(name="Google Sheets, German", reads=".", last_line_end=False, **{**_GERMAN, "separator": ","}),  # type: ignore[arg-type]
)
"""Programs in German, with the columns opened as English, as a person does who sees what else would become of them."""

UNAWARE = (
    Spreadsheet(name="Excel, German, opened as one column", opens=";", **_GERMAN),  # type: ignore[arg-type]
    Spreadsheet(name="LibreOffice, German, opened as German", scientific=False, line_end="\n", **_GERMAN),  # type: ignore[arg-type]
)
