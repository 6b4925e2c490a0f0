"""Which way the common normals point: an exact shortest path over two directions for each link.

a, α → −a, −α with a half turn before and behind leaves the arm as it is. Of all such choices the table takes the one
with the fewest constant angles, then the fewest negative lengths, then the fewest positive θ and negative α. Data
sheets have θ = 0 throughout even if a is negative, and where a θ = ±π/2 is needed anyhow, a > 0 and θ = −π/2.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, TypeAlias

from dh2urdf.late_dataclasses import dataclass
from dh2urdf.late_tuples import NamedTuple

if TYPE_CHECKING:
    from collections.abc import Sequence

    from dh2urdf_plugins.extraction.ends import Base, Tip
    from dh2urdf_plugins.extraction.numbers import Precision
    from dh2urdf_plugins.extraction.zsz import ZSZ

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
