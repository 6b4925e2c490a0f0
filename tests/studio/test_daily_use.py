"""What people do all day in the studio, in a real browser: undo, copy, cut, paste, look, and lose the connection."""

from __future__ import annotations

import itertools
import re
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

import dh2urdf

if TYPE_CHECKING:
    from collections.abc import Callable

TABLES = Path(__file__).parents[2] / "configs" / "tables"
ROWS = "document.querySelectorAll('.dh-table .ag-center-cols-container .ag-row').length"


@pytest.fixture
def tab(studio_address: str, new_tab: Callable[..., Any]) -> Any:
    """A tab that is not open yet, and may use the clipboard."""
    tab = new_tab(studio_address)
    tab.page.context.grant_permissions(["clipboard-read", "clipboard-write"], origin=studio_address.rstrip("/"))
    return tab


def copy_text(tab: Any, text: str) -> None:
    """Puts a text into the clipboard, as another program would."""
    tab.page.evaluate("text => navigator.clipboard.writeText(text)", text)


def paste(tab: Any, row: int, field: str, text: str) -> None:
    copy_text(tab, text)
    tab.cell(row, field).click()
    tab.page.keyboard.press("Control+v")


def begin(tab: Any, axes: int) -> None:
    """A new table of the standard convention, with rows that are empty."""
    tab.page.get_by_role("button", name="New", exact=True).click()
    tab.settle()
    tab.wait_for_status("choose the number of axes, or paste a table")
    tab.page.wait_for_function(f"{ROWS} === 0")  # the table before may have had as many
    tab.page.get_by_role("button", name="standard").click()
    tab.page.get_by_label("number of axes").fill(f"{axes}")
    tab.page.keyboard.press("Enter")
    tab.page.wait_for_function(f"{ROWS} === {axes}")


def wait_until_empty(tab: Any, row: int, field: str) -> None:
    tab.cell(row, field).filter(has_text=re.compile(r"^\s*$")).wait_for()


# --- Undo -------------------------------------------------------------------------------------------------------------


@pytest.mark.long
@pytest.mark.parametrize("how", ["New", "undo"])
def test_no_ghosts_of_rows(tab: Any, how: str) -> None:
    """After New, and after undo back to the start, no row of the old table is on the screen."""
    tab.open("ur5")
    tab.page.get_by_role("button", name=how, exact=True).click()
    tab.page.wait_for_function(f"{ROWS} === 0")
    tab.wait_for_status("choose the number of axes, or paste a table")


@pytest.mark.long
def test_undo_is_the_studios(tab: Any) -> None:
    """A name is typed, then a cell: Ctrl+Z takes back the cell, then the name, whole, and no letter of it before."""
    tab.open("ur5")
    name = tab.page.locator(".studio-name input")
    name.click()
    tab.page.keyboard.press("End")
    tab.page.keyboard.type("_left")
    tab.page.keyboard.press("Enter")
    tab.type_into(1, "a", "-0.5")
    tab.wait_for_cell(1, "a", "-0.5")
    tab.page.keyboard.press("Control+z")
    tab.wait_for_cell(1, "a", "-0.425")
    tab.expect(name).to_have_value("ur5_left")
    tab.page.keyboard.press("Control+z")
    tab.page.wait_for_function("document.querySelector('.studio-name input').value === 'ur5'")
    tab.page.keyboard.press("Control+Shift+z")
    tab.page.wait_for_function("document.querySelector('.studio-name input').value === 'ur5_left'")


@pytest.mark.long
def test_a_field_that_is_being_typed_has_its_own_undo(tab: Any) -> None:
    """Ctrl+Z in the middle of a name takes back letters; once the name is taken, it takes back the name."""
    tab.open("ur5")
    name = tab.page.locator(".studio-name input")
    name.click()
    tab.page.keyboard.press("End")
    tab.page.keyboard.type("x")
    tab.page.keyboard.press("Control+z")
    assert name.input_value() == "ur5"
    tab.page.keyboard.type("y")
    tab.page.keyboard.press("Enter")
    tab.settle()
    tab.page.keyboard.press("Control+z")
    tab.page.wait_for_function("document.querySelector('.studio-name input').value === 'ur5'")


@pytest.mark.long
def test_undo_in_a_cell_is_that_of_its_text(tab: Any) -> None:
    """More Ctrl+Z than there are letters: no edit of the table goes behind the back of the cell that is being typed."""
    tab.open("ur5")
    tab.type_into(1, "a", "-0.5")
    tab.wait_for_cell(1, "a", "-0.5")
    tab.cell(3, "d").click()
    tab.page.keyboard.type("12")
    for _ in range(4):
        tab.page.keyboard.press("Control+z")
    assert tab.page.evaluate("Boolean(document.activeElement.closest('.ag-cell-inline-editing'))")
    tab.page.keyboard.press("Escape")
    tab.type_into(0, "a", "0.1")
    tab.settle()
    tab.wait_for_cell(0, "a", "0.1")
    tab.wait_for_cells(1, a="-0.5")


