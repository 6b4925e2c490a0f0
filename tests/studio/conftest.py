from __future__ import annotations

import base64
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import zlib
from collections.abc import Callable, Iterator, Mapping
from contextlib import AbstractContextManager, contextmanager
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

import numpy as np
import pytest

from dh2urdf.kinematics import forward_kinematics
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import Catalog, load
from dh2urdf.table_text import TableText
from dh2urdf_studio.editing.edits import kept_text, with_cells
from dh2urdf_studio.editing.opening import gallery, gallery_table
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Locator, LocatorAssertions, Page

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or ""
ARGUMENTS = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox")
CHEAP = ("--disable-gpu-compositing", "--webgl-antialiasing-mode=none")
"""There is no GPU here: a page is put together by the processor twice as fast as by a GPU that the processor plays."""
PATIENCE = 120_000
"""Only a fault waits so long, on a busy machine too [ms]."""
SMOOTH = """localStorage.setItem(
  "dh2urdf-look", JSON.stringify({ ...JSON.parse(localStorage.getItem("dh2urdf-look") ?? "{}"), edges: "smooth" }))"""
STILL = """
!document.querySelector(".q-tooltip") && !document.getAnimations().some((animation) =>
  animation.playState === "running" && animation.effect.getComputedTiming().endTime !== Infinity)
"""
TABLES = Path(__file__).parents[2] / "configs" / "tables"


@pytest.fixture(scope="session")
def catalog() -> Catalog:
    return load()


@pytest.fixture(scope="session")
def arm_of(catalog: Catalog) -> Callable[..., Manipulator]:
    """The arm of a table, or of a file of the gallery, with other texts in some cells."""

    def arm(table: TableText | str, cells: Mapping[tuple[int, str], str] = MappingProxyType({})) -> Manipulator:
        table = gallery_table(table, catalog) if isinstance(table, str) else table
        reading = read_whole(with_cells(table, cells), catalog)
        assert reading.manipulator is not None, "\n".join(found.text for found in reading.problems)
        return reading.manipulator

    return arm


@pytest.fixture(scope="session")
def serving() -> Callable[..., Any]:
    """Starts a command that serves, as a context manager that gives its address."""
    pytest.importorskip("nicegui")
    return served


@contextmanager
def served(*words: str | Path, port: int = 0) -> Iterator[str]:
    """The address at which a command of the project serves, in a process of its own, until the end of the block."""
    code = "from dh2urdf.cli import main; main()"
    command = [sys.executable, "-c", code, *map(str, words), "--no-browser", "--port", str(port)]
    environment = {**os.environ, "PYTHONUNBUFFERED": "1"}
    environment.pop("PYTEST_CURRENT_TEST", None)  # NiceGUI would take the server for its own test.
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=environment) as server:
        assert server.stdout is not None
        try:
            found = re.search(r"http://[^/]+/", server.stdout.readline())
            assert found, "the server did not say its address"
            yield found[0]
        finally:
            server.send_signal(signal.SIGINT)
            assert server.wait(60) == 130, "a server ends as every command that is interrupted"


@pytest.fixture
def free_port() -> int:
    """A port that nobody listens at."""
    with socket.create_server(("127.0.0.1", 0)) as listening:
        return int(listening.getsockname()[1])


@pytest.fixture(scope="session")
def parked() -> dict[str, list[Page]]:
    """Pages that wait for the next test, by the address of the server that outlives tests."""
    return {}


@pytest.fixture(scope="session")
def studio_address(parked: dict[str, list[Page]]) -> Iterator[str]:
    """A studio with an empty table."""
    pytest.importorskip("nicegui")
    with served("studio") as address:
        parked[address] = []
        yield address


@pytest.fixture(scope="session")
def chromium(request: pytest.FixtureRequest) -> Iterator[Browser]:
    """The system's own Chromium, headless; what it draws is fine where pictures of the pages are taken."""
    api = pytest.importorskip("playwright.sync_api")
    if not CHROMIUM:
        pytest.skip("Chromium is not installed (apt-get install chromium)")
    with api.sync_playwright() as playwright:
        arguments = ARGUMENTS if request.config.getoption("--renew") else ARGUMENTS + CHEAP
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=arguments)
        api.expect.set_options(timeout=PATIENCE)
        yield browser
        browser.close()


