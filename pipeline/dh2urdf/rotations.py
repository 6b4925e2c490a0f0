"""Rotations and rigid transforms, right to the last bit at quarter turns.

Two rules make every written file the same bytes on every machine. An angle that is a multiple of π/2 has the sines
and cosines −1, 0 and 1, never 6.1e-17. And every matrix product is spelled out as sums: products through BLAS differ
between processors. The elements may be floats or numpy arrays of one shape: the same sums serve both. Functions that
say so give every entry of a column, to the last bit, what they give a float.

A column is a numpy array with an entry for each of many robots (see `dh2urdf.columns`). Sums, products and comparisons
are elementwise as they stand, and IEEE 754 rounds them alike in Python and in numpy. The first functions here do what
they do not: choosing, and what comes from the C library, where numpy has loops of its own that may differ in the last
bit. numpy is imported where there is a column, and nowhere else.

Rotations are row-major 9-tuples (r00, r01, r02, r10, …), vectors are 3-tuples; angles are in rad, lengths in m.
"""

from __future__ import annotations

import math
import operator
from functools import reduce
from itertools import repeat
from struct import pack
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

# --- Numbers and columns of numbers -----------------------------------------------------------------------------------

Number: TypeAlias = Any
"""A float, or an array of shape (N,)."""
Condition: TypeAlias = Any
"""A bool, or an array of N booleans."""


class DividedError(Exception):
    """The members of a column would go different ways.

    Attributes:
        condition: array of N booleans: which of them go the one way.
    """

    def __init__(self, condition: Condition) -> None:
        self.condition = condition
        super().__init__(condition)


def is_column(number: Number) -> bool:
    """Whether a number is one of many; numpy's own scalars are not."""
    return bool(getattr(number, "ndim", 0))


def mapped(function: Callable[..., float], *numbers: Number) -> Number:
    """The value of a function of floats; of columns, its value for every entry."""
    for number in numbers:
        if is_column(number):
            break
    else:
        return function(*numbers)
    return array_of(tuple(map(function, *[each.tolist() if is_column(each) else repeat(each) for each in numbers])))


def array_of(numbers: Sequence[float]) -> Any:  # noqa: ANN401 - an array
    """Numbers as an array of float64, not to be written to: in a third of the time that numpy takes for a list."""
    import numpy as np

    return np.frombuffer(pack(f"{len(numbers)}d", *numbers))


def total(numbers: Iterable[Number]) -> float:
    """The sum from the left, each step rounded: since Python 3.12, `sum` rounds floats otherwise, and columns so."""
    found: float = reduce(operator.add, numbers, 0.0)
    return found


def hypot(*coordinates: Number) -> Number:
    """The length of a vector, without overflow."""
    return mapped(math.hypot, *coordinates)


def atan2(y: Number, x: Number) -> Number:
    """The angle of a point [rad]."""
    return mapped(math.atan2, y, x)


def where(condition: Condition, yes: Number, no: Number) -> Number:
    """One number or another."""
    if is_column(condition):
        import numpy as np

        return np.where(condition, yes, no)
    return yes if condition else no


def greater_of(left: Number, right: Number) -> Number:
    """The greater of two numbers."""
    if is_column(left) or is_column(right):
        import numpy as np

        return np.maximum(left, right)
    return max(left, right)


def smaller_of(left: Number, right: Number) -> Number:
    """The smaller of two numbers."""
    if is_column(left) or is_column(right):
        import numpy as np

        return np.minimum(left, right)
    return min(left, right)


def for_some(condition: Condition) -> bool:
    """Whether a condition holds for one member at least."""
    return bool(condition.any()) if is_column(condition) else condition


def agreed(condition: Condition) -> bool:
    """A condition on which all members agree: what has another structure cannot be made side by side.

    Raises:
        DividedError: they do not.
    """
    if not is_column(condition):
        return bool(condition)
    if condition.all():
        return True
    if condition.any():
        raise DividedError(condition)
    return False


# --- Rotations --------------------------------------------------------------------------------------------------------

Vec3: TypeAlias = tuple[float, float, float]
Rotation: TypeAlias = tuple[float, float, float, float, float, float, float, float, float]

HALF_PI = math.pi / 2
_QUARTER_TURN_TOLERANCE = (
    1e-15  # relative: within the rounding of an angle that was computed, not of one that was meant
)
_ROUNDED = 5e-3  # rad
_DIGITS = 9  # of degrees: more are the rounding of their conversion
_COSINES = (1.0, 0.0, -1.0, 0.0)
_SINES = (0.0, 1.0, 0.0, -1.0)

