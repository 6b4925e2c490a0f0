"""From the parts of an arm to the robot: masses, limits, the base and the frames at the tip.

What both variants share. A variant says where the joints stand and what the links look like; here they get the names,
the mass properties and the efforts that every reader of robot descriptions needs.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any, NamedTuple

from dh2urdf.columns import DYNAMICS
from dh2urdf.errors import TransformError
from dh2urdf.kinematics.mass import GRAVITY, SAFETY, compound, placed, rotated, scaled, solid, two_digits
from dh2urdf.manipulator import BASE, FLANGE, ROOT, TOOL, DHRow, JointType, Limits, whole_laws
from dh2urdf.robot import (
    WEIGHTLESS,
    Collision,
    Inertial,
    Joint,
    Link,
    Mesh,
    Origin,
    Parameter,
    Robot,
    Sphere,
    Visual,
    new_inertial,
    new_joint,
    new_link,
    new_parameter,
)
from dh2urdf.rotations import RigidTransform, Vec3, add, cross, mapped, norm, rotate, subtract
from dh2urdf.source import Messages
from dh2urdf_plugins.transforms.checks import PAYLOAD, is_frame, is_weighed
from dh2urdf_plugins.transforms.limits import travel

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf.manipulator import Manipulator, Payload
    from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions

say = Messages(__file__)


LEAST_EFFORT = 10.0
"""Smallest default effort [N·m or N]."""


class Part(NamedTuple):
    """One row as a variant places it: a joint and the link that it moves."""

    row: DHRow
    limits: Limits  # lower and upper complete
    holder: str | None  # the link that the joint is on; None for the base
    origin: Origin  # the link's frame in the frame of the holder
    axis: Vec3  # of the joint, in the link's frame
    visuals: tuple[Visual, ...]  # what is seen, in the link's frame
    collisions: tuple[Collision, ...]  # what touches
    foot: Vec3  # a point of the joint's axis, in the link's frame [m]
    reach: float  # distance at most to the next joint, from where the foot is at joint value 0 [m]
    arm: float  # distance at most of the next joint from the joint's axis [m]
    dh_frame: RigidTransform | None  # the DH frame after this row, in the link's frame; None where the variant has none


class Base(NamedTuple):
    """The body that carries the arm."""

    origin: Origin  # of base_link_inertia in base_link
    visuals: tuple[Visual, ...]  # what is seen, in base_link_inertia
    collisions: tuple[Collision, ...]  # what touches
    dh_frame: Origin = Origin()  # the DH frame before the first row, in base_link_inertia


def parameters(manipulator: Manipulator, *, angles: bool = False) -> tuple[Parameter, ...]:
    """The numbers that formulas use: the lengths of every row and, if asked for, its angles."""
    units = {"a": "m", "alpha": "rad", "d": "m", "theta": "rad"} if angles else {"a": "m", "d": "m"}
    return tuple(
        new_parameter(name=f"{name}_{number}", value=getattr(row, name) + 0.0, unit=unit, joint=row.joint)
        for number, row in enumerate(manipulator.rows, start=1)
        for name, unit in units.items()
    )


def assemble(
    manipulator: Manipulator,
    *,
    base: Base,
    parts: Sequence[Part],
    flange: Origin,
    tool0: Origin,
    options: AlphaSwapOptions,
    parameters: tuple[Parameter, ...],
    comment: str,
) -> Robot:
    """The robot of a manipulator, of a part for each row; flange and tool0 are on the last link that has a body."""
    density = manipulator.density or options.density
    seen = options.visuals == "all" if manipulator.visuals is None else manipulator.visuals
    touching = options.collisions == "all" if manipulator.collisions is None else manipulator.collisions
    bodies = [link_body(part, density) for part in parts]
    payload = manipulator.payload and payload_body(manipulator.payload, density)
    last = next((number for number, part in reversed([*enumerate(parts)]) if not is_frame(part.row)), None)
    laden = list(bodies)
    if payload and last is not None:
        laden[last] = compound([bodies[last], placed(payload, tool0.transform)])
    lacks_effort = any(part.limits.effort is None for part in parts if part.row.type is not JointType.FIXED)
    efforts = static_efforts(parts, laden) if lacks_effort else ()
    # A base that weighs nothing costs Gazebo the whole arm, and one that stands still loads no joint: where the table
    # gives it no mass, it has that of its shape.
    base_mass, base_body = manipulator.base_mass, WEIGHTLESS
    if base_mass != 0.0:
        base_body = of_mass(shape_body(base.visuals, density), base_mass)

    def link(name: str, body: Inertial, of: Part | Base) -> Link:
        visuals, collisions = of.visuals if seen else (), of.collisions if touching else ()
        return new_link(name=name, inertial=body, visuals=visuals, collisions=collisions)

    links = [new_link(name=ROOT), link(BASE, base_body, base)]
    joints = [fixed_joint(ROOT, BASE, base.origin)]
    for number, (part, body) in enumerate(zip(parts, bodies, strict=True)):
        row, limits = part.row, part.limits
        dynamics: dict[str, Any] = {}  # what the row says, else the run
        if row.type is not JointType.FIXED:
            limits = limits if limits.effort is not None else replace(limits, effort=efforts[number])
            given = {name: getattr(row, name) for name in DYNAMICS}
            dynamics = {name: getattr(options, name, None) if value is None else value for name, value in given.items()}
        joints.append(
            new_joint(
                name=row.joint,
                type=row.type,
                parent=part.holder or BASE,
                child=row.link,
                origin=part.origin,
                axis=part.axis,
                limits=limits,
                follows=row.follows,
                **dynamics,
                mark=row.mark,
            )
        )
        links.append(link(row.link, body, part))
    carrier = BASE if last is None else parts[last].row.link
    joints += [fixed_joint(carrier, FLANGE, flange), fixed_joint(carrier, TOOL, tool0)]
    links += [new_link(name=FLANGE, inertial=WEIGHTLESS), new_link(name=TOOL, inertial=WEIGHTLESS)]
    if options.base_frame:  # On the body of the base: a chain of frames without mass is lost in sdformat.
        joints.append(fixed_joint(BASE, "base", base.dh_frame))
        links.append(new_link(name="base", inertial=WEIGHTLESS))
    if payload:
        joints.append(fixed_joint(carrier, PAYLOAD, tool0))
        links.append(new_link(name=PAYLOAD, inertial=payload))
    return Robot(
        name=manipulator.name,
        links=tuple(links),
        joints=tuple(joints),
        parameters=parameters,
        comment=comment,
        loaded=tuple([row.joint for row in manipulator.moving_rows if row.limits.effort is None]),
    )


def fixed_joint(parent: str, child: str, origin: Origin) -> Joint:
    """A fixed joint, named after the two links that it holds together."""
    return new_joint(name=f"{parent}-{child}", type=JointType.FIXED, parent=parent, child=child, origin=origin)


def shape_body(visuals: Sequence[Visual], density: float, joint: str | None = None) -> Inertial:
    """The mass properties of what is seen of a link, if it were solid and of one density [kg/m³].

    Raises:
        TransformError: the shapes are so small that their mass is 0, to the last digit that a double has.
    """
    bodies = []
    for visual in visuals:
        shape = visual.geometry
        if isinstance(shape, Mesh):
            from dh2urdf_plugins.transforms.meshes import mesh_solid

            body = mesh_solid(shape, density)
        else:
            body = solid(shape, density)
        bodies.append(placed(body, visual.origin.transform))
    try:
        return compound(bodies)
    except ValueError:
        what = "the link" if joint else "the base"
        raise TransformError(say("shapes-too-small", joint=joint, field="radius", what=what)) from None


def of_mass(body: Inertial, mass: float | None) -> Inertial:
    """A body of the same shape with another mass [kg]; the same body where none is given."""
    if mass is None:
        return body
    return new_inertial(mass=mass, com=body.com, inertia=scaled(body.inertia, mass / body.mass))


def payload_body(payload: Payload, density: float) -> Inertial:
    """The mass properties of the payload in tool0; without an inertia it is a solid ball of the links' density."""
    inertia = payload.inertia
    if inertia is None:
        radius = (payload.mass / solid(Sphere(radius=1.0), density).mass) ** (1.0 / 3.0)
        inertia = of_mass(solid(Sphere(radius=radius), density), payload.mass).inertia
    return new_inertial(mass=payload.mass, com=payload.com, inertia=inertia)


