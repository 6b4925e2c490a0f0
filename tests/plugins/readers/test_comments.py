"""Comment lines: those that declare something under a key, sentences that do, and prose."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import TableError
from dh2urdf.manipulator import JointType, Manipulator

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.stages import Rejected

    Read = Callable[..., list[Manipulator | Rejected]]

ROWS = "a,alpha,d\n300,90,100\n"
KEYED = [
    "# units: {length: mm, angle: deg}", "# units: mm/deg", "# units: [mm, deg]", "# units [mm, deg]", "# Unit: mm, °",
    "# Einheiten: mm und deg", "// units: mm, deg", "\N{FULLWIDTH NUMBER SIGN} units\N{FULLWIDTH COLON} mm, deg",
    "'# units: mm, deg", "\ufeff# units: mm, deg", '"# units: {length: mm, angle: deg}",,', "# units:,mm,deg,,",
    ",# units: mm/deg,,", "sep=,\n# units: mm, deg", '"# a table of mine\n# units: mm, deg",,',
]  # fmt: skip
SPOKEN = [
    "# mm / deg", "# lengths in mm, angles in degrees", "# a and d in mm, alpha and theta in deg", "# a/mm, alpha/deg, d/mm",
    "# lengths: mm\n# angles: deg", "# length unit: mm\n# unit of angles: deg", "#lengths [mm]\n#angles [deg]",
    "# Note: units -> mm, deg", "# UR5 (mm, deg)", "# DH parameters (standard, mm, deg)", "# Längen in mm, Winkel in deg",
    "# convention: standard; units: mm, deg", "# 长度单位：毫米，角度：度", "# All dimensions are in mm. Angles: deg",
]  # fmt: skip


def test_metres_of_a_comment_are_no_mass(read: Read) -> None:
    """The letter m is also a header."""
    (arm,) = read("# a and d in m, alpha in degrees\na,alpha,d\n0.3,45,0.1\n0.1,0,0\n", convention="standard")
    assert isinstance(arm, Manipulator)
    assert [(row.a, row.alpha) for row in arm.rows] == [(0.3, pytest.approx(math.pi / 4)), (0.1, 0)]


@pytest.mark.parametrize("comment", [*KEYED, *SPOKEN])
def test_units_of_a_comment_hold(comment: str, read: Read) -> None:
    """Under a key or in a sentence, as YAML, and as spreadsheets write it; a sentence is named in a notice."""
    (arm,) = read(f"{comment}\n{ROWS}", convention="standard")
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    (row,) = arm.rows
    assert (row.a, row.alpha, row.d) == (0.3, pytest.approx(1.5707963267948966), 0.1)
    said = [str(notice) for notice in arm.notices]
    assert len(said) == (comment in SPOKEN) or "declare" in said[0]


MODIFIED = [
    "convention is modified", "convention,modified,", "Craig's convention", "notation: Craig", "DH modifiée", "MDH; m; rad",
    "(D-H parameters, modified form)", "UR5 - modified DH", "modifizierte convention", "수정 DH", "DH convention = modified",
]  # fmt: skip
STANDARD = [
    "This table uses the standard DH convention.",
    "DH: classic",
    "SDH",
    "UR5e (standard DH)",
    "convention: 标准DH",
]


@pytest.mark.parametrize(
    ("comment", "convention"), [*((each, "modified") for each in MODIFIED), *((each, "standard") for each in STANDARD)]
)
def test_the_convention_of_a_comment_holds(comment: str, convention: str, read: Read) -> None:
    """Where one word of one convention is beside a word that shows what it is about."""
    (arm,) = read(f"# {comment}\na,alpha,d\n0.3,0,0.1\n")
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    assert arm.convention == convention


@pytest.mark.parametrize(
    ("comment", "names"),
    [
        ("Modified DH parameters:", 0),
        ("standard DH, lengths in m", 0),
        ("Puma 560, standard DH", 1),
        ("standard DH, lengths in mm", 1),
        ("an RR arm, standard DH, lengths in mm", 1),
    ],
)
def test_a_line_of_nothing_but_the_convention_has_no_notice(comment: str, names: int, read: Read) -> None:
    """Any other sentence that declares is named in one notice, whatever is taken from it."""
    (arm,) = read(f"# {comment}\na,alpha,d\n300,0,100\n100,0,0\n", convention=None)
    assert isinstance(arm, Manipulator)
    said = [notice for notice in arm.notices if notice.code == "declared-by-sentences"]
    assert [f"# {comment}" in notice.message for notice in said] == [True] * names


PROSE = [
    "6 degrees of freedom, repeatability 0.1 mm, reach 850 mm", "TCP: the middle of the gripper", "see fig. 3 in [2]",
    "lengths in m, angles in rad", "see https://example.org/a?b=c", "################", "Created: 2024-01-05 10:30",
    "base, tool and defaults are not given", "in the lab, and not at home", "R = revolute, P = prismatic", "offset -90",
    'the "classic" arm, with "quotes"', "all joints ±170", "max. torque 50 Nm", "joint limits in degrees", "a in cm",
    "modified on 2020-01-01", "an RRRRRR arm", "not the modified DH convention", "reach of 850 millimetres",
    "counterclockwise is positive", "with 6 axes and a hand", "Link 1 -> Link 2: elbow", "<https://example.org/j1>",
]  # fmt: skip


@pytest.mark.parametrize("comment", PROSE)
@pytest.mark.parametrize("form", ["# {}", "# {},,", "'# {}", '"# {}",,'])
def test_everything_else_is_prose_and_passed_over_in_silence(comment: str, form: str, read: Read) -> None:
    """Above the header, between the rows, behind them and below them, and as a spreadsheet writes it."""
    line = form.format(comment.replace('"', '""') if form.startswith('"') else comment)
    table = f"{line}\na,alpha,d\n{line}\n0.3,0,0.1\n{line}\n0.2,0,0,# {comment}\n{line}\n"
    (arm,) = read(table, convention="standard")
    assert isinstance(arm, Manipulator), "\n".join(map(str, arm.problems))
    assert [(row.a, row.d) for row in arm.rows] == [(0.3, 0.1), (0.2, 0)]
    assert arm.notices == ()
    (arm,) = read(f"# {comment}\njoints: [{{a: 0.3, alpha: 0, d: 0}}]\n", ".yaml", convention="standard")
    assert arm.notices == ()


@pytest.mark.parametrize(
    ("comments", "said"),
    [
        ("# conventoin: standard", "did you mean 'convention'?"),
        ("# mounting: {rpy: [0, 0, 1]}", "'mounting', which nothing is called"),
        ("# offsets: [0, 90]", "'offsets', which nothing is called"),
        ("# units: {length: mm}\n# lengths in cm", "contradicts the unit mm"),
        ("# convention: standard\n# Craig's convention", "means the modified convention"),
        ("# units: mm\n# units: cm", "says units already"),
        ("# tool:", "says nothing behind 'tool'"),
    ],
)
def test_a_declaration_that_is_wrong_is_refused(comments: str, said: str, read: Read) -> None:
    """A slip of a key, a key of nothing, and two that contradict each other."""
    try:
        (arm,) = read(f"{comments}\na,alpha,d\n0.3,0,0.1\n", convention=None)
    except TableError as error:
        assert said in str(error)
        return
    assert not isinstance(arm, Manipulator)
    assert said in "\n".join(map(str, arm.problems))


def test_values_that_say_nothing_are_values(read_one: Callable[..., Manipulator]) -> None:
    """`units: SI`, `tool: none`, `base: identity`."""
    arm = read_one("# units: SI\n# tool: none\n# base: identity\na,alpha,d\n0.3,0,0.1\n")
    assert (arm.rows[0].a, arm.notices) == (0.3, ())
    assert arm.tool == arm.base


@pytest.mark.parametrize("key", ["tool", "end-effector", "TCP offset"])
def test_a_key_has_other_words(key: str, read_one: Callable[..., Manipulator]) -> None:
    assert read_one(f"# {key}: {{xyz: [0, 0, 0.5]}}\na,alpha,d\n0.3,0,0.1\n").tool.translation == (0, 0, 0.5)


@pytest.mark.parametrize("suffix", [".csv", ".yaml"])
def test_letters_as_long_as_the_table_are_its_types(suffix: str, read_one: Callable[..., Manipulator]) -> None:
    """In a table without types, with a notice."""
    rows = (
        "a,alpha,d\n0.3,0,0\n0.2,0,0\n"
        if suffix == ".csv"
        else "joints: [{a: 1, alpha: 0, d: 0}, {a: 1, alpha: 0, d: 0}]\n"
    )
    arm = read_one(f"# an RP arm\n{rows}", suffix)
    assert [row.type for row in arm.rows] == [JointType.REVOLUTE, JointType.PRISMATIC]
    (notice,) = arm.notices
    assert "'# an RP arm' declares the types of the joints: RP" in notice.message


@pytest.mark.parametrize("delimiter", ["\t"])
@pytest.mark.parametrize(
    "comment",
    [
        "# tool: {xyz: [0, 0, 0.5]}",
        "# tool: {xyz: [0, 0, 0.5]};;;",
        "# tool: {xyz: [0;0; 0.5]};;",
        "# tool: {xyz: [0; 0; 0,5]; rpy: [0; 0; 0]}",
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
        ('# Manipulator = "r0_5;<3d&n"', "r0_5;<3d&n"),
        ('% robot: "lengths in mm"', "lengths in mm"),
        ("# robot = r0_9d1a-n", "r0_9d1a-n"),
        ("# model: CB3\n# name: ur5", "ur5"),
    ],
)
def test_a_name_has_several_keys(comment: str, name: str, read_one: Callable[..., Manipulator]) -> None:
    """`name` before the others; in quotes it is read as YAML."""
    assert read_one(f"{comment}\na,alpha,d\n0.3,0,0.1\n").name == name


@pytest.mark.parametrize(
    ("header", "row"),
    [
        ('# "theta","a","alpha","d"', "0.5,0.3,0,0.1"),
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
