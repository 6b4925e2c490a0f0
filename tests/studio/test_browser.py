"""The studio in a real browser: what a person sees and does."""

from __future__ import annotations

import itertools
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from dh2urdf.manipulator import Convention
from dh2urdf.table_text import TableText
from dh2urdf_studio import gallery
from dh2urdf_studio.editing import edits, save
from dh2urdf_studio.editing.reading import read_whole
from dh2urdf_studio.editing.session import Session

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system import Catalog

CONFIGS = Path(__file__).parents[2] / "configs"


def arm_of(table: TableText, catalog: Catalog) -> Manipulator:
    arm = read_whole(table, catalog).manipulator
    assert arm is not None
    return arm


@pytest.mark.long
def test_a_wrong_cell(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """It is marked, the reader's message stands below the table, and the last good arm stays; fixed, the arm follows."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    before = tab.pose("tool0")
    tab.type_into(1, "alpha", "pi/x")
    tab.wait_for_status("1 problem; the last good arm is shown")
    (problem,) = read_whole(edits.with_cell(gallery.table("ur5.csv", catalog), 1, "alpha", "pi/x"), catalog).errors
    page.locator(".studio-problem", has_text=problem.text).wait_for()
    tab.expect(tab.cell(1, "alpha")).to_have_class(re.compile(r"\bdh-wrong\b"))
    assert "dh-wrong" not in tab.cell(2, "alpha").get_attribute("class")
    assert tab.pose("tool0") == before
    page.get_by_role("button", name="Generate").click()
    page.locator(".q-dialog").get_by_text("'pi/x' cannot be read").wait_for()
    page.get_by_role("button", name="Close").click()
    tab.type_into(1, "alpha", "30°")
    tab.wait_for_status("the arm is the table's")
    page.locator(".studio-problem.error").wait_for(state="detached")
    tab.wait_for_tool0(arm_of(edits.with_cell(gallery.table("ur5.csv", catalog), 1, "alpha", "30°"), catalog))


@pytest.mark.long
def test_problems_beside_an_open_panel(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """On a laptop the problems and the fields below them stay on the screen: the panels become shorter, and scroll."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    for panel in ("set the pose of tool0", "explain the picked row"):
        page.get_by_role("button", name=panel).click()
    tab.cell(0, "a").click()
    page.locator(".studio-lesson").wait_for()
    for row in range(3):
        tab.type_into(row, "alpha", "pi/x")
    tab.wait_for_status("3 problems")
    page.wait_for_function("""() => {
        const panels = [...document.querySelectorAll('.studio-panel')].filter(each => each.getClientRects().length);
        const bottom = document.querySelector('.studio-ends').getBoundingClientRect().bottom;
        return bottom <= innerHeight && panels.length === 2 && panels.every(each => each.clientHeight > 40);
    }""")


@pytest.mark.long
def test_a_problem_leads_to_what_is_wrong(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """By keyboard too: to the cell, which is being edited then, or to the field below the table."""
    tab = new_tab(studio_address)
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


@pytest.mark.long
def test_the_arm_moves_as_one_types(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """While a cell is being typed the arm is already there; Escape takes it back."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    tab.cell(1, "a").click()
    page.keyboard.type("-0.9")
    table = gallery.table("ur5.csv", catalog)
    tab.wait_for_tool0(arm_of(edits.with_cell(table, 1, "a", "-0.9"), catalog))
    page.keyboard.press("Escape")
    tab.wait_for_tool0(arm_of(table, catalog))
    tab.wait_for_cells(1, a="-0.425")


@pytest.mark.long
def test_letters_are_not_queued(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """Of many letters that are typed at once few arms are made, and the last of them is that of all letters."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    tab.cell(1, "a").dblclick()
    shown = page.evaluate("document.querySelector('.arm-view').shown")
    page.evaluate(
        """() => {
            const input = document.querySelector('.dh-table .ag-cell-inline-editing input');
            for (let i = 100; i < 200; i++) {
                input.value = `-0.${i}`;
                input.dispatchEvent(new Event('input', {bubbles: true}));
            }
        }"""
    )
    tab.wait_for_tool0(arm_of(edits.with_cell(gallery.table("ur5.csv", catalog), 1, "a", "-0.199"), catalog))
    assert page.evaluate("document.querySelector('.arm-view').shown") <= shown + 3


@pytest.mark.long
def test_undo_and_redo(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """By key and by button, in the cells and in the scene."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    table = gallery.table("ur5.csv", catalog)
    before, after = (arm_of(edits.with_cell(table, 1, "a", text), catalog) for text in ("-0.425", "-0.9"))
    tab.type_into(1, "a", "-0.9")
    tab.wait_for_tool0(after)
    for undo, redo in (
        (lambda: page.keyboard.press("Control+z"), lambda: page.keyboard.press("Control+Shift+Z")),
        (page.get_by_role("button", name="undo").click, page.get_by_role("button", name="redo").click),
    ):
        undo()
        tab.wait_for_tool0(before)
        tab.wait_for_cell(1, "a", "-0.425")
        redo()
        tab.wait_for_tool0(after)
        tab.wait_for_cell(1, "a", "-0.9")


@pytest.mark.long
def test_undo_from_a_button(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """Who has come to a button by Tab can undo from there: only text fields have an undo of their own."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    tab.type_into(1, "a", "-0.4x")
    tab.wait_for_status("1 problem")
    page.get_by_role("button", name="zero").focus()
    page.keyboard.press("Control+z")
    tab.wait_for_status("the arm is the table's")
    tab.wait_for_cell(1, "a", "-0.425")


@pytest.mark.long
def test_a_cell_is_shown_as_it_was_taken(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """The screen says what the table has, and not what was typed, where these differ."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    tab.type_into(1, "a", "-0.9   ")
    page.wait_for_function("cell => cell.textContent === '-0.9'", arg=tab.cell(1, "a").element_handle())


@pytest.mark.long
def test_a_row_that_is_gone(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """A cell that was typed while its row went away is no fault: the screen follows the table."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    page.evaluate(
        """() => {
            const {api} = getElement(Number(document.querySelector('.dh-table').id.slice(1)));
            api.applyTransaction({add: [{id: 6, joint: 'late'}]});
        }"""
    )
    tab.type_into(6, "a", "1")
    tab.cell(6, "a").wait_for(state="detached")
    assert page.get_by_text("The studio failed at this").count() == 0


@pytest.mark.long
def test_no_number_of_axes_takes_no_rows(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """An emptied field is no answer, nor are -3 and 6.7: the rows stay, and the field says again how many there are."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    axes = page.get_by_label("number of axes")
    for typed in ("", "-3", "6.7"):
        axes.fill(typed)
        axes.press("Enter")
        page.wait_for_function("axes => axes.value === '6'", arg=axes.element_handle())
        assert tab.status == "6 axes; the arm is the table's"


SHOWS_INERTIAS = """() => {
    let shown = 0;
    document.querySelector('.arm-view')?.scene?.traverse(part => shown += part.userData.layer === 'inertias' && part.visible);
    return shown > 0;
}"""


@pytest.mark.long
def test_a_reload_in_the_table(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """The cursor is in its cell again, and a cell that was being typed has the text as far as it was typed."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    cursor = """() => {
        const cell = document.activeElement.closest('.ag-cell');
        return cell && [cell.closest('.ag-row').getAttribute('row-index'), cell.getAttribute('col-id')].join();
    }"""
    tab.cell(2, "a").click()
    page.keyboard.press("ArrowRight")
    page.reload()
    page.wait_for_function(f"({cursor})() === '2,alpha'")
    page.keyboard.press("ArrowDown")
    page.wait_for_function(f"({cursor})() === '3,alpha'")
    page.keyboard.type("0.25")
    page.reload()
    tab.wait_for_cell(3, "alpha", "0.25")
    page.wait_for_function(f"({cursor})() === '3,alpha'")
    page.get_by_role("button", name="undo", exact=True).click()
    tab.wait_for_cell(3, "alpha", "pi/2")
    page.reload()  # the cursor is no longer in the table
    tab.wait_for_cell(3, "alpha", "pi/2")
    page.wait_for_function("document.querySelector('.arm-view')?.shown > 0")  # which comes after the cursor
    assert page.evaluate(cursor) is None


@pytest.mark.long
@pytest.mark.parametrize(("label", "text"), [("base", "{xyz: [0, 0, 0.3]}"), ("name of the arm", "my arm")])
def test_a_reload_in_a_field(studio_address: str, new_tab: Callable[..., Any], label: str, text: str) -> None:
    """A text of the whole table that was being typed is in its field again, and can be taken back; it was lost."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    before = page.get_by_label(label, exact=True).input_value()
    assert before != text
    page.get_by_label(label, exact=True).click()
    page.keyboard.press("Control+A")
    page.keyboard.type(text)
    page.reload()
    holds = "([label, text]) => document.querySelector(`input[aria-label='${label}']`)?.value === text"
    page.wait_for_function(holds, arg=[label, text])
    page.get_by_role("button", name="undo", exact=True).click()
    page.wait_for_function(holds, arg=[label, before])


@pytest.mark.long
@pytest.mark.parametrize("name", ["ur5", "panda"])
def test_a_whole_table_is_on_a_laptops_screen(studio_address: str, new_tab: Callable[..., Any], name: str) -> None:
    """At a width of 1280 every column is there, heads and cells whole, from the names to the efforts."""
    page = new_tab(studio_address).open(name)
    page.locator(".ag-header-cell[col-id=effort]").wait_for()
    page.wait_for_function("""() => {
        const view = document.querySelector('.dh-table .ag-center-cols-viewport');
        const texts = [...document.querySelectorAll('.dh-table .ag-header-cell-text, .dh-table .ag-cell')];
        return view.scrollWidth <= view.clientWidth && texts.every(text => text.scrollWidth <= text.clientWidth);
    }""")


@pytest.mark.long
def test_a_reload_and_another_tab(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """A reload finds table, pose, past and what is shown again; another tab has its own."""
    tab = new_tab(studio_address)
    page = tab.open("scara")
    tab.type_into(0, "a", "0.45")
    page.locator(".joint-slider-number").first.fill("0.5")
    page.keyboard.press("Enter")
    arm = arm_of(edits.with_cell(gallery.table("scara.csv", catalog), 0, "a", "0.45"), catalog)
    tab.wait_for_joint(0, 0.5)
    tab.wait_for_tool0(arm)

    other = new_tab(studio_address)
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


@pytest.mark.long
def test_sliders_move_the_arm(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """Seven joints of a modified table: after a random pose, zero and a key, the scene is the DH product of the sliders."""
    tab = new_tab(studio_address)
    page = tab.open("panda")
    arm = arm_of(gallery.table("panda.yaml", catalog), catalog)
    for button in ("random pose", "zero"):
        tab.press(button)
        q = tab.sliders()
        assert len(q) == 7
        tab.wait_for_tool0(arm, q)
    limits = [(row.limits.lower, row.limits.upper) for row in arm.moving_rows]
    assert all(low <= value <= high for value, (low, high) in zip(q, limits, strict=True))
    assert q[3] == pytest.approx(-0.0698)
    tab.expect(page.locator(".studio-matrix")).to_contain_text("0.9249")


@pytest.mark.long
def test_a_picked_row_stands_out(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """The link of the row under the cursor is outlined and keeps its colour, its frame stands out, and no others."""
    tab = new_tab(studio_address)
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


@pytest.mark.long
def test_parameters_are_drawn_on_request(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """a, α, d and θ stand as segments and arcs in the scene, with their symbols, once they are asked for."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    assert page.locator(".arm-view-stroke").count() == 0
    page.get_by_text("a α d θ", exact=True).click()
    page.locator(".arm-view-stroke", has_text="a₂ = -0.425 m").wait_for()
    texts = page.locator(".arm-view-stroke").all_inner_texts()
    assert {"d₁ = 0.089159 m", "α₁ = pi/2", "α₅ = -pi/2"} <= set(texts)


@pytest.mark.long
@pytest.mark.parametrize("axes", [1, 30])
def test_nothing_is_below_the_cross(studio_address: str, new_tab: Callable[..., Any], axes: int) -> None:
    """The tip of an arm along x points to the corner with the cross: the arm and its last label keep clear of it."""
    tab = new_tab(studio_address)
    row = {"type": "revolute", "a": "1", "alpha": "0", "d": "0"}
    rows = tuple({"joint": f"joint_{number}", **row} for number in range(1, axes + 1))
    page = tab.open_table(TableText(name="long", convention="standard", rows=rows))
    last = f"{{{axes}}} flange tool0"
    script = """last => [...document.querySelectorAll('.arm-view-label')].some(label =>
        label.textContent === last && label.style.visibility === 'visible')"""
    page.wait_for_function(script, arg=last)
    covered = """() => {
        const view = document.querySelector('.arm-view'), box = selector => document.querySelector(selector).getBoundingClientRect();
        const all = box('.arm-view'), corners = ['.arm-view-cross', '.view-cube', '.arm-view-projection'].map(box), found = [];
        view.scene.traverse(node => {
            if (!/^frame |^tool0$|^flange$/.test(node.name)) return;
            const at = node.position.clone().setFromMatrixPosition(node.matrixWorld).project(view.camera);
            const [x, y] = [all.left + (1 + at.x) / 2 * all.width, all.top + (1 - at.y) / 2 * all.height];
            if (corners.some(one => x > one.left && x < one.right && y > one.top && y < one.bottom)) found.push(node.name);
        });
        for (const label of document.querySelectorAll('.arm-view-label')) {
            const own = label.getBoundingClientRect();
            if (label.style.visibility === 'visible' && corners.some(one =>
                own.right > one.left && own.left < one.right && own.bottom > one.top && own.top < one.bottom)) found.push(label.textContent);
        }
        return found;
    }"""
    page.wait_for_function(f"!({covered})().length")
    page.evaluate("dhLook.magnify()")
    page.wait_for_function(f"!({covered})().length && ({script})({last!r})")


@pytest.mark.long
def test_labels_keep_clear(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """No label lies on another; frames at one point share a label, and a line leads from one that is pushed away."""
    tab = new_tab(studio_address)
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


@pytest.mark.long
def test_the_camera_sees_all(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """All corners of the links of an arm that was opened are inside the picture, and reach over half of it."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    script = """() => {
        const {scene, camera} = document.querySelector('.arm-view'), corners = [];
        camera.updateMatrixWorld();
        scene.traverse(part => {
            if (part.userData.layer !== 'links' || !part.isMesh) return;
            const {array, count} = part.geometry.attributes.position;
            for (let i = 0; i < count; i++)
                corners.push(camera.position.clone().fromArray(array, 3 * i).applyMatrix4(part.matrixWorld).project(camera));
        });
        const reach = axis => Math.max(...corners.map(c => c[axis])) - Math.min(...corners.map(c => c[axis]));
        return corners.every(({x, y}) => Math.abs(x) < 1 && Math.abs(y) < 1) && Math.max(reach('x'), reach('y')) > 1;
    }"""
    page.wait_for_function(f"({script})()")
    for name in ("stanford", "track"):
        tab.open_from_gallery(name)
        page.wait_for_function(f"({script})()")


@pytest.mark.long
def test_the_paper_stands_side_by_side(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """Both variants are in the scene, and the page says how far the straight line is from the arm."""
    tab = new_tab(studio_address)
    page = tab.open("ur5_paper")
    page.get_by_role("button", name="side by side").click()
    page.get_by_text("its tool0 is 1.41 m and 90° from the table's").wait_for()
    tab.wait_for_nodes("tool0", "paper/tool0")


@pytest.mark.long
def test_convention_and_units_are_converted_or_reinterpreted(
    studio_address: str, new_tab: Callable[..., Any], catalog: Catalog
) -> None:
    """The page asks which; converted, the arm stays where it is, reinterpreted, the numbers do."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    before = tab.pose("tool0")
    page.get_by_role("button", name="modified").click()
    with tab.another_drawing():
        page.get_by_text("Convert: the same arm, other numbers.").click()
    page.wait_for_function("document.querySelector('.ag-header-cell[col-id=a]').innerText.includes('ᵢ₋₁')")
    tab.wait_for_cells(2, a="-0.425", alpha="0")
    assert np.allclose(tab.pose("tool0"), before, atol=1e-8)
    page.get_by_role("button", name="mm", exact=True).click()
    with tab.another_drawing():
        page.get_by_text("Convert: the same arm, its numbers").click()
    tab.wait_for_cell(2, "a", "-425")
    assert np.allclose(tab.pose("tool0"), before, atol=1e-8)
    page.get_by_role("button", name="standard").click()
    page.get_by_text("Reinterpret: the same numbers").click()
    page.wait_for_function("!document.querySelector('.ag-header-cell[col-id=a]').innerText.includes('ᵢ₋₁')")
    tab.wait_for_cells(2, a="-425", alpha="0")
    session = Session(catalog, gallery.table("ur5.csv", catalog))
    session.set_convention(Convention.MODIFIED, convert=True)
    session.set_convention(Convention.STANDARD, convert=False)
    assert session.arm is not None
    tab.wait_for_tool0(session.arm.manipulator)
    assert not np.allclose(tab.pose("tool0"), before, atol=1e-3)
    page.get_by_role("button", name="modified").click()
    page.get_by_role("button", name="Cancel").click()
    page.locator("button.bg-primary", has_text="standard").wait_for()
    tab.wait_for_cells(2, a="-425", alpha="0")


@pytest.mark.long
def test_both_units_are_chosen_in_the_question(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """Numbers in mm and degrees are typed into a table in m and rad: one question about both units is enough."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    tab.type_into(1, "a", "-425")
    tab.type_into(0, "alpha", "90")
    tab.settle()
    page.get_by_role("button", name="mm", exact=True).click()
    asked = page.get_by_role("dialog", name="To other units")
    asked.get_by_text("the same numbers, now mm and rad").wait_for()
    asked.get_by_role("button", name="deg", exact=True).click()
    asked.get_by_text("its numbers in mm and deg").wait_for()
    asked.get_by_text("Reinterpret: the same numbers, now mm and deg").click()
    for head in ("a", "alpha"):
        unit = "mm" if head == "a" else "deg"
        page.locator(f".ag-header-cell[col-id={head}]", has_text=f"[{unit}]").wait_for()
    tab.wait_for_cell(1, "a", "-425")
    tab.wait_for_cell(0, "alpha", "90")


@pytest.mark.long
def test_a_wrong_table_is_not_reinterpreted_unasked(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """Numbers that cannot be converted, as one of them is wrong, mean something else only when a person says so."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    tab.type_into(1, "alpha", "pi/x")
    tab.wait_for_status("1 problem")
    for button in ("mm", "modified"):
        page.get_by_role("button", name=button, exact=True).click()
        page.get_by_text("A table that is not right yet cannot be converted.").wait_for()
        page.get_by_role("button", name="Cancel").click()
        page.locator(".q-dialog").wait_for(state="detached")
    page.locator("button.bg-primary", has_text="standard").wait_for()


@pytest.mark.long
def test_too_large_a_file_is_not_read(studio_address: str, new_tab: Callable[..., Any], tmp_path: Path) -> None:
    """The dialog refuses what has more than 64 MB: the page sends none of it, and the server takes none past the page."""
    page = new_tab(studio_address).open()
    huge = tmp_path / "huge.csv"
    with huge.open("wb") as file:
        file.truncate(2**26 + 1)
    page.get_by_role("button", name="Open", exact=True).click()
    dialog = page.locator(".q-dialog")
    dialog.locator("input[type=file]").set_input_files(huge)
    dialog.get_by_text("huge.csv is too large").filter(has_text="of at most 64 MB").wait_for()
    (other := tmp_path / "arm.docx").write_bytes(b"PK")
    dialog.locator("input[type=file]").set_input_files(other)
    dialog.get_by_text("arm.docx is no file that can be opened").wait_for()
    script = """async name => {
        const {id} = document.querySelector('.q-dialog .q-uploader'), form = new FormData();
        form.append(name, new File([new Uint8Array(2 ** 26 + 1)], name));
        await fetch(getElement(Number(id.slice(1))).$props.url, {method: 'POST', body: form});
    }"""
    page.evaluate(script, "huge.csv")
    dialog.get_by_text("huge.csv is too large").filter(has_text="of at most 64 MB").wait_for()
    assert dialog.get_by_text("reading huge.csv").count() == 0


@pytest.mark.long
def test_a_file_is_opened(studio_address: str, new_tab: Callable[..., Any], tmp_path: Path) -> None:
    """A table of one's own is uploaded; one that cannot be read says why; of several robots one is chosen."""
    tab = new_tab(studio_address)
    page = tab.open()
    wrong, two = tmp_path / "wrong.csv", tmp_path / "two.csv"
    (tmp_path / "notes.txt").write_text("no table")
    wrong.write_text("# convention: standard\na,alpha,d\n1,x,0\n")
    two.write_text("# convention: standard\nrobot,a,alpha,d\nfirst,1,0,0\nsecond,2,0,0\n")
    page.get_by_role("button", name="Open", exact=True).click()
    page.locator("[role=dialog] input[type=file]").set_input_files(tmp_path / "notes.txt")
    page.get_by_text("is no file that can be opened").wait_for()
    page.locator("[role=dialog] input[type=file]").set_input_files(wrong)
    page.get_by_text("wrong.csv:3:3: error: joint 'joint_1', field 'alpha': 'x' cannot be read").wait_for()
    page.locator("[role=dialog] input[type=file]").set_input_files(two)
    page.get_by_text("The file holds 2 manipulators").wait_for()
    page.get_by_role("combobox", name="manipulator").click()
    page.get_by_role("option", name="second").click()
    page.locator(".q-dialog").get_by_role("button", name="Open").click()
    tab.wait_for_status("1 axis; the arm is the table's")
    tab.wait_for_cells(0, a="2")


@pytest.mark.long
def test_everything_is_saved(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """Every entry of the menu hands over the bytes that the command line would write."""
    tab = new_tab(studio_address)
    tab.open("stanford")
    table = gallery.table("stanford.csv", catalog)
    assert tab.save("Table as yaml") == ("stanford.yaml", save.table_file(table, "yaml", catalog).content)
    assert tab.save("Table as .tex") == ("stanford.tex", save.other_file(table, ".tex", "exact", catalog).content)
    assert tab.save("Robot as urdf") == ("stanford.urdf", save.robot_file(table, "urdf", "exact", catalog).content)
    assert tab.save("Robot as xacro") == (
        "stanford.urdf.xacro",
        save.robot_file(table, "xacro", "exact", catalog).content,
    )
    assert tab.save("Run file")[0] == "stanford_run.yaml"
    assert tab.save("Everything, as a zip") == ("stanford.zip", save.zipped(save.all_files(table, "exact", catalog)))


@pytest.mark.long
def test_rows_are_added_removed_and_moved(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """By key: a row more below, one up, one away; a spreadsheet's cells are pasted."""
    tab = new_tab(studio_address)
    page = tab.open("scara")
    tab.cell(1, "joint").click()
    page.keyboard.press("Alt+ArrowUp")
    page.keyboard.press("Alt+Delete")  # at once: the cursor has gone with the row
    tab.wait_for_status("3 axes")
    tab.wait_for_cell(0, "joint", "shoulder")
    page.keyboard.press("Alt+Insert")
    tab.wait_for_status("3 problems")
    tab.cell(1, "a").click()
    page.evaluate(
        """() => {
            const data = new DataTransfer();
            data.setData("text/plain", "0.1\\tpi/2\\t0.2\\n");
            document.activeElement.dispatchEvent(new ClipboardEvent("paste", {clipboardData: data, bubbles: true}));
        }"""
    )
    tab.wait_for_status("4 axes; the arm is the table's")
    tab.wait_for_cells(1, a="0.1", alpha="pi/2", d="0.2")


@pytest.mark.long
def test_a_hundred_axes(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog, tmp_path: Path) -> None:
    """A table of a hundred rows is opened, edited and moved; the scene is the DH product of its sliders."""
    table = edits.resized(TableText(name="long", convention="standard"), 100)
    cells = {(row, field): text for row in range(100) for field, text in (("a", "0.1"), ("alpha", "pi/2"), ("d", "0"))}
    saved = save.table_file(edits.with_cells(table, cells), "csv", catalog)
    (tmp_path / saved.name).write_bytes(saved.content)
    tab = new_tab(studio_address)
    page = tab.open()
    page.get_by_role("button", name="Open", exact=True).click()
    page.locator("[role=dialog] input[type=file]").set_input_files(tmp_path / saved.name)
    tab.wait_for_status("100 axes; the arm is the table's")
    tab.type_into(5, "a", "0.2")
    tab.press("random pose")
    session = Session(catalog, edits.with_cell(edits.with_cells(table, cells), 5, "a", "0.2"))
    assert session.arm is not None
    assert len(tab.sliders()) == 100
    tab.wait_for_tool0(session.arm.manipulator)


@pytest.mark.long
def test_faults_of_the_server_are_told(studio_address: str, new_tab: Callable[..., Any], catalog: Catalog) -> None:
    """What the server cannot do is said on the page, and the studio goes on."""
    tab = new_tab(studio_address)
    page = tab.open("ur5")
    page.evaluate("emitEvent('dh-edit', ['nowhere'])")
    page.get_by_text(re.compile("The studio failed at this")).wait_for()
    page.get_by_role("button", name="Close").click()
    tab.type_into(1, "a", "-0.5")
    tab.wait_for_tool0(arm_of(edits.with_cell(gallery.table("ur5.csv", catalog), 1, "a", "-0.5"), catalog))
