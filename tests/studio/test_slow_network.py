"""A person who is faster than the network: what is done while answers are on their way is neither lost nor undone."""

from __future__ import annotations

from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf_studio import gallery
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.keeping import kept_text
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf.plugin_system import Catalog

TABLES = Path(__file__).parents[2] / "configs" / "tables"
HELD = """{
    // While `held` is true, what the server sends waits, in its order, and so does all `from` a message with a text on;
    // while `lost` is true, nothing that the page sends arrives, and it arrives `late` by so many milliseconds.
    const answers = window.answers = { held: false, from: "", lost: false, late: 0, sending: 0, waiting: [], pass(count = Infinity) {
        for (const act of this.waiting.splice(0, count)) act();
    } };
    const own = Object.getOwnPropertyDescriptor(WebSocket.prototype, "onmessage");
    Object.defineProperty(WebSocket.prototype, "onmessage", { ...own, set(handler) {
        own.set.call(this, (event) => {
            const act = Object.assign(() => handler.call(this, event), { text: String(event.data) });
            answers.held ||= Boolean(answers.from) && act.text.includes(answers.from);
            answers.held || answers.waiting.length ? answers.waiting.push(act) : act();
        });
    } });
    const { send } = WebSocket.prototype;
    WebSocket.prototype.send = function (data) {
        if (answers.lost) return;
        answers.sending += 1;
        setTimeout(() => {
            answers.sending -= 1;
            if (this.readyState === WebSocket.OPEN) send.call(this, data); // else it is lost with the connection
        }, answers.late);
    };
}"""


class Network:
    """The way between a page and its server, on which answers can be held back, and what is sent can be lost."""

    def __init__(self, page: Any) -> None:
        self.page = page

    def hold(self) -> None:
        """From now on answers wait."""
        self.page.evaluate("answers.held = true")

    def wait_for(self, text: str) -> int:
        """Waits until an answer with a text is held back; gives how many are."""
        script = "text => answers.waiting.some(act => act.text.includes(text)) && answers.waiting.length"
        return int(self.page.wait_for_function(script, arg=text).json_value())

    def release(self) -> None:
        """Lets all answers through."""
        self.page.evaluate("answers.held = false, answers.pass()")

    def forget(self) -> None:
        """Loses all answers that are held back, with the connection; the next one works."""
        self.page.evaluate("answers.waiting.length = 0, answers.held = false, socket.io.engine.close()")

    @contextmanager
    def broken(self) -> Iterator[None]:
        """A connection over which nothing goes in the block, and which is another one afterwards."""
        self.page.evaluate("answers.lost = true")
        yield
        self.page.evaluate("answers.lost = false, socket.io.engine.close()")


@pytest.fixture
def slow(studio_address: str, new_tab: Callable[..., Any]) -> Iterator[tuple[Any, Network]]:
    """A tab with a UR5, and its network."""
    tab = new_tab(studio_address)
    tab.page.add_init_script(HELD)
    tab.open("ur5")
    yield tab, Network(tab.page)
    tab.page.close()  # what it holds back is for these tests only


@pytest.mark.long
def test_a_row_goes_on_up(slow: tuple[Any, Network]) -> None:
    """A key that is held down moves one row, though the answer to its first move comes after its second."""
    tab, network = slow
    tab.cell(5, "d").click()
    network.hold()
    tab.page.keyboard.press("Alt+ArrowUp")
    count = network.wait_for("dhGrid.mark")
    tab.page.keyboard.press("Alt+ArrowUp")
    tab.page.evaluate("count => answers.pass(count)", count)
    tab.page.keyboard.press("Alt+ArrowUp")
    network.release()
    tab.wait_for_cells(2, joint="wrist_3_joint")
    tab.wait_for_cells(4, joint="wrist_1_joint")
    tab.wait_for_cells(5, joint="wrist_2_joint")


@pytest.mark.long
def test_a_new_row_is_typed_at_once(slow: tuple[Any, Network]) -> None:
    """What is typed after Alt+Insert goes into the new row, and not over the one above it; letters after the answer too."""
    tab, network = slow
    for row in (2, 6):  # in the middle, and at the end
        tab.cell(row, "alpha").click()
        network.hold()
        tab.page.keyboard.press("Alt+Insert")
        tab.page.keyboard.type("0.1")
        network.wait_for("dhGrid.mark")
        network.release()
        tab.page.keyboard.type("23")
        tab.page.keyboard.press("Enter")
        tab.wait_for_cell(row + 1, "a", "0.123")
    tab.wait_for_cells(2, joint="elbow_joint", a="-0.39225", alpha="0")
    tab.wait_for_cells(6, joint="wrist_3_joint", a="0", alpha="0")


