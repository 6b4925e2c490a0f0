from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import ReadsCells, Rejected
from dh2urdf_plugins.readers.table import CellRow, TableOptions, read_table

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

HEADER = ["joint", "type", "a", "alpha", "d"]
FIRST = ["shoulder", "R", 0.0, math.pi / 2, 0.089]
SECOND = ["elbow", "R", -0.425, 0.0, 0.0]
STANDARD = TableOptions(convention="standard")


def rows(*cells: list[Any]) -> Iterator[CellRow]:
    """Rows of a sheet called `Sheet1`, with the place of each cell."""
    for number, row in enumerate(cells, start=1):
        marks = [
            Mark(file="arm.ods", line=number, column=column, place=f"Sheet1!{chr(64 + column)}{number}")
            for column in range(1, len(row) + 1)
        ]
        yield CellRow(row, Mark(file="arm.ods", line=number, place=f"Sheet1!A{number}"), marks)


def read_one(*cells: list[Any], options: TableOptions = STANDARD, **more: Any) -> Manipulator:
    (arm,) = read_table(rows(*cells), "arm.ods", options, **more)
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    return arm


def refusal(*cells: list[Any], options: TableOptions = STANDARD) -> str:
    try:
        items = list(read_table(rows(*cells), "arm.ods", options))
    except TableError as error:
        return str(error)
    return "\n".join(str(problem) for item in items if isinstance(item, Rejected) for problem in item.problems)


class TestRows:
    def test_numbers_texts_and_empty_cells(self) -> None:
        """Numbers are taken as they are, texts as the cells of a CSV file."""
        arm = read_one([*HEADER, "theta"], [*FIRST, None], ["elbow", "R", "-425 mm", "0", 0, "pi/2"])
        assert [(row.a, row.alpha, row.d, row.theta) for row in arm.rows] == [
            (0.0, math.pi / 2, 0.089, 0.0),
            (-0.425, 0.0, 0.0, math.pi / 2),
        ]
        assert arm.name == "arm"

    def test_rows_know_their_places(self) -> None:
        """Whatever is found later names the cell's row as the format does."""
        arm = read_one(HEADER, FIRST, SECOND)
        assert [str(row.mark) for row in arm.rows] == ["arm.ods:Sheet1!A2", "arm.ods:Sheet1!A3"]

    def test_empty_rows_and_comments_are_passed_over(self) -> None:
        """Above the header and below it."""
        arm = read_one([None, ""], ["# a note"], HEADER, FIRST, [None] * 5, ["# of 2020"], SECOND)
        assert [row.joint for row in arm.rows] == ["shoulder", "elbow"]
        assert arm.notices == ()

    def test_short_and_long_rows(self) -> None:
        """Cells that are not there are empty; one that has no header is refused."""
        assert read_one([*HEADER, "mass"], FIRST).rows[0].mass is None
        assert "arm.ods:Sheet1!F2: error: joint 'joint_1': '7' is in a column without a header" in refusal(
            HEADER, [*FIRST, 7]
        )


