import math
from collections.abc import Callable
from pathlib import Path

import pytest

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.header.columns import TURN_ROUND

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
