from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import pytest

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.source import Mark, Problem
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.header.columns import TURN_ROUND
from dh2urdf_plugins.readers.table import CellRow, TableOptions, read_table

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator
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


def refusals(*cells: list[Any], options: TableOptions = STANDARD) -> list[tuple[str | None, str]]:
    """The code of each error, and the cell that it is about."""
    try:
        items = list(read_table(rows(*cells), "arm.ods", options))
        problems = [problem for item in items if isinstance(item, Rejected) for problem in item.problems]
    except TableError as error:
        problems = list(error.problems)
    return [(problem.code, problem.mark.place or "" if problem.mark else "") for problem in problems]


class TestRows:
    def test_numbers_texts_and_empty_cells(self) -> None:
        """Numbers are taken as they are, texts as the cells of a CSV file."""
        arm = read_one([*HEADER, "theta"], [*FIRST, None], ["elbow", "R", "-425 mm", "0", 0, "pi/2"])
        assert [(row.a, row.alpha, row.d, row.theta) for row in arm.rows] == [
            (0.0, math.pi / 2, 0.089, 0.0),
            (-0.425, 0.0, 0.0, math.pi / 2),
        ]
        assert arm.name == "arm"

    def test_empty_rows_and_comments_are_passed_over(self) -> None:
        """Above the header and below it."""
        arm = read_one([None, ""], ["# a note"], HEADER, FIRST, [None] * 5, ["# of 2020"], SECOND)
        assert [row.joint for row in arm.rows] == ["shoulder", "elbow"]
        assert arm.notices == ()


