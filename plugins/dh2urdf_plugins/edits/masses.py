"""The edit ``masses``: the mass of a whole arm, which makers print on the data sheet, shared out among its links.

Links keep their shares: those of the masses that the table says, else of the volumes of their shapes or meshes. Inertia
tensors go with the masses, and so do the efforts that the transform computes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.errors import EditError
from dh2urdf.rotations import agreed, total
from dh2urdf.source import Messages, did_you_mean
from dh2urdf.stages import Edit, EditsInColumns, NeedsMasses
from dh2urdf_plugins.options import mapping, option

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.rotations import Number
    from dh2urdf.source import Problem

say = Messages(__file__)

_NEARLY = 1e-9
"""How far the masses of an arm, all of which are held, may be from the total, as a part of it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MassesOptions:
    """What an arm weighs. A payload and what is mounted on the arm are not part of it."""

    total: float | None = option(
        "mass of the base and all links [kg]: those that are not held are scaled by one factor", None, measures="mass"
    )
    base: float | None = option("mass of the base [kg], which is held; 0 for none", None, measures="mass")
    links: dict[str, float] = mapping("masses of links that are held, by their names [kg]", measures="mass")

    def __post_init__(self) -> None:
        if self.total is not None and not 0.0 < self.total < math.inf:
            raise ValueError("total is a mass greater than 0")
        if self.base is not None and not 0.0 <= self.base < math.inf:
            raise ValueError("base is a mass of 0 or greater")
        if wrong := [name for name, mass in self.links.items() if not 0.0 < mass < math.inf]:
            raise ValueError(f"links: the mass of {' and '.join(wrong)} is not greater than 0")


def edit_table(manipulator: Manipulator, options: MassesOptions) -> Manipulator:
    """The manipulator with other masses of its base and its links."""
    from dh2urdf.fields import replace_unchecked

    factor: Number = 1.0
    if not (problems := list(_problems(manipulator, options))) and options.total is not None:
        loose = [row.mass for row in manipulator.rows if row.link not in options.links and row.mass is not None]
        loose += [manipulator.base_mass or 0.0] if options.base is None else []
        held = total([*options.links.values(), options.base or 0.0])
        rest, weight = options.total - held, total(loose)
        if agreed(weight > 0.0) and rest > 0.0:
            factor = rest / weight
        elif agreed(weight > 0.0):
            problems.append(say("masses-too-small", field="total", total=options.total, held=held))
        elif abs(rest) > _NEARLY * options.total:
            problems.append(say("masses-all-held", field="total", total=options.total, held=held))
    if problems:
        raise EditError(problem.about(robot=manipulator.name, mark=manipulator.mark) for problem in problems)
    if options.total is None:  # What has no mass in the table keeps that of its shape.
        masses = [options.links.get(row.link, row.mass) for row in manipulator.rows]
        base = manipulator.base_mass if options.base is None else options.base
    else:
        masses = [options.links.get(row.link, factor * row.mass) for row in manipulator.rows]
        base = factor * (manipulator.base_mass or 0.0) if options.base is None else options.base
    rows = tuple(map(weighing, manipulator.rows, masses))
    # What has a density is a link without a mass, and a payload without an inertia, which is a ball.
    payload = manipulator.payload
    is_used = (payload is not None and payload.inertia is None) or any(mass is None for mass in (base, *masses))
    density = manipulator.density if is_used else None
    notices = manipulator.notices
    if options == MassesOptions():
        notices = (*notices, say("edit-changes-nothing", field="edits", edit="masses", what="mass"))
    return replace_unchecked(manipulator, rows=rows, base_mass=base, density=density, notices=notices)


def _problems(manipulator: Manipulator, options: MassesOptions) -> Iterator[Problem]:
    links = [row.link for row in manipulator.rows]
    for name in options.links:
        if name not in links:
            near = did_you_mean(name, links)
            yield say("masses-link-unknown", field="links", found=name, links=links, suggestion=near)
    unknown = [row.link for row in manipulator.rows if row.mass is None]
    if unknown and options.total is not None:
        yield say("masses-unknown", field="edits", unknown=unknown)


def weighing(row: DHRow, mass: Number | None) -> DHRow:
    """A row with another mass of its link [kg], and the inertia of the same shape."""
    from dh2urdf.fields import replace_unchecked
    from dh2urdf.kinematics.mass import scaled

    is_body = row.mass is not None and agreed(row.mass > 0.0)
    inertia = scaled(row.inertia, mass / row.mass) if row.inertia and is_body and mass is not None else row.inertia
    return replace_unchecked(row, mass=mass, inertia=inertia)


EDIT = Edit(
    name="masses",
    summary="what the arm, its base and its links weigh: the total of a data sheet is shared out among the links",
    options=MassesOptions,
    edit_table=edit_table,
    capabilities=(EditsInColumns(), NeedsMasses(lambda options: options.total is not None)),
)
