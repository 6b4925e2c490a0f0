"""Mass, centre of mass and inertia of primitives and of bodies made of them.

An `Inertial` is a body: its mass, its centre of mass in some frame, and its inertia about that centre, with axes
parallel to the frame. Everything is spelled out as sums, so the numbers are the same on every machine; and all but
`principal_moments` and `inertia_problem` takes columns, to the last bit as it takes each of their entries.

Source: the moments of solid primitives and the parallel-axis theorem as in Goldstein, Classical Mechanics, 3rd
edition, section 5.3.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Literal, TypeAlias

from dh2urdf.columns import INERTIA
from dh2urdf.manipulator import new_inertia
from dh2urdf.robot import Box, Cylinder, Inertial, Sphere, new_inertial
from dh2urdf.rotations import ZERO, Condition, Vec3, add, is_column, multiply, rotate, subtract, where

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

    from dh2urdf.manipulator import Inertia
    from dh2urdf.robot import Geometry
    from dh2urdf.rotations import RigidTransform, Rotation

Inertias: TypeAlias = Literal["keep", "repair", "recompute"]
"""What becomes of inertias that no body has, see `possible_inertia`."""
GRAVITY = 9.81
"""Acceleration of gravity [m/s²]: of the loads of joints, and of the tests that simulators hold."""
SAFETY = 2.0
"""Effort of a joint for which nobody gives one over its worst static load."""
_ROUNDING = 1e-12  # relative to the largest moment: a flat plate has A + B = C, and rounding may break it
_SPARE = (
    1e-6  # relative to the largest moment: of 60 flat bodies in any pose, PyBullet empties 24 without, none with 1e-9
)
_SWEEPS = 30  # Jacobi's method converges quadratically; a 3x3 matrix needs about five


def two_digits(number: float, to_whole: Callable[[float], int], nearly: float) -> float:
    """A number with two significant digits, through text: 57 times 10**-1 would be 5.7 only by luck."""
    exponent = math.floor(math.log10(number)) - 1
    return float(f"{to_whole(number * 10.0**-exponent + nearly)}e{exponent}")


def solid(geometry: Geometry, density: float) -> Inertial:
    """A primitive of one density [kg/m³] as a body, in its own frame.

    Raises:
        ValueError: the geometry is a mesh, whose volume only its file knows.
    """
    match geometry:
        case Box(size=(x, y, z)):
            mass = density * (x * y * z)
            k = mass / 12.0
            inertia = new_inertia(ixx=k * (y * y + z * z), iyy=k * (x * x + z * z), izz=k * (x * x + y * y))
        case Cylinder(radius=r, length=h):
            mass = density * (math.pi * r * r * h)
            across = mass / 12.0 * (3.0 * r * r + h * h)
            inertia = new_inertia(ixx=across, iyy=across, izz=0.5 * mass * r * r)
        case Sphere(radius=r):
            mass = density * (4.0 / 3.0 * math.pi * r * r * r)
            moment = 0.4 * mass * r * r
            inertia = new_inertia(ixx=moment, iyy=moment, izz=moment)
        case _:
            raise ValueError(f"the volume of {type(geometry).__name__} is not known here")
    return new_inertial(mass=mass, inertia=inertia)


def placed(body: Inertial, frame: RigidTransform) -> Inertial:
    """A body that is known in `frame`, in the frame that `frame` is given in."""
    com = frame.translation if body.com is ZERO else add(frame.translation, rotate(frame.rotation, body.com))
    x, y, z = com  # without -0.0 below
    com = (x + 0.0, y + 0.0, z + 0.0)
    return new_inertial(mass=body.mass, com=com, inertia=rotated(body.inertia, frame.rotation))


def rotated(inertia: Inertia, rotation: Rotation) -> Inertia:
    """An inertia tensor in the axes that its own axes are turned from: R·I·Rᵀ."""
    a, b, c, d, e, f, g, h, i = rotation
    if all(isinstance(product, float) and not product for product in (inertia.ixy, inertia.ixz, inertia.iyz)):
        x, y, z = inertia.ixx, inertia.iyy, inertia.izz
        j, k, m, n, o, p, q, r, s = (a * x, b * y, c * z, d * x, e * y, f * z, g * x, h * y, i * z)
    else:
        j, k, m, n, o, p, q, r, s = multiply(rotation, tensor(inertia))
    return new_inertia(
        ixx=j * a + k * b + m * c + 0.0,
        iyy=n * d + o * e + p * f + 0.0,
        izz=q * g + r * h + s * i + 0.0,
        ixy=j * d + k * e + m * f + 0.0,
        ixz=j * g + k * h + m * i + 0.0,
        iyz=n * g + o * h + p * i + 0.0,
    )


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
        m, tensor = body.mass, body.inertia
        x, y, z = subtract(body.com, (cx, cy, cz))
        ixx += tensor.ixx + m * (y * y + z * z)
        iyy += tensor.iyy + m * (x * x + z * z)
        izz += tensor.izz + m * (x * x + y * y)
        ixy += tensor.ixy - m * x * y
        ixz += tensor.ixz - m * x * z
        iyz += tensor.iyz - m * y * z
    return new_inertial(
        mass=mass,
        com=(cx, cy, cz),
        inertia=new_inertia(ixx=ixx, iyy=iyy, izz=izz, ixy=ixy + 0.0, ixz=ixz + 0.0, iyz=iyz + 0.0),
    )


def scaled(inertia: Inertia, factor: float) -> Inertia:
    """An inertia tensor times a number: that of the same shape with another mass."""
    return new_inertia(**{name: factor * getattr(inertia, name) + 0.0 for name in INERTIA})


def principal_moments(inertia: Inertia) -> Vec3:
    """The principal moments of inertia [kg·m²], smallest first (Jacobi's eigenvalue method)."""
    low, middle, high = (moment for moment, _ in _principal_axes(inertia))
    return (low, middle, high)


def has_zero_moments(inertia: Inertia) -> bool:
    """Whether some principal moments are 0, to the last digits, and none is negative: a maker's rounded table."""
    if not all(map(math.isfinite, tensor(inertia))):
        return False
    low, _, high = principal_moments(inertia)
    return high >= 0.0 and abs(low) <= _ROUNDING * high


def repaired(inertia: Inertia, floor: float = 0.0) -> Inertia:
    """The nearest tensor that a body can have, in the Frobenius norm, none of whose principal moments is smaller.

    The axes stay, and so does the greatest moment C. The others, A and B, are raised by equal shares until A + B is C,
    and each at least to the floor: of diag(0, 0, 2e-4) it makes diag(1e-4, 1e-4, 2e-4), a flat disc, and of
    diag(0.0125, 0.066, 0.086) diag(0.01625, 0.06975, 0.086). A millionth of C is to spare: PyBullet and MuJoCo do not
    forgive the rounding of A + B = C.

    Args:
        inertia: the tensor.
        floor: smallest principal moment [kg·m²].

    Raises:
        ValueError: no moment is greater than 0, and there is no floor: nothing tells how large the body is.
    """
    axes = _principal_axes(inertia)
    a, b, c = (moment for moment, _ in axes)
    c = max(c, floor)
    if c <= 0.0:
        raise ValueError("an inertia without a moment above 0 cannot be repaired")
    least, whole = max(floor, _SPARE * c), (1.0 + _SPARE) * c
    a = max(a, least, a + 0.5 * (whole - a - b))
    b = max(b, least, whole - a)
    raised = (a, b, c)
    if not (inertia.ixy or inertia.ixz or inertia.iyz):
        given = (inertia.ixx, inertia.iyy, inertia.izz)
        places = sorted(range(3), key=given.__getitem__)
        ixx, iyy, izz = (raised[places.index(place)] for place in range(3))
        return new_inertia(ixx=ixx, iyy=iyy, izz=izz)
    moments = [(moment, axis) for moment, (_, axis) in zip(raised, axes, strict=True)]

    def element(p: int, q: int) -> float:
        (a, u), (b, v), (c, w) = moments
        return a * u[p] * u[q] + b * v[p] * v[q] + c * w[p] * w[q]

    return new_inertia(
        ixx=element(0, 0), iyy=element(1, 1), izz=element(2, 2), ixy=element(0, 1), ixz=element(0, 2), iyz=element(1, 2)
    )


def possible_inertia(inertia: Inertia, how: Inertias, floor: float | None = None) -> tuple[Inertia | None, str]:
    """An inertia as it is used, and a sentence where that is not the given one; else an empty text.

    Args:
        inertia: the tensor.
        how: what becomes of a tensor that no body has. ``keep``: it stays, and no robot is made of it; ``repair``:
            `repaired` takes its place; ``recompute``: None does, so that the inertia of the drawn shape is used.
        floor: smallest principal moment of a repaired tensor [kg·m²]; with it, moments of 0 are repaired even where the
            others are kept.
    """
    broken = inertia_problem(inertia)
    if broken is None or (how == "keep" and (floor is None or not has_zero_moments(inertia))):
        return inertia, ""
    if how == "recompute" or (floor is None and principal_moments(inertia)[2] <= 0.0):
        return None, f"{broken}; the inertia of the drawn shape is used in its place"
    raised = repaired(inertia, floor or 0.0)
    before, after = (", ".join(f"{moment + 0.0:.6g}" for moment in principal_moments(i)) for i in (inertia, raised))
    nearest = "the nearest that a body can have" if floor is None else f"with inertia_floor = {floor:g}"
    return raised, (
        f"the principal moments of inertia are {before} kg·m², which no body has; {after} kg·m² are used, {nearest}"
    )


def _principal_axes(inertia: Inertia) -> list[tuple[float, Vec3]]:
    """The principal moments [kg·m²] with their axes, smallest first."""
    a = [list(tensor(inertia)[row : row + 3]) for row in (0, 3, 6)]
    axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    for _ in range(_SWEEPS):
        if not (a[0][1] or a[0][2] or a[1][2]):
            break
        for p, q in ((0, 1), (0, 2), (1, 2)):
            _jacobi_rotation(a, axes, p, q)
    found: list[tuple[float, Vec3]] = [(a[k][k], (axes[0][k], axes[1][k], axes[2][k])) for k in range(3)]
    return sorted(found)


def inertia_problem(inertia: Inertia) -> str | None:
    """The rule that an inertia tensor breaks, as a sentence; None for one that some body has.

    A body's inertia about its centre of mass is positive definite, and its principal moments A ≤ B ≤ C fulfil
    A + B ≥ C (the triangle inequality: the moments are sums of squares of distances). Rounding is forgiven.
    """
    if not all(map(math.isfinite, tensor(inertia))):
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
    elements = tensor(inertia)
    half_trace = 0.5 * (inertia.ixx + inertia.iyy + inertia.izz)
    second_moments = tuple(half_trace * (k in (0, 4, 8)) - element for k, element in enumerate(elements))
    return _positive_definite(elements) & _positive_definite(second_moments)


def tensor(inertia: Inertia) -> Rotation:
    """An inertia as a row-major 3x3 matrix [kg·m²]."""
    i = inertia
    return (i.ixx, i.ixy, i.ixz, i.ixy, i.iyy, i.iyz, i.ixz, i.iyz, i.izz)


def _positive_definite(matrix: Sequence[float]) -> Condition:
    """Whether all pivots of a symmetric 3x3 matrix are positive (Sylvester's criterion)."""
    a, b, c, _, d, e, _, _, f = matrix
    first = where(a > 0.0, a, 1.0)
    d1, e1 = d - b * b / first, e - b * c / first
    second = where(d1 > 0.0, d1, 1.0)
    return (a > 0.0) & (d1 > 0.0) & (f - c * c / first - e1 * e1 / second > 0.0)


def _jacobi_rotation(a: list[list[float]], axes: list[list[float]], p: int, q: int) -> None:
    """Makes element (p, q) of a symmetric matrix 0 by a rotation (Golub and Van Loan, algorithm 8.5.1).

    The columns of `axes` are turned with it.
    """
    if not a[p][q]:
        return
    tau = (a[q][q] - a[p][p]) / (2.0 * a[p][q])
    t = math.copysign(1.0, tau) / (abs(tau) + math.hypot(1.0, tau))
    c = 1.0 / math.hypot(1.0, t)
    s = t * c
    for k in range(3):
        a[k][p], a[k][q] = c * a[k][p] - s * a[k][q], s * a[k][p] + c * a[k][q]
    for row in axes:
        row[p], row[q] = c * row[p] - s * row[q], s * row[p] + c * row[q]
    for k in range(3):
        a[p][k], a[q][k] = c * a[p][k] - s * a[q][k], s * a[p][k] + c * a[q][k]
    a[p][q] = a[q][p] = 0.0
