"""A point or a comma that may separate thousands: the other numbers of the same arm decide, and nothing else."""

from __future__ import annotations

import random
from typing import TYPE_CHECKING

import pytest

from dh2urdf.manipulator import Manipulator
from dh2urdf_plugins.readers import csv, xlsx
from dh2urdf_plugins.readers.plain.rows import PlainRows
from dh2urdf_plugins.readers.table import TableOptions

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

    from dh2urdf.stages import Rejected

    ReadText = Callable[[str], list[Manipulator | Rejected]]

TOP = "# units: {length: mm}\n"


@pytest.fixture
def read_text(tmp_path: Path) -> ReadText:
    """Reads a CSV table of the standard convention."""

    def read(text: str) -> list[Manipulator | Rejected]:
        path = tmp_path / "arm.csv"
        path.write_text(text, encoding="utf-8")
        return list(csv.READER.read(path, TableOptions(convention="standard")))

    return read


def lengths(arm: Manipulator | Rejected) -> list[tuple[float, float]] | None:
    return [(row.a, row.d) for row in arm.rows] if isinstance(arm, Manipulator) else None


@pytest.mark.parametrize(
    ("row", "expected"),
    [
        ("1.250;0;1.100", None),
        ("1,250;0;1,100", None),
        ("-1.250;0;425", None),
        ("1.250 mm;0;3", None),
        ("2*1.250;0;3", None),
        ("3;0;1,100 mm", None),
        ("1.250;0;0.5", (1.25, 0.5)),
        ("1,250;0;0,5", (1.25, 0.5)),
        ("1.250;0;1250.5", (1.25, 1250.5)),
        ("1.250;0;1.2500", (1.25, 1.25)),
        ("1.250;0;1.250e3", (1.25, 1250.0)),
        ("1.250;1.571;3", (1.25, 3.0)),  # 1571 rad are no angle of a table
        ("1.250;1.571 deg;3", None),
        ("1.250;0.5*pi;3", (1.25, 3.0)),
        ("1.250;0;0,5", None),
        ("1,250;0;0.5", None),
        ("9.000;0.00;1,000", None),
        ("1,000;0.00;9.000", None),
        ("9.000;0;1,000", None),
        ("0.250;0;0.125", (0.25, 0.125)),  # no number of thousands begins with 0
        ("1250;0;425", (1250.0, 425.0)),
        ("87.456;0;300", (87.456, 300.0)),  # no link is 87 m long
        ("87,456;0;1,250", (87.456, 1.25)),
        ("−87.456;0;300", (-87.456, 300.0)),
        ("49.999;0;300", None),
        ("87.456 mm;0;300", None),
        ("87.456;0;0,5", None),  # who writes commas may have meant thousands, and another unit
        ("0,5;0;87.456", None),
    ],
)
@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_other_numbers_of_the_arm_show_what_a_sign_means(
    row: str, expected: tuple[float, float] | None, delimiter: str, read_text: ReadText
) -> None:
    """Without one, or with one of each kind, the number is refused."""
    (arm,) = read_text(TOP + f"a;alpha;d\n{row}\n".replace(";", delimiter))
    read = lengths(arm)
    assert (read is None) is (expected is None)
    if read and expected:
        assert read == [pytest.approx([value / 1000 for value in expected], rel=1e-15)]


def test_a_point_is_the_decimal_sign_where_a_comma_separates_cells(read_text: ReadText) -> None:
    """And a quoted comma is refused there, as ever."""
    assert lengths(read_text(TOP + "a,alpha,d\n1.250,0,1.100\n")[0]) == [(0.00125, 0.0011)]
    assert lengths(read_text(TOP + 'a,alpha,d\n"1,250",0,1.100\n')[0]) is None
    assert lengths(read_text(TOP + 'a,alpha,d\n"87,456",0,"0,5"\n')[0]) == [(0.087456, 0.0005)]
    assert lengths(read_text(TOP + 'a,alpha,d\n"87,456",0,0.5\n')[0]) is None
    assert lengths(read_text(TOP + 'a,alpha,d\n"0,5",0,1.250\n')[0]) == [(0.0005, 0.00125)]


