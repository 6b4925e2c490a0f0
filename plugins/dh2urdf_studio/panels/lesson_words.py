"""What a row of a table means, as HTML: its transform in symbols and in numbers. Nothing that a person has typed."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.kinematics.chain import dh_frames, dh_transform, joint_variables, reach, row_transform
from dh2urdf.manipulator import Convention, JointType
from dh2urdf.quantities.units import UNITS
from dh2urdf_studio.drawing.digits import decimals, plain
from dh2urdf_studio.drawing.motions import NAMES, order
from dh2urdf_studio.drawing.normals import where_x_is

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.quantities.units import Unit
    from dh2urdf.rotations import RigidTransform
    from dh2urdf.table_text import TableText

_SYMBOLS = {
    Convention.STANDARD: (
        ("cθ", "−sθ cα", "sθ sα", "a cθ"),
        ("sθ", "cθ cα", "−cθ sα", "a sθ"),
        ("0", "sα", "cα", "d"),
        ("0", "0", "0", "1"),
    ),
    Convention.MODIFIED: (
        ("cθ", "−sθ", "0", "a"),
        ("sθ cα", "cθ cα", "−sα", "−d sα"),
        ("sθ sα", "cθ sα", "cα", "d cα"),
        ("0", "0", "0", "1"),
    ),
}
"""A in symbols, c and s for cosine and sine: Spong, Hutchinson, Vidyasagar, eq. 3.10; Craig, eq. 3.6."""
_MEANING = {
    Convention.STANDARD: "x of the frame after the row lies on the common normal of the row's axis and the next one: a "
    "is its length, α the angle between the axes; d and θ lead to it along and about the row's axis.",
    Convention.MODIFIED: "x of the frame before the row lies on the common normal of its axis and the row's axis: a is "
    "its length, α the angle between the axes; θ and d lead on about and along the row's axis.",
}
_DIGITS = 4
_MOST_FACTORS = 3


def explained(table: Manipulator, number: int, q: Mapping[str, float], typed: TableText) -> str:
    """The transform of a row and that of all rows up to it, at the pose on the screen.

    Args:
        table: the table.
        number: number of the row, counted from 0.
        q: joint values by name [rad or m].
        typed: the table as it is typed, in whose units lengths are.
    """
    row, unit = table.rows[number], UNITS[typed.length_unit]
    value = q.get(row.joint, 0.0)
    angle = UNITS[typed.angle_unit]
    theta, d = joint_variables(row, value)
    moves = {JointType.PRISMATIC: "d", JointType.FIXED: ""}.get(row.type, "theta")
    sizes = {"θ": (theta, "theta"), "d": (d, "d"), "a": (row.a, "a"), "α": (row.alpha, "alpha")}
    told = []
    for symbol, (size, field) in sizes.items():
        if field in ("theta", "alpha"):
            text = f"{math.degrees(size):.6g}°" if angle.degrees else f"{size:.6g} rad"
        else:
            text = f"{size * 10.0**-unit.power:.6g} {unit.symbol}"
        told.append(f"{symbol} = {text}{' (moves)' if field == moves else ''}")
    index, far = number + 1, reach(table)
    other = Convention.MODIFIED if table.convention is Convention.STANDARD else Convention.STANDARD
    neighbour = number + (1 if other is Convention.STANDARD else -1)
    whose, a, alpha = "a = 0 and α = 0", 0.0, 0.0
    if 0 <= neighbour < len(table.rows):
        whose, a, alpha = f"a and α of row {neighbour + 1}", table.rows[neighbour].a, table.rows[neighbour].alpha
    there = dh_transform(other, a=a, alpha=alpha, d=d, theta=theta)
    frame = dh_frames(table, [q.get(each.joint, 0.0) for each in table.moving_rows])[index]
    factors = [f"A<sub>{number}</sub>" for number in range(1, index + 1)]
    product = " ".join(["base", *(factors if index <= _MOST_FACTORS else (factors[0], "…", factors[-1]))])
    return (
        f"<div>{', '.join(told)}</div>"
        f"<div><b>A<sub>{index}</sub> = {_product(table.convention)}</b></div>"
        f'<div class="studio-matrices">{_matrix(_SYMBOLS[table.convention])}<span>=</span>'
        f"{_matrix(_numbers(row_transform(table.convention, row, value), unit, far))}</div>"
        f'<div class="studio-matrices"><b>T<sub>0{index}</sub> = {product}</b><span>=</span>'
        f"{_matrix(_numbers(frame, unit, far))}</div>"
        f"<div>{_MEANING[table.convention]}</div>"
        f"<div>{where_x_is(table, q, number)}</div>"
        f"<details><summary>The {other} convention</summary><div>A = {_product(other)}</div>"
        f'<div class="studio-matrices">{_matrix(_SYMBOLS[other])}<span>=</span>'
        f"{_matrix(_numbers(there, unit, far))}</div>"
        f"<div>The same arm has d and θ of this row there, and {whose}.</div><div>{_MEANING[other]}</div></details>"
    )


def _product(convention: Convention) -> str:
    return " ".join(NAMES[field] for field in order(convention))


def _numbers(transform: RigidTransform, length: Unit, reach: float) -> list[list[str]]:
    digits = max(_DIGITS, decimals(length, reach))
    rows = [
        [*(plain(x, _DIGITS) for x in transform.rotation[3 * row : 3 * row + 3]), plain(length.number(place), digits)]
        for row, place in enumerate(transform.translation)
    ]
    return [[text.replace("-", "−") for text in row] for row in (*rows, ["0", "0", "0", "1"])]


def _matrix(rows: Iterable[Sequence[str]]) -> str:
    cells = "".join(f"<tr>{''.join(f'<td>{cell}</td>' for cell in row)}</tr>" for row in rows)
    return f'<table class="studio-table-matrix">{cells}</table>'
