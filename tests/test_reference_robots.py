"""Published tables, from table files through the command line to files, against their publishers' own kinematics."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
import pytest

from dh2urdf.cli import _status

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from conftest import ReferenceRobot

FACTS = Path(__file__).with_name("reference") / "robots.json"


class Run(NamedTuple):
    """What a run over the tables of all published robots wrote."""

    folder: Path
    report: dict[str, dict[str, Any]]


@pytest.fixture(scope="module", params=["csv", "yaml"])
def form(request: pytest.FixtureRequest) -> str:
    """The form of the tables."""
    return str(request.param)


@pytest.fixture(scope="module", params=["aligned", "dh"])
def run(
    request: pytest.FixtureRequest,
    form: str,
    tmp_path_factory: pytest.TempPathFactory,
    reference_robots: Sequence[ReferenceRobot],
    as_table: Callable[..., str],
) -> Run:
    """One run over all published robots, in the form and the frames of the parameters."""
    folder = tmp_path_factory.mktemp("reference")
    (folder / "tables").mkdir()
    for robot in reference_robots:
        (folder / "tables" / f"{robot.id}.{form}").write_text(as_table(robot.manipulator, form), "utf-8")
    (folder / "run.yaml").write_text(
        f"""
inputs: tables/*.{form}
transform: {{stage: alpha-swap, options: {{frames: {request.param}}}}}
emitters: [urdf, xacro]
output: {{directory: out}}
proof: {{poses: 4}}
execution: {{stage: local, options: {{workers: 1}}}}
"""
    )
    assert _status(["run", str(folder / "run.yaml")], debug=False) == 0
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
