import math
from typing import Any

import numpy as np
import pytest
from hypothesis import assume, given, strategies as st
from numpy.typing import NDArray
from plain_frames import tensor

from dh2urdf.columns import replaced, stacked
from dh2urdf.kinematics.mass import (
    compound,
    inertia_problem,
    is_sound,
    placed,
    principal_moments,
    rotated,
    scaled,
    solid,
)
from dh2urdf.manipulator import Inertia
from dh2urdf.robot import Box, Cylinder, Geometry, Inertial, Sphere
from dh2urdf.rotations import RigidTransform, rotation_from_rpy

sizes = st.floats(0.01, 3)
angles = st.floats(-3.2, 3.2)
vectors = st.tuples(*[st.floats(-2, 2)] * 3)
geometries = (
    st.builds(lambda *size: Box(size=size), sizes, sizes, sizes)
    | st.builds(lambda r, h: Cylinder(radius=r, length=h), sizes, sizes)
    | st.builds(lambda r: Sphere(radius=r), sizes)
)
frames = st.builds(RigidTransform.from_xyz_rpy, vectors, st.tuples(angles, angles, angles))
bodies = st.builds(lambda g, d, f: placed(solid(g, d), f), geometries, st.floats(1, 5000), frames)


def about(body: Inertial, point: NDArray[np.float64]) -> NDArray[np.float64]:
    """The oracle: inertia about another point, Steiner's theorem in matrix form."""
    r = np.array(body.com) - point
    return tensor(body.inertia) + body.mass * (r @ r * np.eye(3) - np.outer(r, r))


def sampled(geometry: Geometry, density: float, cells: int = 60) -> tuple[float, NDArray[np.float64]]:
    """The oracle: mass and inertia of a body made of many small cubes."""
    match geometry:
        case Box(size=size):
            half = np.array(size) / 2
        case Cylinder(radius=r, length=h):
            half = np.array([r, r, h / 2])
        case Sphere(radius=r):
            half = np.array([r, r, r])
    axes = [(np.arange(cells) + 0.5) / cells * 2 * edge - edge for edge in half]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    if isinstance(geometry, Cylinder):
        points = points[np.hypot(points[:, 0], points[:, 1]) <= geometry.radius]
    if isinstance(geometry, Sphere):
        points = points[np.linalg.norm(points, axis=1) <= geometry.radius]
    cube = float(np.prod(2 * half / cells)) * density
    squares = np.einsum("ni,ni->n", points, points).sum()
    return cube * len(points), cube * (squares * np.eye(3) - points.T @ points)


@pytest.mark.parametrize("geometry", [Box(size=(0.2, 0.5, 1.1)), Cylinder(radius=0.3, length=0.8), Sphere(radius=0.4)])
def test_primitives_have_the_mass_properties_of_a_body_of_small_cubes(geometry: Geometry) -> None:
    """Volume and moments, against a sum over space."""
    mass, inertia = sampled(geometry, 1000.0)
    body = solid(geometry, 1000.0)
    assert body.mass == pytest.approx(mass, rel=5e-3)
    assert body.com == (0.0, 0.0, 0.0)
    np.testing.assert_allclose(tensor(body.inertia), inertia, rtol=1e-2, atol=1e-9)


@given(bodies, frames)
def test_a_body_may_be_seen_from_another_frame(body: Inertial, frame: RigidTransform) -> None:
    """Its inertia about the frame's origin is turned, its mass stays."""
    moved = placed(body, frame)
    R = np.reshape(frame.rotation, (3, 3))
    assert moved.mass == body.mass
    np.testing.assert_allclose(moved.com, R @ body.com + frame.translation, atol=1e-12)
    np.testing.assert_allclose(tensor(moved.inertia), R @ tensor(body.inertia) @ R.T, rtol=1e-9, atol=1e-6)


@given(st.lists(bodies, min_size=1, max_size=4), vectors)
def test_a_compound_weighs_what_its_parts_weigh(parts: list[Inertial], point: tuple[float, float, float]) -> None:
    """Mass, first moment, and inertia about any point are the sums of the parts'."""
    whole = compound(parts)
    assert whole.mass == pytest.approx(sum(part.mass for part in parts))
    first = sum(part.mass * np.array(part.com) for part in parts)
    np.testing.assert_allclose(whole.mass * np.array(whole.com), first, rtol=1e-9, atol=1e-9 * whole.mass)
    total = sum(about(part, np.array(point)) for part in parts)
    np.testing.assert_allclose(about(whole, np.array(point)), total, rtol=1e-9, atol=1e-8 * np.abs(total).max())
    assert inertia_problem(whole.inertia) is None


