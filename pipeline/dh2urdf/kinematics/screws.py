"""Which base, tool, signs and offsets make one arm of two that were described by different hands.

Two serial arms move alike where their joints have the same axes: T(q) is a product of screw motions about the axes
that the joints have at q = 0 (Brockett, 1984; Lynch and Park, Modern Robotics, eq. 4.14). So the table's axes are laid
upon the description's, one after the other. A sign turns an axis round; a base transform X moves all axes; an offset c
of a joint moves all axes behind it, as the joint does. With axes (w, p) of the description and (w', p') of the table,
wanted are X, signs s and offsets c with

    w_i = s_i Q_i w'_i    and    p_i - (Q_i p'_i + b_i) parallel to w_i,
    where (Q_i, b_i) = X · motion_1(c_1) · … · motion_(i-1)(c_(i-1));

a prismatic joint asks for the direction alone. The rotations follow one by one: until an axis fixes it, the arm may
still turn about the axis before, and the turn goes to that joint's offset, or to X. An axis that is parallel to the
one before does not fix the turn by its direction, but by where it stands. Then the positions are linear in what is
left, the shift of X and the offsets of prismatic joints. Where an arm leaves a choice, nothing is corrected: a turn
about the first axis goes to X, one about the last to the tool.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

from dh2urdf.kinematics.chain import axis_rotation
from dh2urdf.rotations import (
    IDENTITY_ROTATION,
    X_AXIS,
    ZERO,
    Rotation,
    Vec3,
    add,
    cross,
    dot,
    multiply,
    norm,
    rotate,
    scale,
    subtract,
)

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from dh2urdf.kinematics.chain import Screw

MOST_STATES = 4096
"""Beginnings of an arm that are tried: only axes that meet at right angles leave two ways to go on."""


class Mismatch(NamedTuple):
    """Where two arms part."""

    joint: int  # index of the first joint whose axis cannot be laid upon the other's
    angle: float  # by how much its direction differs then [rad]; 0 where that fits
    distance: float  # by how much its position differs then [m]


@dataclass(frozen=True, slots=True, kw_only=True)
class Alignment:
    """What lays a table's axes upon a description's."""

    rotation: Rotation  # that of the base transform X
    translation: Vec3  # that of X [m]
    signs: tuple[int, ...]  # 1 or −1 per joint
    offsets: tuple[float, ...]  # the table's joint values at the description's zero [rad or m]


def axis_error(given: Screw, wanted: Screw) -> tuple[float, float]:
    """How far the point of an axis is from another axis [m], and the angle between the two [rad].

    The distance of an axis that slides is 0: only its direction counts.
    """
    away = _across(wanted.direction, subtract(given.point, wanted.point))
    return (0.0 if wanted.slides else norm(away)), _angle(given.direction, wanted.direction)


class _State(NamedTuple):
    """The first joints of the table, laid upon those of the description."""

    base: Rotation  # rotation of X
    signs: tuple[int, ...]  # of these joints
    turns: tuple[float, ...]  # offsets of those that turn, 0 of those that slide [rad]
    placed: Rotation  # Q behind these joints
    hinge: int | None  # what can still turn all that follows: index of a joint, −1 for X; None where nothing can
    last: int | None  # index of the last joint that turns, or None


_START = _State(IDENTITY_ROTATION, (), (), IDENTITY_ROTATION, -1, None)


def align(wanted: Sequence[Screw], given: Sequence[Screw], tolerance: float) -> list[Alignment] | Mismatch:
    """What lays the given axes, a table's, upon those wanted: every way there is, or where the longest one ends.

    There are as many of both, of the same types. Directions [rad] and positions [m] may differ by the tolerance.
    """
    found: list[Alignment] = []
    waiting = [_START]
    worst = Mismatch(0, 0.0, 0.0)
    for _ in range(MOST_STATES):
        if not waiting:
            break
        state = waiting.pop()
        number = len(state.signs)
        if number == len(wanted):
            (x, y, z, *slid), _ = _position(wanted, given, state)
            slides = iter(slid)
            offsets = tuple(
                next(slides) if screw.slides else turn for screw, turn in zip(given, state.turns, strict=True)
            )
            found.append(Alignment(rotation=state.base, translation=(x, y, z), signs=state.signs, offsets=offsets))
            continue
        for following, angle in reversed(list(_next(wanted, given, state, tolerance))):
            distance = 0.0 if following is None else _position(wanted, given, following)[1]
            if following is not None and distance <= tolerance:
                waiting.append(following)
            elif number >= worst.joint:
                # Of two ways to part, the one that comes later; of two at one joint, the one that fits better.
                other = Mismatch(number, angle, distance)
                is_tied = number == worst.joint and (worst.angle or worst.distance)
                worst = min(worst, other, key=lambda mismatch: mismatch[1:]) if is_tied else other
    return found or worst


def _next(
    wanted: Sequence[Screw], given: Sequence[Screw], state: _State, tolerance: float
) -> Iterator[tuple[_State | None, float]]:
    """The next joint laid upon the description's, with either sign; None and the angle [rad] where it does not fit."""
    number = len(state.signs)
    target, source = wanted[number], given[number]
    axis = None if state.hinge is None or not number else wanted[max(state.hinge, 0)].direction
    for sign in (1, -1):
        direction = scale(sign, rotate(state.placed, source.direction))
        if not number:
            turn, used = _shortest_turn(direction, target.direction), False
        elif axis is None:
            turn, used = IDENTITY_ROTATION, False
        elif norm(cross(axis, target.direction)) > tolerance:
            turn, used = axis_rotation(axis, _angle_about(axis, direction, target.direction)), True
        else:
            turn, used = _turn_of_parallel(wanted, given, state, tolerance)
        angle = _angle(rotate(turn, direction), target.direction)
        yield (None if angle > tolerance else _turned(state, turn, axis, sign, used=used, slides=target.slides)), angle


