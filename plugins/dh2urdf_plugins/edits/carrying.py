"""Puts a payload into a table, or joins it with the one that is there."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import EditError
from dh2urdf.manipulator import Inertia, Payload
from dh2urdf.mass_properties import compound, solid
from dh2urdf.robot import Box, Inertial, Sphere
from dh2urdf.source import Problem
from dh2urdf.unchecked_records import changed

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator
    from dh2urdf_plugins.edits.payload_options import PayloadOptions


def carrying(manipulator: Manipulator, options: PayloadOptions) -> Manipulator:
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
    if options.tensor is not None:
        return options.tensor
    shape = Box(size=options.size) if options.size else Sphere(radius=options.radius) if options.radius else None
    if shape is None or options.mass is None:
        return None
    unit = solid(shape, 1.0)
    factor = options.mass / unit.mass
    return replace(unit.inertia, **{each.name: factor * getattr(unit.inertia, each.name) for each in fields(Inertia)})
