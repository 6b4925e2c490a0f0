"""What is true of one simulator alone, or of some: MuJoCo, PyBullet, Pinocchio, Drake and sdformat."""

import math
import re
import shutil
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.errors import CrashError, LoaderError, MissingProgramError
from dh2urdf.kinematics import KinematicChain
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf.robot import Inertial, Link, Origin
from dh2urdf.stages import LoadReport
from dh2urdf_plugins.formats import mjcf, urdf
from dh2urdf_plugins.loaders import gazebo, mujoco, pinocchio
from dh2urdf_plugins.loaders.simulators import LOADERS, PyBulletOptions
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

Run = Callable[..., LoadReport]

# Stretched out along x with the rail at 0.05 m, as the hold test begins, gravity asks of the shoulder [N·m]:
STATIC_LOAD = 9.81 * (2.0 * 0.2 + 1.0 * 0.4 + (0.5 + 0.2) * (0.4 + 0.35 + 0.05))
START = (0.0, 0.0, 0.05, 0.0)


def chain(count: int) -> Any:
    """An arm of that many axes."""
    rows = tuple(DHRow(joint=f"joint_{i}", link=f"link_{i}", a=0.01, alpha=0.3 * i, d=0.01) for i in range(count))
    table = Manipulator(name="long", convention=Convention.STANDARD, rows=rows)
    return TRANSFORM.transform(table, TRANSFORM.options())


@pytest.mark.parametrize(
    ("name", "joints", "accepted"), [("pybullet", 122, 121), ("mujoco", 4, 3), ("pinocchio", 4, 3)]
)
def test_an_arm_that_is_too_long_is_weighed(
    run: Run, request_for: Any, monkeypatch: pytest.MonkeyPatch, *, name: str, joints: int, accepted: int
) -> None:
    """Of more joints than the simulator takes: joints and masses are compared, and a notice names the number."""
    monkeypatch.setenv("MUJOCO_GL", "disable")
    monkeypatch.setattr(mujoco, "HELD_JOINTS", 3)
    monkeypatch.setattr(pinocchio, "MEASURED_JOINTS", 3)
    robot = chain(joints)
    (file,) = urdf.EMITTER.emit(robot, "long", urdf.EMITTER.options())
    report = run(name, request_for(file.content.decode(), robot, poses=(), expected={}), here=True)
    assert len(report.joints) == joints
    assert report.mass == pytest.approx(robot.mass)
    assert report.hold == {}
    (finding,) = report.findings
    assert finding.severity == "notice"
    assert str(finding.found).startswith(f"{joints} moving joints")
    assert str(accepted) in str(finding.accepted)


@pytest.mark.parametrize("name", ["pybullet", "mujoco"])
def test_picture_shows_the_arm(run: Run, request_for: Any, planar: Any, tmp_path: Path, name: str) -> None:
    """The picture has the arm in it, large and whole: it fills much of the height or width and touches no border."""
    image_module = pytest.importorskip("PIL.Image")
    if name == "mujoco" and mujoco.graphics() == "disable":
        pytest.skip("there is neither EGL nor OSMesa")
    text = planar.for_mujoco if name == "mujoco" else planar.urdf
    assert run(name, request_for(text, picture=tmp_path / "planar.png")).picture == "planar.png"
    with image_module.open(tmp_path / "planar.png") as image:
        assert (image.info, image.size) == ({}, (800, 600))
        red, _, blue = image.convert("RGB").split()
    coloured = image_module.merge("RGB", (red, red, blue)).convert("HSV").getchannel("S")  # only the arm is blue
    left, upper, right, lower = coloured.point(lambda value: 255 * (value > 80)).getbbox()
    assert (right - left) / 800 > 0.6 or (lower - upper) / 600 > 0.6
    assert min(left, upper, 800 - right, 600 - lower) > 5
    assert red.getpixel((5, 5)) > 200  # a light background


# --- MuJoCo


