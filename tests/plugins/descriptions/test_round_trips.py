"""Of published tables: table, description, table. It is the very table, or the equivalence has a name in the docs."""

import math
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

import dh2urdf
from dh2urdf.manipulator import DHRow, JointType, Manipulator
from reference_arms import ReferenceRobot

PAGE = Path(__file__).parents[3] / "docs" / "extract.md"
Numbers = tuple[float, float, float, float]


def numbers(row: DHRow) -> Numbers:
    """a, α, d and θ of a row, with what it adds to the joint value; θ from -π to π."""
    slides = row.type is JointType.PRISMATIC
    theta = row.theta + (0 if slides else row.offset)
    return row.a, row.alpha, row.d + (row.offset if slides else 0), math.remainder(theta, 2 * math.pi)


def same(one: Sequence[Numbers], other: Sequence[Numbers]) -> bool:
    """Whether rows have the same numbers; π and -π are one angle."""
    if len(one) != len(other):
        return False
    pairs = [(a, b) for row, again in zip(one, other, strict=True) for a, b in zip(row, again, strict=True)]
    return all(abs(a - b) < 1e-9 or abs(abs(a) + abs(b) - 2 * math.pi) < 1e-9 for a, b in pairs)


def shared(table: Manipulator, again: Manipulator) -> bool:
    """Only the first and the last row differ, with base or tool."""
    rows, found = list(map(numbers, table.rows)), list(map(numbers, again.rows))
    return same(rows[1:-1], found[1:-1]) and (table.base, table.tool) != (again.base, again.tool)


def pointing(table: Manipulator, again: Manipulator) -> bool:
    """The lengths of the common normals are the same, and some of the signs are not."""
    moving = [abs(row.a) for row in table.rows if row.type is not JointType.FIXED]
    return moving == pytest.approx([abs(row.a) for row in again.rows], abs=1e-9) and not same(
        list(map(numbers, table.rows)), list(map(numbers, again.rows))
    )


KINDS: dict[str, Callable[[Manipulator, Manipulator], bool]] = {
    "a sign −1": lambda table, _: any(row.sign == -1 for row in table.rows),
    "a turn or a shift shared otherwise": shared,
    "another axis of a prismatic joint": lambda table, _: any(row.type is JointType.PRISMATIC for row in table.rows),
    "a common normal that points the other way": pointing,
    "a fixed row": lambda table, again: len(again.rows) < len(table.rows),
}
EQUIVALENT = {
    "rtb_Panda": ("a turn or a shift shared otherwise",),
    "rtb_Stanford": ("another axis of a prismatic joint",),
    "rtb_Mico": ("a sign −1",),
    "rtb_Baxter": ("a turn or a shift shared otherwise",),
    "rtb_P8": ("another axis of a prismatic joint",),
    "rtbm_nao_left_leg": ("a common normal that points the other way",),
    "kinova_gen3_std": ("a fixed row", "a common normal that points the other way"),
    "franka_fr3": ("a fixed row",),
    "rkc_Doosan_Robotics_M1013": ("a sign −1",),
    "rkc_Brooks_PreciseFlex_400_750": ("a sign −1",),
}


@pytest.mark.parametrize("frames", ["aligned", "dh"])
def test_the_very_table_or_an_equivalence_with_a_name(
    tmp_path: Path, reference_robot: ReferenceRobot, frames: str
) -> None:
    table, path = reference_robot.manipulator, tmp_path / "robot.urdf"
    dh2urdf.convert(table, path, frames=frames)
    again = dh2urdf.read(path, convention=str(table.convention), base_link="base_link", tip_link="tool0")
    assert np.abs(again.fk(reference_robot.q) - np.array(reference_robot.poses)).max() < 2e-8
    kinds = EQUIVALENT.get(reference_robot.id, ())
    assert same(list(map(numbers, table.rows)), list(map(numbers, again.rows))) == (not kinds)
    assert all(KINDS[kind](table, again) for kind in kinds)
    if kinds:
        assert f"| {reference_robot.id} | {', '.join(kinds)} |" in PAGE.read_text("utf-8")
