"""What files hold besides the links and joints of a robot: a notice names it, or the table takes what it has a place for."""

from pathlib import Path

import pytest

import dh2urdf
from dh2urdf_plugins.formats import foreign_urdf

URDF, SDF, MJCF = (
    (Path(__file__).parent / "files" / f"left_out.{suffix}").read_text("utf-8") for suffix in ("urdf", "sdf", "xml")
)


def noticed(path: Path, text: str) -> tuple[dh2urdf.Manipulator, list[str]]:
    """The manipulator of a file, and its notices that have a line."""
    path.write_text(text)
    arm = dh2urdf.extract(path)
    return arm, [f"{each.mark.line} {each.message}" for each in arm.notices if each.mark and each.mark.line]


def test_a_urdf(tmp_path: Path) -> None:
    """Soft limits, calibrations, motors and sensors were left out without a word."""
    assert noticed(tmp_path / "arm.urdf", URDF)[1] == [
        "11 the element transmission is left out, in 2 places (lines 11, 12)",
        "13 the element gazebo is left out",
        "14 the element ros2_control is left out",
        "5 the element sensor of a link is left out",
        "9 the element safety_controller of a joint is left out",
        "9 the element calibration of a joint is left out",
        "8 the attribute deceleration of a limit is left out",
        "8 the attribute spring_stiffness of a dynamics is left out",
    ]
    assert foreign_urdf(tmp_path / "arm.urdf").notices == ()  # A picture leaves nothing out that it could have.


def test_an_sdf(tmp_path: Path) -> None:
    """Those of the model that is read."""
    assert noticed(tmp_path / "m.sdf", SDF)[1] == [
        "7 a model besides the first one is left out",
        "6 the element plugin is left out",
        "2 the element sensor of a link is left out",
        "5 the element sensor of a joint is left out",
        "4 the spring of a joint is left out",
    ]


def test_an_mjcf(tmp_path: Path) -> None:
    """The efforts of joints are those that MuJoCo's actuators reach; where two drive a joint, none is taken."""
    mujoco = pytest.importorskip("mujoco")
    arm, notices = noticed(tmp_path / "arm.xml", MJCF)
    assert notices == [
        "11 an actuator, but for the effort of its joint, is left out, in 7 places (lines 11, 11, 12, 13, 13 and 2 more)",
        "14 a sensor is left out, in 2 places (lines 14, 14)",
        "10 a tendon is left out",
        "15 a keyframe is left out",
        "3 a camera is left out",
        "4 the spring of a joint is left out",
    ]
    model = mujoco.MjModel.from_xml_path(str(tmp_path / "arm.xml"))
    reach = {}
    for name in "abc":
        actuator = model.actuator(name)
        limits = model.actuator_ctrlrange if name == "b" else model.actuator_forcerange
        reach[name] = abs(actuator.gear[0]) * abs(limits[actuator.id]).max()
    efforts = {row.joint: row.limits.effort for row in arm.rows}
    assert (
        efforts
        == {**reach, "d": None, "e": None, "f": 4.0}
        == {"a": 87, "b": 50, "c": 24, "d": None, "e": None, "f": 4}
    )
