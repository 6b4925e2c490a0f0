import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

from dh2urdf.kinematics import dh_frames
from dh2urdf.manipulator import Limits, LinkGeometry, Manipulator
from dh2urdf.robot import Box, Cylinder, Link, Origin, Robot, Sphere, Visual
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    Z_AXIS,
    RigidTransform,
    add,
    cross,
    norm,
    rotate,
    scale,
    subtract,
)
from dh2urdf_plugins.transforms.shapes import AHEAD, BARREL, BARREL_LENGTH, CAP, CAP_LENGTH, TUBE

Table = Callable[..., Manipulator]
RobotOf = Callable[..., Robot]

FRAMES = pytest.mark.parametrize("frames", ["aligned", "dh"])
HALF_PI = math.pi / 2


def link(robot: Robot, name: str) -> Link:
    return next(link for link in robot.links if link.name == name)


def ends(shape: Any) -> set[tuple[float, ...]]:
    """The two ends of a cylinder, or of a box along its z axis, in the link's frame [m]."""
    half = 0.5 * (shape.geometry.length if isinstance(shape.geometry, Cylinder) else shape.geometry.size[2])
    frame = shape.origin.transform
    points = [frame @ RigidTransform(IDENTITY_ROTATION, (0.0, 0.0, z)) for z in (-half, half)]
    return {tuple(round(number, 9) + 0.0 for number in point.translation) for point in points}


def with_limits(manipulator: Manipulator, **limits: float) -> Manipulator:
    """The table with other limits of its last joint."""
    *before, last = manipulator.rows
    return replace(manipulator, rows=(*before, replace(last, limits=Limits(**limits))))


@pytest.mark.parametrize("convention", ["standard", "modified"])
@pytest.mark.parametrize("shape", ["cylinder", "box"])
def test_a_link_is_an_l_of_its_segments(convention: str, shape: str, table: Table, robot_of: RobotOf) -> None:
    """One body from the joint along d, one from there along a to the next joint."""
    rows = [{"d": 0.5, "a": 0.3}, {}] if convention == "standard" else [{"d": 0.5}, {"a": 0.3}]
    robot = robot_of(table(*rows, convention=convention), shape=shape)
    offset, normal = link(robot, "link_1").visuals
    assert ends(offset) == {(0, 0, 0), (0, 0, 0.5)}
    assert ends(normal) == {(0, 0, 0.5), (0.3, 0, 0.5)}
    kind = Cylinder if shape == "cylinder" else Box
    assert isinstance(offset.geometry, kind)


@FRAMES
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_the_shapes_of_an_arm_hang_together(frames: str, convention: str, table: Table, robot_of: RobotOf) -> None:
    """Drawn at q = 0, each segment begins where the one before ends, from the base to the tool, in every frame."""
    rows = [{"d": 0.5, "alpha": 0.3, "theta": 0.4}, {"a": 0.3, "d": -0.2, "alpha": 0.5, "theta": -1.1}, {"a": 0.2}]
    robot = robot_of(table(*rows, convention=convention), frames=frames)
    pose = IDENTITY
    at = (0.0, 0.0, 0.0)
    for joint in robot.joints[:-2]:
        pose = pose @ joint.origin.transform
        segments = link(robot, joint.child).visuals[joint.parent == "base_link" :]
        for shape in segments:
            placed = replace(shape, origin=_origin(pose @ shape.origin.transform))
            here = {end for end in ends(placed) if math.dist(end, at) < 1e-8}
            if shape.geometry.length_formula:
                assert here, (joint.child, at, ends(placed))
                (at,) = ends(placed) - here
    tool = pose @ robot.joints[-1].origin.transform
    assert at == pytest.approx(tool.translation, abs=1e-8)


def _origin(transform: RigidTransform) -> Origin:
    return Origin(xyz=transform.translation, rpy=transform.rpy)


def test_a_link_without_segments_is_a_joint_housing(table: Table, robot_of: RobotOf) -> None:
    """It is as long as it is thick and has nothing that could touch."""
    robot = robot_of(table({"d": 0.5}, {"alpha": HALF_PI}, {"d": 0.5}))
    (housing,) = link(robot, "link_2").visuals
    assert housing.geometry == Cylinder(radius=0.04, length=0.08)
    assert link(robot, "link_2").collisions == ()


@FRAMES
def test_a_rail_runs_from_lower_to_upper(frames: str, table: Table, robot_of: RobotOf) -> None:
    """The link before a prismatic joint carries the rail and a foot that reaches it; the link itself is a carriage."""
    robot = robot_of(
        with_limits(table({"d": 0.5}, {"type": "prismatic", "offset": 0.1}), lower=0.2, upper=1.0), frames=frames
    )
    _, rail, foot = link(robot, "link_1").visuals
    assert ends(rail) == {(0, 0, 0.8), (0, 0, 1.6)}
    assert ends(foot) == {(0, 0, 0.5), (0, 0, 0.8)}
    assert rail.geometry.radius == foot.geometry.radius == pytest.approx(0.5 * 0.04)
    (carriage,) = link(robot, "link_2").visuals
    assert carriage.origin.xyz == pytest.approx((0, 0, 0.1))


def test_collisions_are_a_radius_shorter_at_each_end(table: Table, robot_of: RobotOf) -> None:
    """So neighbours do not touch; what would vanish is left out."""
    robot = robot_of(table({"d": 0.5, "a": 0.079}, {"a": 0.3}))
    (collision,) = link(robot, "link_1").collisions
    assert ends(collision) == {(0, 0, 0.04), (0, 0, 0.46)}
    assert link(robot, "base_link_inertia").collisions == ()


