"""docs/batches.md and docs/machines.md: their run files can be run."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from dh2urdf.config import load_config
from dh2urdf.registry import load
from dh2urdf.runs import make_plan

ROOT = Path(__file__).parents[1]
PAGES = ("batches.md", "machines.md")
BLOCKS = [
    pytest.param(block, id=f"{page} {number}")
    for page in PAGES
    for number, block in enumerate(
        re.findall(r"```yaml\n(.*?)```", (ROOT / "docs" / page).read_text("utf-8"), re.DOTALL)
    )
]


@pytest.mark.parametrize("block", BLOCKS)
def test_its_run_files_are_right(block: str, tmp_path: Path) -> None:
    """Every run file is one, its stages are installed, and its tables are those of configs/."""
    if "inputs:" not in block:
        block += "inputs: configs/tables/ur5.csv\n"
    (tmp_path / "run.yaml").write_text(block)
    shutil.copytree(ROOT / "configs", tmp_path / "configs")
    for mesh in re.findall(r"configs/meshes/\w+\.stl", block):
        (tmp_path / mesh).parent.mkdir(exist_ok=True)
        (tmp_path / mesh).touch()
    plan = make_plan(load_config(tmp_path / "run.yaml"), load())
    assert all(path.is_file() for path, _ in plan.inputs)
