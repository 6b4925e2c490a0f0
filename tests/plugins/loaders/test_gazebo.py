from __future__ import annotations

import json
import math
import re
import shutil
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import LoaderError, MissingProgramError
from dh2urdf.isolation.loads import load_in_child
from dh2urdf.kinematics import KinematicChain
from dh2urdf.robot import Link, Origin
from dh2urdf_plugins.loaders import gazebo
from dh2urdf_plugins.loaders.gazebo import find_command, precision
from dh2urdf_plugins.loaders.simulators import LOADERS, SimulatorOptions

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

LOADER = next(each for each in LOADERS if each.name == "gazebo")
OPTIONS = SimulatorOptions()
CONFIGS = Path(__file__).parents[3] / "configs"

try:
    find_command()
except MissingProgramError as error:
    pytest.skip(str(error), allow_module_level=True)


def run(request: LoadRequest) -> LoadReport:
    return load_in_child(LOADER, request, OPTIONS)


def refusal(request: LoadRequest) -> LoaderError:
    with pytest.raises(LoaderError) as caught:
        run(request)
    return caught.value


def surprises(report: LoadReport) -> list[str]:
    """The findings but for the one that every URDF has: its frames are no links in Gazebo."""
    return [finding.message for finding in report.findings if "Gazebo has no frame" not in finding.message]


def test_lumped_frames_are_a_finding(request_for: Any) -> None:
    """Links without mass that sdformat lumps into others are named: tool0 is measured at the link that carries it."""
    report = run(request_for())
    assert re.fullmatch(r"\d+\.\d+\.\d+", report.version)
    (finding,) = report.findings
    assert finding.severity == "notice"
    assert finding.message.endswith("lumped into others: 'tool0' (in 'hand')")


def test_lumped_masses_are_those_of_all_parts(request_for: Any, planar: Any) -> None:
    """A link is compared with the sum of what it carries: a tool of 0.5 kg, turned and shifted, weighs in the hand."""
    tool = """<inertial>
      <origin xyz="0.01 0 0.02"/>
      <mass value="0.5"/>
      <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" izz="0.0025"/>
    </inertial>"""
    text = re.sub(r'(<link name="tool0">\s*)<inertial>.*?</inertial>', rf"\1{tool}", planar.urdf, flags=re.DOTALL)
    text = text.replace('type="fixed">\n    <parent link="hand"/>', f'type="fixed">\n{TURNED}<parent link="hand"/>')
    hand = next(link for link in planar.robot.links if link.name == "upper_arm").inertial
    inertia = replace(hand.inertia, ixx=0.001, iyy=0.002, izz=0.0025, ixy=0.0, ixz=0.0, iyz=0.0)
    body = replace(hand, mass=0.5, com=(0.01, 0.0, 0.02), inertia=inertia)
    links = tuple(Link(name="tool0", inertial=body) if link.name == "tool0" else link for link in planar.robot.links)
    joints = tuple(
        replace(joint, origin=Origin(xyz=(0.0, 0.1, 0.0), rpy=(0.3, 0.0, 0.0))) if joint.child == "tool0" else joint
        for joint in planar.robot.joints
    )
    request = request_for(text, replace(planar.robot, links=links, joints=joints), poses=(), expected={})
    report = run(request)
    assert report.mass == pytest.approx(7.2)
    assert report.inertia_error is not None
    assert report.inertia_error < 1e-15
    wrong = request_for(
        text.replace('"0.01 0 0.02"', '"0.01 0 0.03"'), replace(planar.robot, links=links, joints=joints)
    )
    assert "another com of the link 'hand'" in str(refusal(wrong))


TURNED = '    <origin xyz="0 0.1 0" rpy="0.3 0 0"/>\n    '


def test_warning_is_a_finding(request_for: Any, planar: Any) -> None:
    """What sdformat warns of and fixes, such as swapped limits, is a finding: others may not fix it."""
    text = planar.urdf.replace('lower="-2" upper="2.5"', 'lower="2.5" upper="-2"')
    (message,) = surprises(run(request_for(text)))
    assert re.fullmatch(r"sdformat printed 'Warning .*\[shoulder\] with limits: .*switching the two\.'", message)


