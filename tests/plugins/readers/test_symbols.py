"""Names for lengths: where they are defined, which are refused, and columns that the options leave out."""

import math
from pathlib import Path

import pytest

import dh2urdf
from dh2urdf.errors import Dh2UrdfError

HEADER = "i,theta,d,a,alpha"
ROWS = "1,q1,L1,0,pi/2\n2,q2,0,a_2,0\n"
YAML = """convention: standard
symbols: {L1: 91 mm, a2: 0.35}
joints:
- {theta: q1, d: L1, a: 0, alpha: pi/2}
- {theta: q2, d: 0, a: $a_2$, alpha: 0}
"""
STANDARD = "# convention: standard\n"


@pytest.mark.parametrize(
    "table",
    [
        f"{STANDARD}# L1 = 0.091\n# a2: 350 mm\n{HEADER}\n{ROWS}",
        f"{STANDARD}# a2=0.35, L1=9.1 cm\n{HEADER}\n{ROWS}",
        f"{STANDARD}# with L_1 = 91 mm and a_{{2}} = 0.35 m, as measured\n{HEADER}\n{ROWS}",
        f"{STANDARD}{HEADER}\n{ROWS}# L1 = 0.091\n# a2 = 350 mm\n",
        f"{STANDARD}# L1=91mm a2=350mm\n{HEADER}\n{ROWS}",
        f"{STANDARD}{HEADER}\n{ROWS}L1 = 91 mm, a2 = 350 mm\n",
        f"{STANDARD}i\ttheta\td\ta\talpha\n1\tq1\tL1\t0\tpi/2\n2\tq2\t0\ta_2\t0\nL₁ = 91 mm, a₂ = 350 mm\n",
        f"{STANDARD}# symbols: {{L1: 91 mm, a2: 0.35}}\n{HEADER}\n{ROWS}",
        f"{STANDARD}{HEADER}\n1,q1,L1 = 0.091,0,pi/2\n2,q2,0,a2 (350 mm),0\n",
        f"{STANDARD}# L0 = 0.001\n# L1 = 91*L0\n# a2 = 0.3 + 50*L0\n{HEADER}\n{ROWS}",
        f"{STANDARD}# L1 = 91\n# a2 = 350\ni,theta,d [mm],a [mm],alpha\n{ROWS}",
        YAML,
    ],
)
def test_names_stand_for_what_they_are_defined_as(table: str) -> None:
    """In a comment above or below, in a statement, in a cell; a bare number takes the unit of the column."""
    arm = dh2urdf.read(table, reader="yaml" if table.startswith("conv") else "csv")
    assert [(row.d, row.a) for row in arm.rows] == [(pytest.approx(0.091), 0), (0, pytest.approx(0.35))]
    assert [notice for notice in arm.notices if "defined" in notice.message] == []


def test_options_define_names_and_leave_columns_out(tmp_path: Path) -> None:
    path = tmp_path / "arm.csv"
    path.write_text(f"{STANDARD}{HEADER},cost\n1,q1,L1,0,pi/2,3\n2,q2,0,a2,0,5\n")
    for symbol in ({"L1": "91mm", "a2": 0.35}, ["L1=91mm", "a2 = 0.35"]):
        arm = dh2urdf.read(path, symbol=symbol, ignore=["cost"])
        assert [(row.d, row.a) for row in arm.rows] == [(0.091, 0), (0, 0.35)]
    with pytest.raises(Dh2UrdfError, match="no column is called 'price'"):
        dh2urdf.read(path, symbol={"L1": 1, "a2": 1}, ignore="price")


@pytest.mark.parametrize(
    ("top", "d", "code"),
    [
        ("", "L1", "quantity-refused"),
        ("", "d1", "variable-elsewhere"),
        ("", "eval(1)", "quantity-refused"),
        ("# L1 = 1\n# L_1 = 2\n", "L1", "defined-twice"),
        ("# symbols: {q1: 2}\n", "1", "no-name"),
        ("# symbols: {L1: 2 kg}\n", "L1", "no-length-or-angle"),
        ("# symbols: {L1: L2}\n", "L1", "no-length"),
    ],
)
def test_what_is_not_defined_once_is_refused(top: str, d: str, code: str) -> None:
    with pytest.raises(Dh2UrdfError) as caught:
        dh2urdf.read(f"{STANDARD}{top}{HEADER}\n1,q1,{d},0,0\n", reader="csv")
    assert code in [problem.code for problem in caught.value.problems]


def test_a_name_that_is_not_used_is_noticed_and_prose_is_not() -> None:
    table = f"{STANDARD}# L7 = 0.3\n# reach: 850 mm, v = 2 m/s, q1 = 30 deg at home\n{HEADER}\n1,q1,0.1,0,0\n"
    with pytest.warns(dh2urdf.TableWarning, match="L7: defined and not used"):
        arm = dh2urdf.read(table, reader="csv")
    assert len(arm.notices) == 1


def test_the_variable_of_a_row_is_no_name() -> None:
    """d3 of the third row, which slides, and d1 of the first, which turns."""
    table = f"type,{HEADER}\nR,1,q1,d1,0,0\nR,2,q2,0,0.3,pi\nP,3,0,d3 + 0.1,0,0\n"
    arm = dh2urdf.read(f"{STANDARD}# d1 = 0.4\n# d3 = 0.2\n{table}", reader="csv")
    assert (arm.rows[0].d, arm.rows[2].d, arm.rows[2].offset) == (0.4, 0, 0.1)


def test_each_arm_of_a_table_may_define_its_own(tmp_path: Path) -> None:
    """In its cells; what a comment defines holds for all."""
    path = tmp_path / "arms.csv"
    path.write_text(f"{STANDARD}# L2 = 0.2\nrobot,{HEADER}\nx,1,q1,L1 = 0.1,L2,0\ny,1,q1,L1 = 0.3,L2,0\n")
    assert [(arm.rows[0].d, arm.rows[0].a) for arm in dh2urdf.read_all(path)] == [(0.1, 0.2), (0.3, 0.2)]


@pytest.mark.parametrize("how", ["keep", "repair"])
def test_rounded_angles_have_one_notice(how: str) -> None:
    table = f"{STANDARD}{HEADER}\n1,q1,1,0,1.5708\n2,1.57 + q2,0,1,-3.1416\n"
    with pytest.warns(dh2urdf.TableWarning, match="3 angles are rounded like that"):
        arm = dh2urdf.read(table, reader="csv", rounded_pi=how)
    exact = [math.pi / 2, -math.pi] if how == "repair" else [1.5708, -3.1416]
    assert [row.alpha for row in arm.rows] == exact
    assert len(arm.notices) == 1
