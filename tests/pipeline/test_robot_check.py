import math
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

from dh2urdf.columns import stacked
from dh2urdf.manipulator import Inertia, JointType, Limits
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
from dh2urdf.robot_check import check_robot, sure_columns
from dh2urdf.source import Mark

BODY = Inertial(mass=1.0, inertia=Inertia(ixx=1.0, iyy=1.0, izz=1.0))
FRAME = Inertial(mass=0.0)
LIMITS = Limits(lower=-1.0, upper=1.0, velocity=1.0, effort=10.0)
MARK = Mark(file="arm.csv", line=3)
NAN, INF = math.nan, math.inf


def joint(name: str, parent: str, child: str, **more: Any) -> Joint:
    known: dict[str, Any] = {"type": JointType.REVOLUTE, "limits": LIMITS, "mark": MARK}
    return Joint(name=name, parent=parent, child=child, **(known | more))


def held(parent: str, child: str) -> Joint:
    return Joint(name=f"{parent}-{child}", type=JointType.FIXED, parent=parent, child=child)


GOOD = Robot(
    name="arm",
    links=(
        Link(name="base_link"),
        Link(name="base_link_inertia", inertial=BODY),
        Link(name="link_1", inertial=BODY, visuals=(Visual(geometry=Box(size=(1.0, 1.0, 1.0))),)),
        Link(name="link_2", inertial=BODY, collisions=(Collision(geometry=Cylinder(radius=1.0, length=1.0)),)),
        Link(name="flange", inertial=FRAME),
        Link(name="tool0", inertial=FRAME),
    ),
    joints=(
        held("base_link", "base_link_inertia"),
        joint("joint_1", "base_link_inertia", "link_1"),
        joint("joint_2", "link_1", "link_2"),
        held("link_2", "flange"),
        held("link_2", "tool0"),
    ),
)


def with_link(**changes: Any) -> Robot:
    """The good robot with something else about link_1."""
    links = tuple(replace(link, **changes) if link.name == "link_1" else link for link in GOOD.links)
    return replace(GOOD, links=links)


def with_joint(**changes: Any) -> Robot:
    """The good robot with something else about joint_1."""
    joints = tuple(replace(joint, **changes) if joint.name == "joint_1" else joint for joint in GOOD.joints)
    return replace(GOOD, joints=joints)


def shaped(geometry: Any, **more: Any) -> Robot:
    return with_link(visuals=(Visual(geometry=geometry, **more),))


def test_a_good_robot_has_no_problems() -> None:
    """Frames held by fixed joints may weigh nothing, a mirrored mesh is a mesh, and a file holds finitely many digits."""
    mirrored = shaped(Mesh(filename="a.stl", scale=(1.0, -1.0, 1.0)))
    for robot in (GOOD, mirrored, with_joint(axis=(0.6, 0.8 + 1e-10, 0.0))):
        assert check_robot(robot) == ()


