"""Published tables, from table files through the command line to files, against their publishers' own kinematics."""

import json
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from command_line import Cli
from lxml import etree

from dh2urdf.cli import exit_status_of
from dh2urdf.manipulator import Inertia, Manipulator
from reference_arms import ReferenceRobot

FACTS = Path(__file__).with_name("reference") / "robots.json"


class Run(NamedTuple):
    """What a run over the tables of all published robots wrote."""

    folder: Path
    report: dict[str, dict[str, Any]]


@pytest.fixture(scope="module", params=[("csv", "aligned"), ("yaml", "dh")], ids="-".join)
def run(
    request: pytest.FixtureRequest,
    tmp_path_factory: pytest.TempPathFactory,
    reference_robots: Sequence[ReferenceRobot],
    as_table: Callable[..., str],
) -> Run:
    """One run over all published robots, in the form and the frames of the parameters."""
    form, frames = request.param
    folder = tmp_path_factory.mktemp("reference")
    (folder / "tables").mkdir()
    for robot in reference_robots:
        (folder / "tables" / f"{robot.id}.{form}").write_text(as_table(robot.manipulator, form), "utf-8")
    (folder / "run.yaml").write_text(
        f"""
inputs: tables/*.{form}
transform: {{stage: alpha-swap, options: {{frames: {frames}}}}}
emitters: [urdf, xacro]
output: {{directory: out}}
proof: {{poses: 4}}
execution: {{stage: local, options: {{workers: 1}}}}
report: {{html: false}}
"""
    )
    assert exit_status_of(["run", str(folder / "run.yaml")], debug=False) == 0
    report = json.loads((folder / "out" / "report.json").read_bytes())
    return Run(folder / "out", {manipulator["name"]: manipulator for manipulator in report["manipulators"]})


def test_tool0_is_where_the_publisher_has_it(
    run: Run, reference_robot: ReferenceRobot, tool0_of: Callable[[Path], Callable[[Sequence[float]], np.ndarray]]
) -> None:
    """T(base_link → tool0) of the written URDF is the published pose, at every published joint vector."""
    pose = tool0_of(run.folder / f"{reference_robot.id}.urdf")
    for q, expected in zip(reference_robot.q, reference_robot.poses, strict=True):
        np.testing.assert_allclose(pose(q), expected, rtol=0, atol=1e-9)


def test_the_run_proves_the_same(run: Run, reference_robot: ReferenceRobot) -> None:
    """The proofs of the run, of the URDF and of the expanded xacro, find rounding errors only."""
    entry = run.report[reference_robot.id]
    assert entry["errors"] == []
    for proof in (entry["proof"]["urdf"], entry["proof"]["xacro"]):
        assert proof["position_error"] < 1e-12
        assert proof["angle_error"] < 1e-12


PHYSICS = {
    "rtb_Puma560": ("joint_3", "the inertia breaks the triangle inequality"),
    "rtb_Stanford": ("joint_5", "the inertia is not positive definite"),
}
"""A joint whose published inertia is that of no body, and the rule that it breaks."""


def with_masses(robot: ReferenceRobot) -> Manipulator:
    """The robot's table with what was published of its bodies; a mass of 0 there is that of a link of unknown mass."""
    record = next(record for record in json.loads(FACTS.read_text("utf-8"))["robots"] if record["id"] == robot.id)
    rows = []
    for row, facts in zip(robot.manipulator.rows, record["rows"], strict=True):
        if facts.get("mass"):
            (ixx, ixy, ixz), (_, iyy, iyz), (_, _, izz) = facts["inertia"]
            inertia = Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy, ixz=ixz, iyz=iyz)
            rows.append(replace(row, mass=facts["mass"], com=tuple(facts["com"]), inertia=inertia))
        else:
            rows.append(row)
    return replace(robot.manipulator, rows=tuple(rows))


@pytest.mark.parametrize("name", PHYSICS)
def test_masses_that_no_body_can_have_are_refused(
    *,
    name: str,
    reference_robots: Sequence[ReferenceRobot],
    as_table: Callable[..., str],
    cli: Cli,
    tmp_path: Path,
) -> None:
    """The published mass properties of three arms are those of no body: the rule is named, and nothing is written."""
    robot = next(robot for robot in reference_robots if robot.id == name)
    (tmp_path / "arm.csv").write_text(as_table(with_masses(robot), "csv"), "utf-8")
    joint, rule = PHYSICS[name]
    refused = cli("convert", "arm.csv", "-o", "arm.urdf", status=2).stderr
    assert f"error: joint '{joint}', field 'inertia': {rule}" in refused
    assert "`--set inertias=repair`" in refused
    assert [path.name for path in tmp_path.iterdir()] == ["arm.csv"]
    cli("convert", "arm.csv", "-o", "arm.urdf", "--inertias", "repair")


def test_masses_that_a_body_can_have_are_written(
    reference_robots: Sequence[ReferenceRobot], as_table: Callable[..., str], cli: Cli, tmp_path: Path
) -> None:
    """The Panda's published masses are those of its links in the file."""
    panda = with_masses(next(robot for robot in reference_robots if robot.id == "rtb_Panda"))
    (tmp_path / "panda.csv").write_text(as_table(panda, "csv"), "utf-8")
    cli("convert", "panda.csv", "-o", "panda.urdf")
    links = {link.get("name"): link for link in etree.parse(tmp_path / "panda.urdf").findall("link")}
    masses = [float(links[row.link].find("inertial/mass").get("value")) for row in panda.rows]
    assert masses == [row.mass for row in panda.rows]
