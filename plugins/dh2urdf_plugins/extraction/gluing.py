"""A chain becomes rows: the screws along z of neighbours add up in the joint between them.

    θ_i = ψ_(i−1) + φ_i,  d_i = e_(i−1) + b_i
    standard:  base = Z(φ_0, b_0)·S(a_0, α_0),  row i = (θ_i, d_i, a_i, α_i),          tool = Z(ψ_N, e_N)
    modified:  base = Z(φ_0, b_0),              row i = (a_(i−1), α_(i−1), θ_i, d_i),  tool = S(a_N, α_N)·Z(ψ_N, e_N)

A turn and a shift along z commute with a joint's own motion, whether it turns or slides. All else is choice.

Which way the common normals point: an exact shortest path over two directions for each link. a, α → −a, −α with a half
turn before and behind leaves the arm as it is. Of all such choices the table takes the one with the fewest constant
angles, then the fewest negative lengths, then the fewest positive θ and negative α. Data sheets have θ = 0 throughout
even if a is negative, and where a θ = ±π/2 is needed anyhow, a > 0 and θ = −π/2.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

from dh2urdf.elementwise import total
from dh2urdf.manipulator import Convention
from dh2urdf.rotations import IDENTITY, RigidTransform, cos_sin, multiply, rotation_z
from dh2urdf_plugins.extraction.chain import ZSZ, decompose, x_screw, z_screw
from dh2urdf_plugins.extraction.ends import Base, Tip, bases, tip

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.extraction.chain import Chain, Precision


Cost: TypeAlias = tuple[int, int, int, int]
"""Tenths of the first criterion, and counts of negative a, positive θ and negative α."""

_ANGLE, _HALF_TURN, _HALF_TURN_AT_TIP, _NEGATIVE_LENGTH = 20, 30, 6, 10
_BASE_TURNED, _BASE_TURNED_FOR_LITTLE = 5, 25


@dataclass(frozen=True, slots=True)
class Group:
    """Axes on one line, which have one turn to give away.

    Attributes:
        first: number of the first axis.
        last: number of the last axis.
        taker: the axis whose θ is the turn.
        inner: what the links between them turn, seen along the first axis [rad].
        direction: 1 where the taker points as the first axis does, else −1.
        last_direction: the same of the last axis.
    """

    first: int
    last: int
    taker: int
    inner: float
    direction: int
    last_direction: int


class Directions(NamedTuple):
    """What was chosen.

    Attributes:
        base: how the first link is shared.
        links: the links between the groups, with the direction of their normals.
        turns: θ of each group's taker [rad].
        base_turn: what the base turns about the first axis [rad].
    """

    base: Base
    links: tuple[ZSZ, ...]
    turns: tuple[float, ...]
    base_turn: float


class _Path(NamedTuple):
    cost: Cost
    base: Base
    links: tuple[ZSZ, ...]
    turns: tuple[float, ...]
    base_turn: float
    psi: float


def shortest(
    bases: Sequence[Base], groups: Sequence[Group], links: Sequence[ZSZ], tip: Tip, precision: Precision
) -> Directions:
    """The best directions.

    Args:
        bases: how the first link may be shared.
        groups: the groups of axes on one line.
        links: the links between the groups: one fewer.
        tip: how the last link is shared.
        precision: what counts as zero.
    """

    def search(base_turned: int) -> _Path:
        costs: list[Cost] = [(base_turned * base.is_turned, *_signs(*base.row)) for base in bases]
        paths = [_Path(cost, base, (), (), 0.0, base.turn) for cost, base in zip(costs, bases, strict=True)]
        for group, link in zip(groups[:-1], links, strict=True):
            # Of all paths to one direction of a link, only the best goes on.
            reached = [[_through(path, group, way, precision) for path in paths] for way in (link, link.flipped)]
            paths = [min(ways, key=_cost) for ways in reached]
        return min((_to_tip(path, groups[-1], tip, precision) for path in paths), key=_cost)

    best = search(_BASE_TURNED)
    if best.base.is_turned and best.cost[0] > _BASE_TURNED:
        best = search(_BASE_TURNED_FOR_LITTLE)
    return Directions(best.base, best.links, best.turns, best.base_turn)


def _cost(path: _Path) -> Cost:
    return path.cost


def _through(path: _Path, group: Group, link: ZSZ, precision: Precision) -> _Path:
    """A path that goes on through a group of axes and over the link behind it."""
    theta, rest = _turn(path, group, link.phi, precision)
    is_last = group.taker == group.last
    beside = _NEGATIVE_LENGTH if link.a < 0.0 and theta and is_last else 0
    cost = _sum(path.cost, _angle_cost(theta, _HALF_TURN), (beside, *_signs(link.a, link.alpha)))
    return _Path(cost, path.base, (*path.links, link), (*path.turns, theta), path.base_turn + rest, link.psi)


def _to_tip(path: _Path, group: Group, tip: Tip, precision: Precision) -> _Path:
    theta, rest = _turn(path, group, tip.turn, precision)
    is_last = group.taker == group.last
    beside = _NEGATIVE_LENGTH if tip.row[0] < 0.0 and theta and is_last else 0
    turn = _angle_cost(theta, _HALF_TURN_AT_TIP if is_last else _HALF_TURN)
    cost = _sum(path.cost, turn, (beside, *_signs(*tip.row)))
    return path._replace(cost=cost, turns=(*path.turns, theta), base_turn=path.base_turn + rest)


def _turn(path: _Path, group: Group, phi: float | None, precision: Precision) -> tuple[float, float]:
    """θ of a group's taker, and what the base turns in its place [rad]."""
    if phi is None:
        return 0.0, 0.0
    turn = path.psi + group.inner + group.last_direction * phi
    if path.base.is_turned and not path.turns:
        return 0.0, turn
    return precision.angle_of(group.direction * turn), 0.0


