"""A sound SDF and a sound MJCF, and each with a single fault for every rule that `dh2urdf check` has for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

if TYPE_CHECKING:
    from pathlib import Path

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


class Change(NamedTuple):
    """A fault in a sound model.

    Attributes:
        old: the text that is replaced, at its first occurrence.
        new: what is in its place.
        at: the text that the line of the finding contains: at the change or before it, or else after it.
        besides: other rules that the fault breaks too.
    """

    old: str
    new: str
    at: str
    besides: tuple[str, ...] = ()

    def of(self, sound: str) -> str:
        if self.old not in sound:
            raise ValueError(f"{self.old!r} is not there")
        return sound.replace(self.old, self.new, 1)

    def line(self, sound: str) -> int:
        text, start = self.of(sound), sound.index(self.old)
        place = text.rfind(self.at, 0, start + max(len(self.new), len(self.at)))
        return text.count("\n", 0, place if place >= 0 else text.index(self.at)) + 1


BOX = "<box><size>0.2 0.05 0.05</size></box>"
ELBOW_AXIS = "<xyz>0 0 1</xyz>"
ELBOW_LIMIT = "<limit><lower>-1</lower><upper>2</upper><effort>20</effort><velocity>3</velocity></limit>"
INERTIA = "<ixx>0.005</ixx><ixy>0</ixy><ixz>0</ixz><iyy>0.006</iyy><iyz>0</iyz><izz>0.007</izz>"
LAST_LINK = '<link name="arm_2">'

SHAPE = SDF[SDF.index("<visual") : SDF.index("</visual>")] + "</visual>"

SDF_FAULTS: dict[str, Change] = {
    "sdf-not-xml": Change("</model>", "", "</sdf>"),
    "sdf-not-sdf": Change(SDF, '<?xml version="1.0"?>\n<robot name="arm">\n  <link name="a"/>\n</robot>\n', "<robot"),
    "sdf-no-version": Change('<sdf version="1.7">', "<sdf>", "<sdf>"),
    "sdf-unknown-version": Change('<sdf version="1.7">', '<sdf version="17.1">', "17.1"),
    "sdf-no-model": Change(SDF, '<?xml version="1.0"?>\n<sdf version="1.7">\n</sdf>\n', "<sdf"),
    "sdf-no-link": Change(SDF, '<?xml version="1.0"?>\n<sdf version="1.7">\n  <model name="a"/>\n</sdf>\n', "<model"),
    "sdf-missing-name": Change('<joint name="elbow" type="revolute">', '<joint type="revolute">', "<joint type"),
    "sdf-duplicate-name": Change(
        LAST_LINK, '<link name="arm_1">', '<link name="arm_1">', besides=("sdf-undefined-link",)
    ),
    "sdf-duplicate-part": Change(SHAPE, f"{SHAPE}\n{SHAPE}", '<visual name="shape">'),
    "sdf-several-models": Change(
        "</sdf>", f"  {SDF[SDF.index('<model') : SDF.index('</sdf>')]}</sdf>", '<model name="arm"'
    ),
    "sdf-colour-out-of-range": Change(
        "</geometry>", "</geometry><material><diffuse>200 90 0 1</diffuse></material>", "<diffuse>"
    ),
    "sdf-shared-name": Change('<joint name="elbow"', '<joint name="arm_1"', '<joint name="arm_1"'),
    "sdf-reserved-name": Change(
        '<link name="base">', '<link name="__base__">', "__base__", besides=("sdf-undefined-link",)
    ),
    "sdf-unknown-joint-type": Change('type="revolute"', 'type="hinge"', "hinge"),
    "sdf-missing-parent-or-child": Change("<parent>base</parent>", "", '<joint name="elbow"'),
    "sdf-undefined-link": Change("<child>arm_2</child>", "<child>arm_9</child>", "arm_9"),
    "sdf-undefined-frame": Change("<pose>0.2", '<pose relative_to="arm_9">0.2', "arm_9"),
    "sdf-relative-pose": Change("<pose>0.2 0 0.1", '<pose relative_to="arm_1">0.2 0 0', "relative_to"),
    "sdf-world-parent": Change(
        LAST_LINK,
        f'<joint name="mounting" type="fixed"><parent>world</parent><child>base</child></joint>\n    {LAST_LINK}',
        "<parent>world",
    ),
    "sdf-missing-axis": Change(
        f"<axis>\n        {ELBOW_AXIS}\n        {ELBOW_LIMIT}\n      </axis>", "", '<joint name="elbow"'
    ),
    "sdf-missing-axis-direction": Change(ELBOW_AXIS, "", "<axis>"),
    "sdf-axis-zero": Change(ELBOW_AXIS, "<xyz>0 0 0</xyz>", "<xyz>0 0 0</xyz>"),
    "sdf-axis-not-unit": Change(ELBOW_AXIS, "<xyz>0 0 2</xyz>", "<xyz>0 0 2</xyz>"),
    "sdf-swapped-limits": Change("<lower>-1</lower><upper>2</upper>", "<lower>2</lower><upper>-1</upper>", "<lower>2"),
    "sdf-missing-limit": Change(ELBOW_LIMIT, "", "<axis>"),
    "sdf-missing-inertial": Change(
        """      <inertial>
        <mass>0.5</mass>
        <inertia><ixx>0.001</ixx><ixy>0</ixy><ixz>0</ixz><iyy>0.001</iyy><iyz>0</iyz><izz>0.001</izz></inertia>
      </inertial>
