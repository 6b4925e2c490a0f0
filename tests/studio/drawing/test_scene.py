"""What is drawn of robots, and what a dragged link moves: held against poses and published numbers."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh

from dh2urdf.kinematics import joint_variables
from dh2urdf.kinematics.chain import as_matrices
from dh2urdf.manipulator import Convention, Inertia, JointType, Limits, Manipulator
from dh2urdf.plugin_system import Catalog
from dh2urdf.robot import Box, Collision, Follower, Inertial, Joint, Link, Material, Mesh, Origin, Robot, Visual
from dh2urdf.rotations import RigidTransform
from dh2urdf.table_text.texts import table_text
from dh2urdf_studio.drawing.parts import APART, PAPER, Grip
from dh2urdf_studio.drawing.scene import FRAME_SIZE, Drawing, Figure
from dh2urdf_studio.editing.reading import make
from dh2urdf_studio.view_page import contents
from dh2urdf_studio.viewing import View, load_figures
from reference_arms import ReferenceRobot


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


def test_strokes_are_the_parameters(reference_robot: ReferenceRobot, catalog: Catalog) -> None:
    """A and d lead from frame to frame along x and z; α turns z and θ turns x into that of the next frame, the right way."""
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
    one = figure(reference_robots[0].manipulator, catalog)
    other = replace(one, name="other/", place=RigidTransform.from_xyz_rpy((0.0, 2.0, 0.0)))
    drawing = Drawing.of([one, other])
    poses = dict(zip((node.name for node in drawing.nodes), drawing.poses({}), strict=True))
    assert len(poses) == len(drawing.nodes)
    here, there = poses["tool0"].translation, poses["other/tool0"].translation
    assert np.allclose(np.subtract(there, here), [0, 2, 0])


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
    inertial = Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=3.0))  # which no body has
    drawing = Drawing.of([Figure(robot=Robot(name="x", links=(Link(name="base", inertial=inertial),), joints=()))])
    assert {part.layer for node in drawing.nodes for part in node.parts} == {"masses"}


def test_an_axis_is_never_in_the_colour_of_its_links(reference_robots: list[ReferenceRobot], catalog: Catalog) -> None:
    """Axes of joints stand out from the links that they join, whatever colour these have."""
    one = figure(reference_robots[0].manipulator, catalog)
    odd = [(0.9, 0.15, 0.55), (0.05, 0.7, 0.6), (0.93, 0.5, 0.13), (0.16, 0.42, 0.68), PAPER]
    for tint in (None, *odd):
        nodes = Drawing.of([replace(one, tint=tint)]).nodes
        colours = {part.colour for node in nodes for part in node.parts if part.layer == "links" and part.colour}
        axes = {part.colour for node in nodes for part in node.parts if part.layer == "axes" and part.colour}
        assert axes
        assert all(math.dist(axis, colour) >= APART for axis in axes for colour in colours)


# --- Links that are dragged -------------------------------------------------------------------------------------------

ROBOT = """<robot name="r">
<link name="base"/><link name="arm"/><link name="slide"/><link name="hand"/><link name="wheel"/><link name="finger"/>
<joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.2" rpy="0.3 0 0"/>
  <axis xyz="0 1 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="push" type="prismatic"><parent link="arm"/><child link="slide"/><origin xyz="0.3 0 0"/><axis xyz="1 0 0"/>
  <limit lower="-0.2" upper="0.5" effort="1" velocity="1"/></joint>
