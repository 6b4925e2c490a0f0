"""The studio in a real browser: what a person sees and does."""

import itertools
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.manipulator import Convention, Manipulator
from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.editing import save
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import Session

pytestmark = pytest.mark.long


def test_a_wrong_cell(tab: Any, arm_of: Callable[..., Manipulator]) -> None:
    """It is marked, the reader's message stands below the table, and the last good arm stays; fixed, the arm follows."""
    page = tab.open("ur5")
    before = tab.pose("tool0")
    tab.type_into(1, "alpha", "pi/x")
    tab.wait_for_status("1 problem; the last good arm is shown")
    page.locator(".studio-problem", has_text="'pi/x' cannot be read").wait_for()
    tab.expect(tab.cell(1, "alpha")).to_have_class(re.compile(r"\bdh-wrong\b"))
    assert "dh-wrong" not in tab.cell(2, "alpha").get_attribute("class")
    assert tab.pose("tool0") == before
    page.get_by_role("button", name="Generate").click()
    page.locator(".q-dialog").get_by_text("'pi/x' cannot be read").wait_for()
    page.get_by_role("button", name="Close").click()
    tab.type_into(1, "alpha", "30°")
    tab.wait_for_status("the arm is the table's")
    page.locator(".studio-problem.error").wait_for(state="detached")
    tab.wait_for_tool0(arm_of("ur5.csv", {(1, "alpha"): "30°"}))


def test_a_problem_leads_to_what_is_wrong(tab: Any) -> None:
    """By keyboard too: to the cell, which is being edited then, or to the field below the table."""
    page = tab.open("ur5")
    tab.type_into(1, "alpha", "pi/x")
    page.get_by_role("button", name="row 2, shoulder_lift_joint, alpha").focus()
    page.keyboard.press("Enter")
    page.wait_for_function(
        "document.activeElement.closest('.ag-cell-inline-editing')?.getAttribute('col-id') === 'alpha'"
    )
    page.keyboard.type("0")
    page.keyboard.press("Enter")
    tab.wait_for_status("the arm is the table's")
    page.get_by_label("payload", exact=True).fill("{mass: none}")
    page.get_by_label("payload", exact=True).blur()
    page.get_by_role("button", name="payload: ").press("Space")
    page.wait_for_function("document.activeElement.getAttribute('aria-label') === 'payload'")


def test_the_arm_moves_as_one_types(tab: Any, arm_of: Callable[..., Manipulator]) -> None:
    """While a cell is being typed the arm is already there; Escape takes it back."""
    page = tab.open("ur5")
    tab.cell(1, "a").click()
    page.keyboard.type("-0.9")
    tab.wait_for_tool0(arm_of("ur5.csv", {(1, "a"): "-0.9"}))
    page.keyboard.press("Escape")
    tab.wait_for_tool0(arm_of("ur5.csv"))
    tab.wait_for_cells(1, a="-0.425")


SHOWS_INERTIAS = """() => {
    let shown = 0;
    document.querySelector('.arm-view')?.scene?.traverse(part => shown += part.userData.layer === 'inertias' && part.visible);
    return shown > 0;
}"""


