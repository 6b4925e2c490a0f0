"""A chain of a robot description as constants: the axes of its joints, and a rigid transform between every two.

    T(q) = X_0 · Z_1(q_1) · X_1 · … · Z_N(q_N) · X_N

Frame K_i is the frame of joint i turned so that its z is the joint's axis. X_0 leads from the base link to K_1, X_i
from K_i to K_(i+1) at q = 0, X_N from K_N to the tip link. Only what stands between two joints is multiplied: each X
has its own rounding and no other.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.manipulator import JointType
from dh2urdf.rotations import IDENTITY, IDENTITY_ROTATION, ZERO, RigidTransform, multiply, norm, scale
from dh2urdf_plugins.extraction.zsz import seen_from

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.robot import Joint
    from dh2urdf.rotations import Rotation, Vec3

_QUARTER_TURNS: dict[Vec3, Rotation] = {
    (0.0, 0.0, 1.0): IDENTITY_ROTATION,
    (0.0, 0.0, -1.0): (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0),
    (1.0, 0.0, 0.0): (0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.0): (0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0): (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0),
    (0.0, -1.0, 0.0): (1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0),
}


@dataclass(frozen=True, slots=True)
class Axis:
    """The axis of a row.

    Attributes:
        joint: name of the joint.
        type: how it moves; fixed where it only splits the link between two nearly parallel axes.
    """

    joint: str
    type: JointType

    @property
    def slides(self) -> bool:
        """Whether the joint is prismatic."""
        return self.type is JointType.PRISMATIC

    @property
    def turns(self) -> bool:
        """Whether the joint turns its link."""
        return self.type in (JointType.REVOLUTE, JointType.CONTINUOUS)


@dataclass(frozen=True, slots=True)
class Chain:
    """Axes and what is between them.

    Attributes:
        axes: from the base outwards.
        links: X_0 … X_N: one more than there are axes.
    """

    axes: tuple[Axis, ...]
    links: tuple[RigidTransform, ...]

    @classmethod
    def of(cls, joints: Iterable[Joint]) -> Chain:
        """The chain of some joints, from the base outwards, fixed ones among them."""
        axes: list[Axis] = []
        links: list[RigidTransform] = []
        so_far = IDENTITY
        for joint in joints:
            so_far = _after(so_far, joint.origin.transform)
            if joint.type is JointType.FIXED:
                continue
            turn = turn_of_z(joint.axis)
            axes.append(Axis(joint.name, joint.type))
            links.append(RigidTransform(multiply(so_far.rotation, turn), so_far.translation))
            a, b, c, d, e, f, g, h, i = turn
            so_far = RigidTransform((a, d, g, b, e, h, c, f, i), ZERO)
        return cls(tuple(axes), (*links, so_far))

    @property
    def length(self) -> float:
        """The arm's length [m], wherever the file puts its frames.

        From the base's origin to its projection on axis 1, from there to its projection on axis 2 … to the tip. The
        axis of a prismatic joint has no place, so there is no step to it.
        """
        total, point = 0.0, ZERO
        for axis, link in zip(self.axes, self.links, strict=False):
            x, y, z = seen_from(link, point)
            if axis.slides:
                point = (x, y, z)
            else:
                total += math.hypot(x, y)
                point = (0.0, 0.0, z)
        return total + math.dist(point, self.links[-1].translation)

    def with_links(self, links: Iterable[RigidTransform]) -> Chain:
        """The same axes with other transforms between them."""
        return replace(self, links=tuple(links))


def turn_of_z(axis: Vec3) -> Rotation:
    """The rotation that takes z to the direction of an axis: by quarter turns where it can be, else the smallest."""
    length = norm(axis)
    x, y, z = scale(1.0 / length, axis)
    if exact := _QUARTER_TURNS.get((x + 0.0, y + 0.0, z + 0.0)):
        return exact
    half = _QUARTER_TURNS[0.0, 0.0, -1.0]
    # Of an axis that points down, 1 + z would lose digits: it is turned upwards first.
    return _smallest_turn(x, y, z) if z >= 0.0 else multiply(half, _smallest_turn(x, -y, -z))


def _smallest_turn(x: float, y: float, z: float) -> Rotation:
    """The smallest rotation that takes z to a unit vector."""
    k = 1.0 / (1.0 + z)
    return (1.0 - k * x * x, -k * x * y, x, -k * x * y, 1.0 - k * y * y, y, -x, -y, z)


def _after(first: RigidTransform, second: RigidTransform) -> RigidTransform:
    if first is IDENTITY:
        return second
    return first if second == IDENTITY else first @ second
