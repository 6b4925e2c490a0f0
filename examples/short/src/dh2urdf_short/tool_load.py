"""The edit `tool-load`: a solid cylinder that every arm carries at tool0."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING

from dh2urdf.errors import EditError
from dh2urdf.manipulator import Inertia, Payload
from dh2urdf.source import Problem
from dh2urdf.stages import Edit

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator


@dataclass(frozen=True, slots=True, kw_only=True)
class ToolLoadOptions:
    """The cylinder stands on tool0, along z."""

    mass: float = field(default=1.0, metadata={"help": "its mass [kg]"})
    radius: float = field(default=0.04, metadata={"help": "its radius [m]"})
    length: float = field(default=0.1, metadata={"help": "its length [m]"})

    def __post_init__(self) -> None:
        if not all(0.0 < each < math.inf for each in (self.mass, self.radius, self.length)):
            raise ValueError("mass, radius and length are numbers greater than 0")


def edit_table(manipulator: Manipulator, options: ToolLoadOptions) -> Manipulator:
    """The arm with the cylinder in its table: m·(3r² + l²)/12 across, and m·r²/2 along it.

    Raises:
        EditError: the arm has a payload already.
    """
    if manipulator.payload is not None:
        message, accepted = "the arm has a payload already", "a table without a payload"
        raise EditError(Problem(message=message, robot=manipulator.name, mark=manipulator.mark, accepted=accepted))
    mass, radius, length = options.mass, options.radius, options.length
    across = mass * (3.0 * radius**2 + length**2) / 12.0
    inertia = Inertia(ixx=across, iyy=across, izz=0.5 * mass * radius**2)
    return replace(manipulator, payload=Payload(mass=mass, com=(0.0, 0.0, 0.5 * length), inertia=inertia))


EDIT = Edit(name="tool-load", summary="a solid cylinder at tool0", options=ToolLoadOptions, edit_table=edit_table)
