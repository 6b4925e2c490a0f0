"""`dh2urdf view` in a real browser."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from dh2urdf.studio.viewing import View, load_figures

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.plugin_system.catalog import Catalog

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
        tab.press("random pose")
        view = View(load_figures(paths, catalog))
        shown = [slider.value(x) for slider, x in zip(view.sliders, tab.sliders(), strict=True)]
        view.move({slider.name: x for slider, x in zip(view.sliders, shown, strict=True)})
        names = [node.name for node in view.drawing.nodes]
        poses = view.drawing.poses(view.q)
        for name in ("pair/left_tool0", "pair/right_tool0", "panda/tool0"):
            tab.wait_for_pose(name, poses[names.index(name)])
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
        page.close()  # before its server ends, of which it would complain
