from __future__ import annotations

import math
from dataclasses import replace
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from hypothesis import given, strategies as st

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

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.source import Problem

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


def only(robot: Robot) -> Problem:
    (problem,) = check_robot(robot)
    return problem


def test_a_good_robot_has_no_problems() -> None:
    """Frames held by fixed joints may weigh nothing."""
    assert check_robot(GOOD) == ()


@pytest.mark.parametrize(
    ("robot", "says"),
    [
        (with_link(inertial=None), "has no mass"),
        (with_link(inertial=FRAME), "has no mass"),
        (with_link(inertial=replace(BODY, mass=0.0)), "mass of link 'link_1' is 0 kg"),
        (with_link(inertial=replace(BODY, mass=-1.0)), "mass of link 'link_1' is -1 kg"),
        (with_link(inertial=replace(BODY, mass=NAN)), "mass of link 'link_1' is nan kg"),
        (with_link(inertial=replace(BODY, com=(0.0, INF, 0.0))), "com holds inf"),
        (with_link(inertial=replace(BODY, inertia=Inertia(ixx=1.0, iyy=1.0, izz=3.0))), "triangle inequality"),
        (with_link(inertial=replace(BODY, inertia=Inertia(ixx=1.0, iyy=1.0, izz=0.0))), "positive definite"),
        (shaped(Box(size=(1.0, 0.0, 1.0))), "size along y"),
        (shaped(Cylinder(radius=-1.0, length=1.0)), "radius"),
        (shaped(Cylinder(radius=1.0, length=INF)), "length"),
        (shaped(Sphere(radius=NAN)), "radius"),
        (shaped(Mesh(filename="a.stl", scale=(1.0, 0.0, 1.0))), "scale"),
        (shaped(Sphere(radius=1.0), origin=Origin(xyz=(0.0, NAN, 0.0))), "origin holds nan"),
        (shaped(Sphere(radius=1.0), material=Material(name="red", rgba=(2.0, 0.0, 0.0, 1.0))), "colour"),
        (with_joint(axis=(0.0, 0.0, 2.0)), "length 2"),
        (with_joint(axis=(0.0, 0.0, 0.0)), "length 0"),
        (with_joint(axis=(0.0, NAN, 1.0)), "length nan"),
        (with_joint(origin=Origin(rpy=(INF, 0.0, 0.0))), "origin holds inf"),
        (with_joint(limits=replace(LIMITS, lower=None)), "needs a limit lower"),
        (with_joint(limits=replace(LIMITS, effort=None)), "needs a limit effort"),
        (with_joint(limits=replace(LIMITS, velocity=0.0)), "velocity is 0"),
        (with_joint(limits=replace(LIMITS, effort=-1.0)), "effort is -1"),
        (with_joint(limits=replace(LIMITS, upper=INF)), "upper is inf"),
        (with_joint(limits=replace(LIMITS, lower=2.0)), "greater than upper"),
        (with_joint(type=JointType.CONTINUOUS), "a continuous joint has no limit lower"),
        (with_joint(damping=-0.1), "damping is -0.1"),
        (with_joint(armature=-0.1), "armature is -0.1"),
        (with_joint(friction=NAN), "friction is nan"),
    ],
)
def test_every_rule_has_its_sentence(robot: Robot, says: str) -> None:
    """The problem is an error and names the joint that moves the link, and the row it came from."""
    problem = check_robot(robot)[0]
    assert says in problem.message
    assert (problem.severity, problem.joint, problem.mark, problem.robot) == ("error", "joint_1", MARK, "arm")


def test_a_mirrored_mesh_is_a_mesh() -> None:
    """Its scale is negative."""
    assert check_robot(shaped(Mesh(filename="a.stl", scale=(1.0, -1.0, 1.0)))) == ()


def test_a_rounded_axis_is_a_unit_vector() -> None:
    """A file holds finitely many digits."""
    assert check_robot(with_joint(axis=(0.6, 0.8 + 1e-10, 0.0))) == ()


# Names.


def renamed(old: str, new: str) -> Robot:
    """The good robot with another name for a link."""
    links = tuple(replace(link, name=new) if link.name == old else link for link in GOOD.links)
    joints = tuple(
        replace(
            joint,
            parent=new if joint.parent == old else joint.parent,
            child=new if joint.child == old else joint.child,
        )
        for joint in GOOD.joints
    )
    return replace(GOOD, links=links, joints=joints)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("", "no name"),
        ("  ", "no name"),
        ("x" * 1001, "1001 characters"),
        ("a\nb", "U+000A"),
        ("a\x85b", "U+0085"),
        ("\ud800", "U+D800"),
        ("\uffff", "U+FFFF"),
        ("joint_2", "has the name of another"),
    ],
)
def test_a_name_that_readers_fail_on_is_refused(name: str, says: str) -> None:
    """Empty, too long, not writable as XML, or taken: links and joints share one set."""
    errors = [problem for problem in check_robot(renamed("link_1", name)) if problem.severity == "error"]
    assert len(errors) == 1
    assert says in errors[0].message


def test_names_that_some_tools_do_not_take_are_a_notice() -> None:
    """One for all of them; the robot is written."""
    problem = only(renamed("link_1", "upper arm"))
    assert problem.severity == "notice"
    assert "'upper arm'" in problem.message


