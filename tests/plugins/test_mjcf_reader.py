"""The reader of MJCF beside MuJoCo: files that the emitter would never write."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest

from dh2urdf.errors import ProofError
from dh2urdf.kinematics import KinematicChain
from dh2urdf.manipulator import JointType
from dh2urdf.robot import Box, Cylinder, Mesh, Sphere
from dh2urdf_plugins.descriptions.description import describe
from dh2urdf_plugins.formats.mjcf.reader import parse_mjcf, read_mjcf

if TYPE_CHECKING:
    from pathlib import Path

FOREIGN = """
<mujoco model="foreign">
  <compiler angle="{angle}" eulerseq="{sequence}"/>
  <default>
    <joint axis="0 2 0" damping="0.3"/>
    <default class="arm"><geom type="box" size="0.1 0.2 0.3"/>
      <default class="hand"><joint axis="1 1 0"/><site pos="0 0 0.1"/></default></default>
  </default>
  <worldbody>
    <geom type="sphere" size="0.01"/>
    <body name="a" pos="0.1 0.2 0.3" euler="10 20 30" childclass="arm">
      <inertial pos="0.01 0 0" quat="1 1 0 0" mass="2" diaginertia="1 2 2.5"/>
      <geom/>
      <joint name="j1" pos="0.1 0 0" ref="15"/>
      <body name="b" pos="0 0 0.4" quat="1 2 3 4">
        <joint name="j2" type="slide" axis="0 0 1" ref="0.1" range="-1 1"/>
        <joint name="j3" class="hand" range="-20 30"/>
        <geom class="arm" contype="0" conaffinity="0" rgba="1 0 0 1"/>
        <geom type="cylinder" size="0.1 0.2" euler="90 0 0"/>
        <body name="c" pos="0.2 0 0">
          <inertial pos="0 0 0" mass="1" fullinertia="1 1 1 0.1 0 0"/>
          <joint name="j4" pos="0 0.1 0.2" actuatorfrcrange="-5 5" limited="false" range="-1 1"/>
          <site name="tool0" class="hand" euler="0 0 90"/>
          <site name="c"/>
        </body>
      </body>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.mark.parametrize("sequence", ["xyz", "XYZ", "zyx", "ZXz"])
@pytest.mark.parametrize("angle", ["degree", "radian"])
def test_frames_are_where_mujoco_has_them(sequence: str, angle: str) -> None:
    """Degrees, Euler sequences, quaternions, anchors, reference values, several joints of a body, default classes."""
    mujoco = pytest.importorskip("mujoco")
    text = FOREIGN.format(sequence=sequence, angle=angle)
    robot = parse_mjcf(text.encode(), "foreign.xml")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    draw = np.random.default_rng(5)
    for _ in range(5):
        q = dict(zip(("j1", "j2", "j3", "j4"), draw.uniform(-1, 1, 4), strict=True))
        for name, value in q.items():
            data.joint(name).qpos[0] = value
        mujoco.mj_kinematics(model, data)
        for link in ("a", "b", "c", "tool0"):
            chain = KinematicChain.between(robot, "world", link)
            values = [q[joint.name] for joint in chain.joints if joint.type is not JointType.FIXED]
            pose = chain.forward_kinematics(values)
            frame = data.site(link) if link == "tool0" else data.body(link)
            assert np.abs(frame.xpos - pose.translation).max() < 1e-13
            assert np.abs(frame.xmat - pose.rotation).max() < 1e-13


ARM = """<mujoco><default><equality active="false"/><default class="near"><site pos="0.1 0.2 0.3"/></default>
    <default class="far"><site pos="1 2 3"/></default><default class="ends"><site type="capsule" fromto="0 0 1 1 0.5 0" size="0.1"/>
    </default></default><worldbody><body name="a" euler="10 20 30"><inertial pos="0 0 0" mass="1" diaginertia="1 1 1"/>
    <joint name="j" axis="0 1 0"{}/>{}</body></worldbody>{}</mujoco>"""
SITES = {
    "given by its ends": '<site name="s" type="box" size="0.1 0.1 0.1" fromto="0 0 0 1 2 3"/>',
    "given by its ends in a class": '<site name="s" class="ends"/>',
    "pointing down as exactly as an exporter wrote it": '<site name="s" zaxis="6.1e-17 0 -1"/>',
    "in a frame with a class": '<frame class="near"><frame euler="0 10 0"><site name="s"/></frame></frame>',
    "in a frame with a class for what is in it": '<frame class="near" childclass="far"><site name="s"/></frame>',
}


