"""The limits of joints that a table does not give: range, travel, velocity, and the effort for a load."""

from __future__ import annotations

import math
from functools import cache, reduce
from typing import TYPE_CHECKING

from dh2urdf import unchecked_records as own
from dh2urdf.elementwise import greater_of, is_column, mapped
from dh2urdf.manipulator import JointType
from dh2urdf_plugins.transforms.shapes import SMALLEST

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.elementwise import Number
    from dh2urdf.manipulator import DHRow, Limits

LEAST_EFFORT = 10.0
"""Smallest default effort [N·m or N]."""
_DOUBT = 1e-9  # of a logarithm: so near to a power of ten, rounding may make another one


def complete_limits(rows: Sequence[DHRow]) -> list[Limits]:
    """The limits of an arm's rows with lower, upper and velocity filled in; effort waits for the masses.

    ±2π rad, or to each side half the length of the arm's longest link, rounded down to two digits; π rad/s or 1 m/s.
    A continuous joint has no lower and upper, a fixed one nothing.
    """
    slides = any(row.type is JointType.PRISMATIC and row.limits.lower is None for row in rows)
    slide = half_travel(rows) if slides else 0.0
    return [_complete(row, slide) for row in rows]


def half_travel(rows: Sequence[DHRow]) -> Number:
    """How far a prismatic joint without limits moves to each side [m]: its rail is no longer than the longest link.

    A link is as long as `a`, or as `d` at joint value 0. ±1 m where all of an arm's links have the length 0.
    """
    lengths = [abs(row.d + row.offset) if row.type is JointType.PRISMATIC else abs(row.d) for row in rows]
    longest = reduce(greater_of, [*lengths, *(abs(row.a) for row in rows)])
    return mapped(_half_rounded_down, longest)


def _half_rounded_down(longest: float) -> float:
    if not SMALLEST < longest < math.inf:
        return 1.0
    exponent = math.floor(math.log10(0.5 * longest)) - 1
    return _decimal(math.floor(0.5 * longest * 10.0**-exponent + 1e-9), exponent)


def _complete(row: DHRow, slide: Number) -> Limits:
    if row.type is JointType.FIXED:
        return own.limits()
    bound, speed = (slide, 1.0) if row.type is JointType.PRISMATIC else (math.tau, math.pi)
    given = row.limits
    velocity = speed if given.velocity is None else given.velocity
    if row.type is JointType.CONTINUOUS:
        return own.limits(velocity=velocity, effort=given.effort)
    return own.limits(
        lower=-bound if given.lower is None else given.lower,
        upper=bound if given.upper is None else given.upper,
        velocity=velocity,
        effort=given.effort,
    )


def travel(joint_type: JointType, limits: Limits) -> float:
    """How far a joint moves its link along its axis from where it is at joint value 0, at most [m]."""
    if joint_type is not JointType.PRISMATIC or limits.lower is None or limits.upper is None:
        return 0.0
    farthest: float = greater_of(abs(limits.lower), abs(limits.upper))
    return farthest


def default_efforts(needed: Number) -> Number:
    """What is needed [N·m or N], rounded up to two significant digits, and the least effort at least; takes columns."""
    if not is_column(needed):
        return _default_effort(needed)
    import numpy as np

    efforts = np.empty(len(needed))
    is_common = (needed > LEAST_EFFORT) & (needed < math.inf)
    logarithms = np.log10(np.where(is_common, needed, 1.0))
    is_common &= abs(logarithms - np.rint(logarithms)) > _DOUBT
    exponents = np.floor(logarithms) - 1.0
    for exponent in map(int, set(exponents[is_common].tolist())):
        chosen = is_common & (exponents == exponent)
        digits, which = np.unique(np.ceil(needed[chosen] * 10.0**-exponent - 1e-9), return_inverse=True)
        efforts[chosen] = np.array([_decimal(int(digit), exponent) for digit in digits.tolist()])[which]
    efforts[~is_common] = list(map(_default_effort, needed[~is_common].tolist()))
    return efforts


def _default_effort(needed: float) -> float:
    if not LEAST_EFFORT < needed < math.inf:
        return max(LEAST_EFFORT, needed)
    exponent = math.floor(math.log10(needed)) - 1
    return _decimal(math.ceil(needed * 10.0**-exponent - 1e-9), exponent)


@cache
def _decimal(digits: int, exponent: int) -> float:
    """A whole number times a power of ten, through text: 57 times 10**-1 would be 5.7 only by luck."""
    return float(f"{digits}e{exponent}")
