"""Rows that are no joints, fixed rows without a type, and numbers in place of names."""

from __future__ import annotations

import json
import math
from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf_plugins.readers.plain.rows import PlainRows

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.stages import Rejected

    Read = Callable[..., list[Manipulator | Rejected]]


@pytest.mark.parametrize(
    ("rows", "types"),
    [
        ("waist:0.3,0,0;elbow_2:0.2,0,0", "RR"),
        ("lift:0.3,0,0;P2:0.2,0,0", "RR"),  # a name decides nothing
        ("wrist_flange_rotation:0.3,0,0;base_yaw:0.2,0,0", "RR"),
        *((f"j1:0.3,0,0;{name}:0.5,0,0.3", "") for name in ("Total", "mean", "TCP", "tool frame", "Base", "合计")),
    ],
)
@pytest.mark.parametrize("many", [1, 300])
def test_rows_called_like_totals_and_tools_are_refused_without_types(
    rows: str, types: str, many: int, read: Read
) -> None:
    """By whole names of one list; in a table of types the type decides."""
    names = [row.replace(":", ",") for row in rows.split(";")]
    lines = [f"r{robot},{row}" for robot in range(many) for row in names]
    for arm in read("\n".join(["robot,joint,a,alpha,d", *lines]), convention="standard"):
        assert isinstance(arm, Manipulator) == bool(types)
        if isinstance(arm, Manipulator):
            assert "".join(row.type.value[0].upper() for row in arm.rows) == types
    lines = [line.replace(",", ",R,", 2).replace(",R,", ",", 1) for line in lines]
    typed = read("\n".join(["robot,joint,type,a,alpha,d", *lines]), convention="standard")
    assert all(isinstance(arm, Manipulator) for arm in typed)


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("word", ["", "J", "Axis "])
@pytest.mark.parametrize("header", ["i", "joint", "link"])
def test_rows_are_counted_from_0_or_1(first: int, word: str, header: str, read_one: Callable[..., Manipulator]) -> None:
    arm = read_one("\n".join([f"{header},a,alpha,d", *(f"{word}{first + k},0.1,0,0" for k in range(3))]))
    assert [row.type for row in arm.rows] == [JointType.REVOLUTE] * 3
    assert arm.notices == ()


@pytest.mark.parametrize("numbers", [["2", "1"], ["1", "3"], ["0", "2"], ["1", "1"]])
@pytest.mark.parametrize("header", ["i", "joint"])
def test_numbers_in_another_order_are_refused(numbers: list[str], header: str, read: Read) -> None:
    (arm,) = read("\n".join([f"{header},a,alpha,d", *(f"{number},0,0,1" for number in numbers)]), convention="standard")
    assert not isinstance(arm, Manipulator)


@pytest.mark.parametrize("header", ["joint", "Motion", "Bewegung"])
def test_a_column_of_words_for_types_is_that_of_types(header: str, read_one: Callable[..., Manipulator]) -> None:
    """Where no other column is, with a notice; a column with other words decides nothing."""
    arm = read_one(f"{header},a,alpha,d\nRotation,0.1,0,0\nRotation,0.1,0,0\nTranslation,0,0,0.2\n")
    assert [str(row.type) for row in arm.rows] == ["revolute", "revolute", "prismatic"]
    assert any("is read as that of types" in notice.message for notice in arm.notices)
    arm = read_one("Motion,a,alpha,d\nRotation,0.1,0,0\nbase,0.1,0,0\n")
    assert [str(row.type) for row in arm.rows] == ["revolute", "revolute"]


KINOVA = """{header}
{zero},0,pi,0,{first}
1,0,pi/2,-0.2848,q1
2,0,pi/2,-0.0118,q2 + pi
3,0,pi/2,-0.4208,q3 + pi
"""


@pytest.mark.parametrize(
    ("header", "zero"),
    [
        ("i,a,alpha,d,theta", "0"),
        ("i,a,alpha,d,theta", "0 (from base)"),
        ("i,a,alpha,d,theta", "base"),
        ("joint,a,alpha,d,theta", "0"),
        ("link,a,alpha,d,theta", "0"),
        ("joint,a,alpha,d,theta", "base"),
        ("joint,a,alpha,d,theta", "Base frame"),
        ("link,a,alpha,d,theta", "ground"),
    ],
)
def test_row_0_of_a_table_with_variables_is_fixed(header: str, zero: str, read_one: Callable[..., Manipulator]) -> None:
    """As Kinova prints it: its theta has no variable, and q1 is in the second row."""
    arm = read_one(KINOVA.format(header=header, zero=zero, first="0"))
    assert [row.type for row in arm.rows] == [JointType.FIXED, *[JointType.REVOLUTE] * 3]
    assert [row.offset for row in arm.rows] == [0, 0, math.pi, math.pi]
    assert [row.joint for row in arm.rows][1:] == ["joint_1", "joint_2", "joint_3"]
    assert arm.notices == ()


