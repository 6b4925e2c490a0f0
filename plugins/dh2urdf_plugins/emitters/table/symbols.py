"""The cells of a table as people read them: constants, and the joint variable with its number."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.manipulator import JointType
from dh2urdf.quantities import UNITS
from dh2urdf.table_text import PARAMETERS, number_in, transform_text

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf_plugins.emitters.table.options import TableOptions


@dataclass(frozen=True, slots=True, kw_only=True)
class Notation:
    """How a format writes what is in a cell.

    Attributes:
        text: a name.
        number: a number, such as ``-3*pi/4`` or ``1e-05``.
        variable: the joint variable of a letter and a number.
        sum: a sum of terms, each with its sign.
    """

    text: Callable[[str], str]
    number: Callable[[str], str]
    variable: Callable[[str, int], str]
    sum: Callable[[Sequence[tuple[str, str]]], str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cells:
    """A table as cells.

    Attributes:
        rows: for each row the number of the joint, its name and type, a, α, d and θ, and limits where there are any.
        limit_units: the units of limits, such as ``rad, m``; empty where there are none.
        base: the base transform, as YAML; empty where it is the identity.
        tool: the tool transform, as YAML; empty where it is the identity.
    """

    rows: tuple[tuple[str, ...], ...]
    limit_units: str
    base: str
    tool: str


def cells_of(arm: Manipulator, options: TableOptions, notation: Notation) -> Cells:
    """The cells of a table in a notation."""
    length, angle = UNITS[options.length_unit], UNITS[options.angle_unit]
    limited = [row for row in arm.moving_rows if (row.limits.lower, row.limits.upper) != (None, None)]
    units = dict.fromkeys(length if row.type is JointType.PRISMATIC else angle for row in limited)
    rows, number = [], 0
    for row in arm.rows:
        number += row.type is not JointType.FIXED
        cells = ["" if row.type is JointType.FIXED else str(number), notation.text(row.joint), str(row.type)]
        cells += [_parameter(row, name, number, options, notation) for name in PARAMETERS]
        if limited:
            unit = length if row.type is JointType.PRISMATIC else angle
            limits = (row.limits.lower, row.limits.upper)
            cells += ["" if each is None else notation.number(number_in(each, unit)) for each in limits]
        rows.append(tuple(cells))
    return Cells(
        rows=tuple(rows),
        limit_units=", ".join(unit.symbol for unit in units),
        base=transform_text(arm.base, length, angle),
        tool=transform_text(arm.tool, length, angle),
    )


def _parameter(row: DHRow, name: str, number: int, options: TableOptions, notation: Notation) -> str:
    """A cell: a number, or the joint variable with what is added to it."""
    unit = UNITS[options.length_unit if name in ("a", "d") else options.angle_unit]
    value: float = getattr(row, name)
    moved = {JointType.PRISMATIC: "d", JointType.FIXED: None}.get(row.type, "theta")
    if name != moved:
        return notation.number(number_in(value, unit))
    terms = [("-" if row.sign < 0 else "+", notation.variable(name, number))]
    constants = [constant for constant in (value, row.offset) if constant]
    terms += [("-" if each < 0 else "+", notation.number(number_in(abs(each), unit))) for each in constants]
    return notation.sum(terms)


def convention_product(arm: Manipulator, factors: Sequence[str]) -> Iterator[str]:
    """The factors of A in the order of a table's convention, of Rz(θ), Tz(d), Tx(a), Rx(α)."""
    turn, shift, length, twist = factors
    yield from (turn, shift, length, twist) if arm.convention == "standard" else (twist, length, turn, shift)
