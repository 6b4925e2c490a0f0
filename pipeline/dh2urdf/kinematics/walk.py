"""Chains of moves and turns, compiled once and walked at many joint vectors, for floats and for arrays alike.

A chain is a sequence of moves along an axis of the frame and turns about one, some of which belong to joints. Compiling
it leaves out what does nothing: a length of 0, and a quarter turn, which only gives the axes other names and signs. So
neither costs anything or rounds anything when the chain is walked.

A walk carries the three axes of a frame and its origin, each three numbers: floats, which need no numpy, or arrays of
shape (P, N) for P joint vectors of N arms, with a dimension of 1 where all are alike. All sums are elementwise, so that
an arm's figures do not depend on the arms beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dh2urdf.rotations import (
    IDENTITY,
    X_AXIS,
    Y_AXIS,
    Z_AXIS,
    ZERO,
    RigidTransform,
    Rotation,
    Vec3,
    cos_sin,
    cross,
    exact_cos_sin,
)

if TYPE_CHECKING:
    from collections.abc import Iterable, Sequence

    from dh2urdf.manipulator import Follower

Numbers: TypeAlias = Any
"""A float, or an array."""
Vector: TypeAlias = tuple[Numbers, Numbers, Numbers]
Axes: TypeAlias = tuple[Vector, Vector, Vector]
"""The x, y and z axis of a frame."""
Names: TypeAlias = tuple[tuple[int, float], tuple[int, float], tuple[int, float]]
"""For each axis of a frame the axis of the walked frame that it is, and its sign."""

_UNNAMED: Names = ((0, 1.0), (1, 1.0), (2, 1.0))

JointValue: TypeAlias = tuple[Numbers, Numbers, Numbers]
"""A joint value [rad or m], its cosine and its sine, which all walks at this value share."""

_MOVE, _TURN, _MIX, _SCREW, _STOP = range(5)
"""Kinds of steps, with their numbers:

a move: a length, and how far a unit of the joint value moves;
a turn: cosine and sine of an angle, None where it is 0, and the sign of the joint value that is added;
a mix of the axes: a matrix, row by row, and the names of the axes before it;
a screw: the vector that a joint turns about, and the names of the axes before it;
a stop: the names of the axes.
"""

Step: TypeAlias = tuple[int, int, "int | None", tuple[Any, ...]]
"""Its kind; the axis along or about which, 0, 1, 2 for x, y, z; the joint whose value belongs to it; its numbers."""


def values_of(q: Iterable[Numbers]) -> list[JointValue]:
    """Joint values with their cosines and sines, exact at quarter turns for floats."""
    return [(value, *cos_sin(value)) for value in q]


class Frame(NamedTuple):
    """A frame in that of the root."""

    axes: Axes  # its x, y and z axis
    origin: Vector  # where it is [m]

    @property
    def transform(self) -> RigidTransform:
        """The frame as a rigid transform."""
        (a, d, g), (b, e, h), (c, f, i) = self.axes
        return RigidTransform((a, b, c, d, e, f, g, h, i), self.origin)


class CompiledChain:
    """Moves and turns, one after the other, each in the frame that those before have led to.

    Lengths and angles are floats, or arrays of shape (N,).
    """

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self._names = _UNNAMED
        self._followers: list[tuple[int | None, Follower]] = []  # their leaders, and how they follow these

    def follow(self, leader: int | None, law: Follower) -> int:
        """A joint whose value follows from that of another one, or from none: its number, which is below 0."""
        self._followers.append((leader, law))
        return -len(self._followers)

    def move(self, along: int, length: Numbers, *, joint: int | None = None, factor: Numbers = 1.0) -> None:
        """A move along an axis by a length, and by the value of a joint times a factor [m]."""
        if isinstance(length, float) and length == 0.0 and (joint is None or _is(factor, 0.0)):
            return
        axis, sign = self._names[along]
        numbers = (length, factor) if sign > 0 else (-length, -factor)
        self.steps.append((_MOVE, axis, joint, numbers))

    def turn(self, about: int, angle: Numbers, *, joint: int | None = None, sign: int = 1) -> None:
        """A turn about an axis by an angle, and by the value of a joint times a sign [rad]."""
        cosine = sine = None
        if not isinstance(angle, float) or angle != 0.0:
            cosine, sine = exact_cos_sin(angle)
            if _is(cosine, 0.0) or _is(sine, 0.0):  # A quarter turn gives two axes other names.
                names = list(self._names)
                after, last = (about + 1) % 3, (about + 2) % 3
                if cosine:
                    names[after], names[last] = self._named(after, cosine), self._named(last, cosine)
                else:
                    names[after], names[last] = self._named(last, sine), self._named(after, -sine)
                self._names = (names[0], names[1], names[2])
                cosine = sine = None
        if cosine is None and joint is None:
            return
        axis, direction = self._names[about]
        if direction < 0:
            sine, sign = (None if sine is None else -sine), -sign
        self.steps.append((_TURN, axis, joint, (cosine, sine, sign)))

    def turn_about(self, vector: Sequence[Numbers], joint: int) -> None:
        """A turn about a unit vector, given in the frame, by the value of a joint."""
        for axis in range(3):
            if _is(vector[axis - 1], 0.0) and _is(vector[axis - 2], 0.0) and _is(abs(vector[axis]), 1.0):
                self.turn(axis, 0.0, joint=joint, sign=int(vector[axis]))
                return
        self.steps.append((_SCREW, 0, joint, (tuple(vector), self._names)))
        self._names = _UNNAMED

    def transform(self, transform: RigidTransform) -> None:
        """A rigid transform of floats."""
        if transform is IDENTITY:
            return
        for along, length in enumerate(transform.translation):
            self.move(along, length)
        matrix = transform.rotation
        columns: Any = (matrix[0::3], matrix[1::3], matrix[2::3])
        x, y, z = columns
        is_whole = all(element in (-1.0, 0.0, 1.0) for element in matrix)
        if is_whole and any(z) and cross(x, y) == z and cross(y, z) == x and cross(z, x) == y:  # only quarter turns
            x, y, z = [next(self._named(row, column[row]) for row in range(3) if column[row]) for column in columns]
            self._names = (x, y, z)
        else:
            self.steps.append((_MIX, 0, None, (matrix, self._names)))
            self._names = _UNNAMED

    def stop(self) -> None:
        """A frame that a walk returns."""
        self.steps.append((_STOP, 0, None, self._names))

    def walk(self, values: Sequence[JointValue]) -> list[Frame]:
        """The frames at the stops, at values of the joints that follow none [rad or m]."""
        if self._followers:
            values = every = [*values, *[(0.0, 1.0, 0.0)] * len(self._followers)]
            for number, (leader, law) in enumerate(self._followers, start=1):
                (every[-number],) = values_of([law.value(0.0 if leader is None else every[leader][0])])
        axes: list[Vector] = [X_AXIS, Y_AXIS, Z_AXIS]
        origin: Vector = ZERO
        stops: list[Frame] = []
        for kind, axis, joint, numbers in self.steps:
            if kind == _MOVE:
                length, factor = numbers
                if joint is not None:
                    length = length + factor * values[joint][0]
                origin = _moved(origin, length, axes[axis])
            elif kind == _TURN:
                cosine, sine, sign = numbers
                if joint is not None:
                    _, c, s = values[joint]
                    s = s if sign > 0 else -s
                    cosine, sine = (c, s) if cosine is None else (cosine * c + -sine * s, sine * c + cosine * s)
                after, last = (axis + 1) % 3, axis - 1
                axes[after], axes[last] = _turned(cosine, sine, axes[after], axes[last])
            elif kind == _STOP:
                stops.append(Frame(_renamed(axes, numbers), origin))
            else:
                matrix, names = numbers
                if joint is not None:
                    _, c, s = values[joint]
                    matrix = rotation_about(matrix, c, s)
                (a, b, c), (d, e, f), (g, h, i) = _renamed(axes, names)
                columns = [matrix[column::3] for column in range(3)]
                axes = [(x * a + y * d + z * g, x * b + y * e + z * h, x * c + y * f + z * i) for x, y, z in columns]
        return stops

    def _named(self, axis: int, factor: float) -> tuple[int, float]:
        """The name of an axis of the frame, or of its opposite."""
        name, sign = self._names[axis]
        return name, factor * sign


def _moved(p: Vector, length: Numbers, u: Vector) -> Vector:
    """The point p + l·u."""
    x, y, z = p
    a, b, c = u
    return (x + length * a, y + length * b, z + length * c)


def _turned(c: Numbers, s: Numbers, u: Vector, v: Vector) -> tuple[Vector, Vector]:
    """The axes u and v after a turn by an angle in their plane: c·u + s·v and c·v − s·u."""
    x, y, z = u
    a, b, d = v
    return (c * x + s * a, c * y + s * b, c * z + s * d), (c * a - s * x, c * b - s * y, c * d - s * z)


def _renamed(axes: Sequence[Vector], names: Names) -> Axes:
    """The axes that have these names."""
    x, y, z = [axes[name] if sign > 0 else _moved(ZERO, -1.0, axes[name]) for name, sign in names]
    return (x, y, z)


def _is(number: Numbers, value: float) -> bool:
    """Whether a number is this one for all arms."""
    return isinstance(number, float) and number == value


def rotation_about(axis: Vec3, c: Numbers, s: Numbers) -> Rotation:
    """The rotation about a unit vector by an angle with this cosine and sine, row by row (Rodrigues' formula).

    The diagonal x² + c·(1 − x²) is c + x²·(1 − c), and exact about the axes of the frame.
    """
    x, y, z = axis
    versine = 1.0 - c
    xx, yy, zz = (k * k + (1.0 - k * k) * c for k in (x, y, z))
    xs, ys, zs = (k * s for k in (x, y, z))
    xy, xz, yz = (k * versine for k in (x * y, x * z, y * z))
    return (xx, xy - zs, xz + ys, xy + zs, yy, yz - xs, xz - ys, yz + xs, zz)