@pytest.mark.long
@pytest.mark.parametrize(
    ("keys", "row", "joint"),
    [
        (["Delete"], 3, "wrist_2_joint"),
        (["Delete", "Delete"], 2, "wrist_2_joint"),
        (["Insert"], 3, "elbow_joint"),
        (["ArrowUp"], 1, "shoulder_pan_joint"),
        (["ArrowDown", "Delete"], 2, "wrist_1_joint"),
    ],
)
def test_a_cell_is_typed_in_the_row_that_is_on_the_screen(
    slow: tuple[Any, Network], keys: list[str], row: int, joint: str
) -> None:
    """Rows that were removed, added or moved before it have gone to their places; the text went into the row below or above."""
    tab, network = slow
    tab.cell(1, "d").click()
    network.hold()
    first, *others = keys
    tab.page.keyboard.press(f"Alt+{first}")
    count = network.wait_for("dhGrid.fill")
    for key in others:
        tab.page.keyboard.press(f"Alt+{key}")
    tab.page.evaluate("count => answers.pass(count)", count)  # the rows after the first act are those of before by now
    assert tab.cells(row, "joint") == [joint]
    tab.type_into(row, "a", "9.9")
    network.release()
    tab.wait_for_cells(row, joint=joint, a="9.9")
    tab.settle()
    tab.page.reload()
    tab.wait_for_cells(row, joint=joint, a="9.9")


def press(tab: Any, row: int, key: str) -> None:
    tab.cell(row, "a").click()
    tab.page.keyboard.press(key)


PASTE = """text => {
    const data = new DataTransfer();
    data.setData("text/plain", text);
    document.activeElement.dispatchEvent(new ClipboardEvent("paste", { clipboardData: data, bubbles: true }));
}"""


def paste(tab: Any, row: int, text: str) -> None:
    tab.cell(row, "a").click()
    tab.page.evaluate(PASTE, text)


def button(tab: Any, row: int, name: str) -> None:
    tab.cell(row, "a").click()
    tab.page.get_by_role("button", name=name).click()


ELSEWHERE: dict[str, tuple[Callable[[Any, int], None], Callable[[list[list[str]], int], object]]] = {
    "a text": (lambda tab, row: tab.type_into(row, "a", "9.9"), lambda rows, at: rows[at].__setitem__(1, "9.9")),
    "an empty cell": (lambda tab, row: press(tab, row, "Delete"), lambda rows, at: rows[at].__setitem__(1, "")),
    "a paste": (lambda tab, row: paste(tab, row, "9.9"), lambda rows, at: rows[at].__setitem__(1, "9.9")),
    "Alt+Delete": (lambda tab, row: press(tab, row, "Alt+Delete"), lambda rows, at: rows.pop(at)),
    "Alt+ArrowUp": (
        lambda tab, row: press(tab, row, "Alt+ArrowUp"),
        lambda rows, at: rows.insert(at - 1, rows.pop(at)),
    ),
    "a drag": (lambda tab, row: drag_row(tab, row, row + 1), lambda rows, at: rows.insert(at + 1, rows.pop(at))),
    "remove": (lambda tab, row: button(tab, row, "remove the row"), lambda rows, at: rows.pop(at)),
    "up": (lambda tab, row: button(tab, row, "move the row up"), lambda rows, at: rows.insert(at - 1, rows.pop(at))),
}
"""What is done to a row by its number on the screen, and to the rows of a list."""
UR5 = [["shoulder_pan", "0"], ["shoulder_lift", "-0.425"], ["elbow", "-0.39225"], *([f"wrist_{n}", "0"] for n in "123")]


def wait_for_rows(tab: Any, rows: list[list[str]]) -> None:
    """Waits until the table has these joints and lengths a, on the screen and on the server."""
    tab.settle()
    for reload in (tab.page.reload, tab.settle):
        tab.page.locator(f".dh-table [aria-rowcount='{len(rows) + 1}']").wait_for()
        for number, (joint, a) in enumerate(rows):
            tab.wait_for_cells(number, joint=f"{joint}_joint", a=a)
        reload()


