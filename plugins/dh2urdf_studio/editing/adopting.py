"""Taking the numbers of a robot description into the table: as few cells as make the two the same arm."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING

from dh2urdf.conversion.one_manipulator import read_items
from dh2urdf.errors import Dh2UrdfError
from dh2urdf.kinematics.chain import angle_error, forward_kinematics, position_error
from dh2urdf.kinematics.comparison import DECIMALS, TOLERANCE, compare
from dh2urdf.manipulator import Convention, JointType, Manipulator
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import IDENTITY, RigidTransform
from dh2urdf.stage_calls.calls import default_call
from dh2urdf.table_text import dimension_of, number_in, table_text, unit_of
from dh2urdf_studio.editing import edits
from dh2urdf_studio.editing.reading import read_whole

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from dh2urdf.manipulator import DHRow
    from dh2urdf.plugin_system.catalog import Catalog
    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.comparing import Beside

_SAME = TOLERANCE / 10
"""Numbers that differ less [m] and [rad] are left as they are."""
_NUMBERS = ("a", "alpha", "d", "theta", "offset", "sign")


def own_table(path: Path, catalog: Catalog, like: Manipulator, ends: tuple[str, str]) -> Manipulator | None:
    """The table of a chain of a description; None where it has none.

    Args:
        path: the description.
        catalog: the installed stages.
        like: the table whose convention it is to have.
        ends: the base link and the tip link of the chain.
    """
    try:
        call = default_call(catalog, catalog.reader_for(path))
        chain = {"convention": str(like.convention), "base_link": ends[0], "tip_link": ends[1]}
        found = list(read_items(replace(call, options=replace(call.options, **chain)), path))
    except (Dh2UrdfError, TypeError):  # a reader without these options reads no chains
        return None
    return found[0] if len(found) == 1 and isinstance(found[0], Manipulator) else None


def adopted(
    table: TableText, arm: Manipulator, found: Beside, own: Manipulator | None, catalog: Catalog
) -> TableText | None:
    """The table with the numbers that make it the arm of a description; None where no table of these rows is.

    The numbers are those of the description's own table, or the base, tool, signs and offsets that the comparison has
    found: whichever are fewer. Every cell whose number is the same keeps its text.

    Args:
        table: the table.
        arm: what a reader makes of it.
        found: the description beside it.
        own: the table of the description; None where it has none.
        catalog: the installed stages.
    """
    if found.agreement is None or found.chain is None:
        return None
    zero = found.chain.forward_kinematics((0.0,) * len(arm.moving_rows))
    every = (own, own and _in_these_rows(own, arm, zero), found.agreement.corrected)
    wanted = [each for each in every if each is not None and _alike(each, arm)]
    right = [each for each in (_with_numbers(table, arm, one) for one in wanted) if _is_the_arm(each, found, catalog)]
    return min(right, key=lambda each: changed_cells(table, each), default=None)


def changed_cells(table: TableText, other: TableText) -> int:
    """How many cells of a table are others, base and tool included."""
    rows = zip(table.rows, other.rows, strict=True)
    cells = sum(one.get(field, "") != row.get(field, "") for one, row in rows for field in {*one, *row})
    return cells + (table.base != other.base) + (table.tool != other.tool)


def _alike(one: Manipulator, other: Manipulator) -> bool:
    """Whether two tables have the same kinds of rows."""
    kinds = [
        [(row.type is JointType.FIXED, row.type is JointType.PRISMATIC) for row in each.rows] for each in (one, other)
    ]
    return kinds[0] == kinds[1] and one.convention == other.convention


def _in_these_rows(own: Manipulator, arm: Manipulator, zero: RigidTransform) -> Manipulator | None:
    """A table with the moving rows of another one and its own fixed rows, whose tool makes up for what that moves.

    What comes after the last axis is kept too: it only moves the tool.

    Args:
        own: where the moving rows are from.
        arm: where everything else is from.
        zero: the pose of tool0 where all joint values are 0.
    """
    if len(own.moving_rows) != len(arm.moving_rows):
        return None
    new, rows = list(own.moving_rows), []
    kept = ("a", "alpha", "d") if arm.convention is Convention.STANDARD else ("d",)
    new[-1:] = [replace(last, **{field: getattr(arm.moving_rows[-1], field) for field in kept}) for last in new[-1:]]
    for row in arm.rows:
        if row.type is JointType.FIXED:
            rows.append(row)
        else:
            moving = new.pop(0)
            rows.append(replace(row, **{field: getattr(moving, field) for field in _NUMBERS}))
    bare = replace(arm, base=own.base, rows=tuple(rows), tool=IDENTITY)
    tool = forward_kinematics(bare, (0.0,) * len(arm.moving_rows)).inverse @ zero
    x, y, z = (round(number, DECIMALS) for number in tool.translation)
    roll, pitch, yaw = (round(number, DECIMALS) for number in tool.rpy)
    return replace(bare, tool=RigidTransform.from_xyz_rpy((x, y, z), (roll, pitch, yaw)))


def _with_numbers(table: TableText, arm: Manipulator, wanted: Manipulator) -> TableText:
    pairs = enumerate(zip(arm.rows, wanted.rows, strict=True))
    cells = {(number, field): text for number, (row, new) in pairs for field, text in _cells(row, new, table)}
    texts = table_text(replace(arm, base=wanted.base, tool=wanted.tool), table.length_unit, table.angle_unit)
    ends = {
        name: getattr(texts, name)
        for name in ("base", "tool")
        if max(f(getattr(arm, name), getattr(wanted, name)) for f in (position_error, angle_error)) > _SAME
    }
    return replace(edits.with_cells(table, cells), **ends)


def _cells(row: DHRow, new: DHRow, table: TableText) -> Iterator[tuple[str, str]]:
    """The cells of a row that have other numbers, with their texts; an offset that is there is kept."""
    length, angle = UNITS[table.length_unit], UNITS[table.angle_unit]
    moved = "d" if row.type is JointType.PRISMATIC else "theta"
    for field in ("a", "alpha", "d", "theta"):
        before, value = getattr(row, field), getattr(new, field)
        if field == moved:
            value += new.offset - row.offset
        apart = math.remainder(value - before, math.tau) if field in ("alpha", "theta") else value - before
        dimension = dimension_of(field, row.type)
        if abs(apart) > _SAME and dimension is not None:
            yield field, number_in(value, unit_of(dimension, length, angle))
    if row.sign != new.sign:
        yield "sign", str(new.sign)


def _is_the_arm(table: TableText, found: Beside, catalog: Catalog) -> bool:
    manipulator, agreement = read_whole(table, catalog).manipulator, found.agreement
    if manipulator is None or agreement is None:
        return False
    ends = {"base_link": agreement.base_link, "tip_link": agreement.tip_link}
    return compare(found.figure.robot, manipulator, **ends).holds
