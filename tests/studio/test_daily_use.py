"""What people do all day in the studio, in a real browser: undo, copy, cut, paste, look, and lose the connection."""

import csv
import itertools
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.kinematics import forward_kinematics
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import Catalog

pytestmark = pytest.mark.long
TABLES = Path(__file__).parents[2] / "configs" / "tables"
ROWS = "document.querySelectorAll('.dh-table .ag-center-cols-container .ag-row').length"


def copy_text(tab: Any, text: str) -> None:
    """Puts a text into the clipboard, as another program would."""
    tab.page.evaluate("text => navigator.clipboard.writeText(text)", text)


def paste(tab: Any, row: int, field: str, text: str) -> None:
    copy_text(tab, text)
    tab.cell(row, field).click()
    tab.page.keyboard.press("Control+v")


# --- Undo -------------------------------------------------------------------------------------------------------------


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


# --- The clipboard ----------------------------------------------------------------------------------------------------


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
        tab.cell(row, field).filter(has_text=re.compile(r"^\s*$")).wait_for()
    tab.cell(1, "a").click()
    tab.page.keyboard.press("Control+v")
    tab.wait_for_cell(2, "a", "-0.39225")
    tab.wait_for_status("the arm is the table's")


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
        (
            "q1\t0.2\t0.1\t2π/3\nq2\t0\t0.3\t0\n",
            "θ, d, a, α",
            "1 problem",
            {"joint": "joint_1", "a": "0.1", "alpha": "2π/3", "d": "0.2", "theta": "q1"},
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


# --- The connection ---------------------------------------------------------------------------------------------------


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


# --- The way through the page by keyboard -----------------------------------------------------------------------------


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


# --- What is said and shown -------------------------------------------------------------------------------------------


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
    tab.expect(box).to_have_attribute("title", re.compile("'x' is not defined"))
    assert box.input_value() == "pi/x"
    assert tab.sliders()[0] == 0.0
    box.fill("0x10")  # a number to JavaScript, and none to a cell
    box.press("Enter")
    tab.page.wait_for_function("document.querySelector('.joint-slider-number').title.includes('0x10')")
    assert tab.sliders()[0] == 0.0


ON_A_PAGE = """<p>DH parameters (mm, deg)</p><table border=1>
<tr><th>Joint</th><th>a<sub>i</sub></th><th>α<sub>i</sub></th><th>d<sub>i</sub></th></tr>
<tr><td>1</td><td>0</td><td>90<sup>o</sup></td><td>%s</td></tr>
<tr><td>2</td><td>425</td><td>0<br></td><td>0</td></tr>
<tr><td>3</td><td>425</td><td>0</td><td>7</td></tr></table><p>1: without the flange</p>"""


@pytest.mark.parametrize("d", ["89<sup>1</sup>", "89"])
def test_a_table_is_copied_from_a_page(tab: Any, d: str) -> None:
    """Chromium copies a raised 1 as one digit more: 89 was 891. A person is asked. The units are those of the line above it."""
    tab.open()
    other = tab.page.context.new_page()
    other.set_content(ON_A_PAGE % d)
    other.keyboard.press("Control+a")
    other.keyboard.press("Control+c")
    other.close()
    tab.page.bring_to_front()
    tab.page.get_by_label("number of axes").click()
    tab.page.keyboard.press("Control+v")
    if d == "89":
        for row, cells in enumerate((("0", "pi/2", "0.089"), ("0.425", "0", "0"), ("0.425", "0", "0.007"))):
            tab.wait_for_cells(row, **dict(zip(("a", "alpha", "d"), cells, strict=True)))
    else:
        tab.page.get_by_role("dialog").get_by_text("'89^1' cannot be read").wait_for()


# --- The paper's job by keyboard alone ------------------------------------------------------------------------------------


def ur5_cells() -> list[list[str]]:
    """a, alpha and d of the UR5 as its table has them."""
    lines = [line for line in (TABLES / "ur5.csv").read_text().splitlines() if not line.startswith("#")]
    return [[row[key].strip() for key in ("a", "alpha", "d")] for row in csv.DictReader(lines, skipinitialspace=True)]


def test_the_ur5_by_keyboard(tab: Any, cli: Callable[..., Any], tmp_path: Path, catalog: Catalog) -> None:
    """Number of axes, convention, a, α and d by keyboard; the pose is the DH product, and the URDF that of `convert`."""
    page = tab.open()
    keys = page.keyboard
    keys.type("6")
    keys.press("Enter")
    page.wait_for_function("document.querySelectorAll('.dh-table .ag-center-cols-container .ag-row').length === 6")
    keys.press("Tab")
    keys.press("Space")
    page.wait_for_function("document.activeElement.getAttribute('col-id') === 'a'")
    for a, alpha, d in ur5_cells():
        keys.type(a)
        keys.press("Tab")
        keys.type(alpha)
        keys.press("Tab")
        keys.type(d)
        keys.press("Enter")
    tab.wait_for_status("6 axes; the arm is the table's")
    tab.wait_for_cells(1, **dict(zip(("a", "alpha", "d"), ur5_cells()[1], strict=True)))

    name, content = tab.save("Table as csv")
    table = tmp_path / name
    table.write_bytes(content)
    reader = catalog.reader_for(table)
    (arm,) = reader.read(table, reader.options())
    assert isinstance(arm, Manipulator)

    sliders = page.locator(".joint-slider input[type=range]")
    for index in range(6):
        sliders.nth(index).focus()
        for _ in range(index + 1):
            keys.press("Shift+ArrowRight" if index % 2 else "Shift+ArrowLeft")
    q = tab.sliders()
    assert len({abs(value) for value in q}) == 6
    tab.wait_for_pose("tool0", forward_kinematics(arm, q))
    tab.wait_for_pose("frame 6", forward_kinematics(arm, q))

    with page.expect_download() as generating:
        page.keyboard.press("Control+Enter")
    assert generating.value.suggested_filename == "arm.urdf"
    made = cli("convert", table)
    assert generating.value.path().read_bytes() == made.stdout.encode()