@pytest.fixture
def mjcf_text(planar: Any) -> str:
    """The planar arm as MJCF: tool0 is a site, and every joint has a servo."""
    (file,) = mjcf.EMITTER.emit(planar.robot, "planar", mjcf.EMITTER.options())
    return str(file.content.decode())


def test_mjcf_is_confirmed(run: Run, request_for: Any, planar: Any, mjcf_text: str) -> None:
    """The same arm, its tool0 a site, is found right in MJCF too; its own servos hold it and bring it to a target."""
    report = run("mujoco", request_for(mjcf_text))
    assert (report.findings, report.output, report.poses) == ((), "", len(planar.poses))
    assert report.mass == pytest.approx(6.7, rel=1e-15)
    assert report.hold["stayed"] is True
    assert report.hold["target_error"] < 0.005
    assert report.hold["overshoot"] < 0.1
    assert report.hold["largest_speed"] < 8.0
    assert [joint["effort"] for joint in report.joints] == [60.0, 30.0, 50.0, 10.0]


@pytest.mark.parametrize(
    ("written", "instead"), [(r' armature="[^"]*"', ""), (r' kv="[^"]*"', ""), (r'kp="[^"]*"', 'kp="1e-3"')]
)
def test_servos_that_cannot_take_a_step_are_a_finding(
    run: Run, request_for: Any, mjcf_text: str, *, written: str, instead: str
) -> None:
    """Servos hold the arm without armature, without damping, and with hardly any gain, but follow no target."""
    assert re.search(written, mjcf_text)
    report = run("mujoco", request_for(re.sub(written, instead, mjcf_text)))
    assert report.hold["stayed"] is True
    (finding,) = report.findings
    assert (finding.code, finding.severity, finding.field) == ("servos-do-not-follow", "notice", "limits.effort")


@pytest.mark.parametrize(
    ("written", "instead", "code"),
    [
        ('forcerange="-60 60"', 'forcerange="-50 50"', "joint-differs"),
        ('<site name="tool0"/>', '<site name="tool0" pos="0 0 0.001"/>', "tip-elsewhere"),
        ('<site name="tool0"/>', "", "mujoco-fused-links"),
    ],
)
def test_another_mjcf_is_refused(
    run: Run, request_for: Any, mjcf_text: str, *, written: str, instead: str, code: str
) -> None:
    """A weaker actuator, and a site that is elsewhere or nowhere."""
    assert written in mjcf_text
    with pytest.raises(LoaderError) as caught:
        run("mujoco", request_for(mjcf_text.replace(written, instead, 1)), here=True)
    assert [problem.code for problem in caught.value.problems] == [code]


def test_fused_links_are_named(run: Run, request_for: Any, planar: Any) -> None:
    """Without the option that keeps them, MuJoCo fuses fixed links: they are named, and how to keep them."""
    with pytest.raises(LoaderError, match="'base_link', 'base_link_inertia', 'tool0'") as caught:
        run("mujoco", request_for(planar.urdf))
    assert 'fusestatic="false"' in str(caught.value.problems[0].suggestion)


@pytest.mark.parametrize(("share", "stays"), [(1.05, True), (0.95, False)])
def test_an_arm_stays_where_its_efforts_are_above_its_weight(
    run: Run, request_for: Any, planar: Any, *, share: float, stays: bool
) -> None:
    """The hold test tells an effort a little above the static load from one a little below."""
    effort = share * STATIC_LOAD
    text = planar.for_mujoco.replace('effort="60"', f'effort="{effort}"')
    hold = run("mujoco", request_for(text, planar.with_effort(effort))).hold
    assert (hold["stayed"], hold["joint"], hold["start"]) == (stays, "shoulder", START)
    assert (hold["largest_displacement"] > 0.1) is not stays


