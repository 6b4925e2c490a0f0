"""The ends of a chain: what base and tool hold, and what the first row and the last row take from them.

The rows of the data sheet come first, and an identity comes before anything else.

Where the axis of a prismatic joint lies: a sliding axis may be moved anywhere beside itself.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from dh2urdf.manipulator import Convention
from dh2urdf.rotations import (
    HALF_PI,
    IDENTITY,
    IDENTITY_ROTATION,
    ZERO,
    RigidTransform,
    cos_sin,
    multiply,
    rotate,
    rotation_x,
    rotation_z,
)
from dh2urdf_plugins.extraction.chain import ZSZ, decompose, seen_from

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.rotations import Vec3
    from dh2urdf_plugins.extraction.chain import Chain, Precision


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


_ROUNDING = 4e-16


@dataclass(frozen=True, slots=True)
class Base:
    """A way to share the first link between base and first row.

    Attributes:
        transform: the base transform.
        turn: ψ: what θ of the first group of axes takes [rad], or the base itself where it is turned.
        shift: e: what d of the first run of axes takes [m].
        is_parallel: whether the first axis is parallel to z of the base link, so that heights of both are one.
        row: a and α of a first row of the modified convention.
        is_turned: whether the base is turned about the first axis, so that θ of the first group is 0.
    """

    transform: RigidTransform
    turn: float
    shift: float
    is_parallel: bool
    row: tuple[float, float] = (0.0, 0.0)
    is_turned: bool = False


@dataclass(frozen=True, slots=True)
class Tip:
    """How the last link is shared between last row and tool.

    Attributes:
        turn: φ: what θ of the last group of axes takes [rad]; None where the tool takes all of it.
        shift: b: what d of the last run takes [m].
        row: a and α of the last row of the standard convention.
        has_tool: whether there is a tool: the rest, whatever it is. Without one it is the identity.
    """

    turn: float | None
    shift: float
    row: tuple[float, float] = (0.0, 0.0)
    has_tool: bool = False


def bases(link: RigidTransform, convention: Convention, precision: Precision, arm_length: float) -> list[Base]:
    """The ways to share X_0, from the base link to the first axis.

    Args:
        link: X_0.
        convention: of the rows.
        precision: what counts as zero.
        arm_length: the arm's length [m].
    """
    screws = decompose(link, precision)
    if screws.parallel == 1 and screws.is_collinear:
        return _turnable(Base(IDENTITY, screws.phi, screws.b, is_parallel=True))
    if convention is Convention.MODIFIED and (base := _in_first_row(screws, precision, arm_length)):
        return [base]
    if screws.parallel:
        x, y, _ = link.translation if screws.a else (0.0, 0.0, 0.0)
        turn = screws.psi + screws.parallel * screws.phi
        pose = RigidTransform(rotation_x(*cos_sin(screws.alpha)), (x, y, 0.0))
        return _turnable(Base(pose, turn, screws.parallel * screws.b, is_parallel=True))
    ux, uy, uz = link.rotation[2], link.rotation[5], link.rotation[8]
    x, y, z = link.translation
    height = x * ux + y * uy + z * uz  # of the first frame's origin above the point nearest to the base link's
    nearest = (x - height * ux, y - height * uy, z - height * uz)
    alpha = math.atan2(math.hypot(ux, uy), uz)
    ways = []
    for phi in (screws.phi, screws.phi + math.pi):
        alpha_of_phi = alpha if phi == screws.phi else -alpha
        turned = multiply(rotation_z(*_exact(phi)), rotation_x(*_exact(alpha_of_phi)))
        turn = screws.psi + (phi - screws.phi)
        ways.append(Base(RigidTransform(turned, nearest), turn, height, is_parallel=False))
    return [*ways, replace(ways[0], is_turned=True)]


def _turnable(base: Base) -> list[Base]:
    return [base, replace(base, is_turned=True)]


def _exact(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle that may be a quarter turn but for rounding."""
    turns = round(angle / HALF_PI)
    cosine, sine = cos_sin(turns * HALF_PI if abs(angle - turns * HALF_PI) < _ROUNDING else angle)
    return cosine, sine


def _in_first_row(screws: ZSZ, precision: Precision, arm_length: float) -> Base | None:
    """The identity, where a first row with a and α makes it so."""
    if screws.is_collinear:  # antiparallel: the turn is about axis 1 as well
        screws = screws._replace(psi=-screws.phi, phi=0.0)
    if screws.parallel:
        screws = screws._replace(b=0.0, e=screws.parallel * screws.b)
    phi = precision.angle_of(screws.phi)
    if phi not in (0.0, math.pi) or abs(screws.b) > precision.length or abs(screws.e) > STEEPEST * arm_length:
        return None
    if phi:
        screws = screws.flipped
    return Base(IDENTITY, screws.psi, screws.e, bool(screws.parallel), (screws.a, screws.alpha))


def tip(link: RigidTransform, convention: Convention, precision: Precision, arm_length: float) -> Tip:
    """How X_N, from the last axis to the tip link, is shared.

    Args:
        link: X_N.
        convention: of the rows.
        precision: what counts as zero.
        arm_length: the arm's length [m].
    """
    screws = decompose(link, precision)
    height = link.translation[2]
    if screws.parallel == 1 and screws.is_collinear:
        return Tip(screws.phi, height)
    if convention is Convention.STANDARD and (found := _in_last_row(screws, precision, arm_length)):
        return found
    if screws.parallel:
        return Tip(screws.phi + screws.parallel * screws.psi, height, has_tool=True)
    return Tip(None, height, has_tool=True)


def _in_last_row(screws: ZSZ, precision: Precision, arm_length: float) -> Tip | None:
    """No tool, where a last row with a and α makes it so."""
    psi = precision.angle_of(screws.psi)
    if psi not in (0.0, math.pi) or abs(screws.e) > precision.length or abs(screws.b) > STEEPEST * arm_length:
        return None
    if psi:
        screws = screws.flipped
    return Tip(screws.phi, screws.b, (screws.a, screws.alpha))