class TestTheTop:
    @pytest.mark.parametrize(
        "said",
        [
            ["# convention: modified"],
            ["# convention", "modified"],
            ["convention: modified"],
            [None, "Convention:", "modified", None],
            ["# dh convention = modified"],
        ],
    )
    def test_what_stands_above_the_header_holds_for_all_rows(self, said: list[Any]) -> None:
        """In one cell or in several, with or without #."""
        arm = read_one(said, HEADER, FIRST, options=TableOptions())
        assert (arm.convention, arm.notices) == (Convention.MODIFIED, ())

    @pytest.mark.parametrize("said", [["# units: {length: mm, angle: deg}"], ["# units: {length: mm", " angle: deg}"]])
    def test_units(self, said: list[Any]) -> None:
        """A mapping that a spreadsheet has split at its comma is one again."""
        row = read_one(said, HEADER, ["j", "R", 100, 90, 0]).rows[0]
        assert (row.a, row.alpha) == (0.1, math.pi / 2)

    def test_statements_from_outside(self) -> None:
        """A file that has metadata hands them over; the rows may not say them again."""
        from dh2urdf.documents import load_yaml

        said = {"name": load_yaml("scara", "metadata")}
        assert read_one(HEADER, FIRST, statements=said).name == "scara"
        with pytest.raises(
            TableError, match="Sheet1!A1: error: field 'name': a comment line says name already, in line 1"
        ):
            read_one(["# name: x"], HEADER, FIRST, statements=said)

    @pytest.mark.parametrize(
        ("cells", "said"),
        [
            ([], "arm.ods: error: there is no header and there are no rows"),
            ([["a note"]], "arm.ods:Sheet1!A1: error: field 'columns': no row is a header whose columns are known"),
            ([["a", "b"]], "arm.ods:Sheet1!A1: error: field 'alpha': there is no column for alpha in the header"),
            ([["a", "alpha", "lenght"]], "arm.ods:Sheet1!A1: error: field 'd': there is no column for d in the header"),
            ([["# untis: mm"], HEADER], "arm.ods:Sheet1!A1: error: the comment line says 'untis', which nothing is called"),
            ([["# base: {xyz: [0, 0}"], HEADER], "arm.ods:Sheet1!A1: error: "),
            ([["# base: {xyz: [0, 0, x]}"], HEADER], "arm.ods:Sheet1!A1: error: field 'base.xyz': 'x' cannot be read"),
            ([HEADER, FIRST, ["# name: x"]], "arm.ods:Sheet1!A3: error: '# name: x' is below the header"),
        ],
    )  # fmt: skip
    def test_refusals_name_the_cell(self, cells: list[Any], said: str) -> None:
        """Of comments, of the header, and where there is none."""
        assert said in refusal(*cells)

    def test_the_search_for_a_header_ends(self) -> None:
        """After a thousand rows that are none."""
        with pytest.raises(TableError, match="no row is a header"):
            list(read_table(rows(*([["text"]] * 1001), HEADER, FIRST), "arm.ods", STANDARD))


class TestCells:
    def test_the_message_names_the_cell(self) -> None:
        """As the format does."""
        assert refusal(HEADER, FIRST, ["j2", "R", "x", 0, 0]).startswith(
            "arm.ods:Sheet1!C3: error: joint 'j2', field 'a': "
        )

    def test_what_is_no_text_and_no_number_is_an_error_where_it_is_read(self) -> None:
        """A date in a column that no field knows is no matter."""
        date = Problem(message="the cell holds a date", found="2020-03-04")
        assert "arm.ods:Sheet1!C2: error: joint 'joint_1', field 'a': the cell holds a date" in refusal(
            HEADER, ["j", "R", date, 0, 0]
        )
        assert read_one([*HEADER, "note"], [*FIRST, date]).rows[0].d == 0.089

    @pytest.mark.parametrize(("decimal_comma", "accepted"), [(True, True), (False, False)])
    def test_decimal_commas(self, *, decimal_comma: bool, accepted: bool) -> None:
        """Where no commas separate cells."""
        table = rows(HEADER, ["j", "R", "0,5", 0, 0])
        (item,) = read_table(table, "arm.ods", STANDARD, decimal_comma=decimal_comma)
        assert isinstance(item, Manipulator) is accepted

    def test_several_manipulators(self) -> None:
        """By the column robot, as in every table."""
        table = rows(["robot", *HEADER], ["A", *FIRST], ["A", *SECOND], ["B", *FIRST])
        arms = [item for item in read_table(table, "arm.ods", STANDARD) if isinstance(item, Manipulator)]
        assert [(arm.name, len(arm.rows)) for arm in arms] == [("A", 2), ("B", 1)]


def test_the_catalog_knows_who_reads_cells() -> None:
    """The host reaches the grammar without the name of a plugin."""
    reader = load().cell_reader()
    reads = reader.can(ReadsCells)
    (arm,) = reads.read_cells(rows(HEADER, FIRST), "cells", STANDARD)
    assert isinstance(arm, Manipulator)
    assert arm.name == "cells"


