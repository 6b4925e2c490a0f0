from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import LoaderError, MissingDependencyError
from dh2urdf.isolation.child_process import load_in_child
from dh2urdf.robot import Collision, Cylinder, Origin
from dh2urdf_plugins.loaders.drake.loader import LOADER, DrakeOptions, load, read_output

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.stages import LoadReport, LoadRequest

pytest.importorskip("pydrake")

OPTIONS = DrakeOptions()
CONFIGS = Path(__file__).parents[3] / "configs"


def run(request: LoadRequest) -> LoadReport:
    return load_in_child(LOADER, request, OPTIONS)


def refusal(request: LoadRequest) -> LoaderError:
    """Why a file is refused, in this process: it is quicker, and Drake raises what it would leave by."""
    with pytest.raises(LoaderError) as caught:
        load(request, OPTIONS)
    return caught.value


def surprises(report: LoadReport) -> list[str]:
    """The findings but for the one that every URDF without transmissions has."""
    return [finding.message for finding in report.findings if "no actuators" not in finding.message]


def test_right_arm_is_confirmed(request_for: Any, planar: Any) -> None:
    """An arm that was written right has its joints, masses and poses in Drake, to the last digits of a double."""
    report = run(request_for())
    assert (report.simulator, report.poses, report.output) == ("Drake", len(planar.poses), "")
    assert surprises(report) == []
    assert report.q in planar.poses
    assert report.position_error is not None
    assert report.tolerance is not None
    assert report.position_error < 1e-14 < report.tolerance < 1e-11
    assert report.angle_error is not None
    assert report.angle_error < 1e-14
    assert report.mass == pytest.approx(6.7, rel=1e-15)
    assert report.mass_error == 0.0
    assert report.inertia_error is not None
    assert report.inertia_error < 1e-16


def test_joints_are_reported_as_drake_has_them(request_for: Any) -> None:
    """The report lists the moving joints in Drake's order; a joint without actuator has no effort in Drake."""
    shoulder, elbow, slide, wrist = run(request_for()).joints
    assert shoulder == {
        "name": "shoulder",
        "type": "revolute",
        "axis": (0.0, 1.0, 0.0),
        "lower": -2.0,
        "upper": 2.5,
        "velocity": 3.0,
    }
    assert elbow["name"] == "elbow"
    assert (slide["type"], slide["axis"], slide["lower"], slide["upper"]) == ("prismatic", (1.0, 0.0, 0.0), 0.05, 0.2)
    assert (wrist["type"], wrist["lower"], wrist["upper"]) == ("continuous", None, None)


def with_transmissions(urdf: str, joints: Sequence[str]) -> str:
    parts = [
        f'<transmission name="of_{joint}">\n<type>transmission_interface/SimpleTransmission</type>\n'
        f'<joint name="{joint}"/>\n<actuator name="motor_of_{joint}"/>\n</transmission>\n'
        for joint in joints
    ]
    return urdf.replace("</robot>", "".join([*parts, "</robot>"]))


def test_joint_without_actuator_is_a_finding(request_for: Any, planar: Any) -> None:
    """Drake takes efforts from transmissions only: it names the joints without; with one, the effort is compared."""
    (finding,) = run(request_for()).findings
    assert finding.severity == "notice"
    assert finding.message.endswith("of 4 joints: 'shoulder', 'elbow', 'slide', 'wrist'")
    written = with_transmissions(planar.urdf, ["shoulder", "elbow", "slide", "wrist"])
    report = run(request_for(written))
    assert report.findings == ()
    assert [joint["effort"] for joint in report.joints] == [60.0, 30.0, 50.0, 10.0]
    assert report.hold["stayed"] is True
    assert "effort 61.0 where 60.0 was written" in str(
        refusal(request_for(written.replace('effort="60"', 'effort="61"')))
    )


