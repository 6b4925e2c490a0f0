"""Where the axis of a prismatic joint lies: a sliding axis may be moved anywhere beside itself."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.rotations import IDENTITY_ROTATION, ZERO, RigidTransform, rotate
from dh2urdf_plugins.extraction.zsz import ZSZ, decompose, seen_from

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.rotations import Vec3
    from dh2urdf_plugins.extraction.chain import Chain
    from dh2urdf_plugins.extraction.numbers import Precision

FARTHEST = 4.0
"""How many lengths of the arm an axis is moved at most."""
STEEPEST = 10.0
"""How many lengths of the arm a normal of nearly parallel axes may lie away."""


def place_sliding_axes(chain: Chain, precision: Precision, arm_length: float) -> Chain:
    """The chain with the axis of each prismatic joint where most lengths of its rows are zero.

    Args:
        chain: the chain as the file has it.
        precision: what counts as zero.
        arm_length: the arm's length [m].
    """
    for number, axis in enumerate(chain.axes):
        if axis.slides:
            chain = _placed(chain, number, precision, arm_length)
    return chain


def _placed(chain: Chain, number: int, precision: Precision, arm_length: float) -> Chain:
    best, most = chain, -1
    for x, y in _candidates(chain, number, precision, arm_length):
        if not math.hypot(x, y) <= FARTHEST * arm_length:
            continue
        moved = _moved(chain, number, x, y)
        if (zeros := _zeros(moved, number, precision, arm_length)) > most:
            best, most = moved, zeros
    return best


def _moved(chain: Chain, number: int, x: float, y: float) -> Chain:
    """The chain with an axis moved beside itself [m]."""
    if x == y == 0.0:
        return chain
    links = list(chain.links)
    links[number] @= RigidTransform(IDENTITY_ROTATION, (x, y, 0.0))
    links[number + 1] = RigidTransform(IDENTITY_ROTATION, (-x, -y, 0.0)) @ links[number + 1]
    return chain.with_links(links)


def _candidates(chain: Chain, number: int, precision: Precision, arm_length: float) -> Iterator[tuple[float, float]]:
    """Where the axis may lie, in the frame where it lies, the likeliest first [m]."""
    yield 0.0, 0.0
    before, after = chain.links[number], chain.links[number + 1]
    is_first, is_last = number == 0, number == len(chain.axes) - 1
    links = [decompose(link, precision) for link in (before, after)]
    if not is_first and links[0].parallel:
        yield seen_from(before, ZERO)[:2]
    if not is_last and links[1].parallel:
        yield after.translation[:2]
    if not is_last:
        foot = _foot(decompose(chain.links[number + 2], precision), chain.links[number + 2])
        if abs(foot) <= STEEPEST * arm_length:
            yield _at(after, (0.0, 0.0, foot))
    if not is_first:
        foot = _foot_backwards(decompose(chain.links[number - 1], precision), chain.links[number - 1])
        if abs(foot) <= STEEPEST * arm_length:
            yield seen_from(before, (0.0, 0.0, foot))[:2]
    if not (is_first or is_last or links[0].parallel or links[1].parallel):
        yield from _meeting(before, after)
    if is_first:
        yield seen_from(before, ZERO)[:2]
    if is_last:
        yield after.translation[:2]


def _foot(link: ZSZ, transform: RigidTransform) -> float:
    """Where on the first axis of a link the normal stands, or the second frame's projection [m]."""
    return transform.translation[2] if link.parallel else link.b


def _foot_backwards(link: ZSZ, transform: RigidTransform) -> float:
    """Where on the second axis of a link the normal stands, or the first frame's projection [m]."""
    return seen_from(transform, ZERO)[2] if link.parallel else 0.0 - link.e


def _at(transform: RigidTransform, point: Vec3) -> tuple[float, float]:
    x, y, _ = rotate(transform.rotation, point)
    return x + transform.translation[0], y + transform.translation[1]


def _meeting(before: RigidTransform, after: RigidTransform) -> Iterator[tuple[float, float]]:
    """Where the lines of both neighbours cross, seen along the sliding axis [m]."""
    r = before.rotation  # its rows are the axes of the frame before, seen from the sliding one
    (px, py, _), ux, uy = seen_from(before, ZERO), r[6], r[7]
    (qx, qy, _), vx, vy = after.translation, after.rotation[2], after.rotation[5]
    cross = ux * vy - uy * vx
    if abs(cross) > 1e-9 * math.hypot(ux, uy) * math.hypot(vx, vy):
        t = ((qx - px) * vy - (qy - py) * vx) / cross
        yield px + t * ux, py + t * uy


def _zeros(chain: Chain, number: int, precision: Precision, arm_length: float) -> int:
    """How many of the lengths of the rows around a sliding axis are zero; none where a normal lies far away."""
    first, last = max(0, number - 1), min(len(chain.links) - 1, number + 2)
    links = {place: decompose(chain.links[place], precision) for place in range(first, last + 1)}
    for place in (number, number + 1):
        if max(abs(links[place].b), abs(links[place].e)) > STEEPEST * arm_length and not links[place].parallel:
            return -1
    lengths = [links[number].a, links[number + 1].a]
    # Of parallel axes the shift along them can be given away.
    lengths.append(_shift(links.get(number - 1), links[number]))
    lengths.append(_shift(links[number + 1], links.get(number + 2)))
    return sum(abs(length) <= precision.length for length in lengths)


def _shift(before: ZSZ | None, after: ZSZ | None) -> float:
    """The shift along the axis between two links, as far as it is fixed [m]."""
    length = 0.0 if before is None or before.parallel else before.e
    return length + (0.0 if after is None or after.parallel else after.b)