@pytest.mark.parametrize("careful", [False, True], ids=["fast", "careful"])
@pytest.mark.parametrize(
    ("units", "row", "a"),
    [
        ("m, deg", "1.250;0;1", 1.25),  # 1250 m
        ("cm, deg", "5.123;0;1", 0.05123),
        ("cm, deg", "1.250;0;1", None),
        ("mm, deg", "1.250;90.000;1", 0.00125),  # 90000 degrees
        ("mm, deg", "1.250;-1,571;1", None),
        ("mm, deg", "1,250;-1,571;1", 0.00125),
        ("m, deg", "1,250;0;0.5", None),
        ("m, deg", "1.250;0;2,500", None),
    ],
)
def test_a_number_that_is_none_with_thousands_shows_the_sign(
    units: str, row: str, a: float | None, *, careful: bool, read_text: ReadText, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It was asked about, though no table has such a length or angle."""
    if careful:
        monkeypatch.setattr(PlainRows, "read", lambda *_: None)
    (arm,) = read_text(f"# units: {units}\na;alpha;d\n{row}\n")
    assert (lengths(arm) or [(None,)])[0][0] == (pytest.approx(a, rel=1e-15) if a else None)
    (arm,) = read_text("a;alpha;d\n87.456;0;30\n")  # mm or m, which nobody declares
    assert lengths(arm) == [(87.456, 30.0)]
    (arm,) = read_text("a;alpha;d\n1.250;0;425\n")
    assert lengths(arm) is None


@pytest.mark.parametrize("careful", [False, True], ids=["fast", "careful"])
def test_an_arm_is_read_alike_alone_and_among_others(
    *, careful: bool, read_text: ReadText, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever its neighbours in the file show of their own signs, with and without the fast way."""
    if careful:
        monkeypatch.setattr(PlainRows, "read", lambda *_: None)
    kinds = {
        "1.250;0;1.100": None,
        "1.250;0;0.5": [(0.00125, 0.0005)],
        "1250;0;425": [(1.25, 0.425)],
        "1,250;0;0,5": [(0.00125, 0.0005)],
        "1,250;0;1,100": None,
        "0,5;0;1.100": None,
    }
    dice = random.Random(11)  # noqa: S311 - a sample
    chosen = dice.choices(list(kinds), k=400)
    rows = "".join(f"r{number};{row}\n" for number, row in enumerate(chosen))
    arms = read_text(TOP + "robot;a;alpha;d\n" + rows)
    assert [lengths(arm) for arm in arms] == [kinds[row] for row in chosen]


@pytest.mark.parametrize("number", [-5.655, 1.25, 1.25e-7, 12.125, 100.0, 1e16])
@pytest.mark.parametrize("arms", [1, 3])
def test_a_number_of_a_workbook_has_no_sign_between_thousands(number: float, arms: int, tmp_path: Path) -> None:
    """It is a number already, and shows nothing of the texts beside it."""
    from openpyxl import Workbook

    book = Workbook()
    rows = [[f"r{arm}", number, 0, text] for arm in range(arms) for text in (0.125, "0.5 m")]
    for row in (["robot", "a", "alpha", "d"], *rows):
        book.active.append(row)
    book.save(tmp_path / "arms.xlsx")
    options = xlsx.READER.options(convention="standard")
    found = [lengths(arm) for arm in xlsx.READER.read(tmp_path / "arms.xlsx", options)]
    expected = [(number, 0.125), (number, 0.5)]
    assert found == ([expected] * arms if abs(number) < 1e9 else [None] * arms)


def test_a_text_beside_numbers_of_a_workbook_is_refused(tmp_path: Path) -> None:
    """Numbers do not show which sign the author of a text writes."""
    from openpyxl import Workbook

    book = Workbook()
    for row in (["a", "alpha", "d"], ["1.250", 0, 0.5]):
        book.active.append(row)
    book.save(tmp_path / "arm.xlsx")
    (arm,) = xlsx.READER.read(tmp_path / "arm.xlsx", xlsx.READER.options(convention="standard"))
    assert "'1.250' can be read in two ways" in str(arm)


@pytest.mark.parametrize(
    ("limits", "upper"),
    [
        ("[-3.141, 3.141]", 3.141),
        ("-3.141,3.141", None),
        ("[-3.141; 3.141]", None),
        ("-3.141..3.141", None),
        ("-3,141..3,141", None),
        ("min: -3.141, max: 3.141", 3.141),
    ],
)
def test_a_comma_between_numbers_of_a_list_is_no_decimal_sign(
    limits: str, upper: float | None, read_text: ReadText
) -> None:
    """So that their points are; where it may be one, the number is refused."""
    (arm,) = read_text(f"a\talpha\td\tqlim\n1\t0\t0\t{limits}\n")
    if upper is None:
        assert not isinstance(arm, Manipulator)
    else:
        assert isinstance(arm, Manipulator)
        assert (arm.rows[0].limits.lower, arm.rows[0].limits.upper) == (-upper, upper)


def test_a_variable_with_a_decimal_comma_is_a_variable(read_text: ReadText) -> None:
    """Rows are told from fixed ones by their variables, with a comma in the number that is added as with a point."""
    (arm,) = read_text("a;alpha;d;theta\n100;0;0;q1 + 1,57\n100;0;0;q2\n")
    assert isinstance(arm, Manipulator)
    assert [row.offset for row in arm.rows] == [1.57, 0]