IDENTITY_ROTATION: Rotation = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0)
ZERO: Vec3 = (0.0, 0.0, 0.0)
X_AXIS: Vec3 = (1.0, 0.0, 0.0)
Y_AXIS: Vec3 = (0.0, 1.0, 0.0)
Z_AXIS: Vec3 = (0.0, 0.0, 1.0)


def nearest_quarter(angle: Number) -> tuple[Number, Condition]:
    """The whole number of quarter turns nearest to an angle [rad], and whether the angle is that but for rounding.

    Only rounding is forgiven (relative 1e-15); 1.5708 is not a quarter turn. Takes columns.
    """
    if isinstance(angle, float) or not is_column(angle):
        turns = round(angle / HALF_PI)
    else:
        import numpy as np

        turns = np.rint(angle / HALF_PI)
    return turns, abs(angle - turns * HALF_PI) <= _QUARTER_TURN_TOLERANCE * abs(angle)


def quarter_turns(angle: float) -> int | None:
    """The whole number of quarter turns that an angle [rad] is, or None where it is none."""
    turns, is_whole = nearest_quarter(angle)
    return turns if is_whole else None


def rounded_quarter_turn(angle: float) -> int | None:
    """The quarter turns that an angle [rad] was probably rounded from, as 1.5708 or 89.9° were; None where it was not.

    It is within two units of its own last decimal, in radians or in degrees, and within 5 mrad, of a whole number of
    quarter turns other than 0, and is none. A measured angle has more decimals: 1.57195248 was not rounded from π/2.
    """
    turns: int = round(angle / HALF_PI)
    if not turns or quarter_turns(angle) is not None or not abs(angle - turns * HALF_PI) <= _ROUNDED:
        return None
    from decimal import Decimal

    for number, whole in ((angle, turns * HALF_PI), (round(math.degrees(angle), _DIGITS), turns * 90.0)):
        exponent = Decimal(repr(number)).normalize().as_tuple().exponent
        if isinstance(exponent, int) and abs(number - whole) <= 2.0 * 10.0**exponent:
            return turns
    return None


def cos_sin(angle: Any) -> tuple[Any, Any]:  # noqa: ANN401 - floats and arrays alike
    """Cosine and sine of an angle [rad]; exact for a float that is a whole number of quarter turns.

    Those of an array are numpy's, fast and right to rounding: joint values are arrays. See `exact_cos_sin`.
    """
    if isinstance(angle, (float, int)):
        turns, is_whole = nearest_quarter(angle)
        return (_COSINES[turns % 4], _SINES[turns % 4]) if is_whole else (math.cos(angle), math.sin(angle))
    import numpy as np

    return np.cos(angle), np.sin(angle)


def exact_cos_sin(angle: Number) -> tuple[Number, Number]:
    """Cosine and sine of an angle [rad] as `cos_sin` gives them for a float; takes columns."""
    if isinstance(angle, float) or not is_column(angle):
        return cos_sin(angle)
    import numpy as np

    angles = angle.tolist()
    cosine, sine = array_of(tuple(map(math.cos, angles))), array_of(tuple(map(math.sin, angles)))
    turns, is_whole = nearest_quarter(angle)
    if is_whole.any():
        quarter = (turns % 4).astype(int)
        cosine = np.where(is_whole, np.take(_COSINES, quarter), cosine)
        sine = np.where(is_whole, np.take(_SINES, quarter), sine)
    return cosine, sine


def rotation_x(cosine: float, sine: float) -> Rotation:
    """Rotation about x."""
    return (1.0, 0.0, 0.0, 0.0, cosine, -sine, 0.0, sine, cosine)


def rotation_y(cosine: float, sine: float) -> Rotation:
    """Rotation about y."""
    return (cosine, 0.0, sine, 0.0, 1.0, 0.0, -sine, 0.0, cosine)


def rotation_z(cosine: float, sine: float) -> Rotation:
    """Rotation about z."""
    return (cosine, -sine, 0.0, sine, cosine, 0.0, 0.0, 0.0, 1.0)


def multiply(left: Rotation, right: Rotation) -> Rotation:
    """The product of two rotations."""
    a, b, c, d, e, f, g, h, i = left
    j, k, m, n, o, p, q, r, s = right
    return (
        a * j + b * n + c * q,
        a * k + b * o + c * r,
        a * m + b * p + c * s,
        d * j + e * n + f * q,
        d * k + e * o + f * r,
        d * m + e * p + f * s,
        g * j + h * n + i * q,
        g * k + h * o + i * r,
        g * m + h * p + i * s,
    )


