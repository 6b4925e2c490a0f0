"""Descriptions with a single oddity each: every reader loads them, or does not, as the findings foretell."""

from pathlib import Path

import pytest
from consumers import require
from faulty_files import ELBOW, ELBOW_LIMIT, END, SOUND, write_meshes
from foretelling import unforeseen

FIRST = '<joint name="base_link-base_link_inertia" type="fixed">'
SHOULDER = '<joint name="shoulder" type="revolute">'
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
        for xyz in ("", *(f' xyz="{text}"' for text in ("0 0 1", "0 0 0")))
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
    for text in (*floating()[::5], *axes()[::4], *followers()[::5], *of_drake()[::2]):
        paths.append(tmp_path / f"{len(paths)}.urdf")
        paths[-1].write_text(text)
    assert unforeseen(consumer, paths)[0] == []
