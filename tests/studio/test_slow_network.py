"""A person who is faster than the network: what is done while answers are on their way is neither lost nor undone."""

from __future__ import annotations

from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator

    from dh2urdf.plugin_system import Catalog

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
        (["Insert"], 3, "elbow_joint"),
        (["ArrowUp"], 1, "shoulder_pan_joint"),
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
@pytest.mark.parametrize(
    ("keys", "more", "refused"),
    [
        (["0", ".", "1", "Enter"], [], "a: 0.1"),
        (["Alt+Delete"], [], "remove"),
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
def test_cells_are_taken_over_another_connection(slow: tuple[Any, Network], catalog: Catalog) -> None:
    """Cells that were lost with the connection are sent again; they were on the screen, and in no table."""
    tab, network = slow
    with network.broken():
        tab.type_into(1, "a", "-0.9")
        tab.type_into(2, "a", "-0.5")
    table = edits.with_cells(gallery_table("ur5.csv", catalog), {(1, "a"): "-0.9", (2, "a"): "-0.5"})
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
@pytest.mark.parametrize("way", ["Control+Enter", "Save"])
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
