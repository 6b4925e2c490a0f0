"""What a careful person would look at twice in a manipulator that has been read: each of it is worth a notice."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from dh2urdf.manipulator import JointType
from dh2urdf.quantities import Dimension
from dh2urdf.rotations import HALF_PI
from dh2urdf.source import Problem
from dh2urdf_plugins.readers.words.bounds import (
    DENSITIES,
    FASTEST_SLIDE,
    FASTEST_TURN,
    HEAVIEST_LINK,
    HEAVY,
    LIGHT,
    LONG_ARM,
    LONG_ROW,
    LONGEST_ARM,
    NARROWEST_RANGE,
    NEARLY_PARALLEL,
    RESISTANCES,
    SHORTEST_ARM,
    SHORTEST_STROKE,
    SMALL_ANGLE,
    SMALLEST_GYRATION,
    SMALLEST_LENGTH,
    STRONGEST,
    THINNEST,
    WIDEST_LIMIT,
    are_limits_in_radians,
    are_radians,
)

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Iterator, Sequence

    from dh2urdf.manipulator import DHRow, Payload
    from dh2urdf_plugins.readers.statements.statements import Statements
    from dh2urdf_plugins.readers.words.cells import Units

_ANOTHER = "is it in another unit?"


def arm_length(rows: Sequence[DHRow]) -> float:
    """The length of the stretched arm at q = 0 [m]."""
    return sum(abs(row.a) + abs(row.d) for row in rows)


def reach_of(rows: Sequence[DHRow]) -> float:
    """The length of the stretched arm, with the travel of the joints that slide [m]."""
    slides = [row.limits for row in rows if row.type is JointType.PRISMATIC]
    return arm_length(rows) + sum(max(abs(limits.lower or 0), abs(limits.upper or 0)) for limits in slides)


def longest_plain(count: int) -> float:
    """How long an arm of some rows is without a word [m]."""
    return min(LONGEST_ARM, max(LONG_ARM, LONG_ROW * count))


def shortest_plain(statements: Statements) -> float:
    """How long an arm has to be so that there is nothing to report about it beside its base, tool and links [m]."""
    tool, base = (math.hypot(*where.translation) if where else 0.0 for where in (statements.tool, statements.base))
    radius, density = statements.geometry.radius, statements.density
    if (radius and not THINNEST <= radius <= 1.0) or (density and not DENSITIES[0] <= density <= DENSITIES[1]):
        return math.inf
    return max(SHORTEST_ARM, tool, base if base > 1.0 else 0.0, _shortest_for(statements.payload))


def _shortest_for(payload: Payload | None) -> float:
    """How long an arm has to be so that there is nothing to report about its payload [m]."""
    if payload is None:
        return 0.0
    reaches = (math.sqrt(payload.mass / HEAVY), 0.5), (math.hypot(*payload.com), 1.0), (_gyration(payload), 0.2)
    return max(reach if reach > least else 0.0 for reach, least in reaches)


def plausibility(rows: Sequence[DHRow], statements: Statements, units: Units) -> Iterator[Problem]:
    """Notices of a manipulator, one for each kind.

    Args:
        rows: its rows; some may be missing where they are wrong.
        statements: what holds for all of them.
        units: the units of bare numbers.
    """
    reach = reach_of(rows)
    yield from _of_the_arm(rows, statements, units, reach)
    yield from _of_the_payload(statements, reach)
    yield from _of_joints(rows, units)
    yield from _of_resistances(rows)
    yield from _of_links(rows, units, reach)
    radius, density = statements.geometry.radius, statements.density
    if radius and not THINNEST <= radius <= max(reach, 1.0):
        yield _of_all(f"links are {radius:.4g} m thick", rows, "radius")
    if density and not DENSITIES[0] <= density <= DENSITIES[1]:
        message = f"the density of links is {density:.4g} kg/m³"
        yield Problem(
            message=message,
            severity="notice",
            mark=rows[0].mark,
            field="density",
            suggestion="write its unit if it is another one: '2.7 g/cm³'",
        )


def _of_the_arm(rows: Sequence[DHRow], statements: Statements, units: Units, reach: float) -> Iterator[Problem]:
    length = arm_length(rows)
    declare = "if its lengths are in {0}, declare it: `a [{0}]`, `units: {{length: {0}}}` or `--length-unit {0}`"
    known = Dimension.LENGTH in statements.stated
    if length > longest_plain(len(rows)):
        advice = _CALIBRATED if _is_calibrated(rows) else None if known else declare.format("mm")
        yield _of_all(f"the arm is {length:.4g} m long", rows, None, advice)
    elif 0 < reach < SHORTEST_ARM:
        yield _of_all(f"the arm is {1000 * reach:.4g} mm long", rows, None, declare.format("m") if known else _ANOTHER)
    else:
        for name in ("a", "d"):
            unit = units.columns.get(name) or units.of(Dimension.LENGTH)
            longest = max(abs(getattr(row, name)) for row in rows)
            if unit and not unit.is_si and 0 < longest < SMALLEST_LENGTH:
                message = f"no {name} is longer than {1000 * longest:.4g} mm, and the unit of {name} is {unit.symbol}"
                yield _of_all(message, rows, name, declare.format("m"))
    for what, where, least in (("base", statements.base, 1.0), ("tool", statements.tool, 0.0)):
        distance = math.hypot(*where.translation) if where else 0.0
        if 0 < reach < distance > least and distance <= LONGEST_ARM / 10:
            message = f"{what} is {distance:.4g} m away, and the arm is {reach:.4g} m long"
            yield _of_all(message, rows, what, "is one of them in another unit?")


_CALIBRATED = (
    "if this is the table of a calibrated arm, whose nearly parallel axes have their normals far away, `--set "
    "near_parallel=split` keeps links and masses of the arm's own size"
)


def _is_calibrated(rows: Sequence[DHRow]) -> bool:
    """Whether the longest d is that of a joint whose axis is nearly parallel to one beside it."""
    number = max(range(len(rows)), key=lambda place: abs(rows[place].d))
    beside = rows[max(0, number - 1) : number + 2]
    return any(0.0 < abs(math.remainder(row.alpha, math.pi)) < NEARLY_PARALLEL for row in beside)


def _of_the_payload(statements: Statements, reach: float) -> Iterator[Problem]:
    payload, mark = statements.payload, statements.placed.get("payload")
    if payload is None:
        return
    arm = f"and the arm is {reach:.4g} m long"
    found = {
        "mass": (payload.mass > HEAVY * max(reach, 0.5) ** 2, f"the payload weighs {payload.mass:.4g} kg, {arm}"),
        "com": (
            (far := math.hypot(*payload.com)) > max(reach, 1.0),
            f"the payload's centre of mass is {far:.4g} m from tool0, {arm}",
        ),
        "inertia": (
            (wide := _gyration(payload)) > max(reach, 0.2),
            f"the payload's radius of gyration is {wide:.4g} m, {arm}",
        ),
    }
    for name, (is_odd, message) in found.items():
        if is_odd:
            field = f"payload.{name}"
            yield Problem(message=message, severity="notice", mark=mark, field=field, suggestion=_ANOTHER)


def _of_resistances(rows: Sequence[DHRow]) -> Iterator[Problem]:
    """Notices of damping, friction and armature that no joint has."""
    for name, most in RESISTANCES.items():
        units = ("N·m·s/rad", "N·s/m") if name == "damping" else ("N·m", "N") if name == "friction" else ("kg·m²", "kg")
        for linear, largest, unit in zip((False, True), most, units, strict=True):
            joints = [row for row in rows if (row.type is JointType.PRISMATIC) is linear]
            is_odd = _beyond(name, largest)
            yield from _grouped(joints, name, is_odd, f"its {name} is {{}} {unit}", _ANOTHER)


def _beyond(name: str, largest: float) -> Callable[[DHRow], bool]:
    return lambda row: (getattr(row, name) or 0.0) > largest


def _of_joints(rows: Sequence[DHRow], units: Units) -> Iterator[Problem]:
    turning = [row for row in rows if row.type in (JointType.REVOLUTE, JointType.CONTINUOUS)]
    sliding = [row for row in rows if row.type is JointType.PRISMATIC]
    fast = "if the number is in degrees, rpm or mm, say so: '180 deg/s', `velocity [rpm]`"
    yield from _grouped(
        turning, "velocity", lambda row: (row.limits.velocity or 0) >= FASTEST_TURN, "it turns at {} rad/s", fast
    )
    yield from _grouped(
        sliding, "velocity", lambda row: (row.limits.velocity or 0) > FASTEST_SLIDE, "it slides at {} m/s", fast
    )
    strong = "write its unit if it is another one: '150 N·mm'"
    yield from _grouped(rows, "effort", lambda row: (row.limits.effort or 0) > STRONGEST, "its effort is {}", strong)
    yield from _grouped(turning, "upper", lambda row: _bound(row) > WIDEST_LIMIT, "it turns as far as {} rad", _ANOTHER)
    yield from _grouped(
        sliding, "lower", lambda row: _bound(row) > LONGEST_ARM, "the joint slides further than 100 m", _ANOTHER
    )
    tiny = "if its limits are in metres, say so: '0.5 m', `lower [m]`"
    yield from _grouped(sliding, "stroke", _is_short, "the joint slides no further than {} mm", tiny)
    sizes = "if the numbers are how far it moves to each side, write the lower one with its minus"
    yield from _grouped(turning, "bound", _is_stuck, "both of its bounds are {}°, so that it cannot turn", sizes)
    for name in ("alpha", "theta", "offset"):
        unit = units.columns.get(name) or units.of(Dimension.ANGLE)
        if unit and unit.degrees:
            angles = [row for row in rows if name != "offset" or row in turning]
            said = "the angle is {} in a column of degrees, a part of π"
            yield from _grouped(angles, name, _radians_in(name), said, _RADIANS)
    yield from _of_degrees(turning, units)
    bounds = [(row.limits.lower, row.limits.upper) for row in turning]
    ranges = [upper - lower for lower, upper in bounds if lower is not None and upper is not None]
    if ranges and 0 < max(ranges) < NARROWEST_RANGE:
        message = f"no joint turns further than {max(ranges) / HALF_PI * 90:.3g}°"
        yield _of_all(message, rows, "upper", "if the limits are in rad, say so: `lower [rad]`, `upper [rad]`")


def _of_degrees(turning: Sequence[DHRow], units: Units) -> Iterator[Problem]:
    """Limits and speeds that were read in degrees, and have the numbers that they would have in rad."""
    unit = units.columns.get("lower") or units.of(Dimension.ANGLE)
    if unit and unit.degrees:
        said = "its limits reach to {} in degrees, the number of round degrees in rad"
        in_radians = "if the limits are in rad, say so: `lower [rad]`, `upper [rad]`"
        yield from _grouped(turning, "bound", lambda row: are_limits_in_radians(row.limits), said, in_radians)
    rate = units.columns.get("velocity") or units.of(Dimension.TURN_RATE)
    fastest = max((row.limits.velocity or 0.0 for row in turning), default=0.0)
    if rate and rate.degrees and 0 < fastest < SMALL_ANGLE:
        message = f"no joint turns faster than {fastest / HALF_PI * 90:.4g} deg/s"
        yield _of_all(message, turning, "velocity", "if the speeds are in rad/s, say so: `velocity [rad/s]`")


def _is_short(row: DHRow) -> bool:
    """Whether a joint that slides hardly does; one that is locked is meant to be."""
    return 0.0 < _stroke(row) < SHORTEST_STROKE


def _is_stuck(row: DHRow) -> bool:
    """Whether a joint that turns has two bounds that are the same, other than 0, where a locked one is."""
    return bool(row.limits.lower) and row.limits.lower == row.limits.upper


def _stroke(row: DHRow) -> float:
    lower, upper = row.limits.lower, row.limits.upper
    return 0.0 if lower is None or upper is None else upper - lower


def _radians_in(name: str) -> Callable[[DHRow], bool]:
    return lambda row: are_radians(getattr(row, name))


_RADIANS = "if it is in rad, say so: 'pi/2 rad', `alpha [rad]`"


def _bound(row: DHRow) -> float:
    return max(abs(row.limits.lower or 0), abs(row.limits.upper or 0))


def _of_links(rows: Sequence[DHRow], units: Units, reach: float) -> Iterator[Problem]:
    heaviest = min(HEAVIEST_LINK, HEAVY * max(reach, 0.5) ** 2)
    yield from _grouped(rows, "mass", lambda row: (row.mass or 0) > heaviest, "the link weighs {} kg", _ANOTHER)
    masses = [row.mass or 0 for row in rows if row.type is not JointType.FIXED]
    if masses and all(masses) and max(masses) < LIGHT * reach**2:
        yield _of_all(f"no link weighs more than {1000 * max(masses):.4g} g", rows, "mass", _ANOTHER)
    size = max(reach, 0.2)
    wide = "its radius of gyration is {} m, beyond the arm's length"
    yield from _grouped(rows, "inertia", lambda row: _gyration(row) > size, wide, "is the inertia in kg·mm² or g·cm²?")
    tiny = "its radius of gyration is {} m"
    yield from _grouped(rows, "inertia", lambda row: 0 < _gyration(row) < SMALLEST_GYRATION, tiny, "is it in kg·m²?")
    far = f"the centre of mass is {{}} m from the joint's frame, and the whole arm is {reach:.4g} m long"
    yield from _grouped(rows, "com", lambda row: _distance(row) > max(reach, 1.0), far, _ANOTHER)
    unit = units.columns.get("com_x") or units.of(Dimension.LENGTH)
    farthest = max(map(_distance, rows))
    if unit and not unit.is_si and 0 < farthest < SMALLEST_LENGTH:
        message = f"no centre of mass is further than {1000 * farthest:.4g} mm from its frame, and the unit of com is"
        yield _of_all(f"{message} {unit.symbol}", rows, "com", "are its numbers in metres?")
    thick = lambda row: not THINNEST <= (row.radius or THINNEST) <= max(reach, 1.0)  # noqa: E731 - as the others
    yield from _grouped(rows, "radius", thick, "the link is {} m thick", _ANOTHER)


def _gyration(body: DHRow | Payload) -> float:
    """Largest radius of gyration of a body about an axis of its frame [m]; 0 where it has none."""
    if not (body.mass and body.inertia):
        return 0.0
    return math.sqrt(max(body.inertia.ixx, body.inertia.iyy, body.inertia.izz, 0.0) / body.mass)


def _distance(row: DHRow) -> float:
    return math.hypot(*row.com) if row.com else 0.0


_NUMBERS: dict[str, Callable[[DHRow], float | None]] = {
    "velocity": lambda row: row.limits.velocity,
    "effort": lambda row: row.limits.effort,
    "upper": _bound,
    "lower": _bound,
    "bound": lambda row: _bound(row) / HALF_PI * 90,
    "stroke": lambda row: 1000 * _stroke(row),
    "damping": lambda row: row.damping,
    "friction": lambda row: row.friction,
    "armature": lambda row: row.armature,
    "mass": lambda row: row.mass,
    "inertia": _gyration,
    "com": _distance,
    "radius": lambda row: row.radius,
    "alpha": lambda row: row.alpha / HALF_PI * 90,
    "theta": lambda row: row.theta / HALF_PI * 90,
    "offset": lambda row: row.offset / HALF_PI * 90,
}


def _grouped(
    rows: Iterable[DHRow], field: str, is_odd: Callable[[DHRow], bool], message: str, suggestion: str
) -> Iterator[Problem]:
    """One notice of all rows of a kind, at the first of them."""
    odd = [row for row in rows if is_odd(row)]
    if odd:
        count = len(odd) - 1
        others = f", and {count} other{'s are' if count > 1 else ' is'} alike" if count else ""
        yield Problem(
            message=message.format(f"{_NUMBERS[field](odd[0]) or 0.0:.4g}") + others,
            severity="notice",
            mark=odd[0].mark,
            joint=odd[0].joint,
            field={"bound": "upper", "stroke": "upper"}.get(field, field),
            suggestion=suggestion,
        )


def _of_all(message: str, rows: Sequence[DHRow], field: str | None, suggestion: str | None = _ANOTHER) -> Problem:
    return Problem(message=message, severity="notice", mark=rows[0].mark, field=field, suggestion=suggestion)
