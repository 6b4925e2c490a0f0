"""A chain of a robot description as constants, its screws, and the decimals that a table writes for them.

    T(q) = X_0 · Z_1(q_1) · X_1 · … · Z_N(q_N) · X_N

Frame K_i is the frame of joint i, turned so that its z is the joint's axis. X_0 leads from the base link to K_1, X_i
from K_i to K_(i+1) at q = 0, X_N from K_N to the tip link. Only neighbours are multiplied: each X has its own rounding.

Each X is a product of three screws, Z(φ, b)·S(a, α)·Z(ψ, e), with Z(φ, b) = Rz(φ)·Tz(b) and S(a, α) = Tx(a)·Rx(α). The
common normal of the two axes is the x in the middle; a is its length and α the angle between the axes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.manipulator import JointType
from dh2urdf.rotations import (
    IDENTITY,
    IDENTITY_ROTATION,
    NEARLY_UPRIGHT,
    ZERO,
    RigidTransform,
    cos_sin,
    multiply,
    norm,
    rotate,
    rotation_x,
    rotation_z,
    scale,
    transpose,
    turned_over,
)

if TYPE_CHECKING:
    from collections.abc import Iterable

    from dh2urdf.robot import Joint
    from dh2urdf.rotations import Rotation, Vec3


# --- Decimals ---------------------------------------------------------------------------------------------------------


class Precision(NamedTuple):
    """How far a written number may be from the computed one: lengths [m] and angles [rad]."""

    length: float
    angle: float

    @classmethod
    def of(cls, tolerance: float, arm_length: float) -> Precision:
        """The precision with which one number uses a quarter of a tolerance at the tip [m, rad]."""
        return cls(between_decimals(tolerance / 4), between_decimals(tolerance / (4 * max(1.0, arm_length))))

    def finer(self) -> Precision:
        """An eighth of it."""
        return Precision(between_decimals(self.length / 8), between_decimals(self.angle / 8))

    def pose_of(self, pose: RigidTransform) -> RigidTransform:
        """A transform with rounded numbers."""
        if pose == IDENTITY:
            return pose
        x, y, z = map(self.length_of, pose.translation)
        roll, pitch, yaw = pose.rpy
        # Near a pitch of ±π/2 only roll ∓ yaw counts, up to the cosine: yaw gets the fewest digits, roll the rest.
        if abs(math.cos(pitch)) < NEARLY_UPRIGHT:
            roll, pitch, yaw = min(pose.rpy, turned_over(pose.rpy), key=lambda angles: abs(angles[2]))
            level = abs(math.cos(self.angle_of(pitch)))
            rough = Precision(self.length, between_decimals(self.angle / max(level, self.angle)))
            written = 0.0 if abs(yaw) * level <= self.angle else rough.angle_of(yaw)
            roll, yaw = roll + math.copysign(1.0, pitch) * (written - yaw), written
        return RigidTransform.from_xyz_rpy((x, y, z), (self.angle_of(roll), self.angle_of(pitch), self.angle_of(yaw)))

    def length_of(self, value: float) -> float:
        """A rounded length [m]."""
        return decimal_of(value, self.length)

    def angle_of(self, value: float) -> float:
        """A rounded angle [rad] in (−π, π]; a multiple of π/2, π/4 or π/6 where one is near enough."""
        angle = math.remainder(value, math.tau)
        while (written := self._angle(angle)) != angle:
            angle = written
        return angle

    def _angle(self, angle: float) -> float:
        if abs(abs(angle) - math.pi) <= self.angle:
            return math.pi
        for part in (2, 4, 6):
            exact = round(angle * part / math.pi) * math.pi / part
            if abs(exact - angle) <= self.angle:
                return exact
        return decimal_of(angle, self.angle)


def decimal_of(value: float, tolerance: float) -> float:
    """The decimal with the fewest places within a tolerance of a number; a decimal made so is its own decimal."""
    while (written := _shortest(value, tolerance)) != value:
        value = written
    return value


def _shortest(value: float, tolerance: float) -> float:
    if abs(value) <= tolerance:
        return 0.0
    places = max(0, -math.ceil(math.log10(2 * max(tolerance, 1e-300))) - 1)
    for more in range(places, 17):
        if abs((written := round(value, more)) - value) <= tolerance:
            while more and abs((fewer := round(value, more - 1)) - value) <= tolerance:
                more, written = more - 1, fewer  # noqa: PLW2901
            return written + 0.0
    return value


def between_decimals(tolerance: float) -> float:
    """The largest tolerance (k + ½)·10ⁿ that is not above another one: a rounded number is rounded no further."""
    if tolerance <= 0.0:
        return 0.0
    power = math.floor(math.log10(tolerance))
    candidates = [(k + 0.5) * 10.0**exponent for exponent in (power, power - 1) for k in range(9, -1, -1)]
    return next((each for each in candidates if each <= tolerance * (1 + 1e-12)), tolerance)


# --- Screws -----------------------------------------------------------------------------------------------------------


class LinkScrews(NamedTuple):
    """A rigid transform as Z(φ, b)·S(a, α)·Z(ψ, e).

    Of axes on one line only φ + cψ is fixed, which is all in φ; of parallel axes only b + c·e, which is all in b.
    """

    phi: float  # turn about the first z [rad]
    b: float  # shift along the first z [m]
    a: float  # shift along x [m]
    alpha: float  # turn about x [rad]
    psi: float  # turn about the second z [rad]
    e: float  # shift along the second z [m]
    parallel: int  # c: 1 where the axes are parallel, −1 where they are antiparallel, 0 otherwise

    @property
    def is_collinear(self) -> bool:
        """Whether the two axes are on one line."""
        return self.parallel != 0 and self.a == 0.0

    @property
    def flipped(self) -> LinkScrews:
        """The same transform with the common normal the other way."""
        alpha = math.pi if self.parallel == -1 else 0.0 - self.alpha
        return self._replace(phi=self.phi + math.pi, psi=self.psi + math.pi, a=0.0 - self.a, alpha=alpha)


def z_screw(angle: float, shift: float) -> RigidTransform:
    """Z: a turn about z [rad] and a shift along z [m]."""
    return RigidTransform(rotation_z(*cos_sin(angle)), (0.0, 0.0, shift))


def x_screw(shift: float, angle: float) -> RigidTransform:
    """S: a shift along x [m] and a turn about x [rad]."""
    return RigidTransform(rotation_x(*cos_sin(angle)), (shift, 0.0, 0.0))


def decompose(transform: RigidTransform, precision: Precision) -> LinkScrews:
    """The three screws of a rigid transform.

    α is rounded first, ψ is what is left after φ and α, and e and b are solved with that α: the product keeps every
    digit where the axes are nearly parallel.
    """
    r, (tx, ty, tz) = transform
    sine = math.hypot(r[2], r[5])
    alpha = precision.angle_of(math.atan2(sine, r[8]))
    ca, sa = cos_sin(alpha)
    if sine > precision.angle and sa != 0.0:
        phi = math.atan2(r[2], 0.0 - r[5])
        cp, sp = math.cos(phi), math.sin(phi)
        left = multiply(transpose(multiply(rotation_z(cp, sp), rotation_x(ca, sa))), r)
        psi = math.atan2(left[3] - left[1], left[0] + left[4])
        e = (tx * sp - ty * cp) / sa
        return LinkScrews(phi, tz - e * ca, precision.length_of(tx * cp + ty * sp), alpha, psi, e, 0)
    c = 1 if r[8] > 0.0 else -1
    alpha = 0.0 if c == 1 else math.pi
    turn = math.atan2(r[3] - c * r[1], r[0] + c * r[4])
    a = precision.length_of(math.hypot(tx, ty))
    if a == 0.0:
        return LinkScrews(turn, tz, 0.0, alpha, 0.0, 0.0, c)
    phi = math.atan2(ty, tx)
    return LinkScrews(phi, tz, a, alpha, c * (turn - phi), 0.0, c)


def seen_from(transform: RigidTransform, point: Vec3) -> Vec3:
    """A point of the first frame in the second one [m]."""
    x, y, z = transform.translation
    return rotate(transpose(transform.rotation), (point[0] - x, point[1] - y, point[2] - z))


# --- Chains -----------------------------------------------------------------------------------------------------------


class Axis(NamedTuple):
    """The axis of a row: the joint's name, and how it moves; fixed where it only splits a link."""

    joint: str
    type: JointType

    @property
    def turns(self) -> bool:
        """Whether the joint turns its link."""
        return self.type in (JointType.REVOLUTE, JointType.CONTINUOUS)


