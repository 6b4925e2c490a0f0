"""The pictures of docs/studio: the state of the page in each, and how it is taken in a browser."""

from __future__ import annotations

import io
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from pathlib import Path

LAPTOP, TABLET = (1280, 720), (820, 1180)
UR5, PANDA = [-2.5, -1.9, 2.0, -1.7, -1.57, 0.0], [0.3, 0.5, -0.2, -1.9, 0.2, 2.2, 0.8]
Act = tuple[str, Any]
STUDIO: dict[str, tuple[str, list[float], list[Act], tuple[int, int]]] = {
    "empty": ("", [], [], LAPTOP),
    "ur5": ("ur5", UR5, [("cell", 1)], LAPTOP),
    "dark": ("ur5", UR5, [("cell", 1), ("text", "a α d θ")], LAPTOP),
    "wrong_cell": ("ur5", UR5, [("type", "pi/x"), ("wait", "1 problem")], LAPTOP),
    "panda": ("panda", PANDA, [("text", "a α d θ"), ("cell", 3)], LAPTOP),
    "paper": ("ur5_paper", [], [("button", "side by side"), ("wait", "from the table's")], LAPTOP),
    "lesson": ("panda", PANDA, [("button", "explain the picked row"), ("cell", 3), ("button", "3 Rz(θ)")], LAPTOP),
    "normals": (
        "panda",
        [0.3, -0.6, 0.9, -1.4, 0.5, 1.2, 0.4],
        [("text", "joint axes"), ("text", "frames"), ("layer", "common normals")],
        LAPTOP,
    ),
    "target": (
        "ur5",
        UR5,
        [("button", "set the pose of tool0"), ("z of tool0", "0.3"), ("wait", "tool0 is there")],
        LAPTOP,
    ),
    "workspace": (
        "ur5",
        UR5,
        [
            ("button", "measure between frames, and show the workspace"),
            ("text", "workspace"),
            ("wait", "in 4000 random poses"),
        ],
        LAPTOP,
    ),
    "tablet": ("ur5", UR5, [("cell", 1)], TABLET),
}
"""The pictures of the studio: the table, the sliders, what is done then, and the size of the screen."""
VIEWS: dict[str, tuple[int, list[float]]] = {
    "dual_arm": (12, [15, -110, 115, -95, -90, 0, -15, -110, 115, -95, -90, 0]),
    "meshes": (8, [20, -30, 0, -120, 0, 90, 45, 0.03]),  # a finger follows the other
    "housings": (6, [-143, -109, 115, -97, -90, 0]),
}
"""The pictures of `dh2urdf view`: how many sliders there are, and their values."""
ALL = {**{name: size for name, (*_, size) in STUDIO.items()}, **dict.fromkeys(VIEWS, LAPTOP)}


def do(tab: Any, what: str, how: int | str) -> None:  # noqa: ANN401 - the driver of the tests
    """One act of a person."""
    page = tab.page
    match what:
        case "cell":
            tab.cell(how, "a").click()
        case "text":
            page.get_by_text(how, exact=True).click()
        case "button":
            page.get_by_role("button", name=how).click()
        case "wait":
            page.get_by_text(how).first.wait_for()
        case "type":
            tab.type_into(3, "alpha", how)
        case "layer":
            tab.switch_layers(how)
        case _:
            box = page.get_by_label(what, exact=True)
            box.fill(how)
            box.press("Enter")


def set_sliders(tab: Any, values: list[float]) -> None:  # noqa: ANN401 - the same
    """Joint values, and all of the arm in the picture."""
    tab.set_sliders(values)
    tab.page.get_by_role("button", name="see all").click()


def take(tab: Any, name: str, folder: Path) -> None:  # noqa: ANN401 - the same
    """Take the picture, with no tooltip and nothing that fades."""
    tab.page.mouse.move(1, 1)
    tab.page.evaluate("document.querySelector('button:focus')?.blur()")
    # Two frames, so that all is drawn that was asked for; then nothing fades any more.
    tab.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")
    tab.page.wait_for_function("document.getAnimations().length === 0")
    write(tab.page.screenshot(), folder / f"{name}.png")


def write(screenshot: bytes, path: Path) -> None:
    """A picture in 256 colours, in whose choice the few pixels of a frame's arrows count more than their number."""
    from PIL import Image

    picture = Image.open(io.BytesIO(screenshot)).convert("RGB")
    counted: Any = picture.getcolors(picture.width * picture.height)
    colours: Any = [colour for count, colour in counted for _ in range(round(count**0.35))]
    sample = Image.new("RGB", (len(colours), 1))
    sample.putdata(colours)
    palette = sample.quantize(256, kmeans=4)
    picture.quantize(palette=palette, dither=Image.Dither.NONE).save(path, optimize=True)
