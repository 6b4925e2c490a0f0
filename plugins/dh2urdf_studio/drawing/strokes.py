"""Lines in the scene: DH parameters, the motions of a row, and the common normals on which the frames stand.

Sources: Denavit and Hartenberg (1955); for axes that are parallel or meet, Siciliano et al., Robotics, section 2.8.2.
"""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from enum import StrEnum
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.chain import Screw, dh_frames, dh_transform, joint_variables, link_poses, reach as table_reach
from dh2urdf.manipulator import Convention, DHRow, JointType, Manipulator
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3, add, cross, dot, norm, rotate, scale, subtract
from dh2urdf.table_text import TableText
from dh2urdf_studio.page_data import PAGE

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.quantities.units import Unit
    from dh2urdf.robot import Robot

NAMES = {"theta": "Rz(θ)", "d": "Tz(d)", "a": "Tx(a)", "alpha": "Rx(α)"}
"""The elementary motions of a row by the parameter that is their size."""
ORDER = {Convention.STANDARD: ("theta", "d", "a", "alpha"), Convention.MODIFIED: ("alpha", "a", "theta", "d")}
"""The parameters of a row in the order of its motions."""
_BARE_NUMBER = re.compile(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?")
_PARALLEL = 1e-7  # sine of the angle between axes
_NONE = 1e-7  # of a length, in reaches
_BEYOND = 0.35  # how far an axis is drawn beyond its feet, in reaches
_CROSS = 0.25  # length of the arrow of a cross product, in reaches


@dataclass(frozen=True, slots=True, kw_only=True)
class Stroke:
    """A line to draw.

    Its field is a, alpha, d or theta; x, y or z of a frame; distance; line, normal, offset or foot of common normals.
    """

    row: int | None  # its number, counted from 0; None of what belongs to no row
    field: str
    points: tuple[Vec3, ...]  # from its beginning to its end, or the only one [m]
    label: str = ""


def _frames(table: Manipulator, q: Mapping[str, float], place: RigidTransform = IDENTITY) -> list[RigidTransform]:
    return [place @ frame for frame in dh_frames(table, [q.get(row.joint, 0.0) for row in table.actuated_rows])]


# --- Parameters and motions -------------------------------------------------------------------------------------------


def strokes(
    table: Manipulator,
    q: Mapping[str, float],
    *,
    place: RigidTransform = IDENTITY,
    radius: float,
    typed: TableText | None = None,
) -> Iterator[Stroke]:
    """Every parameter that is not zero, between the frame before a row and the one after it."""
    words, frames = typed or TableText(angle_unit="deg"), _frames(table, q, place)
    is_standard = table.convention is Convention.STANDARD
    for number, row in enumerate(table.rows):
        theta, d = joint_variables(row, q.get(row.joint, 0.0))
        before, after = frames[number], frames[number + 1]
        start, end = before.translation, after.translation
        x, z = (_axis(before, 0), _axis(before, 2))
        if is_standard:  # Rz(theta) Tz(d) Tx(a) Rx(alpha): z of before, x of after
            about, along, turns_at = z, _axis(after, 0), add(start, scale(d, z))
            foot, twists_at = turns_at, end
            lines = {"d": (start, foot), "a": (foot, end)}
        else:  # Rx(alpha) Tx(a) Rz(theta) Tz(d): x of before, z of after
            about, along, turns_at, twists_at = _axis(after, 2), x, end, start
            foot = add(start, scale(row.a, x))
            lines = {"a": (start, foot), "d": (foot, end)}
        index = number + is_standard
        for field, value, points, which in (
            ("d", d, lines["d"] if d else (), number + 1),
            ("a", row.a, lines["a"] if row.a else (), index),
            ("theta", theta, _arc(turns_at, x, about, theta, radius), number + 1),
            ("alpha", row.alpha, _arc(twists_at, z, along, row.alpha, radius), index),
        ):
            if points:
                symbol = {"theta": "θ", "alpha": "α"}.get(field, field)
                label = f"{symbol}{small(which)} = {_value(words, row, number, field, value)}"
                yield Stroke(row=number, field=field, points=points, label=label)


def _value(words: TableText, row: DHRow, number: int, field: str, value: float) -> str:
    """A parameter as it was typed or, where it moves or nobody has typed it, in the unit of the table."""
    variable = {JointType.PRISMATIC: "d", JointType.FIXED: ""}.get(row.type, "theta")
    unit = UNITS[words.length_unit if field in ("a", "d") else words.angle_unit]
    symbol = "°" if unit.degrees else f" {unit.symbol}"
    typed = words.rows[number].get(field, "") if number < len(words.rows) and field != variable else ""
    if typed:
        return f"{typed}{symbol}" if _BARE_NUMBER.fullmatch(typed) else typed
    return f"{unit.number(value):.4g}{symbol}"


def _arc(centre: Vec3, start: Vec3, about: Vec3, angle: float, radius: float) -> tuple[Vec3, ...]:
    """Points of the arc that an angle is, from one direction about another; none where it is nothing to see."""
    shown = math.remainder(angle, math.tau)
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
    return "".join(chr(ord("₀") + int(digit)) for digit in str(number))


def so_far(convention: Convention, row: DHRow, q: float, progress: float) -> RigidTransform:
    """The motions of a row at a joint value [rad or m] that are done, from 0 to 4, the last one in part."""
    theta, d = joint_variables(row, q)
    sizes = {"theta": theta, "d": d, "a": row.a, "alpha": row.alpha}
    share = {field: min(max(progress - number, 0.0), 1.0) for number, field in enumerate(ORDER[convention])}
    return dh_transform(convention, **{field: share[field] * size for field, size in sizes.items()})


def moving_frame(
    table: Manipulator, number: int, q: Mapping[str, float], progress: float, size: float
) -> Iterator[Stroke]:
    """The axes of the frame on its way through a row, as arrows of a size [m]; its progress is counted in motions."""
    row = table.rows[number]
    frame = _frames(table, q)[number] @ so_far(table.convention, row, q.get(row.joint, 0.0), progress)
    for axis, name in enumerate("xyz"):
        tip = add(frame.translation, scale(size, _axis(frame, axis)))
        yield Stroke(row=number, field=name, points=(frame.translation, tip), label=name)


# --- Common normals ---------------------------------------------------------------------------------------------------


class Position(StrEnum):
    """How two axes lie to each other."""

    SKEW = "skew"
    PARALLEL = "parallel"
    MEETING = "meeting"
    ONE_LINE = "one line"


class AxisNormal(NamedTuple):
    """The common normal of an axis and the next one."""

    position: Position
    start: Vec3  # its foot on the first axis [m]
    end: Vec3  # its foot on the next one [m]
    direction: (
        Vec3 | None
    )  # the unit vector from foot to foot; of axes that meet, of their cross product; of one line none
    angle: float  # from the first axis to the next one, about the direction [rad]


def common_normal(one: Screw, other: Screw, near: Vec3, least: float) -> AxisNormal:
    """The common normal of two axes, no further apart than `least` [m] where they meet.

    Of the many common normals of parallel axes, it is the one whose foot on the first is nearest to a point `near`.
    """
    product, between = cross(one.direction, other.direction), subtract(other.point, one.point)
    sine = norm(product)
    if sine < _PARALLEL:
        start = _at(one, dot(subtract(near, one.point), one.direction))
        end = _at(other, dot(subtract(start, other.point), other.direction))
    else:
        start = _at(one, dot(cross(between, other.direction), product) / sine**2)
        end = _at(other, dot(cross(between, one.direction), product) / sine**2)
    step = subtract(end, start)
    length, angle = norm(step), math.atan2(sine, dot(one.direction, other.direction))
    if length >= least:
        direction = scale(1.0 / length, step)
        signed = angle if dot(product, direction) >= 0.0 else -angle
        return AxisNormal(Position.PARALLEL if sine < _PARALLEL else Position.SKEW, start, end, direction, signed)
    if sine < _PARALLEL:
        return AxisNormal(Position.ONE_LINE, start, start, None, angle)
    return AxisNormal(Position.MEETING, start, start, scale(1.0 / sine, product), angle)


def _at(line: Screw, far: float) -> Vec3:
    """A point of a line, so far from its own one [m]."""
    return add(line.point, scale(far, line.direction))


def row_normals(table: Manipulator, frames: Sequence[RigidTransform], least: float) -> list[AxisNormal]:
    """The common normals of the z axes before and after each row; of parallel axes the ones that the table takes."""
    # The origin after a row is a foot in the standard convention, the one before it in the modified one.
    feet = frames[1:] if table.convention is Convention.STANDARD else frames
    pairs = zip(pairwise(map(_z_line, frames)), feet, strict=False)
    return [common_normal(one, other, foot.translation, least) for (one, other), foot in pairs]


def table_normals(
    table: Manipulator,
    q: Mapping[str, float],
    *,
    place: RigidTransform = IDENTITY,
    reach: float,
    typed: TableText | None = None,
    only: int | None = None,
) -> Iterator[Stroke]:
    """The axes z of a table, or of one row `only`, with their common normals, and the offsets along each axis.

    The base_link is at a `place` in a scene of a size `reach` [m]; lengths are in the unit of the table as `typed`.
    """
    frames = _frames(table, q, place)
    normals = row_normals(table, frames, _NONE * reach)
    is_standard = table.convention is Convention.STANDARD
    unit = UNITS[typed.length_unit if typed else "m"]
    arrivals = [frames[0].translation, *(normal.end for normal in normals)]
    departures = [*(normal.start for normal in normals), frames[-1].translation]
    rows = [only] if only is not None else list(range(len(normals)))
    for number in sorted({axis for row in rows for axis in (row, row + 1)}):
        yield _line(f"z{small(number)}", _z_line(frames[number]), (arrivals[number], departures[number]), reach)
    for row in rows:
        axis = row if is_standard else row + 1
        names = f"z{small(row)} × z{small(row + 1)}", f"a{small(row + is_standard)}", f"d{small(row + 1)}"
        yield from _of_normal(row, normals[row], (arrivals[axis], departures[axis]), names, unit, reach)


def robot_normals(
    robot: Robot, q: Mapping[str, float], *, place: RigidTransform = IDENTITY, reach: float
) -> Iterator[Stroke]:
    """The same of a robot without a table: the axis of each moving joint, and the common normal with the one before."""
    poses, above = link_poses(robot, q), {joint.child: joint for joint in robot.joints}
    moving = {joint.name: joint for joint in robot.moving_joints if joint.child in poses}
    lines = {}
    for name, joint in moving.items():
        pose = place @ poses[joint.child]
        direction = rotate(pose.rotation, joint.axis)
        lines[name] = Screw(scale(1.0 / norm(direction), direction), pose.translation)
    feet: dict[str, list[Vec3]] = {name: [] for name in lines}
    arrivals: dict[str, Vec3] = {}
    for name, joint in moving.items():  # a robot's joints come after the ones that hold them
        before = above.get(joint.parent)
        while before is not None and before.name not in lines:
            before = above.get(before.parent)
        if before is None:
            continue
        one, other = lines[before.name], lines[name]
        near = arrivals.get(before.name, one.point)
        normal = common_normal(one, other, near, _NONE * reach)
        arrivals[name] = normal.end
        feet[before.name].append(normal.start)
        feet[name].append(normal.end)
        yield from _of_normal(None, normal, (near, normal.start), ("z × z", "a", "d"), UNITS["m"], reach)
    for name, line in lines.items():
        yield _line("", line, feet[name] or [line.point], reach)


def where_x_is(table: Manipulator, q: Mapping[str, float], number: int) -> str:
    """Where x of a row comes from, as HTML: how the axes before and after the row lie to each other."""
    frames = _frames(table, q)
    normal = row_normals(table, frames, _NONE * table_reach(table))[number]
    one, other = f"z<sub>{number}</sub>", f"z<sub>{number + 1}</sub>"
    frame = number + 1 if table.convention is Convention.STANDARD else number
    x = f"x<sub>{frame}</sub>"
    against = normal.direction is not None and dot(_axis(frames[frame], 0), normal.direction) < 0.0
    way = f"from {other} to {one}, as a is negative" if against else f"from {one} to {other}"
    sense = "against" if against else "along"
    told: str = PAGE["positions"][normal.position]
    return told.format(one=one, other=other, x=x, way=way, sense=sense, frame=frame).strip()


def _axis(frame: RigidTransform, number: int) -> Vec3:
    r = frame.rotation
    return (r[number], r[number + 3], r[number + 6])


def _z_line(frame: RigidTransform) -> Screw:
    return Screw(_axis(frame, 2), frame.translation)


def _line(name: str, line: Screw, feet: Sequence[Vec3], reach: float) -> Stroke:
    """An axis, some way beyond the feet on it."""
    along = [dot(subtract(foot, line.point), line.direction) for foot in feet]
    ends = min(along) - _BEYOND * reach, max(along) + _BEYOND * reach
    return Stroke(row=None, field="line", points=tuple(_at(line, end) for end in ends), label=name)


def _of_normal(  # noqa: PLR0917 - what is drawn, and how it is named
    row: int | None, normal: AxisNormal, way: tuple[Vec3, Vec3], names: tuple[str, str, str], unit: Unit, reach: float
) -> Iterator[Stroke]:
    """A common normal with its feet, and the way along an axis from one foot to the next, where it is any.

    Of axes that meet, the cross product takes the place of the normal.
    """
    product, a, d = names

    def measured(field: str, name: str, start: Vec3, end: Vec3) -> Stroke:
        label = f"|{name}| = {unit.number(math.dist(start, end)):.4g} {unit.symbol}"
        return Stroke(row=row, field=field, points=(start, end), label=label)

    if normal.direction is not None:
        if normal.position is Position.MEETING:
            tip = add(normal.start, scale(_CROSS * reach, normal.direction))
            yield Stroke(row=row, field="normal", points=(normal.start, tip), label=product)
        else:
            yield measured("normal", a, normal.start, normal.end)
            yield Stroke(row=row, field="foot", points=(normal.end,))
        yield Stroke(row=row, field="foot", points=(normal.start,))
    if math.dist(*way) >= _NONE * reach:
        yield measured("offset", d, *way)