@pytest.mark.long
@pytest.mark.parametrize("way", ["undo", "redo"])
@pytest.mark.parametrize("act", ELSEWHERE)
def test_what_is_done_before_an_undo_is_on_the_screen(slow: tuple[Any, Network], act: str, way: str) -> None:
    """It is done to the row of the screen; it was done to the row that had its number after the undo."""
    tab, network = slow
    press(tab, 1, "Alt+Delete")
    before, after = [UR5[0], *UR5[2:]], UR5
    if way == "redo":
        tab.page.keyboard.press("Control+z")
        before, after = after, before
    wait_for_joints(tab, [joint for joint, _ in before])
    network.hold()
    tab.page.get_by_role("button", name=way, exact=True).click()
    network.wait_for("dhGrid.fill")
    do, in_list = ELSEWHERE[act]
    do(tab, 3)
    network.release()
    rows = [list(row) for row in after]
    in_list(rows, next(at for at, row in enumerate(rows) if row[0] == before[3][0]))
    wait_for_rows(tab, rows)


@pytest.mark.long
@pytest.mark.parametrize(
    ("keys", "more", "refused"),
    [
        (["0", ".", "1", "Enter"], [], "a: 0.1"),
        (["0", ".", "1"], ["2", "Enter"], "a: 0.1"),
        (["Alt+Delete"], [], "remove"),
        (["Alt+ArrowUp"], [], "up"),
        (["Alt+Insert"], [], "add"),
        (["Delete"], [], None),
    ],
)
def test_what_is_done_to_a_row_that_is_gone(
    slow: tuple[Any, Network], keys: list[str], more: list[str], refused: str | None
) -> None:
    """It is refused in words where something would be lost, and no other row changes, though more letters follow."""
    tab, network = slow
    press(tab, 1, "Alt+Insert")
    tab.wait_for_cell(2, "joint", "joint_7")
    tab.settle()
    network.hold()
    tab.page.get_by_role("button", name="undo", exact=True).click()
    network.wait_for("dhGrid.fill")
    tab.cell(2, "a").click()
    for key in keys:
        tab.page.keyboard.press(key)
    network.release()
    if refused:
        told = tab.page.locator(".q-notification__message")
        told.wait_for()
        assert told.inner_text().splitlines()[1:] == [refused]
    for key in more:
        tab.page.keyboard.press(key)
    wait_for_rows(tab, UR5)


@pytest.mark.long
def test_cells_are_pasted_into_rows_that_are_others_by_now(slow: tuple[Any, Network]) -> None:
    """A row has come between the two that they are meant for: a message says so, and none changes."""
    tab, network = slow
    press(tab, 4, "Alt+Delete")
    wait_for_joints(tab, [*JOINTS[:4], JOINTS[5]])
    network.hold()
    tab.page.keyboard.press("Control+z")
    network.wait_for("dhGrid.fill")
    paste(tab, 3, "1\n2")
    network.release()
    tab.page.locator(".q-notification").get_by_text("paste").wait_for()
    wait_for_rows(tab, UR5)


@pytest.mark.long
def test_a_cell_is_typed_on_while_its_row_goes_elsewhere(slow: tuple[Any, Network]) -> None:
    """The letters before and after the answer to an undo are one text, in the row where they were begun."""
    tab, network = slow
    press(tab, 1, "Alt+Delete")
    wait_for_joints(tab, [JOINTS[0], *JOINTS[2:]])
    network.hold()
    tab.page.keyboard.press("Control+z")
    network.wait_for("dhGrid.fill")
    tab.cell(3, "a").click()
    tab.page.keyboard.type("0.1")
    network.release()
    tab.wait_for_cell(1, "joint", "shoulder_lift_joint")
    tab.page.keyboard.type("23")
    tab.page.keyboard.press("Enter")
    wait_for_rows(tab, [*UR5[:4], ["wrist_2", "0.123"], UR5[5]])


@pytest.mark.long
def test_a_cell_is_typed_while_another_table_is_opened(slow: tuple[Any, Network]) -> None:
    """Its rows are others, though their numbers are the same: the text is refused in words."""
    tab, network = slow
    network.hold()
    tab.page.get_by_role("button", name="New").click()
    network.wait_for("dhGrid.fill")
    tab.type_into(1, "a", "9.9")
    network.release()
    tab.page.locator(".q-notification").get_by_text("a: 9.9").wait_for()
    tab.page.get_by_role("button", name="undo", exact=True).click()
    wait_for_rows(tab, UR5)


