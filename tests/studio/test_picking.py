"""The picked row and the picked link are one and the same, whatever is done to the table."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import pytest
from tests.studio.test_slow_network import HELD, UR5, Network, wait_for_rows

if TYPE_CHECKING:
    from collections.abc import Callable

PICKED = "[...document.querySelectorAll('.arm-view-picked')].map(label => label.textContent).join()"
LINK = """row => {
    const element = document.querySelector('.arm-view'), view = getElement(Number(element.id.slice(1)));
    const currentTarget = element.querySelector('canvas'), box = currentTarget.getBoundingClientRect(), found = [];
    for (let clientX = box.left + 2; clientX < box.right; clientX += 6)
        for (let clientY = box.top + 2; clientY < box.bottom; clientY += 6) {
            const isFree = document.elementFromPoint(clientX, clientY) === currentTarget;
            const { node } = isFree ? view.hit(view.ray({ currentTarget, clientX, clientY })) : {};
            if (node && node.userData.row === row) found.push([clientX, clientY]);
        }
    return found[Math.floor(found.length / 2)];
}"""
"""A point of the page where a double click meets a link."""


def wait_for_frame(tab: Any, label: str) -> None:
    tab.page.wait_for_function(f"label => {PICKED} === label", arg=label)


@pytest.mark.long
def test_the_frame_of_the_picked_row_stands_out(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """It stayed that of the row's old place when the row had moved, and of another row in the arm of an earlier table."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    tab.cell(2, "a").click()
    wait_for_frame(tab, "{3}")
    page.keyboard.press("Alt+ArrowDown")
    wait_for_frame(tab, "{4}")
    page.keyboard.press("Control+z")
    wait_for_frame(tab, "{3}")
    tab.cell(0, "a").click()
    page.keyboard.press("Alt+Insert")  # an empty row: the arm on the screen is that without it
    tab.cell(3, "a").click()
    tab.wait_for_cell(3, "joint", "elbow_joint")
    wait_for_frame(tab, "{3}")
    tab.cell(1, "a").click()
    wait_for_frame(tab, "")
    tab.settle()
    page.mouse.dblclick(*page.evaluate(LINK, 1))
    page.locator(".dh-table .ag-row[row-index='2'].dh-picked").first.wait_for()
    wait_for_frame(tab, "{2}")


@pytest.mark.long
def test_a_link_is_picked_before_the_answer(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """What a button does next is done to its row; it was done to the row that was still marked."""
    tab = new_tab(studio_address)
    tab.page.add_init_script(HELD)
    tab.open("ur5")
    network = Network(tab.page)
    tab.cell(5, "a").click()
    tab.settle()
    place = tab.page.evaluate(LINK, 1)
    network.hold()
    tab.page.mouse.dblclick(*place)
    tab.page.get_by_role("button", name="remove the row").click()
    network.release()
    wait_for_rows(tab, [UR5[0], *UR5[2:]])
    tab.page.close()


@pytest.mark.long
def test_menus_open_and_close_before_the_answer(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """They waited for it, above what a person wants to see."""
    tab = new_tab(studio_address)
    page = tab.page
    page.add_init_script(HELD)
    tab.open("ur5")
    tab.settle()
    Network(page).hold()
    menus = page.locator(".q-menu")
    for button, entry in (
        ("look from a side", "top (7)"),
        ("light, dark, projector", "light"),
        ("Save", "Table as csv"),
        ("more layers", None),
        ("opacity", None),
    ):
        page.get_by_role("button", name=button, exact=True).click()
        tab.expect(menus).to_have_count(1)
        if entry:
            menus.get_by_text(entry, exact=True).click()
        else:
            page.keyboard.press("Escape")
        tab.expect(menus).to_have_count(0)
    with page.expect_download():
        Network(page).release()
    tab.expect(menus).to_have_count(0)
    page.close()