@pytest.mark.parametrize("library", ["disable", "egl"])
def test_missing_or_broken_graphics_are_a_finding(
    run: Run, request_for: Any, planar: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, *, library: str
) -> None:
    """Where nothing renders, or the library has no device, the arm is measured all the same, and held."""
    monkeypatch.setenv("MUJOCO_GL", library)
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_DIRS", str(tmp_path))
    report = run("mujoco", request_for(planar.for_mujoco, picture=tmp_path / "planar.png"))
    assert (report.picture, (tmp_path / "planar.png").exists()) == (None, False)
    assert report.hold["stayed"] is True
    assert [(finding.code, finding.severity) for finding in report.findings] == [("mujoco-no-picture", "notice")]


# --- PyBullet


def test_single_precision_is_allowed_for(run: Run, request_for: Any, planar: Any) -> None:
    """The tolerance is four roundings of a float of the arm's reach; the root without a body is expected."""
    report: Any = run("pybullet", request_for())
    assert report.position_error > 0.0
    assert report.tolerance == pytest.approx(4 * 2**-23 * planar.reach + 1e-12)
    assert report.angle_tolerance < 2e-6
    assert "No inertial data" in report.output


def test_crash_is_reported(run: Run, request_for: Any, planar: Any) -> None:
    """A duplicate joint name, on which PyBullet crashes, fails this manipulator with a sentence."""
    with pytest.raises(CrashError, match=r"the loader 'pybullet' crashed \(segmentation fault\)"):
        run("pybullet", request_for(planar.urdf.replace('name="elbow"', 'name="shoulder"')))


def test_arm_without_joints_is_confirmed(run: Run, request_for: Any, planar: Any) -> None:
    """A description without moving joints is compared at its one pose; there is nothing to hold."""
    weld = replace(planar.robot.joints[-1], parent="base_link")
    robot = replace(planar.robot, links=(Link(name="base_link"), planar.robot.links[-1]), joints=(weld,))
    text = urdf.EMITTER.emit(robot, "stand", urdf.EMITTER.options())[0].content.decode()
    identity = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    report = run("pybullet", request_for(text, robot, poses=((),), expected={"tool0": (identity,)}))
    assert (report.position_error, report.joints, report.hold, report.findings) == (0.0, (), {}, ())


def test_window_has_no_time_limit() -> None:
    """Where a person closes a window, nobody is taken for hung."""
    (loader,) = (each for each in LOADERS if each.name == "pybullet")
    assert loader.time_limit(PyBulletOptions(gui=True)) is None
    assert loader.time_limit(PyBulletOptions()) is not None


# --- Pinocchio


@pytest.mark.parametrize(("share", "stays"), [(1.001, True), (0.999, False)])
def test_weight_is_held_against_the_efforts(
    run: Run, request_for: Any, planar: Any, *, share: float, stays: bool
) -> None:
    """The largest share of an effort that gravity asks is the shoulder's, at the start; one above 1 is a notice."""
    effort = share * STATIC_LOAD
    text = planar.urdf.replace('effort="60"', f'effort="{effort}"')
    poses = {"poses": planar.poses[:1], "expected": {"tool0": planar.expected[:1]}}
    report = run("pinocchio", request_for(text, planar.with_effort(effort), **poses))
    hold = report.hold
    assert hold["largest_load"] == pytest.approx(1 / share, rel=1e-12)
    assert (hold["joint"], hold["q"], hold["start"], hold["poses"]) == ("shoulder", START, START, 2)
    assert (hold["threshold"], hold["stayed"]) == (1.0, stays)
    found = [(finding.severity, finding.joint, finding.field) for finding in report.findings]
    assert found == ([] if stays else [("notice", "shoulder", "limits.effort")])
    if not stays:
        assert "q = (0.0, 0.0, 0.05, 0.0) gravity asks 13.34 N·m" in report.findings[0].message


# --- Drake


