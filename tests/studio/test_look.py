"""How the pages look: light, dark, for a projector, and on screens of every width; in a real browser."""

from __future__ import annotations

import io
import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

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


GAP = """[...document.querySelectorAll('.studio-panel')].find(panel => panel.offsetParent).getBoundingClientRect().top
    - document.querySelector('.studio-scene').getBoundingClientRect().bottom"""


def choose(page: Any, entry: str) -> None:
    page.get_by_role("button", name="light, dark, projector").click()
    page.locator(".q-menu").get_by_text(entry).click()
    page.wait_for_function("!document.querySelector('.q-menu')")


@pytest.mark.long
def test_light_dark_and_projector(
    studio_address: str, new_tab: Callable[..., Any], serving: Callable[..., Any]
) -> None:
    """The system's scheme, unless one is chosen; page, cells and scene follow, and the browser keeps the choice."""
    tab = new_tab(studio_address)
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
    choose(page, "light")
    page.wait_for_function("document.documentElement.dataset.look === 'light'")
    page.wait_for_function(f"light => JSON.stringify(({LOOK})()) === JSON.stringify(light)", arg=light)

    page.get_by_text("a α d θ", exact=True).click()
    thickness = "() => document.querySelector('.arm-view').scene.getObjectByName('d 1')?.geometry.parameters.radius"
    page.wait_for_function(f"({thickness})() > 0")
    thin, row = page.evaluate(thickness), tab.cell(0, "a").bounding_box()["height"]
    choose(page, "projector")
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


@pytest.mark.long
def test_edges_are_quick_where_the_browser_draws_in_software(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """The scene says so, and a click makes them smooth: it is kept over a reload with what is on the page."""
    tab = new_tab(studio_address)
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
            choose(page, "smooth edges")
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


@pytest.mark.long
def test_every_width_of_screen(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """Nothing is beside the screen from 390 to 2560 px, and a wide one gives the scene its whole height.

    At a laptop's and at a tablet's size table, scene and joints have room; a laptop shows the page without scrolling.
    """
    tab = new_tab(studio_address)
    page = tab.open()
    scene = page.locator(".arm-view")
    covered = """() => [...document.querySelectorAll('.studio-bar button, .view-cube')].filter(button => {
        const [one, other] = [button, document.querySelector('.studio-empty > div')].map(part => part.getBoundingClientRect());
        return one.width && one.left < other.right && other.left < one.right && one.top < other.bottom && other.top < one.bottom;
    }).length"""
    for size in ("large", "usual"):  # of an empty table: what is said first covers no button
        page.evaluate(f"document.documentElement.dataset.size = '{size}'; dispatchEvent(new Event('dh-look'))")
        for width, height in ((390, 844), (820, 1180), (1280, 720)):
            page.set_viewport_size({"width": width, "height": height})
            page.wait_for_function(WHOLE_HEADERS)
            page.wait_for_function(f"({covered})() === 0")
            if width > 390:  # the scene takes the height that is left, not the header
                page.wait_for_function("document.querySelector('.studio-head').getBoundingClientRect().height < 70")
    tab.open_from_gallery("ur5")
    for width, height in ((390, 844), (640, 360), (820, 1180), (1280, 720), (2560, 1440)):
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_function(f"document.documentElement.scrollWidth <= {width}")
        page.wait_for_function(f"document.querySelector('.arm-view canvas').clientWidth <= {width}")
        assert page.get_by_role("button", name="Generate").is_visible()
        assert page.locator(".studio-name").bounding_box()["width"] > 100
        assert page.locator(".joint-slider input[type=range]").first.bounding_box()["width"] > 100
        box = scene.bounding_box()
        for part in (".dh-table", ".arm-view", ".joint-sliders") if width in {820, 1280} else ():
            room = page.locator(part).bounding_box()
            assert min(room["width"] - 250, room["height"] - 150, room["x"]) >= 0, part
            assert room["x"] + room["width"] <= width, part
        if height == 720:
            page.wait_for_function("document.documentElement.scrollHeight <= 720")
            assert page.locator(".studio-scene .studio-bar").first.bounding_box()["height"] < 76, (
                "two rows above the scene"
            )
        if width <= 820:  # a panel is where it is seen: below the scene
            page.get_by_role("button", name="explain the picked row").click()
            page.locator(".studio-panel:visible").wait_for()
            page.wait_for_function(f"(gap => 0 <= gap && gap < 30)({GAP})")
            page.get_by_role("button", name="explain the picked row").click()
            tab.expect(page.locator(".studio-panel:visible")).to_have_count(0)
        assert box["width"] > 300
        assert box["height"] > max((0.9 if width == 2560 else 0.3) * height, 200)  # 640 px: a browser that zooms by 2
    joints = page.locator(".studio-motion").bounding_box()
    assert joints["x"] >= box["x"] + box["width"] - 1


@pytest.mark.long
def test_a_shadow_on_the_ground(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """The ground where the sun does not shine, behind the raised forearm, is darker than without links."""
    from PIL import Image

    tab = new_tab(studio_address)
    page = tab.open("ur5")
    tab.set_sliders([0.0, -math.pi / 4, 0.0, 0.0, 0.0, 0.0])
    height = 0.089159 + 0.6 * 0.81725 * math.sin(math.pi / 4)  # of a point of the forearm
    x, z = -0.6 * 0.81725 * math.cos(math.pi / 4), height / 0.85
    place = [x - 0.32 * z, 0.42 * z, 0.0]  # the sun is at (0.32, -0.42, 0.85)
    script = """place => {
        const view = document.querySelector('.arm-view'), box = view.getBoundingClientRect();
        view.camera.updateMatrixWorld();
        const at = view.camera.position.clone().set(...place).project(view.camera);
        return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height];
    }"""
    left, top = page.evaluate(script, place)

    def ground() -> float:
        page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
        clip = {"x": left - 6, "y": top - 6, "width": 12, "height": 12}
        return float(np.mean(Image.open(io.BytesIO(page.screenshot(clip=clip))).convert("L")))

    shaded = ground()
    page.get_by_text("links", exact=True).click()
    page.wait_for_function(
        "(() => { const shown = []; document.querySelector('.arm-view').scene.traverse(part => "
        "part.userData.layer === 'links' && part.isMesh && part.visible && shown.push(part)); return !shown.length; })()"
    )
    assert ground() > shaded + 20


@pytest.mark.long
@pytest.mark.parametrize("width", [1001, 1024, 1199, 1280])
def test_joints_keep_their_names(studio_address: str, new_tab: Callable[..., Any], width: int) -> None:
    """In a narrow window too, the names of the joints and the units of their values are there in full."""
    page = new_tab(studio_address, width=width, height=768).open("ur5")
    page.wait_for_function("""() => {
        const parts = [...document.querySelectorAll('.joint-slider-name, .joint-slider-unit')];
        return parts.length === 12 && parts.every(({clientWidth, scrollWidth}) => clientWidth > 0 && scrollWidth <= clientWidth);
    }""")
