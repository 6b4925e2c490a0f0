"""A server that answers late: cursor, focus and picked row are the browser's, and no answer moves them."""

import random
from contextlib import suppress
from typing import Any

import pytest
from tests.studio.test_slow_network import HELD, Network

FIELDS = ["a", "alpha", "d"]
TEXTS = ["0.1", "-0.425", "pi/2", "90°", "0", "0.089159", "-pi/4", "q2 + pi/2", "0.1x2"]
SHOWN = """() => {
    const text = (row, field) => row.querySelector(`[col-id=${field}]`).textContent;
    return [...document.querySelectorAll(".dh-table .ag-center-cols-container .ag-row")]
        .sort((one, other) => one.ariaRowIndex - other.ariaRowIndex)
        .map((row) => ["joint", "a", "alpha", "d"].map((field) => text(row, field)));
}"""
"""The rows on the page."""
CURSOR = """() => {
    const cell = document.activeElement.closest(".dh-table .ag-cell");
    return cell && [Number(cell.closest(".ag-row").getAttribute("row-index")), cell.getAttribute("col-id")];
}"""
PICKED = "() => [...document.querySelectorAll('.dh-table .ag-center-cols-container .dh-picked')].map(row => Number(row.getAttribute('row-index')))"
KEPT = "() => JSON.parse(dhPage.kept()).rows.map(row => ['joint', 'a', 'alpha', 'd'].map(field => row[field] ?? ''))"
"""The rows of the server, which it has the page keep."""


@pytest.mark.parametrize("held", [True, pytest.param(False, marks=pytest.mark.long)])
def test_the_first_letters_go_where_they_are_typed(tab: Any, *, held: bool) -> None:
    """The documented flow by keyboard, typed faster than the server answers: a of the first row was 159, or `/2`."""
    tab.page.add_init_script(HELD)
    page = tab.open()
    tab.settle()
    network = Network(page)
    network.hold() if held else page.evaluate("answers.late = 600")
    for key in ("3", "Enter", "Tab", "Space"):
        page.keyboard.press(key)
    for text in ("0", "Tab", "pi/2", "Tab", "0.089159", "Enter", "-0.425", "Tab", "0", "Tab", "0", "Enter", "0.3"):
        page.keyboard.press(text) if text in ("Tab", "Enter") else page.keyboard.type(text)
    assert page.evaluate("dhGrid.unfinished().text") == "0.3"
    assert page.evaluate(CURSOR) == [2, "a"]
    network.release()
    tab.wait_for_status("row 3 is still empty")
    page.keyboard.type("5")
    page.keyboard.press("Enter")
    rows = [["joint_1", "0", "pi/2", "0.089159"], ["joint_2", "-0.425", "0", "0"], ["joint_3", "0.35", "", ""]]
    page.wait_for_function(f"rows => JSON.stringify(({KEPT})()) === JSON.stringify(rows)", arg=rows)
    assert page.evaluate(SHOWN) == rows
    page.close()