def link_body(part: Part, density: float) -> Inertial:
    """The mass properties of a link: what the table declares about them, the shape's for the rest.

    A fixed row whose mass is 0 is a frame without a body. A mass without an inertia scales that of the shape; a centre
    of mass without one carries it along. Centre of mass and inertia are given in the DH frame after the row, and are
    turned into the link's frame.
    """
    row, frame = part.row, part.dh_frame
    if is_frame(row):
        return WEIGHTLESS
    if frame and is_weighed(row):  # Nobody need read a mesh for that.
        body = new_inertial(mass=row.mass)  # type: ignore[arg-type]  # it is given
    else:
        body = of_mass(shape_body(part.visuals, density, row.joint), row.mass)
    if frame is None:
        return body
    com, inertia = body.com, body.inertia
    if row.com is not None:
        x, y, z = add(frame.translation, rotate(frame.rotation, row.com))
        com = (x + 0.0, y + 0.0, z + 0.0)
    if row.inertia is not None:
        inertia = rotated(row.inertia, frame.rotation)
    return new_inertial(mass=body.mass, com=com, inertia=inertia)


def static_efforts(parts: Sequence[Part], bodies: Sequence[Inertial]) -> list[float]:
    """The default effort of every joint [N·m or N]: twice the worst static load, at least 10, rounded up to two digits.

    The load is bounded for every joint vector and for every way the arm may be mounted. A revolute joint i bears at
    most g·Σ m_j·l_ij over the links j it moves, where l_ij is the length of the way from its axis to the centre of mass
    j along the joints in between; a prismatic one bears at most the weight g·Σ m_j. From the tip inwards both sums take
    one step per link. A leader also bears the load of each follower, times the size of its multiplier.
    """

    def rounded_up(needed: float) -> float:
        return two_digits(needed, math.ceil, -1e-9) if LEAST_EFFORT < needed < math.inf else max(LEAST_EFFORT, needed)

    loads: dict[str, Any] = {}
    weight = moment = 0.0  # of all links further out, moment about the joint that carries them
    for part, body in zip(reversed(parts), reversed(bodies), strict=True):
        from_foot = subtract(body.com, part.foot)
        across = norm(cross(from_foot, part.axis))
        if part.row.type is JointType.PRISMATIC:
            load = weight + body.mass
        else:
            load = moment + weight * part.arm + body.mass * across
        slide = travel(part.row.type, part.limits)
        moment += weight * part.reach + body.mass * (norm(from_foot) + slide)
        weight += body.mass
        loads[part.row.joint] = load
    rows = [part.row for part in parts]
    for name, law in whole_laws({row.joint: row.follows for row in rows if row.follows}).items():
        loads[law.leader] = loads[law.leader] + abs(law.multiplier) * loads[name]  # by the virtual work of both
    return [mapped(rounded_up, SAFETY * GRAVITY * loads[row.joint]) for row in rows]
