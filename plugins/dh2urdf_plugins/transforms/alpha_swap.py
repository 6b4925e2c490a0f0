"""The stage ``alpha-swap``: from a DH table to joints and links.

Two variants. `exact` is the default and gives the arm of the table. `paper` does what "URDF Generator for Manipulator
Robot" describes, for those who want to see that: its links end up in a straight line.
What makes the robots is imported when it is called.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, TypeAlias

from dh2urdf.stages import Compares, KeepsKinematics, Transform, TransformsInColumns, Usual
from dh2urdf_plugins.late import Late
from dh2urdf_plugins.options import option

Shape: TypeAlias = Literal["cylinder", "box", "capsule", "arm"]


@dataclass(frozen=True, slots=True, kw_only=True)
class AlphaSwapOptions:
    """How a robot is made of a table. What the table itself declares about shapes and densities goes first."""

    variant: Literal["exact", "paper"] = option(
        "exact: the arm of the table, always; "
        "paper: the algorithm of the paper, bit-true, for reproduction only: it drops signs and offsets along x",
        "exact",
        flag="V",
    )
    frames: Literal["aligned", "dh"] = option(
        "exact variant: link frames parallel to the base at joint values 0 (aligned), "
        "or the frames of the DH table (dh)",
        "aligned",
        flag="F",
    )
    near_parallel: Literal["dh", "split"] = option(
        "exact variant: nearly parallel axes as the table has them (dh), or with a fixed row between them, "
        "so that links are of the arm's own size (split): for tables of calibrated arms",
        "dh",
    )
    shape: Shape = option(
        "exact variant: what links are drawn as; a capsule is a cylinder with sphere caps, "
        "an arm has a housing at each joint and thinner tubes between them",
        "cylinder",
    )
    radius: float | None = option(
        "exact variant: radius of the links, half the thickness of boxes [m]; "
        "by default 0.04 or a tenth of the longest segment, whichever is smaller",
        None,
        measures="length",
    )
    density: float = option(
        "density of links without a mass [kg/m³]; the default is aluminium", 2700.0, measures="density"
    )
    inertias: Literal["keep", "repair", "recompute"] = option(
        "what becomes of inertias that no body has, as some are published: they are refused (keep), the "
        "nearest that a body can have is used (repair), or that of the drawn shape at the stated mass (recompute)",
        "keep",
        flag="HOW",
    )
    inertia_floor: float | None = option(
        "smallest principal moment of a repaired inertia [kg·m²]; with it, moments of 0, as makers print "
        "them for small links, are repaired also where other inertias are kept",
        None,
        measures="moment of inertia",
    )
    base_collision: bool = option("give the base a collision shape; it may touch the first links in simulators", False)
    base_frame: bool = option(
        "add the frame `base` of ROS (REP 199): the DH frame before the first row, where the base "
        "transform of the table puts it",
        False,
    )
    visuals: Literal["all", "none"] = option(
        "whether links are seen; none is for learning runs: the masses stay as they are", "all"
    )
    collisions: Literal["all", "none"] = option("whether links have collision shapes", "all")
    damping: float | None = option("viscous friction of joints without one [N·m·s/rad, N·s/m]; none by default", None)
    friction: float | None = option("static friction of joints without one [N·m, N]; none by default", None)
    armature: float | None = option(
        "inertia of the rotors of joints without one [kg·m², kg]; none by default; URDF has no place for it", None
    )
    snap: float = option(
        "paper variant: how far alpha may be from 0, ±pi/2 and pi [rad] to be taken for it", 1e-3, measures="angle"
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