def with_transmissions(text: str, joints: Sequence[str]) -> str:
    parts = [
        f'<transmission name="of_{joint}">\n<type>transmission_interface/SimpleTransmission</type>\n'
        f'<joint name="{joint}"/>\n<actuator name="motor_of_{joint}"/>\n</transmission>\n'
        for joint in joints
    ]
    return text.replace("</robot>", "".join([*parts, "</robot>"]))


def test_joint_without_actuator_is_a_finding(run: Run, request_for: Any, planar: Any) -> None:
    """Drake takes efforts from transmissions only: it names the joints without; with one, the effort is compared."""
    joints = [joint.name for joint in planar.robot.moving_joints]
    for count, named in ((0, "of 4 joints: 'shoulder', 'elbow', 'slide', 'wrist'"), (3, "of 1 joint: 'wrist'")):
        (finding,) = run("drake", request_for(with_transmissions(planar.urdf, joints[:count]))).findings
        assert (finding.code, finding.severity) == ("drake-without-actuators", "notice")
        assert finding.message.endswith(named)
    written = with_transmissions(planar.urdf, joints)
    report = run("drake", request_for(written))
    assert (report.findings, report.hold["stayed"]) == ((), True)
    assert [joint["effort"] for joint in report.joints] == [60.0, 30.0, 50.0, 10.0]
    with pytest.raises(LoaderError, match=r"effort 61\.0 where 60\.0 was written"):
        run("drake", request_for(written.replace('effort="60"', 'effort="61"')), here=True)


def test_arm_without_effort_falls(run: Run, request_for: Any, planar: Any) -> None:
    """A joint whose effort is 0 has no motor in the hold test; Drake takes no actuator without effort."""
    joints = tuple(replace(joint, limits=replace(joint.limits, effort=0.0)) for joint in planar.robot.joints)
    report = run("drake", request_for(planar.urdf, replace(planar.robot, joints=joints)))
    assert report.hold["stayed"] is False


def test_friction_is_a_finding(run: Run, request_for: Any, planar: Any) -> None:
    """What Drake logs is a finding with the line of the file: it takes no joint friction."""
    text = planar.urdf.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/>\n<dynamics friction="0.1"/>', 1)
    line = 1 + text[: text.index("<dynamics")].count("\n")
    printed = [finding.message for finding in run("drake", request_for(text)).findings if finding.code == "printed"]
    assert [f"'line {line}: warning: A joint has specified a non-zero value" in each for each in printed] == [True]


# --- sdformat


def test_lumped_frames_are_a_finding(run: Run, request_for: Any) -> None:
    """Links without mass that sdformat lumps into others are named: tool0 is measured at the link that carries it."""
    report = run("gazebo", request_for())
    assert re.fullmatch(r"\d+\.\d+\.\d+", report.version)
    (finding,) = report.findings
    assert finding.severity == "notice"
    assert finding.message.endswith("lumped into others: 'tool0' (in 'hand')")


def test_lumped_masses_are_those_of_all_parts(run: Run, request_for: Any, planar: Any) -> None:
    """A link is compared with the sum of what it carries: a tool of 0.5 kg, turned and shifted, weighs in the hand."""
    tool = '<origin xyz="0.01 0 0.02"/><mass value="0.5"/><inertia ixx="0.001" ixy="0" ixz="0" iyy="0.002" iyz="0" '
    text = re.sub(r'(<link name="tool0">\s*<inertial>).*?(izz|/>)', rf"\1{tool}izz", planar.urdf, flags=re.DOTALL)
    text = re.sub(r'izz<inertia.*?izz="0"', 'izz="0.0025"', text)
    turned = '<origin xyz="0 0.1 0" rpy="0.3 0 0"/><parent link="hand"/>'
    text = text.replace('<parent link="hand"/>', turned)
    moments = replace(planar.robot.links[1].inertial.inertia, ixx=0.001, iyy=0.002, izz=0.0025)
    body = Inertial(mass=0.5, com=(0.01, 0.0, 0.02), inertia=moments)
    robot = planar.with_joint("hand-tool0", origin=Origin(xyz=(0.0, 0.1, 0.0), rpy=(0.3, 0.0, 0.0)))
    robot = replace(robot, links=(*robot.links[:-1], Link(name="tool0", inertial=body)))
    report: Any = run("gazebo", request_for(text, robot, poses=(), expected={}))
    assert report.mass == pytest.approx(7.2)
    assert report.inertia_error < 1e-15
    with pytest.raises(LoaderError, match="another com of the link 'hand'"):
        run("gazebo", request_for(text.replace('"0.01 0 0.02"', '"0.01 0 0.03"'), robot))