@pytest.mark.long
def test_every_field_of_the_table_is_in_the_past(tab: Any) -> None:
    """Base, tool and the number of axes are typed; Ctrl+Z takes them back one by one, whole, from whatever field."""
    tab.open("ur5")
    typed = [("base", "{xyz: [0, 0, 0.3]}"), ("tool", "{xyz: [0, 0, 0.1]}"), ("number of axes", "7")]
    before = []
    for label, text in typed:
        field = tab.page.get_by_label(label, exact=True)
        before.append((field, field.input_value()))
        field.click()
        tab.page.keyboard.press("Control+a")
        tab.page.keyboard.type(text)
        tab.page.keyboard.press("Enter")
    tab.page.wait_for_function(f"{ROWS} === 7")
    cells = tab.cells(1, "a", "alpha", "d")
    for field, text in reversed(before):
        assert field.input_value() != text
        tab.page.keyboard.press("Control+z")
        tab.page.wait_for_function("([field, text]) => field.value === text", arg=[field.element_handle(), text])
    assert tab.cells(1, "a", "alpha", "d") == cells
    tab.wait_for_status("6 axes; the arm is the table's")


@pytest.mark.long
def test_the_shape_of_links_is_typed(tab: Any, tmp_path: Path) -> None:
    """With `shape: arm` the links get housings, on the screen and in the file, as `convert` makes them of such a table."""
    tab.open("ur5")
    field = tab.page.get_by_label("defaults", exact=True)
    field.fill("{geometry: {shape: arms}}")
    field.press("Enter")
    tab.wait_for_status("1 problem; the last good arm is shown")
    field.fill("{geometry: {shape: arm}}")
    field.press("Enter")
    tab.wait_for_status("6 axes; the arm is the table's")
    with tab.page.expect_download() as generating:
        tab.page.get_by_role("button", name="Generate").click()
    made = Path(generating.value.path()).read_text("utf-8").partition("<link")[2]
    table = tmp_path / "ur5.csv"
    table.write_text("# defaults: {geometry: {shape: arm}}\n" + (TABLES / "ur5.csv").read_text("utf-8"), "utf-8")
    assert made == dh2urdf.convert(table).text.partition("<link")[2]
    assert made != dh2urdf.convert(TABLES / "ur5.csv").text.partition("<link")[2]


# --- The clipboard ----------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_a_range_is_copied_cut_and_put_elsewhere(tab: Any) -> None:
    """Shift and arrows choose cells; Ctrl+C has them as a spreadsheet does, Ctrl+X empties them, Ctrl+V puts them in."""
    tab.open("ur5")
    copy_text(tab, "")  # all tests share the clipboard
    tab.cell(1, "a").click()
    for key in ("Shift+ArrowDown", "Shift+ArrowRight", "Shift+ArrowRight"):
        tab.page.keyboard.press(key)
    tab.page.wait_for_function("document.querySelectorAll('.dh-table .ag-cell.dh-range').length === 6")
    tab.page.keyboard.press("Control+c")
    tab.page.wait_for_function("navigator.clipboard.readText().then(text => text.includes('\\t'))")
    cells = tab.page.evaluate("navigator.clipboard.readText()")
    assert [line.split("\t") for line in cells.splitlines()] == [["-0.425", "0", "0"], ["-0.39225", "0", "0"]]
    tab.page.keyboard.press("Control+x")
    for row, field in itertools.product((1, 2), ("a", "alpha", "d")):
        wait_until_empty(tab, row, field)
    tab.cell(1, "a").click()
    tab.page.keyboard.press("Control+v")
    tab.wait_for_cell(2, "a", "-0.39225")
    tab.wait_for_status("the arm is the table's")


@pytest.mark.long
def test_a_click_with_shift_and_delete(tab: Any) -> None:
    """The cells from one click to the next are chosen; Delete empties them, and undo brings all of them back."""
    tab.open("ur5")
    tab.cell(0, "d").click()
    tab.cell(5, "d").click(modifiers=["Shift"])
    tab.page.wait_for_function("document.querySelectorAll('.dh-table .ag-cell.dh-range').length === 6")
    tab.page.keyboard.press("Delete")
    wait_until_empty(tab, 5, "d")
    tab.page.keyboard.press("Control+z")
    tab.wait_for_cell(5, "d", "0.0823")


