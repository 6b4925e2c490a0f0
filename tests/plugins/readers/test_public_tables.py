"""Tables as READMEs, lecture notes and programs have them, and the poses that their authors measured or computed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest
from readings import STANDARD, notices_of, problems_of

from dh2urdf.manipulator import JointType, Manipulator

if TYPE_CHECKING:
    from readings import Read, ReadOne


# --- Whole tables, and where their authors say that the tip is --------------------------------------------------------

IRB_120 = """# convention: standard
θ,d (mm),a (mm),α (rad)
θ1,290,0,-π/2
θ2 - π/2,0,270,0
θ3,0,70,-π/2
θ4,302,0,π/2
θ5,0,0,-π/2
θ6 + π,72,0,0
"""
"""The flange of an IRB 120 in its home position is at (374, 0, 630) mm, says ABB's manual."""
KR_210 = """Links,α(i-1),a(i-1),d(i),θ(i)
0->1,0,0,0.75,q1
1->2,- pi/2,0.35,0,q2 - pi/2
2->3,0,1.25,0,q3
3->4,-pi/2,-0.054,1.50,q4
4->5,pi/2,0,0,q5
5->6,-pi/2,0,0,q6
6->EE,0,0,0.303,q7
"""
"""The gripper of a KR 210 is at (2.153, 0, 1.946) m where all joints are 0, says its URDF."""
MARKED = """# convention: standard
k,θ,d,a,α
1,q1+π/2,0.47,0,π/2
2,q2+π/2,0.16,−0.15,π/2
3,q3+π/2,0,0.18,0
4,q4,0,0.17,π/2
5,q5+π/2,0.05,0,π/2
6,q6,0.20,0,0
"""
OPEN_MANIPULATOR = """% Units: mm, degrees
%           a(i-1)  alpha(i-1)  d(i)    theta_offset
Joint,Name,a(i-1),alpha(i-1),d(i),theta_offset,type
1,Base,0,0,77,0,R
2,Shoulder,0,-90,0,-90,R
3,Elbow,128,0,0,90,R
4,Wrist,124,0,0,0,R
5,End Effector,126,0,0,0,fixed
"""
PUBLISHED = {
    "IRB 120": (IRB_120, 6, (0.374, 0, 0.630)),
    "KR 210": (KR_210, 7, (2.153, 0, 1.946)),
    "an exam": (MARKED, 6, (0.71, 0, 0.37)),
    "OpenManipulator": (OPEN_MANIPULATOR, 4, (0.25, 0, 0.205)),
}


@pytest.mark.parametrize("arm_name", PUBLISHED)
def test_the_tip_is_where_the_author_says(arm_name: str, read: Read) -> None:
    """Where all joints are 0: in the maker's manual, in its URDF, in a tutor's key, and in the comment of a program."""
    text, axes, tip = PUBLISHED[arm_name]
    (arm,) = read(text)
    assert isinstance(arm, Manipulator), arm.problems
    np.testing.assert_allclose(arm.fk([0.0] * axes)[:3, 3], tip, atol=1e-12)


# --- Rows that are called like a frame, and move ----------------------------------------------------------------------


@pytest.mark.parametrize("name", ["Base", "1 (Base)", "Gripper", "tool", "6->EE", "6-END", "末端"])
def test_a_row_with_a_variable_moves_whatever_it_is_called(name: str, read_one: ReadOne) -> None:
    """The waist of a small arm is called base; it was refused, though its variable stood in the row."""
    joint = "- {name: '%s', a: 0.3, alpha: 0, d: 0, theta: %s}\n"
    arms = (
        read_one(f"joint,θ,d,a,α\n{name},q1,0,0.3,0\nelbow,q2,0,0.2,0\n"),
        read_one(f"joints:\n{joint % (name, 'q1')}{joint % ('elbow', 'q2')}", ".yaml"),
    )
    for arm in arms:
        assert [row.type for row in arm.rows] == [JointType.REVOLUTE] * 2
        assert arm.notices == ()


def test_a_flange_without_a_variable_is_fixed_as_before(read_one: ReadOne) -> None:
    arm = read_one("joint,a,alpha,d,theta\nelbow,0.3,0,0,q1\nEE,0,0,0.1,0\n")
    assert [row.type.value for row in arm.rows] == ["revolute", "fixed"]


# --- Joint variables that are counted from 0 --------------------------------------------------------------------------


