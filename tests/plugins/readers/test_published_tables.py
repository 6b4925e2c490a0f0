"""Public tables as their owners type them: read at the first try, or after the answer to one question."""

import math
import warnings
from pathlib import Path
from typing import Any

import pytest
import yaml

import dh2urdf
from dh2urdf.errors import Dh2UrdfError
from dh2urdf.manipulator import JointType

CASES: dict[str, dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("published_tables.yaml").read_text("utf-8"))
KINDS = {"P": (JointType.PRISMATIC,), "F": (JointType.FIXED,), "": (JointType.REVOLUTE, JointType.CONTINUOUS)}


@pytest.mark.parametrize("name", CASES)
def test_a_published_table_is_the_arm_of_its_source(name: str, tmp_path: Path) -> None:
    """Each row has the numbers that are listed in mm and degrees; a question is asked once, and answered by options."""
    case = CASES[name]
    table = tmp_path / f"arm{case['suffix']}"
    table.write_text(case["text"], "utf-8")
    how: dict[str, Any] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", dh2urdf.TableWarning)
        if "asks" in case:
            with pytest.raises(Dh2UrdfError):
                dh2urdf.read(table)
            how = case.get("then", {})
        if "rows" not in case:
            return
        arm = dh2urdf.read(table, **how)
    assert arm.convention.value == case.get("convention", "standard")
    assert len(arm.rows) == len(case["rows"])
    for row, (a, alpha, d, theta, *mark) in zip(arm.rows, case["rows"], strict=True):
        assert row.type in KINDS["".join(mark).strip("-")]
        assert row.sign == (-1 if "-" in mark else 1)
        found = (1000 * row.a, 1000 * (row.d + (row.offset if row.type is JointType.PRISMATIC else 0.0)))
        assert found == pytest.approx((a, d), abs=1e-9)
        turned = row.theta if row.type in (JointType.PRISMATIC, JointType.FIXED) else row.theta + row.offset
        for angle, degrees in ((row.alpha, alpha), (turned, theta)):
            apart = math.degrees(math.remainder(angle - math.radians(degrees), math.tau))
            assert abs(apart) <= case.get("within", 1e-9), (row.joint, math.degrees(angle), degrees)
    assert len(arm.notices) == case.get("notices", 0), "\n".join(map(str, arm.notices))


def test_most_are_read_at_the_first_try_and_in_silence() -> None:
    """Of all cases at most one in three asks a question, which has one answer, and fewer have a notice."""
    asked = [case for case in CASES.values() if "asks" in case]
    assert len(CASES) >= 60
    assert 3 * len(asked) <= len(CASES)
    assert sum(case.get("notices", 0) for case in CASES.values()) <= 0.3 * len(CASES)
