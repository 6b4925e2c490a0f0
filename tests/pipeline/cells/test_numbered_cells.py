"""Cells of variants and of varied placements: which cell has which arms, where they stand, and that each is made alone."""

import json
from collections.abc import Callable
from itertools import product
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from pinocchio_frames import pinocchio_frames
from plain_frames import dh, shift, turn

from dh2urdf.cells.cell import Cell
from dh2urdf.plugin_system import load
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import make_plan
from dh2urdf.stages import Rejected
from dh2urdf.tasks.batch import Expected, batches, items
from dh2urdf.variations.variation import Variants

TABLES = {
    "arm": "# convention: standard\njoint,a,alpha,d,theta\npan,0.1,pi/2,0.3,0\nlift,0.4,0,0,0\nroll,0.2,0.3,0.1,0.5\n",
    "slide": "# convention: standard\njoint,type,a,alpha,d,theta,lower,upper\nrail,prismatic,0.1,0.4,0.2,0,-1,1\n",
}
VARIATIONS = """
inputs: [arm.csv, slide.csv]
variations:
  - {name: v, of: arm, count: 3, seed: 4, vary: [{joints: [1, 2], field: a, scale: [0.5, 2]}]}
  - {name: w, of: arm, count: COUNT, seed: 5, vary: [{joints: 3, field: d, uniform: [0.1, 0.5]}]}
"""


@pytest.fixture
def run_file(tmp_path: Path) -> Callable[..., Path]:
    """A run file with cells, beside the tables."""

    def write(cells: str, count: int = 3) -> Path:
        for name, text in TABLES.items():
            (tmp_path / f"{name}.csv").write_text(text)
        (tmp_path / "run.yaml").write_text(VARIATIONS.replace("COUNT", str(count)) + cells)
        return tmp_path / "run.yaml"

    return write


@pytest.fixture
def made(cli: Cli, run_file: Callable[..., Path], tmp_path: Path) -> Callable[..., dict[str, Any]]:
    """The rows of the manipulators of a run, by their names."""

    def run(cells: str, *words: str, count: int = 3) -> dict[str, Any]:
        answer = cli("run", run_file(cells, count), "-o", tmp_path / "out", *words)
        assert answer.stderr == ""
        report = json.loads((tmp_path / "out/report.json").read_bytes())
        return {row["name"]: row for row in report["manipulators"]}

    return run


def whats(path: Path) -> list[Any]:
    plan = make_plan(load_config(path), load())
    return [what for item in items(plan, Expected(plan)) for what in item.each]


CELLS = """
cells:
  - name: c
    arms:
      - {name: left, of: v, parent: rail/tool0, xyz: [0, 0.1, 0.2], rpy: [0.3, 0, 0]}
      - {name: rail, of: slide, xyz: [0, 2, 0]}
      - {name: right, of: w}
      - {name: fixed, of: arm, xyz: [0, -2, 0]}
MORE
"""


# --- Which arms -------------------------------------------------------------------------------------------------------


def test_variants_are_paired_by_their_numbers(run_file: Callable[..., Path]) -> None:
    """Cell k has variant k of every arm that is a variation; another arm is the same in all."""
    found = {what.name: what for what in whats(run_file(CELLS.replace("MORE", "")))}
    cells = [what for what in found.values() if isinstance(what, Cell)]
    assert [cell.name for cell in cells] == ["c_1", "c_2", "c_3"]
    for number, cell in enumerate(cells, start=1):
        of = {arm.name: arm.of for arm in cell.call.arms}
        assert of == {"rail": "slide", "left": f"v_{number}", "right": f"w_{number}", "fixed": "arm"}
        assert all(cell.manipulators[name] == found[name] for name in of.values())


def test_all_combinations_are_made_in_the_order_of_the_arms(run_file: Callable[..., Path]) -> None:
    """The variants of the last arm go fastest; numbers have as many digits as the last one of their variation."""
    found = whats(run_file(CELLS.replace("MORE", "    combine: all"), count=10))
    cells = [what for what in found if isinstance(what, Cell)]
    numbers = list(product(range(1, 4), range(1, 11)))
    assert [cell.name for cell in cells] == [f"c_{left}_{right:02}" for left, right in numbers]
    for (left, right), cell in zip(numbers, cells, strict=True):
        of = {arm.name: arm.of for arm in cell.call.arms}
        assert (of["left"], of["right"]) == (f"v_{left}", f"w_{right:02}")


def test_unequal_counts_are_refused(run_file: Callable[..., Path]) -> None:
    """The cell fails alone, with both counts; a variation is nobody's twice."""
    (bad,) = (what for what in whats(run_file(CELLS.replace("MORE", ""), count=7)) if isinstance(what, Rejected))
    assert bad.name == "c"
    (problem,) = bad.problems
    assert (problem.code, problem.mark and problem.mark.line) == ("variants-unpaired", 8)