@pytest.mark.long
def test_a_number_is_typed_below_an_old_header(slow: tuple[Any, Network]) -> None:
    """425 below `a [mm]` is no 425 m, though the undo that brings the metres back was sent before it."""
    tab, network = slow
    tab.page.get_by_role("button", name="mm", exact=True).click()
    tab.page.get_by_role("dialog", name="To other units").get_by_text("Convert").click()
    tab.wait_for_cell(1, "a", "-425")
    tab.settle()
    network.hold()
    tab.page.get_by_role("button", name="undo", exact=True).click()
    network.wait_for("dhGrid.fill")
    tab.type_into(1, "a", "-430")
    network.release()
    tab.page.locator(".q-notification").get_by_text("a: -430").wait_for()
    wait_for_rows(tab, UR5)


@pytest.mark.long
def test_the_last_rows_are_removed(slow: tuple[Any, Network]) -> None:
    """Alt+Delete three times in the last row removes three rows."""
    tab, network = slow
    tab.cell(5, "d").click()
    network.hold()
    for _ in range(3):
        tab.page.keyboard.press("Alt+Delete")
    network.wait_for("dhGrid.mark")
    network.release()
    tab.wait_for_status("3 axes; the arm is the table's")


@pytest.mark.long
def test_a_joint_is_moved_while_its_limit_changes(slow: tuple[Any, Network]) -> None:
    """A number that is being typed stays in its box, and the last place of a slider that is dragged holds."""
    tab, network = slow
    box = tab.page.locator(".joint-slider-number").first
    network.hold()
    tab.type_into(0, "upper", "3")
    network.wait_for("dhGrid.mark")
    box.fill("0.")
    network.release()
    tab.page.locator(".joint-slider[title$='to 3 rad']").wait_for()
    tab.page.keyboard.type("25")
    tab.page.keyboard.press("Enter")
    tab.wait_for_joint(0, 0.25)

    network.hold()
    tab.type_into(0, "upper", "2")
    network.wait_for("dhGrid.mark")
    tab.page.get_by_role("slider", name="shoulder_pan_joint").focus()
    for _ in range(3):
        tab.page.keyboard.press("ArrowRight")
    network.release()
    tab.page.locator(".joint-slider[title$='to 2 rad']").wait_for()
    tab.page.locator(".joint-sliders[aria-busy=false]").wait_for()
    assert tab.sliders()[0] == pytest.approx(0.28)


@pytest.mark.long
def test_a_joint_moves_on_over_another_connection(slow: tuple[Any, Network], catalog: Catalog) -> None:
    """Values of a slider that were lost with the connection are sent again; the slider moved nothing any more."""
    tab, network = slow
    with network.broken():
        tab.page.get_by_role("slider", name="shoulder_pan_joint").focus()
        for _ in range(3):
            tab.page.keyboard.press("ArrowRight")
    arm = read_whole(gallery.table("ur5.csv", catalog), catalog).manipulator
    assert arm is not None
    tab.wait_for_tool0(arm, [0.03, 0, 0, 0, 0, 0])
    tab.press("zero")
    tab.wait_for_tool0(arm)


@pytest.mark.long
def test_cells_are_taken_over_another_connection(slow: tuple[Any, Network], catalog: Catalog) -> None:
    """Cells that were lost with the connection are sent again; they were on the screen, and in no table."""
    tab, network = slow
    with network.broken():
        tab.type_into(1, "a", "-0.9")
        tab.type_into(2, "a", "-0.5")
    table = edits.with_cells(gallery.table("ur5.csv", catalog), {(1, "a"): "-0.9", (2, "a"): "-0.5"})
    arm = read_whole(table, catalog).manipulator
    assert arm is not None
    tab.wait_for_tool0(arm)


JOINTS = ["shoulder_pan", "shoulder_lift", "elbow", "wrist_1", "wrist_2", "wrist_3"]


def wait_for_joints(tab: Any, names: list[str]) -> None:
    """Waits until the table has these joints, without the ends that all of their names have."""
    tab.settle()
    tab.page.locator(f".dh-table [aria-rowcount='{len(names) + 1}']").wait_for()
    for row, name in enumerate(names):
        tab.wait_for_cell(row, "joint", name if name == "joint_7" else f"{name}_joint")


