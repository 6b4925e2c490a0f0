"""Descriptions with a single oddity each: every reader loads them, or does not, as the findings foretell."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from consumers import require
from faulty_files import BOX, ELBOW, ELBOW_LIMIT, END, SOUND, write_meshes
from foretelling import unforeseen

if TYPE_CHECKING:
    from collections.abc import Callable
    from pathlib import Path

FIRST = '<joint name="base_link-base_link_inertia" type="fixed">'
SHOULDER = '<joint name="shoulder" type="revolute">'
SHOULDER_LIMIT = '<limit lower="-1" upper="1.5" effort="50" velocity="3"/>'
MASS, WITHOUT_MASS = '<mass value="1"/>', '<mass value="0"/>'
KEPT = ' fusestatic="false"'
ACTUATOR = '<actuator name="motor"/>'
GROUP = "drake:collision_filter_group"
MEMBER = '<drake:member link="link_1"/>'


def changed(*pairs: tuple[str, str]) -> str:
    """The sound description with other texts."""
    text = SOUND
    for old, new in pairs:
        assert old in text
        text = text.replace(old, new)
    return text


def driven(joint: str = "elbow", actuator: str = ACTUATOR) -> str:
    return f'<transmission><type>SimpleTransmission</type><joint name="{joint}"/>{actuator}</transmission>'


def floating() -> list[str]:
    """Joints of type floating, below roots of several names that MuJoCo may merge into the world."""
    return [
        changed((of, of.replace(kind, "floating")), ('"base_link"', f'"{root}"'), (KEPT, keeps))
        for of, kind in ((FIRST, "fixed"), (SHOULDER, "revolute"))
        for root in ("base_link", "world")
        for keeps in (KEPT, "", ' fusestatic="true"')
    ]


def axes() -> list[str]:
    """Axes of joints that do not turn about them."""
    child = '<child link="base_link_inertia"/>'
    return [
        changed((FIRST, FIRST.replace("fixed", kind)), (KEPT, ""), (child, f"{child}<axis{xyz}/>"))
        for kind in ("fixed", "floating")
        for xyz in ("", *(f' xyz="{text}"' for text in ("", "1 2", "0 0 0", "a b c", "nan 0 0")))
    ]


def followers() -> list[str]:
    """Joints of all types that follow joints of all types."""
    kinds = ("revolute", "continuous", "prismatic", "floating", "planar", "fixed")
    return [
        changed(
            (SHOULDER, SHOULDER.replace("revolute", leader)),
            (ELBOW, ELBOW.replace("revolute", kind)),
            (ELBOW_LIMIT, f'{ELBOW_LIMIT}<mimic joint="shoulder"/>'),
            (KEPT, ""),
        )
        for leader in kinds
        for kind in kinds
    ]


def masses() -> list[str]:
    """Masses near 1e-15, of a link and of what is fixed to it."""
    inertia = 'ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"'
    heavy = [(WITHOUT_MASS, MASS), (inertia, 'ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"')]
    return [
        changed((MASS, f'<mass value="{mass}"/>'), *tools)
        for mass in ("1e-14", "1.1e-15", "9e-16", "1e-300")
        for tools in ([], heavy)
    ]


def names_and_addresses() -> list[str]:
    """Names of shapes, and addresses of files that are found in the folder of the description."""
    texts = [
        changed((f"<{shape}>", f'<{shape} name="{name}">'))
        for shape in ("visual", "collision")
        for name in ("", " ", "&#9;", "a", " a ")
    ]
    addresses = ("file:///part.obj", "file://part.obj", "file:////part.obj", "file://./part.obj", "file:///x/part.obj")
    return [*texts, *(changed((BOX, f'<mesh filename="{address}"/>')) for address in addresses)]


def of_drake() -> list[str]:
    """Elements that Drake alone reads."""
    numbers = ("1", "x", "nan", "-1", "0", "", "1 2", "1e5x")
    kinds = ("fixed", "floating", "planar", "prismatic", "continuous")
    frames = (
        *(
            'name="f" link="link_1"',
            'name="f" link="nowhere"',
            'name="f"',
            'link="link_1"',
            'name="link_1" link="link_2"',
        ),
        *('name="f" link="world"', 'name="" link="link_1"', 'name="elbow" link="link_1"'),
        *(f'name="f" link="link_1" xyz="{xyz}"' for xyz in ("1 2", "1 2 3x", "", "a b c", "1 2 3")),
    )
    groups = (
        *("", f' name="g">{MEMBER}', f' name="">{MEMBER}', ' name="g">', ' name="g"><drake:member link="nowhere"/>'),
        *(' name="g"><drake:member/>', ' name="g" ignore="true"><drake:member link="nowhere"/>'),
        *(
            f' name="g">{MEMBER}<drake:ignored_collision_filter_group{name}/>'
            for name in ("", ' name="g"', ' name="h"')
        ),
    )
    elements = [
        *(
            driven(actuator=f'<actuator name="motor"><drake:{kind} value="{number}"/></actuator>')
            for kind in ("gear_ratio", "rotor_inertia")
            for number in numbers
        ),
        driven(actuator='<actuator name="motor"><drake:rotor_inertia/></actuator>'),
        driven() + driven("shoulder"),
        driven() + driven(actuator='<actuator name="other"/>'),
        driven("link_2-tool0"),
        *(f"<frame {frame}/>" for frame in frames),
        '<frame name="f" link="link_1"/><frame name="f" link="link_2"/>',
        *(f"<{GROUP}{group if '>' in group else '>'}</{GROUP}>" for group in groups),
        2 * f'<{GROUP} name="g">{MEMBER}</{GROUP}>',
        "<loop_joint/>",
    ]
    texts = [changed((END, element + END)) for element in elements]
    return [*texts, *(changed((ELBOW, ELBOW.replace("revolute", kind)), (END, driven() + END)) for kind in kinds)]


FREE = '<link name="free"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
TO_FREE = '<parent link="link_1"/><child link="free"/>'
FORCES = {
    "linear_bushing_rpy": ("bushing_", "frameA frameC", "torque_stiffness torque_damping force_damping", "", ()),
    "linear_spring_damper": (
        "linear_spring_damper_",
        *("body_A body_B", "p_AP p_BQ", "free_length stiffness damping"),
        (),
    ),
    "ball_constraint": ("ball_constraint_", "body_A body_B", "p_AP p_BQ", "", ()),
    "tendon_constraint": (
        "tendon_constraint_",
        *("", "", "offset lower_limit upper_limit stiffness damping"),
        ('name="elbow" a="1"', 'name="elbow"', 'a="1"', 'name="nowhere" a="1"', 'name="link_2-tool0" a="1"'),
    ),
}
"""Springs and constraints of Drake: what the names of their parts begin with, the parts, and joints."""


def forces() -> list[str]:
    """Springs and constraints of Drake, right and with a part that is missing or odd."""
    found = []
    for tag, (prefix, ends, vectors, numbers, joints) in FORCES.items():
        parts = {name: f'name="link_{number}"' for number, name in enumerate(ends.split(), 1)}
        parts |= dict.fromkeys(vectors.split(), 'value="1 1 1"') | dict.fromkeys(numbers.split(), 'value="1"')
        if tag == "linear_bushing_rpy":
            parts["force_stiffness"] = 'value="1 1 1"'
        odd = [{}, *({name: None} for name in parts), *({name: ""} for name in parts)]
        odd += [{name: f'name="{link}"'} for name in ends.split() for link in ("nowhere", "world", "", "link_1")]
        odd += [{name: f'value="{text}"'} for name in vectors.split() for text in ("1 1", "a b c", "-1 -1 -1")]
        odd += [{name: f'value="{text}"'} for name in numbers.split() for text in ("0", "-1", "x", "2")]
        for change, joint in [*((change, joints[:1]) for change in odd), *(({}, (each,)) for each in joints)]:
            lines = [f"<drake:{prefix}{name} {text}/>" for name, text in (parts | change).items() if text is not None]
            lines += [f"<drake:{prefix}joint {text}/>" for text in joint]
            found.append(f"<drake:{tag}>{''.join(lines)}</drake:{tag}>")
    return found


def drakes_own() -> list[str]:
    """Elements in Drake's namespace, and transmissions whose type is an attribute."""
    kinds = ("ball", "planar", "screw", "universal", "curvilinear", "fixed", "revolute", "floating", "x")
    joints = [f'name="d" type="{kind}">{TO_FREE}' for kind in kinds]
    joints += [f"{names}>{TO_FREE}" for names in ('type="ball"', 'name="d"', 'name="elbow" type="ball"')]
    joints += [f'name="d" type="ball">{TO_FREE.replace("link_1", name)}' for name in ("nowhere", "world", "", "free")]
    joints += ['name="d" type="x" drake_ignore="true">', 'name="d" type="ball"><parent/><child link="free"/>']
    joints += [
        f'name="d" type="screw">{TO_FREE}<drake:screw_thread_pitch {text}/>' for text in ("", 'value="1"', 'value="x"')
    ]
    curves = ("", "line_segment", 'line_segment length="1"', 'line_segment length="0"', "x", 'circular_arc radius="1"')
    curves += tuple(f'circular_arc radius="{r}" angle="{angle}"' for r in (1, -1) for angle in (1, -1, 0))
    joints += [
        f'name="d" type="curvilinear">{TO_FREE}<drake:curves>{f"<drake:{curve}/>" if curve else ""}</drake:curves>'
        for curve in curves
    ]
    elements = [f"{FREE}<drake:joint {joint}</drake:joint>" for joint in joints] + forces()
    types = (("SimpleTransmission", ""), ("", ""), ("x", ""), ("SimpleTransmission", "<type>x</type>"))
    elements += [
        count * f'<transmission type="{kind}">{inner}<joint name="{joint}"/>{ACTUATOR}</transmission>'
        for kind, inner in types
        for joint in ("elbow", "link_2-tool0", "nowhere")
        for count in (1, 2)
    ]
    gains = ("", 'p="1"', 'p="1" d="1"', 'p="x" d="1"', 'p="-1" d="1"')
    elements += [driven(actuator=f'<actuator name="m"><drake:controller_gains {text}/></actuator>') for text in gains]
    shapes = ("ellipsoid", 'ellipsoid a="1" b="1" c="1"', 'ellipsoid a="1" b="1" c="0"', 'capsule radius="1"')
    shapes += ('capsule radius="1" length="1"', 'capsule radius="0" length="1"', "half_space")
    hints = [f'<drake:mesh_resolution_hint value="{text}"/>' for text in (1, 0)]
    moduli = [f'<drake:hydroelastic_modulus value="{text}"/>' for text in (1, -1)]
    properties = [
        *(
            f"<drake:{kind}_hydroelastic/>{hint}{modulus}"
            for kind in ("rigid", "compliant", "soft")
            for hint in ("", *hints)
            for modulus in ("", *moduli)
        ),
        *(
            f"<drake:{name} {text}/>"
            for name in (
                "hunt_crossley_dissipation",
                "point_contact_stiffness",
                "mu_static",
                "mu_dynamic",
                "relaxation_time",
            )
            for text in ("", 'value="-1"', 'value="0"', 'value="1"', 'value="x"')
        ),
        '<drake:mu_static value="1"/><drake:mu_dynamic value="2"/>',
        "<drake:rigid_hydroelastic/><drake:compliant_hydroelastic/>",
    ]
    texts = [changed((END, element + END)) for element in elements]
    texts += [changed((BOX, f"<drake:{shape}/>")) for shape in shapes]
    texts += [
        changed(("<collision>", f"<collision><drake:proximity_properties>{each}</drake:proximity_properties>"))
        for each in properties
    ]
    texts += [
        changed(
            (BOX, "<box size='1 1 1'/>"),
            ("<collision>", f"<collision><drake:proximity_properties>{each}</drake:proximity_properties>"),
        )
        for each in properties[:12]
    ]
    idle = ELBOW_LIMIT.replace('effort="20"', 'effort="0"')
    texts.append(changed((ELBOW_LIMIT, idle), (END, driven() + driven("shoulder") + END)))
    return [text.replace("<robot ", '<robot xmlns:drake="http://drake.mit.edu" ', 1) for text in texts]


