"""The ends of a chain: what base and tool hold, and what the first row and the last row take from them.

The rows of the data sheet come first, and an identity comes before anything else.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.manipulator import Convention
from dh2urdf.rotations import HALF_PI, IDENTITY, RigidTransform, cos_sin, multiply, rotation_x, rotation_z
from dh2urdf_plugins.extraction.sliding import STEEPEST
from dh2urdf_plugins.extraction.zsz import decompose

if TYPE_CHECKING:
    from dh2urdf_plugins.extraction.numbers import Precision
    from dh2urdf_plugins.extraction.zsz import ZSZ

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
