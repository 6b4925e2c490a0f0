"""How soon an edit is on the screen of the studio, measured in the browser.

A letter is typed into a cell, or an arrow key moves a slider; what is measured is the time from the key to the frame in
which the scene has been drawn with the new arm. On the way are the socket, the reader, both variants of the transform
and three.js. Wants the extra `studio`, Playwright and a Chromium:

    python benchmarks/studio.py
    python benchmarks/studio.py --meshes
    python benchmarks/studio.py --meshes robot.urdf

At the end it is how many poses of an arm are drawn in a second, while a program sends 100. With `--meshes` it is how
soon `dh2urdf view` shows an arm whose meshes have 30 MB, or another description.
"""

from __future__ import annotations

import argparse
import http.client
import itertools
import json
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING
from urllib.parse import urlsplit

from measuring import machine, table
from playwright.sync_api import sync_playwright

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Browser, Page

PANDA = Path(__file__).parents[1] / "configs" / "tables" / "panda.yaml"
LONG = "# convention: standard\na, alpha, d\n" + "0.1, pi/2, 0\n" * 100
PACKAGES = ("dh2urdf", "nicegui", "playwright")

# From each key to the first picture after the scene has taken a new arm or pose. It watches the counters of the scene
# as they are set: to ask for them in every frame would be work for the browser by itself. A pixel of the picture is
# read, because drawing is only ordered when it returns.
STOPWATCH = """counter => {
    const view = document.querySelector('.arm-view'), counts = {shown: view.shown, drawn: view.drawn};
    const gl = view.querySelector('canvas').getContext('webgl2');
    window.times = [];
    let start = null, changed = false;
    document.addEventListener('keydown', () => ([start, changed] = [performance.now(), counter === 'drawn']), true);
    const watch = (name, then) => Object.defineProperty(view, name, {
        get: () => counts[name],
        set: count => { counts[name] = count; then(); },
    });
    watch('shown', () => (changed = start !== null));
    watch('drawn', () => {
        if (start === null || !changed) return;
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
        times.push(performance.now() - start);
        start = null;
    });
}"""
HAND = 300
"""How long a hand takes from the mouse to the first key [ms]."""
POLLING = 50
"""How often the script looks whether a picture is there [ms]."""


