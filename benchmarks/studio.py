"""How soon an edit is on the screen of the studio, measured in the browser.

A letter is typed into a cell, or an arrow key moves a slider; what is measured is the time from the key to the frame in
which the scene has been drawn with the new arm. On the way are the socket, the reader, both variants of the transform
and three.js. Wants the extra `studio`, Playwright and a Chromium:

    python benchmarks/studio.py
"""

from __future__ import annotations

import argparse
import re
import shutil
import signal
import subprocess
import sys
import tempfile
from contextlib import contextmanager
from pathlib import Path
from statistics import median
from typing import TYPE_CHECKING

from measuring import machine, table
from playwright.sync_api import sync_playwright

if TYPE_CHECKING:
    from collections.abc import Iterator

    from playwright.sync_api import Page

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
POLLING = 50
"""How often the script looks whether a picture is there [ms]."""


@contextmanager
def studio(path: Path) -> Iterator[str]:
    """The address of a studio that has a table open."""
    command = [Path(sys.executable).parent / "dh2urdf", "studio", path, "--no-browser", "--port", "0"]
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
    """A number in row 2 gets a digit more, and another one; in ms."""
    opened(page, address, "shown")
    page.locator(".dh-table .ag-row[row-index='1'] .ag-cell[col-id='a']").dblclick()
    field = page.locator(".ag-cell-inline-editing input")
    field.fill("0.1")
    for number in range(rounds):
        field.press(str(number % 9 + 1))
        page.wait_for_function("count => times.length === count", arg=number + 1, polling=POLLING)
    return page.evaluate("times")


def slid(page: Page, address: str, rounds: int) -> list[float]:
    """An arrow key moves a slider by a step; in ms."""
    opened(page, address, "drawn")
    page.locator(".joint-slider input[type=range]").nth(1).focus()
    for number in range(rounds):
        page.keyboard.press("ArrowRight")
        page.wait_for_function("count => times.length === count", arg=number + 1, polling=POLLING)
    return page.evaluate("times")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=50)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        print(machine(Path(folder), PACKAGES))
        long = Path(folder) / "long.csv"
        long.write_text(LONG)
        chromium = shutil.which("chromium") or shutil.which("chromium-browser")
        browser = playwright.chromium.launch(
            executable_path=chromium, args=["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-sandbox"]
        )
        print(f"Chromium {browser.version}, headless, drawn in software, 1280 x 720; {rounds} rounds each\n")
        rows = []
        for path, arm in ((PANDA, "Panda, 7 axes"), (long, "100 axes")):
            with studio(path) as address:
                for measure, told in ((typed, "a letter in a cell"), (slid, "a step of a slider")):
                    page = browser.new_page(viewport={"width": 1280, "height": 720})
                    first, *others = measure(page, address, rounds + 1)
                    page.close()
                    rows.append((f"{arm}: {told}", *(f"{x:.0f}" for x in (median(others), max(others), first))))
        browser.close()
    table(("from a key to the screen", "median, ms", "maximum, ms", "before them, the first, ms"), rows)


if __name__ == "__main__":
    main()