def _turn_of_parallel(
    wanted: Sequence[Screw], given: Sequence[Screw], state: _State, tolerance: float
) -> tuple[Rotation, bool]:
    """The turn that an axis parallel to the hinge asks for by where it stands, and whether it asks for one."""
    number, last = len(state.signs), state.last
    if last is None or wanted[number].slides:
        return IDENTITY_ROTATION, False
    axis = wanted[number].direction
    there = _across(axis, subtract(wanted[number].point, wanted[last].point))
    here = _across(axis, rotate(state.placed, subtract(given[number].point, given[last].point)))
    if min(norm(there), norm(here)) <= tolerance:
        return IDENTITY_ROTATION, False
    return axis_rotation(axis, _angle_about(axis, here, there)), True


def _turned(state: _State, turn: Rotation, axis: Vec3 | None, sign: int, *, used: bool, slides: bool) -> _State:
    """The state with one joint more, after the hinge made its turn."""
    number, base, turns = len(state.signs), state.base, list(state.turns)
    if state.hinge == -1:
        base = multiply(turn, base)
    elif used and state.hinge is not None and axis is not None:
        twice_sine = dot(axis, (turn[7] - turn[5], turn[2] - turn[6], turn[3] - turn[1]))
        angle = math.atan2(twice_sine, turn[0] + turn[4] + turn[8] - 1.0)
        turns[state.hinge] += state.signs[state.hinge] * angle
    hinge = None if used else state.hinge
    if hinge is None and not slides:
        hinge = number
    placed, last = multiply(turn, state.placed), state.last if slides else number
    return _State(base, (*state.signs, sign), (*turns, 0.0), placed, hinge, last)


def _position(wanted: Sequence[Screw], given: Sequence[Screw], state: _State) -> tuple[list[float], float]:
    """The shift of X and the offsets of the joints that slide, least squares; and the largest distance left [m]."""
    import numpy as np

    placed, shift = state.base, ZERO
    sliding: list[Vec3] = []
    blocks: list[tuple[Vec3, Vec3, int]] = []  # axis, what is missing, how many slide before
    for target, source, turn in zip(wanted, given, state.turns, strict=False):
        if source.slides:
            sliding.append(rotate(placed, source.direction))
            continue
        here = add(rotate(placed, source.point), shift)
        blocks.append((target.direction, subtract(target.point, here), len(sliding)))
        turned = multiply(placed, axis_rotation(source.direction, turn))
        shift = add(shift, subtract(rotate(placed, source.point), rotate(turned, source.point)))
        placed = turned
    rows = np.zeros((3 * len(blocks), 3 + len(sliding)))
    missing = np.zeros(3 * len(blocks))
    for number, (axis, gap, before) in enumerate(blocks):
        across = np.eye(3) - np.outer(axis, axis)
        part = slice(3 * number, 3 * number + 3)
        rows[part, :3] = across
        rows[part, 3 : 3 + before] = across @ np.array(sliding[:before]).reshape(before, 3).T
        missing[part] = across @ gap
    if not blocks:
        return [0.0] * (3 + len(sliding)), 0.0
    unknowns = np.linalg.lstsq(rows, missing, rcond=1e-9)[0]
    left = np.linalg.norm((rows @ unknowns - missing).reshape(-1, 3), axis=1)
    return [float(value) for value in unknowns], float(left.max())


# Vectors.


def _across(axis: Vec3, vector: Vec3) -> Vec3:
    """The part of a vector that is perpendicular to an axis."""
    return subtract(vector, scale(dot(axis, vector), axis))


def _angle(left: Vec3, right: Vec3) -> float:
    """The angle between two unit vectors [rad]."""
    return math.atan2(norm(cross(left, right)), dot(left, right))


def _angle_about(axis: Vec3, start: Vec3, end: Vec3) -> float:
    """The turn about an axis that brings one vector nearest to another [rad]."""
    here, there = _across(axis, start), _across(axis, end)
    return math.atan2(dot(axis, cross(here, there)), dot(here, there))


def _shortest_turn(start: Vec3, end: Vec3) -> Rotation:
    """The rotation by the smallest angle that brings one unit vector to another."""
    axis = cross(start, end)
    sine = norm(axis)
    if sine > 0.0:
        return axis_rotation(scale(1.0 / sine, axis), math.atan2(sine, dot(start, end)))
    if dot(start, end) > 0.0:
        return IDENTITY_ROTATION
    beside = _across(start, X_AXIS)
    if norm(beside) < 0.5:  # noqa: PLR2004 - x is nearly the axis: y is not
        beside = _across(start, (0.0, 1.0, 0.0))
    return axis_rotation(scale(1.0 / norm(beside), beside), math.pi)
