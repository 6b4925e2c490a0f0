import math
from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given, strategies as st

from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.measuring import DOUBLE, pose_error, reach, written_joint
from dh2urdf.robot import Collision, Inertial, Joint, Link, Origin, Robot, Sphere
from dh2urdf.rotations import RigidTransform, rotation_from_rpy
from dh2urdf_plugins.loaders.measures import Comparison, carriers, lumped_bodies, touching_pairs

angles = st.floats(-3.1, 3.1)


def chain(*kinds: JointType) -> Robot:
    """base_link, link_1, … link_N, tool0: solid links 0.3 m apart, joined by joints of these kinds."""
    names = ["base_link", *(f"link_{number + 1}" for number in range(len(kinds) - 1)), "tool0"]
    shape = (Collision(geometry=Sphere(radius=0.1)),)
    return Robot(
        name="chain",
        links=tuple(Link(name=name, collisions=shape) for name in names),
        joints=tuple(
            Joint(
                name=f"joint_{child}",
                type=kind,
                parent=parent,
                child=child,
                origin=Origin(xyz=(0.3, 0.0, 0.0)),
                limits=Limits(lower=-0.5, upper=0.2),
            )
            for kind, parent, child in zip(kinds, names, names[1:], strict=False)
        ),
    )


def test_reach_counts_offsets_and_rails() -> None:
    """The reach is the sum of the origins' lengths and the farther end of each rail."""
    assert reach(chain(JointType.REVOLUTE, JointType.PRISMATIC), "tool0") == pytest.approx(0.3 + 0.3 + 0.5)


@given(roll=angles, pitch=st.floats(-1.5, 1.5), yaw=angles, angle=st.floats(0.0, 3.1), size=st.floats(1e-9, 1.0))
def test_pose_error_is_distance_and_angle(roll: float, pitch: float, yaw: float, angle: float, size: float) -> None:
    """A pose that is moved by a length and turned by an angle differs by just these, small angles included."""
    frame = RigidTransform.from_xyz_rpy((1.0, 2.0, 3.0), (roll, pitch, yaw))
    turned = frame @ RigidTransform(rotation_from_rpy((0.0, 0.0, angle * size)), (0.0, size, 0.0))
    r, t = frame
    expected = (*r[0:3], t[0], *r[3:6], t[1], *r[6:9], t[2], 0.0, 0.0, 0.0, 1.0)
    distance, found = pose_error(turned, expected)
    assert math.isclose(distance, size, rel_tol=1e-6, abs_tol=1e-15)
    assert math.isclose(found, angle * size, rel_tol=1e-6, abs_tol=1e-15)


def test_neighbours_do_not_touch() -> None:
    """Links that a joint joins never collide, nor those that fixed joints hold together, nor their neighbours."""
    rigid_elbow = chain(JointType.REVOLUTE, JointType.FIXED, JointType.REVOLUTE, JointType.REVOLUTE)
    assert touching_pairs(rigid_elbow) == [
        ("base_link", "link_3"),
        ("base_link", "tool0"),
        ("link_1", "tool0"),
        ("link_2", "tool0"),
    ]


def test_links_are_carried_by_the_outermost_of_their_body() -> None:
    """Fixed joints, however many, make one body of the links that they hold together."""
    robot = chain(JointType.FIXED, JointType.FIXED, JointType.REVOLUTE, JointType.FIXED)
    assert {link: carrier for link, (carrier, _) in carriers(robot).items()} == {
        "base_link": "base_link",
        "link_1": "base_link",
        "link_2": "base_link",
        "link_3": "link_3",
        "tool0": "link_3",
    }


def test_bodies_are_lumped_about_their_common_centre() -> None:
    """Two balls 0.6 m apart on a turned stick weigh as one body: m·l²/4 each besides their own, by hand."""
    ball = Inertial(mass=2.0, inertia=Inertia(ixx=0.1, iyy=0.2, izz=0.3))
    upright = Origin(xyz=(0.6, 0.0, 0.0), rpy=(0.0, 0.0, math.pi / 2))
    robot = Robot(
        name="dumbbell",
        links=(Link(name="base_link"), Link(name="near", inertial=ball), Link(name="far", inertial=ball)),
        joints=(
            Joint(name="turn", type=JointType.REVOLUTE, parent="base_link", child="near"),
            Joint(name="stick", type=JointType.FIXED, parent="near", child="far", origin=upright),
        ),
    )
    lumped = lumped_bodies(robot)
    assert lumped["base_link"] == Inertial(mass=0.0)
    assert list(lumped) == ["base_link", "near"]
    assert (lumped["near"].mass, lumped["near"].com) == (4.0, pytest.approx((0.3, 0.0, 0.0)))
    inertia = lumped["near"].inertia
    across = 2 * 2.0 * 0.3 * 0.3
    assert (inertia.ixx, inertia.iyy, inertia.izz) == pytest.approx((0.3, 0.3 + across, 0.6 + across))
    assert (inertia.ixy, inertia.ixz, inertia.iyz) == pytest.approx((0.0, 0.0, 0.0))


# --- What differs


@pytest.fixture
def comparison(request_for: Any) -> Comparison:
    return Comparison("Sim", request_for(), DOUBLE)


def held_joints(comparison: Comparison) -> list[dict[str, Any]]:
    return [{"name": joint.name, **written_joint(joint)} for joint in comparison.robot.moving_joints]


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
    """The largest displacement is reported with its joint; an arm that flew apart moved without end."""
    start = (0.0, 0.0, 0.05, 0.0)
    hold, findings = comparison.hold(start, [0.0, 0.002, 0.001, 0.0], []).values()
    assert (hold["stayed"], hold["joint"], hold["largest_displacement"], findings) == (True, "elbow", 0.002, ())
    hold, (finding,) = comparison.hold(start, [0.0, 0.2, math.inf, 0.0], []).values()
    assert (hold["stayed"], hold["joint"], hold["largest_displacement"]) == (False, "slide", None)
    assert "this joint moved without end" in finding.message


def test_an_arm_that_is_strong_enough_was_let_down_by_the_solver(comparison: Comparison) -> None:
    """Gravity asks 2 kg at 0.2 m, 1 kg at 0.4 m and 0.7 kg at 0.8 m of the shoulder: 20 %  of its 60 N·m."""
    start = (0.0, 0.0, 0.05, 0.0)
    load = 9.81 * (2.0 * 0.2 + 1.0 * 0.4 + 0.7 * 0.8) / 60.0
    hold, (finding,) = comparison.hold(start, [0.0, 0.2, 0.0, 0.0], []).values()
    assert hold["largest_load"] == pytest.approx(load)
    assert "the solver gave way" in finding.message
    assert f"gravity asks at most {load:.0%} of any effort" in finding.message
    assert finding.field is None
    for weak, message in ((13.0, "the arm did not stay in place"), (14.0, "the solver gave way")):
        shoulder = comparison.robot.moving_joints[0]
        limits = replace(shoulder.limits, effort=weak)
        joints = [replace(each, limits=limits) if each == shoulder else each for each in comparison.robot.joints]
        other = Comparison("Sim", replace(comparison.request, robot=replace(comparison.robot, joints=tuple(joints))))
        _, (finding,) = other.hold(start, [0.2, 0.0, 0.0, 0.0], []).values()
        assert message in finding.message
