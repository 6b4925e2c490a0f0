"""Comment lines: those that say something about the table, those that seem to, and prose."""

from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import Convention, Manipulator

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.stages import Rejected

ROWS = "a,alpha,d\n300,90,100\n"


@pytest.mark.parametrize(
    "comment",
    [
        "# units: {length: mm, angle: deg}",
        "# units: mm, deg",
        "# units: mm/deg",
        "# units: [mm, deg]",
        "# units [mm, deg]",
        "# units (mm; deg)",
        "# Units = mm and degrees",
        "# Unit: mm, °",
        "# Einheiten: mm und deg",
        "# mm / deg",
        "# lengths in mm, angles in degrees",
        "# All lengths are in millimetres; all angles are given in degrees.",
        "# a and d in mm, alpha and theta in deg",
        "# lengths: mm\n# angles: deg",
        "# length_unit: mm\n# angle_unit: deg",
        "# Length unit = mm\n\n# unit of angles: deg",
        "#lengths [mm]\n#angles [deg]",
        "## units: mm, deg",
        "# - units: mm, deg",
        "// units: mm, deg",
        "% lengths in mm, angles in deg",
        "\N{FULLWIDTH NUMBER SIGN} units\N{FULLWIDTH COLON} mm, deg",
        "'# units: mm, deg",
        "\ufeff# units: mm, deg",
        "# units: {length: mm, angle: deg},,,,",
        '"# units: {length: mm, angle: deg}",,',
        '"\'# units: {length: mm, angle: deg}",,',
        "# units,mm,deg",
        "# units:,mm,deg,,",
        '"# units","mm","deg"',
        ",# units: mm/deg,,",
        '"# a table of mine\n# units: mm, deg",,',
        '"",""\n"# units: mm, deg",""',
        *("# (Units: mm, degrees.)", "# Note: units -> mm, deg", "# 1 unit = 1 mm, 1 angle unit = 1°"),
        *("# One unit equals one mm; angles in degrees", "# a/mm, alpha/deg, d/mm", "# a [mm], alpha [deg], d [mm]"),
        *("# standard DH convention, units: mm and degrees.", "# DH parameters (standard, mm, deg)"),
        *("# convention: standard; units: mm, deg", "# Convention: standard DH (units mm/deg)", "# SDH - mm - deg"),
        "sep=,\n# units: mm, deg",
    ],
)
def test_the_units_of_a_comment_hold_however_it_is_written(comment: str, read_one: Callable[..., Manipulator]) -> None:
    """By people in words or as YAML, and by spreadsheets in cells."""
    (row,) = read_one(f"{comment}\n{ROWS}").rows
    assert (row.a, row.alpha, row.d) == (0.3, pytest.approx(1.5707963267948966), 0.1)


@pytest.mark.parametrize(
    "comment", ["# units [in, deg]", "# units: in/deg", "# lengths in in", "# length_unit: in", "# units: deg, in"]
)
def test_in_is_a_unit_where_nothing_follows_it(comment: str, read_one: Callable[..., Manipulator]) -> None:
    """Otherwise it is a preposition."""
    assert read_one(f"{comment}\na,alpha,d\n10,0,0\n").rows[0].a == pytest.approx(0.254)


@pytest.mark.parametrize("delimiter", [";", "\t"])
@pytest.mark.parametrize(
    "comment",
    [
        "# tool: {xyz: [0, 0, 0.5]}",
        "# tool: {xyz: [0, 0, 0.5]};;;",
        "# tool: {xyz: [0;0; 0.5]};;",
        "# tool: {xyz: [0; 0; 0,5]}",
        "# tool: {xyz: [0; 0; 0,5]; rpy: [0; 0; 0]}",
        "# tool: {xyz: [0;0,0; 0.5];rpy: [0;0;0]};",
        '"# tool: {xyz: [0";0;"0,5]}";',
        "# tool {xyz: [0, 0, 0.5]}",
        "# tool: [[1;0;0;0];[0;1;0;0];[0;0;1;0,5];[0;0;0;1]]",
    ],
)
def test_a_comment_that_was_split_into_cells_is_one_again(
    comment: str, delimiter: str, read_one: Callable[..., Manipulator]
) -> None:
    """With semicolons and tabs in place of its commas, and with decimal commas."""
    table = f"{comment}\na;alpha;d\n0,3;0;0,1\n".replace(";", delimiter)
    assert read_one(table).tool.translation == (0, 0, 0.5)


@pytest.mark.parametrize(
    ("comment", "name"),
    [
        (r'# robot: "say \"hi\", \u00e9"', 'say "hi", é'),
        ("# Manipulator = 'it''s'", "it's"),
        (r'# robot: "r4, g\u00dfn"', "r4, gßn"),  # no grams
        ('# model: "ur5"', "ur5"),
        ("# model: ur5", "ur5"),
    ],
)
def test_a_name_in_quotes_is_read_as_yaml(comment: str, name: str, read_one: Callable[..., Manipulator]) -> None:
    """Under each of the keys that say the name, as under `name`."""
    assert read_one(f"{comment}\na,alpha,d\n0.3,0,0.1\n").name == name


