"""A fixed row between nearly parallel axes whose common normal is too far away for a double.

The link is split at the line from a point P of the first axis to its projection on the second one. Both axes are
perpendicular to that line, up to the small angle between them: the numbers of the rows are of the arm's own size.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.manipulator import JointType
from dh2urdf.rotations import ZERO, RigidTransform, multiply, rotate, transpose
from dh2urdf_plugins.extraction.chain import Axis, Chain
from dh2urdf_plugins.extraction.sliding import STEEPEST
from dh2urdf_plugins.extraction.zsz import decompose, seen_from

if TYPE_CHECKING:
    from collections.abc import Callable

    from dh2urdf.rotations import Vec3
    from dh2urdf_plugins.extraction.numbers import Precision

MOST = 1000.0
"""How many lengths of the arm a d may be before the link is split."""
DIGITS = 4e-16
"""What a d loses of itself in a double."""
NEARLY = 0.1
"""Below which angle axes are nearly parallel [rad]."""


@dataclass(frozen=True, slots=True)
class NearlyParallel:
    """Two neighbours whose axes are nearly parallel.

    Attributes:
        first: name of the first joint.
        second: name of the second joint.
        angle: the angle between their axes, or between one and the other's opposite [rad].
        far: how far away the common normal is, along the axis where it is further [m].
        split: whether a fixed row is between them.
    """

    first: str
    second: str
    angle: float
    far: float
    split: bool


def split_links(
    chain: Chain, precision: Precision, arm_length: float, tolerance: float, near_parallel: str
) -> tuple[Chain, tuple[NearlyParallel, ...]]:
    """The chain with a fixed axis wherever a link has to be split, and all neighbours that are nearly parallel.

    Args:
        chain: the chain, its sliding axes in their places.
        precision: what counts as parallel.
        arm_length: the arm's length [m].
        tolerance: how far the tip may be from the file's [m].
        near_parallel: ``auto``, ``dh`` (never split) or ``split``.
    """
    decides = _decision(near_parallel, arm_length, tolerance)
    axes, links = [chain.axes[0]], [chain.links[0]]
    found: list[NearlyParallel] = []
    point = (0.0, 0.0, seen_from(chain.links[0], ZERO)[2])
    for number, after in enumerate(chain.axes[1:], start=1):
        link, before = chain.links[number], chain.axes[number - 1]
        screws = decompose(link, precision)
        sine, far = math.hypot(link.rotation[2], link.rotation[5]), max(abs(screws.b), abs(screws.e))
        if screws.parallel or sine >= NEARLY or far <= STEEPEST * arm_length:
            point = (0.0, 0.0, seen_from(link, point)[2] if screws.parallel else 0.0 - screws.e)
            links.append(link)
        else:
            reached = seen_from(link, point)[2]
            middle = _middle(link, point) if decides(far) else None
            found.append(NearlyParallel(before.joint, after.joint, math.asin(sine), far, middle is not None))
            if middle is None:
                links.append(link)
                point = (0.0, 0.0, 0.0 - screws.e)
            else:
                axes.append(Axis(before.joint, JointType.FIXED))
                links += middle
                point = (0.0, 0.0, reached)
        axes.append(after)
    return Chain(tuple(axes), (*links, chain.links[-1])), tuple(found)


def _decision(near_parallel: str, arm_length: float, tolerance: float) -> Callable[[float], bool]:
    """Whether a link is split whose normal is so far away [m]."""
    if near_parallel == "dh":
        return lambda _: False
    if near_parallel == "split":
        return lambda _: True
    return lambda far: far > MOST * arm_length or far * DIGITS > tolerance


def _middle(link: RigidTransform, point: Vec3) -> list[RigidTransform] | None:
    """The link in two parts, which meet at the line from a point of its first axis to the second axis."""
    r, t = link
    px, py, _ = seen_from(link, point)
    if (length := math.hypot(px, py)) == 0.0:
        return None
    mx, my, mz = rotate(r, (-px / length, -py / length, 0.0))
    # The frame of the middle: z along the line, x as near to the first axis as it can be.
    across = math.hypot(mx, my)
    nx, ny, nz = -mz * mx / across, -mz * my / across, across
    yx, yy, yz = my * nz - mz * ny, mz * nx - mx * nz, mx * ny - my * nx
    turn = (nx, yx, mx, ny, yy, my, nz, yz, mz)
    back = transpose(turn)
    dx, dy, dz = (there - here for there, here in zip(t, point, strict=True))
    return [RigidTransform(turn, point), RigidTransform(multiply(back, r), rotate(back, (dx, dy, dz)))]
