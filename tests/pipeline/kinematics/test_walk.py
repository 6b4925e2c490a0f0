import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given, strategies as st
from plain_frames import Matrix, homogeneous, rpy, shift, turn

from dh2urdf.kinematics import CompiledChain
from dh2urdf.kinematics.walk import values_of
from dh2urdf.rotations import RigidTransform

Way = tuple[str, Any]
"""What is added to a chain, and its numbers."""

JOINTS = 3
HALF_PI = math.pi / 2

lengths = st.just(0.0) | st.floats(-2, 2)
angles = st.sampled_from([k * HALF_PI for k in range(-4, 5)]) | st.floats(-7, 7)
axes = st.integers(0, 2)
joints = st.integers(0, JOINTS - 1)
signs = st.sampled_from([1, -1])
unit_vectors = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: math.hypot(*v) > 0.1).map(
    lambda v: tuple(x / math.hypot(*v) for x in v)
) | st.sampled_from([(1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.0, 1.0), (0.0, 0.6, -0.8)])

ways = st.lists(
    st.one_of(
        st.tuples(st.just("move"), st.tuples(axes, lengths)),
        st.tuples(st.just("turn"), st.tuples(axes, angles)),
        st.tuples(st.just("slide"), st.tuples(axes, lengths, joints, st.floats(-1, 1))),
        st.tuples(st.just("revolve"), st.tuples(axes, angles, joints, signs)),
        st.tuples(st.just("about"), st.tuples(unit_vectors, joints)),
        st.tuples(st.just("transform"), st.tuples(lengths, lengths, lengths, angles, angles, angles)),
    ),
    max_size=12,
)
joint_vectors = st.lists(
    st.tuples(*[st.sampled_from([0.0, HALF_PI]) | st.floats(-3, 3)] * JOINTS), min_size=1, max_size=4
)


# The oracle: homogeneous matrices, multiplied by numpy, and turns about vectors by the exponential series of Rodrigues.


def along(axis: int, length: float) -> Matrix:
    return shift(*np.eye(3)[axis] * length)


def matrices(way: Way, q: tuple[float, ...]) -> Matrix:
    kind, numbers = way
    if kind == "move":
        return along(*numbers)
    if kind == "turn":
        return turn(np.eye(3)[numbers[0]], numbers[1])
    if kind == "slide":
        axis, length, joint, factor = numbers
        return along(axis, length + factor * q[joint])
    if kind == "revolve":
        about, angle, joint, sign = numbers
        return turn(np.eye(3)[about], angle + sign * q[joint])
    if kind == "about":
        return turn(numbers[0], q[numbers[1]])
    return shift(*numbers[:3]) @ rpy(*numbers[3:])


def add(chain: CompiledChain, way: Way) -> None:
    kind, numbers = way
    if kind in ("move", "turn"):
        getattr(chain, kind)(*numbers)
    elif kind == "slide":
        along, length, joint, factor = numbers
        chain.move(along, length, joint=joint, factor=factor)
    elif kind == "revolve":
        about, angle, joint, sign = numbers
        chain.turn(about, angle, joint=joint, sign=sign)
    elif kind == "about":
        chain.turn_about(*numbers)
    else:
        *xyz, roll, pitch, yaw = numbers
        chain.transform(RigidTransform.from_xyz_rpy(tuple(xyz), (roll, pitch, yaw)))


def with_stops(ways: list[Way]) -> CompiledChain:
    """A chain that stops at its beginning and after everything that is added."""
    chain = CompiledChain()
    chain.stop()
    for way in ways:
        add(chain, way)
        chain.stop()
    return chain


def expected(ways: list[Way], q: tuple[float, ...]) -> list[Matrix]:
    products = [np.eye(4)]
    for way in ways:
        products.append(products[-1] @ matrices(way, q))
    return products


@given(ways=ways, poses=joint_vectors)
def test_a_walk_is_the_product_of_its_parts(ways: list[Way], poses: list[tuple[float, ...]]) -> None:
    """At every stop and joint vector, floats give the product of textbook matrices."""
    chain = with_stops(ways)
    for q in poses:
        found = [homogeneous(frame.transform) for frame in chain.walk(values_of(q))]
        np.testing.assert_allclose(found, expected(ways, q), rtol=0, atol=1e-13)


