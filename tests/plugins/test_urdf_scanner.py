import random
import re
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pytest
from any_tables import ANGLES, LENGTHS, manipulators
from hypothesis import given, settings, strategies as st

from dh2urdf.conversion.one_manipulator import Call
from dh2urdf.conversion.robots import make_robot
from dh2urdf.manipulator import Limits, Manipulator
from dh2urdf.plugin_system import load
from dh2urdf.plugin_system.options import make_options
from dh2urdf.robot import Joint, Robot
from dh2urdf.rotations import is_column
from dh2urdf_plugins.formats.urdf import forms, scanner as urdf_scanner
from dh2urdf_plugins.formats.urdf.reader import model_of, parse_urdf
from dh2urdf_plugins.formats.urdf.scanner import scan_columns
from reference_arms import ReferenceRobot

CATALOG = load()
FRAMES = ("aligned", "dh")

ARM = b"""<?xml version="1.0"?>
<!-- arm: drawn by hand -->
<robot name="arm">
  <material name="grey"><color rgba="0.5 0.5 0.5 1"/></material>
  <link name="base_link"/>
  <link name="one">
    <inertial>
      <origin xyz="0 0 0.5" rpy="0 0 0"/><mass value="2"/>
      <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.01"/>
    </inertial>
    <visual><geometry><cylinder radius="0.05" length="1"/></geometry><material name="grey"/></visual>
  </link>
  <joint name="turn" type="revolute">
    <origin xyz="0 0 0.25" rpy="0 0 1.5"/>
    <parent link="base_link"/>
    <child link="one"/>
    <axis xyz="0 -1 0"/>
    <limit lower="-1" upper="2" effort="10" velocity="3"/>
    <dynamics friction="0.125"/>
  </joint>
  <joint name="end" type="fixed">
    <origin xyz="0 0 1e-3"/>
    <parent link="one"/>
    <child link="tool0"/>
  </joint>
  <link name="tool0"/>
</robot>
"""


def with_changes(*changes: tuple[bytes, bytes]) -> bytes:
    text = ARM
    for old, new in changes:
        assert old in text
        text = text.replace(old, new, 1)
    return text


def entry(numbers: Any, index: int) -> Any:
    return float(numbers[index]) if is_column(numbers) else numbers


def one_of(joint: Joint, index: int) -> Joint:
    """A joint of one member of a group."""

    def vector(numbers: Sequence[Any]) -> Any:
        return tuple(entry(number, index) for number in numbers)

    limits = (getattr(joint.limits, name) for name in ("lower", "upper", "velocity", "effort"))
    lower, upper, velocity, effort = (entry(number, index) for number in limits)
    return replace(
        joint,
        origin=replace(joint.origin, xyz=vector(joint.origin.xyz), rpy=vector(joint.origin.rpy)),
        axis=vector(joint.axis),
        limits=Limits(lower=lower, upper=upper, velocity=velocity, effort=effort),
        damping=entry(joint.damping, index),
        friction=entry(joint.friction, index),
    )


def scanned(contents: Sequence[bytes]) -> dict[int, tuple[list[str], list[Joint]]]:
    """For every file that is read its links and joints."""
    found = {}
    for places, robot in scan_columns(contents):
        for index, place in enumerate(places):
            joints = [one_of(joint, index) for joint in robot.joints]
            found[place] = ([link.name for link in robot.links], joints)
    return found


def as_read(content: bytes) -> tuple[list[str], list[Joint]]:
    """What the slow reader says."""
    robot = parse_urdf(content, "arm")
    return [link.name for link in robot.links], list(robot.joints)


def urdf(robot: Robot) -> bytes:
    stage = CATALOG.get("emitter", "urdf")
    (file,) = stage.emit(robot, robot.name, stage.options())
    content: bytes = file.content
    return content


def written(table: Manipulator, frames: str) -> bytes:
    stage = CATALOG.get("transform", "alpha-swap")
    options = make_options(stage.options, {"frames": frames}, mark=None, where="")
    return urdf(make_robot(table, Call(stage=stage, options=options)))


def with_other_numbers(step: float) -> bytes:
    """The arm with another number in the place of each."""
    head, robot, body = ARM.partition(b"<robot")
    count = iter(range(1000))
    return (
        head + robot + re.sub(rb'(?<=[" ])-?[0-9][0-9.e-]*', lambda m: b"%r" % (float(m[0]) + step * next(count)), body)
    )