@pytest.mark.parametrize("name", ["arm", "v"])
def test_a_name_of_a_manipulator_is_that_manipulator(run_file: Callable[..., Path], name: str) -> None:
    """A variation without a name has that of its manipulator; where another manipulator has its name, which is unclear."""
    path = run_file(f"cells: [{{name: c, arms: [{{name: left, of: {name}}}]}}]\n")
    if name == "v":
        (path.parent / "arm.csv").write_text(
            TABLES["arm"].replace("joint,", "robot,joint,").replace("\npan", "\nv,pan")
        )
        text = path.read_text().replace("inputs: [", "inputs: [more.yaml, ")
        (path.parent / "more.yaml").write_text("name: v\nconvention: standard\njoints: [{a: 1, alpha: 0, d: 0}]\n")
        (path.parent / "arm.csv").write_text(TABLES["arm"])
        path.write_text(text)
        (bad,) = (what for what in whats(path) if isinstance(what, Rejected))
        assert [problem.code for problem in bad.problems] == ["made-of-either"]
    else:
        path.write_text(path.read_text().replace("name: v, ", ""))
        (cell,) = (what for what in whats(path) if isinstance(what, Cell))
        assert (cell.name, cell.call.arms[0].of) == ("c", "arm")


def test_a_cell_of_a_thousand_million_is_made_alone(run_file: Callable[..., Path]) -> None:
    """None of the others is drawn for it, and none is kept: the cells are a range of numbers until a batch comes."""
    more = "    combine: all\n    vary: [{arm: right, field: xyz, offset: [-1, 1]}]"
    path = run_file(CELLS.replace("MORE", more), count=300_000_000)
    plan = make_plan(load_config(path), load())
    (cells,) = (item.what for item in items(plan, Expected(plan)) if item.is_slow)
    assert isinstance(cells, Variants)
    assert len(cells) == 900_000_000
    last = cells.part(len(cells) - 1, len(cells))
    (cell,) = last.tables()
    assert last.names == [cell.name] == ["c_3_300000000"]
    assert {arm.name: arm.of for arm in cell.call.arms}["right"] == "w_300000000"
    sizes = [len(batch) for batch, _ in zip(batches(plan, Expected(plan)), range(20), strict=False)]
    assert max(sizes) <= 16


# --- Where they stand -------------------------------------------------------------------------------------------------


def test_every_cell_is_where_its_drawn_values_have_it(made: Callable[..., Any], tmp_path: Path) -> None:
    """Pinocchio finds both tools at the product of placements and rows, with the numbers that the report has."""
    more = """    vary:
      - {arm: right, field: xyz, uniform: [-0.5, 0.5]}
      - {arm: right, field: yaw, normal: {deviation: 10 deg, bounds: [-30 deg, 30 deg]}}
      - {arm: left, field: x, grid: [0.1, 0.2]}
    sampling: latin-hypercube"""
    rows = made(CELLS.replace("MORE", more))
    lefts = []
    for number in (1, 2, 3):
        row = rows[f"c_{number}"]
        drawn = row["drawn"]
        assert row["status"] == "ok"
        assert all(proof["position_error"] < 1e-14 for proof in row["proof"].values())
        assert drawn["left/a_1"] == rows[f"v_{number}"]["drawn"]["a_1"]
        assert drawn["right/d_3"] == rows[f"w_{number}"]["drawn"]["d_3"]
        assert abs(drawn["right/yaw"]) < pi / 6
        lefts.append(drawn["left/x"])
        q = {"rail_rail": 0.7, "left_pan": 0.3, "left_lift": -0.8, "left_roll": 1.1}
        q |= {"right_pan": -0.4, "right_lift": 0.6, "right_roll": 0.2}
        rail = shift(0, 2, 0) @ dh("standard", 0, 0.2 + 0.7, 0.1, 0.4)
        left = rail @ shift(drawn["left/x"], 0.1, 0.2) @ turn("x", 0.3)
        for row in ((0.3, 0.3, drawn["left/a_1"], pi / 2), (-0.8, 0, drawn["left/a_2"], 0), (1.6, 0.1, 0.2, 0.3)):
            left = left @ dh("standard", *row)
        right = shift(drawn["right/x"], drawn["right/y"], drawn["right/z"]) @ turn("z", drawn["right/yaw"])
        for row in ((-0.4, 0.3, 0.1, pi / 2), (0.6, 0, 0.4, 0), (0.7, drawn["right/d_3"], 0.2, 0.3)):
            right = right @ dh("standard", *row)
        frame = pinocchio_frames(tmp_path / f"out/c_{number}.urdf")
        for link, wanted in (("left_tool0", left), ("right_tool0", right)):
            assert np.abs(frame(q, link) - wanted).max() < 1e-12, (number, link)
    assert lefts == [0.1, 0.2, 0.1]


