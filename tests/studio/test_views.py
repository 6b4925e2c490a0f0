"""The standard views, by the menu and by keys."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

if TYPE_CHECKING:
    from collections.abc import Callable

FROM = {"front (1)": (1, 0, 0), "side (3)": (0, -1, 0), "top (7)": (0, 0, 1), "corner (9)": (0.62, -0.62, 0.5)}
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
    page = tab.open()
    tab.open_exhibit("ur5")
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
        page.wait_for_function(
            """([x, y, z]) => {
                const { elements } = document.querySelector('.arm-view').camera.matrixWorld;
                const size = Math.hypot(x, y, z);
                return Math.abs(elements[8] * x + elements[9] * y + elements[10] * z - size) < 1e-5 * size;
            }""",
            arg=list(wanted),
        )
        _, nodes = page.evaluate(DIRECTION)
        assert np.abs(np.array(nodes)[:, :2]).max() <= 1.0
