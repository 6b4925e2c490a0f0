"""The pose of tool0, typed and dragged, in the browser."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from dh2urdf.kinematics import forward_kinematics
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Manipulator
from dh2urdf.rotations import RigidTransform

pytestmark = pytest.mark.long


@pytest.fixture
def ur5(tab: Any) -> Any:
    """A tab with a UR5 and the panel."""
    tab.open("ur5")
    tab.click("set the pose of tool0")
    box(tab, "x").wait_for()
    return tab


ANSWERED = """() => {
    const view = getElement(Number(document.querySelector('.arm-view').id.slice(1)));
    return !view.asked && !view.wanted;
}"""


def box(tab: Any, name: str) -> Any:
    return tab.page.get_by_label(f"{name} of tool0", exact=True)


def put(tab: Any, name: str, text: str) -> None:
    box(tab, name).fill(text)
    box(tab, name).press("Enter")


def put_pose(tab: Any) -> None:
    """A pose well inside the reach of a UR5, box by box."""
    for name, text in {"x": "350 mm", "y": "-0.2", "z": "0.4", "roll": "pi", "pitch": "0", "yaw": "30 deg"}.items():
        put(tab, name, text)
    tab.wait_for_pose("tool0", RigidTransform.from_xyz_rpy((0.35, -0.2, 0.4), (math.pi, 0.0, math.pi / 6)))
    tab.page.locator(".studio-target-answer", has_text="tool0 is there").wait_for()


def matrix_of(tab: Any, arm: Manipulator) -> Any:
    return as_matrices(forward_kinematics(arm, tab.sliders()))


def test_a_pose_is_typed(ur5: Any, arm_of: Callable[..., Manipulator]) -> None:
    """The boxes show tool0 of the sliders; what is typed there moves the arm, or is answered with how far it is off."""
    tab, arm = ur5, arm_of("ur5.csv")
    tab.page.get_by_text("The arm is at a singularity: manipulability 0").wait_for()  # Straight, it cannot come nearer.
    tab.press("random pose")
    tab.wait_for_tool0(arm)
    tab.page.get_by_text("smallest singular value").wait_for()
    there = matrix_of(tab, arm)
    shown = [float(box(tab, name).input_value()) for name in ("x", "y", "z", "roll", "pitch", "yaw")]
    assert np.abs(shown[:3] - there[:3, 3]).max() < 1e-6
    assert np.abs(Rotation.from_euler("xyz", shown[3:]).as_matrix() - there[:3, :3]).max() < 5e-6
    whole = "() => [...document.querySelectorAll('.studio-target-box input')].every(box => box.scrollWidth <= box.clientWidth)"
    tab.page.wait_for_function(whole)
    put_pose(tab)
    tab.expect(box(tab, "x")).to_have_value("0.35")
    assert np.abs(matrix_of(tab, arm)[:3, 3] - (0.35, -0.2, 0.4)).max() < 5e-4  # sliders have four digits


def test_what_is_no_pose_or_out_of_reach(ur5: Any, arm_of: Callable[..., Manipulator]) -> None:
    """A message, and the arm as near as it comes, which the message measures."""
    tab, arm = ur5, arm_of("ur5.csv")
    put(tab, "x", "far away")
    tab.page.locator(".studio-target-answer", has_text="x: 'far away'").wait_for()
    with tab.other_joints():
        put(tab, "x", "3")
    tab.page.get_by_text("The arm cannot reach this pose").wait_for()
    words = tab.page.locator(".studio-target-answer").inner_text()
    told = float(words.split("tool0 is ")[1].split(" mm")[0])
    assert told == pytest.approx(1000.0 * abs(3.0 - matrix_of(tab, arm)[0, 3]), rel=0.1)
    tab.page.get_by_text("smallest singular value").wait_for()


def test_a_quaternion_is_typed(ur5: Any, arm_of: Callable[..., Manipulator]) -> None:
    """In place of the angles; one of any length is taken, one of length 0 is not."""
    tab, arm = ur5, arm_of("ur5.csv")
    tab.press("random pose")
    tab.wait_for_tool0(arm)
    tab.page.get_by_role("button", name="quaternion").click()
    box(tab, "qw").wait_for()
    box(tab, "roll").wait_for(state="hidden")
    there = matrix_of(tab, arm)
    names = ("qx", "qy", "qz", "qw")
    shown = [float(box(tab, name).input_value()) for name in names]
    assert np.abs(Rotation.from_quat(shown).as_matrix() - there[:3, :3]).max() < 5e-4
    for name, text in zip(names, ("0", "0", "0", "5"), strict=True):
        box(tab, name).fill(text)
    box(tab, "qw").press("Enter")
    tab.page.locator(".studio-target-answer", has_text="tool0 is").wait_for()


def test_tool0_is_dragged(ur5: Any, arm_of: Callable[..., Manipulator]) -> None:
    """The handle leads tool0 in the plane that faces the camera, and its orientation stays."""
    tab, arm = ur5, arm_of("ur5.csv")
    page = tab.page
    tab.set_sliders([-2.5, -1.9, 2.0, -1.7, -1.57, 0.0])  # far from limits and singularities
    tab.wait_for_tool0(arm)
    before = matrix_of(tab, arm)
    camera = "document.querySelector('.arm-view').camera.position.toArray()"
    looks, (x, y) = page.evaluate(camera), tab.pixel("handle")
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(1, 6):
        page.mouse.move(x - 4 * step, y + 3 * step)
    page.mouse.up()
    page.wait_for_function(ANSWERED)
    tab.settle()  # the sliders follow the arm
    after = matrix_of(tab, arm)
    assert np.abs(after[:3, :3] - before[:3, :3]).max() < 5e-4
    assert np.linalg.norm(after[:3, 3] - before[:3, 3]) > 0.02
    assert np.hypot(*(tab.pixel("handle") - (x - 20, y + 15))) < 2
    assert page.evaluate(camera) == looks
    page.get_by_role("button", name="set the pose of tool0").click()
    page.wait_for_function("!document.querySelector('.arm-view').scene.getObjectByName('handle').visible")
