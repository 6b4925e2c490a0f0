"""Reading what strangers wrote: nothing crashes, nothing hangs, and what is read is what is there."""

import json
import re
from pathlib import Path

import pytest
from faulty_files import SOUND
from hypothesis import given, strategies as st

from dh2urdf.errors import InputError, ProofError
from dh2urdf.kinematics import KinematicChain, angle_error, position_error
from dh2urdf.source import Mark
from dh2urdf_check.document import read_text
from dh2urdf_check.finders import numbers_of
from dh2urdf_check.inspection import inspect_urdf, inspect_xacro
from dh2urdf_plugins.formats.urdf import EMITTER, ProfileName
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM
from dh2urdf_plugins.xacro_fence import expansion
from reference_arms import ReferenceRobot

EXPECTED = {
    "root-without-inertial",
    "fixed-link",
    "named-colour",
    "continuous-joint",
    "zero-outside-limits",
    "axis-along-minus-z",
    "free-root",
    "empty-root",
    "usd-name",
}
"""What may be found in a file that is right: nothing but CoppeliaSim misreads it."""
EXPECTED_BY = {"portable": EXPECTED, "coppeliasim": EXPECTED | {"frame-without-inertial"}}
"""The same, by the profile that wrote the file."""
IN_COPPELIASIM = Path(__file__).parents[1] / "plugins" / "loaders" / "coppeliasim_4_10_0_arms.json"


@pytest.mark.parametrize("profile", EXPECTED_BY)
def test_what_the_project_writes_has_notes_only(
    reference_robot: ReferenceRobot, tmp_path: Path, profile: ProfileName
) -> None:
    """The URDF of a published arm has no error and no warning, for any consumer but CoppeliaSim.

    For that one, the portable file of those arms has a warning that were other arms in it, and of these only.
    """
    robot = TRANSFORM.transform(reference_robot.manipulator, TRANSFORM.options())
    path = tmp_path / "arm.urdf"
    path.write_bytes(EMITTER.emit(robot, "arm", EMITTER.options(profile=profile))[0].content)
    found = inspect_urdf(path)
    warned = {effect.consumer for finding in found.findings for effect in finding.effects if effect.severity != "note"}
    was_right = json.loads(IN_COPPELIASIM.read_text("utf-8"))[reference_robot.id]["aligned"][profile] is not None
    assert warned - {"pybullet" if profile == "coppeliasim" else ""} == (set() if was_right else {"coppeliasim"})
    assert {finding.rule for finding in found.findings} <= EXPECTED_BY[profile]
    assert found.robot is not None
    ours, theirs = KinematicChain.between(robot), KinematicChain.between(found.robot)
    for q in reference_robot.q:
        assert position_error(ours.forward_kinematics(q), theirs.forward_kinematics(q)) < 1e-12
        assert angle_error(ours.forward_kinematics(q), theirs.forward_kinematics(q)) < 1e-12


@given(st.binary(max_size=200))
def test_bytes_are_a_tree_or_no_xml(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    """Whatever bytes come, there is a tree, or a reason with a place."""
    path = tmp_path_factory.getbasetemp() / "bytes.urdf"
    path.write_bytes(content)
    try:
        assert read_text(path, "urdf").marks
    except ProofError as error:
        assert error.problems[0].message
        assert error.problems[0].mark


@given(
    st.integers(0, len(SOUND) - 1),
    st.integers(1, 40),
    st.sampled_from(["", "0", "-", "nan", '"', "<link/>", "é", "../"]),
)
def test_a_description_with_a_hole_is_inspected(
    tmp_path_factory: pytest.TempPathFactory, start: int, length: int, instead: str
) -> None:
    """A piece of the file is gone, or is something else: nothing is raised, and every place is inside the file."""
    text = SOUND[:start] + instead + SOUND[start + length :]
    path = tmp_path_factory.getbasetemp() / "hole.urdf"
    path.write_text(text)
    for finding in inspect_urdf(path).findings:
        assert finding.effects
        assert finding.mark is not None
        assert 1 <= (finding.mark.line or 0) <= text.count("\n") + 1


@given(st.text(alphabet="01.e-+_ nainfx٣\t", max_size=12))
def test_numbers_are_those_that_all_readers_take(text: str) -> None:
    """Decimal digits, finite, with spaces between them: what is read is what `float` makes of it."""
    found = numbers_of(text, 1)
    if found is not None:
        assert found == (float(text),)
        assert "_" not in text
        assert text.strip()


def test_entities_are_not_expanded(tmp_path: Path) -> None:
    """A thousand million of one letter are a finding, and no memory."""
    entities = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(9))
    path = tmp_path / "bomb.urdf"
    path.write_text(f'<?xml version="1.0"?>\n<!DOCTYPE r [<!ENTITY e0 "l">{entities}]>\n<robot name="&e9;"/>')
    (finding,) = inspect_urdf(path).findings
    assert (finding.rule, finding.severity) == ("not-xml", "error")


