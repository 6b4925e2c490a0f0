"""The options of the edit ``payload``."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from dh2urdf.rotations import Vec3

if TYPE_CHECKING:
    from dh2urdf.manipulator import Inertia

_BODIES = ("inertia", "size", "radius")


@dataclass(frozen=True, slots=True, kw_only=True)
class PayloadOptions:
    """What the arm carries."""

    mass: float | None = field(
        default=None, metadata={"help": "its mass [kg]; there is no payload without a mass", "measures": "mass"}
    )
    com: Vec3 = field(
        default=(0.0, 0.0, 0.0), metadata={"help": "its centre of mass in tool0 [m]", "measures": "length"}
    )
    inertia: tuple[float, float, float, float, float, float] | None = field(
        default=None,
        metadata={
            "help": "ixx, iyy, izz, ixy, ixz, iyz about the centre of mass, axes of tool0 [kg·m²]; without inertia, "
            "size and radius the payload is a solid ball of the links' density",
            "measures": "moment of inertia",
        },
    )
    size: Vec3 | None = field(
        default=None, metadata={"help": "edges of a solid box along the axes of tool0 [m]", "measures": "length"}
    )
    radius: float | None = field(default=None, metadata={"help": "radius of a solid ball [m]", "measures": "length"})

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
        if tensor := self.tensor:
            from dh2urdf.mass_properties import inertia_problem

            if broken := inertia_problem(tensor):
                raise ValueError(f"inertia: {broken}")

    @property
    def tensor(self) -> Inertia | None:
        """The inertia, where it is given by its elements."""
        if self.inertia is None:
            return None
        from dh2urdf.manipulator import Inertia
        from dh2urdf.row_fields import INERTIA

        return Inertia(**dict(zip(INERTIA, self.inertia, strict=True)))
