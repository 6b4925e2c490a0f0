"""`fk`, `fk_all` and `jacobian` of tables and robots, against Pinocchio, differences and the publishers' poses."""

from collections.abc import Callable
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import dh2urdf
from dh2urdf.errors import RecordError, RecordValueError
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.rotations import RigidTransform
from reference_arms import ReferenceRobot

Function = Callable[[NDArray[np.float64]], NDArray[np.float64]]

ROWS = (
    DHRow(joint="turn", link="column", a=0.1, alpha=0.4, d=0.2, theta=0.3, offset=-0.5, sign=-1),
    DHRow(joint="slide", link="carriage", type=JointType.PRISMATIC, a=-0.2, alpha=-1.1, d=0.05, offset=0.1, sign=-1),
    DHRow(joint="weld", link="plate", type=JointType.FIXED, a=0.15, alpha=2.0, d=-0.1, theta=1.2),
    DHRow(joint="spin", link="hand", type=JointType.CONTINUOUS, a=0.05, alpha=-0.7, d=0.3, theta=0.7),
)
MIXED = Manipulator(
    name="mixed",
    convention=Convention.STANDARD,
    rows=ROWS,
    base=RigidTransform.from_xyz_rpy((0.1, -0.2, 0.3), (0.4, -0.5, 0.6)),
    tool=RigidTransform.from_xyz_rpy((0.02, 0.03, 0.1), (-0.3, 0.2, 0.1)),
)
ARMS = [replace(MIXED, convention=convention) for convention in Convention]
Q = np.random.default_rng(5).uniform(-1, 1, (7, 3))


def differences(function: Function, q: NDArray[np.float64], step: float = 1e-6) -> NDArray[np.float64]:
    """The Jacobian of poses by central differences; W = dR/dq Rᵀ is the matrix of the angular velocity."""
    columns = []
    for number in range(q.shape[-1]):
        change = np.zeros(q.shape[-1])
        change[number] = step
        rate = (function(q + change) - function(q - change)) / (2 * step)
        spin = rate[..., :3, :3] @ np.swapaxes(function(q)[..., :3, :3], -1, -2)
        angular = [spin[..., 2, 1], spin[..., 0, 2], spin[..., 1, 0]]
        columns.append(np.stack([*np.moveaxis(rate[..., :3, 3], -1, 0), *angular], axis=-1))
    return np.stack(columns, axis=-1)


class TestJacobian:
    @pytest.mark.parametrize("arm", ARMS, ids=lambda arm: str(arm.convention))
    def test_is_what_differences_say(self, arm: Manipulator) -> None:
        """Of tables and of their robots, with turned and sliding joints, a fixed row, base and tool."""
        found = arm.jacobian(Q)
        assert found.shape == (7, 6, 3)
        np.testing.assert_allclose(found, differences(arm.fk, Q), atol=1e-8)
        robot = dh2urdf.convert(arm).robot
        np.testing.assert_allclose(robot.jacobian(Q), found, atol=1e-12)
        hand = robot.jacobian(Q, "hand")
        np.testing.assert_allclose(hand, differences(lambda q: robot.fk(q, "hand"), Q), atol=1e-8)

    def test_is_pinocchio_s(self, reference_robot: ReferenceRobot) -> None:
        """In the frame LOCAL_WORLD_ALIGNED, of every reference robot."""
        pinocchio: Any = pytest.importorskip("pinocchio")
        arm = reference_robot.manipulator
        model = pinocchio.buildModelFromXML(dh2urdf.convert(arm).text)
        data, frame = model.createData(), model.getFrameId("tool0")
        joints = [model.joints[model.getJointId(row.joint)] for row in arm.moving_rows]
        q = np.asarray(reference_robot.q)[:5]
        for vector, found in zip(q, arm.jacobian(q), strict=True):
            configuration = pinocchio.neutral(model)
            for joint, value in zip(joints, vector, strict=True):
                # A continuous joint has the cosine and the sine of its angle in the configuration.
                configuration[joint.idx_q : joint.idx_q + joint.nq] = (
                    value if joint.nq == 1 else (np.cos(value), np.sin(value))
                )
            theirs = pinocchio.computeFrameJacobian(
                model, data, configuration, frame, pinocchio.ReferenceFrame.LOCAL_WORLD_ALIGNED
            )
            columns = [joint.idx_v for joint in joints]
            np.testing.assert_allclose(found, np.reshape(theirs, (6, model.nv))[:, columns], atol=1e-9)


class TestAllLinks:
    @pytest.mark.parametrize("arm", ARMS, ids=lambda arm: str(arm.convention))
    def test_of_a_table_are_the_dh_frames(self, arm: Manipulator) -> None:
        """The base, the frame after each row, and tool0, in that order."""
        poses = arm.fk_all(Q)
        assert list(poses) == ["base_link", "column", "carriage", "plate", "hand", "tool0"]
        np.testing.assert_array_equal(poses["base_link"], np.broadcast_to(np.eye(4), (7, 4, 4)))
        np.testing.assert_array_equal(poses["tool0"], arm.fk(Q))
        for count, moving in ((1, 1), (2, 2), (3, 2), (4, 3)):
            part = replace(arm, rows=ROWS[:count], tool=RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0)))
            np.testing.assert_allclose(poses[ROWS[count - 1].link], part.fk(Q[:, :moving]), atol=1e-15)

    def test_of_a_robot_are_those_of_each_link(self) -> None:
        """Every link, at the joints that move it."""
        robot = dh2urdf.convert(MIXED).robot
        poses = robot.fk_all(Q)
        assert list(poses) == [link.name for link in robot.links]
        values = dict(zip(("turn", "slide", "spin"), Q.T, strict=True))
        for link, pose in poses.items():
            np.testing.assert_allclose(pose, np.broadcast_to(robot.fk(values, link), (7, 4, 4)), atol=1e-15)


