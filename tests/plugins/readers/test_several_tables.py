"""Several tables in one file, as the readers ``yaml`` and ``csv`` write them, and what a format leaves out."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

import dh2urdf as api
from dh2urdf.commands.extract import write_extracted
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import load

TABLES = Path(__file__).parents[3] / "configs" / "tables"


@pytest.fixture
def arms() -> list[Manipulator]:
    arm = api.read(TABLES / "ur5.csv")
    return [replace(arm, mark=None), replace(arm, name="twin", mark=None)]


@pytest.mark.parametrize("suffix", [".yaml", ".csv"])
def test_several_arms_in_one_file_come_back(arms: list[Manipulator], suffix: str, tmp_path: Path) -> None:
    """Every arm of the file equals the one that was written, in order."""
    path = tmp_path / f"arms{suffix}"
    assert write_extracted(arms, path, load(), inputs=()) == ()
    assert list(api.read_all(path)) == arms


TWO = """\
# convention: standard
# units: mm, deg
name: left
joint,a,alpha,d
1,100,90,0
2,300,0,50

name: right
# units: m, deg
joint,a,alpha,d
1,0.2,-90,0
2,0.4,0,0.6
"""


def in_csv(text: str, folder: Path) -> Path:
    (folder / "arms.csv").write_text(text)
    return folder / "arms.csv"


def in_workbook(text: str, folder: Path) -> Path:
    """The cells of a text as one sheet of a workbook."""
    book = pytest.importorskip("openpyxl").Workbook()
    for line in text.splitlines():
        cells = [line] if line.startswith("#") else line.split(",")
        book.active.append([float(cell) if cell.strip("-").replace(".", "").isdigit() else cell for cell in cells])
    book.save(folder / "arms.xlsx")
    return folder / "arms.xlsx"


@pytest.mark.parametrize(("number", "name", "first"), [(1, "left", (0.1, 0.0)), (2, "right", (0.2, 0.0))])
@pytest.mark.parametrize("written", [in_csv, in_workbook])
def test_a_table_of_a_file_is_chosen_by_its_number(
    written: Callable[[str, Path], Path], number: int, name: str, first: tuple[float, float], tmp_path: Path
) -> None:
    """Each has what is above all of them and what is above itself, which is stronger; its rows keep their places."""
    arm = api.read(written(TWO, tmp_path), table_number=number)
    assert (arm.name, arm.convention, len(arm.rows)) == (name, "standard", 2)
    assert (arm.rows[0].a, arm.rows[0].d) == first
    assert arm.rows[0].mark
    assert arm.rows[0].mark.line == (5 if number == 1 else 11)


@pytest.mark.parametrize("number", [None, 0, 3])
@pytest.mark.parametrize(("written", "places"), [(in_csv, "line {}"), (in_workbook, "Sheet!A{}")])
def test_which_table_of_a_file_is_meant_is_asked(
    written: Callable[[str, Path], Path], places: str, number: int | None, tmp_path: Path
) -> None:
    """In one sentence that has the places of all of them."""
    said = f"the file has 2 tables of parameters: 1 in {places.format(4)}, 2 in {places.format(10)}"
    with pytest.raises(TableError, match=said):
        api.read(written(TWO, tmp_path), table_number=number)


@pytest.mark.parametrize(
    "between", ["", "\n", "# of the other arm\n", "\nThe other arm:\n\n", "# name: b\n", ",,,\n,,,\n"]
)
@pytest.mark.parametrize("header", ["joint,a,alpha,d", "i,d,a [m],alpha"])
def test_a_second_header_is_never_passed_over(header: str, between: str, tmp_path: Path) -> None:
    """Whatever is between two tables, and whether their headers are the same or not."""
    path = in_csv(f"joint,a,alpha,d\n1,0.1,0,0\n{between}{header}\n1,0.2,0,0\n", tmp_path)
    with pytest.raises(TableError, match=r"header of line 1 again|1 in line 1, 2 in line"):
        api.read(path, convention="standard")
    assert [row.a for row in api.read(path, convention="standard", table_number=1).rows] == [0.1]
    with_a = api.read(path, convention="standard", table_number=2).rows[0]
    assert (with_a.a, with_a.d) == ((0.2, 0.0) if header.startswith("joint") else (0.0, 0.2))


def test_a_table_in_a_text_is_chosen_as_one_in_a_file() -> None:
    """A text that is pasted is asked about in the same words; of one table the first is meant."""
    assert api.read(TWO, table_number=2).name == "right"
    with pytest.raises(TableError, match="the file has 2 tables of parameters: 1 in line 4, 2 in line 10"):
        api.read(TWO)
    with pytest.raises(TableError, match="the file has 1 table of parameters: 1 in line 1"):
        api.read("a,alpha,d\n1,0,0\n", convention="standard", table_number=2)


@pytest.mark.parametrize("suffix", [".yaml", ".parquet"])
def test_a_number_is_never_passed_over(suffix: str, tmp_path: Path) -> None:
    """A format that has one table in a file refuses another number."""
    path = tmp_path / f"arm{suffix}"
    if suffix == ".yaml":
        path.write_text("joints: [{a: 1, alpha: 0, d: 0}]")
    else:
        columns = pytest.importorskip("pyarrow").table({"a": [1.0], "alpha": [0.0], "d": [0.0]})
        pytest.importorskip("pyarrow.parquet").write_table(columns, path)
    assert api.read(path, convention="standard", table_number=1).rows[0].a == 1.0
    with pytest.raises(TableError, match="the file has 1 table of parameters"):
        api.read(path, convention="standard", table_number=2)
