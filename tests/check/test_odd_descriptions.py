"""Descriptions with a single oddity each: every reader loads them, or does not, as the findings foretell."""

import re
from pathlib import Path

import pytest
from consumers import require
from faulty_files import CYLINDER, ELBOW, ELBOW_LIMIT, END, LINK_2_BODY, LINK_2_INERTIA, SOUND, write_meshes
from foretelling import unforeseen

FIRST = '<joint name="base_link-base_link_inertia" type="fixed">'
SHOULDER = '<joint name="shoulder" type="revolute">'
MASS, WITHOUT_MASS = '<mass value="1"/>', '<mass value="0"/>'
KEPT = ' fusestatic="false"'
ACTUATOR = '<actuator name="motor"/>'


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


def of_drake() -> list[str]:
    """Transmissions, of which Drake makes actuators."""
    kinds = ("fixed", "floating", "planar", "prismatic", "continuous")
    elements = [
        driven() + driven("shoulder"),
        driven() + driven(actuator='<actuator name="other"/>'),
        driven("link_2-tool0"),
    ]
    texts = [changed((END, element + END)) for element in elements]
    return [*texts, *(changed((ELBOW, ELBOW.replace("revolute", kind)), (END, driven() + END)) for kind in kinds)]


@pytest.mark.long
@pytest.mark.parametrize("consumer", ["pybullet", "mujoco", "pinocchio", "drake", "ros", "gazebo"])
def test_an_oddity_is_foretold(tmp_path: Path, consumer: str) -> None:
    """A reader refuses a description, or ends, where a finding says so, and loads it where none does: of a sample."""
    require(consumer)
    write_meshes(tmp_path)
    paths = []
    for text in (*floating()[::5], *axes()[::4], *followers()[::5], *masses()[::3], *of_drake()[::2]):
        paths.append(tmp_path / f"{len(paths)}.urdf")
        paths[-1].write_text(text)
    assert unforeseen(consumer, paths)[0] == []


BASE = SOUND.replace(CYLINDER, '<mesh filename="part.obj" scale="1 1 1"/>').replace(
    LINK_2_BODY, f'{LINK_2_BODY}<collision><geometry><cylinder radius="0.02" length="0.05"/></geometry></collision>'
)
BASE = BASE.replace(ELBOW_LIMIT, f'{ELBOW_LIMIT}<dynamics damping="1" friction="0"/>')
SCALES = ("2", "2 ", "2x", "2x 1 1", "0x10", "0x10 1 1", "1 1 0x10", "1e-9 1 1", "1e-8 1 1", "2,2,2", "2 2 2x", "0 1 1")


def with_odd_numbers() -> list[str]:
    """The sound description, each time with another number of it in a form that not all readers take."""
    texts = [BASE.replace('scale="1 1 1"', f'scale="{scale}"') for scale in SCALES]
    for match in re.finditer(r' (value|i[xyz]{2}|xyz|rpy|size|lower|upper|velocity|damping)="([-0-9. ]+)"', BASE):
        words = match[2].split()
        for odd in ("nan", "-inf", "0x10", "-0x10", "0x.8", "0x0", "NaN(1)", "1e5x", "-3x"):
            text = " ".join([*words[:-1], odd])
            texts.append(BASE[: match.start(2)] + text + BASE[match.end(2) :])
    mass, impossible = '<mass value="1"/>', LINK_2_INERTIA.replace("0.005", "-1")
    no_body = [
        BASE.replace(LINK_2_INERTIA, impossible),
        BASE.replace(LINK_2_INERTIA, LINK_2_INERTIA.replace("0.007", "7")),
    ]
    texts += [text.replace(mass, '<mass value="inf"/>') for text in no_body]
    return [*texts, BASE.replace(mass, '<mass value="0x1p9999"/>')]


@pytest.mark.long
@pytest.mark.parametrize("consumer", ["mujoco", "drake"])
def test_what_a_reader_makes_of_an_odd_number_is_foreseen(tmp_path: Path, consumer: str) -> None:
    """MuJoCo reads nan, inf and 0x10, Drake what the text begins with: and refuses what cannot be a body or an axis."""
    require(consumer)
    write_meshes(tmp_path)
    paths = []
    for number, text in enumerate(with_odd_numbers()[::12]):
        paths.append(tmp_path / f"{number}.urdf")
        paths[-1].write_text(text)
    assert unforeseen(consumer, paths)[0] == []
