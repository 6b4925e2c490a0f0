from __future__ import annotations

import json
import math
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
import pytest
import trimesh

from dh2urdf.kinematics import forward_kinematics, joint_variables
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Convention, Inertia, JointType
from dh2urdf.robot import Inertial, Joint, Link, Mesh, Origin, Robot, Visual
from dh2urdf.rotations import RigidTransform
from dh2urdf.table_text.texts import table_text
from dh2urdf_studio.drawing.parts import APART, PAPER
from dh2urdf_studio.drawing.scene import FRAME_SIZE, Drawing, Figure, extent, poses_as_json
from dh2urdf_studio.editing.reading import make

if TYPE_CHECKING:
    from conftest import ReferenceRobot

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.plugin_system import Catalog


def figure(arm: Manipulator, catalog: Catalog) -> Figure:
    robot = make(arm, "exact", table_text(arm), catalog)[0]
    assert robot is not None
    return Figure(robot=robot, manipulator=arm)


def test_links_and_frames_stand_where_the_table_has_them(reference_robot: ReferenceRobot, catalog: Catalog) -> None:
    """At published joint vectors tool0 and the last DH frame times tool are the published poses."""
    arm = reference_robot.manipulator
    drawing = Drawing.of([figure(arm, catalog)])
    names = [node.name for node in drawing.nodes]
    for q, published in zip(reference_robot.q, reference_robot.poses, strict=True):
        values = {row.joint: value for row, value in zip(arm.moving_rows, q, strict=True)}
        poses = dict(zip(names, drawing.poses(values), strict=True))
        assert np.allclose(as_matrices(poses["tool0"]), published, atol=1e-9)
        assert np.allclose(as_matrices(poses[f"frame {len(arm.rows)}"] @ arm.tool), published, atol=1e-9)


def test_flange_and_tool0_have_frames(reference_robots: list[ReferenceRobot], catalog: Catalog) -> None:
    """Both are shown with their names, and so are the DH frames; links stand in none of their own."""
    one = figure(reference_robots[0].manipulator, catalog)
    framed = [node for node in Drawing.of([one]).nodes if any(part.shape == "frame" for part in node.parts)]
    numbers = range(len(reference_robots[0].manipulator.rows) + 1)
    assert {node.label for node in framed} == {"flange", "tool0", *(f"{{{number}}}" for number in numbers)}


def test_strokes_are_the_parameters(reference_robot: ReferenceRobot, catalog: Catalog) -> None:
    """a and d lead from frame to frame along x and z; α turns z and θ turns x into that of the next frame, the right way."""
    arm = reference_robot.manipulator
    drawing = Drawing.of([figure(arm, catalog)])
    values = {row.joint: 0.1 * number + 0.2 for number, row in enumerate(arm.moving_rows)}
    poses = dict(zip((node.name for node in drawing.nodes), map(as_matrices, drawing.poses(values)), strict=True))
    is_standard = arm.convention is Convention.STANDARD
    for number, row in enumerate(arm.rows):
        before, after = poses[f"frame {number}"], poses[f"frame {number + 1}"]
        x, z = (after[:3, 0], before[:3, 2]) if is_standard else (before[:3, 0], after[:3, 2])
        theta, d = joint_variables(row, values.get(row.joint, 0.0))
        drawn = {stroke.field: np.array(stroke.points) for stroke in drawing.strokes(values) if stroke.row == number}
        at = before[:3, 3]
        for field, segment in (("d", d * z), ("a", row.a * x)) if is_standard else (("a", row.a * x), ("d", d * z)):
            assert (field in drawn) == bool(np.any(segment))
            if field in drawn:
                assert np.allclose(drawn[field], [at, at + segment], atol=1e-9)
            at = at + segment
        assert np.allclose(at, after[:3, 3], atol=1e-9)
        for field, angle, about, column in (("theta", theta, z, 0), ("alpha", row.alpha, x, 2)):
            turn = math.remainder(angle, 2 * math.pi)
            assert (field in drawn) == (abs(turn) >= 1e-6)
            if field in drawn:
                first, second, *_, last = drawn[field]
                radius = 0.8 * FRAME_SIZE * drawing.reach
                assert np.allclose(last - first, radius * (after[:3, column] - before[:3, column]), atol=1e-6)
                assert np.dot(np.cross(about, before[:3, column]), second - first) * turn > 0


def test_figures_stand_at_their_places(reference_robots: list[ReferenceRobot], catalog: Catalog) -> None:
    """Two robots of one kind have names of their own, and stand apart by their places."""
    from dataclasses import replace

    one = figure(reference_robots[0].manipulator, catalog)
    other = replace(one, name="other/", place=RigidTransform.from_xyz_rpy((0.0, 2.0, 0.0)))
    drawing = Drawing.of([one, other])
    poses = dict(zip((node.name for node in drawing.nodes), drawing.poses({}), strict=True))
    assert len(poses) == len(drawing.nodes)
    here, there = poses["tool0"].translation, poses["other/tool0"].translation
    assert np.allclose(np.subtract(there, here), [0, 2, 0])


def test_a_drawing_is_plain_json(reference_robots: list[ReferenceRobot], catalog: Catalog) -> None:
    """All that a browser is given is numbers and texts, twelve numbers for each node's pose."""
    drawing = Drawing.of([figure(reference_robots[0].manipulator, catalog)])
    sent = json.loads(json.dumps(drawing.as_json()))
    assert [node["name"] for node in sent["nodes"]] == [node.name for node in drawing.nodes]
    moved = json.loads(json.dumps(poses_as_json(drawing.poses({}), drawing.strokes({}))))
    assert len(moved["poses"]) == 12 * len(drawing.nodes)
    assert all(len(stroke["points"]) >= 2 for stroke in moved["strokes"])