def _angle_cost(theta: float, half_turn: int) -> Cost:
    if theta == 0.0:
        return (0, 0, 0, 0)
    return (half_turn if theta == math.pi else _ANGLE, 0, int(theta > 0.0), 0)


def _signs(a: float, alpha: float) -> tuple[int, int, int]:
    return int(a < 0.0), 0, int(alpha < 0.0)


def _sum(*costs: Cost) -> Cost:
    first, second, third, fourth = (sum(each) for each in zip(*costs, strict=True))
    return first, second, third, fourth


class Numbers(NamedTuple):
    """The numbers of a row [m, rad]."""

    a: float
    alpha: float
    d: float
    theta: float


@dataclass(frozen=True, slots=True)
class Glued:
    """The rows of a chain, with the numbers that a table has.

    Attributes:
        rows: a row for each axis.
        base: the base transform.
        tool: the tool transform.
    """

    rows: tuple[Numbers, ...]
    base: RigidTransform
    tool: RigidTransform


def glue(chain: Chain, convention: Convention, precision: Precision, arm_length: float, *, origins: str) -> Glued:
    """The rows of a chain.

    Args:
        chain: the chain, its sliding axes in their places, nearly parallel links split where they have to be.
        convention: of the rows.
        precision: what counts as zero, and how far numbers may be from what was computed.
        arm_length: the arm's length [m].
        origins: ``file`` where each d of parallel axes is to be as the file's origins have it, else ``fewest``.
    """
    links = [decompose(link, precision) for link in chain.links[1:-1]]
    ways = bases(chain.links[0], convention, precision, arm_length)
    last = tip(chain.links[-1], convention, precision, arm_length)
    groups = _groups(chain, links)
    between = [links[group.last] for group in groups[:-1]]
    chosen = shortest(ways, groups, between, last, precision)
    heights = _heights(chain, links, chosen.base, last, precision, keep=origins == "file")
    screws, thetas = _screws(links, groups, chosen), [0.0] * len(chain.axes)
    for group, theta in zip(groups, chosen.turns, strict=True):
        thetas[group.taker] = theta
    screws = [*screws, last.row] if convention is Convention.STANDARD else [chosen.base.row, *screws]
    rows = tuple(
        Numbers(a, alpha, precision.length_of(d), theta)
        for (a, alpha), d, theta in zip(screws, heights, thetas, strict=True)
    )
    base = precision.pose_of(_turned(chosen.base, chosen.base_turn, precision))
    tool = _rest(chain, rows, base, convention, precision) if last.has_tool else IDENTITY
    return Glued(rows, base, tool)


