"""The size of an arm: one that is longer or shorter than arms are may have its lengths in another unit."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.quantities import UNITS, Dimension
from dh2urdf.source import Messages

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence
    from typing import Any

    from dh2urdf.manipulator import DHRow
    from dh2urdf.source import Problem
    from dh2urdf_plugins.readers.header.units import Units

say = Messages(__file__)

LONGEST_ARM, SHORTEST_ARM = 5.0, 0.02
"""Reach beyond which a notice asks for the unit [m]."""
_USUAL = (0.2, 3.0)
"""Reach of the arms that people build [m]."""
_NEARLY_PARALLEL = 0.01
"""Angle between the axes of neighbours that a calibration finds where the drawing has parallel ones [rad]."""
_CANDIDATES = ("cm", "inch", "mm", "m")


def arm_length(rows: Sequence[DHRow]) -> float:
    """The length of the stretched arm at q = 0 [m]."""
    return sum(abs(row.a) + abs(row.d) for row in rows)


def far_away(placed: Mapping[str, Any]) -> str | None:
    """Which of base and tool is further away than arms are long; None where neither is."""
    where = ((what, placed[what].translation) for what in ("base", "tool") if placed.get(what))
    return next((what for what, translation in where if math.hypot(*translation) > LONGEST_ARM), None)


def size_notice(rows: Sequence[DHRow], units: Units, placed: Mapping[str, Any]) -> Problem | None:
    """A notice of an arm that is longer than 5 m or shorter than 20 mm, with the units that would make it usual.

    Args:
        rows: its rows.
        units: the units of bare numbers.
        placed: its base and tool, of which one that is as far away is the same question.
    """
    if what := far_away(placed):
        return say("base-or-tool-far-away", field=what, limit=f"{LONGEST_ARM:g}")
    slides = [row.limits for row in rows if row.type is JointType.PRISMATIC]
    length = arm_length(rows)
    reach = length + sum(max(abs(limits.lower or 0), abs(limits.upper or 0)) for limits in slides)
    if not rows or not reach or (reach >= SHORTEST_ARM and length <= LONGEST_ARM):
        return None
    reach = length if length > LONGEST_ARM else reach
    read = units.columns.get("a") or units.columns.get("d") or units.of(Dimension.LENGTH) or UNITS["m"]
    sizes = {name: UNITS[name].si(reach / read.si(1.0)) for name in _CANDIDATES}
    meant = [name for name, size in sizes.items() if _USUAL[0] <= size <= _USUAL[1]]
    return say(
        "size-of-a-calibrated-arm" if length > LONGEST_ARM and _is_calibrated(rows) else "size",
        rows[0].mark,
        size=f"{reach:.4g} m" if reach >= 1 else f"{1000 * reach:.4g} mm",
        read=read.symbol,
        sizes=[f"{name} ({sizes[name]:.3g} m)" for name in meant] or "another unit",
        unit=meant[0] if meant else "mm",
    )


def _is_calibrated(rows: Sequence[DHRow]) -> bool:
    """Whether the longest d is that of a joint whose axis is nearly parallel to one beside it."""
    number = max(range(len(rows)), key=lambda place: abs(rows[place].d))
    beside = rows[max(0, number - 1) : number + 2]
    return any(0.0 < abs(math.remainder(row.alpha, math.pi)) < _NEARLY_PARALLEL for row in beside)
