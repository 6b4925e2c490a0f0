"""The pictures of docs/studio: taken in the browser with `pytest --renew`, and shown on the pages."""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "docs" / "studio"
LARGEST = 150_000
"""Size of a picture [B]: they are cloned with the project."""
LAPTOP, TABLET = (1280, 720), (820, 1180)


UR5_POSE = [-2.5, -1.9, 2.0, -1.7, -1.57, 0.0]


def empty(_: Any) -> None:
    """An empty table, as the studio begins."""


def ur5(tab: Any) -> None:
    tab.open_from_gallery("ur5")
    set_sliders(tab, UR5_POSE)
    tab.cell(1, "a").click()


def dark(tab: Any) -> None:
    tab.page.emulate_media(color_scheme="dark")
    ur5(tab)
    tab.page.get_by_text("a α d θ", exact=True).click()


def wrong_cell(tab: Any) -> None:
    tab.open_from_gallery("ur5")
    set_sliders(tab, UR5_POSE)
    tab.type_into(3, "alpha", "pi/x")
    tab.wait_for_status("1 problem")


def panda(tab: Any) -> None:
    tab.open_from_gallery("panda")
    set_sliders(tab, [0.3, 0.5, -0.2, -1.9, 0.2, 2.2, 0.8])
    tab.page.get_by_text("a α d θ", exact=True).click()
    tab.cell(3, "a").click()


def paper(tab: Any) -> None:
    tab.open_from_gallery("ur5_paper")
    tab.page.get_by_role("button", name="side by side").click()
    tab.page.get_by_text("from the table's").wait_for()


def lesson(tab: Any) -> None:
    tab.open_from_gallery("panda")
    set_sliders(tab, [0.3, 0.5, -0.2, -1.9, 0.2, 2.2, 0.8])
    tab.page.get_by_role("button", name="explain the picked row").click()
    tab.cell(3, "a").click()
    tab.page.get_by_role("button", name="3 Rz(θ)").click()
    tab.wait_for_lesson(3.0)


def normals(tab: Any) -> None:
    tab.open_from_gallery("panda")
    set_sliders(tab, [0.3, -0.6, 0.9, -1.4, 0.5, 1.2, 0.4])
    for layer in ("joint axes", "frames"):
        tab.page.get_by_text(layer, exact=True).click()
    tab.switch_layers("common normals")


def target(tab: Any) -> None:
    tab.open_from_gallery("ur5")
    set_sliders(tab, UR5_POSE)
    tab.page.get_by_role("button", name="set the pose of tool0").click()
    box = tab.page.get_by_label("z of tool0", exact=True)
    box.fill("0.3")
    box.press("Enter")
    tab.page.get_by_text("tool0 is there").wait_for()
    box.blur()


def workspace(tab: Any) -> None:
    tab.open_from_gallery("ur5")
    set_sliders(tab, UR5_POSE)
    tab.page.get_by_role("button", name="measure between frames, and show the workspace").click()
    tab.page.get_by_text("workspace", exact=True).click()
    tab.page.get_by_text("in 4000 random poses").wait_for()


def set_sliders(tab: Any, values: list[float]) -> None:
    tab.set_sliders(values)
    tab.page.get_by_role("button", name="see all").click()


STUDIO: dict[str, tuple[Callable[[Any], None], tuple[int, int]]] = {
    "empty": (empty, LAPTOP),
    "ur5": (ur5, LAPTOP),
    "dark": (dark, LAPTOP),
    "wrong_cell": (wrong_cell, LAPTOP),
    "panda": (panda, LAPTOP),
    "paper": (paper, LAPTOP),
    "lesson": (lesson, LAPTOP),
    "normals": (normals, LAPTOP),
    "target": (target, LAPTOP),
    "workspace": (workspace, LAPTOP),
    "tablet": (ur5, TABLET),
}
ALL = {**{name: size for name, (_, size) in STUDIO.items()}, "dual_arm": LAPTOP, "housings": LAPTOP, "meshes": LAPTOP}


@pytest.mark.parametrize("name", STUDIO)
def test_pictures_of_the_studio(name: str, renew: bool, request: pytest.FixtureRequest) -> None:  # noqa: FBT001 - a fixture
    """With `--renew` the studio is brought into the state of each picture, and the picture is taken."""
    if not renew:
        return
    act, (width, height) = STUDIO[name]
    new_tab = request.getfixturevalue("new_tab")
    tab = new_tab(request.getfixturevalue("studio_address"), width=width, height=height)
    tab.open()
    act(tab)
    take(tab, name)


