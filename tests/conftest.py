"""What all tests share: the facts of tests/reference, the project's command, and the rule about skipped tests."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import hypothesis
import pytest

from dh2urdf.manipulator import Convention, DHRow, JointType, Limits, Manipulator
from dh2urdf.rotations import IDENTITY, RigidTransform

if TYPE_CHECKING:
    from collections.abc import Callable, Generator, Sequence

R = TypeVar("R", pytest.TestReport, pytest.CollectReport)

REFERENCE = Path(__file__).with_name("reference")

# The same examples on every machine and in every run; a failure prints how to repeat it.
hypothesis.settings.register_profile(
    "dh2urdf", derandomize=True, deadline=None, database=None, print_blob=True, max_examples=60
)
hypothesis.settings.load_profile("dh2urdf")


# A test that needs what is not installed is skipped, with `pytest.importorskip` or `pytest.skip`. Where everything has
# to be there, DH2URDF_REQUIRE_ALL=1 turns every skip into a failure, so that nothing goes untested in silence.


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport() -> Generator[None, pytest.TestReport, pytest.TestReport]:
    return _no_skip((yield))


@pytest.hookimpl(wrapper=True)
def pytest_make_collect_report() -> Generator[None, pytest.CollectReport, pytest.CollectReport]:
    return _no_skip((yield))


def _no_skip(report: R) -> R:
    expected_failure = hasattr(report, "wasxfail")  # pytest counts it as skipped too
    if report.outcome == "skipped" and not expected_failure and os.environ.get("DH2URDF_REQUIRE_ALL") == "1":
        reason = report.longrepr[2] if isinstance(report.longrepr, tuple) else report.longrepr
        report.outcome = "failed"
        report.longrepr = f"DH2URDF_REQUIRE_ALL=1 allows no skipped test: {reason}"
    return report


class ReferenceRobot(NamedTuple):
    """A published table, and where its publisher's own library has its end effector.

    Attributes:
        id: its name in robots.json.
        manipulator: the table.
        q: joint vectors.
        poses: the 4x4 matrix T(base_link → tool0) at each, as nested lists.
    """

    id: str
    manipulator: Manipulator
    q: Sequence[Sequence[float]]
    poses: Sequence[Sequence[Sequence[float]]]


def load_reference_robots() -> list[ReferenceRobot]:
    records = json.loads((REFERENCE / "robots.json").read_text("utf-8"))["robots"]
    return [ReferenceRobot(record["id"], _manipulator(record), record["q"], record["T_ee"]) for record in records]


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    """A test that takes `reference_robot` runs once for every published robot."""
    if "reference_robot" in metafunc.fixturenames:
        robots = load_reference_robots()
        metafunc.parametrize("reference_robot", robots, ids=[robot.id for robot in robots])


@pytest.fixture(scope="session")
def reference_robots() -> list[ReferenceRobot]:
    """All published robots."""
    return load_reference_robots()


def _manipulator(record: dict[str, Any]) -> Manipulator:
    """A manipulator as robots.json has it; without its masses, some of which no body can have."""
    return Manipulator(
        name=record["id"],
        convention=Convention(record["convention"]),
        rows=tuple(_row(number, row) for number, row in enumerate(record["rows"], start=1)),
        base=_rigid(record["base"]),
        tool=_rigid(record["tool"]),
    )


def _row(number: int, row: dict[str, Any]) -> DHRow:
    lower, upper = row["qlim"] or (None, None)
    return DHRow(
        joint=f"joint_{number}",
        link=f"link_{number}",
        type=JointType(row["type"]),
        a=row["a"],
        alpha=row["alpha"],
        d=row["d"],
        theta=row["theta"],
        offset=row["offset"],
        sign=-1 if row["flip"] else 1,
        limits=Limits(lower=lower, upper=upper),
    )


def _rigid(matrix: list[list[float]] | None) -> RigidTransform:
    if matrix is None:
        return IDENTITY
    (a, b, c, x), (d, e, f, y), (g, h, i, z), _ = matrix
    return RigidTransform((a, b, c, d, e, f, g, h, i), (x, y, z))


@pytest.fixture
def dh2urdf(tmp_path: Path) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Run the project's command in the test's folder.

    `path` holds folders of further distributions, that are seen before the installed ones.
    """

    def run(*words: str | Path, path: Sequence[Path] = (), status: int = 0) -> subprocess.CompletedProcess[str]:
        inherited = os.environ.get("PYTHONPATH", "")
        result = subprocess.run(
            [sys.executable, "-c", "from dh2urdf.cli import main; main()", *map(str, words)],
            env={**os.environ, "PYTHONPATH": os.pathsep.join([*map(str, path), *filter(None, [inherited])])},
            cwd=tmp_path,
            capture_output=True,
            text=True,
            encoding="utf-8",
            check=False,
            timeout=300,
        )
        assert result.returncode == status, f"exit status {result.returncode}\n{result.stdout}\n{result.stderr}"
        return result

    return run
