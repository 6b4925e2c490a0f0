"""The axes of a table: its rows that move."""

from __future__ import annotations

from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf_studio.editing.edits import resized

if TYPE_CHECKING:
    from dh2urdf.table_text import TableText
    from dh2urdf_studio.editing.session import OpenArm


def moving_rows(table: TableText, arm: OpenArm | None) -> list[int]:
    """The numbers of the rows that move, and so are axes.

    Args:
        table: the table.
        arm: the last arm that could be made, which knows what fixed joints are called in the table beside ``fixed``.
    """
    made = zip(arm.table.rows, arm.manipulator.rows, strict=False) if arm else ()
    fixed = {"fixed", *(typed["type"] for typed, row in made if row.type is JointType.FIXED and "type" in typed)}
    return [number for number, row in enumerate(table.rows) if row.get("type") not in fixed]


def with_axes(table: TableText, count: int, arm: OpenArm | None) -> TableText:
    """The table with so many rows that move: empty ones more, or the last ones less, fixed rows among them."""
    moving = moving_rows(table, arm)
    if count >= len(moving):
        return resized(table, len(table.rows) + count - len(moving))
    return resized(table, moving[count - 1] + 1 if count else 0)
