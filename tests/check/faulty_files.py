"""A sound robot description, and one that has a single fault for every rule of `dh2urdf check`."""

from __future__ import annotations

import struct
from itertools import pairwise
from typing import TYPE_CHECKING

from dh2urdf_check.rules import Proof

if TYPE_CHECKING:
    from pathlib import Path

SOUND = """<?xml version="1.0" encoding="utf-8"?>
<robot name="arm">
  <mujoco>
    <compiler fusestatic="false" discardvisual="false"/>
  </mujoco>
  <material name="grey">
    <color rgba="0.5 0.5 0.5 1"/>
  </material>
  <link name="base_link"/>
  <link name="base_link_inertia">
    <inertial>
      <origin xyz="0 0 0.05" rpy="0 0 0"/>
      <mass value="3"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
    </inertial>
  </link>
  <link name="link_1">
    <inertial>
      <origin xyz="0.1 0 0.05" rpy="0 0 0"/>
      <mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
    </inertial>
    <visual>
      <origin xyz="0.1 0 0" rpy="0 0 0"/>
      <geometry>
        <box size="0.1 0.05 0.05"/>
      </geometry>
      <material name="grey"/>
    </visual>
    <collision>
      <origin xyz="0.1 0 0" rpy="0 0 0"/>
      <geometry>
        <cylinder radius="0.02" length="0.05"/>
      </geometry>
    </collision>
  </link>
  <link name="link_2">
    <inertial>
      <origin xyz="0.1 0 0" rpy="0 0 0"/>
      <mass value="1"/>
      <inertia ixx="0.005" ixy="0" ixz="0" iyy="0.006" iyz="0" izz="0.007"/>
    </inertial>
  </link>
  <link name="flange">
    <inertial>
      <mass value="0"/>
      <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>
    </inertial>
  </link>
  <link name="tool0">
    <inertial>
      <mass value="0"/>
      <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>
    </inertial>
  </link>
  <joint name="base_link-base_link_inertia" type="fixed">
    <origin xyz="0 0 0" rpy="0 0 0"/>
    <parent link="base_link"/>
    <child link="base_link_inertia"/>
  </joint>
  <joint name="shoulder" type="revolute">
    <origin xyz="0 0 0.1" rpy="0 0 0"/>
    <parent link="base_link_inertia"/>
    <child link="link_1"/>
    <axis xyz="0 0 1"/>
    <limit lower="-1" upper="1.5" effort="50" velocity="3"/>
  </joint>
  <joint name="elbow" type="revolute">
    <origin xyz="0.3 0 0" rpy="0 0 0"/>
    <parent link="link_1"/>
    <child link="link_2"/>
    <axis xyz="0 1 0"/>
    <limit lower="-2" upper="2" effort="20" velocity="3"/>
  </joint>
  <joint name="link_2-flange" type="fixed">
    <origin xyz="0.2 0 0" rpy="0 0 0"/>
    <parent link="link_2"/>
    <child link="flange"/>
  </joint>
  <joint name="link_2-tool0" type="fixed">
    <origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/>
    <parent link="link_2"/>
    <child link="tool0"/>
  </joint>
</robot>
"""

ELBOW_AXIS = '<axis xyz="0 1 0"/>'
ELBOW_LIMIT = '<limit lower="-2" upper="2" effort="20" velocity="3"/>'
ELBOW_START = """  <joint name="elbow" type="revolute">
    <origin xyz="0.3 0 0" rpy="0 0 0"/>
    <parent link="link_1"/>
"""
ELBOW_END = f"    {ELBOW_AXIS}\n    {ELBOW_LIMIT}\n  </joint>\n"
LINK_2_INERTIA = '<inertia ixx="0.005" ixy="0" ixz="0" iyy="0.006" iyz="0" izz="0.007"/>'
LINK_2_BODY = f"""    <inertial>
      <origin xyz="0.1 0 0" rpy="0 0 0"/>
      <mass value="1"/>
      {LINK_2_INERTIA}
    </inertial>
"""
WEIGHTLESS = """    <inertial>
      <mass value="0"/>
      <inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>
    </inertial>
"""
TOOL0 = f'  <link name="tool0">\n{WEIGHTLESS}  </link>\n'
TOOL0_JOINT = """  <joint name="link_2-tool0" type="fixed">
    <origin xyz="0.2 0 0" rpy="0 1.5707963267948966 0"/>
    <parent link="link_2"/>
    <child link="tool0"/>
  </joint>
"""
BASE_BODY = """    <inertial>
      <origin xyz="0 0 0.05" rpy="0 0 0"/>
      <mass value="3"/>
      <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/>
    </inertial>
"""
BOX = '<box size="0.1 0.05 0.05"/>'
VISUAL = f"""    <visual>
      <origin xyz="0.1 0 0" rpy="0 0 0"/>
      <geometry>
        {BOX}
      </geometry>
      <material name="grey"/>
    </visual>
"""
CYLINDER = '<cylinder radius="0.02" length="0.05"/>'
LINK_1_BODY = """    <inertial>
      <origin xyz="0.1 0 0.05" rpy="0 0 0"/>
      <mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>
    </inertial>
"""
MANY = 140