RODS = (
    "5.174345927e-9 -5.290597383e-10 1.8919162484e-9 5.5449037e-9 1.342020101e-9 1.121128847e-9",
    "5.17434592709207E-09 -5.29059738327317E-10 1.89191624844867E-09 5.5449037019298E-09 1.34202010093817E-09 1.12112884690769E-09",
    "6.577885432863033 13.777361 19.9545865 93.8450559 -3.075508024589318 91.5140521905107",
    "35.6994270585546 -0.166263479 46.5874258905804 96.4959115245 0.127404235 60.797393838864146",
    "0.421991585 -0.067846 0.008049995316552075 0.0169199045 0.049374604039720445 0.4271948024363487",
    "5.342198826495226 -2.899583260113406 -0.354807333 1.67618027134403 -0.644054299619 6.8607597590393645",
    "1 0 0 2 0 3.0000000001",
    "1 0 0 2 0 3.000000000000001",
    "1 1e-7 0 2 0 3.000000000000001",
)
"""Inertias of thin rods and flat plates, of which rounding decides; the second is of a published robot."""


def thin_things() -> list[str]:
    """Links with such inertias."""
    inertia = '<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/>'
    names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
    return [
        changed((inertia, "<inertia " + " ".join(map('{}="{}"'.format, names, rod.split())) + "/>")) for rod in RODS
    ]


