from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pytest

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics.mass import tensor
from dh2urdf.measuring import DOUBLE, Body, written_joint
from dh2urdf.rotations import IDENTITY
from dh2urdf_plugins.loaders.measures import Comparison


@pytest.fixture
def comparison(request_for: Any) -> Comparison:
    return Comparison("Sim", request_for(), DOUBLE)


def held_joints(comparison: Comparison) -> list[dict[str, Any]]:
    return [{"name": joint.name, **written_joint(joint)} for joint in comparison.robot.moving_joints]


def held_bodies(comparison: Comparison) -> dict[str, Body]:
    zero = Body(0.0, (0.0, 0.0, 0.0), (0.0,) * 9)
    return {
        link.name: Body(link.inertial.mass, link.inertial.com, tensor(link.inertial.inertia)) if link.inertial else zero
        for link in comparison.robot.links
    }


def test_nan_is_not_right(comparison: Comparison) -> None:
    """A limit, a mass, an inertia or a pose that is no number differs from every number."""
    joints = held_joints(comparison)
    joints[0]["lower"] = math.nan
    assert [problem.field for problem in comparison.joints(joints)] == ["lower"]
    bodies = held_bodies(comparison)
    bodies["hand"] = Body(math.nan, (math.nan, 0.0, 0.0), (math.nan,) * 9)
    assert [problem.field for problem in comparison.masses(bodies)[1]] == ["mass", "com", "inertia"]
    with pytest.raises(LoaderError, match="another place"):
        comparison.poses(lambda _q, _links: {"tool0": IDENTITY._replace(translation=(math.nan, 0.0, 0.0))})


def test_every_difference_is_told_at_once(comparison: Comparison) -> None:
    """Lost and unknown joints, and each property that differs, are problems of their own, by the joint's row."""
    joints = held_joints(comparison)
    joints[0] |= {"type": "continuous", "upper": None}
    joints[1]["name"] = "knee"
    problems = comparison.joints(joints)
    assert [(problem.joint, problem.field) for problem in problems] == [
        (None, None),
        ("shoulder", "type"),
        ("shoulder", "upper"),
        ("elbow", None),
    ]


def test_hold_names_the_joint_that_moved_most(comparison: Comparison) -> None:
    """The largest displacement is told with its joint; an arm that flew apart moved without end."""
    start = (0.0, 0.0, 0.05, 0.0)
    hold, findings = comparison.hold(start, [0.0, 0.002, 0.001, 0.0], [])
    assert (hold["stayed"], hold["joint"], hold["largest_displacement"], findings) == (True, "elbow", 0.002, ())
    hold, (finding,) = comparison.hold(start, [0.0, 0.2, math.inf, 0.0], [])
    assert (hold["stayed"], hold["joint"], hold["largest_displacement"]) == (False, "slide", None)
    assert "this joint moved without end" in finding.message


def test_an_arm_that_is_strong_enough_was_let_down_by_the_solver(comparison: Comparison) -> None:
    """Gravity asks 2 kg at 0.2 m, 1 kg at 0.4 m and 0.7 kg at 0.8 m of the shoulder: 20 %  of its 60 N·m."""
    start = (0.0, 0.0, 0.05, 0.0)
    load = 9.81 * (2.0 * 0.2 + 1.0 * 0.4 + 0.7 * 0.8) / 60.0
    hold, (finding,) = comparison.hold(start, [0.0, 0.2, 0.0, 0.0], [])
    assert hold["largest_load"] == pytest.approx(load)
    assert "the solver gave way" in finding.message
    assert f"gravity asks at most {load:.0%} of any effort" in finding.message
    assert finding.field is None
    for weak, message in ((13.0, "the arm did not stay in place"), (14.0, "the solver gave way")):
        shoulder = comparison.robot.moving_joints[0]
        limits = replace(shoulder.limits, effort=weak)
        joints = [replace(each, limits=limits) if each == shoulder else each for each in comparison.robot.joints]
        other = Comparison("Sim", replace(comparison.request, robot=replace(comparison.robot, joints=tuple(joints))))
        _, (finding,) = other.hold(start, [0.2, 0.0, 0.0, 0.0], [])
        assert message in finding.message
