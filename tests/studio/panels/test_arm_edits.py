"""The panel of edits, in a real browser."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from two_fingers import HAND

import dh2urdf_studio

UR5 = Path(dh2urdf_studio.__file__).parent / "arms" / "ur5.csv"
THERE = "name => Boolean(document.querySelector('.arm-view').scene.getObjectByName(name))"


def test_a_hand_is_attached(tab: Any) -> None:
    """It is in the scene, has a slider for the joint that leads, and moves; what is wrong is shown beside the edit."""
    page = tab.open("ur5")
    page.get_by_role("button", name="edits: ").click()
    for name, has in (("payload", "inertia"), ("attach", "parent")):
        page.get_by_label("kind of edit").click()
        page.get_by_role("option", name=name, exact=True).click()
        page.locator(".studio-options dt", has_text=has).wait_for()
        page.wait_for_function("!document.querySelector('.q-menu')")  # it takes the cursor back to the list
    box = page.get_by_label("options of the edit")
    box.fill(f"{{file: {HAND}, name: hand, xyz: [0, 0, 11 mm]}}")
    box.press("Enter")
    tab.expect(box).to_have_value("")
    page.wait_for_function(THERE, arg="hand_left_finger")
    tab.wait_for_status("6 axes; the arm is the table's with 1 edit")
    names = page.locator(".joint-slider-name").all_inner_texts()
    assert names[6:] == ["hand_left"]
    before = tab.pose("hand_right_finger")
    tab.set_sliders([0.0] * 6 + [20.0])
    assert tab.pose("hand_right_finger") != before

    # What is typed into the list is another edit; the arm that was right stays.
    edit = page.get_by_label("edit 1", exact=True)
    edit.fill(edit.input_value().replace("name: hand", "nam: hand"))
    edit.press("Enter")
    edit.blur()
    page.locator(".studio-edits .studio-problem", has_text="did you mean 'name'?").wait_for()
    tab.wait_for_status("1 problem; the last good arm is shown")
    assert page.evaluate(THERE, "hand_left_finger")
    page.get_by_role("button", name="undo").click()
    tab.wait_for_status("the arm is the table's with 1 edit")
    assert tab.serious() == []
    page.get_by_role("button", name="remove edit 1").click()
    page.wait_for_function(f"!({THERE})('hand_left_finger')")
    tab.wait_for_status("6 axes; the arm is the table's")


@pytest.mark.long
@pytest.mark.parametrize("host", ["127.0.0.1", "0.0.0.0"])  # noqa: S104 - what it is about
def test_edits_of_the_command_line(serving: Callable[..., Any], new_tab: Callable[..., Any], host: str) -> None:
    """A tab begins with them; where other machines can reach the page, nobody types a file of this one."""
    with serving("studio", UR5, "--edit", f"attach: {{file: {HAND}, name: hand}}", "--host", host) as address:
        tab = new_tab(address)
        tab.page.goto(address)
        tab.page.wait_for_function(f"document.querySelector('.arm-view')?.scene && ({THERE})('hand_left_finger')")
        edit = tab.page.get_by_label("edit 1", exact=True)
        assert edit.is_editable() is (host == "127.0.0.1")
        count = int(host == "127.0.0.1")
        assert tab.page.get_by_label("options of the edit").count() == count
        assert tab.page.get_by_role("button", name="remove edit 1").count() == count
        tab.page.close()
