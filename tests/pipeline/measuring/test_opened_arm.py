"""What dh2urdf measures of an arm that a loader has opened: joints, masses and poses, as the simulator has them."""

import math
import pickle
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from dh2urdf.errors import LoaderError
from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.measuring import load_function, load_opened
from dh2urdf.robot import Inertial
from dh2urdf.stages import Loader, LoadReport, LoadRequest, NoOptions, SimulatedArm
from dh2urdf.testing import plain_robot, reference_manipulators
from dh2urdf.testing.oracle import table_pose

ARM = reference_manipulators()[0]
ROBOT = plain_robot(ARM)


def pose(link: str, q: Sequence[float]) -> Any:
    """T(root → link) by the walk of the robot, as an array."""
    values = {joint.name: value for joint, value in zip(ROBOT.moving_joints, q, strict=True)}
    return as_matrices(link_poses(ROBOT, values)[link])


RIGHT = SimulatedArm(
    simulator="Paper",
    version="2",
    pose=pose,
    joints=[
        {"name": joint.name, "type": joint.type.value, "axis": list(joint.axis), "lower": joint.limits.lower}
        for joint in ROBOT.moving_joints
    ],
    bodies={link.name: link.inertial or Inertial(mass=0.0) for link in ROBOT.links},
)


@pytest.fixture(name="request_")
def _request(tmp_path: Path) -> LoadRequest:
    """The poses of tool0 are those of the oracle's matrices of the table."""
    count = len(ROBOT.moving_joints)
    poses = tuple(tuple(0.1 * (step + number) for number in range(count)) for step in range(4))
    expected = tuple(tuple(number for row in table_pose(ARM, q) for number in row) for q in poses)
    return LoadRequest(path=tmp_path / "arm.urdf", robot=ROBOT, poses=poses, expected={"tool0": expected})


def test_the_right_arm_is_reported(request_: LoadRequest) -> None:
    report = load_opened(lambda *_: RIGHT, request_, None)
    assert (report.simulator, report.version, report.poses) == ("Paper", "2", 4)
    assert report.position_error is not None
    assert report.position_error < 1e-12
    assert report.mass == pytest.approx(math.fsum(link.inertial.mass for link in ROBOT.links if link.inertial))
    assert [joint["name"] for joint in report.joints] == [joint.name for joint in ROBOT.moving_joints]
    pickle.dumps(report)


def test_what_the_simulator_does_not_tell_is_not_compared(request_: LoadRequest) -> None:
    names = [{"name": joint.name} for joint in ROBOT.moving_joints]
    report = load_opened(lambda *_: replace(RIGHT, joints=names, bodies=None), request_, None)
    assert report.mass is None
    assert report.poses == 4


def aside(link: str, q: Sequence[float]) -> Any:
    moved = np.array(pose(link, q))
    moved[0, 3] += 1e-6
    return moved


HEAVY = {name: replace(body, mass=body.mass + 0.001) for name, body in (RIGHT.bodies or {}).items()}
NAN = {name: replace(body, mass=math.nan) for name, body in (RIGHT.bodies or {}).items()}


@pytest.mark.parametrize(
    ("wrong", "code"),
    [
        ({"pose": aside}, "tip-elsewhere"),
        ({"pose": lambda *_: np.full((4, 4), math.nan)}, "tip-elsewhere"),
        ({"bodies": HEAVY}, "link-differs"),
        ({"bodies": NAN}, "link-differs"),
        ({"bodies": {}}, "link-lost"),
        ({"joints": RIGHT.joints[1:]}, "joint-lost"),
        ({"joints": [*RIGHT.joints, {"name": "thumb"}]}, "joint-not-written"),
        ({"joints": [{**RIGHT.joints[0], "lower": -9.0}, *RIGHT.joints[1:]]}, "joint-differs"),
        ({"joints": [{**RIGHT.joints[0], "lower": math.nan}, *RIGHT.joints[1:]]}, "joint-differs"),
        ({"joints": [{**RIGHT.joints[0], "effort": None}, *RIGHT.joints[1:]]}, "joint-differs"),
    ],
)
def test_another_arm_is_refused_and_closed(request_: LoadRequest, wrong: dict[str, Any], code: str) -> None:
    closed: list[bool] = []
    arm = replace(RIGHT, close=lambda: closed.append(True), **wrong)
    with pytest.raises(LoaderError) as refused:
        load_opened(lambda *_: arm, request_, None)
    assert {problem.code for problem in refused.value.problems} == {code}
    assert closed == [True]


def test_a_tolerance_is_the_simulators_own(request_: LoadRequest) -> None:
    report = load_opened(lambda *_: replace(RIGHT, pose=aside, tolerance=1e-5), request_, None)
    assert report.position_error == pytest.approx(1e-6, rel=1e-3)
    assert report.tolerance is not None
    assert report.tolerance > 1e-6


def test_a_pose_is_four_rows_of_four(request_: LoadRequest) -> None:
    with pytest.raises(ValueError, match=r"rows of \[3, 3, 3\] numbers; accepted: four rows of four"):
        load_opened(lambda *_: replace(RIGHT, pose=lambda *_: np.eye(3)), request_, None)


def test_the_function_of_a_loader_is_its_own_or_that_of_what_it_opens() -> None:
    function = load_function(Loader(name="paper", summary="s", options=NoOptions, open=opened))
    assert function.__qualname__ == "opened"  # what messages call it
    assert pickle.loads(pickle.dumps(function)).args == (opened,)  # noqa: S301 - our own
    report = LoadReport(simulator="paper", version="1")
    assert load_opened(lambda *_: report, None, None) is report  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="open returned int, neither a SimulatedArm nor a LoadReport"):
        load_opened(lambda *_: 3, None, None)  # type: ignore[arg-type, return-value]


def opened(_request: LoadRequest, _options: NoOptions) -> SimulatedArm:
    return RIGHT