ROW_ACTS: dict[str, tuple[Callable[[Any], None], list[str]]] = {
    "a new row": (lambda tab: tab.page.keyboard.press("Alt+Insert"), [*JOINTS[:3], "joint_7", *JOINTS[3:]]),
    "a removed row": (lambda tab: tab.page.keyboard.press("Alt+Delete"), [*JOINTS[:2], *JOINTS[3:]]),
    "a row that goes up": (
        lambda tab: tab.page.keyboard.press("Alt+ArrowUp"),
        ["shoulder_pan", "elbow", "shoulder_lift", *JOINTS[3:]],
    ),
    "a row that is dragged": (lambda tab: drag_row(tab, 2, 4), [*JOINTS[:2], *JOINTS[3:5], "elbow", "wrist_3"]),
    "a button": (lambda tab: tab.page.get_by_role("button", name="remove the row").click(), [*JOINTS[:2], *JOINTS[3:]]),
}


@pytest.mark.long
@pytest.mark.parametrize("act", ROW_ACTS)
def test_rows_are_changed_over_another_connection(slow: tuple[Any, Network], act: str) -> None:
    """What is done to rows while the connection is broken is done when it is back, and cells behind it go into their rows."""
    tab, network = slow
    do, after = ROW_ACTS[act]
    tab.cell(2, "d").click()
    tab.settle()
    with network.broken():
        do(tab)
    tab.page.locator(".studio-lost").wait_for(state="detached")
    wait_for_joints(tab, after)


@pytest.mark.long
@pytest.mark.parametrize("act", [act for act in ROW_ACTS if act != "a row that is dragged"])
def test_an_act_whose_answer_is_lost_is_done_once(slow: tuple[Any, Network], act: str) -> None:
    """A row is added, removed or moved once, where the connection broke after the server had done so."""
    tab, network = slow
    do, after = ROW_ACTS[act]
    tab.cell(2, "d").click()
    tab.settle()
    network.hold()
    do(tab)
    network.wait_for("dhGrid.mark")
    network.forget()
    wait_for_joints(tab, after)


@pytest.mark.long
@pytest.mark.parametrize("label", ["base", "payload", "name of the arm"])
def test_a_text_is_taken_over_another_connection(slow: tuple[Any, Network], label: str) -> None:
    """A text of the whole table that was lost with the connection is sent again: the page loaded anew has it."""
    tab, network = slow
    text = "other" if label == "name of the arm" else {"base": "{xyz: [0, 0, 0.5]}", "payload": "{mass: 2}"}[label]
    with network.broken():
        tab.page.get_by_label(label, exact=True).fill(text)
        tab.page.keyboard.press("Enter")
        tab.page.keyboard.press("Tab")
    tab.page.wait_for_function("text => dhPage.kept().includes(text)", arg=text)  # which the server has answered
    tab.page.reload()
    tab.page.wait_for_function(
        "([label, text]) => document.querySelector(`input[aria-label='${label}']`)?.value === text", arg=[label, text]
    )


@pytest.mark.long
def test_what_is_being_typed_while_the_connection_breaks(slow: tuple[Any, Network]) -> None:
    """A text that was begun in a field, or a cell, is taken, and the cursor comes back to where it was."""
    tab, network = slow
    page = tab.page
    page.get_by_label("base", exact=True).click()
    for text, where, kept in (("{xyz: [0, 0, 0.5]}", "[aria-label=base]", "0.5"), ("0.123", "[col-id=d]", "0.123")):
        with network.broken():
            page.keyboard.type(text)
        page.locator(".studio-lost").wait_for(state="detached")
        page.wait_for_function("text => dhPage.kept().includes(text)", arg=kept)
        page.wait_for_function("where => document.activeElement.matches(where)", arg=where)
        tab.cell(1, "d").click()
    page.reload()
    tab.wait_for_cell(1, "d", "0.123")
    page.wait_for_function("document.querySelector('[aria-label=base]').value === '{xyz: [0, 0, 0.5]}'")


