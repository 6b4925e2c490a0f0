"""The stage ``alpha-swap``: from a DH table to joints and links.

Two variants. `exact` is the default and gives the arm of the table. `paper` does what "URDF Generator for Manipulator
Robot" describes, for those who want to see that: its links end up in a straight line.
What makes the robots is imported when it is called.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from dh2urdf.stages import Compares, KeepsKinematics, Transform, TransformsInColumns, Usual
from dh2urdf_plugins.late import Late

Shape: TypeAlias = Literal["cylinder", "box", "capsule", "arm"]


@dataclass(frozen=True, slots=True, kw_only=True)
class AlphaSwapOptions:
    """How a robot is made of a table. What the table itself declares about shapes and densities goes first."""

    variant: Literal["exact", "paper"] = field(
        default="exact",
        metadata={
            "flag": "V",
            "help": "exact: the arm of the table, always; "
            "paper: the algorithm of the paper, bit-true, for reproduction only: it drops signs and offsets along x",
        },
    )
    frames: Literal["aligned", "dh"] = field(
        default="aligned",
        metadata={
            "flag": "F",
            "help": "exact variant: link frames parallel to the base at joint values 0 (aligned), "
            "or the frames of the DH table (dh)",
        },
    )
    near_parallel: Literal["dh", "split"] = field(
        default="dh",
        metadata={
            "help": "exact variant: nearly parallel axes as the table has them (dh), or with a fixed row between them, "
            "so that links are of the arm's own size (split): for tables of calibrated arms"
        },
    )
    shape: Shape = field(
        default="cylinder",
        metadata={
            "help": "exact variant: what links are drawn as; a capsule is a cylinder with sphere caps, "
            "an arm has a housing at each joint and thinner tubes between them"
        },
    )
    radius: float | None = field(
        default=None,
        metadata={
            "help": "exact variant: radius of the links, half the thickness of boxes [m]; "
            "by default 0.04 or a tenth of the longest segment, whichever is smaller",
            "measures": "length",
        },
    )
    density: float = field(
        default=2700.0,
        metadata={"help": "density of links without a mass [kg/m³]; the default is aluminium", "measures": "density"},
    )
    inertias: Literal["keep", "repair", "recompute"] = field(
        default="keep",
        metadata={
            "flag": "HOW",
            "help": "what becomes of inertias that no body has, as some are published: they are refused (keep), the "
            "nearest that a body can have is used (repair), or that of the drawn shape at the stated mass (recompute)",
        },
    )
    inertia_floor: float | None = field(
        default=None,
        metadata={
            "help": "smallest principal moment of a repaired inertia [kg·m²]; with it, moments of 0, as makers print "
            "them for small links, are repaired also where other inertias are kept",
            "measures": "moment of inertia",
        },
    )
    base_collision: bool = field(
        default=False,
        metadata={"help": "give the base a collision shape; it may touch the first links in simulators"},
    )
    base_frame: bool = field(
        default=False,
        metadata={
            "help": "add the frame `base` of ROS (REP 199): the DH frame before the first row, where the base "
            "transform of the table puts it"
        },
    )
    visuals: Literal["all", "none"] = field(
        default="all",
        metadata={"help": "whether links are seen; none is for learning runs: the masses stay as they are"},
    )
    collisions: Literal["all", "none"] = field(default="all", metadata={"help": "whether links have collision shapes"})
    damping: float | None = field(
        default=None, metadata={"help": "viscous friction of joints without one [N·m·s/rad, N·s/m]; none by default"}
    )
    friction: float | None = field(
        default=None, metadata={"help": "static friction of joints without one [N·m, N]; none by default"}
    )
    armature: float | None = field(
        default=None,
        metadata={
            "help": "inertia of the rotors of joints without one [kg·m², kg]; none by default; URDF has no place for it"
        },
    )
    snap: float = field(
        default=1e-3,
        metadata={
            "help": "paper variant: how far alpha may be from 0, ±pi/2 and pi [rad] to be taken for it",
            "measures": "angle",
        },
    )

    def __post_init__(self) -> None:
        sizes = {"radius": self.radius, "density": self.density, "inertia_floor": self.inertia_floor}
        for name, value in sizes.items():
            if value is not None and not 0.0 < value < float("inf"):
                raise ValueError(f"{name} must be greater than 0 and finite, not {value}")
        for name in ("damping", "friction", "armature", "snap"):
            value = getattr(self, name)
            if value is not None and not 0.0 <= value < float("inf"):
                raise ValueError(f"{name} must be 0 or greater and finite, not {value}")


TRANSFORM = Transform(
    name="alpha-swap",
    summary="the arm of the table, its link frames parallel to the base or as in the table; or the paper's algorithm",
    transform=Late(f"{__package__}.robots:alpha_swap"),
    options=AlphaSwapOptions,
    capabilities=(
        Usual(),
        KeepsKinematics(lambda options: options.variant == "exact"),  # the paper's algorithm does not promise it
        TransformsInColumns(Late(f"{__package__}.robots:alpha_swap_columns")),
        Compares("variant"),
    ),
)
