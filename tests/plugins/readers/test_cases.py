"""Tables as people type them: each text of cases.yaml is the arm that it says, or is refused by the messages that it says."""

from collections.abc import Callable
from operator import attrgetter
from pathlib import Path
from typing import Any

import pytest
import yaml

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator

CASES: dict[str, dict[str, Any]] = yaml.safe_load(Path(__file__).with_name("cases.yaml").read_text("utf-8"))
TEXTS = [
    pytest.param(case, text, id=f"{name} {number}")
    for name, case in CASES.items()
    for number, text in enumerate(
        case["texts"] if "texts" in case else [case["table"].replace("{}", each) for each in case["each"]]
    )
]


def found(arm: Any, path: str) -> Any:
    """An attribute of an arm, or one of all its rows."""
    if path.startswith("rows."):
        return [found(row, path.removeprefix("rows.")) for row in arm.rows]
    value = attrgetter(path)(arm)
    return [*value] if isinstance(value, tuple) else value


def nearly(wanted: Any) -> Any:
    """Numbers to a rounding, in lists of any depth."""
    if isinstance(wanted, list):
        return [nearly(each) for each in wanted]
    return pytest.approx(wanted, rel=1e-15) if isinstance(wanted, float) else wanted


@pytest.mark.parametrize(("case", "text"), TEXTS)
def test_a_text_is_the_arm_that_is_meant(case: dict[str, Any], text: str, read: Callable[..., list[Any]]) -> None:
    """With the notices that it gets, and none besides; what is refused has a place."""
    try:
        (arm,) = read(text, case.get("suffix", ".csv"), **case.get("options", {"convention": "standard"}))
        problems = () if isinstance(arm, Manipulator) else arm.problems
    except TableError as error:
        problems = tuple(problem for problem in error.problems if problem.severity == "error")
    if "refused" in case:
        assert sorted({problem.code or "name" for problem in problems}) == case["refused"]
        assert all(problem.mark for problem in problems)
        return
    assert not problems, "\n".join(map(str, problems))
    for path, wanted in case["is"].items():
        assert found(arm, path) == nearly(wanted)
    assert sorted({notice.code for notice in arm.notices}) == case.get("notices", [])