def test_placements_are_drawn_apart_from_variants(made: Callable[..., Any]) -> None:
    """The seed of the cells is that of the variation, and still the placement says nothing about the variant."""
    more = "    seed: 5\n    vary: {arm: fixed, field: x, uniform: [0.1, 0.5]}"
    rows = made(CELLS.replace("MORE", more))
    shares = [rows[f"c_{number}"]["drawn"] for number in (1, 2, 3)]
    assert all(abs(drawn["fixed/x"] - drawn["right/d_3"]) > 1e-6 for drawn in shares)


def test_placements_alone_make_cells(made: Callable[..., Any]) -> None:
    """As many as the grid has points, or as the count says; a latin hypercube has one in each part of a range."""
    rows = made("""
cells:
  - {name: g, arms: [{name: l, of: arm, xyz: [2, 0, 0]}], vary: [{arm: l, field: x, grid: [1, 3]}, {arm: l, field: roll, grid: [0, 1, 2]}]}
  - {name: s, arms: [{name: l, of: arm, xyz: [2, 0, 0]}], count: 10, sampling: latin-hypercube, vary: {arm: l, field: x, scale: [1, 2]}}
""")
    drawn = [row["drawn"] for name, row in rows.items() if name.startswith("g_")]
    assert drawn == [{"l/x": x, "l/roll": roll} for x in (1, 3) for roll in (0, 1, 2)]
    found = [row["drawn"]["l/x"] for name, row in rows.items() if name.startswith("s_")]
    assert sorted(int((x - 2) / 2 * 10) for x in found) == list(range(10))
    assert len(rows) == 2 + 6 + 10 + 6


def test_an_impossible_variant_fails_its_cell_alone(cli: Cli, run_file: Callable[..., Path]) -> None:
    """The message names the arm, and why there is no such variant."""
    cells = """  - {name: u, of: slide, vary: [{joints: 1, field: lower, grid: [0, 2]}]}
cells: {name: c, arms: [{name: l, of: u}]}
"""
    path = run_file(cells)
    cli("run", path, "-o", path.parent / "out", status=1)
    report = json.loads((path.parent / "out/report.json").read_bytes())
    rows = {row["name"]: row for row in report["manipulators"]}
    assert {name: row["status"] for name, row in rows.items() if name[0] in "cu"} == {
        "c_1": "ok",
        "c_2": "failed",
        "u_1": "ok",
        "u_2": "failed",
    }
    assert [error["code"] for error in rows["c_2"]["errors"]] == ["not-made", "drawn-limits-exchanged"]


# --- Anywhere, and again ----------------------------------------------------------------------------------------------

VARIED = CELLS.replace("MORE", "    combine: all\n    vary: [{arm: right, field: xyz, offset: [-1, 1]}]")


def files_in(folder: Path) -> dict[str, bytes]:
    return {
        str(path.relative_to(folder)): path.read_bytes()
        for path in folder.rglob("*")
        if path.is_file() and path.name != "timing.json"
    }


@pytest.mark.parametrize("layout", ["files", "folders, size: 4", "shards, size: 4"])
def test_two_runs_give_the_same_bytes(made: Callable[..., Any], tmp_path: Path, layout: str) -> None:
    """By one worker or by two, in every layout; a run that resumes makes nothing anew but what is gone."""
    output = f"output: {{directory: out, layout: {layout}}}\n"
    made(VARIED + output)
    first = files_in(tmp_path / "out")
    made(VARIED + output, "--set", "execution.options.workers=2")
    assert files_in(tmp_path / "out") == first
    lost = next(path for path in sorted((tmp_path / "out").rglob("*")) if path.name.startswith(("c_2_2", "000001.tar")))
    lost.unlink()
    answer = made(VARIED + output, "--resume")
    assert files_in(tmp_path / "out") == first
    assert len([name for name in answer if name.startswith("c_")]) == 9


def test_a_table_that_changes_makes_its_cells_anew(cli: Cli, run_file: Callable[..., Path]) -> None:
    """A run that resumes keeps what depends on other tables."""
    path = run_file(VARIED)
    cli("run", path, "-o", path.parent / "out")
    slide = path.parent / "slide.csv"
    slide.write_text(slide.read_text().replace("0.2", "0.25"))
    answer = cli("run", path, "-o", path.parent / "out", "--resume")
    assert "10 made, 7 unchanged" in answer.stdout.replace("\n", " ")  # the slide and nine cells


def test_a_dry_run_names_them(cli: Cli, run_file: Callable[..., Path]) -> None:
    """It makes their robots, and writes nothing."""
    path = run_file(VARIED)
    answer = cli("run", path, "-o", path.parent / "out", "--dry-run")
    assert all(f"c_{left}_{right} " in answer.stdout for left in (1, 2, 3) for right in (1, 2, 3))
    assert not (path.parent / "out").exists()
