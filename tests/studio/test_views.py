"""The standard views: by the menu, by keys and by the cube."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

FROM = {"front (1)": (1, 0, 0), "right (3)": (0, -1, 0), "top (7)": (0, 0, 1), "corner (9)": (0.62, -0.62, 0.5)}
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
DIRECTION = """() => {
    const { camera, scene } = document.querySelector('.arm-view');
    const { elements } = camera.matrixWorld;
    const box = (point) => point.project(camera).toArray();
    const nodes = scene.children[0].children.map(node => box(node.position.clone().setFromMatrixPosition(node.matrixWorld)));
    return [elements.slice(8, 11), nodes];
}"""


@pytest.mark.parametrize("by_key", [False, True])
def test_each_looks_from_its_side(studio_address: str, new_tab: Callable[..., Any], by_key: bool) -> None:  # noqa: FBT001 - a parameter
    """And sees all of the arm, whatever the camera saw before."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    scene = page.get_by_role("application")
    for name, wanted in FROM.items():
        scene.focus()
        for _ in range(9):
            page.keyboard.press("ArrowLeft")
            page.keyboard.press("+")
        drawn = page.evaluate("document.querySelector('.arm-view').drawn")
        if by_key:
            page.keyboard.press(name[-2])
        else:
            page.get_by_role("button", name="look from a side").click()
            page.locator(".q-menu").get_by_text(name, exact=True).click()
            page.locator(".q-menu").wait_for(state="hidden")
        page.wait_for_function("drawn => document.querySelector('.arm-view').drawn > drawn", arg=drawn)
        page.wait_for_function(LOOKS_FROM, arg=list(wanted))
        _, nodes = page.evaluate(DIRECTION)
        assert np.abs(np.array(nodes)[:, :2]).max() <= 1.0


def test_the_cube(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """It turns with the camera; a click on a side looks from there, with the side upright in the middle of the cube."""
    tab = new_tab(studio_address)
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
        page.wait_for_function(f"({seen})() === '{name}'")
        upright = page.locator(".view-cube-side", has_text=name).evaluate("side => side.style.transform")
        numbers = [float(part) for part in upright.removeprefix("matrix(").rstrip(")").split(",")]
        assert np.allclose(numbers, [1, 0, 0, 1, 0, 0], atol=0.02)
    page.locator(".arm-view").focus()
    page.keyboard.press("9")
    page.wait_for_function(f"({seen})() === 'front,right,top'")
    page.locator(".view-cube-corner:visible").first.click()
    page.wait_for_function(f"({seen})().split(',').length === 3")
