"""The options of the edit ``mount``."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from dh2urdf.rotations import ZERO, Vec3


@dataclass(frozen=True, slots=True, kw_only=True)
class MountOptions:
    """What is mounted, and where."""

    name: str = field(default="", metadata={"help": "name of the link; its joint is NAME_joint. Required"})
    parent: str = field(default="tool0", metadata={"help": "link that holds it"})
    xyz: Vec3 = field(default=ZERO, metadata={"help": "its origin in that link [m]", "measures": "length"})
    rpy: Vec3 = field(default=ZERO, metadata={"help": "roll, pitch, yaw in that link [rad]", "measures": "angle"})
    size: Vec3 | None = field(
        default=None,
        metadata={"help": "edges of a solid box about its origin [m]; a mere frame without", "measures": "length"},
    )
    mass: float = field(default=0.0, metadata={"help": "mass of the box [kg]", "measures": "mass"})
    optical: bool = field(
        default=False,
        metadata={"help": "whether NAME_optical_frame is there too, of REP 103: z forward, x right, y down"},
    )

    def __post_init__(self) -> None:
        """Refuse what cannot be mounted.

        Raises:
            ValueError: a length is not greater than 0, or a mass has no box.
        """
        if self.size is not None and not all(0.0 < edge < math.inf for edge in self.size):
            raise ValueError("size: the edges of a box are numbers greater than 0")
        if not 0.0 <= self.mass < math.inf or bool(self.mass) is not (self.size is not None):
            raise ValueError("mass and size belong together: a box has both, a mere frame has neither")
