import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from dh2urdf.errors import ProofError
from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.robot import Box, Cylinder, Inertial, Material, Mesh, Origin, Robot, Sphere
from dh2urdf_plugins.formats.mjcf.reader import parse_mjcf
from dh2urdf_plugins.formats.sdf.reader import parse_sdf
from dh2urdf_plugins.formats.urdf.reader import parse_urdf, read_urdf

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
    with pytest.raises(ProofError) as caught:
        read_urdf(tmp_path / "none.urdf")
    assert [problem.code for problem in caught.value.problems] == ["description-unreadable"]


MJCF_BODY = '<mujoco><worldbody><body name="a">{}</body></worldbody></mujoco>'
SDF_MODEL = '<sdf version="1.7"><model name="m"><link name="a"/><link name="b"/>{}</model></sdf>'
REFUSED: dict[Any, dict[str, list[str]]] = {
    parse_urdf: {
        "xml-refused": ['<!DOCTYPE robot [<!ENTITY e SYSTEM "file:///etc/hostname">]><robot name="r">&e;</robot>'],
        "not-xml": [ARM.replace("</robot>", "")],
        "root-element-other": ["<sdf/>"],
        "attribute-missing": [ARM.replace('length="2"', "")],
        "joint-type-foreign": [ARM.replace('"revolute"', '"floating"')],
        "element-missing": [ARM.replace('<parent link="base"/>', "")],
        "numbers-wrong": [ARM.replace("1 2 3", text) for text in ("1 2", "1 2 nan", "1 2 1_0", "1 2 1e999", "1 2 two")],
        "not-read": [ARM.replace('<sphere radius="0.125"/>', "<torus/>")],
        "geometry-unknown": [ARM.replace('<sphere radius="0.125"/>', "")],
        "material-undefined": [ARM.replace('<material name="orange"/>', '<material name="red"/>')],
    },
    parse_sdf: {
        "no-model": ["<robot/>"],
        "numbers-wrong": [SDF_MODEL.format('<frame name="f"><pose>0 0 0 inf 0 0</pose></frame>')],
        "frame-of-itself": [
            SDF_MODEL.format('<frame name="f" attached_to="f"/>'),
            SDF_MODEL.format('<frame name="f" attached_to="g"/><frame name="g" attached_to="f"/>'),
        ],
        "pose-of-itself": [
            SDF_MODEL.format(
                '<frame name="f" attached_to="a"><pose relative_to="g">0 0 0 0 0 0</pose></frame>'
                '<frame name="g" attached_to="b"><pose relative_to="f">0 0 0 0 0 0</pose></frame>'
            )
        ],
        "joint-type-foreign": [
            SDF_MODEL.format('<joint name="j" type="ball"><parent>a</parent><child>b</child></joint>')
        ],
    },
    parse_mjcf: {
        "coordinates-not-local": [MJCF_BODY.format("").replace("<w", '<compiler coordinate="global"/><w', 1)],
        "joint-type-foreign": [MJCF_BODY.format('<joint type="ball"/>'), MJCF_BODY.format("<body><freejoint/></body>")],
        "axis-of-length-0": [MJCF_BODY.format('<joint axis="1e-9 0 0"/>')],
        "numbers-wrong": [MJCF_BODY.format('<joint axis="0 1_0 0"/>')],
        "not-read": [
            MJCF_BODY.format('<geom type="plane" size="1 1 1" mass="0"/>'),
            MJCF_BODY.format('<geom size="1" shellinertia="true"/>'),
            MJCF_BODY.format('<replicate count="2"><geom size="1"/></replicate>'),
        ],
        "fromto-of-one-point": [MJCF_BODY.format('<geom type="capsule" fromto="1 2 3 1 2 3" size="1"/>')],
        "mesh-undefined": [MJCF_BODY.format('<geom type="mesh" mesh="m"/>')],
        "vector-of-length-0": [MJCF_BODY.format('<site name="s" xyaxes="0.1 0.2 0.3 0.2 0.4 0.6"/>')],
        "element-misplaced": [MJCF_BODY.format('<geom size="1"><site name="s"/></geom>')],
        "geom-size-wrong": [MJCF_BODY.format('<geom type="box" fromto="0 0 0 0 0 1"/>')],
        "frames-too-deep": [MJCF_BODY.format("<frame>" * 101 + '<site name="s"/>' + "</frame>" * 101)],
    },
}


@pytest.mark.parametrize(
    ("parse", "code", "text"),
    [(parse, code, text) for parse, codes in REFUSED.items() for code, texts in codes.items() for text in texts],
)
def test_what_is_no_manipulator_is_refused(parse: Callable[[bytes, str], Robot], code: str, text: str) -> None:
    """No default replaces what cannot be read, and no parser is asked for other files or to grow without bound."""
    with pytest.raises(ProofError) as caught:
        parse(text.encode(), "arm.xml")
    (problem,) = caught.value.problems
    assert (problem.code, problem.mark and problem.mark.file) == (code, "arm.xml")


def test_a_document_that_grows_without_bound_is_refused() -> None:
    levels = "".join(f'<!ENTITY e{i + 1} "{f"&e{i};" * 10}">' for i in range(12))
    with pytest.raises(ProofError):
        arm(f'<!DOCTYPE robot [<!ENTITY e0 "ha">{levels}]><robot name="&e12;"/>')


@pytest.mark.parametrize("fault", [b"<!-- a -- b -->", b"<gz:a/>"])
@pytest.mark.parametrize("written", [parse_urdf, parse_sdf, parse_mjcf])
def test_what_is_written_has_to_be_xml(written: Callable[[bytes, str], Robot], fault: bytes) -> None:
    """Foreign files are read with faults that simulators take; a proof takes none."""
    with pytest.raises(ProofError) as caught:
        written(b"<robot>" + fault + b"</robot>", "arm")
    assert caught.value.problems[0].code == "not-xml"
