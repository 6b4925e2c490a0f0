"""Tables as makers, textbooks and spreadsheets have them: what a person meant, or a word about it."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest
from readings import STANDARD

import dh2urdf
from dh2urdf.errors import TableError
from dh2urdf.manipulator import Manipulator
from dh2urdf_plugins.readers.header.columns import TURN_ROUND

if TYPE_CHECKING:
    from readings import Read, ReadOne


# --- Comments ---------------------------------------------------------------------------------------------------------


# --- Cells ------------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("field", ["a", "alpha", "d", "theta", "offset", "lower"])
def test_such_a_number_is_refused_in_bulk(field: str, read: Read) -> None:
    """On the fast path, among numbers with usual exponents."""
    fields = ("a", "alpha", "d", "theta", "offset", "lower", "upper")
    row = dict.fromkeys(fields, "0") | {"a": "0.3", "lower": "-1", "upper": "1"}
    rows = [row | {"d": "1e-05"} for _ in range(400)]
    rows[300] |= {field: "1e-400"}
    lines = "".join(f"r{k},{','.join(row.values())}\n" for k, row in enumerate(rows))
    arms = read(f"{STANDARD}robot,{','.join(fields)}\n{lines}")
    assert [arm.name for arm in arms if not isinstance(arm, Manipulator)] == ["r300"]


# --- Words in other languages, and in other places --------------------------------------------------------------------


@pytest.mark.parametrize("name", ["θ_offset", "theta_offset_i", "Joint angle offset"])
@pytest.mark.parametrize("kind", ["R", "P"])
def test_an_offset_of_theta_is_the_constant_part_of_theta(name: str, kind: str, read_one: ReadOne) -> None:
    """It was refused; it is an angle, also where the joint slides."""
    arm = read_one(f"type,a,alpha,d,{name}\n{kind},0.3,0,0.1,pi/2\n")
    expected = read_one(f"type,a,alpha,d,theta\n{kind},0.3,0,0.1,pi/2\n")
    assert arm.fk([0.7]) == pytest.approx(expected.fk([0.7]))
    assert read_one(f"type,a,alpha,d,{name} [deg]\n{kind},0.3,0,0.1,30\n").rows[0].theta == pytest.approx(math.pi / 6)


@pytest.mark.parametrize(
    "table",
    [
        "parameter,J1,J2,J3\na,0,0.3,0.2\nalpha,pi/2,0,0\nd,0.1,0,0",
        "parameter,J1,J2\na,0,0.3\nalpha,pi/2,0\nd,0.1,0",
        "param;1;2;3\na [mm];0;300;200\nalpha;90;0;0\nd;100;0;0",
        "a,0,0.3,0.2\nalpha,0,0,0\nd,0.1,0,0",
    ],
)
def test_a_table_whose_joints_are_in_columns_is_to_be_turned_round(table: str) -> None:
    """The advice was that no field is called '0.3'."""
    with pytest.raises(TableError) as caught:
        dh2urdf.read(f"# convention: standard\n{table}\n", reader="csv")
    assert TURN_ROUND in str(caught.value)


# --- Legends, footnotes and cells that say that there is nothing ------------------------------------------------------


def test_a_row_of_names_that_are_headers_too_is_a_row(read_one: ReadOne) -> None:
    """Numbers are in it."""
    assert [row.joint for row in read_one("joint,link,a,alpha,d\nmass,base plate,0.3,0,0\n").rows] == ["mass"]
