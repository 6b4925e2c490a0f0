import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from plain_frames import tensor

from dh2urdf.errors import TransformError
from dh2urdf.kinematics import KinematicChain
from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, LinkGeometry, Manipulator, Payload
from dh2urdf.robot import Inertial, Robot
from dh2urdf.rotations import RigidTransform
from dh2urdf.source import Mark
from dh2urdf.testing.oracle import robot_pose
from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions
from dh2urdf_plugins.transforms.robots import alpha_swap

Table = Callable[..., Manipulator]
RobotOf = Callable[..., Robot]

GRAVITY = 9.81
MARK = Mark(file="arm.csv", line=3)


@pytest.mark.parametrize(
    ("row", "more", "code", "field"),
    [
        ({"limits": Limits(lower=0.0)}, {}, "limit-alone", "limits.upper"),
        ({"radius": -0.1}, {}, "not-above-0", "radius"),
        ({}, {"geometry": LinkGeometry(shape="cilinder")}, "shape-unknown", "geometry.shape"),
        ({}, {"base_geometry": LinkGeometry(radius=0.0)}, "not-above-0", "base.geometry.radius"),
        ({}, {"base_mass": -1.0}, "not-above-0", "base.mass"),
    ],
)
def test_a_table_that_makes_no_arm_is_refused(
    row: dict[str, Any], more: dict[str, Any], *, code: str, field: str, table: Table, robot_of: RobotOf
) -> None:
    """The error names the field, and of a row the joint and its place."""
    with pytest.raises(TransformError) as caught:
        robot_of(table({"d": 0.1}, row | {"mark": MARK}, **more))
    (problem,) = caught.value.problems
    assert (problem.code, problem.field, problem.robot) == (code, field, "arm")
    assert (problem.joint, problem.mark) == (("joint_2", MARK) if row else (None, None))


def test_shapes_without_a_mass_that_a_double_holds_are_refused(table: Table, robot_of: RobotOf) -> None:
    with pytest.raises(TransformError) as caught:
        robot_of(table({"a": 0.3, "radius": 1e-200}))
    (problem,) = caught.value.problems
    assert (problem.code, problem.joint, problem.field) == ("shapes-too-small", "joint_1", "radius")


def body(robot: Robot, name: str) -> Inertial:
    inertial = next(link.inertial for link in robot.links if link.name == name)
    assert inertial is not None
    return inertial


# Limits.


def test_limits_that_nobody_gave_are_filled_in(table: Table, robot_of: RobotOf) -> None:
    """±2π rad and π rad/s, half the longest link and 1 m/s; continuous without bounds; a fixed joint has none."""
    kinds = ("revolute", "prismatic", "continuous", "fixed")
    joints = robot_of(table(*({"type": kind, "d": 0.1} for kind in kinds))).joints[1:5]
    revolute, prismatic, continuous, fixed = (joint.limits for joint in joints)
    assert (revolute.lower, revolute.upper, revolute.velocity) == (-math.tau, math.tau, math.pi)
    assert (prismatic.lower, prismatic.upper, prismatic.velocity) == (-0.05, 0.05, 1.0)
    assert (continuous.lower, continuous.upper, continuous.velocity) == (None, None, math.pi)
    assert fixed == Limits()


@pytest.mark.parametrize(
    ("rows", "half"),
    [
        ([{"a": 0.2, "d": 0.15}, {"a": -0.12}], 0.1),
        ([{"a": 0.2}, {"d": -0.4337}], 0.21),
        ([{"a": 0.001999}], 0.00099),
        ([{}], 1.0),
    ],
)
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_the_travel_that_nobody_gave_is_the_longest_link(
    rows: list[dict[str, Any]], half: float, convention: str, table: Table, robot_of: RobotOf
) -> None:
    """Half of it to each side, rounded down to two digits: no rail is longer than the links. ±1 m without a length."""
    robot = robot_of(table(*rows, {"type": "prismatic"}, {}, convention=convention))
    limits = robot.joints[len(rows) + 1].limits
    assert (limits.lower, limits.upper) == (-half, half)
    longest = max(abs(row.get(name, 0.0)) for row in rows for name in ("a", "d"))
    lengths = [getattr(visual.geometry, "length", 0.0) for link in robot.links for visual in link.visuals]
    assert max(lengths) <= (longest or 2.0)


def test_the_default_effort_of_a_level_arm_is_twice_its_static_load(table: Table, robot_of: RobotOf) -> None:
    """Two links of 10 kg and 1 m: the shoulder bears g·(10·0.5 + 10·1.5), the elbow g·10·0.5, rounded up."""
    arm = robot_of(table({"a": 1.0, "mass": 10.0}, {"a": 1.0, "mass": 10.0}))
    assert [joint.limits.effort for joint in arm.moving_joints] == [400.0, 99.0]
    assert pytest.approx(392.4) == 2 * GRAVITY * 20
    assert pytest.approx(98.1) == 2 * GRAVITY * 5