@pytest.mark.parametrize("name", ["rtb_Panda", "rtb_Stanford", "threelink3d_oblique"])
def test_turned_frames_are_confirmed(reference_robots: Any, published_request: Any, name: str) -> None:
    """With the frames of the table, whose origins are turned, the arm is the same too."""
    (robot,) = [robot for robot in reference_robots if robot.id == name]
    assert LOADER.open(published_request(robot, frames="dh"), OPTIONS).poses == len(robot.q)


@pytest.mark.parametrize("pitch", [1.5707963267948966, 1.5707963, 1.57079, 1.5707, 1.57, 1.5])
def test_loss_near_the_singular_pitch_is_foreseen(request_for: Any, planar: Any, pitch: float) -> None:
    """It loses digits where a pitch is near ±π/2: as many as the tolerance allows, and no more than half."""
    rpy = (0.2, pitch, 0.3)
    joints = tuple(
        replace(joint, origin=Origin(xyz=(0.4, 0.0, 0.0), rpy=rpy)) if joint.name == "elbow" else joint
        for joint in planar.robot.joints
    )
    robot = replace(planar.robot, joints=joints)
    r, t = KinematicChain.between(robot).forward_kinematics(planar.poses[1])
    matrix = (*r[0:3], t[0], *r[3:6], t[1], *r[6:9], t[2], 0.0, 0.0, 0.0, 1.0)
    text = planar.urdf.replace('xyz="0.4 0 0"', f'xyz="0.4 0 0" rpy="{rpy[0]} {pitch!r} {rpy[2]}"')
    report = LOADER.open(request_for(text, robot, poses=(planar.poses[1],), expected={"tool0": (matrix,)}), OPTIONS)
    assert report.angle_tolerance is not None
    exact = math.cos(pitch) < 1e-15 or math.cos(pitch) > 0.01
    assert precision(robot).angle <= report.angle_tolerance < (1.1e-12 if exact else 1e-7)


def test_missing_command_names_the_packages(request_for: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without sdformat's command the error says what to install, before a run and in it."""
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    for call in (lambda: LOADER.require(OPTIONS), lambda: LOADER.open(request_for(), OPTIONS)):
        with pytest.raises(MissingProgramError, match="apt-get install ignition-tools libsdformat-dev"):
            call()


def test_command_without_sdformat_is_passed_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A `gz` that knows no `sdf`, as of a Gazebo without its libraries, is not taken for sdformat."""
    command = tmp_path / "gz"
    command.write_text("#!/bin/sh\necho 'I cannot find any available command'\n")
    command.chmod(0o755)
    real = shutil.which
    monkeypatch.setattr(shutil, "which", lambda name: str(command) if name == "gz" else real(name))
    monkeypatch.setattr(gazebo, "COMMANDS", ("gz",))
    with pytest.raises(MissingProgramError):
        find_command()


def test_a_centre_of_mass_far_from_its_link(cli: Any, tmp_path: Path) -> None:
    """sdformat lumps by way of the link's origin: of a small inertia 11 m from there fewer digits are left."""
    (tmp_path / "far.csv").write_text(
        "# convention: standard\n"
        "a,alpha,d,mass,comx,comy,comz,ixx,iyy,izz,ixy,ixz,iyz\n"
        "0.3,0.7,0.1,1.3,11.1,0.37,-2.3,1e-3,1.2e-3,1.1e-3,1e-5,2e-5,3e-5\n"
        "5.3,0.3,0.2,1.3,-11.1,3.37,-2.3,1e-3,1.2e-3,1.1e-3,1e-5,2e-5,3e-5\n"
    )
    (tmp_path / "run.yaml").write_text(
        "inputs: far.csv\nemitters: [{stage: urdf, options: {profile: gazebo}}]\nloaders: [gazebo]\noutput: out\n"
    )
    cli("run", tmp_path / "run.yaml")
    (arm,) = json.loads((tmp_path / "out" / "report.json").read_text("utf-8"))["manipulators"]
    assert arm["loaders"]["gazebo"]["inertia_error"] < 1e-13
