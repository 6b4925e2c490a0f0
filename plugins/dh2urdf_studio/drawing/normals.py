"""The common normals of consecutive joint axes, on which the DH frames of an arm stand: their feet, a, and d.

Source: Denavit and Hartenberg (1955); for axes that are parallel or meet, Siciliano et al., Robotics, section 2.8.2.
"""

from __future__ import annotations

import math
from enum import StrEnum
from itertools import pairwise
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.chain import dh_frames, link_poses, reach as table_reach
from dh2urdf.kinematics.facts import Line
from dh2urdf.manipulator import Convention
from dh2urdf.quantities.units import UNITS
from dh2urdf.rotations import IDENTITY, RigidTransform, Vec3, add, cross, dot, norm, rotate, scale, subtract
from dh2urdf_studio.drawing.strokes import Stroke, small

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping, Sequence

    from dh2urdf.manipulator import Manipulator
    from dh2urdf.quantities.units import Unit
    from dh2urdf.robot import Joint, Robot
    from dh2urdf.table_text import TableText

_PARALLEL = 1e-7  # sine of the angle between axes
_NONE = 1e-7  # of a length, in reaches
_BEYOND = 0.35  # how far an axis is drawn beyond its feet, in reaches
_CROSS = 0.25  # length of the arrow of a cross product, in reaches


class Position(StrEnum):
    """How two axes lie to each other."""

    SKEW = "skew"
    PARALLEL = "parallel"
    MEETING = "meeting"
    ONE_LINE = "one line"


class AxisNormal(NamedTuple):
    """The common normal of an axis and the next one.

    Attributes:
        position: how the axes lie to each other.
        start: its foot on the first axis [m].
        end: its foot on the next one [m].
        direction: the unit vector from foot to foot; of axes that meet, of their cross product; of one line, none.
        angle: from the first axis to the next one, about the direction [rad].
    """

    position: Position
    start: Vec3
    end: Vec3
    direction: Vec3 | None
    angle: float


def common_normal(one: Line, other: Line, near: Vec3, least: float) -> AxisNormal:
    """The common normal of two axes.

    Args:
        one: an axis.
        other: the next one.
        near: a point; of the many common normals of parallel axes, the one whose foot on the first is nearest to it.
        least: a distance that is none [m].
    """
    product, between = cross(one.direction, other.direction), subtract(other.point, one.point)
    sine = norm(product)
    if sine < _PARALLEL:
        start = add(one.point, scale(dot(subtract(near, one.point), one.direction), one.direction))
        end = add(other.point, scale(dot(subtract(start, other.point), other.direction), other.direction))
    else:
        along = dot(cross(between, other.direction), product) / sine**2
        back = dot(cross(between, one.direction), product) / sine**2
        start, end = add(one.point, scale(along, one.direction)), add(other.point, scale(back, other.direction))
    step = subtract(end, start)
    length, angle = norm(step), math.atan2(sine, dot(one.direction, other.direction))
    if length >= least:
        direction = scale(1.0 / length, step)
        signed = angle if dot(product, direction) >= 0.0 else -angle
        position = Position.PARALLEL if sine < _PARALLEL else Position.SKEW
        return AxisNormal(position, start, end, direction, signed)
    if sine < _PARALLEL:
        return AxisNormal(Position.ONE_LINE, start, start, None, angle)
    return AxisNormal(Position.MEETING, start, start, scale(1.0 / sine, product), angle)


def row_normals(table: Manipulator, frames: Sequence[RigidTransform], least: float) -> list[AxisNormal]:
    """The common normals of the z axes before and after each row; of parallel axes the ones that the table takes.

    Args:
        table: the table.
        frames: its DH frames.
        least: a distance that is none [m].
    """
    lines = [_z_axis(frame) for frame in frames]
    # The origin after a row is a foot in the standard convention, the one before it in the modified one.
    feet = frames[1:] if table.convention is Convention.STANDARD else frames
    return [
        common_normal(one, other, foot.translation, least)
        for (one, other), foot in zip(pairwise(lines), feet, strict=False)
    ]


def table_normals(
    table: Manipulator,
    q: Mapping[str, float],
    *,
    place: RigidTransform = IDENTITY,
    reach: float,
    typed: TableText | None = None,
    only: int | None = None,
) -> Iterator[Stroke]:
    """The axes z of a table with their common normals, and the offsets along each axis.

    Args:
        table: the table.
        q: joint values by name [rad or m].
        place: where its base_link is.
        reach: size of the scene [m].
        typed: the table as it was typed, in whose unit lengths are.
        only: number of the only row that is drawn, counted from 0; None for all rows.
    """
    frames = [place @ frame for frame in dh_frames(table, [q.get(row.joint, 0.0) for row in table.moving_rows])]
    normals = row_normals(table, frames, _NONE * reach)
    is_standard = table.convention is Convention.STANDARD
    unit = UNITS[typed.length_unit if typed else "m"]
    arrivals = [frames[0].translation, *(normal.end for normal in normals)]
    departures = [*(normal.start for normal in normals), frames[-1].translation]
    rows = [only] if only is not None else list(range(len(normals)))
    for number in sorted({axis for row in rows for axis in (row, row + 1)}):
        yield _line(f"z{small(number)}", _z_axis(frames[number]), (arrivals[number], departures[number]), reach)
    for row in rows:
        names = f"z{small(row)} × z{small(row + 1)}", f"a{small(row + is_standard)}"
        yield from _of_normal(row, normals[row], names, unit, reach)
        axis = row if is_standard else row + 1
        yield from _offset(row, f"d{small(row + 1)}", (arrivals[axis], departures[axis]), unit, reach)


