import math

import numpy as np
import pytest
from any_tables import ANGLES, LENGTHS, manipulators
from hypothesis import given, strategies as st
from plain_frames import homogeneous, shift, turn

from dh2urdf.kinematics import (
    KinematicChain,
    angle_error,
    axis_rotation,
    dh_transform,
    dh_transforms,
    forward_kinematics,
    pose_matrices,
    reach,
)
from dh2urdf.kinematics.expected_poses import Stretch
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.robot import Joint, Link, Origin, Robot
from dh2urdf.rotations import IDENTITY, ZERO, RigidTransform, rotation_from_rpy
from dh2urdf.testing.oracle import table_pose
from reference_arms import ReferenceRobot

STANDARD, MODIFIED = Convention.STANDARD, Convention.MODIFIED
ROUNDING = 2e-14
"""An angle within 1e-15 of quarter turns, relatively, is made one: 6e-15 rad at 2π, on a lever of 2 m."""
BOTH = pytest.mark.parametrize("convention", Convention)


# The oracle: homogeneous matrices as a textbook has them, multiplied by numpy.


@st.composite
def tables_with_q(draw: st.DrawFn) -> tuple[Manipulator, list[float]]:
    table = draw(manipulators())
    return table, [draw(LENGTHS) for _ in table.actuated_rows]


def arm(*rows: DHRow, convention: Convention = STANDARD, **more: RigidTransform) -> Manipulator:
    return Manipulator(name="arm", convention=convention, rows=rows, **more)


def row(number: int = 1, **fields: object) -> DHRow:
    return DHRow(**({"joint": f"j{number}", "link": f"l{number}", "a": 0.0, "alpha": 0.0, "d": 0.0} | fields))  # type: ignore[arg-type]


class TestPublishedRobots:
    def test_every_pose_is_the_published_one(self, reference_robot: ReferenceRobot) -> None:
        """T(q) is what each table's own publisher computes, to the rounding of the published numbers."""
        for q, pose in zip(reference_robot.q, reference_robot.poses, strict=True):
            found = homogeneous(forward_kinematics(reference_robot.manipulator, q))
            np.testing.assert_allclose(found, pose, rtol=0, atol=1e-12 * max(1, np.abs(pose).max()))


class TestRowTransform:
    @BOTH
    def test_quarter_turns_are_exact(self, convention: Convention) -> None:
        """Quarter turns of alpha and theta give the numbers −1, 0 and 1, with no noise of 6e-17."""
        for alpha in range(-4, 5):
            for theta in range(-4, 5):
                found = dh_transform(convention, a=0.25, alpha=alpha * math.pi / 2, d=0.5, theta=theta * math.pi / 2)
                assert set(found.rotation) <= {-1.0, 0.0, 1.0}
                assert set(map(abs, found.translation)) <= {0.0, 0.25, 0.5}

    @BOTH
    def test_a_nearly_quarter_turn_is_not_made_one(self, convention: Convention) -> None:
        """1.5708 is kept as given: nothing but rounding is ever snapped."""
        found = dh_transform(convention, a=0.0, alpha=1.5708, d=0.0, theta=0.0)
        assert found.rotation[8] == math.cos(1.5708) != 0.0


class TestForwardKinematics:
    @given(tables_with_q())
    def test_it_is_the_product_of_base_rows_and_tool(self, case: tuple[Manipulator, list[float]]) -> None:
        """T(q) = base · A_1 · … · A_N · tool, for any table of either convention and all joint types."""
        table, q = case
        np.testing.assert_allclose(
            homogeneous(forward_kinematics(table, q)),
            table_pose(table, q),
            rtol=0,
            atol=12 * ROUNDING * max(1, reach(table)),
        )

    @given(tables_with_q())
    def test_no_pose_is_beyond_the_reach(self, case: tuple[Manipulator, list[float]]) -> None:
        """tool0 is never further from base_link than the reach, prismatic travel aside."""
        table, q = case
        travel = Stretch(table).travel(dict(zip([row.joint for row in table.actuated_rows], q, strict=True)))
        assert math.hypot(*forward_kinematics(table, q).translation) <= (reach(table) + travel) * (1 + 1e-12) + 1e-12