def test_a_robot_has_a_name() -> None:
    """URDF requires one."""
    assert "no name" in only(replace(GOOD, name="")).message


# The tree.


def test_two_roots_are_refused() -> None:
    """Both are named."""
    problem = only(replace(GOOD, links=(*GOOD.links, Link(name="lost"))))
    assert "2 links have no parent: 'base_link', 'lost'" in problem.message


def test_a_cycle_is_refused_beside_a_root_and_without_one() -> None:
    """Some readers accept it in silence."""
    ring = (held("link_2", "link_1"),)
    without_root = replace(GOOD, links=GOOD.links[2:4], joints=(GOOD.joints[2], *ring))
    assert any("cycle" in problem.message for problem in check_robot(without_root))
    beside = replace(GOOD, joints=(GOOD.joints[0], GOOD.joints[2], *ring, *GOOD.joints[3:]))
    lost = [problem.message for problem in check_robot(beside) if "cycle" in problem.message]
    assert lost == [
        "no way leads from the root 'base_link' to 'link_1', 'link_2', 'flange', 'tool0': joints form a cycle"
    ]


def test_a_link_with_two_joints_above_it_is_refused() -> None:
    """A tree has one way to each link."""
    twice = replace(GOOD, joints=(*GOOD.joints, joint("joint_3", "base_link", "link_2")))
    problem = only(twice)
    assert (problem.joint, problem.message) == ("joint_3", "link 'link_2' is already the child of joint 'joint_2'")


def test_a_joint_to_nowhere_is_refused() -> None:
    """With the link that was probably meant."""
    problem = check_robot(with_joint(parent="base_link_inerta"))[0]
    assert problem.found == "base_link_inerta"
    assert problem.suggestion == "did you mean 'base_link_inertia'?"


def test_a_frame_below_a_frame_is_refused_where_both_weigh_nothing() -> None:
    """sdformat loses the whole model."""
    joints = (*GOOD.joints[:4], held("flange", "tool0"))
    problem = only(replace(GOOD, joints=joints))
    assert "'tool0' and its parent 'flange' both weigh nothing" in problem.message


def test_an_inertial_of_the_root_is_a_notice() -> None:
    """KDL does not use it, sdformat needs it: an empty root serves both."""
    links = (replace(GOOD.links[0], inertial=BODY), *GOOD.links[1:])
    problem = only(replace(GOOD, links=links))
    assert problem.severity == "notice"
    assert "KDL" in problem.message


def test_thousands_of_joints_are_checked_without_recursion() -> None:
    """Nothing grows with the depth of the tree."""
    links = [Link(name=f"l{i}", inertial=BODY if i else None) for i in range(5001)]
    joints = [joint(f"j{i}", f"l{i}", f"l{i + 1}") for i in range(5000)]
    assert check_robot(Robot(name="snake", links=tuple(links), joints=tuple(joints))) == ()


# Formulas.


def test_formulas_use_parameters_and_functions() -> None:
    """An unknown name would stop xacro; numbers with exponents are no names."""
    origin = Origin(xyz_formula=("max(abs(a_1), 1e-3)", "0", "-sin(d_1)*atan2(1, 2)"))
    parameters = tuple(Parameter(name=name, value=1.0, unit="m", joint="joint_1") for name in ("a_1", "d_1"))
    robot = replace(with_joint(origin=origin), parameters=parameters)
    assert check_robot(robot) == ()
    problem = only(replace(robot, parameters=parameters[:1]))
    assert "uses 'd_1', which is no parameter" in problem.message


@pytest.mark.parametrize(
    "geometry",
    [
        Cylinder(radius=1.0, length=1.0, length_formula="a_9"),
        Box(size=(1.0, 1.0, 1.0), size_formula=("1", "1", "a_9")),
    ],
)
def test_formulas_of_shapes_are_checked_too(geometry: Box | Cylinder) -> None:
    """Lengths and sizes."""
    assert only(shaped(geometry)).found == "a_9"


@pytest.mark.parametrize(("values", "says"), [((1.0, 2.0), "declared twice"), ((NAN,), "is nan")])
def test_a_parameter_is_one_finite_number(values: tuple[float, ...], says: str) -> None:
    """The property of a macro."""
    parameters = tuple(Parameter(name="a_1", value=value, unit="m", joint="joint_1") for value in values)
    assert says in only(replace(GOOD, parameters=parameters)).message


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
def test_a_robot_with_a_fault_is_never_sure(
    with_numbers: Callable[..., Any], side_by_side: Callable[..., Any], data: st.DataObject
) -> None:
    """Whichever number of a robot is wrong, columns of robots know it, and think no worse of its neighbours."""
    wrong = {data.draw(st.integers(0, NUMBERS_OF_ROUND - 1)): data.draw(st.sampled_from(WRONG)) for _ in range(2)}
    places = count()
    other = with_numbers(ROUND, lambda number: wrong.get(next(places), number))
    robots = [ROUND, other, ROUND]
    data.draw(st.randoms()).shuffle(robots)
    sure = sure_columns(side_by_side(robots), ["arm"] * 3).tolist()
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
