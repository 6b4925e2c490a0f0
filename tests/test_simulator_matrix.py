"""Every published arm in every simulator: one run of the pipeline, and docs/simulators.md says what came out.

`pytest --renew` writes the table of the page. CoppeliaSim is no part of the run: it is no free package. Its column is
what tests/plugins/loaders/test_coppeliasim_arms.py has kept of the real one, which that test asks where there is one.
"""

import fcntl
import json
import math
import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest
from lxml import etree

from dh2urdf.cli import exit_status_of
from dh2urdf.errors import PluginError
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.rotations import norm
from reference_arms import ReferenceRobot

Matrix = Mapping[str, Mapping[str, Any]]

PAGE = Path(__file__).parents[1] / "docs" / "simulators.md"
TABLE = re.compile(r"(?<=<!-- matrix: )(?P<remark>[^>]*-->\n)(?P<table>.*?)(?=<!-- /matrix -->)", re.DOTALL)

COPPELIASIM = Path(__file__).with_name("plugins") / "loaders" / "coppeliasim_4_10_0_arms.json"

POSES = 5
OPTIONS = {
    "pybullet": {"poses": POSES, "picture": False},
    "mujoco": {"poses": POSES, "picture": False},
    "pinocchio": {"poses": POSES},
    "drake": {"poses": POSES},
    "gazebo": {"poses": POSES},
}
NO_INERTIAL = "No inertial data for link, using mass=1, localinertiadiagonal = 1,1,1, identity local inertial frame"
SAID = {
    "pybullet": (
        "pybullet build time: .*",
        re.escape("PyBullet: Constraint Solver: MLCP + Dantzig"),
        "switched solver",
        re.escape(NO_INERTIAL),
        "base_link",
    ),
    "mujoco": (),
    "pinocchio": (),
    "drake": (),
    "gazebo": ("Library error: libignition-tools-backward.so not found. .*",),
}
"""All that a simulator may print, of any of these arms: docs/simulators.md says why."""
FOUND = {"drake": "Drake has no actuators, and drops the efforts, of "}
"""What is found of every arm: a URDF without transmissions has no actuators."""
OVERLAP = "collision shapes of the arm overlap at the start of the hold test: "

DOUBLE = 1e-9
"""What a simulator of double precision may be off [m, rad]."""
SINGLE = 2.0**-20
"""Eight times the rounding of single precision: what PyBullet may be off, as a share of the arm's length, and [rad]."""


@pytest.fixture(scope="session")
def matrix(
    tmp_path_factory: pytest.TempPathFactory, reference_robots: Sequence[ReferenceRobot], as_table: Callable[..., str]
) -> Matrix:
    """What the manifest of the run declares about every robot.

    The run is made once: of several processes that run tests, the first makes it, and the others wait for it.
    """
    folder = tmp_path_factory.getbasetemp()
    folder = (folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder) / "matrix"
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not (folder / "status").exists():
            status = run(folder, reference_robots, as_table)
            (folder / "status").write_text(str(status))
    assert (folder / "status").read_text() == "0"
    rows = map(json.loads, (folder / "out" / "manifest.jsonl").read_text("utf-8").splitlines())
    return {row["name"]: row | {"folder": folder / "out"} for row in rows}


def run(folder: Path, robots: Iterable[ReferenceRobot], as_table: Callable[..., str]) -> int:
    """Make and load all robots, as a user would; the exit status."""
    for robot in robots:
        (folder / f"{robot.id}.yaml").write_text(as_table(robot.manipulator, "yaml"), "utf-8")
    loaders = [{"stage": name, "options": OPTIONS[name]} for name in installed()]
    (folder / "run").write_text(
        f"""
inputs: ["*.yaml"]
emitters: [urdf, xacro, sdf, mjcf]
loaders: {json.dumps(loaders)}
sample: {{every: 1}}
output: {{directory: out}}
report: {{html: false}}
"""
    )
    return exit_status_of(["run", str(folder / "run")], debug=False)


def installed() -> Iterator[str]:
    """The loaders whose simulators are there."""
    catalog = load()
    for name, words in OPTIONS.items():
        loader = catalog.get("loader", name)
        try:
            loader.require(loader.options(**words))
        except PluginError:
            continue
        yield name


def length(manipulator: Manipulator) -> float:
    """The length of the chain of the table [m]: an arm reaches no farther."""
    total = norm(manipulator.base.translation) + norm(manipulator.tool.translation)
    for row in manipulator.rows:
        total += math.hypot(row.a, row.d)
        if row.type is JointType.PRISMATIC:
            total += abs(row.offset) + max(abs(row.limits.lower or 1.0), abs(row.limits.upper or 1.0))
    return total


def written_mass(urdf: Path) -> float:
    return math.fsum(float(mass.get("value")) for mass in etree.parse(urdf).iter("mass"))


@pytest.mark.long
def test_the_run_makes_every_robot(matrix: Matrix, reference_robots: Sequence[ReferenceRobot]) -> None:
    """In four formats, each of which is proved, and without an error."""
    assert sorted(matrix) == sorted(robot.id for robot in reference_robots)
    for row in matrix.values():
        assert (row["status"], row["errors"]) == ("ok", [])
        assert list(row["proof"]) == ["urdf", "xacro", "sdf", "mjcf"]