def test_picture_of_a_cell(renew: bool, request: pytest.FixtureRequest) -> None:  # noqa: FBT001 - a fixture
    """With `--renew` a dual-arm cell is shown, and the picture is taken."""
    if not renew:
        return
    with request.getfixturevalue("serving")("view", ROOT / "configs" / "pair.yaml") as address:
        tab = request.getfixturevalue("new_tab")(address)
        tab.page.goto(address)
        tab.page.wait_for_function("document.querySelectorAll('.joint-slider').length === 12")
        set_sliders(tab, [15, -110, 115, -95, -90, 0, -15, -110, 115, -95, -90, 0])
        take(tab, "dual_arm")
        tab.page.close()  # before its server ends, of which it would complain


def test_picture_of_meshes(renew: bool, request: pytest.FixtureRequest) -> None:  # noqa: FBT001 - a fixture
    """With `--renew` a maker's description is shown, and the picture is taken."""
    if not renew:
        return
    robots = request.getfixturevalue("example_robots")
    with request.getfixturevalue("serving")("view", robots / "panda_description" / "urdf" / "panda.urdf") as address:
        tab = request.getfixturevalue("new_tab")(address)
        tab.page.goto(address)
        tab.page.wait_for_function(
            "document.querySelectorAll('.joint-slider').length === 8"
        )  # a finger follows the other
        tab.wait_for_triangles(100_000)
        set_sliders(tab, [20, -30, 0, -120, 0, 90, 45, 0.03])
        take(tab, "meshes")
        tab.page.close()


def take(tab: Any, name: str) -> None:
    tab.page.mouse.move(1, 1)
    tab.page.evaluate("document.querySelector('button:focus')?.blur()")
    # Two frames, so that all is drawn that was asked for; then nothing fades any more.
    tab.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    tab.page.wait_for_function("document.getAnimations().length === 0")
    write(tab.page.screenshot(), PICTURES / f"{name}.png")


def write(screenshot: bytes, path: Path) -> None:
    """A picture in 256 colours, in whose choice the few pixels of a frame's arrows count more than their number."""
    from PIL import Image

    picture = Image.open(io.BytesIO(screenshot)).convert("RGB")
    counted = picture.getcolors(picture.width * picture.height)
    colours = [colour for count, colour in counted for _ in range(round(count**0.35))]
    sample = Image.new("RGB", (len(colours), 1))
    sample.putdata(colours)
    palette = sample.quantize(256, kmeans=4)
    picture.quantize(palette=palette, dither=Image.Dither.NONE).save(path, optimize=True)


def test_picture_of_housings(renew: bool, request: pytest.FixtureRequest, tmp_path: Path) -> None:  # noqa: FBT001 - a fixture
    """With `--renew` a UR5 of the shape `arm` is shown, and the picture of its scene is taken."""
    if not renew:
        return
    words = (ROOT / "configs" / "tables" / "ur5.csv").read_text("utf-8")
    (tmp_path / "ur5.csv").write_text(f"# defaults: {{geometry: {{shape: arm}}}}\n{words}", "utf-8")
    with request.getfixturevalue("serving")("view", tmp_path / "ur5.csv") as address:
        tab = request.getfixturevalue("new_tab")(address)
        tab.page.goto(address)
        tab.page.wait_for_function("document.querySelectorAll('.joint-slider').length === 6")
        for layer in ("joint axes", "frames"):
            box = tab.page.locator(".studio-bar").get_by_role("checkbox", name=layer, exact=True)
            if box.get_attribute("aria-checked") == "true":
                box.click()
        set_sliders(tab, [-143, -109, 115, -97, -90, 0])
        take(tab, "housings")
        tab.page.close()


@pytest.mark.parametrize("name", ALL)
def test_every_picture_is_shown(name: str) -> None:
    """Each is there, small, in the size of its screen, and on the page about the studio or about shapes."""
    content = (PICTURES / f"{name}.png").read_bytes()
    assert len(content) < LARGEST
    assert struct.unpack(">II", content[16:24]) == ALL[name]
    page = "tables/other-files.md" if name == "housings" else "studio.md"
    assert f"studio/{name}.png)" in (ROOT / "docs" / page).read_text("utf-8")
