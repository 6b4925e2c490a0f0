import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import pytest

from dh2urdf.manipulator import Convention, DHRow, Inertia, JointType, Limits, LinkGeometry, Manipulator
from dh2urdf.robot import (
    Box,
    Collision,
    Cylinder,
    Inertial,
    Joint,
    Link,
    Material,
    Mesh,
    Origin,
    Parameter,
    Robot,
    Sphere,
    Visual,
)
from dh2urdf_plugins.transforms.alpha_swap import TRANSFORM

GREY = Material(name="grey", rgba=(0.5, 0.5, 0.5, 1.0))
ORANGE = Material(name="orange", rgba=(1.0, 0.5, 0.0, 1.0))
WEIGHTLESS = Inertial(mass=0.0)


@pytest.fixture
def arm() -> Robot:
    """An arm by hand that has one of everything: each joint type, each shape, formulas, dynamics, two frames."""
    return Robot(
        name="arm",
        comment="made by hand",
        parameters=(
            Parameter(name="d_1", value=0.089159, unit="m", joint="lift"),
            Parameter(name="a_2", value=-0.425, unit="m", joint="turn"),
            Parameter(name="alpha_2", value=-math.pi / 2, unit="rad", joint="turn"),
        ),
        links=(
            Link(name="base_link"),
            Link(
                name="base_link_inertia",
                inertial=Inertial(mass=4.0, com=(0.0, 0.0, 0.02), inertia=Inertia(ixx=0.25, iyy=0.25, izz=0.5)),
                visuals=(Visual(geometry=Cylinder(radius=0.06, length=0.04), material=GREY),),
            ),
            Link(
                name="link_1",
                inertial=Inertial(
                    mass=2.5, com=(-0.0, 1e-5, 1e-7), inertia=Inertia(ixx=1.0, iyy=1.5, izz=2.0, ixy=0.1, ixz=-0.2)
                ),
                visuals=(
                    Visual(
                        geometry=Cylinder(radius=0.04, length=0.425, length_formula="abs(a_2)"),
                        origin=Origin(
                            xyz=(-0.2125, 0.0, 0.0), rpy=(0.0, math.pi / 2, 0.0), xyz_formula=("0.5*a_2", "0", "0")
                        ),
                        material=ORANGE,
                    ),
                    Visual(geometry=Sphere(radius=0.04), material=GREY),
                ),
                collisions=(Collision(geometry=Cylinder(radius=0.04, length=0.345, length_formula="abs(a_2) - 0.08")),),
            ),
            Link(
                name="link_2",
                inertial=Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0)),
                visuals=(
                    Visual(geometry=Mesh(filename="package://arm/hand.stl", scale=(0.001, 0.001, 0.001))),
                    Visual(
                        geometry=Box(size=(0.425, 0.08, 0.08), size_formula=("abs(a_2)", "0.08", "0.08")),
                        material=ORANGE,
                    ),
                ),
            ),
            Link(name="link_3", inertial=Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0))),
            Link(name="flange", inertial=WEIGHTLESS),
            Link(name="tool0", inertial=WEIGHTLESS),
        ),
        joints=(
            Joint(
                name="base_link-base_link_inertia", type=JointType.FIXED, parent="base_link", child="base_link_inertia"
            ),
            Joint(
                name="lift",
                type=JointType.PRISMATIC,
                parent="base_link_inertia",
                child="link_1",
                origin=Origin(xyz=(0.0, 0.0, 0.089159), xyz_formula=("0", "0", "d_1")),
                limits=Limits(lower=0.0, upper=0.5, velocity=1.0, effort=100.0),
                damping=0.5,
            ),
            Joint(
                name="turn",
                type=JointType.REVOLUTE,
                parent="link_1",
                child="link_2",
                origin=Origin(
                    xyz=(-0.425, 0.0, 0.0),
                    rpy=(-math.pi / 2, 0.0, 0.3),
                    xyz_formula=("a_2", "0", "0"),
                    rpy_formula=("alpha_2", "0", "0.3"),
                ),
                axis=(0.0, -1.0, 0.0),
                limits=Limits(lower=-2 * math.pi, upper=math.pi / 3, velocity=math.pi, effort=150.0),
                damping=0.1,
                friction=0.2,
            ),
            Joint(
                name="spin",
                type=JointType.CONTINUOUS,
                parent="link_2",
                child="link_3",
                limits=Limits(velocity=3.15, effort=28.0),
            ),
            Joint(
                name="link_3-flange",
                type=JointType.FIXED,
                parent="link_3",
                child="flange",
                origin=Origin(rpy=(0.0, -math.pi / 2, -math.pi / 2)),
            ),
            Joint(name="link_3-tool0", type=JointType.FIXED, parent="link_3", child="tool0"),
        ),
    )


@pytest.fixture(scope="session")
def table(reference_robots: Sequence[Any]) -> Callable[[str], Manipulator]:
    """The manipulator of a published table, with shapes of one thickness whatever is edited in it."""
    tables = {robot.id: robot.manipulator for robot in reference_robots}
    return lambda name: replace(tables[name], geometry=LinkGeometry(radius=0.01))


@pytest.fixture(scope="session")
def long_chain() -> Callable[[int], Robot]:
    """An arm of so many axes."""

    def robot(count: int) -> Robot:
        limits = Limits(lower=-1.0, upper=1.0)
        rows = tuple(
            DHRow(joint=f"joint_{i}", link=f"link_{i}", a=0.2, alpha=0.3, d=0.1, limits=limits)
            for i in range(1, count + 1)
        )
        table = Manipulator(name="long", convention=Convention.STANDARD, rows=rows)
        return TRANSFORM.transform(table, TRANSFORM.options())

    return robot