@pytest.fixture(autouse=True, params=[0, forms.ENOUGH], ids=["no file", "known form"])
def anew(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """No test knows the files of another; the form of the arm is known before a test, or is not."""
    monkeypatch.setattr(urdf_scanner, "_scanner", urdf_scanner._Scanner())
    scan_columns([with_other_numbers(0.01 * k) for k in range(request.param)])


class TestWhatIsRead:
    def test_every_published_robot(self, reference_robots: list[ReferenceRobot]) -> None:
        """All of them, in both frames, are read as the slow reader reads them."""
        files = [written(robot.manipulator, frames) for robot in reference_robots for frames in FRAMES]
        assert scanned(files) == {place: as_read(content) for place, content in enumerate(files)}

    def test_a_file_of_another_origin(self) -> None:
        """Nothing is taken for granted of the emitter's form."""
        assert scanned([ARM]) == {0: as_read(ARM)}
        one_line = re.sub(rb">\s+<", b"><", ARM.partition(b"?>")[2].strip())
        assert scanned([one_line]) == {0: as_read(one_line)}

    def test_every_number_of_a_joint_is_a_column(self) -> None:
        """Files that differ in the numbers of joints are one group, in the order of the files."""
        files = [
            ARM,
            with_changes((b"0 0 0.25", b"-1e-7 0 12.5"), (b"0 0 1.5", b"0.5 0 1.5"), (b"0 -1 0", b"0 0 -1")),
            with_changes((b'lower="-1"', b'lower="-0.5"'), (b'"10"', b'"1e1"'), (b"0.125", b"0"), (b"1e-3", b"2")),
        ]
        ((places, robot),) = scan_columns(files)
        assert places == [0, 1, 2]
        assert scanned(files) == {place: as_read(content) for place, content in enumerate(files)}
        turn = robot.joints[0]
        assert turn.origin.xyz[0].tolist() == [0, -1e-7, 0]
        assert turn.origin.xyz[1] == 0.0
        assert isinstance(turn.origin.xyz[1], float)

    def test_links_may_look_as_they_like(self) -> None:
        """Files whose joints are of one structure are one group, whatever shapes their links have."""
        plain = with_changes((b'<cylinder radius="0.05" length="1"/>', b'<sphere radius="0.2"/>'))
        bare = re.sub(rb"<inertial>.*</visual>", b"", ARM, flags=re.DOTALL)
        ((places, _),) = scan_columns([plain, ARM, bare, ARM])
        assert places == [0, 1, 2, 3]

    def test_other_joints_are_another_group(self) -> None:
        """A name, a type, a parent or an attribute that is missing makes another group."""
        others = [
            with_changes((b'"turn"', b'"twist"')),
            with_changes((b'"revolute"', b'"prismatic"')),
            with_changes((b'<parent link="one"/>', b'<parent link="base_link"/>')),
            with_changes((b' rpy="0 0 1.5"', b"")),
            with_changes((b'<axis xyz="0 -1 0"/>', b"")),
            with_changes((b'name="tool0"', b'name="tool1"')),
        ]
        files = [ARM, *others, ARM, *others]
        assert [places for places, _ in scan_columns(files)] == [[k, k + 7] for k in range(7)]
        assert scanned(files) == {place: as_read(content) for place, content in enumerate(files)}

    def test_the_axis_of_a_fixed_joint_is_none(self) -> None:
        """A fixed joint may say an axis; it has none."""
        files = [
            with_changes((b'<parent link="one"/>', b'<axis xyz="%d 2 3"/><parent link="one"/>' % k)) for k in (1, 4)
        ]
        assert scanned(files) == {place: as_read(content) for place, content in enumerate(files)}

    def test_the_first_of_two_origins_counts(self) -> None:
        """Where an element stands twice, the slow reader takes the first."""
        twice = with_changes((b'<axis xyz="0 -1 0"/>', b'<origin xyz="7 8 9"/><axis xyz="0 -1 0"/><axis xyz="1 0 0"/>'))
        assert scanned([twice]) == {0: as_read(twice)}

    @pytest.mark.parametrize("name", ["a b", "bräs", "it's", "2", "-1e5", "--", "手"])
    def test_names_and_comments_are_free(self, name: str) -> None:
        """The robot's name and the comment above it may be anything, and no other file is concerned."""
        comment = name.replace("--", "- -")
        other = with_changes((b'"arm"', f'"{name}"'.encode()), (b"drawn by hand", comment.encode()))
        for files in ([ARM, other], [other, ARM]):
            ((places, robot),) = scan_columns(files)
            assert places == [0, 1]
            assert robot.name == parse_urdf(files[0], "arm").name

    def test_nothing_comes_from_the_emitter(self) -> None:
        """The scanner imports no emitter."""
        code = "import sys, dh2urdf_plugins.formats.urdf.scanner; print([m for m in sys.modules if m.endswith(('writer', 'formats.urdf.columns'))])"
        result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert result.stdout.strip() == "[]"


NOT_PLAIN = {
    "no file": (ARM, b""),
    "no XML": (b"</robot>", b""),
    "an attribute left open": (b'<link name="tool0"/>\n</robot>\n', b'<link name="tool0'),
    "text after the root": (b"</robot>", b"</robot>text"),
    "a second root": (b"</robot>", b"</robot><robot/>"),
    "a nameless robot": (b'<robot name="arm">', b"<robot>"),
    "an attribute before the name": (b"<robot name", b'<robot version="1.0" name'),
    "a namespace": (b'name="arm"', b'name="arm" xmlns:xacro="http://ros.org/wiki/xacro"'),
    "a document type": (b"<robot", b'<!DOCTYPE robot [<!ENTITY e "1">]><robot'),
    "an entity in the robot's name": (b'"arm"', b'"a&amp;m"'),
    "an entity in a joint's name": (b'"turn"', b'"t&#117;rn"'),
    "an undefined entity": (b'"arm"', b'"&arm;"'),
    "an angle bracket in a name": (b'"arm"', b'"a<m"'),
    "a line end in the robot's name": (b'"arm"', b'"a\nm"'),
    "a line end in a joint's name": (b'"turn"', b'"tu\nrn"'),
    "what is not UTF-8": (b'"arm"', b'"br\xe4s"'),
    "another encoding": (b'version="1.0"', b'version="1.0" encoding="ISO-8859-1"'),
    "another version of XML": (b'version="1.0"', b'version="1.1"'),
    "a byte order mark": (b"<?xml", b"\xef\xbb\xbf<?xml"),
    "three dashes at the comment's end": (b"hand -->", b"hand --->"),
    "a comment left open": (b"hand -->", b"hand"),
    "a processing instruction": (b"<robot", b"<?go?><robot"),
    "a comment that hides a joint": (b'<joint name="end"', b'<!-- <link name="x"/> --><joint name="end"'),
    "single quotes": (b'xyz="0 0 0.25"', b"xyz='0 0 0.25'"),
    "text that looks like an attribute": (b'<link name="base_link"/>', b'<link name="base_link">x="1"</link>'),
    "the attribute elsewhere": (b'xyz="0 0 1e-3"/>', b"xyz='0 0 1e-3'>xyz=\"0 0 1e-3\"</origin>"),
    "an attribute twice": (b'xyz="0 0 0.25"', b'xyz="0 0 0.25" xyz="0 0 0.5"'),
    "an unknown type of joint": (b'"revolute"', b'"floating"'),
    "no type of joint": (b' type="revolute"', b""),
    "no child": (b'<child link="one"/>', b""),
    "a nameless joint": (b'name="end" ', b""),
    "two numbers of three": (b"0 0 0.25", b"0 0.25"),
    "two numbers of one": (b'"0.125"', b'"0 125"'),
    "no number": (b"0 0 0.25", b"0 0 "),
    "a comma": (b"0 0 0.25", b"0,0 0.25"),
    "an exponent without digits": (b"0 0 0.25", b"0 0 25e"),
    "a plus": (b"0 0 0.25", b"0 0 +0.25"),
    "a leading zero": (b"0 0 0.25", b"0 0 00.25"),
    "a number beyond all": (b"0 0 0.25", b"0 0 1e999"),
    "an underscore": (b"0 0 0.25", b"0 0 1_0"),
    "a mass without end": (b'<mass value="2"/>', b'<mass value="1e999"/>'),
    "no inertia": (b'ixx="0.1" ', b""),
    "a shape without size": (b'radius="0.05" ', b""),
    "no known shape": (b"<cylinder", b"<torus"),
    "an undefined material": (b'<material name="grey"/>', b'<material name="green"/>'),
}


class TestWhatIsLeftOut:
    @pytest.mark.parametrize(("old", "new"), NOT_PLAIN.values(), ids=NOT_PLAIN.keys())
    def test_what_is_not_plain(self, old: bytes, new: bytes) -> None:
        """It is in no group, whether its like has been read before or not, and costs no other file."""
        bad = with_changes((old, new))
        assert scan_columns([bad]) == []
        assert list(scanned([bad, ARM, bad, ARM])) == [1, 3]
        assert scan_columns([bad]) == []

    def test_commas_shift_no_number(self) -> None:
        """Numbers with a comma between them are not those of the next attribute, wherever else commas may stand."""
        joints, shapes = b'xyz="0 0 0.25" rpy="0 0 1.5"', b'<gazebo><origin xyz="%s"/></gazebo><link name="tool0"/>'
        odd = with_changes((b'<link name="tool0"/>', shapes % b"1,2"))
        shifted = with_changes((joints, b'xyz="0 0 0.25,0 0 1.5" rpy="1"'), (b'<link name="tool0"/>', shapes % b"2"))
        assert as_read(odd) == as_read(ARM)
        assert scan_columns([odd, shifted]) == []

    def test_what_stands_between_the_attributes_may_be_anything(self) -> None:
        """Comments, text and CDATA without quotes are the same in all files of a skeleton, and read as they are."""
        noted = with_changes((b"<joint", b"<!-- no quotes & no joint --><joint"), (b"<link", b"<![CDATA[<]]><link"))
        assert scanned([noted, ARM]) == {0: as_read(noted), 1: as_read(ARM)}

    @pytest.mark.long
    @settings(max_examples=750)
    @given(data=st.data())
    def test_a_damaged_file_is_left_out_or_read_as_it_is(self, data: st.DataObject) -> None:
        """Whatever happens to its bytes: what is read is what the slow reader reads, which refuses nothing of it."""
        content = ARM
        for _ in range(data.draw(st.integers(1, 3))):
            start = data.draw(st.integers(0, len(content)))
            gone = data.draw(st.integers(0, 3) | st.integers(0, 80))
            piece = st.sampled_from(
                [b'"', b"'", b" ", b"=", b"<", b"/>", b">", b"-", b".", b"e", b"&", b"<!--", b"-->"]
            )
            new = data.draw(st.binary(max_size=3) | piece | st.sampled_from(b"0123456789").map(lambda c: bytes([c])))
            content = content[:start] + new + content[start + gone :]
        found = scanned([ARM, content]) if data.draw(st.booleans()) else scanned([content, ARM])
        ours = [read for place, read in found.items() if read != as_read(ARM)]
        assert as_read(ARM) in found.values()
        for read in ours:
            assert read == as_read(content)
        if len(found) == 2 and not ours:
            assert as_read(content) == as_read(ARM)


THIRD = b"""  <joint name="third" type="fixed">
    <origin xyz="0.1 0 0"/>
    <parent link="tool0"/>
    <child link="grip"/>
  </joint>
  <link name="grip"/>
</robot>
"""
LONGER = ARM.replace(b"</robot>\n", THIRD)


class TestParts:
    def test_each_is_learned_once(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """Of files that all have other elements, the slow reader reads what is new in each."""
        asked = []

        def counted(root: Any, file: str) -> Any:
            asked.append(root)
            return model_of(root, file)

        monkeypatch.setattr(urdf_scanner, "model_of", counted)
        shapes = [b'<sphere radius="0.1"/>', b'<box size="0.1 0.2 0.3"/>', b'<cylinder radius="0.05" length="1"/>']
        looks = [b"<visual><geometry>%s</geometry></visual>" % shape for shape in shapes]
        files = [
            LONGER.replace(b'"tool0"/>\n  <joint', b'"tool0">%s</link>\n  <joint' % tool).replace(
                b'"grip"/>\n</robot>', b'"grip">%s</link>\n</robot>' % grip
            )
            for tool in looks
            for grip in looks
        ]
        assert scanned(files) == {place: as_read(content) for place, content in enumerate(files)}
        assert len(asked) <= 2 + 2 * len(shapes)  # the same two parts are first in all

    @pytest.mark.parametrize("first", [[], [LONGER], [LONGER, ARM]], ids=["", "longer", "both"])
    def test_the_end_is_at_the_end(self, first: list[bytes]) -> None:
        """A part that is well-formed in one place is not taken for it in another."""
        end = b"</robot>\n"
        third = LONGER.index(THIRD)
        wrong = [LONGER[:third], ARM.removesuffix(end), ARM + THIRD, LONGER + end, ARM[: ARM.index(b"  <joint")]]
        found = scanned([*first, *wrong])
        assert found == {place: as_read(content) for place, content in enumerate(first)}
        assert scanned([LONGER, ARM]) == {0: as_read(LONGER), 1: as_read(ARM)}

    def test_what_a_part_needs_of_another(self) -> None:
        """A material may be defined in any link before the one that names it: such a file is not cut, and left out."""
        color = b'<material name="blue"><color rgba="0 0 1 1"/></material>'
        shape = b'<link name="%s"><visual><geometry><sphere radius="1"/></geometry>%s</visual></link>'
        by_name = shape % (b"grip", b'<material name="blue"/>')
        named = LONGER.replace(b'<link name="grip"/>', by_name)
        defined = named.replace(b'<link name="tool0"/>', shape % (b"tool0", color))
        for files in ([named, defined, named], [defined, named, defined]):
            assert scanned(files) == {}

    def test_what_looks_like_a_joint_of_the_robot(self) -> None:
        """A joint inside another element is none of the robot's; where its line begins as theirs, the file is left out."""
        drive = b'  <transmission name="drive">\n%s<joint name="turn"/>\n  </transmission>\n</robot>'
        files = [ARM.replace(b"</robot>", drive % margin) for margin in (b"  ", b"    ")]
        files += [content.replace(b'xyz="0 0 0.25"', b'xyz="0 0 0.5"') for content in files]
        assert scanned(files) == {place: as_read(files[place]) for place in (1, 3)}


class TestWhatIsRemembered:
    @pytest.mark.parametrize("step", [0.01, 0], ids=["all numbers vary", "none does"])
    def test_a_form_is_known(self, monkeypatch: pytest.MonkeyPatch, step: float) -> None:
        """Files of a known form are not cut into parts, and read to the last bit."""
        scan_columns([with_other_numbers(step * k) for k in range(forms.ENOUGH)])
        monkeypatch.delattr(urdf_scanner._Scanner, "_cut")
        files = [with_other_numbers(step * k) for k in (5, 1e-7, -30)]
        assert scanned(files) == {place: as_read(content) for place, content in enumerate(files)}

    def test_a_file_of_another_form(self) -> None:
        """A number that no other file changed, two that were always the same, and what is no number: all are seen."""
        scan_columns([with_changes((b"0.25", b"%d.5" % k)) for k in range(forms.ENOUGH)])
        plain = [with_changes(change) for change in ((b"0.25", b"7"), (b"0 0 1e-3", b"0 1 1e-3"), (b'"2"', b'"2.5"'))]
        odd = with_changes((b"0.25", b"+1"))
        files = [plain[0], odd, *plain[1:], plain[0]]
        assert scanned(files) == {place: as_read(files[place]) for place in (0, 2, 3, 4)}

    def test_numbers_that_were_always_alike(self) -> None:
        """Two values that were the same text in each file are read apart where they are not."""
        twice = [with_changes((b"0 0 0.25", b"0 0 %d" % k), (b"0 0 1e-3", b"0 0 %d" % k)) for k in range(40)]
        files = [*twice, with_changes((b"0 0 0.25", b"0 0 3"), (b"0 0 1e-3", b"0 0 4")), twice[1]]
        for _ in range(2):
            assert scanned(files) == {place: as_read(content) for place, content in enumerate(files)}

    def test_the_order_of_the_files_changes_nothing(self) -> None:
        """A file is read or left out for what it is, whatever came before it."""
        files = [with_changes(change) for change in NOT_PLAIN.values()]
        files += [ARM, with_changes((b"0.25", b"0.5")), with_changes((b'"turn"', b'"twist"'))]
        alone = {content: scanned([content]).get(0) for content in files}
        for seed in range(5):
            shuffled = random.Random(seed).sample(files, len(files))  # noqa: S311 - the same on every machine
            found = scanned(shuffled)
            assert [found.get(place) for place in range(len(files))] == [alone[content] for content in shuffled]

    def test_it_has_a_bound(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """A run whose robots are all of different kinds does not fill the memory, and is read all the same."""
        monkeypatch.setattr(urdf_scanner, "_MOST", 5 * len(ARM))
        for number in range(50):
            content = with_changes((b'"turn"', b'"turn_%d"' % number))
            assert scanned([content]) == {0: as_read(content)}
            assert urdf_scanner._scanner.size < 8 * len(ARM)


@settings(max_examples=40)
@given(table=manipulators(most=5), data=st.data(), frames=st.sampled_from(FRAMES))
def test_any_arms_are_read_as_the_slow_reader_reads_them(table: Manipulator, data: st.DataObject, frames: str) -> None:
    """Files of arms with the same joints are one group, and each of its members is the file's robot."""

    def numbers() -> dict[str, float]:
        return {
            "a": data.draw(LENGTHS),
            "alpha": data.draw(ANGLES),
            "d": data.draw(LENGTHS),
            "theta": data.draw(ANGLES),
        }

    tables = [
        replace(table, name=f"arm_{k}", rows=tuple(replace(row, **numbers()) for row in table.rows))
        for k in range(data.draw(st.integers(1, 4)))
    ]
    files = [written(table, frames) for table in tables]
    assert [places for places, _ in scan_columns(files)] == [list(range(len(files)))]
    assert scanned(files) == {place: as_read(content) for place, content in enumerate(files)}