""",
        "",
        LAST_LINK,
    ),
    "sdf-negative-mass": Change("<mass>1</mass>", "<mass>-1</mass>", "<mass>-1"),
    "sdf-zero-mass": Change("<mass>1</mass>", "<mass>0</mass>", "<mass>0"),
    "sdf-inertia-not-positive-definite": Change("<ixx>0.005</ixx>", "<ixx>-0.005</ixx>", "-0.005"),
    "sdf-inertia-triangle-inequality": Change("<izz>0.007</izz>", "<izz>0.7</izz>", "0.7"),
    "sdf-invalid-number": Change("<mass>1</mass>", "<mass>1 kg</mass>", "1 kg"),
    "sdf-invalid-vector": Change("0.2 0 0.1 0 0 0", "0.2 0 0", "0.2 0 0"),
    "sdf-unreadable-value": Change("<mass>1</mass>", "<mass>one</mass>", "one", besides=("sdf-invalid-number",)),
    "sdf-out-of-range": Change(
        "</geometry>",
        "</geometry></visual><collision name='c'>"
        "<geometry><sphere><radius>1</radius></sphere></geometry><surface><friction><ode><mu>-1</mu></ode></friction>"
        "</surface></collision><visual name='other'><geometry><sphere><radius>1</radius></sphere></geometry>",
        "<mu>",
    ),
    "sdf-impossible-number": Change(ELBOW_AXIS, f"{ELBOW_AXIS}<dynamics><damping>-1</damping></dynamics>", "<axis>"),
    "sdf-quaternion-zero": Change(
        "<pose>0.2 0 0.1 0 0 0", '<pose rotation_format="quat_xyzw">0.2 0 0.1 0 0 0 0', "quat_xyzw"
    ),
    "sdf-missing-attribute": Change('<visual name="shape">', "<visual>", "<visual>"),
    "sdf-unknown-type": Change('<visual name="shape">', '<sensor name="s" type="eye"/><visual name="shape">', "eye"),
    "sdf-frame-cycle": Change(LAST_LINK, f'<frame name="f" attached_to="f"/>\n    {LAST_LINK}', "<frame"),
    "sdf-joint-of-one-link": Change(
        "<child>arm_2</child>",
        "<child>arm_1</child>",
        '<joint name="slide"',
        besides=("sdf-cycle", "sdf-several-parents"),
    ),
    "sdf-unsupported-joint-type": Change('type="revolute"', 'type="gearbox"', "gearbox"),
    "sdf-missing-mesh": Change(BOX, "<mesh><uri>nowhere.obj</uri></mesh>", "<uri>"),
    "sdf-missing-geometry": Change(f"<geometry>{BOX}</geometry>", "", "<visual"),
    "sdf-size-not-positive": Change("0.2 0.05 0.05", "0.2 0 0.05", "0.2 0 0.05"),
    "sdf-unknown-element": Change(ELBOW_AXIS, f"{ELBOW_AXIS}<limits/>", "<limits"),
    "sdf-missing-include": Change(
        LAST_LINK, f"<include><uri>model://nowhere</uri></include>\n    {LAST_LINK}", "<uri>"
    ),
    "sdf-several-parents": Change(
        "  </model>",
        '  <joint name="second" type="fixed"><parent>base</parent><child>arm_2</child></joint>\n  </model>',
        "second",
    ),
    "sdf-cycle": Change(
        "  </model>",
        '  <joint name="second" type="fixed"><parent>arm_2</parent><child>base</child></joint>\n  </model>',
        "second",
    ),
}

LAST_JOINT = '<joint name="slide" type="slide" axis="1 0 0" limited="true" range="0 0.3"/>'
MJCF_FAULTS: dict[str, Change] = {
    "mjcf-not-xml": Change("</worldbody>", "", "</mujoco>"),
    "mjcf-not-mujoco": Change(MJCF, '<?xml version="1.0"?>\n<sdf version="1.7">\n</sdf>\n', "<sdf"),
    "mjcf-unknown-element": Change("<contact>", "<contacts/>\n  <contact>", "<contacts"),
    "mjcf-unknown-attribute": Change('damping="0.1"', 'dampings="0.1"', "dampings"),
    "mjcf-model-without-name": Change(' model="arm"', "", "<mujoco"),
    "mjcf-misread-number": Change('pos="0.2 0 0"', 'pos="0.2 0 0x"', "0x", besides=("mjcf-invalid-vector",)),
    "mjcf-out-of-range": Change('damping="0.1"', 'damping="-0.1"', "damping"),
    "mjcf-missing-attribute": Change(
        "</actuator>", '</actuator>\n<equality><connect body1="arm_1"/></equality>', "<equality"
    ),
    "mjcf-negative-number": Change(
        "</actuator>", '</actuator>\n<sensor><jointpos joint="elbow" noise="-1"/></sensor>', "<sensor"
    ),
    "mjcf-direction-zero": Change('pos="0.2 0 0"', 'pos="0.2 0 0" axisangle="0 0 0 1"', "axisangle"),
    "mjcf-mesh-format": Change('file="part.obj"', 'file="part.glb"', "part.glb"),
    "mjcf-unreadable-mesh": Change('file="part.obj"', 'file="pointer.obj"', "pointer.obj"),
    "mjcf-flat-mesh": Change('file="part.obj"', 'file="part.obj" scale="1 1 0"', "part.obj"),
    "mjcf-moving-plane": Change('type="sphere" size="0.02"', 'type="plane" size="1 1 1"', '"plane"'),
    "mjcf-duplicate-body": Change('<body name="arm_2"', '<body name="arm_1"', '<body name="arm_1"'),
    "mjcf-duplicate-joint": Change('name="slide"', 'name="elbow"', '<joint name="elbow"'),
    "mjcf-duplicate-name": Change('<geom type="sphere"', '<geom name="shape" type="sphere"', 'type="sphere"'),
    "mjcf-unknown-joint-type": Change('type="slide"', 'type="prismatic"', "prismatic"),
    "mjcf-unknown-geom-type": Change('type="sphere"', 'type="ball"', "ball"),
    "mjcf-unknown-word": Change('limited="true" range="-1 2"', 'limited="yes" range="-1 2"', '"yes"'),
    "mjcf-free-joint-below": Change(LAST_JOINT, '<joint name="slide" type="free"/>', '"free"'),
    "mjcf-size-not-positive": Change('size="0.1 0.025 0.025"', 'size="0.1 0.025 0"', '"shape"'),
    "mjcf-tendon-path": Change("</actuator>", '</actuator>\n<tendon><fixed name="t"/></tendon>', "<tendon"),
    "mjcf-equality-with-itself": Change(
        "</actuator>",
        '</actuator>\n<equality><connect body1="arm_1" body2="arm_1" anchor="0 0 0"/></equality>',
        "<equality",
    ),
    "mjcf-not-finite": Change(
        '<body name="arm_2" pos="0.2 0 0">',
        '<body name="arm_2" pos="nan 0 0">',
        "nan",
        besides=("mjcf-invalid-vector",),
    ),
    "mjcf-quaternion-zero": Change('pos="0.2 0 0"', 'pos="0.2 0 0" quat="0 0 0 0"', "quat="),
    "mjcf-several-orientations": Change('pos="0.2 0 0"', 'pos="0.2 0 0" quat="1 0 0 0" euler="0 0 1"', "quat="),
    "mjcf-swapped-limits": Change('range="-1 2"', 'range="2 -1"', 'range="2 -1"'),
    "mjcf-equal-limits": Change('range="-1 2"', 'range="1 1"', 'range="1 1"'),
    "mjcf-axis-zero": Change('axis="0 0 1"', 'axis="0 0 0"', 'axis="0 0 0"'),
    "mjcf-axis-not-unit": Change('axis="0 0 1"', 'axis="0 0 2"', 'axis="0 0 2"'),
    "mjcf-swapped-range": Change(
        'limited="true" range="-1 2"', 'range="2 -1"', 'range="2 -1"', besides=("mjcf-range-without-limited",)
    ),
    "mjcf-limited-without-range": Change(' range="-1 2"', "", '<joint name="elbow"'),
    "mjcf-mass-not-positive": Change('mass="1"', 'mass="-1"', 'mass="-1"'),
    "mjcf-inertia-triangle-inequality": Change("0.005 0.006 0.007", "0.005 0.006 0.7", "0.7"),
    "mjcf-inertia-not-positive-definite": Change(
        'diaginertia="0.005 0.006 0.007"', 'fullinertia="0.005 0.006 0.007 0.5 0 0"', "fullinertia"
    ),
    "mjcf-missing-mass": Change(' mass="0.5"', "", '<inertial pos="0 0 0" dia'),
    "mjcf-missing-inertial-pos": Change('pos="0 0 0" mass="0.5" dia', 'mass="0.5" dia', '<inertial mass="0.5"'),
    "mjcf-weightless-body": Change(
        f"""          <inertial pos="0 0 0" mass="0.5" diaginertia="0.001 0.001 0.001"/>
          {LAST_JOINT}
          <geom type="sphere" size="0.02"/>
