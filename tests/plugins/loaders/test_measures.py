from __future__ import annotations

import math

import pytest
from hypothesis import given, strategies as st

from dh2urdf.manipulator import Inertia, JointType, Limits
from dh2urdf.measuring import pose_error, reach
from dh2urdf.robot import Collision, Inertial, Joint, Link, Origin, Robot, Sphere
from dh2urdf.rotations import RigidTransform, rotation_from_rpy
from dh2urdf_plugins.loaders.measures import carriers, lumped_bodies, touching_pairs

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