# --- One grammar: what stands around the columns means the same in every container -------------------------------------


def sheet_of(text: str, folder: Path) -> Path:
    """The same cells as a workbook."""
    from openpyxl import Workbook

    book = Workbook()
    for line in text.splitlines():
        book.active.append([None if cell == "" else _number_or_text(cell) for cell in line.split(",")])
    book.save(folder / "arm.xlsx")
    return folder / "arm.xlsx"


def _number_or_text(cell: str) -> float | str:
    try:
        return float(cell)
    except ValueError:
        return cell


def read_from(form: str, text: str, folder: Path) -> Manipulator | Rejected:
    """The one manipulator of a CSV file or a workbook."""
    (folder / "arm.csv").write_text(text)
    path = folder / "arm.csv" if form == "csv" else sheet_of(text, folder)
    (item,) = dh2urdf.read_all(path, convention="standard")
    return item


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("j1,0.3,0,0\n\nrev B of the sheet", None),
        ("j1,0.3,0,0\n\nmeasured, twice, by the maker", None),
        ("j1,0.3,0,0\n,,,\nSource: UR,,,", None),
        ("j1,0.3,0,0\n\nj2,,0,0", "a is empty"),
        ("j1,0.3,0,0\n\nj2,0.2,0,0", None),
        ("j1,0.3,0,0\n\nelbow,,0,0", "a is empty"),
    ],
)
@pytest.mark.parametrize("form", ["csv", "xlsx"])
def test_notes_below_the_table(form: str, rows: str, said: str | None, tmp_path: Path) -> None:
    """A notice after an empty row; what says geometry there is a row."""
    item = read_from(form, f"joint,a,alpha,d\n{rows}\n", tmp_path)
    problems = item.problems if isinstance(item, Rejected) else ()
    messages = [problem.message for problem in (*problems, *item.notices)]
    assert [message for message in messages if said is None or said not in message] == []
    assert len(messages) == (said is not None)


@pytest.mark.parametrize(
    ("header", "cells", "said"),
    [
        (",a,alpha,d", ["0,0.3,0,0", "1,0.3,0,0"], None),
        (",a,alpha,d", ["1,0.3,0,0", "2,0.3,0,0"], None),
        (",a,alpha,d", ["425,0.3,0,0", "426,0.3,0,0"], "'425' is in a column without a header"),
        (",a,alpha,d", ["0,0.3,0,0", "0.5,0.3,0,0"], "'0.5' is in a column without a header"),
        ("a,,alpha,d", ["0.3,0.1,0,0", "0.3,0.2,0,0"], "'0.1' is in a column without a header"),
        ("a,alpha,d,,", ["0.3,0,0,,18.4"], None),
        ("a,alpha,d,", ["0.3,0,0,checked"], None),
    ],
)
@pytest.mark.parametrize("form", ["csv", "xlsx"])
def test_numbers_in_a_column_without_a_header(
    form: str, header: str, cells: list[str], said: str | None, tmp_path: Path
) -> None:
    """They count the rows, or may be any field and are refused; beside the table they are a note, as all texts are."""
    item = read_from(form, "\n".join([header, *cells, ""]), tmp_path)
    assert isinstance(item, Rejected) is ("is in" in (said or ""))
    problems = item.problems if isinstance(item, Rejected) else item.notices
    if form == "xlsx" or said:
        assert [problem.message for problem in problems if said is None or said not in problem.message] == []


@pytest.mark.parametrize(("cell", "bad"), [("501", []), ("7", ["r250"]), ("checked", []), ("0.5", ["r250"])])
def test_a_column_without_a_header_that_counts_the_rows_of_all_manipulators(cell: str, bad: list[str]) -> None:
    """As pandas writes it: one cell that is another number is refused, also where rows are read fast."""
    rows = [f"r{k // 2},{k if k != 501 else cell},0.3,0,0" for k in range(1000)]
    text = "\n".join(["# convention: standard", "robot,,a,alpha,d", *rows, ""])
    assert [item.name for item in dh2urdf.read_all(text, reader="csv") if isinstance(item, Rejected)] == bad