@pytest.mark.long
def test_cells_are_pasted_and_dialogs_opened_over_another_connection(slow: tuple[Any, Network]) -> None:
    """So are cells that are pasted, and a click that opens a dialog opens one."""
    tab, network = slow
    tab.cell(2, "a").click()
    tab.settle()
    with network.broken():
        tab.page.evaluate(PASTE, "-0.3\tpi/4")
        tab.page.get_by_role("button", name="Open", exact=True).dblclick()
    tab.wait_for_cells(2, a="-0.3", alpha="pi/4")
    tab.page.locator(".q-dialog").wait_for()
    tab.page.keyboard.press("Escape")
    tab.page.locator(".q-dialog").wait_for(state="detached")


@pytest.mark.long
def test_what_is_lost_is_told(slow: tuple[Any, Network]) -> None:
    """A page that is loaded anew while the connection is broken names what has not arrived, and nothing else."""
    tab, network = slow
    page, told = tab.page, tab.page.locator(".q-notification")
    network.hold()
    tab.type_into(0, "a", "0.25")
    network.wait_for("dhGrid.mark")  # it has arrived, though the page does not know it
    page.evaluate("answers.lost = true")
    tab.type_into(1, "a", "-0.9")
    page.keyboard.press("Alt+ArrowUp")
    page.get_by_label("base", exact=True).fill("{xyz: [0, 0, 0.5]}")
    page.get_by_role("button", name="New").click()
    page.reload()
    told.wait_for()
    lines = told.locator(".q-notification__message").inner_text().splitlines()
    assert lines[1:] == ["row 2, a: -0.9", "row 3: up", "base: {xyz: [0, 0, 0.5]}", "New"]
    tab.wait_for_cell(0, "a", "0.25")
    tab.wait_for_cell(1, "a", "-0.425")
    told.get_by_role("button", name="Close").click()
    told.wait_for(state="detached")
    network.hold()
    tab.type_into(1, "a", "-0.9")
    network.wait_for("dhGrid.mark")
    page.reload()
    tab.wait_for_cell(1, "a", "-0.9")
    tab.settle()
    assert told.count() == 0


@pytest.mark.long
def test_a_handle_is_dragged_over_another_connection(slow: tuple[Any, Network]) -> None:
    """So is the place that the handle was dragged to."""
    tab, network = slow
    page = tab.page
    tab.set_sliders([-2.5, -1.9, 2.0, -1.7, -1.57, 0.0])  # far from limits and singularities
    page.get_by_role("button", name="set the pose of tool0").click()
    page.wait_for_function("document.querySelector('.arm-view').scene.getObjectByName('handle').visible")
    script = """() => {
        const view = document.querySelector('.arm-view'), box = view.querySelector('canvas').getBoundingClientRect();
        const at = view.scene.getObjectByName('handle').position.clone().project(view.camera);
        return [box.left + (at.x + 1) / 2 * box.width, box.top + (1 - at.y) / 2 * box.height];
    }"""
    x, y = page.evaluate(script)
    with network.broken():
        page.mouse.move(x, y)
        page.mouse.down()
        page.mouse.move(x - 10, y + 8)
        page.mouse.move(x - 20, y + 15)
        page.mouse.up()
    page.wait_for_function(
        f"([x, y]) => {{ const [a, b] = ({script})(); return Math.hypot(a - x, b - y) < 2; }}", arg=[x - 20, y + 15]
    )


@pytest.mark.long
@pytest.mark.parametrize("field", ["cell", "name"])
def test_a_file_does_not_overtake_what_was_typed(slow: tuple[Any, Network], field: str) -> None:
    """What was being typed as a file was dropped belongs to the table before, though the file is sent faster."""
    tab, _ = slow
    (tab.cell(1, "a") if field == "cell" else tab.page.locator(".studio-name input")).click()
    tab.page.keyboard.type("0.123")
    tab.page.evaluate("answers.late = 1000")
    tab.drop(".studio-table", TABLES / "stanford.csv")
    tab.wait_for_table("stanford")
    tab.page.evaluate("answers.late = 0")
    tab.page.wait_for_function("!answers.sending")
    tab.page.get_by_role("button", name="undo", exact=True).click()
    if field == "cell":
        tab.wait_for_table("ur5")
        tab.wait_for_cell(1, "a", "0.123")
    else:
        tab.wait_for_table("ur50.123")


