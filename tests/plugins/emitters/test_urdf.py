from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING
from xml.etree import ElementTree as ET

import pytest

from dh2urdf.errors import EmitterError
from dh2urdf.robot import Link, Robot
from dh2urdf.stages import ReadsBack
from dh2urdf_plugins.formats.urdf import EMITTER, UrdfOptions

if TYPE_CHECKING:
    from pathlib import Path


def urdf(robot: Robot) -> str:
    (file,) = EMITTER.emit(robot, "stem", UrdfOptions())
    return file.content.decode("utf-8")


def renamed(robot: Robot, old: str, new: str) -> Robot:
    """The robot with another name for a link."""
    return replace(
        robot,
        links=tuple(replace(link, name=new) if link.name == old else link for link in robot.links),
        joints=tuple(
            replace(
                joint,
                parent=new if joint.parent == old else joint.parent,
                child=new if joint.child == old else joint.child,
            )
            for joint in robot.joints
        ),
    )


def test_joints_carry_the_limits_of_their_type(arm: Robot) -> None:
    """Revolute and prismatic ones all four, continuous ones effort and velocity, fixed ones none."""
    limits = {
        joint.get("type"): None if (limit := joint.find("limit")) is None else list(limit.keys())
        for joint in ET.fromstring(urdf(arm)).iter("joint")  # noqa: S314 - our own file
    }
    assert limits == {
        "fixed": None,
        "prismatic": ["lower", "upper", "effort", "velocity"],
        "revolute": ["lower", "upper", "effort", "velocity"],
        "continuous": ["effort", "velocity"],
    }


def test_names_are_written_as_they_are_in_utf8(arm: Robot) -> None:
    """A person reads the name in the file; only what XML itself uses is escaped."""
    text = urdf(renamed(arm, "tool0", "Größe 机械臂 <&>\"' ]]> ${x}"))
    assert '<child link="Größe 机械臂 &lt;&amp;&gt;&quot;\' ]]&gt; ${x}"/>' in text


@pytest.mark.parametrize(
    ("name", "code_point"),
    [("a\x00b", "U+0000"), ("\x1b[2J", "U+001B"), ("a\tb", "U+0009"), ("\ud800", "U+D800"), ("\uffff", "U+FFFF")],
)
def test_a_name_that_xml_cannot_carry_is_refused_by_its_code_point(arm: Robot, name: str, code_point: str) -> None:
    """The message names the character and shows the text harmlessly."""
    with pytest.raises(EmitterError, match=re.escape(code_point)) as caught:
        urdf(renamed(arm, "link_2", name))
    assert all(character.isprintable() or character == "\n" for character in str(caught.value))


def test_a_comment_ends_where_it_should(arm: Robot) -> None:
    """Two hyphens and control characters, which a path may hold, do not end or garble the comment."""
    text = urdf(replace(arm, comment="from ----><robot> \x1b[2J\n--"))
    assert text.splitlines()[1] == r"<!-- from - - - -><robot> \x1b[2J\n- - -->"
    assert ET.fromstring(text).tag == "robot"  # noqa: S314


def test_no_line_is_longer_than_readers_take(arm: Robot) -> None:
    """PyBullet cuts a line of more than 8 kB without a word, so such a name is refused; a comment is cut."""
    assert max(map(len, urdf(replace(arm, comment="x" * 100_000)).splitlines())) < 8000
    with pytest.raises(EmitterError, match=r"line \d+ .* would have 8\d+ bytes"):
        urdf(renamed(arm, "link_2", "é" * 4000))


def test_a_thousand_joints_are_written_and_read_back(tmp_path: Path, arm: Robot) -> None:
    """Nothing recurses over the chain, and the file is the same robot."""
    spin = next(joint for joint in arm.joints if joint.name == "spin")
    robot = Robot(
        name="long",
        links=tuple(Link(name=f"link_{i}") for i in range(1001)),
        joints=tuple(replace(spin, name=f"joint_{i}", parent=f"link_{i}", child=f"link_{i + 1}") for i in range(1000)),
    )
    path = tmp_path / "long.urdf"
    path.write_text(urdf(robot), encoding="utf-8")
    assert EMITTER.can(ReadsBack).read_back(path) == robot
