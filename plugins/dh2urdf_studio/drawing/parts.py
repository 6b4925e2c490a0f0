"""What the nodes of a scene are made of: bodies with a size, a place, a colour and a layer; and what drags a link.

A link that is dragged moves the joint that is nearest to it, or the one which that joint follows.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from dh2urdf.manipulator import Follower, JointType
from dh2urdf.rotations import IDENTITY, X_AXIS, Y_AXIS, RigidTransform, Rotation, Vec3, cross, norm, scale
from dh2urdf_studio.drawing.mesh_files import DrawnMesh

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from dh2urdf.robot import Joint, Link, Robot

Colour: TypeAlias = tuple[float, float, float]  # red, green, blue in 0..1

GREY: Colour = (0.72, 0.74, 0.77)
COLLISION: Colour = (0.85, 0.2, 0.45)
MASS: Colour = (0.45, 0.3, 0.75)
CENTRE: Colour = (1.0, 0.85, 0.1)
PAPER: Colour = (0.45, 0.24, 0.72)
BESIDE: Colour = (0.03, 0.55, 0.42)
_TURNS: tuple[Colour, ...] = ((0.85, 0.1, 0.6), (1.0, 0.85, 0.1))
AXIS_COLOURS: Mapping[JointType, tuple[Colour, ...]] = {
    JointType.REVOLUTE: _TURNS,
    JointType.CONTINUOUS: _TURNS,
    JointType.PRISMATIC: ((0.0, 0.72, 0.62), (0.75, 0.95, 0.2)),
}
"""Colours of a joint's axis: the usual one, and the one for links of nearly that colour."""
_MOVING = (JointType.REVOLUTE, JointType.CONTINUOUS, JointType.PRISMATIC)
_STEPS, _CLOSE = 30, 1e-9
APART = 0.3  # distance of two colours that can be told apart


class Grip(NamedTuple):
    """How a link can be dragged: it turns about an axis, or slides along it."""

    joint: str  # whose value changes
    carrier: str  # the link whose frame has the axis: of the joint nearest to the link
    axis: Vec3  # in the carrier's frame
    slides: bool
    is_endless: bool  # whether the joint whose value changes has no limits
    law: Follower | None = None  # how the joint nearest to the link follows that one

    def value(self, before: float, by: float) -> float:
        """The joint value that turns or slides the link so far from a value before [rad or m], by Newton's method."""
        law = self.law or Follower(self.joint)
        aim, value = law.value(before) + by, before
        for _ in range(_STEPS):
            now, rate = law.value(value), law.rate(value)
            if abs(aim - now) < _CLOSE or not rate:
                break
            value += (aim - now) / rate
        if not abs(law.value(value) - aim) < _CLOSE:  # the joint turns back before
            return before
        return math.remainder(value, math.tau) if self.is_endless else value


@dataclass(frozen=True, slots=True, kw_only=True)
class ScenePart:
    """A body of a node.

    Its shape is ``box`` (size x, y, z [m]), ``cylinder`` (radius, length), ``sphere`` (radius, or three half axes),
    ``frame`` (length) or ``mesh`` (none).
    """

    shape: str
    size: tuple[float, ...]
    pose: RigidTransform = IDENTITY  # in the node
    layer: str = "links"  # with what it is shown, one of `LAYERS`
    colour: Colour = GREY
    opacity: float = 1.0
    mesh: DrawnMesh | None = None
    own_colours: bool = (
        False  # whether those of the mesh file come before `colour`: of a description they do, as in RViz
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class SceneNode:
    """A rigid thing."""

    name: str  # of a link, or ``frame 3``
    row: int | None = None  # number of the row of the table that it belongs to, counted from 0
    figure: str = ""  # the name of the robot that it belongs to
    grip: Grip | None = None  # how it can be dragged; None where no joint moves it
    carrier: str | None = None  # the node whose frame carries its frame; None for what shows no frame, and for a root
    parts: tuple[ScenePart, ...] = ()
    label: str = ""  # at its origin
    layer: str = "frames"  # of the label
    rooted: bool = False  # whether no joint moves it, in a robot that may stand elsewhere than at its root


def towards(direction: Vec3) -> Rotation:
    """A rotation that turns z into a direction."""
    z = scale(1.0 / norm(direction), direction)
    y = cross(z, X_AXIS if abs(z[0]) < 0.9 else Y_AXIS)  # noqa: PLR2004 - any that is not nearly parallel
    y = scale(1.0 / norm(y), y)
    x = cross(y, z)
    return (x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2])


def mass_parts(link: Link, radius: float) -> Iterator[ScenePart]:
    """A ball of a radius [m] at the centre of mass of a link, and the ellipsoid of even density with its inertia.

    An ellipsoid with the half axes a, b, c has the principal moments I1 = m (b² + c²)/5 and so on
    (https://scienceworld.wolfram.com/physics/MomentofInertiaEllipsoid.html), so a² = 5 (I2 + I3 - I1)/(2 m). Where the
    largest moment is larger than the sum of the other two, no body has the tensor, and there is no ellipsoid.
    """
    import numpy as np

    inertial = link.inertial
    if inertial is None or not inertial.mass > 0.0:
        return
    centre, i = RigidTransform(IDENTITY.rotation, inertial.com), inertial.inertia
    yield ScenePart(shape="sphere", size=(radius,), pose=centre, layer="masses", colour=CENTRE)
    moments, axes = np.linalg.eigh([[i.ixx, i.ixy, i.ixz], [i.ixy, i.iyy, i.iyz], [i.ixz, i.iyz, i.izz]])
    if np.linalg.det(axes) < 0.0:
        axes[:, 2] *= -1.0
    squares = 2.5 / inertial.mass * (moments.sum() - 2.0 * moments)
    if squares.min() >= 0.0:
        half_axes = tuple(map(float, np.sqrt(squares)))
        pose = RigidTransform(tuple(map(float, axes.ravel())), inertial.com)  # type: ignore[arg-type]  # nine of them
        yield ScenePart(shape="sphere", size=half_axes, pose=pose, layer="inertias", colour=MASS, opacity=0.5)


def grips(robot: Robot, before: str = "") -> dict[str, Grip]:
    """How the links of a robot can be dragged, by the name of the link; those that nothing moves are left out."""
    above = {joint.child: joint for joint in robot.joints}
    joints, followers = {joint.name: joint for joint in robot.joints}, robot.followers
    found = {}
    for link in robot.links:
        name, seen = link.name, set[str]()
        while (joint := above.get(name)) is not None and name not in seen:
            seen.add(name)
            if (grip := _grip(joint, joints, followers, before)) is not None:
                found[link.name] = grip
                break
            name = joint.parent
    return found


def _grip(joint: Joint, joints: Mapping[str, Joint], followers: Mapping[str, Follower], before: str) -> Grip | None:
    if joint.type not in _MOVING or norm(joint.axis) == 0.0:
        return None
    law = followers.get(joint.name)
    if law and not any(law.factors[1:]):
        return None
    leader, slides = law.leader if law else joint.name, joint.type is JointType.PRISMATIC
    is_endless = joints[leader].type is JointType.CONTINUOUS
    return Grip(before + leader, before + joint.child, joint.axis, slides, is_endless, law)