def robot_normals(
    robot: Robot, q: Mapping[str, float], *, place: RigidTransform = IDENTITY, reach: float
) -> Iterator[Stroke]:
    """The same of a robot without a table: the axis of each moving joint, and the common normal with the one before.

    Args:
        robot: the robot.
        q: joint values by name [rad or m].
        place: where its root is.
        reach: size of the scene [m].
    """
    poses, above = link_poses(robot, q), {joint.child: joint for joint in robot.joints}
    moving = {joint.name: joint for joint in robot.moving_joints if joint.child in poses}
    lines = {name: _joint_axis(joint, place @ poses[joint.child]) for name, joint in moving.items()}
    feet: dict[str, list[Vec3]] = {name: [] for name in lines}
    arrivals: dict[str, Vec3] = {}
    unit = UNITS["m"]
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
        yield from _of_normal(None, normal, ("z × z", "a"), unit, reach)
        yield from _offset(None, "d", (near, normal.start), unit, reach)
    for name, line in lines.items():
        yield _line("", line, feet[name] or [line.point], reach)


def where_x_is(table: Manipulator, q: Mapping[str, float], number: int) -> str:
    """Where x of a row comes from, as HTML: how the axes before and after the row lie to each other.

    Args:
        table: the table.
        q: joint values by name [rad or m].
        number: number of the row, counted from 0.
    """
    frames = dh_frames(table, [q.get(row.joint, 0.0) for row in table.moving_rows])
    normal = row_normals(table, frames, _NONE * table_reach(table))[number]
    one, other = f"z<sub>{number}</sub>", f"z<sub>{number + 1}</sub>"
    frame = number + 1 if table.convention is Convention.STANDARD else number
    x = f"x<sub>{frame}</sub>"
    r = frames[frame].rotation
    against = normal.direction is not None and dot((r[0], r[3], r[6]), normal.direction) < 0.0
    match normal.position:
        case Position.SKEW:
            way = f"from {other} to {one}, as a is negative" if against else f"from {one} to {other}"
            return f"{one} and {other} are skew: they have one common normal, and {x} points along it, {way}."
        case Position.PARALLEL:
            return (
                f"{one} and {other} are parallel: they have a common normal at every point, and any of them is right. "
                f"This table takes the one through the origin of {{{frame}}}; d follows from that choice."
            )
        case Position.MEETING:
            way = "against" if against else "along"
            return f"{one} and {other} meet in a point: a is 0, and {x} is {way} {one} × {other}."
    return (
        f"{one} and {other} are one line: a is 0, and {x} may have any direction across it; θ follows from that choice."
    )


def _z_axis(frame: RigidTransform) -> Line:
    r = frame.rotation
    return Line(frame.translation, (r[2], r[5], r[8]))


def _joint_axis(joint: Joint, pose: RigidTransform) -> Line:
    direction = rotate(pose.rotation, joint.axis)
    return Line(pose.translation, scale(1.0 / norm(direction), direction))


def _line(name: str, line: Line, feet: Sequence[Vec3], reach: float) -> Stroke:
    """An axis, some way beyond the feet on it."""
    along = [dot(subtract(foot, line.point), line.direction) for foot in feet]
    ends = min(along) - _BEYOND * reach, max(along) + _BEYOND * reach
    points = tuple(add(line.point, scale(end, line.direction)) for end in ends)
    return Stroke(row=None, field="line", points=points, label=name)


def _of_normal(
    row: int | None, normal: AxisNormal, names: tuple[str, str], unit: Unit, reach: float
) -> Iterator[Stroke]:
    """A common normal with its feet; of axes that meet, the cross product that takes its place."""
    product, length = names
    if normal.direction is None:
        return
    if normal.position is Position.MEETING:
        tip = add(normal.start, scale(_CROSS * reach, normal.direction))
        yield Stroke(row=row, field="normal", points=(normal.start, tip), label=product)
    else:
        size = norm(subtract(normal.end, normal.start))
        label = f"|{length}| = {unit.number(size):.4g} {unit.symbol}"
        yield Stroke(row=row, field="normal", points=(normal.start, normal.end), label=label)
        yield Stroke(row=row, field="foot", points=(normal.end,), label="")
    yield Stroke(row=row, field="foot", points=(normal.start,), label="")


def _offset(row: int | None, name: str, feet: tuple[Vec3, Vec3], unit: Unit, reach: float) -> Iterator[Stroke]:
    """The way along an axis from one foot to the next, where it is any."""
    start, end = feet
    length = norm(subtract(end, start))
    if length >= _NONE * reach:
        label = f"|{name}| = {unit.number(length):.4g} {unit.symbol}"
        yield Stroke(row=row, field="offset", points=(start, end), label=label)