def _screws(links: Sequence[ZSZ], groups: Sequence[Group], chosen: Directions) -> list[tuple[float, float]]:
    """A and α of the links between two axes."""
    directed = {group.last: link for group, link in zip(groups, chosen.links, strict=False)}
    return [(each.a, each.alpha) for each in (directed.get(number, link) for number, link in enumerate(links))]


# Turns.


def _groups(chain: Chain, links: Sequence[ZSZ]) -> list[Group]:
    """The axes, by the lines that they are on."""
    found: list[Group] = []
    first = 0
    for number in range(len(chain.axes)):
        if number == len(links) or not links[number].is_collinear:
            found.append(_group(chain, links, first, number))
            first = number + 1
    return found


def _group(chain: Chain, links: Sequence[ZSZ], first: int, last: int) -> Group:
    directions, inner = [1], 0.0
    for link in links[first:last]:
        inner += directions[-1] * (link.phi + link.parallel * link.psi)
        directions.append(directions[-1] * link.parallel)
    taker = next((number for number in range(first, last + 1) if not chain.axes[number].turns), first)
    return Group(first, last, taker, inner, directions[taker - first], directions[-1])


# Shifts.


def _heights(
    chain: Chain, links: Sequence[ZSZ], base: Base, last: Tip, precision: Precision, *, keep: bool
) -> list[float]:
    """D of every axis [m]."""
    heights = [0.0] * len(chain.axes)
    heights[0] += base.shift
    heights[-1] += last.shift
    for number, link in enumerate(links):
        heights[number] += link.b
        heights[number + 1] += link.e
    if not keep:
        first = 0
        for number in range(len(chain.axes)):
            if number == len(links) or not links[number].parallel:
                _give_away(chain, links, heights, first, number, precision)
                first = number + 1
    return heights


def _give_away(  # noqa: PLR0917 - the run and what is known of it
    chain: Chain, links: Sequence[ZSZ], heights: list[float], first: int, last: int, precision: Precision
) -> None:
    """Gives the sum of the shifts along a run of parallel axes to one of them."""
    directions = [1]
    for link in links[first:last]:
        directions.append(directions[-1] * link.parallel)
    run = range(first, last + 1)
    shift = total(direction * heights[number] for direction, number in zip(directions, run, strict=True))
    shifted = [number for number in run if abs(heights[number]) > precision.length]
    is_inside = first > 0 and last < len(chain.axes) - 1
    if len(run) > 2 and is_inside and all(chain.axes[number].turns for number in run):  # noqa: PLR2004
        taker = last
    elif len(shifted) == 1:
        (taker,) = shifted
    else:
        taker = first if first == 0 else last
    for number in run:
        heights[number] = 0.0
    heights[taker] = directions[taker - first] * shift


# Base and tool.


def _turned(base: Base, turn: float, precision: Precision) -> RigidTransform:
    r, t = base.transform
    return RigidTransform(multiply(r, rotation_z(*cos_sin(precision.angle_of(turn)))), t) if turn else base.transform


def _rest(
    chain: Chain, rows: Sequence[Numbers], base: RigidTransform, convention: Convention, precision: Precision
) -> RigidTransform:
    """What is left for the tool at q = 0: it makes up for what the rows and the base lose by rounding.

    The frame of each row is followed in the frame of its axis, where its numbers are those of the arm.
    """
    # `behind` leads from the table's frame to the file's frame K at the same joint.
    behind = base.inverse @ chain.links[0]
    for row, link in zip(rows, chain.links[1:], strict=True):
        if convention is Convention.STANDARD:
            screws = z_screw(row.theta, row.d) @ x_screw(row.a, row.alpha)
        else:
            screws = x_screw(row.a, row.alpha) @ z_screw(row.theta, row.d)
        behind = screws.inverse @ behind @ link
    return precision.pose_of(behind)