def test_a_fixed_row_0_is_read_with_its_type(read_one: Callable[..., Manipulator]) -> None:
    """Without any variable."""
    arm = read_one("i,type,a,alpha,d\n0,fixed,0,pi,0\n1,R,0.1,0,0\n2,R,0.1,0,0\n")
    assert [row.joint for row in arm.rows] == ["joint_0", "joint_1", "joint_2"]


def test_a_flange_beside_variables_is_fixed(read: Read) -> None:
    """As Franka prints it; in YAML too."""
    rows = [{"name": f"j{k}", "a": 0.1, "alpha": 0, "d": 0, "theta": f"q{k}"} for k in (1, 2)]
    flange = {"name": "Flansch", "a": 0, "alpha": 0, "d": 0.107, "theta": 0}
    text = "\n".join(["joint,a,alpha,d,theta", *(",".join(map(str, row.values())) for row in (*rows, flange))])
    for arm in (
        *read(text, convention="standard"),
        *read(json.dumps({"convention": "standard", "joints": [*rows, flange]}), ".yaml"),
    ):
        assert isinstance(arm, Manipulator)
        assert [str(row.type) for row in arm.rows] == ["revolute", "revolute", "fixed"]
        assert arm.notices == ()


@pytest.mark.parametrize("header", ["joint", "Joint", "link", "JOINT NAME"])
@pytest.mark.parametrize("numbers", [["1", "2", "3"], ["1.0", "2.0", "3.0"], ["01", "02", "03"]])
@pytest.mark.parametrize("form", ["csv", "careful", "json"])
def test_numbers_are_made_names(
    header: str, numbers: list[str], form: str, read: Read, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In silence: a robot description has no joint named 1."""
    field = "link" if header == "link" else "joint"
    if form == "careful":
        monkeypatch.setattr(PlainRows, "read", lambda *_arguments: None)
    if form == "json":
        joints = [{field if field == "link" else "name": number, "a": 0, "alpha": 0, "d": 1} for number in numbers]
        (arm,) = read(json.dumps({"convention": "standard", "joints": joints}), ".json")
    else:
        rows = [f"{number},0,0,1" for number in numbers]
        (arm,) = read("\n".join([f"{header},a,alpha,d", *rows]), convention="standard")
    assert isinstance(arm, Manipulator)
    assert [getattr(row, field) for row in arm.rows] == [f"{field}_{number.removesuffix('.0')}" for number in numbers]
    assert arm.notices == ()


@pytest.mark.parametrize("names", [["J1", "J2"], ["A1", "B1"], ["I", "II"], ["007", "épaule"], ["1a", "2a"]])
def test_other_names_are_kept(names: list[str], read_one: Callable[..., Manipulator]) -> None:
    """Letter for letter."""
    arm = read_one("\n".join(["joint,a,alpha,d", *(f"{name},0,0,1" for name in names)]))
    assert [row.joint for row in arm.rows] == names


@pytest.mark.parametrize(
    ("axes", "are_names"),
    [
        *((axes, False) for axes in (["Z", "Y", "Y", "X"], ["z", "z", "z"])),
        *((axes, True) for axes in (["X", "Y", "Z"], ["X", "Y", "Z", "C"])),
    ],
)
def test_axes_are_no_names(axes: list[str], are_names: bool, read_one: Callable[..., Manipulator]) -> None:  # noqa: FBT001 - a case
    """``Eje | Z | Y | Y | X`` beside the parameters; the joints of a gantry are called X, Y, Z."""
    arm = read_one("\n".join(["Axis,a,alpha,d", *(f"{axis},0,0,1" for axis in axes)]))
    assert [row.joint for row in arm.rows] == (axes if are_names else [f"joint_{k + 1}" for k in range(len(axes))])


@pytest.mark.parametrize("numbers", [["3", "4"], ["10", "20"], ["101", "102"]])
def test_numbers_that_rise_from_elsewhere_are_those_of_motors(
    numbers: list[str], read_one: Callable[..., Manipulator]
) -> None:
    """They count no rows, and name the joints."""
    arm = read_one("\n".join(["joint,a,alpha,d", *(f"{number},0,0,1" for number in numbers)]))
    assert [row.joint for row in arm.rows] == [f"joint_{number}" for number in numbers]
    assert arm.notices == ()


def test_a_table_of_a_million_rows_reads_alike(read: Read) -> None:
    """An arm with numbers for names in the middle of others gets the same names as alone."""
    lines = [f"r{robot},{joint},R,0.1,0,0" for robot in range(300) for joint in ("j1", "j2")]
    lines[300:300] = ["odd,1,R,0.1,0,0", "odd,2,R,0.1,0,0"]
    arms = read("\n".join(["robot,joint,type,a,alpha,d", *lines]), convention="standard")
    (odd,) = (arm for arm in arms if arm.name == "odd")
    assert isinstance(odd, Manipulator)
    assert [row.joint for row in odd.rows] == ["joint_1", "joint_2"]


def test_notes_below_the_rows_are_refused(read: Read) -> None:
    """A row of dashes is no joint."""
    for note in ("---,---,---", "...,...,..."):
        try:
            (arm,) = read(f"a,alpha,d\n0.3,0,0\n{note}\n", convention="standard")
        except TableError:
            continue
        assert not isinstance(arm, Manipulator)


@pytest.mark.parametrize(
    ("rows", "types"),
    [
        ("0.3,0,0.1,θ1;0.2,pi,0,q2;0,0,d3,0", "RRP"),
        ("0.3,0,0.1,θ1*;0.2,pi,0,θ2* + pi/2;0,0,d3* + 0.05,pi/2", "RRP"),
        ("0,pi/2,q1,0;0,pi/2,q2,0", "PP"),
        ("0.3,0,d1,θ1;0,0,d2,0", ""),  # a length that is not said
        ("0.3,0,0.1,θ1;0,0,d2,", ""),
        ("0.3,0,0.1,0;0,0,d2,0", ""),
        ("0.3,0,0.1,θ1;0,0,d3,0", ""),
    ],
)
@pytest.mark.parametrize("form", ["csv", "yaml"])
def test_a_variable_in_d_makes_a_row_without_types_prismatic(rows: str, types: str, form: str, read: Read) -> None:
    """Where every row has one variable, as textbooks have them; it was refused."""
    cells = [row.split(",") for row in rows.split(";")]
    if form == "csv":
        text = "\n".join(["a,alpha,d,theta", *(",".join(row) for row in cells)])
    else:
        names = ("a", "alpha", "d", "theta")
        joints = [", ".join(f"{n}: {c}" for n, c in zip(names, row, strict=True) if c) for row in cells]
        text = f"joints: [{', '.join(f'{{{joint}}}' for joint in joints)}]"
    (arm,) = read(text, f".{form}", convention="standard")
    assert isinstance(arm, Manipulator) == bool(types)
    if isinstance(arm, Manipulator):
        assert "".join(row.type.value[0].upper() for row in arm.rows) == types
        assert arm.notices == ()


def test_a_yaml_table_has_no_merged_cells(read_one: Callable[..., Manipulator]) -> None:
    """A key that only the first joint has is meant so."""
    joints = [{"a": 0.3, "alpha": 0, "d": 0, "limits": {"velocity": 1}}, *[{"a": 0.3, "alpha": 0, "d": 0}] * 2]
    assert read_one(json.dumps({"convention": "standard", "joints": joints}), ".json").notices == ()


@pytest.mark.parametrize(
    ("first", "second"),
    [
        *(("1 (base)", "2 (shoulder)"), ("Joint 1 (Sockel)", "Joint 2 (Schulter)"), ("base (1)", "shoulder (2)")),
        *(("1: base", "2: shoulder"), ("1 - base", "2 - shoulder"), ("J1 [base]", "J2 [shoulder]")),
    ],
)
@pytest.mark.parametrize("header", ["i", "joint", "#", "Axis"])
def test_joint_1_may_be_called_after_the_base(first: str, second: str, header: str, read: Read) -> None:
    """As that of the Braccio, where all rows have the numbers of joints."""
    (arm,) = read(f"# convention: standard\n{header},a,alpha,d\n{first},0.3,0,0.1\n{second},0.2,0,0\n")
    assert isinstance(arm, Manipulator), arm.problems
    assert [(row.joint, row.type) for row in arm.rows] == [(first, JointType.REVOLUTE), (second, JointType.REVOLUTE)]


@pytest.mark.parametrize("header", ["link", "body", "n", "k"])
def test_joint_1_may_be_called_after_the_base_in_a_column_of_links_or_rows(header: str, read: Read) -> None:
    """It was refused there."""
    (arm,) = read(f"# convention: standard\n{header},a,alpha,d\n1 (base),0.3,0,0.1\n2 (shoulder),0.2,0,0\n")
    assert isinstance(arm, Manipulator), arm.problems
    assert [row.type for row in arm.rows] == [JointType.REVOLUTE] * 2


def test_a_first_row_called_0_is_fixed_where_a_flange_follows_the_joints(read_one: Callable[..., Manipulator]) -> None:
    """Six errors spoke of rows that are counted from 1."""
    rows = "0,0,0,0.35,0\n1,0.1,pi/2,0.4,q1\n2,0.4,0,0,q2\nTCP,0,0,0.1,0\n"
    arm = read_one(f"joint,a,alpha,d,theta\n{rows}")
    assert [str(row.type) for row in arm.rows] == ["fixed", "revolute", "revolute", "fixed"]
