"""The paper's α-swap, bit-true: for reproduction, not for robots.

"URDF Generator for Manipulator Robot" reads a, d, α and the joint types, keeps a length along y and one along z per
row, and swaps y and z of everything that follows wherever α is a quarter turn. Its running text (section III) is
followed, "from (i+1)th to Nth"; the printed Algorithm 1 is damaged and contradicts the paper's own result. How the
lengths become a chain the paper does not say; `docs/paper.md` does.

The links end up in a straight line, as the paper's conclusion says: signs and offsets along x are dropped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.robot import Box, Collision, Origin, Visual
from dh2urdf.rotations import Y_AXIS, Z_AXIS, ZERO
from dh2urdf_plugins.transforms.assembly import Base, Part, assemble, parameters
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
from dh2urdf_plugins.transforms.limits import complete_limits, travel
from dh2urdf_plugins.transforms.shapes import BASE_COLOUR, LINK_COLOURS, Style, pedestal

if TYPE_CHECKING:
    from dh2urdf.manipulator import Manipulator
    from dh2urdf.robot import Robot
    from dh2urdf_plugins.transforms.alpha_swap import AlphaSwapOptions

THICKNESS = 0.01
"""Thickness of the paper's boxes [m] (section IV)."""
_LEAST = 1e-5  # shortest side of a box [m]


def _box(along_y: Quantity, along_z: Quantity, shorter: float = 0.0) -> Box:
    """A link's box: its lengths along y and z, the paper's thickness where there is none."""
    thick = Quantity(THICKNESS)
    lengths = (along_y, along_z)
    y, z = (length_of(length, shorter, least=_LEAST) if length.value else thick for length in lengths)
    return Box(size=(thick.value, y.value, z.value), size_formula=(thick.formula, y.formula, z.formula))


def paper(manipulator: Manipulator, options: AlphaSwapOptions) -> Robot:
    """The robot of a manipulator as the paper has it; it does not keep the kinematics."""
    parts = []
    here = NO_VECTOR
    rows = manipulator.rows
    turned = turned_origins = False  # two swaps of y and z undo each other, so only odd or even counts
    for number, (row, limits) in enumerate(zip(rows, complete_limits(rows), strict=True)):
        a, d = Quantity.parameter(f"a_{number + 1}", row.a), Quantity.parameter(f"d_{number + 1}", row.d)
        along_y, along_z = (d, a) if turned else (a, d)
        axis, direction = Y_AXIS if turned else Z_AXIS, Y_AXIS if turned_origins else Z_AXIS
        length = greater(along_y, along_z)
        step = times(length, constants(direction))
        middle = origin(times(HALF, step))
        sides = [abs(side.value) for side in (along_y, along_z) if side.value]
        # The box that touches is half its thickness shorter at each end, where something of it remains.
        touches = sides and min(sides) - THICKNESS > _LEAST
        colour = LINK_COLOURS[number % len(LINK_COLOURS)]
        parts.append(
            Part(
                row=row,
                limits=limits,
                holder=rows[number - 1].link if number else None,
                origin=origin(here),
                axis=axis,
                visuals=(Visual(geometry=_box(along_y, along_z), origin=middle, material=colour),),
                collisions=(Collision(geometry=_box(along_y, along_z, THICKNESS), origin=middle),) if touches else (),
                foot=ZERO,
                reach=length.value + travel(row.type, limits),
                arm=0.0 if axis == direction else length.value,
                dh_frame=None,
            )
        )
        here = step
        word, _ = nearest_paper_angle(row.alpha)
        turned ^= word in ("pi/2", "-pi/2")
        turned_origins ^= word == "-pi/2"
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