class Fault(Proof):
    """A fault in the sound description."""

    @property
    def text(self) -> str:
        if SOUND.count(self.old) != 1:
            raise ValueError(f"{self.old!r} occurs {SOUND.count(self.old)} times")
        return SOUND.replace(self.old, self.new)

    @property
    def line(self) -> int:
        place = -1
        for _ in range(self.nth):
            place = self.text.index(self.at, place + 1)
        return self.text.count("\n", 0, place) + 1


def joint(name: str, child: str, *, parent: str = "link_2", kind: str = "fixed", inner: str = "") -> str:
    return f'  <joint name="{name}" type="{kind}">\n    <parent link="{parent}"/>\n    <child link="{child}"/>\n{inner}  </joint>\n'


def body(name: str) -> str:
    return f'  <link name="{name}">\n{LINK_2_BODY}  </link>\n'


def many_joints() -> str:
    inner = '    <axis xyz="0 0 1"/>\n    <limit lower="-1" upper="1" effort="1" velocity="1"/>\n'
    names = ["link_2", *(f"further_{i}" for i in range(MANY))]
    pairs = pairwise(names)
    links = "".join(body(name) for name in names[1:])
    return links + "".join(joint(f"j_{b}", b, parent=a, kind="revolute", inner=inner) for a, b in pairs)


GREY = SOUND[SOUND.index("  <material") : SOUND.index('  <link name="base_link"/>')]
END = "</robot>\n"
LONG_NAME = "n" * 1200

