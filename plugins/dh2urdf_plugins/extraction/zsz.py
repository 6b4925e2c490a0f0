"""Every rigid transform is a screw along z, a screw along x and a screw along z: X = Z(φ, b)·S(a, α)·Z(ψ, e).

Z(φ, b) = Rz(φ)·Tz(b) and S(a, α) = Tx(a)·Rx(α): what stands between two joints whose axes are the z of their frames.
The common normal of the two axes is the x in the middle; a is its length and α the angle between the axes.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.late_tuples import NamedTuple
from dh2urdf.rotations import RigidTransform, cos_sin, multiply, rotate, rotation_x, rotation_z, transpose

if TYPE_CHECKING:
    from dh2urdf_plugins.extraction.numbers import Precision


class ZSZ(NamedTuple):
    """A rigid transform as Z(φ, b)·S(a, α)·Z(ψ, e).

    Attributes:
        phi: turn about the first z [rad]. Of axes on one line, only φ + cψ is fixed: it is all here.
        b: shift along the first z [m]. Of parallel axes, only b + c·e is fixed: it is all here.
        a: shift along x [m].
        alpha: turn about x [rad].
        psi: turn about the second z [rad].
        e: shift along the second z [m].
        parallel: c: 1 where the axes are parallel, −1 where they are antiparallel, 0 otherwise.
    """

    phi: float
    b: float
    a: float
    alpha: float
    psi: float
    e: float
    parallel: int

    @property
    def is_collinear(self) -> bool:
        """Whether the two axes are on one line."""
        return self.parallel != 0 and self.a == 0.0

    @property
    def flipped(self) -> ZSZ:
        """The same transform with the common normal the other way."""
        alpha = math.pi if self.parallel == -1 else 0.0 - self.alpha
        return self._replace(phi=self.phi + math.pi, psi=self.psi + math.pi, a=0.0 - self.a, alpha=alpha)


def z_screw(angle: float, shift: float) -> RigidTransform:
    """Z: a turn about z [rad] and a shift along z [m]."""
    return RigidTransform(rotation_z(*cos_sin(angle)), (0.0, 0.0, shift))


def x_screw(shift: float, angle: float) -> RigidTransform:
    """S: a shift along x [m] and a turn about x [rad]."""
    return RigidTransform(rotation_x(*cos_sin(angle)), (shift, 0.0, 0.0))


def decompose(transform: RigidTransform, precision: Precision) -> ZSZ:
    """The three screws of a rigid transform.

    α is a number as the table has it, ψ is what is left after φ and α, and e and b are solved with that α: the product
    keeps every digit where the axes are nearly parallel.
    """
    r, (tx, ty, tz) = transform
    sine = math.hypot(r[2], r[5])
    alpha = precision.angle_of(math.atan2(sine, r[8]))
    ca, sa = cos_sin(alpha)
    if sine <= precision.angle or sa == 0.0:
        return _of_parallel(transform, precision)
    phi = math.atan2(r[2], 0.0 - r[5])
    cp, sp = math.cos(phi), math.sin(phi)
    left = multiply(transpose(multiply(rotation_z(cp, sp), rotation_x(ca, sa))), r)
    psi = math.atan2(left[3] - left[1], left[0] + left[4])
    e = (tx * sp - ty * cp) / sa
    return ZSZ(phi, tz - e * ca, precision.length_of(tx * cp + ty * sp), alpha, psi, e, 0)


def _of_parallel(transform: RigidTransform, precision: Precision) -> ZSZ:
    r, (tx, ty, tz) = transform
    c = 1 if r[8] > 0.0 else -1
    alpha = 0.0 if c == 1 else math.pi
    turn = math.atan2(r[3] - c * r[1], r[0] + c * r[4])
    a = precision.length_of(math.hypot(tx, ty))
    if a == 0.0:
        return ZSZ(turn, tz, 0.0, alpha, 0.0, 0.0, c)
    phi = math.atan2(ty, tx)
    return ZSZ(phi, tz, a, alpha, c * (turn - phi), 0.0, c)


def seen_from(transform: RigidTransform, point: tuple[float, float, float]) -> tuple[float, float, float]:
    """A point of the first frame in the second one [m]."""
    x, y, z = transform.translation
    return rotate(transpose(transform.rotation), (point[0] - x, point[1] - y, point[2] - z))