def test_warning_is_a_finding(run: Run, request_for: Any, planar: Any) -> None:
    """What sdformat warns of and fixes, such as swapped limits, is a finding: others may not fix it."""
    text = planar.urdf.replace('lower="-2" upper="2.5"', 'lower="2.5" upper="-2"')
    printed = [finding.message for finding in run("gazebo", request_for(text)).findings if finding.code == "printed"]
    assert ["[shoulder] with limits: " in each for each in printed] == [True]


@pytest.mark.parametrize("pitch", [1.5707963267948966, 1.5707963, 1.57, 1.5])
def test_loss_near_the_singular_pitch_is_foreseen(run: Run, request_for: Any, planar: Any, pitch: float) -> None:
    """It loses digits where a pitch is near ±π/2: as many as the tolerance allows, and no more than half."""
    rpy = (0.2, pitch, 0.3)
    robot = planar.with_joint("elbow", origin=Origin(xyz=(0.4, 0.0, 0.0), rpy=rpy))
    r, t = KinematicChain.between(robot).forward_kinematics(planar.poses[1])
    matrix = (*r[0:3], t[0], *r[3:6], t[1], *r[6:9], t[2], 0.0, 0.0, 0.0, 1.0)
    text = planar.urdf.replace('xyz="0.4 0 0"', f'xyz="0.4 0 0" rpy="{rpy[0]} {pitch!r} {rpy[2]}"')
    request = request_for(text, robot, poses=(planar.poses[1],), expected={"tool0": (matrix,)})
    report: Any = run("gazebo", request, here=True)
    exact = math.cos(pitch) < 1e-15 or math.cos(pitch) > 0.01
    assert gazebo.precision(robot).angle <= report.angle_tolerance < (1.1e-12 if exact else 1e-7)


def test_a_centre_of_mass_far_from_its_link(run: Run, request_for: Any, planar: Any) -> None:
    """sdformat lumps by way of the link's origin: of a small inertia 11 m from there fewer digits are left."""
    far = replace(planar.robot.links[2].inertial, com=(11.1, 0.37, -2.3))
    links = tuple(replace(each, inertial=far) if each.name == "upper_arm" else each for each in planar.robot.links)
    robot = replace(planar.robot, links=links)
    report: Any = run("gazebo", request_for(planar.urdf.replace("0.2 0.01 0", "11.1 0.37 -2.3"), robot))
    assert report.inertia_error < 1e-12


def test_missing_command_names_the_packages(request_for: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without sdformat's command the error says what to install, before a run and in it."""
    (loader,) = (each for each in LOADERS if each.name == "gazebo")
    monkeypatch.setattr(shutil, "which", lambda _name: None)
    for call in (lambda: loader.require(loader.options()), lambda: loader.open(request_for(), loader.options())):
        with pytest.raises(MissingProgramError, match="apt-get install ignition-tools libsdformat-dev"):
            call()


def test_command_without_sdformat_is_passed_over(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A `gz` that knows no `sdf`, as of a Gazebo without its libraries, is not taken for sdformat."""
    command = tmp_path / "gz"
    command.write_text("#!/bin/sh\necho 'I cannot find any available command'\n")
    command.chmod(0o755)
    monkeypatch.setattr(shutil, "which", lambda name: str(command) if name == "gz" else None)
    with pytest.raises(MissingProgramError):
        gazebo.find_command()
