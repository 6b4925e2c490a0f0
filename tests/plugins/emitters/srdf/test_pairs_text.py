"""Collision pairs of an earlier SRDF are brought up to date, and every other byte stays."""

from pathlib import Path

import pytest
from lxml import etree

from dh2urdf.errors import InputError
from dh2urdf.robot import Link, Robot
from dh2urdf_plugins.collision_pairs.search import DisabledPair
from dh2urdf_plugins.packages.srdf.pairs_text import new_file, updated

ROBOT = Robot(name="arm", links=tuple(Link(name=name) for name in ("a", "b", "c", "d")), joints=())
PAIRS = (DisabledPair("a", "b", "Adjacent"), DisabledPair("a", "c", "Never"), DisabledPair("b", "c", "Default"))

EARLIER, LATER = (Path(__file__).with_name(f"{name}.srdf").read_bytes() for name in ("earlier", "later"))


def later(content: bytes, pairs: tuple[DisabledPair, ...] = PAIRS, robot: Robot = ROBOT) -> bytes:
    return updated(content, "arm.srdf", robot, pairs)[0]


def of(content: bytes) -> list[tuple[str, str, str]]:
    return [tuple(each.values()) for each in etree.fromstring(content).findall("disable_collisions")]


def test_pairs_change_and_nothing_else() -> None:
    """Right pairs stay as they are written, others change, go and come; a decision of somebody stays."""
    changed = later(EARLIER)
    before, after = changed.split(b"<!-- the cable -->")
    assert before + b"<!-- the cable -->" in LATER
    assert sorted(changed.splitlines()) == sorted(LATER.splitlines())
    assert b'<disable_collisions link1="a" link2="c" reason="Never"/>' in after


def test_a_second_time_changes_nothing() -> None:
    assert later(later(EARLIER)) == later(EARLIER)
    assert later(new_file(ROBOT, PAIRS)) == new_file(ROBOT, PAIRS)


def test_a_decision_comes_before_what_is_found() -> None:
    """A pair with a reason of its own stays where the search has found another, and is there once."""
    content = b'<robot name="arm">\n  <disable_collisions link1="a" link2="b" reason="User"/>\n</robot>\n'
    assert of(later(content))[0] == ("a", "b", "User")
    assert len(of(later(content))) == len(PAIRS)


@pytest.mark.parametrize("ending", [b"\n", b"\r\n"])
def test_pairs_come_at_the_end_where_there_are_none(ending: bytes) -> None:
    """With the line ends of the file; all that was there is there."""
    content = ending.join([b'<robot name="arm">', b'  <group name="g"/>', b"</robot>", b""])
    changed = later(content)
    assert of(changed) == [tuple(pair) for pair in PAIRS]
    assert changed.startswith(content.removesuffix(b"</robot>" + ending))
    assert changed.count(b"\n") == changed.count(ending) == content.count(ending) + len(PAIRS)


def test_in_one_line() -> None:
    content = b'<robot name="arm"><disable_collisions link1="a" link2="d" reason="Never"/><group name="g"/></robot>'
    changed = later(content)
    assert of(changed) == [tuple(pair) for pair in PAIRS]
    assert etree.fromstring(changed).find("group") is not None
    assert of(later(b'<robot name="arm"><group name="g"/></robot>')) == [tuple(pair) for pair in PAIRS]


def test_all_pairs_go() -> None:
    """Lines that had a pair alone go with it."""
    assert later(new_file(ROBOT, PAIRS), ()) == b'<?xml version="1.0"?>\n<robot name="arm">\n</robot>\n'


def test_names_that_the_encoding_lacks_are_escaped() -> None:
    """The file keeps its encoding."""
    robot = Robot(name="arm", links=(Link(name="ärm"), Link(name='ε"&')), joints=())
    content = '<?xml version="1.0" encoding="ISO-8859-1"?>\n<robot name="arm">\n <!-- Größe -->\n</robot>\n'
    changed = later(content.encode("latin-1"), (DisabledPair("ärm", 'ε"&', "Never"),), robot)
    assert of(changed) == [("ärm", 'ε"&', "Never")]
    assert "<!-- Größe -->".encode("latin-1") in changed


def test_what_no_longer_fits_is_a_notice() -> None:
    """Another robot's name, and a decision about a link that is gone."""
    content = b'<robot name="leg">\n<disable_collisions link1="a" link2="z" reason="User"/>\n</robot>\n'
    changed, notices = updated(content, "leg.srdf", ROBOT, PAIRS)
    assert ("a", "z", "User") in of(changed)
    assert [(notice.code, notice.mark and notice.mark.line) for notice in notices] == [
        ("srdf-of-other-robot", None),
        ("pair-of-no-links", 2),
    ]


@pytest.mark.parametrize(
    ("content", "code"),
    [
        (b"", "srdf-no-xml"),
        (b"<robot>", "srdf-no-xml"),
        (b'<sdf version="1"/>', "root-element-other"),
        (b'<!DOCTYPE robot [<!ENTITY a "b">]><robot/>', "srdf-no-xml"),
        (b'<robot xmlns:xacro="x"><xacro:macro name="m"/></robot>', "srdf-with-macros"),
        ('<?xml version="1.0" encoding="UTF-16"?><robot/>'.encode("utf-16"), "srdf-in-utf-16"),
        (b'<robot name="arm"/>', "srdf-empty"),
    ],
)
def test_what_is_no_srdf(content: bytes, code: str) -> None:
    with pytest.raises(InputError) as caught:
        later(content)
    assert caught.value.problems[0].code == code