@pytest.mark.parametrize("loader", OPTIONS)
def test_every_simulator_has_the_arm_of_the_table(matrix: Matrix, reference_robot: ReferenceRobot, loader: str) -> None:
    """The joints in order, tool0 where the DH product has it, the mass of the file; it holds its weight, and nothing
    is said that is not expected of every good file."""
    row, manipulator = matrix[reference_robot.id], reference_robot.manipulator
    report = reported(row, loader)

    moving = [each for each in manipulator.rows if each.type is not JointType.FIXED]
    assert [(each["name"], each["type"]) for each in report["joints"]] == [(each.joint, each.type) for each in moving]

    assert report["poses"] == POSES
    share, bound = (length(manipulator), SINGLE) if loader == "pybullet" else (1.0, DOUBLE)
    assert report["position_error"] <= share * bound
    assert report["angle_error"] <= 2.0 * bound  # A quaternion in single precision is half the angle.

    assert report["mass"] == pytest.approx(written_mass(row["folder"] / f"{reference_robot.id}.urdf"), rel=1e-12)
    assert report["mass_error"] <= 1e-12 * report["mass"]

    assert report["hold"].get("stayed") is (None if loader == "gazebo" else True)

    assert [line for line in printed(report) if not any(re.fullmatch(known, line) for known in SAID[loader])] == []
    expected = [FOUND[loader]] if loader in FOUND else []
    expected += [f"{report['simulator']}: {OVERLAP}"] if report["hold"].get("contacts") else []
    messages = sorted(finding["message"] for finding in report["findings"])
    assert len(messages) == len(expected)
    assert all(map(str.startswith, messages, sorted(expected))), messages


def reported(row: Mapping[str, Any], loader: str) -> dict[str, Any]:
    if loader not in row["loaders"]:
        pytest.skip(f"the simulator of the loader {loader!r} is not installed")
    report: dict[str, Any] = row["loaders"][loader]
    return report


def printed(report: Mapping[str, Any]) -> list[str]:
    """The lines that a simulator printed; PyBullet's headers and texts do not begin on lines of their own."""
    text = re.sub(r"b3Warning\[[^\]]*\]:", "\n", report["output"])
    return [line.strip() for line in text.splitlines() if line.strip()]


def test_the_simulators_find_the_same_links_in_each_other(matrix: Matrix) -> None:
    """What overlaps at the start of the hold test does so in every simulator that looks; the MJCF excludes it."""
    for row in matrix.values():
        found = [reported(row, loader)["hold"]["contacts"] for loader in ("pybullet", "drake", "mujoco")]
        assert found == [found[0], found[0], []]


# --- The table of the page --------------------------------------------------------------------------------------------

FINEST = -14
"""Power of ten below which errors are not distinguished: it is the rounding of the machine's own arithmetic."""


def lines(matrix: Matrix, robots: Iterable[ReferenceRobot]) -> Iterator[str]:
    """The table: what is rounded is the same on every machine."""
    columns = [*OPTIONS, "coppeliasim"]
    yield f"| arm | joints | mass [kg] | {' | '.join(f'`{name}`' for name in columns)} | overlaps at the start |"
    yield f"|---|---|---|{'---|' * len(columns)}---|"
    in_coppeliasim = json.loads(COPPELIASIM.read_text("utf-8"))
    for robot in robots:
        reports = [reported(matrix[robot.id], name) for name in OPTIONS]
        moving = sum(row.type is not JointType.FIXED for row in robot.manipulator.rows)
        overlaps = ", ".join(" with ".join(f"`{link}`" for link in pair) for pair in reports[0]["hold"]["contacts"])
        errors = [*map(cell, reports), power_of_ten(in_coppeliasim[robot.id]["aligned"]["coppeliasim"])]
        cells = [robot.id, str(moving), f"{reports[0]['mass']:.4g}", *errors, overlaps]
        yield f"| {' | '.join(cells)} |".replace("|  |", "| |")


def cell(report: Mapping[str, Any]) -> str:
    words = {True: ", holds", False: ", **falls**", None: ""}
    return power_of_ten(report["position_error"]) + words[report["hold"].get("stayed")]


def power_of_ten(error: float) -> str:
    """The power of ten that an error does not exceed."""
    power = math.ceil(math.log10(error)) if error > 0.0 else FINEST
    return f"1e{max(power, FINEST)}"


def test_the_page_has_what_was_measured(
    matrix: Matrix, reference_robots: Sequence[ReferenceRobot], *, renew: bool
) -> None:
    """A row for every robot; `--renew` writes it."""
    page, generated = PAGE.read_text("utf-8"), "\n".join(["", *lines(matrix, reference_robots), "", ""])
    if renew:
        PAGE.write_text(TABLE.sub(lambda match: match["remark"] + generated, page), "utf-8")
    found = TABLE.search(PAGE.read_text("utf-8"))
    assert found is not None
    assert found["table"] == generated, "run `pytest --renew tests/test_simulator_matrix.py`"
