"""Inverse kinematics: what it reaches, and that limits are kept; manipulability, singular values and margins."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

import dh2urdf
from dh2urdf import Convention, DHRow, JointType, Limits, Manipulator, RigidTransform
from dh2urdf.kinematics.inverse import dexterity
from reference_arms import ReferenceRobot

TABLES = Path(__file__).parents[3] / "configs" / "tables"


def bounds(arm: Manipulator) -> tuple[Any, Any]:
    limits = [row.limits for row in arm.moving_rows]
    lower = np.array([-np.inf if each.lower is None else each.lower for each in limits])
    upper = np.array([np.inf if each.upper is None else each.upper for each in limits])
    return lower, upper


def joint_vectors(arm: Manipulator, count: int) -> Any:
    """Random ones inside the limits; a turn where there are none."""
    lower, upper = bounds(arm)
    lower, upper = np.maximum(lower, -np.pi), np.minimum(upper, np.pi)
    return np.random.default_rng(5).uniform(lower, upper, (count, len(lower)))


def check(arm: Manipulator, found: dh2urdf.InverseSolution, pose: Any) -> None:
    """What a solution claims is what forward kinematics has, and it is inside the limits."""
    lower, upper = bounds(arm)
    assert np.all((lower <= found.q) & (found.q <= upper))
    there = arm.fk(found.q)
    assert np.linalg.norm(there[:3, 3] - pose[:3, 3]) == pytest.approx(found.position_error, abs=1e-12)


def test_every_published_arm_reaches_what_it_can(reference_robot: ReferenceRobot) -> None:
    """From a joint vector nearby and from nowhere: within a rounding, inside the limits."""
    arm = reference_robot.manipulator
    lower, upper = bounds(arm)
    for q in joint_vectors(arm, 4):
        pose = arm.fk(q)
        near = np.clip(q + np.random.default_rng(1).normal(0.0, 0.1, len(q)), lower, upper)
        found = dh2urdf.inverse_kinematics(arm, pose, near)
        check(arm, found, pose)
        assert found.reached
        assert found.position_error <= 1e-9 * max(1.0, float(np.abs(pose[:3, 3]).max()) * 10.0)
        assert found.angle_error <= 1e-9


def test_the_table_knows_the_pose_without_a_start() -> None:
    """The middle of the limits, and random joint vectors, always the same: the same solution each time."""
    arm = dh2urdf.read(TABLES / "ur5.csv")
    for q in joint_vectors(arm, 20):
        found = dh2urdf.inverse_kinematics(arm, arm.fk(q))
        assert found.reached
        assert found == dh2urdf.inverse_kinematics(arm, arm.fk(q))


@pytest.mark.parametrize("table", ["ur5.csv", "stanford.csv", "scara.csv"])
def test_what_cannot_be_reached_is_approached(table: str) -> None:
    """As near as an optimiser of scipy comes from ten starts: lengths as parts of the distance, and turns."""
    arm = dh2urdf.read(TABLES / table)
    lower, upper = bounds(arm)
    pose = np.eye(4)
    pose[:3, 3] = 10.0, 4.0, 3.0
    far = float(np.linalg.norm(pose[:3, 3]))
    found = dh2urdf.inverse_kinematics(arm, pose)
    check(arm, found, pose)
    assert not found.reached

    def left(q: Any) -> Any:
        there = arm.fk(q)
        turn = Rotation.from_matrix(pose[:3, :3] @ there[:3, :3].T).as_rotvec()
        return np.concatenate([(pose[:3, 3] - there[:3, 3]) / far, turn])

    starts = np.clip(joint_vectors(arm, 10), lower + 1e-6, upper - 1e-6)
    best = min(2.0 * least_squares(left, start, bounds=(lower, upper)).cost for start in starts)
    assert (found.position_error / far) ** 2 + found.angle_error**2 <= best * (1.0 + 1e-6)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-3.0, 3.0), min_size=6, max_size=6))
def test_a_stretched_arm_gives_numbers(start: list[float]) -> None:
    """At a singularity, straight up and 5 cm out of reach: finite numbers inside the limits, from wherever it begins."""
    arm = dh2urdf.read(TABLES / "ur5.csv")
    pose = np.array(arm.fk([0.0, -np.pi / 2, 0.0, 0.0, 0.0, 0.0]))
    pose[2, 3] += 0.05
    found = dh2urdf.inverse_kinematics(arm, pose, start, attempts=1)
    assert np.isfinite([*found.q, found.position_error, found.angle_error]).all()
    check(arm, found, pose)


def test_a_target_is_followed() -> None:
    """One attempt from the solution before: small steps of the tool are small steps of the joints."""
    arm = dh2urdf.read(TABLES / "ur5.csv")
    q = [0.3, -1.2, 1.4, -1.0, -1.5, 0.2]
    pose = np.array(arm.fk(q))
    for _ in range(30):
        pose[0, 3] += 0.002
        found = dh2urdf.inverse_kinematics(arm, pose, q, attempts=1)
        assert found.reached
        assert np.abs(np.subtract(found.q, q)).max() < 0.05
        q = list(found.q)


def test_limits_hold() -> None:
    """A slide that would have to leave its range stays at the end of it, and the answer says how much is missing."""
    row = DHRow(
        joint="slide", link="carriage", type=JointType.PRISMATIC, a=0, alpha=0, d=0, limits=Limits(lower=0, upper=0.5)
    )
    arm = Manipulator(name="slide", convention=Convention.STANDARD, rows=(row,))
    found = dh2urdf.inverse_kinematics(arm, RigidTransform.from_xyz_rpy((0.0, 0.0, 0.8)))
    assert found.q == (0.5,)
    assert found.position_error == pytest.approx(0.3)
    assert not found.reached
    free = replace(arm, rows=(replace(row, limits=Limits()),))
    assert dh2urdf.inverse_kinematics(free, RigidTransform.from_xyz_rpy((0.0, 0.0, 0.8))).reached


@pytest.mark.parametrize("x", [2.0, -2.0, -0.1])
def test_no_joint_turns_round_for_nothing(x: float) -> None:
    """Limits of ±2π allow a whole turn, which leads to the same pose as none."""
    arm = dh2urdf.read(TABLES / "ur5.csv")
    pose = arm.fk([0.0] * 6).copy()
    pose[0, 3] = x
    found = dh2urdf.inverse_kinematics(arm, pose, [0.0] * 6)
    lower, upper = bounds(arm)
    for joint, value in enumerate(found.q):
        nearer = value - np.sign(value) * 2.0 * np.pi
        assert abs(value) <= abs(nearer) or not lower[joint] <= nearer <= upper[joint]
    check(arm, found, pose)


# --- Dexterity --------------------------------------------------------------------------------------------------------


def row(number: int, a: float, kind: JointType, limits: Limits) -> DHRow:
    return DHRow(joint=f"j{number}", link=f"l{number}", type=kind, a=a, alpha=0.0, d=0.0, limits=limits)


def two_links(upper: float | None = None) -> Manipulator:
    kind = JointType.CONTINUOUS if upper is None else JointType.REVOLUTE
    limits = Limits() if upper is None else Limits(lower=-1.0, upper=upper)
    rows = tuple(row(number, a, kind, limits) for number, a in enumerate((0.5, 0.3)))
    return Manipulator(name="planar", convention=Convention.STANDARD, rows=rows)


@pytest.mark.parametrize("elbow", [0.4, -1.2, math.pi / 2, math.pi])
def test_the_dexterity_of_two_links(elbow: float) -> None:
    """The Jacobian of a planar arm has the columns of lever arms; its singular values follow by hand."""
    found = dexterity(two_links(), [0.7, elbow])
    lever = np.array([[0.5 * math.sin(elbow), 0.3 + 0.5 * math.cos(elbow), 1.0], [0.0, 0.3, 1.0]])
    small, large = np.sqrt(np.linalg.eigvalsh(lever @ lever.T).clip(0.0))
    assert found.manipulability == pytest.approx(small * large, abs=1e-15)
    assert found.smallest_singular_value == pytest.approx(small, abs=1e-15)
    assert found.margins == {}


def test_a_ur5_at_its_singularities() -> None:
    """Wrist (q5 = 0), elbow (q3 = 0): a singular value is 0; elsewhere none is."""
    arm = dh2urdf.read(TABLES / "ur5.csv")
    for q in ([0.3, -1.0, 0.9, 0.2, 0.0, 0.4], [0.3, -1.0, 0.0, 0.2, 0.7, 0.4]):
        found = dexterity(arm, q)
        assert found.smallest_singular_value < 1e-15
        assert found.manipulability < 1e-15
    assert dexterity(arm, [0.3, -1.0, 0.9, 0.2, 0.7, 0.4]).smallest_singular_value > 0.05


def test_the_manipulability_of_seven_joints() -> None:
    """The root of det(J Jᵀ), after Yoshikawa."""
    arm = dh2urdf.read(TABLES / "panda.yaml")
    q = [0.1, 0.2, 0.3, -1.2, 0.4, 1.5, 0.6]
    jacobian = arm.jacobian(q)
    assert dexterity(arm, q).manipulability == pytest.approx(math.sqrt(np.linalg.det(jacobian @ jacobian.T)), rel=1e-9)


def test_margins_are_those_of_the_nearer_limit() -> None:
    """Negative outside; by name or by position."""
    arm = two_links(upper=2.0)
    assert dexterity(arm, [0.0, 1.5]).margins == {"j0": 1.0, "j1": 0.5}
    assert dexterity(arm, {"j0": -1.25, "j1": 2.5}).margins == {"j0": -0.25, "j1": -0.5}