@pytest.mark.parametrize(
    ("rows", "radius"),
    [
        ([{"d": 0.5}], 0.04),
        ([{"d": 0.1}, {"a": -0.2}], 0.02),
        ([{}], 0.04),
        ([{}, {"type": "prismatic", "limits": Limits(lower=0.2, upper=0.3)}], 0.01),
    ],
)
def test_the_default_radius_fits_the_arm(
    rows: list[dict[str, Any]], radius: float, table: Table, robot_of: RobotOf
) -> None:
    """0.04 m, or a tenth of the longest segment; an arm without segments has no scale."""
    assert link(robot_of(table(*rows)), "link_1").visuals[0].geometry.radius == pytest.approx(radius)


def test_the_row_goes_before_the_table_and_the_table_before_the_run(table: Table, robot_of: RobotOf) -> None:
    """Whoever is nearest to the link decides on its radius; the table decides on the shape."""
    rows = ({"d": 0.5}, {"d": 0.5, "radius": 0.01})
    said = table(*rows, geometry=LinkGeometry(shape="box", radius=0.02))
    robot = robot_of(said, radius=0.03, shape="cylinder")
    assert [link(robot, name).visuals[0].geometry.size[0] for name in ("link_1", "link_2")] == [0.04, 0.02]
    assert link(robot_of(table(*rows), radius=0.03), "link_1").visuals[0].geometry == Cylinder(radius=0.03, length=0.5)


@pytest.mark.parametrize(
    ("row", "ends"),
    [
        ({"d": 0.5, "a": 0.3}, [(0, 0, 0), (0, 0, 0.5), (0.3, 0, 0.5)]),
        ({"d": 0.5}, [(0, 0, 0), (0, 0, 0.5)]),
        ({"a": 0.3}, [(0, 0, 0), (0.3, 0, 0)]),
        ({"d": 0.5, "a": 0.3, "type": "prismatic"}, [(0, 0, 0.5), (0, 0, 0.5), (0.3, 0, 0.5)]),
    ],
    ids=["both", "d", "a", "a sliding joint"],
)
def test_a_capsule_has_one_sphere_where_two_segments_meet(
    row: dict[str, Any], ends: list[tuple[float, ...]], table: Table, robot_of: RobotOf
) -> None:
    """Two cylinders and three spheres make an L, one cylinder has a sphere at each end; what touches has no caps."""
    robot = robot_of(table(row, {}), shape="capsule")
    body = link(robot, "link_1")
    assert [visual.origin.xyz for visual in body.visuals if isinstance(visual.geometry, Sphere)] == ends
    assert all(isinstance(collision.geometry, Cylinder) for collision in body.collisions)
    (housing,) = link(robot, "link_2").visuals
    assert isinstance(housing.geometry, Sphere)


@FRAMES
@pytest.mark.parametrize("convention", ["standard", "modified"])
def test_an_arm_has_a_housing_at_each_joint(frames: str, convention: str, table: Table, robot_of: RobotOf) -> None:
    """A cylinder with two caps along the axis that the DH product gives, off to the side where d leads; none at a fixed row.

    Tubes are thinner, and a ball rounds the corner of an L.
    """
    r = 0.04
    arm = table(
        {"d": 0.5, "a": 0.3, "alpha": 0.7},
        {"d": -0.2, "alpha": -1.1, "theta": 0.4, "a": 0.1, "sign": -1},
        {"alpha": 0.2},
        {"type": "fixed", "d": 0.1},
        convention=convention,
    )
    robot = robot_of(arm, shape="arm", frames=frames, radius=r)
    dh = dh_frames(arm, [0.0, 0.0, 0.0])
    ahead = (0.5 * BARREL_LENGTH + CAP_LENGTH, -AHEAD, 0.0)  # in radii: the first housing stands on the base
    pose = IDENTITY
    for number, joint in enumerate(robot.joints[-6:-2]):  # behind the base's come those of the four rows
        pose = pose @ joint.origin.transform
        visuals = link(robot, joint.child).visuals
        barrels = [visual for visual in visuals if getattr(visual.geometry, "radius", 0) == BARREL * r]
        assert len(barrels) == (number < 3)
        if not barrels:
            continue
        frame = dh[number] if convention == "standard" else dh[number + 1]
        axis = rotate(frame.rotation, Z_AXIS)
        back = 0.0 if convention == "standard" else arm.rows[number].d
        middle = add(frame.translation, scale(ahead[number] * r - back, axis))
        for visual, offset in ((barrels[0], {0.0}), *((cap, {-0.047, 0.047}) for cap in housing_caps(visuals, r))):
            placed = pose @ visual.origin.transform
            away = subtract(placed.translation, middle)
            assert min(norm(subtract(away, scale(by, axis))) for by in offset) < 1e-12
            assert norm(cross(rotate(placed.rotation, Z_AXIS), axis)) < 1e-12
        assert len(housing_caps(visuals, r)) == 2
        tubes = {visual.geometry.radius for visual in visuals} - {BARREL * r, CAP * r}
        assert tubes <= {TUBE * r}
    balls = [body.name for body in robot.links for visual in body.visuals if isinstance(visual.geometry, Sphere)]
    assert balls == (["link_1", "link_2"] if convention == "standard" else ["link_1"])


def housing_caps(visuals: tuple[Visual, ...], r: float) -> list[Visual]:
    return [visual for visual in visuals if getattr(visual.geometry, "radius", 0) == CAP * r]
