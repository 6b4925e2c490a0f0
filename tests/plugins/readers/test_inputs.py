"""Tables as people write them, and published ones, against the textbook's DH product."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf.stages import Rejected
from dh2urdf.testing.oracle import table_pose
from dh2urdf_plugins.readers import stages
from dh2urdf_plugins.readers.table import TableOptions

REFERENCE = Path(__file__).parents[2] / "reference"
INPUTS = json.loads((REFERENCE / "inputs" / "expected.json").read_text("utf-8"))
ROBOTS = json.loads((REFERENCE / "robots.json").read_text("utf-8"))["robots"]


def read(path: Path, convention: str | None) -> Manipulator:
    reader = stages.CSV if path.suffix == ".csv" else stages.YAML
    (arm,) = reader.read(path, TableOptions(convention=convention))
    if isinstance(arm, Rejected):
        raise TableError(arm.problems)
    return arm


def mentions(text: str, item: str) -> bool:
    return any(
        re.search(rf"\b{re.escape(word)}\b" if len(word) == 1 else re.escape(word), text, re.IGNORECASE)
        for word in item.split("|")
    )


@pytest.mark.parametrize("case", INPUTS, ids=[case["file"] for case in INPUTS])
def test_a_table_of_real_life_is_read_rightly_or_refused_clearly(case: dict[str, Any]) -> None:
    """What is accepted has the pose of the reference; what is refused is refused with the words that help."""
    path = REFERENCE / "inputs" / case["file"]
    convention = case.get("convention", "standard") if path.suffix == ".csv" else None
    try:
        arm: Manipulator | str = read(path, convention)
    except TableError as error:
        arm = str(error)
    if isinstance(arm, str):
        assert "error" in case["outcome"], arm
        assert [item for item in case["mentions"] if not mentions(arm, item)] == [], arm
        return
    assert "accept" in case["outcome"], arm
    assert [row.type for row in arm.rows] == [row["type"] for row in case["rows"]]
    np.testing.assert_allclose(table_pose(arm, case["q"]), case["T_ee"], rtol=0, atol=case["tol"])


def as_csv(robot: dict[str, Any]) -> str:
    def statement(key: str) -> list[str]:
        return [f"# {key}: {json.dumps(robot[key])}"] if robot[key] else []

    lines = [f"# convention: {robot['convention']}", *statement("base"), *statement("tool")]
    lines.append("joint,type,a,alpha,d,theta,offset,flip,lower,upper")
    for number, row in enumerate(robot["rows"], start=1):
        limits = row["qlim"] if row["qlim"] and row["type"] != "fixed" else ("", "")
        cells = (f"j{number}", *(row[key] for key in ("type", "a", "alpha", "d", "theta", "offset", "flip")), *limits)
        lines.append(",".join(map(str, cells)))
    return "\n".join(lines)


@pytest.mark.parametrize("robot", ROBOTS, ids=[robot["id"] for robot in ROBOTS])
def test_a_published_robot_is_read_as_it_was_published(robot: dict[str, Any], tmp_path: Path) -> None:
    """Base, tool, offsets and flipped joints included, the end is where the publisher has it."""
    path = tmp_path / "robot.csv"
    path.write_text(as_csv(robot), "utf-8")
    arm = read(path, None)
    for q, expected in zip(robot["q"], robot["T_ee"], strict=True):
        np.testing.assert_allclose(table_pose(arm, q), expected, rtol=0, atol=1e-11)