FAULTS: dict[str, Fault] = {
    "not-xml": Fault('  <link name="base_link"/>\n', '  <link name="base_link">\n', "</robot>"),
    "loose-xml": Fault('  <link name="base_link"/>\n', '  <link name="base_link"/>\n  <?note here?>\n', "<?note"),
    "not-strict-xml": Fault(
        '  <link name="base_link"/>\n', '  <!-- base -- inertia -->\n  <link name="base_link"/>\n', "<!-- base"
    ),
    "wrong-encoding": Fault('<robot name="arm">', '<robot name="arm" author="Jos\udce9">', "<robot"),
    "nul-byte": Fault('  <link name="base_link"/>\n', '  <link name="base_link"/>\n\0\n', "\0"),
    "bad-character-reference": Fault('<robot name="arm">', '<robot name="arm" author="&#xZZ;">', "<robot"),
    "carriage-returns": Fault('  <link name="base_link"/>\n', '  <link name="base_link"/>\r', "\r"),
    "robot-not-first": Fault('<robot name="arm">', '<notes/>\n<robot name="arm">', "<notes"),
    "unknown-version": Fault('<robot name="arm">', '<robot name="arm" version="2.0">', "<robot"),
    "not-a-robot": Fault(SOUND, '<?xml version="1.0"?>\n<sdf version="1.9">\n  <model name="arm"/>\n</sdf>\n', "<sdf"),
    "document-type": Fault(
        '<?xml version="1.0" encoding="utf-8"?>\n',
        '<?xml version="1.0" encoding="utf-8"?>\n<!DOCTYPE robot [ <!ENTITY m "1"> ]>\n',
        "<!DOCTYPE",
    ),
    "no-xml-declaration": Fault('<?xml version="1.0" encoding="utf-8"?>\n', "", "<robot"),
    "long-line": Fault('<mass value="1"/>', '<mass value="' + "0" * 8500 + '1"/>', '<mass value="000'),
    "unexpanded-xacro": Fault(
        'effort="20"', 'effort="${2*10}"', "${2*10}", besides=("invalid-number", "misread-number")
    ),
    "xacro-element": Fault(
        '  <link name="base_link"/>\n',
        '  <xacro:property name="a" value="1"/>\n  <link name="base_link"/>\n',
        "<xacro",
        besides=("not-strict-xml",),
    ),
    "robot-without-name": Fault('<robot name="arm">', "<robot>", "<robot"),
    "missing-name": Fault('<joint name="elbow"', "<joint", '<joint type="revolute"'),
    "no-link": Fault(SOUND, '<?xml version="1.0"?>\n<robot name="arm">\n</robot>\n', "<robot"),
    "repeated-element": Fault('<mass value="1"/>', '<mass value="1"/>\n      <mass value="5"/>', '<mass value="5"/>'),
    "unknown-element": Fault(ELBOW_AXIS, f'{ELBOW_AXIS}\n    <limits lower="0"/>', "<limits"),
    "invalid-number": Fault(
        'lower="-2" upper="2"',
        'lower="-2" upper="1,5"',
        '"1,5"',
        besides=("misread-number",),
        of=("mujoco", "pinocchio", "ros", "gazebo", "coppeliasim"),
    ),
    "misread-number": Fault(
        'lower="-2" upper="2"',
        'lower="-2" upper="1,5"',
        '"1,5"',
        besides=("invalid-number",),
        of=("pybullet", "drake"),
    ),
    "invalid-vector": Fault(ELBOW_AXIS, '<axis xyz="1 0"/>', 'xyz="1 0"', besides=("misread-vector",)),
    "misread-vector": Fault(
        '<origin xyz="0.1 0 0" rpy="0 0 0"/>\n      <geometry>\n        <box',
        '<origin xyz="0 0.1" rpy="0 0 0"/>\n      <geometry>\n        <box',
        'xyz="0 0.1"',
        besides=("invalid-vector",),
        of=("pybullet", "pinocchio", "ros", "gazebo"),
    ),
    "duplicate-link": Fault(END, f"{body('link_2')}{END}", '<link name="link_2"', 2),
    "duplicate-joint": Fault('<joint name="link_2-tool0"', '<joint name="elbow"', '<joint name="elbow"', 2),
    "joint-named-like-link": Fault('<joint name="elbow"', '<joint name="link_2"', '<joint name="link_2"'),
    "empty-parent-or-child": Fault('<parent link="link_1"/>', '<parent link=""/>', '<joint name="elbow"'),
    "reserved-name": Fault('<robot name="arm">', '<robot name="world">', "<robot", of=("gazebo",)),
    "name-characters": Fault('<joint name="elbow"', '<joint name="the elbow::1"', "the elbow::1"),
    "name-too-long": Fault('<joint name="elbow"', f'<joint name="{LONG_NAME}"', LONG_NAME),
    "several-roots": Fault(END, f"{body('stray')}{END}", '<link name="stray"'),
    "cycle": Fault(
        END,
        body("one") + body("two") + joint("one-two", "two", parent="one") + joint("two-one", "one", parent="two") + END,
        '<joint name="one-two"',
    ),
    "no-root": Fault(
        END,
        joint("closing", "base_link", kind="continuous", inner=f"    {ELBOW_AXIS}\n") + END,
        '<link name="base_link"',
        besides=("missing-inertial", "continuous-joint"),
    ),
    "cycle-from-root": Fault(
        END,
        joint("closing", "link_1", kind="continuous", inner=f"    {ELBOW_AXIS}\n") + END,
        '<joint name="closing"',
        besides=("continuous-joint",),
    ),
    "several-parents": Fault(END, joint("second", "tool0", parent="link_1") + END, '<joint name="second"'),
    "undefined-link": Fault('<parent link="link_1"/>', '<parent link="link_9"/>', "link_9"),
    "missing-parent-or-child": Fault('    <parent link="link_1"/>\n', "", '<joint name="elbow"'),
    "unknown-joint-type": Fault(
        '<joint name="elbow" type="revolute">', '<joint name="elbow" type="Revolute">', "Revolute"
    ),
    "too-many-joints": Fault(END, many_joints() + END, '<joint name="j_further_119"'),
    "floating-joint": Fault('<joint name="elbow" type="revolute">', '<joint name="elbow" type="floating">', "floating"),
    "planar-joint": Fault('<joint name="elbow" type="revolute">', '<joint name="elbow" type="planar">', "planar"),
    "continuous-joint": Fault(
        f'<joint name="elbow" type="revolute">\n    <origin xyz="0.3 0 0" rpy="0 0 0"/>\n    <parent link="link_1"/>\n    <child link="link_2"/>\n{ELBOW_END}',
        f'<joint name="elbow" type="continuous">\n    <origin xyz="0.3 0 0" rpy="0 0 0"/>\n    <parent link="link_1"/>\n    <child link="link_2"/>\n    {ELBOW_AXIS}\n  </joint>\n',
        "continuous",
    ),
    "mimic-joint": Fault(
        ELBOW_LIMIT, f'{ELBOW_LIMIT}\n    <mimic joint="shoulder" multiplier="2" offset="0"/>', "<mimic"
    ),
    "mimic-undefined": Fault(ELBOW_LIMIT, f'{ELBOW_LIMIT}\n    <mimic joint="shoulders"/>', "<mimic"),
    "mimic-while-fixed": Fault(
        '<child link="tool0"/>', '<child link="tool0"/>\n    <mimic joint="shoulder"/>', "<mimic"
    ),
    "mimic-of-fixed": Fault(ELBOW_LIMIT, f'{ELBOW_LIMIT}\n    <mimic joint="link_2-tool0"/>', "<mimic"),
    "axis-not-unit": Fault(ELBOW_AXIS, '<axis xyz="0 2 0"/>', "0 2 0"),
    "axis-zero": Fault(ELBOW_AXIS, '<axis xyz="0 0 0"/>', '<axis xyz="0 0 0"/>'),
    "axis-without-direction": Fault(ELBOW_AXIS, "<axis/>", "<axis/>"),
    "equal-limits": Fault('lower="-2" upper="2"', 'lower="0" upper="0"', 'lower="0"'),
    "negative-effort": Fault('effort="20"', 'effort="-30"', "-30", of=("mujoco", "pinocchio", "coppeliasim")),
    "negative-velocity": Fault('effort="20" velocity="3"', 'effort="20" velocity="-3"', 'velocity="-3"'),
    "friction-without-value": Fault(
        LINK_2_BODY, f"{LINK_2_BODY}    <contact>\n      <lateral_friction/>\n    </contact>\n", "<lateral"
    ),
    "empty-dynamics": Fault(ELBOW_LIMIT, f"{ELBOW_LIMIT}\n    <dynamics/>", "<dynamics"),
    "negative-damping": Fault(ELBOW_LIMIT, f'{ELBOW_LIMIT}\n    <dynamics damping="-1"/>', "<dynamics"),
    "negative-friction": Fault(
        ELBOW_LIMIT, f'{ELBOW_LIMIT}\n    <dynamics friction="-1"/>', "<dynamics", besides=("joint-friction",)
    ),
    "safety-without-velocity": Fault(ELBOW_LIMIT, f"{ELBOW_LIMIT}\n    <safety_controller/>", "<safety"),
    "mimic-without-joint": Fault(ELBOW_LIMIT, f"{ELBOW_LIMIT}\n    <mimic/>", "<mimic"),
    "calibration-text": Fault(ELBOW_LIMIT, f'{ELBOW_LIMIT}\n    <calibration rising="x"/>', "<calibration"),
    "mimic-without-range": Fault(
        ELBOW_LIMIT,
        '<limit effort="20" velocity="3"/>\n    <mimic joint="shoulder"/>',
        "<mimic",
        besides=("missing-range", "mimic-joint"),
    ),
    "root-merged": Fault(
        SOUND[SOUND.index("    <compiler") : SOUND.index('  <link name="base_link_inertia">')],
        f'    <compiler discardvisual="false"/>\n  </mujoco>\n{GREY}  <link name="base_link">\n{BASE_BODY}  </link>\n',
        '<link name="base_link"',
        besides=("root-with-inertial", "fixed-link"),
    ),
    "mimic-itself": Fault(ELBOW_LIMIT, f'{ELBOW_LIMIT}\n    <mimic joint="elbow"/>', "<mimic"),
    "transmission-incomplete": Fault(
        END, "  <transmission>\n    <type>SimpleTransmission</type>\n  </transmission>\n" + END, "<transmission"
    ),
    "transmission-type-empty": Fault(END, "  <transmission>\n    <type/>\n  </transmission>\n" + END, "<type"),
    "axis-along-minus-z": Fault(ELBOW_AXIS, '<axis xyz="0 0 -1"/>', '<axis xyz="0 0 -1"/>'),
    "missing-axis": Fault(f"    {ELBOW_AXIS}\n", "", '<joint name="elbow"'),
    "missing-limit": Fault(f"    {ELBOW_LIMIT}\n", "", '<joint name="elbow"'),
    "missing-range": Fault('<limit lower="-2" upper="2" effort="20"', '<limit effort="20"', '<limit effort="20"'),
    "missing-effort": Fault(' effort="20"', "", '<limit lower="-2" upper="2" velocity="3"/>'),
    "missing-velocity": Fault(' effort="20" velocity="3"', ' effort="20"', 'effort="20"/>'),
    "swapped-limits": Fault('lower="-2" upper="2"', 'lower="2" upper="-2"', 'lower="2"'),
    "zero-outside-limits": Fault('lower="-2" upper="2"', 'lower="0.5" upper="2"', 'lower="0.5"'),
    "joint-friction": Fault(ELBOW_LIMIT, f'{ELBOW_LIMIT}\n    <dynamics damping="0.1" friction="0.2"/>', "<dynamics"),
    "missing-inertial": Fault(LINK_1_BODY, "", '<link name="link_1"'),
    "nothing-that-weighs": Fault(LINK_2_BODY, "", '<link name="link_2"', besides=("missing-inertial",)),
    "frame-without-inertial": Fault(
        TOOL0,
        f'  <link name="tool0">\n    <collision><geometry>{CYLINDER}</geometry></collision>\n  </link>\n',
        '<link name="tool0"',
        besides=("collision-without-visual",),
    ),
    "zero-mass": Fault('<mass value="1"/>', '<mass value="0"/>', '<mass value="0"/>'),
    "negative-mass": Fault('<mass value="1"/>', '<mass value="-1"/>', '<mass value="-1"/>'),
    "mass-without-inertia": Fault(f"      {LINK_2_INERTIA}\n", "", "<inertial", 3),
    "inertial-without-mass": Fault('      <mass value="1"/>\n', "", "<inertial", 3),
    "zero-inertia": Fault(LINK_2_INERTIA, '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0.0"/>', 'izz="0.0"'),
    "inertia-not-positive-definite": Fault(LINK_2_INERTIA, LINK_2_INERTIA.replace("0.005", "-0.005"), "-0.005"),
    "inertia-triangle-inequality": Fault(LINK_2_INERTIA, LINK_2_INERTIA.replace("0.007", "0.07"), "0.07"),
    "inertia-semidefinite": Fault(
        LINK_2_INERTIA,
        '<inertia ixx="0.005" ixy="0" ixz="0" iyy="0.005" iyz="0" izz="0"/>',
        'iyy="0.005" iyz="0" izz="0"',
    ),
    "root-with-inertial": Fault(
        '<link name="base_link"/>', f'<link name="base_link">\n{BASE_BODY}  </link>', '<link name="base_link"'
    ),
    "weightless-root": Fault(BASE_BODY, "", '<link name="base_link"', besides=("frame-without-inertial",)),
    "weightless-holder": Fault(
        ELBOW_START,
        f'  <link name="frame">\n{WEIGHTLESS}  </link>\n  <joint name="link_1-frame" type="fixed">\n'
        '    <parent link="link_1"/>\n    <child link="frame"/>\n  </joint>\n' + ELBOW_START.replace("link_1", "frame"),
        '<link name="frame"',
    ),
    "weightless-chain": Fault(TOOL0_JOINT, TOOL0_JOINT.replace("link_2", "flange"), '<link name="tool0"'),
    "size-not-positive": Fault(BOX, '<box size="0.1 0 0.05"/>', "<box"),
    "tiny-size": Fault(BOX, '<box size="0.1 0.0005 0.05"/>', "<box"),
    "missing-size": Fault(CYLINDER, '<cylinder radius="0.02"/>', "<cylinder"),
    "missing-geometry": Fault(
        '      <geometry>\n        <box size="0.1 0.05 0.05"/>\n      </geometry>\n', "", "<visual"
    ),
    "unknown-geometry": Fault(BOX, '<cone radius="0.1"/>', "<cone"),
    "capsule": Fault(CYLINDER, '<capsule radius="0.02" length="0.05"/>', "<capsule"),
    "empty-mesh-name": Fault(BOX, '<mesh filename=""/>', "<mesh", of=("pybullet", "mujoco", "gazebo", "coppeliasim")),
    "scale-zero": Fault(BOX, '<mesh filename="part.obj" scale="1 0 1"/>', "<mesh", besides=("relative-mesh",)),
    "colour-out-of-range": Fault(
        '<material name="grey"/>', '<material name="red">\n <color rgba="255 0 0 1"/>\n</material>', "<color", 2
    ),
    "colour-without-components": Fault(
        '<material name="grey"/>', '<material name="red">\n <color/>\n</material>', "<color/>"
    ),
    "missing-texture": Fault(
        '<material name="grey"/>', '<material name="red">\n <texture filename="nowhere.png"/>\n</material>', "<texture"
    ),
    "material-without-colour": Fault(
        '  <link name="base_link"/>\n', '  <material name="red"/>\n  <link name="base_link"/>\n', '<material name="red"'
    ),
    "material-without-name": Fault(
        '      <material name="grey"/>',
        '      <material>\n        <color rgba="1 0 0 1"/>\n      </material>',
        "<material>",
        of=("pybullet", "pinocchio", "ros", "gazebo"),
    ),
    "duplicate-material": Fault(
        '  <link name="base_link"/>\n',
        '  <material name="grey">\n    <color rgba="1 0 0 1"/>\n  </material>\n  <link name="base_link"/>\n',
        '<material name="grey">',
        2,
    ),
    "undefined-material": Fault('<material name="grey"/>', '<material name="gray"/>', "gray"),
    "missing-mesh": Fault(BOX, '<mesh filename="nowhere.stl"/>', "<mesh", besides=("relative-mesh",)),
    "unresolved-package": Fault(BOX, '<mesh filename="package://nowhere/part.stl"/>', "<mesh"),
    "package-address": Fault(
        BOX,
        '<mesh filename="package://robots/part.obj"/>',
        "<mesh",
        of=("mujoco", "pinocchio", "drake", "coppeliasim"),
    ),
    "file-address": Fault(BOX, '<mesh filename="file://FOLDER/part.obj"/>', "<mesh"),
    "mesh-scale": Fault(BOX, '<mesh filename="part.obj" scale="2 2 2"/>', "<mesh", besides=("relative-mesh",)),
    "collision-without-visual": Fault(VISUAL, "", "<collision"),
    "relative-mesh": Fault(BOX, '<mesh filename="part.obj"/>', "<mesh"),
    "mesh-format": Fault(
        BOX, '<mesh filename="part.glb"/>', "<mesh", besides=("relative-mesh",), of=("pybullet", "mujoco")
    ),
    "text-stl": Fault(BOX, '<mesh filename="text.stl"/>', "<mesh", besides=("relative-mesh",)),
    "unreadable-mesh": Fault(
        BOX,
        '<mesh filename="pointer.stl"/>',
        "<mesh",
        besides=("relative-mesh",),
        of=("pybullet", "mujoco", "pinocchio", "ros", "gazebo", "coppeliasim"),
    ),
    "hollow-mesh": Fault(BOX, '<mesh filename="hollow.dae"/>', "<mesh", besides=("relative-mesh", "mesh-format")),
    "collada-unit": Fault(BOX, '<mesh filename="unit.dae"/>', "<mesh", besides=("relative-mesh", "mesh-format")),
    "mesh-without-volume": Fault(
        BOX, '<mesh filename="flat.obj"/>', "<mesh", besides=("relative-mesh",), of=("mujoco",)
    ),
    "many-triangles": Fault(BOX, '<mesh filename="many.stl"/>', "<mesh", besides=("relative-mesh",)),
    "fixed-link": Fault(
        '    <compiler fusestatic="false" discardvisual="false"/>\n',
        '    <compiler discardvisual="false"/>\n',
        '<link name="base_link_inertia"',
    ),
}


