from __future__ import annotations

import json
import sys
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import LoaderError, MissingDependencyError
from dh2urdf.isolation.child_process import load_in_child
from dh2urdf_plugins.loaders.pinocchio import arm as pinocchio_arm
from dh2urdf_plugins.loaders.pinocchio.loader import LOADER, PinocchioOptions, load, read_output

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.stages import LoadReport, LoadRequest

pytest.importorskip("pinocchio")

CONFIGS = Path(__file__).parents[3] / "configs"
OPTIONS = PinocchioOptions()


def run(request: LoadRequest) -> LoadReport:
    return load_in_child(LOADER, request, OPTIONS)


def refusal(request: LoadRequest) -> LoaderError:
    with pytest.raises(LoaderError) as caught:
        run(request)
    return caught.value


def test_right_arm_is_confirmed(request_for: Any, planar: Any) -> None:
    """An arm that was written right has its joints, masses and poses in Pinocchio; no finding and no output."""
    report = run(request_for())
    assert report.simulator == "Pinocchio"
    assert (report.findings, report.output) == ((), "")
    assert report.poses == len(planar.poses)
    assert report.q in planar.poses
    assert report.position_error is not None
    assert report.tolerance is not None
    assert report.position_error < report.tolerance < 1.2e-12
    assert report.angle_error is not None
    assert report.angle_tolerance is not None
    assert report.angle_error < report.angle_tolerance < 1.1e-12
    assert report.mass == pytest.approx(6.7, rel=1e-15)
    assert report.mass_error == 0.0
    assert report.inertia_error is not None
    assert report.inertia_error < 1e-16


def test_joints_are_reported_as_pinocchio_has_them(request_for: Any) -> None:
    """The report lists the moving joints; one that turns without end has two coordinates, and no limits."""
    shoulder, _, slide, wrist = run(request_for()).joints
    assert shoulder == {
        "name": "shoulder",
        "type": "revolute",
        "axis": (0.0, 1.0, 0.0),
        "lower": -2.0,
        "upper": 2.5,
        "velocity": 3.0,
        "effort": 60.0,
    }
    assert (slide["type"], slide["axis"], slide["lower"], slide["upper"]) == ("prismatic", (1.0, 0.0, 0.0), 0.05, 0.2)
    assert (wrist["type"], wrist["axis"]) == ("continuous", (1.0, 0.0, 0.0))
    assert (wrist["lower"], wrist["upper"], wrist["velocity"], wrist["effort"]) == (None, None, 6.0, 10.0)


@pytest.mark.parametrize(
    ("written", "instead", "message"),
    [
        ('xyz="0.4 0 0"', 'xyz="0.400000001 0 0"', "tool0 in another place, 1e-09 m"),
        ('xyz="0.4 0 0"', 'xyz="0.4 0 0" rpy="0.00000001 0 0"', "and 1e-08 rad away"),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>', r"axis \(0\.0, -1\.0, 0\.0\) where"),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>', r"axis \(0\.0, 0\.0, 0\.0\) where"),
        ('type="continuous"', 'type="fixed"', "lost the joint"),
        ('name="elbow"', 'name="knee"', "a joint that was not written"),
        ('lower="-2" upper="2.5"', 'lower="2.5" upper="-2"', r"lower 2\.5 where -2\.0 was written"),
        ('effort="60"', 'effort="61"', r"effort 61\.0 where 60\.0"),
        ('velocity="0.5"', 'velocity="5"', r"velocity 5\.0 where 0\.5"),
        ('mass value="1"', 'mass value="1.000001"', r"another mass of the link 'forearm', by 1e-06 kg"),
        ('xyz="0.2 0.01 0"', 'xyz="0.2 0.011 0"', r"another com of the link 'upper_arm', by 0\.001 m"),
        ('ixy="0.0003"', 'ixy="-0.0003"', r"another inertia of the link 'upper_arm', by 0\.0006 kg·m²"),
        ('<mass value="2"/>', "", "another mass of the link 'upper_arm', by 2 kg"),
    ],
)
def test_another_arm_is_refused(request_for: Any, planar: Any, written: str, instead: str, message: str) -> None:
    """A file that differs from the robot in a pose, joint or mass property is refused, and the message says in what."""
    assert written in planar.urdf
    error = refusal(request_for(planar.urdf.replace(written, instead, 1)))
    with pytest.raises(LoaderError, match=message):
        raise error
    assert error.problems[0].robot == "planar"


@pytest.mark.parametrize(
    ("written", "instead", "said"),
    [
        ('<limit lower="-2" upper="2.5" effort="60" velocity="3"/>', "", "does not specify limits"),
        (' effort="60"', "", "no effort"),
        ('name="elbow"', 'name="shoulder"', "is not unique"),
        ('<link name="hand">', '<link name="slider">', "is not unique"),
        ("</robot>", '<link name="other"/></robot>', "Two root links"),
        ("<robot ", "<", "XML"),
    ],
)
def test_what_the_parser_prints_of_a_faulty_file_is_repeated(
    request_for: Any, planar: Any, written: str, instead: str, said: str
) -> None:
    """A file that Pinocchio refuses fails with the reason, which stands only in what its parser prints."""
    assert written in planar.urdf
    error = refusal(request_for(planar.urdf.replace(written, instead, 1)))
    assert error.problems[0].message == "Pinocchio cannot load the file"
    assert any(said in problem.message for problem in error.problems[1:]), str(error)


def test_error_that_is_only_printed_is_a_finding(request_for: Any, planar: Any) -> None:
    """Pinocchio loads a file with an inertial that it could not read: the parser's error is told with the difference."""
    inertia = '<inertia ixx="0.004" ixy="0.0003" ixz="0.0001" iyy="0.03" iyz="-0.0002" izz="0.031"/>'
    assert inertia in planar.urdf
    messages = [problem.message for problem in refusal(request_for(planar.urdf.replace(inertia, ""))).problems]
    assert any("another inertia of the link 'upper_arm'" in message for message in messages)
    assert any("Pinocchio printed 'Inertial element must have inertia element'" in message for message in messages)


