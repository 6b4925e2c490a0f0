"""The sums of a walk, for the kinds of vectors that it can carry.

`TRIPLES` are tuples of three floats, or of three arrays of one shape, and need no numpy. `STACKS` are arrays of shape
(3, P, N) for P joint vectors of N arms, with a dimension of 1 where all are alike. All sums are elementwise, so that an
arm's figures do not depend on the arms beside it.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from dh2urdf.rotations import ZERO

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence

Numbers: TypeAlias = Any
"""A float, or an array."""
Vector: TypeAlias = Any
"""Three numbers, or an array whose first dimension is 3."""
Axes: TypeAlias = tuple[Vector, Vector, Vector]
"""The x, y and z axis of a frame."""


class Vectors(NamedTuple):
    """How a kind of vectors is added.

    Attributes:
        axes: makes the axes of the root.
        origin: makes its origin.
        moved: p + l·u.
        turned: the axes u and v after a turn by an angle in their plane: c·u + s·v and c·v − s·u.
        mixed: a sum of the axes, each times its factor: x·u + y·v + z·w.
    """

    axes: Callable[[], Axes]
    origin: Callable[[], Vector]
    moved: Callable[[Vector, Numbers, Vector], Vector]
    turned: Callable[[Numbers, Numbers, Vector, Vector], tuple[Vector, Vector]]
    mixed: Callable[[Sequence[Numbers], Axes], Vector]


def _moved(p: Vector, length: Numbers, u: Vector) -> Vector:
    x, y, z = p
    a, b, c = u
    return (x + length * a, y + length * b, z + length * c)


def _turned(c: Numbers, s: Numbers, u: Vector, v: Vector) -> tuple[Vector, Vector]:
    x, y, z = u
    a, b, d = v
    return (c * x + s * a, c * y + s * b, c * z + s * d), (c * a - s * x, c * b - s * y, c * d - s * z)


def _mixed(factors: Sequence[Numbers], axes: Axes) -> Vector:
    x, y, z = factors
    (a, b, c), (d, e, f), (g, h, i) = axes
    return (x * a + y * d + z * g, x * b + y * e + z * h, x * c + y * f + z * i)


def _stacked_axes() -> Axes:
    import numpy as np

    x, y, z = np.eye(3).reshape(3, 3, 1, 1)
    return (x, y, z)


def _stacked_origin() -> Vector:
    import numpy as np

    return np.zeros((3, 1, 1))


def _moved_stack(p: Vector, length: Numbers, u: Vector) -> Vector:
    step = length * u
    if not _holds(step, p):
        return p + step
    step += p
    return step


def _turned_stacks(c: Numbers, s: Numbers, u: Vector, v: Vector) -> tuple[Vector, Vector]:
    cu, cv, su, sv = c * u, c * v, s * u, s * v
    if not (_holds(cu, sv) and _holds(cv, su)):
        return cu + sv, cv - su
    cu += sv
    cv -= su
    return cu, cv


def _holds(sums: Vector, others: Vector) -> bool:
    """Whether an array has room for its sum with another one: new memory costs several times what a sum does."""
    _, poses, arms = sums.shape
    _, other_poses, other_arms = others.shape
    return bool(poses >= other_poses and arms >= other_arms)


def _mixed_stack(factors: Sequence[Numbers], axes: Axes) -> Vector:
    x, y, z = factors
    return x * axes[0] + y * axes[1] + z * axes[2]


TRIPLES = Vectors(lambda: ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)), lambda: ZERO, _moved, _turned, _mixed)
STACKS = Vectors(_stacked_axes, _stacked_origin, _moved_stack, _turned_stacks, _mixed_stack)