@pytest.mark.long
def test_a_cell_that_is_begun_while_a_file_is_read(slow: tuple[Any, Network]) -> None:
    """It belongs to the table before as well."""
    tab, network = slow
    network.hold()
    tab.drop(".studio-table", TABLES / "stanford.csv")
    network.wait_for("reading stanford.csv")
    network.wait_for("dhPage.")
    tab.cell(1, "a").click()
    tab.page.keyboard.type("0.123")
    network.release()
    tab.wait_for_table("stanford")
    tab.wait_for_cell(1, "a", "0")
    tab.page.get_by_role("button", name="undo", exact=True).click()
    tab.wait_for_table("ur5")
    tab.wait_for_cell(1, "a", "0.123")


def drag_row(tab: Any, row: int, to: int) -> None:
    """Drags a row by its number to the place of another one."""
    tab.cell(row, "number").hover(position={"x": 12, "y": 12})  # once it stands still
    start, end = (tab.cell(number, "number").bounding_box() for number in (row, to))
    tab.page.mouse.down()
    for share in (0.25, 0.5, 0.75, 1.0):
        y = (1 - share) * start["y"] + share * end["y"] + 0.6 * end["height"]
        tab.page.mouse.move(start["x"] + 12, y)
    tab.page.mouse.up()


@pytest.mark.long
def test_rows_are_dragged_one_after_the_other(slow: tuple[Any, Network]) -> None:
    """The second drag moves the row that was taken, and a text goes where it was typed, though no answer is there yet."""
    tab, network = slow
    network.hold()
    for joint in ("shoulder_pan_joint", "shoulder_lift_joint"):
        tab.wait_for_cell(0, "joint", joint)
        drag_row(tab, 0, 3)
    tab.wait_for_cell(0, "joint", "elbow_joint")
    tab.type_into(0, "a", "0.7")
    network.release()
    tab.settle()
    for row, (joint, a) in enumerate(
        (("elbow", "0.7"), ("wrist_1", "0"), ("shoulder_pan", "0"), ("shoulder_lift", "-0.425"))
    ):
        tab.wait_for_cells(row, joint=f"{joint}_joint", a=a)


@pytest.mark.long
def test_two_clicks_open_one_dialog(slow: tuple[Any, Network]) -> None:
    """A person who clicks again since nothing has happened yet gets one dialog, and another one when it is closed."""
    tab, network = slow
    button = tab.page.get_by_role("button", name="Open", exact=True)
    for _ in range(2):
        network.hold()
        button.dblclick()
        network.wait_for("Open a table")
        button.click()
        tab.page.wait_for_function("!answers.sending")
        network.release()
        tab.page.locator(".q-dialog").wait_for()
        tab.settle()
        assert tab.page.locator(".q-dialog").count() == 1
        tab.page.keyboard.press("Escape")
        tab.page.locator(".q-dialog").wait_for(state="detached")


@pytest.mark.long
@pytest.mark.parametrize("way", ["Generate", "Control+Enter", "Save"])
def test_two_clicks_save_one_file(slow: tuple[Any, Network], way: str) -> None:
    """So does a person who saves a file; afterwards it can be saved again."""
    tab, network = slow
    page, files = tab.page, []
    page.on("download", lambda download: files.append(download.suggested_filename))
    for count in (1, 2):
        if way == "Save":
            page.get_by_role("button", name="Save").click()
            page.locator(".q-menu").wait_for()
        network.hold()
        for _ in range(2):
            match way:
                case "Generate":
                    page.get_by_role("button", name="Generate").click()
                case "Save":
                    page.locator(".q-menu").get_by_text("Table as csv", exact=True).click(force=True)
                case _:
                    page.keyboard.press(way)
            network.wait_for("download")
        with page.expect_download():
            network.release()
        page.wait_for_function("!document.querySelector('.q-menu')")
        tab.settle()
        page.wait_for_function("!answers.sending")
        assert len(files) == count


@pytest.mark.long
def test_two_choices_of_units_ask_one_question(slow: tuple[Any, Network]) -> None:
    """Of mm and then deg at once, the question is about both."""
    tab, network = slow
    network.hold()
    for unit in ("mm", "deg"):
        tab.page.get_by_role("button", name=unit, exact=True).click()
    network.wait_for("now mm and deg")
    network.release()
    tab.page.get_by_role("dialog", name="To other units").get_by_text("Convert").click()
    tab.page.locator(".q-dialog").wait_for(state="detached")
    tab.wait_for_cell(1, "a", "-425")
    tab.wait_for_cell(0, "alpha", "90")
    tab.settle()
    assert tab.page.locator(".q-dialog").count() == 0


