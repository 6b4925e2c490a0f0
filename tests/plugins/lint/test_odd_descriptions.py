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
        *(f'<sensor name="a" type="{kind}"/>' for kind in ("gpu_lidar", "lidars", "Camera", "custom ", "none")),
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
    "texts", [floating, axes, followers, masses, names_and_addresses, of_drake, of_gazebo, extensions]
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