@cache
def link_to(name: str) -> str:
    """The part of a link that holds a table of the gallery: to click through the dialog costs as much as the page."""
    (file,) = (file for file in gallery() if file.partition(".")[0] == name)
    return link_to_table(gallery_table(file, load()))


def link_to_table(table: TableText) -> str:
    """The part of a link that holds a table."""
    squeezed = zlib.compressobj(wbits=-15)
    text = squeezed.compress(kept_text(table).encode()) + squeezed.flush()
    return f"#table={base64.urlsafe_b64encode(text).decode().rstrip('=')}"


class Tab:
    """A tab of the browser with what it asked for and what went wrong in it."""

    def __init__(self, page: Page, address: str) -> None:
        self.page = page
        self.address = address
        self.asked: list[str] = []
        self.faults: list[str] = []
        self._listeners: dict[str, Callable[[Any], None]] = {
            "request": lambda request: self.asked.append(request.url),
            "websocket": lambda socket: self.asked.append(socket.url),
            "pageerror": lambda error: self.faults.append(str(error)),
            "console": lambda message: self.faults.append(message.text) if message.type == "error" else None,
        }
        for event, listener in self._listeners.items():
            page.on(event, listener)  # type: ignore[call-overload]

    def leave(self) -> None:
        """Leaves the page ready for another test, with the compiled scripts and shaders, half of what a page costs."""
        page = self.page
        page.mouse.move(0, 0)
        page.goto(f"{self.address}favicon.ico")
        page.evaluate("sessionStorage.clear(), localStorage.clear()")  # tabs share what is in the latter
        page.emulate_media(color_scheme="light")
        for event, listener in self._listeners.items():
            page.remove_listener(event, listener)

    def open(self, name: str = "") -> Page:
        """Opens the page, with an empty table or, by a link, with a table of the gallery."""
        self._go_to(link_to(name) if name else "")
        if name:
            self._wait_for_arm(name)
        return self.page

    def open_table(self, table: TableText) -> Page:
        self._go_to(link_to_table(table))
        self._wait_for_arm(table.name)
        return self.page

    def _go_to(self, fragment: str) -> None:
        self.page.goto(self.address + fragment)
        self.page.wait_for_function("document.querySelector('.arm-view')?.drawn > 0")
        self.page.wait_for_function("document.querySelector('.dh-table .ag-header-cell[col-id=a]')")

    def _wait_for_arm(self, name: str) -> None:
        self.wait_for_table(name)
        self.page.wait_for_function("document.querySelector('.arm-view').scene.getObjectByName('tool0')")
        self.settle()

    # --- What stands on the page ---

    @staticmethod
    def expect(locator: Locator) -> LocatorAssertions:
        """What an element will be like, which Playwright waits for."""
        from playwright.sync_api import expect

        return expect(locator)

    @contextmanager
    def another_drawing(self) -> Iterator[None]:
        """Waits, after its block, until another drawing is in the scene."""
        shown = self.page.evaluate("document.querySelector('.arm-view').shown ?? 0")
        yield
        self.page.wait_for_function("shown => document.querySelector('.arm-view').shown > shown", arg=shown)

    @contextmanager
    def other_joints(self) -> Iterator[None]:
        """Waits, after its block, until the sliders have moved."""
        self.settle()
        before = self.sliders()
        yield
        script = """before => {
            const sliders = [...document.querySelectorAll('.joint-slider input[type=range]')];
            return sliders.some((slider, i) => slider.valueAsNumber !== before[i]);
        }"""
        self.page.wait_for_function(script, arg=before)

    def settle(self) -> None:
        """Waits until the server has done all that the page has sent, and the page has all of what was answered."""
        told = "{ client_id: clientId, next_message_id: nextMessageId }"
        self.page.evaluate(f"new Promise(done => socket.emit('ack', {told}, done))")

    def wait_for_joint(self, index: int, value: float) -> None:
        script = """([index, value]) => {
            const slider = document.querySelectorAll('.joint-slider input[type=range]')[index];
            return Math.abs(slider?.valueAsNumber - value) < 1e-6;
        }"""
        self.page.wait_for_function(script, arg=[index, value])

    def cell(self, row: int, field: str) -> Any:
        return self.page.locator(self._cell(row, field))

    @staticmethod
    def _cell(row: int, field: str) -> str:
        return f".dh-table .ag-row[row-index='{row}'] .ag-cell[col-id='{field}']"

    def cells(self, row: int, *fields: str) -> list[str]:
        return [self.cell(row, field).inner_text() for field in fields]

    def type_into(self, row: int, field: str, text: str) -> None:
        self.cell(row, field).click()
        self.page.keyboard.type(text)
        self.page.keyboard.press("Enter")

    @property
    def status(self) -> str:
        return str(self.page.locator(".studio-status").first.inner_text())

    def wait_for_status(self, text: str) -> None:
        script = "text => document.querySelector('.studio-status')?.textContent.includes(text)"
        self.page.wait_for_function(script, arg=text)

    def wait_for_table(self, name: str) -> None:
        self.page.wait_for_function(f"document.querySelector('.studio-name input').value === '{name}'")
        self.wait_for_status("the arm is the table's")

    def open_from_gallery(self, name: str) -> None:
        """Opens a table of the gallery as a person does."""
        with self.another_drawing():
            self.page.get_by_role("button", name="Open", exact=True).click()
            self.page.locator(f".studio-gallery-table[data-name='{name}']").click()
            self.wait_for_table(name)
        self.settle()

    def drop(self, where: str, *paths: Path) -> None:
        """Drops files and folders of the machine on a part of the page, as the browser reports it."""
        box = self.page.locator(where).first.bounding_box()
        assert box is not None
        place = {"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}
        data = {"items": [], "files": [str(path) for path in paths], "dragOperationsMask": 1}
        session = self.page.context.new_cdp_session(self.page)
        for kind in ("dragEnter", "dragOver", "drop"):
            session.send("Input.dispatchDragEvent", {"type": kind, **place, "data": data})
        session.detach()

    def choose_file(self, path: Path) -> None:
        self.page.get_by_role("button", name="Open", exact=True).click()
        with self.page.expect_file_chooser() as choosing:
            self.page.get_by_role("button", name="Choose a file").click()
        choosing.value.set_files(path)

    def paste(self, row: int, field: str, text: str) -> None:
        """Pastes a text into a cell, without the clipboard."""
        self.cell(row, field).click()
        script = """text => {
            const data = new DataTransfer();
            data.setData("text/plain", text);
            document.activeElement.dispatchEvent(new ClipboardEvent("paste", {clipboardData: data, bubbles: true}));
        }"""
        self.page.evaluate(script, text)

    def click(self, name: str) -> None:
        self.page.get_by_role("button", name=name, exact=True).click()

    def choose(self, menu: str, entry: str) -> None:
        """Chooses an entry of a menu, which closes."""
        self.page.get_by_role("button", name=menu).click()
        self.page.locator(".q-menu").get_by_text(entry, exact=True).click()
        self.page.wait_for_function("!document.querySelector('.q-menu')")  # it holds the cursor

    def send_past_the_page(self, size: int) -> None:
        """Sends a file of a size [B] that the page itself would refuse."""
        script = """async size => {
            const {id} = document.querySelector('.studio > .q-uploader'), form = new FormData();
            form.append("huge.csv", new File([new Uint8Array(size)], "huge.csv"));
            await fetch(getElement(Number(id.slice(1))).$props.url, {method: 'POST', body: form});
        }"""
        self.page.evaluate(script, size)

    def save(self, what: str) -> tuple[str, bytes]:
        """Chooses an entry of the menu; gives the name and the bytes that are downloaded."""
        with self.page.expect_download() as saving:
            self.choose("Save", what)
        return saving.value.suggested_filename, saving.value.path().read_bytes()

    def sliders(self) -> list[float]:
        return [float(slider.input_value()) for slider in self.page.locator(".joint-slider input[type=range]").all()]

    def set_sliders(self, values: list[float]) -> None:
        """Types joint values, in the units of the page, and waits until they are those of the arm that is drawn."""
        self.settle()
        for box, value in zip(self.page.locator(".joint-slider-number").all(), values, strict=True):
            box.fill(str(value))
            box.press("Enter")
            box.blur()
        self.page.locator(".joint-sliders[aria-busy=false]").wait_for()
        drawn = "new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
        self.page.evaluate(drawn)
        self.page.wait_for_function("!document.querySelector('.arm-view').goes")

    def pose(self, name: str) -> list[list[float]]:
        """The matrix that three.js draws a node with, row by row."""
        script = """name => {
            const scene = document.querySelector('.arm-view').scene;
            scene.updateMatrixWorld();
            return scene.getObjectByName(name).matrixWorld.elements.slice();
        }"""
        numbers = self.page.evaluate(script, name)
        return [[numbers[4 * column + row] for column in range(4)] for row in range(4)]

    def pixel(self, name: str, *place: float) -> Any:
        """Where a place in a node [m], or its origin, is in the window [px]."""
        script = """([name, place]) => {
            const { camera, scene } = document.querySelector('.arm-view');
            const node = scene.getObjectByName(name), box = document.querySelector('.arm-view canvas').getBoundingClientRect();
            scene.updateMatrixWorld(), camera.updateMatrixWorld();
            const point = node.position.clone().set(...place).applyMatrix4(node.matrixWorld).project(camera);
            return [box.left + (point.x + 1) / 2 * box.width, box.top + (1 - point.y) / 2 * box.height];
        }"""
        return np.array(self.page.evaluate(script, [name, place or (0.0, 0.0, 0.0)]))

    def wait_for_pose(self, name: str, pose: Any) -> None:
        script = """([name, expected]) => {
            const node = document.querySelector('.arm-view').scene.getObjectByName(name);
            node?.updateWorldMatrix(true, false);
            return node?.matrixWorld.elements.every((x, i) => Math.abs(x - expected[i]) < 1e-6);
        }"""
        self.page.wait_for_function(script, arg=[name, as_matrices(pose).T.ravel().tolist()])

    def wait_for_tool0(self, arm: Manipulator, q: list[float] | None = None) -> None:
        """Waits until tool0 is drawn where the DH product has it, at joint values or at those of the sliders."""
        self.wait_for_pose("tool0", forward_kinematics(arm, self.sliders() if q is None else q))

    def switch_layers(self, *names: str) -> None:
        """Shows or hides rare layers, which are in the menu above the scene."""
        self.page.get_by_role("button", name="more layers").click()
        for name in names:
            self.page.get_by_role("dialog", name="more layers").get_by_role("checkbox", name=name, exact=True).click()
        self.page.keyboard.press("Escape")
        self.page.wait_for_function("!document.querySelector('.q-menu')")

    def press(self, name: str) -> None:
        """Presses a button that moves the joints, and waits until the sliders have moved."""
        with self.other_joints():
            self.page.get_by_role("button", name=name).click()

    def wait_for_cell(self, row: int, field: str, text: str) -> None:
        self.page.locator(f"{self._cell(row, field)}:text-is('{text}')").wait_for()

    def wait_for_cells(self, row: int, **texts: str) -> None:
        for field, text in texts.items():
            self.wait_for_cell(row, field, text)

    def wait_for_lesson(self, progress: float) -> None:
        """Waits until the frame of the explained row has done so many motions."""
        self.page.locator(f'.studio-lesson[data-progress="{progress:.2f}"]').wait_for()

    def wait_for_arrow(self, name: str, tip: Any) -> None:
        script = """([name, tip]) => {
            const head = document.querySelector('.arm-view').scene.getObjectByName(name)?.children.find(part => part.isMesh);
            return head?.position.toArray().every((x, i) => Math.abs(x - tip[i]) < 1e-6);
        }"""
        self.page.wait_for_function(script, arg=[name, list(tip)])

    def wait_for_triangles(self, count: int) -> None:
        """Waits until so many triangles of links are in the scene, and no mesh is on its way."""
        script = """count => {
            let found = 0;
            document.querySelector('.arm-view').scene.traverse(part => found += part.isMesh && part.visible &&
                part.userData.layer === 'links' ? (part.geometry.index ?? part.geometry.attributes.position).count / 3 : 0);
            return found > count && !document.querySelector('.arm-view-progress');
        }"""
        self.page.wait_for_function(script, arg=count)

    def serious(self, where: str = "document") -> list[Any]:
        """What axe-core finds on the page, or in an element of it, and calls more than minor."""
        axe = pytest.importorskip("axe_playwright_python")
        self.page.mouse.move(1, 1)  # No tooltip, and nothing that is still fading away.
        self.page.wait_for_function(STILL)
        if not self.page.evaluate("Boolean(window.axe)"):
            self.page.evaluate((Path(axe.__file__).parent / "axe.min.js").read_text("utf-8"))
        options = "{resultTypes: ['violations']}"  # no list of all that is good
        found = self.page.evaluate(f"axe.run({where}, {options}).then(({{violations}}) => violations)")
        serious = [one for one in found if one["impact"] != "minor"]
        return [(one["id"], [node["failureSummary"] for node in one["nodes"]]) for one in serious]

    def foreign(self) -> list[str]:
        here = urlsplit(self.address).netloc
        return [
            url for url in self.asked if urlsplit(url).scheme not in ("data", "blob") and urlsplit(url).netloc != here
        ]


@pytest.fixture(scope="session")
def profile(chromium: Browser, request: pytest.FixtureRequest) -> Iterator[BrowserContext]:
    """The profile of the browser that all tabs share: what they show differs by the tab alone."""
    context = chromium.new_context(accept_downloads=True)
    if request.config.getoption("--renew"):  # pictures are those of a browser with a graphics card
        context.add_init_script(SMOOTH)
    context.set_default_timeout(PATIENCE)
    yield context
    context.close()


@pytest.fixture
def new_tab(profile: BrowserContext, parked: dict[str, list[Page]]) -> Iterator[Callable[..., Tab]]:
    """Opens tabs; none may ask for anything from elsewhere, or have a fault."""
    tabs: list[Tab] = []
    excused: list[Tab] = []

    def open_tab(address: str, *, width: int = 1280, height: int = 720, faults: bool = True) -> Tab:
        page = parked[address].pop() if parked.get(address) else profile.new_page()
        page.bring_to_front()  # of a tab behind another one, Chromium draws one picture a second
        page.set_viewport_size({"width": width, "height": height})
        tabs.append(Tab(page, address))
        if not faults:  # its server goes away on purpose, and the browser complains
            excused.append(tabs[-1])
        return tabs[-1]

    yield open_tab
    for tab in tabs:
        if tab.address in parked and tab not in excused and not tab.page.is_closed():
            tab.leave()
            parked[tab.address].append(tab.page)
        else:
            tab.page.close()
    for tab in tabs:
        assert tab.foreign() == []
        assert tab in excused or tab.faults == []


@pytest.fixture
def open_view(new_tab: Callable[..., Tab]) -> Callable[..., AbstractContextManager[Tab]]:
    """Opens `dh2urdf view` of some files in a tab, which has so many sliders."""

    @contextmanager
    def opened(*files: Path, sliders: int, faults: bool = True) -> Iterator[Tab]:
        with served("view", *files) as address:
            tab = new_tab(address, faults=faults)
            tab.page.goto(address)
            tab.page.wait_for_function(f"document.querySelectorAll('.joint-slider').length === {sliders}")
            tab.page.wait_for_function("document.querySelector('.arm-view')?.shown > 0")
            yield tab
            tab.page.close()  # before its server ends, of which it would complain

    return opened


@pytest.fixture
def tab(studio_address: str, new_tab: Callable[..., Tab]) -> Tab:
    """A tab of the studio that is not open yet, and may use the clipboard."""
    tab = new_tab(studio_address)
    tab.page.context.grant_permissions(["clipboard-read", "clipboard-write"], origin=studio_address.rstrip("/"))
    return tab


@pytest.fixture(scope="session")
def example_robots() -> Path:
    """The folder of the descriptions in example-robot-data."""
    from importlib.util import find_spec

    spec = find_spec("cmeel")
    places = (spec.submodule_search_locations or ()) if spec else ()
    folders = [Path(place).parent / "cmeel.prefix" / "share" / "example-robot-data" / "robots" for place in places]
    found = [folder for folder in folders if folder.is_dir()]
    if not found:
        pytest.skip("example-robot-data is not installed")
    return found[0]
