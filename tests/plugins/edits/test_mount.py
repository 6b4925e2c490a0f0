"""The edit `mount`: a frame on a fixed joint, with a box or without, and the optical frame of a camera."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import Cli
from lxml import etree

from dh2urdf.kinematics import link_poses
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.plugin_system import load
from dh2urdf.robot import Robot
from dh2urdf.testing import reference_manipulators
from dh2urdf_plugins.edits.mount import MountOptions, edit_robot

TABLE = "# convention: standard\na, alpha, d\n0.4, pi/2, 0.1\n0.3, 0, 0\n"


@pytest.fixture(scope="module", name="robot")
def _robot() -> Robot:
    transform = load().usual("transform")
    robot: Robot = transform.transform(reference_manipulators()[0], transform.options())
    return robot


def pose(robot: Robot, link: str) -> Any:
    return as_matrices(link_poses(robot, {})[link])


def test_a_camera_is_where_it_is_put(robot: Robot) -> None:
    """And looks along z of its optical frame, which is x of its body (REP 103); the arm itself stays as it was."""
    options = MountOptions(name="camera", xyz=(0.05, 0.0, 0.1), rpy=(0.0, -math.pi / 2, 0.0), optical=True)
    made = edit_robot(robot, options)
    assert made.links[: len(robot.links)] == robot.links
    assert made.joints[: len(robot.joints)] == robot.joints
    body, optical, tool = (pose(made, name) for name in ("camera", "camera_optical_frame", "tool0"))
    inside = np.linalg.inv(tool) @ body
    assert np.allclose(inside[:3, 3], [0.05, 0.0, 0.1], atol=1e-15)
    assert np.allclose(inside[:3, 0], [0.0, 0.0, 1.0], atol=1e-15)
    right, down, forward = (np.linalg.inv(body) @ optical)[:3, :3].T
    assert np.allclose([forward, right, down], [[1, 0, 0], [0, -1, 0], [0, 0, -1]], atol=1e-15)
    masses = [link.inertial.mass for link in made.links[len(robot.links) :] if link.inertial]
    assert masses == [0.0, 0.0]


def test_a_box_is_solid(robot: Robot) -> None:
    """m/12·(b² + c²), about its origin; seen, and touched."""
    link = edit_robot(robot, MountOptions(name="sensor", size=(0.1, 0.2, 0.3), mass=6.0)).links[-1]
    assert link.inertial is not None
    inertia = link.inertial.inertia
    assert inertia is not None
    assert (inertia.ixx, inertia.iyy, inertia.izz) == pytest.approx((0.065, 0.05, 0.025))
    assert link.inertial.mass == pytest.approx(6.0)
    assert len(link.visuals) == len(link.collisions) == 1


def test_angles_are_numbers_or_expressions(tmp_path: Path, cli: Cli) -> None:
    """As everywhere in a run file; what is no angle, or may be in degrees, is refused before anything is read."""
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(
        "inputs: arm.csv\noutput: out\nedits: {stage: mount, options: {name: camera, rpy: [-pi/2, 90 deg, 0.25]}}\n"
    )
    cli("run", tmp_path / "run.yaml")
    in_run = (tmp_path / "out" / "arm.urdf").read_bytes()
    in_radians = f"mount: {{name: camera, rpy: [{-math.pi / 2}, {math.pi / 2}, 0.25]}}"
    cli("convert", tmp_path / "arm.csv", "-o", tmp_path / "arm.urdf", "--edit", in_radians)
    assert (tmp_path / "arm.urdf").read_bytes() == in_run
    for word, message in (("half", "'half' cannot be read"), ("90", "if these are degrees, say so: '90 deg'")):
        edit = f"mount: {{name: camera, rpy: [{word}, 0, 0]}}"
        assert message in cli("convert", tmp_path / "arm.csv", "--edit", edit, status=2).stderr


def test_in_a_run(tmp_path: Path, cli: Cli) -> None:
    """In the order of the list: the second one is mounted on the first; every file is proved."""
    (tmp_path / "arm.csv").write_text(TABLE)
    (tmp_path / "run.yaml").write_text(
        "inputs: arm.csv\nemitters: [urdf, sdf, mjcf]\nedits:\n"
        "  - {stage: mount, options: {name: bracket, size: [0.02, 0.02, 0.1], mass: 0.3, xyz: [0, 0, 0.05]}}\n"
        "  - {stage: mount, options: {name: camera, parent: bracket, optical: true}}\n"
        "  - {stage: mount, options: {name: grasp, xyz: [0, 0, 0.2]}}\n"
    )
    cli("run", tmp_path / "run.yaml", "-o", tmp_path / "out")
    root = etree.parse(tmp_path / "out" / "arm.urdf").getroot()
    parents = {joint.find("child").get("link"): joint.find("parent").get("link") for joint in root.iter("joint")}
    assert parents["bracket"] == "tool0"
    assert parents["camera"] == "bracket"
    assert parents["grasp"] == parents["tool0"]
    assert parents["camera_optical_frame"] == "bracket"  # two frames without mass in a chain are no robot to simulators