@pytest.mark.parametrize(
    ("comment", "convention"),
    [
        ("# DH convention = modified", Convention.MODIFIED),
        ("# convention is modified", Convention.MODIFIED),
        ("# convention,modified,", Convention.MODIFIED),
        ("# convention:,modified,", Convention.MODIFIED),
        ("# Craig's convention", Convention.MODIFIED),
        ("# This table uses the standard DH convention.", Convention.STANDARD),
        ("# notation: Craig", Convention.MODIFIED),
        ("# DH: classic", Convention.STANDARD),
        ('"# convention: standard",,,', Convention.STANDARD),
        ("# Modified DH parameters", Convention.MODIFIED),
        ("# (D-H parameters, modified form)", Convention.MODIFIED),
        ("# Denavit\N{EN DASH}Hartenberg according to Craig, units: m.", Convention.MODIFIED),
        ("# DH modifiée", Convention.MODIFIED),
        ("# MDH; m; rad", Convention.MODIFIED),
        ("# convention: Craig, lengths in m", Convention.MODIFIED),
        ("# Standard DH convention, units: meters.", Convention.STANDARD),
        ("# UR5 - modified DH", Convention.MODIFIED),
        ("# UR5: modified DH, m, rad", Convention.MODIFIED),
        ("# Panda - modified DH", Convention.MODIFIED),
        ("# Franka Emika Panda (modified DH)", Convention.MODIFIED),
        ("# Stanford arm: standard DH parameters", Convention.STANDARD),
        ("# Modified DH parameters of the KUKA iiwa robot", Convention.MODIFIED),
        ("# KUKA KR 16 - modified DH", Convention.MODIFIED),
        ("# UR5e (standard DH)", Convention.STANDARD),
        ("# KR 16 DH parameters (modified)", Convention.MODIFIED),
        ("# Modified DH parameters of the UR5 robot", Convention.MODIFIED),
        ("# Modified DH for Puma 560", Convention.MODIFIED),
        ("# units: m, rad\n# IRB120, standard DH, m", Convention.STANDARD),
    ],
)
def test_the_convention_of_a_comment_holds(
    comment: str, convention: Convention, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """In words that say nothing else."""
    (arm,) = read(f"{comment}\na,alpha,d\n0.3,0,0.1\n")
    assert isinstance(arm, Manipulator)
    assert arm.convention is convention


@pytest.mark.parametrize(
    ("comment", "said"),
    [
        ("# tcp: {xyz: [0, 0, 0.1]}", "did you mean 'tool'?"),
        ("# tool0: {xyz: [0, 0, 0.1]}", "did you mean 'tool'?"),
        ("# TCP offset: 0.1 m", "did you mean 'tool'?"),
        ("# tool_transform = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.1], [0, 0, 0, 1]]", "did you mean 'tool'?"),
        ("# flange {xyz: [0, 0, 0.1]}", "did you mean 'tool'?"),
        ("# Werkzeug: {xyz: [0, 0, 0.1]},,", "did you mean 'tool'?"),
        ("# base_transform: {xyz: [0, 0, 0.1]}", "did you mean 'base'?"),
        ("# T_base: {xyz: [0, 0, 0.1]}", "did you mean 'base'?"),
        ("# world: {xyz: [0, 0, 0.1]}", "did you mean 'base'?"),
        ("# tool length: 0.1", "did you mean 'tool'?"),
        ("# d_tool = 100 mm", "did you mean 'tool'?"),
        ("# Base height: 0.3", "did you mean 'base'?"),
        *(
            (f"# {words}", "did you mean 'base'?")
            for words in ("底座高度：0.3m", "ベース高さ: 0.3", "Sockelhöhe: 0.3 m")
        ),
        ("# convention: standard; name: ur5", "says more than the convention: 'standard; name: ur5'"),
        ("# joint 1 is prismatic", "the table has no types"),
        ("# Schubgelenk", "the table has no types"),
        ("# joint types: [R, P]", "the table has no types"),
        ("# sigma: 0 1", "the table has no types"),
        ("# Type: RP", "the table has no types"),
        ("# an RRP arm", "the table has no types"),
        ("# R-P-R", "the table has no types"),
        ("# PR robot", "the table has no types"),
        ("# density: 2700", "did you mean 'defaults'?"),
        ("# geometry: {shape: box}", "did you mean 'defaults'?"),
        ("# robot: ur5, lengths in mm", "did you mean 'name'?"),
        ("# visuals: {shape: none}", "which nothing is called"),
        ("# convetion: standard", "did you mean 'convention'?"),
        ("# base: # none", "field 'base': the comment line says nothing behind 'base'"),
        ("# tool: #", "field 'tool': the comment line says nothing behind 'tool'"),
        ("# joint limits in degrees", "this comment mentions deg, and angles are read in rad"),
        ("# Längen in mm, Winkel in Grad", "this comment mentions mm, and lengths are read in m"),
        ("# a in mm", "this comment mentions mm, and lengths are read in m"),
        ("# UR5 (mm, deg)", "this comment mentions deg, and angles are read in rad"),
        ("# Panda - modified DH", "means the standard convention, and arm.csv:1:3 says modified"),
        ("# UR5 - modified DH", "means the standard convention, and arm.csv:1:3 says modified"),
        ("# units: m\n# UR5 - standard DH, mm", "a comment line says units already"),
        ("# lengths in mm\n# units: {length: cm}", "a comment line says units already"),
        ("# lengths in mm\n# lengths in cm", "a comment line says units already"),
        ("; units: mm", "a comment begins with #"),
        ("-- units: mm", "a comment begins with #"),
        ("! units: mm", "a comment begins with #"),
        ("/* units: mm */", "a comment begins with #"),
    ],
)
def test_a_comment_that_seems_to_say_something_is_refused(
    comment: str, said: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """With the statement that was probably meant; dropped in silence, it would leave another arm."""
    with pytest.raises(TableError) as error:
        read(f"{comment}\na,alpha,d\n0.3,0,0.1\n", convention="standard")
    assert said in str(error.value)


@pytest.mark.parametrize(
    "comment",
    [
        "# Universal Robots UR5, from the maker's own table",
        "# 6 degrees of freedom, repeatability 0.1 mm, reach 850 mm, 18.4 kg",
        "# TCP: the middle of the gripper",
        "# Source: manual, p. 12 [3]",
        "# see fig. 3 in [2]",
        "# lengths in m, angles in rad",
        "# see https://example.org/a?b=c",
        "#################",
        "# Units",
        "# base, tool and defaults are not given",
        "% written by MATLAB",
        "// by hand",
        "# in the lab, and not at home",
        "# RRR, or PR 12 of the catalogue",
        "# joints: 6",
        "# rev B of the sheet",
        "# Created: 2024-01-05 10:30",
        '# the "classic" arm, with "quotes"',
    ],
)
@pytest.mark.parametrize("form", ["{}", "{},,", "'{}", "quoted"])
def test_prose_is_a_comment(comment: str, form: str, read_one: Callable[..., Manipulator]) -> None:
    """Above the header, between the rows and below them, and as a spreadsheet writes it."""
    doubled = comment.replace('"', '""')
    line = f'"{doubled}",,' if form == "quoted" else form.format(comment)
    arm = read_one(f"{line}\na,alpha,d\n{line}\n0.3,0,0.1\n{line}\n0.2,0,0\n{line}\n")
    assert [(row.a, row.d) for row in arm.rows] == [(0.3, 0.1), (0.2, 0)]
    assert arm.notices == ()


@pytest.mark.parametrize(
    "comment",
    [
        "# units: {length: mm}",
        "# units: {length: mm},,",
        '"# units: {length: mm, angle: deg}",,',
        "'# tool: {xyz: [0,0,1]},,",
        "# convention: standard,,",
        "# lengths in mm,,",
        "% modified convention",
    ],
)
def test_a_statement_below_the_header_is_refused(
    comment: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """Filled up or in quotes, too."""
    with pytest.raises(TableError, match="is below the header"):
        read(f"a,alpha,d\n0.3,0,0.1\n{comment}\n0.2,0,0\n", convention="standard")


def test_a_phrase_below_the_header_may_repeat_what_holds(read_one: Callable[..., Manipulator]) -> None:
    """As footnotes do, and notes behind an empty line."""
    assert read_one("a [mm],alpha [deg],d [mm]\n300,90,0\n# all lengths in mm,,\n").notices == ()
    notes = "Units: mm, deg\nConvention: standard\nName: of the note\nall lengths in mm\nThe last joint turns"
    (notice,) = read_one(f"a [mm],alpha [deg],d [mm]\n300,90,0\n\n{notes}\n").notices
    assert "nothing is read from what is below the table" in notice.message


@pytest.mark.parametrize(
    ("note", "said"),
    [
        ("units: mm", "is below the header"),
        ("Units: {length: mm}", "is below the header"),
        ("All lengths in mm", "is below the header"),
        ("Abmessungen in mm und Winkel", "this comment mentions mm, and lengths are read in m"),
        ("Convention: modified", "is below the header"),
        ("Tool length = 100 mm", "did you mean 'tool'?"),
        ("Note: joint 2 is prismatic", "the table has no types"),
    ],
)
@pytest.mark.parametrize("place", ["below", "beside", "behind"])
def test_a_note_that_seems_to_say_something_is_refused(
    note: str, said: str, place: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """As a comment is: a notice that it is left out would leave another arm."""
    if place == "below":
        table = f"a;alpha;d\n0.3;0;0.1\n0.2;0;0\n\n{note}\n"
    elif place == "beside":
        table = f"a;alpha;d;;\n0.3;0;0.1;;\n0.2;0;0;;{note}\n"
    else:
        table = f"a;alpha;d\n0.3;0;0.1\n0.2;0;0;# {note}\n"
    try:
        (arm,) = read(table, convention="standard")
    except TableError as error:
        assert said in str(error)
    else:
        assert not isinstance(arm, Manipulator)
        assert "seems to be a type" in str(arm.problems[0])


@pytest.mark.parametrize(
    ("comment", "said"),
    [
        ("# theta offsets: 0, 90°", "nothing is read from it"),
        ("# home: [0 90] deg", "nothing is read from it"),
        ("# signs: 1 -1", "nothing is read from it"),
        ("# limits: ±170°", "no joint gets this value"),
        ("# qlim: -170 .. 170", "no joint gets this value"),
        ("# Tool length 100 mm", "nothing is read from it"),
        ("# the TCP is 0.1 m before the flange", "nothing is read from it"),
        *(
            (f"# {words} m ", "nothing is read from it")
            for words in (
                *(
                    "基座高度 0.3",
                    "基座高度为0.3",
                    "工具长度 0.1",
                    "法兰到工具 0.1",
                    "台座の高さ 0.3",
                    "베이스 높이 0.3",
                ),
                *("wysokość podstawy 0.3", "taban yüksekliği 0.3", "Basishöhe 0.3", "height of the base is 0.3"),
            )
        ),
        ("# высота основания 0.3 м", "nothing is read from it"),
    ],
)
def test_numbers_in_a_comment_are_noticed(comment: str, said: str, read_one: Callable[..., Manipulator]) -> None:
    """Several of them, too, and a length of the tool in prose where no tool is declared."""
    (notice,) = read_one(f"{comment}\na,alpha,d\n0.3,0,0.1\n").notices
    assert said in notice.message
    placed = "# tool: {xyz: [0, 0, 0.1]}\n# base: {xyz: [0, 0, 0.3]}"
    again = read_one(f"{comment}\n{placed}\na,alpha,d\n0.3,0,0.1\n").notices
    assert len(again) == (0 if any(unit in comment for unit in ("mm", " m ", " м")) else 1)


@pytest.mark.parametrize(
    "comment",
    [
        *("theta2 = q2 - q1", "θ_2 = q_2 − 90°", "joint 2 is fixed", "J2 is mechanically coupled to J1"),
        *("positive direction of joint 2 is reversed", "joint 2: inverted", "all lengths x1000", "a and d × 10⁻³"),
        *("angles as multiples of pi", "limits: J1 ±170, J2 ±90", "masses: 3.7 kg, 1.2 kg", "base height 0.3"),
        *("TCP 0 0 0.1", "flange offset 0.05", "θ_i = q_i + 90°", "theta = -q - pi/2", "rows in reverse order"),
    ],
)
@pytest.mark.parametrize("below", [False, True])
def test_prose_about_joints_or_all_numbers_is_noticed(
    comment: str, read_one: Callable[..., Manipulator], *, below: bool
) -> None:
    """It was lost without a word."""
    table = "a,alpha,d\n0.3,0,0.1\n0.2,0,0\n"
    (notice,) = read_one(f"{table}# {comment}\n" if below else f"# {comment}\n{table}").notices
    assert "is a comment, and no" in notice.message


@pytest.mark.parametrize(
    "comment",
    [
        *(
            "joint 2 slides",
            "axis 2 is a linear axis",
            "J2: prism.",
            "the second joint translates along z",
            "2. Achse: Schub",
        ),
        *("q = [θ1, d2]", "d2 is the joint variable", "joint variables: θ1, d2*", "articulation 2 = glissière"),
    ],
)
def test_prose_about_a_joint_that_slides_is_refused_where_no_joint_has_a_type(
    comment: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """The joint was revolute, without a word."""
    with pytest.raises(TableError, match="speaks of a prismatic joint"):
        read(f"# {comment}\na,alpha,d\n0.3,0,0.1\n0.2,0,0\n", convention="standard")
    (arm,) = read(f"# {comment}\nconvention: standard\njoints: [{{a: 0.3, alpha: 0, d: 0}}]\n", ".yaml")
    assert not isinstance(arm, Manipulator)
    assert "speaks of a prismatic joint" in arm.problems[0].message
    (arm,) = read(f"# {comment}\ntype,a,alpha,d\nR,0.3,0,0.1\nP,0.2,0,0\n", convention="standard")
    assert isinstance(arm, Manipulator)


@pytest.mark.parametrize(
    "comment",
    [
        *(
            "改进DH参数",
            "修正DHパラメータ",
            "модифицированные параметры ДХ",
            "modified",
        ),
        *("T_i = Rx(α)·Tx(a)·Rz(θ)·Tz(d)", "A = Rot(x,alpha) Trans(x,a) Rot(z,theta) Trans(z,d)", "Rx Tx Rz Tz"),
        *("zmodyfikowana notacja D-H", "Khalil", "modified (Khalil)"),
    ],
)
def test_prose_about_the_modified_convention_is_noticed_in_other_words(
    comment: str, read_one: Callable[..., Manipulator]
) -> None:
    """In other languages, and as the product of the moves."""
    (notice,) = read_one(f"# {comment}\na,alpha,d\n0.3,0,0.1\n").notices
    assert "speaks of the modified convention" in notice.message
    assert read_one(f"# {comment}\na,alpha,d\n0.3,0,0.1\n", convention="modified").notices == ()


@pytest.mark.parametrize(
    ("comment", "unit"),
    [
        *(
            (text, "mm")
            for text in ("wymiary w mm", "ölçüler mm", "長さの単位はmm", "단위: mm", "Размеры в мм", "长度单位毫米")
        ),
        *((text, "cm") for text in ("длины в сантиметрах", "単位：センチ", "measures cm")),
        *((text, "deg") for text in ("углы в градусах", "kąty w stopniach", "角度单位为度", "açılar derece")),
        *((text, "deg") for text in ("Winkel in Grad", "Winkel [Grad]", "angles en degrés", "angulos en grados")),
        *((text, "deg") for text in ("angoli in gradi", "ângulos em graus")),
    ],
)
def test_a_unit_in_the_prose_of_any_language_is_refused_where_nothing_declares_one(
    comment: str, unit: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """It was passed over where the words around it are not known."""
    with pytest.raises(TableError, match=f"this comment mentions {unit}"):
        read(f"# {comment}\na,alpha,d\n0.3,0,0.1\n", convention="standard")


@pytest.mark.parametrize(
    "comment",
    [
        *(
            "joint 2 linear velocity 0.2",
            "repeatability ±0.05 mm",
            "stiffness 10 N/mm",
            "inertia kg·mm² of joint 3",
            "速度 3",
        ),
        *(
            "see q1 in figure 2",
            "axis 2 of the stand",
            "Rz and Tz, then Tx",
            "自由度数",
            "d6 is long",
        ),
        *("6 stopni swobody", "o sześciu stopniach swobody", "serbestlik derecesi", "six degrés de liberté"),
        *(
            "4 grados de libertad",
            "seis graus de liberdade",
            "6 gradi di libertà",
            "grad student",
            "theta = q + offset",
        ),
        *("modified 2024-03-01 by J. Smith", "gear ratio 10", "standardised table", "limit switches at joint 3"),
        *("offset of 3 rows", "offset 2 lines from the print", "scale model 1:5"),
    ],
)
def test_other_prose_stays_without_a_word(comment: str, read_one: Callable[..., Manipulator]) -> None:
    """It says nothing of the arm that a table could hold."""
    assert read_one(f"# {comment}\na,alpha,d\n0.3,0,0.1\n").notices == ()


@pytest.mark.parametrize(
    ("line", "sign"), [("#j2,0.2,0,0", "#"), ("//j2,0.2,0,0", "//"), ("% j2,0.2,0,0,", "%"), ("'#j2,0.2,pi/2,0", "#")]
)
def test_a_row_that_is_commented_out_is_noticed(line: str, sign: str, read_one: Callable[..., Manipulator]) -> None:
    """Prose that a spreadsheet has filled up is not, nor a name in quotes."""
    arm = read_one(f'joint,a,alpha,d\nj1,0.3,0,0.1\n{line}\n# prose,,,\n"#j3",0.1,0,0\n')
    assert [row.joint for row in arm.rows] == ["j1", "#j3"]
    (notice,) = arm.notices
    assert f"is a comment, since it begins with {sign}, and no row" in notice.message


@pytest.mark.parametrize(
    ("header", "row"),
    [
        ('# "theta","a","alpha","d"', "0.5,0.3,0,0.1"),
        ('"# theta","a","alpha","d"', "0.5,0.3,0,0.1"),
        ("# theta,a,alpha,d,,", "0.5,0.3,0,0.1,,"),
        ("'# theta,a,alpha,d", "0.5,0.3,0,0.1"),
        ("% theta; a; alpha; d", "0,5;0,3;0;0,1"),
        ('"#","theta","a","alpha","d"', "1,0.5,0.3,0,0.1"),
        ("#\ttheta\ta\talpha\td", "1\t0.5\t0.3\t0\t0.1"),
    ],
)
def test_a_header_behind_a_marker_keeps_its_first_column(
    header: str, row: str, read_one: Callable[..., Manipulator]
) -> None:
    """In quotes or not."""
    (joint,) = read_one(f"{header}\n{row}\n").rows
    assert (joint.theta, joint.a, joint.d) == (0.5, 0.3, 0.1)


def test_a_comment_may_stand_behind_the_last_column(read_one: Callable[..., Manipulator]) -> None:
    """Where no header is above it."""
    arm = read_one("a,alpha,d\n0.3,0,0.1,# upper arm\n0.2,0,0,,# forearm\n")
    assert [row.a for row in arm.rows] == [0.3, 0.2]


def test_a_value_in_a_comment_is_noticed(read_one: Callable[..., Manipulator]) -> None:
    """A limit of all joints is in a column."""
    (notice,) = read_one("# velocity: 180 deg/s\na,alpha,d\n0.3,0,0.1\n").notices
    assert "no joint gets this value" in notice.message


@pytest.mark.parametrize(
    ("line", "unit"),
    [("# originally in mm", "mm"), ("# limits in degrees", "deg")],
)
def test_prose_about_another_unit_than_the_declared_one_is_noticed(
    line: str, unit: str, read_one: Callable[..., Manipulator]
) -> None:
    """The declaration decides."""
    arm = read_one(f"{line}\n# units: {{length: m, angle: rad}}\na,alpha,d\n0.3,0,0.1\n")
    (notice,) = arm.notices
    assert notice.message.startswith(f"this comment mentions {unit}, and")


@pytest.mark.parametrize(
    ("comment", "said"),
    [
        ("all angles are in degrees unless noted", "this comment mentions deg"),
        ("UR5e, as in the manual, mm, deg", "this comment mentions deg"),
        ("UR5e - joint angles - deg", "this comment mentions deg"),
        ("UR5e DH table (Kuka, mm, deg)", "this comment mentions mm"),
        ("a/mm alpha/deg", "this comment mentions mm"),
        ("imperial units", "this comment mentions in"),
    ],
)
def test_a_unit_in_prose_is_seen_behind_other_words(
    comment: str, said: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """It was passed over: the arm was in m and rad, without a word."""
    with pytest.raises(TableError, match=said):
        read(f"# {comment}\na,alpha,d\n0.3,0,0.1\n", convention="standard")


@pytest.mark.parametrize("comment", ["1 unit = 10 mm", "1 LU = 1 mm", "scale: 1 = 1 mm", "scale 1:1000"])
def test_a_scale_is_noticed(comment: str, read_one: Callable[..., Manipulator]) -> None:
    """It was passed over, where it is not a unit."""
    (notice,) = read_one(f"# {comment}\na,alpha,d\n0.3,0,0.1\n").notices
    assert "is a comment, and nothing is read from it" in notice.message


@pytest.mark.parametrize(
    "comment", ["units: mm", "1 unit = 1 mm", "MDH; m; deg", "All units in mm/deg", "DH (standard, mm, deg)"]
)
def test_what_a_comment_in_yaml_declares_has_to_be_a_key(
    comment: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """Some phrases, which a CSV declares units with, were passed over there."""
    (arm,) = read(f"# {comment}\nconvention: standard\njoints: [{{a: 0.3, alpha: 0, d: 0}}]\n", ".yaml")
    assert not isinstance(arm, Manipulator)
    assert any((problem.accepted or "").startswith("`units: {") for problem in arm.problems)


def test_the_convention_of_prose_is_in_the_error_that_none_is_declared(
    read: Callable[..., list[Manipulator | Rejected]],
) -> None:
    """With the line to write; a column of conventions decides."""
    comment = "# the modified DH parameters of my left arm\n"
    with pytest.raises(TableError, match="if it means this table, write `# convention: modified`"):
        read(f"{comment}a,alpha,d\n0.3,0,0.1\n")
    (arm,) = read(f"{comment}convention,a,alpha,d\nstandard,0.3,0,0.1\n")
    assert isinstance(arm, Manipulator)
    (rejected,) = read(f"{comment}joints: [{{a: 0.3, alpha: 0, d: 0}}]\n", ".yaml")
    assert not isinstance(rejected, Manipulator)
    assert ["write `convention: modified`" in str(problem) for problem in rejected.problems] == [True]


@pytest.mark.parametrize("comment", ["Joint 3: modified DH", "Table 3 - modified DH", "UR5 versus UR10, modified DH"])
def test_a_title_that_is_no_model_declares_no_convention(
    comment: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """It may speak of a part, or of another table."""
    with pytest.raises(TableError, match="speaks of the modified convention, and nothing declares one"):
        read(f"# {comment}\na,alpha,d\n0.3,0,0.1\n")


@pytest.mark.parametrize(
    "comment", ["not modified DH", "not the modified convention", "non-modified DH", "unlike Craig"]
)
def test_prose_that_denies_a_convention_speaks_of_the_other(
    comment: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """There was a notice that it speaks of the convention that it denies."""
    table = f"# {comment}\na,alpha,d\n0.3,0,0.1\n"
    (arm,) = read(table, convention="standard")
    assert isinstance(arm, Manipulator)
    assert arm.notices == ()
    (arm,) = read(table, convention="modified")
    assert isinstance(arm, Manipulator)
    assert "speaks of the standard convention" in arm.notices[0].message
    with pytest.raises(TableError, match="if it means this table, write `# convention: standard`"):
        read(table)


def test_a_header_in_a_comment_above_the_header_declares_its_units(
    read: Callable[..., list[Manipulator | Rejected]],
) -> None:
    """The header itself was refused as that of another table. One that names the link before still is."""
    (arm,) = read("# i, a [mm], alpha [deg], d [mm]\n\ni,a,alpha,d\n1,300,90,100\n", convention="standard")
    assert isinstance(arm, Manipulator)
    assert (arm.rows[0].a, arm.rows[0].alpha) == (0.3, pytest.approx(1.5707963267948966))
    (arm,) = read("# a, alpha, d\n\n# measured\n# units: mm\n\na,alpha,d\n300,0,100\n", convention="standard")
    assert isinstance(arm, Manipulator)
    assert arm.rows[0].a == 0.3
    with pytest.raises(TableError, match="this comment mentions mm"):
        read("# a [mm], alpha, d [mm]\n\n# measured\na,alpha,d\n300,0,100\n", convention="standard")
    with pytest.raises(TableError, match="this comment mentions cm"):
        read("# a [cm], alpha [rad], d [m]\na,alpha,d\n0.3,0,0.1\n", convention="standard")
    (rejected,) = read("# a_{i-1}, alpha_{i-1}, d\na,alpha,d\n0.3,0,0.1\n", convention="modified")
    assert "is the header of another table" in str(rejected.problems[0])


def _with_remark(remark: str, header: str = "Notes") -> str:
    return f'a,alpha,d,{header}\n0.3,0,0.1,"from the sheet, p. 3"\n0.2,0,0,"{remark}"\n'


@pytest.mark.parametrize("header", ["Notes", "Remarks", "Comment", "Bemerkung", "Source"])
@pytest.mark.parametrize(
    ("remark", "said"),
    [
        ("modified DH", "'modified DH' is in a column that is left out, and may declare the convention"),
        ("in mm", "'in mm' is in a column that is left out, and may declare the units"),
        ("MDH, lengths in mm", "may declare the units and convention"),
        ("limits in degrees", "this comment mentions deg, and angles are read in rad"),
        ("a, alpha and d of the CAD (mm)", "this comment mentions mm, and lengths are read in m"),
        ("# all lengths in mm", "may declare the units"),
        ("tool length: 0.1", "did you mean 'tool'?"),
        ("tool: {xyz: [0, 0, 0.1]}", "may declare the tool"),
        ("it is an RRP arm", "speaks of a prismatic joint"),
    ],
)
def test_a_remark_in_a_column_that_contradicts_the_table_is_refused(
    remark: str, said: str, header: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """As a comment line is. There was only the notice that the column is left out."""
    (arm,) = read(_with_remark(remark, header), convention="standard")
    assert not isinstance(arm, Manipulator)
    (error,) = arm.problems
    assert said in str(error)
    assert error.mark
    assert (error.mark.line, error.mark.column) == (3, 9)


@pytest.mark.parametrize(
    "remark",
    [
        *("theta offset -90", "offset: -90°", "theta = q - 90°", "clockwise is positive", "coupled to J2"),
        *("range: -170 to 170", "tool length 100 mm", "mass: 5 kg", "x1000", "from a modified DH table"),
    ],
)
def test_a_remark_in_a_column_that_columns_could_say_is_noticed(
    remark: str, read_one: Callable[..., Manipulator]
) -> None:
    """It is about the joint of its row. A column that its author wants to be left out is not looked at."""
    notices = read_one(_with_remark(remark)).notices
    assert [notice.mark and notice.mark.line for notice in notices] == [1, 3]
    assert "is a comment, and no" in notices[1].message or "speaks of the modified" in notices[1].message
    (left_out,) = read_one(_with_remark(remark, "_Notes")).notices
    assert "as the _ at the beginning asks for" in left_out.message


@pytest.mark.parametrize(
    "remark",
    [
        *("Base: cast iron", "shoulder", "from the data sheet, in [2]", "brake 24 V", "18.4 kg of steel"),
        *("https://x.org/a?b=c", "Name: upper arm", "in", "M", "lengths in m, angles in rad", "standard DH"),
    ],
)
def test_other_remarks_in_a_column_stay_without_a_word(remark: str, read_one: Callable[..., Manipulator]) -> None:
    """But for the notice of the column."""
    (notice,) = read_one(_with_remark(remark)).notices
    assert "is left out: no field is called so" in notice.message


def test_a_remark_among_many_manipulators_is_seen_and_noticed_once(
    read: Callable[..., list[Manipulator | Rejected]],
) -> None:
    """The fast reader does not read over it, and does not repeat it."""
    said = {30: "offset -90", 40: "modified DH", 60: "offset -90"}
    rows = "".join(f"arm{k},0.3,0,0.1,{said.get(k, 'CAD')}\n" for k in range(80))
    arms = read(f"robot,a,alpha,d,Notes\n{rows}", convention="standard")
    assert [k for k, arm in enumerate(arms) if not isinstance(arm, Manipulator)] == [40]
    assert [k for k, arm in enumerate(arms) if isinstance(arm, Manipulator) and arm.notices] == [0, 30]


TURNED = "joint,type,a,alpha,d,theta\nj1,R,0.3,pi/2,0.1,0\nj2,R,0.2,0,0,0\nj3,R,0.1,0,0,0\n"
UNTYPED = TURNED.replace("type,", "").replace("R,", "")


@pytest.mark.parametrize(
    "comment",
    [
        *(
            "zero position: arm stretched upwards, theta2 = -90 deg",
            "zero pose: theta2 = -90",
            "zero of joint 3 is at +90",
        ),
        *(
            "home position q = [0, -90, 90]",
            "at the home position joint 2 is at 90 degrees",
            "joint 2 zero is 90 deg off",
        ),
        *("initial configuration 0, 90, 0", "J2 encoder zero differs by 90 degrees", "qlim = [-pi pi]"),
        *(
            "add 90 deg to theta2",
            "add pi to q3",
            "subtract pi/2 from joint 2",
            "-90 deg offset",
            "q2-90",
            "theta - 90",
        ),
        *("theta_2 -> theta_2 - pi/2", "phi2 = theta2 + pi/2", "J1 +-170", "J1 +/- 170 deg", "limits +-170, +-120"),
        *("J3 welded", "joint 3 does not move", "joint 2 is not used", "joint 2 is passive", "J1 and J2 are swapped"),
        *("CW positive", "mirror of the right arm", "signs: + - +", "values in 0.1 mm", "lengths in 1e-3 m"),
        *("inertia about the joint frame, not the com", "com in frame i-1", "centres of mass in the base frame"),
        *("limits are those of the motors", "max torque of motor 3", "speeds at the motor, gear 1:100"),
        *("values are times 1000", "multiply by L", "normalised lengths", "all dimensionless"),
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_what_only_columns_can_say_is_noticed_in_more_words(
    comment: str, suffix: str, read_one: Callable[..., Manipulator]
) -> None:
    """Nothing was said of them; of `q = [0, -90, 90]` and the like nothing was in a YAML table."""
    joints = "convention: standard\njoints: [{type: R, a: 0.3, alpha: 0, d: 0}, {type: R, a: 0.3, alpha: 0, d: 0}]\n"
    arm = read_one(f"# {comment}\n{TURNED if suffix == '.csv' else joints}", suffix)
    assert "is a comment, and no" in " ".join(notice.message for notice in arm.notices)


@pytest.mark.parametrize("comment", ["R R P", "R, R, P", "2R+P", "J3 = P", "joint 3: P", "q3 = d3"])
def test_a_joint_that_slides_by_its_letter_is_refused_in_a_table_without_types(
    comment: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    with pytest.raises(TableError, match="speaks of a prismatic joint, and the table has no types"):
        read(f"# {comment}\n{UNTYPED}", convention="standard")
    (arm,) = read(f"# {comment}\n{TURNED}", convention="standard")
    assert isinstance(arm, Manipulator)


@pytest.mark.parametrize(
    ("comment", "said"),
    [
        *(
            (comment, "mostly has a prismatic joint")
            for comment in ("gantry", "telescopic third link", "stroke 200 mm")
        ),
        *(
            (comment, "mostly has a prismatic joint")
            for comment in ("wrist: linear motion", "a ball screw lifts the arm")
        ),
        *((comment, "a row that may not move") for comment in ("the last row is the tool", "row 3: flange")),
    ],
)
def test_a_comment_about_what_types_would_say_is_noticed_in_a_table_without_types(
    comment: str, said: str, read_one: Callable[..., Manipulator]
) -> None:
    assert said in " ".join(notice.message for notice in read_one(f"# {comment}\n{UNTYPED}").notices)
    assert "type" not in {notice.field for notice in read_one(f"# {comment}\n{TURNED}").notices}


@pytest.mark.parametrize(
    "comment",
    [
        *("UR5, DH parameters from the manual", "joint 1: shoulder pan", "q1-q6 are the joint angles", "theta 1-6"),
        *("reference [12]", "zero is the stretched arm", "in the zero position all axes are parallel", "TX2-60"),
        *("the rest is from the data sheet", "used in 1 project", "IRB 120-3/0.6", "repeatability +-0.1 mm", "R-30iB"),
        *("calibrated, not nominal", "P. Corke 2017", "roll, pitch, yaw: R, P, Y", "max speed of the linear encoder"),
        *("inertia about the centre of mass", "com in frame i", "from www.example.com in 2020", "company motors"),
        *("positive angles are counterclockwise", "no offsets", "offset in column 5", "measured on 2024-01-02"),
    ],
)
def test_prose_with_the_same_words_stays_without_a_word(comment: str, read_one: Callable[..., Manipulator]) -> None:
    assert read_one(f"# {comment}\n{UNTYPED}").notices == ()


def test_a_comment_behind_a_row_is_about_its_joint(read_one: Callable[..., Manipulator]) -> None:
    """It was passed over where it declares nothing."""
    table = "joint,a,alpha,d,theta\nj1,0.3,0,0.1,0, # offset -90\nj2,0.3,0,0,0, # reversed\nj3,0.3,0,0,0,, # elbow\n"
    notices = [(notice.mark and notice.mark.line, notice.found) for notice in read_one(table).notices]
    assert notices == [(2, "# offset -90"), (3, "# reversed")]


@pytest.mark.parametrize(
    ("comment", "said"),
    [
        ("tool: {xyz: [0, 0, 0.1]}", "if it is part of the arm"),
        ("base: [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0.3], [0, 0, 0, 1]]", "if it is part of the arm"),
        ("payload: {mass: 2}", "if it is part of the arm"),
        ("limits: [-170, 170]", "write a key limits if it is meant for the joints"),
        ("v_max: 2.0", "no joint gets this value"),
        ("home: 90", "nothing is read from it"),
    ],
)
def test_what_a_comment_of_yaml_declares_as_one_of_csv_does_is_noticed(
    comment: str, said: str, read_one: Callable[..., Manipulator]
) -> None:
    """A table that was a CSV file lost its tool without a word."""
    joints = "joints: [{type: R, a: 0.3, alpha: 0, d: 0}]\n"
    (notice,) = read_one(f"# {comment}\nconvention: standard\n{joints}", ".yaml").notices
    assert said in str(notice)
    key = comment.partition(":")[0]
    if key in ("tool", "payload"):
        declared = "payload: {mass: 2, com: [0, 0, 0], inertia: {ixx: 0.01, iyy: 0.01, izz: 0.01}}"
        declared = declared if key == "payload" else f"{key}: {{xyz: [0, 0, 0.1]}}"
        assert read_one(f"# {comment}\nconvention: standard\n{declared}\n{joints}", ".yaml").notices == ()


@pytest.mark.parametrize(
    "word",
    [
        "modifiziert convention",
        "modifizierte convention",
        "modificada convention",
        "DH modificado",
        "수정 DH",
        "değiştirilmiş DH",
    ],
)
def test_a_convention_of_another_language_before_the_word_convention_is_read(
    word: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """`convention modifiziert` was; the other order was refused as prose."""
    (arm,) = read(f"# {word}\na,alpha,d\n0.3,0,0.1\n")
    assert isinstance(arm, Manipulator)
    assert str(arm.convention) == "modified"


@pytest.mark.parametrize(
    ("comment", "field", "factor"),
    [
        *(
            (comment, "velocity", math.pi / 180)
            for comment in ("velocity in deg/s", "speeds: °/s", "max velocities [deg/s]")
        ),
        *((comment, "velocity", math.pi / 30) for comment in ("speeds are in rpm", "velocity in rev/min")),
        ("lengths in m, angles in rad, speeds in deg/s", "velocity", math.pi / 180),
        ("masses in g", "mass", 1e-3),
        ("torque in Nmm", "effort", 1e-3),
    ],
)
def test_a_phrase_declares_the_unit_of_speeds_too(
    comment: str, field: str, factor: float, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """`velocity in deg/s` was two units to it, deg and s, and so no phrase: 9 deg/s were 9 rad/s. `max` makes it prose."""
    table = f"# {comment}\na,alpha,d,{field}\n0.3,0,0,9\n"
    if comment.startswith("max"):
        with pytest.raises(TableError, match="this comment mentions deg/s, and velocities are read in rad/s"):
            read(table, convention="standard")
        return
    (arm,) = read(table, convention="standard")
    assert isinstance(arm, Manipulator)
    row = arm.rows[0]
    assert (row.mass if field == "mass" else getattr(row.limits, field)) == pytest.approx(9 * factor, rel=1e-14)


@pytest.mark.parametrize(
    ("comment", "field", "said"),
    [
        ("max speeds as in the manual (deg/s)", "velocity", "mentions deg/s, and velocities are read in rad/s"),
        ("max velocity in deg per second", "velocity", "mentions deg/s, and velocities are read in rad/s"),
        ("speeds of the manual, in rpm", "velocity", "mentions rev/min, and velocities are read in rad/s"),
        ("the manual has masses in g", "mass", "mentions g, and masses are read in kg"),
        ("torques as on the sheet (Nmm)", "effort", "mentions N·mm, and efforts are read in Nm"),
    ],
)
def test_prose_that_mentions_a_unit_of_a_column_is_refused(
    comment: str, field: str, said: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """Where nothing declares one, and the table has the column; in YAML, where a comment has it."""
    with pytest.raises(TableError, match=re.escape(said)):
        read(f"# {comment}\na,alpha,d,{field}\n0.3,0,0,9\n", convention="standard")
    (rejected,) = read(
        f"# {comment}\nconvention: standard\njoints: [{{a: 0.3, alpha: 0, d: 0, {field}: 9}}]\n", ".yaml"
    )
    assert not isinstance(rejected, Manipulator)
    assert said in str(rejected.problems[0])
    unit = {"velocity": "deg/s", "mass": "g", "effort": "Nmm"}[field]
    for table in ("a,alpha,d\n0.3,0,0\n", f"a,alpha,d,{field} [{unit}]\n0.3,0,0,9\n"):
        (arm,) = read(f"# {comment}\n{table}", convention="standard")
        assert isinstance(arm, Manipulator)


def test_units_of_speeds_follow_those_that_are_declared(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """`units: deg` has speeds in deg/s; accelerations and values of their own are nothing of the table."""
    rows = "a,alpha,d,velocity\n0.3,0,0,9\n"
    for comment, said in (
        ("# units: deg\n# speeds as in the manual (deg/s)\n", []),
        (
            "# units: deg\n# speeds as in the manual (rad/s)\n",
            ["this comment mentions rad/s, and velocities are read in deg/s"],
        ),
        ("# accelerations in deg/s^2 are not given\n", []),
        ("# gravity is 9.81 m/s^2 along -z\n", []),
    ):
        (arm,) = read(f"{comment}{rows}", convention="standard")
        assert isinstance(arm, Manipulator)
        assert [notice.message for notice in arm.notices] == said


@pytest.mark.parametrize(("value", "good"), [("180", False), ("180 deg/s", True), ("3.14 rad/s", True)])
def test_a_unit_behind_a_speed_of_yaml_is_seen(
    value: str,
    good: bool,  # noqa: FBT001 - a case
    read: Callable[..., list[Manipulator | Rejected]],
) -> None:
    comment = "rad/s" if value.endswith("rad/s") else "deg/s"
    text = f"convention: standard\njoints:\n- a: 0.3\n  alpha: 0\n  d: 0\n  velocity: {value} # {comment}\n"
    (arm,) = read(text, ".yaml")
    assert isinstance(arm, Manipulator) is good


BEHIND = [
    *(("350 mm", True), ("200 mm", False), ("0.35", True), ("0.2", False), ("20 cm", False), ("a = 0.35", True)),
    *(("a = 0.2", False), ("90°", False), ("-90°", True), ("-pi/2", True), ("+90 deg", False), ("45", True)),
    *(("90", False), ("300 mm - 10 cm", False), ("±170°", True), ("[-170, 170]", True), ("-170..170", True)),
    *(("180 deg/s", True), ("max speed 180 deg/s", True), ("50 Nm", True), ("5 kg", True), ("1", False), ("12", False)),
    *(("not used", True), ("locked at 0", True), ("does not move", True), ("zero at -90°", True), ("home = 90", True)),
    *(("slides", True), ("linear axis", True), ("continuous", True), ("tool", True), ("flange", True), ("TCP", True)),
    *(("dummy", True), ("fixed", True), ("from -90 to 90", True), ("coupled with J2", True), ("parallelogram", True)),
    *(("elbow", False), ("see fig. 3", False), ("upper arm", False), ("[2]", False), ("none", False), ("base", False)),
    *(("?", False), ("was 0.35 before", False), ("from the manual", False), ("turns the other way", True)),
    *(("wrist offset", False), ("vertical axis", False), ("absolute encoder", False), ("offset to the elbow", False)),
    *(("shifted by pi/2", True), ("offset -90", True), ("measured from the horizontal", True)),
]


@pytest.mark.parametrize(("comment", "noticed"), BEHIND)
@pytest.mark.parametrize("form", ["csv", "flow", "block"])
def test_a_comment_behind_a_row_is_judged_by_the_values_beside_it(
    comment: str, form: str, read_one: Callable[..., Manipulator], *, noticed: bool
) -> None:
    """Another number than all of them, or what they do not say, was passed over: in YAML all of it."""
    row, number = "{a: 0.2, alpha: pi/2, d: 0.0}", comment.strip("[]").removeprefix("a = ")
    if form == "csv":
        arm = read_one(f"joint,a,alpha,d\nj1,0.3,0,0.1,\nj2,0.2,pi/2,0.0, # {comment}\n")
    elif form == "flow":
        arm = read_one(f"joints:\n- {{a: 0.3, alpha: 0, d: 0.1}}\n- {row}  # {comment}\n", ".yaml")
    else:
        key = "alpha" if any(sign in number for sign in ("9", "pi", "4")) else "a"
        lines = [f"{text}  # {comment}" if text.startswith(f"{key}:") else text for text in row.strip("{}").split(", ")]
        arm = read_one("joints:\n- " + "\n  ".join(lines) + "\n", ".yaml")
    assert [notice.found for notice in arm.notices] == ([f"# {comment}"] if noticed else [])


@pytest.mark.parametrize("word", ["prismatic", "linear", "slides", "fixed", "continuous"])
def test_a_comment_behind_a_row_that_repeats_its_type_stays_without_a_word(
    word: str, read_one: Callable[..., Manipulator]
) -> None:
    kind = {"fixed": "fixed", "continuous": "continuous"}.get(word, "prismatic")
    assert read_one(f"type,a,alpha,d\n{kind},0.3,0,0, # {word}\n").notices == ()
    assert read_one(f"joints: [{{type: {kind}, a: 0.3, alpha: 0, d: 0}}]  # {word}\n", ".yaml").notices == ()
    assert read_one(f"type,a,alpha,d\nR,0.3,0,0, # {word}\n").notices


@pytest.mark.parametrize(
    ("comment", "field"),
    [
        *(("max speed 180 deg/s", "velocity"), ("max. torque 50 Nm", "effort"), ("limit 170°", "limits")),
        *(("range 340 deg for all joints", "limits"), ("the velocity is 3.14 rad/s", "velocity"), ("180°/s", None)),
        *(
            ("payload 5 kg, reach 850 mm", None),
            ("between -90 and 90 deg", None),
            ("endless", None),
            ("no limits", None),
        ),
        *(("from the tool to the base", None), ("last joint first", None), ("joint 2 moves with joint 3", None)),
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_a_value_of_joints_in_words_without_a_colon_is_noticed(
    comment: str, field: str | None, suffix: str, read_one: Callable[..., Manipulator]
) -> None:
    """With a colon it was."""
    rows = "a,alpha,d\n0.3,0,0.1\n" if suffix == ".csv" else "joints: [{a: 0.3, alpha: 0, d: 0.1}]\n"
    (notice,) = read_one(f"# {comment}\n{rows}", suffix).notices
    assert (notice.found, notice.field) == (f"# {comment}", field)


@pytest.mark.parametrize(
    "comment",
    ["6 degrees of freedom, 18.4 kg", "reach 850 mm", "version 2 m", "the cable of the robot is at least 3 m long"],
)
def test_a_number_that_no_joint_has_stays_without_a_word(comment: str, read_one: Callable[..., Manipulator]) -> None:
    assert read_one(f"# {comment}\na,alpha,d\n0.3,0,0.1\n").notices == ()


@pytest.mark.parametrize("comment", ["not used", "passive joint", "locked at 0", "fixed", "reversed"])
@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_a_few_words_among_rows_are_about_the_row_behind_them(
    comment: str, suffix: str, read_one: Callable[..., Manipulator]
) -> None:
    rows = ["{a: 0.3, alpha: 0, d: 0.1}", "{a: 0.2, alpha: 0, d: 0}"]
    table = f"a,alpha,d\n0.3,0,0.1\n# {comment}\n0.2,0,0\n"
    if suffix == ".yaml":
        table = f"joints:\n- {rows[0]}\n# {comment}\n- {rows[1]}\n"
    (notice,) = read_one(table, suffix).notices
    assert notice.found == f"# {comment}"
    assert read_one(table.replace(comment, "the forearm"), suffix).notices == ()


@pytest.mark.parametrize("remark", ["tool flange", "TCP", "dummy", "gripper"])
def test_a_remark_that_names_a_frame_is_noticed_in_a_table_without_types(
    remark: str, read_one: Callable[..., Manipulator]
) -> None:
    """A row of that name is refused, and one with the remark was a joint without a word."""
    table = f"joint,a,alpha,d,remark\nj1,0.3,0,0,ok\nj2,0,0,0.1,{remark}\n"
    assert remark in [notice.found for notice in read_one(table).notices]
    typed = f"joint,type,a,alpha,d,remark\nj1,R,0.3,0,0,ok\nj2,F,0,0,0.1,{remark}\n"
    assert remark not in [notice.found for notice in read_one(typed).notices]


@pytest.mark.parametrize(
    "comment",
    [
        *("gesperrt", "nicht angetrieben", "gekoppelt mit Achse 2", "Drehrichtung negativ", "gegenläufig", "fest"),
        *("bloqué", "non actionné", "couplé à l'axe 2", "bloqueada", "no actuada", "sentido contrario", "bloccato"),
        *("固定", "不动", "被动关节", "方向相反", "与关节2耦合", "constant"),
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_what_a_comment_of_another_language_says_about_the_joint_of_its_row_is_noticed(
    comment: str, suffix: str, read_one: Callable[..., Manipulator]
) -> None:
    """In English it was."""
    table = f"a,alpha,d\n0.3,0,0.1, # {comment}\n"
    if suffix == ".yaml":
        table = f"joints: [{{a: 0.3, alpha: 0, d: 0.1}}]  # {comment}\n"
    assert [notice.found for notice in read_one(table, suffix).notices] == [f"# {comment}"]


@pytest.mark.parametrize(
    "comment",
    [
        *("Gelenk 2 ist fest", "articulation 2 bloquée", "articulación 2 bloqueada", "关节2固定", "Nullstellung 90°"),
        *("零位偏移90°", "偏置90°", "nach unten montiert", "monté à l'envers", "montado boca abajo", "倒置安装"),
        *("最大速度180°/s", "最大力矩50Nm", "vitesse max 180 °/s", "par máximo 50 Nm", "joint 3 moves up and down"),
    ],
)
def test_what_only_columns_can_say_is_noticed_in_other_languages(
    comment: str, read_one: Callable[..., Manipulator]
) -> None:
    assert read_one(f"# {comment}\na,alpha,d\n0.3,0,0.1\n").notices[0].found == f"# {comment}"


def test_a_comment_about_parameters_of_the_link_before_speaks_of_the_modified_convention(
    read_one: Callable[..., Manipulator],
) -> None:
    (notice,) = read_one("# a_{i-1} and alpha_{i-1} in each row\na,alpha,d\n0.3,0,0.1\n").notices
    assert "speaks of the modified convention" in notice.message
    assert read_one("# theta from x_{i-1} to x_i about z_{i-1}\na,alpha,d\n0.3,0,0.1\n").notices == ()


@pytest.mark.parametrize("comment", ["d is the joint variable", "q = d"])
def test_d_as_the_variable_is_refused_in_a_table_without_types(
    comment: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    with pytest.raises(TableError, match="speaks of a prismatic joint"):
        read(f"# {comment}\n{UNTYPED}", convention="standard")


def test_comments_behind_the_rows_of_many_arms_are_judged_with_their_own_rows(
    read: Callable[..., list[Manipulator | Rejected]],
) -> None:
    """The same words are noticed once in a file, and each number with the row that it is behind."""
    rows = [
        f"r{arm},R,0.{arm},0,0, # {text}" for arm, text in enumerate(["0.1 m", "0.3 m", "0.3 m", "fixed", "fixed"], 1)
    ]
    arms = read("\n".join(["robot,type,a,alpha,d", *rows]) + "\n", convention="standard")
    assert [[notice.found for notice in arm.notices] for arm in arms] == [[], ["# 0.3 m"], [], ["# fixed"], []]


@pytest.mark.parametrize(
    "comment",
    [
        *("divide by 1000", "values /1000", "in thousandths", "alpha in multiples of 90°", "alpha: 1 means 90 deg"),
        *(
            "1 = 90°",
            "angles in gon",
            "milliradians",
            "alpha in mrad",
            "lengths in yards",
            "wall mount",
            "tilted 45 deg",
        ),
        *("rotated 90° about z", "mounted at 45°", "left-hand rule", "y up", "symmetric to the right arm"),
        *("d6 + 100 for the tool", "l1=300, l2=200", "L1 = 0.3, L2 = 0.2.", "angles in the controller are negated"),
        *("external axis 2 m", "on a rail", "7th axis: rail"),
        *("zero pose: arm straight up", "zero position: arm horizontal", "home position is stretched upwards"),
        *(
            "Nullstellung: Arm gestreckt",
            "angles/90",
            "values / 1000",
            "all values doubled",
            "half scale",
            "1:10 scale",
        ),
        *("angles are in semi-circles", "theta in quarter turns", "weight in N", "masses in newton", "mass [N]"),
        *("alpha is negated", "sign of alpha flipped", "encoder reversed on J2", "motor 2 inverted", "base tilted"),
        *("mounted on the wall", "elevated by 200", "z axis points down", "theta = -q", "theta = q - offset"),
        *("offset is subtracted from q", "all joints ±170", "range 0..180", "ignore the last row", "skip joint 2"),
        *("row 2 unused", "joint 1 does nothing", "order is reversed", "order: tool to base", "numbered from the tool"),
        "J1 0...180",
    ],
)
@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_more_of_what_only_columns_can_say_is_noticed(
    comment: str, suffix: str, read_one: Callable[..., Manipulator]
) -> None:
    """Scales, zeros, signs, rows, units that no table has, turned bases, symbols with numbers: they were passed over."""
    rows = "a,alpha,d\n0.3,0,0.1\n" if suffix == ".csv" else "joints: [{a: 0.3, alpha: 0, d: 0.1}]\n"
    assert [notice.found for notice in read_one(f"# {comment}\n{rows}", suffix).notices] == [f"# {comment}"]


@pytest.mark.parametrize(
    "comment",
    [
        *("z up, right-hand rule", "d4-d6 are the wrist", "page 3/10", "IRB 1600-10/1.45", "left arm of the pair"),
        *("mounted on a table", "rotated views in figure 2", "revision 1 is of 2020", "the hand is not part of it"),
    ],
)
def test_words_like_those_stay_without_a_word(comment: str, read_one: Callable[..., Manipulator]) -> None:
    assert read_one(f"# {comment}\na,alpha,d\n0.3,0,0.1\n").notices == ()


@pytest.mark.parametrize(
    "comment",
    [
        *("home position is not given", "zero position: see figure 3", "the zero pose is that of the manual"),
        *("values/parameters of the manual", "lengths/angles from CAD", "theta/alpha", "weight: normal", "double arm"),
        *("mass in newest revision", "a quarter of a turn is pi/2", "skip to the next section", "ignore the colours"),
        *(
            "rows in the order of the joints",
            "robot is raised in the factory",
            "each joint has an encoder",
            "figure 3/4",
        ),
        *("range of motion: see manual", "numbered from the base", "1:10 scale model", "joint 1 is on the wall side"),
    ],
)
def test_words_like_those_of_zeros_and_scales_stay_without_a_word(
    comment: str, read_one: Callable[..., Manipulator]
) -> None:
    assert read_one(f"# {comment}\na,alpha,d\n0.3,0,0.1\n").notices == ()


@pytest.mark.parametrize(
    ("comment", "factor"),
    [
        ("torques in N cm", 0.01),
        ("torque in N m", 1.0),
        ("efforts in kg cm", 0.0980665),
        ("lengths in m, torques in N mm", 0.001),
        ("torque in Newton metres", 1.0),
        ("torques in lbf·in", 4.4482216152605 * 0.0254),
        ("torques in lbf in", 4.4482216152605 * 0.0254),
        ("torque in lb ft", 4.4482216152605 * 0.3048),
    ],
)
def test_a_unit_of_torques_in_two_words_is_one(
    comment: str, factor: float, read_one: Callable[..., Manipulator]
) -> None:
    """`N cm` declared centimetres for lengths, or was refused for them; `lbf·in` was passed over: 10 N·m were read."""
    (row,) = read_one(f"# {comment}\na,alpha,d,effort\n0.3,0,0.1,10\n").rows
    assert (row.a, row.limits.effort) == (0.3, pytest.approx(10 * factor, rel=1e-12))


@pytest.mark.parametrize("title", ["right", "right arm", "Robot 2", "rechter Arm", "UR10", "KUKA KR 16"])
def test_the_title_of_another_arm_among_the_rows_is_noticed(title: str, read_one: Callable[..., Manipulator]) -> None:
    """Two arms became one, without a word."""
    arm = read_one(f"a,alpha,d\n0.3,0,0\n0.2,0,0\n\n# {title}\n0.3,0,0\n0.2,0,0\n")
    assert [notice.message for notice in arm.notices] == [
        f"'# {title}' may be the title of another arm, and all rows are of one"
    ]


@pytest.mark.parametrize("title", ["right", "UR10"])
def test_the_title_of_an_arm_beside_a_column_of_arms_stays_without_a_word(
    title: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    arms = read(f"robot,a,alpha,d\nx,0.3,0,0\n\n# {title}\ny,0.3,0,0\n", convention="standard")
    assert [isinstance(arm, Manipulator) and arm.notices for arm in arms] == [(), ()]


@pytest.mark.parametrize("name", ["r0_f;;,g<n", "g;n", "T, t"])
def test_letters_of_a_name_in_quotes_are_no_units(name: str, read_one: Callable[..., Manipulator]) -> None:
    """`# robot = "x,g<n"` was refused, since it mentions grams."""
    assert read_one(f'# robot = "{name}"\na,alpha,d\n0.3,0,0\n').name == name
