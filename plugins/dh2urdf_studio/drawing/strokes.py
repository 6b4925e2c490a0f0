"""The DH parameters as segments and arcs in the scene, each with its symbol and its value."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

from dh2urdf.kinematics.chain import dh_frames, joint_variables
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3, add, cross, scale
from dh2urdf.table_text import TableText

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

_BARE_NUMBER = re.compile(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?")


@dataclass(frozen=True, slots=True, kw_only=True)
class Stroke:
    """A DH parameter as the segment or the arc that it is, at some q; or another line to draw.

    Attributes:
        row: number of its row, counted from 0; None of what belongs to no row.
        field: a, alpha, d or theta; x, y or z of a frame; distance; line, normal, offset or foot of `normals`.
        points: from its beginning to its end, or the only one [m].
        label: its symbol and its value.
    """

    row: int | None
    field: str
    points: tuple[Vec3, ...]
    label: str


def strokes(
    table: Manipulator,
    q: Mapping[str, float],
    *,
    place: RigidTransform = IDENTITY,
    radius: float,
    typed: TableText | None = None,
) -> Iterator[Stroke]:
    """Every parameter that is not zero, between the frame before a row and the one after it.

    Args:
        table: the table.
        q: joint values by name [rad or m].
        place: where its base_link is.
        radius: of the arcs of angles [m].
        typed: the table as it was typed, whose texts and units are at the parameters.
    """
    words = typed or TableText(angle_unit="deg")
    vector = [q.get(row.joint, 0.0) for row in table.moving_rows]
    frames = [place @ frame for frame in dh_frames(table, vector)]
    for number, row in enumerate(table.rows):
        theta, d = joint_variables(row, q.get(row.joint, 0.0))
        before, after = frames[number], frames[number + 1]
        if table.convention is Convention.STANDARD:  # Rz(theta) Tz(d) Tx(a) Rx(alpha): z of before, x of after
            axis, normal = (_axes(before)[2], before.translation), (_axes(after)[0], after.translation)
            turn = (_axes(before)[0], axis[0], add(axis[1], scale(d, axis[0])))
            twist = (_axes(before)[2], normal[0], normal[1])
            along_d = (axis[1], add(axis[1], scale(d, axis[0])))
            along_a = (along_d[1], after.translation)
        else:  # Rx(alpha) Tx(a) Rz(theta) Tz(d): x of before, z of after
            axis, normal = (_axes(after)[2], after.translation), (_axes(before)[0], before.translation)
            foot = add(normal[1], scale(row.a, normal[0]))
            turn, twist = (_axes(before)[0], axis[0], after.translation), (_axes(before)[2], normal[0], normal[1])
            along_a, along_d = (normal[1], foot), (foot, after.translation)
        index = number + 1 if table.convention is Convention.STANDARD else number
        if d:
            label = f"d{small(number + 1)} = {_value(words, row, number, 'd', d)}"
            yield Stroke(row=number, field="d", points=along_d, label=label)
        if row.a:
            label = f"a{small(index)} = {_value(words, row, number, 'a', row.a)}"
            yield Stroke(row=number, field="a", points=along_a, label=label)
        for name, symbol, angle, (start, about, centre), which in (
            ("theta", "θ", theta, turn, number + 1),
            ("alpha", "α", row.alpha, twist, index),
        ):
            if arc := _arc(centre, start, about, angle, radius):
                label = f"{symbol}{small(which)} = {_value(words, row, number, name, angle)}"
                yield Stroke(row=number, field=name, points=arc, label=label)


def _value(words: TableText, row: DHRow, number: int, field: str, value: float) -> str:
    """A parameter as it was typed or, where it moves or nobody has typed it, in the unit of the table."""
    variable = {JointType.PRISMATIC: "d", JointType.FIXED: ""}.get(row.type, "theta")
    unit = UNITS[words.length_unit if field in ("a", "d") else words.angle_unit]
    symbol = "°" if unit.degrees else f" {unit.symbol}"
    typed = words.rows[number].get(field, "") if number < len(words.rows) and field != variable else ""
    if typed:
        return f"{typed}{symbol}" if _BARE_NUMBER.fullmatch(typed) else typed
    return f"{math.degrees(value) if unit.degrees else value * 10.0**-unit.power:.4g}{symbol}"


def _axes(frame: RigidTransform) -> tuple[Vec3, Vec3, Vec3]:
    a, b, c, d, e, f, g, h, i = frame.rotation
    return (a, d, g), (b, e, h), (c, f, i)


def _arc(centre: Vec3, start: Vec3, about: Vec3, angle: float, radius: float) -> tuple[Vec3, ...]:
    """Points of the arc that an angle is, from one direction about another; none where it is nothing to see."""
    shown = math.remainder(angle, 2 * math.pi)
    shown = math.pi if shown == -math.pi else shown
    if abs(shown) < 1e-6:  # noqa: PLR2004 - [rad], less than a pixel
        return ()
    side = cross(about, start)
    steps = max(2, math.ceil(abs(shown) / 0.15))
    turns = [shown * step / steps for step in range(steps + 1)]
    return tuple(
        add(centre, scale(radius, add(scale(math.cos(turn), start), scale(math.sin(turn), side)))) for turn in turns
    )


def small(number: int) -> str:
    """A number as an index, in small digits."""
    return str(number).translate(str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉"))
