"""What a dragged link moves, held against the poses of the links."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
import pytest

from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.stages.foreign_robot import Follower
from dh2urdf_studio.drawing.parts import Grip
from dh2urdf_studio.viewing import View, load_figures

if TYPE_CHECKING:
    from pathlib import Path

    from dh2urdf.plugin_system.catalog import Catalog

ROBOT = """<robot name="r">
<link name="base"/><link name="arm"/><link name="slide"/><link name="hand"/><link name="wheel"/><link name="finger"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.2" rpy="0.3 0 0"/>
  <axis xyz="0 1 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="push" type="prismatic"><parent link="arm"/><child link="slide"/><origin xyz="0.3 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-0.2" upper="0.5" effort="1" velocity="1"/></joint>
<joint name="glue" type="fixed"><parent link="slide"/><child link="hand"/><origin xyz="0.1 0 0"/></joint>
<joint name="roll" type="continuous"><parent link="hand"/><child link="wheel"/><axis xyz="0 0 1"/></joint>
<joint name="copy" type="revolute"><parent link="base"/><child link="finger"/><axis xyz="0 0 1"/><origin xyz="0 0.4 0"/>
  <limit lower="-9" upper="9" effort="1" velocity="1"/><mimic joint="turn" multiplier="-2" offset="0.1"/></joint></robot>"""


@pytest.mark.parametrize(
    ("link", "moved"),
    [
        ("arm", ("turn", 0.4, 0.6)),
        ("arm", ("turn", 5.0, 1.0)),  # no farther than the limit
        ("hand", ("push", -0.15, -0.05)),
        ("slide", ("push", 0.2, 0.3)),
        ("wheel", ("roll", 6.0, 0.3 + 6.0 - 2 * math.pi)),  # round and round
        ("finger", ("turn", -0.6, 0.5)),  # it follows at twice the speed, the other way
        ("base", (None, 1.0, 0.0)),
    ],
)
def test_a_link_moves_as_far_as_it_is_dragged(
    tmp_path: Path, catalog: Catalog, link: str, moved: tuple[str | None, float, float]
) -> None:
    joint, by, value = moved
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT)
    view = View(load_figures([path], catalog))
    view.move({"turn": 0.2, "push": 0.1, "roll": 0.3})
    before, places = dict(view.q), view.drawing.poses(view.q)
    names = [node.name for node in view.drawing.nodes]
    view.drag(link, 0.3 * by, begins=True)
    view.drag(link, by, begins=False)
    if joint is None:
        assert view.q == before
        return
    assert view.q[joint] == pytest.approx(value)
    grip = view.drawing.grips[link]
    if abs(view.q[joint] - before[joint]) < abs(by) - 1e-9:  # at a limit, or it has gone round
        return
    carrier = as_matrices(places[names.index(grip.carrier)])
    axis = carrier[:3, :3] @ grip.axis / np.linalg.norm(grip.axis)
    old, new = (as_matrices(poses[names.index(link)]) for poses in (places, view.drawing.poses(view.q)))
    if grip.slides:
        assert np.abs(new[:3, 3] - old[:3, 3] - by * axis).max() < 1e-9
    else:
        turn = new[:3, :3] @ old[:3, :3].T
        skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        assert np.abs(turn - (np.eye(3) + math.sin(by) * skew + (1 - math.cos(by)) * skew @ skew)).max() < 1e-9


@pytest.mark.parametrize(("by", "reached"), [(0.3, True), (-0.1, True), (-5.0, False)])
def test_a_link_that_follows_by_a_parabola_moves_as_far_as_it_is_dragged(by: float, *, reached: bool) -> None:
    """By b = 0.1 + a + a²; it turns back at -0.15, and is not dragged beyond."""
    grip = Grip("a", "b", (0.0, 0.0, 1.0), slides=False, is_endless=False, followers=(Follower("a", 1.0, 0.1, (1.0,)),))
    value = grip.value(0.2, by)
    if reached:
        assert 0.1 + value + value * value == pytest.approx(0.1 + 0.2 + 0.04 + by)
    else:
        assert value == 0.2
