"""A sound SDF and a sound MJCF, and each with the fault of every rule that `dh2urdf check` has for them."""

from __future__ import annotations

import struct
from typing import TYPE_CHECKING

from dh2urdf_check.models import model_rules

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf_check.rules import Proof

SDF = """<?xml version="1.0"?>
<sdf version="1.7">
  <model name="arm">
    <link name="base">
      <inertial>
        <mass>3</mass>
        <inertia><ixx>0.02</ixx><ixy>0</ixy><ixz>0</ixz><iyy>0.02</iyy><iyz>0</iyz><izz>0.02</izz></inertia>
      </inertial>
    </link>
    <link name="arm_1">
      <pose>0 0 0.1 0 0 0</pose>
      <inertial>
        <pose>0.1 0 0 0 0 0</pose>
        <mass>1</mass>
        <inertia><ixx>0.005</ixx><ixy>0</ixy><ixz>0</ixz><iyy>0.006</iyy><iyz>0</iyz><izz>0.007</izz></inertia>
      </inertial>
      <visual name="shape">
        <geometry><box><size>0.2 0.05 0.05</size></box></geometry>
      </visual>
    </link>
    <joint name="elbow" type="revolute">
      <parent>base</parent>
      <child>arm_1</child>
      <axis>
        <xyz>0 0 1</xyz>
        <limit><lower>-1</lower><upper>2</upper><effort>20</effort><velocity>3</velocity></limit>
      </axis>
    </joint>
    <link name="arm_2">
      <pose>0.2 0 0.1 0 0 0</pose>
      <inertial>
        <mass>0.5</mass>
        <inertia><ixx>0.001</ixx><ixy>0</ixy><ixz>0</ixz><iyy>0.001</iyy><iyz>0</iyz><izz>0.001</izz></inertia>
      </inertial>
    </link>
    <joint name="slide" type="prismatic">
      <parent>arm_1</parent>
      <child>arm_2</child>
      <axis>
        <xyz>1 0 0</xyz>
        <limit><lower>0</lower><upper>0.3</upper><effort>9</effort><velocity>1</velocity></limit>
      </axis>
    </joint>
  </model>
</sdf>
"""

MJCF = """<?xml version="1.0"?>
<mujoco model="arm">
  <compiler angle="radian"/>
  <default>
    <default class="drive">
      <joint damping="0.1"/>
    </default>
  </default>
  <asset>
    <material name="grey" rgba="0.5 0.5 0.5 1"/>
    <mesh name="part" file="part.obj"/>
  </asset>
  <worldbody>
    <body name="base">
      <inertial pos="0 0 0" mass="3" diaginertia="0.02 0.02 0.02"/>
      <body name="arm_1" pos="0 0 0.1">
        <inertial pos="0.1 0 0" mass="1" diaginertia="0.005 0.006 0.007"/>
        <joint name="elbow" class="drive" type="hinge" axis="0 0 1" limited="true" range="-1 2"/>
        <geom name="shape" type="box" size="0.1 0.025 0.025" material="grey"/>
        <geom type="mesh" mesh="part"/>
        <body name="arm_2" pos="0.2 0 0">
          <inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
          <joint name="slide" type="slide" axis="1 0 0" limited="true" range="0 0.3"/>
          <geom type="sphere" size="0.02"/>
        </body>
      </body>
    </body>
  </worldbody>
  <contact>
    <exclude body1="base" body2="arm_1"/>
  </contact>
  <actuator>
    <position name="elbow" joint="elbow" kp="100" ctrlrange="-2 2"/>
  </actuator>
</mujoco>
"""


def faulty(sound: str, proof: Proof) -> str:
    """The text of a sound model with the fault of a proof; `ALL` of it may be another text."""
    if proof.old == "ALL":
        return proof.new
    if proof.old not in sound:
        raise ValueError(f"{proof.old!r} is not there")
    return sound.replace(proof.old, proof.new, 1)


def line_of(sound: str, proof: Proof) -> int:
    """The line of the finding: with the text of the proof, at the change or before it, or else after it."""
    text, start = faulty(sound, proof), 0 if proof.old == "ALL" else sound.index(proof.old)
    place = text.rfind(proof.at, 0, start + max(len(proof.new), len(proof.at)))
    return text.count("\n", 0, place if place >= 0 else text.index(proof.at)) + 1


SOUND = {"sdf": SDF, "mjcf": MJCF}
PROOFS = {rule.name: rule.proof for name in SOUND for rule in model_rules(name).values() if rule.proof}
"""By rule, the substitution that breaks it."""


def write_models(folder: Path) -> dict[str, Path]:
    """The sound files, as ``sdf`` and ``mjcf``, and every faulty one by its rule, with a mesh beside them."""
    corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
    faces = [(1, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4)]
    obj = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in faces]
    (folder / "part.obj").write_text("\n".join(obj) + "\n")
    (folder / "part.glb").write_text("glTF")
    (folder / "pointer.obj").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n")
    (folder / "part.stl").write_bytes(bytes(80) + struct.pack("<I", 4) + 4 * bytes(50))
    paths = {}
    for name, suffix in (("sdf", ".sdf"), ("mjcf", ".xml")):
        faults = {rule: faulty(SOUND[name], proof) for rule, proof in PROOFS.items() if rule.startswith(name)}
        for rule, content in {name: SOUND[name], **faults}.items():
            paths[rule] = folder / f"{rule}{suffix}"
            paths[rule].write_text(content)
    return paths
