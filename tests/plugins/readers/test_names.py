from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

from dh2urdf.stages import Rejected
from dh2urdf_plugins.readers.words.names import MAX_NAME, RESERVED, are_out_of_order, name_fault

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
    ("joints", "wrong"),
    [
        (("1", "2", "3"), False),
        (("j2", "j10"), False),
        (("j3", "j2", "j1"), True),
        (("0", "2", "1"), True),
        (("elbow_2", "wrist_1"), False),
        (("base", "j2", "j1"), False),
        (("j1",), False),
    ],
)
def test_numbers_of_joints_that_do_not_rise_are_noticed(joints: tuple[str, ...], wrong: bool) -> None:  # noqa: FBT001
    """A table that begins at the tool would be another arm; only names that are alike but for a number tell."""
    assert are_out_of_order(joints) is wrong


def test_names_that_differ_in_case_are_kept_apart(read_one: Callable[..., Manipulator]) -> None:
    """With a notice, since a person may not see it; letters that are coded in two ways too."""
    arm = read_one("joint,a,alpha,d\nElbow,0,0,1\nelbow,0,0,1\né,0,0,1\ne\u0301,0,0,1\n")
    assert [row.joint for row in arm.rows] == ["Elbow", "elbow", "é", "e\u0301"]
    assert len(arm.notices) == 2
