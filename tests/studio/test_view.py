"""`dh2urdf view` in a real browser."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from dh2urdf.kinematics import as_matrices
from dh2urdf.studio.viewing import View, load_figures

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.registry import Catalog

CONFIGS = Path(__file__).parents[2] / "configs"


def test_a_cell_and_an_arm_in_one_scene(
    new_tab: Callable[..., Any], serving: Callable[..., Any], catalog: Catalog
) -> None:
    """A dual-arm cell and a table beside it: sliders for all joints, and every tool0 where its kinematics has it."""
    paths = [CONFIGS / "pair.yaml", CONFIGS / "tables" / "panda.yaml"]
    with serving("view", *paths) as address:
        tab = new_tab(address)
        page = tab.page
        page.goto(address)
        page.wait_for_function("document.querySelectorAll('.joint-slider').length === 19")
        page.get_by_role("button", name="random pose").click()
        page.wait_for_timeout(500)
        view = View(load_figures(paths, catalog))
        shown = [slider.value(x) for slider, x in zip(view.sliders, tab.sliders(), strict=True)]
        view.move({slider.name: x for slider, x in zip(view.sliders, shown, strict=True)})
        names = [node.name for node in view.drawing.nodes]
        poses = view.drawing.poses(view.q)
        for name in ("pair/left_tool0", "pair/right_tool0", "panda/tool0"):
            assert np.allclose(tab.pose(name), as_matrices(poses[names.index(name)]), atol=1e-6)
        page.get_by_text("collision", exact=True).click()
        script = """() => {
            let count = 0;
            document.querySelector('.arm-view').scene.traverse(part => count += part.userData.layer === 'collision' && part.visible);
            return count;
        }"""
        page.wait_for_function(f"({script})() > 10")
        page.get_by_role("button", name="at one place").click()
        page.wait_for_function(
            "document.querySelector('.arm-view').scene.getObjectByName('panda/base_link').matrixWorld.elements[13] === 0"
        )
