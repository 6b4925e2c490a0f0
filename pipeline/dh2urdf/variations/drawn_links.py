"""Links whose meshes, centres of mass and inertias were drawn for other lengths than their table has.

All three are given in the DH frame after a row, and stay there whatever the row says. The row's a and d are the way
between its joint and a frame, and alpha the turn between the axes. In the standard convention the link of the row is
between the two; in the modified one the link before.

Two things can be compared: a row with what it was (`torn_links`), and, in the standard convention, its a with the place
of its mesh (`other_lengths`). A mesh whose origin is in its joint, as that of most robot descriptions, is at x = -a on
the axis of the joint. Of anything else a table does not tell what it was drawn for.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.manipulator import BASE, Convention, JointType
from dh2urdf.rotations import greater_of, hypot, is_column, mapped, where
from dh2urdf.source import Messages, Problem

if TYPE_CHECKING:
    from collections.abc import Iterator

    from dh2urdf.manipulator import DHRow, Manipulator
    from dh2urdf.rotations import Number
    from dh2urdf.source import Mark

say = Messages(__file__)

LENGTHS = ("a", "d", "alpha")
"""The numbers of a row for which a link is drawn."""
GAP = 1e-3
"""Gap from which on it is noticed [m]: the arms of a series differ by less from their drawings."""
TURN = math.radians(1.0)
"""Turn from which on it is noticed [rad]."""
_COMPARED = {"mesh-off-drawn-link", "mesh-of-other-length", "lengths-drawn"}
"""Notices of a table that has been compared before."""
_PLANE = 1e-4  # m: how far the origin of a mesh may be from the plane of x and the joint's axis
_FROM, _TO = 2.0 / 3.0, 1.5  # of x over -a: at 0 is the end of a link, at 1/2 its middle, where boxes have their origin


def torn_links(before: Manipulator, after: Manipulator, what: str, mark: Mark | None = None) -> Iterator[Problem]:
    """A notice where the lengths of links have changed, and what is drawn of them has not: of the worst of them.

    Args:
        before: the table for which the links are drawn.
        after: the same rows with other numbers, of which some may be columns.
        what: what has changed the numbers, such as ``the edits change``.
        mark: the place of that; the row's where it is None.
    """
    if len(before.rows) != len(after.rows):
        return
    torn = []
    holders = (None, *after.rows[:-1]) if after.convention is Convention.MODIFIED else after.rows
    for holder, old, new in zip(holders, before.rows, after.rows, strict=True):
        if old.type is not new.type or not (drawn := _drawn(after, holder)):
            continue
        # A prismatic joint slides along d anyway, and theta turns a link about its joint.
        along = 0.0 if new.type is JointType.PRISMATIC else new.d - old.d
        gap = _most(hypot(new.a - old.a, along))
        turn = _most(mapped(math.remainder, new.alpha - old.alpha, math.tau))
        if gap >= GAP or turn >= TURN:
            field = "alpha" if gap < GAP else "a" if _most(new.a - old.a) >= _most(along) else "d"
            torn.append((gap, turn, field, new, holder.link if holder else BASE, drawn))
    if torn:
        gap, turn, field, row, link, drawn = max(torn, key=lambda each: each[:2])
        sizes = [f"{1e3 * gap:.4g} mm"] if gap >= GAP else []
        sizes += [f"{math.degrees(turn):.3g}°"] if turn >= TURN else []
        kept = " and ".join(filter(None, (", ".join(drawn[:-1]), drawn[-1])))
        about = {"what": what, "link": link, "kept": kept, "off": " and ".join(sizes), "others": _others(len(torn))}
        yield say("mesh-off-drawn-link", mark or row.mark, joint=row.joint, field=field, **about)


def other_lengths(manipulator: Manipulator) -> Iterator[Problem]:
    """A notice where meshes were drawn for another a than that of their rows, of the worst of them.

    A table whose numbers were changed, and compared, before is not looked at: nor is one of the modified convention.
    """
    if not is_to_compare(manipulator):
        return
    odd = [(gap, row) for row in manipulator.rows if (gap := mesh_gap(row)) >= GAP]
    if odd:
        gap, row = max(odd, key=lambda each: each[0])
        about = {"a": row.a, "link": row.link, "gap": 1e3 * gap, "others": _others(len(odd))}
        yield say("mesh-of-other-length", row.mark, joint=row.joint, field="a", **about)


def is_to_compare(manipulator: Manipulator) -> bool:
    """Whether the places of meshes tell for which lengths they were drawn, and nobody has compared lengths before."""
    told = any(notice.code in _COMPARED for notice in manipulator.notices)
    return manipulator.convention is Convention.STANDARD and not told


def mesh_gap(row: DHRow) -> Number:
    """How far the meshes of a row begin from its joint [m], if they were drawn from a joint: else 0. Takes columns.

    The origin of the mesh then is on the plane of x and the joint's axis, which is (0, sin α, cos α) in the frame after
    the row, and nearly at x = -a.
    """
    widest: Number = 0.0
    for shape in (row.visual, row.collision):
        if shape is not None:
            x, y, z = shape.pose.translation
            across = y * mapped(math.cos, row.alpha) - z * mapped(math.sin, row.alpha)
            square, product = row.a * row.a, -row.a * x
            is_near = (product > 0.0) & (product >= _FROM * square) & (product <= _TO * square)
            widest = greater_of(widest, where(is_near & (abs(across) <= _PLANE), abs(x + row.a), 0.0))
    return widest


def _drawn(manipulator: Manipulator, row: DHRow | None) -> list[str]:
    """What is drawn of the link of a row, or of the base, in its DH frame."""
    if row is None:
        return ["mesh"] if manipulator.base_visual or manipulator.base_collision else []
    given = {"mesh": row.visual or row.collision, "centre of mass": row.com, "inertia": row.inertia}
    return [name for name, value in given.items() if value is not None]


def _most(number: Number) -> float:
    """The size of a number; the greatest of a column."""
    return float(abs(number).max() if is_column(number) else abs(number))


def _others(count: int) -> str:
    return f"; of {count} links, this is the farthest" if count > 1 else ""