@dataclass(frozen=True, slots=True)
class Chain:
    """Axes from the base outwards, and the transforms X_0 … X_N between them: one more than there are axes."""

    axes: tuple[Axis, ...]
    links: tuple[RigidTransform, ...]

    @classmethod
    def of(cls, joints: Iterable[Joint]) -> Chain:
        """The chain of some joints, from the base outwards, fixed ones among them."""
        axes: list[Axis] = []
        links: list[RigidTransform] = []
        so_far = IDENTITY
        for joint in joints:
            origin = joint.origin.transform
            if so_far is IDENTITY:
                so_far = origin
            elif origin != IDENTITY:
                so_far @= origin
            if joint.type is not JointType.FIXED:
                turn = turn_of_z(joint.axis)
                axes.append(Axis(joint.name, joint.type))
                links.append(RigidTransform(multiply(so_far.rotation, turn), so_far.translation))
                so_far = RigidTransform(transpose(turn), ZERO)
        return cls(tuple(axes), (*links, so_far))

    @property
    def length(self) -> float:
        """The arm's length [m], wherever the file puts its frames.

        The way from the base's origin to its projection on axis 1, from there to its projection on axis 2 … to the tip.
        The axis of a prismatic joint has no place, so there is no step to it.
        """
        total, point = 0.0, ZERO
        for axis, link in zip(self.axes, self.links, strict=False):
            point = seen_from(link, point)
            if axis.type is not JointType.PRISMATIC:
                total += math.hypot(point[0], point[1])
                point = (0.0, 0.0, point[2])
        return total + math.dist(point, self.links[-1].translation)


