"""The standard views, by the menu, by keys and by the cube; perspective and orthographic."""

import base64
import io
from typing import Any

import numpy as np
import pytest
from PIL import Image

pytestmark = pytest.mark.long
SIDES = {
    "front": (1, 0, 0),
    "left": (0, 1, 0),
    "back": (-1, 0, 0),
    "right": (0, -1, 0),
    "top": (0, 0, 1),
    "bottom": (0, 0, -1),
}
LOOKS_FROM = """([x, y, z]) => {
    const { elements } = document.querySelector('.arm-view').camera.matrixWorld;
    const size = Math.hypot(x, y, z);
    return Math.abs(elements[8] * x + elements[9] * y + elements[10] * z - size) < 1e-5 * size;
}"""
UPRIGHT = """name => {
    const sides = [...document.querySelectorAll('.view-cube-side')].filter(side => side.style.visibility === 'visible');
    const [a, b, c, d, x, y] = sides[0].style.transform.slice(7, -1).split(',').map(Number);
    return sides.length === 1 && sides[0].textContent === name && [a - 1, b, c, d - 1, x, y].every(part => Math.abs(part) < 0.02);
}"""


def test_the_cube(tab: Any) -> None:
    """It turns with the camera; a click on a side looks from there, with the side upright in the middle of the cube."""
    page = tab.open("ur5")
    seen = """() => [...document.querySelectorAll('.view-cube-side')].filter(side => side.style.visibility === 'visible')
        .map(side => side.textContent).sort().join()"""
    page.wait_for_function(f"({seen})() === 'front,right,top'")
    for name, direction in SIDES.items():
        page.locator(".arm-view").focus()
        page.keyboard.press("9")
        key, times = {"left": ("ArrowLeft", 36), "back": ("ArrowLeft", 18), "bottom": ("ArrowDown", 20)}.get(
            name, ("", 0)
        )
        for _ in range(times):
            page.keyboard.press(key)
        page.get_by_role("button", name=f"look from the {name}").click()
        page.wait_for_function(LOOKS_FROM, arg=list(direction))
        page.wait_for_function(UPRIGHT, arg=name)
    page.locator(".arm-view").focus()
    page.keyboard.press("1")
    page.wait_for_function(UPRIGHT, arg="front")
    page.locator(".view-cube-corner:visible").first.click()
    page.wait_for_function(f"({seen})().split(',').length === 3")


ARM = "document.querySelector('.arm-view')"
SEEN = f"""() => {{
    const {{ camera, scene }} = {ARM}, points = [];
    scene.updateMatrixWorld();
    for (const node of scene.children[0].children)
        points.push(node.position.clone().setFromMatrixPosition(node.matrixWorld).project(camera).toArray());
    const [near, far] = [[0, 0, 0], [0.5, 0, 0]].map((at) => camera.position.clone().set(...at).project(camera).toArray());
    return [camera.isOrthographicCamera ?? false, points, near, far];
}}"""
SIZES = ("width", "height")
COVERED = """() => {
    const own = document.querySelector('.arm-view-projection').getBoundingClientRect();
    return [...document.querySelectorAll('.arm-view-label')].filter((label) => {
        const box = label.getBoundingClientRect(), shown = getComputedStyle(label).visibility === 'visible';
        return shown && box.right > own.left && box.left < own.right && box.top < own.bottom && box.bottom > own.top;
    }).map((label) => label.textContent);
}"""
TURNED = f"share => getElement(Number({ARM}.id.slice(1))).turn(share, 640)"


def silhouettes(page: Any) -> list[Any]:
    """Where the arm is in pictures from the front and, half a turn of the camera later, from behind: light is paper."""
    found = []
    for share in (0, 0.5):
        picture = base64.b64decode(page.evaluate(TURNED, share).partition(",")[2])
        found.append(np.asarray(Image.open(io.BytesIO(picture)).convert("L")) < 200)
    page.evaluate(TURNED, None)
    return found