<joint name="glue" type="fixed"><parent link="slide"/><child link="hand"/><origin xyz="0.1 0 0"/></joint>
<joint name="roll" type="continuous"><parent link="hand"/><child link="wheel"/><axis xyz="0 0 1"/></joint>
<joint name="copy" type="revolute"><parent link="base"/><child link="finger"/><axis xyz="0 0 1"/><origin xyz="0 0.4 0"/>
  <limit lower="-9" upper="9" effort="1" velocity="1"/><mimic joint="turn" multiplier="-2" offset="0.1"/></joint></robot>"""


@pytest.mark.parametrize(
    ("link", "moved"),
    [
        ("arm", ("turn", 0.4, 0.6)),
        ("arm", ("turn", 5.0, 1.0)),  # no farther than the limit
        ("hand", ("push", -0.15, -0.05)),
        ("slide", ("push", 0.2, 0.3)),
        ("wheel", ("roll", 6.0, 0.3 + 6.0 - 2 * math.pi)),  # round and round
        ("finger", ("turn", -0.6, 0.5)),  # it follows at twice the speed, the other way
        ("base", (None, 1.0, 0.0)),
    ],
)
def test_a_link_moves_as_far_as_it_is_dragged(
    tmp_path: Path, catalog: Catalog, link: str, moved: tuple[str | None, float, float]
) -> None:
    joint, by, value = moved
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT)
    view = View(load_figures([path], catalog))
    view.move({"turn": 0.2, "push": 0.1, "roll": 0.3})
    before, places = dict(view.q), view.drawing.poses(view.q)
    names = [node.name for node in view.drawing.nodes]
    view.drag(link, 0.3 * by, begins=True)
    view.drag(link, by, begins=False)
    if joint is None:
        assert view.q == before
        return
    assert view.q[joint] == pytest.approx(value)
    grip = view.drawing.grips[link]
    if abs(view.q[joint] - before[joint]) < abs(by) - 1e-9:  # at a limit, or it has gone round
        return
    carrier = as_matrices(places[names.index(grip.carrier)])
    axis = carrier[:3, :3] @ grip.axis / np.linalg.norm(grip.axis)
    old, new = (as_matrices(poses[names.index(link)]) for poses in (places, view.drawing.poses(view.q)))
    if grip.slides:
        assert np.abs(new[:3, 3] - old[:3, 3] - by * axis).max() < 1e-9
    else:
        turn = new[:3, :3] @ old[:3, :3].T
        skew = np.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
        assert np.abs(turn - (np.eye(3) + math.sin(by) * skew + (1 - math.cos(by)) * skew @ skew)).max() < 1e-9


@pytest.mark.parametrize(("by", "reached"), [(0.3, True), (-0.1, True), (-5.0, False)])
def test_a_link_that_follows_by_a_parabola_moves_as_far_as_it_is_dragged(by: float, *, reached: bool) -> None:
    """By b = 0.1 + a + a²; it turns back at -0.15, and is not dragged beyond."""
    grip = Grip("a", "b", (0.0, 0.0, 1.0), slides=False, is_endless=False, law=Follower("a", 1.0, 0.1, (1.0,)))
    value = grip.value(0.2, by)
    if reached:
        assert 0.1 + value + value * value == pytest.approx(0.1 + 0.2 + 0.04 + by)
    else:
        assert value == 0.2


# --- The tree ---------------------------------------------------------------------------------------------------------


def test_links_from_the_root_with_all_that_they_hold() -> None:
    links = (
        Link(name="tip"),
        Link(
            name="finger",
            inertial=Inertial(mass=0.5, com=(0.0, 0.0, 0.1), inertia=Inertia(ixx=1e-3, iyy=2e-3, izz=1e-3)),
        ),
        Link(
            name="hand",
            visuals=(
                Visual(
                    geometry=Mesh(filename="package://lab/meshes/hand.dae", scale=(0.001, 0.001, 0.001)),
                    origin=Origin(xyz=(0.0, 0.0, 0.2), rpy=(math.pi / 2, 0.0, 0.0)),
                    material=Material(name="white", rgba=(1.0, 1.0, 1.0, 1.0)),
                ),
            ),
            collisions=(Collision(geometry=Box(size=(0.1, 0.2, 0.3))),),
        ),
        Link(name="loose"),
    )
    joints = (
        Joint(name="f", type=JointType.PRISMATIC, parent="hand", child="finger", limits=Limits(lower=0.0, upper=0.04)),
        Joint(
            name="t",
            type=JointType.REVOLUTE,
            parent="finger",
            child="tip",
            limits=Limits(lower=-math.pi, upper=1.0),
            follows=Follower("f", -2.0, 0.1, (0.0, -0.5)),
        ),
        Joint(name="l", type=JointType.FIXED, parent="hand", child="loose"),
    )
    one = Figure(
        robot=Robot(name="gripper", links=links, joints=joints),
        name="gripper/",
        title="gripper",
        loose={"l": "floating"},
    )
    found = contents(one)
    assert found["name"] == "gripper"
    assert {link["node"]: [f"{item['kind']} {item['text']}" for item in link["items"]] for link in found["links"]} == {
        "gripper/hand": [
            "frame the root",
            "visual mesh hand.dae × (0.001, 0.001, 0.001), white, xyz (0, 0, 0.2) m, rpy (90, 0, 0)°",
            "collision box 0.1 × 0.2 × 0.3 m",
        ],
        "gripper/finger": [
            "joint f: prismatic along (0, 0, 1), 0 m to 0.04 m",
            "frame xyz (0, 0, 0) m in hand",
            "mass 0.5 kg at (0, 0, 0.1) m; ixx, iyy, izz (0.001, 0.002, 0.001) kg·m²",
        ],
        "gripper/tip": [
            "joint t: revolute about (0, 0, 1), -180° to 57.3°, follows -2 · f + 0.1 − 0.5 · f³",
            "frame xyz (0, 0, 0) m in finger",
        ],
        "gripper/loose": ["joint l: floating, drawn as fixed", "frame xyz (0, 0, 0) m in hand"],
    }
    assert [link["name"] for link in found["links"]] == ["hand", "finger", "tip", "loose"]