ELBOW = '<joint name="elbow" type="revolute">'
OTHER = """<link name="more">
    <inertial><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
  </link>
  <joint name="other" type="revolute">
    <parent link="link_2"/><child link="more"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/><mimic joint="elbow"/>"""
IMPLAUSIBLE = {
    "limits-in-degrees": (ELBOW_LIMIT, ELBOW_LIMIT.replace('"-2" upper="2"', '"-180" upper="180"')),
    "angles-in-degrees": ('rpy="0 1.5707963267948966 0"', 'rpy="0 90 0"'),
    "length-in-millimetres": (BOX, '<box size="100 50 50"/>'),
    "inertia-of-a-larger-body": (LINK_1_BODY, LINK_1_BODY.replace("0.01", "10")),
    "centre-of-mass-far-off": (LINK_1_BODY, LINK_1_BODY.replace("0.1 0 0.05", "100 0 50")),
    "zero-velocity": (ELBOW_LIMIT, ELBOW_LIMIT.replace('velocity="3"', 'velocity="0"')),
    "zero-effort": (ELBOW_LIMIT, ELBOW_LIMIT.replace('effort="20"', 'effort="0"')),
    "mimic-circle": (ELBOW_LIMIT, f'{ELBOW_LIMIT}<mimic joint="other"/></joint>{OTHER}'),
    "unknown-attribute": (ELBOW_AXIS, '<axis xyz="0 1 0"/><dynamics damping="0.1" frictoin="0.2"/>'),
    "reference-to-nothing": (END, f'<gazebo reference="elbows"/>{END}'),
}
"""By rule of the table of plausibility: a text of the sound description, and what is hardly meant in its place."""


