"""The edit ``payload``: something that the arm carries at tool0.

It goes into the table, so transforms treat it as a payload that the table itself has: ``alpha-swap`` makes it a link of
its own, ``payload``, on a fixed joint at tool0, and counts it among what the joints carry.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import EditError
from dh2urdf.manipulator import Inertia, Payload
from dh2urdf.mass_properties import compound, inertia_problem, solid
from dh2urdf.robot import Box, Inertial, Sphere
from dh2urdf.rotations import Vec3
from dh2urdf.source import Problem
from dh2urdf.stages import Edit
from dh2urdf.unchecked_records import changed

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator

_BODIES = ("inertia", "size", "radius")


@dataclass(frozen=True, slots=True, kw_only=True)
class PayloadOptions:
    """What the arm carries."""

    mass: float | None = field(default=None, metadata={"help": "its mass [kg]; there is no payload without a mass"})
    com: Vec3 = field(default=(0.0, 0.0, 0.0), metadata={"help": "its centre of mass in tool0 [m]"})
    inertia: tuple[float, float, float, float, float, float] | None = field(
        default=None,
        metadata={
            "help": "ixx, iyy, izz, ixy, ixz, iyz about the centre of mass, axes of tool0 [kg·m²]; without inertia, "
            "size and radius the payload is a solid ball of the links' density"
        },
    )
    size: Vec3 | None = field(default=None, metadata={"help": "edges of a solid box along the axes of tool0 [m]"})
    radius: float | None = field(default=None, metadata={"help": "radius of a solid ball [m]"})

    def __post_init__(self) -> None:
        """Refuse what no body has.

        Raises:
            ValueError: a number is not possible, or several options give the inertia.
        """
        given = [name for name in _BODIES if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)} both give the inertia: choose one")
        lengths = [each for each in (self.radius, *(self.size or ())) if each is not None]
        if not all(0.0 < each < math.inf for each in (*lengths, *([] if self.mass is None else [self.mass]))):
            raise ValueError("mass, size and radius are numbers greater than 0")
        if self.inertia is not None and (broken := inertia_problem(_tensor(self.inertia))):
            raise ValueError(f"inertia: {broken}")


def edit_table(manipulator: Manipulator, options: PayloadOptions) -> Manipulator:
    """The manipulator with the payload; one that it has already is carried together with the new one.

    Raises:
        EditError: the options have no mass, or two payloads cannot be joined, since one has no inertia.
    """
    if options.mass is None:
        raise EditError(
            Problem(
                message="the payload has no mass",
                robot=manipulator.name,
                field="edits",
                accepted="a mass, such as `{stage: payload, options: {mass: 2.5}}`",
            )
        )
    new = Payload(mass=options.mass, com=options.com, inertia=_inertia(options))
    return changed(manipulator, payload=_joined(manipulator, manipulator.payload, new))


def _joined(manipulator: Manipulator, old: Payload | None, new: Payload) -> Payload:
    """Two payloads as one body."""
    if old is None:
        return new
    if old.inertia is None or new.inertia is None:
        which = "the payload that the arm has" if old.inertia is None else "the payload of this edit"
        raise EditError(
            Problem(
                message=f"the arm has a payload of {old.mass:g} kg already, and {which} has no inertia",
                robot=manipulator.name,
                mark=manipulator.mark,
                field="edits",
                accepted="two payloads with inertias, which are joined; or one payload",
                suggestion="give the inertia, the size of a box or the radius of a ball",
            )
        )
    bodies = [Inertial(mass=each.mass, com=each.com, inertia=each.inertia) for each in (old, new) if each.inertia]
    body = compound(bodies)
    return Payload(mass=body.mass, com=body.com, inertia=body.inertia)


def _inertia(options: PayloadOptions) -> Inertia | None:
    if options.inertia is not None:
        return _tensor(options.inertia)
    shape = Box(size=options.size) if options.size else Sphere(radius=options.radius) if options.radius else None
    if shape is None or options.mass is None:
        return None
    unit = solid(shape, 1.0)
    factor = options.mass / unit.mass
    return replace(unit.inertia, **{name: factor * getattr(unit.inertia, name) for name in _ELEMENTS})


_ELEMENTS = ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")


def _tensor(numbers: tuple[float, ...]) -> Inertia:
    return Inertia(**dict(zip(_ELEMENTS, numbers, strict=True)))


EDIT = Edit(
    name="payload",
    summary="something that the arm carries at tool0: mass, centre of mass and inertia",
    options=PayloadOptions,
    edit_table=edit_table,
    accepts_columns=True,
)