def rotate(rotation: Rotation, vector: Vec3) -> Vec3:
    """A vector turned by a rotation."""
    x, y, z = vector
    a, b, c, d, e, f, g, h, i = rotation
    return (a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z)


def x_axis_of(rotation: Rotation) -> Vec3:
    """The turned x axis."""
    return (rotation[0], rotation[3], rotation[6])


def z_axis_of(rotation: Rotation) -> Vec3:
    """The turned z axis."""
    return (rotation[2], rotation[5], rotation[8])


def transpose(rotation: Rotation) -> Rotation:
    """The inverse of a rotation."""
    a, b, c, d, e, f, g, h, i = rotation
    return (a, d, g, b, e, h, c, f, i)


def add(left: Vec3, right: Vec3) -> Vec3:
    """The sum of two vectors."""
    return (left[0] + right[0], left[1] + right[1], left[2] + right[2])


def subtract(left: Vec3, right: Vec3) -> Vec3:
    """The difference of two vectors."""
    return (left[0] - right[0], left[1] - right[1], left[2] - right[2])


def scale(factor: float, vector: Vec3) -> Vec3:
    """A vector times a number."""
    return (factor * vector[0], factor * vector[1], factor * vector[2])


def cross(left: Vec3, right: Vec3) -> Vec3:
    """The cross product of two vectors."""
    a, b, c = left
    x, y, z = right
    return (b * z - c * y, c * x - a * z, a * y - b * x)


def dot(left: Vec3, right: Vec3) -> float:
    """The scalar product of two vectors; takes columns."""
    return left[0] * right[0] + left[1] * right[1] + left[2] * right[2]


def norm(vector: Vec3) -> float:
    """The length of a vector, without overflow; takes columns."""
    length: float = hypot(*vector)
    return length


def rotation_from_rpy(rpy: Vec3) -> Rotation:
    """The rotation Rz(yaw)·Ry(pitch)·Rx(roll) of URDF's fixed-axis angles [rad], without -0.0; takes columns."""
    (cx, sx), (cy, sy), (cz, sz) = map(exact_cos_sin, rpy)
    u, v = sy * sx, sy * cx
    return (
        cz * cy + 0.0,
        cz * u - sz * cx + 0.0,
        cz * v + sz * sx + 0.0,
        sz * cy + 0.0,
        sz * u + cz * cx + 0.0,
        sz * v - cz * sx + 0.0,
        0.0 - sy,
        cy * sx + 0.0,
        cy * cx + 0.0,
    )


NEARLY_UPRIGHT = 0.01
"""Cosine of the pitch below which a difference of roll and yaw counts more than either of them."""


def rpy_from_rotation(rotation: Rotation) -> Vec3:
    """URDF's fixed-axis angles (roll, pitch, yaw) [rad] of a rotation, right to 4e-16 at every pitch.

    The sine and cosine of yaw are divided out before pitch and roll are read off, so nothing is lost where the
    pitch is ±π/2 (the usual asin form keeps half the digits there), and −0.0 is made 0 first: atan2 tells them apart.
    Takes columns.
    """
    r00, _, r02, r10, r11, r12, r20, _, _ = (element + 0.0 for element in rotation)
    r01 = rotation[1] + 0.0
    yaw = atan2(r10, r00)
    c, s = exact_cos_sin(yaw)
    pitch = atan2(0.0 - r20, c * r00 + s * r10)
    roll = atan2(s * r02 - c * r12 + 0.0, c * r11 - s * r01 + 0.0)
    return (roll + 0.0, pitch + 0.0, yaw + 0.0)


def turned_over(rpy: Vec3) -> Vec3:
    """The other roll, pitch and yaw of the same rotation [rad]: their pitch is on the other side of ±π/2."""
    roll, pitch, yaw = rpy
    return (
        math.remainder(roll + math.pi, math.tau),
        math.copysign(math.pi, pitch) - pitch,
        math.remainder(yaw + math.pi, math.tau),
    )


def rotation_from_quaternion(quaternion: Sequence[float]) -> Rotation:
    """The rotation of a quaternion (x, y, z, w) of any length but 0.

    Raises:
        ZeroDivisionError: its length is 0.
    """
    x, y, z, w = quaternion
    s = 2.0 / (w * w + x * x + y * y + z * z)
    return (
        *(1.0 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)),
        *(s * (x * y + w * z), 1.0 - s * (x * x + z * z), s * (y * z - w * x)),
        *(s * (x * z - w * y), s * (y * z + w * x), 1.0 - s * (x * x + y * y)),
    )