@pytest.mark.parametrize(
    ("robot", "code", "field"),
    [
        (with_link(inertial=FRAME), "moves-without-mass", "mass"),
        (with_link(inertial=replace(BODY, mass=0.0)), "mass-not-above-0", "mass"),
        (with_link(inertial=replace(BODY, com=(0.0, INF, 0.0))), "numbers-infinite", "com"),
        (
            with_link(inertial=replace(BODY, inertia=Inertia(ixx=1.0, iyy=1.0, izz=3.0))),
            "inertia-impossible",
            "inertia",
        ),
        (shaped(Box(size=(1.0, 0.0, 1.0))), "size-not-above-0", "geometry"),
        (shaped(Sphere(radius=NAN)), "size-not-above-0", "geometry"),
        (shaped(Mesh(filename="a.stl", scale=(1.0, 0.0, 1.0))), "size-not-above-0", "geometry"),
        (shaped(Sphere(radius=1.0), origin=Origin(xyz=(0.0, NAN, 0.0))), "numbers-infinite", "origin"),
        (
            shaped(Sphere(radius=1.0), material=Material(name="red", rgba=(2.0, 0.0, 0.0, 1.0))),
            *("colour-out-of-range", "material"),
        ),
        (with_joint(axis=(0.0, 0.0, 2.0)), "axis-not-unit", "axis"),
        (with_joint(axis=(0.0, NAN, 1.0)), "axis-not-unit", "axis"),
        (with_joint(origin=Origin(rpy=(INF, 0.0, 0.0))), "numbers-infinite", "origin"),
        (with_joint(limits=replace(LIMITS, effort=None)), "limit-missing", "limits.effort"),
        (with_joint(limits=replace(LIMITS, velocity=0.0)), "limit-not-above-0", "limits.velocity"),
        (with_joint(limits=replace(LIMITS, upper=INF)), "limit-infinite", "limits.upper"),
        (with_joint(limits=replace(LIMITS, lower=2.0)), "limits-exchanged", "limits.lower"),
        (with_joint(type=JointType.CONTINUOUS), "limit-needless", "limits.lower"),
        (with_joint(damping=-0.1), "number-negative", "damping"),
    ],
)
def test_every_rule_names_the_joint_and_its_row(robot: Robot, code: str, field: str) -> None:
    """The problem is an error and names the joint that moves the link, and the row it came from."""
    problem = check_robot(robot)[0]
    assert (problem.code, problem.field) == (code, field)
    assert (problem.severity, problem.joint, problem.mark, problem.robot) == ("error", "joint_1", MARK, "arm")


def renamed(old: str, new: str) -> Robot:
    """The good robot with another name for a link."""
    names = {old: new}
    links = tuple(replace(link, name=names.get(link.name, link.name)) for link in GOOD.links)
    joints = tuple(
        replace(joint, parent=names.get(joint.parent, joint.parent), child=names.get(joint.child, joint.child))
        for joint in GOOD.joints
    )
    return replace(GOOD, links=links, joints=joints)


def with_parameters(*values: float, **robot: Any) -> Robot:
    parameters = tuple(Parameter(name="a_1", value=value, unit="m", joint="joint_1") for value in values)
    return replace(with_joint(**robot), parameters=parameters)


FORMULA = Origin(xyz_formula=("max(abs(a_1), 1e-3)", "0", "-sin(a_1)*atan2(1, 2)"))
RING = held("link_2", "link_1")


@pytest.mark.parametrize(
    ("robot", "code"),
    [
        (renamed("link_1", "  "), "name-missing"),
        (renamed("link_1", "x" * 1001), "name-too-long"),
        (renamed("link_1", "\ud800"), "name-unwritable"),
        (renamed("link_1", "joint_2"), "name-taken"),
        (renamed("link_1", "upper arm"), "names-troublesome"),
        (replace(GOOD, links=(*GOOD.links, Link(name="lost"))), "several-roots"),
        (replace(GOOD, links=GOOD.links[2:4], joints=(GOOD.joints[2], RING)), "no-root"),
        (replace(GOOD, joints=(GOOD.joints[0], GOOD.joints[2], RING, *GOOD.joints[3:])), "links-in-circle"),
        (replace(GOOD, joints=(*GOOD.joints, joint("joint_3", "base_link", "link_2"))), "two-parents"),
        (replace(GOOD, joints=(*GOOD.joints[:4], held("flange", "tool0"))), "two-weigh-nothing"),
        (replace(GOOD, links=(replace(GOOD.links[0], inertial=BODY), *GOOD.links[1:])), "root-with-mass"),
        (with_parameters(1.0, 2.0), "parameter-twice"),
        (with_parameters(NAN), "parameter-infinite"),
        (with_parameters(origin=Origin(xyz_formula=("a_1", "0", "0"))), "formula-name-unknown"),
        (shaped(Cylinder(radius=1.0, length=1.0, length_formula="a_9")), "formula-name-unknown"),
        (shaped(Box(size=(1.0, 1.0, 1.0), size_formula=("1", "1", "a_9"))), "formula-name-unknown"),
    ],
)
def test_every_rule_of_names_trees_and_formulas(robot: Robot, code: str) -> None:
    """Readers fail on each; what only some of them do not take is a notice, and the robot is written."""
    (problem,) = (each for each in check_robot(robot) if each.code == code)
    assert (problem.severity == "notice") is (code in ("names-troublesome", "root-with-mass"))


