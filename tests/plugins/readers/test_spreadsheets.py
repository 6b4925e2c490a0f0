"""The tables of `configs/`, opened and saved by spreadsheets, are the same arms."""

from dataclasses import replace
from pathlib import Path

import pytest
from spreadsheets import ENGLISH, GERMAN, UNAWARE, Spreadsheet

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf.table_text.texts import table_text
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.sources import typed
from dh2urdf_plugins.readers.table import TableOptions

FOLDER = Path(__file__).parents[3] / "configs" / "tables"
TABLES = sorted(FOLDER.iterdir())
SPREADSHEETS = (*ENGLISH, *GERMAN)


def read(path: Path) -> Manipulator | Rejected:
    reader = stages.CSV if path.suffix == ".csv" else stages.YAML
    (arm,) = reader.read(path, TableOptions())
    return arm


def arm_of(path: Path) -> Manipulator:
    arm = read(path)
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    return arm


def as_csv(path: Path) -> str:
    """The table as it stands, or as the project writes it where it is YAML."""
    if path.suffix == ".csv":
        return path.read_text("utf-8")
    return typed.write_csv([table_text(arm_of(path))]).content.decode()


def same(left: Manipulator, right: Manipulator) -> bool:
    return (left.convention, left.rows, left.base, left.tool) == (right.convention, right.rows, right.base, right.tool)


@pytest.mark.parametrize("spreadsheet", SPREADSHEETS, ids=[each.name for each in SPREADSHEETS])
@pytest.mark.parametrize("table", TABLES, ids=[path.name for path in TABLES])
def test_a_table_that_a_spreadsheet_has_saved_is_the_same_arm(
    table: Path, spreadsheet: Spreadsheet, tmp_path: Path
) -> None:
    """Once and twice: only cells that Excel took for formulas and replaced by its error are refused."""
    arm, path, content = arm_of(table), tmp_path / f"{table.stem}.csv", as_csv(table)
    again = replace(spreadsheet, opens=spreadsheet.separator, reads=spreadsheet.decimal)
    first = spreadsheet.saved(content)
    for saved in (first, again.saved(first.decode(spreadsheet.encoding))):
        path.write_bytes(saved)
        found = read(path)
        if b"#NAME?" in saved.replace(b"\0", b""):
            assert not isinstance(found, Manipulator)
            assert any("#NAME?" in problem.message for problem in found.problems)
            return
        assert isinstance(found, Manipulator), "\n".join(map(str, found.problems))
        assert same(found, arm)


@pytest.mark.parametrize("spreadsheet", UNAWARE, ids=[each.name for each in UNAWARE])
@pytest.mark.parametrize("table", TABLES, ids=[path.name for path in TABLES])
def test_what_a_spreadsheet_has_destroyed_is_no_other_arm(
    table: Path, spreadsheet: Spreadsheet, tmp_path: Path
) -> None:
    """A point that was taken for a separator of thousands makes −0.425 m to −425 m: refused where it may be seen."""
    arm, path = arm_of(table), tmp_path / f"{table.stem}.csv"
    path.write_bytes(spreadsheet.saved(as_csv(table)))
    try:
        found = read(path)
    except TableError:
        return
    assert not isinstance(found, Manipulator) or same(found, arm) or found.notices
