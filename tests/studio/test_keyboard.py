"""The paper's job by keyboard alone, from an empty table to a URDF, in a real browser."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.kinematics import forward_kinematics
from dh2urdf.manipulator import Manipulator

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.plugin_system import Catalog


TABLES = Path(__file__).parents[2] / "configs" / "tables"


def ur5_cells() -> list[list[str]]:
    """a, alpha and d of the UR5 as its table has them."""
    lines = [line for line in (TABLES / "ur5.csv").read_text().splitlines() if not line.startswith("#")]
    return [[row[key].strip() for key in ("a", "alpha", "d")] for row in csv.DictReader(lines, skipinitialspace=True)]


@pytest.mark.long
def test_the_ur5_by_keyboard(
    studio_address: str, new_tab: Callable[..., Any], cli: Callable[..., Any], tmp_path: Path, catalog: Catalog
) -> None:
    """Number of axes, convention, a, α and d by keyboard; the pose is the DH product, and the URDF that of `convert`."""
    tab = new_tab(studio_address)
    page = tab.open()
    keys = page.keyboard
    keys.type("6")
    keys.press("Enter")
    page.wait_for_function("document.querySelectorAll('.dh-table .ag-center-cols-container .ag-row').length === 6")
    keys.press("Tab")
    keys.press("Space")
    page.wait_for_function("document.activeElement.getAttribute('col-id') === 'a'")
    for a, alpha, d in ur5_cells():
        keys.type(a)
        keys.press("Tab")
        keys.type(alpha)
        keys.press("Tab")
        keys.type(d)
        keys.press("Enter")
    tab.wait_for_status("6 axes; the arm is the table's")
    tab.wait_for_cells(1, **dict(zip(("a", "alpha", "d"), ur5_cells()[1], strict=True)))

    name, content = tab.save("Table as csv")
    table = tmp_path / name
    table.write_bytes(content)
    reader = catalog.reader_for(table)
    (arm,) = reader.read(table, reader.options())
    assert isinstance(arm, Manipulator)

    sliders = page.locator(".joint-slider input[type=range]")
    for index in range(6):
        sliders.nth(index).focus()
        for _ in range(index + 1):
            keys.press("Shift+ArrowRight" if index % 2 else "Shift+ArrowLeft")
    q = tab.sliders()
    assert len({abs(value) for value in q}) == 6
    tab.wait_for_pose("tool0", forward_kinematics(arm, q))
    tab.wait_for_pose("frame 6", forward_kinematics(arm, q))

    with page.expect_download() as generating:
        page.keyboard.press("Control+Enter")
    assert generating.value.suggested_filename == "arm.urdf"
    made = cli("convert", table)
    assert generating.value.path().read_bytes() == made.stdout.encode()
