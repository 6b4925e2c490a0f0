"""Comparing a description with a table, and finding what would make them one arm."""

import importlib.metadata
import math
import random
import re
from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from any_tables import manipulators
from hypothesis import given, settings, strategies as st

from dh2urdf.errors import ConfigError
from dh2urdf.kinematics import forward_kinematics
from dh2urdf.kinematics.comparison import TOLERANCE, changes, compare
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf_check.inspection import inspect_urdf
from dh2urdf_plugins.readers.stages import CSV
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM
from reference_arms import ReferenceRobot

CONFIGS = Path(__file__).parents[3] / "configs"


def robot_of(manipulator: Manipulator) -> Robot:
    return TRANSFORM.transform(manipulator, TRANSFORM.options())


def shaken(manipulator: Manipulator, seed: int) -> Manipulator:
    """The same arm with another base and tool, and some other signs and offsets."""
    draw = random.Random(seed)  # noqa: S311 - reproducible on purpose

    def pose() -> RigidTransform:
        xyz, rpy = ([draw.uniform(-size, size) for _ in range(3)] for size in (1, 3))
        return RigidTransform.from_xyz_rpy((xyz[0], xyz[1], xyz[2]), (rpy[0], rpy[1], rpy[2]))

    rows = [
        row
        if row.type is JointType.FIXED
        else replace(
            row,
            sign=row.sign * draw.choice([1, -1]),
            offset=row.offset + draw.choice([0, 0, math.pi / 2, -math.pi, 0.2, -0.3]),
        )
        for row in manipulator.rows
    ]
    return replace(manipulator, rows=tuple(rows), base=pose() @ manipulator.base, tool=manipulator.tool @ pose())


def test_an_arm_agrees_with_its_table(reference_robot: ReferenceRobot) -> None:
    """What was made of a table is the arm of the table, and nothing is to be corrected."""
    found = compare(robot_of(reference_robot.manipulator), reference_robot.manipulator)
    assert found.holds
    assert (found.base_link, found.tip_link) == ("base_link", "tool0")
    assert (found.corrected, found.first_difference) == (None, None)


@pytest.mark.parametrize("seed", range(3))
def test_a_table_of_the_same_arm_is_corrected(reference_robot: ReferenceRobot, seed: int) -> None:
    """Another base, tool, signs and offsets are found, whatever the arm, from the two kinematics alone."""
    other = shaken(reference_robot.manipulator, seed)
    found = compare(robot_of(reference_robot.manipulator), other)
    assert not found.holds
    assert found.corrected is not None
    assert found.remaining is not None
    assert found.remaining.is_none
    assert found.first_difference is None
    # The publisher's own poses agree with the corrected table.
    for q, pose in zip(reference_robot.q, reference_robot.poses, strict=True):
        r, t = forward_kinematics(found.corrected, q)
        np.testing.assert_allclose(np.c_[np.reshape(r, (3, 3)), t], np.array(pose)[:3], rtol=0, atol=1e-6)


TABLES = manipulators(8, st.just(0.0) | st.floats(0.05, 1) | st.floats(-1, -0.05))


@pytest.mark.long
@settings(max_examples=200)
@given(TABLES, st.integers(0, 1000))
def test_any_table_of_the_same_arm_is_corrected(manipulator: Manipulator, seed: int) -> None:
    """For every kind of arm there is a correction that makes the two one."""
    found = compare(robot_of(manipulator), shaken(manipulator, seed))
    assert found.holds or (found.remaining is not None and found.remaining.is_none), found


