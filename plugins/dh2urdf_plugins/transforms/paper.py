"""The paper's α-swap, bit-true: for reproduction, not for robots.

"URDF Generator for Manipulator Robot" reads a, d, α and the joint types, keeps a length along y and one along z per
row, and swaps y and z of everything that follows wherever α is a quarter turn. Its running text (section III) is
followed, "from (i+1)th to Nth"; the printed Algorithm 1 is damaged and contradicts the paper's own result. How the
lengths become a chain the paper does not say; `docs/paper.md` does.

The links end up in a straight line, as the paper's conclusion says: signs and offsets along x are dropped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.robot import Box, Collision, Origin, Visual
from dh2urdf.rotations import Y_AXIS, Z_AXIS, ZERO, Vec3
from dh2urdf_plugins.transforms.assembly import Base, Part, assemble, complete_limits, parameters, travel
from dh2urdf_plugins.transforms.checks import nearest_paper_angle
from dh2urdf_plugins.transforms.formulas import (
    HALF,
    NO_VECTOR,
    Quantity,
    constants,
    greater,
    length_of,
    origin,
    times,
)
from dh2urdf_plugins.transforms.shapes import BASE_COLOUR, LINK_COLOURS, Style, pedestal

if TYPE_CHECKING:
    from collections.abc import Iterable, Iterator

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf_plugins.transforms.alpha_swap_options import AlphaSwapOptions

THICKNESS = 0.01
"""Thickness of the paper's boxes [m] (section IV)."""

_LEAST = 1e-5  # shortest side of a box [m]


class PaperRow(NamedTuple):
    """What the algorithm keeps of a row.

    Attributes:
        axis: of the joint.
        direction: from the joint to the next one.
        along_y: length along y [m].
        along_z: length along z [m].
    """

    axis: Vec3
    direction: Vec3
    along_y: Quantity
    along_z: Quantity

    @property
    def length(self) -> Quantity:
        """The distance from the joint to the next one [m]."""
        return greater(self.along_y, self.along_z)


def paper(manipulator: Manipulator, options: AlphaSwapOptions) -> Robot:
    """The robot of a manipulator as the paper has it; it does not keep the kinematics."""
    parts = []
    here = NO_VECTOR
    rows = manipulator.rows
    for number, (row, swapped, limits) in enumerate(zip(rows, swapped_rows(rows), complete_limits(rows), strict=True)):
        length = swapped.length
        step = times(length, constants(swapped.direction))
        colour = LINK_COLOURS[number % len(LINK_COLOURS)]
        middle = origin(times(HALF, step))
        parts.append(
            Part(
                row=row,
                limits=limits,
                holder=rows[number - 1].link if number else None,
                origin=origin(here),
                axis=swapped.axis,
                visuals=(Visual(geometry=_box(swapped), origin=middle, material=colour),),
                collisions=_collisions(swapped, middle),
                foot=ZERO,
                reach=length.value + travel(row.type, limits),
                arm=0.0 if swapped.axis == swapped.direction else length.value,
                dh_frame=None,
            )
        )
        here = step
    style = Style(shape="box", radius=0.5 * THICKNESS, material=BASE_COLOUR)
    return assemble(
        manipulator,
        base=Base(origin=Origin(), visuals=(pedestal(NO_VECTOR, constants(Z_AXIS), NO_VECTOR, style),), collisions=()),
        parts=parts,
        flange=origin(here),
        tool0=origin(here),
        options=options,
        parameters=parameters(manipulator),
        comment=(
            f"{manipulator.name}: made by dh2urdf as the paper has it (alpha-swap, paper); "
            "its kinematics is not that of the table"
        ),
    )


def swapped_rows(rows: Iterable[DHRow]) -> Iterator[PaperRow]:
    """Axes, directions and lengths after the swaps of all rows before, row by row from the base."""
    turned = turned_origins = False  # two swaps of y and z undo each other, so only odd or even counts
    for number, row in enumerate(rows, start=1):
        a, d = Quantity.parameter(f"a_{number}", row.a), Quantity.parameter(f"d_{number}", row.d)
        yield PaperRow(
            axis=Y_AXIS if turned else Z_AXIS,
            direction=Y_AXIS if turned_origins else Z_AXIS,
            along_y=d if turned else a,
            along_z=a if turned else d,
        )
        word, _ = nearest_paper_angle(row.alpha)
        turned ^= word in ("pi/2", "-pi/2")
        turned_origins ^= word == "-pi/2"


def _box(row: PaperRow, shorter: float = 0.0) -> Box:
    """A link's box: its lengths along y and z, the paper's thickness where there is none."""
    thick = Quantity(THICKNESS)
    y, z = (
        length_of(length, shorter, least=_LEAST) if length.value else thick for length in (row.along_y, row.along_z)
    )
    return Box(size=(thick.value, y.value, z.value), size_formula=(thick.formula, y.formula, z.formula))


def _collisions(row: PaperRow, middle: Origin) -> tuple[Collision, ...]:
    """The box, half its thickness shorter at each end, where something of it remains."""
    lengths = [abs(length.value) for length in (row.along_y, row.along_z) if length.value]
    if not lengths or min(lengths) - THICKNESS <= _LEAST:
        return ()
    return (Collision(geometry=_box(row, THICKNESS), origin=middle),)