def test_a_reload_and_another_tab(tab: Any, new_tab: Callable[..., Any], arm_of: Callable[..., Manipulator]) -> None:
    """A reload finds table, pose, past and what is shown again; another tab has its own."""
    page = tab.open("scara")
    tab.type_into(0, "a", "0.45")
    page.locator(".joint-slider-number").first.fill("0.5")
    page.keyboard.press("Enter")
    arm = arm_of("scara.csv", {(0, "a"): "0.45"})
    tab.wait_for_joint(0, 0.5)
    tab.wait_for_tool0(arm)

    other = new_tab(tab.address)
    other.open()
    other.wait_for_status("choose the number of axes")
    assert other.status == "choose the number of axes, or paste a table"
    other.open_from_gallery("ur5")

    page.bring_to_front()
    page.get_by_role("button", name="orthographic").click()
    tab.switch_layers("inertias")
    page.wait_for_function(SHOWS_INERTIAS)
    page.reload()
    tab.wait_for_status("4 axes; the arm is the table's")
    page.wait_for_function(SHOWS_INERTIAS)
    page.locator(".arm-view-projection[aria-pressed=true]").wait_for()
    page.wait_for_function("document.querySelector('.arm-view').camera.isOrthographicCamera")
    assert other.page.locator(".arm-view-projection[aria-pressed=false]").count() == 1
    tab.wait_for_cells(0, joint="shoulder", a="0.45")
    tab.wait_for_joint(0, 0.5)
    tab.wait_for_tool0(arm)
    assert other.cells(0, "joint") == ["shoulder_pan_joint"]
    page.get_by_role("button", name="undo").click()
    tab.wait_for_cell(0, "a", "0.4")
    assert other.cells(1, "a") == ["-0.425"]


def test_a_picked_row_stands_out(tab: Any) -> None:
    """The link of the row under the cursor is outlined and keeps its colour, its frame stands out, and no others."""
    page = tab.open("ur5")
    tab.cell(2, "d").click()
    script = """() => {
        const nodes = document.querySelector('.arm-view').scene.children[0].children;
        return nodes.filter(node => node.children.some(part => part.isMesh && part.userData.layer === 'links'
            && part.userData.outline)).map(node => node.name + ' ' + node.children[0].material.color.getHexString());
    }"""
    page.wait_for_function(f"JSON.stringify(({script})()) === '[\"link_3 ed8021\"]'")
    tab.expect(page.locator(".arm-view-picked:visible")).to_have_text(["{3}"])
    row = page.locator(".dh-table .ag-center-cols-container .ag-row[row-index='2']")
    tab.expect(row).to_have_class(re.compile(r"\bdh-picked\b"))


def test_labels_keep_clear(tab: Any) -> None:
    """No label lies on another; frames at one point share a label, and a line leads from one that is pushed away."""
    page = tab.open("ur5")
    script = """() => [...document.querySelectorAll('.arm-view-label')].filter(label => label.style.visibility === 'visible')
        .map(label => [label.textContent, label.getBoundingClientRect().toJSON()])"""
    page.wait_for_function(f"({script})().length === 7")
    labels = page.evaluate(script)
    assert {text for text, _ in labels} == {*(f"{{{number}}}" for number in range(6)), "{6} flange tool0"}
    for (_, one), (_, other) in itertools.combinations(labels, 2):
        aside = one["right"] < other["left"] or other["right"] < one["left"]
        assert aside or one["bottom"] < other["top"] or other["bottom"] < one["top"]
    lines = "document.querySelector('.arm-view-leaders path').getAttribute('d').split('M').length - 1"
    page.get_by_text("a α d θ", exact=True).click()
    page.locator(".arm-view-stroke").first.wait_for()
    # Most are beside their points.
    page.wait_for_function(f"0 < {lines} && {lines} < document.querySelectorAll('.arm-view-label').length / 2")

    # At the wrist of a Stanford arm all frames from {3} on are at one point.
    tab.open_from_gallery("stanford")
    page.wait_for_function(f"({script})().some(([text]) => text === '{{3}}–{{6}} flange tool0')")
    tab.cell(4, "a").click()
    page.wait_for_function(f"({script})().some(([text]) => text === '{{3}} {{4}} {{6}} flange tool0')")


def test_convention_and_units_are_converted_or_reinterpreted(tab: Any, catalog: Catalog) -> None:
    """The page asks which; converted, the arm stays where it is, reinterpreted, the numbers do; cancelled, all stays."""
    page = tab.open("ur5")
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    for button, answer, a in (
        ("modified", "Convert: the same arm, other numbers.", "-0.425"),
        ("mm", "Convert: the same arm, its numbers", "-425"),
        ("standard", "Reinterpret: the same numbers", "-425"),
    ):
        with tab.another_drawing():
            tab.click(button)
            page.get_by_text(answer).click()
        if button == "mm":
            session.set_units("mm", "rad", convert=True)
        else:
            session.set_convention(Convention(button), convert="Convert" in answer)
        tab.wait_for_cells(2, a=a, alpha="0")
        assert session.arm is not None
        tab.wait_for_tool0(session.arm.manipulator)
    tab.click("modified")
    tab.click("Cancel")
    page.locator("button.bg-primary", has_text="standard").wait_for()
    tab.wait_for_cells(2, a="-425", alpha="0")