@pytest.mark.long
def test_all_cells_are_copied(tab: Any) -> None:
    """With Ctrl+A, or by drawing the mouse over them with its button held."""
    tab.open("scara")
    copy_text(tab, "")
    tab.cell(0, "a").hover()
    tab.page.mouse.down()
    tab.cell(1, "alpha").hover()
    tab.cell(2, "d").hover()
    tab.page.mouse.up()
    tab.cell(3, "joint").hover()
    tab.expect(tab.page.locator(".dh-table .ag-cell.dh-range")).to_have_count(9)
    tab.page.keyboard.press("Control+c")
    tab.page.wait_for_function("navigator.clipboard.readText().then(text => text.split('\\n').length === 3)")
    assert tab.page.evaluate("navigator.clipboard.readText()").startswith("0.4\t0\t")
    tab.cell(0, "a").click()
    tab.page.keyboard.press("Control+a")
    tab.page.keyboard.press("Control+c")
    tab.page.wait_for_function("navigator.clipboard.readText().then(text => text.split('\\n').length === 4)")
    assert tab.page.evaluate("navigator.clipboard.readText()").startswith("shoulder\t")


@pytest.mark.long
def test_a_header_is_understood(tab: Any) -> None:
    """A pasted table with header, units and decimal commas is what the CSV reader makes of it; the page asks once."""
    tab.open()
    tab.page.get_by_label("number of axes").fill("1")
    tab.page.keyboard.press("Enter")
    paste(tab, 0, "a", "# convention: standard\nalpha [deg];a [mm];d [mm]\n90;0,5;120\n0;300;0\n")
    tab.page.get_by_role("button", name="Open it in place of this table").click()
    tab.wait_for_status("2 axes; the arm is the table's")
    tab.wait_for_cells(0, alpha="90", d="120")

    # A convention that was chosen is that of a pasted table which names none.
    paste(tab, 0, "a", "a\talpha\td\n0.1\tpi/2\t0.2\n0.3\t0\t0\n0.4\t0\t0\n")
    tab.page.locator(".q-dialog").get_by_text("clipboard: 3 rows, standard, read as a CSV file is").wait_for()
    for units in (
        "lengths in mm, angles in rad",
        "lengths in m, angles in rad",
    ):  # the page has mm and deg: pi/2 is none
        tab.page.get_by_role("button", name=f"Open it in place of this table: {units}").hover()
    tab.page.get_by_role("button", name=f"Open it in place of this table: {units}").click()
    tab.wait_for_status("3 axes; the arm is the table's")
    tab.expect(tab.page.get_by_role("button", name="m", exact=True)).to_have_attribute("aria-pressed", "true")


TEXTS = {
    "commas": "0.1, pi/2, 0.2\n0.3, 0, 0",
    "Markdown": "| 0.1 | pi/2 | 0.2 |\n| 0.3 | 0 | 0 |",
    "decimal commas": "0,1;pi/2;0,2\n0,3;0;0",
}


@pytest.mark.long
def test_cells_of_a_text(tab: Any) -> None:
    """Cells of CSV files, of Markdown and with decimal commas go to cells of their own, and nobody is asked."""
    tab.open()
    for text in TEXTS.values():
        begin(tab, 1)
        paste(tab, 0, "a", text)
        tab.wait_for_status("2 axes; the arm is the table's")
        tab.wait_for_cells(0, a="0.1", alpha="pi/2", d="0.2")
        tab.wait_for_cells(1, a="0.3", alpha="0", d="0")


@pytest.mark.long
def test_a_picture_empties_no_cell(tab: Any) -> None:
    """A clipboard without a text was read as an empty one. A copied cell that is empty does empty the others."""
    tab.open("ur5")
    tab.page.evaluate(
        """async () => {
            const canvas = Object.assign(document.createElement("canvas"), {width: 4, height: 4});
            const picture = await new Promise(done => canvas.toBlob(done));
            await navigator.clipboard.write([new ClipboardItem({"image/png": picture})]);
        }"""
    )
    tab.cell(1, "a").click()
    tab.page.keyboard.press("Control+v")
    tab.page.get_by_text("the clipboard holds no text").wait_for()
    assert tab.cells(1, "a") == ["-0.425"]
    tab.cell(1, "theta").click()
    tab.page.keyboard.press("Control+c")
    tab.cell(1, "a").click()
    tab.page.keyboard.press("Control+v")
    wait_until_empty(tab, 1, "a")


