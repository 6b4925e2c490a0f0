from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.words.names import MAX_NAME, RESERVED, name_fault, order_fault

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.manipulator import Manipulator


@pytest.mark.parametrize(
    "name",
    [
        "j1",
        "a b",
        "Grün",
        "关节",
        "مفصل",
        "می\u200cخواهم",
        "🤖",
        "👩\u200d🔧",
        "<a&b>",
        "${x}",
        "$(x)",
        "../x",
        "]]>",
        "'\"",
        "x" * MAX_NAME,
    ],
)
def test_any_visible_text_is_a_name(name: str) -> None:
    """Markup, xacro and paths are text like any other."""
    assert name_fault(name) is None


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("", "empty"),
        ("  ", "empty"),
        ("\N{NO-BREAK SPACE}", "empty"),
        ("x" * (MAX_NAME + 1), "201 characters"),
        ("a\nb", "U+000A"),
        ("a\x00", "U+0000"),
        ("a\x1b[31m", "U+001B"),
        ("a\x7f", "U+007F"),
        ("a\x85", "U+0085"),
        ("a\ud800", "U+D800"),
        ("a\u200b", "U+200B"),
        ("a\u202e", "U+202E"),
        ("a\ufeff", "U+FEFF"),
        ("a\u2028", "U+2028"),
        ("a\uffff", "U+FFFF"),
    ],
)
def test_a_name_that_nobody_can_see_is_none(name: str, reason: str) -> None:
    """The message names the code point and shows no control character."""
    fault = name_fault(name)
    assert fault is not None
    assert reason in fault[0]
    assert fault[0].isprintable()


@pytest.mark.parametrize("name", [*RESERVED, "base_link-base_link_inertia", "link_1-tool0", "link_1-flange", "link_1"])
def test_a_joint_has_no_name_that_the_description_gives(
    read: Callable[..., list[Manipulator | Rejected]], name: str
) -> None:
    """Links and joints share one set of names, those that are added included."""
    (arm,) = read(f"joint,a,alpha,d\n{name},0,0,1\n", convention="standard")
    assert isinstance(arm, Rejected)
    assert any("cannot be named" in problem.message for problem in arm.problems)


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (("1", "2", "3"), None),
        (("j2", "j10"), None),
        (("j3", "j2", "j1"), "do not rise from row to row"),
        (("0", "2", "1"), "do not rise from row to row"),
        (("J1", "J2", "J4", "J5", "J7"), "leap from 2 to 4"),
        (("joint_0", "joint_2"), "leap from 0 to 2"),
        (("motor_11", "motor_13"), None),
        (("elbow_2", "wrist_1"), None),
        (("base", "j2", "j1"), None),
        (("j1",), None),
        (("0->1", "1->2", "2->EE"), None),
        (("0->1", "1->2", "3->EE"), "do not follow each other: 3->EE is behind 1->2"),
        (("1-2", "2-3", "4-5"), "do not follow each other: 4-5 is behind 2-3"),
        (("Base–L1", "L1–L2", "L1–L3"), "do not follow each other: L1–L3 is behind L1–L2"),
        (("0 to 1", "2 to 3"), "do not follow each other: 2 to 3 is behind 0 to 1"),
        *((names, None) for names in (("wrist-1", "wrist-2", "wrist-3"), ("a-1", "a-2"), ("L1-L2", "L2-L3"))),
        (("arm-1", "arm-2", "arm-4"), "leap from 2 to 4"),
        (("0 → 1", "1 → 2", "1 → 2"), "do not follow each other: 1 → 2 is behind 1 → 2"),
        (("0->1", "elbow", "3->EE"), None),
    ],
)
def test_numbers_of_names_show_rows_that_are_missing_or_elsewhere(names: tuple[str, ...], said: str | None) -> None:
    """A table that begins at the tool, or lacks a row, is another arm; only names alike but for a number tell."""
    assert order_fault(names) == said


