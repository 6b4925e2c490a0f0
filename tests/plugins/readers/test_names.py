from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.words.names import MAX_NAME, name_fault, order_fault

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


def test_names_that_differ_in_case_are_kept_apart(read_one: Callable[..., Manipulator]) -> None:
    """With a notice, since a person may not see it; letters that are coded in two ways too."""
    arm = read_one("joint,a,alpha,d\nElbow,0,0,1\nelbow,0,0,1\né,0,0,1\ne\u0301,0,0,1\n")
    assert [row.joint for row in arm.rows] == ["Elbow", "elbow", "é", "e\u0301"]
    assert len(arm.notices) == 2


def test_links_of_rows_in_order_are_left_out(read: Callable[..., list[Manipulator | Rejected]]) -> None:
    """For each arm of the file; the second one is no chain."""
    header = "robot,joint,parent,child,a,alpha,d"
    good = "r{0},j1,base,l1,0.3,0,0\nr{0},j2,l1,l2,0.3,0,0\n"
    arms = read(f"{header}\n{good.format(1)}{good.format(2).replace('j2,l1', 'j2,l0')}", convention="standard")
    assert [isinstance(arm, Rejected) for arm in arms] == [False, True]


@pytest.mark.parametrize("theta", ["θ2 - θ1", "q2-", "q2(+90°)", "0 (θ2)", "θ2 = 0"])
def test_a_theta_that_cannot_be_read_lacks_no_variable_besides(
    theta: str, read: Callable[..., list[Manipulator | Rejected]]
) -> None:
    """There was a second error: that the row has no joint variable and no type."""
    (arm,) = read(f"a,alpha,d,theta\n0.3,0,0,q1\n0.2,0,0,{theta}\n", convention="standard")
    assert isinstance(arm, Rejected)
    assert [problem.found for problem in arm.problems] == [theta]