@pytest.mark.long
def test_an_empty_table_takes_what_is_pasted(tab: Any) -> None:
    """Wherever the cursor is: a whole table is there at once, and a number is a number. Columns of an unknown order are asked about."""
    page = tab.open()
    page.locator(".studio-axes input:focus").wait_for()
    for text, columns, status, cells in (
        (
            "# convention: standard\nalpha [deg];a [mm];d [mm]\n90;0,5;120\n",
            "",
            "1 axis; the arm is the table's",
            {"alpha": "90", "d": "120"},
        ),
        ("0.1\tpi/2\t0.2\n0.3\t0\t0\n", "a, α, d", "1 problem", {"a": "0.1", "alpha": "pi/2", "d": "0.2"}),
        (
            "q1\t0.2\t0.1\t2π/3\nq2\t0\t0.3\t0\n",
            "θ, d, a, α",
            "1 problem",
            {"joint": "joint_1", "a": "0.1", "alpha": "2*π/3", "d": "0.2", "theta": "q1"},
        ),
        (
            "waist 1\tP\t0.1\t0\t0.2",
            "name, type, a, α, d",
            "1 problem",
            {"joint": "waist 1", "type": "P", "a": "0.1", "d": "0.2"},
        ),
    ):
        copy_text(tab, text)
        page.keyboard.press("Control+v")
        if columns:
            page.get_by_role("dialog").get_by_role("button", name=columns, exact=True).click()
        tab.wait_for_status(status)
        tab.wait_for_cells(0, **cells)
        page.get_by_role("button", name="New", exact=True).click()
        tab.wait_for_status("choose the number of axes, or paste a table")
        page.locator(".arm-view").click()  # the cursor is in no field
    copy_text(tab, "# convention: foo\na,alpha,d\n1,2,3\n")
    page.keyboard.press("Control+v")
    page.get_by_text("What you paste may be misread").wait_for()
    page.get_by_role("button", name="Cancel").click()
    copy_text(tab, "3")
    page.get_by_label("number of axes").click()
    page.keyboard.press("Control+v")
    page.keyboard.press("Enter")
    page.wait_for_function(f"{ROWS} === 3")


@pytest.mark.long
def test_cells_without_a_place_are_told(tab: Any) -> None:
    """What is wider than the table is put in as far as it goes, and the page says what is left."""
    tab.open("ur5")
    last = tab.page.evaluate(
        "[...document.querySelectorAll('.dh-table .ag-header-cell')].at(-1).getAttribute('col-id')"
    )
    paste(tab, 0, last, "1\t2\t3")
    tab.page.get_by_text("2 cells find no place").wait_for()
    tab.wait_for_cell(0, last, "1")


# --- The camera -------------------------------------------------------------------------------------------------------

ALL_IN_VIEW = """() => {
    const view = document.querySelector('.arm-view'), {scene, camera} = view;
    camera.updateMatrixWorld();
    const points = [];
    scene.traverse(part => {
        if (!part.isMesh || !part.visible || !['links', 'frames'].includes(part.userData.layer)) return;
        const {array, count} = part.geometry.attributes.position;
        for (let i = 0; i < count; i++)
            points.push(camera.position.clone().fromArray(array, 3 * i).applyMatrix4(part.matrixWorld).project(camera));
    });
    const span = axis => Math.max(...points.map(p => p[axis])) - Math.min(...points.map(p => p[axis]));
    return points.every(({x, y}) => Math.abs(x) < 1 && Math.abs(y) < 1) && Math.max(span('x'), span('y')) > 0.5;
}"""


WIDTHS = """() => {
    const view = document.querySelector('.arm-view'), {scene, camera} = view, widths = [];
    scene.traverse(part => {
        if (part.userData.layer !== 'links' || !part.isMesh || part.geometry.type !== 'CylinderGeometry') return;
        const centre = camera.position.clone().setFromMatrixPosition(part.matrixWorld);
        const radius = camera.position.clone().setFromMatrixColumn(part.matrixWorld, 0).length();
        const tall = 2 * Math.tan(camera.fov * Math.PI / 360) * centre.distanceTo(camera.position);
        widths.push(2 * radius / tall * view.clientHeight);
    });
    return widths;
}"""


@pytest.mark.long
def test_the_camera_follows_what_is_typed(tab: Any) -> None:
    """An arm that grows tenfold in a cell, and one of which a window shows less, stay in the picture, arrows included."""
    tab.open("ur5")
    tab.page.wait_for_function(ALL_IN_VIEW)
    for text in ("-4", "-0.1"):
        tab.type_into(1, "a", text)
        tab.settle()
        tab.page.wait_for_function(ALL_IN_VIEW)
    aspect = "document.querySelector('.arm-view').camera.aspect"
    before = tab.page.evaluate(aspect)
    tab.page.set_viewport_size({"width": 820, "height": 1180})
    tab.page.wait_for_function(f"before => {aspect} !== before", arg=before)
    tab.page.wait_for_function(ALL_IN_VIEW)


@pytest.mark.long
def test_the_camera_stays_where_a_person_looks(tab: Any) -> None:
    """Who has come near a part of the arm goes on looking at it while cells change."""
    tab.open("ur5")
    tab.page.wait_for_function(ALL_IN_VIEW)
    box = tab.page.locator(".arm-view").bounding_box()
    tab.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    tab.page.evaluate("window.wheeled = 0, addEventListener('wheel', ({ deltaY }) => (wheeled += deltaY))")
    for _ in range(12):
        tab.page.mouse.wheel(0, -300)
    tab.page.wait_for_function("wheeled === -3600")
    tab.page.wait_for_function(f"!({ALL_IN_VIEW})()")
    camera = "document.querySelector('.arm-view').camera.position.toArray()"
    before = tab.page.evaluate(camera)
    with tab.another_drawing():
        tab.type_into(1, "a", "-0.43")
    assert tab.page.evaluate(camera) == pytest.approx(before, abs=0.05)


