"""Commas in numbers: the decimal sign where no number of the same arm has a point."""

from __future__ import annotations

import random
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.plain.rows import PlainRows

if TYPE_CHECKING:
    from readings import Read


TOP = "# units: {length: mm}\n"


def lengths(arm: Manipulator | Rejected) -> list[tuple[float, float]] | None:
    return [(row.a, row.d) for row in arm.rows] if isinstance(arm, Manipulator) else None


KINDS: dict[str, tuple[float, float] | None] = {
    "1.250;0;1.100": (1.25, 1.1),
    "-1.250;0;425": (-1.25, 425.0),
    "1,250;0;0,5": (1.25, 0.5),
    "−87,456;0;0,5 mm": (-87.456, 0.5),
    "0,250;0;0": (0.25, 0.0),
    "-1112,155;0;3": (-1112.155, 3.0),
    "1,250;0;1,100": None,
    "1,250;0;3": None,
    "1.250;0;0,5": None,
    "9.000;0.00;1,000": None,
    "1.234,5;0;3": None,
}


@pytest.mark.parametrize(("row", "expected"), KINDS.items())
@pytest.mark.parametrize("delimiter", [";", "\t"])
def test_what_a_comma_means(row: str, expected: tuple[float, float] | None, delimiter: str, read: Read) -> None:
    """`1,250` alone is refused, and so are both signs in one arm; `1112,155` has no groups of three."""
    (arm,) = read(TOP + f"a;alpha;d\n{row}\n".replace(";", delimiter), convention="standard")
    read = lengths(arm)
    assert read == (expected and [pytest.approx([value / 1000 for value in expected], rel=1e-15)])


@pytest.mark.parametrize("careful", [False, True], ids=["fast", "careful"])
def test_an_arm_is_read_alike_alone_and_among_others(
    *, careful: bool, read: Read, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whatever its neighbours in the file show of their own signs, with and without the fast way."""
    if careful:
        monkeypatch.setattr(PlainRows, "read", lambda *_: None)
    dice = random.Random(11)  # noqa: S311 - a sample
    chosen = dice.choices(list(KINDS), k=400)
    rows = "".join(f"r{number};{row}\n" for number, row in enumerate(chosen))
    arms = read(TOP + "robot;a;alpha;d\n" + rows, convention="standard")
    assert [lengths(arm) is None for arm in arms] == [KINDS[row] is None for row in chosen]


@pytest.mark.parametrize("number", [-5.655, 1.25, 1.25e-7, 12.125, 100.0])
@pytest.mark.parametrize("arms", [1, 3])
def test_a_number_of_a_workbook_has_no_sign(number: float, arms: int, tmp_path: Path) -> None:
    """It is a number already, and shows nothing of the texts beside it."""
    from openpyxl import Workbook

    book = Workbook()
    rows = [[f"r{arm}", number, 0, text] for arm in range(arms) for text in (0.125, "0,5 m")]
    for row in (["robot", "a", "alpha", "d"], *rows):
        book.active.append(row)
    book.save(tmp_path / "arms.xlsx")
    options = stages.XLSX.options(convention="standard")
    found = [lengths(arm) for arm in stages.XLSX.read(tmp_path / "arms.xlsx", options)]
    assert found == [[(number, 0.125), (number, 0.5)]] * arms


def test_a_variable_with_a_decimal_comma_is_a_variable(read: Read) -> None:
    """Rows are distinguished from fixed ones by their variables, with a comma in the number that is added as with a point."""
    (arm,) = read("a;alpha;d;theta\n100;0;0;q1 + 1,57\n100;0;0;q2\n", convention="standard")
    assert isinstance(arm, Manipulator)
    assert [row.offset for row in arm.rows] == [1.57, 0]