def test_no_depth_is_recursed_into(tmp_path: Path) -> None:
    """A hundred thousand elements inside each other are a finding; a thousand joints in a row are a chain."""
    path = tmp_path / "deep.urdf"
    depth = 100_000
    path.write_text(f'<robot name="r"><link name="a">{"<visual>" * depth}{"</visual>" * depth}</link></robot>')
    assert inspect_urdf(path).findings
    links = "".join(f'<link name="l{i}"/>' for i in range(1001))
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="l{i}"/><child link="l{i + 1}"/></joint>' for i in range(1000)
    )
    path.write_text(f'<robot name="r">{links}{joints}</robot>')
    robot = inspect_urdf(path).robot
    assert robot is not None
    assert len(KinematicChain.between(robot, "l0", "l1000").joints) == 1000


@pytest.mark.parametrize("encoding", ["utf-8-sig", "iso-8859-1"])
def test_encodings_are_read(tmp_path: Path, encoding: str) -> None:
    """As XML declares them, or as a byte order mark does."""
    path = tmp_path / "arm.urdf"
    declared = encoding.removesuffix("-sig")
    path.write_bytes(SOUND.replace("utf-8", declared, 1).replace("elbow", "élbow").encode(encoding))
    robot = inspect_urdf(path).robot
    assert robot is not None
    assert "élbow" in {joint.name for joint in robot.joints}
    assert {finding.rule for finding in inspect_urdf(path).findings} - EXPECTED == {"name-characters"}


def test_a_file_that_is_not_there_is_an_error(tmp_path: Path) -> None:
    """And no finding: nothing can be said of it."""
    for inspect in (inspect_urdf, inspect_xacro):
        with pytest.raises(InputError, match="no such file"):
            inspect(tmp_path / "nowhere.urdf")


# --- xacro ------------------------------------------------------------------------------------------------------------

XACRO = '<?xml version="1.0"?>\n<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">\n{}\n</robot>\n'


def test_a_xacro_is_inspected_as_it_expands(tmp_path: Path) -> None:
    """Faults are found behind properties and macros; their lines are those of the sources, with the macro's call."""
    text = SOUND.split("?>", 1)[1].split('<robot name="arm">')[1].removesuffix("</robot>\n")
    text = text.replace('lower="-2"', 'lower="${bottom}"')
    (tmp_path / "macro.xacro").write_text(
        XACRO.format(f'<xacro:macro name="arm" params="bottom">{text}</xacro:macro>\n<link name="base_link"/>')
    )
    path = tmp_path / "arm.urdf.xacro"
    path.write_text(XACRO.format('<xacro:include filename="macro.xacro"/>\n  <xacro:arm bottom="${3 + 1}"/>'))
    found = {finding.rule: finding for finding in inspect_xacro(path).findings if finding.rule not in EXPECTED}
    assert set(found) == {"swapped-limits", "duplicate-link"}
    limit, link = found["swapped-limits"], found["duplicate-link"]
    assert limit.mark is not None
    assert limit.mark.file == str(tmp_path / "macro.xacro")
    assert 'lower="${bottom}"' in (tmp_path / "macro.xacro").read_text().splitlines()[(limit.mark.line or 0) - 1]
    assert limit.calls == (Mark(file=str(path), line=4, column=3),)
    lines = (tmp_path / "macro.xacro").read_text().splitlines()
    first = next(
        number
        for number, line in enumerate(lines, start=1)
        if line == '<link name="base_link"/>' or "</xacro:macro>" in line
    )
    assert link.message.endswith(f"has the name of the link in line {first + 1} of {tmp_path / 'macro.xacro'}")


@pytest.mark.parametrize(
    ("body", "said"),
    [('<link name="${nobody}"/>', "nobody"), ('<xacro:macro name="a"><xacro:a/></xacro:macro><xacro:a/>', "recursion")],
)
def test_what_xacro_cannot_expand_is_a_finding(tmp_path: Path, body: str, said: str) -> None:
    """An undefined property, a package that is not found, a file that is not there, a macro without end."""
    path = tmp_path / "arm.xacro"
    path.write_text(XACRO.format(body))
    (finding,) = inspect_xacro(path).findings
    assert (finding.rule, finding.severity) == ("xacro-fails", "error")
    assert re.search(said, finding.message)


@pytest.mark.long
def test_a_xacro_that_does_not_end_is_given_up(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It computes what the file asks for; that may be anything."""
    monkeypatch.setattr(expansion, "EXPANSION", 2.0)
    path = tmp_path / "arm.xacro"
    path.write_text(XACRO.format('<link name="${[x for x in range(10**6) for y in range(10**6)]}"/>'))
    (finding,) = inspect_xacro(path).findings
    assert finding.rule == "xacro-fails"
    assert "did not finish" in finding.message