def test_the_reach_holds_where_joints_slide(tab: Any) -> None:
    """Of the Stanford arm, whatever the pose: tool0 is no farther than the page says it can be."""
    tab.open("stanford")
    sliders = tab.page.locator(".joint-slider-number")
    sliders.nth(2).fill("99")
    sliders.nth(2).press("Enter")
    tab.page.wait_for_function("document.querySelectorAll('.joint-slider input[type=range]')[2].valueAsNumber > 0.5")
    tab.page.wait_for_function(
        """() => {
            const [distance, reach] = [...document.querySelectorAll('.studio-numbers b')].slice(-2).map(b => Number(b.textContent));
            return distance > 0.7 && distance <= reach;
        }"""
    )


# --- The connection ---------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_the_server_goes_and_another_comes(
    serving: Callable[..., Any], new_tab: Callable[..., Any], free_port: int
) -> None:
    """While it is away nothing can be typed and the page says why; the next server is given the table back.

    A reload during the question does not lose the table.
    """
    with serving("studio", port=free_port) as address:
        tab = new_tab(address, faults=False)
        page = tab.open("ur5")

        # The same server again, which was suspended: NiceGUI loads the page anew. The cell that was being typed is there.
        tab.type_into(0, "d", "0.77")
        page.wait_for_function("dhPage.kept().includes('0.77')")
        tab.cell(1, "d").click()
        page.keyboard.type("0.123")
        page.evaluate("socket.disconnect()")
        page.get_by_text("The studio does not answer").wait_for()
        assert not page.locator("#popup").is_visible()
        page.reload()
        tab.wait_for_cells(1, d="0.123")
        tab.wait_for_cells(0, d="0.77")
        page.get_by_role("button", name="undo").click()
        tab.wait_for_cells(1, d="0")
        page.reload()  # It is given back once.
        tab.wait_for_cells(0, d="0.77")
        tab.wait_for_cells(1, d="0")
        tab.type_into(1, "a", "-0.77")
        page.wait_for_function("dhPage.kept().includes('-0.77')")  # The cell shows it before the server knows it.
        tab.cell(2, "a").click()
        page.keyboard.type("-0.3")  # and not finished
    page.get_by_text("The studio does not answer").wait_for()
    assert page.evaluate("document.querySelector('.studio').inert")
    with serving("studio", port=free_port):
        page.get_by_role("button", name="Bring it back").wait_for()
        page.reload()
        page.get_by_role("button", name="Bring it back").click()
        tab.wait_for_cell(1, "a", "-0.77")
        tab.wait_for_cells(2, a="-0.3")
        tab.wait_for_status("6 axes; the arm is the table's")
        assert not page.evaluate("document.querySelector('.studio').inert")


# --- A telephone ------------------------------------------------------------------------------------------------------


