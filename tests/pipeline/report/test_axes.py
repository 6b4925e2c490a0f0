"""What a report says of the axes of a run's tables, and of how to do the run again."""

import hashlib
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.plugin_system import load
from dh2urdf.run_file.config import load_config
from dh2urdf.run_file.plan import Plan, make_plan
from dh2urdf.running.run import execute, load_plan

IRB_2400 = (
    "# convention: standard\njoint,a,alpha,d,theta\nj1,0.1,-pi/2,0.615,0\nj2,0.705,0,0,-pi/2\n"
    "j3,0.135,-pi/2,0,0\nj4,0,pi/2,0.755,0\nj5,0,-pi/2,0,0\nj6,0,0,0.085,pi\n"
)


def plan_of(folder: Path, more: str = "") -> Plan:
    (folder / "irb2400.csv").write_text(IRB_2400)
    (folder / "run.yaml").write_text(f"inputs: irb2400.csv\nemitters: urdf\nreport: {{html: false}}\n{more}")
    return make_plan(load_config(folder / "run.yaml"), load())


def test_an_arm(tmp_path: Path) -> None:
    """Parallel axes, the wrist, and the parameters of the data sheet."""
    plan = plan_of(tmp_path)
    (axes,) = execute(plan)[1]["axes"]
    assert (axes["name"], axes["arms"], axes["parallel"]) == ("irb2400", [], [["j2", "j3"]])
    assert axes["spherical_wrist"] == ["j4", "j5", "j6"]
    assert axes["opw"] is not None
    assert (axes["opw"]["a1"], axes["opw"]["c2"]) == pytest.approx((0.1, 0.705), abs=1e-12)
    assert execute(plan, resume=True)[1]["axes"] == [axes]


def test_a_cell(tmp_path: Path) -> None:
    """Arms that share a table have one entry."""
    arms = "{name: left, of: irb2400}, {name: right, of: irb2400, xyz: [0, 2, 0]}"
    *_, axes = execute(plan_of(tmp_path, f"cells: [{{name: pair, arms: [{arms}]}}]"))[1]["axes"]
    assert (axes["name"], axes["arms"]) == ("pair", ["left", "right"])


@pytest.mark.long
def test_a_long_run(tmp_path: Path) -> None:
    """The first thousand manipulators have an entry, as they are in the report; a table that is refused has none."""
    plan = plan_of(
        tmp_path, "variations: [{of: irb2400, count: 1003, seed: 1, vary: [{joints: 2, field: a, scale: [0.9, 1.1]}]}]"
    )
    report = execute(plan)[1]
    assert [entry["name"] for entry in report["axes"]] == [entry["name"] for entry in report["manipulators"]]
    (tmp_path / "irb2400.csv").write_text(IRB_2400.replace("0.705", "much"))
    (tmp_path / "good.csv").write_text(IRB_2400)
    config = (tmp_path / "run.yaml").read_text().replace("irb2400.csv", "[good.csv, irb2400.csv]")
    (tmp_path / "run.yaml").write_text(config.partition("variations")[0])
    _, report = execute(make_plan(load_config(tmp_path / "run.yaml"), load()))
    assert [entry["name"] for entry in report["axes"]] == ["good"]


# --- Reproduction -----------------------------------------------------------------------------------------------------

TABLE = "# convention: standard\njoint,a,alpha,d,lower,upper\none,0.3,0,0.1,-1,1\n"
RUN = (
    "inputs: arm.csv\nvariations: [{of: arm, count: 3, seed: 7, vary: [{joints: all, field: a, uniform: [0.1, 1]}]}]\n"
)


def reported(folder: Path, *settings: str) -> Any:
    (folder / "arm.csv").write_text(TABLE)
    (folder / "run.yaml").write_text(RUN)
    overrides = [*settings, "execution.options.workers=1"]
    _, made = execute(load_plan(folder / "run.yaml", load(), overrides, str(folder / "out")))
    return made


def test_a_run_says_how_to_do_it_again(tmp_path: Path) -> None:
    """The command with what changes its files, the hashes of what it read, its seed, and a citation of this version."""
    told = reported(tmp_path, "proof.poses=5")["reproduction"]
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
    reported(tmp_path)
    assert b"<td>velocity, effort</td>" in (tmp_path / "out" / "report.html").read_bytes()
