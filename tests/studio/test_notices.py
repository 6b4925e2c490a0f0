"""Notices: they go with their table, lie over no question, ask with buttons, and are text whatever they quote."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.editing.opening import gallery_table

pytestmark = pytest.mark.long
WRONG = "# convention: standard\njoint,type,a,alpha,d\nj1,revolute,0.15,0,0.2\nj2,revolute,0.1x2,pi,0\n"
IGNORED = "# convention: standard\na,alpha,d,cable\n1,0,0,red\n1,pi/2,0,red\n"
HOSTILE = """\
name: "q<img src=x onerror=window.P=40>"
convention: standard
joints:
- {name: "j<img src=x onerror=window.P=41>", type: revolute, a: 0.3, alpha: 1.57, d: 0.1}
- {name: "k<img src=x onerror=window.P=42>", link: "l<svg onload=window.P=43>", type: revolute, a: 0.3, alpha: 0, d: 0}
- {name: "m<img src=x onerror=window.P=44>", type: prismatic, a: 0, alpha: 0, d: "0<img src=x onerror=window.P=45>"}
"""


def drop(tab: Any, folder: Path, name: str, text: str) -> Any:
    """Drops a file of a text; gives the notices on the page."""
    (folder / name).write_text(text)
    tab.drop(".arm-view", folder / name)
    return tab.page.locator(".q-notification", has=tab.page.get_by_role("button", name="Close"))


def test_a_notice_asks_with_buttons(tab: Any, catalog: Catalog) -> None:
    """An arm of 425 m: mm are other numbers' unit, and m is the answer that takes the notice away; so for an angle."""
    table = gallery_table("ur5.csv", catalog)
    rows = [{**row, "a": f"{1000 * float(row['a']):g}", "d": f"{1000 * float(row['d']):g}"} for row in table.rows]
    page = tab.open_table(replace(table, rows=tuple(rows)))
    asked = page.locator(".studio-asked").get_by_role("button")
    page.get_by_text("if its lengths are in mm").wait_for()
    assert asked.all_inner_texts() == ["mm", "m"]
    asked.get_by_text("mm").click()
    unit = page.get_by_label("unit of lengths").locator("[aria-pressed=true]")
    tab.expect(unit).to_have_text("mm")
    tab.expect(asked).to_have_count(0)
    tab.wait_for_cells(1, a="-425", d="0")
    tab.wait_for_status("6 axes; the arm is the table's")
    page.get_by_role("button", name="undo", exact=True).click()
    asked.get_by_text("m", exact=True).click()
    tab.expect(asked).to_have_count(0)
    tab.expect(unit).to_have_text("m")
    tab.wait_for_cells(1, a="-425", d="0")

    tab.open("ur5")
    tab.type_into(
        0, "alpha", "90"
    )  # in rad it is no angle: the button for degrees makes it one, and there is none for rad
    tab.expect(asked).to_have_text(["deg"])


def test_notices_go_with_their_table(tab: Any, tmp_path: Path) -> None:
    """What was said of a file that cannot be read, or of a table before this one, is gone when another table is there."""
    page = tab.open("ur5")
    shown = drop(tab, tmp_path, "wrong.csv", WRONG)
    tab.expect(shown).to_contain_text("0.1x2")
    drop(tab, tmp_path, "ignored.csv", IGNORED)
    tab.wait_for_table("ignored")
    tab.expect(shown).to_have_count(1)
    tab.expect(shown).to_contain_text("cable")
    tab.type_into(0, "a", "0.9")
    tab.settle()
    assert shown.count() == 1, "an edit leaves it the same table"
    page.get_by_role("button", name="undo", exact=True).click()
    tab.settle()
    assert shown.count() == 1
    page.get_by_role("button", name="undo", exact=True).click()
    tab.wait_for_table("ur5")
    tab.expect(shown).to_have_count(0)


def test_names_with_markup_are_text(studio_address: str, new_tab: Callable[..., Any], tmp_path: Path) -> None:
    """In cells, fields, notices, labels, sliders, panels, questions and what is handed over, nothing of it is run."""
    tab = new_tab(studio_address, faults=False)
    page = tab.open("ur5")
    shown = drop(tab, tmp_path, "hostile.yaml", HOSTILE)
    tab.expect(shown).to_contain_text("<img src=x onerror=window.P=45>")
    drop(tab, tmp_path, "hostile.yaml", HOSTILE.replace("0<img src=x onerror=window.P=45>", "0"))
    page.wait_for_function("document.querySelector('.studio-name input').value.includes('window.P=40')")
    tab.wait_for_cell(0, "joint", "j<img src=x onerror=window.P=41>")
    tab.settle()
    tab.cell(1, "a").click()
    for name in ("explain the picked row", "measure between frames, and show the workspace", "stored poses"):
        page.get_by_role("button", name=name).click()
        tab.settle()
    tab.type_into(1, "alpha", "1<img src=x onerror=window.P=46>")
    page.locator(".studio-problem.error").first.wait_for()
    tab.type_into(1, "alpha", "0")
    tab.settle()
    page.get_by_role("button", name="modified", exact=True).click()
    page.get_by_role("dialog").get_by_text("Convert").click()
    page.get_by_role("button", name="Generate").click()
    page.wait_for_timeout(1500)
    assert page.evaluate("window.P") is None
    assert page.locator("img[src=x], svg[onload]").count() == 0
