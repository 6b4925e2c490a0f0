"""Comment lines: those that say something about the table, those that seem to, and prose."""

from __future__ import annotations

import math
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


def test_a_remark_among_many_manipulators_is_seen_and_noticed_once(
    read: Callable[..., list[Manipulator | Rejected]],
) -> None:
    """The fast reader does not read over it, and does not repeat it."""
    said = {30: "offset -90", 40: "modified DH", 60: "offset -90"}
    rows = "".join(f"arm{k},0.3,0,0.1,{said.get(k, 'CAD')}\n" for k in range(80))
    arms = read(f"robot,a,alpha,d,Notes\n{rows}", convention="standard")
    assert [k for k, arm in enumerate(arms) if not isinstance(arm, Manipulator)] == [40]
    assert [k for k, arm in enumerate(arms) if isinstance(arm, Manipulator) and arm.notices] == [0, 30]


def test_a_comment_behind_a_row_is_about_its_joint(read_one: Callable[..., Manipulator]) -> None:
    """It was passed over where it declares nothing."""
    table = "joint,a,alpha,d,theta\nj1,0.3,0,0.1,0, # offset -90\nj2,0.3,0,0,0, # reversed\nj3,0.3,0,0,0,, # elbow\n"
    notices = [(notice.mark and notice.mark.line, notice.found) for notice in read_one(table).notices]
    assert notices == [(2, "# offset -90"), (3, "# reversed")]


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


@pytest.mark.parametrize("name", ["r0_f;;,g<n", "g;n", "T, t"])
def test_letters_of_a_name_in_quotes_are_no_units(name: str, read_one: Callable[..., Manipulator]) -> None:
    """`# robot = "x,g<n"` was refused, since it mentions grams."""
    assert read_one(f'# robot = "{name}"\na,alpha,d\n0.3,0,0\n').name == name
