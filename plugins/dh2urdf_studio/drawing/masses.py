"""The mass of a link in the scene: its centre, and the ellipsoid that has its inertia."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.rotations import IDENTITY_ROTATION, RigidTransform, Vec3
from dh2urdf_studio.drawing.colours import CENTRE, MASS
from dh2urdf_studio.drawing.parts import ScenePart

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.robot import Inertial, Link


def mass_parts(link: Link, radius: float) -> Iterator[ScenePart]:
    """The centre of mass of a link, and the ellipsoid of even density that has its mass and inertia.

    Args:
        link: the link; one without a mass has neither.
        radius: of the ball at the centre of mass [m].
    """
    inertial = link.inertial
    if inertial is None or not inertial.mass > 0.0:
        return
    centre = RigidTransform(IDENTITY_ROTATION, inertial.com)
    yield ScenePart(shape="sphere", size=(radius,), pose=centre, layer="masses", colour=CENTRE)
    if (found := inertia_ellipsoid(inertial)) is not None:
        half_axes, pose = found
        yield ScenePart(shape="sphere", size=half_axes, pose=pose, layer="inertias", colour=MASS, opacity=0.5)


def inertia_ellipsoid(inertial: Inertial) -> tuple[Vec3, RigidTransform] | None:
    """The half axes [m] of the ellipsoid of even density that has a mass and an inertia, and where it is in the link.

    An ellipsoid with the half axes a, b, c is a stretched ball. The integral of x² over the mass of a unit ball of mass
    m is m/5, so the integral over the ellipsoid is m a²/5, and its principal moments are I1 = m (b² + c²)/5 and so on
    (https://scienceworld.wolfram.com/physics/MomentofInertiaEllipsoid.html). Solved for the half axes:
    a² = 5 (I2 + I3 - I1)/(2 m). The principal axes are the eigenvectors of the tensor.

    Returns:
        None for a tensor that no body has: the largest of the moments is larger than the sum of the other two.
    """
    import numpy as np

    i = inertial.inertia
    moments, axes = np.linalg.eigh([[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]])
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] *= -1.0
    squares = 2.5 / inertial.mass * (moments.sum() - 2.0 * moments)
    if not squares.min() >= 0.0:
        return None
    a, b, c = (float(axis) for axis in np.sqrt(squares))
    return (a, b, c), RigidTransform(tuple(map(float, axes.ravel())), inertial.com)  # type: ignore[arg-type]  # nine of them
