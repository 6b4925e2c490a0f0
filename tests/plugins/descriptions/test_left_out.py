"""What files hold besides the links and joints of a robot: a notice names it, or the table takes what it has a place for."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest

import dh2urdf
from dh2urdf_plugins.formats import foreign_urdf

if TYPE_CHECKING:
    from pathlib import Path

URDF = """<?xml version="1.0"?>
<robot name="arm">
  <mujoco><compiler discardvisual="false"/></mujoco>
  <link name="base"/>
  <link name="arm"><sensor name="eye" type="camera"/></link>
  <joint name="hip" type="revolute">
    <parent link="base"/><child link="arm"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1" acceleration="3"/><dynamics damping="1" spring_stiffness="2"/>
    <safety_controller k_velocity="20" soft_lower_limit="-0.9"/><calibration rising="0.1"/>
  </joint>
  <transmission name="t"><type>simple</type></transmission>
  <transmission name="u"><type>simple</type></transmission>
  <gazebo reference="arm"><sensor name="touch" type="contact"/></gazebo>
  <ros2_control name="drive" type="system"/>
</robot>
"""
SDF = """<sdf version="1.9"><model name="m"><link name="a"/>
  <link name="b"><pose>0 0 1 0 0 0</pose><sensor name="s" type="imu"/></link>
  <joint name="j" type="revolute"><parent>a</parent><child>b</child><axis><xyz>0 0 1</xyz>
    <dynamics><spring_stiffness>3</spring_stiffness></dynamics></axis></joint>
  <joint name="k" type="fixed"><parent>world</parent><child>a</child><sensor name="f" type="force_torque"/></joint>
  <plugin filename="p" name="p"><sensor/></plugin></model>
  <model name="other"><link name="c"><sensor name="s" type="imu"/></link></model></sdf>"""
MJCF = """<mujoco><default><general forcerange="-87 87"/>
    <default class="wrist"><position forcerange="-12 10"/></default><default class="soft"><joint stiffness="2"/></default></default>
  <worldbody><body><joint name="a"/><geom size="1"/><camera name="eye"/>
    <body pos="0 0 1"><joint name="b" axis="0 1 0" class="soft"/><geom size="1"/>
    <body pos="0 0 1"><joint name="c" axis="0 1 0"/><geom size="1"/><site name="s"/>
    <body pos="0 0 1"><joint name="d" axis="0 1 0"/><geom size="1"/>
    <body pos="0 0 1"><joint name="e" axis="0 1 0"/><geom size="1"/>
    <body name="tool0" pos="0 0 1"><joint name="f" axis="0 1 0" actuatorfrcrange="-4 4"/><geom size="1"/>
    </body></body></body></body></body></body></worldbody>
  <tendon><fixed name="t"><joint joint="d" coef="1"/></fixed></tendon>
  <actuator><position name="a" joint="a" kp="10"/><motor name="b" joint="b" gear="-50" ctrlrange="-1 0.5" forcelimited="false"/>
    <position name="c" class="wrist" joint="c" gear="2"/>
    <motor name="d" tendon="t"/><motor joint="e"/><motor joint="e"/><motor joint="f"/></actuator>
  <sensor><jointpos joint="a"/><gyro site="s"/></sensor>
  <keyframe><key qpos="0 0 0 0 0 0"/></keyframe></mujoco>"""


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
        "8 the attribute acceleration of a limit is left out",
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