class Monkey:
    """Somebody who acts at random, and knows what a table is.

    Attributes:
        rows: each row by its number, and its texts: a, α and d.
        row: the row of the cursor.
        column: its column, of `FIELDS`.
    """

    def __init__(self, tab: Any, seed: int) -> None:
        self.tab, self.page, self.random = tab, tab.page, random.Random(seed)  # noqa: S311 - no secret
        self.late = pytest.importorskip("playwright.sync_api").TimeoutError
        self.rows: list[list[Any]] = [[0, "", "", ""]]
        self.made = 1
        self.row, self.column = 0, 0
        self.past: list[list[list[Any]]] = []
        self.future: list[list[list[Any]]] = []
        self.done: list[str] = []

    def act(self) -> None:
        """Does one thing, on the page and to the rows here."""
        acts = {
            self.type: 8,
            self.go: 6,
            self.click: 6,
            self.empty: 2,
            self.add: 3,
            self.remove: 2,
            self.move: 4,
            self.undo: 1,
            self.resize: 1,
            self.pause: 1,
        }
        (act,) = self.random.choices(list(acts), list(acts.values()))
        self.done.append(act.__name__)
        act()

    def press(self, key: str, button: str) -> None:
        """A key, or the button that does the same."""
        if self.random.random() < 0.5:
            self.page.keyboard.press(key)
        else:
            self.page.get_by_role("button", name=button).click()

    def new_row(self) -> list[Any]:
        self.made += 1
        return [self.made, "", "", ""]

    def put(self, rows: list[list[Any]]) -> None:
        """Other rows, which undo takes back."""
        if rows != self.rows:
            self.past.append(self.rows)
            self.future, self.rows = [], rows

    def type(self) -> None:
        """A text, which Enter takes, and goes down."""
        text, rows = self.random.choice(TEXTS), [list(row) for row in self.rows]
        rows[self.row][1 + self.column] = text
        self.page.keyboard.type(text)
        self.page.keyboard.press("Enter")
        self.put(rows)
        self.row = min(self.row + 1, len(rows) - 1)

    def go(self) -> None:
        """An arrow."""
        key, down, right = self.random.choice([("Up", -1, 0), ("Down", 1, 0), ("Left", 0, -1), ("Right", 0, 1)])
        if not 0 <= self.column + right < len(FIELDS):
            return
        self.page.keyboard.press(f"Arrow{key}")
        self.row = min(max(self.row + down, 0), len(self.rows) - 1)
        self.column += right

    def click(self) -> None:
        """A cell."""
        self.row, self.column = self.random.randrange(len(self.rows)), self.random.randrange(len(FIELDS))
        self.tab.cell(self.row, FIELDS[self.column]).click()

    def empty(self) -> None:
        """Delete."""
        rows = [list(row) for row in self.rows]
        rows[self.row][1 + self.column] = ""
        self.page.keyboard.press("Delete")
        self.put(rows)

    def add(self) -> None:
        """A row below."""
        if len(self.rows) > 7:
            return
        self.press("Alt+Insert", "add a row below")
        self.put([*self.rows[: self.row + 1], self.new_row(), *self.rows[self.row + 1 :]])
        self.row, self.column = self.row + 1, 0

    def remove(self) -> None:
        """The row with the cursor; not the last one, behind which there is no cursor."""
        if len(self.rows) < 2:
            return
        self.press("Alt+Delete", "remove the row")
        self.put([*self.rows[: self.row], *self.rows[self.row + 1 :]])
        self.row = min(self.row, len(self.rows) - 1)

    def move(self) -> None:
        """The row with the cursor, up or down."""
        way, by = self.random.choice([("up", -1), ("down", 1)])
        self.press(f"Alt+Arrow{way.title()}", f"move the row {way}")
        if 0 <= self.row + by < len(self.rows):
            rows = list(self.rows)
            rows.insert(self.row + by, rows.pop(self.row))
            self.put(rows)
            self.row += by

    def undo(self) -> None:
        """Some states back, and some forward; what they are is on the page when the answer is."""
        for key, way, other in (("z", self.past, self.future), ("y", self.future, self.past)):
            for _ in range(self.random.randrange(3)):
                self.page.keyboard.press(f"Control+{key}")
                if way:
                    other.append(self.rows)
                    self.rows = way.pop()
        self.tab.settle()
        self.click() if self.rows else self.resize()

    def resize(self) -> None:
        """Another number of axes; the driver selects and fills in two steps, and an answer between them is no person's."""
        self.tab.settle()
        count = self.random.randint(1, 7)
        field = self.page.get_by_label("number of axes")
        field.fill(str(count))
        field.press("Enter")
        self.put([*self.rows[:count], *(self.new_row() for _ in range(len(self.rows), count))])
        self.tab.settle()
        self.click()

    def pause(self) -> None:
        """Some answers come."""
        self.page.wait_for_timeout(self.random.randrange(900))

    def compare(self) -> None:
        """The page, the server and the rows here are the same, and so are the cursor and the picked row."""
        self.tab.settle()
        told = f"after {self.done[-30:]}"
        rows = [[f"joint_{number}", *cells] for number, (_, *cells) in enumerate(self.rows, start=1)]
        both = f"[({SHOWN})(), ({KEPT})(), ({PICKED})()]"
        expected = [rows, rows, [self.row]]
        with suppress(self.late):  # the grid draws a cell after the other
            same = f"expected => JSON.stringify({both}) === JSON.stringify(expected)"
            self.page.wait_for_function(same, arg=expected, timeout=30_000)
        assert self.page.evaluate(both) == expected, told
        where = self.page.evaluate(CURSOR)
        assert where in (None, [self.row, FIELDS[self.column]]), told


def let_act(tab: Any, seed: int, acts: int) -> None:
    tab.page.add_init_script(HELD)
    page = tab.open()
    tab.settle()
    page.evaluate("answers.late = 600")
    page.keyboard.type("1")
    for key in ("Enter", "Tab", "Space"):
        page.keyboard.press(key)
    monkey = Monkey(tab, seed)
    for number in range(1, acts + 1):
        monkey.act()
        if number % 25 == 0 or number == acts:
            monkey.compare()
    page.close()


def test_a_monkey_with_a_late_server(tab: Any) -> None:
    """Fifty acts at random; the server answers 0.6 s late."""
    let_act(tab, seed=1, acts=50)


@pytest.mark.long
@pytest.mark.parametrize("seed", [2])
def test_a_monkey_of_a_thousand_acts(tab: Any, seed: int) -> None:
    """A thousand acts at random; the server answers 0.6 s late."""
    let_act(tab, seed=seed, acts=1000)
