"""The tree of robots, links and what they consist of, driven by keyboard and mouse; sliders folded by robot."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

UR5 = Path(__file__).parents[2] / "configs" / "tables" / "ur5.csv"
GRIPPER = """<robot name="gripper">
  <link name="palm"><inertial><mass value="2"/><inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual></link>
  <link name="left"><visual><geometry><box size="0.05 0.02 0.2"/></geometry></visual></link>
  <link name="right"><visual><geometry><box size="0.05 0.02 0.2"/></geometry></visual></link>
  <joint name="l" type="prismatic"><parent link="palm"/><child link="left"/><origin xyz="0 0.02 0.15"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.08" effort="1" velocity="1"/></joint>
  <joint name="r" type="prismatic"><parent link="palm"/><child link="right"/><origin xyz="0 -0.02 0.15"/><axis xyz="0 1 0"/>
    <limit lower="-0.08" upper="0" effort="1" velocity="1"/><mimic joint="l" multiplier="-1"/></joint>
</robot>
"""
OUTLINED = """name => {
    let on = false;
    document.querySelector('.arm-view').scene.getObjectByName(name).traverse(part => on ||= part.userData.outline === true);
    return on;
}"""
HIDDEN = "name => document.querySelector('.arm-view')?.scene?.getObjectByName(name)?.visible === false"
LINES = """() => {
    const view = document.querySelector('.arm-view'), found = [];
    view.scene.updateMatrixWorld();
    const nodes = view.scene.children[0].children;
    const at = (line, z) => {
        const end = line.position.clone().set(0, 0, z).applyMatrix4(line.matrixWorld);
        return nodes.filter((node) => end.distanceTo(end.clone().setFromMatrixPosition(node.matrixWorld)) < 1e-6).map(({ name }) => name);
    };
    view.scene.traverse((line) => {
        if (!line.name.startsWith('line to ') || !line.visible || !line.parent.visible) return;
        const to = line.name.slice('line to '.length), ends = [at(line, 0.5), at(line, -0.5)];
        found.push([to, ends[0].includes(to) ? line.userData.carrier.name : 'elsewhere']);
        if (!ends[1].includes(line.userData.carrier.name)) found.push([to, 'from elsewhere']);
    });
    return found;
}"""
LAYER = """layer => {
    const found = [];
    document.querySelector('.arm-view').scene.traverse(part => part.userData.layer === layer && part.visible && found.push(part.parent.name));
    return found;
}"""


def lines_between_frames(tab: Any) -> None:
    """A line from each frame to the one that carries it, in any pose, but none to a hidden one or of no length."""
    page = tab.page
    tab.switch_layers("lines between frames")
    page.wait_for_function(f"({LINES})().length > 0")
    tab.press("random pose")
    tab.settle()  # there were lines before as well
    lines = [[f"ur5/frame {number}", f"ur5/frame {number - 1}"] for number in range(1, 7)]
    assert sorted(page.evaluate(LINES)) == [["gripper/left", "gripper/palm"], *lines]
    tab.switch_layers("lines between frames")
    page.wait_for_function(f"({LINES})().length === 0")


def outlined_and_followed(tab: Any) -> None:
    """The outline of the picked link can be switched off; the camera follows the link on request."""
    page = tab.page
    for is_on in (False, True):
        tab.switch_layers("outline of the picked link")
        page.wait_for_function(f"name => ({OUTLINED})(name) === {str(is_on).lower()}", arg="gripper/left")

    def moved(position: float) -> float:
        """How far the link is in the picture from where it was, once its joint is elsewhere [px]."""
        before = tab.pixel("gripper/left")
        page.get_by_label("gripper/l in m").fill(str(position))
        page.get_by_label("gripper/l in m").press("Enter")
        script = """y => {
            const view = document.querySelector('.arm-view');
            return Math.abs(view.scene.getObjectByName('gripper/left').matrix.elements[13] - y) < 1e-9 && !view.goes;
        }"""
        page.wait_for_function(script, arg=0.02 + position)
        return float(max(abs(before - tab.pixel("gripper/left"))))

    assert moved(0.01) > 1
    for check in (lambda way: way < 1e-3, lambda way: way > 1):
        page.get_by_role("button", name="look from a side").click()
        page.get_by_role("menuitemcheckbox", name="follow what is picked").click()
        page.wait_for_function("!document.querySelector('.q-menu')")
        assert check(moved(0.07))
        assert check(moved(0.01))


@pytest.mark.long
def test_links_are_picked_hidden_and_unfolded(open_view: Callable[..., Any], tmp_path: Path) -> None:
    """By keys alone, and back from the scene; a joint that follows another moves with it and has no slider."""
    (tmp_path / "gripper.urdf").write_text(GRIPPER)
    with open_view(tmp_path / "gripper.urdf", UR5, sliders=7) as tab:
        page = tab.page
        page.get_by_role("button", name="at one place").click()

        # A follower.
        page.get_by_label("gripper/l in m").fill("0.05")
        page.get_by_label("gripper/l in m").press("Enter")
        script = """y => {
            const {scene} = document.querySelector('.arm-view');
            return ['left', 'right'].every((name, i) =>
                Math.abs(scene.getObjectByName('gripper/' + name).matrix.elements[13] - (i ? -y : y)) < 1e-9);
        }"""
        page.wait_for_function(script, arg=0.07)

        # The sliders of a robot fold.
        tab.expect(page.locator(".joint-slider:visible")).to_have_count(7)
        page.get_by_role("button", name="ur5").click()
        tab.expect(page.locator(".joint-slider:visible")).to_have_count(1)

        # The tree, by keys: one tab stop.
        tree = page.get_by_role("tree", name="Robots")
        tab.expect(tree.locator("[tabindex='0']")).to_have_count(1)
        items = tree.get_by_role("treeitem")
        tab.expect(items).to_have_text(["gripper (3)", "ur5 (10)"])
        tree.locator("[tabindex='0']").focus()
        for key in ("ArrowRight", "ArrowRight", "ArrowDown", "ArrowDown", "ArrowRight", "ArrowRight"):
            page.keyboard.press(key)
        focused = page.locator("*:focus")
        follows = "joint r: prismatic along (0, 1, 0), -0.08 m to 0 m, follows -1 · l"
        tab.expect(focused).to_have_text(follows)
        page.keyboard.press("ArrowLeft")
        tab.expect(focused).to_have_text("right")
        page.keyboard.press("Enter")
        page.wait_for_function(OUTLINED, arg="gripper/right")
        assert not page.evaluate(OUTLINED, "gripper/left")
        tab.expect(focused).to_have_attribute("aria-selected", "true")
        page.keyboard.press("Space")
        page.wait_for_function(HIDDEN, arg="gripper/right")
        tab.expect(focused).to_have_attribute("aria-checked", "false")
        tab.expect(items.nth(0)).to_have_attribute("aria-checked", "mixed")

        # From the scene into the tree: nothing that is hidden can be picked.
        page.mouse.dblclick(*tab.pixel("gripper/left"))
        page.wait_for_function(OUTLINED, arg="gripper/left")
        page.locator(".robot-tree [aria-selected=true]", has_text="left").wait_for()

        # Centres of mass, and inertias, on request.
        assert page.evaluate(LAYER, "masses") == page.evaluate(LAYER, "inertias") == []
        tab.switch_layers("centres of mass", "inertias")
        for layer in ("masses", "inertias"):
            script = f"layer => ({LAYER})(layer).filter(name => name.startsWith('gripper')).join() === 'gripper/palm'"
            page.wait_for_function(script, arg=layer)

        outlined_and_followed(tab)
        lines_between_frames(tab)

        # What is hidden stays hidden in another drawing and after a reload.
        with tab.another_drawing():
            page.get_by_role("button", name="side by side").click()
        page.wait_for_function(HIDDEN, arg="gripper/right")
        page.reload()
        page.wait_for_function(HIDDEN, arg="gripper/right")