def digits_and_colours() -> list[str]:
    """Numbers in the digits of another alphabet, and materials where none belongs."""
    colours = [f'<material{name}><color rgba="1 0 0"/></material>' for name in ("", ' name=""', ' name="steel"')]
    texts = [MASS.replace("1", digit) for digit in ("\u0661", "\uff11", "1_0")] + [MASS + each for each in colours]
    return [changed((MASS, text)) for text in texts]


def of_gazebo() -> list[str]:
    """Texts in the elements of Gazebo."""
    tags = (
        "mu1",
        "mu2",
        "kp",
        "kd",
        "dampingFactor",
        "maxVel",
        "minDepth",
        "maxContacts",
        "laserRetro",
        "stopCfm",
        "stopErp",
    )
    tags += ("springStiffness", "springReference", "fudgeFactor", "material", "selfCollide", "provideFeedback")
    texts = ("", "1x", "nan", "1e999", "1e-999", " 1 ", "0x10", ".5", "1<!-- -->", "<![CDATA[1]]>")
    values = ('value="1">', 'value="x">', 'value="1">x', 'value="x">1', 'value="">1', 'value=" 1 ">')
    elements = [
        *(f'<gazebo reference="link_1"><{tag}>x</{tag}></gazebo>' for tag in tags),
        *(f'<gazebo reference="link_1"><mu1>{text}</mu1></gazebo>' for text in texts),
        *(f"<gazebo{to}><mu1>x</mu1></gazebo>" for to in ("", ' reference="nowhere"', ' reference="tool0"')),
        *(f'<gazebo reference="link_1"><mu1 {text}</mu1></gazebo>' for text in values),
    ]
    added = (
        *(
            "<pose>a b c 0 0 0</pose>",
            "<pose>1 2</pose>",
            "<pose>0 0 1 0 0 0</pose>",
            "<mu1>-1</mu1>",
            "<mu1>-0.0</mu1>",
        ),
        *(f"<fdir1>{text}</fdir1>" for text in ("a b c", "1 0", "1 0 0x", "", "1 0 0 0")),
        *(f"<sensor{text}/>" for text in (' type="imu"', ' name="a"', ' name="" type="imu"', ' name="a" type="imu"')),
        *(
            f'<sensor name="a" type="{kind}"/>'
            for kind in ("gpu_lidar", "wideanglecamera", "lidars", "Camera", "custom ", "none")
        ),
        2 * '<sensor name="a" type="imu"/>',
        *('<plugin name="a" filename="b"/>', '<plugin name="a"/>', '<plugin filename="b"/>'),
        *('<mu2 value="-1"/>', '<fdir1 value="1 0"/>'),
    )
    names = ("link_1", "link_2", "tool0", "base_link", "elbow", "nowhere")
    elements += [
        f"<gazebo{to}>{each}</gazebo>" for to in ("", *(f' reference="{name}"' for name in names)) for each in added
    ]
    sensor = '<sensor name="a" type="imu"/>'
    elements += [
        "".join(f'<gazebo reference="{name}">{sensor}</gazebo>' for name in pair)
        for pair in (("link_1", "link_1"), ("link_1", "link_2"), ("elbow", "link_1"), ("tool0", "link_2"))
    ]
    return [changed((END, element + END)) for element in elements]


