"""axe-core on all that the studio shows, in every mode, in a real browser."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

PANELS = (
    "set the pose of tool0",
    "stored poses",
    "measure between frames",
    "explain the picked row",
    "compare with a robot description",
)
MENUS = ("Save", "more layers", "look from a side", "light, dark, projector")


def dress(page: Any, look: str, size: str) -> None:
    """Has a page look in a mode: this page alone, and not kept, as other tests share the browser's profile."""
    page.evaluate(f"Object.assign(document.documentElement.dataset, {{ look: '{look}', size: '{size}' }})")
    page.evaluate(f"Quasar.Dark.set({'true' if look == 'dark' else 'false'})")
    page.evaluate("dispatchEvent(new Event('dh-look'))")
    # What fades takes a third of a second, and axe waits for it.
    page.add_style_tag(
        content="*, ::before, ::after { transition-duration: 0s !important; animation-duration: 0s !important }"
    )


def parts(tab: Any, folder: Path, look: str, size: str) -> Iterator[tuple[str, str]]:
    """Brings the page into every state, one after the other: its name, and the part of the page that is new in it."""
    page = tab.page
    dress(page, look, size)
    yield "an empty table", "document"
    page.get_by_role("button", name="Open", exact=True).click()
    yield from _dialog(page, "opening")
    two = folder / "two.csv"
    two.write_text("# convention: standard\nrobot,a,alpha,d\nfirst,1,0,0\nsecond,2,0,0\n")
    tab.choose_file(two)
    page.get_by_text("The file holds 2 manipulators").wait_for()
    yield from _dialog(page, "which manipulator")
    tab.open_from_gallery("ur5")
    tab.cell(1, "a").click()
    yield "an arm", "document"
    for name in PANELS:
        button = page.get_by_role("button", name=name)
        button.click()
        page.locator(".studio-panel:visible").wait_for()
        yield name, "[...document.querySelectorAll('.studio-panel')].find(panel => panel.offsetParent)"
        button.click()
        tab.expect(page.locator(".studio-panel:visible")).to_have_count(0)
    for name in MENUS:
        page.get_by_role("button", name=name).click()
        page.locator(".q-menu").wait_for()
        yield name, "document.querySelector('.q-menu')"
        page.keyboard.press("Escape")
        page.wait_for_function("!document.querySelector('.q-menu')")
    page.get_by_role("button", name="Save").click()
    page.locator(".q-menu").get_by_text("Link with this table").click()
    yield from _dialog(page, "a link", "Close")
    page.get_by_role("button", name="modified").click()
    yield from _dialog(page, "the convention")
    for name, text in (
        ("a pasted table", "a\talpha\td\n1\t0\t0\n2\t0\t0\n"),
        ("one that is wrong", "# x\na,alpha,d\n1,y,0\n"),
    ):
        tab.paste(0, "a", text)
        yield from _dialog(page, name)
    tab.type_into(1, "alpha", "pi/x")
    tab.wait_for_status("1 problem")
    yield "a wrong cell", "document"
    page.get_by_role("button", name="mm", exact=True).click()
    yield from _dialog(page, "units of a wrong table")
    page.get_by_role("button", name="Generate").click()
    yield from _dialog(page, "no URDF", "Close")
    page.get_by_label("number of axes").fill("1001")
    page.keyboard.press("Enter")
    page.locator(".q-notification").wait_for()
    yield "a notification", "document.querySelector('.q-notification')"
    # The table that a tab has kept is offered by a server that does not know the tab.
    page.evaluate("const kept = dhPage.kept(); sessionStorage.clear(); dhPage.keep(kept)")
    page.reload()
    page.get_by_text("This tab has kept a table").wait_for()
    dress(page, look, size)
    yield from _dialog(page, "a server that was started anew", "Go on without it")


def _dialog(page: Any, name: str, closes: str = "Cancel") -> Iterator[tuple[str, str]]:
    page.locator(".studio-card h2").wait_for()
    page.wait_for_function("!document.querySelector('[class*=-enter-]')")  # it has come in
    # axe takes the veil behind the card for what its texts are on, and the text of a button, whose z-index is 0, for one
    # behind the button.
    page.add_style_tag(content=".q-dialog__backdrop { display: none } .q-dialog .q-btn__content { z-index: auto }")
    yield name, "document.querySelector('.q-dialog')"
    page.locator(".q-dialog").get_by_role("button", name=closes, exact=True).click()
    page.locator(".q-dialog").wait_for(state="detached")


def found(tab: Any, folder: Path, look: str, size: str) -> dict[str, list[Any]]:
    """What axe-core finds in every state, in a mode."""
    tab.open()
    return {name: serious for name, where in parts(tab, folder, look, size) if (serious := tab.serious(where))}


@pytest.mark.long
@pytest.mark.parametrize(
    ("look", "size", "width"),
    [("light", "usual", 1280), ("dark", "usual", 390), ("dark", "large", 1280), ("light", "large", 390)],
)
def test_axe_finds_nothing_serious(  # noqa: PLR0917 - fixtures and parameters
    studio_address: str, new_tab: Callable[..., Any], tmp_path: Path, look: str, size: str, width: int
) -> None:
    """On the page, every panel, dialog, menu and notification: light, dark on a telephone, and both for a projector."""
    tab = new_tab(studio_address, width=width, height=844 if width == 390 else 720)
    assert found(tab, tmp_path, look, size) == {}