""",
        f"{LAST_JOINT}\n",
        '<body name="arm_2"',
    ),
    "mjcf-global-coordinates": Change('angle="radian"', 'angle="radian" coordinate="global"', "global"),
    "mjcf-missing-asset-file": Change(
        "  </asset>", '    <texture name="wood" type="2d" file="nowhere.png"/>\n  </asset>', "nowhere"
    ),
    "mjcf-undefined-asset": Change('rgba="0.5 0.5 0.5 1"', 'texture="wood"', "wood"),
    "mjcf-long-keyframe": Change(
        "</mujoco>", '<keyframe>\n<key name="home" qpos="0 0 0"/>\n</keyframe>\n</mujoco>', "home"
    ),
    "mjcf-short-keyframe": Change(
        "</mujoco>", '<keyframe>\n<key name="home" qpos="0"/>\n</keyframe>\n</mujoco>', "home"
    ),
    "mjcf-missing-size": Change(' size="0.02"', "", 'type="sphere"'),
    "mjcf-missing-mesh": Change('file="part.obj"', 'file="nowhere.obj"', "nowhere"),
    "mjcf-undefined-mesh": Change('mesh="part"', 'mesh="parts"', "parts"),
    "mjcf-undefined-material": Change('material="grey"', 'material="gray"', "gray"),
    "mjcf-undefined-class": Change('class="drive" type', 'class="drives" type', "drives"),
    "mjcf-actuator-of-nothing": Change('joint="elbow" kp', 'joint="elbows" kp', "elbows"),
    "mjcf-undefined-name": Change("</actuator>", '</actuator><sensor><jointpos joint="elbows"/></sensor>', "elbows"),
    "mjcf-exclude-of-nothing": Change('body2="arm_1"', 'body2="arm_9"', "arm_9"),
    "mjcf-invalid-number": Change('mass="1"', 'mass="one"', "one"),
    "mjcf-invalid-vector": Change('pos="0.2 0 0"', 'pos="0.2 0"', 'pos="0.2 0"'),
    "mjcf-missing-include": Change("  <worldbody>", '  <include file="nowhere.xml"/>\n  <worldbody>', "nowhere"),
    "mjcf-repeated-element": Change(
        LAST_JOINT, f'{LAST_JOINT}<inertial pos="0 0 0" mass="9" diaginertia="1 1 1"/>', 'mass="9"'
    ),
    "mjcf-range-without-limited": Change(' limited="true"', "", '<joint name="elbow"'),
    "mjcf-nameless-joint": Change('<joint name="slide"', "<joint", "<joint type"),
}


def write_models(folder: Path) -> dict[str, Path]:
    """The sound files, as ``sdf`` and ``mjcf``, and every faulty one by its rule, with a mesh beside them."""
    corners = [(0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)]
    faces = [(1, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4)]
    obj = [f"v {x} {y} {z}" for x, y, z in corners] + [f"f {a} {b} {c}" for a, b, c in faces]
    (folder / "part.obj").write_text("\n".join(obj) + "\n")
    (folder / "part.glb").write_text("glTF")
    (folder / "pointer.obj").write_text("version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n")
    paths = {}
    for sound, text, faults, suffix in (("sdf", SDF, SDF_FAULTS, ".sdf"), ("mjcf", MJCF, MJCF_FAULTS, ".xml")):
        for name, content in {sound: text, **{rule: fault.of(text) for rule, fault in faults.items()}}.items():
            paths[name] = folder / f"{name}{suffix}"
            paths[name].write_text(content)
    return paths