@given(TABLES, st.integers(0, 1000), st.data())
def test_another_arm_is_not_corrected_away(manipulator: Manipulator, seed: int, data: st.DataObject) -> None:
    """A link that is 0.1 m longer is distinguished from all that base, tool, signs and offsets can do, or is of no matter."""
    moving = [index for index, row in enumerate(manipulator.rows) if row.type is not JointType.FIXED]
    if not moving:
        return
    index = data.draw(st.sampled_from(moving))
    row = manipulator.rows[index]
    longer = replace(
        manipulator, rows=(*manipulator.rows[:index], replace(row, a=row.a + 0.1), *manipulator.rows[index + 1 :])
    )
    found = compare(robot_of(longer), shaken(manipulator, seed))
    if found.remaining is not None and found.remaining.is_none and found.corrected is not None:
        draw = random.Random(seed)  # noqa: S311 - reproducible on purpose
        for _ in range(3):
            q = [draw.uniform(-2, 2) for _ in longer.actuated_rows]
            one, other = forward_kinematics(longer, q), forward_kinematics(found.corrected, q)
            assert math.dist(one.translation, other.translation) <= 10 * TOLERANCE
    elif not found.holds:
        assert found.first_difference


def ur5() -> Manipulator:
    (manipulator,) = CSV.read(CONFIGS / "tables" / "ur5.csv", CSV.options())
    assert isinstance(manipulator, Manipulator)
    return manipulator


def test_the_place_where_two_arms_part_is_named() -> None:
    """The joint behind the link that is longer, and by how much."""
    table = ur5()
    longer = replace(table.rows[1], a=table.rows[1].a - 0.02)
    found = compare(robot_of(replace(table, rows=(table.rows[0], longer, *table.rows[2:]))), table)
    assert found.corrected is None
    assert found.first_difference is not None
    # Three parallel axes may be in any triangle: only the axis behind the third is out of place.
    match = re.search(r"part at joint (\d), '(\w+)': .* by ([\d.]+) m", found.first_difference)
    assert match is not None
    assert int(match[1]) in {3, 4, 5}
    bent = replace(table.rows[3], alpha=1.2)
    found = compare(robot_of(replace(table, rows=(*table.rows[:3], bent, *table.rows[4:]))), table)
    assert found.first_difference is not None
    assert "part at joint 5, 'wrist_2" in found.first_difference
    assert re.search(r"another direction, by 0\.37\d* rad", found.first_difference)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"convention": Convention.MODIFIED}, "read with the standard convention, the table"),
        ({"lengths": 1000.0}, "read with lengths times 0.001, the table"),
        ({"angles": 180 / math.pi}, "read with angles in degrees, the table"),
        (
            {"convention": Convention.MODIFIED, "lengths": 1000.0},
            "read with the standard convention and lengths times 0.001, the table",
        ),
    ],
)
def test_a_table_in_another_convention_or_unit_is_the_same_arm(change: dict[str, Any], said: str) -> None:
    """Both are tried before it is another arm; an arm that is another in each of them is that."""
    table, lengths, angles = ur5(), change.pop("lengths", 1.0), change.pop("angles", 1.0)
    rows = [
        replace(row, a=row.a * lengths, d=row.d * lengths, alpha=row.alpha * angles, theta=row.theta * angles)
        for row in table.rows
    ]
    found = compare(robot_of(table), replace(table, rows=tuple(rows), **change))
    assert found.first_difference is not None
    assert found.first_difference.endswith(f"{said} is the arm of the description")
    other = (replace(table.rows[0], alpha=1.3), *table.rows[1:])
    assert "read with" not in (compare(robot_of(replace(table, rows=other)), table).first_difference or "")


# --- Which chain ------------------------------------------------------------------------------------------------------


def chain(*links: str, tips: Sequence[str] = ()) -> Robot:
    """Links in a row, a moving joint between each two, and fixed to the last the tips."""
    names = [*links, *tips]
    joints = [
        Joint(name=f"j_{b}", type=JointType.REVOLUTE, parent=a, child=b, origin=Origin(xyz=(0.1, 0, 0)))
        for a, b in pairwise(links)
    ]
    joints += [Joint(name=f"j_{tip}", type=JointType.FIXED, parent=links[-1], child=tip) for tip in tips]
    return Robot(name="r", links=tuple(Link(name=name) for name in names), joints=tuple(joints))


