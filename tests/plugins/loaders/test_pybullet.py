from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pytest

from dh2urdf.errors import CrashError, LoaderError
from dh2urdf.isolation.loads import load_in_child
from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.robot import Inertial, Joint, Link, Robot
from dh2urdf_plugins.loaders.simulators import LOADERS, PyBulletOptions

LOADER = next(each for each in LOADERS if each.name == "pybullet")

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.stages import LoadReport, LoadRequest

pytest.importorskip("pybullet")

OPTIONS = PyBulletOptions()


def body(mass: float, size: float, **more: Any) -> Inertial:
    return Inertial(mass=mass, inertia=Inertia(ixx=size, iyy=size, izz=size), **more)


def fixed(parent: str, child: str) -> Joint:
    return Joint(name=f"{parent}-{child}", type=JointType.FIXED, parent=parent, child=child)


def run(request: LoadRequest) -> LoadReport:
    return load_in_child(LOADER, request, OPTIONS)


def refusal(request: LoadRequest) -> LoaderError:
    with pytest.raises((LoaderError, CrashError)) as caught:
        run(request)
    return caught.value


def test_single_precision_is_allowed_for(request_for: Any, planar: Any) -> None:
    """The tolerance is four roundings of a float of the arm's reach; the root without a body is expected."""
    report = run(request_for())
    assert report.position_error is not None
    assert report.position_error > 0.0
    assert report.tolerance == pytest.approx(4 * 2**-23 * planar.reach + 1e-12)
    assert report.angle_tolerance is not None
    assert report.angle_tolerance < 2e-6
    assert "No inertial data" in report.output


def test_rewritten_file_is_read_again(request_for: Any, planar: Any) -> None:
    """PyBullet caches files by path: a file rewritten in between is really loaded again, in the same process too."""
    LOADER.open(request_for(), OPTIONS)
    with pytest.raises(LoaderError, match="tool0 in another place"):
        LOADER.open(request_for(planar.urdf.replace('xyz="0.4 0 0"', 'xyz="0.5 0 0"')), OPTIONS)


def test_crash_is_reported(request_for: Any, planar: Any) -> None:
    """A duplicate joint name, on which PyBullet crashes, fails this manipulator with a sentence."""
    error = refusal(request_for(planar.urdf.replace('name="elbow"', 'name="shoulder"')))
    assert "the loader 'pybullet' crashed (segmentation fault)" in str(error)


def test_picture_shows_the_arm(request_for: Any, tmp_path: Path) -> None:
    """The picture has the arm in it, large and whole: it fills much of the height or width and touches no border."""
    image_module = pytest.importorskip("PIL.Image")
    picture = tmp_path / "planar.png"
    assert run(request_for(picture=picture)).picture == "planar.png"
    with image_module.open(picture) as image:
        assert image.info == {}
        grey = image.convert("L")
        assert grey.size == (800, 600)
    dark = grey.point(lambda value: 255 * (value < 180))  # the background and the shadow are lighter
    left, upper, right, lower = dark.getbbox()
    assert (right - left) / 800 > 0.7 or (lower - upper) / 600 > 0.7
    assert min(left, upper, 800 - right, 600 - lower) > 5
    share = dark.histogram()[255] / (800 * 600)
    assert 0.02 < share < 0.5
    assert grey.getextrema()[1] > 240


@pytest.mark.parametrize("count", [122, 140])
def test_more_joints_than_pybullet_takes_is_a_finding(request_for: Any, count: int) -> None:
    """An arm of more joints than PyBullet can move is weighed only; that is said, and fails nothing."""
    links, joints, parts = [Link(name="base_link")], [], ['<robot name="long">', '<link name="base_link"/>']
    names = ["base_link", *(f"link_{number}" for number in range(1, count)), "tool0"]
    for parent, child in pairwise(names):
        limits = Limits(lower=-1.0, upper=1.0, effort=100.0, velocity=1.0)
        joints.append(Joint(name=f"to_{child}", type=JointType.REVOLUTE, parent=parent, child=child, limits=limits))
        links.append(Link(name=child, inertial=body(0.5, 0.001)))
        parts += [
            f'<joint name="to_{child}" type="revolute">',
            f'<parent link="{parent}"/>',
            f'<child link="{child}"/>',
            '<axis xyz="0 0 1"/>',
            '<limit lower="-1" upper="1" effort="100" velocity="1"/>',
            "</joint>",
            f'<link name="{child}">',
            '<inertial>\n<mass value="0.5"/>',
            '<inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/>',
            "</inertial>\n</link>",
        ]
    robot = Robot(name="long", links=tuple(links), joints=tuple(joints))
    report = run(request_for("\n".join([*parts, "</robot>"]), robot, poses=(), expected={}))
    assert len(report.joints) == count
    assert report.mass == pytest.approx(0.5 * count)
    assert report.hold == {}
    (finding,) = report.findings
    assert finding.severity == "notice"
    assert finding.found == f"{count} moving joints, {count} links"


def test_arm_without_joints_is_confirmed(request_for: Any) -> None:
    """A description without moving joints is compared at its one pose; there is nothing to hold."""
    robot = Robot(
        name="stand",
        links=(Link(name="base_link"), Link(name="tool0", inertial=Inertial(mass=0.0))),
        joints=(fixed("base_link", "tool0"),),
    )
    urdf = """<robot name="stand">
  <link name="base_link"/>
  <joint name="base_link-tool0" type="fixed">
    <parent link="base_link"/>
    <child link="tool0"/>
  </joint>
  <link name="tool0">
    <inertial>
      <mass value="0"/>
      <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>
    </inertial>
  </link>
</robot>
"""
    identity = (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
    report = run(request_for(urdf, robot, poses=((),), expected={"tool0": (identity,)}))
    assert (report.position_error, report.joints, report.hold, report.findings) == (0.0, (), {}, ())


def test_window_has_no_time_limit() -> None:
    """Where a person closes a window, nobody is taken for hung."""
    assert LOADER.time_limit(PyBulletOptions(gui=True)) is None
    assert LOADER.time_limit(OPTIONS) is not None
