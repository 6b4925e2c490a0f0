"""The edit ``payload``: something that the arm carries at tool0.

It goes into the table, so transforms treat it as a payload that the table itself has: ``alpha-swap`` makes it a link of
its own, ``payload``, on a fixed joint at tool0, and counts it among what the joints carry.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.rotations import Vec3
from dh2urdf.source import Messages
from dh2urdf.stages import Edit, EditsInColumns
from dh2urdf_plugins.options import option

if TYPE_CHECKING:
    from dh2urdf.manipulator import Inertia, Manipulator

say = Messages(__file__)


@dataclass(frozen=True, slots=True, kw_only=True)
class PayloadOptions:
    """What the arm carries."""

    mass: float | None = option("its mass [kg]; there is no payload without a mass", None, measures="mass")
    com: Vec3 = option("its centre of mass in tool0 [m]", (0.0, 0.0, 0.0), measures="length")
    inertia: tuple[float, float, float, float, float, float] | None = option(
        "ixx, iyy, izz, ixy, ixz, iyz about the centre of mass, axes of tool0 [kg·m²]; without inertia, "
        "size and radius the payload is a solid ball of the links' density",
        None,
        measures="moment of inertia",
    )
    size: Vec3 | None = option("edges of a solid box along the axes of tool0 [m]", None, measures="length")
    radius: float | None = option("radius of a solid ball [m]", None, measures="length")

    def __post_init__(self) -> None:
        given = [name for name in ("inertia", "size", "radius") if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)} both give the inertia: choose one")
        sizes = [each for each in (self.mass, self.radius, *(self.size or ())) if each is not None]
        if not all(0.0 < each < math.inf for each in sizes):
            raise ValueError("mass, size and radius are numbers greater than 0")
        if self.inertia is not None:
            from dh2urdf.kinematics.mass import inertia_problem

            if broken := inertia_problem(_tensor(self.inertia)):
                raise ValueError(f"inertia: {broken}")


def _tensor(elements: tuple[float, ...]) -> Inertia:
    from dh2urdf.columns import INERTIA
    from dh2urdf.manipulator import Inertia

    return Inertia(**dict(zip(INERTIA, elements, strict=True)))


def edit_table(manipulator: Manipulator, options: PayloadOptions) -> Manipulator:
    """The manipulator with the payload; one that it has already is carried together with the new one."""
    from dh2urdf.errors import EditError
    from dh2urdf.fields import replace_unchecked
    from dh2urdf.kinematics.mass import compound, scaled, solid
    from dh2urdf.manipulator import Payload
    from dh2urdf.robot import Box, Inertial, Sphere

    old, mass = manipulator.payload, options.mass
    if mass is None:
        raise EditError(say("payload-without-mass", robot=manipulator.name, field="edits"))
    inertia = None if options.inertia is None else _tensor(options.inertia)
    if shape := Box(size=options.size) if options.size else Sphere(radius=options.radius) if options.radius else None:
        unit = solid(shape, 1.0)
        inertia = scaled(unit.inertia, mass / unit.mass)
    new = Payload(mass=mass, com=options.com, inertia=inertia)
    if old is not None:
        bodies = [Inertial(mass=each.mass, com=each.com, inertia=each.inertia) for each in (old, new) if each.inertia]
        if len(bodies) < 2:  # noqa: PLR2004 - of two
            which = "the payload that the arm has" if old.inertia is None else "the payload of this edit"
            code, name = "payload-without-inertia", manipulator.name
            raise EditError(say(code, manipulator.mark, robot=name, field="edits", mass=old.mass, which=which))
        body = compound(bodies)
        new = Payload(mass=body.mass, com=body.com, inertia=body.inertia)
    return replace_unchecked(manipulator, payload=new)


EDIT = Edit(
    name="payload",
    summary="something that the arm carries at tool0: mass, centre of mass and inertia",
    options=PayloadOptions,
    edit_table=edit_table,
    capabilities=(EditsInColumns(),),
)
