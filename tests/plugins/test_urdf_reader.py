from __future__ import annotations

import math
from typing import TYPE_CHECKING

import pytest

from dh2urdf.errors import ProofError
from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.robot import Box, Cylinder, Inertial, Material, Mesh, Origin, Robot, Sphere
from dh2urdf_plugins.formats.mjcf.reader import parse_mjcf
from dh2urdf_plugins.formats.sdf.reader import parse_sdf
from dh2urdf_plugins.formats.urdf.reader import parse_urdf, read_urdf

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

ARM = """<?xml version="1.0"?>
<robot name="arm">
  <!-- a comment -->
  <gazebo reference="upper"><material>Gazebo/Orange</material></gazebo>
  <material name="orange"><color rgba="1 0.5 0 1"/></material>
  <link name="base"/>
  <link name="upper">
    <visual name="shown"><geometry><box size="1 2 3"/></geometry><material name="orange"/></visual>
    <visual>
      <origin xyz=" 1e-3  -2 +.5 "/>
      <geometry><cylinder length="2" radius="0.25"/></geometry>
      <material name="green"><color rgba="0 1 0 0.5"/></material>
    </visual>
    <visual><geometry><mesh filename="package://arm/upper.stl"/></geometry><material name="green"/></visual>
    <collision><origin rpy="0 0 1"/><geometry><sphere radius="0.125"/></geometry></collision>
    <collision><geometry><mesh filename="a.dae" scale="0.1 0.1 0.2"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/>
    <limit effort="5" velocity="2"/>
    <dynamics friction="0.25"/>
  </joint>
  <transmission name="t"/>
</robot>
"""


def arm(text: str = ARM) -> Robot:
    return parse_urdf(text.encode(), "arm.urdf")


def refusal(text: str) -> str:
    with pytest.raises(ProofError) as caught:
        arm(text)
    return str(caught.value)


def test_shapes_origins_and_colours_are_read() -> None:
    """Each shape has its sizes and place, and the colour of the material that it defines or names."""
    upper = arm().links[1]
    assert [visual.geometry for visual in upper.visuals] == [
        Box(size=(1, 2, 3)),
        Cylinder(radius=0.25, length=2),
        Mesh(filename="package://arm/upper.stl"),
    ]
    assert upper.visuals[1].origin == Origin(xyz=(0.001, -2, 0.5))
    green = Material(name="green", rgba=(0, 1, 0, 0.5))
    assert [visual.material for visual in upper.visuals] == [Material(name="orange", rgba=(1, 0.5, 0, 1)), green, green]
    assert [collision.geometry for collision in upper.collisions] == [
        Sphere(radius=0.125),
        Mesh(filename="a.dae", scale=(0.1, 0.1, 0.2)),
    ]
    assert upper.collisions[0].origin.rpy == (0, 0, 1)


def test_what_a_joint_leaves_out_has_the_defaults_of_urdf() -> None:
    """No axis is x, no origin is the parent's frame; what has no default stays unknown."""
    (joint,) = arm().joints
    assert (joint.type, joint.parent, joint.child) == (JointType.REVOLUTE, "base", "upper")
    assert joint.axis == (1, 0, 0)
    assert joint.origin == Origin()
    assert joint.limits == Limits(effort=5, velocity=2)
    assert (joint.damping, joint.friction) == (None, 0.25)
    assert str(joint.mark) == "arm.urdf:18"


def test_an_inertia_in_turned_axes_is_turned_into_those_of_the_link() -> None:
    """A quarter turn about z swaps the moments about x and y and turns the sign of their product."""
    inertial = f"""<inertial><origin xyz="1 2 3" rpy="0 0 {math.pi / 2}"/><mass value="4"/>
        <inertia ixx="1" iyy="2" izz="3" ixy="0.1" ixz="0.2" iyz="0.3"/></inertial>"""
    robot = arm(ARM.replace('<link name="base"/>', f'<link name="base">{inertial}</link>'))
    assert robot.links[0].inertial == Inertial(
        mass=4, com=(1, 2, 3), inertia=Inertia(ixx=2, iyy=1, izz=3, ixy=-0.1, ixz=-0.3, iyz=0.2)
    )