def test_formulas_use_parameters_and_functions() -> None:
    """Numbers with exponents are no names."""
    assert check_robot(with_parameters(1.0, origin=FORMULA)) == ()


def test_a_joint_to_nowhere_is_refused() -> None:
    """With the link that was probably meant."""
    problem = check_robot(with_joint(parent="base_link_inerta"))[0]
    assert problem.found == "base_link_inerta"
    assert problem.suggestion == "did you mean 'base_link_inertia'?"


def test_thousands_of_joints_are_checked_without_recursion() -> None:
    """Nothing grows with the depth of the tree."""
    links = [Link(name=f"l{i}", inertial=BODY if i else None) for i in range(5001)]
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}") for i in range(5000)]
    assert check_robot(Robot(name="snake", links=tuple(links), joints=tuple(joints))) == ()


# Many robots at once.


ROUND = Robot(
    name="arm",
    links=(
        Link(name="base_link"),
        Link(name="base_link_inertia", inertial=BODY, visuals=(Visual(geometry=Sphere(radius=0.5)),)),
        Link(
            name="link_1",
            inertial=BODY,
            visuals=(
                Visual(geometry=Box(size=(1.0, 1.0, 1.0)), material=Material(name="m", rgba=(1.0, 1.0, 1.0, 1.0))),
            ),
            collisions=(Collision(geometry=Cylinder(radius=1.0, length=1.0)),),
        ),
        Link(name="link_2", inertial=BODY, visuals=(Visual(geometry=Mesh(filename="a.stl")),)),
        Link(name="tool0"),
    ),
    joints=(
        held("base_link", "base_link_inertia"),
        joint("joint_1", "base_link_inertia", "link_1", damping=0.5, friction=0.5),
        joint("joint_2", "link_1", "link_2", type=JointType.CONTINUOUS, limits=Limits(velocity=1.0, effort=1.0)),
        held("link_2", "tool0"),
    ),
)
NUMBERS_OF_ROUND = 107
WRONG = [NAN, INF, -INF, 0.0, -0.0, -1.0, 1e-300, 1e300, 2.0, 1.0 + 1e-8]


@given(st.data())
def test_a_robot_with_a_fault_is_never_sure(with_numbers: Callable[..., Any], data: st.DataObject) -> None:
    """Whichever number of a robot is wrong, columns of robots know it, and think no worse of its neighbours."""
    wrong = {data.draw(st.integers(0, NUMBERS_OF_ROUND - 1)): data.draw(st.sampled_from(WRONG)) for _ in range(2)}
    places = count()
    other = with_numbers(ROUND, lambda number: wrong.get(next(places), number))
    robots = [ROUND, other, ROUND]
    data.draw(st.randoms()).shuffle(robots)
    sure = sure_columns(stacked(robots), ["arm"] * 3).tolist()
    for robot, is_sure in zip(robots, sure, strict=True):
        assert not (is_sure and check_robot(robot))
        assert is_sure or robot is other


def test_every_number_may_be_wrong(with_numbers: Callable[..., Any]) -> None:
    """The test above reaches all of them."""
    found: list[float] = []
    with_numbers(ROUND, found.append)
    assert len(found) == NUMBERS_OF_ROUND


def test_what_robots_have_alike_is_judged_by_one_of_them() -> None:
    """Names, structure and common numbers are those of any of them."""
    for faulty in (
        with_link(name="joint_1"),
        with_link(name="two words"),
        with_joint(type=JointType.CONTINUOUS),
        with_joint(limits=Limits(lower=0.0)),
        replace(GOOD, links=GOOD.links[:-1]),
    ):
        assert check_robot(faulty)
        columns = replace(
            faulty, links=(*faulty.links[:1], replace(faulty.links[1], inertial=_heavy(1.0, 2.0)), *faulty.links[2:])
        )
        assert sure_columns(columns, ["a", "b"]).tolist() == [False, False]
        assert sure_columns(faulty, ["a", "b"]).tolist() == [False, False]
    assert sure_columns(GOOD, ["a", "b"]).tolist() == [True, True]


def _heavy(*masses: float) -> Inertial:
    return replace(BODY, mass=np.array(masses))
