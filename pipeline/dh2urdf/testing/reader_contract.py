"""The contract of readers."""

from __future__ import annotations

import gc
import math
from contextlib import suppress
from itertools import islice
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.errors import InputError, TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system.column_calls import checked_groups
from dh2urdf.quantities.units import UNITS
from dh2urdf.source import Mark
from dh2urdf.stages import Reader, ReadsCells, ReadsInColumns, Rejected, Traces
from dh2urdf.table_text import CellRow, Trace
from dh2urdf.testing.stage_contract import Calls, InputContract, clause, difference, leaves

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.testing.stage_contract import Found

LARGE = 2**20
"""Bytes of a file of which a reader may look half ahead [B]."""
MANY = 500
"""Manipulators of a file that is read as one document."""
_CELLS = "cells of a test"
_WANTED = [(0.4, math.pi / 2, 0.1), (0.3, 0.0, -0.2)]


class ReaderContract(InputContract):
    """What holds for a reader.

    Attributes:
        example: what is in a file that it reads, with one manipulator or several.
        is_document: whether a file is one document that can only be read as a whole, as JSON and YAML are: then the
            file may be held, but the manipulators are made one by one.
    """

    kind = "reader"
    stage: ClassVar[Reader[Any]]
    example: ClassVar[str | bytes]
    is_document: ClassVar[bool] = False

    def many(self, count: int) -> str | bytes | None:  # noqa: ARG002 - for those who override it
        """What is in a file with so many manipulators; None where a file holds one."""
        return None

    def calls(self, folder: Path) -> Iterator[Calls]:
        """Reading the example; broken files, no file, and a folder."""
        suffix = (*self.stage.suffixes, "")[0]
        (directory := folder / f"folder{suffix}").mkdir()
        odd = [self._file(folder, content, name) for name, content in self._broken().items()]
        odd += [folder / f"missing{suffix}", directory]
        yield Calls(_read_all, (self.stage.read, self.given()), [self._file(folder, self.example)], odd, (TableError,))

    @clause
    def test_gives_tables(self, tmp_path: Path) -> Found:
        """The example gives manipulators: named, with rows, finite numbers, and the place of each in the file."""
        path = self._file(tmp_path, self.example)
        found = self._read(path)
        if not found or not all(isinstance(item, Manipulator) for item in found):
            yield f"{[str(item) for item in found]}"
        for table in found:
            if not table.rows or not table.name.strip():
                yield f"a manipulator named {table.name!r} with {len(table.rows)} rows"
            for place, text in leaves(table):
                if text in ("nan", "inf", "-inf") or text.startswith(("a list of", "a dict of")):
                    yield f"{place} of {table.name!r} is {text}"
            if table.mark is None or table.mark.file != str(path):
                yield f"the mark {table.mark!r} of the manipulator {table.name!r}"

    @clause
    def test_streams(self, tmp_path: Path) -> Found:
        """The first table is there before the last of the file is read; one document gives its tables one by one."""
        content = self.many(MANY)
        if content is None:
            if (count := len(self._read(self._file(tmp_path, self.example)))) > 1:
                yield f"the example holds {count} manipulators, and nothing says what a file of many holds"
            return
        count = MANY if self.is_document else MANY * (LARGE // len(_bytes(content)) + 1)
        path = self._file(tmp_path, self.many(count) or "")
        gc.collect()
        before = sum(isinstance(item, Manipulator) for item in gc.get_objects())
        tables = iter(self.stage.read(path, self.given()))
        first = next(tables, None)
        if self.is_document:
            made = sum(isinstance(item, Manipulator) for item in gc.get_objects()) - before
            given = 1 + sum(1 for _ in tables)
            if first is None or given != MANY or made > MANY // 2:
                yield f"{made} of {given} manipulators were made before the first was given; the file holds {MANY}"
            return
        given, size = int(isinstance(first, Manipulator)), path.stat().st_size
        # Zeros in place of the second half: a reader that has not read it yet finds them.
        with path.open("r+b") as file:
            file.seek(size // 2)
            file.write(b"\0" * (size - size // 2))
        with suppress(InputError):
            given += sum(isinstance(item, Manipulator) for item in islice(tables, count))
            if given in (0, count):
                half = f"half of the file ({size / 2**20:.0f} MiB) was overwritten after the first"
                yield f"{given} of {count} manipulators were given, though {half}"

    @clause
    def test_errors_name_the_file(self, tmp_path: Path) -> Found:
        """What is wrong with a file, or noticed in it, is at a place in this file."""
        for name, content in {"the example": self.example, **self._broken()}.items():
            path = self._file(tmp_path, content)
            items: list[Any] = []
            with suppress(Exception, SystemExit):  # Another clause reports it.
                try:
                    items = self._read(path)
                except TableError as error:
                    items = [error]
            parts = [getattr(item, kind, ()) for item in items for kind in ("problems", "notices", "rows")]
            for each in (each for part in parts for each in part):
                # A reader of macros names what they become, too.
                if each.mark is not None and each.mark.file.removesuffix(" (expanded)") != str(path):
                    yield f"{f'{each.mark}: {each}'!r:.200} of {name}"

    @clause
    def test_traces_what_it_reads(self, tmp_path: Path) -> Found:
        """With a trace the tables are the same, and the number of a cell, in its unit, is the value of the field."""
        if not (traces := self.stage.can(Traces)):
            return
        path, trace = self._file(tmp_path, self.example), Trace()
        traced = [(item, trace.copy()) for item in traces.trace(path, self.given(), trace)]
        if differs := difference(self._read(path), [item for item, _ in traced]):
            yield differs
        for table, its in traced:
            if isinstance(table, Rejected):
                continue
            if len(its.rows) != len(table.rows) or not any(its.rows):
                yield f"{len(its.rows)} rows in the trace of {table.name!r}, which has {len(table.rows)}"
            cells = [(row, *cell) for row, said in zip(table.rows, its.rows, strict=True) for cell in said.items()]
            for row, field, each in cells:
                if each.mark is None or each.mark.file != str(path):
                    yield f"the place {each.mark} of {field} of {row.joint!r}"
                value = getattr(row, field, None)
                with suppress(ValueError, KeyError):  # The cell holds an expression, or has a unit of its own.
                    if not each.unit or each.text is None or not isinstance(value, float):
                        continue
                    if not math.isclose(UNITS[each.unit].si(float(each.text)), value, rel_tol=1e-12, abs_tol=1e-15):
                        yield f"{each.text!r} in {each.unit} as {field} of {row.joint!r}, and the row has {value}"

    @clause
    def test_reads_cells_as_files(self) -> Found:
        """Rows of cells give the manipulator that they say, with the place of each cell in messages."""
        if not (reads := self.stage.can(ReadsCells)):
            return
        (table,) = reads.read_cells(_cell_rows("400"), _CELLS, self.given())
        found = [(row.a, row.alpha, row.d) for row in table.rows] if isinstance(table, Manipulator) else table
        if found != _WANTED:
            yield f"{found!r:.200} for {_WANTED} [m, rad], of cells in mm"
        (refused,) = reads.read_cells(_cell_rows("far"), _CELLS, self.given())
        places = [str(problem.mark) for problem in refused.problems] if isinstance(refused, Rejected) else []
        if places != [f"{_CELLS}:A3"]:
            yield f"{places} for a cell that is no number, at {_CELLS}:A3"

    @clause
    def test_reads_columns_as_tables(self, tmp_path: Path) -> Found:
        """What it reads in columns is to the last bit what it reads one by one, with marks, notices and errors."""
        if not (fast := self.stage.can(ReadsInColumns)):
            return
        for content in (self.example, *self._broken().values(), self.many(MANY) or self.example):
            path = self._file(tmp_path, content)
            both: list[Any] = []
            for read in (self.stage.read, fast.read_columns):
                try:
                    both.append(_read_all(path, read, self.given()))
                except TableError as error:
                    both.append(str(error))
            if differs := difference(*both):
                yield differs

    def _broken(self) -> dict[str, bytes]:
        """Files that are not, or not quite, what the reader reads; the name says what they are."""
        whole = _bytes(self.example)
        return {
            "an empty file": b"",
            "a file of zeros": b"\0" * 64,
            "no text": bytes(range(128, 256)),
            "a line of brackets": b"[{" * 2000,
            "an example with a zero byte in it": whole[: len(whole) // 2] + b"\0" + whole[len(whole) // 2 :],
            "an example in UTF-16 without a mark": whole.decode("latin-1").encode("utf-16-le"),
            "an example with numbers that are too large": whole.replace(b"0", b"9" * 400),
            "an example without digits": bytes(byte for byte in whole if not chr(byte).isdigit()),
            **{f"an example cut after {part} of 7 parts": whole[: len(whole) * part // 7] for part in range(1, 7)},
        }

    def _file(self, folder: Path, content: str | bytes, name: str = "table") -> Path:
        path = folder / f"{name}{(*self.stage.suffixes, '')[0]}"
        path.write_bytes(_bytes(content))
        return path

    def _read(self, path: Path) -> list[Any]:
        return _read_all(path, self.stage.read, self.given())


def _bytes(content: str | bytes) -> bytes:
    return content.encode() if isinstance(content, str) else content


def _read_all(path: Path, read: Any, options: Any) -> list[Any]:  # noqa: ANN401 - the stage's own
    found: list[Any] = []
    for item in read(path, options):
        found += checked_groups(item).tables() if isinstance(item, ManipulatorGroups) else [item]
    if wrong := [type(item).__name__ for item in found if not isinstance(item, (Manipulator, Rejected))]:
        raise TypeError(f"it yielded {wrong[0]}")
    return found


def _cell_rows(cell: str) -> list[CellRow]:
    """A table of two rows, the first cell of which is given."""

    def row(number: int, *cells: str | float) -> CellRow:
        marks = [Mark(file=_CELLS, line=number, column=i, place=f"{'ABC'[i - 1]}{number}") for i in (1, 2, 3)]
        return CellRow(cells, Mark(file=_CELLS, line=number), marks[: len(cells)])

    header = row(2, "a [mm]", "alpha", "d [mm]")
    return [row(1, "# convention: standard"), header, row(3, cell, "pi/2", 100.0), row(4, 300, 0, "-200")]