@pytest.mark.parametrize(
    ("written", "instead", "message"),
    [
        ('xyz="0.4 0 0"', 'xyz="0.401 0 0"', "tool0 in another place, 0.001 m"),
        ('xyz="0.4 0 0"', 'xyz="-0.4 0 0"', "tool0 in another place, 0.8 m"),
        ('xyz="0.4 0 0"', 'xyz="0.4 0 0" rpy="1e-11 0 0"', "and 1e-11 rad away"),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>', r"axis \(0\.0, -1\.0, 0\.0\) where"),
        ('type="continuous"', 'type="fixed"', "lost the joint"),
        ('name="elbow"', 'name="knee"', "a joint that was not written"),
        ('lower="-2" upper="2.5"', 'lower="-2" upper="2.6"', r"upper 2\.6 where 2\.5 was written"),
        ('velocity="0.5"', 'velocity="5"', r"velocity 5\.0 where 0\.5"),
        ('mass value="1"', 'mass value="1.1"', r"another mass of the link 'forearm', by 0\.1 kg"),
        ('xyz="0.2 0.01 0"', 'xyz="0.2 0.011 0"', r"another com of the link 'upper_arm', by 0\.001 m"),
        ('ixy="0.0003"', 'ixy="-0.0003"', r"another inertia of the link 'upper_arm', by 0\.0006 kg·m²"),
        ('iyy="0.03"', 'iyy="0.3"', "another inertia of the link 'upper_arm'"),  # impossible: zeroed
        ('"base_link"', '"base"', "lost the link 'base_link'"),
    ],
)
def test_another_arm_is_refused(request_for: Any, planar: Any, *, written: str, instead: str, message: str) -> None:
    """A file that differs from the robot in a pose, joint or mass property is refused, and the message says in what."""
    assert written in planar.urdf
    error = refusal(request_for(planar.urdf.replace(written, instead)))
    with pytest.raises(LoaderError, match=message):
        raise error
    assert error.problems[0].robot == "planar"


@pytest.mark.parametrize(
    ("written", "instead", "message"),
    [
        ('name="elbow"', 'name="shoulder"', "names must be unique"),
        ('name="hand"', 'name="slider"', "names must be unique"),
        ('lower="-2" upper="2.5"', 'lower="2.5" upper="-2"', "pos_lower_limits.* failed"),  # SystemExit
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', "line 26: .*axis is zero"),
        ('size="0.4 0.06 0.06"', 'size="0.4 0 0.06"', "Box.* failed"),
        ("</robot>", '<link name="second_root"/>\n</robot>', "cannot simulate the arm: .*second_root"),
        ('<parent link="base_link_inertia"/>', '<parent link="hand"/>', "loops"),
        ("</robot>", "", "line .*Failed to parse XML"),
        ('<box size="0.4 0.06 0.06"/>', '<mesh filename="nowhere.obj"/>', "nowhere.obj.*does not exist"),
    ],
)
def test_bad_file_is_refused_with_a_reason(
    request_for: Any, planar: Any, *, written: str, instead: str, message: str
) -> None:
    """What Drake raises, and what makes it leave the interpreter, is an error in Drake's own words."""
    assert written in planar.urdf
    with pytest.raises(LoaderError, match=message):
        raise refusal(request_for(planar.urdf.replace(written, instead)))


def test_error_is_followed_by_what_was_logged(request_for: Any, planar: Any) -> None:
    """An impossible inertia, that Drake zeroes, is refused, and its own words about it follow."""
    with pytest.raises(LoaderError) as caught:
        run(request_for(planar.urdf.replace('iyy="0.03"', 'iyy="0.3"')))
    first, logged = caught.value.problems
    assert "another inertia" in first.message
    assert logged.message.startswith("Drake printed 'line 30: warning: While parsing inertia matrix")
    assert "CouldBePhysicallyValid" in logged.message


def test_missing_file_is_refused(request_for: Any, tmp_path: Path) -> None:
    """A file that is not there is an error of this manipulator."""
    request = replace(request_for(), path=tmp_path / "elsewhere.urdf")
    assert "Drake cannot load the file" in str(refusal(request))


def test_weak_arm_does_not_stay(request_for: Any, planar: Any) -> None:
    """An arm whose efforts are below its weight sinks in the hold test; that is a finding, not a failure."""
    joints = tuple(
        replace(joint, limits=replace(joint.limits, effort=1.0)) if joint.limits.effort == 60.0 else joint
        for joint in planar.robot.joints
    )
    robot = replace(planar.robot, joints=joints)
    report = run(request_for(planar.urdf.replace('effort="60"', 'effort="1"'), robot))
    assert report.hold["stayed"] is False
    assert report.hold["joint"] == "shoulder"
    assert report.hold["largest_displacement"] > 0.5
    assert surprises(report) == [report.findings[-1].message]
    assert "did not stay in place" in report.findings[-1].message


def test_arm_without_effort_falls(request_for: Any, planar: Any) -> None:
    """A joint whose effort is 0 has no motor in the hold test; Drake takes no actuator without effort."""
    joints = tuple(replace(joint, limits=replace(joint.limits, effort=0.0)) for joint in planar.robot.joints)
    report = run(request_for(planar.urdf, replace(planar.robot, joints=joints)))
    assert report.hold["stayed"] is False


