"""What is left to choose beside the rows: where sliding axes lie, and what base and tool share with the end rows.

The rows of the data sheet come first, and an identity comes before anything else.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import Convention, JointType
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
from dh2urdf_plugins.extraction.chain import LinkScrews, decompose, seen_from

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf_plugins.extraction.chain import Chain, Precision

FARTHEST = 4.0
"""How many lengths of the arm an axis is moved at most."""
STEEPEST = 10.0
"""How many lengths of the arm a normal of nearly parallel axes may lie away."""
_ROUNDING = 4e-16


def place_sliding_axes(chain: Chain, precision: Precision, arm_length: float) -> Chain:
    """The chain of a file with the axis of each prismatic joint where most lengths [m] of its rows are zero."""
    for number, axis in enumerate(chain.axes):
        if axis.type is JointType.PRISMATIC:
            best, most = chain, -1
            for x, y in _candidates(chain, number, precision, arm_length):
                if math.hypot(x, y) <= FARTHEST * arm_length:
                    moved = _moved(chain, number, x, y)
                    if (zeros := _zeros(moved, number, precision, arm_length)) > most:
                        best, most = moved, zeros
            chain = best
    return chain


def _moved(chain: Chain, number: int, x: float, y: float) -> Chain:
    """The chain with an axis moved sideways [m]."""
    if x == y == 0.0:
        return chain
    links = list(chain.links)
    links[number] @= RigidTransform(IDENTITY_ROTATION, (x, y, 0.0))
    links[number + 1] = RigidTransform(IDENTITY_ROTATION, (-x, -y, 0.0)) @ links[number + 1]
    return replace(chain, links=tuple(links))


def _candidates(chain: Chain, number: int, precision: Precision, arm_length: float) -> Iterator[tuple[float, float]]:
    """Where the axis may lie, in the frame where it lies, the likeliest first [m]."""
    yield 0.0, 0.0
    before, after = chain.links[number], chain.links[number + 1]
    is_first, is_last = number == 0, number == len(chain.axes) - 1
    parallel_before, parallel_after = (decompose(link, precision).parallel for link in (before, after))
    if not is_first and parallel_before:
        yield seen_from(before, ZERO)[:2]
    if not is_last and parallel_after:
        yield after.translation[:2]
    if not is_last:  # through the foot, on the next axis, of that axis's own next normal
        screws = decompose(link := chain.links[number + 2], precision)
        foot = link.translation[2] if screws.parallel else screws.b
        if abs(foot) <= STEEPEST * arm_length:
            x, y, _ = rotate(after.rotation, (0.0, 0.0, foot))
            yield x + after.translation[0], y + after.translation[1]
    if not is_first:  # the same backwards
        screws = decompose(link := chain.links[number - 1], precision)
        foot = seen_from(link, ZERO)[2] if screws.parallel else 0.0 - screws.e
        if abs(foot) <= STEEPEST * arm_length:
            yield seen_from(before, (0.0, 0.0, foot))[:2]
    if not (is_first or is_last or parallel_before or parallel_after):
        yield from _meeting(before, after)
    if is_first:
        yield seen_from(before, ZERO)[:2]
    if is_last:
        yield after.translation[:2]


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
    """How many of the lengths of the rows around a sliding axis are zero; −1 where a normal lies far away."""
    first, last = max(0, number - 1), min(len(chain.links) - 1, number + 2)
    links = {place: decompose(chain.links[place], precision) for place in range(first, last + 1)}
    before, after = links[number], links[number + 1]
    if any(max(abs(each.b), abs(each.e)) > STEEPEST * arm_length and not each.parallel for each in (before, after)):
        return -1

    def shift(one: LinkScrews | None, other: LinkScrews | None) -> float:
        """The shift along the axis between two links, as far as it is fixed: of parallel axes it can be given away."""
        length = 0.0 if one is None or one.parallel else one.e
        return length + (0.0 if other is None or other.parallel else other.b)

    lengths = (before.a, after.a, shift(links.get(number - 1), before), shift(after, links.get(number + 2)))
    return sum(abs(length) <= precision.length for length in lengths)


# --- Base and tool ----------------------------------------------------------------------------------------------------


class Base(NamedTuple):
    """A way to share the first link between base and first row."""

    transform: RigidTransform
    turn: float  # ψ: what θ of the first group of axes takes [rad], or the base itself where it is turned
    shift: float  # e: what d of the first run of axes takes [m]
    row: tuple[float, float] = (0.0, 0.0)  # a and α of a first row of the modified convention
    is_turned: bool = False  # whether the base is turned about the first axis, so that θ of the first group is 0


class Tip(NamedTuple):
    """How the last link is shared between last row and tool, which is the rest; without one it is the identity."""

    turn: float | None  # φ: what θ of the last group of axes takes [rad]; None where the tool takes all of it
    shift: float  # b: what d of the last run takes [m]
    row: tuple[float, float] = (0.0, 0.0)  # a and α of the last row of the standard convention
    has_tool: bool = False


def bases(link: RigidTransform, convention: Convention, precision: Precision, arm_length: float) -> list[Base]:
    """The ways to share X_0, from the base link to the first axis, in a convention; the arm's length is in m."""
    screws = decompose(link, precision)
    if screws.parallel == 1 and screws.is_collinear:
        base = Base(IDENTITY, screws.phi, screws.b)
        return [base, base._replace(is_turned=True)]
    if convention is Convention.MODIFIED and (found := _in_first_row(screws, precision, arm_length)):
        return [found]
    if screws.parallel:
        x, y, _ = link.translation if screws.a else ZERO
        pose = RigidTransform(rotation_x(*cos_sin(screws.alpha)), (x, y, 0.0))
        base = Base(pose, screws.psi + screws.parallel * screws.phi, screws.parallel * screws.b)
        return [base, base._replace(is_turned=True)]
    ux, uy, uz = link.rotation[2], link.rotation[5], link.rotation[8]
    x, y, z = link.translation
    height = x * ux + y * uy + z * uz  # of the first frame's origin above the point nearest to the base link's
    nearest = (x - height * ux, y - height * uy, z - height * uz)
    alpha = math.atan2(math.hypot(ux, uy), uz)
    ways = []
    for phi, tilt in ((screws.phi, alpha), (screws.phi + math.pi, -alpha)):
        turned = multiply(rotation_z(*_quarter_cos_sin(phi)), rotation_x(*_quarter_cos_sin(tilt)))
        ways.append(Base(RigidTransform(turned, nearest), screws.psi + (phi - screws.phi), height))
    return [*ways, ways[0]._replace(is_turned=True)]