@pytest.mark.long
def test_a_telephone(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """At 390 px every button of the head can be reached, Generate too, and nothing hangs over at the side."""
    tab = new_tab(studio_address, width=390, height=844)
    page = tab.open("ur5")
    page.wait_for_function("document.documentElement.scrollWidth <= 390")
    for name in ("New", "Open", "Save", "Generate", "undo", "redo"):
        box = page.get_by_role("button", name=name, exact=True).bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= 390
    with page.expect_download() as generating:
        page.get_by_role("button", name="Generate").click()
    assert generating.value.suggested_filename == "ur5.urdf"


# --- The way through the page by keyboard -----------------------------------------------------------------------------


@pytest.mark.long
def test_the_table_is_one_stop(tab: Any) -> None:
    """Tab goes into the table and out of it at once; arrows lead from cell to cell, and while a cell is typed, Tab does."""
    tab.open("ur5")
    tab.cell(2, "a").click()
    inside = "Boolean(document.activeElement.closest('.dh-table'))"
    assert tab.page.evaluate(inside)
    tab.page.keyboard.press("Tab")
    assert not tab.page.evaluate(inside)
    tab.page.get_by_role("button", name="show all columns, or those in use").focus()
    tab.page.keyboard.press("Tab")  # to a cell, and to no header before
    assert tab.page.evaluate("Boolean(document.activeElement.closest('.dh-table .ag-cell'))")
    tab.page.keyboard.press("Tab")
    assert not tab.page.evaluate(inside)
    tab.page.keyboard.press("Shift+Tab")
    assert tab.page.evaluate(inside)
    tab.page.keyboard.press("Shift+Tab")
    assert not tab.page.evaluate(inside)
    tab.page.keyboard.press("Tab")
    assert tab.page.evaluate(inside)
    convention = tab.page.get_by_role("button", name="modified")
    convention.focus()
    tab.page.keyboard.press("Enter")
    tab.page.locator(".studio-card h2").wait_for()
    tab.page.keyboard.press("Escape")
    tab.page.wait_for_function("document.activeElement.innerText === 'modified'")  # it is where it was before

    # Where the cursor is, is seen: on buttons, boxes to tick, fields, the scene and sliders.
    ringless = []
    tab.page.get_by_role("button", name="undo").focus()
    for _ in range(60):
        tab.page.keyboard.press("Tab")
        name, seen = tab.page.evaluate(
            """() => {
                const at = document.activeElement, field = at.closest('.q-field__control, .ag-cell');
                const ring = getComputedStyle(at), around = field && getComputedStyle(field, field.matches('.q-field__control') ? '::after' : null);
                const drawn = style => style && (style.outlineStyle === 'solid' || parseFloat(style.borderTopWidth) > 0);
                return [at.getAttribute('aria-label') || at.innerText, drawn(ring) || drawn(around)];
            }"""
        )
        if not seen:
            ringless.append(name)
        if name == "shoulder_pan_joint in rad":
            break
    assert name == "shoulder_pan_joint in rad"
    assert ringless == []


@pytest.mark.long
def test_row_numbers_are_whole(tab: Any) -> None:
    """Of a hundred rows, the number of the last is not cut."""
    tab.open()
    tab.page.get_by_label("number of axes").fill("100")
    tab.page.keyboard.press("Enter")
    tab.page.wait_for_function("document.querySelectorAll('.dh-table .ag-cell[col-id=number]').length > 5")
    tab.page.evaluate("document.querySelector('.dh-table .ag-body-viewport').scrollTop = 1e6")
    number = tab.page.locator(".dh-table .ag-row[row-index='99'] .ag-cell[col-id='number'] .ag-cell-value")
    tab.expect(number).to_have_text("100")
    tab.page.wait_for_function("cell => cell.scrollWidth <= cell.clientWidth", arg=number.element_handle())


@pytest.mark.long
def test_a_pi_of_a_mac_begins_a_cell(tab: Any) -> None:
    """Option+P is a letter and no command. A cell whose text may be cut has it as its tooltip."""
    tab.open("ur5")
    tab.cell(2, "alpha").click()
    keys = tab.page.context.new_cdp_session(tab.page)
    for kind in ("keyDown", "keyUp"):
        text = {"text": "π"} if kind == "keyDown" else {}
        keys.send("Input.dispatchKeyEvent", {"type": kind, "modifiers": 1, "key": "π", "code": "KeyP", **text})
    tab.page.wait_for_function("document.activeElement.value === 'π'")
    tab.page.keyboard.type("/2")
    tab.page.keyboard.press("Enter")
    tab.wait_for_cell(2, "alpha", "π/2")
    tab.wait_for_status("the arm is the table's")
    assert tab.cell(0, "joint").get_attribute("title") == "shoulder_pan_joint"


@pytest.mark.long
def test_the_first_key_pays_for_nothing_else(tab: Any) -> None:
    """Once the page rests, the first letter in a cell compiles no shader, and no letter has all of the page laid out."""
    tab.open("ur5")
    view = "getElement(Number(document.querySelector('.arm-view').id.slice(1)))"
    tab.page.wait_for_function(f"{view}.rehearsed")
    tab.page.evaluate("window.updates = 0, socket.on('update', () => updates++)")
    shaders = f"{view}.renderer.info.programs.length"
    before, shown = tab.page.evaluate(shaders), tab.page.evaluate("document.querySelector('.arm-view').shown")
    tab.cell(2, "a").click()
    tab.page.locator(".arm-view-picked").first.wait_for()
    tab.settle()
    tab.page.evaluate("updates = 0")
    tab.page.keyboard.type("-0.4")
    tab.page.wait_for_function("shown => document.querySelector('.arm-view').shown > shown", arg=shown)
    tab.page.wait_for_function("document.querySelector('.studio-matrix').innerText.includes('-0.8250')")
    assert tab.page.evaluate("updates") == 0
    assert tab.page.evaluate(shaders) == before


# --- What is said and shown -------------------------------------------------------------------------------------------


@pytest.mark.long
def test_the_page_speaks_of_its_switches(tab: Any) -> None:
    """Where a file would need a line or the command line an option, the page has a button, and the message names it."""
    tab.open("ur5")
    tab.type_into(1, "alpha", "90")
    tab.page.get_by_text("if these are degrees, press deg").wait_for()
    tab.type_into(1, "alpha", "0")
    tab.type_into(1, "a", "425")
    tab.page.get_by_text("if its lengths are in mm, press mm").wait_for()


@pytest.mark.long
def test_a_joint_box_takes_what_a_cell_takes(tab: Any) -> None:
    """An expression, degrees, a number; what is none is marked with the reason and stays, and the arm stays too."""
    tab.open("ur5")
    box, slider = tab.page.locator(".joint-slider-number").first, ".joint-slider input[type=range]"
    limits = tab.page.locator(".joint-slider").first.get_attribute("title")
    assert limits == "shoulder_pan_joint: -6.2832 to 6.2832 rad"
    for text, value in (("pi/2", 1.5707963), ("-45°", -0.7853982), ("0.25", 0.25)):
        box.fill(text)
        box.press("Enter")
        tab.page.wait_for_function(
            f"value => Math.abs(document.querySelector('{slider}').valueAsNumber - value) < 1e-6", arg=value
        )
    box.fill("0.25")  # no change to the browser
    box.blur()
    tab.press("zero")
    tab.page.wait_for_function("document.querySelector('.joint-slider-number').value === '0'")
    box.fill("pi/x")
    box.press("Enter")
    tab.page.locator(".joint-slider-number[aria-invalid=true]").wait_for()
    tab.expect(box).to_have_attribute("title", re.compile("'x' is no number"))
    assert box.input_value() == "pi/x"
    assert tab.sliders()[0] == 0.0
    for text in ("0x10", "0b11", "1e-400"):  # numbers to JavaScript, and none to a cell
        box.fill(text)
        box.press("Enter")
        tab.page.wait_for_function(
            "text => document.querySelector('.joint-slider-number').title.includes(text)", arg=text
        )
        assert tab.sliders()[0] == 0.0


@pytest.mark.long
def test_the_camera_by_keyboard(tab: Any) -> None:
    """Arrows turn it, plus brings it nearer, 0 sees all again."""
    tab.open("ur5")
    distance = "(({camera, scene}) => camera.position.length())(document.querySelector('.arm-view'))"
    position = "document.querySelector('.arm-view').camera.position.toArray()"
    tab.page.locator(".arm-view").focus()
    before = tab.page.evaluate(position)
    tab.page.keyboard.press("ArrowRight")
    assert tab.page.evaluate(position) != pytest.approx(before, abs=1e-3)
    far = tab.page.evaluate(distance)
    for _ in range(10):
        tab.page.keyboard.press("+")
    assert tab.page.evaluate(distance) < far
    tab.page.keyboard.press("0")
    tab.page.wait_for_function(ALL_IN_VIEW)


@pytest.mark.long
def test_more_axes_than_there_may_be(tab: Any) -> None:
    tab.open()
    tab.page.get_by_label("number of axes").fill("1001")
    tab.page.keyboard.press("Enter")
    tab.page.get_by_text("at most 1000 rows: these are the first of 1001").wait_for()
    assert tab.page.get_by_label("number of axes").evaluate("field => field.scrollWidth <= field.clientWidth")


@pytest.mark.long
def test_arms_of_any_size_are_seen(tab: Any) -> None:
    """Of 1 mm, of 50 m and of none: the picture holds the arm, and its links are wider than a pixel."""
    tab.open()
    for a, d in (("0.3 mm", "0.1 mm"), ("10", "1"), ("0", "0")):
        begin(tab, 5)
        paste(tab, 0, "a", "\n".join(f"{a}\tpi/2\t{d}" for _ in range(5)))
        tab.wait_for_status("5 axes; the arm is the table's")
        tab.page.wait_for_function(ALL_IN_VIEW)
        widths = tab.page.evaluate(WIDTHS)
        assert min(widths) > 1.5, (a, d)


@pytest.mark.long
def test_a_large_file_is_read_in_sight(tab: Any, tmp_path: Path) -> None:
    """While a large file is read the page says so; a person who goes on without it is not disturbed."""
    tab.open()
    large = tmp_path / "many.csv"
    rows = "".join(f"r{number},0.1,0,0\nr{number},0.2,pi/2,0\n" for number in range(60_000))
    large.write_text(f"# convention: standard\nrobot,a,alpha,d\n{rows}")
    tab.page.get_by_role("button", name="Open", exact=True).click()
    tab.page.locator("[role=dialog] input[type=file]").set_input_files(large)
    tab.page.get_by_text("reading many.csv").wait_for()
    tab.page.locator(".q-dialog").get_by_role("button", name="Cancel").click()
    tab.page.locator(".q-dialog").wait_for(state="detached")
    tab.open_from_gallery("ur5")
    assert tab.page.get_by_text("The studio failed at this").count() == 0
    assert tab.status == "6 axes; the arm is the table's"


@pytest.mark.long
def test_a_tab_that_is_closed_during_a_dialog(
    serving: Callable[..., Any], new_tab: Callable[..., Any], tmp_path: Path
) -> None:
    """Nothing is left to answer: the server forgets the dialogs, without a stack trace."""
    errors = tmp_path / "errors.txt"
    with serving("studio", TABLES / "ur5.csv", errors=errors, patience=1.0) as address:
        for button, told in (
            ("Open", "or one of the gallery"),
            ("deg", "To other units"),
            ("modified", "To the convention"),
        ):
            page = new_tab(address).open()
            page.get_by_role("button", name=button, exact=True).click()
            page.locator(".q-dialog").get_by_text(told).wait_for()
            page.close()
        time.sleep(2.0)  # the server waits one second for a tab to come back
    assert errors.read_text("utf-8") == "dh2urdf: interrupted; nothing half-written is left\n"  # which ends it


@pytest.mark.long
def test_a_page_that_is_left_while_it_loads(
    serving: Callable[..., Any], new_tab: Callable[..., Any], tmp_path: Path
) -> None:
    """Loaded anew or closed at once: the terminal had a stack trace for each."""
    errors = tmp_path / "errors.txt"
    with serving("studio", TABLES / "ur5.csv", errors=errors, patience=1.0) as address:
        for pause in (100, 300, 600, 1000):
            page = new_tab(address, faults=False).page
            page.goto(address)
            page.wait_for_timeout(pause)
            page.reload(wait_until="commit")
            page.wait_for_timeout(pause)
            page.close()
        time.sleep(12.0)  # the server waits ten seconds for the first answer of a page
    assert errors.read_text("utf-8") == "dh2urdf: interrupted; nothing half-written is left\n"


@pytest.mark.long
def test_what_is_typed_stays_with_its_table(tab: Any) -> None:
    """A file is dropped while a cell is typed: the text went into the same cell of the table that was dropped."""
    tab.open("scara")
    tab.cell(1, "a").click()
    tab.page.keyboard.type("0.123")
    tab.drop(".studio-table", TABLES / "ur5.csv")
    tab.wait_for_table("ur5")
    tab.wait_for_cell(1, "a", "-0.425")
    tab.page.locator(".studio-status").first.click()
    tab.page.get_by_role("button", name="undo", exact=True).click()
    tab.wait_for_table("scara")
    tab.wait_for_cell(1, "a", "0.123")


@pytest.mark.long
def test_what_the_reader_noticed_is_shown(tab: Any, tmp_path: Path) -> None:
    """A column that means nothing is not in the table on the page; the page says that it was ignored."""
    tab.open()
    path = tmp_path / "arm.csv"
    path.write_text("# convention: standard\na,alpha,d,cable\n1,0,0,red\n")
    tab.page.get_by_role("button", name="Open", exact=True).click()
    tab.page.locator("[role=dialog] input[type=file]").set_input_files(path)
    tab.page.locator(".q-notification", has_text="cable").wait_for()


ON_A_PAGE = """<p>DH parameters (mm, deg)</p><table border=1>
<tr><th>Joint</th><th>a<sub>i</sub></th><th>α<sub>i</sub></th><th>d<sub>i</sub></th></tr>
<tr><td>1</td><td>0</td><td>90<sup>o</sup></td><td>%s</td></tr>
<tr><td>2</td><td rowspan=2>425</td><td>0<br></td><td>0</td></tr>
<tr><td>3</td><td>0</td><td>7</td></tr></table><p>1: without the flange</p>"""


@pytest.mark.long
@pytest.mark.parametrize(("d", "pasted"), [("89<sup>1</sup>", "89^1"), ("89", "89"), ("2·10<sup>-3</sup>", "2·10^-3")])
def test_a_table_is_copied_from_a_page(studio_address: str, new_tab: Callable[..., Any], d: str, pasted: str) -> None:
    """Chromium copies a raised 1 as one digit more, and no cells below one that spans rows: 89 was 891, and α was in a."""
    tab = new_tab(studio_address)
    tab.open()
    other = tab.page.context.new_page()
    other.set_content(ON_A_PAGE % d)
    other.keyboard.press("Control+a")
    other.keyboard.press("Control+c")
    other.close()
    tab.page.bring_to_front()
    tab.page.get_by_label("number of axes").click()
    tab.page.keyboard.press("Control+v")
    for row, cells in enumerate((("0", "90°", pasted), ("425", "0", "0"), ("", "0", "7"))):
        tab.wait_for_cells(row, **dict(zip(("a", "alpha", "d"), cells, strict=True)))
    tab.wait_for_status("problem")  # no cell is filled in, and no power is read


@pytest.mark.long
def test_many_notices_fit_into_the_window(tab: Any, example_robots: Path) -> None:
    """The first lines of an xArm's were above the window, and all of the page was below the others."""
    page = tab.open()
    tab.drop(".arm-view", example_robots / "xarm_description" / "urdf" / "xarm7.urdf")
    shown = page.locator(".q-notification")
    shown.wait_for()
    shown.get_by_text("the table is the chain from").hover()
    tab.settle()
    box = shown.bounding_box()
    assert box is not None
    assert box["y"] > 0.4 * 720
    assert box["height"] < 0.6 * 720
    message = shown.locator(".q-notification__message")
    assert message.evaluate("message => message.scrollHeight > message.clientHeight")
    page.mouse.wheel(0, 10_000)
    page.wait_for_function("document.querySelector('.q-notification__message').scrollTop > 0")
    shown.get_by_role("button", name="Close").click()
    shown.wait_for(state="detached")
