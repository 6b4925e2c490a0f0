"""The contract of readers."""

from __future__ import annotations

import gc
import math
from contextlib import suppress
from dataclasses import fields, is_dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any, ClassVar

from dh2urdf.columns import ManipulatorGroups
from dh2urdf.errors import InputError, PluginError, TableError
from dh2urdf.manipulator import DHRow, Manipulator
from dh2urdf.provenance import Trace
from dh2urdf.quantities.units import UNITS
from dh2urdf.source import Mark, Problem
from dh2urdf.stage_calls.column_calls import checked_groups
from dh2urdf.stages import Reader, Rejected
from dh2urdf.table_text import CellRow
from dh2urdf.testing.stage_contract import StageContract, outcome

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Mapping
    from pathlib import Path

    from dh2urdf.provenance import Said

LARGE = 2**20
"""Bytes of a file of which a reader may look half ahead [B]."""
_CELLS, _PLACE, _ABC = "cells of a test", "A3", (1, 2, 3)
MANY = 500
"""Manipulators of a file that is read as one document."""


class ReaderContract(StageContract):
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
        """What is in a file with so many manipulators; None where a file holds one.

        Args:
            count: how many.
        """
        return None

    # --- The clauses

    def test_gives_tables(self, tmp_path: Path) -> None:
        """The example gives manipulators: named, with rows, finite numbers, and the place of each in the file."""
        clause = self.test_gives_tables
        path = self._file(tmp_path, self.example)
        found = self._read(path)
        if not found or not all(isinstance(item, Manipulator) for item in found):
            self.breach(
                clause,
                found=f"{[str(item) for item in found]}",
                accepted="the manipulators of the example: dh2urdf.manipulator.Manipulator",
                remedy="yield a Manipulator for each, and set `example` of the test to a file that is right",
            )
        for table in found:
            if not table.rows or not table.name.strip():
                self.breach(
                    clause,
                    found=f"a manipulator named {table.name!r} with {len(table.rows)} rows",
                    accepted="a name that is not empty, and a row for each joint",
                    remedy="take the file's stem for a table that does not say its name; refuse one without rows",
                )
            if fault := next(_unfit(table), None):
                self.breach(
                    clause,
                    found=fault,
                    accepted="finite floats, in tuples",
                    remedy="convert with float(), refuse what is not finite, and make tuples of lists",
                )
            if table.mark is None or table.mark.file != str(path):
                self.breach(
                    clause,
                    found=f"the mark {table.mark!r} of the manipulator {table.name!r}",
                    accepted=f"Mark(file={str(path)!r}, line=…)",
                    remedy="set `mark`: messages of later stages show where a person has to fix the table",
                )

    def test_streams(self, tmp_path: Path) -> None:
        """The first table is there before the last of the file is read; one document gives its tables one by one."""
        clause = self.test_streams
        content = self.many(MANY)
        if content is None:
            if (count := len(self._read(self._file(tmp_path, self.example)))) > 1:
                self.breach(
                    clause,
                    found=f"the example holds {count} manipulators, and nothing says what a file of many holds",
                    accepted="a method `many(self, count)` in the test",
                    remedy="let `many` return a file of so many manipulators",
                )
        elif self.is_document:
            self._makes_one_by_one(clause, self._file(tmp_path, content))
        else:
            count = MANY * (LARGE // len(_bytes(content)) + 1)
            path = self._file(tmp_path, self.many(count) or "")
            self._notices_what_changes(clause, path, count)

    def test_is_deterministic(self, tmp_path: Path) -> None:
        """The same file gives the same tables, or the same refusal, in every process."""
        contents = {"whole": _bytes(self.example), **self._broken()}
        folders = [tmp_path / str(number) for number in range(len(contents))]
        for folder in folders:
            folder.mkdir()
        paths = [self._file(folder, content) for folder, content in zip(folders, contents.values(), strict=True)]
        self.same_in_every_process(self.test_is_deterministic, _outcomes, self.stage.read, paths, self.given())

    def test_keeps_its_input(self, tmp_path: Path) -> None:
        """The file is as it was, nothing else is written, and no process is left."""
        clause, path = self.test_keeps_its_input, self._file(tmp_path, self.example)
        seen = self.in_child(clause, _read_all, self.stage.read, path, self.given())
        deeds = [*seen.traces]
        if path.read_bytes() != _bytes(self.example):
            deeds.append(f"changed {path.name}")
        if deeds:
            self.breach(
                clause,
                found="; ".join(deeds),
                accepted="a reader that opens its file for reading",
                remedy="hold what is needed in memory; the folder of a table may be somebody's archive",
            )

    def test_raises_documented_errors_only(self, tmp_path: Path) -> None:
        """A file that cannot be read is a TableError, whatever is wrong with it."""
        for name, content in self._broken().items():
            self._only_documented(name, self._file(tmp_path, content))
        self._only_documented("no file at all", tmp_path / f"missing{self._suffix()}")
        folder = tmp_path / f"folder{self._suffix()}"
        folder.mkdir()
        self._only_documented("a folder", folder)

    def test_errors_name_the_file(self, tmp_path: Path) -> None:
        """What is wrong with a file, or noticed in it, is at a place in this file."""
        for name, content in {"the example": _bytes(self.example), **self._broken()}.items():
            path = self._file(tmp_path, content)
            for problem in self._told(path):
                mark = problem.mark  # A reader of macros names what they become, too.
                if mark is not None and mark.file.removesuffix(" (expanded)") != str(path):
                    self.breach(
                        self.test_errors_name_the_file,
                        found=f"{str(problem)!r:.200} of {name}",
                        accepted=f"Mark(file={str(path)!r}, …) as the mark of the problem",
                        remedy="give each Problem the mark of what it is about, or none: then the file is filled in; "
                        "give `Manipulator.from_dh` the file: `file=path`, or `mark=Mark(file=str(path), line=…)`",
                    )

    def test_traces_what_it_reads(self, tmp_path: Path) -> None:
        """With a trace the tables are the same, and the number of a cell, in its unit, is the value of the field."""
        clause, trace_of = self.test_traces_what_it_reads, self.stage.trace
        if trace_of is None:
            return
        path, trace = self._file(tmp_path, self.example), Trace()
        traced = [(item, trace.copy()) for item in trace_of(path, self.given(), trace)]
        items = [item for item, _ in traced]
        self.same(clause, self._read(path), items)
        for table, its in traced:
            if not isinstance(table, Manipulator):
                continue
            if len(its.rows) != len(table.rows) or not any(its.rows):
                self.breach(
                    clause,
                    found=f"{len(its.rows)} rows in the trace of {table.name!r}, which has {len(table.rows)}",
                    accepted="what the cells hold, for each row of the manipulator",
                    remedy="fill `trace.rows` and `trace.table` before each manipulator is yielded",
                )
            for row, said in zip(table.rows, its.rows, strict=True):
                if fault := next(_mistold(row, said, path), None):
                    self.breach(
                        clause,
                        found=fault,
                        accepted="the text of the cell, its place in the file, and the unit of a bare number",
                        remedy="make each `Said` of the cell that the field is read from",
                    )

    def test_reads_cells_as_files(self) -> None:
        """Rows of cells give the manipulator that they say, with the place of each cell in messages."""
        clause, read_cells = self.test_reads_cells_as_files, self.stage.read_cells
        if read_cells is None:
            return
        wanted = ((0.4, math.pi / 2, 0.1), (0.3, 0.0, -0.2))
        (table,) = read_cells(_cell_rows("400"), _CELLS, self.given())
        found = tuple((row.a, row.alpha, row.d) for row in table.rows) if isinstance(table, Manipulator) else table
        if found != wanted:
            self.breach(
                clause,
                found=f"{found!r:.200}",
                accepted=f"rows with a, alpha and d of {wanted} [m, rad], of cells in mm",
                remedy="let `read_cells` be dh2urdf_plugins.readers.table.read_table, or read what it reads",
            )
        (refused,) = read_cells(_cell_rows("far"), _CELLS, self.given())
        places = [str(problem.mark) for problem in refused.problems] if isinstance(refused, Rejected) else []
        if places != [f"{_CELLS}:{_PLACE}"]:
            self.breach(
                clause,
                found=f"{places} for a cell that is no number" if places else f"{refused!r:.200}",
                accepted=f"a Rejected with a problem at {_CELLS}:{_PLACE}, the mark of the cell",
                remedy="give problems the marks of `CellRow.marks`",
            )

    def test_reads_columns_as_tables(self, tmp_path: Path) -> None:
        """What it reads in columns is to the last bit what it reads one by one, with marks, notices and errors."""
        clause, reads = self.test_reads_columns_as_tables, (self.stage.read, self.stage.read_columns)
        if reads[1] is None:
            return
        for content in (_bytes(self.example), *self._broken().values(), _bytes(self.many(MANY) or self.example)):
            path = self._file(tmp_path, content)
            self.same(clause, *[outcome(_read_all, read, path, self.given()) for read in reads])

    # --- What the clauses use

    def _broken(self) -> dict[str, bytes]:
        """Files that are not, or not quite, what the reader reads; the name says what they are."""
        whole = _bytes(self.example)
        broken = {
            "an empty file": b"",
            "a file of zeros": b"\0" * 64,
            "no text": bytes(range(128, 256)),
            "a line of brackets": b"[{" * 2000,
            "an example with a zero byte in it": whole[: len(whole) // 2] + b"\0" + whole[len(whole) // 2 :],
            "an example in UTF-16 without a mark": whole.decode("latin-1").encode("utf-16-le"),
            "an example with numbers that are too large": whole.replace(b"0", b"9" * 400),
            "an example without digits": bytes(byte for byte in whole if not chr(byte).isdigit()),
        }
        cut = {f"an example cut after {part} of 7 parts": whole[: len(whole) * part // 7] for part in range(1, 7)}
        return broken | cut

    def _suffix(self) -> str:
        return (*self.stage.suffixes, "")[0]

    def _file(self, folder: Path, content: str | bytes) -> Path:
        path = folder / f"table{self._suffix()}"
        path.write_bytes(_bytes(content))
        return path

    def _read(self, path: Path) -> list[Any]:
        return _read_all(self.stage.read, path, self.given())

    def _told(self, path: Path) -> Iterator[Problem]:
        """The problems and notices of a file, and a problem for each row that is in another one."""
        try:
            items = self._read(path)
        except TableError as error:
            items = [error]
        except (Exception, SystemExit):  # noqa: BLE001 - another clause reports it
            return
        for item in items:
            yield from (*getattr(item, "problems", ()), *getattr(item, "notices", ()))
            for row in getattr(item, "rows", ()):
                yield Problem(message="the row", joint=row.joint, mark=row.mark)

    def _only_documented(self, name: str, path: Path) -> None:
        try:
            strange = [item for item in self._read(path) if not isinstance(item, (Manipulator, Rejected))]
        except (TableError, PluginError):
            return
        except (Exception, SystemExit) as error:  # noqa: BLE001 - whatever an author's code raises
            what = f"{type(error).__name__}: {error}"
        else:
            if not strange:
                return
            what = f"it yielded {type(strange[0]).__name__}"
        self.breach(
            self.test_raises_documented_errors_only,
            found=f"{what} at {name}",
            accepted="dh2urdf.errors.TableError, or a Rejected for one manipulator of several",
            remedy="read with dh2urdf.documents.text_files.read_bytes and decoded, which check the file; "
            "turn what a parser raises into a TableError with a Problem that says where",
        )

    def _makes_one_by_one(self, clause: Callable[..., Any], path: Path) -> None:
        """Fail where all manipulators of a document are made before the first is given."""
        gc.collect()
        before = sum(isinstance(item, Manipulator) for item in gc.get_objects())
        tables = iter(self.stage.read(path, self.given()))
        first = next(tables, None)
        made = sum(isinstance(item, Manipulator) for item in gc.get_objects()) - before
        given = 1 + sum(1 for _ in tables)
        if first is None or given != MANY or made > MANY // 2:
            self.breach(
                clause,
                found=f"{made} of {given} manipulators were made before the first was given; the file holds {MANY}",
                accepted="manipulators that are made one by one",
                remedy="`yield` each manipulator where it is made, in place of returning a list",
            )

    def _notices_what_changes(self, clause: Callable[..., Any], path: Path, count: int) -> None:
        """Fail where the end of a file does not matter any more once the first manipulator is there."""
        tables = iter(self.stage.read(path, self.given()))
        first = next(tables, None)
        size = path.stat().st_size
        # Zeros in place of its second half: a reader that has not read it yet finds them.
        with path.open("r+b") as file:
            file.seek(size // 2)
            file.write(b"\0" * (size - size // 2))
        given = int(isinstance(first, Manipulator))
        try:
            given += sum(isinstance(item, Manipulator) for item in islice(tables, count))
        except InputError:
            return
        if given in (0, count):
            self.breach(
                clause,
                found=f"{given} of {count} manipulators were given, though half of the file ({size / 2**20:.0f} MiB) "
                "was overwritten after the first",
                accepted="a reader that reads on only when the next manipulator is asked for",
                remedy="iterate over the open file and `yield` each manipulator; where the format is one document, "
                "set `is_document = True` in the test",
            )


def _cell_rows(cell: str) -> list[CellRow]:
    """A table of two rows, the first cell of which is given."""

    def row(number: int, *cells: str | float) -> CellRow:
        marks = [Mark(file=_CELLS, line=number, column=column, place=f"{'ABC'[column - 1]}{number}") for column in _ABC]
        return CellRow(cells, Mark(file=_CELLS, line=number), marks[: len(cells)])

    header = row(2, "a [mm]", "alpha", "d [mm]")
    return [row(1, "# convention: standard"), header, row(3, cell, "pi/2", 100.0), row(4, 300, 0, "-200")]


def _mistold(row: DHRow, said: Mapping[str, Said], path: Path) -> Iterator[str]:
    """What a trace declares about a row that the file or the manipulator does not."""
    for field, each in said.items():
        if each.mark is None or each.mark.file != str(path):
            yield f"the place {each.mark} of {field} of {row.joint!r}"
        if each.unit and each.text is not None and isinstance(value := getattr(row, field, None), float):
            with suppress(ValueError, KeyError):
                if not math.isclose(UNITS[each.unit].si(float(each.text)), value, rel_tol=1e-12, abs_tol=1e-15):
                    yield f"{each.text!r} in {each.unit} as {field} of {row.joint!r}, and the row has {value}"


def _bytes(content: str | bytes) -> bytes:
    return content.encode() if isinstance(content, str) else content


def _read_all(read: Callable[[Path, Any], Iterator[Any]], path: Path, options: Any) -> list[Any]:  # noqa: ANN401 - the stage's own
    found: list[Any] = []
    for item in read(path, options):
        found += checked_groups(item).tables() if isinstance(item, ManipulatorGroups) else [item]
    return found


def _outcomes(read: Callable[[Path, Any], Iterator[Any]], paths: list[Path], options: Any) -> list[Any]:  # noqa: ANN401 - the stage's own
    return [outcome(_read_all, read, path, options) for path in paths]


def _unfit(value: Any, place: str = "the manipulator") -> Iterator[str]:  # noqa: ANN401 - a record, or what is in it
    """What is in a record that should not be: numbers that are not finite, and collections that can be changed."""
    if is_dataclass(value) and not isinstance(value, type):
        for field in fields(value):
            yield from _unfit(getattr(value, field.name), f"{place}, {field.name}")
    elif isinstance(value, tuple):
        for item in value:
            yield from _unfit(item, place)
    elif isinstance(value, (list, dict, set)):
        yield f"{place}: the {type(value).__name__} {value!r:.80}"
    elif isinstance(value, float) and not math.isfinite(value):
        yield f"{place}: {value}"
    elif value is not None and not isinstance(value, (str, int, float, bool)):
        yield f"{place}: {type(value).__name__} {value!r:.80}"
