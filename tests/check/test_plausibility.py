"""What is hardly meant is found, what is meant is not, and every consumer takes both as they stand."""

from __future__ import annotations

from typing import TYPE_CHECKING

import pytest
from consumers import behaviours, require
from faulty_files import CYLINDER, ELBOW_AXIS, ELBOW_LIMIT, END, PROOFS, SOUND
from real_robots import descriptions, findings_of

from dh2urdf_check.inspection import inspect_urdf
from dh2urdf_check.rules import rules_of

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.stages import Finding

RULES = rules_of("plausibility")
NOT_MEANT_OTHERWISE = {
    "no limits": (ELBOW_LIMIT, ELBOW_LIMIT.replace('"-2" upper="2"', '"-100" upper="100"')),
    "a rotor that is not drawn": (CYLINDER, '<cylinder radius="0.001" length="0.001"/>'),
    "what ROS 2 controls": (END, f'<ros2_control name="c" type="system"><joint name="elbow"/></ros2_control>{END}'),
    "an attribute of one's own": (ELBOW_AXIS, '<axis xyz="0 1 0" colour="red"/>'),
}


def write(folder: Path, name: str, old: str, new: str) -> Path:
    assert SOUND.count(old) == 1
    path = folder / f"{name}.urdf"
    path.write_text(SOUND.replace(old, new))
    return path


def found(path: Path) -> list[Finding]:
    return [finding for finding in inspect_urdf(path).findings if finding.rule in RULES]


@pytest.mark.parametrize("name", NOT_MEANT_OTHERWISE)
def test_what_may_be_meant_is_not_spoken_of(tmp_path: Path, name: str) -> None:
    assert found(write(tmp_path, "arm", *NOT_MEANT_OTHERWISE[name])) == []


def test_an_effort_of_0_is_no_limit_to_mujoco_and_takes_drakes_actuator(tmp_path: Path) -> None:
    """Drake reads efforts where a transmission makes an actuator, and nothing is said of it elsewhere."""
    require("drake", "mujoco")
    drive = (
        '<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="elbow"/>'
        f'<actuator name="motor"/></transmission>{END}'
    )
    paths = [
        write(tmp_path, "plain", PROOFS["zero-effort"].old, PROOFS["zero-effort"].new),
        tmp_path / "driven.urdf",
        write(tmp_path, "with effort", END, drive),
    ]
    paths[1].write_text(paths[0].read_text().replace(END, drive))
    spoken_of = [
        "drake" in {effect.consumer for effect in finding.effects} for path in paths for finding in found(path)
    ]
    assert spoken_of == [False, True]
    assert [each.extra["actuators"] for each in behaviours("drake", paths)] == [0, 0, 1]
    efforts = [each.extra["told"]["elbow"]["effort"] for each in behaviours("mujoco", paths)]
    assert efforts == [None, None, 20.0]


def test_a_ground_may_be_large(tmp_path: Path) -> None:
    """A single link with a box of 200 m is where robots stand."""
    path = tmp_path / "plane.urdf"
    path.write_text(
        '<robot name="plane"><link name="ground"><collision><geometry><box size="200 200 10"/></geometry>'
        "</collision></link></robot>"
    )
    assert found(path) == []


TRUE = {
    "inertia-of-a-larger-body": {"a1.urdf", "b1-z1.urdf", "tiago.urdf"},
    "reference-to-nothing": {"talos_left_arm.urdf", "tiago_dual.urdf"},
}
"""Descriptions of real robots of which each finding was looked at by hand."""


@pytest.mark.long
def test_real_robots_are_plausible_but_for_what_was_looked_at() -> None:
    """No arm of a maker has limits, angles or lengths that are taken for other units: of a sixth of them."""
    by_rule: dict[str, set[str]] = {}
    known = set().union(*TRUE.values())
    for path in [path for number, path in enumerate(descriptions()) if path.name in known or number % 6 == 0]:
        for finding in findings_of(path):
            if finding.rule not in RULES:
                continue
            by_rule.setdefault(finding.rule, set()).add(path.name)
    assert {*TRUE} <= set(by_rule) <= {*TRUE, "zero-velocity", "zero-effort"}
    for rule, names in TRUE.items():
        assert names <= by_rule[rule]
