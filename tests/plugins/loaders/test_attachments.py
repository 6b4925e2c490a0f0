"""What is attached to an arm, in every simulator: leaves at random joint values, masses, joints that follow."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from two_fingers import HAND, TWO_JOINTS as TABLE

import dh2urdf

SIMULATORS = {"mujoco": "mjcf", "pinocchio": "urdf", "pybullet": "urdf", "drake": "sdf", "gazebo": "sdf"}


def loaded(folder: Path, simulator: str, emitter: str, part: Path, **options: Any) -> Any:
    (folder / "arm.csv").write_text(TABLE, "utf-8")
    edit = {"stage": "attach", "options": {"file": str(part), "name": "hand", "xyz": [0.0, 0.02, 0.011]}}
    run = {
        "inputs": str(folder / "arm.csv"),
        "edits": [edit],
        "emitters": [{"stage": emitter, "options": options}],
        "loaders": [simulator],
        "output": str(folder / "out"),
    }
    (arm,) = dh2urdf.run(run)["manipulators"]
    assert arm["status"] == "ok"
    return arm["loaders"][simulator]


@pytest.mark.parametrize("simulator", SIMULATORS)
def test_every_simulator_has_it(simulator: str, tmp_path: Path, require_loaders: Callable[..., None]) -> None:
    """Each leaf of the hand is where its own file has it, and the masses are those of arm and hand."""
    require_loaders(simulator)
    load = loaded(tmp_path, simulator, SIMULATORS[simulator], HAND)
    assert load["position_error"] <= load["tolerance"]
    assert load["poses"] >= 20
    assert [joint["name"] for joint in load["joints"]][-2:] in (
        ["hand_right", "hand_left"],
        ["hand_left", "hand_right"],
    )


def test_pybullet_takes_frames_of_frames_for_bodies(tmp_path: Path, require_loaders: Callable[..., None]) -> None:
    """A finding says so, with what helps; the profile for PyBullet writes them so that it does not."""
    require_loaders("pybullet")
    frames = "".join(
        f'<link name="{name}"/><joint name="to_{name}" type="fixed"><parent link="{parent}"/><child link="{name}"/></joint>'
        for parent, name in (("base_link", "camera"), ("camera", "optical"), ("optical", "rgb"))
    )
    part = tmp_path / "part.urdf"
    part.write_text(HAND.read_text("utf-8").replace("</robot>", f"{frames}</robot>"), "utf-8")
    told = loaded(tmp_path, "pybullet", "urdf", part)
    assert any("2 links" in finding["message"] for finding in told["findings"])
    quiet = loaded(tmp_path, "pybullet", "urdf", part, profile="pybullet")
    assert not any("2 links" in finding["message"] for finding in quiet["findings"])
