from __future__ import annotations

import hashlib
from typing import TYPE_CHECKING, Any

from dh2urdf.plugin_system import load
from dh2urdf.running.run import execute, load_plan

if TYPE_CHECKING:
    from pathlib import Path

TABLE = "# convention: standard\njoint,a,alpha,d,lower,upper\none,0.3,0,0.1,-1,1\n"
RUN = (
    "inputs: arm.csv\nvariations: [{of: arm, count: 3, seed: 7, vary: [{joints: all, field: a, uniform: [0.1, 1]}]}]\n"
)


def report(folder: Path, *settings: str) -> Any:
    (folder / "arm.csv").write_text(TABLE)
    (folder / "run.yaml").write_text(RUN)
    overrides = [*settings, "execution.options.workers=1"]
    _, made = execute(load_plan(folder / "run.yaml", load(), overrides, str(folder / "out")))
    return made


def test_a_run_says_how_to_do_it_again(tmp_path: Path) -> None:
    """The command with what changes its files, the hashes of what it read, its seed, and a citation of this version."""
    told = report(tmp_path, "proof.poses=5")["reproduction"]
    assert told["command"] == f"dh2urdf run {tmp_path / 'run.yaml'} --set proof.poses=5"
    hashes = {entry["path"]: entry["sha256"] for entry in told["inputs"]}
    assert hashes == {
        str(tmp_path / name): hashlib.sha256(text.encode()).hexdigest()
        for name, text in (("run.yaml", RUN), ("arm.csv", TABLE))
    }
    assert told["variations"] == [{"name": "arm", "of": "arm", "count": 3, "seed": 7, "sampling": "random"}]
    assert f"dh2urdf {told['versions']['dh2urdf']}" in told["citation"]


def test_the_page_says_which_limits_were_computed(tmp_path: Path) -> None:
    """The table says both ends of the limits; velocity and effort are the transform's."""
    report(tmp_path)
    assert b"<td>velocity, effort</td>" in (tmp_path / "out" / "report.html").read_bytes()