def _quarter_cos_sin(angle: float) -> tuple[float, float]:
    """Cosine and sine of an angle that may be a quarter turn but for rounding."""
    quarter = round(angle / HALF_PI) * HALF_PI
    cosine, sine = cos_sin(quarter if abs(angle - quarter) < _ROUNDING else angle)
    return cosine, sine


def _in_first_row(screws: LinkScrews, precision: Precision, arm_length: float) -> Base | None:
    """The identity, where a first row with a and α makes it so."""
    if screws.is_collinear:  # antiparallel: the turn is about axis 1 as well
        screws = screws._replace(psi=-screws.phi, phi=0.0)
    if screws.parallel:
        screws = screws._replace(b=0.0, e=screws.parallel * screws.b)
    phi = precision.angle_of(screws.phi)
    if phi not in (0.0, math.pi) or abs(screws.b) > precision.length or abs(screws.e) > STEEPEST * arm_length:
        return None
    screws = screws.flipped if phi else screws
    return Base(IDENTITY, screws.psi, screws.e, (screws.a, screws.alpha))


def tip(link: RigidTransform, convention: Convention, precision: Precision, arm_length: float) -> Tip:
    """How X_N, from the last axis to the tip link, is shared in a convention; the arm's length is in m."""
    screws = decompose(link, precision)
    height = link.translation[2]
    if screws.parallel == 1 and screws.is_collinear:
        return Tip(screws.phi, height)
    psi = precision.angle_of(screws.psi)
    is_near = abs(screws.e) <= precision.length and abs(screws.b) <= STEEPEST * arm_length
    if convention is Convention.STANDARD and psi in (0.0, math.pi) and is_near:
        # A last row makes the tool the identity.
        screws = screws.flipped if psi else screws
        return Tip(screws.phi, screws.b, (screws.a, screws.alpha))
    return Tip(screws.phi + screws.parallel * screws.psi if screws.parallel else None, height, has_tool=True)