@contextmanager
def studio(path: Path, command_name: str = "studio") -> Iterator[str]:
    """The address of a studio that has a table open, or of a view."""
    command = [Path(sys.executable).parent / "dh2urdf", command_name, path, "--no-browser", "--port", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as server:
        try:
            yield re.findall(r"http://\S+", next(iter(server.stdout or ())))[0]
        finally:
            server.send_signal(signal.SIGINT)


def opened(page: Page, address: str, counter: str) -> None:
    page.goto(address)
    page.wait_for_function("document.querySelector('.arm-view')?.shown > 0")
    page.locator(".studio-status.good").wait_for()
    page.evaluate(STOPWATCH, counter)


def typed(page: Page, address: str, rounds: int) -> list[float]:
    """A number in row 4 gets a digit more, and another one; in ms. The first is the first key on the page."""
    opened(page, address, "shown")
    page.locator(".dh-table .ag-row[row-index='3'] .ag-cell[col-id='a']").dblclick()
    field = page.locator(".ag-cell-inline-editing input")
    field.press("End")  # else the first digit takes the place of the number
    page.wait_for_timeout(HAND)
    for number in range(rounds):
        field.press(str(number % 9 + 1))
        page.wait_for_function("count => times.length === count", arg=number + 1, polling=POLLING)
    return page.evaluate("times")


def slid(page: Page, address: str, rounds: int) -> list[float]:
    """An arrow key moves a slider by a step; in ms."""
    opened(page, address, "drawn")
    page.locator(".joint-slider input[type=range]").nth(1).focus()
    page.wait_for_timeout(HAND)
    for number in range(rounds):
        page.keyboard.press("ArrowRight")
        page.wait_for_function("count => times.length === count", arg=number + 1, polling=POLLING)
    return page.evaluate("times")


def driven(page: Page, address: str, rounds: int) -> list[int]:
    """Poses that are drawn in a second, while a program sends 100."""
    page.goto(address)
    page.wait_for_function("document.querySelector('.arm-view')?.shown > 0")
    stop = threading.Event()

    def send() -> None:
        program = http.client.HTTPConnection(urlsplit(address).netloc)
        for step in itertools.count():
            names = json.dumps({"names": ["panda_joint1"], "positions": [step % 1000 / 1000]})
            program.request("POST", "/set_joint_positions", names, {"Content-Type": "application/json"})
            answer = program.getresponse()
            if answer.status != http.HTTPStatus.OK:
                raise RuntimeError(answer.read())
            answer.read()
            if stop.wait(0.01):
                return

    driving = threading.Thread(target=send)
    driving.start()
    script = """() => {
        const node = document.querySelector('.arm-view').scene.getObjectByName('tool0');
        const poses = new Set(), end = performance.now() + 1000;
        return new Promise((done) => {
            const look = () => {
                poses.add(node.matrix.elements.join());
                performance.now() < end ? requestAnimationFrame(look) : done(poses.size);
            };
            look();
        });
    }"""
    counts = [page.evaluate(script) for _ in range(rounds)]
    stop.set()
    driving.join()
    return counts


def mesh_arm(folder: Path, suffix: str, size: float) -> Path:
    """A description of eight links, each a ball as a file of its own, of about so many MB together."""
    import trimesh

    name = f"arm_{suffix[1:]}"
    links, joints, written, number = [], [], 0.0, 0
    while written < size:
        ball = trimesh.creation.icosphere(subdivisions=6, radius=0.1 + 0.001 * number)  # 81,920 triangles
        path = folder / f"{name}_{number}{suffix}"
        ball.export(path)
        written += path.stat().st_size / 1e6
        mesh = f"<visual><geometry><mesh filename='{path.name}'/></geometry></visual>"
        links.append(f"<link name='link_{number}'>{mesh}</link>")
        ends = f"<parent link='link_{number - 1}'/><child link='link_{number}'/><origin xyz='0.2 0 0.1'/>"
        joints.append(f"<joint name='joint_{number}' type='continuous'>{ends}</joint>" if number else "")
        number += 1
    path = folder / f"{name}.urdf"
    path.write_text(f"<robot name='arm'>{''.join((*links, *joints))}</robot>")
    return path


def seen(page: Page, address: str) -> tuple[float, float]:
    """From asking for the page until its progress bar is there, and until all is drawn; in s."""
    page.goto("about:blank")
    started = time.perf_counter()
    page.goto(address, wait_until="commit")
    page.wait_for_function("document.querySelector('.arm-view')?.shown > 0", polling=POLLING)
    shown = time.perf_counter() - started
    page.wait_for_function("!document.querySelector('.arm-view-progress')", polling=POLLING)
    page.evaluate("""async () => {
        for (let frames = 0; frames < 2; frames++) await new Promise(requestAnimationFrame); // the last mesh is drawn
        const gl = document.querySelector('.arm-view canvas').getContext('webgl2');
        gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    }""")
    return shown, time.perf_counter() - started


def measure_meshes(browser: Browser, folder: Path, own: Path | None, rounds: int) -> None:
    """How soon robots of meshes are seen: right after the server has started, and at a reload."""
    rows = []
    for told, path in ((own.name, own),) if own else ((s, mesh_arm(folder, s, 30.0)) for s in (".stl", ".dae")):
        first, again, bars = [], [], []
        for _ in range(rounds):
            with studio(path, "view") as address:
                page = browser.new_page(viewport={"width": 1280, "height": 720})
                for times in (first, again):
                    bar, all_of_it = seen(page, address)
                    bars.append(bar)
                    times.append(all_of_it)
                page.close()
        rows.append((told, *(f"{median(times):.1f}" for times in (bars, first, again)), f"{max(first):.1f}"))
    head = ("meshes", "bar, s", "all, first page, s", "all, reload, s", "slowest first page, s")
    table(head, rows)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=50)
    parser.add_argument("--meshes", nargs="?", const=True, help="how soon meshes are seen; of DESCRIPTION")
    given = parser.parse_args()
    rounds = given.rounds
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        print(machine(Path(folder), PACKAGES))
        long = Path(folder) / "long.csv"
        long.write_text(LONG)
        chromium = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = playwright.chromium.launch(
            executable_path=chromium, args=["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"]
        )
        print(f"Chromium {browser.version}, headless, drawn in software, 1280 x 720; {rounds} rounds each\n")
        if given.meshes:
            measure_meshes(browser, Path(folder), None if given.meshes is True else Path(given.meshes), rounds)
            browser.close()
            return
        rows = []
        for path, arm in ((PANDA, "Panda, 7 axes"), (long, "100 axes")):
            with studio(path) as address:
                for measure, told in ((typed, "a letter in a cell"), (slid, "a step of a slider")):
                    page = browser.new_page(viewport={"width": 1280, "height": 720})
                    first, *others = measure(page, address, rounds + 1)
                    page.close()
                    rows.append((f"{arm}: {told}", *(f"{x:.0f}" for x in (median(others), max(others), first))))
        with studio(PANDA, "view") as address:
            page = browser.new_page(viewport={"width": 640, "height": 400})
            _, *counts = driven(page, address, min(rounds, 20) + 1)
        browser.close()
    print(f"poses that are drawn in a second: median {median(counts):.0f}, at least {min(counts)}\n")
    table(("from a key to the screen", "median, ms", "maximum, ms", "before them, the first, ms"), rows)


if __name__ == "__main__":
    main()