@given(ways=ways, poses=joint_vectors)
def test_arrays_give_what_floats_give(ways: list[Way], poses: list[tuple[float, ...]]) -> None:
    """All joint vectors together give the frames that they give one by one; later steps leave earlier frames alone."""
    chain = with_stops(ways)
    values = [np.array(column).reshape(-1, 1) for column in zip(*poses, strict=True)]
    together = chain.walk(values_of(values))
    for number, q in enumerate(poses):
        for frame, alone in zip(together, chain.walk(values_of(q)), strict=True):
            for found, wanted in zip((*frame.axes, frame.origin), (*alone.axes, alone.origin), strict=True):
                at_pose = _stacked(found, len(poses), 1)[:, number, 0]
                np.testing.assert_allclose(at_pose, wanted, rtol=0, atol=1e-14)


@given(ways=ways, data=st.data())
def test_arms_side_by_side_are_each_its_own(ways: list[Way], data: st.DataObject) -> None:
    """Columns of lengths and angles give every arm, to the last bit, what it has by itself."""
    arms = [[_changed(way, data.draw) for way in ways] for _ in range(3)]
    q = [np.array([[0.3], [-1.2]]), np.array([[0.7], [2.0]]), np.array([[0.0], [0.4]])]
    columns = with_stops([_column([arm[number] for arm in arms]) for number in range(len(ways))])
    together = columns.walk(values_of(q))
    for place, arm in enumerate(arms):
        for frame, alone in zip(together, with_stops(arm).walk(values_of(q)), strict=True):
            for found, wanted in zip((*frame.axes, frame.origin), (*alone.axes, alone.origin), strict=True):
                own = _stacked(found, 2, 3)[:, :, place : place + 1]
                np.testing.assert_array_equal(own, _stacked(wanted, 2, 1))


def _stacked(vector: tuple[Any, Any, Any], poses: int, arms: int) -> Matrix:
    return np.stack([np.broadcast_to(number, (poses, arms)) for number in vector])


def _changed(way: Way, draw: Any) -> Way:
    """The same with a length or an angle of its own."""
    kind, numbers = way
    if kind in ("move", "slide"):
        return kind, (numbers[0], draw(lengths), *numbers[2:])
    if kind in ("turn", "revolve"):
        return kind, (numbers[0], draw(angles), *numbers[2:])
    return kind, (draw(unit_vectors), numbers[1]) if kind == "about" else numbers


def _column(members: list[Way]) -> Way:
    """The same step of several arms, with columns for their numbers."""
    kind, first = members[0]
    if kind == "about":
        vectors = zip(*(numbers[0] for _, numbers in members), strict=True)
        return kind, (tuple(map(np.array, vectors)), first[1])
    if kind == "transform":
        return kind, first
    return kind, (first[0], np.array([numbers[1] for _, numbers in members]), *first[2:])


@pytest.mark.parametrize(
    "matrix",
    [
        (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, -1.0),
        (1.0, 1.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0),
        (0.0,) * 9,
        (1.0, 0.0, 0.0, 0.0, 1.0, -1.0, 0.0, 1.0, 1.0),
    ],
)
def test_what_is_no_rotation_is_multiplied(matrix: Any) -> None:
    """A mirrored, sheared or scaled transform, which no check has let pass, still gives the product of matrices."""
    chain = CompiledChain()
    chain.transform(RigidTransform(matrix, (0.1, 0.2, 0.3)))
    chain.turn(2, 0.4)
    chain.move(0, 2.0)
    chain.stop()
    (frame,) = chain.walk(())
    wanted = homogeneous(RigidTransform(matrix, (0.1, 0.2, 0.3))) @ turn("z", 0.4) @ shift(2.0)
    np.testing.assert_allclose(homogeneous(frame.transform), wanted, rtol=0, atol=1e-15)
