"""Links dragged by the mouse, what is seen through, the axes of the world, and the camera that goes after an arm."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

pytestmark = pytest.mark.long
ROBOT = """<robot name="r">
<link name="base"><visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
<link name="arm"><visual><origin xyz="0.3 0 0"/><geometry><box size="0.4 0.1 0.1"/></geometry></visual></link>
<link name="slide"><visual><geometry><box size="0.2 0.2 0.2"/></geometry></visual></link>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.2"/>
  <axis xyz="0 0 1"/><limit lower="-0.7" upper="0.7" effort="1" velocity="1"/></joint>
<joint name="push" type="prismatic"><parent link="arm"/><child link="slide"/><origin xyz="0.6 0 0"/><axis xyz="1 0 0"/>
  <limit lower="0" upper="6" effort="1" velocity="1"/></joint></robot>"""
ANSWERED = """() => {
    const view = getElement(Number(document.querySelector('.arm-view').id.slice(1)));
    return !view.asked && !view.wanted;
}"""
"""Nothing that a person has dragged is on its way to the server, or back; the sliders come before the answer."""
CAMERA = "document.querySelector('.arm-view').camera.matrixWorld.elements.map(x => Number(x.toFixed(6)))"


class Hand:
    """A hand on the mouse, above the scene."""

    def __init__(self, tab: Any) -> None:
        self.tab, self.page = tab, tab.page

    def drag(self, start: Any, by: Any) -> list[float]:
        """Drags from a place, and gives the joint values that are there then."""
        self.page.mouse.move(*start)
        self.page.mouse.down()
        for step in range(1, 9):
            self.page.mouse.move(*(start + np.array(by) * step / 8))
        self.page.mouse.up()
        self.page.wait_for_function(ANSWERED)
        return list(self.tab.sliders())

    def look(self, key: str) -> None:
        drawn = self.page.evaluate("document.querySelector('.arm-view').drawn")
        self.page.get_by_role("application").focus()
        self.page.keyboard.press(key)
        self.page.wait_for_function("drawn => document.querySelector('.arm-view').drawn > drawn", arg=drawn)


def drag_with_parallel_rays(tab: Any, hand: Hand) -> None:
    """The point that is held stays below the pointer in the orthographic camera, too."""
    hand.look("5")
    tab.set_sliders([0, 0])
    start, end = tab.pixel("slide", 0.1, 0, 0), tab.pixel("slide", 0.4, 0, 0)
    assert hand.drag(start, end - start)[1] == pytest.approx(0.3, abs=0.008)
    hand.look("7")
    start, by = tab.pixel("arm", 0.45, 0, 0.05), (30, -4)
    assert hand.drag(start, by)[0] > 2
    axis = tab.pixel("arm", 0, 0, 0.05)
    here, there = (np.arctan2(*(point - axis)) for point in (start + by, tab.pixel("arm", 0.45, 0, 0.05)))
    assert here == pytest.approx(there, abs=0.01)
    hand.look("5")


def test_a_link_follows_the_pointer(open_view: Callable[..., Any], tmp_path: Path) -> None:
    """It turns and slides below the pointer, inside its limits; elsewhere and without the hand the camera turns."""
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT)
    with open_view(path, sliders=2) as tab:
        page, hand = tab.page, Hand(tab)

        # The axes of the world are seen as the camera sees them: from above, x goes down and y to the right.
        hand.look("7")
        script = """all => all.map(axis => ['x2', 'y2'].map(end => Number(axis.children[0].getAttribute(end))))"""
        axes = page.locator(".arm-view-cross g")
        names = axes.evaluate_all("all => all.map(axis => axis.dataset.axis)")
        tips = dict(zip(names, axes.evaluate_all(script), strict=True))
        assert np.abs(np.subtract([tips["x"], tips["y"], tips["z"]], [(0, 22), (22, 0), (0, 0)])).max() < 0.1

        # Without the hand the camera turns.
        before = page.evaluate(CAMERA)
        assert hand.drag(tab.pixel("arm", 0.3, 0, 0.05), (20, 10)) == [0, 0]
        assert page.evaluate(CAMERA) != before
        hand.look("7")

        # With Shift the arm turns about its axis, and the point that is held stays below the pointer.
        held, by = tab.pixel("arm", 0.45, 0, 0.05), np.array([60.0, -4.0])
        before = page.evaluate(CAMERA)
        page.keyboard.down("Shift")
        turned, pushed = hand.drag(held, by)
        page.keyboard.up("Shift")
        assert (turned > 5, pushed) == (True, 0)
        axis = tab.pixel("arm", 0, 0, 0.05)
        here, there = (np.arctan2(*(point - axis)) for point in (held + by, tab.pixel("arm", 0.45, 0, 0.05)))
        assert here == pytest.approx(there, abs=0.01)
        assert page.evaluate(CAMERA) == before

        # With the hand it needs no Shift; the joint stops at its limit, 0.7 rad.
        page.get_by_role("button", name="drag links").click()
        page.locator("button[aria-pressed=true]").wait_for()
        tab.settle()
        start = tab.pixel("arm", 0.45, 0, 0.05)
        page.mouse.move(*(start + 1))
        page.wait_for_function("document.querySelector('.arm-view canvas').style.cursor === 'grab'")
        assert hand.drag(start, (200, -150))[0] == pytest.approx(np.degrees(0.7), abs=0.01)
        tab.set_sliders([0, 0])

        # From the front the slide moves towards the camera: nobody can drag it from there.
        hand.look("1")
        assert hand.drag(tab.pixel("slide", 0.1, 0, 0), (30, 0)) == [0, 0]
        hand.look("9")
        start, end = tab.pixel("slide", 0.1, 0, 0), tab.pixel("slide", 0.4, 0, 0)
        assert hand.drag(start, end - start)[1] == pytest.approx(0.3, abs=0.008)

        drag_with_parallel_rays(tab, hand)

        # From the side the axis is upright in the picture: the arm turns back as its middle goes to the right.
        tab.set_sliders([30, 0])
        hand.look("3")
        assert 10 < hand.drag(tab.pixel("arm", 0.3, -0.05, 0.0), (25, 0))[0] < 29


def test_bodies_are_looked_through(open_view: Callable[..., Any], tmp_path: Path) -> None:
    """Those of one robot of two, in the scene and in the file that is made of it."""
    for name in "ab":
        (tmp_path / f"{name}.urdf").write_text(ROBOT.replace('name="r"', f'name="{name}"'))
    with open_view(tmp_path / "a.urdf", tmp_path / "b.urdf", sliders=4) as tab:
        page = tab.page
        page.get_by_role("button", name="opacity").click()
        page.get_by_label("opacity of b").press("Home")
        script = """() => {
            const found = new Set();
            for (const node of document.querySelector('.arm-view').scene.children[0].children)
                node.traverse(({ isMesh, userData, material }) => isMesh && userData.layer === 'links' &&
                    found.add([node.name[0], material.opacity, material.transparent, material.depthWrite].join()));
            return [...found].sort().join(' ');
        }"""
        page.wait_for_function(f"({script})() === 'a,1,false,true b,0.1,true,false'")
        assert tab.serious() == []
        page.keyboard.press("Escape")
        _, content = tab.save("Scene as glTF (GLB)")
        scene = trimesh.load_scene(io.BytesIO(content), file_type="glb", process=False)
        opacities = [int(mesh.visual.material.baseColorFactor[3]) for mesh in scene.geometry.values()]
        assert set(opacities) == {26, 255}
