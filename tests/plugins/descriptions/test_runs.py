"""Descriptions as inputs of a run: beside tables, in cells, varied."""

from pathlib import Path

import dh2urdf

ARM = "# convention: standard\na, alpha, d\n0.1, pi/2, 0.3\n0.4, 0, 0\n0.3, 0, 0.1\n"


def test_a_run_with_cells_and_variations(tmp_path: Path) -> None:
    (tmp_path / "arm.csv").write_text(ARM)
    dh2urdf.convert(tmp_path / "arm.csv", tmp_path / "arm.urdf")
    (tmp_path / "run.yaml").write_text(
        """
inputs:
  - {path: arm.urdf, options: {tip_link: tool0}}
emitters: [urdf, sdf]
cells:
  - name: pair
    arms: [{name: one, of: arm}, {name: two, of: arm, parent: one/tool0}]
variations:
  - {name: v, of: arm, vary: [{joints: [joint_2], field: a, grid: [0.4, 0.5]}]}
output: {directory: out}
execution: {stage: local, options: {workers: 1}}
"""
    )
    report = dh2urdf.run(tmp_path / "run.yaml")
    made = {entry["name"]: entry["status"] for entry in report["manipulators"]}
    assert made == {"arm": "ok", "pair": "ok", "v_1": "ok", "v_2": "ok"}
    assert dh2urdf.read(tmp_path / "out" / "v_2.urdf", tip_link="tool0").rows[1].a == 0.5