@pytest.mark.long
def test_the_camera_is_turned_before_a_linked_table_is_there(slow: tuple[Any, Network]) -> None:
    """A person who looks from the front while the page is filled goes on looking from there, and sees all of the arm."""
    tab, _ = slow
    tab.page.goto(f"{tab.address}favicon.ico")
    tab.page.add_init_script("""
        answers.late = 300;
        const wait = setInterval(() => {
            if (!document.querySelector(".arm-view")?.drawn) return;
            clearInterval(wait);
            const key = new KeyboardEvent("keydown", { key: "1", bubbles: true });
            document.querySelector(".arm-view").dispatchEvent(key);
            window.wasEmpty = !document.querySelector(".arm-view").scene.getObjectByName("tool0");
        }, 10);
    """)
    tab.open("ur5")
    assert tab.page.evaluate("wasEmpty")
    axis = "new Array(3).fill(0).map((_, i) => document.querySelector('.arm-view').camera.matrixWorld.elements[8 + i])"
    assert tab.page.evaluate(axis) == pytest.approx([1, 0, 0], abs=1e-3)


@pytest.mark.long
def test_a_table_is_begun_before_the_kept_one_is_known(
    studio_address: str, new_tab: Callable[..., Any], catalog: Catalog
) -> None:
    """The kept table of a server that is gone is offered though a person has begun a new one before it is known."""
    tab = new_tab(studio_address)
    page, network = tab.page, Network(tab.page)
    page.add_init_script(HELD)
    tab.open()
    tab.settle()
    page.evaluate("text => sessionStorage.setItem('dh2urdf-table', text)", kept_text(gallery.table("ur5.csv", catalog)))
    page.add_init_script("answers.from = 'dhPage.kept()'")
    page.reload()
    network.wait_for("dhPage.kept()")
    page.get_by_label("number of axes").fill("3")
    page.get_by_label("number of axes").press("Enter")
    network.wait_for("dhPage.keep(")
    page.evaluate("answers.from = ''")
    network.release()
    page.get_by_role("button", name="Bring it back").click()
    tab.wait_for_cells(5, joint="wrist_3_joint")
    page.close()  # what it holds back is for this test only


@pytest.mark.long
def test_what_is_done_meanwhile_waits_for_what_was_lost(slow: tuple[Any, Network]) -> None:
    """What is done before the server knows the page again, as after a handshake of its own, overtakes no lost act."""
    tab, network = slow
    script = """() => {
        const { query } = socket.io.opts, { emit } = socket;
        query.implicit_handshake = false;
        const key = document.querySelector(".dh-table .ag-row[row-index='0']").getAttribute("row-id");
        socket.on("connect", () => emitEvent("dh-edit", [key, "d", "0.7", 0]));
    }"""
    tab.page.evaluate(script)
    with network.broken():
        tab.type_into(1, "a", "-0.9")
    tab.page.wait_for_function("dhPage.kept().includes('0.7') && dhPage.kept().includes('-0.9')")


@pytest.mark.long
def test_what_is_too_large_is_in_nobodys_way(studio_address: str, new_tab: Callable[..., Any]) -> None:
    """NiceGUI sends nothing of more than a megabyte; what is done afterwards arrives."""
    tab = new_tab(studio_address, faults=False)
    page = tab.open("ur5")
    page.evaluate("emitEvent('dh-edit', [0, 'd', '1'.repeat(1_100_000), 0])")
    tab.type_into(1, "a", "-0.9")
    page.wait_for_function("dhPage.kept().includes('-0.9')")


@pytest.mark.long
def test_a_page_answers_late(slow: tuple[Any, Network]) -> None:
    """A page whose first answer took more than ten seconds stayed empty, with a fault of the studio in its place."""
    tab, _ = slow
    tab.page.add_init_script("""{
        const { send } = WebSocket.prototype;
        WebSocket.prototype.send = function (data) {
            const wait = String(data).includes("javascript_response") ? 11_000 : 0;
            wait ? setTimeout(() => send.call(this, data), wait) : send.call(this, data);
        };
    }""")
    tab.page.goto(f"{tab.address}favicon.ico")
    tab.page.goto(tab.address)
    tab.wait_for_cells(1, a="-0.425")
    assert tab.page.locator(".q-notification").count() == 0