_QUARTER_TURNS: dict[Vec3, Rotation] = {
    (0.0, 0.0, 1.0): IDENTITY_ROTATION,
    (0.0, 0.0, -1.0): (1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, -1.0),
    (1.0, 0.0, 0.0): (0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0),
    (-1.0, 0.0, 0.0): (0.0, 0.0, -1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0),
    (0.0, 1.0, 0.0): (1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0),
    (0.0, -1.0, 0.0): (1.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 1.0, 0.0),
}


def turn_of_z(axis: Vec3) -> Rotation:
    """The rotation that takes z to the direction of an axis: by quarter turns where it can be, else the smallest."""
    x, y, z = scale(1.0 / norm(axis), axis)
    if exact := _QUARTER_TURNS.get((x + 0.0, y + 0.0, z + 0.0)):
        return exact
    if z < 0.0:  # 1 + z would lose digits: the axis is turned upwards first
        return multiply(_QUARTER_TURNS[0.0, 0.0, -1.0], _smallest_turn(x, -y, -z))
    return _smallest_turn(x, y, z)


def _smallest_turn(x: float, y: float, z: float) -> Rotation:
    """The smallest rotation that takes z to a unit vector that does not point down."""
    k = 1.0 / (1.0 + z)
    return (1.0 - k * x * x, -k * x * y, x, -k * x * y, 1.0 - k * y * y, y, -x, -y, z)
