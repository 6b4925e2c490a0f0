from __future__ import annotations

import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest
from openpyxl import Workbook  # type: ignore[import-untyped]

from dh2urdf.errors import EditError, LoaderError, TableError
from dh2urdf.stages import LoadRequest, NoOptions, Rejected
from dh2urdf.testing import EditContract, ExecutorContract, LoaderContract, ReaderContract, reference_manipulators
from dh2urdf_short.joblib_pool import EXECUTOR, JoblibOptions
from dh2urdf_short.tool_load import EDIT, ToolLoadOptions, edit_table
from dh2urdf_short.workbook import READER, read
from dh2urdf_short.yourdfpy_arm import LOADER, open_arm

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.robot import Robot

FOLDER = Path(__file__).parents[1]


def workbook(count: int) -> bytes:
    """A workbook with so many sheets of two rows."""
    book, file = Workbook(), io.BytesIO()
    book.remove(book.active)
    for number in range(count):
        sheet = book.create_sheet(f"arm_{number}")
        sheet.append(["# convention: standard"])
        sheet.append(["a [mm]", "alpha [deg]", "d [mm]"])
        sheet.append([400 + number, 90, 100])
        sheet.append([300, 0, 0])
    book.save(file)
    return file.getvalue()


class TestToolLoad(EditContract):
    stage = EDIT
    options = ToolLoadOptions(mass=2.5)


class TestWorkbook(ReaderContract):
    stage = READER
    example = workbook(3)
    is_document = True

    def many(self, count: int) -> bytes:
        return workbook(count)


class TestJoblib(ExecutorContract):
    stage = EXECUTOR
    options = JoblibOptions(workers=2)


class TestYourdfpy(LoaderContract):
    stage = LOADER


def test_the_cylinder_stands_on_tool0() -> None:
    """m·(3r² + l²)/12 and m·r²/2; a second one is refused."""
    arm = edit_table(reference_manipulators()[0], ToolLoadOptions(mass=12.0, radius=1.0, length=2.0))
    assert arm.payload is not None
    assert arm.payload.com == (0.0, 0.0, 1.0)
    assert arm.payload.inertia is not None
    assert (arm.payload.inertia.ixx, arm.payload.inertia.iyy, arm.payload.inertia.izz) == (7.0, 7.0, 6.0)
    with pytest.raises(EditError, match="a payload already"):
        edit_table(arm, ToolLoadOptions())


def test_a_wrong_cell_is_named_as_excel_names_it(tmp_path: Path) -> None:
    book = Workbook()
    for row in (["# convention: standard"], ["a", "alpha", "d"], ["wide", 0, 0]):
        book.active.append(row)
    book.active.title = "Left"
    book.save(tmp_path / "arms.xlsm")
    (rejected,) = read(tmp_path / "arms.xlsm", READER.options())
    assert isinstance(rejected, Rejected)
    assert "Left!A3" in str(rejected.problems[0])
    (tmp_path / "arms.xlsm").write_bytes(b"no zip")
    with pytest.raises(TableError, match="no Excel workbook"):
        list(read(tmp_path / "arms.xlsm", READER.options()))


def test_all_work_in_a_run(dh2urdf_run: Callable[..., Any]) -> None:
    """The arms carry the cylinder, and yourdfpy has them as they were written."""
    text, arms = (FOLDER.joinpath(name).read_text("utf-8") for name in ("run.yaml", "arms.csv"))
    run = dh2urdf_run(text.partition("output:")[0], {"arms.csv": arms})
    assert run.exit_status == 0
    for arm in run.report["manipulators"]:
        measured = arm["loaders"]["yourdfpy"]
        assert measured["poses"] == 25
        assert measured["position_error"] < 1e-12
        assert "payload" in run.folder.joinpath(f"{arm['name']}.urdf").read_text("utf-8")


def test_a_file_that_yourdfpy_does_not_take_is_refused(tmp_path: Path, dh2urdf_robots: tuple[Robot, ...]) -> None:
    (tmp_path / "arm.urdf").write_text("<robot")
    request = LoadRequest(path=tmp_path / "arm.urdf", robot=dh2urdf_robots[0], poses=(), expected={})
    with pytest.raises(LoaderError, match="yourdfpy cannot load"):
        open_arm(request, NoOptions())
