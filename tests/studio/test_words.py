from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Convention
from dh2urdf.rotations import RigidTransform
from dh2urdf.table_text import TableText
from dh2urdf_studio import words
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.opening import Opened, gallery_table
from dh2urdf_studio.editing.session import Session

if TYPE_CHECKING:
    from dh2urdf.plugin_system import Catalog


def test_what_the_page_says(catalog: Catalog) -> None:
    """The next step from an empty table to an arm, the place of a problem, numbers in the units of the table."""
    session = Session(catalog)
    told = [status(session)]
    session.put(edits.resized(session.table, 2))
    session.set_convention(Convention.STANDARD, convert=False)
    told.append(status(session))
    for row in range(2):
        session.put(edits.with_cells(session.table, {(row, field): "0.1" for field in ("a", "alpha", "d")}))
        told.append(status(session))
    session.edit(1, "a", "x")
    told.append(status(session))
    (found,) = session.reading.errors
    told += [words.place(found, session.table), words.place(replace(found, row=None, field="base"), session.table)]
    told += [status(Session(catalog, gallery_table("panda.yaml", catalog)))]
    told += [words.remarks(Opened(TableText(), tuple("abcdefgh")))[0]]
    paper = Session(catalog, gallery_table("ur5_paper.csv", catalog))
    told.append(words.remark(paper))
    paper.show_variant("both")
    told.append(words.remark(paper).partition("its tool0")[2])
    paper.edit(0, "alpha", "0.3")
    told.append(words.remark(paper).partition(":")[0])
    assert told == [
        "choose the number of axes, or paste a table",
        "rows 1 to 2 are still empty",
        "row 2 is still empty; the arm of the first row is shown",
        "2 axes; the arm is the table's",
        "1 problem; the last good arm is shown",
        "row 2, joint_2, a: ",
        "base: ",
        "7 axes and 1 fixed joint; the arm is the table's",
        "The studio's table has no place for a, b, c, d, e, f and 2 more: what is made here is without.",
        "",
        " is 1.41 m and 90° from the table's.",
        "The variant paper refuses this table",
    ]


def status(session: Session) -> str:
    return words.status(session, len(session.reading.errors))[0]


def test_numbers_are_in_the_units_of_the_table() -> None:
    """Millimetres and degrees, and no minus before a zero; of a small arm, as many digits as count."""
    pose = RigidTransform.from_xyz_rpy((0.1, -0.0, 0.25), (0.0, 0.0, math.pi / 2))
    told = words.numbers(pose, TableText(length_unit="mm", angle_unit="deg"), 0.3)
    assert "-0.00" not in told
    for number in ("100.00", "rpy <b>0.0000, 0.0000, 90.0000</b>°", "reach at most <b>300.00</b> mm"):
        assert number in told
    pose = RigidTransform.from_xyz_rpy((0.0008012, 0.0, 0.0002), (0.0, 0.0, 0.0))
    told = words.numbers(pose, TableText(length_unit="m", angle_unit="rad"), 0.0011)
    assert "0.0008012" in told
    assert "reach at most <b>0.0011000</b> m" in told
