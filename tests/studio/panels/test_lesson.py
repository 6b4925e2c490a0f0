"""The row that is explained: its words, and the panel in the browser."""

import re
from collections import Counter
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from dh2urdf.kinematics import dh_frames, dh_transform
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Convention
from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import Session
from dh2urdf_studio.panels.lesson import explained


def matrices(html: str) -> list[list[list[str]]]:
    """The cells of every matrix."""
    return [
        [re.findall(r"<td>(.*?)</td>", row) for row in re.findall(r"<tr>(.*?)</tr>", table)]
        for table in re.findall(r"<table.*?</table>", html)
    ]


def evaluated(cells: list[list[str]], a: float, alpha: float, d: float, theta: float) -> NDArray[np.float64]:
    """A matrix of symbols at some values."""
    values = {"cθ": np.cos(theta), "sθ": np.sin(theta), "cα": np.cos(alpha), "sα": np.sin(alpha), "a": a, "d": d}

    def number(cell: str) -> float:
        sign = -1.0 if cell.startswith("−") else 1.0
        factors = cell.removeprefix("−").split()
        return sign * float(np.prod([values[each] if each in values else float(each) for each in factors]))

    return np.array([[number(cell) for cell in row] for row in cells])


def numbers_of(cells: list[list[str]]) -> NDArray[np.float64]:
    return np.array([[float(cell.replace("−", "-")) for cell in line] for line in cells])


@pytest.mark.parametrize("file", ["ur5.csv", "panda.yaml", "scara.csv"])
@pytest.mark.parametrize("length", ["m", "mm"])
def test_the_matrices_are_those_of_the_row(catalog: Catalog, file: str, length: str) -> None:
    """The symbols, evaluated, are the numbers beside them; T is the product of the rows so far, lengths in the unit.

    In the other convention the product of all rows, and of what is left over, is the same arm.
    """
    session = Session(catalog, gallery_table(file, catalog))
    session.set_units(length, "rad", convert=True)
    assert session.arm is not None
    arm = session.arm.manipulator
    session.move({row.joint: 0.1 * number - 0.25 for number, row in enumerate(arm.moving_rows)})
    factor = 1000.0 if length == "mm" else 1.0
    frames = dh_frames(arm, [session.q.get(row.joint, 0.0) for row in arm.moving_rows])
    products = []
    for number, row in enumerate(arm.rows):
        symbols, here, whole, other, there = matrices(explained(arm, number, session.q, session.table))
        q = session.q.get(row.joint, 0.0)
        slides, turns = row.type.value == "prismatic", row.type.value in ("revolute", "continuous")
        d = row.d + (row.offset + row.sign * q if slides else 0.0)
        theta = row.theta + (row.offset + row.sign * q if turns else 0.0)
        expected = evaluated(symbols, row.a * factor, row.alpha, d * factor, theta)
        assert np.abs(numbers_of(here) - expected).max() < 6e-5
        product = as_matrices(frames[number + 1])
        product[:3, 3] *= factor
        assert np.abs(numbers_of(whole) - product).max() < 6e-5
        numbers = numbers_of(there)
        neighbour = number - 1 if arm.convention is Convention.STANDARD else number + 1
        a, alpha = (arm.rows[neighbour].a, arm.rows[neighbour].alpha) if 0 <= neighbour < len(arm.rows) else (0.0, 0.0)
        assert np.abs(numbers - evaluated(other, a * factor, alpha, d * factor, theta)).max() < 6e-5
        products.append(numbers)
    first, last = as_matrices(frames[0]), arm.rows[-1 if arm.convention is Convention.STANDARD else 0]
    left = as_matrices(dh_transform(Convention.MODIFIED, a=last.a * factor, alpha=last.alpha, d=0.0, theta=0.0))
    first[:3, 3] *= factor
    both = [first, *products, left] if arm.convention is Convention.STANDARD else [first, left, *products]
    assert np.abs(np.linalg.multi_dot(both) - product).max() < 1e-3 * factor, "it is the same arm"


@pytest.mark.long
def test_a_row_in_the_browser(tab: Any, catalog: Catalog) -> None:
    """Opened, it asks for a row; a picked row is explained; a motion is played; closed, its strokes are gone."""
    page = tab.open("ur5")
    hat = page.get_by_role("button", name="explain the picked row")
    hat.click()
    page.get_by_text("Pick a row of the table, or a link of the arm.").wait_for()
    tab.cell(1, "a").click()
    page.get_by_text("A2 = Rz(θ) Tz(d) Tx(a) Rx(α)").wait_for()
    session = Session(catalog, gallery_table("ur5.csv", catalog))
    session.picked, session.lesson = session.history.keys[1], 4.0
    arrows = {stroke.field: stroke.points[-1] for stroke in session.strokes()}
    for field in "xyz":
        tab.wait_for_arrow(f"{field} 2", arrows[field])
    page.get_by_text("z1 and z2 are parallel: they have a common normal at every point").wait_for()
    assert strokes_of_normals(page) == {"foot 2": 2, "line": 2}, "a is the normal"
    frames = """() => [...document.querySelectorAll('.arm-view-frames-label')]
        .filter(label => label.style.visibility === 'visible').map(label => label.textContent).sort().join()"""
    page.wait_for_function(f"({frames})() === '{{1}},{{2}}'")  # No other frame is named beside those of the row.
    page.get_by_role("button", name="play").click()
    page.wait_for_function("Number(document.querySelector('.studio-lesson').dataset.progress) < 1")
    tab.wait_for_lesson(4.0)
    page.get_by_role("button", name="1 Rz(θ)").click()
    tab.wait_for_lesson(1.0)
    tab.type_into(1, "a", "-0.5")
    tab.cell(1, "a").click()
    page.get_by_text("a = -0.5 m").wait_for()
    hat.click()
    page.get_by_text("A2 = Rz(θ)").wait_for(state="hidden")
    page.wait_for_function("!document.querySelector('.arm-view-x')")
    tab.switch_layers("common normals")
    session.edit(1, "a", "-0.5")
    (product,) = (stroke for stroke in session.drawing.normals(session.q, 4) if stroke.field == "normal")
    tab.wait_for_arrow("normal 5", product.points[-1])
    drawn = strokes_of_normals(page)
    assert drawn == Counter(
        f"{stroke.field} {stroke.row + 1}" if stroke.row is not None else stroke.field
        for stroke in session.drawing.normals(session.q)
    )
    page.locator(".arm-view-normal", has_text="|a₂| = 0.5 m").wait_for()


def strokes_of_normals(page: Any) -> Counter[str]:
    """The names of axes, feet, normals and offsets in the scene."""
    script = "document.querySelector('.arm-view').scene.children[1].children.map(stroke => stroke.name)"
    return Counter(name for name in page.evaluate(script) if name.split()[0] in ("line", "normal", "offset", "foot"))