def test_a_file_is_read_by_its_path(tmp_path: Path) -> None:
    """The encoding is the one that the file declares."""
    path = tmp_path / "arm.urdf"
    text = ARM.replace('version="1.0"', 'version="1.0" encoding="ISO-8859-1"').replace('"arm"', '"bräs"')
    path.write_bytes(text.encode("latin-1"))
    assert read_urdf(path).name == "bräs"


def test_a_missing_file_is_an_error_with_its_path(tmp_path: Path) -> None:
    """The message names the file and the reason."""
    with pytest.raises(ProofError, match=r"none\.urdf: error: the file cannot be read: No such file"):
        read_urdf(tmp_path / "none.urdf")


@pytest.mark.parametrize(
    ("found", "written", "message"),
    [
        ("</robot>", "", "error: this is not XML: "),
        ("<robot name", "<robots name", "this is not XML"),
        ('<robot name="arm">', "<robot>", "arm.urdf:2: error: robot lacks the attribute name"),
        ('type="revolute"', 'type="floating"', "arm.urdf:18: error: joint type 'floating' is not one of a manipulator"),
        ('<parent link="base"/>', "", "arm.urdf:18: error: joint lacks parent"),
        ("1 2 3", "1 2", "arm.urdf:8: error: size of box is '1 2'\n    accepted: 3 finite numbers"),
        ("1 2 3", "1 2 nan", "size of box is '1 2 nan'"),
        ("1 2 3", "1 2 1_0", "size of box is '1 2 1_0'"),
        ("1 2 3", "1 2 1e999", "size of box is '1 2 1e999'"),
        ('length="2"', 'length="two"', "arm.urdf:11: error: length of cylinder is 'two'\n    accepted: one finite"),
        ('length="2"', "", "cylinder lacks the attribute length"),
        ('<sphere radius="0.125"/>', "<torus/>", "arm.urdf:15: error: a shape 'torus' is not read here"),
        ('<sphere radius="0.125"/>', "", "the geometry has no shape\n    accepted: box, cylinder, sphere"),
        ('<material name="orange"/>', '<material name="red"/>', "arm.urdf:8: error: material 'red' is defined nowhere"),
    ],
)
def test_what_is_not_a_robot_is_refused_with_its_line(found: str, written: str, message: str) -> None:
    """The message says where and what, and no default replaces what cannot be read."""
    assert found in ARM
    assert message in refusal(ARM.replace(found, written, 1))


def test_another_document_is_refused() -> None:
    """A world or a launch file is no robot description."""
    assert "the outermost element is 'sdf'\n    accepted: robot" in refusal("<sdf/>")


def test_entities_are_refused(tmp_path: Path) -> None:
    """A description that asks the parser for other files, or to grow without bound, is not read."""
    secret = tmp_path / "secret"
    secret.write_text("secret")
    outer = f'<!DOCTYPE robot [<!ENTITY e SYSTEM "{secret.as_uri()}">]><robot name="r">&e;</robot>'
    assert "it has a document type (<!DOCTYPE>)\n    accepted: XML in UTF-8" in refusal(outer)
    levels = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(12))
    bomb = f'<!DOCTYPE robot [<!ENTITY e0 "ha">{levels}]><robot name="&e12;"/>'
    assert "error" in refusal(bomb)


def test_a_thousand_joints_are_read() -> None:
    """Nothing recurses over the chain."""
    links = "".join(f'<link name="l{i}"/>' for i in range(1001))
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="l{i}"/><child link="l{i + 1}"/></joint>' for i in range(1000)
    )
    assert len(arm(f'<robot name="long">{links}{joints}</robot>').joints) == 1000


@pytest.mark.parametrize("fault", [b"<!-- a -- b -->", b"<gz:a/>"])
@pytest.mark.parametrize("written", [parse_urdf, parse_sdf, parse_mjcf])
def test_what_is_written_has_to_be_xml(written: Callable[[bytes, str], Robot], fault: bytes) -> None:
    """Foreign files are read with faults that simulators take; a proof takes none."""
    with pytest.raises(ProofError, match=r"this is not XML[^\n]*\n    accepted: a robot description in XML"):
        written(b"<robot>" + fault + b"</robot>", "arm")
