import math
from pathlib import Path

from dh2urdf.cells.cell import ArmCall, CellCall
from dh2urdf.robot import Origin
from dh2urdf.run_file.config import RunConfig, load_config


def config(folder: Path, cells: str, *settings: str) -> RunConfig:
    (folder / "a.csv").touch()
    (folder / "run.yaml").write_text(f"inputs: a.csv\ncells:\n{cells}\n")
    return load_config(folder / "run.yaml", settings)


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


def test_all_faults_are_said_at_once(tmp_path: Path) -> None:
    """One of every cell and arm, together with those of other sections."""
    text = "- {arms: [{name: a, of: x}]}\n- {name: p, arms: [{of: x}, {name: b}]}\n- 7\nproof: {poses: 0}"
    found = config(tmp_path, text).problems
    assert [each.field for each in found] == [
        *("cells.0.name", "cells.1.arms.0.name", "cells.1.arms.1.of", "cells.2", "proof.poses")
    ]