class Eye:
    """What the camera of a page sees."""

    def __init__(self, tab: Any) -> None:
        self.page, self.scene = tab.page, tab.page.get_by_role("application")
        self.switch = tab.page.get_by_role("button", name="orthographic")

    def press(self, *keys: str) -> None:
        """Presses keys of the scene, and waits until it is drawn."""
        self.scene.focus()
        for key in keys:
            self.page.keyboard.press(key)
        self.wait_for_picture()

    def wait_for_picture(self) -> None:
        """Waits until what the scene has got is drawn: camera and labels have their places in the picture then."""
        self.page.evaluate("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def nodes(self) -> Any:
        """Where the nodes are in the picture."""
        return np.array(self.page.evaluate(SEEN)[1])[:, :2]

    def sees_all(self, *, parallel: bool, ends_on: bool = False) -> None:
        """Waits for a way to draw: all of the arm is in the picture, and the x axis is a point or is not."""
        self.page.wait_for_function(f"parallel => ({SEEN})()[0] === parallel", arg=parallel)
        self.page.locator(f".arm-view-projection[aria-pressed={str(parallel).lower()}]").wait_for()
        self.wait_for_picture()
        _, nodes, near, far = self.page.evaluate(SEEN)
        assert 0.2 < np.abs(np.array(nodes)[:, :2]).max() < 1.0
        assert np.abs(np.array(nodes)[:, 2]).max() < 1.0, "nothing is cut off"
        assert np.allclose(near[:2], far[:2], atol=1e-9) == ends_on
        assert self.page.evaluate(COVERED) == []


def test_orthographic(tab: Any) -> None:
    """With parallel rays what is farther is no smaller; views, picks, labels and pictures are right in both ways."""
    page, eye = tab.open("ur5"), Eye(tab)
    eye.press("1")
    page.wait_for_function(LOOKS_FROM, arg=[1, 0, 0])
    eye.sees_all(parallel=False)
    page.get_by_text("joint axes", exact=True).click()
    page.get_by_text("frames", exact=True).click()
    tab.settle()
    one, other = silhouettes(page)
    assert (one != other[:, ::-1]).mean() > 0.005
    eye.press("5")  # as the number pad of modellers has it
    eye.sees_all(parallel=True, ends_on=True)
    one, other = silhouettes(page)
    assert one.mean() > 0.02
    assert (one != other[:, ::-1]).mean() < 0.002

    # It stays over the standard views, by key and by cube, and sees all after a person was near.
    page.get_by_text("joint axes", exact=True).click()
    page.get_by_text("frames", exact=True).click()
    tab.settle()
    for key, side in (("7", (0, 0, 1)), ("9", (0.62, -0.62, 0.5)), ("3", (0, -1, 0))):
        eye.press(*"+++++++++", key)
        page.wait_for_function(LOOKS_FROM, arg=list(side))
        eye.sees_all(parallel=True)
    eye.press("9")
    page.get_by_role("button", name="look from the front").click()
    page.wait_for_function(LOOKS_FROM, arg=[1, 0, 0])
    eye.sees_all(parallel=True, ends_on=True)
    whole = eye.nodes()
    eye.press("+")
    assert np.allclose(eye.nodes(), whole / 0.85, atol=1e-6)
    page.get_by_role("button", name="see all of the arm").click()
    page.wait_for_function(LOOKS_FROM, arg=[0.62, -0.62, 0.5])
    eye.sees_all(parallel=True)

    # A label is at its point, and a double click picks the link that is there.
    box, at = page.locator(".arm-view-label", has_text="tool0").first.bounding_box(), tab.pixel("tool0")
    beside = [max(box[side] - x, x - box[side] - box[size], 0) for side, size, x in zip("xy", SIZES, at, strict=True)]
    assert np.hypot(*beside) < 60
    page.mouse.dblclick(*(tab.pixel("frame 2") + tab.pixel("frame 3")) / 2)
    page.locator(".dh-table .ag-row[row-index='2'].dh-picked").first.wait_for()

    # The button is the way back; near the arm the switch keeps what a person looks at.
    eye.press(*"++++++")
    near = eye.nodes()
    eye.switch.click()
    page.wait_for_function(f"!{ARM}.camera.isOrthographicCamera")
    now, middle = eye.nodes(), np.abs(near).max(axis=1).argmin()
    assert min(np.abs(near).max(), np.abs(now).max()) > 1.5
    assert np.abs(now[middle] - near[middle]).max() < 0.1
    eye.press("0")
    eye.sees_all(parallel=False)
    assert tab.serious(ARM) == []
