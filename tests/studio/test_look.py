"""How the pages look: light, dark, for a projector, and on screens of every width; in a real browser."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

pytestmark = pytest.mark.long
TABLES = Path(__file__).parents[2] / "configs" / "tables"

LOOK = """() => {
    const { look, size } = document.documentElement.dataset;
    const style = (query, name) => getComputedStyle(document.querySelector(query))[name];
    const colours = [];
    document.querySelector('.arm-view').scene.traverse(part => part.isLineSegments &&
        colours.push([...part.geometry.attributes.color.array.slice(0, 3)].map(x => x.toFixed(2)).join()));
    return { look, size, quasar: document.body.classList.contains('body--dark'),
             label: parseFloat(style('.arm-view-label', 'fontSize')), ink: style('body', 'color'), grid: colours.join(' ') };
}"""


WHOLE_HEADERS = """[...document.querySelectorAll('.dh-table .ag-header-cell-text')].every(
    text => text.scrollWidth <= text.clientWidth)"""


WITHOUT_SCROLLING = """columns => {
    const [table, ...heads] = ['.dh-table', '.dh-table .ag-header-cell'].flatMap(all => [...document.querySelectorAll(all)]);
    const right = part => part.getBoundingClientRect().right;
    return heads.length >= columns && heads.slice(0, columns).every(head => right(head) <= right(table));
}"""


ASKED = """{
    window.smoothed = []; // what the scene has asked for: these tests switch smoothing off in the browser
    const ask = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, options) {
        if (options && "antialias" in options) smoothed.push(options.antialias);
        return ask.call(this, kind, options);
    };
}"""


def test_light_dark_and_projector(tab: Any, new_tab: Callable[..., Any], serving: Callable[..., Any]) -> None:
    """The system's scheme, unless one is chosen; page, cells and scene follow, and the browser keeps the choice."""
    tab.page.emulate_media(color_scheme="light")
    page = tab.open("ur5")
    light = page.evaluate(LOOK)
    assert (light["look"], light["size"], light["quasar"]) == ("light", "usual", False)
    page.emulate_media(color_scheme="dark")
    page.wait_for_function("document.body.classList.contains('body--dark')")
    dark = page.evaluate(LOOK)
    assert (dark["look"], dark["quasar"]) == ("dark", True)
    assert dark["ink"] != light["ink"]
    assert dark["grid"] != light["grid"]
    tab.choose("light, dark, projector", "light")
    page.wait_for_function("document.documentElement.dataset.look === 'light'")
    page.wait_for_function(f"light => JSON.stringify(({LOOK})()) === JSON.stringify(light)", arg=light)

    page.get_by_text("a α d θ", exact=True).click()
    thickness = "() => document.querySelector('.arm-view').scene.getObjectByName('d 1')?.geometry.parameters.radius"
    page.wait_for_function(f"({thickness})() > 0")
    thin, row = page.evaluate(thickness), tab.cell(0, "a").bounding_box()["height"]
    tab.choose("light, dark, projector", "projector: larger text and lines")
    page.wait_for_function("document.documentElement.dataset.size === 'large'")
    page.wait_for_function(f"thin => ({thickness})() > 1.5 * thin", arg=thin)
    page.wait_for_function(f"document.querySelector('.dh-table .ag-cell').offsetHeight > {1.25 * row}")
    page.wait_for_function(f"label => ({LOOK})().label > 1.25 * label", arg=light["label"])
    page.wait_for_function(WHOLE_HEADERS)
    page.get_by_role("button", name="light, dark, projector").click()
    chosen = page.locator(".studio-look[aria-checked=true]")
    tab.expect(chosen).to_have_text(["light", "projector: larger text and lines"])

    page.reload()
    page.wait_for_function("document.querySelector('.arm-view')?.shown > 0")
    assert page.evaluate("({ ...document.documentElement.dataset })") == {"look": "light", "size": "large"}
    cut = """() => [...document.querySelectorAll('.dh-table .ag-cell:not(.dh-number), .dh-table .ag-header-cell-text')]
        .filter(cell => cell.scrollWidth > cell.clientWidth).map(cell => cell.textContent)"""
    for width, height, columns in ((1280, 720, 7), (1920, 1080, 10)):
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_function(WITHOUT_SCROLLING, arg=columns)
        page.wait_for_function(f"!({cut})().length")
        page.wait_for_function(f"document.querySelector('.arm-view').getBoundingClientRect().width > {0.4 * width}")
    with serving("view", TABLES / "ur5.csv") as address:
        other = new_tab(address).page
        other.emulate_media(color_scheme="dark")
        other.goto(address)
        other.wait_for_function("document.querySelectorAll('.joint-slider').length === 6")
        assert other.evaluate("({ ...document.documentElement.dataset })") == {"look": "dark", "size": "usual"}
        assert other.get_by_role("button", name="light, dark, projector").is_visible()
        other.close()


def test_edges_are_quick_where_the_browser_draws_in_software(tab: Any) -> None:
    """The scene says so, and a click makes them smooth: it is kept over a reload with what is on the page."""
    tab.page.add_init_script(ASKED)
    page = tab.open("ur5")
    notice = page.get_by_role("button", name="drawn in software")
    assert "a click makes them smooth" in notice.get_attribute("title")
    assert page.evaluate("smoothed") == [False]
    tab.set_sliders([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    for is_smooth in (True, False):
        if is_smooth:
            notice.click()
        else:
            tab.choose("light, dark, projector", "smooth edges")
        is_new = f"smoothed.join() === '{str(is_smooth).lower()}'"  # the page before may still be there
        page.wait_for_function(f"document.querySelector('.arm-view')?.drawn && {is_new}")
        tab.wait_for_table("ur5")
        for joint in range(6):
            tab.wait_for_joint(joint, round(0.1 * (joint + 1), 1))
        assert notice.is_visible() is not is_smooth
        page.get_by_role("button", name="light, dark, projector").click()
        ticked = page.get_by_role("menuitemcheckbox", name="smooth edges", checked=is_smooth)
        ticked.wait_for()
        page.keyboard.press("Escape")
        page.wait_for_function("!document.querySelector('.q-menu')")
    page.close()  # what it notes is for this test only