class TestTheTop:
    @pytest.mark.parametrize(
        "said",
        [
            ["# convention: modified"],
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
        with pytest.raises(TableError) as caught:
            read_one(["# name: x"], HEADER, FIRST, statements=said)
        assert [problem.code for problem in caught.value.problems] == ["declared-twice"]

    @pytest.mark.parametrize(
        ("cells", "code", "place"),
        [
            ([], "no-rows", ""),
            ([["a note"]], "no-header", "Sheet1!A1"),
            ([["a", "b"]], "missing-column", "Sheet1!A1"),
            ([["# untis: mm"], HEADER], "no-such-key", "Sheet1!A1"),
            ([["# base: {xyz: [0, 0, x]}"], HEADER], "no-quantity", "Sheet1!A1"),
            ([HEADER, FIRST, ["# name: x"]], "below-the-header", "Sheet1!A3"),
            ([HEADER, [*FIRST, 7]], "stray-number", "Sheet1!F2"),
            ([HEADER, FIRST, ["j2", "R", "x", 0, 0]], None, "Sheet1!C3"),
            ([["text"]] * 1001 + [HEADER, FIRST], "no-header", "Sheet1!A1"),
        ],
    )
    def test_refusals_name_the_cell(self, cells: list[Any], code: str | None, place: str) -> None:
        """Of comments, of the header, of rows, and where there is none; the search for a header ends."""
        assert refusals(*cells)[0] == (code, place)


class TestCells:
    def test_what_is_no_text_and_no_number_is_an_error_where_it_is_read(self) -> None:
        """A date in a column that no field knows is no matter."""
        date = Problem(message="the cell holds a date", found="2020-03-04")
        assert refusals(HEADER, ["j", "R", date, 0, 0]) == [(None, "Sheet1!C2")]
        assert read_one([*HEADER, "note"], [*FIRST, date]).rows[0].d == 0.089

    @pytest.mark.parametrize(("decimal_comma", "accepted"), [(True, True), (False, False)])
    def test_decimal_commas(self, *, decimal_comma: bool, accepted: bool) -> None:
        """Where no commas separate cells."""
        table = rows(HEADER, ["j", "R", "0,5", 0, 0])
        (item,) = read_table(table, "arm.ods", STANDARD, decimal_comma=decimal_comma)
        assert isinstance(item, Manipulator) is accepted


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
    ("rows", "code"),
    [
        ("j1,0.3,0,0\n\nrev B of the sheet", ""),
        ("j1,0.3,0,0\n\nmeasured, twice, by the maker", ""),
        ("j1,0.3,0,0\n,,,\nSource: UR,,,", ""),
        ("j1,0.3,0,0\n\nelbow,,0,0", "cell-empty"),
        ("j1,0.3,0,0\n\nj2,0.2,0,0", ""),
    ],
)
@pytest.mark.parametrize("form", ["csv", "xlsx"])
def test_notes_below_the_table(form: str, rows: str, code: str, tmp_path: Path) -> None:
    """In silence, after an empty row; what says geometry there is a row."""
    item = read_from(form, f"joint,a,alpha,d\n{rows}\n", tmp_path)
    assert [problem.code for problem in (*getattr(item, "problems", ()), *item.notices)] == ([code] if code else [])


@pytest.mark.parametrize(
    ("header", "cells", "refused"),
    [
        (",a,alpha,d", ["0,0.3,0,0", "1,0.3,0,0"], False),
        (",a,alpha,d", ["425,0.3,0,0", "426,0.3,0,0"], True),
        (",a,alpha,d", ["0,0.3,0,0", "0.5,0.3,0,0"], True),
        ("a,,alpha,d", ["0.3,0.1,0,0", "0.3,0.2,0,0"], True),
        ("a,alpha,d,,", ["0.3,0,0,,18.4"], False),
        ("a,alpha,d,", ["0.3,0,0,checked"], False),
    ],
)
@pytest.mark.parametrize("form", ["csv", "xlsx"])
def test_numbers_in_a_column_without_a_header(
    form: str, header: str, cells: list[str], tmp_path: Path, *, refused: bool
) -> None:
    """They count the rows, or may be any field and are refused; beside the table they are a note, as all texts are."""
    item = read_from(form, "\n".join([header, *cells, ""]), tmp_path)
    codes = [problem.code for problem in getattr(item, "problems", ())]
    assert codes == (["stray-number"] if refused else [])


@pytest.mark.parametrize(("cell", "bad"), [("501", []), ("7", ["r250"]), ("checked", []), ("0.5", ["r250"])])
def test_a_column_without_a_header_that_counts_the_rows_of_all_manipulators(cell: str, bad: list[str]) -> None:
    """As pandas writes it: one cell that is another number is refused, also where rows are read fast."""
    rows = [f"r{k // 2},{k if k != 501 else cell},0.3,0,0" for k in range(1000)]
    text = "\n".join(["# convention: standard", "robot,,a,alpha,d", *rows, ""])
    assert [item.name for item in dh2urdf.read_all(text, reader="csv") if isinstance(item, Rejected)] == bad


@pytest.mark.parametrize("name", ["θ_offset", "theta_offset_i", "Joint angle offset"])
@pytest.mark.parametrize("kind", ["R", "P"])
def test_an_offset_of_theta_is_the_constant_part_of_theta(
    name: str, kind: str, read_one: Callable[..., Manipulator]
) -> None:
    """It was refused; it is an angle, also where the joint slides."""
    arm = read_one(f"type,a,alpha,d,{name}\n{kind},0.3,0,0.1,pi/2\n")
    expected = read_one(f"type,a,alpha,d,theta\n{kind},0.3,0,0.1,pi/2\n")
    assert arm.fk([0.7]) == pytest.approx(expected.fk([0.7]))
    assert read_one(f"type,a,alpha,d,{name} [deg]\n{kind},0.3,0,0.1,30\n").rows[0].theta == pytest.approx(math.pi / 6)


@pytest.mark.parametrize(
    "table",
    [
        "parameter,J1,J2,J3\na,0,0.3,0.2\nalpha,pi/2,0,0\nd,0.1,0,0",
        "param;1;2;3\na [mm];0;300;200\nalpha;90;0;0\nd;100;0;0",
        "a,0,0.3,0.2\nalpha,0,0,0\nd,0.1,0,0",
    ],
)
def test_a_table_whose_joints_are_in_columns_is_to_be_turned_round(table: str) -> None:
    """The advice was that no field is called '0.3'."""
    with pytest.raises(TableError) as caught:
        dh2urdf.read(f"# convention: standard\n{table}\n", reader="csv")
    assert TURN_ROUND in [problem.suggestion for problem in caught.value.problems]


def test_a_row_of_names_that_are_headers_too_is_a_row(read_one: Callable[..., Manipulator]) -> None:
    """Numbers are in it."""
    assert [row.joint for row in read_one("joint,link,a,alpha,d\nmass,base plate,0.3,0,0\n").rows] == ["mass"]