def test_a_coordinate_that_all_parts_share_is_that_of_the_whole() -> None:
    """To the last bit, so symmetric links have products of inertia of exactly 0."""
    parts = [placed(solid(Sphere(radius=r), 2700.0), RigidTransform.from_xyz_rpy((0.1, r, 0.0))) for r in (0.1, 0.3)]
    whole = compound(parts)
    assert whole.com[0] == 0.1
    assert (whole.inertia.ixy, whole.inertia.ixz, whole.inertia.iyz) == (0.0, 0.0, 0.0)


elements = st.floats(-5, 5)
tensors = st.builds(lambda *e: Inertia(ixx=e[0], iyy=e[1], izz=e[2], ixy=e[3], ixz=e[4], iyz=e[5]), *[elements] * 6)


@given(tensors)
def test_principal_moments_are_the_eigenvalues(inertia: Inertia) -> None:
    """As LAPACK has them."""
    expected = np.linalg.eigvalsh(tensor(inertia))
    np.testing.assert_allclose(principal_moments(inertia), expected, atol=1e-13)


@given(st.tuples(*[st.floats(0.001, 5)] * 3), st.tuples(angles, angles, angles))
def test_a_tensor_is_refused_exactly_where_no_body_has_it(
    moments: tuple[float, float, float], rpy: tuple[float, float, float]
) -> None:
    """In any axes, the rule depends on the principal moments alone."""
    a, b, c = moments
    inertia = rotated(Inertia(ixx=a, iyy=b, izz=c), rotation_from_rpy(rpy))
    low, middle, high = sorted(moments)
    assume(abs(low + middle - high) > 1e-9)
    problem = inertia_problem(inertia)
    assert (problem is None) == (low + middle > high)
    assert problem is None or "triangle inequality" in problem


@pytest.mark.parametrize(
    ("inertia", "rule"),
    [
        (Inertia(ixx=0.0, iyy=0.35, izz=0.0), "positive definite"),
        (Inertia(ixx=1.0, iyy=1.0, izz=-1.0), "positive definite"),
        (Inertia(ixx=1.0, iyy=1.0, izz=1.0, ixy=1.5), "positive definite"),
        (Inertia(ixx=0.13, iyy=0.524, izz=0.7), "triangle inequality"),
        (Inertia(ixx=math.inf, iyy=1.0, izz=1.0), "not finite"),
    ],
)
def test_the_broken_rule_is_named(inertia: Inertia, rule: str) -> None:
    """So that a person can look it up."""
    assert rule in (inertia_problem(inertia) or "")


def test_a_flat_plate_is_a_body() -> None:
    """A + B = C is the limit, and rounding may break it."""
    assert inertia_problem(Inertia(ixx=0.1, iyy=0.2, izz=0.30000000000000004)) is None
    plate = rotated(Inertia(ixx=0.1, iyy=0.2, izz=0.3), rotation_from_rpy((0.3, 0.4, 0.5)))
    assert inertia_problem(plate) is None


class TestColumns:
    @given(st.lists(st.tuples(sizes, sizes, sizes, vectors, angles), min_size=2, max_size=5))
    def test_of_bodies_are_what_each_body_is(self, numbers: list[tuple[Any, ...]]) -> None:
        """Solids, placed, put together, turned and scaled side by side, to the last bit."""

        def body(shapes: tuple[Geometry, ...], frame: RigidTransform) -> Inertial:
            parts = [placed(solid(shape, 2700.0), frame) for shape in shapes]
            whole = compound([*parts, solid(shapes[0], 1000.0)])
            return Inertial(mass=whole.mass, com=whole.com, inertia=scaled(whole.inertia, 0.3))

        shapes = [(Box(size=(a, b, c)), Cylinder(radius=a, length=b), Sphere(radius=c)) for a, b, c, _, _ in numbers]
        frames = [RigidTransform.from_xyz_rpy(xyz, (0.0, angle, 0.0)) for *_, xyz, angle in numbers]
        rotations = stacked([tuple(frame.rotation) for frame in frames])
        translations = stacked([frame.translation for frame in frames])
        together = body(stacked(shapes), RigidTransform(rotations, translations))
        for index, each in enumerate(zip(shapes, frames, strict=True)):
            assert replaced(together, lambda column, index=index: column[index]) == body(*each)  # type: ignore[misc]

    @given(st.lists(st.tuples(sizes, sizes, sizes, angles, angles, angles), min_size=1, max_size=5))
    def test_of_tensors_are_sound_where_each_is(self, numbers: list[tuple[float, ...]]) -> None:
        """And what is sound breaks no rule."""
        names = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        single = [Inertia(**dict(zip(names, each, strict=True))) for each in numbers]
        columns = Inertia(**dict(zip(names, map(np.array, zip(*numbers, strict=True)), strict=True)))
        with np.errstate(all="ignore"):
            sound = is_sound(columns).tolist()
        assert sound == [is_sound(inertia) for inertia in single]
        assert not any(inertia_problem(inertia) for inertia, good in zip(single, sound, strict=True) if good)