def test_too_large_a_file_is_not_read(tab: Any, tmp_path: Path) -> None:
    """The page refuses what has more than 64 MB and sends none of it, and the server takes none past the page."""
    page = tab.open()
    with (huge := tmp_path / "huge.csv").open("wb") as file:
        file.truncate(2**26 + 1)
    told = page.locator(".q-notification").get_by_text("of at most 64 MB")
    tab.choose_file(huge)
    told.wait_for()
    page.get_by_role("button", name="Close").click()
    told.wait_for(state="detached")
    tab.send_past_the_page(2**26 + 1)
    told.wait_for()
    assert page.get_by_text("reading huge.csv").count() == 0


def test_a_file_is_opened(tab: Any, tmp_path: Path) -> None:
    """A table of one's own is uploaded; one that cannot be read says why; of several robots one is chosen."""
    page = tab.open()
    wrong, two = tmp_path / "wrong.csv", tmp_path / "two.csv"
    (tmp_path / "notes.pdf").write_text("no table")
    wrong.write_text("# convention: standard\na,alpha,d\n1,x,0\n")
    two.write_text("# convention: standard\nrobot,a,alpha,d\nfirst,1,0,0\nsecond,2,0,0\n")
    tab.choose_file(tmp_path / "notes.pdf")
    page.get_by_text("This is not a file that can be opened").wait_for()
    tab.choose_file(wrong)
    page.get_by_text("wrong.csv:3:3: error: joint 'joint_1', field 'alpha': 'x' cannot be read").wait_for()
    tab.choose_file(two)
    page.get_by_text("The file holds 2 manipulators").wait_for()
    page.get_by_role("combobox", name="manipulator").click()
    page.get_by_role("option", name="second").click()
    page.locator(".q-dialog").get_by_role("button", name="Open").click()
    tab.wait_for_status("1 axis; the arm is the table's")
    tab.wait_for_cells(0, a="2")


def test_everything_is_saved(tab: Any, catalog: Catalog) -> None:
    """Every entry of the menu hands over the bytes that the command line would write."""
    tab.open("stanford")
    table = gallery_table("stanford.csv", catalog)
    assert tab.save("Table as yaml") == ("stanford.yaml", save.table_file(table, "yaml", catalog).content)
    assert tab.save("Table as .tex") == ("stanford.tex", save.other_file(table, ".tex", "exact", catalog).content)
    assert tab.save("Robot as urdf") == ("stanford.urdf", save.saved(table, "robot", "urdf", "exact", catalog).content)
    assert tab.save("Robot as xacro") == (
        "stanford.urdf.xacro",
        save.saved(table, "robot", "xacro", "exact", catalog).content,
    )
    assert tab.save("Run file")[0] == "stanford_run.yaml"
    assert tab.save("Everything, as a zip") == ("stanford.zip", save.saved(table, "all", "", "exact", catalog).content)


def test_faults_of_the_server_are_told(tab: Any, arm_of: Callable[..., Manipulator]) -> None:
    """What the server cannot do is said on the page, and the studio goes on."""
    page = tab.open("ur5")
    page.evaluate("emitEvent('dh-edit', ['nowhere'])")
    page.get_by_text(re.compile("The studio failed at this")).wait_for()
    page.get_by_role("button", name="Close").click()
    tab.type_into(1, "a", "-0.5")
    tab.wait_for_tool0(arm_of("ur5.csv", {(1, "a"): "-0.5"}))
