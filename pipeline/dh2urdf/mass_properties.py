"""Mass, centre of mass and inertia of primitives and of bodies made of them.

An `Inertial` is a body: its mass, its centre of mass in some frame, and its inertia about that centre, with axes
parallel to the frame. Everything is spelled out as sums, so the numbers are the same on every machine; and all but
`principal_moments` and `inertia_problem` takes columns, to the last bit as it takes each of their entries.

Source: the moments of solid primitives and the parallel-axis theorem as in Goldstein, Classical Mechanics, 3rd
edition, section 5.3.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.elementwise import Condition, is_column, where
from dh2urdf.manipulator import Inertia
from dh2urdf.robot import Box, Cylinder, Inertial, Sphere
from dh2urdf.rotations import Vec3, add, multiply, rotate, subtract, transpose

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.robot import Geometry
    from dh2urdf.rotations import RigidTransform, Rotation

_ROUNDING = 1e-12  # relative to the largest moment: a flat plate has A + B = C, and rounding may break it
_SWEEPS = 30  # Jacobi's method converges quadratically; a 3x3 matrix needs about five


def volume(geometry: Geometry) -> float:
    """The volume of a primitive [m³].

    Raises:
        ValueError: the geometry is a mesh, whose volume only its file knows.
    """
    match geometry:
        case Box(size=(x, y, z)):
            return x * y * z
        case Cylinder(radius=radius, length=length):
            return math.pi * radius * radius * length
        case Sphere(radius=radius):
            return 4.0 / 3.0 * math.pi * radius * radius * radius
    raise ValueError(f"the volume of {type(geometry).__name__} is not known here")


def solid(geometry: Geometry, density: float) -> Inertial:
    """A primitive of one density [kg/m³] as a body, in its own frame.

    Raises:
        ValueError: the geometry is a mesh.
    """
    mass = density * volume(geometry)
    match geometry:
        case Box(size=(x, y, z)):
            k = mass / 12.0
            inertia = Inertia(ixx=k * (y * y + z * z), iyy=k * (x * x + z * z), izz=k * (x * x + y * y))
        case Cylinder(radius=r, length=h):
            across = mass / 12.0 * (3.0 * r * r + h * h)
            inertia = Inertia(ixx=across, iyy=across, izz=0.5 * mass * r * r)
        case Sphere(radius=r):
            moment = 0.4 * mass * r * r
            inertia = Inertia(ixx=moment, iyy=moment, izz=moment)
    return Inertial(mass=mass, inertia=inertia)


def placed(body: Inertial, frame: RigidTransform) -> Inertial:
    """A body that is known in `frame`, in the frame that `frame` is given in."""
    return Inertial(
        mass=body.mass,
        com=_clean(add(frame.translation, rotate(frame.rotation, body.com))),
        inertia=rotated(body.inertia, frame.rotation),
    )


def rotated(inertia: Inertia, rotation: Rotation) -> Inertia:
    """An inertia tensor in the axes that its own axes are turned from: R·I·Rᵀ."""
    ixx, ixy, ixz, _, iyy, iyz, _, _, izz = multiply(multiply(rotation, _matrix(inertia)), transpose(rotation))
    return Inertia(ixx=ixx + 0.0, iyy=iyy + 0.0, izz=izz + 0.0, ixy=ixy + 0.0, ixz=ixz + 0.0, iyz=iyz + 0.0)


def compound(bodies: Sequence[Inertial]) -> Inertial:
    """Several bodies as one, by the parallel-axis theorem; overlaps count twice.

    Raises:
        ValueError: there is no body, or their mass is 0.
    """
    mass = 0.0  # Not by sum: from Python 3.12 on it rounds the sum of floats, and of nothing else, better.
    for body in bodies:
        mass += body.mass
    if not is_column(mass) and not mass:
        raise ValueError("a compound needs a mass")
    # From the first body's centre on: a coordinate that all bodies share stays what it is, to the last bit.
    ox, oy, oz = bodies[0].com
    cx = cy = cz = 0.0
    for body in bodies[1:]:
        m = body.mass
        x, y, z = body.com
        cx += m * (x - ox)
        cy += m * (y - oy)
        cz += m * (z - oz)
    cx, cy, cz = ox + cx / mass + 0.0, oy + cy / mass + 0.0, oz + cz / mass + 0.0
    ixx = iyy = izz = ixy = ixz = iyz = 0.0
    for body in bodies:
        m, own = body.mass, body.inertia
        x, y, z = subtract(body.com, (cx, cy, cz))
        ixx += own.ixx + m * (y * y + z * z)
        iyy += own.iyy + m * (x * x + z * z)
        izz += own.izz + m * (x * x + y * y)
        ixy += own.ixy - m * x * y
        ixz += own.ixz - m * x * z
        iyz += own.iyz - m * y * z
    return Inertial(
        mass=mass,
        com=(cx, cy, cz),
        inertia=Inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy + 0.0, ixz=ixz + 0.0, iyz=iyz + 0.0),
    )


def scaled(inertia: Inertia, factor: float) -> Inertia:
    """An inertia tensor times a number: that of the same shape with another mass."""
    return Inertia(
        ixx=factor * inertia.ixx,
        iyy=factor * inertia.iyy,
        izz=factor * inertia.izz,
        ixy=factor * inertia.ixy + 0.0,
        ixz=factor * inertia.ixz + 0.0,
        iyz=factor * inertia.iyz + 0.0,
    )


def principal_moments(inertia: Inertia) -> Vec3:
    """The principal moments of inertia [kg·m²], smallest first (Jacobi's eigenvalue method)."""
    a = [list(_matrix(inertia)[row : row + 3]) for row in (0, 3, 6)]
    for _ in range(_SWEEPS):
        if not (a[0][1] or a[0][2] or a[1][2]):
            break
        for p, q in ((0, 1), (0, 2), (1, 2)):
            _jacobi_rotation(a, p, q)
    low, middle, high = sorted((a[0][0], a[1][1], a[2][2]))
    return (low, middle, high)


def inertia_problem(inertia: Inertia) -> str | None:
    """The rule that an inertia tensor breaks, as a sentence; None for one that some body has.

    A body's inertia about its centre of mass is positive definite, and its principal moments A ≤ B ≤ C fulfil
    A + B ≥ C (the triangle inequality: the moments are sums of squares of distances). Rounding is forgiven.
    """
    if not all(map(math.isfinite, _matrix(inertia))):
        return "the inertia is not finite"
    if is_sound(inertia):
        return None
    low, middle, high = principal_moments(inertia)
    if low <= 0.0:
        return (
            f"the inertia is not positive definite: its principal moments are {low:.9g}, {middle:.9g} and "
            f"{high:.9g} kg·m², and those of a body are greater than 0"
        )
    if low + middle < high * (1.0 - _ROUNDING):
        return (
            f"the inertia breaks the triangle inequality: of the principal moments of a body none is greater than the "
            f"sum of the other two, but {low:.9g} + {middle:.9g} < {high:.9g} kg·m²"
        )
    return None


def is_sound(inertia: Inertia) -> Condition:
    """Whether an inertia tensor keeps both rules with something to spare; takes columns.

    The rules on the matrix itself: I and tr(I)/2·E - I are positive definite. That needs no eigenvalues.
    """
    elements = _matrix(inertia)
    half_trace = 0.5 * (inertia.ixx + inertia.iyy + inertia.izz)
    second_moments = tuple(half_trace * (k in (0, 4, 8)) - element for k, element in enumerate(elements))
    return _positive_definite(elements) & _positive_definite(second_moments)


def _matrix(inertia: Inertia) -> Rotation:
    """The tensor as a row-major matrix."""
    i = inertia
    return (i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz)


def _positive_definite(matrix: Sequence[float]) -> Condition:
    """Whether all pivots of a symmetric 3x3 matrix are positive (Sylvester's criterion)."""
    a, b, c, _, d, e, _, _, f = matrix
    first = where(a > 0.0, a, 1.0)
    d1, e1 = d - b * b / first, e - b * c / first
    second = where(d1 > 0.0, d1, 1.0)
    return (a > 0.0) & (d1 > 0.0) & (f - c * c / first - e1 * e1 / second > 0.0)


def _jacobi_rotation(a: list[list[float]], p: int, q: int) -> None:
    """Makes element (p, q) of a symmetric matrix 0 by a rotation (Golub and Van Loan, algorithm 8.5.1)."""
    if not a[p][q]:
        return
    tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q])
    t = math.copysign(1.0, tau) / (abs(tau) + math.hypot(1.0, tau))
    c = 1.0 / math.hypot(1.0, t)
    s = t * c
    for k in range(3):
        a[k][p], a[k][q] = c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]
    for k in range(3):
        a[p][k], a[q][k] = c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]
    a[p][q] = a[q][p] = 0.0


def _clean(vector: Vec3) -> Vec3:
    """A vector without -0.0."""
    return (vector[0] + 0.0, vector[1] + 0.0, vector[2] + 0.0)