def test_meshes_that_are_not_there_are_named() -> None:
    """The page names a mesh whose file nobody finds."""
    mesh = Visual(geometry=Mesh(filename="package://x/arm.stl"))
    robot = Robot(name="x", links=(Link(name="base", visuals=(mesh,)),), joints=())
    drawing = Drawing.of([Figure(robot=robot)])
    assert drawing.unseen == ("package://x/arm.stl",)
    assert [part.shape for node in drawing.nodes for part in node.parts] == []


def test_a_link_with_nothing_to_draw_is_sticks() -> None:
    """From its origin to the joints that it holds, as far as they are elsewhere."""
    links = tuple(Link(name=name) for name in ("root", "arm", "here"))
    joints = (
        Joint(name="a", type=JointType.FIXED, parent="root", child="arm", origin=Origin(xyz=(0.3, 0.0, 0.4))),
        Joint(name="b", type=JointType.FIXED, parent="root", child="here"),
    )
    drawing = Drawing.of([Figure(robot=Robot(name="x", links=links, joints=joints))])
    ((stick,),) = ([part for part in node.parts if part.layer == "links"] for node in drawing.nodes[:1])
    assert stick.size[1] == pytest.approx(0.5)
    x, y, z = stick.pose.translation
    assert (x, y, z) == pytest.approx((0.15, 0.0, 0.2))
    assert [stick.pose.rotation[k] for k in (2, 5, 8)] == pytest.approx([0.6, 0.0, 0.8])
    assert not any(part.layer == "links" for node in drawing.nodes[1:] for part in node.parts)


def test_a_mass_is_the_ellipsoid_of_its_inertia() -> None:
    """Of an ellipsoid of steel, whose mass and tensor trimesh integrates over triangles: the very ellipsoid.

    Its 20,480 triangles lie inside it, so they enclose a little less.
    """
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    body = trimesh.creation.icosphere(subdivisions=5)
    body.apply_transform(np.diag([0.1, 0.2, 0.3, 1.0]))
    body.apply_transform(np.block([[turn, np.array([[1.0], [2.0], [3.0]])], [np.zeros((1, 3)), np.ones((1, 1))]]))
    body.density = 7850.0
    t = body.moment_inertia
    inertia = Inertia(ixx=t[0, 0], iyy=t[1, 1], izz=t[2, 2], ixy=t[0, 1], ixz=t[0, 2], iyz=t[1, 2])
    inertial = Inertial(mass=body.mass, com=tuple(body.center_mass), inertia=inertia)
    drawing = Drawing.of([Figure(robot=Robot(name="x", links=(Link(name="base", inertial=inertial),), joints=()))])
    parts = {part.layer: part for node in drawing.nodes for part in node.parts}
    assert parts["masses"].pose.translation == pytest.approx((1.0, 2.0, 3.0))
    drawn = parts["inertias"]
    assert drawn.pose.translation == pytest.approx((1.0, 2.0, 3.0))
    axes = np.reshape(drawn.pose.rotation, (3, 3))
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert sorted(drawn.size) == pytest.approx([0.1, 0.2, 0.3], rel=1e-3)
    assert axes @ np.diag(np.square(drawn.size)) @ axes.T == pytest.approx(
        turn @ np.diag([0.01, 0.04, 0.09]) @ turn.T, abs=1e-4
    )


def test_an_inertia_that_no_body_has_is_no_ellipsoid() -> None:
    """Its centre of mass is drawn all the same."""
    inertial = Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=3.0))
    drawing = Drawing.of([Figure(robot=Robot(name="x", links=(Link(name="base", inertial=inertial),), joints=()))])
    assert {part.layer for node in drawing.nodes for part in node.parts} == {"masses"}


def test_the_extent_bounds_the_arm(reference_robot: ReferenceRobot, catalog: Catalog) -> None:
    """No published pose is farther away than the scene is made for."""
    arm = reference_robot.manipulator
    robot = figure(arm, catalog).robot
    for q in reference_robot.q:
        inside = all(
            row.limits.upper is None or (row.limits.lower or 0) <= x <= row.limits.upper
            for row, x in zip(arm.moving_rows, q, strict=True)
        )
        if inside:
            assert math.hypot(*forward_kinematics(arm, q).translation) <= extent(robot) + 1e-9


def test_an_axis_is_never_in_the_colour_of_its_links(reference_robots: list[ReferenceRobot], catalog: Catalog) -> None:
    """Axes of joints are told apart from the links that they join, whatever colour these have."""
    one = figure(reference_robots[0].manipulator, catalog)
    odd = [(0.9, 0.15, 0.55), (0.05, 0.7, 0.6), (0.93, 0.5, 0.13), (0.16, 0.42, 0.68), PAPER]
    for tint in (None, *odd):
        nodes = Drawing.of([replace(one, tint=tint)]).nodes
        colours = {part.colour for node in nodes for part in node.parts if part.layer == "links" and part.colour}
        axes = {part.colour for node in nodes for part in node.parts if part.layer == "axes" and part.colour}
        assert axes
        assert all(math.dist(axis, colour) >= APART for axis in axes for colour in colours)