@pytest.mark.parametrize("site", SITES)
def test_a_site_is_where_mujoco_has_it(site: str) -> None:
    """The tip of an arm was in the origin of its body."""
    mujoco = pytest.importorskip("mujoco")
    text = ARM.format("", SITES[site], "")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.joint("j").qpos[0] = 0.7
    mujoco.mj_kinematics(model, data)
    pose = KinematicChain.between(parse_mjcf(text.encode(), "x"), "world", "s").forward_kinematics([0.7])
    assert pose.translation == pytest.approx(data.site("s").xpos, abs=1e-13)
    assert pose.rotation == pytest.approx(data.site("s").xmat, abs=1e-13)


@pytest.mark.parametrize("limited", ["", "true", "false"])
@pytest.mark.parametrize("ends", ["0 0", "1 1", "2 -1", "-1 2"])
@pytest.mark.parametrize(("name", "switch"), [("range", "limited"), ("actuatorfrcrange", "actuatorfrclimited")])
def test_a_range_counts_where_it_counts_in_mujoco(name: str, switch: str, ends: str, limited: str) -> None:
    """One that is empty held the joint at one value, and a force that is not limited was its effort."""
    mujoco = pytest.importorskip("mujoco")
    text = ARM.format(f' {name}="{ends}"' + (f' {switch}="{limited}"' if limited else ""), "", "")
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError:  # limited by an empty range
        return
    (joint,) = parse_mjcf(text.encode(), "x").moving_joints
    counts = (model.jnt_limited if name == "range" else model.jnt_actfrclimited)[0]
    limits = joint.limits
    assert (limits.lower is not None or limits.effort is not None) == counts
    assert (joint.type is JointType.REVOLUTE) == (bool(counts) and name == "range")


def test_constraints_are_those_that_hold(tmp_path: Path) -> None:
    """One that its class switches off made the joint a follower; one of tendons, which couples joints, had no notice."""
    mujoco = pytest.importorskip("mujoco")
    path = tmp_path / "arm.xml"
    for tag, words in (("joint", 'joint1="j"'), ("connect", 'body1="a" anchor="0 0 0"'), ("tendon", 'tendon1="t"')):
        for active in ("", ' active="true"'):
            tendon = '<tendon><fixed name="t"><joint joint="j" coef="1"/></fixed></tendon>' if tag == "tendon" else ""
            path.write_text(ARM.format("", "", f"{tendon}<equality><{tag} {words}{active}/></equality>"))
            found = describe("mjcf", path)
            holds = bool(found.followers or found.notices)
            assert holds == bool(mujoco.MjModel.from_xml_path(str(path)).eq_active0[0])
            assert bool(found.doubly) == (holds and tag == "connect")


def test_what_it_holds() -> None:
    """Types, limits, losses, masses, shapes and colours, defaults included."""
    robot = parse_mjcf(FOREIGN.format(sequence="xyz", angle="degree").encode(), "foreign.xml")
    assert robot.name == "foreign"
    assert robot.root == "world"
    j1, j2, j3, j4 = robot.moving_joints
    assert [joint.type.value for joint in (j1, j2, j3, j4)] == ["continuous", "prismatic", "revolute", "continuous"]
    assert j1.axis == (0.0, 1.0, 0.0)
    assert (j1.damping, j1.friction) == (0.3, None)
    assert (j2.limits.lower, j2.limits.upper) == (-1.0, 1.0)
    assert j3.limits.lower == pytest.approx(np.radians(-20))
    assert j4.limits.effort == 5.0
    links = {link.name: link for link in robot.links}
    a, b = links["a"], links["b"]
    assert a.inertial is not None
    assert a.inertial.mass == 2.0
    # Turned by 90° about x, the second and the third moment change places.
    assert (a.inertial.inertia.iyy, a.inertial.inertia.izz) == pytest.approx((2.5, 2.0))
    assert a.collisions[0].geometry == Box(size=(0.2, 0.4, 0.6))
    assert b.visuals[0].material is not None
    assert b.visuals[0].material.rgba == (1.0, 0.0, 0.0, 1.0)
    assert b.collisions[0].geometry == Cylinder(radius=0.1, length=0.4)
    assert links["world"].collisions[0].geometry == Sphere(radius=0.01)