def extensions() -> list[str]:
    """What the extension of MuJoCo has, and limits beside `autolimits="false"`."""
    options = (
        *(f'autolimits="{word}"' for word in ("false", "true", "no", "False")),
        *(f'coordinate="{word}"' for word in ("global", "local", "x")),
        *('angle="rad"', 'angle="degree"', 'eulerseq="xy"', 'eulerseq="abc"', 'boundmass="x"', 'boundmass="-1"'),
        *('inertiagrouprange="0"', 'inertiafromgeom="auto"', 'inertiafromgeom="x"', 'strippath="1"', 'unknown="1"'),
    )
    elements = (
        *(
            f"<option {text}/>"
            for text in ('timestep="x"', 'timestep="0"', 'integrator="RK5"', 'gravity="0 0"', 'a="b"')
        ),
        *('<size njmax="x"/>', '<size njmax="10"/>', "<asset/>", '<option><flag gravity="no"/></option>'),
    )
    compiler = 'discardvisual="false"/>'
    never = (compiler, compiler.replace("/>", ' autolimits="false"/>'))
    still = (SHOULDER_LIMIT, "")
    limits = [
        f'<limit{ends}{effort} velocity="3"/>'
        for ends in (
            "",
            *(f' lower="{lower}" upper="{upper}"' for lower, upper in ((-2, 2), (0, 0), (2, 1))),
            ' upper="2"',
        )
        for effort in ("", ' effort="0"', ' effort="20"')
    ]
    return [
        *(changed((compiler, compiler.replace("/>", f" {text}/>"))) for text in options),
        *(changed((compiler, f"{compiler}{element}")) for element in elements),
        *(
            changed(
                never, still, (SHOULDER, SHOULDER.replace("revolute", "fixed")), (ELBOW, elbow), (ELBOW_LIMIT, limit)
            )
            for elbow in (ELBOW.replace("revolute", kind) for kind in ("revolute", "continuous", "prismatic", "planar"))
            for limit in limits
        ),
    ]


