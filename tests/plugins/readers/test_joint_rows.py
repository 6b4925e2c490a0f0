"""Rows that are no joints, fixed rows without a type, and numbers in place of names."""

import json
import math
from collections.abc import Callable

import pytest

from dh2urdf.manipulator import JointType, Manipulator
from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.plain.rows import PlainRows

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


@pytest.mark.parametrize(
    ("header", "names", "joints"),
    [
        *(("joint", names, names) for names in ("J1 J2", "I II", "007 épaule", "1a 2a", "X Y Z", "X Y Z C")),
        *(("Axis", axes, "joint_1 joint_2 joint_3") for axes in ("z z z", "Z Y Y")),
        *(("joint", motors, f"joint_{motors.replace(' ', ' joint_')}") for motors in ("3 4", "101 102")),
        *(("joint", numbers, "joint_1 joint_2") for numbers in ("1 2", "1.0 2.0")),
        ("JOINT NAME", "01 02", "joint_01 joint_02"),
        *(("i", numbers, None) for numbers in ("2 1", "1 3", "0 2", "1 1")),
        *(("joint", numbers, None) for numbers in ("2 1", "0 2", "1 1")),
        *((header, "1_(base) 2_(shoulder)", "") for header in ("i", "#", "link", "body")),
        *(
            ("joint", names, names)
            for names in ("1_(base) 2_(shoulder)", "base_(1) shoulder_(2)", "1:_base 2:_shoulder")
        ),
    ],
)
@pytest.mark.parametrize("form", ["csv", "careful", "json"])
def test_names_are_kept_and_numbers_are_made_names(
    header: str, names: str, joints: str | None, *, form: str, read: Read, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In silence; axes of frames are no names, and numbers that rise from elsewhere are those of motors."""
    given = [name.replace("_", " ") for name in names.split()]
    if form == "careful":
        monkeypatch.setattr(PlainRows, "read", lambda *_arguments: None)
    rows = [{header: name, "a": 0, "alpha": 0, "d": 1} for name in given]
    if form == "json":
        (arm,) = read(json.dumps({"convention": "standard", "joints": rows}), ".json")
    else:
        lines = [",".join(map(str, row.values())) for row in rows]
        (arm,) = read("\n".join([f"{header},a,alpha,d", *lines]), convention="standard")
    assert isinstance(arm, Manipulator) == (joints is not None)
    if isinstance(arm, Manipulator) and joints is not None:
        assert arm.notices == ()
        assert {row.type for row in arm.rows} == {JointType.REVOLUTE}
        wanted = [name.replace("_", " ") if joints == names else name for name in joints.split()]
        assert [row.joint for row in arm.rows] == (wanted or [row.joint for row in arm.rows])


@pytest.mark.parametrize("first", [0, 1])
@pytest.mark.parametrize("word", ["", "J", "Axis "])
@pytest.mark.parametrize("header", ["i", "joint", "link"])
def test_rows_are_counted_from_0_or_1(first: int, word: str, header: str, read_one: Callable[..., Manipulator]) -> None:
    arm = read_one("\n".join([f"{header},a,alpha,d", *(f"{word}{first + k},0.1,0,0" for k in range(3))]))
    assert [row.type for row in arm.rows] == [JointType.REVOLUTE] * 3
    assert arm.notices == ()


@pytest.mark.parametrize("header", ["joint", "Motion", "Bewegung"])
def test_a_column_of_words_for_types_is_that_of_types(header: str, read_one: Callable[..., Manipulator]) -> None:
    """Where no other column is, with a notice; a column with other words decides nothing."""
    arm = read_one(f"{header},a,alpha,d\nRotation,0.1,0,0\nRotation,0.1,0,0\nTranslation,0,0,0.2\n")
    assert [str(row.type) for row in arm.rows] == ["revolute", "revolute", "prismatic"]
    assert [notice.code for notice in arm.notices] == ["types-taken"]
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
        ("joint,a,alpha,d,theta", "0"),
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
    arm = read_one(KINOVA.format(header=header, zero=zero, first="0") + "TCP,0,0,0.1,0\n")
    assert [row.type for row in arm.rows] == [JointType.FIXED, *[JointType.REVOLUTE] * 3, JointType.FIXED]


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
