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
    from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions

THICKNESS = 0.01
"""Thickness of the paper's boxes [m] (section IV)."""
_LEAST = 1e-5  # shortest side of a box [m]


class PaperRow(NamedTuple):
    """What the algorithm keeps of a row: the joint's axis, the direction to the next joint, and two lengths [m]."""

    axis: Vec3
    direction: Vec3
    along_y: Quantity
    along_z: Quantity

    def box(self, shorter: float = 0.0) -> Box:
        """The link's box: its lengths along y and z, the paper's thickness where there is none."""
        thick = Quantity(THICKNESS)
        y, z = (
            length_of(length, shorter, least=_LEAST) if length.value else thick
            for length in (self.along_y, self.along_z)
        )
        return Box(size=(thick.value, y.value, z.value), size_formula=(thick.formula, y.formula, z.formula))


def paper(manipulator: Manipulator, options: AlphaSwapOptions) -> Robot:
    """The robot of a manipulator as the paper has it; it does not keep the kinematics."""
    parts = []
    here = NO_VECTOR
    rows = manipulator.rows
    for number, (row, swapped, limits) in enumerate(zip(rows, swapped_rows(rows), complete_limits(rows), strict=True)):
        length = greater(swapped.along_y, swapped.along_z)
        step = times(length, constants(swapped.direction))
        middle = origin(times(HALF, step))
        sides = [abs(side.value) for side in (swapped.along_y, swapped.along_z) if side.value]
        # The box that touches is half its thickness shorter at each end, where something of it remains.
        touches = sides and min(sides) - THICKNESS > _LEAST
        colour = LINK_COLOURS[number % len(LINK_COLOURS)]
        parts.append(
            Part(
                row=row,
                limits=limits,
                holder=rows[number - 1].link if number else None,
                origin=origin(here),
                axis=swapped.axis,
                visuals=(Visual(geometry=swapped.box(), origin=middle, material=colour),),
                collisions=(Collision(geometry=swapped.box(THICKNESS), origin=middle),) if touches else (),
                foot=ZERO,
                reach=length.value + travel(row.type, limits),
                arm=0.0 if swapped.axis == swapped.direction else length.value,
                dh_frame=None,
            )
        )
        here = step
    stand = pedestal(NO_VECTOR, constants(Z_AXIS), NO_VECTOR, Style("box", 0.5 * THICKNESS, BASE_COLOUR))
    return assemble(
        manipulator,
        base=Base(origin=Origin(), visuals=(stand,), collisions=()),
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
