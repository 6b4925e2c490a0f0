from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from dh2urdf.cells.cell import ArmCall, CellCall
from dh2urdf.robot import Origin
from dh2urdf.run_file.config import load_config

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.run_file.config import RunConfig


def config(folder: Path, cells: str, *settings: str) -> RunConfig:
    (folder / "a.csv").touch()
    (folder / "run.yaml").write_text(f"inputs: a.csv\ncells:\n{cells}\n")
    return load_config(folder / "run.yaml", settings)


def problem(folder: Path, arms: str) -> str:
    """What is wrong with a cell of these arms, which are in the fourth line of the run file."""
    found = config(folder, f"- name: pair\n  arms: [{arms}]").problems
    assert len(found) == 1, [str(each) for each in found]
    return str(found[0]).removeprefix(f"{folder}/")


def test_a_cell_is_read(tmp_path: Path) -> None:
    """Placements may be expressions with units; prefix, parent and placement have defaults."""
    text = """
  - name: pair
    arms:
      - {name: left, of: ur5, prefix: l-, parent: world, xyz: [1/2, -50 mm, 0.3], rpy: [90 deg, 0, -pi]}
      - {name: right, of: ur5}
      - {name: camera, of: pan tilt, prefix: "", parent: left/tool0}
"""
    read = config(tmp_path, text)
    assert read.problems == ()
    assert read.cells == (
        CellCall(
            name="pair",
            arms=(
                ArmCall(
                    name="left",
                    of="ur5",
                    prefix="l-",
                    placement=Origin(xyz=(0.5, -0.05, 0.3), rpy=(math.pi / 2, 0.0, -math.pi)),
                ),
                ArmCall(name="right", of="ur5", prefix="right_"),
                ArmCall(name="camera", of="pan tilt", prefix="", parent="left", link="tool0"),
            ),
        ),
    )
    mark = read.cells[0].arms[2].parent_mark
    assert mark is not None
    assert (mark.line, mark.column) == (8, 58)


def test_arms_stand_after_what_holds_them(tmp_path: Path) -> None:
    """The order in the file does not matter, and is kept otherwise."""
    text = """
  - name: pile
    arms:
      - {name: c, of: x, parent: b/tool0}
      - {name: d, of: x, parent: world}
      - {name: b, of: x, parent: a/tool0}
      - {name: a, of: x}
"""
    (cell,) = config(tmp_path, text).cells
    assert [arm.name for arm in cell.arms] == ["d", "a", "b", "c"]


@pytest.mark.parametrize(
    ("arms", "place", "message"),
    [
        ("{name: a, of: x, parent: b/tool0}, {name: b, of: x, parent: a/tool0}", "4:35", "hold each other in a circle"),
        ("{name: left, of: x}, {name: hand, of: x, parent: left}", "4:59", "an arm's tool is 'left/tool0'"),
        ("{name: a, of: x}, {name: b, of: x, parent: c/tool0}", "4:53", "the cell has no arm 'c' that could hold 'b'"),
        ("{name: a, of: x, prefix: p}, {name: b, of: x, prefix: p}", "4:39", "the first is at run.yaml:4:10"),
        ("{name: a}", "4:10", "field 'cells.0.arms.0.of': a run file needs this key"),
        ("", "4:9", "a run file cannot take an empty list here"),
    ],
)
def test_a_faulty_cell_is_an_error_at_its_place(tmp_path: Path, arms: str, place: str, message: str) -> None:
    """Line and column, and what is wrong."""
    found = problem(tmp_path, arms).replace(f"{tmp_path}/", "")
    assert found.startswith(f"run.yaml:{place}: error: ")
    assert message in found


def test_all_faults_are_said_at_once(tmp_path: Path) -> None:
    """One of every cell and arm, together with those of other sections."""
    text = "- {arms: [{name: a, of: x}]}\n- {name: p, arms: [{of: x}, {name: b}]}\n- 7\nproof: {poses: 0}"
    found = config(tmp_path, text).problems
    assert [each.field for each in found] == [
        *("cells.0.name", "cells.1.arms.0.name", "cells.1.arms.1.of", "cells.2", "proof.poses")
    ]


def test_two_cells_of_one_name_are_refused(tmp_path: Path) -> None:
    """The second is told where the first stands."""
    text = "- {name: p, arms: [{name: a, of: x}]}\n- {name: p, arms: [{name: a, of: x}]}"
    (found,) = config(tmp_path, text).problems
    assert found.message == "two cells are named 'p'"
    assert found.mark is not None
    assert found.mark.line == 4
    assert found.suggestion is not None
    assert found.suggestion.endswith("run.yaml:3:3")