@pytest.mark.parametrize(
    ("robot", "tip"),
    [
        (chain("world", "a", "b", tips=("camera", "tool0", "flange")), "tool0"),
        (chain("world", "a", "b", tips=("camera", "flange")), "flange"),
        (chain("world", "a", "b", tips=("camera",)), "camera"),
        (chain("world", "a", "b", "finger"), "b"),
        (chain("world", "a"), "a"),
    ],
)
def test_the_likeliest_tip_is_taken(robot: Robot, tip: str) -> None:
    """Of the links behind as many joints as the table has: a usual name, else the last one."""
    row = DHRow(joint="j", link="l", a=0.1, alpha=0, d=0)
    table = Manipulator(name="t", convention=Convention.STANDARD, rows=(row, replace(row, joint="k", link="m")))
    found = compare(robot, table)
    assert (found.base_link, found.tip_link) == ("world", tip)


def test_ends_are_chosen_by_name() -> None:
    """From any link to any below it; a name that is not there, or lies elsewhere, is an error."""
    robot = chain("world", "a", "b", "c", tips=("tool0",))
    table = Manipulator(
        name="t", convention=Convention.STANDARD, rows=(DHRow(joint="j", link="l", a=0.1, alpha=0, d=0),)
    )
    found = compare(robot, table, base_link="a", tip_link="b")
    assert found.joints == ("j_b",)
    assert found.corrected is not None
    with pytest.raises(ConfigError, match="did you mean 'tool0'"):
        compare(robot, table, tip_link="tool")
    with pytest.raises(ConfigError, match="no chain"):
        compare(robot, table, base_link="c", tip_link="a")


# --- Real arms --------------------------------------------------------------------------------------------------------


def real(name: str) -> Path:
    try:
        files = importlib.metadata.files("example-robot-data") or ()
    except importlib.metadata.PackageNotFoundError:
        pytest.skip("example-robot-data is not installed")
    (path,) = (Path(file.locate()) for file in files if file.name == name)
    return path


@pytest.mark.parametrize(
    ("file", "reference", "tip", "said"),
    [
        ("ur5_robot.urdf", "urdoc_ur5", "tool0", "base: {xyz: [0, 0, 0], rpy: [0, 0, pi]}"),
        ("panda.urdf", "rtb_Panda", "panda_link8", "tool: {xyz: [0, 0, 0], rpy: [0, 0, 0]}"),
        ("panda.urdf", "franka_fr3", "panda_link8", "nothing"),
    ],
)
def test_real_arms_are_those_of_published_tables(
    file: str, reference: str, tip: str, said: str, reference_robots: Sequence[ReferenceRobot]
) -> None:
    """Where they differ, by their base and their tool."""
    table = next((robot.manipulator for robot in reference_robots if robot.id == reference), None)
    if table is None:
        pytest.fail(f"no {reference} among {[robot.id for robot in reference_robots]}")
    robot = inspect_urdf(real(file)).robot
    assert robot is not None
    found = compare(robot, table, tip_link=tip)
    assert (found.corrected is None) == found.holds
    assert said == ("nothing" if found.corrected is None else "; ".join(changes(table, found.corrected)))


# --- Numbers for the table --------------------------------------------------------------------------------------------


def test_the_correction_can_be_put_into_the_table(tmp_path: Path) -> None:
    """The text of the changes, in the comment lines and columns of a CSV, makes the table agree."""
    table = replace(ur5(), base=IDENTITY)
    other = shaken(table, 5)
    found = compare(robot_of(table), other)
    assert found.corrected is not None
    said = changes(other, found.corrected)
    ends = [f"# {text}" for text in said if text.startswith(("base", "tool"))]
    assert len(ends) == 2
    cells = {
        match[1]: dict(part.split(": ") for part in match[2].split(", "))
        for text in said
        if (match := re.fullmatch(r"joint (\w+): (.*)", text))
    }
    lines = ["# convention: standard", *ends, "joint,a,alpha,d,sign,offset"]
    for row in other.rows:
        values = {"sign": str(row.sign), "offset": repr(row.offset)} | cells.get(row.joint, {})
        lines.append(f"{row.joint},{row.a},{row.alpha},{row.d},{values['sign']},{values['offset']}")
    path = tmp_path / "corrected.csv"
    path.write_text("\n".join(lines) + "\n")
    (corrected,) = CSV.read(path, CSV.options())
    assert isinstance(corrected, Manipulator)
    assert compare(robot_of(table), corrected).holds