def quaternion_from_rotation(rotation: Rotation) -> tuple[float, float, float, float]:
    """The unit quaternion (x, y, z, w) of a rotation; of the two that whose w, or else first number but 0, is positive.

    Source: Shepperd, Quaternion from Rotation Matrix, Journal of Guidance and Control 1(3), 1978: the square root is
    taken of the largest of the four squares, so that no digit is lost at a half turn.
    """
    r00, r01, r02, r10, r11, r12, r20, r21, r22 = rotation
    squares = (1.0 + r00 - r11 - r22, 1.0 - r00 + r11 - r22, 1.0 - r00 - r11 + r22, 1.0 + r00 + r11 + r22)
    products = (
        (squares[0], r01 + r10, r02 + r20, r21 - r12),
        (r01 + r10, squares[1], r12 + r21, r02 - r20),
        (r02 + r20, r12 + r21, squares[2], r10 - r01),
        (r21 - r12, r02 - r20, r10 - r01, squares[3]),
    )
    x, y, z, w = max(zip(squares, products, strict=True))[1]
    length = math.hypot(x, y, z, w)
    sign = math.copysign(1.0, next(part for part in (w, x, y, z) if part))
    x, y, z, w = (sign * part / length + 0.0 for part in (x, y, z, w))
    return (x, y, z, w)


class RigidTransform(NamedTuple):
    """A rigid transform from one frame to another.

    Attributes:
        rotation: the second frame's axes in the first.
        translation: the second frame's origin in the first [m].
    """

    rotation: Rotation
    translation: Vec3

    def __matmul__(self, other: RigidTransform) -> RigidTransform:
        """The transform `other` after this one, as the product of their 4x4 matrices."""
        return RigidTransform(
            multiply(self.rotation, other.rotation),
            add(self.translation, rotate(self.rotation, other.translation)),
        )

    @property
    def inverse(self) -> RigidTransform:
        """The transform back."""
        back = transpose(self.rotation)
        return RigidTransform(back, scale(-1.0, rotate(back, self.translation)))

    @classmethod
    def from_xyz_rpy(cls, xyz: Vec3, rpy: Vec3 = ZERO) -> RigidTransform:
        """The transform of a URDF origin: xyz [m], rpy [rad]."""
        return cls(rotation_from_rpy(rpy), xyz)

    @property
    def rpy(self) -> Vec3:
        """URDF's roll, pitch, yaw of the rotation [rad]."""
        return rpy_from_rotation(self.rotation)


IDENTITY = RigidTransform(IDENTITY_ROTATION, ZERO)


def nearest_rotation(matrix: Rotation) -> tuple[Rotation, float]:
    """The rotation nearest to a 3x3 matrix that is nearly one, and how far the matrix is from being orthonormal.

    Elements within rounding of −1, 0 and 1 are these. A matrix that is orthonormal to rounding is kept as it is; any
    other is brought to its polar factor by Newton's iteration R ← R·(3·1 − RᵀR)/2 (Higham, Functions of Matrices,
    eq. 8.20), which converges where the deviation is below 1. A mirrored matrix has a deviation of 2.

    Returns:
        The rotation, and the largest element of |RᵀR − 1|.
    """
    rotation = _without_rounding(matrix)
    deviation = _deviation(rotation)
    if dot(cross(rotation[0:3], rotation[3:6]), rotation[6:9]) < 0:
        return rotation, max(2.0, deviation)
    residual = deviation
    for _ in range(_NEWTON_STEPS if deviation < _CONVERGES else 0):
        if residual <= 4 * _QUARTER_TURN_TOLERANCE:
            break
        gram = multiply(transpose(rotation), rotation)
        a, b, c, d, e, f, g, h, i = (-element / 2 for element in gram)
        rotation = multiply(rotation, (a + 1.5, b, c, d, e + 1.5, f, g, h, i + 1.5))
        residual = _deviation(rotation)
    return _without_rounding(rotation), deviation


_NEWTON_STEPS = 6
_CONVERGES = 0.1


def _without_rounding(matrix: Rotation) -> Rotation:
    a, b, c, d, e, f, g, h, i = (
        float(round(x)) if math.isfinite(x) and abs(x - round(x)) <= _QUARTER_TURN_TOLERANCE else x for x in matrix
    )
    return (a, b, c, d, e, f, g, h, i)


def _deviation(matrix: Rotation) -> float:
    gram = multiply(transpose(matrix), matrix)
    return max(abs(element - (index % 4 == 0)) for index, element in enumerate(gram))
