import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dh2urdf.kinematics import KinematicChain
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import JointType, Limits
from dh2urdf.robot import Box, Joint, Link, Origin, Robot, Visual
from dh2urdf_plugins.loaders.viewpoint import FIELD_OF_VIEW, HEIGHT, WIDTH, Frames, JointVector, View, best_view

LIMITS = Limits(lower=-2.0, upper=2.0)
BAR = (0.5, 0.1, 0.1)


def arm(size: float = 1.0, limits: Limits = LIMITS) -> Robot:
    """Two bars in a row, the first turning about z, the second about y, of any size."""
    along_x = Origin(xyz=(size * BAR[0] / 2, 0.0, 0.0))
    bar = (Visual(geometry=Box(size=(size * BAR[0], size * BAR[1], size * BAR[2])), origin=along_x),)
    knee = Origin(xyz=(size * BAR[0], 0.0, 0.0))
    revolute = {"type": JointType.REVOLUTE, "limits": limits}
    return Robot(
        name="arm",
        links=(Link(name="base_link"), Link(name="first", visuals=bar), Link(name="second", visuals=bar)),
        joints=(
            Joint(name="hip", parent="base_link", child="first", **revolute),
            Joint(name="knee", parent="first", child="second", origin=knee, axis=(0.0, 1.0, 0.0), **revolute),
        ),
    )


def frames(robot: Robot, q: JointVector) -> Frames:
    chains = {link.name: KinematicChain.between(robot, robot.root, link.name) for link in robot.links}
    return {name: chain.forward_kinematics(q[: len(chain.joints)]) for name, chain in chains.items()}


def view_of(robot: Robot) -> View:
    return best_view(robot, lambda q: frames(robot, q))


def corners(robot: Robot, q: JointVector, size: float) -> np.ndarray:
    """The corners of both bars in the world, of shape (16, 3)."""
    ends = np.array(list(product((0.0, BAR[0]), (-BAR[1] / 2, BAR[1] / 2), (-BAR[2] / 2, BAR[2] / 2)))) * size
    poses = [as_matrices(frames(robot, q)[name]) for name in ("first", "second")]
    return np.concatenate([ends @ pose[:3, :3].T + pose[:3, 3] for pose in poses])


@given(size=st.floats(0.01, 100.0))
def test_all_of_the_arm_is_seen_and_large(size: float) -> None:
    """Through a pinhole at the camera's place, the arm lies within the picture and reaches nearly to its border."""
    robot = arm(size)
    view = view_of(robot)
    backward = np.subtract(view.eye, view.target) / view.distance
    assert np.linalg.norm(backward) == pytest.approx(1.0)
    right = np.cross((0.0, 0.0, 1.0), backward)
    right /= np.linalg.norm(right)
    x, y, z = np.array([right, np.cross(backward, right), backward]) @ (corners(robot, view.q, size) - view.eye).T
    tangent = math.tan(FIELD_OF_VIEW / 2)
    share = np.maximum(np.abs(x / z) / (tangent * WIDTH / HEIGHT), np.abs(y / z) / tangent)
    assert (z < 0).all()
    assert 0.8 < share.max() < 1.0


def test_box_and_floor_enclose_the_arm() -> None:
    """The box around the arm is that of its corners and its root; the floor lies under all of it."""
    robot = arm()
    view = view_of(robot)
    points = np.vstack([corners(robot, view.q, 1.0), np.zeros(3)])
    assert view.low == pytest.approx(points.min(axis=0))
    assert view.high == pytest.approx(points.max(axis=0))
    (x, y, z), half = view.floor
    assert z == view.low[2]
    assert x - half < view.low[0] < view.high[0] < x + half
    assert y - half < view.low[1] < view.high[1] < y + half


@pytest.mark.parametrize(("lower", "upper"), [(-0.1, 0.1), (1.2, 2.0), (-2.0, -1.2)])
def test_pose_is_inside_the_limits(lower: float, upper: float) -> None:
    """No joint is shown where it cannot go."""
    q = view_of(arm(limits=Limits(lower=lower, upper=upper))).q
    assert all(lower <= value <= upper for value in q)