def test_a_missing_row_of_many_arms_is_noticed(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """On the fast path, too; by the names of joints or of links."""
    steps = ("0->1", "1->2", "2->3")
    arms = {"full": steps, "cut": (steps[0], steps[2])}
    rows = [f"{arm},{place},0.3,0,0.1\n" for arm, places in arms.items() for place in places]
    first, second = read("robot,link,a,alpha,d\n" + "".join(rows), convention="standard")
    assert not first.notices
    (notice,) = second.notices
    assert notice.message == "the numbers of the links, '0->1, 2->3', do not follow each other: 2->3 is behind 0->1"
    assert notice.field == "link"


@pytest.mark.parametrize(
    ("names", "wrong"),
    [
        (("q1", "q2-90", "q3"), "q2-90"),
        (("θ1", "θ2 + π/2", "θ3"), "θ2 + π/2"),
        (("J1", "J2", "-(J2 + J3)"), "-(J2 + J3)"),
        (("q1", "q2", "q3"), None),
        (("q1-axis", "q-2", "lift-2"), None),
    ],
)
@pytest.mark.parametrize("field", ["joint", "link", "i"])
def test_a_joint_variable_with_an_offset_is_no_name(
    names: tuple[str, ...], wrong: str | None, field: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """Below a header that is one column off, it was a name, and the numbers of the rows were theta."""
    rows = [f"{name},{number},0.3,0,0.1\n" for number, name in enumerate(names)]
    (arm,) = read(f"{field},theta,a,alpha,d\n" + "".join(rows), convention="standard")
    if wrong is None:
        assert not isinstance(arm, Rejected)
    else:
        assert isinstance(arm, Rejected)
        kind = "link" if field == "link" else "joint"
        said = f"'{wrong}' is a joint variable with an offset or a sign, and no name of a {kind}"
        assert said in [problem.message for problem in arm.problems]


def test_names_that_differ_in_case_are_kept_apart(read_one: Callable[..., Manipulator]) -> None:
    """With a notice, since a person may not see it; letters that are coded in two ways too."""
    arm = read_one("joint,a,alpha,d\nElbow,0,0,1\nelbow,0,0,1\né,0,0,1\ne\u0301,0,0,1\n")
    assert [row.joint for row in arm.rows] == ["Elbow", "elbow", "é", "e\u0301"]
    assert len(arm.notices) == 2


@pytest.mark.parametrize("names", [("j1", "j2*"), ("shoulder†", "elbow"), ("j1*", "j2*"), ("j1", "j2¹")])
@pytest.mark.parametrize("column", ["joint", "link"])
def test_a_name_with_the_mark_of_a_footnote_is_noticed(
    names: tuple[str, str], column: str, read_one: Callable[..., Manipulator]
) -> None:
    """What the footnote says, such as that the joint slides, is nowhere in the table."""
    (notice,) = read_one(f"{column},a,alpha,d\n{names[0]},0.3,0,0\n{names[1]},0.2,0,0\n").notices
    assert "ends with the mark of a footnote" in notice.message
    assert notice.field == column


def test_names_that_are_told_apart_by_raised_digits_stay_without_a_word(read_one: Callable[..., Manipulator]) -> None:
    assert read_one("joint,a,alpha,d\nj¹,0.3,0,0\nj²,0.2,0,0\n").notices == ()


@pytest.mark.parametrize(
    ("header", "rows", "said"),
    [
        (
            "parent,child",
            ("base,l1", "l1,l2", "l1,l3"),
            "the row leads from 'l1' to 'l3', and the row above it to 'l2'",
        ),
        ("from,to", ("1,2", "0,1"), "the row leads from '0' to '1', and the row above it to '2'"),
        ("DOF", ("1", "0"), "whether a joint moves by itself"),
        ("beweglich", ("ja", "nein"), "whether a joint moves by itself"),
        ("Bewegung", ("drehen", "schieben"), "'schieben' seems to be a type"),
        ("Drehsinn", ("rechts", "links"), "seems to be sign"),
        ("turning", ("顺时针", "逆时针"), "seems to be a direction"),
    ],
)
def test_columns_that_say_that_rows_are_no_chain_of_turning_joints_are_refused(
    header: str, rows: tuple[str, ...], said: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """They were left out, and the arm was another one: a notice named the column alone."""
    lines = [f"j{number},{row},0.3,0,0" for number, row in enumerate(rows, 1)]
    (arm,) = read("\n".join([f"joint,{header},a,alpha,d", *lines]), convention="standard")
    assert isinstance(arm, Rejected)
    assert said in "\n".join(map(str, arm.problems))


def test_links_of_rows_in_order_are_left_out(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """For each arm of the file; the second one is no chain."""
    header = "robot,joint,parent,child,a,alpha,d"
    good = "r{0},j1,base,l1,0.3,0,0\nr{0},j2,l1,l2,0.3,0,0\n"
    arms = read(f"{header}\n{good.format(1)}{good.format(2).replace('j2,l1', 'j2,l0')}", convention="standard")
    assert [isinstance(arm, Rejected) for arm in arms] == [False, True]


@pytest.mark.parametrize(
    ("name", "accepted"),
    [
        *(
            ("Joint 2 (prismatic)", "write prismatic"),
            ("J2 (pris)", "write prismatic"),
            ("Elbow [linear]", "write prismatic"),
        ),
        *(("Joint 2 (elbow, prismatic)", "write prismatic"), ("Elbow (schub)", None), ("J2 (rev)", None)),
        *(
            ("Joint 2 (elbow, fixed)", "write fixed"),
            ("Elbow [not used]", "write fixed"),
            ("J2 (passive)", "write fixed"),
        ),
        *(("Joint 2 (shoulder pan)", None), ("Joint 2 (1)", None), ("Elbow (R)", None), ("J2 (fixture side)", None)),
    ],
)
def test_a_type_in_brackets_behind_a_name_is_asked_about(
    name: str, accepted: str | None, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """`Joint 2 (P)` was refused, and the words were part of a revolute joint's name."""
    (arm,) = read(f"joint;a;alpha;d\nJoint 1;0.3;0;0\n{name};0.2;0;0\n", convention="standard")
    assert isinstance(arm, Rejected) == bool(accepted)
    if isinstance(arm, Rejected):
        assert accepted in str(arm.problems[0])
    (arm,) = read(f"joint;type;a;alpha;d\nJoint 1;R;0.3;0;0\n{name};R;0.2;0;0\n", convention="standard")
    assert not isinstance(arm, Rejected)


def test_the_variable_in_d_is_no_type_in_a_column_beside_it(read_one: Callable[..., Manipulator]) -> None:
    """A table of a SCARA, whose last column lists the variables, was refused."""
    arm = read_one("a,alpha,d,theta,variable\n0.3,0,0.4,θ1,θ1\n0,0,d2,0,d2\n0,0,0.1 + d3,0,d3\n")
    assert [str(row.type) for row in arm.rows] == ["revolute", "prismatic", "prismatic"]


def test_a_frame_that_is_read_as_fixed_has_one_notice(read_one: Callable[..., Manipulator]) -> None:
    notices = read_one("frame,a,alpha,d,theta\nShoulder,0.3,0,0,θ1\nEnd,0.1,0,0,0\n").notices
    assert [notice.found for notice in notices if "End" in str(notice)] == [None]


@pytest.mark.parametrize("header", ["d_max", "d max [mm]", "dmin"])
def test_bounds_of_d_are_answered_with_bounds_of_q(
    header: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """The advice was `velocity`."""
    (arm,) = read(f"a,alpha,d,{header}\n0.3,0,q1 + 0.1,400\n", convention="standard")
    assert isinstance(arm, Rejected)
    assert "columns lower and upper" in "\n".join(map(str, arm.problems))


@pytest.mark.parametrize("theta", ["θ2 - θ1", "q2-", "q2(+90°)", "0 (θ2)", "θ2 = 0"])
def test_a_theta_that_cannot_be_read_lacks_no_variable_besides(
    theta: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """There was a second error: that the row has no joint variable and no type."""
    (arm,) = read(f"a,alpha,d,theta\n0.3,0,0,q1\n0.2,0,0,{theta}\n", convention="standard")
    assert isinstance(arm, Rejected)
    assert [problem.found for problem in arm.problems] == [theta]


@pytest.mark.parametrize(
    "name",
    [
        *("q2 passive", "J3 fixed", "J3-fixed", "elbow_fixed", "fixed elbow", "locked wrist", "dummy J3", "J2 mimic"),
        *(
            "J3 (disabled)",
            "J3 (no motor)",
            "gripper not actuated",
            "not used",
            "Achse 3 fest",
            "articulation 2 (bloquée)",
        ),
        *("关节3（固定）", "J3（P）", "J3: P", "Joint 3 / P"),
    ],
)
def test_a_name_of_what_does_not_turn_is_asked_about(
    name: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """They were revolute joints, in silence, and the same word in a column of types holds."""
    (arm,) = read(f"joint,a,alpha,d\nwaist,0.3,0,0\n{name},0.3,0,0\n", convention="standard")
    assert isinstance(arm, Rejected)
    assert [problem.field for problem in arm.problems] == ["type"]
    assert "by its name it hardly is a revolute joint" in arm.problems[0].message
    (arm,) = read(f"joint,type,a,alpha,d\nwaist,R,0.3,0,0\n{name},F,0.3,0,0\n", convention="standard")
    assert not isinstance(arm, Rejected)


@pytest.mark.parametrize("name", ["reach", "tolerance", "error", "Fehler", "max reach"])
def test_a_last_row_of_what_is_no_joint_is_asked_about(
    name: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    (arm,) = read(f"joint,a,alpha,d\nwaist,0.3,0,0\n{name},0.3,0,0\n", convention="standard")
    assert isinstance(arm, Rejected)
    assert "seems to be no joint" in arm.problems[0].message


@pytest.mark.parametrize(
    ("name", "said"),
    [
        *((name, "sign") for name in ("Shoulder [inverted]", "wrist inverted", "wrist_reversed", "J2 (flipped)")),
        *(
            (name, "sign")
            for name in ("J2 (-)", "J2 (CW)", "J2 cw", "J2 (counter-clockwise)", "J2 (mounted upside down)")
        ),
        *((name, "motion") for name in ("J2 coupled to J1", "joint2 (mimics joint 1)", "J4 (continuous)", "J3 [mm]")),
        *((name, "value") for name in ("J1 (±170°)", "J1 (-90° offset)", "J3 (theta+90)", "elbow (offset 90°)")),
    ],
)
def test_a_name_that_says_something_about_its_joint_is_noticed(
    name: str, said: str, read_one: Callable[..., Manipulator]
) -> None:
    """Nothing is read from a name; where the row says the same, there is nothing to notice."""
    (notice,) = (n for n in read_one(f"joint,a,alpha,d\nwaist,0.3,0,0\n{name},0.3,0,0\n").notices if n.field)
    assert notice.message == f"the name '{name}' says something about its joint: nothing is read from it"
    column, cell = {"sign": ("sign", "-1"), "motion": ("type", "continuous"), "value": ("theta", "q2 - pi/2")}[said]
    first = {"sign": "1", "motion": "R", "value": "q1"}[said]
    held = read_one(f"joint,a,alpha,d,{column}\nwaist,0.3,0,0,{first}\n{name},0.3,0,0,{cell}\n")
    assert [n for n in held.notices if n.field] == []


def test_names_that_say_something_are_noticed_once(read_one: Callable[..., Manipulator]) -> None:
    rows = "".join(f"J{number} (±170°),0.3,0,0\n" for number in (1, 2, 3))
    (notice,) = (n for n in read_one(f"joint,a,alpha,d\n{rows}").notices if n.field)
    assert "says something about its joint, as 2 more do" in notice.message


@pytest.mark.parametrize(
    "name",
    [
        *("shoulder_pan_joint", "Joint 2 (shoulder)", "left_hand_finger1", "mirror_tilt", "flipper", "static_mixer"),
        *("A1 (base rotation)", "J2 (1-2)", "S (swivel)", "shoulder (Z-axis)", "reverse thruster", "cw_arm", "coupler"),
        *("passenger", "fixation", "J2 (active)", "J2 (revolute)", "wrist [deg]", "linear encoder joint 3"),
    ],
)
def test_other_words_in_a_name_stay_without_a_word(name: str, read_one: Callable[..., Manipulator]) -> None:
    notices = read_one(f"joint,a,alpha,d\nwaist,0.3,0,0\n{name},0.3,0,0\n").notices
    assert [notice.message for notice in notices if "ROS tools" not in notice.message] == []


def test_names_with_remarks_are_noticed_among_many_arms(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """What reads plain rows fast leaves them to what looks at each."""
    rows = "".join(f"r{number},waist,0.3,0,0\nr{number},wrist [inverted],0.3,0,0\n" for number in range(300))
    arms = read(f"robot,joint,a,alpha,d\n{rows}", convention="standard")
    said = [any("says something about its joint" in n.message for n in arm.notices) for arm in arms]
    assert said == [True] * 300