def test_a_mesh_is_its_file() -> None:
    """With its scale."""
    text = (
        '<mujoco><asset><mesh name="m" file="a.stl" scale="1 2 3"/></asset>'
        '<worldbody><body name="a"><geom type="mesh" mesh="m" mass="0"/></body></worldbody></mujoco>'
    )
    assert parse_mjcf(text.encode(), "x").links[1].collisions[0].geometry == Mesh(
        filename="a.stl", scale=(1.0, 2.0, 3.0)
    )


BODY = '<mujoco><worldbody><body name="a">{}</body></worldbody></mujoco>'


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<mujoco>", "not XML"),
        ("<robot/>", "outermost element is 'robot'"),
        ("<mujoco/>", "mujoco lacks worldbody"),
        ('<mujoco><include file="other.xml"/><worldbody/></mujoco>', "include is not read"),
        (BODY.format("").replace("<w", '<compiler coordinate="global"/><w', 1), "poses are not given in the bodies"),
        (BODY.format('<freejoint name="f"/>'), "'floating' is not one of a manipulator"),
        (BODY.format('<joint type="ball"/>'), "'ball' is not one of a manipulator"),
        (BODY.format('<joint type="screw"/>'), "no joint type 'screw'"),
        (BODY.format('<joint axis="0 0 0"/>'), "has no length"),
        (BODY.format('<joint axis="0 nan 0"/>'), "axis of joint is '0 nan 0'"),
        (BODY.format('<joint axis="0 1"/>'), "axis of joint is '0 1'"),
        (BODY.format('<joint axis="0 1_0 0"/>'), "axis of joint is"),
        (BODY.format('<geom class="x"/>'), "no class 'x'"),
        (BODY.format('<geom type="plane" size="1 1 1" mass="0"/>'), "a shape 'plane' is not read"),
        (BODY.format('<geom type="ellipsoid" size="1 2 1" mass="0"/>'), "a shape 'ellipsoid' is not read"),
        (BODY.format('<geom size="1" shellinertia="true"/>'), "a mass that follows from a mesh or a shell is not read"),
        (BODY.format('<geom type="capsule" fromto="1 2 3 1 2 3" size="1"/>'), "the same point twice"),
        (BODY.format('<geom type="mesh" mesh="m"/>'), "no mesh 'm'"),
        (BODY.format('<site name="s" zaxis="0 0 0"/>'), "zaxis of site gives no direction"),
        (BODY.format('<site name="s" xyaxes="0.1 0.2 0.3 0.2 0.4 0.6"/>'), "xyaxes of site gives no direction"),
        (BODY.format('<joint axis="1e-9 0 0"/>'), "has no length"),
        (BODY.format('<geom size="1"><site name="s"/></geom>'), "a site is in a geom"),
        (
            BODY.format('<site name="s" euler="0 0 1"/>').replace("<w", '<compiler eulerseq="xw"/><w', 1),
            "eulerseq is 'xw'",
        ),
        (BODY.format('<geom type="capsule" size="0 1"/>'), "size of geom is '0 1'"),
        (BODY.format('<geom type="box" fromto="0 0 0 0 0 1"/>'), "size of geom is ''"),
        (BODY.format('<geom size="1" group="x"/>'), "group of geom is 'x'"),
        (BODY.format("<frame>" * 101 + '<site name="s"/>' + "</frame>" * 101), "more than 100 frames"),
        (BODY.format('<replicate count="2"><geom size="1"/></replicate>'), "replicate is not read"),
    ],
)
def test_what_cannot_be_read_is_refused(text: str, message: str) -> None:
    """What needs MuJoCo's compiler, and what is no MJCF of a manipulator; the error names the file."""
    with pytest.raises(ProofError, match=message) as caught:
        parse_mjcf(text.encode(), "arm.xml")
    mark = caught.value.problems[0].mark
    assert mark is not None
    assert mark.file == "arm.xml"


def test_a_missing_file_is_an_error(tmp_path: Path) -> None:
    """It says that the file cannot be read."""
    with pytest.raises(ProofError, match="cannot be read"):
        read_mjcf(tmp_path / "none.xml")