@pytest.mark.parametrize("column", ["", "1,2,3", "0,1,2", "J1,J2,J3", "a,b,c"])
@pytest.mark.parametrize("header", ["i", "joint", "Link"])
@pytest.mark.parametrize("symbol", ["q₀", "q0", "θ_0", "theta0"])
def test_joint_variables_may_be_counted_from_0(symbol: str, header: str, column: str, read_one: ReadOne) -> None:
    """As programs count; each was refused, as the variable of another row."""
    symbols = [symbol.replace("0", str(k)).replace("₀", "₀₁₂"[k]) for k in range(3)]
    labels = [f"{text}," for text in column.split(",")] if column else [""] * 3
    rows = "".join(
        f"{label}0.{k + 1},0,0,{text} + pi/{k + 2}\n"
        for k, (label, text) in enumerate(zip(labels, symbols, strict=True))
    )
    arm = read_one(f"{header + ',' if column else ''}a,alpha,d,theta\n{rows}")
    assert [row.offset for row in arm.rows] == [math.pi / 2, math.pi / 3, math.pi / 4]
    assert arm.notices == ()


# --- A column of joints beside one of their names ---------------------------------------------------------------------


@pytest.mark.parametrize(
    ("header", "cells"),
    [
        ("Joint,Name", "1;2"),
        ("Name,Joint", "1;2"),
        ("Axis,Joint name", "A1;A2"),
        ("Joint,Joint Name", "Joint 1;Joint 2"),
        ("Gelenk,Gelenkname", "G1;G2"),
        ("关节,名称", "关节1;关节2"),
    ],
)
def test_a_column_of_joints_may_count_the_named_ones(header: str, cells: str, read_one: ReadOne) -> None:
    """Hobby arms and data sheets have both; the table was refused for two columns of joints."""
    rows = [
        f"part{k},{text}" if header == "Name,Joint" else f"{text},part{k}" for k, text in enumerate(cells.split(";"))
    ]
    arm = read_one(f"{header},a,alpha,d\n{rows[0]},0.3,0,0\n{rows[1]},0.2,0,0\n")
    assert [row.joint for row in arm.rows] == ["part0", "part1"]
    assert not arm.notices


def test_labels_of_axes_are_left_out_beside_names(read_one: ReadOne) -> None:
    """Motoman's S, L, U count nothing."""
    arm = read_one("Axis,Name,a,alpha,d\nS,swing,0.3,0,0\nL,lower arm,0.2,0,0\n")
    assert [row.joint for row in arm.rows] == ["swing", "lower arm"]


@pytest.mark.parametrize("key", ["joint", "index", "i", "no"])
def test_joints_of_yaml_may_be_counted(key: str, read: Read, read_one: ReadOne) -> None:
    joint = "- {%s: %s, name: %s, a: 0.3, alpha: 0, d: 0}\n"
    arm = read_one(f"joints:\n{joint % (key, 1, 'x')}{joint % (key, 2, 'y')}", ".yaml")
    assert [row.joint for row in arm.rows] == ["x", "y"]
    text = f"convention: standard\njoints:\n{joint % (key, 1, 'x')}{joint % (key, 3, 'y')}"
    assert any("the index is '3'" in problem.message for problem in problems_of(read, text, ".yaml"))


@pytest.mark.parametrize("header", ["n", "k", "j"])
def test_a_letter_may_count_the_rows(header: str, read: Read, read_one: ReadOne) -> None:
    assert len(read_one(f"{header},a,alpha,d\n1,0.3,0,0\n2,0.2,0,0\n").rows) == 2
    (problem,) = problems_of(read, f"{STANDARD}{header},a,alpha,d\n1,0.3,0,0\n3,0.2,0,0\n")
    assert "the number of a row" in problem.message


# --- Advice that leads to a table that works --------------------------------------------------------------------------


# --- Columns of joints that hold types --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "words",
    ["R,R,P", "rotacional,rotacional,prismática", "旋转,旋转,移动"],
)
@pytest.mark.parametrize("link", ["1,2,3", "upper,lower,hand_link"])
def test_a_column_of_joints_that_holds_types_is_read_as_such(words: str, link: str, read_one: ReadOne) -> None:
    """`Link, Joint, a, …` of lecture notes: R was a name that another joint had, and the advice was to call it R_joint."""
    rows = [*zip(link.split(","), words.split(","), strict=True)]
    arm = read_one("Link,Joint,a,α,d\n" + "".join(f"{name},{word},0.3,0,0\n" for name, word in rows))
    sliding = [word in ("P", "Prismatic", "linear", "prismática", "移动") for _, word in rows]
    assert [row.type is JointType.PRISMATIC for row in arm.rows] == sliding
    assert [row.joint for row in arm.rows] == ["joint_1", "joint_2", "joint_3"]
    assert "is read as that of types" in notices_of(arm)