lengths = st.floats(-1, 1)
angles = st.floats(-3, 3)


@st.composite
def arms(draw: st.DrawFn) -> Manipulator:
    kinds = st.sampled_from([JointType.REVOLUTE, JointType.PRISMATIC, JointType.FIXED])
    rows = []
    for i in range(draw(st.integers(1, 5))):
        kind = draw(kinds)
        rows.append(
            DHRow(
                joint=f"j{i}",
                link=f"l{i}",
                type=kind,
                a=draw(lengths),
                alpha=draw(angles),
                d=draw(lengths),
                theta=draw(angles),
                mass=draw(st.floats(1, 20)),
                com=(draw(lengths), draw(lengths), draw(lengths)),
                limits=Limits() if kind is JointType.FIXED else Limits(lower=-0.7, upper=0.9),
            )
        )
    return Manipulator(name="arm", convention=draw(st.sampled_from(Convention)), rows=tuple(rows))


@given(arms(), st.integers(0, 99))
def test_no_posture_and_no_mounting_needs_more_than_half_the_default_effort(arm: Manipulator, seed: int) -> None:
    """The static load, computed from the written robot, stays below the bound in whatever direction gravity points."""
    robot = alpha_swap(arm, AlphaSwapOptions(frames="dh" if seed % 2 else "aligned"))
    rng = np.random.default_rng(seed)
    for _ in range(5):
        q = [rng.uniform(-0.7, 0.9) for _ in robot.moving_joints]
        axes, masses = [], []
        for joint in robot.joints[:-2]:
            pose = robot_pose(robot, q, robot.root, joint.child)
            axes.append((joint, pose[:3, 3], pose[:3, :3] @ joint.axis))
            link = body(robot, joint.child)
            masses.append((link.mass, (pose @ [*link.com, 1])[:3]))
        gravity = rng.normal(size=3)
        gravity *= GRAVITY / np.linalg.norm(gravity)
        for i, (joint, place, axis) in enumerate(axes):
            force = sum(mass * gravity for mass, _ in masses[i:])
            torque = sum(mass * np.cross(com - place, gravity) for mass, com in masses[i:])
            load = abs(axis @ (force if joint.type is JointType.PRISMATIC else torque))
            if joint.type is not JointType.FIXED:
                assert joint.limits.effort is not None
                assert 2 * load <= joint.limits.effort * (1 + 1e-9)


# Masses.


def test_a_computed_mass_is_density_times_volume(table: Table, robot_of: RobotOf) -> None:
    """The table's density goes before the option's."""
    rows = [{"a": 1.0, "radius": 0.1}]
    volume = math.pi * 0.01
    assert body(robot_of(table(*rows)), "link_1").mass == pytest.approx(2700 * volume)
    assert body(robot_of(table(*rows), density=1000.0), "link_1").mass == pytest.approx(1000 * volume)
    dense = table(*rows, density=500.0)
    assert body(robot_of(dense, density=1000.0), "link_1").mass == pytest.approx(500 * volume)


def test_a_link_of_two_segments_has_the_mass_properties_of_both(table: Table, robot_of: RobotOf) -> None:
    """Equal legs of an L: the centre of mass lies between their centres, and the L has a product of inertia."""
    leg, r, mass = 1.0, 0.1, 2.0
    link = body(robot_of(table({"d": leg, "a": leg, "radius": r, "mass": 2 * mass})), "link_1")
    assert link.com == pytest.approx((0.25, 0.0, 0.75))
    across, along = mass / 12 * (3 * r * r + leg * leg), mass * r * r / 2
    shift = mass * 0.25**2
    expected = [
        [across + along + 2 * shift, 0, 2 * shift * -1],
        [0, 2 * across + 4 * shift, 0],
        [2 * shift * -1, 0, across + along + 2 * shift],
    ]
    np.testing.assert_allclose(tensor(link.inertia), expected, atol=1e-12)


def test_a_mass_alone_scales_the_inertia_of_the_shape(table: Table, robot_of: RobotOf) -> None:
    """Twice the mass in the same shape has twice the inertia; a centre of mass carries it along."""
    plain = body(robot_of(table({"a": 1.0})), "link_1")
    heavy = body(robot_of(table({"a": 1.0, "mass": 2 * plain.mass, "com": (0.0, 0.1, 0.0)})), "link_1")
    np.testing.assert_allclose(tensor(heavy.inertia), 2 * tensor(plain.inertia), rtol=1e-14)
    assert heavy.com == (1.0, 0.1, 0.0)


GIVEN = {"mass": 2.0, "com": (0.1, 0.2, 0.3), "inertia": Inertia(ixx=1.0, iyy=2.0, izz=2.5, ixy=0.1, ixz=0.2, iyz=0.3)}


