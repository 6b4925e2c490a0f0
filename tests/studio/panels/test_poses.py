"""Stored poses and their playback, and measuring, in the browser."""

import re
from collections.abc import Callable
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy.spatial.transform import Rotation

from dh2urdf.kinematics import dh_frames, forward_kinematics
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Manipulator
from dh2urdf.plugin_system import Catalog
from dh2urdf_studio.editing.opening import gallery_table
from dh2urdf_studio.editing.session import Session
from dh2urdf_studio.panels.poses import between

ANGLE = st.floats(-3.0, 3.0)


@given(st.lists(st.tuples(ANGLE, ANGLE), min_size=2, max_size=5), st.floats(0.0, 1.0))
def test_a_way_goes_through_its_poses(poses: list[tuple[float, float]], part: float) -> None:
    """At whole numbers it is at a pose; between two of them inside both; it stands still where it begins and ends."""
    way = [{"a": a, "b": b} for a, b in poses]
    for number, pose in enumerate(way):
        assert between(way, float(number)) == pose
    for number, (one, other) in enumerate(pairwise(way)):
        found = between(way, number + part)
        for name in one:
            least, most = sorted((one[name], other[name]))
            assert least - 1e-12 <= found[name] <= most + 1e-12
        step = 1e-5
        slow = between(way, number + step)
        assert all(abs(slow[name] - one[name]) <= 4e-10 * (abs(other[name] - one[name]) + 1.0) for name in one)


def test_a_joint_that_a_pose_does_not_have_stays() -> None:
    assert between([{"a": 1.0, "b": 2.0}, {"a": 3.0}], 0.5) == {"a": 2.0, "b": 2.0}


@pytest.mark.long
def test_poses_are_stored_and_played(tab: Any, arm_of: Callable[..., Manipulator]) -> None:
    """The arm goes through them in order and stops at the last; one can be chosen, and forgotten."""
    arm = arm_of("ur5.csv")
    page = tab.open("ur5")
    page.get_by_role("button", name="stored poses").click()
    play = page.get_by_role("button", name="play", exact=True)
    assert play.is_disabled()
    stored = []
    for _ in range(2):
        tab.press("random pose")
        tab.wait_for_tool0(arm)
        page.get_by_role("button", name="store this pose").click()
        page.get_by_role("button", name=re.compile(f"^pose {len(stored) + 1}$")).wait_for()
        stored.append(tab.sliders())
    tab.press("zero")
    play.click()
    page.get_by_role("button", name="stop").wait_for()
    page.get_by_role("button", name="play", exact=True).wait_for()
    tab.wait_for_tool0(arm, stored[-1])
    page.get_by_role("button", name="pose 1", exact=True).click()
    tab.wait_for_tool0(arm, stored[0])
    page.get_by_role("button", name="forget pose 1").click()
    page.get_by_role("button", name=re.compile("^pose 2$")).wait_for(state="hidden")
    page.get_by_role("button", name="pose 1", exact=True).click()
    tab.wait_for_tool0(arm, stored[1])
    tab.open_from_gallery("panda")
    page.get_by_role("button", name="pose 1", exact=True).wait_for(state="hidden")


@pytest.mark.long
def test_two_frames_are_measured(tab: Any, arm_of: Callable[..., Manipulator]) -> None:
    """Distance, xyz and rpy are those of the DH frames, also in millimetres; a line joins the two."""
    arm = arm_of("ur5.csv")
    page = tab.open("ur5")
    page.get_by_role("button", name="measure between frames, and show the workspace").click()
    words = page.locator(".studio-measured")
    changed = "before => document.querySelector('.studio-measured').innerText !== before"
    tab.expect(words).to_contain_text("distance")
    before = words.inner_text()
    tab.press("random pose")
    tab.wait_for_tool0(arm)
    page.wait_for_function(changed, arg=before)
    q = tab.sliders()

    def measured() -> tuple[float, Any, Any]:
        numbers = [
            [float(x) for x in re.findall(r"-?\d[\d.e-]*", part)] for part in re.split("xyz|rpy", words.inner_text())
        ]
        return numbers[0][0], numbers[1], numbers[2]

    def expect(one: Any, other: Any, scale: float = 1.0) -> None:
        pose = np.linalg.inv(as_matrices(one)) @ as_matrices(other)
        distance, xyz, rpy = measured()
        assert distance == pytest.approx(scale * np.linalg.norm(pose[:3, 3]), rel=1e-5)
        assert xyz == pytest.approx(scale * pose[:3, 3], abs=2e-5 * scale)
        assert np.abs(Rotation.from_euler("xyz", rpy).as_matrix() - pose[:3, :3]).max() < 2e-5

    frames = dh_frames(arm, q)
    expect(arm.base, forward_kinematics(arm, q))
    tip = as_matrices(forward_kinematics(arm, q))[:3, 3].tolist()
    tab.wait_for_arrow("distance", tip)
    before = words.inner_text()
    page.get_by_label("from", exact=True).click()
    page.get_by_role("option", name="{2}").click()
    page.wait_for_function(changed, arg=before)
    expect(frames[2], forward_kinematics(arm, q))


@pytest.mark.long
@pytest.mark.parametrize("name", ["ur5", "stanford"])
def test_the_workspace_is_where_tool0_can_be(tab: Any, catalog: Catalog, name: str) -> None:
    """No point is farther than the reach that the page gives, prismatic joints included; closed, it is gone."""
    page = tab.open(name)
    button = page.get_by_role("button", name="measure between frames, and show the workspace")
    button.click()
    page.get_by_text("workspace", exact=True).click()
    page.get_by_text("in 4000 random poses").wait_for()
    page.wait_for_function("document.querySelector('.arm-view').scene.getObjectByName('workspace')")
    points = page.evaluate(
        "Array.from(document.querySelector('.arm-view').scene.getObjectByName('workspace').geometry.attributes.position.array)"
    )
    far = np.linalg.norm(np.reshape(points, (-1, 3)), axis=1)
    session = Session(catalog, gallery_table(f"{name}.csv", catalog))
    assert len(far) == 4000
    assert far.max() <= session.reach
    assert far.max() > 0.75 * session.reach
    told = re.search(r"was ([\d.]+) m to ([\d.]+) m", page.get_by_text("in 4000 random poses").inner_text())
    assert told
    assert [float(each) for each in told.groups()] == pytest.approx([far.min(), far.max()], rel=1e-3)
    button.click()
    page.wait_for_function("!document.querySelector('.arm-view').scene.getObjectByName('workspace')")
