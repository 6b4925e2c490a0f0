"""A person who is faster than the network: what is done while answers are on their way is neither lost nor undone."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import pytest

pytestmark = pytest.mark.long
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
def slow(tab: Any) -> Iterator[tuple[Any, Network]]:
    """A tab with a UR5, and its network."""
    tab.page.add_init_script(HELD)
    tab.open("ur5")
    yield tab, Network(tab.page)
    tab.page.close()  # what it holds back is for these tests only


UR5 = [
    [f"{joint}_joint", a] for joint, a in {"shoulder_pan": "0", "shoulder_lift": "-0.425", "elbow": "-0.39225"}.items()
] + [[f"wrist_{number}_joint", "0"] for number in "123"]


def wait_for_rows(tab: Any, rows: list[list[str]]) -> None:
    """Waits until the table has these joints and lengths a, on the screen and on the server."""
    tab.settle()
    for reload in (tab.page.reload, tab.settle):
        tab.page.locator(f".dh-table [aria-rowcount='{len(rows) + 1}']").wait_for()
        for number, (joint, a) in enumerate(rows):
            tab.wait_for_cells(number, joint=joint, a=a)
        reload()


@pytest.mark.parametrize(("keys", "refused"), [(["0", ".", "1", "Enter"], "a: 0.1"), (["Alt+Delete"], "remove")])
def test_what_is_done_to_a_row_that_is_gone(slow: tuple[Any, Network], keys: list[str], refused: str) -> None:
    """It is refused in words, and no other row changes."""
    tab, network = slow
    tab.cell(1, "a").click()
    tab.page.keyboard.press("Alt+Insert")
    tab.wait_for_cell(2, "joint", "joint_7")
    tab.settle()
    network.hold()
    tab.click("undo")
    network.wait_for("dhGrid.fill")
    tab.cell(2, "a").click()
    for key in keys:
        tab.page.keyboard.press(key)
    network.release()
    told = tab.page.locator(".q-notification__message")
    told.wait_for()
    assert told.inner_text().splitlines()[1:] == [refused]
    wait_for_rows(tab, UR5)


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


def test_cells_are_taken_over_another_connection(slow: tuple[Any, Network], arm_of: Callable[..., Any]) -> None:
    """Cells that were lost with the connection are sent again; they were on the screen, and in no table."""
    tab, network = slow
    with network.broken():
        tab.type_into(1, "a", "-0.9")
        tab.type_into(2, "a", "-0.5")
    tab.wait_for_tool0(arm_of("ur5.csv", {(1, "a"): "-0.9", (2, "a"): "-0.5"}))


NEW = ["joint_7", ""]
ROW_ACTS: dict[str, tuple[str, list[list[str]]]] = {
    "a new row": ("add a row below", [*UR5[:3], NEW, *UR5[3:]]),
    "a removed row": ("remove the row", [*UR5[:2], *UR5[3:]]),
    "a row that goes up": ("move the row up", [UR5[0], UR5[2], UR5[1], *UR5[3:]]),
}


@pytest.mark.parametrize("act", ROW_ACTS)
def test_an_act_whose_answer_is_lost_is_done_once(slow: tuple[Any, Network], act: str) -> None:
    """A row is added, removed or moved once, where the connection broke after the server had done so."""
    tab, network = slow
    button, after = ROW_ACTS[act]
    tab.cell(2, "d").click()
    tab.settle()
    network.hold()
    tab.page.get_by_role("button", name=button).click()
    network.wait_for("dhGrid.mark")
    network.forget()
    wait_for_rows(tab, after)


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
            if way == "Save":
                page.locator(".q-menu").get_by_text("Table as csv", exact=True).click(force=True)
            else:
                page.keyboard.press(way)
            network.wait_for("download")
        with page.expect_download():
            network.release()
        page.wait_for_function("!document.querySelector('.q-menu')")
        tab.settle()
        page.wait_for_function("!answers.sending")
        assert len(files) == count
