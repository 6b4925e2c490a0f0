from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import LoaderError
from dh2urdf.isolation.loads import load_in_child
from dh2urdf.manipulator import Convention, DHRow, Manipulator
from dh2urdf_plugins.formats import mjcf
from dh2urdf_plugins.formats.urdf import EMITTER
from dh2urdf_plugins.loaders import mujoco as mujoco_loader
from dh2urdf_plugins.loaders.mujoco import graphics
from dh2urdf_plugins.loaders.simulators import LOADERS, PictureOptions
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

LOADER = next(each for each in LOADERS if each.name == "mujoco")

if TYPE_CHECKING:
    from dh2urdf.stages import LoadReport, LoadRequest

pytest.importorskip("mujoco")

CONFIGS = Path(__file__).parents[3] / "configs"
OPTIONS = PictureOptions()
KEPT = '<robot name="planar">\n  <mujoco>\n    <compiler fusestatic="false" discardvisual="false"/>\n  </mujoco>'


def run(request: LoadRequest) -> LoadReport:
    return load_in_child(LOADER, request, OPTIONS)


def refusal(request: LoadRequest) -> LoaderError:
    with pytest.raises(LoaderError) as caught:
        run(request)
    return caught.value


@pytest.fixture
def urdf(planar: Any) -> str:
    """The planar arm's text, with what keeps MuJoCo from fusing its fixed links."""
    assert planar.urdf.count('<robot name="planar">') == 1
    return str(planar.urdf.replace('<robot name="planar">', KEPT))


@pytest.fixture
def mjcf_text(planar: Any) -> str:
    """The planar arm as MJCF: tool0 is a site, and every joint has a servo."""
    (file,) = mjcf.EMITTER.emit(planar.robot, "planar", mjcf.EMITTER.options())
    return str(file.content.decode())


def test_mjcf_is_confirmed(request_for: Any, planar: Any, mjcf_text: str) -> None:
    """The same arm, its tool0 a site, is found right in MJCF too; its own servos hold it and bring it to a target."""
    report = run(request_for(mjcf_text))
    assert (report.findings, report.output) == ((), "")
    assert report.poses == len(planar.poses)
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
    request_for: Any, mjcf_text: str, written: str, instead: str
) -> None:
    """Servos hold the arm without armature, without damping, and with hardly any gain, but follow no target."""
    assert re.search(written, mjcf_text)
    report = run(request_for(re.sub(written, instead, mjcf_text)))
    assert report.hold["stayed"] is True
    (finding,) = (each for each in report.findings if "do not follow a step" in each.message)
    assert (finding.severity, finding.field) == ("notice", "limits.effort")


@pytest.mark.parametrize(
    ("written", "instead", "message"),
    [
        ('forcerange="-60 60"', 'forcerange="-50 50"', r"effort 50\.0 where 60\.0"),
        ('<site name="tool0"/>', '<site name="tool0" pos="0 0 0.001"/>', r"tool0 in another place, 0\.001 m"),
        ('<site name="tool0"/>', "", "or lost them: 'tool0'"),
    ],
)
def test_another_mjcf_is_refused(request_for: Any, mjcf_text: str, written: str, instead: str, message: str) -> None:
    """A weaker actuator, and a site that is elsewhere or nowhere."""
    assert written in mjcf_text
    with pytest.raises(LoaderError, match=message):
        raise refusal(request_for(mjcf_text.replace(written, instead, 1)))


def test_fused_links_are_named(request_for: Any, planar: Any) -> None:
    """Without the option that keeps them, MuJoCo fuses fixed links: they are named, and how to keep them."""
    (problem,) = refusal(request_for(planar.urdf)).problems
    assert "'base_link', 'base_link_inertia', 'tool0'" in problem.message
    assert 'fusestatic="false"' in str(problem.suggestion)


def with_effort(robot: Any, effort: float) -> Any:
    """The robot with another effort of its shoulder, whose is 60 N·m."""
    joints = tuple(
        replace(joint, limits=replace(joint.limits, effort=effort)) if joint.name == "shoulder" else joint
        for joint in robot.joints
    )
    return replace(robot, joints=joints)


# At the start of the hold test, stretched out along x, gravity asks of the shoulder [N·m]:
STATIC_LOAD = 9.81 * (2.0 * 0.2 + 1.0 * 0.4 + (0.5 + 0.2) * (0.4 + 0.35 + 0.05))


