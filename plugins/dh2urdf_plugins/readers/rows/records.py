"""Records by the hundred thousand, made without the price of frozen dataclasses.

A frozen dataclass sets each of its slots through `object.__setattr__`: 1.4 µs for a row, five times what it costs to
fill the same slots of another class. Python lets the class of an object be changed to one with the same slots, and so
the records made here are like any others.
"""

from __future__ import annotations

from dataclasses import fields
from typing import TYPE_CHECKING, Any

from dh2urdf.manipulator import DHRow, Limits, Manipulator
from dh2urdf.source import Mark

if TYPE_CHECKING:
    from collections.abc import Iterable


class _Row:
    """The slots of a `DHRow`."""

    __slots__ = tuple(field.name for field in fields(DHRow))


class _Limits:
    """The slots of `Limits`."""

    __slots__ = tuple(field.name for field in fields(Limits))


class _Mark:
    """The slots of a `Mark`."""

    __slots__ = tuple(field.name for field in fields(Mark))


class _Manipulator:
    """The slots of a `Manipulator`."""

    __slots__ = tuple(field.name for field in fields(Manipulator))


_NOT_GIVEN = tuple(field.name for field in fields(DHRow) if field.default is None and field.name != "mark")
"""What a row leaves out."""


def make_marks(file: str, lines: Iterable[int], before: str | None = None) -> list[Mark]:
    """The places of rows.

    Args:
        file: their file.
        lines: the line of each.
        before: what the name of a place has before its number, where the file has no lines: `row `; see `Mark.place`.
    """
    if before is not None:
        return [Mark(file=file, line=line, place=f"{before}{line}") for line in lines]
    made: list[Any] = []
    for line in lines:
        mark: Any = _Mark()
        mark.file = file
        mark.line = line
        mark.column = mark.place = None
        mark.__class__ = Mark
        made.append(mark)
    return made


def make_rows(rows: Iterable[tuple[Any, ...]]) -> list[DHRow]:
    """Rows with nothing beyond their geometry and limits.

    Args:
        rows: joint, link, type, a, alpha, d, theta, offset, limits and mark of each.
    """
    made: list[Any] = []
    for joint, link, kind, a, alpha, d, theta, offset, limits, mark in rows:
        row: Any = _Row()
        row.joint = joint
        row.link = link
        row.type = kind
        row.a = a
        row.alpha = alpha
        row.d = d
        row.theta = theta
        row.offset = offset
        row.sign = 1
        row.limits = limits
        row.mark = mark
        for name in _NOT_GIVEN:
            setattr(row, name, None)
        row.__class__ = DHRow
        made.append(row)
    return made


def make_limits(limits: Iterable[tuple[float | None, float | None, float | None, float | None]]) -> list[Limits]:
    """Limits of lower, upper, velocity and effort each."""
    made: list[Any] = []
    for lower, upper, velocity, effort in limits:
        bounds: Any = _Limits()
        bounds.lower = lower
        bounds.upper = upper
        bounds.velocity = velocity
        bounds.effort = effort
        bounds.__class__ = Limits
        made.append(bounds)
    return made


def make_manipulators(model: Manipulator, arms: Iterable[tuple[str, tuple[DHRow, ...]]]) -> list[Manipulator]:
    """Manipulators of some names and rows that are like another one in everything else."""
    convention, base, tool, geometry = model.convention, model.base, model.tool, model.geometry
    density, base_mass, base_geometry, notices = model.density, model.base_mass, model.base_geometry, model.notices
    base_visual, base_collision, payload = model.base_visual, model.base_collision, model.payload
    visuals, collisions = model.visuals, model.collisions
    made: list[Any] = []
    for name, rows in arms:
        arm: Any = _Manipulator()
        arm.name = name
        arm.convention = convention
        arm.rows = rows
        arm.base = base
        arm.tool = tool
        arm.geometry = geometry
        arm.density = density
        arm.base_mass = base_mass
        arm.payload = payload
        arm.base_geometry = base_geometry
        arm.base_visual = base_visual
        arm.base_collision = base_collision
        arm.visuals = visuals
        arm.collisions = collisions
        arm.mark = rows[0].mark
        arm.notices = notices
        arm.__class__ = Manipulator
        made.append(arm)
    return made