def test_strong_arm_stays(request_for: Any) -> None:
    """An arm whose efforts hold its weight stays for two seconds; the test starts inside the limits."""
    hold = run(request_for()).hold
    assert hold["stayed"] is True
    assert 0.0 < hold["largest_displacement"] < 0.001  # the springs give their full effort at 0.001
    assert (hold["seconds"], hold["start"], hold["contacts"]) == (2.0, (0.0, 0.0, 0.05, 0.0), [])


def test_overlap_is_found(request_for: Any, planar: Any) -> None:
    """Collision shapes that overlap at the start are a finding; contacts are off, and the arm stays all the same."""
    upper_arm = Collision(
        geometry=Cylinder(radius=0.04, length=1.2), origin=Origin(xyz=(0.2, 0.0, 0.0), rpy=(0.0, 1.5707963267948966, 0))
    )
    links = tuple(
        replace(link, collisions=(upper_arm,)) if link.name == "upper_arm" else link for link in planar.robot.links
    )
    text = planar.urdf.replace('radius="0.04" length="0.3"', 'radius="0.04" length="1.2"')
    report = run(request_for(text, replace(planar.robot, links=links)))
    assert report.hold["contacts"] == [("upper_arm", "slider")]
    assert report.hold["stayed"] is True
    (message,) = surprises(report)
    assert "'upper_arm' and 'slider'" in message


def test_friction_is_a_finding(request_for: Any, planar: Any) -> None:
    """What Drake logs is a finding with the line of the file: it takes no joint friction."""
    text = planar.urdf.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/>\n<dynamics friction="0.1"/>', 1)
    (message,) = surprises(run(request_for(text)))
    assert message.startswith("Drake printed 'line 27: warning: A joint has specified a non-zero value for")


def test_output_is_told_by_message(request_for: Any) -> None:
    """A logged message is one finding though it has many lines; each comes once, errors keep their severity."""
    path = request_for().path.resolve()
    output = (
        f"Drake logged WARNING: {path}:30: warning: the inertia\n [1 2 3]\nis impossible\n"
        f"Drake logged WARNING: {path}:30: warning: the inertia\n [1 2 3]\nis impossible\n"
        "Drake logged ERROR: worse\n"
    )
    found = [(problem.severity, problem.message) for problem in read_output(request_for(), output)]
    assert found == [
        ("notice", "Drake printed 'line 30: warning: the inertia [1 2 3] is impossible'"),
        ("error", "Drake printed 'worse'"),
    ]


def test_bare_line_is_a_finding(request_for: Any) -> None:
    """What was printed past the logger is a finding too, line by line."""
    found = [problem.message for problem in read_output(request_for(), "one\n\ntwo\n")]
    assert found == ["Drake printed 'one'", "Drake printed 'two'"]


def test_published_arms_are_confirmed(reference_robot: Any, published_request: Any) -> None:
    """Every published arm is the same arm in Drake, to 1e-12 of its reach, stays, and gives no unexpected finding."""
    report = load(published_request(reference_robot), OPTIONS)
    assert report.poses == len(reference_robot.q)
    assert report.position_error is not None
    assert report.position_error < 1e-13
    assert report.hold["stayed"] is True
    assert not [message for message in surprises(report) if "collision shapes" not in message]


@pytest.mark.parametrize(("config", "tips"), [("pair", 2), ("ur5_on_track", 2)])
def test_cell_is_confirmed(cli: Any, tmp_path: Path, config: str, tips: int) -> None:
    """A cell, whose root `world` is Drake's own world, is the same: every tool0 of every arm, riders too."""
    cli(
        "run",
        CONFIGS / f"{config}.yaml",
        "-o",
        tmp_path / "out",
        "--set",
        "loaders=[drake]",
        "--set",
        "execution=local",
    )
    records = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))["manipulators"]
    (cell,) = [record for record in records if record["name"] == config]
    assert cell["status"] == "ok"
    assert cell["loaders"]["drake"]["position_error"] < 1e-13
    assert cell["loaders"]["drake"]["hold"]["stayed"] is True
    assert len(cell["proof"]["urdf"]["tips"]) == tips


def test_missing_package_names_the_extra(request_for: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without Drake the error says what to install."""
    monkeypatch.setitem(sys.modules, "pydrake", None)
    with pytest.raises(MissingDependencyError, match=r"pip install 'dh2urdf\[drake\]'"):
        load(request_for(), OPTIONS)


def test_options_are_checked() -> None:
    """There is at least one pose to measure."""
    with pytest.raises(ValueError, match="from 1 on"):
        DrakeOptions(poses=0)
