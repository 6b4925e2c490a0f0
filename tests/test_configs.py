"""Every run file of configs/ is run, and does what it says."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from command_line import Cli
from lxml import etree

CONFIGS = Path(__file__).parents[1] / "configs"


TIPS = {
    "pair": ["left_tool0", "right_tool0"],
    "ur5_on_track": ["track_tool0", "arm_tool0"],
    "around_a_table": ["left_tool0", "near_tool0", "right_tool0", "far_tool0"],
}
"""The cells with a picture, and the tool0 of each of their arms."""


@pytest.mark.parametrize("config", sorted(CONFIGS.glob("*.yaml")), ids=lambda path: path.stem)
def test_it_is_run(cli: Cli, tmp_path: Path, config: Path, require_loaders: Callable[..., None]) -> None:
    """Exit status 0, every manipulator ok, and not a word on standard error: an example gives no cause for a notice."""
    require_loaders(*(name for name in ("pybullet", "mujoco") if name in config.read_text("utf-8")))
    answer = cli("run", config, "-o", tmp_path / "out")
    said = [line for line in answer.stderr.splitlines() if not line.endswith(" left")]  # how far a slow machine is
    assert said == []
    (written,) = tmp_path.glob("out*/report.json")  # a folder of packages has its report beside it
    report = json.loads(written.read_bytes())
    assert {entry["status"] for entry in report["manipulators"]} == {"ok"}
    for entry in report["manipulators"]:
        assert all((tmp_path / "out" / file["path"]).is_file() for file in entry["files"])
        assert all(report["hold"]["stayed"] for report in entry["loaders"].values())
    entries = {entry["name"]: entry for entry in report["manipulators"]}
    if config.stem == "ur5_paper":  # whose axes and lengths tests/plugins/transforms/test_paper.py looks at
        (entry,) = entries.values()
        assert entry["keeps_kinematics"] is False
        assert entry["proof"]["urdf"]["position_error"] > 0.1
    if config.stem in TIPS:
        check_cell(config.stem, entries[config.stem], tmp_path / "out")
    if config.stem == "folder":  # it takes every table there is
        found = {Path(entry["source"]).name for entry in entries.values()}
        assert found == {path.name for path in (CONFIGS / "tables").iterdir()}


def check_cell(name: str, entry: dict[str, Any], folder: Path) -> None:
    """URDF, xacro and picture of the whole cell; every tool0 is proved in both files and found in PyBullet."""
    assert Path(entry["source"]).name == f"{name}.yaml"
    assert [file["path"] for file in entry["files"]] == [*(f"{name}.urdf", f"{name}.urdf.xacro", f"{name}_macro.xacro")]
    for proof in entry["proof"].values():
        assert list(proof["tips"]) == TIPS[name]
        assert proof["position_error"] == max(proof["tips"].values()) < 1e-14
    loaded = entry["loaders"]["pybullet"]
    assert loaded["position_error"] < loaded["tolerance"] < 1e-5
    assert loaded["findings"] == []
    assert loaded["mass_error"] == 0.0
    assert (folder / loaded["picture"]).is_file()


def test_convert_takes_the_tables_too(cli: Cli) -> None:
    """Each table stands alone: one conversion needs no run file."""
    for path in sorted((CONFIGS / "tables").iterdir()):
        described: Any = etree.fromstring(cli("convert", path).stdout.encode())
        assert described.get("name") == path.stem
