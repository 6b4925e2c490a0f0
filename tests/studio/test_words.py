from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

import pytest

from dh2urdf.manipulator import Convention
from dh2urdf.rotations import RigidTransform
from dh2urdf.table_text import TableText
from dh2urdf_studio import words
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.opening import Opened, gallery_table
from dh2urdf_studio.editing.session import Session

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog


def status(session: Session) -> tuple[str, str]:
    return words.status(session, len(session.reading.errors))


def test_what_is_to_be_done_next(catalog: Catalog) -> None:
    """From an empty table to an arm the line below the table says the next step."""
    session = Session(catalog)
    assert status(session) == ("choose the number of axes, or paste a table", "")
    session.put(edits.resized(session.table, 2))
    assert status(session)[0].startswith("choose the convention: standard")
    session.set_convention(Convention.STANDARD, convert=False)
    assert status(session) == ("rows 1 to 2 are still empty", "")
    session.put(edits.with_cells(session.table, {(0, field): "0.1" for field in ("a", "alpha", "d")}))
    assert status(session) == ("row 2 is still empty; the arm of the first row is shown", "")
    session.put(edits.with_cells(session.table, {(1, field): "0.1" for field in ("a", "alpha", "d")}))
    assert status(session) == ("2 axes; the arm is the table's", "good")
    session.edit(1, "a", "x")
    assert status(session) == ("1 problem; the last good arm is shown", "bad")


@pytest.mark.parametrize(
    ("file", "told"),
    [
        ("panda.yaml", "7 axes and 1 fixed joint; the arm is the table's"),
        ("track.csv", "1 axis; the arm is the table's"),
    ],
)
def test_axes_are_those_that_move(catalog: Catalog, file: str, told: str) -> None:
    """A fixed row is no axis."""
    assert status(Session(catalog, gallery_table(file, catalog))) == (told, "good")


def test_a_problem_says_its_row(catalog: Catalog) -> None:
    """Row, joint and field stand before the message; what is about the whole table names what."""
    session = Session(catalog, edits.with_cells(gallery_table("ur5.csv", catalog), {(3, "alpha"): "pi/x"}))
    (found,) = session.reading.errors
    assert words.place(found, session.table) == "row 4, wrist_1_joint, alpha: "
    assert words.place(replace(found, row=None, field="base"), session.table) == "base: "
    assert words.place(replace(found, row=None, field=None), session.table) == ""


def test_numbers_are_in_the_units_of_the_table() -> None:
    """Millimetres and degrees where the table has them, and no minus before a zero."""
    pose = RigidTransform.from_xyz_rpy((0.1, -0.0, 0.25), (0.0, 0.0, math.pi / 2))
    told = words.numbers(pose, TableText(length_unit="mm", angle_unit="deg"), 0.3)
    assert "100.00" in told
    assert "-0.00" not in told
    assert "rpy <b>0.0000, 0.0000, 90.0000</b>°" in told
    assert "reach at most <b>300.00</b> mm" in told


def test_a_small_arm_has_digits_that_count() -> None:
    """Of an arm of 1.1 mm, the place of tool0 has as many digits as that of an arm of a metre."""
    pose = RigidTransform.from_xyz_rpy((0.0008012, 0.0, 0.0002), (0.0, 0.0, 0.0))
    told = words.numbers(pose, TableText(length_unit="m", angle_unit="rad"), 0.0011)
    assert "0.0008012" in told
    assert "reach at most <b>0.0011000</b> m" in told


def test_what_is_lost_is_told_in_a_line() -> None:
    """Six names, and how many there are besides."""
    told = words.remarks(Opened(TableText(), tuple("abcdefgh"), ("a notice",)))
    assert told[0].startswith("The studio's table has no place for a, b")
    assert "f and 2 more: " in told[0]
    assert told[1:] == ["a notice"]


def test_the_paper_is_remarked_on(catalog: Catalog) -> None:
    """Where the paper's variant is shown it is said how far it is from the arm, or why it refuses the table."""
    session = Session(catalog, gallery_table("ur5_paper.csv", catalog))
    assert words.remark(session) == ""
    session.show_variant("both")
    assert words.remark(session).endswith("at this pose its tool0 is 1.41 m and 90° from the table's.")
    session.edit(0, "alpha", "0.3")
    assert words.remark(session).startswith("The variant paper refuses this table: ")