@pytest.mark.parametrize("frames", ["aligned", "dh"])
@pytest.mark.parametrize("convention", Convention)
def test_given_mass_properties_hold_in_the_dh_frame_after_the_row(frames: str, convention: Convention) -> None:
    """Seen from base_link at q = 0, com and inertia are those of the table in DH frame i, in both frames."""
    row: dict[str, Any] = {"a": 0.3, "alpha": 0.4, "d": 0.5, "theta": 0.6}
    table = Manipulator(
        name="arm",
        convention=convention,
        base=RigidTransform.from_xyz_rpy((0.1, 0.2, 0.3), (0.4, 0.5, 0.6)),
        rows=tuple(DHRow(joint=f"j{i}", link=f"l{i}", **row, **(GIVEN if i == 1 else {})) for i in range(3)),
    )
    robot = alpha_swap(table, AlphaSwapOptions(frames=frames))
    pose = RigidTransform.from_xyz_rpy((0.0, 0.0, 0.0))
    for joint in robot.joints[:3]:
        pose = pose @ joint.origin.transform
    from dh2urdf.kinematics import forward_kinematics

    frame = forward_kinematics(replace(table, rows=table.rows[:2]), [0.0, 0.0])
    R, F = np.reshape(pose.rotation, (3, 3)), np.reshape(frame.rotation, (3, 3))
    link = body(robot, "l1")
    assert link.mass == 2.0
    np.testing.assert_allclose(R @ link.com + pose.translation, F @ GIVEN["com"] + frame.translation, atol=1e-14)
    np.testing.assert_allclose(
        R @ tensor(link.inertia) @ R.T,
        F @ tensor(GIVEN["inertia"]) @ F.T,
        atol=1e-14,  # type: ignore[arg-type]
    )


@pytest.mark.parametrize("frames", ["aligned", "dh"])
def test_a_payload_is_a_body_at_tool0(frames: str, ur5: Manipulator, robot_of: RobotOf) -> None:
    """As the table says it, in the axes of tool0; the joints' default efforts bear it."""
    tool = RigidTransform.from_xyz_rpy((0.0, 0.02, 0.1), (0.1, 0.2, 0.3))
    payload = Payload(mass=5.0, com=(0.0, 0.01, 0.05), inertia=Inertia(ixx=0.02, iyy=0.02, izz=0.01))
    alone, laden = (robot_of(replace(ur5, tool=tool, payload=p), frames=frames) for p in (None, payload))
    found = body(laden, "payload")
    assert (found.mass, found.com, found.inertia) == (payload.mass, payload.com, payload.inertia)
    origins = {joint.child: (joint.parent, joint.type, joint.origin) for joint in laden.joints}
    assert origins["payload"] == origins["tool0"]
    assert laden.mass == pytest.approx(alone.mass + 5.0, rel=1e-15)
    for lighter, heavier in zip(alone.moving_joints[:3], laden.moving_joints[:3], strict=True):
        assert (heavier.limits.effort or 0) > (lighter.limits.effort or 0)


@pytest.mark.parametrize("row", [{}, {"mass": 2.0}])
def test_the_base_weighs_what_the_table_says_or_what_its_shape_does(
    row: dict[str, Any], table: Table, robot_of: RobotOf
) -> None:
    """0 included; its shape is 1.5 radii wide and one radius high, of aluminium, whether the links have masses or not."""
    for said, weight in ((3.0, 3.0), (0.0, 0.0), (None, 2700.0 * math.pi * 0.06**2 * 0.04)):
        robot = robot_of(table({"d": 0.3, **row}, {"a": 0.4, **row}, base_mass=said))
        assert body(robot, "base_link_inertia").mass == pytest.approx(weight, rel=1e-12)


@pytest.mark.parametrize("frames", ["aligned", "dh"])
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_nothing_hangs_on_a_link_without_a_body(frames: str, convention: str, table: Table, robot_of: RobotOf) -> None:
    """sdformat would drop it: joints, flange and tool0 are on the last body, and every DH frame is where it was."""
    frame = {"type": "fixed", "mass": 0.0, "a": 0.1, "alpha": 0.4, "theta": -0.3, "d": 0.2}
    moving = {"a": 0.3, "alpha": 1.1, "d": 0.1, "mass": 2.0}
    arm = table(frame, moving, frame, frame, moving, {**moving, "type": "prismatic"}, frame, convention=convention)
    robot = robot_of(arm, frames=frames)
    bodies = {link.name for link in robot.links if link.inertial and link.inertial.mass}
    assert {joint.parent for joint in robot.joints[1:]} <= bodies
    q = [0.3, -0.7, 0.05]
    expected = np.array(arm.fk(q))
    pose = KinematicChain.between(robot, robot.root, "tool0").forward_kinematics(q)
    assert np.abs(np.reshape(pose.rotation, (3, 3)) - expected[:3, :3]).max() < 1e-12
    assert np.abs(np.array(pose.translation) - expected[:3, 3]).max() < 1e-12