class TestJointVectors:
    def test_may_name_the_joints(self) -> None:
        """In any order; a value for each, or arrays that go together."""
        by_name = {"spin": Q[:, 2], "turn": Q[:, 0], "slide": Q[:, 1]}
        np.testing.assert_array_equal(MIXED.fk(by_name), MIXED.fk(Q))
        assert MIXED.fk({"turn": Q[:, 0], "slide": 0.1, "spin": 0}).shape == (7, 4, 4)
        np.testing.assert_array_equal(MIXED.jacobian(by_name), MIXED.jacobian(Q))
        assert MIXED.fk({"turn": 0, "slide": 0, "spin": 0, "weld": 0}, full=True).shape == (4, 4)

    def test_may_be_labelled_arrays(self) -> None:
        """The labels count, not the places: of a DataFrame, a Series and a structured array."""
        pandas: Any = pytest.importorskip("pandas")
        frame = pandas.DataFrame({"spin": Q[:, 2], "turn": Q[:, 0], "slide": Q[:, 1]})
        np.testing.assert_array_equal(MIXED.fk(frame), MIXED.fk(Q))
        np.testing.assert_array_equal(MIXED.fk(frame.iloc[1]), MIXED.fk(Q[1]))
        np.testing.assert_array_equal(MIXED.fk(pandas.DataFrame(Q)), MIXED.fk(Q))
        structured = np.zeros(7, dtype=[("slide", float), ("spin", float), ("turn", float)])
        for number, name in enumerate(("turn", "slide", "spin")):
            structured[name] = Q[:, number]
        np.testing.assert_array_equal(MIXED.fk(structured), MIXED.fk(Q))

    def test_are_exact_at_quarter_turns(self) -> None:
        """One vector of quarter turns has zeros where there are zeros."""
        planar = replace(MIXED, rows=[DHRow(joint="j", link="l", a=1, alpha=0, d=0)], base=np.eye(4), tool=np.eye(4))  # type: ignore[arg-type]
        assert planar.fk([np.pi / 2])[:3, 3].tolist() == [0.0, 1.0, 0.0]

    @pytest.mark.parametrize(
        "q",
        [
            [1, 0, 1],
            (Fraction(1), 0, 1),
            np.array([1, 0, 1], dtype=np.float32),
            np.array([1, 0, 1], dtype=object),
            {"turn": np.int64(1), "slide": Fraction(0), "spin": np.float32(1)},
        ],
        ids=lambda q: type(q).__name__,
    )
    def test_are_numbers_of_any_type(self, q: Any) -> None:
        """The same pose as that of floats."""
        np.testing.assert_array_equal(MIXED.fk(q), MIXED.fk([1.0, 0.0, 1.0]))

    @pytest.mark.parametrize(
        ("code", "q"),
        [
            ("not-a-joint-vector", 0.1),
            ("entries-not-joints", []),
            ("entries-not-joints", np.zeros((3, 2))),
            ("rows-of-other-lengths", [[0, 0, 0], [0, 0]]),
            ("joint-value-infinite", [0, float("nan"), 0]),
            ("joint-value-infinite", np.array([[0, 0, 0], [0, 0, np.inf]])),
            *(("values-no-numbers", q) for q in (["0", "0", "0"], [True, 0.0, 0.0], None, [1j, 0, 0])),
            *(("values-no-numbers", q) for q in (np.zeros(3, dtype="m8[s]"), {"turn": "0", "slide": 0, "spin": 0})),
            ("values-masked", np.ma.masked_array([0.0, 0.0, 0.0], mask=[0, 1, 0])),
            ("joint-value-missing", {"turn": 0, "slide": 0}),
            ("joint-unknown", {"turn": 0, "slide": 0, "spni": 0}),
            ("joint-unknown", {"turn": 0, "slide": 0, "spin": 0, "weld": 0}),
            ("values-of-other-shapes", {"turn": [0, 0], "slide": [0, 0, 0], "spin": 0}),
        ],
    )
    def test_that_are_not_surely_meant_are_refused(self, code: str, q: Any) -> None:
        """By every function, of tables and of robots; the error is a TypeError or a ValueError, too."""
        robot = dh2urdf.convert(MIXED).robot
        for function in (MIXED.fk, MIXED.fk_all, MIXED.jacobian, robot.fk, robot.fk_all, robot.jacobian):
            with pytest.raises(RecordError) as raised:
                function(q)
            assert raised.value.problems[0].code == code
            assert isinstance(raised.value, TypeError if code.startswith("values-no") else (TypeError, ValueError))

    def test_of_a_link_may_name_further_joints(self) -> None:
        """Those of the robot that do not move the link; no others."""
        robot = dh2urdf.convert(MIXED).robot
        every = {"turn": 0.1, "slide": 0.2, "spin": 0.3}
        np.testing.assert_array_equal(robot.fk(every, "column"), robot.fk([0.1], "column"))
        with pytest.raises(RecordValueError, match="no value is given for turn"):
            robot.fk({"spin": 0.3}, "column")
        with pytest.raises(RecordValueError, match="did you mean 'column'"):
            robot.fk(every, "colunm")

    def test_whose_pose_is_not_finite_are_refused(self) -> None:
        """Numbers that overflow are no pose."""
        huge = replace(MIXED, rows=[replace(ROWS[0], a=1e308, d=1e308), replace(ROWS[3], a=1e308)])
        with np.errstate(all="ignore"), pytest.raises(RecordValueError, match="the pose is not finite"):
            huge.fk([0.0, 0.0])
