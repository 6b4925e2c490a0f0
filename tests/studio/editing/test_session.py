import math
from dataclasses import replace

import numpy as np
import pytest

from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Convention
from dh2urdf.plugin_system import Catalog
from dh2urdf.table_text import NAMES
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import Session


@pytest.fixture
def session(catalog: Catalog) -> Session:
    return Session(catalog, gallery_table("ur5.csv", catalog))


def test_no_arm_is_left_of_another_table(session: Session) -> None:
    """Rows in which nothing stands yet are nobody's arm: the last good one is not shown for them."""
    for row in range(6):
        for field in set(session.table.rows[row]) - set(NAMES):
            session.edit(row, field, "")
    assert session.arm is None
    assert session.drawing.nodes == ()
    session.undo()
    assert session.table.rows[5].keys() - set(NAMES)


def test_a_table_without_a_convention_is_opened_without_an_arm(session: Session) -> None:
    """The arm of the table before is not the last good one of this one; the convention brings its own."""
    session.open(replace(session.table, convention=""))
    assert session.arm is None
    assert [found.field for found in session.reading.errors] == ["convention"]
    session.set_convention(Convention.STANDARD, convert=False)
    assert session.arm is not None


def test_a_preview_is_on_the_screen_and_in_no_table(session: Session) -> None:
    """What is being typed moves the arm; half a number changes nothing; afterwards all is as it was."""
    before = session.arm
    assert not session.preview(1, "a", "-0.9*")
    assert session.arm is before
    assert session.preview(1, "a", "-0.9")
    assert session.arm is not None
    assert session.arm.manipulator.rows[1].a == -0.9
    assert session.table.rows[1]["a"] == "-0.425"
    session.look()
    assert (session.arm, session.previews) == (before, False)
    session.edit(0, "d", "wrong")
    good = session.arm
    session.preview(0, "d", "0.5")
    session.look()
    assert session.arm is good, "beside a wrong cell, the last good arm comes back"


def test_half_a_limit_moves_no_joint(session: Session) -> None:
    """On the way to 2.5 the limit was 2, and the joint stayed there; so it did when the cell was left as it was."""
    session.move({"elbow_joint": 2.3})
    for text in ("2", "2.", "2.5"):
        session.preview(2, "upper", text)
    assert session.q["elbow_joint"] == 2.3
    session.preview(2, "upper", "1")
    assert session.q["elbow_joint"] == 1.0
    session.look()  # Esc
    assert session.q["elbow_joint"] == 2.3
    session.preview(2, "upper", "2")
    session.move({"wrist_1_joint": 0.7})  # as poses that are played do
    session.edit(2, "upper", "2.5")
    assert (session.q["elbow_joint"], session.q["wrist_1_joint"]) == (2.3, 0.7)


def test_a_joint_that_is_renamed_stays_where_it_is(session: Session) -> None:
    """While its name is typed, too: the joint went back to 0, and stored poses lost it."""
    first, second = (slider.name for slider in session.sliders[:2])
    session.move({first: 0.5, second: 0.25})
    session.poses.append(dict(session.q))
    pose = session.pose
    for text in ("n", "ne", "new"):
        session.preview(0, "joint", text)
        assert session.pose == pose
    session.look()  # Esc
    assert (session.pose, session.q[first]) == (pose, 0.5)
    session.edit(0, "joint", "new")
    session.edit(1, "joint", "newer")
    assert session.pose == pose
    assert {"new": 0.5, "newer": 0.25}.items() <= session.poses[0].items()
    session.arrange("down", session.history.keys[0])
    assert (session.q["new"], session.q["newer"]) == (0.5, 0.25)
    session.undo()
    session.undo()
    session.undo()
    assert (session.pose, session.q[first], session.q[second]) == (pose, 0.5, 0.25)


def test_the_paper_stands_beside_the_arm(session: Session) -> None:
    """Side by side, both robots have poses of their own, and the distance of their tool0 is shown."""
    assert session.arm is not None
    assert session.arm.other is None, "no edit waits for what is not shown"
    session.show_variant("both")
    assert {"tool0", "paper/tool0"} <= {node.name for node in session.drawing.nodes}
    assert session.other_error == pytest.approx((1.40983, math.pi / 2), abs=1e-4)
    session.open(gallery_table("panda.yaml", session.catalog))  # modified, which the paper's refuses
    assert session.other_error is None
    assert session.arm
    assert session.arm.refusal
    assert "tool0" in {node.name for node in session.drawing.nodes}


def test_columns_are_those_of_the_form_and_those_in_use(session: Session) -> None:
    """Masses and inertias are out of the way until a table has them or a person asks for them."""
    assert "velocity" in session.columns
    assert "mass" not in session.columns
    session.all_columns = True
    assert "izz" in session.columns


def test_convention_and_units_are_converted_or_reinterpreted(session: Session) -> None:
    """The same arm with other numbers, or the same numbers of another arm; undo brings both back."""
    session.move(dict.fromkeys(session.q, 0.2))
    before, rows = session.pose, session.table.rows
    assert before is not None
    for change, factor in (
        (lambda convert: session.set_convention(Convention.MODIFIED, convert=convert), None),
        (lambda convert: session.set_units("mm", "deg" if convert else "rad", convert=convert), 1e-3),
    ):
        for convert in (True, False):
            change(convert)
            assert session.pose is not None
            same = np.allclose(as_matrices(session.pose), as_matrices(before), atol=1e-12)
            assert (same, session.table.rows == rows) == (convert, not convert)
            assert factor is None or session.reach == pytest.approx(1.19251 * (1.0 if convert else factor))
            session.undo()
    assert (session.table.rows, session.pose) == (rows, before)