COLLADA = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">{asset}
<library_geometries><geometry id="g"><mesh><source id="p"><float_array id="a" count="12">{corners}</float_array>
<technique_common><accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices><triangles count="4">
<input semantic="VERTEX" source="#v" offset="0"/><p>{faces}</p></triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def write_meshes(folder: Path) -> None:
    """A part in the formats that the faults name, and a folder that is empty of it."""
    corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    obj = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in faces]
    (folder / "part.obj").write_text("\n".join(obj) + "\n")
    triangles = [struct.pack("<12fH", 0, 0, 0, *corners[a], *corners[b], *corners[c], 0) for a, b, c in faces]
    (folder / "part.stl").write_bytes(bytes(80) + struct.pack("<I", len(faces)) + b"".join(triangles))
    text = "".join(
        "facet normal 0 0 0\nouter loop\n"
        + "".join("vertex {:g} {:g} {:g}\n".format(*corners[i]) for i in face)
        + "endloop\nendfacet\n"
        for face in faces
    )
    (folder / "text.stl").write_text(f"solid part\n{text}endsolid part\n")
    (folder / "part.glb").write_bytes(b"glTF")
    (folder / "many.stl").write_bytes(bytes(80) + struct.pack("<I", 200_004) + b"".join(triangles) * 50_001)
    (folder / "pointer.stl").write_text(f"version https://git-lfs.github.com/spec/v1\noid sha256:{64 * '0'}\nsize 9\n")
    dae = COLLADA.format(
        asset='<asset><unit meter="0.01"/><up_axis>Z_UP</up_axis></asset>',
        corners=" ".join(str(number) for corner in corners for number in corner),
        faces=" ".join(str(index) for face in faces for index in face),
    )
    (folder / "unit.dae").write_text(dae)
    (folder / "hollow.dae").write_text(dae.replace(' meter="0.01"', ""))
    (folder / "flat.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n")


def write_all(folder: Path) -> dict[str, Path]:
    """The sound file, as ``sound``, and every faulty one, by its rule, with the meshes beside them."""
    folder = folder / "robots"
    folder.mkdir()
    write_meshes(folder)
    texts = {"sound": SOUND} | {rule: fault.text.replace("FOLDER", str(folder)) for rule, fault in FAULTS.items()}
    paths = {name: folder / f"{name}.urdf" for name in texts}
    for name, path in paths.items():
        path.write_bytes(texts[name].encode("utf-8", "surrogateescape"))
    return paths