class TestManyAtOnce:
    @BOTH
    def test_parameters_broadcast(self, convention: Convention) -> None:
        """Parameters of any shapes that broadcast give matrices of the common shape, each its row's own."""
        alpha, theta = np.linspace(-3, 3, 4), np.linspace(-3, 3, 5)
        found = dh_transforms(convention, a=0.3, alpha=alpha[:, None], d=0.1, theta=theta)
        assert found.shape == (4, 5, 4, 4)
        for i, j in np.ndindex(4, 5):
            single = row(a=0.3, alpha=alpha[i], d=0.1, theta=theta[j], type=JointType.FIXED)
            np.testing.assert_allclose(
                found[i, j], table_pose(arm(single, convention=convention), []), rtol=0, atol=1e-15
            )

    @pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0,)])
    def test_joint_vectors_of_any_leading_shape(self, shape: tuple[int, ...]) -> None:
        """Joint vectors of shape (..., n) give poses of shape (..., 4, 4)."""
        table = arm(row(a=1.0), row(2, type=JointType.PRISMATIC), row(3, type=JointType.FIXED, d=0.5))
        q = np.random.default_rng(1).uniform(-1, 1, (*shape, 2))
        found = pose_matrices(table, q)
        assert found.shape == (*shape, 4, 4)
        for index in np.ndindex(shape):
            np.testing.assert_allclose(found[index], table_pose(table, q[index]), rtol=0, atol=1e-15)


def chain_robot() -> Robot:
    """base_link –turns about y– one –slides along x– two –fixed– tool0, and a side branch."""
    return Robot(
        name="hand-built",
        links=tuple(Link(name=name) for name in ("base_link", "one", "side", "two", "tool0")),
        joints=(
            Joint(
                name="turn",
                type=JointType.CONTINUOUS,
                parent="base_link",
                child="one",
                origin=Origin(xyz=(0.0, 0.0, 1.0)),
                axis=(0.0, 1.0, 0.0),
            ),
            Joint(name="aside", type=JointType.REVOLUTE, parent="one", child="side"),
            Joint(
                name="slide",
                type=JointType.PRISMATIC,
                parent="one",
                child="two",
                origin=Origin(xyz=(0.0, 0.0, 0.5), rpy=(0.0, 0.0, math.pi / 2)),
                axis=(1.0, 0.0, 0.0),
            ),
            Joint(
                name="two-tool0", type=JointType.FIXED, parent="two", child="tool0", origin=Origin(xyz=(0.1, 0.0, 0.0))
            ),
        ),
    )


class TestKinematicChain:
    def test_it_holds_the_joints_from_root_to_tip(self) -> None:
        """A chain has the joints on the way from the root to the tip, in order, and no side branch."""
        chain = KinematicChain.between(chain_robot())
        assert [joint.name for joint in chain.joints] == ["turn", "slide", "two-tool0"]
        assert [joint.name for joint in KinematicChain.between(chain_robot(), tip="side").joints] == ["turn", "aside"]

    def test_a_hand_built_robot_moves_as_drawn(self) -> None:
        """Origins, axes and joint types mean what URDF says they mean."""
        angle, way = 0.7, 0.2
        expected = shift(z=1) @ turn("y", angle) @ shift(z=0.5) @ turn("z", math.pi / 2) @ shift(x=way) @ shift(x=0.1)
        found = KinematicChain.between(chain_robot()).forward_kinematics([angle, way])
        np.testing.assert_allclose(homogeneous(found), expected, rtol=0, atol=1e-15)

    def test_a_cycle_ends(self) -> None:
        """Joints in a circle give an error, not an endless search."""
        joints = tuple(
            Joint(name=f"{a}{b}", type=JointType.FIXED, parent=a, child=b)
            for a, b in ("ab", "bc", "ca", ("c", "tool0"))
        )
        with pytest.raises(ValueError, match="no chain"):
            KinematicChain.between(Robot(name="circle", links=(), joints=joints))


class TestAxisRotation:
    @given(angle=ANGLES, roll=ANGLES, pitch=ANGLES)
    def test_about_an_oblique_axis(self, angle: float, roll: float, pitch: float) -> None:
        """About an axis that a rotation R makes of z, it is R·Rz·Rᵀ."""
        R = np.reshape(rotation_from_rpy((roll, pitch, 0.0)), (3, 3))
        x, y, z = R[:, 2].tolist()
        found = np.reshape(axis_rotation((x, y, z), angle), (3, 3))
        np.testing.assert_allclose(found, R @ turn("z", angle)[:3, :3] @ R.T, rtol=0, atol=ROUNDING)


class TestErrors:
    @pytest.mark.parametrize("angle", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 0.5, 1.5, 2.5, 3.0])
    @pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 0.6, 0.8), (-0.6, 0.0, 0.8)])
    def test_an_angle_is_measured_to_its_last_digits(self, angle: float, axis: tuple[float, float, float]) -> None:
        """The angle between two frames is right where arccos of the trace loses half the digits."""
        turned = RigidTransform(axis_rotation(axis, angle), ZERO)
        assert angle_error(IDENTITY, turned) == pytest.approx(angle, rel=1e-6, abs=1e-16)