def test_it_is_in_yaml_too(read_one: ReadOne) -> None:
    joint = "- {{joint: {}, a: 0.3, alpha: 0, d: 0}}\n"
    arm = read_one(f"joints:\n{joint.format('revolute')}{joint.format('prismatic')}", ".yaml")
    assert [row.type.value for row in arm.rows] == ["revolute", "prismatic"]


@pytest.mark.parametrize("names", ["S,L,U,R,B,T", "R,T", "R,elbow"])
def test_axes_that_are_called_by_letters_keep_their_names(names: str, read_one: ReadOne) -> None:
    """Motoman's R and T turn."""
    rows = "".join(f"{name},0.3,0,0\n" for name in names.split(","))
    arm = read_one(f"joint,a,alpha,d\n{rows}")
    assert {row.type for row in arm.rows} == {JointType.REVOLUTE}
    assert [row.joint for row in arm.rows] == names.split(",")


# --- Units in other letters -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "table",
    [
        "关节,θ（度）,d（毫米）,a（毫米）,α（度）,速度（度/秒）\n1,90,400,300,90,180\n",
        "звено;θ, градусы;d, мм;a, мм;α, градусы;скорость, градусы/с\n1;90;400;300;90;180\n",
        "관절,θ(도),d(밀리미터),a(mm),α(도),속도(도/초)\n1,90,400,300,90,180\n",
        "i,theta,d,a,alpha,velocity\n1,90°,400 мм,30 см,90 градусов,π рад/с\n",
        "# units: {length: мм, angle: 度}\ni,theta,d,a,alpha,velocity\n1,90,400,300,90,180\n",
    ],
)
def test_units_in_other_letters_are_read(table: str, read_one: ReadOne) -> None:
    """The headers were read in these languages, and their units were none."""
    (row,) = read_one(table).rows
    assert (row.a, row.alpha, row.d, row.theta) == (0.3, math.pi / 2, 0.4, math.pi / 2)
    assert row.limits.velocity == math.pi


# --- Directions and joints that nothing drives ------------------------------------------------------------------------


@pytest.mark.parametrize("header", ["active", "Actuated", "enabled", "driven", "moving"])
@pytest.mark.parametrize("cell", ["0", "false", "No"])
def test_a_joint_that_nothing_drives_is_not_left_out(header: str, cell: str, read: Read, read_one: ReadOne) -> None:
    (problem,) = problems_of(read, f"{STANDARD}a,alpha,d,{header}\n0.3,0,0,1\n0.2,0,0,{cell}\n")
    assert "whether a joint moves by itself" in problem.message
    assert len(read_one(f"a,alpha,d,{header}\n0.3,0,0,1\n0.2,0,0,true\n").rows) == 2


# --- YAML of other programs -------------------------------------------------------------------------------------------


def test_keys_of_moveit_are_limits(read_one: ReadOne) -> None:
    limits = "limits: {min_position: -1, max_position: 2, max_velocity: 3, max_effort: 4}"
    (row,) = read_one(f"joints: [{{a: 0.3, alpha: 0, d: 0, {limits}}}]", ".yaml").rows
    assert (row.limits.lower, row.limits.upper, row.limits.velocity, row.limits.effort) == (-1, 2, 3, 4)


@pytest.mark.parametrize("header", ["joint", "i", "Link"])
@pytest.mark.parametrize("frame", ["EE", "e.e.", "tool"])
def test_a_frame_behind_joints_is_fixed_also_where_one_of_them_slides(
    header: str, frame: str, read_one: ReadOne
) -> None:
    """A SCARA with a row for its tool: the variable in d was none, and `EE` in a column i no number."""
    rows = f"1,θ1,0.4,0.3,0\n2,θ2,0,0.2,pi\n3,0,d3,0,0\n{frame},0,0.1,0,0\n"
    arm = read_one(f"{header},theta,d,a,alpha\n{rows}")
    assert [row.type.value for row in arm.rows] == ["revolute", "revolute", "prismatic", "fixed"]


@pytest.mark.parametrize("row", ["*,q2,0,0", "3),pi,0,0"])
def test_a_row_with_such_a_mark_is_no_footnote(row: str, read: Read) -> None:
    assert problems_of(read, f"{STANDARD}i,a,alpha,d\n1,0.3,0,0\n\n{row}\n")