@pytest.mark.parametrize(("share", "stays"), [(1.05, True), (0.95, False)])
def test_an_arm_stays_where_its_efforts_are_above_its_weight(
    request_for: Any, planar: Any, urdf: str, *, share: float, stays: bool
) -> None:
    """The hold test tells an effort a little above the static load from one a little below; the latter is a notice."""
    effort = share * STATIC_LOAD
    request = request_for(urdf.replace('effort="60"', f'effort="{effort}"'), with_effort(planar.robot, effort))
    report = run(request)
    assert report.hold["stayed"] is stays
    assert report.hold["joint"] == "shoulder"
    assert (report.hold["seconds"], report.hold["start"]) == (2.0, (0.0, 0.0, 0.05, 0.0))
    if stays:
        assert 0.0 < report.hold["largest_displacement"] < report.hold["threshold"] == 0.01
        assert report.findings == ()
    else:
        assert report.hold["largest_displacement"] > 0.1
        (finding,) = report.findings
        assert (finding.severity, finding.joint, finding.field) == ("notice", "shoulder", "limits.effort")


def test_long_arm_is_measured_but_not_held(request_for: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """An arm of more joints than the hold test takes is compared all the same; that it was left out is said."""
    monkeypatch.setenv("MUJOCO_GL", "disable")  # which it would set itself
    monkeypatch.setattr(mujoco_loader, "HELD_JOINTS", 3)
    rows = tuple(DHRow(joint=f"joint_{i}", link=f"link_{i}", a=0.2, alpha=0.3 * i, d=0.1) for i in range(1, 5))
    robot = TRANSFORM.transform(
        Manipulator(name="long", convention=Convention.STANDARD, rows=rows), TRANSFORM.options()
    )
    (file,) = EMITTER.emit(robot, "long", EMITTER.options())
    report = LOADER.open(request_for(file.content.decode(), robot, poses=(), expected={}), OPTIONS)
    assert len(report.joints) == 4
    assert report.mass == pytest.approx(robot.mass)
    assert report.hold == {}
    (finding,) = report.findings
    assert (finding.severity, finding.found) == ("notice", "4 moving joints")


@pytest.fixture
def needs_graphics() -> None:
    if graphics() == "disable":
        pytest.skip("there is neither EGL nor OSMesa")


@pytest.mark.usefixtures("needs_graphics")
def test_picture_shows_the_arm(request_for: Any, urdf: str, tmp_path: Path) -> None:
    """The picture has the arm in it, large and whole: it fills much of the height or width and touches no border."""
    image_module = pytest.importorskip("PIL.Image")
    picture = tmp_path / "planar.png"
    report = run(request_for(urdf, picture=picture))
    assert (report.picture, report.findings) == ("planar.png", ())
    with image_module.open(picture) as image:
        assert image.info == {}
        red, _, blue = image.convert("RGB").split()
        assert image.size == (800, 600)
    coloured = image_module.merge("RGB", (red, red, blue)).convert("HSV").getchannel("S")  # only the arm is blue
    left, upper, right, lower = coloured.point(lambda value: 255 * (value > 80)).getbbox()
    assert (right - left) / 800 > 0.6 or (lower - upper) / 600 > 0.6
    assert min(left, upper, 800 - right, 600 - lower) > 5
    assert red.getpixel((5, 5)) > 200  # a light background


def test_no_graphics_is_a_finding(request_for: Any, urdf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing renders, the arm is measured all the same; the missing picture is a notice that says what to do."""
    monkeypatch.setenv("MUJOCO_GL", "disable")
    report = run(request_for(urdf, picture=tmp_path / "planar.png"))
    assert report.picture is None
    assert not (tmp_path / "planar.png").exists()
    assert report.hold["stayed"] is True
    (finding,) = report.findings
    assert finding.severity == "notice"
    assert "took no picture" in finding.message
    assert "libegl1" in str(finding.suggestion)


def test_broken_graphics_are_a_finding(
    request_for: Any, urdf: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A graphics library that is there and has no device fails nothing but the picture."""
    monkeypatch.setenv("MUJOCO_GL", "egl")
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_DIRS", str(tmp_path))
    report = run(request_for(urdf, picture=tmp_path / "planar.png"))
    assert report.picture is None
    assert report.position_error is not None
    assert ["took no picture" in finding.message for finding in report.findings] == [True]