def test_lost_link_is_refused(request_for: Any, planar: Any) -> None:
    """A link that Pinocchio does not have is named."""
    assert "Pinocchio has lost the link 'tool0'" in str(refusal(request_for(planar.urdf.replace('"tool0"', '"tool"'))))


def test_missing_file_is_refused(request_for: Any, tmp_path: Path) -> None:
    """A file that is not there is an error of this manipulator."""
    request = replace(request_for(), path=tmp_path / "elsewhere.urdf")
    assert "Pinocchio cannot load the file" in str(refusal(request))


# Stretched out along x with the rail at 0.05 m, gravity asks of the shoulder [N·m]:
STATIC_LOAD = 9.81 * (2.0 * 0.2 + 1.0 * 0.4 + (0.5 + 0.2) * (0.4 + 0.35 + 0.05))


def test_weight_is_held_against_the_efforts(request_for: Any, planar: Any) -> None:
    """The largest load is the largest share of a joint's effort that gravity asks: here of the shoulder, at the start."""
    hold = run(request_for(poses=planar.poses[:1], expected={"tool0": planar.expected[:1]})).hold
    assert hold["largest_load"] == pytest.approx(STATIC_LOAD / 60.0, rel=1e-12)
    assert (hold["joint"], hold["q"], hold["poses"]) == ("shoulder", (0.0, 0.0, 0.05, 0.0), 2)
    assert (hold["start"], hold["threshold"], hold["stayed"]) == ((0.0, 0.0, 0.05, 0.0), 1.0, True)


@pytest.mark.parametrize(("share", "stays"), [(1.001, True), (0.999, False)])
def test_effort_below_the_weight_is_a_finding(request_for: Any, planar: Any, *, share: float, stays: bool) -> None:
    """An effort below what gravity asks is a notice with the joint, the torque and the joint vector."""
    effort = share * STATIC_LOAD
    joints = tuple(
        replace(joint, limits=replace(joint.limits, effort=effort)) if joint.name == "shoulder" else joint
        for joint in planar.robot.joints
    )
    text = planar.urdf.replace('effort="60"', f'effort="{effort}"')
    poses = {"poses": planar.poses[:1], "expected": {"tool0": planar.expected[:1]}}
    report = run(request_for(text, replace(planar.robot, joints=joints), **poses))
    assert report.hold["stayed"] is stays
    assert [(finding.severity, finding.joint, finding.field) for finding in report.findings] == (
        [] if stays else [("notice", "shoulder", "limits.effort")]
    )
    if not stays:
        assert "q = (0.0, 0.0, 0.05, 0.0) gravity asks 13.34 N·m" in report.findings[0].message


def test_published_arms_are_confirmed(reference_robot: Any, published_request: Any) -> None:
    """Every published arm is the same arm in Pinocchio, to double precision, holds its weight; nothing is printed."""
    report = run(published_request(reference_robot))
    assert report.poses == len(reference_robot.q)
    assert report.hold["stayed"] is True
    assert (report.findings, report.output) == ((), "")


def test_cell_is_confirmed(cli: Callable[..., Any], tmp_path: Path) -> None:
    """Both arms of a cell are where the run file has them, and both hold their weight."""
    cli(
        "run",
        CONFIGS / "pair.yaml",
        "-o",
        tmp_path / "out",
        "--set",
        "loaders=[{stage: pinocchio, options: {poses: 5}}]",
    )
    report = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))
    entry = next(entry for entry in report["manipulators"] if entry["name"] == "pair")["loaders"]["pinocchio"]
    assert len(entry["joints"]) == 12
    assert entry["position_error"] < entry["tolerance"] < 2e-12
    assert entry["hold"]["stayed"] is True
    assert entry["findings"] == []


def test_arm_too_long_for_its_memory_is_weighed_only(request_for: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of an arm of more joints than Pinocchio has memory for, joints and masses are compared; that is said."""
    monkeypatch.setattr(pinocchio_arm, "MEASURED_JOINTS", 3)
    report = load(request_for(), OPTIONS)
    assert len(report.joints) == 4
    assert report.mass == pytest.approx(6.7)
    assert (report.position_error, report.hold) == (None, {})
    (finding,) = report.findings
    assert (finding.severity, finding.found) == ("notice", "4 moving joints")


def test_missing_package_names_the_extra(request_for: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without Pinocchio, the error says what to install; the package is not named as the module is."""
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    with pytest.raises(MissingDependencyError) as caught:
        load(request_for(), OPTIONS)
    assert (caught.value.package, caught.value.extra) == ("pin", "dh2urdf[pinocchio]")


def test_warnings_and_errors_are_findings(request_for: Any) -> None:
    """What the parser calls a warning is a notice, what it calls an error is one; each is told once."""
    output = (
        "Warning: link 'a' material 'x' undefined.\n         at line 63 in urdf_parser/src/model.cpp\n"
        "Error:   joint 'b' is not unique.\n         at line 231 in urdf_parser/src/model.cpp\n"
    )
    findings = read_output(request_for(), output * 2)
    assert [(finding.severity, finding.message) for finding in findings] == [
        ("notice", "Pinocchio printed 'link 'a' material 'x' undefined.'"),
        ("error", "Pinocchio printed 'joint 'b' is not unique.'"),
    ]


def test_poses_are_counted_from_one() -> None:
    """There is no run without a pose."""
    with pytest.raises(ValueError, match="poses is a number from 1 on"):
        PinocchioOptions(poses=0)