@pytest.mark.long
@pytest.mark.parametrize("consumer", ["pybullet", "mujoco", "pinocchio", "drake", "ros", "gazebo"])
@pytest.mark.parametrize(
    "texts",
    [
        *(floating, axes, followers, masses, names_and_addresses, of_drake),
        *(digits_and_colours, of_gazebo, extensions),
    ],
)
def test_an_oddity_is_foretold(tmp_path: Path, consumer: str, texts: Callable[[], list[str]]) -> None:
    """A reader refuses a description, or ends, where a finding says so, and loads it where none does."""
    require(consumer)
    write_meshes(tmp_path)
    paths = []
    for number, text in enumerate(texts()):
        paths.append(tmp_path / f"{number}.urdf")
        paths[-1].write_text(text)
    assert unforeseen(consumer, paths)[0] == []


@pytest.mark.long
def test_elements_of_drake_are_foretold(tmp_path: Path) -> None:
    """Its joints, springs, constraints, shapes and properties, as Drake itself takes them."""
    test_an_oddity_is_foretold(tmp_path, "drake", drakes_own)


@pytest.mark.long
def test_thin_things_are_foretold(tmp_path: Path) -> None:
    """Inertias of which the last digits decide, as sdformat computes with them."""
    test_an_oddity_is_foretold(tmp_path, "gazebo", thin_things)
